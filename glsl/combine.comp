// combine: viewz, normal, albedo, material, irradiance, scattered, reflected -> picture (ldr, tone-mapped; or exr, linear).
// The end of every method that scatters light itself. The surface's colour and what its gloss leaves of the light act where
// light leaves, after scattering; or, with PRE, the colour's square root before and after (d'Eon & Luebke 2007). Specular
// light never scatters.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "common/frame.glsl"
#include "common/octahedral.glsl"
#include "common/tiles.glsl"
#include "common/coat.glsl"
#include "common/specular.glsl"
#include "common/tonemap.glsl"

#define OUTPUT_FINAL 0
#define OUTPUT_SCATTER 1
#define OUTPUT_IRRADIANCE 2

layout(constant_id = 0) const int OUTPUT = OUTPUT_FINAL;
layout(constant_id = 1) const bool PRE = false;          // irradiance already holds the square root of the colour
layout(constant_id = 31) const bool MASKED = false;       // some surface scatters a share of the light alone
layout(constant_id = 2) const int CURVE = 0;             // 0 Khronos PBR Neutral, 1 sRGB alone, 2 linear
layout(constant_id = 3) const bool OWN = false;          // of several profiles, not the first: what does not scatter is another's

layout(set = 0, binding = 2, r32f) uniform readonly image2D viewz;
layout(set = 0, binding = 3, r32ui) uniform readonly uimage2D normal;
layout(set = 0, binding = 4, rgba8) uniform readonly image2D albedo;
layout(set = 0, binding = 5, rgba8) uniform readonly image2D material;
layout(set = 0, binding = 24, rg32ui) uniform readonly uimage2D coat;
layout(set = 0, binding = 23, r32ui) uniform readonly uimage2D smooth_normal;
layout(set = 0, binding = 6, rgba16f) uniform readonly image2D irradiance;
layout(set = 0, binding = 7, rgba16f) uniform readonly image2D scattered;
layout(set = 0, binding = 8, rgba16f) uniform readonly image2D reflected;
layout(set = 0, binding = 9) uniform writeonly image2D picture;

void main() {
    ivec2 pixel = tile_pixel();
    if (any(greaterThanEqual(pixel, frame.size))) return;
    float z = imageLoad(viewz, pixel).x;
    if (OWN && z >= 0.) return;
    if (z == 0.) {
        // The rest of a tile that holds some surface.
        imageStore(picture, pixel, vec4(0.));
        return;
    }
    bool scatters = z < 0. && OUTPUT != OUTPUT_IRRADIANCE;
    vec3 light = frame.light_unit * (scatters ? imageLoad(scattered, pixel).rgb : imageLoad(irradiance, pixel).rgb);
    if (MASKED && scatters) {
        float share = imageLoad(albedo, pixel).a;
        if (share < 1.) light = mix(frame.light_unit * imageLoad(irradiance, pixel).rgb, light, share);
    }
    if (OUTPUT == OUTPUT_FINAL) {
        vec4 base = imageLoad(albedo, pixel);
        vec4 m = imageLoad(material, pixel);
        Coat over = coat_none();
        if (COATED) over = coat_decode(imageLoad(coat, pixel).xy);
        vec3 color = base.rgb * base.rgb, f0 = gloss_f0(m.a * m.a, color, m.g, over);
        vec3 n = octahedral_decode(imageLoad(normal, pixel).x), smooth_n = n;
        if (COATED) smooth_n = octahedral_decode(imageLoad(smooth_normal, pixel).x);
        vec3 v = view_direction(view_position(pixel, abs(z)));
        vec3 kept = vec3(1.);
        if (SPECULAR) kept = (1. - m.g) * (1. - gloss_taken(gloss_of(base.a > 0., dot(n, v), m.r, m.g, f0, over, smooth_n, v)));
        light = kept * (PRE && scatters ? base.rgb : color) * light / PI;
        if (SPECULAR) light += frame.light_unit * imageLoad(reflected, pixel).rgb;
        light *= frame.exposure;
    }
    if (CURVE < 2) light = srgb(clamp(CURVE == 0 ? neutral(light) : light, 0., 1.));
    imageStore(picture, pixel, vec4(light, 1.));
}
