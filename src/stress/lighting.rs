//! Lights where they should not be, too strong, too many, none.

use super::studio::{Set, settings};
use super::{Bench, Measure, Measured, Spread, StressError};
use crate::frame::Renderer;
use crate::scene::{Light, LightKind};
use crate::settings::{Ambient, Method, View};
use glam::Vec3;

fn sphere(method: Method, view: View) -> Result<Set, StressError> {
    Set::new("shape:sphere:40", 200., settings(method, view, [80, 60]))
}

fn point(position: Vec3, intensity: f32) -> Light {
    Light { kind: LightKind::Point { position }, color: [1.; 3], intensity, range_mm: None }
}

/// A point light in the middle of a closed mesh: outside stays dark.
pub fn inside(bench: &Bench, method: Method) -> Measured {
    let mut set = sphere(method, View::Scatter)?;
    set.lights = vec![point(Vec3::new(3., 5., -2.), 0.01)];
    let dark = set.linear(bench)?.outside(0., 0.);
    let mut out = set.clone();
    out.lights = vec![point(set.camera.eye, 0.01)];
    Ok(vec![Measure::new("largest exitance", dark, out.linear(bench)?.outside(0., 0.), "wrong: the light at the eye")])
}

/// A light straight behind the object: only the rim may glow, and nothing exceeds what arrives.
pub fn behind(bench: &Bench, method: Method) -> Measured {
    let mut set = sphere(method, View::Scatter)?;
    let direction = set.camera.forward;
    set.lights = vec![Light { kind: LightKind::Directional { direction }, ..Light::directional(0., 0., 1.) }];
    let picture = set.linear(bench)?;
    let facing = set.seeing(View::Normal).linear(bench)?;
    let away = |i: usize| Vec3::from_slice(&facing.texels[i][..3]).dot(direction) < -0.7;
    let most = |p: &super::studio::Picture| {
        p.covered().filter(|i| away(*i)).map(|i| f64::from(p.texels[i][0])).fold(0., f64::max)
    };
    let mut front = set.clone();
    front.lights =
        vec![Light { kind: LightKind::Directional { direction: -direction }, ..Light::directional(0., 0., 1.) }];
    // Sigma 4 mm on 40 mm: at 45 degrees behind the terminator nothing is left, 1e-12 of it.
    Ok(vec![
        Measure::new("45 degrees away", most(&picture), most(&front.linear(bench)?), "wrong: the light in front"),
        Measure::new("outside 0..1", picture.outside(0., 1.), picture.spoilt(2.).outside(0., 1.), ""),
    ])
}

/// A light of 1e6 is a light of 1 times 1e6; in the lit picture, too.
pub fn strong(bench: &Bench, method: Method) -> Measured {
    let mut all = Vec::new();
    for (quantity, view) in [("exitance", View::Scatter), ("radiance", View::Final)] {
        let mut set = sphere(method, view)?;
        set.settings.ambient = Ambient { up: [0.; 3], down: [0.; 3] };
        let base = set.linear(bench)?;
        set.lights[0].intensity = 1e6;
        let bright = set.linear(bench)?;
        // Specular peaks are bright themselves: relative to what is there.
        let apart = |factor: f32| {
            let one = |i: usize| {
                let worst = |c: usize| {
                    let (a, b) = (bright.texels[i][c] * factor, base.texels[i][c]);
                    f64::from((a - b).abs() / b.max(0.01))
                };
                (0..3).map(worst).fold(0., |m, x| if x.is_nan() { f64::INFINITY } else { m.max(x) })
            };
            Spread::of(base.covered().map(one).collect())
        };
        let s = apart(1e-6);
        all.push(Measure::new(quantity, s.max, apart(1.01e-6).max, format!("{s}, relative")));
    }
    Ok(all)
}

/// A point light on the surface itself: every value is finite, and none exceeds the light held to 1 mm.
pub fn touching(bench: &Bench, method: Method) -> Measured {
    let mut set = sphere(method, View::Final)?;
    let towards = set.camera.eye.normalize();
    set.settings.ambient = Ambient { up: [0.; 3], down: [0.; 3] };
    let place = |set: &mut Set, r: f32, intensity: f32| {
        set.lights = vec![point(towards * r, intensity)];
    };
    // 1e-6 at a metre is 1 at a millimetre.
    place(&mut set, 40., 1e-6);
    let on = set.seeing(View::Scatter).linear(bench)?;
    let lit = set.linear(bench)?;
    let finite = |p: &super::studio::Picture| p.texels.iter().flatten().filter(|x| !x.is_finite()).count() as f64;
    Ok(vec![
        Measure::new(
            "outside 0..1",
            on.outside(0., 1.001),
            on.spoilt(3.).outside(0., 1.001),
            "exitance; at 1 mm the light is 1",
        ),
        Measure::new("not finite", finite(&lit), finite(&lit.spoilt(f32::NAN)), "radiance"),
    ])
}

