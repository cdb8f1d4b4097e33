#version 330 core
// A finished picture with its marks and lines.
#include "srgb.glsl"
#include "faces.glsl"
uniform sampler2D picture;      // sRGB
uniform bool top_first;         // row 0 of the picture is its top
uniform sampler2D lines;        // linear, alpha premultiplied; row 0 is the bottom
uniform bool has_marks;         // faces of the picture may have some
uniform isampler2D frame_face;  // the picture's face at the pixel centres, less than 0 where there is none
in vec2 at;
out vec4 color;
void main() {
    vec2 from_first = top_first ? vec2(at.x, 1.0 - at.y) : at;
    vec4 sum = vec4(linear_from_srgb(texture(picture, from_first).rgb), 1.0);
    if (has_marks) {
        int face = texelFetch(frame_face, ivec2(from_first * vec2(textureSize(frame_face, 0))), 0).r;
        if (face >= 0) sum = marked(sum, face);
    }
    vec4 line = texture(lines, at);
    color = vec4(srgb(line.rgb + (1.0 - line.a) * sum.rgb), 1.0);
}
