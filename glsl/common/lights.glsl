// Lights, view space. Mirrored by src/frame/uniforms.rs.
#define MAX_LIGHTS 128
#define MAX_LAYERS 16

#define LIGHT_DIRECTIONAL 0
#define LIGHT_POINT 1
#define LIGHT_SPOT 2

struct Light {
    vec3 position;        // mm; for a directional light the unit direction it comes from
    int kind;
    vec3 color;           // irradiance at normal incidence, at one metre for point and spot lights
    float range_mm;       // 0: unlimited
    vec3 axis;            // unit, where a spot points
    float inner_cos;
    float outer_cos;
    int layer;            // first layer of its shadow map, -1 none
    float texel_mm;       // footprint of a shadow texel; per mm of distance for point and spot lights
    int slot;             // channel of the scattered visibility, -1 none
    float part;           // of the light of its slot: others of its colour may share it
};

// A uniform block, and loops over a specialised count: an unrolled loop reads it at constant offsets, which costs nothing,
// where a storage buffer costs a gather per lane and member on CPU drivers.
layout(set = 0, binding = 30, scalar) uniform LightBlock {
    mat4 shadow_from_view[MAX_LAYERS];
    Light light[MAX_LIGHTS];
} lights;

layout(constant_id = 20) const int LIGHTS = 1;              // how many there are
layout(constant_id = 21) const bool ALL_DIRECTIONAL = true; // none is a point or a spot

// Direction to the light (unit) and irradiance at normal incidence.
vec3 light_arrives(Light light, vec3 position, out vec3 irradiance) {
    irradiance = light.color;
    if (ALL_DIRECTIONAL || light.kind == LIGHT_DIRECTIONAL) return light.position;
    vec3 d = light.position - position;
    float square = dot(d, d);
    vec3 l = d * inversesqrt(max(square, 1e-12));
    // Candela to lux: per square metre. A light at zero distance is held to a sphere of 1 mm.
    float falloff = 1e6 / max(square, 1.);
    if (light.range_mm > 0.) {
        // glTF's windowing (KHR_lights_punctual): 1 - (d / range)^4, clamped.
        float q = square / (light.range_mm * light.range_mm);
        falloff *= clamp(1. - q * q, 0., 1.);
    }
    if (light.kind == LIGHT_SPOT) {
        float c = dot(-l, light.axis);
        float t = clamp((c - light.outer_cos) / max(light.inner_cos - light.outer_cos, 1e-4), 0., 1.);
        falloff *= t * t;
    }
    irradiance *= falloff;
    return l;
}
