// Both have face k at column k % width, row k / width.
uniform sampler2D face_colors;  // linear RGBA
uniform sampler2D face_marks;   // what is mixed into the picture of the face: linear RGB, and how much of it

ivec2 place_of_face(int face, int width) {
    return ivec2(face % width, face / width);
}

vec4 color_of_face(int face) {
    return texelFetch(face_colors, place_of_face(face, textureSize(face_colors, 0).x), 0);
}

// The colour of a face's picture, alpha premultiplied, with its mark.
vec4 marked(vec4 color, int face) {
    vec4 mark = texelFetch(face_marks, place_of_face(face, textureSize(face_marks, 0).x), 0);
    return vec4(mix(color.rgb, mark.rgb * color.a, mark.a), color.a);
}
