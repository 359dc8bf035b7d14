// Screen stages run over lists of tiles, a workgroup or a point each, by indirect dispatch or draw: empty tiles cost nothing. A tile is
// y << 16 | x, in tiles; `tiles.comp` writes the lists. Its sides, and whether a stage is a compute or a fragment shader, are what suits the
// device (`src/gpu/suit.rs`): 64 pixels, 8 x 8 if nobody says.
#ifdef FRAGMENT
// The build compiles the stage once more, its stores made outputs (`glsl/fragment.rs`); `tiles.vert` draws the tiles.
ivec2 tile_pixel() { return ivec2(gl_FragCoord.xy); }
#else
layout(local_size_x = 8, local_size_y = 8, local_size_x_id = 50, local_size_y_id = 51) in;
layout(constant_id = 48) const int TILE_X = 8;
layout(constant_id = 49) const int TILE_Y = 8;
layout(set = 0, binding = 1, scalar) readonly buffer TileBlock { uvec3 dispatch; uint pad; uint tile[]; } tile_list;

ivec2 tile_pixel() {
    uint tile = tile_list.tile[gl_WorkGroupID.x];
    return ivec2(tile & 0xffffu, tile >> 16) * ivec2(TILE_X, TILE_Y) + ivec2(gl_LocalInvocationID.xy);
}
#endif
