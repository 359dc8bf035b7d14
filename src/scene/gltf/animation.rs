//! Animations: the nodes' transforms and weights at a time, by glTF's three interpolations, in f64.

use glam::{DQuat, DVec3};

use super::accessor::{Accessor, Component};
use super::json::At;
use super::nodes::Node;
use crate::scene::error::Fault;

/// How values between two keys are made.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Interpolation {
    Step,
    Linear,
    Cubic,
}

/// Keys and their values.
struct Sampler<'a> {
    path: String,
    times: &'a Accessor<'a>,
    values: &'a Accessor<'a>,
    kind: Interpolation,
}

/// Sets every node that the animation with this index moves to where it is at `time` (seconds, held to the keys' range).
/// `targets` says how many morph targets a mesh has.
pub(super) fn pose(
    root: &At,
    accessors: &[Accessor],
    index: usize,
    time: f64,
    nodes: &mut [Node],
    targets: &[usize],
) -> Result<(), Fault> {
    let animations = root.list("animations")?;
    let Some(animation) = animations.get(index) else {
        let count = animations.len();
        return Err(Fault::new("animations", format!("{index} is out of range; the file has {count} animations")));
    };
    // Many samplers share their times.
    let mut rising = vec![None; accessors.len()];
    let read = |at: &At| read_sampler(at, accessors, &mut rising);
    let samplers: Vec<_> = animation.list("samplers")?.iter().map(read).collect::<Result<_, _>>()?;
    for channel in animation.list("channels")? {
        let sampler = channel.index("sampler", samplers.len(), "samplers")?;
        let sampler = &samplers[channel.required(sampler, "sampler")?];
        let target = channel.required(channel.object("target")?, "target")?;
        let path = target.required(target.text("path")?, "path")?;
        let Some(index) = target.index("node", nodes.len(), "nodes")? else { continue };
        let node = &mut nodes[index];
        match path {
            "translation" => node.local.translation = DVec3::from(sampler.vector(time)?),
            "scale" => node.local.scale = DVec3::from(sampler.vector(time)?),
            "rotation" => node.local.rotation = sampler.rotation(time)?,
            "weights" => node.weights = sampler.weights(time, node.mesh.map_or(0, |m| targets[m]))?,
            // What an extension points to is no transform.
            "pointer" => continue,
            other => {
                let reason = format!("'{other}' cannot move; translation, rotation, scale and weights can");
                return Err(Fault::new(target.place("path"), reason));
            }
        }
        // glTF forbids a matrix on an animated node; its parts are what is meant.
        node.local.matrix = node.local.matrix.filter(|_| path == "weights");
    }
    Ok(())
}

