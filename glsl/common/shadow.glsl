// Visibility of a light: bilinear percentage-closer filter in one gather (Reeves et al. 1987). Reversed depth: nearer is greater.
layout(set = 0, binding = 29) uniform sampler2DArray shadow;
layout(constant_id = 34) const bool SOFT = false; // light scatters farther than texels are wide, where nothing blurs it

// A variance that a softer filter adds, squared texels: less is not worth three more fetches, more is not within four texels.
const float SOFT_FROM = 1. / 16., SOFT_TO = 1. / 3.;

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

// Three points `step` texels apart, exact to the fifth degree (Gauss-Hermite), each bilinear: weights of texels so far away along an axis.
vec4 shadow_weights(vec4 away, float step) {
    vec4 middle = max(1. - abs(away), 0.), sides = max(1. - abs(away - step), 0.) + max(1. - abs(away + step), 0.);
    return middle * (2. / 3.) + sides * (1. / 6.);
}

// Three by three such points, in four gathers.
float shadow_soft_share(int layer, vec4 q, vec2 slope, float step) {
    vec3 s = q.xyz / (ALL_DIRECTIONAL ? 1. : q.w);
    vec2 size = vec2(textureSize(shadow, 0).xy);
    vec2 at = (s.xy * .5 + .5) * size - .5;
    vec2 base = floor(at), f = at - base;
    vec4 x = vec4(-1., 0., 1., 2.) - f.x, y = vec4(-1., 0., 1., 2.) - f.y;
    vec4 wx = shadow_weights(x, step), wy = shadow_weights(y, step);
    float sum = 0.;
    for (int k = 0; k < 4; ++k) {
        bvec2 far = bvec2((k & 1) != 0, k > 1);
        vec2 xs = far.x ? x.zw : x.xy, ys = far.y ? y.zw : y.xy, by_x = far.x ? wx.zw : wx.xy, by_y = far.y ? wy.zw : wy.xy;
        vec4 found = textureGather(shadow, vec3((base + 2. * vec2(far)) / size, float(layer)));
        vec4 open = vec4(lessThanEqual(found, s.z + slope.x * xs.xyyx + slope.y * ys.yyxx));
        sum += dot(open, by_x.xyyx * by_y.yyxx);
    }
    return sum;
}

// The lit share of four texels, of a surface that faces the light.
float shadow_fetch(int layer, vec3 p) {
    vec4 q = lights.shadow_from_view[layer] * vec4(p, 1.);
    return !ALL_DIRECTIONAL && q.w <= 0. ? 1. : shadow_share(layer, q, vec2(0.));
}

// `normal` is the surface's own where the caller has it. Each texel is held against the tangent plane where the texel is, so that a
// plane never shades itself. Left to an offset towards the light is what surfaces bend within a texel, which grows with the square of
// the slope. A lift along the normal, large enough for the slope itself, moved the edges of shadows by a pixel. What vertex
// normals mean above coarse triangles is `position`'s already (rise.glsl).
// `narrow`, mm, is how far light scatters in what is too narrow for a level: so soft is the edge of a shadow, where a filter of one texel is
// harder. 0: it does not scatter.
float shadow_visibility(Light light, vec3 position, vec3 normal, vec3 l, mat3 world_from_view, float narrow) {
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
    vec2 size = vec2(textureSize(shadow, 0).xy), slope = -plane.xy / plane.z * 2. / size;
    // Variance in texels beyond that of the bilinear filter, 1/6 an axis.
    float more = SOFT ? min(narrow * narrow / (texel * texel) - 1. / 6., SOFT_TO) : 0.;
    return more < SOFT_FROM ? shadow_share(layer, q, slope) : shadow_soft_share(layer, q, slope, sqrt(3. * more));
}
