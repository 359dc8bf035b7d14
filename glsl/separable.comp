// separable: viewz, source -> target. One pass of the separable pair (Jimenez et al. 2015): the same row of taps along rows, then
// along columns; each tap has a weight a channel (src/skin/separable.rs).
//
// target = sum of w_i source(pixel + offset_i). An offset in pixels is the offset in mm over depth, between two texels where it
// falls there. Follow surface: a tap whose depth differs is moved towards the centre's own light,
// s = min(|dz| / (FOLLOW WIDEST), 1).
// variants: across DOWN=0; down DOWN=1
#version 460
#extension GL_GOOGLE_include_directive : require
#include "common/frame.glsl"
#include "common/tiles.glsl"
#include "common/light_code.glsl"

layout(constant_id = 0) const int ROWS = 6;               // entries of the kernel that are taps, the centre's included
layout(constant_id = 1) const float WIDEST = 1.;          // sigma of the profile's widest Gaussian, mm

// The authors' demo stands at 2.25; 1 to 5 were tried on a torus and a head.
const float FOLLOW = 3.;

layout(set = 0, binding = 2, r32f) uniform readonly image2D viewz;
layout(set = 0, binding = 3, rgba16f) uniform readonly image2D source;
layout(set = 0, binding = 4, rgba16f) uniform writeonly image2D target;
// rgb weight, w offset in mm; the first is the centre.
layout(set = 0, binding = 5, scalar) readonly buffer KernelBlock { vec4 entry[]; } kernel;

#include "common/along.glsl"

void main() {
    ivec2 pixel = tile_pixel();
    if (any(greaterThanEqual(pixel, frame.size))) return;
    float z = -imageLoad(viewz, pixel).x;
    if (z <= 0.) return;
    const ivec2 axis = DOWN == 1 ? ivec2(0, 1) : ivec2(1, 0);
    float px_per_mm = frame.pixels_per_mm / mix(1., z, frame.perspective), per_mm = 1. / (FOLLOW * WIDEST);
    vec3 centre = imageLoad(source, pixel).rgb, sum = kernel.entry[0].rgb * centre;
    for (int i = 1; i < ROWS; ++i) {
        vec4 tap = kernel.entry[i];
        float reach = tap.w * px_per_mm;
        sum += tap.rgb * (along(pixel, axis, reach, centre, z, per_mm) + along(pixel, axis, -reach, centre, z, per_mm));
    }
    imageStore(target, pixel, light_encode(sum));
}
