// Light of a sky that is a picture: irradiance from spherical harmonics up to band 2 (Ramamoorthi & Hanrahan 2001), each band
// weakened by what scatters on a surface of the pixel's curvature, and reflection from a picture whose mips are filtered by GGX
// lobes (Karis 2013). f64 twin: src/skin/sky.rs. Mirrored by src/frame/uniforms.rs.
layout(constant_id = 22) const bool SKY = false;

layout(set = 0, binding = 31, scalar) uniform EnvironmentBlock {
    mat3 sky_from_view;    // rigid: view space to the picture's own axes
    float intensity;       // factor on the picture's radiance
    float first;           // level of the picture that a mirror shows; finer ones serve the background alone
    float last;            // level that is filtered for roughness 1
    float blur;            // level of the background
    float knee;            // 1/mm, curvature of the middle of `bands`
    vec3 harmonic[9];      // view space, times intensity: factors of 1, x, y, z, xy, yz, zx, 2zz - xx - yy, xx - yy; sum: irradiance / pi
} environment;

layout(set = 0, binding = 27) uniform sampler2D bands;   // row 0: R_1, row 1: R_2, rgb; along curvature / (curvature + knee)
layout(set = 0, binding = 28) uniform sampler2D sky;     // latitude and longitude

// The bands' sums for a normal, of any length: homogeneous, so that means of normals scatter as they should.
vec3 sky_linear(vec3 n) {
    return environment.harmonic[1] * n.x + environment.harmonic[2] * n.y + environment.harmonic[3] * n.z;
}

vec3 sky_square(vec3 n) {
    vec3 q = n * n;
    return environment.harmonic[4] * (n.x * n.y) + environment.harmonic[5] * (n.y * n.z) + environment.harmonic[6] * (n.z * n.x)
         + environment.harmonic[7] * (2. * q.z - q.x - q.y) + environment.harmonic[8] * (q.x - q.y);
}

// Irradiance / pi on a surface that scatters nothing. Three bands of a small bright light swing below 0 behind it.
vec3 sky_light(vec3 n) {
    return max(environment.harmonic[0] + sky_linear(n) + sky_square(n), 0.);
}

// Exitance of a white surface that scatters: a normal and a curvature (1/mm) a channel; band l is left R_l of it.
vec3 sky_scattered(mat3 n, vec3 curvature) {
    vec3 sum = environment.harmonic[0];
    vec3 u = curvature / (curvature + environment.knee);
    float width = float(textureSize(bands, 0).x);
    for (int c = 0; c < 3; ++c) {
        float at = (u[c] * (width - 1.) + .5) / width;
        sum[c] += sky_linear(n[c])[c] * textureLod(bands, vec2(at, .25), 0.)[c] + sky_square(n[c])[c] * textureLod(bands, vec2(at, .75), 0.)[c];
    }
    return max(sum, 0.);
}

// Band 2 of a Gaussian lobe of normals over |mean normal|^2, from that square (von Mises-Fisher, fitted: 1.7e-3).
float sky_spread(float square) {
    return .6 + square * (.13 + square * (.41 - .14 * square));
}

// Place in the picture of a direction, view space: its middle is +Z, left of it +X (OpenEXR's latitude-longitude map).
vec2 sky_place(vec3 direction) {
    vec3 d = environment.sky_from_view * direction;
    return vec2(.5 - atan(d.x, d.z) * .15915494, .5 - asin(clamp(d.y, -1., 1.)) * .31830989);
}

// Radiance that a lobe of perceptual roughness 0..1 around a direction sees.
vec3 sky_seen(vec3 direction, float roughness) {
    float level = environment.first + roughness * (environment.last - environment.first);
    return environment.intensity * textureLod(sky, sky_place(direction), level).rgb;
}
