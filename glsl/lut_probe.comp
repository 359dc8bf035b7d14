// lut_probe: queries, lut -> answers. The tests' probe of common/scattering.glsl; part of no frame.
//
// in   query  x, y: cosine to the light and curvature (1/mm) of a look-up; z, w: mean and spread of a rectified normal variable
// out  answer rgb: the table there; a: rectified(mean, spread)
#version 460
#extension GL_GOOGLE_include_directive : require
#include "common/frame.glsl"
#include "common/scattering.glsl"

layout(local_size_x = 64) in;

layout(set = 0, binding = 2, scalar) readonly buffer QueryBlock { vec4 query[]; } queries;
layout(set = 0, binding = 3, scalar) writeonly buffer AnswerBlock { vec4 answer[]; } answers;
layout(set = 0, binding = 20) uniform sampler2D lut;

void main() {
    uint index = gl_GlobalInvocationID.x;
    if (index >= uint(queries.query.length())) return;
    vec4 q = queries.query[index];
    // As light.comp does.
    vec3 d = vec3(lut_look_up(lut, q.x, q.y, 0.), lut_look_up(lut, q.x, q.y, 1.), lut_look_up(lut, q.x, q.y, 2.));
    answers.answer[index] = vec4(d, rectified(q.z, q.w));
}
