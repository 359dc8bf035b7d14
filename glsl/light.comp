// light: G-buffer, blurred levels, table, shadow -> picture (ldr, tone-mapped; or exr, linear).
// variants: lambert METHOD=0; pdss METHOD=1; moments METHOD=2; wrap METHOD=3
//
// lambert  exitance = max(0, n.l) E
// pdss     exitance_c = D(n_c.l, |H_c|) E, D pre-integrated over a sphere or a ring (Penner & Borshukov 2011), n_c and H_c a
//          channel's own mix of the blurred levels (Chen, Lambert & Penner 2014)
// moments  exitance = sum over the profile's Gaussians w E[max(0, n.l)], from mean and spread of n (common/scattering.glsl)
// wrap     exitance_c = max(0, n.l + w_c) / (1 + w_c)^2 E (McAuley; Hill 2011), w_c fitted to a sphere of the pixel's curvature
// pdss and wrap: light from behind thin parts by the thickness that the shadow map measures, or a file states.
// What a light with a slot lights (cosine times visibility) is blurred with the levels: moments takes it as it is, pdss takes
// from it how much of the unshadowed light is left. What no level carries (narrower than a pixel) is lit by the sharp normal.
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
#include "common/thickness.glsl"
#include "common/specular.glsl"
#include "common/environment.glsl"
#include "common/sky_gloss.glsl"
#include "common/scattering.glsl"
#include "common/level_code.glsl"
#include "common/tonemap.glsl"
#include "common/curvature_code.glsl"

#define LEVELLED (METHOD == 1 || METHOD == 2)

#define OUTPUT_FINAL 0
#define OUTPUT_SCATTER 1
#define OUTPUT_IRRADIANCE 2
#define OUTPUT_AO 3

layout(constant_id = 0) const int OUTPUT = OUTPUT_FINAL;
layout(constant_id = 1) const bool LOOK_UP = true;       // some light without a slot of its own casts a shadow
layout(constant_id = 2) const bool SLOTS = true;         // the lit target is there
layout(constant_id = 4) const bool AO = true;
layout(constant_id = 5) const bool AMBIENT = true;
layout(constant_id = 6) const int LEVELS = 0;
layout(constant_id = 7) const int STRIDE0 = 1;           // pixels per texel of each level
layout(constant_id = 8) const int STRIDE1 = 1;
layout(constant_id = 9) const int STRIDE2 = 1;
layout(constant_id = 10) const int STRIDE3 = 1;
layout(constant_id = 11) const int STRIDE4 = 1;
layout(constant_id = 12) const int STRIDE5 = 1;
layout(constant_id = 14) const int CURVE = 0;              // 0 Khronos PBR Neutral, 1 sRGB alone, 2 linear
layout(constant_id = 15) const bool MASS = false;        // light with a slot is gathered from level FIRST on
layout(constant_id = 16) const int FIRST = 0;
layout(constant_id = 3) const bool LOOSE = true;         // moments: some light has no slot
layout(constant_id = 31) const bool MASKED = false;      // some surface scatters a share of the light alone
layout(constant_id = 13) const bool STRIDED = false;     // some level is coarser than the picture
layout(constant_id = 17) const bool OWN = false;         // of several profiles, not the first: what does not scatter is another's

