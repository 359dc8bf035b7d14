// gbuffer: meshes -> depth, viewz, normal, albedo, material, bumped.
//
// viewz    R32F      distance along the view axis, mm; negated where the surface scatters
// normal   R32_UINT  interpolated normal, without the normal map: curvature is measured on it
// albedo   RGBA8     rgb square root of linear base colour (more steps in the dark), a scatter mask
// material RGBA8     r roughness, g metallic, b occlusion, a square root of F0
// bumped   R32_UINT  normal with the normal map, only where the scene has one
// chart    R32_UINT  texture coordinate, 2 x unorm16, only for methods that work over it
// variants: plain CHART=0; chart CHART=1
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "common/octahedral.glsl"
#include "common/material.glsl"

layout(location = 0) in vec3 view_normal;
layout(location = 1) in vec2 uv;
layout(location = 2) in vec4 view_tangent;
layout(location = 3) in float view_distance;

layout(location = 0) out float viewz;
layout(location = 1) out uint normal;
layout(location = 2) out vec4 albedo;
layout(location = 3) out vec4 material;
#if CHART
layout(location = 4) out uint chart;
layout(location = 5) out uint bumped;
#else
layout(location = 4) out uint bumped;
#endif

void main() {
    vec4 base = material_base(uv);
    if (ALPHA_MASK && base.a < push.alpha_cutoff) discard;
    vec3 n = material_normal(view_normal, gl_FrontFacing);
    vec3 b = n;
    if (NORMAL_MAP) b = material_bumped(n, view_tangent, texture(normal_map, uv).xyz, gl_FrontFacing);

    viewz = push.scatter > 0. ? -view_distance : view_distance;
    normal = octahedral_encode(n);
    albedo = vec4(sqrt(clamp(base.rgb, 0., 1.)), push.scatter);
    material = vec4(material_rough_metal(uv), material_occlusion(uv), sqrt(push.reflectance));
    bumped = octahedral_encode(b);
#if CHART
    chart = packUnorm2x16(uv);
#endif
}
