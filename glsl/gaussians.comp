// gaussians: viewz, source -> target, and down also irradiance -> scattered. Screen-space diffusion by a sum of Gaussians, a
// separable pair of passes each (Jimenez, Sundstedt & Gutierrez 2009; Jimenez & Gutierrez 2010). Pairs are cascaded: each
// widens what the one before it has made by the difference of their variances.
//
// 2 HALF + 1 taps, SPACING sigma apart, weighted by the Gaussian where they are: the trapezoid rule, whose variance is right to
// 1e-6 at one sigma and better below. A tap's step in pixels is the step in mm over depth, shortened where the surface leans
// away along the axis (the stretch of 2009), between two texels where it falls there. Where depth differs, a tap is moved
// towards the centre's own light: s = min(|dz| / (FOLLOW sigma), 1).
// variants: across DOWN=0 FIRST=0; first DOWN=1 FIRST=1; down DOWN=1 FIRST=0
#version 460
#extension GL_GOOGLE_include_directive : require
#include "common/frame.glsl"
#include "common/tiles.glsl"
#include "common/light_code.glsl"

layout(constant_id = 0) const int STEP = 1;               // entry of the kernel
layout(constant_id = 1) const int HALF = 3;               // taps on a side
layout(constant_id = 2) const float SPACING = 1.;         // of taps, sigmas

// Wider serves a torus better still (.0078 rms at 8 against .0082), and lets a background bleed further.
const float FOLLOW = 5.;

layout(set = 0, binding = 2, r32f) uniform readonly image2D viewz;
layout(set = 0, binding = 3, rgba16f) uniform readonly image2D source;
layout(set = 0, binding = 4, rgba16f) uniform writeonly image2D target;
#if DOWN
#if FIRST
layout(set = 0, binding = 5, rgba16f) uniform readonly image2D irradiance;
layout(set = 0, binding = 6, rgba16f) uniform writeonly image2D scattered;
#else
layout(set = 0, binding = 6, rgba16f) uniform image2D scattered;
#endif
#endif
// Entry 0: rgb weight of what is narrower than a pixel. Others: rgb weight, w sigma (mm) of the pair.
layout(set = 0, binding = 7, scalar) readonly buffer KernelBlock { vec4 entry[]; } kernel;

#include "common/along.glsl"

void main() {
    ivec2 pixel = tile_pixel();
    if (any(greaterThanEqual(pixel, frame.size))) return;
    float z = -imageLoad(viewz, pixel).x;
    if (z <= 0.) return;
    vec4 entry = kernel.entry[STEP];
    float sigma = entry.w, per_mm = 1. / (FOLLOW * sigma);
    float step_px = SPACING * sigma * frame.pixels_per_mm / mix(1., z, frame.perspective);
    const ivec2 axis = DOWN == 1 ? ivec2(0, 1) : ivec2(1, 0);
    step_px *= along_shortening(pixel, axis, z);
    vec3 centre = imageLoad(source, pixel).rgb, sum = centre;
    float weights = 1.;
    for (int i = 1; i <= HALF; ++i) {
        float x = float(i) * SPACING, weight = exp2(-.72134752 * x * x), reach = float(i) * step_px;
        sum += weight * (along(pixel, axis, reach, centre, z, per_mm) + along(pixel, axis, -reach, centre, z, per_mm));
        weights += 2. * weight;
    }
    sum /= weights;
    imageStore(target, pixel, light_encode(sum));
#if DOWN
#if FIRST
    vec3 before = kernel.entry[0].rgb * imageLoad(irradiance, pixel).rgb;
#else
    vec3 before = imageLoad(scattered, pixel).rgb;
#endif
    imageStore(scattered, pixel, light_encode(before + entry.rgb * sum));
#endif
}
