#version 330 core
// A side's picture with its lines before the background, in sRGB.
#include "srgb.glsl"
uniform sampler2D picture;  // linear, alpha premultiplied
uniform bool top_first;     // row 0 of the picture is its top
uniform sampler2D lines;    // the same over it; row 0 is the bottom
uniform vec3 background;    // linear
uniform vec4 pane;          // left, bottom, width, height in the framebuffer
out vec4 color;
void main() {
    vec2 at = (gl_FragCoord.xy - pane.xy) / pane.zw;
    vec4 sum = texture(picture, top_first ? vec2(at.x, 1.0 - at.y) : at);
    vec4 line = texture(lines, at);
    sum = line + (1.0 - line.a) * sum;
    color = vec4(srgb(sum.rgb + (1.0 - sum.a) * background), 1.0);
}
