#version 330 core
// A segment of a line as a rectangle around it, a little longer and wider than what is seen.
uniform mat4 clip_from_local;
uniform mat4 eye_from_local;
uniform bool perspective;
uniform vec2 size;         // of the picture, pixels
uniform float half_width;  // pixels
uniform float nearest;     // the smallest clip w that is in front of the eye
in vec3 start;
in vec3 end;
flat out vec2 from, to;    // pixels, origin at the bottom left
flat out vec2 key;         // of both ends: grows with depth and is linear in the picture

vec4 moved_before_the_eye(vec4 p, vec4 q) {
    return p.w >= nearest ? p : mix(p, q, (nearest - p.w) / (q.w - p.w));
}

vec2 pixel_of(vec4 p) {
    return (0.5 + 0.5 * p.xy / p.w) * size;
}

void main() {
    vec4 p = clip_from_local * vec4(start, 1.0), q = clip_from_local * vec4(end, 1.0);
    if (max(p.w, q.w) <= nearest) {  // all of it is behind the eye: nothing to draw
        from = to = key = vec2(0.0);
        gl_Position = vec4(2.0, 2.0, 2.0, 1.0);
        return;
    }
    if (perspective) {
        vec4 clipped = moved_before_the_eye(p, q);
        q = moved_before_the_eye(q, p);
        p = clipped;
        key = -1.0 / vec2(p.w, q.w);
    } else {
        key = vec2((eye_from_local * vec4(start, 1.0)).z, (eye_from_local * vec4(end, 1.0)).z);
    }
    from = pixel_of(p);
    to = pixel_of(q);
    vec2 along = to - from;
    float length_ = length(along);
    along = length_ > 0.0 ? along / length_ : vec2(1.0, 0.0);
    float reach = half_width + 1.0;
    bool at_end = (gl_VertexID & 1) == 1;
    float side = (gl_VertexID >> 1) == 1 ? 1.0 : -1.0;
    vec2 corner = (at_end ? to + reach * along : from - reach * along) + side * reach * vec2(-along.y, along.x);
    gl_Position = vec4(2.0 * corner / size - 1.0, 0.0, 1.0);
}
