// A shadow with a soft edge of known width, and what the profile makes of it (Penner & Borshukov 2011). Needs lights.glsl and
// shadow.glsl. f64 twin of the table: src/skin/penumbra.rs.

// Lit share of a disc around a point: a hard shadow does not tell how far away its edge is, this does, while the point itself
// still says on which side it is. position, normal, l in view space, mm; `bend` the surface's curvature, 1/mm; `radius` of the
// disc, mm, across the light; taps are spread by the golden angle from `turn`. One tap: visibility.
//
// Three things keep a surface from shading itself. Taps follow the tangent plane. They rise from it towards the light, by as
// much as they are away and by what the surface's curvature may. And a point behind the terminator is lifted to the horizon of
// a sphere of its curvature: what the table gives it for light that comes from there, its own body must not take away again,
// while what another body casts on it still arrives.
float shadow_disc(Light light, vec3 position, vec3 normal, vec3 l, float bend, float radius, int taps, float turn, mat3 world_from_view) {
    float c = clamp(dot(normal, l), -1., 1.), s = sqrt(1. - c * c);
    int layer = light.layer;
    float texel = light.texel_mm;
    if (!ALL_DIRECTIONAL && light.kind != LIGHT_DIRECTIONAL) {
        vec3 d = position - light.position;
        texel *= length(d);
        if (light.kind == LIGHT_POINT) layer += shadow_face(world_from_view * d);
    }
    float lift = texel * (.3 + .8 * s);
    if (c < 0.) lift += min((1. / max(s, .1) - 1.) / max(bend, 1e-6), radius);
    vec3 p = position + normal * lift;
    // The plane's slope towards the light is bounded: at the terminator it would be infinite.
    vec3 slope = (normal - c * l) / max(c, .1);
    vec3 x = normalize(abs(l.x) > .7 ? cross(l, vec3(0., 1., 0.)) : cross(l, vec3(1., 0., 0.))), y = cross(l, x);
    float own = shadow_fetch(layer, p), sum = 0.;
    if (taps == 1) return own;
    for (int i = 0; i < taps; ++i) {
        float r = radius * sqrt((float(i) + .5) / float(taps)), a = turn + 2.3999632 * float(i);
        vec3 o = r * (cos(a) * x + sin(a) * y) + (r + .5 * bend * r * r) * l;
        sum += shadow_fetch(layer, p + o - l * dot(slope, o));
    }
    float u = sum / float(taps);
    return own >= .5 ? max(u, 1. - u) : min(u, 1. - u);
}

// Scattered visibility of each channel at a point `u` of the disc of which is lit, on a plane at cosine c to the light. The
// table's rows are that cosine: a penumbra of width w across the light is w / c wide on the surface.
vec3 penumbra_look_up(sampler2D table, float u, float c) {
    vec2 size = vec2(textureSize(table, 0));
    return textureLod(table, (vec2(u, clamp(c, 0., 1.)) * (size - 1.) + .5) / size, 0.).rgb;
}
