// gbuffer: meshes -> depth, viewz, normal, albedo, material, bumped.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "common/frame.glsl"

layout(constant_id = 0) const bool HAS_UV = false;
layout(constant_id = 1) const bool HAS_TANGENT = false;

layout(location = 0) in vec3 position;
layout(location = 1) in vec3 normal;
layout(location = 2) in vec2 uv;
layout(location = 3) in vec4 tangent;

layout(location = 0) out vec3 view_normal;
layout(location = 1) out vec2 out_uv;
layout(location = 2) out vec4 view_tangent;
layout(location = 3) out float view_distance;

void main() {
    gl_Position = frame.clip_from_world * vec4(position, 1.);
    mat3 rotation = mat3(frame.view_from_world);
    view_normal = rotation * normal;
    view_distance = -(frame.view_from_world * vec4(position, 1.)).z;
    out_uv = HAS_UV ? uv : vec2(0.);
    view_tangent = HAS_TANGENT ? vec4(rotation * tangent.xyz, tangent.w) : vec4(0.);
}
