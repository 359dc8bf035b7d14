//! Coarse triangles under smooth normals: what the G-buffer says of them, and that they do not shade one another where light grazes.
mod studio;

use glam::{DMat4, DVec3};
use pdss::frame::Renderer;
use pdss::scene::Light;
use pdss::settings::{Method, View};
use pdss::skin::facet;
use pdss::stress::studio::triangles;
use std::f32::consts::{PI, TAU};
use std::sync::Arc;
use studio::{Set, settings};

const SIZE: [u32; 2] = [160, 120];
const RADIUS: f32 = 20.;

/// A ball of 16 x 10 patches, its normals a sphere's.
fn ball(size: [u32; 2], method: Method) -> Set {
    let (around, down) = (16u32, 10u32);
    let place = |i: u32, j: u32| {
        let (a, b) = (TAU * i as f32 / around as f32, PI * j as f32 / down as f32);
        [b.sin() * a.cos(), b.cos(), b.sin() * a.sin()]
    };
    let normals: Vec<[f32; 3]> =
        (0..=down).flat_map(|j| (0..=around).map(move |i| (i, j))).map(|(i, j)| place(i, j)).collect();
    let mut indices = Vec::new();
    for j in 0..down {
        for i in 0..around {
            let a = j * (around + 1) + i;
            let b = a + around + 1;
            indices.extend(if j > 0 { vec![a, a + 1, b + 1] } else { Vec::new() });
            indices.extend(if j + 1 < down { vec![a, b + 1, b] } else { Vec::new() });
        }
    }
    let mut set = Set::new("shape:sphere:20", 90., settings(method, View::Scatter, size));
    let positions = normals.iter().map(|n| n.map(|x| x * RADIUS)).collect();
    set.scene = Arc::new(triangles("ball", positions, normals, indices));
    set.lights = vec![Light::directional(100., 20., 1.)];
    set
}

/// The triangle under a pixel, in the scene's space: corners, normals, barycentric coordinates.
struct Hit {
    corners: [DVec3; 3],
    normals: [DVec3; 3],
    shares: [f64; 3],
}

impl Hit {
    fn place(&self) -> DVec3 {
        (0..3).map(|i| self.corners[i] * self.shares[i]).sum()
    }

    fn smooth(&self) -> DVec3 {
        (0..3).map(|i| self.normals[i] * self.shares[i]).sum::<DVec3>().normalize()
    }

    fn facet(&self) -> DVec3 {
        let [a, b, c] = self.corners;
        let n = (b - a).cross(c - a).normalize();
        n * n.dot(self.smooth()).signum()
    }
}

/// What a ray meets first, further on than `from` mm.
fn cast(set: &Set, origin: DVec3, direction: DVec3, from: f64) -> Option<Hit> {
    let double = |v: [f32; 3]| DVec3::from_array(v.map(f64::from));
    let mut nearest: Option<(f64, Hit)> = None;
    for t in set.scene.indices.chunks_exact(3) {
        let corners = [0, 1, 2].map(|i| double(set.scene.positions[t[i] as usize]));
        let (e, f) = (corners[1] - corners[0], corners[2] - corners[0]);
        let h = direction.cross(f);
        let (det, s) = (e.dot(h), origin - corners[0]);
        let u = s.dot(h) / det;
        let v = direction.dot(s.cross(e)) / det;
        let along = f.dot(s.cross(e)) / det;
        if u >= 0. && v >= 0. && u + v <= 1. && along > from && nearest.as_ref().is_none_or(|n| along < n.0) {
            let normals = [0, 1, 2].map(|i| double(set.scene.normals[t[i] as usize]));
            nearest = Some((along, Hit { corners, normals, shares: [1. - u - v, u, v] }));
        }
    }
    nearest.map(|n| n.1)
}

