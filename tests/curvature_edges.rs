//! Where neighbours fail the estimators: edges of objects and images, creases, noise, single pixels.
mod analytic;

use analytic::{Shape, Shot};
use pdss::skin::curvature::{Camera, Curvature, Estimator, FOOTPRINT_BOUND, GBuffer, estimate};

const OURS: [Estimator; 2] = [Estimator::Metric, Estimator::Fit];

fn gbuffer(width: usize, height: usize, pixel: impl Fn(usize, usize) -> (f64, [f64; 3])) -> GBuffer {
    let at = |i: usize| pixel(i % width, i / width);
    GBuffer {
        width,
        height,
        z: (0..width * height).map(|i| at(i).0).collect(),
        normal: (0..width * height).map(|i| at(i).1).collect(),
        camera: Camera { ray_scale: [1e-3, -1e-3], ray_offset: [0.0, 0.0], perspective: true },
    }
}

fn unit(a: [f64; 3]) -> [f64; 3] {
    let s = 1.0 / (a[0] * a[0] + a[1] * a[1] + a[2] * a[2]).sqrt();
    a.map(|x| x * s)
}

/// Uniform in [0, 1), the same in every run.
fn noise(seed: &mut u64) -> f64 {
    *seed = seed.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
    (*seed >> 40) as f64 / (1u64 << 24) as f64
}

/// Whatever the input, |H| stays within the footprint's bound and everything is finite.
#[test]
fn bounded_on_noise() {
    let mut seed = 1;
    for roughness in [1e-4, 1e-2, 1.0] {
        let (mut z, mut normal) = (Vec::new(), Vec::new());
        for _ in 0..64 * 64 {
            let sign = if noise(&mut seed) < 0.2 { -1.0 } else { 1.0 };
            let hole = if noise(&mut seed) < 0.1 { 0.0 } else { 1.0 };
            z.push(500.0 * sign * hole * (1.0 + roughness * noise(&mut seed)));
            normal.push(unit([noise(&mut seed) - 0.5, noise(&mut seed) - 0.5, roughness * noise(&mut seed)]));
        }
        let mut g = gbuffer(64, 64, |_, _| (0.0, [0.0; 3]));
        (g.z, g.normal) = (z, normal);
        for e in Estimator::ALL {
            let c = estimate(e, &g);
            assert!(c.iter().all(|c| c.h.is_finite() && c.k.is_finite() && (0.0..=1.0).contains(&c.confidence)));
            if OURS.contains(&e) {
                let excess = |i: usize| c[i].h.abs() * g.camera.footprint(g.z[i]) - FOOTPRINT_BOUND;
                assert!((0..c.len()).filter(|i| g.z[*i] != 0.0).all(|i| excess(i) < 1e-12), "{}", e.name());
                assert!(c.iter().any(|c| c.confidence == 0.0), "{}: pure noise was trusted everywhere", e.name());
            }
        }
    }
}

/// Two objects that touch without a step or a crease, a wall and a cylinder bending away from it: only the mark on z
/// can tell them apart, and does.
#[test]
fn objects_do_not_mix() {
    let radius = 50.0;
    let seam = 16.0 * 1e-3 * 500.0;
    let scene = |mark: f64| {
        gbuffer(32, 8, |x, _| {
            let u = (x as f64 + 0.5) * 1e-3;
            if x < 16 {
                return (500.0, [0.0, 0.0, 1.0]);
            }
            // (u z - seam)^2 + (z - 500 - radius)^2 = radius^2
            let (a, b) = (1.0 + u * u, u * seam + 500.0 + radius);
            let c = seam * seam + (500.0 + radius) * (500.0 + radius) - radius * radius;
            let z = c / (b + (b * b - a * c).sqrt());
            (mark * z, unit([u * z - seam, 0.0, 500.0 + radius - z]))
        })
    };
    for e in OURS {
        let worst = |mark: f64| {
            let c = estimate(e, &scene(mark));
            let truth = |x: usize| if x < 16 { 0.0 } else { 0.5 / radius };
            (8..24).map(|x| (c[4 * 32 + x].h - truth(x)).abs() * radius).fold(0.0, f64::max)
        };
        assert!(worst(-1.0) < 1e-3, "{}: {}", e.name(), worst(-1.0));
        assert!(worst(1.0) > 0.1, "{}: the test does not depend on the mark: {}", e.name(), worst(1.0));
    }
}

