#version 330 core
// As fullscreen.vert, for a picture's texture.
uniform bool top_first;  // row 0 of the picture is its top
out vec2 at;             // place in the texture
const vec2 CORNERS[6] = vec2[](vec2(0, 0), vec2(1, 0), vec2(1, 1), vec2(0, 0), vec2(1, 1), vec2(0, 1));
void main() {
    vec2 corner = CORNERS[gl_VertexID];
    at = top_first ? vec2(corner.x, 1.0 - corner.y) : corner;
    gl_Position = vec4(2.0 * corner - 1.0, 0.0, 1.0);
}
