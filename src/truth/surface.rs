//! The scene as a surface that rays meet: triangles in f64 behind a hierarchy of f32 boxes.

use super::bump;
use crate::frame::view::ViewFacts;
use crate::scene::{Camera, Mips, Projection, Scene};
use glam::{DVec3, Vec3A};
use obvhs::aabb::Aabb;
use obvhs::bvh2::Bvh2;
use obvhs::bvh2::builder::build_bvh2;
use obvhs::bvh2::node::Bvh2Node;
use obvhs::ray::{Ray, RayHit};
use obvhs::{Boundable, BvhBuildParams};
use rayon::prelude::*;
use std::time::Duration;

/// Boxes are widened, and hits this near a shadow ray's start ignored, by this part of the scene's extent: above the
/// rounding of f32 positions, far below anything that is seen.
const SLACK: f64 = 1e-6;
/// How far outside a triangle its barycentric coordinates still hit it, so that rays do not slip through shared edges.
const EDGE: f64 = 1e-9;

/// Where a ray meets a triangle.
#[derive(Clone, Copy, Debug)]
pub struct Hit {
    /// In units of the ray's direction.
    pub t: f64,
    /// Index into [`Surface::faces`].
    pub face: u32,
    /// Barycentric coordinates of the second and third corner.
    pub at: [f64; 2],
}

/// One triangle.
#[derive(Clone, Copy, Debug)]
pub struct Face {
    /// Corners, mm.
    pub corners: [DVec3; 3],
    /// Vertices of the scene.
    pub vertices: [u32; 3],
    /// Material of the scene.
    pub material: u32,
}

impl Face {
    /// The front's normal times twice the area, mm^2.
    pub fn cross(&self) -> DVec3 {
        let [a, b, c] = self.corners;
        (b - a).cross(c - a)
    }

    /// mm^2.
    pub fn area(&self) -> f64 {
        0.5 * self.cross().length()
    }
}

/// A place on the surface.
#[derive(Clone, Copy, Debug)]
pub struct Place {
    /// mm.
    pub position: DVec3,
    /// Where shadow rays start: on the surface that the vertex normals mean, not on its facet (Hanika 2021), mm.
    pub lifted: DVec3,
    /// Unit normal that light falls on: interpolated, with the normal map, towards the viewer on double-sided material.
    pub normal: DVec3,
    /// The same without the normal map.
    pub smooth: DVec3,
    /// Unit normal of the triangle.
    pub facet: DVec3,
    /// Index into [`Surface::faces`].
    pub face: u32,
}

/// Triangles and their hierarchy.
pub struct Surface<'a> {
    /// In the hierarchy's order, which keeps neighbours together.
    pub faces: Vec<Face>,
    scene: &'a Scene,
    boxes: Bvh2,
    eye: Eye,
    /// Hits nearer than this to a ray's start are of the faces that meet there, mm.
    pub(super) slack: f64,
    normal_maps: Vec<Option<Mips>>,
    steps: Steps,
}

/// How the places behind neighbouring pixels differ: what mip levels follow from.
struct Steps {
    /// The camera's axes to the right and up, over the pixels that a mm covers at unit distance.
    across: [DVec3; 2],
    forward: DVec3,
}

/// What decides which side of a double-sided triangle is seen.
enum Eye {
    At(DVec3),
    Along(DVec3),
}

struct Bound(Aabb);

impl Boundable for Bound {
    fn aabb(&self) -> Aabb {
        self.0
    }
}

