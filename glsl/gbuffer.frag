// gbuffer: meshes -> depth, viewz, normal, albedo, material, bumped.
//
// viewz    R32F      distance along the view axis, mm; negated where the surface scatters; lowest three bits: its profile, if there are several
// normal   R32_UINT  interpolated normal, without the normal map: curvature is measured on it
// albedo   RGBA8     rgb square root of linear base colour (more steps in the dark), a share that scatters where the material has the profile
// material RGBA8     r roughness, g metallic, b occlusion, a square root of F0
// bumped   R32_UINT  normal with the normal map, only where the scene has one
// mass     RGB10_A2  half the reciprocal of the mass of each gathered level, only where light is gathered
// facet    R32_UINT  the triangle itself (common/facet_code.glsl), only where shading normals stray from it and shadows fall
// coat     RG32UI    coat, sheen, tint of F0, thickness (common/coat.glsl), only where some material has any of it
// chart    R32_UINT  texture coordinate, 2 x unorm16, only for methods that work over it
// variants: plain BUMPED=4; chart CHART=4 BUMPED=5; mass MASS=4; facet FACET=4 BUMPED=5; chart_facet CHART=4 FACET=5 BUMPED=6; mass_facet MASS=4 FACET=5 BUMPED=6; plain_coat LAYERED=4 BUMPED=5; chart_coat LAYERED=4 CHART=5 BUMPED=6; mass_coat LAYERED=4 MASS=5; facet_coat LAYERED=4 FACET=5 BUMPED=6; chart_facet_coat LAYERED=4 CHART=5 FACET=6 BUMPED=7; mass_facet_coat LAYERED=4 MASS=5 FACET=6 BUMPED=7
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "common/octahedral.glsl"
#if defined(MASS) || defined(FACET)
#include "common/frame.glsl"
#endif

#ifdef LAYERED
#include "common/coat.glsl"
#endif
#include "common/material.glsl"
#include "common/profile_code.glsl"
#ifdef FACET
#include "common/facet_code.glsl"
#include "common/rise.glsl"
#endif

layout(constant_id = 12) const bool SEVERAL = false;   // several profiles scatter

layout(location = 0) in vec3 view_normal;
layout(location = 1) in vec4 uv;
layout(location = 2) in vec4 view_tangent;
layout(location = 3) in float view_distance;
#ifdef FACET
layout(location = 6) in float plane;
#endif

layout(location = 0) out float viewz;
layout(location = 1) out uint normal;
layout(location = 2) out vec4 albedo;
layout(location = 3) out vec4 material;
#ifdef LAYERED
layout(location = LAYERED) out uvec2 coat;
#endif
#ifdef CHART
layout(location = CHART) out uint chart;
#endif
#ifdef BUMPED
layout(location = BUMPED) out uint bumped;
#endif
#ifdef MASS
layout(constant_id = 0) const int FIRST = 0;            // first level that is gathered
layout(constant_id = 1) const int LEVELS = 0;
layout(location = 4) in vec4 kernel_mass;               // of each gathered level, without what a border takes; w: distance to the border, mm
layout(location = MASS) out vec4 mass;
#endif
#ifdef FACET
layout(location = FACET) out uint facet;
#endif

void main() {
    vec4 base = material_base(uv);
    if (ALPHA_MASK && base.a < push.alpha_cutoff) discard;
    vec3 n = material_normal(view_normal, gl_FrontFacing);
    vec3 b = material_shading_normal(n, view_tangent, uv, gl_FrontFacing);
    float scatter = material_scatter(uv), reflectance = material_reflectance(scatter);
#ifdef LAYERED
    Coat over = material_coat(uv, reflectance);
    coat = coat_encode(over, material_thickness(uv));
#endif

    viewz = scatter > 0. ? -view_distance : view_distance;
    if (SEVERAL) viewz = profile_encode(viewz, push.profile);
    normal = octahedral_encode(n);
    albedo = vec4(sqrt(clamp(base.rgb, 0., 1.)), scatter == 0. ? 0. : max(abs(scatter), 1. / 255.));
    material = vec4(material_rough_metal(uv), material_occlusion(uv), sqrt(reflectance));
#ifdef BUMPED
    bumped = octahedral_encode(b);
#endif
#ifdef MASS
    // A Gaussian cut by a straight border (src/skin/mass.rs, beside_border).
    vec3 whole = kernel_mass.rgb;
    for (int k = FIRST; k < LEVELS; ++k) {
        float x = kernel_mass.w * inversesqrt(frame.level[k].w);
        whole[k - FIRST] /= 1. + exp2(-x * (2.30485 + .101797 * x * x));
    }
    mass = vec4(.5 / max(whole, .5), 0.);
#endif
#ifdef FACET
    vec3 p = view_position(ivec2(gl_FragCoord.xy), view_distance);
    float mm = mix(1., view_distance, frame.perspective) / frame.pixels_per_mm;
    facet = facet_encode(facet_normal(p, n, view_direction(p)), rise(view_normal, plane, p, gl_FrontFacing) / mm);
#endif
#ifdef CHART
    chart = packUnorm2x16(uv.xy);
#endif
}
