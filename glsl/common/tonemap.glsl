// Tone curves and the sRGB transfer function.

// Khronos PBR Neutral tone mapper (2024): removes the 4 % Fresnel veil, then compresses the peak and desaturates it.
vec3 neutral(vec3 color) {
    const float start = .8 - .04, desaturation = .15;
    float x = min(color.r, min(color.g, color.b));
    color -= x < .08 ? x - 6.25 * x * x : .04;
    float peak = max(color.r, max(color.g, color.b));
    if (peak < start) return color;
    float d = 1. - start;
    float squeezed = 1. - d * d / (peak + d - start);
    color *= squeezed / peak;
    float g = 1. - 1. / (desaturation * (peak - squeezed) + 1.);
    return mix(color, vec3(squeezed), g);
}

vec3 srgb(vec3 c) {
    return mix(1.055 * pow(c, vec3(1. / 2.4)) - .055, 12.92 * c, lessThanEqual(c, vec3(.0031308)));
}
