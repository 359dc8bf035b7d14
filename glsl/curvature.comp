#version 460
#extension GL_GOOGLE_include_directive : require
// variants: vergne ESTIMATOR=0; trace ESTIMATOR=1; metric ESTIMATOR=2; fit ESTIMATOR=3; vergne_mended ESTIMATOR=4
//
// Mean curvature H and Gaussian curvature K of the visible surface, from view distances and normals.
//
// In   viewz      r32f    distance along the view axis, mm; < 0: the same, negated, on a scattering surface; 0: background
//      normal     r32ui   octahedral 2 x snorm16, view space, facing the viewer, without normal map
//      frame      uniform projection (ray_scale, ray_offset, perspective, pixels_per_mm), size
//      tile_list  buffer  the 8 x 8 tiles to visit, one workgroup each
// Out  curvature  rg32ui  H, K and a confidence: common/curvature_code.glsl. Only covered pixels inside the image are written.
// Reads 4 neighbours (fit: 8), never outside the image. Barrier before: both inputs, shader read; after: the output, shader read.
//
// Units: everything is computed in footprints (q mm, a pixel's size at the centre's distance) and scaled once at the end.
// With ray = (slope, -1), P_k - P_0 = z_0 (ray_k - ray_0) + (z_k - z_0) ray_k; divided by q that is a constant pixel step
// plus e_k ray_k with e_k = (z_k - z_0)/q. The one subtraction is of stored numbers, exact between neighbours, and no
// threshold knows a length: an object of 1e-3 mm and one of 1e6 mm take the same path.
//
// vergne  H = -tr(Hess depth)/2, grad depth = -(n_x, n_y)/n_z, exponent 1.     Vergne et al. 2009. Infinite at contours.
// trace   H = tr(grad n)/2, grad n = n_u (x) grad u + n_v (x) grad v,
//         grad u = (e_x + slope_x e_z)/(z ray_scale_x).                         Chen, Lambert & Penner 2014, equation 1;
//         exact for any unit extension of n, because n^T grad n = grad|n|^2/2 = 0.
// metric  H = (G L + E N - 2 F M)/(2 D), K = (L N - M^2)/D, D = EG - F^2,       first and second fundamental form of
//         central differences, each axis over the sides that belong to it:      p_u, p_v, n_u, n_v. Exact on spheres.
// fit     S = (sum w m a^T)(sum w a a^T)^-1, H = tr S/2, K = det sym S,         least squares over tangential steps a
//         w = |d|^-2 exp(-4 (2h/|d|)^4 - (|d|/24)^4), h off the tangent plane.  and normal changes m.
// vergne_mended  as vergne, with n_z^.4 and no n_z below .01, times a weight that falls where one of 8 neighbours lies at
//         another depth.                                                        The author's code for radiance scaling (MeshLab).
// The f64 twin is src/skin/curvature.rs, `metric` in SPIR-V assembly curvature.spvasm.
#include "common/frame.glsl"
#include "common/octahedral.glsl"
#include "common/tiles.glsl"
#include "common/curvature_code.glsl"

#define VERGNE 0
#define TRACE 1
#define METRIC 2
#define FIT 3
#define VERGNE_MENDED 4
#ifndef ESTIMATOR
#define ESTIMATOR METRIC
#endif

layout(set = 0, binding = 2, r32f) uniform readonly image2D viewz;
layout(set = 0, binding = 3, r32ui) uniform readonly uimage2D normal;
layout(set = 0, binding = 4, rg32ui) uniform writeonly uimage2D curvature;

