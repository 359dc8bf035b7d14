//! Where the surface that vertex normals mean lies above a triangle, and how the G-buffer holds it: the f64 twin of
//! `glsl/common/rise.glsl` and `glsl/common/facet_code.glsl`.
//!
//! Shadow rays that start on coarse triangles meet their neighbours where light grazes; lifted to the tangent planes of the corners they
//! do not (Hanika 2021, *Hacking the shadow terminator*). Those planes, mixed, are one plane: n.x = d.

use super::octahedral;
use glam::DVec3;

/// How far above a triangle's point that plane is, in units of the corners: sum of `shares` n_i.(v_i - p), 0 at least. `shares` are
/// barycentric, `normals` unit. Along the mixed normal, not made unit: short of Hanika's point by what the normals differ by, squared.
pub fn rise(corners: [DVec3; 3], normals: [DVec3; 3], shares: [f64; 3]) -> f64 {
    let p: DVec3 = (0..3).map(|i| corners[i] * shares[i]).sum();
    (0..3).map(|i| shares[i] * normals[i].dot(corners[i] - p)).sum::<f64>().max(0.0)
}

/// The bits of a normal and a rise in pixels.
pub fn encode(normal: DVec3, rise: f64) -> u32 {
    let [x, y] = octahedral::encode(normal.to_array()).map(|c| u32::from(c as u16));
    let code = (32.0 * rise.max(1e-30).log2() + 512.0).clamp(0.0, 1023.0) as u32;
    (x | y << 16) & 0xffe0_ffe0 | code & 31 | code >> 5 << 16
}

/// Normal, to 4e-3, and rise in pixels, to 1.1 % between 2^-16 and 2^16; below, 0.
pub fn decode(bits: u32) -> (DVec3, f64) {
    let normal = DVec3::from_array(octahedral::decode([bits as i16, (bits >> 16) as i16]));
    let code = bits & 31 | (bits >> 16 & 31) << 5;
    (normal, if code == 0 { 0.0 } else { ((f64::from(code) - 511.5) / 32.0).exp2() })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// On a sphere the tangent planes of an edge's ends meet above its middle, twice as high as the sphere.
    #[test]
    fn an_edge_of_a_sphere_rises_twice() {
        let at = |degrees: f64| DVec3::new(degrees.to_radians().sin(), 0.0, degrees.to_radians().cos());
        let (a, b) = (at(-5.0), at(5.0));
        let found = rise([a, b, DVec3::Y], [a, b, DVec3::Y], [0.5, 0.5, 0.0]);
        let above = 1.0 - 5f64.to_radians().cos();
        assert!((found / above - 2.0).abs() < 0.01, "{found} over {above}");
        let flat = rise([a, b, DVec3::Y], [DVec3::Z; 3], [0.3, 0.3, 0.4]);
        assert!(flat.abs() < 1e-15, "{flat}");
        // A hollow one keeps its triangles.
        assert_eq!(rise([a, b, DVec3::Y], [-a, -b, -DVec3::Y], [0.5, 0.5, 0.0]), 0.0);
    }

    #[test]
    fn what_is_stored_comes_back() {
        let mut worst = [0f64; 2];
        for i in 0..4000 {
            let x = f64::from(i);
            let n = DVec3::new((1.3 * x).sin(), (2.1 * x).cos(), (0.7 * x + 1.0).sin()).normalize();
            let rise = (x / 200.0 - 14.0).exp2();
            let (m, back) = decode(encode(n, rise));
            worst = [worst[0].max(n.distance(m)), worst[1].max((back / rise - 1.0).abs())];
        }
        assert!(worst[0] < 4e-3 && worst[0] > 1e-3 && worst[1] < 0.012, "{worst:?}");
        assert_eq!(decode(encode(DVec3::Z, 0.0)).1, 0.0);
        assert!(decode(encode(DVec3::Z, 1e30)).1 > 6e4);
    }
}
