// view: any target -> exr, decoded to its unit. For people and tests; never part of a frame that is timed.
// variants: albedo VIEW=0; normal VIEW=1; position VIEW=2; depth VIEW=3; curvature VIEW=4; soft_normal VIEW=5; soft_curvature VIEW=6; lit VIEW=7
#version 460
#extension GL_GOOGLE_include_directive : require
#include "common/frame.glsl"
#include "common/octahedral.glsl"
#include "common/tiles.glsl"
#include "common/level_code.glsl"
#include "common/curvature_code.glsl"

layout(set = 0, binding = 2, r32f) uniform readonly image2D viewz;
layout(set = 0, binding = 3) uniform writeonly image2D exr;
#if VIEW == 0
layout(set = 0, binding = 4, rgba8) uniform readonly image2D source;
layout(constant_id = 0) const bool ROOTED = true;   // stored as square roots
#elif VIEW == 1 || VIEW == 7
layout(set = 0, binding = 4, r32ui) uniform readonly uimage2D source;
#elif VIEW > 3
layout(set = 0, binding = 4, rg32ui) uniform readonly uimage2D source;
#endif
layout(constant_id = 1) const int STRIDE = 1;       // pixels per texel of the source
layout(constant_id = 2) const bool OWN = false;     // of several profiles, not the first: what does not scatter is another's

void main() {
    ivec2 pixel = tile_pixel();
    if (any(greaterThanEqual(pixel, frame.size))) return;
    float signed_z = imageLoad(viewz, pixel).x;
    if (OWN && signed_z >= 0.) return;
    if (signed_z == 0.) {
        imageStore(exr, pixel, vec4(0.));
        return;
    }
    float z = abs(signed_z);
    vec3 color = vec3(0.);
#if VIEW == 0
    vec3 c = imageLoad(source, pixel).rgb;
    color = ROOTED ? c * c : c;
#elif VIEW == 1
    color = mat3(frame.world_from_view) * octahedral_decode(imageLoad(source, pixel).x);
#elif VIEW == 2
    color = (frame.world_from_view * vec4(view_position(pixel, z), 1.)).xyz + frame.origin;
#elif VIEW == 3
    color = vec3(z);
#elif VIEW == 4
    uvec2 code = imageLoad(source, pixel).xy;
    float q = mix(1., z, frame.perspective) / frame.pixels_per_mm;
    color = vec3(curvature_mean(code), curvature_gauss(code, q), curvature_confidence(code));
#elif VIEW == 5
    if (signed_z < 0.) color = mat3(frame.world_from_view) * level_normal(imageLoad(source, pixel / STRIDE).xy);
#elif VIEW == 6
    if (signed_z < 0.) color = vec3(level_curvature(imageLoad(source, pixel / STRIDE).xy) / frame.length_mm);
#elif VIEW == 7
    color = vec3(unpackUnorm2x16(imageLoad(source, pixel).x), 0.);
#endif
    imageStore(exr, pixel, vec4(color, 1.));
}
