// The light of nofacet's own pictures (src/native/light.h), whose constants come from nofacet.light.
uniform vec3 light_direction;  // towards the key light, in eye space (right, up, forward)
uniform float light_ambient, light_sky, light_facing, light_key, light_gloss, light_gloss_exponent;
uniform vec3 world_up;  // in eye space

// Linear RGB of a face colour at a point with this unit normal, in eye space.
vec3 lit(vec3 color, vec3 normal, vec3 towards_eye) {
    float facing = min(1.0, abs(dot(normal, towards_eye)));
    float key = max(0.0, dot(normal, light_direction));
    float sky = 0.5 + 0.5 * dot(normal, world_up);
    float gloss = max(0.0, dot(normal, normalize(light_direction + towards_eye)));
    float diffuse = light_ambient + light_sky * sky + light_facing * facing + light_key * key;
    return min(vec3(1.0), color * diffuse + light_gloss * pow(gloss, light_gloss_exponent));
}
