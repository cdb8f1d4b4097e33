// Reflection stripes: where the mirror image of level strip lights is. A kink in the stripes is a kink in the normal.
const float ZEBRA_STRIPES = 12.0;  // between straight up and straight down

// Share of white, 0 or 1, for a unit normal in eye space; `width`: how far the value changes across a pixel.
float zebra_phase(vec3 normal, vec3 towards_eye) {
    vec3 mirrored = reflect(-towards_eye, normal);
    return ZEBRA_STRIPES * acos(clamp(mirrored.y, -1.0, 1.0)) / 3.14159265358979;
}

float zebra_white(float phase, float width) {
    float distance = abs(fract(phase) - 0.5) - 0.25;  // from the stripe's border, negative inside
    return clamp(0.5 - distance / max(width, 1e-6), 0.0, 1.0);
}

vec3 zebra_color(float white) {
    return mix(vec3(0.01), vec3(0.9), white);
}
