#version 330 core
// One triangle that covers the viewport.
out vec2 at;  // place in the viewport, from (0, 0) at the bottom left to (1, 1)
void main() {
    at = 2.0 * vec2(gl_VertexID & 1, gl_VertexID >> 1);
    gl_Position = vec4(2.0 * at - 1.0, 0.0, 1.0);
}
