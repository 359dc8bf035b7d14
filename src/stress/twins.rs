//! The device against the f64 twins, stage after stage, on a picture that the device drew: the twins start from its G-buffer
//! and run every pass that the frame runs, rounding between passes as the formats do.

use super::studio::{Picture, Set, settings, wax};
use super::{Bench, Measure, Measured, Spread, StressError};
use crate::frame::Setup;
use crate::frame::levels::{Level, Step};

use crate::scene::{Camera, Light, LightKind};
use crate::settings::{Method, Quality, View};
use crate::skin::blur::{Pass, Screen, Texel, blur};
use crate::skin::curvature;
use crate::skin::light::{self, Lamp};
use crate::skin::lut::Lut;
use crate::skin::occlusion::RADIUS_SIGMAS;

/// The device's G-buffer, and what the frame was set up as.
struct Shot {
    setup: Setup,
    screen: Screen,
    first: Vec<Texel>,
    lamps: Vec<Lamp>,
    lut: Option<Lut>,
}

fn shot(bench: &Bench, set: &Set) -> Result<Shot, StressError> {
    let setups = Setup::all(&set.inputs())?;
    let setup = setups[0].clone();
    let view = set.camera.view_from_world();
    let depth = set.seeing(View::Depth).linear(bench)?;
    let normal = set.seeing(View::Normal).linear(bench)?;
    let bent = set.seeing(View::Curvature).linear(bench)?;
    let slots = setup.shadows.slots;
    let lit = if slots > 0 { Some(set.seeing(View::Lit).linear(bench)?) } else { None };
    let facts = setup.view;
    let single = |v: [f64; 2]| v.map(|x| f64::from(x as f32));
    let camera = curvature::Camera {
        ray_scale: single(facts.ray_scale),
        ray_offset: single(facts.ray_offset),
        perspective: facts.perspective > 0.5,
    };
    let first = (0..depth.texels.len())
        .map(|i| {
            let n = view.transform_vector3(glam::Vec3::from_slice(&normal.texels[i][..3]));
            Texel {
                n: n.as_dvec3().to_array(),
                h: f64::from(bent.texels[i][0]) * setup.levels.length_mm,
                confidence: f64::from(bent.texels[i][2]),
                lit: lit.as_ref().map_or([0.; 2], |l| [l.texels[i][0], l.texels[i][1]].map(f64::from)),
            }
        })
        .collect();
    let lamps = set
        .lights
        .iter()
        .enumerate()
        .filter_map(|(i, light)| {
            let LightKind::Directional { direction } = light.kind else { return None };
            let l = view.transform_vector3(direction).as_dvec3().to_array();
            let irradiance = light.color.map(|c| f64::from(c * light.intensity));
            Some(Lamp { l, irradiance, slot: (i < slots).then_some(i), shade: 1. })
        })
        .collect();
    let integral = set.settings.integral.into();
    let lut = set.profile.as_ref().filter(|_| set.settings.method == Method::Pdss).map(|p| Lut::build(p, integral));
    let z = depth.texels.iter().map(|t| -f64::from(t[0])).collect();
    Ok(Shot { screen: Screen { size: set.size(), z, camera }, setup, first, lamps, lut })
}

impl Shot {
    /// Every level that lighting reads, each pass `widened` times as wide as it should be.
    fn levels(&self, widened: f64) -> Vec<(Level, Vec<Texel>)> {
        let mut done = Vec::new();
        let mut source = self.first.clone();
        for (i, Step { variance, stride, level }) in self.setup.levels.steps.iter().enumerate() {
            let pass = Pass {
                variance: f64::from(*variance as f32) * widened,
                source_stride: stride.0 as usize,
                target_stride: stride.1 as usize,
                turn: i % 2 == 1,
            };
            source = blur(&self.screen, &source, &pass).into_iter().map(Texel::stored).collect();
            if let Some(l) = level {
                done.push((self.setup.levels.levels[*l].clone(), source.clone()));
            }
        }
        done
    }

    /// Exitance and ambient visibility of a pixel.
    fn lit(&self, levels: &[(Level, Vec<Texel>)], reach: f64, at: usize) -> ([f64; 3], f64) {
        let (l, own) = (&self.setup.levels, &self.first[at]);
        let pixel = [at % self.screen.size[0], at / self.screen.size[0]];
        let read: Vec<Texel> = levels
            .iter()
            .map(|(level, t)| light::level_at(&self.screen, t, level.stride as usize, pixel, own.n, own.lit))
            .collect();
        let radii: Vec<f64> =
            levels.iter().map(|(level, _)| reach * RADIUS_SIGMAS * level.variance.sqrt() / l.length_mm).collect();
        let exitance = match &self.lut {
            Some(lut) => {
                let shares: Vec<_> = [l.sharp].into_iter().chain(levels.iter().map(|(x, _)| x.share)).collect();
                light::pdss(own.n, own.lit, &read, &shares, l.length_mm, lut, &self.lamps)
            }
            None => {
                let weights: Vec<_> = levels.iter().map(|(x, _)| x.weight).collect();
                light::moments(own.n, own.lit, &read, &weights, l.sharp, &self.lamps)
            }
        };
        (exitance, light::ambient(&read, &radii))
    }
}

