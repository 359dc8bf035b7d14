// gaussians: viewz, source -> target, and down also irradiance -> scattered. Screen-space diffusion by a sum of Gaussians, a
// separable pair of passes each (Jimenez, Sundstedt & Gutierrez 2009; Jimenez & Gutierrez 2010). Pairs are cascaded: each
// widens what the one before it has made by the difference of their variances.
//
// Seven taps span three sigma. A tap's step in pixels is the step in mm over depth; where a tap's depth differs, it is moved
// towards the centre's own value in proportion: s = min(|dz| / (3 sigma), 1).
// variants: across DOWN=0 FIRST=0; first DOWN=1 FIRST=1; down DOWN=1 FIRST=0
#version 460
#extension GL_GOOGLE_include_directive : require
#include "common/frame.glsl"
#include "common/tiles.glsl"

layout(constant_id = 0) const int STEP = 1;               // entry of the kernel

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

const float TAP[4] = float[](.382, .242, .061, .006);

void main() {
    ivec2 pixel = tile_pixel();
    if (any(greaterThanEqual(pixel, frame.size))) return;
    float z = -imageLoad(viewz, pixel).x;
    if (z <= 0.) return;
    vec4 entry = kernel.entry[STEP];
    float sigma = entry.w;
    float unit = sigma * frame.pixels_per_mm / mix(1., z, frame.perspective);
    vec3 centre = imageLoad(source, pixel).rgb;
    vec3 sum = TAP[0] * centre;
    for (int i = -3; i <= 3; ++i) {
        if (i == 0) continue;
        int reach = int(round(float(i) * unit));
        ivec2 at = clamp(pixel + (DOWN == 1 ? ivec2(0, reach) : ivec2(reach, 0)), ivec2(0), frame.size - 1);
        float far = -imageLoad(viewz, at).x;
        float s = far <= 0. ? 1. : min(abs(far - z) / (3. * sigma), 1.);
        vec3 tap = s < 1. ? imageLoad(source, at).rgb : centre;
        sum += TAP[abs(i)] * mix(tap, centre, s);
    }
    imageStore(target, pixel, vec4(sum, 1.));
#if DOWN
#if FIRST
    vec3 before = kernel.entry[0].rgb * imageLoad(irradiance, pixel).rgb;
#else
    vec3 before = imageLoad(scattered, pixel).rgb;
#endif
    imageStore(scattered, pixel, vec4(before + entry.rgb * sum, 1.));
#endif
}
