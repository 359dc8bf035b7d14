// GGX specular (Walter et al. 2007) with the height-correlated Smith term (Heitz 2014) and Schlick's Fresnel; what microfacets
// reflect to one another is given back by a factor (Turquin 2019). Skin has two lobes. Over it may lie fine hair, the material's
// sheen (Estevez & Kulla 2017), and a clear coat, each taking from what is below. f64 twin: src/skin/specular.rs.
const float PI = 3.14159265358979;

layout(constant_id = 23) const bool TWO_LOBES = false;       // the profile has a second lobe
layout(constant_id = 24) const float LOBE_FIRST = 1.;        // factors on roughness
layout(constant_id = 25) const float LOBE_SECOND = 1.;
layout(constant_id = 26) const float LOBE_MIX = 0.;          // share of the second
layout(constant_id = 27) const float FUZZ = 0.;              // sheen of fine hair over the profile's surfaces, 0..1
layout(constant_id = 28) const bool COATED = false;          // some material has more than plain lobes
layout(constant_id = 32) const bool SPECULAR = true;         // some material reflects light

// Directional albedo of the lobe is F0 x + y (Karis 2013); axes: square root of n.v, roughness.
layout(set = 0, binding = 26) uniform sampler2D gloss_table;
// Directional albedo of sheen; the same axes.
layout(set = 0, binding = 25) uniform sampler2D sheen_table;

struct Gloss {
    vec3 f0;
    float f90;
    bool two;
    vec2 roughness;      // of each lobe
    vec3 boost[2];       // single bounce to all bounces, times the lobe's share
    vec3 reflected[2];   // share of a white sky that each lobe reflects
    float fuzz;          // factor on the hair's sheen
    float under;         // share of light that gets through all that lies over the surface
    vec3 sheen;          // factor on the material's sheen
    float sheen_inverse; // 1 / its alpha
    vec3 sheen_reflected;// share of a white sky that it reflects
    float coat;          // factor on the coat's lobe
    float coat_roughness;
    float coat_reflected;
    vec3 coat_normal;
};

vec2 gloss_table_at(sampler2D table, float nv, float roughness) {
    vec2 size = vec2(textureSize(table, 0));
    return textureLod(table, (vec2(sqrt(nv), roughness) * (size - 1.) + .5) / size, 0.).xy;
}

