// tonemap: exr -> ldr. Only where something was drawn over the lit picture; else lighting maps its own pixel.
//
// exr holds premultiplied colour, ldr does not: coverage is taken out before the curve.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "common/tonemap.glsl"

layout(local_size_x = 8, local_size_y = 8) in;
layout(constant_id = 14) const int CURVE = 0;            // 0 Khronos PBR Neutral, 1 sRGB alone

layout(set = 0, binding = 2, rgba32f) uniform readonly image2D exr;
layout(set = 0, binding = 3, rgba8) uniform writeonly image2D ldr;

void main() {
    ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
    if (any(greaterThanEqual(pixel, imageSize(ldr)))) return;
    vec4 x = imageLoad(exr, pixel);
    // Light without a surface behind it covers what it outshines.
    float a = clamp(x.a, 0., 1.);
    vec3 color = a > 0. ? x.rgb / a : vec3(0.);
    color = srgb(clamp(CURVE == 0 ? neutral(color) : color, 0., 1.));
    imageStore(ldr, pixel, vec4(color, a));
}
