// sheets: sheet i - 1, stretch -> sheet i, stretch. Diffusion over texture coordinates by a cascade of Gaussians (d'Eon, Luebke &
// Enderton 2007): each pair of passes widens what the one before it has made by the difference of their variances.
//
// Seven taps, one sigma apart on the surface: as many texels as the stretch says at the centre, interpolated along the axis. With
// FINE 2 there are thirteen, half a sigma apart: a spot that is smaller than a sigma is not seen as a comb.
// Stretch is blurred along with light, as its authors do. A tap counts only where it falls on the same chart, and the sum is
// divided by the weights that did (normalised convolution, Knutsson & Westin 1993): light does not leak to what happens to be
// near in the image, nor darkness from between the charts.
// variants: across DOWN=0; down DOWN=1
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "common/light_code.glsl"

layout(local_size_x = 8, local_size_y = 8) in;
layout(constant_id = 0) const int STEP = 1;              // entry of the kernel
layout(constant_id = 1) const int FINE = 1;              // taps a sigma

layout(set = 0, binding = 2, rgba16f) uniform readonly image2D source;
layout(set = 0, binding = 3, r32ui) uniform readonly uimage2D stretch;
layout(set = 0, binding = 4, rgba16f) uniform writeonly image2D target;
layout(set = 0, binding = 5, r32ui) uniform writeonly uimage2D target_stretch;
// Entry 0: rgb weight of what is narrower than a texel or a pixel. Others: rgb weight, w sigma (mm) of the pair.
layout(set = 0, binding = 6, scalar) readonly buffer KernelBlock { vec4 entry[]; } kernel;

// exp(-i^2 / 8), i half sigma away.
const float TAP[7] = float[](1., .8824969, .60653066, .32465247, .13533528, .043936934, .011108997);

void main() {
    ivec2 at = ivec2(gl_GlobalInvocationID.xy), size = imageSize(source);
    if (any(greaterThanEqual(at, size))) return;
    vec4 centre = imageLoad(source, at);
    uint code = imageLoad(stretch, at).x;
    if (centre.a <= 0.) {
        imageStore(target, at, vec4(0.));
        imageStore(target_stretch, at, uvec4(0u));
        return;
    }
    vec2 own = unpackHalf2x16(code);
    float unit = min(kernel.entry[STEP].w * own[DOWN], float(size[DOWN]));
    vec3 sum = TAP[0] * centre.rgb;
    vec2 widths = TAP[0] * own;
    float weight = TAP[0];
    for (int i = -3 * FINE; i <= 3 * FINE; ++i) {
        if (i == 0) continue;
        float reach = float(i) * unit / float(FINE), low = floor(reach);
        for (int k = 0; k < 2; ++k) {
            int step = int(low) + k;
            float w = TAP[abs(i) * (2 / FINE)] * (k == 0 ? 1. - (reach - low) : reach - low);
            ivec2 tap = at + (DOWN == 1 ? ivec2(0, step) : ivec2(step, 0));
            if (w == 0. || tap[DOWN] < 0 || tap[DOWN] >= size[DOWN]) continue;
            vec4 light = imageLoad(source, tap);
            if (abs(light.a) != centre.a) continue;
            sum += w * light.rgb;
            // Beyond a cut the coordinates run another way.
            widths += w * (light.a > 0. ? unpackHalf2x16(imageLoad(stretch, tap).x) : own);
            weight += w;
        }
    }
    imageStore(target, at, vec4(light_encode(sum / weight).rgb, centre.a));
    imageStore(target_stretch, at, uvec4(packHalf2x16(widths / weight)));
}
