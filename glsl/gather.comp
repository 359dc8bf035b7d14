// gather: viewz, chart, irradiance, sheets -> scattered. What each pixel's place on the sheets has of every Gaussian, weighted
// per channel; what is narrower than a texel or a pixel is the pixel's own irradiance.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "common/frame.glsl"
#include "common/tiles.glsl"
#include "common/sheet.glsl"
#include "common/light_code.glsl"

layout(constant_id = 0) const int LEVELS = 1;

layout(set = 0, binding = 2, r32f) uniform readonly image2D viewz;
layout(set = 0, binding = 3, r32ui) uniform readonly uimage2D chart;
layout(set = 0, binding = 4, rgba16f) uniform readonly image2D irradiance;
layout(set = 0, binding = 5, rgba16f) uniform writeonly image2D scattered;
layout(set = 0, binding = 6, scalar) readonly buffer KernelBlock { vec4 entry[]; } kernel;
layout(set = 0, binding = 7, rgba16f) uniform readonly image2D sheet1;
layout(set = 0, binding = 8, rgba16f) uniform readonly image2D sheet2;
layout(set = 0, binding = 9, rgba16f) uniform readonly image2D sheet3;
layout(set = 0, binding = 10, rgba16f) uniform readonly image2D sheet4;
layout(set = 0, binding = 11, rgba16f) uniform readonly image2D sheet5;
layout(set = 0, binding = 12, rgba16f) uniform readonly image2D sheet6;

// Bilinear among the four texels that lie on a chart.
#define ADD(i) \
    if (LEVELS >= i) { \
        vec4 light = vec4(0.); \
        for (int k = 0; k < 4; ++k) { \
            vec4 texel = imageLoad(sheet##i, clamp(base + ivec2(k & 1, k >> 1), ivec2(0), size - 1)); \
            if (texel.a > 0.) light += weight[k] * vec4(texel.rgb, 1.); \
        } \
        sum += kernel.entry[i].rgb * (light.a > 0. ? light.rgb / light.a : own); \
    }

void main() {
    ivec2 pixel = tile_pixel();
    if (any(greaterThanEqual(pixel, frame.size))) return;
    if (imageLoad(viewz, pixel).x >= 0.) return;
    vec3 own = imageLoad(irradiance, pixel).rgb, sum = kernel.entry[0].rgb * own;
    ivec2 size = imageSize(sheet1);
    vec2 at = sheet_place(unpackUnorm2x16(imageLoad(chart, pixel).x), float(size.x)) - .5;
    ivec2 base = ivec2(floor(at));
    vec2 f = at - vec2(base);
    float weight[4] = float[]((1. - f.x) * (1. - f.y), f.x * (1. - f.y), (1. - f.x) * f.y, f.x * f.y);
    ADD(1)
    ADD(2)
    ADD(3)
    ADD(4)
    ADD(5)
    ADD(6)
    imageStore(scattered, pixel, light_encode(sum));
}
