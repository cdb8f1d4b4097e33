uniform sampler2D face_colors;  // linear RGBA of face k at column k % width, row k / width

vec4 color_of_face(int face) {
    int width = textureSize(face_colors, 0).x;
    return texelFetch(face_colors, ivec2(face % width, face / width), 0);
}
