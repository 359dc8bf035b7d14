//! A small bright spot on a plane: what a method makes of it is the profile that it claims, and more work is less error.
use crate::studio::{Picture, Set, settings};
use glam::Vec3;
use pdss::gpu::Gpu;
use pdss::scene::{Camera, Light, LightKind};
use pdss::settings::{Method, Quality, View};
use pdss::skin::burley::fit_d;
use pdss::skin::profile::{Gaussian, Profile, Shape};
use std::f64::consts::TAU;
use std::sync::{Arc, LazyLock};

/// Pixels on a side, an odd number: the spot is in the middle of one.
const SIZE: u32 = 129;
/// Height of the picture, mm.
const FIELD: f64 = 32.;
const PIXEL: f64 = FIELD / SIZE as f64;
const QUALITIES: [Quality; 4] = [Quality::Low, Quality::Medium, Quality::High, Quality::Ultra];

/// Four Gaussians, all wider than a pixel, that quality has something to merge.
pub fn wide() -> Profile {
    let g = |variance: f64, weight: [f64; 3]| Gaussian { variance, weight };
    let list = vec![g(0.2, [0.1, 0.4, 0.6]), g(0.6, [0.2, 0.3, 0.3]), g(1.6, [0.3, 0.2, 0.1]), g(4., [0.4, 0.1, 0.])];
    Profile {
        name: "wide".into(),
        source: String::new(),
        shape: Shape::Gaussians(list),
        ior: 1.4,
        albedo: None,
        lobes: None,
    }
}

pub fn set(method: Method, quality: Quality, view: View) -> Set {
    set_of(method, quality, view, SIZE)
}

fn set_of(method: Method, quality: Quality, view: View, size: u32) -> Set {
    let mut set = Set::new("shape:plane", 100., settings(method, view, [size, size]));
    set.camera = Camera::orbit(0., 90., 100., Some(glam::DVec3::ZERO), 30., &set.scene)
        .with_orthographic(FIELD as f32, &set.scene);
    let position = Vec3::new(0., 400., 0.);
    let kind = LightKind::Spot { position, direction: Vec3::NEG_Y, inner_cos: 0.999_998_5, outer_cos: 0.999_997 };
    set.lights = vec![Light { kind, color: [1.; 3], intensity: 0.16, range_mm: None }];
    set.profile = Some(wide());
    set.settings.quality = quality;
    set.settings.no_shadows = true;
    set
}

/// Burley's distances nearest to [`wide`], found once.
static NEAREST: LazyLock<[f64; 3]> = LazyLock::new(|| fit_d(&wide()));

/// What a method says that a point becomes, 1/mm^2.
pub type Kernel<'a> = &'a dyn Fn(f64, f64) -> [f64; 3];

/// Each pixel's light spread by a kernel, averaged over a pixel where the kernel is steep.
pub fn spread(light: &Picture, kernel: Kernel<'_>) -> Picture {
    let n = SIZE as i32;
    let cell = |dx: i32, dy: i32| -> [f64; 3] {
        let fine = if dx.abs().max(dy.abs()) <= 3 { 16 } else { 2 };
        let mut sum = [0.; 3];
        for i in 0..fine * fine {
            let at = |d: i32, i: i32| (f64::from(d) - 0.5 + (f64::from(i) + 0.5) / f64::from(fine)) * PIXEL;
            let k = kernel(at(dx, i % fine), at(dy, i / fine));
            (0..3).for_each(|c| sum[c] += k[c] * PIXEL * PIXEL / f64::from(fine * fine));
        }
        sum
    };
    let table: Vec<[f64; 3]> = (0..4 * n * n).map(|i| cell(i % (2 * n) - n, i / (2 * n) - n)).collect();
    let bright: Vec<usize> = (0..light.texels.len()).filter(|i| light.texels[*i][0] > 0.).collect();
    assert!((4..60).contains(&bright.len()), "a small spot: {} pixels", bright.len());
    let mut out = Picture { size: light.size, texels: vec![[0., 0., 0., 1.]; light.texels.len()] };
    for (i, texel) in out.texels.iter_mut().enumerate() {
        for b in &bright {
            let d = |a: usize, b: usize| a as i32 - b as i32 + n;
            let k = table
                [(d(i / SIZE as usize, b / SIZE as usize) * 2 * n + d(i % SIZE as usize, b % SIZE as usize)) as usize];
            (0..3).for_each(|c| texel[c] += (k[c] * f64::from(light.texels[*b][c])) as f32);
        }
    }
    out
}

/// Pixels of a finer picture to one.
const FINER: u32 = 5;

/// The light of a finer picture spread by a kernel, at the middle of each pixel.
fn spread_fine(light: &Picture, kernel: Kernel<'_>) -> Picture {
    let wide = light.size[0];
    let bright: Vec<usize> = (0..light.texels.len()).filter(|i| light.texels[*i][0] > 0.).collect();
    let fine = PIXEL / f64::from(FINER);
    let texel = |i: usize| {
        let at = |x: usize| (FINER as usize * x + FINER as usize / 2) as f64;
        let (x, y) = (at(i % SIZE as usize), at(i / SIZE as usize));
        let mut sum = [0.; 3];
        for b in &bright {
            let k = kernel(fine * (x - (b % wide) as f64), fine * (y - (b / wide) as f64));
            (0..3).for_each(|c| sum[c] += k[c] * fine * fine * f64::from(light.texels[*b][c]));
        }
        [sum[0] as f32, sum[1] as f32, sum[2] as f32, 1.]
    };
    Picture { size: [SIZE as usize; 2], texels: (0..(SIZE * SIZE) as usize).map(texel).collect() }
}

