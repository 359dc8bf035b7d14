// unwrap: meshes, shadow -> sheet0, stretch. Irradiance over texture coordinates (d'Eon, Luebke & Enderton 2007).
//
// sheet0   RGBA16F   in units of light_unit: sum over lights of E max(0, n.l) visibility, plus the sky's, times the square root of the surface's colour
//                    with PRE; a: number of the chart
// stretch  R32_UINT  2 halves: texels a mm of the surface along u and along v
#version 460
#extension GL_GOOGLE_include_directive : require
#include "common/frame.glsl"
#include "common/material.glsl"
#include "common/rise.glsl"
#include "common/lights.glsl"
#include "common/shadow.glsl"
#include "common/environment.glsl"

layout(constant_id = 0) const bool SHADOWS = true;
layout(constant_id = 1) const bool AMBIENT = true;
layout(constant_id = 7) const bool PRE = false;

layout(location = 0) in vec3 view_normal;
layout(location = 1) in vec4 uv;
layout(location = 2) in vec4 view_tangent;
layout(location = 3) in vec3 view_place;
layout(location = 4) in float chart;
layout(location = 6) in float plane;

layout(location = 0) out vec4 sheet;
layout(location = 1) out uint stretch;

const float PI = 3.14159265358979;

void main() {
    vec2 mm = vec2(length(dFdx(view_place)), length(dFdy(view_place)));
    vec4 base = material_base(uv);
    vec3 n = material_normal(view_normal, true);
    vec3 facet = facet_normal(view_place, n, n), p = view_place + facet * rise(view_normal, plane, view_place, true);
    n = material_shading_normal(n, view_tangent, uv, true);
    float occlusion = material_occlusion(uv);
    bool bare = SCATTER_MAP && material_scatter(uv) == 0.;
    if (ALPHA_MASK && base.a < push.alpha_cutoff || bare) discard;
    vec3 sum = vec3(0.);
    for (int i = 0; i < LIGHTS; ++i) {
        Light light = lights.light[i];
        vec3 arriving;
        vec3 l = light_arrives(light, p, arriving);
        if (SHADOWS && light.layer >= 0) arriving *= shadow_visibility(light, p, facet, l, mat3(frame.world_from_view), 0.);
        sum += max(dot(n, l), 0.) * arriving;
    }
    if (AMBIENT) sum += PI * (frame.ambient_mean + frame.ambient_slope * dot(n, frame.up)) * occlusion;
    if (SKY) sum += PI * sky_light(n) * occlusion;
    if (PRE) sum *= sqrt(clamp(base.rgb, 0., 1.));
    sheet = vec4(min(sum / frame.light_unit, vec3(65504.)), round(chart));
    stretch = packHalf2x16(min(1. / max(mm, vec2(1e-9)), vec2(65504.)));
}
