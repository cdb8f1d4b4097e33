#version 330 core
// A finished picture.
uniform sampler2D picture;  // sRGB
uniform bool top_first;     // row 0 of the picture is its top
in vec2 at;
out vec4 color;
void main() {
    color = vec4(texture(picture, top_first ? vec2(at.x, 1.0 - at.y) : at).rgb, 1.0);
}