/// Differences of a picture's first `channels` channels to what the twin says, at covered pixels.
fn apart(p: &Picture, channels: usize, twin: impl Fn(usize) -> Option<[f64; 3]>) -> Vec<f64> {
    p.covered()
        .filter_map(|i| {
            let want = twin(i)?;
            let one = |c: usize| (f64::from(p.texels[i][c]) - want[c]).abs();
            Some((0..channels).map(one).fold(0., |m, x| if x.is_nan() { f64::INFINITY } else { m.max(x) }))
        })
        .collect()
}

/// Errors of the four quantities over one picture.
fn errors(bench: &Bench, set: &Set) -> Result<[[Vec<f64>; 2]; 4], StressError> {
    let shot = shot(bench, set)?;
    let rotation = set.camera.world_from_view().as_dmat4();
    let views = [View::SoftNormal, View::SoftCurvature, View::Scatter, View::Ao];
    let pictures = views.map(|v| set.seeing(v).linear(bench));
    let [normal, bend, exitance, ao] = pictures;
    let (normal, bend, exitance, ao) = (normal?, bend?, exitance?, ao?);
    let all = [1., 1.05].map(|widened| {
        let levels = shot.levels(widened);
        let length = shot.setup.levels.length_mm;
        let last = |i: usize| {
            let (level, texels) = levels.last()?;
            let stride = level.stride as usize;
            let (x, y) = (i % shot.screen.size[0] / stride, i / shot.screen.size[0] / stride);
            let seat = shot.screen.representative([x, y], stride);
            // A texel whose own pixel is background was never written.
            (shot.screen.scattering(seat) > 0.).then(|| texels[y * shot.screen.texels(stride)[0] + x])
        };
        let turned = |n: [f64; 3]| rotation.transform_vector3(glam::DVec3::from_array(n)).to_array();
        [
            apart(&normal, 3, |i| Some(turned(last(i)?.n))),
            // Relative to the profile's length: what the level stores.
            apart(&bend, 1, |i| Some([last(i)?.h / length, 0., 0.])).into_iter().map(|x| x * length).collect(),
            apart(&exitance, 3, |i| Some(shot.lit(&levels, widened, i).0)),
            apart(&ao, 1, |i| Some([shot.lit(&levels, widened, i).1; 3])),
        ]
    });
    let [right, wrong] = all;
    let mut wrong = wrong.into_iter();
    Ok(right.map(|r| [r, wrong.next().unwrap_or_default()]))
}

fn sets(method: Method) -> Result<Vec<Set>, StressError> {
    let mut list = Vec::new();
    for (quality, parallel, shadows) in
        [(Quality::Low, false, true), (Quality::High, false, false), (Quality::Ultra, true, true)]
    {
        let mut set = Set::new("shape:torus:12,9", 90., settings(method, View::Scatter, [92, 70]))?;
        set.lights.push(Light::directional(70., 10., 0.4));
        set.settings.quality = quality;
        set.settings.no_shadows = !shadows;
        // `gathered` holds what is gathered from the light's view.
        set.settings.no_translucent = true;
        set.profile = Some(wax().scaled(0.4));
        if parallel {
            set.camera = Camera::orbit(-30., 75., 90., None, 30., &set.scene).with_orthographic(46., &set.scene);
        }
        list.push(set);
    }
    Ok(list)
}

/// Levels and light of `method` against f64.
fn compared(bench: &Bench, method: Method) -> Measured {
    let mut all: [[Vec<f64>; 2]; 4] = Default::default();
    for set in sets(method)? {
        for (sum, one) in all.iter_mut().zip(errors(bench, &set)?) {
            for (sum, one) in sum.iter_mut().zip(one) {
                sum.extend(one);
            }
        }
    }
    let quantities = ["soft normal p99", "soft H length p99", "exitance p99", "ambient p99"];
    let measure = |(quantity, [right, wrong]): (&'static str, [Vec<f64>; 2])| {
        let s = Spread::of(right);
        Measure::new(
            quantity,
            s.p99,
            Spread::of(wrong).p99,
            format!("{s}; wrong: passes and the reach of occlusion 5 % wider"),
        )
    };
    Ok(quantities.into_iter().zip(all).map(measure).collect())
}

/// `pdss` against its twins.
pub fn pdss(bench: &Bench) -> Measured {
    compared(bench, Method::Pdss)
}

/// `moments` against its twins.
pub fn moments(bench: &Bench) -> Measured {
    compared(bench, Method::Moments)
}
