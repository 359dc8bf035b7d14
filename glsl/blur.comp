// blur: viewz, and normal + curvature + lit or a blurred level -> a wider level.
// variants: first FIRST=1 LIT=0; first_lit FIRST=1 LIT=1; next FIRST=0 LIT=0; next_lit FIRST=0 LIT=1; first_geo FIRST=1 LIT=2; next_geo FIRST=0 LIT=2
//
// One pass of the cross-bilateral diffusion. It widens the Gaussian by `variance` (mm^2 on the surface) with the seven-point
// rule for a Gaussian in the plane (Radon 1948; Stroud 1971, E2 r^2 5-1): the centre weighs 1/2, a hexagon of radius
// 2 sqrt(variance) 1/12 a corner; exact to the fifth degree, so that passes add up to the profile's variances to the digit.
// The hexagon lies in the tangent plane and is projected to the screen: on a grazing surface the kernel is as round as on a
// facing one. Each tap is corrected for where it really landed,
//     w = 1/12 * exp((4 variance - distance^2) / (2 variance)) * area,
// distance being 3-D (Mikkelsen 2010): what lies across a depth step is far away and weighs nothing. The area term is the
// surface that a tap stands for over the tangent plane's share, n0.v / n.v. Curvature without confidence weighs nothing and
// is filled from its neighbours (normalised convolution, Knutsson & Westin 1993).
#version 460
#extension GL_GOOGLE_include_directive : require
#include "common/frame.glsl"
#include "common/octahedral.glsl"
#include "common/tiles.glsl"
#include "common/level_code.glsl"
#include "common/curvature_code.glsl"

layout(constant_id = 0) const int SOURCE_STRIDE = 1;   // pixels per texel of the source, and of the target
layout(constant_id = 1) const int TARGET_STRIDE = 1;
layout(constant_id = 2) const bool CURVATURE = true;   // H is wanted
layout(constant_id = 3) const bool TURN = false;       // the hexagon stands on a side: passes take turns

layout(push_constant, scalar) uniform Push { float variance; } push;

layout(set = 0, binding = 2, r32f) uniform readonly image2D viewz;
#if FIRST
layout(set = 0, binding = 3, r32ui) uniform readonly uimage2D normal;
layout(set = 0, binding = 4, rg32ui) uniform readonly uimage2D curvature;
#else
layout(set = 0, binding = 5, rg32ui) uniform readonly uimage2D source;
#endif
layout(set = 0, binding = 6, rg32ui) uniform writeonly uimage2D target;
#if LIT
layout(set = 0, binding = 7, r32ui) uniform readonly uimage2D source_lit;
layout(set = 0, binding = 8, r32ui) uniform writeonly uimage2D target_lit;
#endif
#if LIT == 2
// The same light by the triangles' own normals, beside it.
#define LITS vec4
layout(set = 0, binding = 9, r32ui) uniform readonly uimage2D source_geo;
layout(set = 0, binding = 10, r32ui) uniform writeonly uimage2D target_geo;
#else
#define LITS vec2
#endif

struct Sample {
    vec3 n;
    float h;
    float confidence;
    LITS lit;
};

Sample fetch(ivec2 texel) {
    Sample s;
#if FIRST
    s.n = octahedral_decode(imageLoad(normal, texel).x);
    s.h = 0.;
    s.confidence = 0.;
    if (CURVATURE) {
        uvec2 code = imageLoad(curvature, texel).xy;
        s.h = curvature_mean(code) * frame.length_mm;
        s.confidence = curvature_confidence(code);
    }
#else
    uvec2 code = imageLoad(source, texel).xy;
    s.n = level_normal(code);
    s.h = CURVATURE ? level_curvature(code) : 0.;
    s.confidence = 1.;
#endif
#if LIT
    s.lit.xy = unpackUnorm2x16(imageLoad(source_lit, texel).x);
#endif
#if LIT == 2
    s.lit.zw = unpackUnorm2x16(imageLoad(source_geo, texel).x);
#endif
    return s;
}

// One tap: where it lands is a whole pixel, so its weight is corrected for where that is.
struct Kernel {
    ivec2 pixel;
    vec3 p0, v;
    vec2 ray;           // view ray of the pixel
    float z, facing;
    float falloff, planned; // log2 of a tap's weight is planned - distance^2 * falloff
};

struct Sum {
    vec3 n;
    float weight, h, h_weight;
    LITS lit;
};

