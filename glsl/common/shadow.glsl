// Visibility of a light: bilinear percentage-closer filter in one gather (Reeves et al. 1987). Reversed depth: nearer is greater.
layout(set = 0, binding = 29) uniform sampler2DArray shadow;

// Layer of a point light's cube: +x -x +y -y +z -z.
int shadow_face(vec3 d) {
    vec3 a = abs(d);
    if (a.x >= a.y && a.x >= a.z) return d.x >= 0. ? 0 : 1;
    if (a.y >= a.z) return d.y >= 0. ? 2 : 3;
    return d.z >= 0. ? 4 : 5;
}

// Lit share of the four texels around a point, view space, mm, of a surface that is the plane along `slope` there: its depth in
// texture space, a texel on in x and in y.
float shadow_share(int layer, vec4 q, vec2 slope) {
    vec3 s = q.xyz / (ALL_DIRECTIONAL ? 1. : q.w);
    vec2 size = vec2(textureSize(shadow, 0).xy);
    vec2 at = (s.xy * .5 + .5) * size - .5;
    vec2 base = floor(at), f = at - base;
    // A gather returns x (0,1), y (1,1), z (1,0), w (0,0).
    vec4 x = vec4(-f.x, 1. - f.x, 1. - f.x, -f.x), y = vec4(1. - f.y, 1. - f.y, -f.y, -f.y);
    vec4 plane = s.z + slope.x * x + slope.y * y;
    vec4 a = vec4(lessThanEqual(textureGather(shadow, vec3((base + 1.) / size, float(layer))), plane));
    return mix(mix(a.w, a.z, f.x), mix(a.x, a.y, f.x), f.y);
}

// The same of a surface that faces the light.
float shadow_fetch(int layer, vec3 p) {
    vec4 q = lights.shadow_from_view[layer] * vec4(p, 1.);
    return !ALL_DIRECTIONAL && q.w <= 0. ? 1. : shadow_share(layer, q, vec2(0.));
}

// `normal` is the surface's own where the caller has it. Each texel is held against the tangent plane where the texel is, so that a
// plane never shades itself. Left to an offset towards the light is what surfaces bend within a texel, which grows with the square of
// the slope. A lift along the normal, large enough for the slope itself, moved the edges of shadows by a pixel. What vertex
// normals mean above coarse triangles is `position`'s already (rise.glsl).
float shadow_visibility(Light light, vec3 position, vec3 normal, vec3 l, mat3 world_from_view) {
    int layer = light.layer;
    float texel = light.texel_mm;
    if (!ALL_DIRECTIONAL && light.kind != LIGHT_DIRECTIONAL) {
        vec3 d = position - light.position;
        texel *= length(d);
        if (light.kind == LIGHT_POINT) layer += shadow_face(world_from_view * d);
    }
    // No steeper than a tenth.
    float c = dot(normal, l), steep = c < 0. ? min(c, -.1) : max(c, .1);
    vec3 n = normal + l * (steep - c);
    mat4 m = lights.shadow_from_view[layer];
    float bent = min(.3 * texel / (steep * steep), 2. * texel);
    vec4 q = m * vec4(position + l * (.3 * texel + bent), 1.);
    vec3 plane;
    if (ALL_DIRECTIONAL || light.kind == LIGHT_DIRECTIONAL) {
        // Rows are the light's axes, at right angles, longer the more depth or texture a mm is.
        mat3 rows = transpose(mat3(m));
        plane = vec3(dot(rows[0], n) / dot(rows[0], rows[0]), dot(rows[1], n) / dot(rows[1], rows[1]),
                     dot(rows[2], n) / dot(rows[2], rows[2]));
    } else {
        if (q.w <= 0.) return 1.;
        // The plane through the point and two directions at infinity, all three projected.
        vec3 t = cross(n, abs(n.x) < .7 * length(n) ? vec3(1., 0., 0.) : vec3(0., 1., 0.)), u = cross(n, t);
        vec4 a = m * vec4(t, 0.), b = m * vec4(u, 0.);
        plane = vec3(dot(q.yzw, cross(a.yzw, b.yzw)), -dot(q.xzw, cross(a.xzw, b.xzw)), dot(q.xyw, cross(a.xyw, b.xyw)));
    }
    vec2 slope = -plane.xy / plane.z * 2. / vec2(textureSize(shadow, 0).xy);
    return shadow_share(layer, q, slope);
}
