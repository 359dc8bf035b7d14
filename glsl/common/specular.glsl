// GGX specular (Walter et al. 2007) with the height-correlated Smith term (Heitz 2014) and Schlick's Fresnel; what microfacets
// reflect to one another is given back by a factor (Turquin 2019). Skin has two lobes. f64 twin: src/skin/specular.rs.
const float PI = 3.14159265358979;

layout(constant_id = 23) const bool TWO_LOBES = false;       // the profile has a second lobe
layout(constant_id = 24) const float LOBE_FIRST = 1.;        // factors on roughness
layout(constant_id = 25) const float LOBE_SECOND = 1.;
layout(constant_id = 26) const float LOBE_MIX = 0.;          // share of the second
layout(constant_id = 27) const float FUZZ = 0.;              // sheen of fine hair over the profile's surfaces, 0..1

// Directional albedo of the lobe is F0 x + y (Karis 2013); axes: square root of n.v, roughness.
layout(set = 0, binding = 26) uniform sampler2D gloss_table;

struct Gloss {
    vec3 f0;
    bool two;
    vec2 roughness;      // of each lobe
    vec3 boost[2];       // single bounce to all bounces, times the lobe's share
    vec3 reflected[2];   // share of a white sky that each lobe reflects
    float fuzz;          // factor on the sheen
    float under;         // share of light that gets through it to the surface
};

void gloss_lobe(inout Gloss g, int lobe, float nv, float roughness, float share) {
    vec2 size = vec2(textureSize(gloss_table, 0));
    vec2 ab = textureLod(gloss_table, (vec2(sqrt(nv), roughness) * (size - 1.) + .5) / size, 0.).xy;
    g.roughness[lobe] = roughness;
    g.boost[lobe] = share * (1. + g.f0 * (1. / (ab.x + ab.y) - 1.));
    g.reflected[lobe] = g.boost[lobe] * (g.f0 * ab.x + ab.y);
}

// Share of a white sky that hair reflects (Estevez & Kulla 2017, alpha 1/2, Neubelt & Pettineo's visibility), fitted.
float fuzz_albedo(float nv) {
    float s = sqrt(nv);
    return .7284 + s * (-.2018 + s * (-1.6271 + s * (1.9159 - .7337 * s)));
}

// f_r n.l of hair: D = 2 sin^2 / pi.
float fuzz_light(float nl, float nv, float nh) {
    return nl > 0. ? .63661977 * (1. - nh * nh) * nl / (4. * max(nl + nv - nl * nv, 1e-4)) : 0.;
}

// `skin`: the profile's lobes and hair apply; nv = n.v, roughness perceptual 0..1.
Gloss gloss_of(bool skin, float nv, float roughness, vec3 f0) {
    Gloss g;
    g.f0 = f0;
    g.two = TWO_LOBES && skin;
    nv = clamp(nv, 0., 1.);
    g.roughness = vec2(roughness);
    g.reflected[1] = vec3(0.);
    gloss_lobe(g, 0, nv, g.two ? min(roughness * LOBE_FIRST, 1.) : roughness, g.two ? 1. - LOBE_MIX : 1.);
    if (g.two) gloss_lobe(g, 1, nv, min(roughness * LOBE_SECOND, 1.), LOBE_MIX);
    g.fuzz = 0.;
    g.under = 1.;
    if (FUZZ > 0. && skin) {
        g.fuzz = FUZZ;
        g.under = 1. - FUZZ * fuzz_albedo(nv);
        for (int i = 0; i < 2; ++i) {
            g.boost[i] *= g.under;
            g.reflected[i] *= g.under;
        }
    }
    return g;
}

// Share of a white sky that is reflected, by hair too: what specular takes, diffuse does not get.
vec3 gloss_albedo(Gloss g) {
    return g.reflected[0] + g.reflected[1] + (1. - g.under);
}

// f_r n.l of a lobe, one bounce, without Fresnel.
float specular_ggx(float nl, float nv, float nh, float roughness) {
    float alpha = max(roughness * roughness, 2e-3), a2 = alpha * alpha;
    float d = nh * nh * (a2 - 1.) + 1.;
    float distribution = a2 / (PI * d * d);
    float visibility = .5 / (nl * sqrt(nv * nv * (1. - a2) + a2) + nv * sqrt(nl * nl * (1. - a2) + a2));
    return distribution * visibility * nl;
}

// f_r n.l; the caller multiplies by irradiance at normal incidence.
vec3 gloss_light(Gloss g, vec3 n, vec3 v, vec3 l) {
    vec3 h = normalize(v + l);
    float nl = dot(n, l), nv = max(dot(n, v), 1e-4), nh = clamp(dot(n, h), 0., 1.), vh = clamp(dot(v, h), 0., 1.);
    if (nl <= 0.) return vec3(0.);
    vec3 lobes = g.boost[0] * specular_ggx(nl, nv, nh, g.roughness[0]);
    if (g.two) lobes += g.boost[1] * specular_ggx(nl, nv, nh, g.roughness[1]);
    float m = 1. - vh, m2 = m * m;
    vec3 reflected = lobes * (g.f0 + (1. - g.f0) * (m2 * m2 * m));
    if (FUZZ > 0.) reflected += g.fuzz * fuzz_light(nl, nv, nh);
    return reflected;
}
