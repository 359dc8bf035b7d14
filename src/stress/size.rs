//! Picture sizes, crops, scale, and how far light scatters compared with the object, the pixel and the screen.

use super::studio::{Picture, Set, mixture, settings, wax};
use super::{Bench, Measure, Measured, Spread, StressError};
use crate::scene::{Camera, Light};
use crate::settings::{Method, Quality, Resolution, Size, View};

/// A torus that fills a small picture.
fn torus(method: Method, size: [u32; 2]) -> Result<Set, StressError> {
    let mut set = Set::new("shape:torus:70,25", 420., settings(method, View::Scatter, size))?;
    set.lights.push(Light::directional(70., 10., 0.4));
    Ok(set)
}

/// The scene from 1e-3 to 1e3 times as large, its profile with it.
pub fn scaled(bench: &Bench, method: Method) -> Measured {
    let set = torus(method, [120, 90])?;
    let base = set.linear(bench)?;
    let (mut p99, mut text) = (0f64, String::new());
    for factor in [1e-4, 1e4] {
        let s = Spread::of(base.differences(&set.scaled(factor, true).linear(bench)?, |_| true));
        p99 = if s.p99.is_nan() { f64::INFINITY } else { p99.max(s.p99) };
        text.push_str(&format!("x {factor:.0e}: {s}; "));
    }
    let wrong = if method == Method::Lambert {
        let mut other = set.clone();
        other.lights[0] = Light::directional(-37., 35., 1.);
        other.linear(bench)?
    } else {
        set.scaled(1e4, false).linear(bench)?
    };
    let wrong = Spread::of(base.differences(&wrong, |_| true)).p99;
    Ok(vec![Measure::new("p99", p99, wrong, text.trim_end_matches("; "))])
}

/// Radius 0 and 1e-9 of the profile's: lambert, to the bit.
pub fn radius_zero(bench: &Bench, method: Method) -> Measured {
    let lambert = torus(Method::Lambert, [96, 72])?.linear(bench)?;
    let differing = |factor: f64| -> Result<usize, StressError> {
        let mut set = torus(method, [96, 72])?;
        set.profile = set.profile.map(|p| p.scaled(factor));
        Ok(lambert.differing(&set.linear(bench)?))
    };
    let (none, tiny, own) = (differing(0.)?, differing(1e-9)?, differing(1.)?);
    let text = format!("x 0: {none}, x 1e-9: {tiny} pixels");
    Ok(vec![Measure::new("pixels that differ", none.max(tiny) as f64, own as f64, text)])
}

/// From so far away that the object is a pixel, and that scattering is below one: lambert, to the bit.
pub fn far(bench: &Bench, method: Method) -> Measured {
    let at = |method: Method, distance: f64| -> Result<Picture, StressError> {
        let mut set = Set::new("shape:sphere:20", distance, settings(method, View::Scatter, [64, 64]))?;
        set.settings.no_shadows = true;
        set.linear(bench)
    };
    let (mut count, mut text) = (0, String::new());
    // 40 mm are a pixel at 4,780 mm; sigma 4 mm is .7 of one at 680.
    for distance in [4780., 1000.] {
        let (a, b) = (at(Method::Lambert, distance)?, at(method, distance)?);
        count = count.max(a.differing(&b));
        text.push_str(&format!("{distance} mm: {} pixels of surface; ", a.covered().count()));
    }
    let near = at(Method::Lambert, 120.)?.differing(&at(method, 120.)?);
    Ok(vec![Measure::new("pixels that differ", count as f64, near as f64, text.trim_end_matches("; "))])
}

/// So close that a hundredth of the object fills the screen: exitance is the sphere's, within 0..1.
pub fn near(bench: &Bench, method: Method) -> Measured {
    let mut set = Set::new("shape:sphere:200", 230., settings(method, View::Scatter, [64, 64]))?;
    set.camera = Camera::orbit(-20., 30., 200. + 4. / (2. * 15f64.to_radians().tan()), None, 30., &set.scene);
    set.settings.no_shadows = true;
    let picture = set.linear(bench)?;
    // Lit nearly head on: mu = n.l hardly changes over the kernel, whatever its width.
    let want = set.by(Method::Lambert).linear(bench)?;
    let s = Spread::of(picture.differences(&want, |_| true));
    let mut turned = set.clone();
    turned.lights = vec![Light::directional(-50., 35., 1.)];
    let wrong = Spread::of(turned.linear(bench)?.differences(&want, |_| true)).median;
    Ok(vec![Measure::new(
        "median |E - mu|",
        s.median,
        wrong,
        format!("{s}; 4 mm of a sphere of 200 mm fill the picture"),
    )])
}

