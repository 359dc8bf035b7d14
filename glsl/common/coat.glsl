// What gloss has beside one plain lobe: a clear coat (KHR_materials_clearcoat), sheen (KHR_materials_sheen), a weight and a
// colour of its own (KHR_materials_specular). And how the G-buffer holds it, with the body's thickness: rg32ui, where some
// material has any of it.
struct Coat {
    float share;            // of the surface that is coated
    float roughness;        // of the coat, perceptual, like the next but one
    vec3 sheen;             // colour, linear; black: none
    float sheen_roughness;
    vec3 tint;              // of the dielectric's F0, its brightest channel 1
    float f90;              // what the dielectric reflects edge on
};

Coat coat_none() {
    return Coat(0., 0., vec3(0.), 0., vec3(1.), 1.);
}

uint coat_bits(float x, int bits, int at) {
    return uint(clamp(x, 0., 1.) * float((1 << bits) - 1) + .5) << at;
}

float coat_part(uint code, int bits, int at) {
    return float(code >> at & uint((1 << bits) - 1)) / float((1 << bits) - 1);
}

// x: share 6, roughness 6, tint 5 5 5, f90 5; y: square root of the sheen 6 6 6, its roughness 6, square root of thickness 8.
// 0 and 1 come back as they are.
uvec2 coat_encode(Coat c, float thickness) {
    vec3 s = sqrt(c.sheen);
    return uvec2(coat_bits(c.share, 6, 0) | coat_bits(c.roughness, 6, 6) | coat_bits(c.tint.r, 5, 12) | coat_bits(c.tint.g, 5, 17)
                     | coat_bits(c.tint.b, 5, 22) | coat_bits(c.f90, 5, 27),
                 coat_bits(s.r, 6, 0) | coat_bits(s.g, 6, 6) | coat_bits(s.b, 6, 12) | coat_bits(c.sheen_roughness, 6, 18)
                     | coat_bits(sqrt(thickness), 8, 24));
}

Coat coat_decode(uvec2 code) {
    vec3 s = vec3(coat_part(code.y, 6, 0), coat_part(code.y, 6, 6), coat_part(code.y, 6, 12));
    return Coat(coat_part(code.x, 6, 0), coat_part(code.x, 6, 6), s * s, coat_part(code.y, 6, 18),
                vec3(coat_part(code.x, 5, 12), coat_part(code.x, 5, 17), coat_part(code.x, 5, 22)), coat_part(code.x, 5, 27));
}

// 0..1 of the frame's thickest; 0: not known.
float coat_thickness(uvec2 code) {
    float root = coat_part(code.y, 8, 24);
    return root * root;
}
