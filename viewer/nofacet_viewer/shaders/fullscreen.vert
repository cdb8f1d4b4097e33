#version 330 core
// Two triangles that cover the viewport: a rectangle is what drivers that draw by processor have a short way for.
out vec2 at;  // place in the viewport, from (0, 0) at the bottom left to (1, 1)
const vec2 CORNERS[6] = vec2[](vec2(0, 0), vec2(1, 0), vec2(1, 1), vec2(0, 0), vec2(1, 1), vec2(0, 1));
void main() {
    at = CORNERS[gl_VertexID];
    gl_Position = vec4(2.0 * at - 1.0, 0.0, 1.0);
}