impl<'a> Surface<'a> {
    /// Builds the hierarchy. Alpha is ignored: what is cut out elsewhere is whole here.
    ///
    /// Normal maps are read at the mip level that a picture of `size` pixels reads.
    pub fn new(scene: &'a Scene, camera: &Camera, size: [u32; 2]) -> Self {
        let vertex = |i: u32| DVec3::from_array(scene.positions[i as usize].map(f64::from));
        let mut faces = Vec::with_capacity(scene.triangle_count());
        for draw in &scene.draws {
            let range = draw.first_index as usize..(draw.first_index + draw.index_count) as usize;
            faces.extend(scene.indices[range].chunks_exact(3).map(|t| Face {
                corners: [vertex(t[0]), vertex(t[1]), vertex(t[2])],
                vertices: [t[0], t[1], t[2]],
                material: draw.material as u32,
            }));
        }
        let slack = SLACK * f64::from(scene.bounds.size().max_element().max(scene.bounds.max.abs().max_element()));
        let room = Vec3A::splat(slack as f32);
        let bounds: Vec<Bound> = faces
            .iter()
            .map(|f: &Face| {
                let [a, b, c] = f.corners.map(|p| Vec3A::from(p.as_vec3()));
                Bound(Aabb::new(a.min(b).min(c) - room, a.max(b).max(c) + room))
            })
            .collect();
        let boxes = build_bvh2(&bounds, BvhBuildParams::fast_build(), &mut Duration::default());
        let faces = boxes.primitive_indices.iter().map(|&i| faces[i as usize]).collect();
        let eye = match camera.projection {
            Projection::Perspective { .. } => Eye::At(camera.eye.as_dvec3()),
            Projection::Orthographic { .. } => Eye::Along(camera.forward.as_dvec3()),
        };
        let used = |i: usize| scene.materials.iter().any(|m| m.normal_texture.is_some_and(|t| t.0 == i));
        let maps: Vec<usize> = (0..scene.textures.len()).collect();
        let normal_maps = maps.par_iter().map(|i| used(*i).then(|| Mips::of(&scene.textures[*i]))).collect();
        let pixels = ViewFacts::new(camera, size, scene.bounds.min, scene.bounds.max).pixels_per_mm;
        let across = [camera.right, camera.up].map(|axis| axis.as_dvec3() / pixels);
        let steps = Steps { across, forward: camera.forward.as_dvec3() };
        Self { faces, scene, boxes, eye, slack, normal_maps, steps }
    }

    /// The profile of a face's material.
    pub fn profile(&self, face: u32) -> Option<usize> {
        let material = self.faces[face as usize].material as usize;
        self.scene.materials.get(material).and_then(|m| m.scatter)
    }

    fn double_sided(&self, face: &Face) -> bool {
        self.scene.materials.get(face.material as usize).is_some_and(|m| m.double_sided)
    }

    /// The first face between `near` and `far` that a viewer sees: backs of single-sided ones are not there.
    pub fn seen(&self, origin: DVec3, direction: DVec3, near: f64, far: f64) -> Option<Hit> {
        let mut best: Option<Hit> = None;
        self.each(origin, direction, near, far, |hit, front| {
            let culled = !front && !self.double_sided(&self.faces[hit.face as usize]);
            if !culled && best.is_none_or(|b| hit.t < b.t) {
                best = Some(hit);
            }
            best.map_or(far, |b| b.t)
        });
        best
    }

    /// Whether anything stands between a place and a light `distance` mm away in a unit direction.
    pub fn hidden(&self, place: &Place, direction: DVec3, distance: f64) -> bool {
        let mut blocked = false;
        self.each(place.lifted, direction, self.slack, distance, |hit, _| {
            blocked |= hit.face != place.face;
            if blocked { f64::NEG_INFINITY } else { distance }
        });
        blocked
    }

    /// Calls `found` for every face that the ray meets between `near` and `far`, in no order, with whether it is the
    /// front; what it returns is the new far end.
    pub fn each(&self, origin: DVec3, direction: DVec3, near: f64, far: f64, mut found: impl FnMut(Hit, bool) -> f64) {
        let mut far = far;
        let ray = Ray::new(origin.as_vec3a(), direction.as_vec3a(), near as f32, widen(far));
        let mut test = |node: &Bvh2Node, ray: &mut Ray, _: &mut RayHit| {
            for face in node.first_index..node.first_index + node.prim_count {
                let Some((t, at, front)) = meet(&self.faces[face as usize].corners, origin, direction) else {
                    continue;
                };
                if t > near && t < far {
                    far = found(Hit { t, face, at }, front);
                }
            }
            ray.tmax = widen(far);
            far > near
        };
        obvhs::fast_stack!(u32, (64, 192), self.boxes.max_depth, stack, {
            self.boxes.ray_traverse_dynamic(&mut stack, ray, &mut RayHit::none(), &mut test);
        });
    }

