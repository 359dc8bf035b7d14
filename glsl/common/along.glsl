// Light at a fraction of a pixel along a row or a column, for passes that blur along one. Wants `viewz` and `source`.
//
// Linear between two texels, as a filtered fetch would be; but each is judged first: one that lies deeper or nearer is moved
// towards the centre's own light, s = min(|dz| per_mm, 1) of the way (Jimenez & Gutierrez 2010), and one that shows no
// scattering surface is not looked at at all: it may hold anything.
vec3 along_texel(ivec2 at, vec3 centre, float z, float per_mm) {
    at = clamp(at, ivec2(0), frame.size - 1);
    float there = -imageLoad(viewz, at).x;
    float s = there > 0. ? min(abs(there - z) * per_mm, 1.) : 1.;
    return s < 1. ? mix(imageLoad(source, at).rgb, centre, s) : centre;
}

vec3 along(ivec2 pixel, ivec2 axis, float offset, vec3 centre, float z, float per_mm) {
    // An offset beyond the integers' range must not wrap.
    offset = clamp(offset, -1e6, 1e6);
    float base = floor(offset);
    ivec2 at = pixel + axis * int(base);
    vec3 a = along_texel(at, centre, z, per_mm), b = along_texel(at + axis, centre, z, per_mm);
    return mix(a, b, offset - base);
}

// What a length on the surface is shortened to along the axis, 0..1: 1 / sqrt(1 + slope^2), the slope from the nearer of two
// neighbours, so that a step in depth is none.
float along_shortening(ivec2 pixel, ivec2 axis, float z) {
    float a = -imageLoad(viewz, min(pixel + axis, frame.size - 1)).x, b = -imageLoad(viewz, max(pixel - axis, ivec2(0))).x;
    float da = a > 0. ? abs(a - z) : 1e9, db = b > 0. ? abs(b - z) : 1e9, d = min(da, db);
    float slope = d < 1e9 ? d * frame.pixels_per_mm / mix(1., z, frame.perspective) : 0.;
    return inversesqrt(1. + slope * slope);
}
