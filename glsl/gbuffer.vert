// gbuffer and forward: meshes, in view space, for their fragment shaders.
// variants: plain UV=0 TANGENT=0; uv UV=1 TANGENT=0; tangent UV=1 TANGENT=1; plain_bend UV=0 TANGENT=0 BEND=1; uv_bend UV=1 TANGENT=0 BEND=1; tangent_bend UV=1 TANGENT=1 BEND=1
#version 460
#extension GL_GOOGLE_include_directive : require
#include "common/frame.glsl"

layout(location = 0) in vec3 position;
layout(location = 1) in vec3 normal;
// A stream that the scene does not need is not fetched.
#if UV
layout(location = 2) in vec2 uv;
#else
const vec2 uv = vec2(0.);
#endif
#if TANGENT
layout(location = 3) in vec4 tangent;
#else
const vec4 tangent = vec4(0.);
#endif

// Unsigned curvature of the mesh, 1/mm, for `forward`.
#ifdef BEND
layout(location = 4) in float bend;
layout(location = 4) out float out_bend;
#endif

layout(location = 0) out vec3 view_normal;
layout(location = 1) out vec2 out_uv;
layout(location = 2) out vec4 view_tangent;
layout(location = 3) out float view_distance;

void main() {
    gl_Position = frame.clip_from_world * vec4(position, 1.);
    mat3 rotation = mat3(frame.view_from_world);
    view_normal = rotation * normal;
    view_distance = -(frame.view_from_world * vec4(position, 1.)).z;
    out_uv = uv;
#ifdef BEND
    out_bend = bend;
#endif
    view_tangent = vec4(rotation * tangent.xyz, tangent.w);
}
