// entrance: meshes -> shadow[layer], entrance[layer]. The modified translucent shadow map (d'Eon & Luebke 2007): beside its depth,
// the texture coordinate of the surface that the light meets, so that what has scattered there can be found again.
//
// entrance  R32_UINT  texture coordinate, 2 x unorm16; all bits set where nothing scatters
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "common/material.glsl"

layout(location = 0) in vec4 uv;
layout(location = 0) out uint entrance;

void main() {
    entrance = material_scatter(uv) > 0. ? packUnorm2x16(uv.xy) : 0xffffffffu;
}