void gloss_lobe(inout Gloss g, int lobe, float nv, float roughness, float share) {
    vec2 ab = gloss_table_at(gloss_table, nv, roughness);
    g.roughness[lobe] = roughness;
    g.boost[lobe] = share * (1. + g.f0 * (1. / (ab.x + ab.y) - 1.));
    g.reflected[lobe] = g.boost[lobe] * (g.f0 * ab.x + (COATED ? g.f90 * ab.y : ab.y));
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

// F0 of a dielectric's reflectance, a metal's colour, or what lies between.
vec3 gloss_f0(float reflectance, vec3 color, float metallic, Coat coat) {
    return mix(COATED ? reflectance * coat.tint : vec3(reflectance), color, metallic);
}

// `skin`: the profile's lobes and hair apply; nv = n.v, roughness perceptual 0..1. The coat lies along `smooth_n`, not bumped.
Gloss gloss_of(bool skin, float nv, float roughness, float metallic, vec3 f0, Coat coat, vec3 smooth_n, vec3 v) {
    Gloss g;
    g.f0 = f0;
    g.f90 = mix(coat.f90, 1., metallic);
    g.two = TWO_LOBES && skin;
    nv = clamp(nv, 0., 1.);
    g.roughness = vec2(roughness);
    g.reflected[1] = vec3(0.);
    gloss_lobe(g, 0, nv, g.two ? min(roughness * LOBE_FIRST, 1.) : roughness, g.two ? 1. - LOBE_MIX : 1.);
    if (g.two) gloss_lobe(g, 1, nv, min(roughness * LOBE_SECOND, 1.), LOBE_MIX);
    g.fuzz = 0.;
    g.under = 1.;
    if (COATED) {
        float coat_nv = clamp(dot(smooth_n, v), 0., 1.);
        vec2 ab = gloss_table_at(gloss_table, coat_nv, coat.roughness);
        g.coat = coat.share * (1. + .04 * (1. / (ab.x + ab.y) - 1.));
        g.coat_reflected = g.coat * (.04 * ab.x + ab.y);
        g.coat_roughness = coat.roughness;
        g.coat_normal = smooth_n;
        g.under = 1. - g.coat_reflected;
        // A lobe that would reflect more than falls on it is held to that.
        float albedo = gloss_table_at(sheen_table, nv, coat.sheen_roughness).x, held = min(albedo, 1.);
        g.sheen = g.under * coat.sheen * (held / max(albedo, 1e-6));
        g.sheen_inverse = 1. / max(coat.sheen_roughness * coat.sheen_roughness, 1e-2);
        g.sheen_reflected = g.under * coat.sheen * held;
        g.under *= 1. - held * max(max(coat.sheen.r, coat.sheen.g), coat.sheen.b);
    }
    if (FUZZ > 0. && skin) {
        g.fuzz = COATED ? FUZZ * g.under : FUZZ;
        g.under *= 1. - FUZZ * fuzz_albedo(nv);
    }
    if (COATED || FUZZ > 0. && skin) {
        for (int i = 0; i < 2; ++i) {
            g.boost[i] *= g.under;
            g.reflected[i] *= g.under;
        }
    }
    return g;
}

// Share of a white sky that does not get through to where light scatters.
vec3 gloss_taken(Gloss g) {
    return g.reflected[0] + g.reflected[1] + (1. - g.under);
}

// Share of a white sky that is reflected, by what lies over the surface too. Coloured sheen swallows the rest of what it takes.
vec3 gloss_albedo(Gloss g, float nv) {
    if (!COATED) return gloss_taken(g);
    return g.reflected[0] + g.reflected[1] + g.coat_reflected + g.sheen_reflected + (FUZZ > 0. ? g.fuzz * fuzz_albedo(clamp(nv, 0., 1.)) : 0.);
}

// f_r n.l of a lobe, one bounce, without Fresnel.
float specular_ggx(float nl, float nv, float nh, float roughness) {
    float alpha = max(roughness * roughness, 2e-3), a2 = alpha * alpha;
    float d = nh * nh * (a2 - 1.) + 1.;
    float distribution = a2 / (PI * d * d);
    float visibility = .5 / (nl * sqrt(nv * nv * (1. - a2) + a2) + nv * sqrt(nl * nl * (1. - a2) + a2));
    return distribution * visibility * nl;
}

// f_r n.l of sheen: D = (2 + 1/alpha) sin^(1/alpha) / 2 pi, visibility 1 / 4 (n.l + n.v - n.l n.v).
float sheen_light(float nl, float nv, float nh, float inverse) {
    float d = (2. + inverse) * pow(max(1. - nh * nh, 1e-9), .5 * inverse) * .15915494;
    return d * nl / (4. * max(nl + nv - nl * nv, 1e-4));
}

float schlick(float vh) {
    float m = 1. - vh, m2 = m * m;
    return m2 * m2 * m;
}

// f_r n.l; the caller multiplies by irradiance at normal incidence.
vec3 gloss_light(Gloss g, vec3 n, vec3 v, vec3 l) {
    vec3 h = normalize(v + l);
    float nl = dot(n, l), nv = max(dot(n, v), 1e-4), nh = clamp(dot(n, h), 0., 1.), vh = clamp(dot(v, h), 0., 1.);
    vec3 reflected = vec3(0.);
    if (COATED) {
        float cl = dot(g.coat_normal, l), cv = max(dot(g.coat_normal, v), 1e-4), ch = clamp(dot(g.coat_normal, h), 0., 1.);
        if (cl > 0. && g.coat > 0.) reflected += g.coat * (.04 + .96 * schlick(vh)) * specular_ggx(cl, cv, ch, g.coat_roughness);
    }
    if (nl <= 0.) return reflected;
    vec3 lobes = g.boost[0] * specular_ggx(nl, nv, nh, g.roughness[0]);
    if (g.two) lobes += g.boost[1] * specular_ggx(nl, nv, nh, g.roughness[1]);
    reflected += lobes * (g.f0 + ((COATED ? g.f90 : 1.) - g.f0) * schlick(vh));
    if (FUZZ > 0.) reflected += g.fuzz * fuzz_light(nl, nv, nh);
    if (COATED) reflected += g.sheen * sheen_light(nl, nv, nh, g.sheen_inverse);
    return reflected;
}
