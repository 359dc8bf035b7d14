//! The whole surface as one field, symmetric about x = 0.

use glam::{DVec3, dvec3};

use crate::{body, ear, face, hair};

/// Signed distance to the skin and the hair on it, mm, of first order near the surface.
pub fn skin(p: DVec3) -> f64 {
    let p = dvec3(p.x.abs(), p.y, p.z);
    let d = body::body(p);
    if d > 60. {
        return d - 25.;
    }
    let d = face::face(d, p);
    let d = d - hair::thickness(p);
    ear::ear(d, p)
}

/// Outward unit normal.
pub fn normal(p: DVec3) -> DVec3 {
    const H: f64 = 0.05;
    let at = |d: DVec3| skin(p + d) - skin(p - d);
    dvec3(at(DVec3::X * H), at(DVec3::Y * H), at(DVec3::Z * H)).normalize()
}