// Largest |H q| of metric and fit: a radius under about 2 pixels cannot be told from noise. A pixel beyond it was not
// measured: clamped, confidence 0.
const float FOOTPRINT_BOUND = .5;
// Two sides of an axis are averaged while neither is more than 3 times as long as the other.
const float SIDE_RATIO_SQUARED = 9.;
// 60 degrees apart is another face. At 90, a cube's edge, rounding of the normals would decide.
const float CREASE_COS = .5;
// Relative to E G: a parallelogram this thin is rounding noise.
const float DETERMINANT_FLOOR = 1e-6;
// Trust grows from 0 to 1 between these cosines of the given and the measured normal.
const float AGREE_FROM = .5, AGREE_FULL = .9;
// fit adds this share of its matrix' trace to the diagonal: a line of neighbours yields its curvature, none across.
const float RIDGE = 1e-6;
// Sum of weights below which fit found no neighbour; one good neighbour is 1.
const float NO_WEIGHT = 1e-12;
// Neighbours, of 8, for full confidence: the half left over is what the weights take at grazing angles.
const float ENOUGH_VOTES = 7.5;
// vergne divides by no smaller n.z: finite, and still far off at a contour.
const float VERGNE_EPSILON = 1e-6;
// vergne_mended: exponent and floor of n.z; relative steps of depth that start to be, and are, a silhouette.
const float MENDED_EXPONENT = .4, MENDED_FLOOR = .01, MENDED_SAME = .03, MENDED_JUMP = .04;

// Curvature in footprints: H q, K q^2, confidence.
struct Local { float mean, gauss, confidence; };

struct Centre {
    ivec2 pixel;
    float z;        // stored, signed
    vec3 n;
    float per_mm;   // footprints per mm, 1/q
    vec2 unit;      // pixel step in footprints: +-1 where pixels are square
    vec2 slope;     // of the view ray; 0 in an orthographic view
    vec2 slope_step;
};

struct Step {
    vec3 p;         // position, relative to the centre, in footprints
    vec3 normal;
    bool covered;   // inside the image and not background
    bool usable;    // and the same object, no crease between
};

// As octahedral_decode, but left in whole steps of 1/32767 until normalised: exact so far, and two roundings fewer
// in numbers whose differences are all that matters here.
vec3 whole_normal(uint code) {
    vec2 p = vec2(bitfieldExtract(int(code), 0, 16), int(code) >> 16);
    vec3 n = vec3(p, 32767. - abs(p.x) - abs(p.y));
    float fold = max(-n.z, 0.);
    n.xy -= vec2(n.x >= 0. ? fold : -fold, n.y >= 0. ? fold : -fold);
    return n * inversesqrt(dot(n, n)); // never 0; normalize() guards against that, dearly on some drivers
}

Step step_to(Centre c, ivec2 by) {
    ivec2 wanted = c.pixel + by;
    ivec2 at = clamp(wanted, ivec2(0), frame.size - 1); // a finite stand-in; never counted
    float z = imageLoad(viewz, at).x;
    Step s;
    s.normal = whole_normal(imageLoad(normal, at).x);
    float e = (abs(z) - abs(c.z)) * c.per_mm;
    vec2 side = vec2(by);
    s.p = vec3(side * c.unit + e * (c.slope + side * c.slope_step), -e);
    s.covered = at == wanted && z != 0.;
    // The sign of z tells the objects apart; a product of two background or opposite distances is not positive.
    s.usable = at == wanted && z * c.z > 0. && dot(s.normal, c.n) > CREASE_COS;
    return s;
}

// How far to trust differences over so many sides of each axis: 1 for all four.
float trust(float sides_u, float sides_v) {
    return sides_u * sides_v > 0. ? sides_u * sides_v * .25 : (sides_u + sides_v) * .125;
}

#if ESTIMATOR == VERGNE || ESTIMATOR == TRACE || ESTIMATOR == VERGNE_MENDED
vec3 differenced(vec3 n) {
#if ESTIMATOR == VERGNE
    float nz = n.z < 0. ? min(n.z, -VERGNE_EPSILON) : max(n.z, VERGNE_EPSILON);
    return vec3(-n.xy / nz, 0.);
#elif ESTIMATOR == VERGNE_MENDED
    return vec3(-n.xy * pow(max(n.z, MENDED_FLOOR), -MENDED_EXPONENT), 0.);
#else
    return n;
#endif
}

// Difference per pixel along one axis over the covered sides; w counts them.
vec4 per_pixel(Centre c, ivec2 by) {
    Step ahead = step_to(c, by), behind = step_to(c, -by);
    float a = ahead.covered ? 1. : 0., b = behind.covered ? 1. : 0.;
    vec3 centre = differenced(c.n);
    vec3 total = a * (differenced(ahead.normal) - centre) + b * (centre - differenced(behind.normal));
    return vec4(total / max(a + b, 1.), a + b);
}

