// tiles: viewz -> surface tiles, scatter tiles.
//
// One thread looks at one tile, 8 x 8 or as the device likes it, of a grid of STRIDE pixels and appends it to the lists that it belongs to. The lists
// start with the arguments of the indirect dispatch that runs over them. The order of a list does not matter to anyone.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "common/frame.glsl"
layout(local_size_x = 64) in;

layout(constant_id = 0) const int STRIDE = 1;
layout(constant_id = 1) const bool SURFACE = true;
layout(constant_id = 2) const bool SCATTER = true;
layout(constant_id = 3) const bool EVERY = false;   // leave no tile out
layout(constant_id = 4) const bool OWN = false;     // surface that does not scatter is another's
layout(constant_id = 48) const int TILE_X = 8;
layout(constant_id = 49) const int TILE_Y = 8;

layout(set = 0, binding = 2, r32f) uniform readonly image2D viewz;
layout(set = 0, binding = 3, scalar) buffer SurfaceTiles { uvec3 dispatch; uint pad; uint tile[]; } surface_tiles;
layout(set = 0, binding = 4, scalar) buffer ScatterTiles { uvec3 dispatch; uint pad; uint tile[]; } scatter_tiles;

void main() {
    ivec2 grid = (frame.size + STRIDE - 1) / STRIDE;
    const ivec2 SIDES = ivec2(TILE_X, TILE_Y);
    ivec2 tiles = (grid + SIDES - 1) / SIDES;
    int index = int(gl_GlobalInvocationID.x);
    if (index >= tiles.x * tiles.y) return;
    ivec2 tile = ivec2(index % tiles.x, index / tiles.x);
    float lowest = 0., highest = 0.;
    for (int y = 0; y < TILE_Y; ++y) {
        for (int x = 0; x < TILE_X; ++x) {
            // Beyond the border the last pixel is looked at again: it changes nothing.
            ivec2 p = representative(tile * SIDES + ivec2(x, y), STRIDE);
            float z = imageLoad(viewz, p).x;
            lowest = min(lowest, z);
            highest = max(highest, z);
        }
    }
    uint code = uint(tile.y) << 16 | uint(tile.x);
    if (SURFACE && (EVERY || lowest < 0. || !OWN && highest > 0.)) surface_tiles.tile[atomicAdd(surface_tiles.dispatch.x, 1u)] = code;
    if (SCATTER && (EVERY || lowest < 0.)) scatter_tiles.tile[atomicAdd(scatter_tiles.dispatch.x, 1u)] = code;
}
