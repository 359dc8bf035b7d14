// layer: viewz -> viewz of one profile of several.
//
// What scatters by another profile does not scatter here: whoever blurs passes it by, as he does what never scatters, and
// nothing bleeds. The profile's number stands in the lowest bits of viewz (gbuffer.frag).
#version 460
#extension GL_GOOGLE_include_directive : require
#include "common/frame.glsl"
#include "common/profile_code.glsl"
layout(local_size_x = 8, local_size_y = 8) in;

layout(constant_id = 0) const uint PROFILE = 0;

layout(set = 0, binding = 1, r32f) uniform readonly image2D viewz;
layout(set = 0, binding = 2, r32f) uniform writeonly image2D own;

void main() {
    ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
    if (any(greaterThanEqual(pixel, frame.size))) return;
    float z = imageLoad(viewz, pixel).x;
    imageStore(own, pixel, vec4(profile_of(z) == PROFILE ? z : abs(z), 0., 0., 0.));
}
