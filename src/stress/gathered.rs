//! Light gathered from the light's view on the device against the f64 twin, from the device's own targets.

use super::studio::{Set, settings, wax};
use super::{Bench, Measure, Measured, Spread, StressError};
use crate::frame::levels::Level;
use crate::frame::{Renderer, Setup};
use crate::plan::{Need, Plan};
use crate::scene::{Camera, Light, LightKind, Scene};
use crate::settings::{Method, Quality, View};
use crate::skin::blur::Screen;
use crate::skin::curvature;
use crate::skin::gather::{Gather, LightView, Seen, level, sparse};
use crate::skin::octahedral;

/// The words of targets after a frame, each one word a texel but for levels, which have two; as they are where nothing is gathered,
/// if so asked.
fn targets(bench: &Bench, set: &Set, gathers: bool, names: &[&str]) -> Result<Vec<Vec<u32>>, StressError> {
    let mut planned = Ok(());
    let keep = |plan: &mut Plan| {
        if !gathers {
            plan.passes.retain(|p| !p.name.starts_with("translucent"));
            planned = plan.finish();
        }
        names.iter().for_each(|n| plan.keep(n));
        plan.fit(|desc| Need::on(&bench.gpu, desc));
    };
    let mut renderer = Renderer::edited(&bench.gpu, set.inputs(), keep)?;
    planned.map_err(|e| StressError::Row(e.to_string()))?;
    renderer.run()?;
    let words = |name: &&str| -> Result<Vec<u32>, StressError> {
        Ok(renderer.texels(name)?.chunks_exact(4).map(bytemuck::pod_read_unaligned).collect())
    };
    names.iter().map(words).collect()
}

/// The first light's map, and how many texels of what is kept of it are not the twin's: as they are, and from the cells' corners.
fn map(bench: &Bench, set: &Set) -> Result<(LightView, [usize; 2]), StressError> {
    let setup = Setup::all(&set.inputs())?.swap_remove(0);
    let [whole, kept]: [Vec<u32>; 2] = match targets(bench, set, true, &["shadow", "sparse"])?.try_into() {
        Ok(both) => both,
        Err(_) => return Err(StressError::Row("two targets were asked for".to_owned())),
    };
    let (side, step) = (setup.shadows.size as usize, setup.sparse_step as usize);
    let differing = |want: &[u32]| want.iter().zip(&kept).filter(|(a, b)| a != b).count();
    let corner = |i: usize| whole[i / (side / step) * step * side + i % (side / step) * step];
    let corners: Vec<u32> = (0..kept.len()).map(corner).collect();
    let count = [differing(&sparse(&whole, side, step)), differing(&corners)];
    let m = setup.shadows.matrices[0] * set.camera.world_from_view();
    let rows = [0, 1, 2].map(|i| m.row(i).to_array().map(f64::from));
    let l = match set.lights[0].kind {
        LightKind::Directional { direction } => set.camera.view_from_world().transform_vector3(direction).as_dvec3(),
        _ => return Err(StressError::Row("only directional lights are gathered".to_owned())),
    };
    let depth = kept.iter().map(|w| f64::from(f32::from_bits(*w))).collect();
    Ok((LightView { side: side / step, depth, rows, l: l.to_array(), slot: 0, part: 1. }, count))
}

/// Differences of one level to the twin: as it is, and to twins that gather a wider Gaussian, by half of the taps, and without
/// the kernel's mass.
fn differences(bench: &Bench, set: &Set, views: &[LightView]) -> Result<[Vec<f64>; 4], StressError> {
    let setup = Setup::all(&set.inputs())?.swap_remove(0);
    let mut all: [Vec<f64>; 4] = Default::default();
    for (i, l) in setup.levels.levels.iter().enumerate().filter(|(_, l)| l.gathered) {
        let channel = i as u32 - setup.levels.first_gathered();
        let (screen, seen, got) = texels(bench, set, &setup, (i, channel), l)?;
        let as_is = Gather {
            variance: f64::from(l.variance as f32),
            taps: setup.taps as usize,
            shared: setup.shadows.shared(),
            step: setup.sparse_step as usize,
        };
        let wider = Gather { variance: 1.05 * as_is.variance, ..as_is };
        let fewer = Gather { taps: as_is.taps / 2, ..as_is };
        let across = screen.texels(l.stride as usize)[0];
        for (at, (seen, got)) in seen.iter().zip(&got).enumerate() {
            let pixel = screen.representative([at % across, at / across], l.stride as usize);
            if screen.scattering(pixel) <= 0. {
                continue;
            }
            let bare = Seen { share: 1., ..*seen };
            let twins = [(seen, as_is), (seen, wider), (seen, fewer), (&bare, as_is)];
            for (sum, (seen, gather)) in all.iter_mut().zip(twins) {
                let want = level(seen, views, &gather);
                sum.push((want[0] - got[0]).abs().max((want[1] - got[1]).abs()));
            }
        }
    }
    Ok(all)
}

/// What the device had of a level before it gathered, and its light afterwards.
type Texels = (Screen, Vec<Seen>, Vec<[f64; 2]>);

