// Light that enters a thin part on its far side, as a slab between two planes lets it through: of what falls on the back f, the
// profile over the thickness, arrives in front, and front and back weigh 1 + f. Needs thickness.glsl, and GAUSSIANS of the profile
// at FIRST_GAUSSIAN of a `kernel`.

// f of a light that shines on the back. Where it falls on the mesh itself, its shading normal alone turns away, and none comes through.
vec3 let_through(Light light, vec3 position, vec3 n, float stated) {
    float mm = stated, open = 0.;
    if (light.layer >= 0) {
        int layer = shadow_layer(light, position);
        // Lifted off the surface, which is away from the light: what has its back to the light lies in its own shadow.
        float texel = light.texel_mm * (ALL_DIRECTIONAL || light.kind == LIGHT_DIRECTIONAL ? 1. : length(position - light.position));
        open = shadow_fetch(layer, position + n * texel);
        mm = thickness_stated(stated, thickness(light, layer, shadow_place(layer, position), position));
    } else if (stated == 0.) return vec3(0.);
    vec3 through = vec3(0.);
    for (int k = 0; k < GAUSSIANS; ++k) {
        vec4 g = kernel.entry[FIRST_GAUSSIAN + k];
        through += g.rgb * exp2(-.72134752 * min(mm * mm / max(g.w, 1e-30), 160.));
    }
    return through * (1. - open);
}

// The same beside the light that a body of this curvature has anyway, c = n.l < 0: where the normal grazes, a way through says
// nothing of a slab, and counts for less.
vec3 from_behind(Light light, float c, vec3 position, vec3 n, float stated, vec3 lit) {
    vec3 through = let_through(light, position, n, stated) * -c;
    return mix(lit, vec3(-c), through / (1. + through));
}