    /// The place with these barycentric coordinates.
    pub fn place(&self, face: u32, [u, v]: [f64; 2]) -> Place {
        let f = &self.faces[face as usize];
        let shares = [1. - u - v, u, v];
        let normals = f.vertices.map(|i| DVec3::from_array(self.scene.normals[i as usize].map(f64::from)));
        let mix = |x: [DVec3; 3]| x[0] * shares[0] + x[1] * shares[1] + x[2] * shares[2];
        let position = mix(f.corners);
        // Lifted to where the tangent planes of the corners put it, where they lie above the facet.
        let lifts: [DVec3; 3] =
            std::array::from_fn(|i| normals[i] * -(position - f.corners[i]).dot(normals[i]).min(0.));
        let facet = f.cross().normalize_or(DVec3::Y);
        let smooth = mix(normals).normalize_or(facet);
        let (mut lifted, mut sign) = (position + mix(lifts), 1.);
        if self.double_sided(f) && facet.dot(self.towards_eye(position)) < 0. {
            // Seen from behind: the lift would sink.
            (lifted, sign) = (position, -1.);
        }
        let texels = |size: [f64; 2]| self.texels_per_pixel(f, position, size);
        let normal = bump::normal(self.scene, &self.normal_maps, f, shares, smooth * sign, sign, texels);
        Place { position, lifted, normal, smooth: smooth * sign, facet, face }
    }

    /// Texels of a map of `size` between neighbouring pixels, along the axis of the picture where there are more. Of any place,
    /// seen or not, as if nothing stood before it.
    fn texels_per_pixel(&self, f: &Face, position: DVec3, size: [f64; 2]) -> f64 {
        let (forward, cross) = (self.steps.forward, f.cross());
        // Position = eye + distance * ray; a step to the next pixel stays in the plane of the face.
        let (ray, distance) = match self.eye {
            Eye::At(eye) => {
                let distance = (position - eye).dot(forward);
                ((position - eye) / distance, distance)
            }
            Eye::Along(forward) => (forward, 1.),
        };
        let uv = f.vertices.map(|i| self.scene.uvs.get(i as usize).map_or([0.; 2], |c| c.map(f64::from)));
        let [a, b, c] = f.corners;
        let (e, g, square) = (b - a, c - a, cross.length_squared());
        let texels = |axis: DVec3| {
            let step = distance * (axis - ray * (cross.dot(axis) / cross.dot(ray)));
            let (s, t) = (step.cross(g).dot(cross) / square, e.cross(step).dot(cross) / square);
            let along = |k: usize| (s * (uv[1][k] - uv[0][k]) + t * (uv[2][k] - uv[0][k])) * size[k];
            along(0).hypot(along(1))
        };
        let [x, y] = self.steps.across.map(texels);
        x.max(y)
    }

    fn towards_eye(&self, position: DVec3) -> DVec3 {
        match self.eye {
            Eye::At(eye) => eye - position,
            Eye::Along(forward) => -forward,
        }
    }
}

/// Boxes are met in f32: a little beyond is none too few.
fn widen(far: f64) -> f32 {
    far as f32 * if far > 0. { 1.000_001 } else { 1. }
}

/// Distance, barycentric coordinates, and whether it is the front (Möller & Trumbore 1997).
fn meet([a, b, c]: &[DVec3; 3], origin: DVec3, direction: DVec3) -> Option<(f64, [f64; 2], bool)> {
    let (e, g, s) = (*b - *a, *c - *a, origin - *a);
    let p = direction.cross(g);
    let det = e.dot(p);
    let inverse = 1. / det;
    let u = s.dot(p) * inverse;
    let q = s.cross(e);
    let v = direction.dot(q) * inverse;
    // A NaN from a ray in the triangle's plane fails this, too.
    let inside = u >= -EDGE && v >= -EDGE && u + v <= 1. + EDGE;
    inside.then(|| (g.dot(q) * inverse, [u, v], det > 0.))
}
