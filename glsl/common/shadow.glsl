// Visibility of a light: 3 x 3 bilinear percentage-closer filter in four gathers. Reversed depth: nearer is greater.
layout(set = 0, binding = 29) uniform sampler2DArray shadow;

// Layer of a point light's cube: +x -x +y -y +z -z.
int shadow_face(vec3 d) {
    vec3 a = abs(d);
    if (a.x >= a.y && a.x >= a.z) return d.x >= 0. ? 0 : 1;
    if (a.y >= a.z) return d.y >= 0. ? 2 : 3;
    return d.z >= 0. ? 4 : 5;
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
    // thin parts keep their contact. Less, .3 + .8 s, and a sphere shades itself; more, 1 + 2.5 s, and light leaks under
    // every eave: rms of a shadowed head .0118 -> .0165.
    float c = clamp(dot(normal, l), 0., 1.);
    vec3 p = position + normal * (texel * (.5 + 1.5 * sqrt(1. - c * c)));
    vec4 q = lights.shadow_from_view[layer] * vec4(p, 1.);
    vec3 s = q.xyz;
    if (!ALL_DIRECTIONAL) {
        if (q.w <= 0.) return 1.;
        s /= q.w;
    }
    vec2 size = vec2(textureSize(shadow, 0).xy);
    vec2 at = (s.xy * .5 + .5) * size - .5;
    vec2 base = floor(at), f = at - base;
    vec3 uv = vec3(base / size, float(layer));
    vec2 step = 2. / size;
    vec4 a = vec4(lessThanEqual(textureGather(shadow, uv), vec4(s.z)));
    vec4 b = vec4(lessThanEqual(textureGather(shadow, uv + vec3(step.x, 0., 0.)), vec4(s.z)));
    vec4 e = vec4(lessThanEqual(textureGather(shadow, uv + vec3(0., step.y, 0.)), vec4(s.z)));
    vec4 g = vec4(lessThanEqual(textureGather(shadow, uv + vec3(step, 0.)), vec4(s.z)));
    // Rows bottom to top of the 4 x 4 block; each row weighs (1 - f, 1, 1, f), and so do the columns.
    vec4 wx = vec4(1. - f.x, 1., 1., f.x);
    vec4 row0 = vec4(a.w, a.z, b.w, b.z), row1 = vec4(a.x, a.y, b.x, b.y);
    vec4 row2 = vec4(e.w, e.z, g.w, g.z), row3 = vec4(e.x, e.y, g.x, g.y);
    return dot(vec4(dot(row0, wx), dot(row1, wx), dot(row2, wx), dot(row3, wx)), vec4(1. - f.y, 1., 1., f.y)) / 9.;
}
