// unwrap: meshes, laid out by their texture coordinates.
// variants: uv TANGENT=0; tangent TANGENT=1; uv_color COLOR=1 TANGENT=0; tangent_color COLOR=1 TANGENT=1
#version 460
#extension GL_GOOGLE_include_directive : require
#include "common/frame.glsl"
#include "common/sheet.glsl"

layout(location = 0) in vec3 position;
layout(location = 1) in vec3 normal;
layout(location = 2) in vec4 uv;
#if TANGENT
layout(location = 3) in vec4 tangent;
#else
const vec4 tangent = vec4(0.);
#endif
layout(location = 5) in float chart;

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
layout(location = 3) out vec3 view_place;
layout(location = 4) out float out_chart;
layout(location = 6) out float plane;      // of the vertex: its normal times its place

void main() {
    gl_Position = vec4(sheet_place(uv.xy, 1.) * 2. - 1., 0., 1.);
    mat3 rotation = mat3(frame.view_from_world);
    view_normal = rotation * normal;
    view_place = (frame.view_from_world * vec4(position, 1.)).xyz;
    plane = dot(view_normal, view_place);
    out_uv = uv;
    tint = color;
    view_tangent = vec4(rotation * tangent.xyz, tangent.w);
    out_chart = chart;
}
