#version 330 core
#include "light.glsl"
#include "zebra.glsl"
#include "faces.glsl"
const int LIT = 0, ZEBRA = 1, CURVATURE = 2;
uniform bool perspective;
uniform sampler2D ramp;   // colours of the curvature scale, from -ramp_end to ramp_end
uniform float ramp_end;
in vec3 eye_position;
in vec3 eye_normal;
centroid in vec3 inner_normal;
flat in int face_index;
out vec4 color;  // linear, alpha premultiplied

// Mean of the principal curvatures, positive where the surface bends towards its normal as in a drilled hole, from how
// the interpolated normal turns across the pixel.
float mean_curvature(vec3 normal) {
    vec3 px = dFdx(eye_position), py = dFdy(eye_position), nx = dFdx(normal), ny = dFdy(normal);
    float e = dot(px, px), f = dot(px, py), g = dot(py, py);
    float l = dot(nx, px), m = 0.5 * (dot(nx, py) + dot(ny, px)), n = dot(ny, py);
    return -0.5 * (e * n - 2.0 * f * m + g * l) / max(e * g - f * f, 1e-30);
}

void main() {
    vec4 face_color = color_of_face(face_index);
    vec3 towards_eye = perspective ? -normalize(eye_position) : vec3(0.0, 0.0, -1.0);
    vec3 normal = normalize(gl_FrontFacing ? inner_normal : -inner_normal);
    // Near the outline interpolated normals point away from an eye that sees the triangle: at most edge-on, then.
    normal = normalize(normal - min(0.0, dot(normal, towards_eye)) * towards_eye);
    if (SHADING == ZEBRA) {
        float phase = zebra_phase(normal, towards_eye);
        color = vec4(zebra_color(zebra_white(phase, fwidth(phase))), 1.0);
    } else if (SHADING == CURVATURE) {
        float curvature = mean_curvature(normalize(eye_normal));
        color = vec4(lit(texture(ramp, vec2(0.5 + 0.5 * curvature / ramp_end, 0.5)).rgb, normal, towards_eye), 1.0);
    } else {
        color = vec4(lit(face_color.rgb, normal, towards_eye) * face_color.a, face_color.a);
    }
    color = marked(color, face_index);
}