/// Channels whose radii are 1e4 apart: each is what it would be if all had its radius.
pub fn channels(bench: &Bench, method: Method) -> Measured {
    let base = torus(method, [96, 72])?;
    let apart = mixture("apart", vec![(16e-8, [0., 0., 1.]), (16., [1., 0., 0.]), (1., [0., 1., 0.])]);
    let draw = |variances: [f64; 3]| -> Result<Picture, StressError> {
        let mut set = base.clone();
        let one = |c: usize| (variances[c], std::array::from_fn(|i| if i == c { 1. } else { 0. }));
        set.profile = Some(mixture("one", (0..3).map(one).collect()));
        set.linear(bench)
    };
    let mut set = base.clone();
    set.profile = Some(apart);
    let picture = set.linear(bench)?;
    let lambert = base.by(Method::Lambert).linear(bench)?;
    let blue = |p: &Picture, q: &Picture| {
        let one = |i: usize| f64::from((p.texels[i][2] - q.texels[i][2]).abs());
        Spread::of(p.covered().map(one).collect())
    };
    let s = blue(&picture, &lambert);
    let wrong = blue(&draw([16., 1., 16.])?, &lambert);
    let all = picture.outside(-1e-3, 1.001 * 1.4);
    Ok(vec![
        Measure::new("blue - lambert p99", s.p99, wrong.p99, format!("{s}; sigma 4, 1, 4e-4 mm")),
        Measure::new("outside 0..1.4", all, picture.spoilt(f32::NAN).outside(-1e-3, 1.4), "two lights of 1 and .4"),
    ])
}

/// Light that travels much further than the object is large: a sphere glows evenly, at its mean of 1/4.
pub fn wide(bench: &Bench, method: Method) -> Measured {
    let mut set = Set::new("shape:sphere:20", 120., settings(method, View::Scatter, [64, 64]))?;
    set.settings.no_shadows = true;
    let error = |set: &Set| -> Result<(Spread, f64), StressError> {
        let p = set.linear(bench)?;
        let one = |i: usize| p.texels[i][..3].iter().map(|x| f64::from((x - 0.25).abs())).fold(0., f64::max);
        Ok((Spread::of(p.covered().map(one).collect()), p.outside(-1e-3, 1.001)))
    };
    // Sigma 400 mm: ten times the object, a dozen screens.
    set.profile = Some(wax().scaled(100.));
    let (s, out) = error(&set)?;
    let mut narrow = set.clone();
    narrow.profile = Some(wax());
    let spoilt = set.linear(bench)?.spoilt(1.2).outside(-1e-3, 1.001);
    Ok(vec![
        Measure::new("outside 0..1", out, spoilt, "sigma 100 and 400 mm on a sphere of 20 mm"),
        Measure::new("|E - 1/4| median", s.median, error(&narrow)?.0.median, format!("{s}")),
    ])
}

/// Pictures of one pixel, one row, one column, odd, and 8192 wide: every pixel is that of a picture large enough to hold it.
pub fn sizes(bench: &Bench, method: Method) -> Measured {
    let mut set = Set::new("shape:cylinder:40", 300., settings(method, View::Scatter, [1, 1]))?;
    set.settings.quality = Quality::Low;
    set.settings.no_shadows = true;
    let (mut worst, mut text) = (0f64, String::new());
    let mut spoilt = 0f64;
    for (width, height) in [(1, 1), (1, 37), (53, 1), (7, 5), (33, 17), (65, 66), (8192, 5)] {
        set.settings.size = Size { width, height };
        let picture = set.linear(bench)?;
        worst = worst.max(picture.outside(0., 1.001));
        spoilt = picture.spoilt(f32::NAN).outside(0., 1.001);
        // Something is lit: a black picture is within bounds, too.
        let lit = picture.covered().any(|i| picture.texels[i][0] > 0.1);
        worst = if lit { worst } else { f64::INFINITY };
        text.push_str(&format!("{width}x{height} "));
    }
    Ok(vec![Measure::new("outside 0..1", worst, spoilt, text.trim_end())])
}

