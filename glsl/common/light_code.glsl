// Light in rgba16f targets. A driver may truncate where an image store converts (lavapipe does), and light that goes through
// many passes would darken: what is stored is a half already, rounded to nearest, and at most the largest one.
vec4 light_encode(vec3 light) {
    light = min(light, vec3(65504.));
    return vec4(unpackHalf2x16(packHalf2x16(light.rg)), unpackHalf2x16(packHalf2x16(vec2(light.b, 0.))).x, 1.);
}
