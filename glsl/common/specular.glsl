// GGX specular (Walter et al. 2007) with the height-correlated Smith term (Heitz 2014) and Schlick's Fresnel.
const float PI = 3.14159265358979;

// Returns f_r n.l; the caller multiplies by irradiance at normal incidence.
vec3 specular_ggx(vec3 n, vec3 v, vec3 l, float roughness, vec3 f0) {
    float alpha = max(roughness * roughness, 2e-3), a2 = alpha * alpha;
    vec3 h = normalize(v + l);
    float nl = dot(n, l), nv = max(dot(n, v), 1e-4), nh = clamp(dot(n, h), 0., 1.), vh = clamp(dot(v, h), 0., 1.);
    if (nl <= 0.) return vec3(0.);
    float d = nh * nh * (a2 - 1.) + 1.;
    float distribution = a2 / (PI * d * d);
    float visibility = .5 / (nl * sqrt(nv * nv * (1. - a2) + a2) + nv * sqrt(nl * nl * (1. - a2) + a2));
    float m = 1. - vh, m2 = m * m;
    vec3 fresnel = f0 + (1. - f0) * (m2 * m2 * m);
    return distribution * visibility * nl * fresnel;
}

// Directional albedo of the same lobe, fitted (Karis 2014): what specular takes, diffuse does not get.
vec3 specular_albedo(float nv, float roughness, vec3 f0) {
    vec4 r = roughness * vec4(-1., -.0275, -.572, .022) + vec4(1., .0425, 1.04, -.04);
    float a = min(r.x * r.x, exp2(-9.28 * nv)) * r.x + r.y;
    vec2 ab = vec2(-1.04, 1.04) * a + r.zw;
    return clamp(f0 * ab.x + ab.y, 0., 1.);
}