/// No light: no exitance at all. A sky alone: the sky's own light.
pub fn dark(bench: &Bench, method: Method) -> Measured {
    let mut set = sphere(method, View::Scatter)?;
    let lit = set.linear(bench)?.outside(0., 0.);
    set.lights.clear();
    let none = set.linear(bench)?.outside(0., 0.);
    let mut sky = set.seeing(View::Final);
    sky.settings.ambient = Ambient { up: [0.3; 3], down: [0.3; 3] };
    sky.settings.no_ao = true;
    let p = sky.linear(bench)?;
    let off = p.outside(0.297, 0.303);
    Ok(vec![
        Measure::new("without light", none, lit, "exitance"),
        Measure::new(
            "an even sky: off .3",
            off,
            p.times(1.05).outside(0.297, 0.303),
            "white, radiance of .3 from everywhere",
        ),
    ])
}

/// Lights that together are one light: 1, 64, 128 give the same picture; 1000 are refused by number.
pub fn many(bench: &Bench, method: Method) -> Measured {
    let mut set = sphere(method, View::Scatter)?;
    set.settings.no_shadows = true;
    let draw = |count: usize, total: f32| {
        let mut set = set.clone();
        set.lights = vec![Light::directional(-40., 35., f64::from(total / count as f32) as f32); count];
        set.linear(bench)
    };
    let one = draw(1, 1.)?;
    let (mut worst, mut text) = (0f64, String::new());
    for count in [64, 128] {
        let s = Spread::of(one.differences(&draw(count, 1.)?, |_| true));
        worst = worst.max(s.max);
        text.push_str(&format!("{count}: {s}; "));
    }
    let wrong = Spread::of(one.differences(&draw(64, 63. / 64.)?, |_| true)).max;
    let mut crowd = set.clone();
    crowd.lights = vec![Light::directional(-40., 35., 1e-3); 1000];
    let said = |set: &Set| match Renderer::plan_only(&set.inputs()) {
        Err(e) if e.to_string().contains("1000") && e.to_string().contains("128") => 0.,
        _ => 1.,
    };
    Ok(vec![
        Measure::new("64, 128 - 1", worst, wrong, format!("{text}wrong: one of 64 missing")),
        Measure::new("1000 not refused", said(&crowd), said(&set), "the error names both numbers"),
    ])
}

/// Lights that share channels of scattered visibility, three of one colour and two of another: the sum of what each casts alone.
/// Blurred on the screen, where that holds to the digit; wrong is a light of the other colour.
pub fn shared(bench: &Bench) -> Measured {
    let mut set = Set::new("shape:torus:12,5", 90., settings(Method::Moments, View::Scatter, [92, 70]))?;
    set.settings.no_translucent = true;
    let (white, amber) = ([1.; 3], [1., 0.6, 0.2]);
    let lamp = |yaw, pitch, intensity, color| Light { color, ..Light::directional(yaw, pitch, intensity) };
    let lights = [
        lamp(-40., 35., 0.4, white),
        lamp(70., 10., 0.3, amber),
        lamp(160., 40., 0.2, white),
        lamp(-110., 5., 0.3, amber),
        lamp(20., 70., 0.1, white),
    ];
    let under = |lights: &[Light]| Set { lights: lights.to_vec(), ..set.clone() }.linear(bench);
    let mut sum = under(&lights[..1])?;
    for light in &lights[1..] {
        let one = under(std::slice::from_ref(light))?;
        sum.texels.iter_mut().zip(&one.texels).for_each(|(s, o)| (0..3).for_each(|c| s[c] += o[c]));
    }
    let mut tinted = lights.clone();
    tinted[4].color = amber;
    let right = Spread::of(sum.differences(&under(&lights)?, |_| true));
    let wrong = Spread::of(sum.differences(&under(&tinted)?, |_| true));
    Ok(vec![Measure::new("all - sum", right.max, wrong.max, format!("{right}; wrong: one of another colour, {wrong}"))])
}
