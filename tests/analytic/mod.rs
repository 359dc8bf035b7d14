//! G-buffers of shapes whose curvature is known in closed form, ray cast in f64.
#![allow(dead_code, reason = "shared by several test programs, none of which uses all of it")]
use pdss::skin::curvature::{Camera, GBuffer};

type V = [f64; 3];

fn dot(a: V, b: V) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn along(o: V, d: V, t: f64) -> V {
    [o[0] + t * d[0], o[1] + t * d[1], o[2] + t * d[2]]
}

fn unit(a: V) -> V {
    let s = 1.0 / dot(a, a).sqrt();
    a.map(|x| x * s)
}

/// Lengths in mm; placed as the command line's shapes are.
#[derive(Debug, Clone, Copy)]
pub enum Shape {
    Plane,
    Sphere(f64),
    /// Around y, endless.
    Cylinder(f64),
    /// Around y: ring radius, tube radius.
    Torus(f64, f64),
    Ellipsoid(f64, f64, f64),
    /// y = (x^2 - z^2) / 2a for |x|, |z| <= 2a.
    Saddle(f64),
}

/// Outward normal (a saddle's points up), H and K.
pub struct Surface {
    pub n: V,
    pub h: f64,
    pub k: f64,
}

impl Shape {
    /// Largest principal curvature, 1/mm: the unit errors are told in. A plane has none; its errors are told in 1/mm.
    pub fn sharpest(self) -> f64 {
        match self {
            Self::Plane => 1.0,
            Self::Sphere(r) | Self::Cylinder(r) | Self::Torus(_, r) | Self::Saddle(r) => 1.0 / r,
            Self::Ellipsoid(a, b, c) => a.max(b).max(c) / a.min(b).min(c).powi(2),
        }
    }

    /// First hit ahead of `o`.
    fn cast(self, o: V, d: V) -> Option<f64> {
        match self {
            Self::Plane => Some(-o[1] / d[1]).filter(|t| *t > 0.0),
            Self::Sphere(r) => self::quadric(o, d, [1.0 / r; 3]),
            Self::Cylinder(r) => self::quadric(o, d, [1.0 / r, 0.0, 1.0 / r]),
            Self::Ellipsoid(a, b, c) => self::quadric(o, d, [1.0 / a, 1.0 / b, 1.0 / c]),
            Self::Torus(..) => self.march(o, d),
            Self::Saddle(a) => {
                let (qa, qb, qc) = (
                    d[0] * d[0] - d[2] * d[2],
                    o[0] * d[0] - o[2] * d[2] - a * d[1],
                    o[0] * o[0] - o[2] * o[2] - 2.0 * a * o[1],
                );
                let root = (qb * qb - qa * qc).sqrt();
                // Both roots without cancellation; a NaN of a missing root fails every comparison below.
                let q = -qb - root.copysign(qb);
                let mut hits = [q / qa, qc / q];
                hits.sort_by(f64::total_cmp);
                hits.into_iter().find(|t| {
                    let p = along(o, d, *t);
                    *t > 0.0 && p[0].abs() <= 2.0 * a && p[2].abs() <= 2.0 * a
                })
            }
        }
    }

    fn torus_distance(ring: f64, tube: f64, p: V) -> f64 {
        (p[0].hypot(p[2]) - ring).hypot(p[1]) - tube
    }

    /// Sphere tracing, ended by Newton steps: the distance is exact, so nothing is stepped over.
    fn march(self, o: V, d: V) -> Option<f64> {
        let Self::Torus(ring, tube) = self else { return None };
        let length = dot(d, d).sqrt();
        let far = 2.0 * (dot(o, o).sqrt() + ring + tube) / length;
        let mut t = 0.0;
        for _ in 0..4000 {
            let f = Self::torus_distance(ring, tube, along(o, d, t));
            if f < 1e-7 * tube {
                for _ in 0..3 {
                    let p = along(o, d, t);
                    let slope = dot(self.surface(p).n, d);
                    if slope < -1e-4 * length {
                        t -= Self::torus_distance(ring, tube, p) / slope;
                    }
                }
                return Some(t);
            }
            t += f / length;
            if t > far {
                return None;
            }
        }
        None
    }

