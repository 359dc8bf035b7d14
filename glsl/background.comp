// background: viewz or depth, sky -> picture (ldr, tone-mapped; or exr, linear), where no surface is. A is 1 there.
// variants: screen FORWARD=0; forward FORWARD=1
//
// The picture is magnified by a cubic B-spline in four bilinear fetches (Sigg & Hadwiger 2005): a blurred sky is a coarse mip,
// and bilinear magnification would show its texels.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "common/frame.glsl"
#include "common/environment.glsl"
#include "common/tonemap.glsl"
layout(local_size_x = 8, local_size_y = 8) in;

layout(constant_id = 0) const int CURVE = 0;             // 0 Khronos PBR Neutral, 1 sRGB alone, 2 linear

#if FORWARD
layout(set = 0, binding = 2) uniform sampler2D depth;
#else
layout(set = 0, binding = 2, r32f) uniform readonly image2D viewz;
#endif
layout(set = 0, binding = 3) uniform writeonly image2D picture;

vec3 cubic(vec2 place, float level) {
    vec2 size = vec2(textureSize(sky, int(level)));
    vec2 at = place * size - .5, base = floor(at), f = at - base, g = 1. - f;
    vec2 w0 = g * g * g / 6., w1 = (4. - 6. * f * f + 3. * f * f * f) / 6., w3 = f * f * f / 6.;
    vec2 near = w0 + w1, far = 1. - near;
    vec2 a = (base - .5 + w1 / near) / size, b = (base + 1.5 + w3 / far) / size;
    return near.y * (near.x * textureLod(sky, a, level).rgb + far.x * textureLod(sky, vec2(b.x, a.y), level).rgb)
         + far.y * (near.x * textureLod(sky, vec2(a.x, b.y), level).rgb + far.x * textureLod(sky, b, level).rgb);
}

void main() {
    ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
    if (any(greaterThanEqual(pixel, frame.size))) return;
#if FORWARD
    if (texelFetch(depth, pixel, 0).x > 0.) return;
#else
    if (imageLoad(viewz, pixel).x != 0.) return;
#endif
    vec3 ray = frame.perspective > .5 ? normalize(view_ray(pixel)) : vec3(0., 0., -1.);
    // No finer than the pixels are.
    float texels = .15915494 * float(textureSize(sky, 0).x) / frame.pixels_per_mm;
    float level = max(environment.blur, frame.perspective > .5 ? log2(max(texels, 1.)) : 0.);
    level = min(level, environment.last);
    vec2 place = sky_place(ray);
    float whole = floor(level);
    vec3 color = mix(cubic(place, whole), cubic(place, min(whole + 1., environment.last)), level - whole);
    color *= environment.intensity * frame.exposure;
    if (CURVE < 2) color = srgb(clamp(CURVE == 0 ? neutral(color) : color, 0., 1.));
    imageStore(picture, pixel, vec4(color, 1.));
}
