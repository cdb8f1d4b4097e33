#version 330 core
// Signed outline error as colour over a pale exact picture; pixels whose centre shows another face are tinted.
#include "srgb.glsl"
uniform sampler2D picture;       // the exact side, sRGB; row 0 is the top
uniform isampler2D frame_face;   // the exact side's face, row 0 is the top; -1 on background
uniform bool has_face;
uniform isampler2D drawn_face;   // the mesh's face; row 0 is the bottom
uniform sampler2D error;         // signed error in px, and 1 where there is one; row 0 is the top
uniform sampler2D ramp;
uniform float ramp_end;
uniform vec3 background;
in vec2 at;
out vec4 color;
const vec3 LUMINANCE = vec3(0.2126, 0.7152, 0.0722);
const float PALE = 0.25;                        // of the picture's contrast
const vec3 OTHER_FACE = vec3(0.80, 0.62, 0.25);
void main() {
    vec2 from_top = vec2(at.x, 1.0 - at.y);
    float gray = dot(linear_from_srgb(texture(picture, from_top).rgb), LUMINANCE);
    vec3 rgb = vec3(mix(dot(background, LUMINANCE), gray, PALE));
    if (has_face) {
        ivec2 exact_at = ivec2(from_top * vec2(textureSize(frame_face, 0)));
        int exact = texelFetch(frame_face, exact_at, 0).r;
        int drawn = texelFetch(drawn_face, ivec2(at * vec2(textureSize(drawn_face, 0))), 0).r;
        if (exact != drawn) rgb = OTHER_FACE;
    }
    vec2 found = texelFetch(error, ivec2(from_top * vec2(textureSize(error, 0))), 0).rg;
    float place = sign(found.r) * sqrt(abs(found.r) / ramp_end);  // as ColorScale.root has it
    if (found.g > 0.0) rgb = texture(ramp, vec2(0.5 + 0.5 * place, 0.5)).rgb;
    color = vec4(srgb(rgb), 1.0);
}
