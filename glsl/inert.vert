// inert: meshes that do not scatter -> inert[layer]. Their depth as the light sees it, in the texels of `shadow` that `sparse` keeps:
// light that falls on hair or eyes does not enter the skin beside them.
#version 460
#extension GL_EXT_scalar_block_layout : require

layout(location = 0) in vec3 position;
// shift: what is kept of a cell lies half a texel of the shadow map past its middle.
layout(push_constant, scalar) uniform Push { uint layer; float shift; } push;
layout(set = 0, binding = 0, scalar) readonly buffer ShadowWorldBlock { mat4 shadow_from_world[]; } shadow_world;

void main() {
    vec4 p = shadow_world.shadow_from_world[push.layer] * vec4(position, 1.);
    gl_Position = vec4(p.xy - push.shift * p.w, p.zw);
}