    pub fn surface(self, p: V) -> Surface {
        match self {
            Self::Plane => Surface { n: [0.0, 1.0, 0.0], h: 0.0, k: 0.0 },
            Self::Sphere(r) => Surface { n: unit(p), h: 1.0 / r, k: 1.0 / (r * r) },
            Self::Cylinder(r) => Surface { n: unit([p[0], 0.0, p[2]]), h: 0.5 / r, k: 0.0 },
            Self::Torus(ring, tube) => {
                let rho = p[0].hypot(p[2]);
                let out = rho - ring;
                let cosine = out / out.hypot(p[1]);
                let around = cosine / (ring + tube * cosine);
                let n = unit([out * p[0] / rho, p[1], out * p[2] / rho]);
                Surface { n, h: 0.5 * (1.0 / tube + around), k: around / tube }
            }
            Self::Ellipsoid(a, b, c) => {
                let (a2, b2, c2) = (a * a, b * b, c * c);
                let g = [p[0] / a2, p[1] / b2, p[2] / c2];
                // Distance of the tangent plane from the centre.
                let s = 1.0 / dot(g, g).sqrt();
                let h = (a2 + b2 + c2 - dot(p, p)) * s.powi(3) / (2.0 * a2 * b2 * c2);
                Surface { n: unit(g), h, k: s.powi(4) / (a2 * b2 * c2) }
            }
            Self::Saddle(a) => {
                let (px, pz) = (p[0] / a, -p[2] / a);
                let w2 = 1.0 + px * px + pz * pz;
                let bend = ((1.0 + pz * pz) - (1.0 + px * px)) / (a * 2.0 * w2 * w2.sqrt());
                Surface { n: unit([-px, 1.0, -pz]), h: -bend, k: -1.0 / (a * a * w2 * w2) }
            }
        }
    }
}

/// First intersection with sum (s_i p_i)^2 = 1.
fn quadric(o: V, d: V, s: V) -> Option<f64> {
    let o = [o[0] * s[0], o[1] * s[1], o[2] * s[2]];
    let d = [d[0] * s[0], d[1] * s[1], d[2] * s[2]];
    let (a, b, c) = (dot(d, d), dot(o, d), dot(o, o) - 1.0);
    let discriminant = b * b - a * c;
    let t = if discriminant < 0.0 { return None } else { c / (-b + discriminant.sqrt()) };
    Some(t).filter(|t| *t > 0.0)
}

/// Where the picture is taken from. The eye looks at the origin from `distance` along +z, the object turned before it.
#[derive(Debug, Clone, Copy)]
pub struct Shot {
    pub shape: Shape,
    pub size: [usize; 2],
    /// Focal length in pixels; an orthographic view takes the same scale at `distance`.
    pub focal: f64,
    pub distance: f64,
    /// Degrees around y, then around x.
    pub turn: [f64; 2],
    pub perspective: bool,
}

pub struct Picture {
    pub shape: Shape,
    pub g: GBuffer,
    pub h: Vec<f64>,
    pub k: Vec<f64>,
    /// Within `BAND` pixels of a contour, the background or the image's border.
    pub band: Vec<bool>,
}

pub const BAND: i64 = 4;

impl Shot {
    /// The same picture of an object `s` times as large.
    pub fn scaled(self, s: f64) -> Self {
        let shape = match self.shape {
            Shape::Plane => Shape::Plane,
            Shape::Sphere(r) => Shape::Sphere(r * s),
            Shape::Cylinder(r) => Shape::Cylinder(r * s),
            Shape::Torus(a, b) => Shape::Torus(a * s, b * s),
            Shape::Ellipsoid(a, b, c) => Shape::Ellipsoid(a * s, b * s, c * s),
            Shape::Saddle(a) => Shape::Saddle(a * s),
        };
        Self { shape, distance: self.distance * s, ..self }
    }