/// A sphere before a wall of the same object, far behind or just behind its rim: what is trusted is right.
#[test]
fn depth_jumps_are_doubted() {
    let (turn, size) = ([0.0; 2], [320, 240]);
    let shot = Shot { shape: Shape::Sphere(60.0), size, focal: 672.0, distance: 500.0, turn, perspective: true };
    let sphere = shot.take();
    let rim = 500.0 - 60.0 * 60.0 / 500.0;
    for wall in [rim + 1.0, rim + 10.0, 900.0] {
        let mut g = sphere.g.clone();
        g.z.iter_mut().filter(|z| **z == 0.0).for_each(|z| *z = wall);
        for e in OURS {
            let c = estimate(e, &g);
            let wrong = |i: &usize| (c[*i].h - sphere.h[*i]).abs() * 60.0 > 0.1 && c[*i].confidence > 0.5;
            assert_eq!((0..c.len()).filter(wrong).count(), 0, "{}, wall at {wall}: trusted and wrong", e.name());
        }
    }
}

/// Two planes meeting at 90 degrees are flat on both sides, and a pixel at the crease says that a side is missing.
#[test]
fn creases_stay_flat() {
    let s = std::f64::consts::FRAC_1_SQRT_2;
    // A roof's ridge towards the eye: z rises away from column 16.
    let g = gbuffer(33, 16, |x, _| {
        // Plane through (x0, z0) with slope 1: z = (z0 - x0) / (1 - u), u = ray slope; mirrored on the left.
        let u = (x as f64 + 0.5) * 1e-3 - 16.4e-3;
        (500.0 / (1.0 - u.abs()), if u < 0.0 { [-s, 0.0, s] } else { [s, 0.0, s] })
    });
    let g = GBuffer { camera: Camera { ray_offset: [-16.4e-3, 8e-3], ..g.camera }, ..g };
    for e in OURS {
        let c = estimate(e, &g);
        assert!(c.iter().all(|c| c.h.abs() < 1e-9), "{}: a crease between planes has curvature", e.name());
        assert!(c[8 * 33 + 16].confidence < 1.0 && c[8 * 33 + 5].confidence == 1.0, "{}", e.name());
    }
    let literal = estimate(Estimator::Trace, &g);
    assert!(literal.iter().any(|c| c.h.abs() > 0.1), "the literal estimator spikes here; is the crease there at all?");
}

/// Images too small to have neighbours: defined, and confident only of what was seen.
#[test]
fn tiny_images() {
    // A cylinder of radius 50 along y, seen face on.
    let cylinder = |x: usize| {
        let u = (x as f64 + 0.5) * 1e-3;
        let z = (550.0 - (550.0f64 * 550.0 - (1.0 + u * u) * (550.0 * 550.0 - 2500.0)).sqrt()) / (1.0 + u * u);
        (z, unit([u * z, 0.0, 550.0 - z]))
    };
    for e in OURS {
        assert_eq!(estimate(e, &gbuffer(1, 1, |_, _| (500.0, [0.0, 0.0, 1.0]))), [Curvature::default()]);
        // One row: curvature along it is known, across it is not.
        let row = estimate(e, &gbuffer(9, 1, |x, _| cylinder(x)));
        let column = estimate(e, &gbuffer(1, 9, |x, _| cylinder(x)));
        assert!((row[4].h - 0.01).abs() < 1e-5 && row[4].confidence > 0.0 && row[4].confidence < 0.5, "{:?}", row[4]);
        assert!(column[4].h.abs() < 1e-9 && column[4].confidence < 0.5, "{:?}", column[4]);
    }
    for e in Estimator::ALL {
        assert_eq!(estimate(e, &gbuffer(3, 3, |_, _| (0.0, [0.0, 0.0, 1.0]))), vec![Curvature::default(); 9]);
    }
}

/// Normals that are not the geometry's, as a normal map's at a grazing view: the doubt grows with the angle between
/// them, and the geometry's own normals are not doubted however grazing.
#[test]
fn normals_off_the_geometry_are_doubted() {
    let slope = 8.0f64;
    let z = |x: usize| 500.0 / (1.0 - slope * ((x as f64 + 0.5) * 1e-3));
    let confidence = |e: Estimator, degrees: f64| {
        let (sin, cos) = (slope.atan() - degrees.to_radians()).sin_cos();
        estimate(e, &gbuffer(32, 8, |x, _| (z(x), [sin, 0.0, cos])))[4 * 32 + 16].confidence
    };
    for e in OURS {
        assert!(confidence(e, 0.0) > 0.95, "{}: a plane is doubted: {}", e.name(), confidence(e, 0.0));
        assert!(confidence(e, 10.0) > 0.9, "{}: {}", e.name(), confidence(e, 10.0));
        assert!(confidence(e, 70.0) < 0.3, "{}: bumps are trusted: {}", e.name(), confidence(e, 70.0));
        assert!(confidence(e, 45.0) < confidence(e, 20.0), "{}", e.name());
    }
}
