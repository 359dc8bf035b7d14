// Screen stages run over lists of 8 x 8 tiles, one workgroup a tile, by indirect dispatch: empty tiles cost nothing.
// A tile is y << 16 | x, in tiles. `tiles.comp` writes the lists.
layout(local_size_x = 8, local_size_y = 8) in;
layout(set = 0, binding = 1, scalar) readonly buffer TileBlock { uvec3 dispatch; uint pad; uint tile[]; } tile_list;

ivec2 tile_pixel() {
    uint tile = tile_list.tile[gl_WorkGroupID.x];
    return ivec2(tile & 0xffffu, tile >> 16) * 8 + ivec2(gl_LocalInvocationID.xy);
}
