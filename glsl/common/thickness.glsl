// How much of a body lies between a point and where light entered it, by the shadow map. Needs lights.glsl and shadow.glsl.

// A point as a layer of the shadow map has it: clip space of that layer.
vec4 shadow_place(int layer, vec3 position) {
    return lights.shadow_from_view[layer] * vec4(position, 1.);
}

// Layer of the shadow map that a light's view of a point is in.
int shadow_layer(Light light, vec3 position) {
    bool point = !ALL_DIRECTIONAL && light.kind == LIGHT_POINT;
    return light.layer + (point ? shadow_face(mat3(frame.world_from_view) * (position - light.position)) : 0);
}

// The same where a file says how thick the body is, mm, 0 where it does not: as it says; but what lies in front beyond twice that is
// another body, and in the way.
float thickness_stated(float stated, float measured) {
    return stated > 0. ? max(stated, measured - stated) : measured;
}

// Thickness in mm along the light, bilinear; 0 where nothing lies in front. q: the point's place in that layer.
float thickness(Light light, int layer, vec4 q, vec3 position) {
    bool parallel = ALL_DIRECTIONAL || light.kind == LIGHT_DIRECTIONAL;
    if (!parallel && q.w <= 0.) return 1e9;
    vec2 size = vec2(textureSize(shadow, 0).xy), at = (q.xy / q.w * .5 + .5) * size - .5, base = floor(at), f = at - base;
    vec4 map = textureGather(shadow, vec3((base + 1.) / size, float(layer)));
    vec4 mm;
    if (parallel) {
        // Reversed depth is linear: so much a mm.
        mat4 m = lights.shadow_from_view[layer];
        mm = (map - q.z) * inversesqrt(m[0].z * m[0].z + m[1].z * m[1].z + m[2].z * m[2].z);
    } else {
        // Infinite reversed depth is near / distance.
        mm = (q.w - q.z / max(map, vec4(1e-20))) * (length(position - light.position) / q.w);
    }
    // A texel that nothing covers is in front of nothing.
    mm = max(mm, vec4(0.));
    return mix(mix(mm.w, mm.z, f.x), mix(mm.x, mm.y, f.x), f.y);
}
