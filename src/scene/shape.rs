//! Built-in shapes: surfaces whose curvature is known in closed form, so that an estimator can be held to the truth.
//!
//! Signs: normals point outwards (up, for the open plane and saddle); mean curvature H = div(n)/2 is positive where
//! the surface is convex, so a sphere of radius r has H = 1/r and K = 1/r^2.

use std::str::FromStr;

use glam::DVec3;

use super::SceneError;

/// Sizes in mm that a shape may have: f32 squares them without overflow or denormals.
const SIZES: std::ops::RangeInclusive<f64> = 1e-6..=1e9;
const KNOWN: &str = "plane, sphere:R, cylinder:R, torus:R,r, saddle:a, cube:a or ellipsoid:a,b,c";

/// A shape centred at the origin, sizes in mm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ShapeSpec {
    /// A square of 200 mm in the plane y = 0, facing +Y.
    Plane,
    /// A sphere.
    Sphere {
        /// Radius; default 50.
        r: f64,
    },
    /// A closed cylinder along Y, max(20 r, 100) long.
    Cylinder {
        /// Radius; default 25.
        r: f64,
    },
    /// A ring around Y.
    Torus {
        /// From the centre to the middle of the tube; default 70.
        major: f64,
        /// Radius of the tube, less than `major`; default 25.
        minor: f64,
    },
    /// y = (x^2 - z^2) / (2 a) over |x|, |z| <= 2 a, facing +Y.
    Saddle {
        /// Radius of both principal curvatures at the centre; default 50.
        a: f64,
    },
    /// An axis-aligned cube with sharp edges.
    Cube {
        /// Edge; default 100.
        a: f64,
    },
    /// An axis-aligned ellipsoid.
    Ellipsoid {
        /// Half axis along X; default 60.
        a: f64,
        /// Half axis along Y; default 40.
        b: f64,
        /// Half axis along Z; default 30.
        c: f64,
    },
}

impl ShapeSpec {
    /// Half the edge of the plane, mm.
    pub(super) const PLANE_HALF: f64 = 100.0;

    /// Half the length of a cylinder of radius `r`, mm.
    pub(super) fn cylinder_half(r: f64) -> f64 {
        (20.0 * r).max(100.0) / 2.0
    }

    /// Whether the surface has an edge, so that its back can be seen.
    pub(super) fn is_open(&self) -> bool {
        matches!(self, Self::Plane | Self::Saddle { .. })
    }
}

impl FromStr for ShapeSpec {
    type Err = SceneError;

    /// Parses `shape:name` or `shape:name:size,size`.
    fn from_str(text: &str) -> Result<Self, SceneError> {
        let fault = |reason: String| SceneError::Shape { shape: text.to_owned(), reason };
        let spec = text.strip_prefix("shape:").unwrap_or(text);
        let (name, rest) = match spec.split_once(':') {
            Some((name, rest)) => (name, Some(rest)),
            None => (spec, None),
        };
        let mut given = Vec::new();
        for part in rest.iter().flat_map(|r| r.split(',')) {
            let size: f64 =
                part.trim().parse().map_err(|_| fault(format!("'{part}' is not a size in mm; write shape:{KNOWN}")))?;
            if !SIZES.contains(&size) {
                return Err(fault(format!("{size} mm is outside 1e-6..1e9 mm")));
            }
            given.push(size);
        }
        let sizes = |defaults: &[f64]| match given.len() {
            0 => Ok(defaults.to_vec()),
            n if n == defaults.len() => Ok(given.clone()),
            n => Err(fault(format!("{n} sizes given where {name} has {}; write shape:{KNOWN}", defaults.len()))),
        };
        match name {
            "plane" => sizes(&[]).map(|_| Self::Plane),
            "sphere" => sizes(&[50.0]).map(|s| Self::Sphere { r: s[0] }),
            "cylinder" => sizes(&[25.0]).map(|s| Self::Cylinder { r: s[0] }),
            "torus" => {
                let s = sizes(&[70.0, 25.0])?;
                let (major, minor) = (s[0], s[1]);
                if minor >= major {
                    return Err(fault(format!(
                        "a tube of {minor} mm around a ring of {major} mm cuts itself; the second size must be smaller"
                    )));
                }
                Ok(Self::Torus { major, minor })
            }
            "saddle" => sizes(&[50.0]).map(|s| Self::Saddle { a: s[0] }),
            "cube" => sizes(&[100.0]).map(|s| Self::Cube { a: s[0] }),
            "ellipsoid" => sizes(&[60.0, 40.0, 30.0]).map(|s| Self::Ellipsoid { a: s[0], b: s[1], c: s[2] }),
            other => Err(fault(format!("there is no shape '{other}'; write shape:{KNOWN}"))),
        }
    }
}