fn read_sampler<'a>(at: &At, accessors: &'a [Accessor<'a>], rising: &mut [Option<bool>]) -> Result<Sampler<'a>, Fault> {
    let part = |key: &str| at.required(at.index(key, accessors.len(), "accessors")?, key);
    let (input, output) = (part("input")?, part("output")?);
    let (times, values) = (&accessors[input], &accessors[output]);
    times.expect_width(&[1], &at.place("input"))?;
    let kind = match at.text("interpolation")? {
        None | Some("LINEAR") => Interpolation::Linear,
        Some("STEP") => Interpolation::Step,
        Some("CUBICSPLINE") => Interpolation::Cubic,
        Some(other) => {
            let reason = format!("there is no '{other}'; STEP, LINEAR and CUBICSPLINE are");
            return Err(Fault::new(at.place("interpolation"), reason));
        }
    };
    if !*rising[input].get_or_insert_with(|| rises(times)) {
        return Err(Fault::new(at.place("input"), "times must be floats, finite and rising"));
    }
    Ok(Sampler { path: at.path().to_owned(), times, values, kind })
}

fn rises(times: &Accessor) -> bool {
    // An accessor without bytes of its own is all zero, whatever count it claims.
    let stored = times.is_stored() && times.component == Component::F32 && times.count > 0;
    let key = |i: usize| times.floats::<1>(i)[0];
    stored && key(0).is_finite() && (1..times.count).all(|i| key(i) > key(i - 1) && key(i).is_finite())
}

impl Sampler<'_> {
    fn key(&self, index: usize) -> f64 {
        f64::from(self.times.floats::<1>(index)[0])
    }

    /// The key at or before a time, the one after (or the same), how far between them (0..1), and the seconds between.
    fn between(&self, time: f64) -> (usize, usize, f64, f64) {
        let (mut low, mut high) = (0, self.times.count);
        while low < high {
            let middle = low.midpoint(high);
            if self.key(middle) <= time { low = middle + 1 } else { high = middle }
        }
        if low == 0 || low == self.times.count {
            let end = low.saturating_sub(1);
            return (end, end, 0.0, 0.0);
        }
        let (before, after) = (self.key(low - 1), self.key(low));
        (low - 1, low, (time - before) / (after - before), after - before)
    }

    /// `width` values of each of `each` elements a key, at a time; element by element.
    fn sample<const N: usize>(&self, time: f64, each: usize) -> Result<Vec<[f64; N]>, Fault> {
        let cubic = self.kind == Interpolation::Cubic;
        let needed = self.times.count.checked_mul(if cubic { 3 } else { 1 }).and_then(|n| n.checked_mul(each));
        self.values.expect_width(&[N], &self.path)?;
        if needed != Some(self.values.count) {
            let have = self.values.count;
            return Err(Fault::new(&self.path, format!("{have} values for {} keys of {each}", self.times.count)));
        }
        let (first, second, t, seconds) = self.between(time);
        // Of each key: the tangents that come in, the values, those that go out.
        let value = |key: usize, part: usize, i: usize| {
            let at = if cubic { (3 * key + part) * each + i } else { key * each + i };
            self.values.floats::<N>(at).map(f64::from)
        };
        let at = |i: usize| {
            let (a, b) = (value(first, 1, i), value(second, 1, i));
            match self.kind {
                Interpolation::Step => a,
                Interpolation::Linear => std::array::from_fn(|k| a[k] + (b[k] - a[k]) * t),
                Interpolation::Cubic => {
                    let (out, into) = (value(first, 2, i), value(second, 0, i));
                    std::array::from_fn(|k| hermite(a[k], out[k] * seconds, b[k], into[k] * seconds, t))
                }
            }
        };
        Ok((0..each).map(at).collect())
    }

    fn vector(&self, time: f64) -> Result<[f64; 3], Fault> {
        Ok(self.sample::<3>(time, 1)?[0])
    }

    fn rotation(&self, time: f64) -> Result<DQuat, Fault> {
        if self.kind != Interpolation::Linear {
            return Ok(DQuat::from_array(self.sample::<4>(time, 1)?[0]));
        }
        // Checks the counts.
        let plain = DQuat::from_array(self.sample::<4>(time, 1)?[0]);
        let (first, second, t, _) = self.between(time);
        let unit = |i: usize| {
            let q = DQuat::from_array(self.values.floats::<4>(i).map(f64::from));
            (q.length() > 1e-6 && q.is_finite()).then(|| q.normalize())
        };
        // Along the shorter arc, at an even pace.
        Ok(unit(first).zip(unit(second)).map_or(plain, |(a, b)| a.slerp(b, t)))
    }

    fn weights(&self, time: f64, targets: usize) -> Result<Vec<f64>, Fault> {
        Ok(self.sample::<1>(time, targets)?.into_iter().map(|[w]| w).collect())
    }
}

/// Cubic Hermite spline from `a` to `b` with these slopes a unit of `t`.
fn hermite(a: f64, out: f64, b: f64, into: f64, t: f64) -> f64 {
    let (t2, t3) = (t * t, t * t * t);
    a * (2.0 * t3 - 3.0 * t2 + 1.0) + out * (t3 - 2.0 * t2 + t) + b * (3.0 * t2 - 2.0 * t3) + into * (t3 - t2)
}
