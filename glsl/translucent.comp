// translucent: viewz, normal, mass, sparse, and light blurred on the screen (with DETAIL by the triangles' normals, too) -> in its place, of one level:
// variants: plain DETAIL=0; detail DETAIL=1
// what a Gaussian of the profile gathers of the light that enters the
// surface, hidden parts included, of the directional lights with a slot, over the kernel's mass.
//
// In a directional light's view every texel carries the same flux, n.l dA = the texel's area. So the integral of G_v E dA is
// a mean over the light's plane, and E cancels against none of it:
//     integral = E0 * mean of exp(-dz^2 / 2v) over offsets o ~ N(0, v) in the plane,
// dz the distance along the light between the shaded point and what the map holds at o. A plane under any tilt gives its
// cosine exactly; what the map does not hold is in shadow. The map knows triangles alone: what shading normals add to the
// light that the camera sees is blurred on the screen, and added.
//
// SHARED: several lights have a slot together, and each few offsets, turned and spaced otherwise than the others': what one misses
// another finds. So few know no share of a control variate, and of so many lights few graze the surface.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "common/frame.glsl"
#include "common/octahedral.glsl"
#include "common/level_code.glsl"
#include "common/tiles.glsl"
#include "common/lights.glsl"

layout(constant_id = 0) const int STRIDE = 1;
layout(constant_id = 1) const int TAPS = 32;
layout(constant_id = 2) const int GATHERED = 0;           // which of the gathered levels this is
layout(constant_id = 3) const int STEP = 8;               // every so many-th texel of the shadow map is there

layout(constant_id = 4) const bool SHARED = false;        // some slot is of several lights

layout(push_constant, scalar) uniform Push {
    float variance;        // mm^2
} push;

layout(set = 0, binding = 2, r32f) uniform readonly image2D viewz;
layout(set = 0, binding = 6, r32ui) uniform readonly uimage2D normal;  // the triangle's own where DETAIL
// Nobody else wants the blurred light any more: what is found takes its place.
layout(set = 0, binding = 4, r32ui) uniform uimage2D blurred;
layout(set = 0, binding = 8, rg32ui) uniform readonly uimage2D soft;
layout(set = 0, binding = 7, rgb10_a2) uniform readonly image2D mass;
#if DETAIL
layout(set = 0, binding = 5, r32ui) uniform readonly uimage2D blurred_geo;
#endif
layout(set = 0, binding = 9, r32f) uniform readonly image2DArray sparse;

// Rows of a directional light's matrix are its axes over the half extents of its box; the third maps onto 0..1.
float row_length(mat4 m, int row) {
    return length(vec3(m[0][row], m[1][row], m[2][row]));
}

// The tangent plane is a control variate: its mean is known, the cosine c, and its samples err as the surface's own do. Its
// share is the regression of one on the other, so a surface that is not seen by the light takes none of it.
float gathered(int layer, vec3 position, vec3 n, float c, vec2 direction, float phase) {
    mat4 m = lights.shadow_from_view[layer];
    vec3 s = (m * vec4(position, 1.)).xyz;
    vec2 scale = sqrt(push.variance) * .5 * vec2(row_length(m, 0), row_length(m, 1));
    float falloff = sqrt(.5 * 1.44269504 / push.variance) / row_length(m, 2);
    // In texels of what is there; what was kept of a cell is half a texel of the shadow map past its middle.
    int side = imageSize(sparse).x;
    vec2 at = (s.xy * .5 + .5) * float(side) - .5 / float(STEP);
    scale *= float(side);
    vec2 slope = vec2(dot(n, vec3(m[0][0], m[1][0], m[2][0])) / row_length(m, 0), dot(n, vec3(m[0][1], m[1][1], m[2][1])) / row_length(m, 1));
    slope *= sqrt(.5 * 1.44269504) / max(c, 1e-3);
    // Vogel's spiral: equal areas turned by the golden angle, stretched to a Gaussian.
    const mat2 turn = mat2(-.737368878, .675490294, -.675490294, -.737368878);
    float sum = 0., plane = 0., both = 0., square = 0.;
    for (int i = 0; i < TAPS; ++i) {
        float radius = sqrt(-1.38629436 * log2(1. - (float(i) + phase) / float(TAPS)));
        vec2 cell = floor(at + direction * radius * scale), offset = (cell + .5 - at) / scale;
        bool inside = all(greaterThanEqual(cell, vec2(0.))) && all(lessThan(cell, vec2(side)));
        float depth = imageLoad(sparse, ivec3(clamp(ivec2(cell), 0, side - 1), layer)).r;
        float dz = (depth - s.z) * falloff, dp = dot(offset, slope);
        float f = inside && depth > 0. ? exp2(-min(dz * dz, 80.)) : 0., p = exp2(-min(dp * dp, 80.));
        sum += f;
        plane += p;
        both += f * p;
        square += p * p;
        direction = turn * direction;
    }
    if (SHARED) return sum / float(TAPS);
    float share = c > 1e-3 && square > 0. ? min(both / square, 1.) : 0.;
    return max(sum / float(TAPS) + share * (c - plane / float(TAPS)), 0.);
}

void main() {
    ivec2 texel = tile_pixel();
    if (any(greaterThanEqual(texel * STRIDE, frame.size))) return;
    ivec2 pixel = STRIDE == 1 ? texel : representative(texel, STRIDE);
    float z = -imageLoad(viewz, pixel).x;
    if (z <= 0.) return;
    vec3 position = view_position(pixel, z);
    vec3 n = octahedral_decode(imageLoad(normal, pixel).x);
    float scale = 2. * imageLoad(mass, pixel)[GATHERED];
    // On a wide smooth sheet the camera sees all there is, and blurs it without a sample's error. Spread of the normals within
    // the level, 1 - |n|^2, and mass tell what is not.
    vec3 mean = level_normal(imageLoad(soft, texel).xy);
    float needed = smoothstep(.015, .09, 1. - dot(mean, mean) + 2. * abs(1. / max(scale, .1) - 1.));
    vec2 found = vec2(0.), shares = vec2(0.), first = vec2(1., 0.);
    const mat2 skew = mat2(.696706709, .717356091, -.717356091, .696706709);
    for (int i = 0; i < LIGHTS; ++i) {
        Light light = lights.light[i];
        if (light.slot < 0) continue;
        float c = dot(n, light.position);
        // At a terminator the light's view sees the surface edge on and few offsets find it; there the camera sees it better.
        float share = SHARED ? needed : needed * smoothstep(.08, .3, abs(c));
        if (share == 0.) continue;
        float phase = SHARED ? (float(i) + .5) / float(LIGHTS) : .5;
        float x = light.part * gathered(light.layer, position, n, c, first, phase) * scale;
        if (light.slot == 0) { found.x += x; shares.x = share; } else { found.y += x; shares.y = share; }
        if (SHARED) first = skew * first;
    }
    vec2 seen = unpackUnorm2x16(imageLoad(blurred, texel).x);
#if DETAIL
    found += seen - unpackUnorm2x16(imageLoad(blurred_geo, texel).x);
#endif
    imageStore(blurred, texel, uvec4(packUnorm2x16(mix(seen, found, shares))));
}
