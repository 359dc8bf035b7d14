// forward: meshes, shadow, lut, penumbra -> picture (ldr, tone-mapped; or exr, linear), depth. Pre-integrated skin shading as its
// authors have it (Penner & Borshukov 2011): one raster pass that lights what it draws; no other target, no blur.
//
// exitance_c = E D_c(n_c.l, curvature) S_c(u, n.l) for each channel c
//   D          pre-integrated over a sphere or a ring of the surface's curvature (common/scattering.glsl)
//   curvature  |fwidth N| / |fwidth P|, constant over a quad and, with flat interpolation of N, over a triangle; or of the mesh,
//              interpolated (BEND)
//   n_c        the normal map, filtered as wide as light of the channel travels: a level of its mip chain; the mesh's own
//              normal where there is no map
//   S          the profile over the edge of a shadow whose penumbra is u lit (common/penumbra.glsl)
// Specular light takes the unfiltered normal and the unscattered shadow.
// variants: derivative BEND=0; vertex BEND=1
#version 460
#extension GL_GOOGLE_include_directive : require
#include "common/frame.glsl"
#define LAYERED
#include "common/coat.glsl"
#include "common/material.glsl"
#include "common/rise.glsl"
#include "common/lights.glsl"
#include "common/shadow.glsl"
#include "common/thickness.glsl"
#include "common/specular.glsl"
#include "common/environment.glsl"
#include "common/sky_gloss.glsl"
#include "common/scattering.glsl"
#include "common/penumbra.glsl"
#include "common/tonemap.glsl"

#define OUTPUT_FINAL 0
#define OUTPUT_SCATTER 1
#define OUTPUT_IRRADIANCE 2
#define NORMALS_ONE 0
#define NORMALS_TWO 1
#define NORMALS_THREE 2

layout(constant_id = 0) const int OUTPUT = OUTPUT_FINAL;
layout(constant_id = 1) const bool SHADOWS = true;
layout(constant_id = 7) const bool AMBIENT = true;
layout(constant_id = 8) const int CURVE = 0;             // 0 Khronos PBR Neutral, 1 sRGB alone, 2 linear
layout(constant_id = 9) const int NORMALS = NORMALS_ONE; // normals a channel
layout(constant_id = 31) const bool MASKED = false;     // some surface scatters a share of the light alone
layout(constant_id = 10) const int TAPS = 1;             // of the shadow's disc; 1: a hard shadow, no S

layout(set = 0, binding = 20) uniform sampler2D lut;
layout(set = 0, binding = 21) uniform sampler2D penumbra;
layout(constant_id = 12) const int GAUSSIANS = 0;        // of the profile, through which light comes from behind; 0: none does
layout(constant_id = 33) const float THICKEST = 0.;      // mm; 0: no file says how thick its bodies are
const int FIRST_GAUSSIAN = 1;
// Entry 0: rgb sigma (mm) by which each channel's normal is blurred, w diameter (mm) of the shadow's disc. Then the profile's
// Gaussians: rgb weight, w variance in mm^2.
layout(set = 0, binding = 6, scalar) readonly buffer KernelBlock { vec4 entry[]; } kernel;
#include "common/behind.glsl"

layout(location = 0) in vec3 view_normal;
layout(location = 1) in vec4 uv;
layout(location = 2) in vec4 view_tangent;
layout(location = 3) in float view_distance;
layout(location = 6) in float plane;
#if BEND
layout(location = 4) in float bend;
#endif

layout(location = 0) out vec4 picture;

// Level of the normal map whose bilinear footprint (variance 4^level / 4 texels^2) is as wide as a Gaussian of sigma mm; the
// sampler's own level where that is coarser. `texels` a mm.
vec3 filtered(float sigma, float texels, float own, vec3 n) {
    float level = max(log2(max(2. * sigma * texels, 1e-4)), own);
    return material_bumped(n, view_tangent, textureLod(normal_map, slot_uv(uv, 2), level).xyz, gl_FrontFacing);
}

