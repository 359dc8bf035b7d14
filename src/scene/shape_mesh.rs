//! Triangles of the built-in shapes. Every vertex lies on the exact surface and carries the exact normal; the chords
//! are short enough that the flat triangles stay within a hundredth of a pixel of it at the usual framing (the object
//! filling some 1,000 pixels), and nowhere do triangles shrink to a pole.

use glam::{DVec2, DVec3};

use super::shape::{ShapeSpec, shape_normal};
use super::{Aabb, Draw, Material, Scene};

/// Segments around a full circle: a chord's height is r (2 pi / n)^2 / 8, 2e-5 r.
const AROUND: usize = 512;
/// Segments around the torus's axis and around its tube: 102,400 triangles.
const TORUS: (usize, usize) = (320, 160);
/// Segments along the edge of a spherical cube's face: as fine as `AROUND`.
const CUBE_SPHERE: usize = AROUND / 4;
/// Segments along the edge of a flat face. One would do; more give methods that work at vertices something to hold.
const FLAT: usize = 32;
/// Segments along the edge of the saddle.
const SADDLE: usize = 256;

/// Builds the mesh of a shape; `name` becomes the scene's name.
pub(super) fn build(name: &str, spec: &ShapeSpec) -> Scene {
    let mut mesh =
        Builder { spec: *spec, positions: Vec::new(), normals: Vec::new(), uvs: Vec::new(), indices: Vec::new() };
    match *spec {
        ShapeSpec::Plane => {
            let half = ShapeSpec::PLANE_HALF;
            mesh.patch([FLAT; 2], FULL, |s, t| sheet(s, t, half, |_, _| 0.0));
        }
        ShapeSpec::Saddle { a } => {
            mesh.patch([SADDLE; 2], FULL, |s, t| sheet(s, t, 2.0 * a, |x, z| (x * x - z * z) / (2.0 * a)))
        }
        ShapeSpec::Sphere { r } => mesh.cube(CUBE_SPHERE, |p| round(p) * r),
        ShapeSpec::Ellipsoid { a, b, c } => {
            mesh.cube(CUBE_SPHERE, |p| round(p) * DVec3::new(a, b, c));
        }
        ShapeSpec::Cube { a } => mesh.cube(FLAT, |p| p * (a / 2.0)),
        ShapeSpec::Torus { major, minor } => {
            mesh.patch([TORUS.0, TORUS.1], FULL, |s, t| {
                let (sin_s, cos_s) = turn(s);
                // The tube runs from its inside over the top, so the seam hides in the hole.
                let (sin_t, cos_t) = turn(0.5 - t);
                let radius = major + minor * cos_t;
                DVec3::new(radius * sin_s, minor * sin_t, radius * cos_s)
            });
        }
        ShapeSpec::Cylinder { r } => mesh.cylinder(r),
    }
    mesh.finish(name)
}

/// The whole unit square of UVs.
const FULL: [DVec2; 2] = [DVec2::ZERO, DVec2::ONE];

/// Sine and cosine of a part of a full turn, exact at quarters so that seams close to the bit.
fn turn(part: f64) -> (f64, f64) {
    let quarters = part * 4.0;
    let whole = quarters.round();
    let (s, c) = ((quarters - whole) * std::f64::consts::FRAC_PI_2).sin_cos();
    match (whole as i64).rem_euclid(4) {
        0 => (s, c),
        1 => (c, -s),
        2 => (-s, -c),
        _ => (-c, s),
    }
}

/// A point of a height field over a square, x along s and z along t.
fn sheet(s: f64, t: f64, half: f64, height: impl Fn(f64, f64) -> f64) -> DVec3 {
    let (x, z) = ((2.0 * s - 1.0) * half, (2.0 * t - 1.0) * half);
    DVec3::new(x, height(x, z), z)
}

/// The unit sphere's point for a point on the cube [-1, 1]^3. The tangent spaces a face's grid lines by equal angles;
/// a plain projection would make triangles five times smaller at the corners than in the middle.
fn round(p: DVec3) -> DVec3 {
    let spaced = (p * std::f64::consts::FRAC_PI_4).to_array().map(f64::tan);
    DVec3::from_array(spaced).normalize()
}

struct Builder {
    spec: ShapeSpec,
    positions: Vec<[f32; 3]>,
    normals: Vec<[f32; 3]>,
    uvs: Vec<[f32; 2]>,
    indices: Vec<u32>,
}

impl Builder {
    fn vertex(&mut self, p: DVec3, normal: DVec3, uv: DVec2) {
        self.positions.push(p.as_vec3().to_array());
        self.normals.push(normal.as_vec3().to_array());
        self.uvs.push(uv.as_vec2().to_array());
    }

