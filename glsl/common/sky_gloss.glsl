// What gloss reflects of a sky. After specular.glsl and environment.glsl.
vec3 sky_reflected(Gloss gloss, vec3 n, vec3 v) {
    vec3 mirrored = reflect(-v, n);
    vec3 light = gloss.reflected[0] * sky_seen(mirrored, gloss.roughness[0]);
    if (gloss.two) light += gloss.reflected[1] * sky_seen(mirrored, gloss.roughness[1]);
    if (COATED) {
        light += gloss.sheen_reflected * sky_light(n) + gloss.coat_reflected * sky_seen(reflect(-v, gloss.coat_normal), gloss.coat_roughness);
        if (FUZZ > 0.) light += gloss.fuzz * fuzz_albedo(clamp(dot(n, v), 0., 1.)) * sky_light(n);
    } else if (FUZZ > 0.) light += (1. - gloss.under) * sky_light(n);
    return light;
}
