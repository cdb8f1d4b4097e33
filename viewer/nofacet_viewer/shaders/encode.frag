#version 330 core
// A linear picture before the background, in sRGB. It is drawn `from_bottom` rows up.
#include "srgb.glsl"
uniform sampler2D picture;  // linear, alpha premultiplied
uniform int from_bottom;
uniform vec3 background;    // linear
out vec4 color;
void main() {
    vec4 sum = texelFetch(picture, ivec2(gl_FragCoord.xy) - ivec2(0, from_bottom), 0);
    color = vec4(srgb(sum.rgb + (1.0 - sum.a) * background), 1.0);
}