layout(set = 0, binding = 2, r32f) uniform readonly image2D viewz;
layout(set = 0, binding = 3, r32ui) uniform readonly uimage2D normal;
layout(set = 0, binding = 4, rgba8) uniform readonly image2D albedo;
layout(set = 0, binding = 5, rgba8) uniform readonly image2D material;
layout(set = 0, binding = 6, r32ui) uniform readonly uimage2D lit;
layout(set = 0, binding = 7) uniform writeonly image2D picture;
layout(set = 0, binding = 24, rg32ui) uniform readonly uimage2D coat;
layout(set = 0, binding = 23, r32ui) uniform readonly uimage2D smooth_normal;
#if LEVELLED
layout(set = 0, binding = 8, rg32ui) uniform readonly uimage2D soft0;
layout(set = 0, binding = 9, rg32ui) uniform readonly uimage2D soft1;
layout(set = 0, binding = 10, rg32ui) uniform readonly uimage2D soft2;
layout(set = 0, binding = 11, rg32ui) uniform readonly uimage2D soft3;
layout(set = 0, binding = 12, rg32ui) uniform readonly uimage2D soft4;
layout(set = 0, binding = 13, rg32ui) uniform readonly uimage2D soft5;
layout(set = 0, binding = 14, r32ui) uniform readonly uimage2D softlit0;
layout(set = 0, binding = 15, r32ui) uniform readonly uimage2D softlit1;
layout(set = 0, binding = 16, r32ui) uniform readonly uimage2D softlit2;
layout(set = 0, binding = 17, r32ui) uniform readonly uimage2D softlit3;
layout(set = 0, binding = 18, r32ui) uniform readonly uimage2D softlit4;
#if METHOD == 2
layout(set = 0, binding = 20, rgb10_a2) uniform readonly image2D mass;
#endif
layout(set = 0, binding = 19, r32ui) uniform readonly uimage2D softlit5;

struct Level {
    vec3 n;     // un-normalised
    float h;    // H times the profile's length
    vec2 lit;   // blurred cosine times visibility
};
Level level[MAX_LEVELS];

// Four texels of a coarse level around a pixel: joint bilateral weights, bilinear times closeness to the tangent plane.
struct Footprint {
    ivec2 texel[4];
    float weight[4];
};

Footprint footprint(ivec2 pixel, vec3 p0, vec3 n, int stride) {
    Footprint f;
    vec2 at = (vec2(pixel) - float(min(stride / 2, 1))) / float(stride);
    vec2 base = floor(at), t = at - base;
    ivec2 last = (frame.size + stride - 1) / stride - 1;
    float reach = float(stride) / frame.pixels_per_mm * mix(1., -p0.z, frame.perspective);
    float sum = 0.;
    for (int i = 0; i < 4; ++i) {
        ivec2 corner = ivec2(i & 1, i >> 1);
        f.texel[i] = clamp(ivec2(base) + corner, ivec2(0), last);
        ivec2 seat = representative(f.texel[i], stride);
        float z = -imageLoad(viewz, seat).x;
        vec2 b = mix(1. - t, t, vec2(corner));
        float off = dot(view_position(seat, max(z, 1e-20)) - p0, n) / reach;
        f.weight[i] = z > 0. ? (b.x * b.y + 1e-4) * exp(-min(off * off, 60.)) : 0.;
        sum += f.weight[i];
    }
    float scale = sum > 0. ? 1. / sum : 0.;
    for (int i = 0; i < 4; ++i) f.weight[i] *= scale;
    return f;
}

