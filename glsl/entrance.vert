// entrance: meshes -> shadow[layer], entrance[layer]. As a light sees them, with their texture coordinates.
#version 460
#extension GL_EXT_scalar_block_layout : require

layout(constant_id = 12) const int LAYER = 0;

layout(location = 0) in vec3 position;
layout(location = 2) in vec4 uv;
layout(set = 0, binding = 0, scalar) readonly buffer ShadowWorldBlock { mat4 shadow_from_world[]; } shadow_world;

layout(location = 0) out vec4 out_uv;

void main() {
    gl_Position = shadow_world.shadow_from_world[LAYER] * vec4(position, 1.);
    out_uv = uv;
}
