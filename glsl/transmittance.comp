// transmittance: viewz, normal, albedo, shadow, irradiance -> irradiance. Light that enters a thin part from behind and leaves
// towards the eye (Jimenez, Whelan, Sundstedt & Gutierrez 2010); it is blurred with the rest, as the authors do it.
//
// SLAB       irradiance += E f (-n.l) / (1 + f), what a slab between two planes shows whose front and back weigh 1 and f
//            (common/behind.glsl)
// otherwise  irradiance += E T(s) max(0, .3 - n.l), T(s) = sum over the profile's Gaussians of w exp(-s^2 / v), s the thickness in
//            mm along the light: from the surface that the shadow map holds to this one, sunk by SINK along its normal, so that a
//            texel of what faces the light is not taken for something in front of it: as published
#version 460
#extension GL_GOOGLE_include_directive : require
#include "common/frame.glsl"
#include "common/octahedral.glsl"
#include "common/tiles.glsl"
#include "common/lights.glsl"
#include "common/shadow.glsl"
#include "common/thickness.glsl"
#include "common/light_code.glsl"
#include "common/coat.glsl"

layout(constant_id = 0) const int FIRST_GAUSSIAN = 0;     // entry of the kernel that the Gaussians start at
layout(constant_id = 1) const int GAUSSIANS = 0;
layout(constant_id = 3) const bool SLAB = true;
layout(constant_id = 31) const bool MASKED = false;       // some surface scatters a share of the light alone
layout(constant_id = 2) const bool PRE = false;           // irradiance holds the square root of the colour
layout(constant_id = 5) const float THICKEST = 0.;       // mm; 0: no file says how thick its bodies are

layout(set = 0, binding = 2, r32f) uniform readonly image2D viewz;
layout(set = 0, binding = 3, r32ui) uniform readonly uimage2D normal;
layout(set = 0, binding = 4, rgba8) uniform readonly image2D albedo;
layout(set = 0, binding = 5, rgba16f) uniform image2D irradiance;
layout(set = 0, binding = 7, rg32ui) uniform readonly uimage2D coat;
// rgb weight, w variance in mm^2.
layout(set = 0, binding = 6, scalar) readonly buffer KernelBlock { vec4 entry[]; } kernel;

#include "common/behind.glsl"

const float SINK = .22;  // of the profile's length; .6 mm of skin's

void main() {
    ivec2 pixel = tile_pixel();
    if (any(greaterThanEqual(pixel, frame.size))) return;
    float z = -imageLoad(viewz, pixel).x;
    if (z <= 0.) return;
    vec3 p = view_position(pixel, z);
    vec3 n = octahedral_decode(imageLoad(normal, pixel).x);
    vec3 sum = vec3(0.);
    for (int i = 0; i < LIGHTS; ++i) {
        Light light = lights.light[i];
        float stated = THICKEST > 0. ? THICKEST * coat_thickness(imageLoad(coat, pixel).xy) : 0.;
        if (light.layer < 0 && stated == 0.) continue;
        vec3 arriving;
        vec3 l = light_arrives(light, p, arriving);
        float c = dot(n, l);
        if (c >= (SLAB ? 0. : .3)) continue;
        if (SLAB) {
            vec3 through = let_through(light, p, n, stated);
            sum += arriving * -c * through / (1. + through);
            continue;
        }
        vec3 sunk = p - n * (SINK * frame.length_mm);
        float s = stated;
        if (light.layer >= 0) {
            int layer = shadow_layer(light, p);
            s = thickness_stated(stated, thickness(light, layer, shadow_place(layer, sunk), p));
        }
        vec3 through = vec3(0.);
        for (int k = 0; k < GAUSSIANS; ++k) {
            vec4 g = kernel.entry[FIRST_GAUSSIAN + k];
            through += g.rgb * exp2(-1.44269504 * min(s * s / max(g.w, 1e-30), 80.));
        }
        sum += arriving * through * min(.3 - c, 1.);
    }
    if (PRE) sum *= imageLoad(albedo, pixel).rgb;
    if (MASKED) sum *= imageLoad(albedo, pixel).a;
    imageStore(irradiance, pixel, light_encode(imageLoad(irradiance, pixel).rgb + sum / frame.light_unit));
}
