// The triangle itself beside what its vertices' normals make of it: its normal, octahedral, whose lowest five bits of each half,
// 3.5e-3 of a radian at most, are the rise of the surface above it (rise.glsl). Needs octahedral.glsl.
// The rise is in pixels, a thirty-second of an octave a step from 2^-16 on; code 0: none.
uint facet_encode(vec3 normal, float rise) {
    uint code = uint(clamp(32. * log2(max(rise, 1e-30)) + 512., 0., 1023.));
    return octahedral_encode(normal) & 0xffe0ffe0u | code & 31u | code >> 5 << 16;
}

float facet_rise(uint facet) {
    uint code = facet & 31u | (facet >> 16 & 31u) << 5;
    return code == 0u ? 0. : exp2((float(code) - 511.5) / 32.);
}
