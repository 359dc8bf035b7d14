// gbuffer, forward and overlay: meshes, in view space, for their fragment shaders.
// variants: plain UV=0 TANGENT=0; uv UV=1 TANGENT=0; tangent UV=1 TANGENT=1; plain_bend UV=0 TANGENT=0 EXTRA=float; uv_bend UV=1 TANGENT=0 EXTRA=float; tangent_bend UV=1 TANGENT=1 EXTRA=float; plain_mass UV=0 TANGENT=0 EXTRA=vec4; uv_mass UV=1 TANGENT=0 EXTRA=vec4; tangent_mass UV=1 TANGENT=1 EXTRA=vec4; plain_color COLOR=1 UV=0 TANGENT=0; uv_color COLOR=1 UV=1 TANGENT=0; tangent_color COLOR=1 UV=1 TANGENT=1; plain_bend_color COLOR=1 UV=0 TANGENT=0 EXTRA=float; uv_bend_color COLOR=1 UV=1 TANGENT=0 EXTRA=float; tangent_bend_color COLOR=1 UV=1 TANGENT=1 EXTRA=float; plain_mass_color COLOR=1 UV=0 TANGENT=0 EXTRA=vec4; uv_mass_color COLOR=1 UV=1 TANGENT=0 EXTRA=vec4; tangent_mass_color COLOR=1 UV=1 TANGENT=1 EXTRA=vec4
#version 460
#extension GL_GOOGLE_include_directive : require
#include "common/frame.glsl"

layout(location = 0) in vec3 position;
layout(location = 1) in vec3 normal;
// A stream that the scene does not need is not fetched.
#if UV
layout(location = 2) in vec4 uv;       // two sets; a stream of one leaves the second alone
#else
const vec4 uv = vec4(0.);
#endif
#if TANGENT
layout(location = 3) in vec4 tangent;
#else
const vec4 tangent = vec4(0.);
#endif

// A stream of one stage's own: unsigned curvature of the mesh (1/mm) for `forward`; mass and border for `gbuffer`.
#ifdef EXTRA
layout(location = 4) in EXTRA extra;
layout(location = 4) out EXTRA out_extra;
#endif

// A colour of the vertex, linear; white where none has one.
#ifdef COLOR
layout(location = 6) in vec4 color;
#else
const vec4 color = vec4(1.);
#endif
layout(location = 5) out vec4 tint;

layout(location = 0) out vec3 view_normal;
layout(location = 1) out vec4 out_uv;
layout(location = 2) out vec4 view_tangent;
layout(location = 3) out float view_distance;
layout(location = 6) out float plane;      // of the vertex: its normal times its place

// Drawn again over the picture, a surface must lie where it lay.
invariant gl_Position;

void main() {
    gl_Position = frame.clip_from_world * vec4(position, 1.);
    mat3 rotation = mat3(frame.view_from_world);
    view_normal = rotation * normal;
    vec3 p = (frame.view_from_world * vec4(position, 1.)).xyz;
    view_distance = -p.z;
    plane = dot(view_normal, p);
    out_uv = uv;
    tint = color;
#ifdef EXTRA
    out_extra = extra;
#endif
    view_tangent = vec4(rotation * tangent.xyz, tangent.w);
}