Local measure(Centre c) {
    vec4 u = per_pixel(c, ivec2(1, 0)), v = per_pixel(c, ivec2(0, 1));
#if ESTIMATOR == VERGNE
    return Local(-.5 * (u.x / c.unit.x + v.y / c.unit.y), 0., trust(u.w, v.w));
#elif ESTIMATOR == VERGNE_MENDED
    float near = 0.;
    for (int k = 0; k < 9; ++k) {
        if (k == 4) continue;
        float z = abs(imageLoad(viewz, clamp(c.pixel + ivec2(k % 3, k / 3) - 1, ivec2(0), frame.size - 1)).x);
        if (z > 0.) near += 1. - smoothstep(MENDED_SAME, MENDED_JUMP, abs(log(z / abs(c.z))));
    }
    float weight = clamp(near * .25 - 1., 0., 1.);
    return Local(-.5 * weight * (u.x / c.unit.x + v.y / c.unit.y), 0., trust(u.w, v.w));
#else
    float uu = (u.x + c.slope.x * u.z) / c.unit.x, uv = (u.y + c.slope.y * u.z) / c.unit.y;
    float vu = (v.x + c.slope.x * v.z) / c.unit.x, vv = (v.y + c.slope.y * v.z) / c.unit.y;
    // n^T grad n = 0 leaves grad n the eigenvalues k1, k2, 0: K is its second invariant.
    return Local(.5 * (uu + vv), uu * vv - uv * vu, trust(u.w, v.w));
#endif
}

#elif ESTIMATOR == METRIC
// Differences of position and normal along one axis over the sides that serve, and their number. Position and normal
// take the same sides: on a sphere n is affine in P, so any pair is exact and a mixed pair is not.
float axis(Centre c, ivec2 by, out vec3 p, out vec3 n) {
    Step ahead = step_to(c, by), behind = step_to(c, -by);
    float a2 = dot(ahead.p, ahead.p), b2 = dot(behind.p, behind.p);
    bool a = ahead.usable && (!behind.usable || a2 <= SIDE_RATIO_SQUARED * b2);
    bool b = behind.usable && (!ahead.usable || b2 <= SIDE_RATIO_SQUARED * a2);
    // The centre itself stands in for a side left out.
    p = (a ? ahead.p : vec3(0.)) - (b ? behind.p : vec3(0.));
    n = (a ? ahead.normal : c.n) - (b ? behind.normal : c.n);
    return float(a) + float(b);
}

Local measure(Centre c) {
    vec3 pu, pv, nu, nv;
    float sides_u = axis(c, ivec2(1, 0), pu, nu), sides_v = axis(c, ivec2(0, 1), pv, nv);
    float e = dot(pu, pu), f = dot(pu, pv), g = dot(pv, pv);
    float l = dot(nu, pu), m = .5 * (dot(nu, pv) + dot(nv, pu)), n = dot(nv, pv);
    bool both = sides_u * sides_v > 0.;
    // |p_u x p_v|^2 rather than E G - F^2: at grazing angles those two nearly cancel.
    vec3 measured = cross(pu, pv);
    float area2 = max(dot(measured, measured), DETERMINANT_FLOOR * e * g);
    // An axis without a usable side left zeros: L + N and E + G are then the other axis' own (and K is 0). With
    // neither, 0 over anything; a footprint squared is never as small as that floor.
    float twice = both ? g * l + e * n - 2. * f * m : l + n;
    float over = 1. / max(both ? area2 : e + g, 1e-20);
    float facing = sign(c.unit.x * c.unit.y); // pixels may run down while view space runs up
    float cosine = facing * dot(measured, c.n) * sqrt(over);
    float agree = both ? clamp((cosine - AGREE_FROM) / (AGREE_FULL - AGREE_FROM), 0., 1.) : 1.;
    return Local(.5 * twice * over, (l * n - m * m) * over, trust(sides_u, sides_v) * agree);
}

