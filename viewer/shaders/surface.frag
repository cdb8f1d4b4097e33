#version 330 core
// What is at the pixel's centre: the depth and the face. Faces of no opacity are not there.
#include "faces.glsl"
in vec3 eye_position;
flat in int face_index;
layout(location = 0) out float depth;
layout(location = 1) out int face;
void main() {
    if (color_of_face(face_index).a == 0.0) discard;
    depth = eye_position.z;
    face = face_index;
}
