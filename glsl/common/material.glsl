// What a material's factors and textures say of a point. For fragment shaders that draw the scene's meshes.
layout(constant_id = 2) const bool BASE_MAP = false;
layout(constant_id = 3) const bool ROUGH_MAP = false;
layout(constant_id = 4) const bool NORMAL_MAP = false;
layout(constant_id = 5) const bool OCCLUSION_MAP = false;
layout(constant_id = 6) const bool ALPHA_MASK = false;
layout(constant_id = 11) const bool TINT = false;      // vertices have colours

layout(location = 5) in vec4 tint;

layout(push_constant, scalar) uniform Push {
    vec4 base_color;
    float roughness;
    float metallic;
    float normal_scale;
    float occlusion_strength;
    float alpha_cutoff;
    float reflectance;     // F0 of the dielectric
    float scatter;         // 1 scatters; -1 has the profile, and its gloss, but this frame scatters nothing; 0 has none
    vec3 emission;         // radiance, linear
    uint profile;          // of several, by which it scatters
} push;

layout(set = 0, binding = 2) uniform sampler2D base_color_map;
layout(set = 0, binding = 3) uniform sampler2D metallic_roughness_map;
layout(set = 0, binding = 4) uniform sampler2D normal_map;
layout(set = 0, binding = 5) uniform sampler2D occlusion_map;

// Linear base colour; alpha is coverage.
vec4 material_base(vec2 uv) {
    vec4 base = BASE_MAP ? push.base_color * texture(base_color_map, uv) : push.base_color;
    return TINT ? base * tint : base;
}

// Perceptual roughness and metallic, 0..1.
vec2 material_rough_metal(vec2 uv) {
    vec2 rm = vec2(push.roughness, push.metallic);
    if (ROUGH_MAP) rm *= texture(metallic_roughness_map, uv).gb;
    return clamp(rm, 0., 1.);
}

float material_occlusion(vec2 uv) {
    return OCCLUSION_MAP ? mix(1., texture(occlusion_map, uv).r, push.occlusion_strength) : 1.;
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
