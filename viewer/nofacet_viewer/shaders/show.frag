#version 330 core
// A finished picture, and no more than that: see show.vert.
uniform sampler2D picture;  // sRGB, opaque
in vec2 at;
out vec4 color;
void main() {
    color = texture(picture, at);
}