void main() {
    // Derivatives first: they need whole quads.
    vec3 n = material_normal(view_normal, gl_FrontFacing);
    ivec2 pixel = ivec2(gl_FragCoord.xy);
    vec3 p = view_position(pixel, view_distance);
    vec3 v = view_direction(p), facet = facet_normal(p, n, v), from = p + facet * rise(view_normal, plane, p, gl_FrontFacing);
    float curvature = length(fwidth(n)) / max(length(fwidth(p)), 1e-20);
#if BEND
    curvature = bend;
#endif
    float texels = 0., own = 0.;
    if (NORMAL_MAP && NORMALS > NORMALS_ONE) {
        vec2 size = vec2(textureSize(normal_map, 0)), at = slot_uv(uv, 2), du = dFdx(at) * size, dv = dFdy(at) * size;
        float area = length(cross(dFdx(p), dFdy(p)));
        texels = sqrt(abs(du.x * dv.y - du.y * dv.x) / max(area, 1e-20));
        own = textureQueryLod(normal_map, at).y;
    }
    vec4 base = material_base(uv);
    vec3 b = material_shading_normal(n, view_tangent, uv, gl_FrontFacing);
    vec2 rm = material_rough_metal(uv);
    float occlusion = material_occlusion(uv);
    float scatter = material_scatter(uv), reflectance = material_reflectance(scatter);
    Coat over = coat_none();
    if (COATED) over = material_coat(uv, reflectance);
    if (ALPHA_MASK && base.a < push.alpha_cutoff) discard;

    vec3 color = clamp(base.rgb, 0., 1.);
    vec3 f0 = gloss_f0(reflectance, color, rm.y, over);
    bool scatters = scatter > 0.;
    vec4 widths = kernel.entry[0];
    Gloss gloss;
    if (SPECULAR && OUTPUT == OUTPUT_FINAL) gloss = gloss_of(scatter != 0., dot(b, v), rm.x, rm.y, f0, over, n, v);
    mat3 bent = mat3(b, b, b);
    if (NORMAL_MAP && NORMALS > NORMALS_ONE) {
        bent[0] = filtered(widths.r, texels, own, n);
        if (NORMALS == NORMALS_THREE) {
            bent[1] = filtered(widths.g, texels, own, n);
            bent[2] = filtered(widths.b, texels, own, n);
        }
    }
    // Interleaved gradient noise (Jimenez 2014).
    float turn = 6.2831853 * fract(52.9829189 * fract(dot(vec2(pixel), vec2(.06711056, .00583715))));

    vec3 exitance = vec3(0.), reflected = vec3(0.);
    for (int i = 0; i < LIGHTS; ++i) {
        Light light = lights.light[i];
        vec3 arriving;
        vec3 l = light_arrives(light, p, arriving);
        if (NORMAL_MAP && NORMALS == NORMALS_TWO) {
            // Between the blurred and the sharp normal, the closer to the blurred the further from the light (NVIDIA FaceWorks).
            float f = 1. - clamp(dot(bent[0], l), 0., 1.);
            f *= f;
            bent[1] = normalize(mix(b, bent[0], .3 + .7 * f));
            bent[2] = normalize(mix(b, bent[0], f));
        }
        vec3 cosine = vec3(dot(bent[0], l), dot(bent[1], l), dot(bent[2], l));
        float c = dot(n, l), seen = 1.;
        vec3 shade = vec3(1.);
        if (SHADOWS && light.layer >= 0) {
            seen = scatters ? shadow_disc(light, from, n, l, curvature, .5 * widths.w, TAPS, turn, mat3(frame.world_from_view))
                            : shadow_visibility(light, from, facet, l, mat3(frame.world_from_view), 0.);
            shade = TAPS > 1 && scatters ? penumbra_look_up(penumbra, seen, c) : vec3(seen);
        }
        vec3 lit = max(cosine, 0.), unscattered = max(dot(b, l), 0.) * seen * arriving;
        if (scatters && OUTPUT != OUTPUT_IRRADIANCE) {
            lit.r = lut_look_up(lut, cosine.r, curvature, 0.);
            lit.g = lut_look_up(lut, cosine.g, curvature, 1.);
            lit.b = lut_look_up(lut, cosine.b, curvature, 2.);
        }
        lit *= shade;
        if (GAUSSIANS > 0 && scatters && c < 0.) {
            float stated = THICKEST > 0. ? THICKEST * material_thickness(uv) : 0.;
            lit = from_behind(light, c, p, n, stated, lit);
        }
        if (OUTPUT == OUTPUT_IRRADIANCE) exitance += unscattered;
        else if (MASKED && scatters && scatter < 1.) exitance += mix(unscattered, lit * arriving, scatter);
        else exitance += lit * arriving;
        if (SPECULAR && OUTPUT == OUTPUT_FINAL) reflected += gloss_light(gloss, b, v, l) * arriving * seen;
    }
    vec3 radiance = exitance;
    if (OUTPUT == OUTPUT_FINAL) {
        vec3 mirrored = vec3(0.), kept = vec3(1.);
        if (SPECULAR) {
            mirrored = gloss_albedo(gloss, dot(b, v));
            kept = (1. - rm.y) * (1. - gloss_taken(gloss));
        }
        radiance = kept * color * exitance / PI + reflected;
        if (AMBIENT) {
            vec3 up = frame.up;
            vec3 tilt = scatters ? vec3(dot(bent[0], up), dot(bent[1], up), dot(bent[2], up)) : vec3(dot(b, up));
            if (MASKED && scatters && scatter < 1.) tilt = mix(vec3(dot(b, up)), tilt, scatter);
            radiance += kept * color * (frame.ambient_mean + frame.ambient_slope * tilt) * occlusion;
            radiance += mirrored * (frame.ambient_mean + frame.ambient_slope * dot(b, up)) * occlusion;
        }
        if (SKY) {
            vec3 white = scatters ? sky_scattered(bent, vec3(curvature)) : sky_light(b);
            if (MASKED && scatters && scatter < 1.) white = mix(sky_light(b), white, scatter);
            vec3 light = kept * color * white;
            if (SPECULAR) light += sky_reflected(gloss, b, v);
            radiance += light * occlusion;
        }
        radiance *= frame.exposure;
    }
    if (CURVE < 2) radiance = srgb(clamp(CURVE == 0 ? neutral(radiance) : radiance, 0., 1.));
    picture = vec4(radiance, 1.);
}
