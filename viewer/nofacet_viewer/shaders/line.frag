#version 330 core
// A fine anti-aliased line, hidden by a depth picture: lines lie on surfaces, where no depth buffer would decide well.
const int ON_SURFACE = 0, IN_FRONT = 1, FAINT_BEHIND = 2;
uniform int rule;
uniform bool perspective;
uniform vec3 line_color;    // linear
uniform float opacity;
uniform float half_width;   // pixels
uniform float tolerance;    // how far the line may be off the surface it lies on, model units
uniform vec2 size;          // of the picture, pixels
uniform sampler2D surface;  // depth at pixel centres, huge on background
uniform bool top_first;     // row 0 of `surface` is the picture's top
flat in vec2 from, to;
flat in vec2 key;
out vec4 color;             // linear, alpha premultiplied
const float BACKGROUND = 1e29;
const float FAINT = 0.3;

float depth_at(ivec2 texel) {
    return texelFetch(surface, clamp(texel, ivec2(0), textureSize(surface, 0) - 1), 0).r;
}

// How much the depth changes from a texel to the next. A step to another surface on one side does not count: the
// smoother side decides.
float slope_at(ivec2 texel, float depth) {
    float x = min(abs(depth_at(texel - ivec2(1, 0)) - depth), abs(depth_at(texel + ivec2(1, 0)) - depth));
    float y = min(abs(depth_at(texel - ivec2(0, 1)) - depth), abs(depth_at(texel + ivec2(0, 1)) - depth));
    return x + y;
}

// Whether a line at this depth is seen: before the surface, or on it or on that of a neighbouring texel, within what
// these fall away there.
bool shows(ivec2 texel, float line) {
    float here = depth_at(texel);
    if (rule != ON_SURFACE && (here > BACKGROUND || line <= here)) return true;
    for (int dy = -1; dy <= 1; ++dy) {
        for (int dx = -1; dx <= 1; ++dx) {
            ivec2 near = texel + ivec2(dx, dy);
            float depth = depth_at(near);
            if (depth < BACKGROUND && abs(line - depth) <= 1.5 * slope_at(near, depth) + tolerance) return true;
        }
    }
    return false;
}

void main() {
    vec2 at = gl_FragCoord.xy, run = to - from;
    float length2 = dot(run, run);
    float t = length2 > 0.0 ? clamp(dot(at - from, run) / length2, 0.0, 1.0) : 0.0;
    float strength = opacity * clamp(half_width + 0.5 - distance(at, from + t * run), 0.0, 1.0);
    if (strength <= 0.0) discard;
    float line = mix(key.x, key.y, t);
    if (perspective) line = -1.0 / line;
    vec2 place = at / size;
    if (top_first) place.y = 1.0 - place.y;
    if (!shows(ivec2(floor(place * vec2(textureSize(surface, 0)))), line)) {
        if (rule != FAINT_BEHIND) discard;
        strength *= FAINT;
    }
    color = vec4(line_color * strength, strength);
}
