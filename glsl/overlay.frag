// overlay: meshes, shadow -> exr. What light that scatters has no part in, drawn over the lit picture: emission (added), unlit
// materials (instead of what is there), and blended ones, back to front, lit by themselves.
//
// The target holds premultiplied colour: out = src + (1 - src.a) dst serves all three, with src.a 0, 1 and coverage.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "common/frame.glsl"
#define LAYERED
#include "common/coat.glsl"
#include "common/material.glsl"
#include "common/rise.glsl"
#include "common/lights.glsl"
#include "common/shadow.glsl"
#include "common/specular.glsl"
#include "common/environment.glsl"
#include "common/sky_gloss.glsl"

layout(constant_id = 0) const bool UNLIT = false;
layout(constant_id = 1) const bool BLEND = false;
layout(constant_id = 7) const bool EMISSION_MAP = false;
layout(constant_id = 8) const bool SHADOWS = true;
layout(constant_id = 9) const bool AMBIENT = true;

layout(set = 0, binding = 6) uniform sampler2D emission_map;

layout(location = 0) in vec3 view_normal;
layout(location = 1) in vec4 uv;
layout(location = 2) in vec4 view_tangent;
layout(location = 3) in float view_distance;
layout(location = 6) in float plane;

layout(location = 0) out vec4 picture;

// Diffuse and specular radiance, one bounce, Lambert's for the diffuse.
vec3 lit(vec3 color) {
    vec3 smooth_n = material_normal(view_normal, gl_FrontFacing);
    vec3 n = material_shading_normal(smooth_n, view_tangent, uv, gl_FrontFacing);
    vec2 rm = material_rough_metal(uv);
    vec3 p = view_position(ivec2(gl_FragCoord.xy), view_distance), v = view_direction(p);
    vec3 facet = facet_normal(p, smooth_n, v), from = p + facet * rise(view_normal, plane, p, gl_FrontFacing);
    float scatter = material_scatter(uv), reflectance = material_reflectance(scatter);
    Coat over = coat_none();
    if (COATED) over = material_coat(uv, reflectance);
    vec3 f0 = gloss_f0(reflectance, color, rm.y, over);
    Gloss gloss = gloss_of(scatter != 0., dot(n, v), rm.x, rm.y, f0, over, smooth_n, v);
    vec3 taken = gloss_taken(gloss);
    vec3 arriving = vec3(0.), reflected = vec3(0.);
    for (int i = 0; i < LIGHTS; ++i) {
        Light light = lights.light[i];
        vec3 irradiance;
        vec3 l = light_arrives(light, p, irradiance);
        if (SHADOWS && light.layer >= 0) irradiance *= shadow_visibility(light, from, facet, l, mat3(frame.world_from_view), 0.);
        arriving += max(dot(n, l), 0.) * irradiance;
        reflected += gloss_light(gloss, n, v, l) * irradiance;
    }
    vec3 kept = (1. - rm.y) * (1. - taken) * color;
    vec3 radiance = kept * arriving / PI + reflected;
    if (AMBIENT) {
        vec3 sky = (frame.ambient_mean + frame.ambient_slope * dot(n, frame.up)) * material_occlusion(uv);
        radiance += (kept + gloss_albedo(gloss, dot(n, v))) * sky;
    }
    if (SKY) radiance += (kept * sky_light(n) + sky_reflected(gloss, n, v)) * material_occlusion(uv);
    return radiance;
}

void main() {
    vec4 base = material_base(uv);
    if (ALPHA_MASK && base.a < push.alpha_cutoff) discard;
    vec3 color = clamp(base.rgb, 0., 1.);
    float coverage = BLEND ? clamp(base.a, 0., 1.) : UNLIT ? 1. : 0.;
    vec3 radiance = push.emission;
    if (EMISSION_MAP) radiance *= texture(emission_map, slot_uv(uv, 4)).rgb;
    if (UNLIT) radiance = color;
    else if (BLEND) radiance += lit(color);
    picture = vec4(radiance * frame.exposure * (BLEND ? coverage : 1.), coverage);
}
