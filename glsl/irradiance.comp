// irradiance: G-buffer, shadow -> irradiance, reflected. The start of every method that scatters light itself: what light
// falls on a pixel, before it scatters, and what its gloss reflects, which never does.
//
// irradiance = sum over lights of E max(0, n.l) visibility, plus the sky's (pi times its radiance), times the square root of
//              the surface's colour with PRE (half of it acts before scattering, half after: d'Eon & Luebke 2007)
// reflected  = specular radiance of lights and sky
// Both in units of `light_unit`, which keeps the strongest lights within a half's range.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "common/frame.glsl"
#include "common/octahedral.glsl"
#include "common/tiles.glsl"
#include "common/lights.glsl"
#include "common/shadow.glsl"
#include "common/facet_code.glsl"
#include "common/receiver.glsl"
#include "common/coat.glsl"
#include "common/specular.glsl"
#include "common/environment.glsl"
#include "common/sky_gloss.glsl"
#include "common/light_code.glsl"

layout(constant_id = 0) const bool FINAL = true;         // the lit picture: with specular and ambient light
layout(constant_id = 1) const bool SHADOWS = true;       // some light casts a shadow
layout(constant_id = 2) const bool AMBIENT = true;
layout(constant_id = 3) const bool PRE = false;

layout(set = 0, binding = 2, r32f) uniform readonly image2D viewz;
layout(set = 0, binding = 3, r32ui) uniform readonly uimage2D normal;
layout(set = 0, binding = 4, rgba8) uniform readonly image2D albedo;
layout(set = 0, binding = 5, rgba8) uniform readonly image2D material;
layout(set = 0, binding = 24, rg32ui) uniform readonly uimage2D coat;
layout(set = 0, binding = 23, r32ui) uniform readonly uimage2D smooth_normal;
layout(set = 0, binding = 6, rgba16f) uniform writeonly image2D irradiance;
layout(set = 0, binding = 7, rgba16f) uniform writeonly image2D reflected;

void main() {
    ivec2 pixel = tile_pixel();
    if (any(greaterThanEqual(pixel, frame.size))) return;
    float z = imageLoad(viewz, pixel).x;
    if (z == 0.) return;
    vec3 p = view_position(pixel, abs(z));
    vec3 v = view_direction(p);
    vec3 n = octahedral_decode(imageLoad(normal, pixel).x);
    vec4 base = FINAL ? imageLoad(albedo, pixel) : vec4(1.);
    vec4 m = FINAL ? imageLoad(material, pixel) : vec4(1., 0., 1., 0.);
    Gloss gloss;
    if (FINAL && SPECULAR) {
        Coat over = coat_none();
        vec3 smooth_n = n;
        if (COATED) {
            over = coat_decode(imageLoad(coat, pixel).xy);
            smooth_n = octahedral_decode(imageLoad(smooth_normal, pixel).x);
        }
        gloss = gloss_of(base.a > 0., dot(n, v), m.r, m.g, gloss_f0(m.a * m.a, base.rgb * base.rgb, m.g, over), over, smooth_n, v);
    }

    Receiver at = receiver(pixel, p, n);
    vec3 diffuse = vec3(0.), specular = vec3(0.);
    for (int i = 0; i < LIGHTS; ++i) {
        Light light = lights.light[i];
        vec3 arriving;
        vec3 l = light_arrives(light, p, arriving);
        if (SHADOWS && light.layer >= 0) arriving *= shadow_visibility(light, at.position, at.normal, l, mat3(frame.world_from_view), z < 0. ? frame.sharp.w : 0.);
        diffuse += max(dot(n, l), 0.) * arriving;
        if (FINAL && SPECULAR) specular += gloss_light(gloss, n, v, l) * arriving;
    }
    if (AMBIENT) {
        vec3 sky = (frame.ambient_mean + frame.ambient_slope * dot(n, frame.up)) * m.b;
        diffuse += PI * sky;
        if (SPECULAR) specular += gloss_albedo(gloss, dot(n, v)) * sky;
    }
    if (SKY) {
        diffuse += PI * m.b * sky_light(n);
        if (SPECULAR) specular += m.b * sky_reflected(gloss, n, v);
    }
    imageStore(irradiance, pixel, light_encode((PRE && z < 0. ? diffuse * base.rgb : diffuse) / frame.light_unit));
    if (FINAL && SPECULAR) imageStore(reflected, pixel, light_encode(specular / frame.light_unit));
}
