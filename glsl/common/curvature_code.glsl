// One pixel's curvature in two words (rg32ui). What `curvature` writes, and whoever blurs or lights reads.
//   x  H in 1/mm, convex > 0, as float bits: curvature spans nine decades of scale, no shorter float holds that
//   y  half: sign(K) sqrt|K| q, in [-2, 2] at every scale, q the pixel's footprint in mm; half: confidence 0..1
uvec2 curvature_encode(float mean, float gauss_q2, float confidence) {
    return uvec2(floatBitsToUint(mean), packHalf2x16(vec2(sign(gauss_q2) * sqrt(abs(gauss_q2)), confidence)));
}

// H, 1/mm.
float curvature_mean(uvec2 code) {
    return uintBitsToFloat(code.x);
}

// K, 1/mm^2, at a pixel of footprint q (mm).
float curvature_gauss(uvec2 code, float q) {
    float root = unpackHalf2x16(code.y).x / q;
    return root * abs(root);
}

float curvature_confidence(uvec2 code) {
    return unpackHalf2x16(code.y).y;
}
