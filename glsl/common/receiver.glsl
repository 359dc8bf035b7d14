// Where a pixel is held against shadow maps, and the plane through it: of the triangle, on the surface above it, where shading normals
// stray from triangles; else the pixel's own. Needs frame.glsl and facet_code.glsl.
layout(constant_id = 33) const bool FACETS = false;
layout(set = 0, binding = 22, r32ui) uniform readonly uimage2D facet;

struct Receiver {
    vec3 position, normal;
};

Receiver receiver(ivec2 pixel, vec3 p, vec3 n) {
    if (!FACETS) return Receiver(p, n);
    uint code = imageLoad(facet, pixel).x;
    vec3 bare = octahedral_decode(code);
    float mm = mix(1., -p.z, frame.perspective) / frame.pixels_per_mm;
    return Receiver(p + bare * (facet_rise(code) * mm), bare);
}
