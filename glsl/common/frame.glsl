// What every stage knows: camera, lights, profile. Mirrored by src/frame/uniforms.rs; tests/layout.rs holds the two together.
// View space: millimetres, +x right, +y up, -z forward. Distances along the view axis are stored positive.
#extension GL_EXT_scalar_block_layout : require

#define MAX_LEVELS 6

layout(set = 0, binding = 0, scalar) uniform FrameBlock {
    mat4 clip_from_world;      // reversed z, [0,1], y down
    mat4 view_from_world;      // rigid
    mat4 world_from_view;      // rigid
    vec2 ray_scale;            // view x,y per pixel at unit distance (perspective) or in mm (orthographic)
    vec2 ray_offset;           // so that ray.xy = ray_scale * (pixel + .5) + ray_offset
    ivec2 size;                // pixels
    float perspective;         // 1 perspective, 0 orthographic
    float pixels_per_mm;       // at unit distance: |1 / ray_scale.y|
    vec3 origin;               // mm, world position that stored positions are relative to
    float light_unit;          // what light is divided by where it is stored as halves: a power of two, 1 but for very strong lights
    vec3 ambient_mean;         // half the sum of the radiance from above and from below: a two-colour sky
    float exposure;            // factor
    vec3 ambient_slope;        // half their difference; ambient(n) = mean + slope * n.up
    float length_mm;           // the profile's length: levels store H * length_mm, so that halves do for every scale
    vec3 up;                   // world up, in view space
    float lut_knee;            // 1/mm, curvature of the middle of the look-up table
    vec4 level[MAX_LEVELS];    // moments: weight rgb of the level's Gaussian; w: variance in mm^2
    vec4 share[MAX_LEVELS + 1];// pdss: per-channel share of level i - 1; entry 0 is the unblurred normal
    vec4 occlusion[MAX_LEVELS];// x: AO radius in units of length_mm, y: share of the level
    vec4 sharp;                // weight rgb of all Gaussians narrower than a pixel; w: mean sigma of those that nothing carries, mm
} frame;

// Ray through a pixel, view space, z = -1.
vec3 view_ray(ivec2 pixel) {
    return vec3(frame.ray_scale * (vec2(pixel) + .5) + frame.ray_offset, -1.);
}

// View-space position (mm) of the surface seen through a pixel at distance z > 0 along the view axis.
vec3 view_position(ivec2 pixel, float z) {
    vec2 ray = frame.ray_scale * (vec2(pixel) + .5) + frame.ray_offset;
    return vec3(ray * mix(1., z, frame.perspective), -z);
}

// Direction from a surface point to the eye, view space, unit.
vec3 view_direction(vec3 position) {
    return frame.perspective > .5 ? normalize(-position) : vec3(0., 0., 1.);
}

// The pixel that speaks for a texel of `stride` x `stride` pixels. The same pixel speaks for the finer texel that holds it:
// a level that reads a finer one finds its own pixel's texel written, at silhouettes too.
ivec2 representative(ivec2 texel, int stride) {
    return min(texel * stride + min(stride / 2, 1), frame.size - 1);
}