/// Mean of each ring of pixels around the middle.
pub fn rings(p: &Picture) -> Vec<[f64; 3]> {
    let middle = SIZE as i32 / 2;
    let mut rings = vec![([0.; 3], 0.); middle as usize];
    for (i, t) in p.texels.iter().enumerate() {
        let (x, y) = (i as i32 % SIZE as i32 - middle, i as i32 / SIZE as i32 - middle);
        if let Some(ring) = rings.get_mut(f64::from(x * x + y * y).sqrt().round() as usize) {
            (0..3).for_each(|c| ring.0[c] += f64::from(t[c]));
            ring.1 += 1.;
        }
    }
    rings.into_iter().map(|(sum, n)| sum.map(|s| s / n)).collect()
}

/// Share of the light that is in the wrong ring, the worst channel.
fn misplaced(got: &Picture, want: &Picture) -> f64 {
    let (got, want) = (rings(got), rings(want));
    let sum = |f: &dyn Fn(usize) -> f64| (0..got.len()).map(|i| (i as f64).max(0.25) * f(i)).sum::<f64>();
    (0..3).map(|c| sum(&|i| (got[i][c] - want[i][c]).abs()) / sum(&|i| want[i][c])).fold(0., f64::max)
}

pub fn gaussian(v: f64, x: f64) -> f64 {
    (-0.5 * x * x / v).exp() / (TAU * v).sqrt()
}

/// The round profile; what one separable pair claims, a product; the nearest Burley.
pub fn claims(method: Method, x: f64, y: f64, stretch: f64) -> [f64; 3] {
    let (x, y) = (x / stretch, y / stretch);
    let Shape::Gaussians(list) = wide().shape else { return [0.; 3] };
    let along = |x: f64| -> [f64; 3] {
        std::array::from_fn(|c| list.iter().map(|g| g.weight[c] * gaussian(g.variance, x)).sum())
    };
    let k = match method {
        Method::Separable => {
            let (a, b) = (along(x), along(y));
            std::array::from_fn(|c| a[c] * b[c])
        }
        Method::Burley => {
            let d = *NEAREST;
            let r = (x * x + y * y).sqrt().max(1e-9);
            d.map(|d| ((-r / d).exp() + (-r / (3. * d)).exp()) / (4. * TAU * d * r))
        }
        _ => wide().radial((x * x + y * y).sqrt()),
    };
    k.map(|k| k / (stretch * stretch))
}

/// Bounds on what is left at ultra quality, and why it is not less.
const CASES: [(Method, f64, &str); 4] = [
    (Method::Gaussians, 0.01, "the sum of Gaussians itself"),
    (Method::Separable, 0.02, "the product of the profile's integrals along x and y"),
    (Method::Burley, 0.04, "the nearest Burley over visible pixels"),
    (Method::TextureSpace, 0.01, "the sum of Gaussians itself"),
];

/// These scatter by the surface's shape alone: on a plane a point of light stays one, whatever the quality.
const STILL: [Method; 4] = [Method::Preintegrated, Method::Pdss, Method::Moments, Method::Wrap];

/// Lines of a plot: a name and its rings.
pub type Curves = Vec<(String, Vec<[f64; 3]>)>;

pub fn check(gpu: &Arc<Gpu>) -> (Vec<String>, Curves) {
    let (mut wrong, mut curves) = (Vec::new(), Curves::new());
    let light = set(Method::Lambert, Quality::Low, View::Irradiance).linear(gpu);
    let fine = set_of(Method::Lambert, Quality::Low, View::Irradiance, FINER * SIZE).linear(gpu);
    let profile = spread(&light, &|x, y| claims(Method::Gaussians, x, y, 1.));
    curves.push(("profile".into(), rings(&profile)));
    for method in STILL {
        let picture = set(method, Quality::High, View::Scatter).linear(gpu);
        let (off, wide) = (misplaced(&picture, &light), misplaced(&picture, &profile));
        println!("{method:?}: {off:.4} of the light misplaced, limit the point itself; against the profile {wide:.4}");
        if off > 0.01 || wide < 0.1 {
            wrong.push(format!("{method:?}: {off}, against the profile {wide}"));
        }
        curves.push((format!("{method:?}, high"), rings(&picture)));
    }
    for (method, bound, limit) in CASES {
        // Texels over texture coordinates are not pixels: what they see of a spot of a few pixels is nearer to the spot itself.
        let spread = |stretch: f64| {
            let kernel = |x: f64, y: f64| claims(method, x, y, stretch);
            if method == Method::TextureSpace { spread_fine(&fine, &kernel) } else { spread(&light, &kernel) }
        };
        let (want, wider) = (spread(1.), spread(1.1));
        let pictures = QUALITIES.map(|q| set(method, q, View::Scatter).linear(gpu));
        let errors = pictures.each_ref().map(|p| misplaced(p, &want));
        let off = misplaced(&pictures[3], &wider);
        println!(
            "{method:?}: {errors:.4?} of the light misplaced from low to ultra, limit {limit}; against one a tenth wider {off:.4}"
        );
        if errors[3] > bound || errors[3] > errors[0] || errors.windows(2).any(|e| e[1] > e[0] * 1.02 + 1e-3) {
            wrong.push(format!("{method:?}: {errors:?}, bound {bound}"));
        }
        if off < bound {
            wrong.push(format!("{method:?}: a wider profile passes"));
        }
        curves.push((format!("{method:?} claims"), rings(&want)));
        curves.push((format!("{method:?}, ultra"), rings(&pictures[3])));
    }
    (wrong, curves)
}
