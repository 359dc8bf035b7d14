// tiles: a list of tiles -> a point each, as large as a tile, for stages over tiles that run as fragment shaders. Points and not two triangles:
// along a diagonal between two a device shades its blocks of pixels twice.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "common/frame.glsl"

layout(constant_id = 0) const int GRID = 1; // pixels a texel of what is drawn
layout(constant_id = 48) const int TILE_X = 8;
layout(set = 0, binding = 1, scalar) readonly buffer TileBlock { uvec3 dispatch; uint pad; uint tile[]; } tile_list;

void main() {
    // The arguments of the dispatch, read as those of a draw: count, 1, 1, 0, so that the first vertex is number 1.
    uint tile = tile_list.tile[gl_VertexIndex - 1];
    vec2 middle = (vec2(tile & 0xffffu, tile >> 16) + .5) * float(TILE_X);
    gl_Position = vec4(2. * middle / vec2((frame.size + GRID - 1) / GRID) - 1., 0., 1.);
    gl_PointSize = float(TILE_X);
}