/// What each pixel sees, and how many mm a pixel is there.
fn seen(set: &Set) -> Vec<Option<(Hit, f64)>> {
    let [w, h] = SIZE.map(f64::from);
    let world: DMat4 = set.camera.world_from_view().as_dmat4();
    let clip = set.camera.clip_from_view(SIZE[0] as f32 / SIZE[1] as f32).as_dmat4();
    let (sx, sy) = (clip.x_axis.x, clip.y_axis.y);
    let pixel = |i: usize| {
        let (x, y) = ((i % SIZE[0] as usize) as f64 + 0.5, (i / SIZE[0] as usize) as f64 + 0.5);
        let ray = DVec3::new((2. * x / w - 1.) / sx, (2. * y / h - 1.) / sy, -1.);
        let hit = cast(set, world.transform_point3(DVec3::ZERO), world.transform_vector3(ray), 0.)?;
        let z = -world.inverse().transform_point3(hit.place()).z;
        Some((hit, z * 2. / (h * sy.abs())))
    };
    (0..(SIZE[0] * SIZE[1]) as usize).map(pixel).collect()
}

#[test]
fn the_device_holds_a_facet_as_its_twin_does() {
    let gpu = studio::open();
    let set = ball(SIZE, Method::Lambert);
    let mut renderer = Renderer::edited(&gpu, set.inputs(), |plan| plan.keep("facet")).expect("a frame");
    renderer.run().expect("it runs");
    let bits: Vec<u32> =
        renderer.texels("facet").expect("kept").chunks_exact(4).map(bytemuck::pod_read_unaligned).collect();
    drop(renderer);
    let view = set.camera.view_from_world().as_dmat4();
    let (mut off, mut wrong, mut turned) = (Vec::new(), Vec::new(), Vec::new());
    for (pixel, bits) in seen(&set).into_iter().zip(bits) {
        let Some((hit, mm)) = pixel else { continue };
        // Between two triangles the raster may take the other.
        if hit.shares.iter().any(|s| *s < 0.02) {
            continue;
        }
        let (normal, rise) = facet::decode(bits);
        let want = facet::rise(hit.corners, hit.normals, hit.shares) / mm;
        off.push((rise - want).abs() / want.max(0.05));
        wrong.push((rise - want / 2.).abs() / want.max(0.05));
        turned.push(normal.distance(view.transform_vector3(hit.facet())));
    }
    let most = |list: &[f64]| list.iter().fold(0f64, |a, b| a.max(*b));
    println!(
        "{} pixels: rise {:.4} off, normal {:.1e}; half the rise {:.3}",
        off.len(),
        most(&off),
        most(&turned),
        most(&wrong)
    );
    assert!(off.len() > 3000 && most(&off) < 0.015 && most(&turned) < 4e-3, "{} {}", most(&off), most(&turned));
    assert!(most(&wrong) > 0.3);
    studio::close(gpu);
}

#[test]
fn a_ball_of_coarse_triangles_has_a_smooth_terminator() {
    let gpu = studio::open();
    for method in [Method::Lambert, Method::Gaussians] {
        let mut set = ball(SIZE, method);
        if method == Method::Gaussians {
            // Its light before it scatters.
            set.settings.view = View::Irradiance;
        }
        let picture = set.linear(&gpu);
        set.settings.no_shadows = true;
        let open = set.linear(&gpu);
        let direction = match set.lights[0].kind {
            pdss::scene::LightKind::Directional { direction } => direction.as_dvec3(),
            _ => unreachable!("a directional light"),
        };
        let (mut all, mut dark, mut facets) = (0, 0, 0);
        for (i, pixel) in seen(&set).into_iter().enumerate() {
            let Some((hit, _)) = pixel else { continue };
            if hit.smooth().dot(direction) < 0.05 || open.texels[i][1] <= 0. {
                continue;
            }
            all += 1;
            dark += usize::from(picture.texels[i][1] < 0.5 * open.texels[i][1]);
            // The twin: rays from the triangles themselves.
            facets += usize::from(cast(&set, hit.place(), direction, 1e-6).is_some());
        }
        println!("{method:?}: of {all} lit pixels {dark} lie in shadow; by rays from the triangles {facets}");
        assert!(all > 1000 && dark * 100 <= all && facets * 50 >= all, "{method:?}: {all} {dark} {facets}");
    }
    studio::close(gpu);
}
