#version 330 core
// What is at the pixel's centre: the depth and the face.
in vec3 eye_position;
flat in int face_index;
layout(location = 0) out float depth;
layout(location = 1) out int face;
void main() {
    depth = eye_position.z;
    face = face_index;
}
