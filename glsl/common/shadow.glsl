// Visibility of a light: bilinear percentage-closer filter in one gather (Reeves et al. 1987). Reversed depth: nearer is
// greater. A 3 x 3 filter in four gathers needs a lift of .5 + 1.5 s texels, and was no nearer to truth for it (.0118 against
// .0109 rms, moments on the head).
layout(set = 0, binding = 29) uniform sampler2DArray shadow;

// Layer of a point light's cube: +x -x +y -y +z -z.
int shadow_face(vec3 d) {
    vec3 a = abs(d);
    if (a.x >= a.y && a.x >= a.z) return d.x >= 0. ? 0 : 1;
    if (a.y >= a.z) return d.y >= 0. ? 2 : 3;
    return d.z >= 0. ? 4 : 5;
}

// Lit share of the four texels around a point, view space, mm.
float shadow_fetch(int layer, vec3 p) {
    vec4 q = lights.shadow_from_view[layer] * vec4(p, 1.);
    vec3 s = q.xyz;
    if (!ALL_DIRECTIONAL) {
        if (q.w <= 0.) return 1.;
        s /= q.w;
    }
    vec2 size = vec2(textureSize(shadow, 0).xy);
    vec2 at = (s.xy * .5 + .5) * size - .5;
    vec2 base = floor(at), f = at - base;
    // A gather returns x (0,1), y (1,1), z (1,0), w (0,0).
    vec4 a = vec4(lessThanEqual(textureGather(shadow, vec3((base + 1.) / size, float(layer))), vec4(s.z)));
    return mix(mix(a.w, a.z, f.x), mix(a.x, a.y, f.x), f.y);
}

float shadow_visibility(Light light, vec3 position, vec3 normal, vec3 l, mat3 world_from_view) {
    int layer = light.layer;
    float texel = light.texel_mm;
    if (!ALL_DIRECTIONAL && light.kind != LIGHT_DIRECTIONAL) {
        vec3 d = position - light.position;
        texel *= length(d);
        if (light.kind == LIGHT_POINT) layer += shadow_face(world_from_view * d);
    }
    // The receiver is lifted along its own normal by what the filter's footprint can rise on a slope: no constant bias, so
    // thin parts keep their contact.
    float c = clamp(dot(normal, l), 0., 1.);
    vec3 p = position + normal * (texel * (.3 + .8 * sqrt(1. - c * c)));
    return shadow_fetch(layer, p);
}
