// tonemap: hdr -> ldr. Khronos PBR Neutral (hue kept, identity below .76), or none; then the sRGB curve.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "common/frame.glsl"
#include "common/tiles.glsl"

layout(constant_id = 0) const int CURVE = 0;   // 0 neutral, 1 linear

layout(set = 0, binding = 2, rgba16f) uniform readonly image2D hdr;
layout(set = 0, binding = 3, rgba8) uniform writeonly image2D ldr;

// Khronos PBR Neutral tone mapper (2024): removes the 4 % Fresnel veil, then compresses the peak and desaturates it.
vec3 neutral(vec3 color) {
    const float start = .8 - .04, desaturation = .15;
    float x = min(color.r, min(color.g, color.b));
    color -= x < .08 ? x - 6.25 * x * x : .04;
    float peak = max(color.r, max(color.g, color.b));
    if (peak < start) return color;
    float d = 1. - start;
    float squeezed = 1. - d * d / (peak + d - start);
    color *= squeezed / peak;
    float g = 1. - 1. / (desaturation * (peak - squeezed) + 1.);
    return mix(color, vec3(squeezed), g);
}

vec3 srgb(vec3 c) {
    return mix(1.055 * pow(c, vec3(1. / 2.4)) - .055, 12.92 * c, lessThanEqual(c, vec3(.0031308)));
}

void main() {
    ivec2 pixel = tile_pixel();
    if (any(greaterThanEqual(pixel, frame.size))) return;
    vec4 c = imageLoad(hdr, pixel);
    vec3 color = CURVE == 0 ? neutral(c.rgb) : c.rgb;
    imageStore(ldr, pixel, vec4(srgb(clamp(color, 0., 1.)), c.a));
}
