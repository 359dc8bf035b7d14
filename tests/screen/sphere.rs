//! Every method on a sphere, where the answer is a series: the error falls with quality, to the limit that the method's own theory has.
use crate::studio::{Picture, Set, settings};
use glam::Vec3;
use pdss::gpu::Gpu;
use pdss::scene::{Camera, Light};
use pdss::settings::{Method, Quality, View};
use pdss::skin::profile::Profile;
use pdss::skin::sphere::exitance_normalised;
use std::sync::Arc;

const RADIUS: f64 = 20.;
const QUALITIES: [Quality; 4] = [Quality::Low, Quality::Medium, Quality::High, Quality::Ultra];

/// Root of the mean square error (over RGB) that is allowed at the best quality tried, and the limit.
const CASES: [(Method, f64, &str); 8] = [
    (Method::Preintegrated, 2e-4, "the sphere itself: light over a sphere of the surface's curvature"),
    (Method::Pdss, 1e-3, "the sphere itself: light over a sphere of the surface's curvature"),
    (Method::Moments, 1e-3, "the Gaussian of an even spread"),
    (Method::TextureSpace, 5e-4, "Gaussians of the way along the surface instead of the chord"),
    (Method::Gaussians, 1.2e-3, "what the camera sees of the sphere"),
    (Method::Separable, 2e-3, "the product of the profile's integrals over what the camera sees"),
    (Method::Burley, 1.2e-3, "the nearest Burley over what the camera sees"),
    (Method::Wrap, 1.7e-3, "a cosine wrapped as far as the curvature says"),
];

fn set(method: Method, quality: Quality, view: View) -> Set {
    let mut set = Set::new(&format!("shape:sphere:{RADIUS}"), 200., settings(method, view, [96, 96]));
    set.camera = Camera::orbit(0., 0., 200., Some(glam::DVec3::ZERO), 14., &set.scene);
    set.lights = vec![Light::directional(55., 20., 1.)];
    set.profile = Some(Profile::resolve("skin").expect("a profile"));
    (set.settings.quality, set.settings.no_shadows) = (quality, true);
    set
}

/// What the series says of every pixel, for a sphere of this radius.
fn series(normals: &Picture, radius: f64, profile: &Profile) -> Picture {
    let light = Light::directional(55., 20., 1.);
    let l = match light.kind {
        pdss::scene::LightKind::Directional { direction } => direction,
        _ => Vec3::Y,
    };
    let gaussians = profile.gaussians().gaussians;
    let texels = normals.texels.iter().map(|t| {
        if t[3] == 0. {
            return [0.; 4];
        }
        let mu = f64::from(Vec3::from_slice(&t[..3]).normalize().dot(l));
        let e = exitance_normalised(mu, radius, &gaussians);
        [e[0] as f32, e[1] as f32, e[2] as f32, 1.]
    });
    Picture { size: normals.size, texels: texels.collect() }
}

fn rms(a: &Picture, b: &Picture) -> f64 {
    let (mut sum, mut n) = (0., 0);
    for i in a.covered() {
        sum += (0..3).map(|c| f64::from(a.texels[i][c] - b.texels[i][c]).powi(2)).sum::<f64>();
        n += 3;
    }
    (sum / f64::from(n)).sqrt()
}

pub fn check(gpu: &Arc<Gpu>) -> Vec<String> {
    let mut wrong = Vec::new();
    let profile = Profile::resolve("skin").expect("a profile");
    let normals = set(Method::Lambert, Quality::Low, View::Normal).linear(gpu);
    let want = series(&normals, RADIUS, &profile);
    let other = series(&normals, 0.8 * RADIUS, &profile);
    let lambert = rms(&set(Method::Lambert, Quality::Low, View::Scatter).linear(gpu), &want);
    println!("lambert {lambert:.5}; a sphere a fifth smaller {:.5}", rms(&other, &want));
    for (method, bound, limit) in CASES {
        // Sheets of 4096 texels are seconds, and the point of light has had them.
        let tried = if method == Method::TextureSpace { &QUALITIES[..3] } else { &QUALITIES[..] };
        let pictures: Vec<Picture> = tried.iter().map(|q| set(method, *q, View::Scatter).linear(gpu)).collect();
        let errors: Vec<f64> = pictures.iter().map(|p| rms(p, &want)).collect();
        println!("{method:?}: rms {errors:.5?} from low up, limit: {limit}");
        let (last, picture) = (errors[errors.len() - 1], &pictures[pictures.len() - 1]);
        if last > bound || last >= lambert {
            wrong.push(format!("{method:?}: {errors:?}, bound {bound}, lambert {lambert}"));
        }
        if errors.windows(2).any(|e| e[1] > e[0] * 1.05 + 2e-5) {
            wrong.push(format!("{method:?}: more work, more error: {errors:?}"));
        }
        if bound < rms(&other, &want) && rms(picture, &other) < bound {
            wrong.push(format!("{method:?}: a smaller sphere passes"));
        }
    }
    wrong
}