fn texels(
    bench: &Bench,
    set: &Set,
    setup: &Setup,
    (i, channel): (usize, u32),
    l: &Level,
) -> Result<Texels, StressError> {
    let facts = setup.view;
    let single = |v: [f64; 2]| v.map(|x| f64::from(x as f32));
    let camera = curvature::Camera {
        ray_scale: single(facts.ray_scale),
        ray_offset: single(facts.ray_offset),
        perspective: facts.perspective > 0.5,
    };
    let [soft, lit, geo] = ["soft", "softlit", "softgeo"].map(|n| format!("{n}{i}"));
    let mut names = vec!["viewz", if setup.detail { "facet" } else { "normal" }, "mass", &soft, &lit];
    names.extend(setup.detail.then_some(&*geo));
    let after = targets(bench, set, true, &names)?;
    // Light as the blur leaves it, before what is gathered takes its place.
    let before = targets(bench, set, false, &[&lit])?;
    let screen =
        Screen { size: set.size(), z: after[0].iter().map(|w| f64::from(f32::from_bits(*w))).collect(), camera };
    let stride = l.stride as usize;
    let across = screen.texels(stride)[0];
    let light = |w: u32| [w & 0xffff, w >> 16].map(|x| f64::from(x) / 65535.);
    let snorm = |w: u32| (f64::from(w as i16) / 32767.).max(-1.);
    let seen = before[0].iter().enumerate().map(|(at, before)| {
        let pixel = screen.representative([at % across, at / across], stride);
        let p = pixel[1] * screen.size[0] + pixel[0];
        let normal = after[1][p];
        let mean = [after[3][2 * at], after[3][2 * at] >> 16, after[3][2 * at + 1]].map(snorm);
        Seen {
            position: screen.position(pixel, screen.scattering(pixel)),
            n: octahedral::decode([normal as i16, (normal >> 16) as i16]),
            mean,
            share: 2. * f64::from(after[2][p] >> (10 * channel) & 0x3ff) / 1023.,
            lit: light(*before),
            bare: after.get(5).map(|geo| light(geo[at])),
        }
    });
    let seen = seen.collect();
    Ok((screen, seen, after[4].iter().map(|w| light(*w)).collect()))
}

fn sets() -> Result<Vec<Set>, StressError> {
    let mut list = Vec::new();
    for (quality, parallel, rough, shared) in
        [(Quality::Low, false, false, false), (Quality::High, true, true, false), (Quality::Medium, false, true, true)]
    {
        let mut scene = Scene::shape("shape:torus:12,9")?;
        if rough {
            // Shading normals that are not the triangles' own.
            for (n, p) in scene.normals.iter_mut().zip(&scene.positions) {
                let tilt = glam::Vec3::new((1.7 * p[1]).sin(), (1.3 * p[2]).sin(), (1.9 * p[0]).sin());
                *n = (glam::Vec3::from(*n) + 0.1 * tilt).normalize().to_array();
            }
        }
        let mut set = Set::of(scene, 90., settings(Method::Moments, View::Scatter, [92, 70]));
        set.lights.push(Light::directional(70., 10., 0.4));
        if shared {
            // Of the second's colour.
            set.lights.push(Light::directional(170., 40., 0.3));
        }
        set.settings.quality = quality;
        set.profile = Some(wax().scaled(0.6));
        if parallel {
            set.camera = Camera::orbit(-30., 75., 90., None, 30., &set.scene).with_orthographic(46., &set.scene);
        }
        list.push(set);
    }
    Ok(list)
}

/// Gathered light of `moments`, and what is kept of the shadow map for it, against the twins.
pub fn moments(bench: &Bench) -> Measured {
    let mut all: [Vec<f64>; 4] = Default::default();
    let mut kept = [0; 2];
    for set in sets()? {
        let beyond: f32 = set.lights[1..].iter().map(|l| l.intensity).sum();
        let mut views = Vec::new();
        for (i, light) in set.lights.iter().enumerate() {
            // A target's first layer is what comes back, so each light takes a turn at being the first.
            let mut turned = set.clone();
            turned.lights.rotate_left(i);
            let (view, count) = map(bench, &turned)?;
            let part = if i == 0 { 1. } else { light.intensity / beyond };
            views.push(LightView { slot: i.min(1), part: f64::from(part), ..view });
            (0..2).for_each(|i| kept[i] += count[i]);
        }
        for (sum, one) in all.iter_mut().zip(differences(bench, &set, &views)?) {
            sum.extend(one);
        }
    }
    let [right, wrong @ ..] = all.map(Spread::of);
    let least = wrong.iter().map(|s| s.p99).fold(f64::INFINITY, f64::min);
    let text = format!(
        "{right}; p99 of wrong twins: variance 5 % wider {:.1e}, half the taps {:.1e}, no mass {:.1e}",
        wrong[0].p99, wrong[1].p99, wrong[2].p99
    );
    Ok(vec![
        Measure::new("gathered light p99", right.p99, least, text),
        Measure::new("kept texels that differ", kept[0] as f64, kept[1] as f64, "wrong: the corner of each cell"),
    ])
}
