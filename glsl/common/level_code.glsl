// A blurred level, RG32_UINT: the un-normalised mean normal as three snorm16 (a half would lose 1 - |n|^2, by which the
// spread is told), and H times the profile's length as a half.
uvec2 level_encode(vec3 n, float h) {
    return uvec2(packSnorm2x16(n.xy), (packSnorm2x16(vec2(n.z, 0.)) & 0xffffu) | packHalf2x16(vec2(h, 0.)) << 16);
}

vec3 level_normal(uvec2 code) {
    return vec3(unpackSnorm2x16(code.x), unpackSnorm2x16(code.y & 0xffffu).x);
}

float level_curvature(uvec2 code) {
    return unpackHalf2x16(code.y >> 16).x;
}