#define FETCH(i, STRIDE) \
    if (LEVELS > i) { \
        Level x; \
        if (STRIDE == 1) { \
            uvec2 code = imageLoad(soft##i, pixel).xy; \
            x.n = level_normal(code); \
            x.h = level_curvature(code); \
            x.lit = SLOTS ? unpackUnorm2x16(imageLoad(softlit##i, pixel).x) : vec2(0.); \
        } else { \
            x.n = vec3(0.); x.h = 0.; x.lit = vec2(0.); \
            float sum = 0.; \
            for (int k = 0; k < 4; ++k) { \
                ivec2 texel = STRIDE == 2 ? half_.texel[k] : quarter.texel[k]; \
                float w = STRIDE == 2 ? half_.weight[k] : quarter.weight[k]; \
                if (w == 0.) continue; \
                uvec2 code = imageLoad(soft##i, texel).xy; \
                x.n += w * level_normal(code); \
                x.h += w * level_curvature(code); \
                if (SLOTS) x.lit += w * unpackUnorm2x16(imageLoad(softlit##i, texel).x); \
                sum += w; \
            } \
            if (sum == 0.) { x.n = n; x.lit = sharp; } \
        } \
        level[i] = x; \
    }
#endif

#if METHOD == 1
layout(set = 0, binding = 20) uniform sampler2D lut;
#elif METHOD == 3
layout(set = 0, binding = 20, rg32ui) uniform readonly uimage2D curvature;
#endif
#if METHOD == 1 || METHOD == 3
layout(constant_id = 19) const int GAUSSIANS = 0;         // of the profile, through which light comes from behind; 0: none does
layout(constant_id = 18) const float THICKEST = 0.;       // mm; 0: no file says how thick its bodies are
// wrap: entry 0, rgb Burley's d in mm, w the widest. Then the profile's Gaussians: rgb weight, w variance in mm^2.
const int FIRST_GAUSSIAN = METHOD == 3 ? 1 : 0;
layout(set = 0, binding = 21, scalar) readonly buffer KernelBlock { vec4 entry[]; } kernel;
#include "common/behind.glsl"
#endif

void finish(ivec2 pixel, vec3 color) {
    if (CURVE < 2) color = srgb(clamp(CURVE == 0 ? neutral(color) : color, 0., 1.));
    imageStore(picture, pixel, vec4(color, 1.));
}

void main() {
    ivec2 pixel = tile_pixel();
    if (any(greaterThanEqual(pixel, frame.size))) return;
    float z = imageLoad(viewz, pixel).x;
    if (OWN && z >= 0.) return;
    if (z == 0.) {
        // The rest of a tile that holds some surface.
        imageStore(picture, pixel, vec4(0.));
        return;
    }
    bool scatters = z < 0.;
    z = abs(z);
    vec3 p = view_position(pixel, z);
    vec3 v = view_direction(p);
    vec3 n = octahedral_decode(imageLoad(normal, pixel).x);
    vec2 sharp = SLOTS ? unpackUnorm2x16(imageLoad(lit, pixel).x) : vec2(0.);

    float ao = 1.;
#if LEVELLED
    Footprint half_, quarter;
    if (STRIDED) {
        if (STRIDE0 == 2 || STRIDE1 == 2 || STRIDE2 == 2 || STRIDE3 == 2 || STRIDE4 == 2 || STRIDE5 == 2) half_ = footprint(pixel, p, n, 2);
        if (STRIDE0 == 4 || STRIDE1 == 4 || STRIDE2 == 4 || STRIDE3 == 4 || STRIDE4 == 4 || STRIDE5 == 4) quarter = footprint(pixel, p, n, 4);
    }
    FETCH(0, STRIDE0)
    FETCH(1, STRIDE1)
    FETCH(2, STRIDE2)
    FETCH(3, STRIDE3)
    FETCH(4, STRIDE4)
    FETCH(5, STRIDE5)
    if (AO && scatters) {
        // The level that sees most: narrower ones see the same occluders again.
        for (int i = 0; i < LEVELS; ++i) ao = min(ao, 1. - frame.occlusion[i].y * occlusion_of(level[i].h * frame.occlusion[i].x));
    }
    if (OUTPUT == OUTPUT_AO) {
        finish(pixel, vec3(ao));
        return;
    }
#endif
#if METHOD == 1
    // Each channel's own normal and curvature, and what reaches it of the lights with a slot.
    vec3 nr = n * frame.share[0].r, ng = n * frame.share[0].g, nb = n * frame.share[0].b;
    vec3 h = vec3(0.);
    vec3 lit0 = frame.share[0].rgb * sharp.x, lit1 = frame.share[0].rgb * sharp.y;
    for (int i = 0; i < LEVELS; ++i) {
        vec3 share = frame.share[i + 1].rgb;
        // The unblurred level has no curvature worth using: the first blurred one stands in.
        vec3 hs = i == 0 ? share + frame.share[0].rgb : share;
        nr += level[i].n * share.r;
        ng += level[i].n * share.g;
        nb += level[i].n * share.b;
        h += level[i].h * hs;
        lit0 += level[i].lit.x * share;
        lit1 += level[i].lit.y * share;
    }
    nr = normalize(nr);
    ng = normalize(ng);
    nb = normalize(nb);
    h = abs(h) / frame.length_mm;
#endif

#if METHOD == 3
    // Root mean square of the principal curvatures: 1/r on a sphere, and of all single numbers the one that serves a cylinder
    // best.
    vec3 wrap = vec3(0.);
    float bend = 0.;
    if (scatters) {
        uvec2 code = imageLoad(curvature, pixel).xy;
        float mean = curvature_mean(code), q = mix(1., z, frame.perspective) / frame.pixels_per_mm;
        bend = curvature_confidence(code) > 0. ? sqrt(max(2. * mean * mean - curvature_gauss(code, q), 0.)) : 0.;
        wrap = wrap_of(kernel.entry[0].rgb * bend);
    }
#endif

    vec4 base = imageLoad(albedo, pixel);
    vec4 m = imageLoad(material, pixel);
    vec3 color = base.rgb * base.rgb;
    float f = m.a * m.a;
    float share = MASKED && scatters ? base.a : 1.;
    Coat over = coat_none();
    vec3 smooth_n = n;
    if (COATED) {
        over = coat_decode(imageLoad(coat, pixel).xy);
        smooth_n = octahedral_decode(imageLoad(smooth_normal, pixel).x);
    }
    vec3 f0 = gloss_f0(f, color, m.g, over);
    Gloss gloss;
    if (SPECULAR) gloss = gloss_of(base.a > 0., dot(n, v), m.r, m.g, f0, over, smooth_n, v);
    vec3 kept = SPECULAR ? (1. - m.g) * (1. - gloss_taken(gloss)) : vec3(1.);

#if METHOD == 2
    vec3 masses = MASS ? .5 / max(imageLoad(mass, pixel).rgb, .01) : vec3(1.);
    // What each slot's lights come to. Where light is gathered, a level weighs as much as the surface that it finds.
    vec3 weights = frame.sharp.rgb, slot0 = weights * sharp.x, slot1 = weights * sharp.y;
    for (int k = 0; k < LEVELS; ++k) {
        vec3 weight = frame.level[k].rgb;
        if (MASS && k >= FIRST) weight *= masses[k - FIRST];
        weights += weight;
        slot0 += weight * level[k].lit.x;
        slot1 += weight * level[k].lit.y;
    }
    if (MASS) {
        slot0 /= weights;
        slot1 /= weights;
    }
#endif
    Receiver at = receiver(pixel, p, n);
    vec3 exitance = vec3(0.), reflected = vec3(0.), arriving = vec3(0.);
    for (int i = 0; i < LIGHTS; ++i) {
        Light light = lights.light[i];
        vec3 irradiance;
        vec3 l = light_arrives(light, p, irradiance);
        float c = dot(n, l);
        bool slotted = SLOTS && light.slot >= 0;
        float own = light.slot == 0 ? sharp.x : sharp.y;
        float shade = 1.;
        if (slotted && light.part == 1.) shade = c > 1e-3 ? min(own / c, 1.) : 0.;
        else if (LOOK_UP && light.layer >= 0) {
            vec3 from = at.position;
#if METHOD == 3
            // Beyond the terminator a surface hides itself from the light. It is asked for from where a sphere of its
            // curvature no longer does, no further up than light travels.
            float sine = min(-c, .99);
            if (scatters && c < 0.) from += n * min((inversesqrt(1. - sine * sine) - 1.) / max(bend, 1e-9), 4. * kernel.entry[0].w);
#endif
            shade = shadow_visibility(light, from, at.normal, l, mat3(frame.world_from_view), scatters ? frame.sharp.w : 0.);
        }
        vec3 lit_here = vec3(slotted ? own : max(c, 0.) * shade), unscattered = lit_here;
#if METHOD == 1
        if (scatters) {
            vec3 cosine = vec3(dot(nr, l), dot(ng, l), dot(nb, l));
            lit_here.r = lut_look_up(lut, cosine.r, h.r, 0.);
            lit_here.g = lut_look_up(lut, cosine.g, h.g, 1.);
            lit_here.b = lut_look_up(lut, cosine.b, h.b, 2.);
            if (slotted) {
                // The share that shadows leave: blurred shadowed over blurred unshadowed light of the same levels. Where
                // both vanish nothing is cast, the surface merely turns away.
                vec3 free = frame.share[0].rgb * max(c, 0.);
                for (int k = 0; k < LEVELS; ++k) free += frame.share[k + 1].rgb * moment(level[k].n, l);
                lit_here *= min(((light.slot == 0 ? lit0 : lit1) + .003) / (free + .003), 1.);
            } else {
                lit_here *= shade;
            }
        }
#elif METHOD == 3
        if (scatters) lit_here = max(c + wrap, 0.) / ((1. + wrap) * (1. + wrap)) * shade;
#elif METHOD == 2
        if (scatters) {
            vec3 scattered = light.slot == 0 ? slot0 : slot1;
            if (LOOSE) {
                vec3 loose = lit_here * frame.sharp.rgb;
                for (int k = 0; k < LEVELS; ++k) loose += frame.level[k].rgb * (moment(level[k].n, l) * shade);
                if (!slotted) scattered = loose;
            }
            lit_here = scattered;
        }
#endif
#if METHOD == 1 || METHOD == 3
        if (GAUSSIANS > 0 && scatters && c < 0.) {
            float stated = THICKEST > 0. ? THICKEST * coat_thickness(imageLoad(coat, pixel).xy) : 0.;
            lit_here = from_behind(light, c, p, n, stated, lit_here);
        }
#endif
        if (MASKED && share < 1.) lit_here = mix(unscattered, lit_here, share);
        exitance += lit_here * irradiance;
        if (OUTPUT == OUTPUT_IRRADIANCE) arriving += max(c, 0.) * shade * irradiance;
        if (SPECULAR && OUTPUT == OUTPUT_FINAL) reflected += gloss_light(gloss, n, v, l) * irradiance * shade;
    }
    if (OUTPUT == OUTPUT_SCATTER) {
        finish(pixel, exitance);
        return;
    }
    if (OUTPUT == OUTPUT_IRRADIANCE) {
        finish(pixel, arriving);
        return;
    }
    vec3 radiance = kept * color * exitance / PI + reflected;
    if (AMBIENT) {
        // A sky that is linear in n.up is scattered exactly by the mean normal.
        vec3 tilt = vec3(dot(n, frame.up));
#if METHOD == 2
        if (scatters) {
            tilt *= frame.sharp.rgb;
            for (int k = 0; k < LEVELS; ++k) tilt += frame.level[k].rgb * dot(level[k].n, frame.up);
        }
#endif
        if (MASKED && share < 1.) tilt = mix(vec3(dot(n, frame.up)), tilt, share);
        vec3 sky = (frame.ambient_mean + frame.ambient_slope * tilt) * ao * m.b;
        radiance += kept * color * sky;
        if (SPECULAR) radiance += gloss_albedo(gloss, dot(n, v)) * sky;
    }
    if (SKY) {
        vec3 white = sky_light(n);
#if METHOD == 1
        if (scatters) white = sky_scattered(mat3(nr, ng, nb), h);
#elif METHOD == 3
        if (scatters) white = sky_scattered(mat3(n, n, n), vec3(bend));
#elif METHOD == 2
        if (scatters) {
            // Mean normals scatter band 1 exactly; how short they are tells how much of band 2 is left.
            white = environment.harmonic[0] + frame.sharp.rgb * (sky_linear(n) + sky_square(n));
            for (int k = 0; k < LEVELS; ++k) {
                vec3 mean = level[k].n;
                white += frame.level[k].rgb * (sky_linear(mean) + sky_spread(dot(mean, mean)) * sky_square(mean));
            }
            white = max(white, 0.);
        }
#endif
        if (MASKED && share < 1.) white = mix(sky_light(n), white, share);
        vec3 light = kept * color * white;
        if (SPECULAR) light += sky_reflected(gloss, n, v);
        radiance += light * ao * m.b;
    }
    finish(pixel, radiance * frame.exposure);
}
