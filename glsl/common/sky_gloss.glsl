// What gloss reflects of a sky. After specular.glsl and environment.glsl.
vec3 sky_reflected(Gloss gloss, vec3 n, vec3 v) {
    vec3 mirrored = reflect(-v, n);
    vec3 light = gloss.reflected[0] * sky_seen(mirrored, gloss.roughness[0]);
    if (gloss.two) light += gloss.reflected[1] * sky_seen(mirrored, gloss.roughness[1]);
    if (FUZZ > 0.) light += (1. - gloss.under) * sky_light(n);
    return light;
}
