// seams: gutter, sheet -> sheet. Fills the strip beside each cut of the unwrapping with what lies on its other side, so that the
// blur goes on over the cut. Between a fill and the next the strip is not blurred itself: it is filled anew.
#version 460
#extension GL_EXT_scalar_block_layout : require

layout(local_size_x = 64) in;

layout(set = 0, binding = 2, rgba16f) uniform image2D sheet;
// x: a texel, y << 16 | x. y, z: place in texels that it shows, float bits. w: the chart that it belongs to, float bits.
layout(set = 0, binding = 3, scalar) readonly buffer GutterBlock { uvec4 texel[]; } gutter;

void main() {
    // One row of threads would be more workgroups than a device need allow.
    uint index = gl_GlobalInvocationID.y * gl_NumWorkGroups.x * 64u + gl_GlobalInvocationID.x;
    if (index >= uint(gutter.texel.length())) return;
    uvec4 entry = gutter.texel[index];
    ivec2 here = ivec2(entry.x & 0xffffu, entry.x >> 16), last = imageSize(sheet) - 1;
    // What a chart covers is its own.
    if (imageLoad(sheet, here).a > 0.) return;
    vec2 at = uintBitsToFloat(entry.yz) - .5, base = floor(at), f = at - base;
    vec4 sum = vec4(0.);
    for (int k = 0; k < 4; ++k) {
        ivec2 corner = ivec2(k & 1, k >> 1);
        vec4 light = imageLoad(sheet, clamp(ivec2(base) + corner, ivec2(0), last));
        vec2 w = mix(1. - f, f, vec2(corner));
        // Gutters hold negative numbers: a strip is not filled from a strip.
        if (light.a > 0.) sum += w.x * w.y * vec4(light.rgb, 1.);
    }
    if (sum.a > .01) imageStore(sheet, here, vec4(sum.rgb / sum.a, -uintBitsToFloat(entry.w)));
}
