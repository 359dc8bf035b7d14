// burley: viewz, irradiance -> scattered. Burley's normalised diffusion by a disc of samples (Christensen & Burley 2015; Golubev
// 2018).
//
// scattered_c = sum of w_c irradiance / sum of w_c, w_c = R_c(|distance in space|) / p(distance on the screen)
//
// Samples are drawn from the widest channel's own R: radius r = inverse CDF of (i + 1/2) / n, angles a golden angle apart, the
// whole disc turned by noise a pixel. A sample lands on a whole pixel; its distance is sqrt(r^2 + dz^2) in mm, so that what lies
// across a step in depth weighs next to nothing. Weights are renormalised: what is off the surface takes no light away.
// n is a quarter of the pixels that the disc of .997 of the energy covers, BUDGET at most; below one sample nothing scatters.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "common/frame.glsl"
#include "common/tiles.glsl"
#include "common/light_code.glsl"

layout(constant_id = 0) const int BUDGET = 40;

layout(set = 0, binding = 2, r32f) uniform readonly image2D viewz;
layout(set = 0, binding = 3, rgba16f) uniform readonly image2D irradiance;
layout(set = 0, binding = 4, rgba16f) uniform writeonly image2D scattered;
// 0: rgb Burley's d in mm, w the widest; 1: x the radius of .997 of the widest one's energy, mm.
layout(set = 0, binding = 5, scalar) readonly buffer KernelBlock { vec4 entry[]; } kernel;

const float PI = 3.14159265358979, GOLDEN_ANGLE = 2.39996322972865;

// r/d within which a share 1 - u of the energy lies. Twin in f64: src/skin/burley.rs.
float inverse_cdf(float u) {
    float g = 1. + 4. * u * (2. * u + sqrt(1. + 4. * u * u)), root = pow(g, 1. / 3.);
    return 3. * log((1. + 1. / root + root) / (4. * u));
}

void main() {
    ivec2 pixel = tile_pixel();
    if (any(greaterThanEqual(pixel, frame.size))) return;
    float z = -imageLoad(viewz, pixel).x;
    if (z <= 0.) return;
    vec3 own = imageLoad(irradiance, pixel).rgb;
    vec4 d = kernel.entry[0];
    float px_per_mm = frame.pixels_per_mm / mix(1., z, frame.perspective), radius_px = kernel.entry[1].x * px_per_mm;
    int n = int(min(PI * radius_px * radius_px / 4., float(BUDGET)));
    if (n < 1) {
        imageStore(scattered, pixel, vec4(own, 1.));
        return;
    }
    // A channel that scatters nothing has a d of 0: no sample weighs anything, and it keeps its light.
    vec3 per_d = 1. / max(d.rgb, 1e-12 * d.w), fall = -.48089835 * per_d, to_widest = d.w * per_d;
    float widest_fall = -.48089835 / d.w;
    // Interleaved gradient noise (Jimenez 2014).
    float turn = 2. * PI * fract(52.9829189 * fract(dot(vec2(pixel), vec2(.06711056, .00583715))));
    vec3 sum = vec3(0.), weights = vec3(0.);
    for (int i = 0; i < n; ++i) {
        float r = d.w * max(inverse_cdf(1. - (float(i) + .5) / float(n)), 1e-4), angle = turn + float(i) * GOLDEN_ANGLE;
        ivec2 at = pixel + ivec2(round(min(r * px_per_mm, 1e6) * vec2(cos(angle), sin(angle))));
        bool inside = all(greaterThanEqual(at, ivec2(0))) && all(lessThan(at, frame.size));
        at = clamp(at, ivec2(0), frame.size - 1);
        float there = -imageLoad(viewz, at).x, dz = there - z;
        if (!inside || there <= 0.) continue;
        float distance = sqrt(r * r + dz * dz);
        // R is (t^3 + t) / (8 pi d r), t = e^{-r/3d}.
        vec3 t = exp2(max(fall * distance, -100.));
        float s = exp2(max(widest_fall * r, -100.));
        vec3 w = (t * t * t + t) * to_widest * (r / (distance * (s * s * s + s)));
        sum += w * imageLoad(irradiance, at).rgb;
        weights += w;
    }
    // Weights sum to about n where the disc is sampled. A channel so narrow that every sample lies beyond it keeps its light;
    // without this the least of exponents would weigh all samples alike.
    bvec3 any_weight = greaterThan(weights, vec3(1e-3 * float(n)));
    imageStore(scattered, pixel, light_encode(mix(own, sum / max(weights, 1e-30), any_weight)));
}