    /// A grid of s (columns) by t (rows), both 0..1, facing ds x -dt; UVs fill the rectangle `uv`. The normal is the
    /// shape's own at each point.
    fn patch(&mut self, cells: [usize; 2], uv: [DVec2; 2], point: impl Fn(f64, f64) -> DVec3) {
        let spec = self.spec;
        self.grid(cells, uv, |s, t| {
            let p = point(s, t);
            (p, shape_normal(&spec, p))
        });
    }

    /// A grid like [`patch`](Self::patch) with its normals given.
    fn grid(&mut self, [columns, rows]: [usize; 2], uv: [DVec2; 2], point: impl Fn(f64, f64) -> (DVec3, DVec3)) {
        let first = self.positions.len() as u32;
        for row in 0..=rows {
            for column in 0..=columns {
                let at = DVec2::new(column as f64 / columns as f64, row as f64 / rows as f64);
                let (p, n) = point(at.x, at.y);
                self.vertex(p, n, uv[0] + (uv[1] - uv[0]) * at);
            }
        }
        let stride = columns as u32 + 1;
        for row in 0..rows as u32 {
            for column in 0..columns as u32 {
                let a = first + row * stride + column;
                let (b, c, d) = (a + 1, a + stride, a + stride + 1);
                // Alternate diagonals: no direction is favoured.
                if (row + column) % 2 == 0 {
                    self.indices.extend([a, c, d, a, d, b]);
                } else {
                    self.indices.extend([a, c, b, b, c, d]);
                }
            }
        }
    }

    /// Six faces of the cube [-1, 1]^3, mapped onto the shape; UVs are an atlas of 3 by 2 squares with gutters.
    fn cube(&mut self, cells: usize, map: impl Fn(DVec3) -> DVec3) {
        let faces = [
            (DVec3::X, DVec3::NEG_Z),
            (DVec3::NEG_X, DVec3::Z),
            (DVec3::Y, DVec3::X),
            (DVec3::NEG_Y, DVec3::X),
            (DVec3::Z, DVec3::X),
            (DVec3::NEG_Z, DVec3::NEG_X),
        ];
        let sharp = matches!(self.spec, ShapeSpec::Cube { .. });
        let spec = self.spec;
        for (index, (out, right)) in faces.into_iter().enumerate() {
            let down = right.cross(out);
            let corner = DVec2::new((index % 3) as f64 / 3.0, (index / 3) as f64 / 2.0);
            // Room for what a blur over texture coordinates needs of the faces next door.
            let gutter = DVec2::splat(1.0 / 24.0);
            let uv = [corner + gutter, corner + DVec2::new(1.0 / 3.0, 0.5) - gutter];
            self.grid([cells; 2], uv, |s, t| {
                let p = map(out + right * (2.0 * s - 1.0) + down * (2.0 * t - 1.0));
                // On a cube's edge the point alone cannot tell which face it belongs to.
                (p, if sharp { out } else { shape_normal(&spec, p) })
            });
        }
    }

    fn cylinder(&mut self, r: f64) {
        let half = ShapeSpec::cylinder_half(r);
        // The wall above, its two ends below.
        let wall = [DVec2::ZERO, DVec2::new(1.0, 0.74)];
        self.grid([AROUND, FLAT], wall, |s, t| {
            let (sin, cos) = turn(s);
            let out = DVec3::new(sin, 0.0, cos);
            (out * r + DVec3::Y * half * (1.0 - 2.0 * t), out)
        });
        for up in [1.0, -1.0] {
            self.cap(r, half, up);
        }
    }

    /// A disc of triangles around its middle, facing +Y or -Y.
    fn cap(&mut self, r: f64, half: f64, up: f64) {
        let middle = DVec2::new(0.5 - 0.25 * up, 0.875);
        let first = self.positions.len() as u32;
        let normal = DVec3::Y * up;
        self.vertex(normal * half, normal, middle);
        for step in 0..AROUND {
            let (sin, cos) = turn(step as f64 / AROUND as f64);
            let p = DVec3::new(sin * r, half * up, cos * r);
            self.vertex(p, normal, middle + DVec2::new(sin, cos) * 0.12);
        }
        for step in 0..AROUND as u32 {
            let (a, b) = (first + 1 + step, first + 1 + (step + 1) % AROUND as u32);
            self.indices.extend(if up > 0.0 { [first, a, b] } else { [first, b, a] });
        }
    }

    fn finish(self, name: &str) -> Scene {
        let mut material = Material::new("shape");
        material.double_sided = self.spec.is_open();
        Scene {
            name: name.to_owned(),
            origin: DVec3::ZERO,
            bounds: Aabb::around(&self.positions),
            second_uvs: Vec::new(),
            colors: Vec::new(),
            draws: vec![Draw { material: 0, first_index: 0, index_count: self.indices.len() as u32 }],
            positions: self.positions,
            normals: self.normals,
            tangents: Vec::new(),
            uvs: self.uvs,
            indices: self.indices,
            materials: vec![material],
            textures: Vec::new(),
            lights: Vec::new(),
            cameras: Vec::new(),
            environment: None,
            warnings: Vec::new(),
        }
    }
}
