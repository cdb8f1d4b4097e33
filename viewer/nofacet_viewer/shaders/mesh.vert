#version 330 core
uniform mat4 clip_from_local;
uniform mat4 eye_from_local;
#ifdef CLIPPED  // where nothing is cut, this would only cost time
uniform vec4 sections[8];  // in local coordinates, the first three of unit length: positive where they cut away
out float gl_ClipDistance[8];
#endif
in vec3 position;
in vec3 normal;
in int face;
out vec3 eye_position;
out vec3 eye_normal;
centroid out vec3 inner_normal;  // the same, never beyond the triangle where that covers part of a pixel
flat out int face_index;
void main() {
#ifdef CLIPPED
    for (int k = 0; k < 8; ++k) gl_ClipDistance[k] = -dot(sections[k], vec4(position, 1.0));
#endif
    gl_Position = clip_from_local * vec4(position, 1.0);
    eye_position = (eye_from_local * vec4(position, 1.0)).xyz;
    eye_normal = mat3(eye_from_local) * normal;
    inner_normal = eye_normal;
    face_index = face;
}