    pub fn take(self) -> Picture {
        let [width, height] = self.size;
        let scale = if self.perspective { 1.0 / self.focal } else { self.distance / self.focal };
        let camera = Camera {
            ray_scale: [scale, -scale],
            ray_offset: [-0.5 * width as f64 * scale, 0.5 * height as f64 * scale],
            perspective: self.perspective,
        };
        let n = width * height;
        let g = GBuffer { width, height, z: vec![0.0; n], normal: vec![[0.0, 0.0, 1.0]; n], camera };
        let mut picture = Picture { shape: self.shape, g, h: vec![0.0; n], k: vec![0.0; n], band: vec![false; n] };
        let mut contour = vec![true; n];
        for (at, near) in contour.iter_mut().enumerate() {
            let x = camera.ray_scale[0] * ((at % width) as f64 + 0.5) + camera.ray_offset[0];
            let y = camera.ray_scale[1] * ((at / width) as f64 + 0.5) + camera.ray_offset[1];
            let (o, d) = if self.perspective { ([0.0; 3], [x, y, -1.0]) } else { ([x, y, 0.0], [0.0, 0.0, -1.0]) };
            let (o, d) = (self.into_object([o[0], o[1], o[2] + self.distance]), self.into_object(d));
            let Some(z) = self.shape.cast(o, d) else { continue };
            let s = self.shape.surface(along(o, d, z));
            let facing = -dot(s.n, d) / dot(d, d).sqrt();
            let side = 1f64.copysign(facing);
            picture.g.z[at] = z;
            picture.g.normal[at] = self.into_view(s.n.map(|v| v * side));
            (picture.h[at], picture.k[at]) = (side * s.h, s.k);
            // A surface of curvature k falls to this cosine within one pixel of its contour.
            *near = facing.abs() < (2.0 * camera.footprint(z) * self.shape.sharpest()).sqrt();
        }
        picture.mark_band(&contour, matches!(self.shape, Shape::Plane));
        picture
    }

    fn rotation(self) -> [V; 3] {
        let ((sy, cy), (sx, cx)) = (self.turn[0].to_radians().sin_cos(), self.turn[1].to_radians().sin_cos());
        [[cy, 0.0, sy], [sx * sy, cx, -sx * cy], [-cx * sy, sx, cx * cy]]
    }

    fn into_view(self, v: V) -> V {
        self.rotation().map(|row| dot(row, v))
    }

    fn into_object(self, v: V) -> V {
        let r = self.rotation();
        [0, 1, 2].map(|i| r[0][i] * v[0] + r[1][i] * v[1] + r[2][i] * v[2])
    }
}

impl Picture {
    fn mark_band(&mut self, contour: &[bool], flat: bool) {
        let (w, h) = (self.g.width as i64, self.g.height as i64);
        for y in 0..h {
            for x in 0..w {
                let near = (-BAND..=BAND).flat_map(|dy| (-BAND..=BAND).map(move |dx| (x + dx, y + dy)));
                let mut hit = x == 0 || y == 0 || x == w - 1 || y == h - 1;
                for (i, j) in near.filter(|(i, j)| *i >= 0 && *j >= 0 && *i < w && *j < h) {
                    let at = (j * w + i) as usize;
                    hit |= self.g.z[at] == 0.0 || (contour[at] && !flat);
                }
                self.band[(y * w + x) as usize] = hit;
            }
        }
    }

    /// Rounds the normals as the G-buffer stores them: octahedral, `bits` a coordinate.
    pub fn quantise(&mut self, bits: u32) {
        let steps = f64::from((1u32 << (bits - 1)) - 1);
        for n in &mut self.g.normal {
            *n = octahedral(*n, steps);
        }
    }

    pub fn covered(&self) -> impl Iterator<Item = usize> + '_ {
        (0..self.g.z.len()).filter(|i| self.g.z[*i] != 0.0)
    }
}

fn octahedral(n: V, steps: f64) -> V {
    let sign = |x: f64| if x >= 0.0 { 1.0 } else { -1.0 };
    let sum = n[0].abs() + n[1].abs() + n[2].abs();
    let (mut x, mut y) = (n[0] / sum, n[1] / sum);
    if n[2] < 0.0 {
        (x, y) = ((1.0 - y.abs()) * sign(x), (1.0 - x.abs()) * sign(y));
    }
    let (x, y) = ((x * steps).round() / steps, (y * steps).round() / steps);
    let z = 1.0 - x.abs() - y.abs();
    let fold = (-z).max(0.0);
    unit([x - sign(x) * fold, y - sign(y) * fold, z])
}
