// Images over texture coordinates ("sheets"). The unit square lies inside a border, so that what a chart needs of its neighbours
// has a place outside of the square, too. Texels hold light, and in alpha the number of the chart that they belong to; 0:
// none; negative: to the gutter of that chart, which shows what lies beyond a cut.
layout(constant_id = 19) const float SHEET_BORDER = 0.;   // of a side, beside the unit square

// Place in texels of a texture coordinate, on a sheet of `size` texels.
vec2 sheet_place(vec2 uv, float size) {
    return size * (SHEET_BORDER + uv * (1. - 2. * SHEET_BORDER));
}
