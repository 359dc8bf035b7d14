// visibility: viewz, normal, facet, shadow -> lit; and litgeo where light is gathered and normals stray from the surface.
// variants: plain GEO=0; geo GEO=1
//
// Clamped cosine times visibility of the lights with a slot, a channel a light, or the mean of those that share one, before it is scattered. Not
// visibility alone: where a surface turns away from the light its shadow map says nothing, and blurring that nothing would
// darken every terminator twice. The product blurs exactly, and costs no channel more.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "common/frame.glsl"
#include "common/octahedral.glsl"
#include "common/tiles.glsl"
#include "common/lights.glsl"
#include "common/shadow.glsl"
#include "common/facet_code.glsl"
#include "common/receiver.glsl"

layout(set = 0, binding = 2, r32f) uniform readonly image2D viewz;
layout(set = 0, binding = 3, r32ui) uniform readonly uimage2D normal;
layout(set = 0, binding = 4, r32ui) uniform writeonly uimage2D lit;

#if GEO
layout(set = 0, binding = 6, r32ui) uniform writeonly uimage2D litgeo;
#endif

void main() {
    ivec2 pixel = tile_pixel();
    if (any(greaterThanEqual(pixel, frame.size))) return;
    float stored = imageLoad(viewz, pixel).x, z = abs(stored), narrow = stored < 0. ? frame.sharp.w : 0.;
    if (z == 0.) return;
    vec3 position = view_position(pixel, z);
    vec3 n = octahedral_decode(imageLoad(normal, pixel).x);
    Receiver at = receiver(pixel, position, n);
    vec2 seen = vec2(0.);
#if GEO
    vec2 seen_bare = vec2(0.);
#endif
    for (int i = 0; i < LIGHTS; ++i) {
        Light light = lights.light[i];
        if (light.slot < 0) continue;
        vec3 irradiance;
        vec3 l = light_arrives(light, position, irradiance);
        float c = max(dot(n, l), 0.);
#if GEO
        float bare = max(dot(at.normal, l), 0.);
#else
        float bare = 0.;
#endif
        if (c + bare == 0.) continue; // nothing times whatever the map says
        float open = light.part * shadow_visibility(light, at.position, at.normal, l, mat3(frame.world_from_view), narrow);
        float v = c * open;
#if GEO
        float w = bare * open;
        if (light.slot == 0) seen_bare.x += w; else seen_bare.y += w;
#endif
        if (light.slot == 0) seen.x += v; else seen.y += v;
    }
    imageStore(lit, pixel, uvec4(packUnorm2x16(seen)));
#if GEO
    imageStore(litgeo, pixel, uvec4(packUnorm2x16(seen_bare)));
#endif
}