/// A crop of the middle, its tiles cut elsewhere, against the same pixels of the whole, away from the crop's border.
pub fn crops(bench: &Bench, method: Method) -> Measured {
    let mut set = Set::new("shape:torus:11,4.5", 60., settings(method, View::Scatter, [160, 128]))?;
    set.settings.no_shadows = true;
    set.settings.resolution = Some(Resolution::Full);
    set.profile = Some(wax().scaled(0.1));
    // A parallel view, its height a power of two: what a pixel is does not change by a bit.
    set.camera = Camera::orbit(20., 30., 60., None, 30., &set.scene).with_orthographic(32., &set.scene);
    let whole = set.linear(bench)?;
    let mut part = set.clone();
    let from = [11, 13];
    let size = [160 - 2 * from[0], 128 - 2 * from[1]];
    part.settings.size = Size { width: size[0] as u32, height: size[1] as u32 };
    part.camera = part.camera.clone().with_orthographic(32. * size[1] as f32 / 128., &set.scene);
    let crop = part.linear(bench)?;
    // Two sigma of .4 mm at 4 pixels per mm, in steps: 12 pixels see the border.
    let inner = |i: usize| {
        let (x, y) = (i % size[0], i / size[0]);
        x.min(size[0] - 1 - x).min(y.min(size[1] - 1 - y)) >= 12
    };
    let s = Spread::of(crop.differences(&whole.crop(from, size), inner));
    let wrong = Spread::of(crop.differences(&whole.crop([from[0] + 1, from[1]], size), inner)).p99;
    Ok(vec![Measure::new("p99", s.p99, wrong, format!("{s}; wrong: a pixel further"))])
}

/// The eye moves by parts of a pixel; the object's shading is followed at its pixel: what flickers, rms.
pub fn motion(bench: &Bench, method: Method) -> Measured {
    let mut all = Vec::new();
    for (quantity, resolution) in
        [("full", Resolution::Full), ("half", Resolution::Half), ("quarter", Resolution::Quarter)]
    {
        let mut set = Set::new("shape:sphere:20", 100., settings(method, View::Scatter, [64, 64]))?;
        set.settings.no_shadows = true;
        set.settings.resolution = Some(resolution);
        set.camera = set.camera.clone().with_orthographic(32., &set.scene);
        let base = set.camera.clone();
        let frames = |step: f32| -> Result<Vec<Picture>, StressError> {
            let one = |i: u8| {
                let mut moved = set.clone();
                // Half a millimetre is a pixel.
                moved.camera.eye = base.eye + base.right * (0.5 * step * f32::from(i));
                moved.linear(bench)
            };
            (0..4).map(one).collect()
        };
        // Less what moves on by itself: the frames' common slope. Second differences hold none of it.
        let flicker = |p: &[Picture]| {
            let one = |i: usize| {
                let v = |k: usize| f64::from(p[k].texels[i][0]);
                (0..2).map(|k| (v(k) - 2. * v(k + 1) + v(k + 2)).powi(2) / 6.).sum::<f64>() / 2.
            };
            let inner: Vec<f64> = (0..p[0].texels.len())
                .filter(|i| {
                    p.iter().all(|p| p.texels[*i][3] > 0.) && i % 64 > 16 && i % 64 < 48 && i / 64 > 16 && i / 64 < 48
                })
                .map(one)
                .collect();
            (inner.iter().sum::<f64>() / inner.len() as f64).sqrt()
        };
        let (figure, wrong) = (flicker(&frames(0.25)?), flicker(&frames(8.)?));
        all.push(Measure::new(quantity, figure, wrong, "rms over pixels, from second differences of four frames a quarter of a pixel apart; wrong: eight pixels apart"));
    }
    Ok(all)
}
