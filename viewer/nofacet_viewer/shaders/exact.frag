#version 330 core
// The exact frame in other colours, from its values at the pixel centres. Row 0 of its textures is the picture's top;
// what is written, before the background and in sRGB, keeps that.
#include "srgb.glsl"
#include "light.glsl"
#include "zebra.glsl"
#include "faces.glsl"
const int LIT = 0, ZEBRA = 1, CURVATURE = 2;
uniform bool perspective;
uniform float slope;              // model units at unit depth (perspective) a pixel
uniform mat3 eye_from_world;
uniform sampler2D frame_color;    // as the frame has it, before the background and in sRGB
uniform isampler2D frame_face;    // -1 on background, less on the caps of section planes
uniform sampler2D frame_normal;   // unit, world, towards the eye
uniform sampler2D frame_coverage;
uniform sampler2D frame_curvature;
uniform sampler2D ramp;
uniform float ramp_end;
uniform vec3 background;          // linear
out vec4 color;

vec3 towards_eye_at(ivec2 pixel, ivec2 size) {
    vec2 from_middle = (vec2(pixel) + 0.5 - 0.5 * vec2(size)) * vec2(slope, -slope);
    return perspective ? -normalize(vec3(from_middle, 1.0)) : vec3(0.0, 0.0, -1.0);
}

float phase_at(ivec2 pixel, ivec2 size) {
    return zebra_phase(eye_from_world * texelFetch(frame_normal, pixel, 0).xyz, towards_eye_at(pixel, size));
}

// How far the stripes' phase changes from this pixel to the next of the same face, the smoother way along each axis.
float phase_width(ivec2 pixel, ivec2 size, int face, float phase) {
    float width = 0.0;
    for (int axis = 0; axis < 2; ++axis) {
        float least = 0.5;
        for (int sign = -1; sign <= 1; sign += 2) {
            ivec2 near = pixel + sign * ivec2(1 - axis, axis);
            if (near != clamp(near, ivec2(0), size - 1) || texelFetch(frame_face, near, 0).r != face) continue;
            least = min(least, abs(phase_at(near, size) - phase));
        }
        width += least;
    }
    return width;
}

// This pixel, or where its centre shows the background a neighbour that does not.
ivec2 nearest_covered(ivec2 pixel, ivec2 size) {
    if (texelFetch(frame_face, pixel, 0).r != -1) return pixel;
    const ivec2 STEPS[8] = ivec2[8](ivec2(-1, 0), ivec2(1, 0), ivec2(0, -1), ivec2(0, 1),
                                    ivec2(-1, -1), ivec2(1, -1), ivec2(-1, 1), ivec2(1, 1));
    for (int k = 0; k < 8; ++k) {
        ivec2 near = clamp(pixel + STEPS[k], ivec2(0), size - 1);
        if (texelFetch(frame_face, near, 0).r != -1) return near;
    }
    return pixel;
}

void main() {
    ivec2 size = textureSize(frame_face, 0);
    ivec2 pixel = ivec2(gl_FragCoord.xy);
    float coverage = texelFetch(frame_coverage, pixel, 0).r;
    color = texelFetch(frame_color, pixel, 0);
    pixel = nearest_covered(pixel, size);
    int face = texelFetch(frame_face, pixel, 0).r;
    if (face < 0 || coverage == 0.0) return;  // a cap, or the background
    vec3 normal = eye_from_world * texelFetch(frame_normal, pixel, 0).xyz, towards_eye = towards_eye_at(pixel, size);
    vec3 rgb;
    if (SHADING == ZEBRA) {
        float phase = phase_at(pixel, size);
        rgb = zebra_color(zebra_white(phase, phase_width(pixel, size, face, phase)));
    } else {
        vec3 base = color_of_face(face).rgb;
        if (SHADING == CURVATURE) {
            float curvature = texelFetch(frame_curvature, pixel, 0).r;
            base = isnan(curvature) ? vec3(0.5) : texture(ramp, vec2(0.5 + 0.5 * curvature / ramp_end, 0.5)).rgb;
        }
        rgb = lit(base, normal, towards_eye);
    }
    color = vec4(srgb(mix(background, rgb, coverage)), 1.0);
}
