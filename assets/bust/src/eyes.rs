//! The eyeballs: spheres with the bulge of the cornea, each one chart around its front pole.

use glam::{DVec2, DVec3, dvec2, dvec3};

use crate::face::{EYE, EYE_RADIUS};
use crate::sdf::join;

/// The cornea: how far in front of the eyeball's middle its own middle lies, and its radius, mm.
const CORNEA: [f64; 2] = [5.4, 7.5];
/// Radius of a chart in its square: the rest is room around it.
const REACH: f64 = 0.48;
/// Radius in the chart goes with the angle from the front to this power, so that the iris has most of the texels.
const SPREAD: f64 = 0.6;

fn surface(direction: DVec3) -> DVec3 {
    let field = |p: DVec3| join(p.length() - EYE_RADIUS, p.distance(DVec3::Z * CORNEA[0]) - CORNEA[1], 0.8);
    let mut r = EYE_RADIUS;
    for _ in 0..30 {
        r -= field(direction * r);
    }
    direction * r
}

/// Where in the square a direction from the eyeball's middle lies.
pub fn chart(direction: DVec3) -> DVec2 {
    let turn = direction.xy_or_zero();
    let angle = direction.z.clamp(-1., 1.).acos() / std::f64::consts::PI;
    dvec2(0.5, 0.5) + REACH * angle.powf(SPREAD) * dvec2(turn.x, -turn.y)
}

trait Turn {
    fn xy_or_zero(self) -> DVec2;
}

impl Turn for DVec3 {
    fn xy_or_zero(self) -> DVec2 {
        dvec2(self.x, self.y).normalize_or_zero()
    }
}

/// The point of the left eyeball that is charted at `q`, in the bust's space, mm.
pub fn point(q: DVec2) -> DVec3 {
    let q = (q - 0.5) / REACH;
    let angle = q.length().min(1.).powf(1. / SPREAD) * std::f64::consts::PI;
    let turn = q.normalize_or_zero();
    let direction = dvec3(angle.sin() * turn.x, -angle.sin() * turn.y, angle.cos());
    DVec3::from(EYE) + surface(direction)
}

/// A vertex of an eyeball: place, normal, UV within its square.
pub struct Vertex {
    pub position: DVec3,
    pub normal: DVec3,
    pub uv: DVec2,
}

/// The left eyeball. The back pole is a ring of vertices at one place, so that the chart is whole.
pub fn ball(rings: u32, sides: u32) -> (Vec<Vertex>, Vec<[u32; 3]>) {
    let place = |ring: u32, side: u32| {
        // Rings stand closer in front.
        let angle = std::f64::consts::PI * (f64::from(ring) / f64::from(rings)).powf(1.3);
        let (s, c) = (std::f64::consts::TAU * f64::from(side) / f64::from(sides)).sin_cos();
        let sin = if ring == rings { 0. } else { angle.sin() };
        (dvec3(sin * c, sin * s, angle.cos()), dvec2(c, s))
    };
    let vertex = |direction: DVec3, turn: DVec2, ring: u32| {
        let p = surface(direction);
        let grow = |d: f64| {
            surface(
                (direction + dvec3(turn.x * direction.z, turn.y * direction.z, -direction.truncate().length()) * d)
                    .normalize(),
            )
        };
        let along = grow(1e-3) - grow(-1e-3);
        let across = dvec3(-turn.y, turn.x, 0.);
        let normal = if ring == 0 {
            DVec3::Z
        } else if ring == rings {
            DVec3::NEG_Z
        } else {
            along.cross(across).normalize()
        };
        let q = if ring == rings { dvec2(0.5, 0.5) + REACH * dvec2(turn.x, -turn.y) } else { chart(direction) };
        Vertex { position: DVec3::from(EYE) + p, normal: normal * normal.dot(p).signum(), uv: q }
    };
    let mut vertices = vec![vertex(DVec3::Z, DVec2::X, 0)];
    let mut triangles = Vec::new();
    for ring in 1..=rings {
        for side in 0..sides {
            let (direction, turn) = place(ring, side);
            vertices.push(vertex(direction, turn, ring));
            let at = |ring: u32, side: u32| if ring == 0 { 0 } else { 1 + (ring - 1) * sides + side % sides };
            let [a, b, c, d] = [at(ring - 1, side), at(ring, side), at(ring, side + 1), at(ring - 1, side + 1)];
            triangles.push(if ring < rings { [a, b, c] } else { [a, b, d] });
            if ring > 1 && ring < rings {
                triangles.push([a, c, d]);
            }
        }
    }
    (vertices, triangles)
}
