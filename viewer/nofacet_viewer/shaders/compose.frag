#version 330 core
// A side's picture with its lines before the background, in sRGB.
#include "srgb.glsl"
#include "faces.glsl"
uniform sampler2D picture;  // linear, alpha premultiplied
uniform bool top_first;     // row 0 of the picture is its top
uniform sampler2D lines;    // the same over it; row 0 is the bottom
uniform bool has_marks;     // faces of the picture may have some
uniform isampler2D frame_face;  // the picture's face at the pixel centres, less than 0 where there is none
uniform vec3 background;    // linear
uniform vec4 pane;          // left, bottom, width, height in the framebuffer
out vec4 color;
void main() {
    vec2 at = (gl_FragCoord.xy - pane.xy) / pane.zw;
    vec2 from_first = top_first ? vec2(at.x, 1.0 - at.y) : at;
    vec4 sum = texture(picture, from_first);
    if (has_marks) {
        int face = texelFetch(frame_face, ivec2(from_first * vec2(textureSize(frame_face, 0))), 0).r;
        if (face >= 0) sum = marked(sum, face);
    }
    vec4 line = texture(lines, at);
    sum = line + (1.0 - line.a) * sum;
    color = vec4(srgb(sum.rgb + (1.0 - sum.a) * background), 1.0);
}