#else
struct Sums {
    vec3 a;         // of w a a^T: 00, 01, 11
    vec4 b;         // of w m a^T: 00, 01, 10, 11
    float votes;
};

void add(inout Sums s, Centre c, vec3 t, vec3 b, ivec2 by) {
    Step k = step_to(c, by);
    float d2 = dot(k.p, k.p), height = dot(k.p, c.n);
    float lift = height * height / d2, far = d2 / 576.;
    float vote = k.usable ? exp(-(64. * lift * lift + far * far)) : 0.;
    float w = vote / d2; // every direction counts alike, however stretched the footprint
    vec3 change = k.normal - c.n;
    vec2 a = vec2(dot(k.p, t), dot(k.p, b)), m = vec2(dot(change, t), dot(change, b));
    s.a += w * vec3(a.x * a.x, a.x * a.y, a.y * a.y);
    s.b += w * vec4(m.x * a, m.y * a);
    s.votes += vote;
}

Local measure(Centre c) {
    // Tangent pair without a pole in sight (Duff et al. 2017).
    float side = c.n.z < 0. ? -1. : 1.;
    float d = -1. / (side + c.n.z), xy = c.n.x * c.n.y * d;
    vec3 t = vec3(1. + side * c.n.x * c.n.x * d, side * xy, -side * c.n.x);
    vec3 b = vec3(xy, side + c.n.y * c.n.y * d, -c.n.y);

    Sums s = Sums(vec3(0.), vec4(0.), 0.);
    add(s, c, t, b, ivec2(-1, -1));
    add(s, c, t, b, ivec2(0, -1));
    add(s, c, t, b, ivec2(1, -1));
    add(s, c, t, b, ivec2(-1, 0));
    add(s, c, t, b, ivec2(1, 0));
    add(s, c, t, b, ivec2(-1, 1));
    add(s, c, t, b, ivec2(0, 1));
    add(s, c, t, b, ivec2(1, 1));

    float spread = s.a.x + s.a.z;
    if (spread < NO_WEIGHT) return Local(0., 0., 0.);
    s.a /= spread; // products of weights as small as these may be would underflow
    s.b /= spread;
    s.a.xz += RIDGE;
    float over = 1. / (s.a.x * s.a.z - s.a.y * s.a.y);
    vec4 shape = vec4(s.b.x * s.a.z - s.b.y * s.a.y, s.b.y * s.a.x - s.b.x * s.a.y,
                      s.b.z * s.a.z - s.b.w * s.a.y, s.b.w * s.a.x - s.b.z * s.a.y) * over;
    float shear = .5 * (shape.y + shape.z);
    return Local(.5 * (shape.x + shape.w), shape.x * shape.w - shear * shear, min(s.votes / ENOUGH_VOTES, 1.));
}
#endif

void main() {
    ivec2 pixel = tile_pixel();
    if (any(greaterThanEqual(pixel, frame.size))) return;
    Centre c;
    c.pixel = pixel;
    c.z = imageLoad(viewz, pixel).x;
    if (c.z == 0.) return;
    c.n = whole_normal(imageLoad(normal, pixel).x);
    c.per_mm = frame.pixels_per_mm / mix(1., abs(c.z), frame.perspective);
    c.unit = frame.ray_scale * frame.pixels_per_mm;
    c.slope = frame.perspective * (frame.ray_scale * (vec2(pixel) + .5) + frame.ray_offset);
    c.slope_step = frame.perspective * frame.ray_scale;

    Local local = measure(c);
#if ESTIMATOR == METRIC || ESTIMATOR == FIT
    if (abs(local.mean) > FOOTPRINT_BOUND) local.confidence = 0.;
    local.mean = clamp(local.mean, -FOOTPRINT_BOUND, FOOTPRINT_BOUND);
    local.gauss = clamp(local.gauss, -FOOTPRINT_BOUND * FOOTPRINT_BOUND, FOOTPRINT_BOUND * FOOTPRINT_BOUND);
#endif
    imageStore(curvature, pixel, uvec4(curvature_encode(local.mean * c.per_mm, local.gauss, local.confidence), 0u, 0u));
}
