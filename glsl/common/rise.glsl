// How far the surface that vertex normals mean rises above its triangle, mm: where shadow maps are asked from, so that coarse
// triangles do not shade each other at terminators (Hanika 2021).
//
// The tangent planes of the corners, mixed as attributes are, are one plane: `normal` . x = `plane`, both interpolated, none made
// unit. No less than 0: what is hollow keeps its triangles, and so does what is seen from behind.
float rise(vec3 normal, float plane, vec3 p, bool front) {
    return front ? max(plane - dot(normal, p), 0.) : 0.;
}

// The triangle's own normal, on the side of `side`; p's derivatives span it.
vec3 facet_normal(vec3 p, vec3 n, vec3 side) {
    vec3 f = cross(dFdx(p), dFdy(p));
    float ff = dot(f, f);
    f = ff > 0. ? f * inversesqrt(ff) : n;
    return dot(f, side) < 0. ? -f : f;
}
