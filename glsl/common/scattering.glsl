// The two lighting forms. Twins in f64: src/skin/lut.rs, src/skin/moments.rs.

// D(mu, curvature) of one channel. The table is R16F, a channel above the other: three fetches of one channel cost a third of
// three fetches of four. u: two straight pieces in mu that break at texels; v: x / (x + 1), x the root
// of curvature / knee.
float lut_look_up(sampler2D lut, float mu, float curvature, float channel) {
    vec2 size = vec2(textureSize(lut, 0)) * vec2(1., 1. / 3.);
    float a = min(abs(mu), 1.);
    float t = sign(mu) * min(4. * a, (4. * a + 3.) / 7.);
    float root = sqrt(min(abs(curvature), 1e30));
    vec2 at = (vec2(.5 + .5 * t, root / (root + sqrt(frame.lut_knee))) * (size - 1.) + .5) / size;
    return textureLod(lut, vec2(at.x, (at.y + channel) * (1. / 3.)), 0.).r;
}

// E max(0, X), X normal with mean c and standard deviation s >= 0. Error below 2.4e-5 s; s = 0 gives max(0, c).
float rectified(float c, float s) {
    float z = abs(c) / max(s, 1e-8);
    return max(c, 0.) + s * exp2(-(1.3258326 + z * (1.8057098 + z * (.42119398 + z * .032454884))));
}

// Scattered clamped cosine of one Gaussian from its blurred, un-normalised normal: n.l has mean n.l and a spread that
// 1 - |n|^2 tells, even over the tangent plane.
float moment(vec3 n, vec3 l) {
    float c = dot(n, l), square = dot(n, n);
    float spread = max(1. - square, 0.) * .5 * max(1. - c * c / max(square, 1e-8), 0.);
    return rectified(c, sqrt(spread));
}

// How far a cosine is wrapped on a sphere whose radius is 1 / x of Burley's d, so that max(0, mu + w) / (1 + w)^2 is near what the
// sphere scatters: a fit, .051 rms at worst. Twin in f64: src/skin/burley.rs.
vec3 wrap_of(vec3 x) {
    vec3 t = pow(min(x, 1e6), vec3(1.8307));
    return 5.3052 * t / (1. + 4.6665 * t);
}

// Occlusion of a concave patch within R by its mean curvature alone, quadratic falloff: 5/16 (H R)^2, between a bowl's 1/4
// and a trough's 3/8 times 1/2 of the falloff, saturating as the bowl does. h = H R, convex > 0.
float occlusion_of(float h) {
    float c = min(h, 0.) * .5;
    float square = c * c * 1.25;
    return square <= 1. ? .5 * square : 1. - .5 / square;
}
