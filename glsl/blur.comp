// blur: viewz, and normal + curvature + lit or a blurred level -> a wider level.
// variants: first FIRST=1 LIT=0; first_lit FIRST=1 LIT=1; next FIRST=0 LIT=0; next_lit FIRST=0 LIT=1
//
// One pass of the cross-bilateral diffusion. It widens the Gaussian by `variance` (mm^2 on the surface) with the 3 x 3
// Gauss-Hermite rule: nodes 0, +-sqrt(3 variance), weights 2/3, 1/6, exact to the fifth moment, so that passes add up to
// the profile's variances to the digit. The nodes lie in the tangent plane and are projected to the screen: on a grazing
// surface the kernel is as round as on a facing one. Each tap is corrected for where it really landed,
//     w = rule * exp((planned^2 - distance^2) / (2 variance)) * area,
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

struct Sample {
    vec3 n;
    float h;
    float confidence;
    vec2 lit;
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
    s.lit = unpackUnorm2x16(imageLoad(source_lit, texel).x);
#endif
    return s;
}

ivec2 representative(ivec2 texel, int stride) {
    return min(texel * stride + stride / 2, frame.size - 1);
}

void main() {
    ivec2 texel = tile_pixel();
    ivec2 pixel = representative(texel, TARGET_STRIDE);
    if (any(greaterThanEqual(texel * TARGET_STRIDE, frame.size))) return;
    float z = -imageLoad(viewz, pixel).x;
    if (z <= 0.) return;
    ivec2 home = pixel / SOURCE_STRIDE;
    Sample centre = fetch(home);
    vec3 p0 = view_position(pixel, z);
    vec3 v = view_direction(p0);
    float square = dot(centre.n, centre.n);
    vec3 n0 = square > 0. ? centre.n * inversesqrt(square) : v;
    float facing = max(dot(n0, v), .1);

    // Tangents: along the slope and across it. Their images on the screen, in pixels per sqrt(3 variance).
    vec3 slope = v - n0 * dot(n0, v);
    float steep = dot(slope, slope);
    vec3 t = steep > 1e-8 ? slope * inversesqrt(steep) : normalize(cross(n0, abs(n0.x) < .7 ? vec3(1., 0., 0.) : vec3(0., 1., 0.)));
    vec3 b = cross(n0, t);
    float radius = sqrt(3. * push.variance);
    float distance = mix(1., z, frame.perspective);
    vec2 ray = view_ray(pixel).xy * frame.perspective;
    vec2 scale = radius / (distance * frame.ray_scale);
    vec2 step_t = (t.xy + ray * t.z) * scale, step_b = (b.xy + ray * b.z) * scale;

    float falloff = .5 / push.variance, planned = 3. * push.variance;
    vec3 n = centre.n * (4. / 9.);
    float weight = 4. / 9.;
    float h = centre.h * centre.confidence * weight, h_weight = centre.confidence * weight;
#if LIT
    vec2 lit = centre.lit * weight;
#endif
    for (int i = 0; i < 9; ++i) {
        if (i == 4) continue;
        int x = i % 3 - 1, y = i / 3 - 1;
        vec2 at = vec2(pixel) + step_t * float(x) + step_b * float(y);
        // A step beyond the integers' range must not wrap.
        at = clamp(at, vec2(-1e6), vec2(1e6));
        ivec2 q = ivec2(floor(at + .5));
        if (any(lessThan(q, ivec2(0))) || any(greaterThanEqual(q, frame.size))) continue;
        ivec2 tap = q / SOURCE_STRIDE;
        ivec2 seat = representative(tap, SOURCE_STRIDE);
        float tz = -imageLoad(viewz, seat).x;
        if (tz <= 0.) continue;
        Sample s = fetch(tap);
        vec3 d = view_position(seat, tz) - p0;
        float rule = x != 0 && y != 0 ? 1. / 36. : 1. / 9.;
        float want = planned * float(x * x + y * y);
        float area = facing / max(dot(s.n, v), .1);
        float w = rule * exp(clamp((want - dot(d, d)) * falloff, -60., 4.)) * area;
        n += s.n * w;
        weight += w;
        h += s.h * s.confidence * w;
        h_weight += s.confidence * w;
#if LIT
        lit += s.lit * w;
#endif
    }
    n /= weight;
    h = h_weight > 0. ? h / h_weight : 0.;
    imageStore(target, texel, uvec4(level_encode(n, clamp(h, -6e4, 6e4)), 0u, 0u));
#if LIT
    imageStore(target_lit, texel, uvec4(packUnorm2x16(lit / weight)));
#endif
}