/// Whether a point of a cylinder lies on one of its flat ends.
fn on_cap(r: f64, p: DVec3) -> bool {
    let inside = r - p.x.hypot(p.z);
    inside > (ShapeSpec::cylinder_half(r) - p.y.abs()).abs()
}

/// Outward unit normal of the shape at a point of its surface (mm). A point off the surface gives the normal of a
/// nearby one; the centre, where there is none, gives +Y.
pub fn shape_normal(spec: &ShapeSpec, p: DVec3) -> DVec3 {
    let normal = match *spec {
        ShapeSpec::Plane => DVec3::Y,
        ShapeSpec::Sphere { .. } => p,
        ShapeSpec::Cylinder { r } if on_cap(r, p) => DVec3::Y * p.y.signum(),
        ShapeSpec::Cylinder { .. } => DVec3::new(p.x, 0.0, p.z),
        ShapeSpec::Torus { major, .. } => {
            let ring = DVec3::new(p.x, 0.0, p.z).normalize_or_zero() * major;
            p - ring
        }
        ShapeSpec::Saddle { a } => DVec3::new(-p.x / a, 1.0, p.z / a),
        ShapeSpec::Cube { .. } => {
            let size = p.abs();
            if size.x >= size.y && size.x >= size.z {
                DVec3::X * p.x.signum()
            } else if size.y >= size.z {
                DVec3::Y * p.y.signum()
            } else {
                DVec3::Z * p.z.signum()
            }
        }
        ShapeSpec::Ellipsoid { a, b, c } => p / DVec3::new(a, b, c).powf(2.0),
    };
    normal.try_normalize().unwrap_or(DVec3::Y)
}

/// Mean curvature H (1/mm, convex > 0) and Gaussian curvature K (1/mm^2) of the shape at a point of its surface (mm).
/// On the edges of a cube or of a cylinder's ends, where curvature is not defined, those of a side next to them.
pub fn shape_curvature(spec: &ShapeSpec, p: DVec3) -> (f64, f64) {
    match *spec {
        ShapeSpec::Plane | ShapeSpec::Cube { .. } => (0.0, 0.0),
        ShapeSpec::Sphere { r } => (1.0 / r, 1.0 / (r * r)),
        ShapeSpec::Cylinder { r } if on_cap(r, p) => (0.0, 0.0),
        ShapeSpec::Cylinder { r } => (0.5 / r, 0.0),
        ShapeSpec::Torus { major, minor } => {
            let axis_distance = p.x.hypot(p.z);
            let around_tube = 1.0 / minor;
            // Meusnier: the parallel circle bends by 1/distance, tilted by the tube's angle.
            let around_axis = (axis_distance - major) / (minor * axis_distance);
            ((around_tube + around_axis) / 2.0, around_tube * around_axis)
        }
        ShapeSpec::Saddle { a } => {
            let (fx, fz) = (p.x / a, -p.z / a);
            let w2 = 1.0 + fx * fx + fz * fz;
            let h = ((1.0 + fx * fx) - (1.0 + fz * fz)) / (2.0 * a * w2 * w2.sqrt());
            (h, -1.0 / (a * a * w2 * w2))
        }
        ShapeSpec::Ellipsoid { a, b, c } => {
            let axes2 = DVec3::new(a * a, b * b, c * c);
            let sum = (p * p / (axes2 * axes2)).element_sum();
            let volume2 = axes2.element_product();
            let h = (axes2.element_sum() - p.length_squared()) / (2.0 * volume2 * sum * sum.sqrt());
            (h, 1.0 / (volume2 * sum * sum))
        }
    }
}
