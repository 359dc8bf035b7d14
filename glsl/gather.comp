// gather: viewz, normal, chart, irradiance, sheets, shadow, entrance -> scattered. What each pixel's place on the sheets has of
// every Gaussian, weighted per channel; what is narrower than a texel or a pixel is the pixel's own irradiance.
//
// Light through thin parts (modified translucent shadow maps, d'Eon & Luebke 2007): the shadow map knows where light that would
// come to a pixel enters instead, and the widest three Gaussians have what has scattered there. With f = exp(-t^2 / 2v),
//   scattered += w f b sheet(entrance)                           as its authors have it
//   scattered += w f b (sheet(entrance) - sheet) / (1 + f b)     SLAB: divided by what the two sides of a slab weigh
// t     thickness along the light in mm, as deep as it is along the normal where the normal turns away from the light
// b     0 where the entrance is the pixel itself, 1 from six sigma away
// What faces the light has no far side. Several lights see the same one: the strongest counts.
// variants: plain THROUGH=0; through THROUGH=1
#version 460
#extension GL_GOOGLE_include_directive : require
#include "common/frame.glsl"
#include "common/tiles.glsl"
#include "common/sheet.glsl"
#include "common/light_code.glsl"
#if THROUGH
#include "common/octahedral.glsl"
#include "common/lights.glsl"
#include "common/shadow.glsl"
#include "common/thickness.glsl"
#include "common/coat.glsl"
#endif

layout(constant_id = 0) const int LEVELS = 1;
layout(constant_id = 1) const bool SLAB = false;
layout(constant_id = 2) const float THICKEST = 0.;       // mm; 0: no file says how thick its bodies are

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
#if THROUGH
layout(set = 0, binding = 13, r32ui) uniform readonly uimage2D normal;
layout(set = 0, binding = 14, r32ui) uniform readonly uimage2D stretch;
layout(set = 0, binding = 15, r32ui) uniform readonly uimage2DArray entrance;
layout(set = 0, binding = 16, rg32ui) uniform readonly uimage2D coat;
#endif

// Four texels around a place, and their weights.
struct Corner {
    ivec2 base;
    vec4 weight;
};

Corner corner(vec2 uv, ivec2 size) {
    vec2 at = sheet_place(uv, float(size.x)) - .5, base = floor(at), f = at - base;
    return Corner(ivec2(base), vec4((1. - f.x) * (1. - f.y), f.x * (1. - f.y), (1. - f.x) * f.y, f.x * f.y));
}

// Bilinear among the four texels that lie on a chart.
#define SHEET(i) \
    vec3 look_up##i(Corner c, vec3 none) { \
        vec4 light = vec4(0.); \
        for (int k = 0; k < 4; ++k) { \
            vec4 texel = imageLoad(sheet##i, clamp(c.base + ivec2(k & 1, k >> 1), ivec2(0), imageSize(sheet##i) - 1)); \
            if (texel.a > 0.) light += c.weight[k] * vec4(texel.rgb, 1.); \
        } \
        return light.a > 0. ? light.rgb / light.a : none; \
    }
SHEET(1)
SHEET(2)
SHEET(3)
SHEET(4)
SHEET(5)
SHEET(6)

#define EACH(DO) DO(1) DO(2) DO(3) DO(4) DO(5) DO(6)

void main() {
    ivec2 pixel = tile_pixel();
    if (any(greaterThanEqual(pixel, frame.size))) return;
    float z = -imageLoad(viewz, pixel).x;
    if (z <= 0.) return;
    vec3 own = imageLoad(irradiance, pixel).rgb, sum = kernel.entry[0].rgb * own;
    ivec2 size = imageSize(sheet1);
    vec2 uv = unpackUnorm2x16(imageLoad(chart, pixel).x);
    Corner here = corner(uv, size);
    vec3 near[7];
#define ADD(i) if (LEVELS >= i) { near[i] = look_up##i(here, own); sum += kernel.entry[i].rgb * near[i]; }
    EACH(ADD)
#if THROUGH
    {
        vec3 p = view_position(pixel, z), n = octahedral_decode(imageLoad(normal, pixel).x);
        vec2 texels = unpackHalf2x16(imageLoad(stretch, clamp(here.base + 1, ivec2(0), size - 1)).x);
        vec3 through = vec3(0.);
        for (int i = 0; i < LIGHTS; ++i) {
            Light light = lights.light[i];
            if (light.layer < 0) continue;
            vec3 arriving;
            float away = -dot(n, light_arrives(light, p, arriving));
            if (away <= 0.) continue;
            int layer = shadow_layer(light, p);
            vec4 q = shadow_place(layer, p);
            if (q.w <= 0.) continue;
            ivec3 map = imageSize(entrance);
            ivec2 at = ivec2(floor((q.xy / q.w * .5 + .5) * vec2(map.xy)));
            if (any(lessThan(at, ivec2(0))) || any(greaterThanEqual(at, map.xy))) continue;
            uint code = imageLoad(entrance, ivec3(at, layer)).x;
            if (code == 0xffffffffu) continue;
            vec2 entered = unpackUnorm2x16(code);
            float t = thickness(light, layer, q, p);
            if (THICKEST > 0.) t = thickness_stated(THICKEST * coat_thickness(imageLoad(coat, pixel).xy), t);
            // Thickness along the normal of what is behind, along the light of what is beside.
            t *= mix(1., away, away);
            float mm = length((entered - uv) * (1. - 2. * SHEET_BORDER) * vec2(size) / max(texels, vec2(1e-9)));
            Corner there = corner(entered, size);
            vec3 sent = vec3(0.);
            float variance = 0.;
#define FOLLOW(k) \
            if (LEVELS >= k) { \
                variance += kernel.entry[k].w * kernel.entry[k].w; \
                if (k > LEVELS - 3) { \
                    float f = exp2(-1.44269504 * min(t * t / (2. * max(variance, 1e-30)), 80.)) * min(mm * inversesqrt(36. * max(variance, 1e-30)), 1.); \
                    if (f > 1e-4) { \
                        vec3 far = look_up##k(there, vec3(0.)); \
                        sent += kernel.entry[k].rgb * f * (SLAB ? max(far - near[k], 0.) / (1. + f) : far); \
                    } \
                } \
            }
            EACH(FOLLOW)
            through = max(through, sent);
        }
        sum += through;
    }
#endif
    imageStore(scattered, pixel, light_encode(sum));
}
