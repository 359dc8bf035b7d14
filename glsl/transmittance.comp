// transmittance: viewz, normal, albedo, shadow, irradiance -> irradiance. Light that enters a thin part from behind and leaves
// towards the eye (Jimenez, Whelan, Sundstedt & Gutierrez 2010); it is blurred with the rest, as the authors do it.
//
// irradiance += E T(s) max(0, OFFSET - n.l), T(s) = sum over the profile's Gaussians of w exp(-s^2 / (WIDEN v)), s the thickness
// in mm along the light: from the surface that the shadow map holds to this one, sunk by SINK along its normal, so that a texel
// of what faces the light is not taken for something in front of it. As published OFFSET is .3 and WIDEN 1; 0 and 2 are what a
// slab that is lit from behind shows exactly, and add nothing on the near side of a terminator.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "common/frame.glsl"
#include "common/octahedral.glsl"
#include "common/tiles.glsl"
#include "common/lights.glsl"
#include "common/shadow.glsl"
#include "common/light_code.glsl"

layout(constant_id = 0) const int FIRST = 0;              // entry of the kernel that the Gaussians start at
layout(constant_id = 1) const int GAUSSIANS = 0;
layout(constant_id = 2) const bool PRE = false;           // irradiance holds the square root of the colour
layout(constant_id = 3) const float OFFSET = .3;
layout(constant_id = 4) const float WIDEN = 1.;

layout(set = 0, binding = 2, r32f) uniform readonly image2D viewz;
layout(set = 0, binding = 3, r32ui) uniform readonly uimage2D normal;
layout(set = 0, binding = 4, rgba8) uniform readonly image2D albedo;
layout(set = 0, binding = 5, rgba16f) uniform image2D irradiance;
// rgb weight, w variance in mm^2.
layout(set = 0, binding = 6, scalar) readonly buffer KernelBlock { vec4 entry[]; } kernel;

const float SINK = .22;  // of the profile's length; .6 mm of skin's

// Thickness in mm along the light, bilinear; 0 where nothing lies in front.
float thickness(Light light, vec3 position, vec3 normal) {
    int layer = light.layer;
    vec3 d = position - light.position;
    if (!ALL_DIRECTIONAL && light.kind == LIGHT_POINT) layer += shadow_face(mat3(frame.world_from_view) * d);
    mat4 m = lights.shadow_from_view[layer];
    vec4 q = m * vec4(position - normal * (SINK * frame.length_mm), 1.);
    bool parallel = ALL_DIRECTIONAL || light.kind == LIGHT_DIRECTIONAL;
    if (!parallel && q.w <= 0.) return 1e9;
    vec2 size = vec2(textureSize(shadow, 0).xy), at = (q.xy / q.w * .5 + .5) * size - .5, base = floor(at), f = at - base;
    vec4 map = textureGather(shadow, vec3((base + 1.) / size, float(layer)));
    vec4 mm;
    if (parallel) {
        // Reversed depth is linear: so much a mm.
        mm = (map - q.z) * inversesqrt(m[0].z * m[0].z + m[1].z * m[1].z + m[2].z * m[2].z);
    } else {
        // Infinite reversed depth is near / distance.
        mm = (q.w - q.z / max(map, vec4(1e-20))) * (length(d) / q.w);
    }
    // A texel that nothing covers is in front of nothing.
    mm = max(mm, vec4(0.));
    return mix(mix(mm.w, mm.z, f.x), mix(mm.x, mm.y, f.x), f.y);
}

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
        if (light.layer < 0) continue;
        vec3 arriving;
        vec3 l = light_arrives(light, p, arriving);
        float behind = max(OFFSET - dot(n, l), 0.);
        if (behind == 0.) continue;
        float s = thickness(light, p, n);
        vec3 through = vec3(0.);
        for (int k = 0; k < GAUSSIANS; ++k) {
            vec4 g = kernel.entry[FIRST + k];
            through += g.rgb * exp2(-1.44269504 * min(s * s / (WIDEN * max(g.w, 1e-30)), 80.));
        }
        sum += arriving * through * min(behind, 1.);
    }
    if (PRE) sum *= imageLoad(albedo, pixel).rgb;
    imageStore(irradiance, pixel, light_encode(imageLoad(irradiance, pixel).rgb + sum / frame.light_unit));
}
