// shadow: meshes -> shadow[layer]. Depth alone, reversed, as the light sees it.
#version 460
#extension GL_EXT_scalar_block_layout : require

layout(location = 0) in vec3 position;
layout(push_constant, scalar) uniform Push { uint layer; } push;
layout(set = 0, binding = 0, scalar) readonly buffer ShadowWorldBlock { mat4 shadow_from_world[]; } shadow_world;

void main() {
    gl_Position = shadow_world.shadow_from_world[push.layer] * vec4(position, 1.);
}