void tap(inout Sum sum, Kernel k, ivec2 offset) {
    ivec2 q = k.pixel + offset;
    // Clamped and weighed nothing rather than skipped: lanes do not part.
    ivec2 inside = clamp(q, ivec2(0), frame.size - 1);
    ivec2 texel = inside / SOURCE_STRIDE;
    ivec2 seat = SOURCE_STRIDE == 1 ? inside : representative(texel, SOURCE_STRIDE);
    float z = -imageLoad(viewz, seat).x;
    Sample s = fetch(texel);
    vec2 ray = k.ray + frame.ray_scale * vec2(seat - k.pixel);
    vec3 d = vec3(ray * mix(1., z, frame.perspective), -z) - k.p0;
    float area = k.facing / max(dot(s.n, k.v), .1);
    float w = exp2(clamp(k.planned - dot(d, d) * k.falloff, -80., 6.)) * area;
    w = z > 0. && q == inside ? w : 0.;
    sum.n += s.n * w;
    sum.weight += w;
    if (CURVATURE) {
        // Texels without a surface hold anything, NaN included: nothing times NaN is not nothing.
        float share = w > 0. ? s.confidence * w : 0.;
        sum.h += share > 0. ? s.h * share : 0.;
        sum.h_weight += share;
    }
#if LIT
    sum.lit += s.lit * w;
#endif
}

void main() {
    ivec2 texel = tile_pixel();
    ivec2 pixel = TARGET_STRIDE == 1 ? texel : representative(texel, TARGET_STRIDE);
    if (any(greaterThanEqual(texel * TARGET_STRIDE, frame.size))) return;
    Kernel k;
    k.pixel = pixel;
    k.z = -imageLoad(viewz, pixel).x;
    if (k.z <= 0.) return;
    Sample centre = fetch(pixel / SOURCE_STRIDE);
    k.ray = view_ray(pixel).xy;
    float distance = mix(1., k.z, frame.perspective);
    k.p0 = vec3(k.ray * distance, -k.z);
    k.v = view_direction(k.p0);
    float square = dot(centre.n, centre.n);
    vec3 n0 = square > 0. ? centre.n * inversesqrt(square) : k.v;
    float along = dot(n0, k.v);
    k.facing = max(along, .1);
    k.falloff = .5 * 1.44269504 / push.variance;
    k.planned = 2. * 1.44269504;

    // Tangents: along the slope and across it. Their images on the screen, in pixels per 2 sqrt(variance).
    vec3 slope = k.v - n0 * along;
    float steep = dot(slope, slope);
    vec3 other = cross(n0, abs(n0.x) < .7 ? vec3(1., 0., 0.) : vec3(0., 1., 0.));
    vec3 t = steep > 1e-8 ? slope * inversesqrt(steep) : other * inversesqrt(dot(other, other));
    vec3 b = cross(n0, t);
    vec2 scale = 2. * sqrt(push.variance) / (distance * frame.ray_scale);
    vec2 ray = k.ray * frame.perspective;
    // A step beyond the integers' range must not wrap.
    vec2 first = clamp((t.xy + ray * t.z) * scale, vec2(-1e6), vec2(1e6));
    vec2 second = clamp((b.xy + ray * b.z) * scale, vec2(-1e6), vec2(1e6));
    vec2 along_t = TURN ? second : first, along_b = (TURN ? first : second) * .866025404;
    ivec2 corner0 = ivec2(round(along_t));
    ivec2 corner1 = ivec2(round(.5 * along_t + along_b)), corner2 = ivec2(round(.5 * along_t - along_b));

    // In units of a corner's weight the centre weighs 6.
    Sum sum;
    sum.weight = 6.;
    sum.n = centre.n * sum.weight;
    sum.h_weight = centre.confidence * sum.weight;
    sum.h = sum.h_weight > 0. ? centre.h * sum.h_weight : 0.;
#if LIT
    sum.lit = centre.lit * sum.weight;
#endif
    tap(sum, k, corner0);
    tap(sum, k, -corner0);
    tap(sum, k, corner1);
    tap(sum, k, -corner1);
    tap(sum, k, corner2);
    tap(sum, k, -corner2);

    float scale_back = 1. / sum.weight;
    float h = sum.h_weight > 0. ? sum.h / sum.h_weight : 0.;
    imageStore(target, texel, uvec4(level_encode(sum.n * scale_back, clamp(h, -6e4, 6e4)), 0u, 0u));
#if LIT
    imageStore(target_lit, texel, uvec4(packUnorm2x16(sum.lit.xy * scale_back)));
#endif
#if LIT == 2
    imageStore(target_geo, texel, uvec4(packUnorm2x16(sum.lit.zw * scale_back)));
#endif
}
