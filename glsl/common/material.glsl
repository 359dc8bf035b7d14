// What a material's factors and textures say of a point. For fragment shaders that draw the scene's meshes. LAYERED: with what its
// gloss has beside roughness (common/coat.glsl), and its thickness.
layout(constant_id = 2) const bool BASE_MAP = false;
layout(constant_id = 3) const bool ROUGH_MAP = false;
layout(constant_id = 4) const bool NORMAL_MAP = false;
layout(constant_id = 5) const bool OCCLUSION_MAP = false;
layout(constant_id = 6) const bool ALPHA_MASK = false;
layout(constant_id = 11) const bool TINT = false;      // vertices have colours
layout(constant_id = 13) const int SECOND = 0;         // a bit for each texture that reads the second coordinates
layout(constant_id = 14) const bool SCATTER_MAP = false;

layout(location = 5) in vec4 tint;

layout(push_constant, scalar) uniform Push {
    vec4 base_color;
    float roughness;
    float metallic;
    float normal_scale;
    float occlusion_strength;
    float alpha_cutoff;
    float reflectance;     // F0 of the dielectric
    float bare;            // the same where its mask says that it does not scatter
    float scatter;         // share that scatters, 0..1; -1 has the profile, and its gloss, but this frame scatters nothing; 0 has none
    vec3 emission;         // radiance, linear
    float thickness;       // 0..1 of the frame's thickest, under the surface; 0: not known
    vec3 sheen;            // colour, linear
    float sheen_roughness;
    vec3 specular_tint;    // factor on F0
    float specular;        // factor on all of the dielectric's gloss
    float coat;            // share of the surface
    float coat_roughness;
    uint profile;          // of several, by which it scatters
} push;

layout(set = 0, binding = 2) uniform sampler2D base_color_map;
layout(set = 0, binding = 3) uniform sampler2D metallic_roughness_map;
layout(set = 0, binding = 4) uniform sampler2D normal_map;
layout(set = 0, binding = 5) uniform sampler2D occlusion_map;
layout(set = 0, binding = 7) uniform sampler2D scatter_map;

// The coordinates that a texture reads, of the two sets in uv; slots as in src/scene/material.rs, MAPS.
vec2 slot_uv(vec4 uv, int slot) {
    return (SECOND >> slot & 1) != 0 ? uv.zw : uv.xy;
}

// Linear base colour; alpha is coverage.
vec4 material_base(vec4 uv) {
    vec4 base = BASE_MAP ? push.base_color * texture(base_color_map, slot_uv(uv, 0)) : push.base_color;
    return TINT ? base * tint : base;
}

// Perceptual roughness and metallic, 0..1.
vec2 material_rough_metal(vec4 uv) {
    vec2 rm = vec2(push.roughness, push.metallic);
    if (ROUGH_MAP) rm *= texture(metallic_roughness_map, slot_uv(uv, 1)).gb;
    return clamp(rm, 0., 1.);
}

float material_occlusion(vec4 uv) {
    return OCCLUSION_MAP ? mix(1., texture(occlusion_map, slot_uv(uv, 3)).r, push.occlusion_strength) : 1.;
}

// As push.scatter, of the point.
float material_scatter(vec4 uv) {
    return SCATTER_MAP ? push.scatter * texture(scatter_map, slot_uv(uv, 5)).a : push.scatter;
}

// F0 of the dielectric, without tint; scatter: the point's.
float material_reflectance(float scatter) {
    return SCATTER_MAP && scatter == 0. ? push.bare : push.reflectance;
}

// The interpolated normal, unit, turned to the viewer. One of opposite ends can vanish; any unit vector is better than a NaN.
vec3 material_normal(vec3 interpolated, bool front) {
    float square = dot(interpolated, interpolated);
    vec3 n = square > 0. ? interpolated * inversesqrt(square) : vec3(0., 0., 1.);
    return front ? n : -n;
}

// n bent by a texel of the normal map (0..1), in the frame that the interpolated tangent spans.
vec3 material_bumped(vec3 n, vec4 tangent, vec3 texel, bool front) {
    vec3 m = texel * 2. - 1.;
    m.xy *= push.normal_scale;
    vec3 t = tangent.xyz - n * dot(n, tangent.xyz);
    float tt = dot(t, t);
    if (tt <= 0.) return n;
    t *= inversesqrt(tt);
    vec3 s = cross(n, t) * (front ? tangent.w : -tangent.w);
    return normalize(t * m.x + s * m.y + n * max(m.z, 1e-3));
}

// n bent by the normal map, where there is one.
vec3 material_shading_normal(vec3 n, vec4 tangent, vec4 uv, bool front) {
    return NORMAL_MAP ? material_bumped(n, tangent, texture(normal_map, slot_uv(uv, 2)).xyz, front) : n;
}

#ifdef LAYERED
layout(constant_id = 15) const bool COAT_MAP = false;
layout(constant_id = 16) const bool COAT_ROUGH_MAP = false;
layout(constant_id = 17) const bool SHEEN_MAP = false;
layout(constant_id = 18) const bool SHEEN_ROUGH_MAP = false;
layout(constant_id = 19) const bool SPECULAR_MAP = false;
layout(constant_id = 29) const bool SPECULAR_COLOR_MAP = false;
layout(constant_id = 30) const bool THICKNESS_MAP = false;

layout(set = 0, binding = 8) uniform sampler2D thickness_map;
layout(set = 0, binding = 9) uniform sampler2D coat_map;
layout(set = 0, binding = 10) uniform sampler2D coat_roughness_map;
layout(set = 0, binding = 11) uniform sampler2D sheen_map;
layout(set = 0, binding = 12) uniform sampler2D sheen_roughness_map;
layout(set = 0, binding = 13) uniform sampler2D specular_map;
layout(set = 0, binding = 14) uniform sampler2D specular_color_map;

// What lies over the surface; reflectance: F0 of the dielectric in, with the tint's brightest channel out.
Coat material_coat(vec4 uv, inout float reflectance) {
    Coat c;
    c.share = COAT_MAP ? push.coat * texture(coat_map, slot_uv(uv, 7)).r : push.coat;
    c.roughness = COAT_ROUGH_MAP ? push.coat_roughness * texture(coat_roughness_map, slot_uv(uv, 8)).g : push.coat_roughness;
    c.sheen = SHEEN_MAP ? push.sheen * texture(sheen_map, slot_uv(uv, 9)).rgb : push.sheen;
    c.sheen_roughness = SHEEN_ROUGH_MAP ? push.sheen_roughness * texture(sheen_roughness_map, slot_uv(uv, 10)).a : push.sheen_roughness;
    c.f90 = SPECULAR_MAP ? push.specular * texture(specular_map, slot_uv(uv, 11)).a : push.specular;
    vec3 tinted = SPECULAR_COLOR_MAP ? push.specular_tint * texture(specular_color_map, slot_uv(uv, 12)).rgb : push.specular_tint;
    tinted = min(reflectance * tinted, 1.);
    float most = max(max(tinted.r, tinted.g), tinted.b);
    c.tint = most > 0. ? tinted / most : vec3(1.);
    reflectance = most * c.f90;
    return c;
}

// 0..1 of the frame's thickest; 0: not known.
float material_thickness(vec4 uv) {
    return THICKNESS_MAP ? push.thickness * texture(thickness_map, slot_uv(uv, 6)).g : push.thickness;
}
#endif
