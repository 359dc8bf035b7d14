// sparse: shadow, inert -> sparse. Every STEPth texel of the shadow maps of the lights with a slot, for `translucent`.
//
// A gathered Gaussian is wide beside a texel, and its offsets lie far apart: each would fetch a line of memory of its own. One
// texel in so many fits a cache. Taken as they are, not averaged: a depth between two surfaces is none.
#version 460
#extension GL_GOOGLE_include_directive : require
layout(local_size_x = 8, local_size_y = 8) in;

layout(constant_id = 0) const int STEP = 8;             // even
layout(constant_id = 1) const bool INERT = false;       // some of what casts shadows does not scatter

layout(set = 0, binding = 0, r32f) uniform writeonly image2DArray sparse;
layout(set = 0, binding = 29) uniform sampler2DArray shadow;
layout(set = 0, binding = 1) uniform sampler2DArray inert;

void main() {
    ivec2 at = ivec2(gl_GlobalInvocationID.xy);
    ivec3 size = imageSize(sparse);
    int layer = at.y / size.y;
    at.y -= layer * size.y;
    if (at.x >= size.x || layer >= size.z) return;
    float depth = texelFetch(shadow, ivec3(at * STEP + STEP / 2, layer), 0).r;
    // The raster steps otherwise here, and the same surface may differ in its last bits: 1e-5 of what the light sees in depth.
    if (INERT && texelFetch(inert, ivec3(at, layer), 0).r > depth - 1e-5) depth = 0.;
    imageStore(sparse, ivec3(at, layer), vec4(depth));
}
