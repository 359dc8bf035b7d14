//! One thing changed and all else held: resolution, covered share, lights, distance.

use super::plot::Drawing;
use super::plot::chart::{self, Axis};
use super::scenes::{Lit, Spec, Stand};
use super::store::Results;
use clap::ValueEnum;

/// What is swept.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Sweep {
    /// Sides of the picture: a quarter, half, three quarters, all of the size asked for.
    Resolution,
    /// Share of the picture that has a surface, at one magnification: the camera looks more and more past the object.
    Coverage,
    /// Lights: 1 to 16, their irradiances one in sum.
    Lights,
    /// Distance of the camera, in parts of what frames the object: a half to eight.
    Distance,
}

impl Sweep {
    /// A scene for each value.
    pub fn specs(self, base: &Spec) -> Vec<Spec> {
        let with = |value: f64, change: &dyn Fn(&mut Spec)| {
            let mut spec = Spec { sweep: Some((self.name(), value)), ..base.clone() };
            change(&mut spec);
            spec
        };
        // A camera at a known distance, from where the standard set looks.
        let stand = |times: f64| match base.stand {
            Stand::Around(yaw, pitch, _) => Stand::Around(yaw, pitch, times),
            Stand::Own => Stand::Around(0., 0., times),
        };
        match self {
            Sweep::Resolution => [0.25, 0.5, 0.75, 1.].map(|x| with(x, &|s| s.scale = x)).to_vec(),
            Sweep::Coverage => [0., 0.35, 0.6, 0.75, 0.95]
                .map(|x| {
                    with(1. - x, &|s| {
                        s.aside = x;
                        s.stand = stand(0.6);
                    })
                })
                .to_vec(),
            Sweep::Lights => [1, 2, 4, 8, 16].map(|n| with(n as f64, &|s| s.lit = Lit::Ring(n))).to_vec(),
            Sweep::Distance => [0.5, 1., 2., 4., 8.].map(|x| with(x, &|s| s.stand = stand(x))).to_vec(),
        }
    }

    /// What results call it.
    pub fn name(self) -> &'static str {
        match self {
            Sweep::Resolution => "resolution",
            Sweep::Coverage => "coverage",
            Sweep::Lights => "lights",
            Sweep::Distance => "distance",
        }
    }
}

/// Time and error of a swept scene's rows along the sweep, one curve a method and quality.
pub fn charts(results: &Results, rows: &[usize]) -> Vec<Drawing> {
    let axis = rows.first().and_then(|r| results.cells.get(*r)?.sweep.as_deref()).unwrap_or_default();
    let across = match axis {
        "resolution" => Axis { column: "sweep_value", label: "part of the picture's sides" },
        // What was asked for by shifting the camera is known once it is drawn.
        "coverage" => Axis { column: "covered", label: "part of the picture covered" },
        "lights" => Axis { column: "sweep_value", label: "lights" },
        _ => Axis { column: "sweep_value", label: "distance, in parts of what frames it" },
    };
    let curve = |row: usize| {
        let cell = &results.cells[row];
        let several = rows.iter().any(|r| {
            let other = &results.cells[*r];
            other.method == cell.method && other.quality != cell.quality
        });
        let name = if several { format!("{} {}", cell.method, cell.quality) } else { cell.method.clone() };
        (name, cell.method.clone())
    };
    let up = [("time", chart::TIME_ERROR[0]), ("error", chart::TIME_ERROR[1])];
    up.map(|(name, up)| chart::draw(results, &format!("{name} by {axis}"), rows, [across, up], curve)).to_vec()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::compare::scenes::{Subject, standard};
    use crate::settings::Size;
    use crate::skin::profile::Profile;

    #[test]
    fn a_sweep_changes_what_it_says() -> Result<(), Box<dyn std::error::Error>> {
        let profile = Profile::resolve("skin")?;
        let base = &standard("shape:sphere:60")[0];
        let built = |sweep: Sweep| -> Result<Vec<Subject>, crate::scene::SceneError> {
            let size = Size { width: 80, height: 60 };
            sweep.specs(base).iter().map(|s| Subject::build(s, &profile, None, None, size)).collect()
        };
        let widths: Vec<u32> = built(Sweep::Resolution)?.iter().map(|s| s.size.width).collect();
        assert_eq!(widths, [20, 40, 60, 80]);
        let lights: Vec<usize> = built(Sweep::Lights)?.iter().map(|s| s.lights.len()).collect();
        assert_eq!(lights, [1, 2, 4, 8, 16]);
        let far: Vec<f32> = built(Sweep::Distance)?.iter().map(|s| s.camera.eye.length()).collect();
        assert!(far.windows(2).all(|d| (d[1] / d[0] - 2.).abs() < 1e-3), "{far:?}");
        let aside = built(Sweep::Coverage)?;
        let depth = |s: &Subject| -s.camera.eye.dot(s.camera.forward);
        assert!(aside.windows(2).all(|s| (depth(&s[0]) - depth(&s[1])).abs() < 1e-2), "one magnification");
        assert!(aside.windows(2).all(|s| s[0].camera.eye.length() < s[1].camera.eye.length()));
        Ok(())
    }
}
