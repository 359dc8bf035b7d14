//! Curvature as light warping (Vergne et al. 2009) reads it off the screen: the Hessian of depth, whose gradient is -n.xy / n.z.

use super::real::{Real, V3};
use super::{Local, RING, Window, per_pixel, sides};

/// `published` divides by n.z no smaller than this: finite, yet a hundred thousand times too large at a silhouette.
pub const EPSILON: f64 = 1e-6;
/// `mended` divides by n.z to this power, and by no smaller n.z than the next.
pub const MENDED_EXPONENT: f64 = 0.4;
/// See there.
pub const MENDED_FLOOR: f64 = 0.01;
/// Relative difference of depth at which a neighbour stops counting as the same surface, and does not count at all: the author's
/// smoothstep(.96, .97, 1 - d), d the difference of the logarithm of depth.
pub const MENDED_JUMP: [f64; 2] = [0.03, 0.04];

/// H = -tr(Hess depth)/2 with grad depth = -(n_x, n_y)/n_z, central differences on the screen, scaled by f/z.
/// The denominator (1 + |grad|^2)^(3/2) of the true mean curvature is missing in the paper's form, too.
pub(super) fn published<T: Real>(w: &Window<T>) -> Local<T> {
    divergence(w, |n| {
        let floor = T::of(EPSILON);
        let nz = if n[2] < T::of(0.0) { -(-n[2]).at_least(floor) } else { n[2].at_least(floor) };
        [-n[0] / nz, -n[1] / nz, T::of(0.0)]
    })
}

/// The form of the author's own code for radiance scaling (MeshLab's plugin): n_z to a power of .4, held to .01, and weighted down
/// where depth jumps. Its tanh belongs to the display; its weight, which is w - 1/2 where w > 1/2, is brought to 1 where no
/// neighbour jumps.
pub(super) fn mended<T: Real>(w: &Window<T>) -> Local<T> {
    let local = divergence(w, |n| {
        let by = (T::of(-MENDED_EXPONENT) * n[2].at_least(T::of(MENDED_FLOOR)).ln()).exp();
        [-n[0] * by, -n[1] * by, T::of(0.0)]
    });
    let mut near = T::of(0.0);
    for (dx, dy) in RING {
        near = near + w.same_depth(dx, dy);
    }
    let weight = (near * T::of(0.25) - T::of(1.0)).clamped(0.0, 1.0);
    Local { h: local.h * weight, ..local }
}

fn divergence<T: Real>(w: &Window<T>, gradient: impl Fn(V3<T>) -> V3<T> + Copy) -> Local<T> {
    let (u, sides_u) = per_pixel(w, 1, 0, gradient);
    let (v, sides_v) = per_pixel(w, 0, 1, gradient);
    let h = -T::of(0.5) * (u[0] / w.unit[0] + v[1] / w.unit[1]);
    Local { h, k: T::of(0.0), confidence: sides(sides_u, sides_v) }
}

impl<T: Real> Window<'_, T> {
    /// 1 where a neighbour lies at the same depth, 0 where it jumps or is background; beyond the picture's edge it is as the edge.
    fn same_depth(&self, dx: i64, dy: i64) -> T {
        let hold = |i: i64, size: usize| i.clamp(0, size as i64 - 1) as usize;
        let at = hold(self.y + dy, self.g.height) * self.g.width + hold(self.x + dx, self.g.width);
        let z = T::of(self.g.z[at]).abs();
        if z.f64() == 0.0 {
            return T::of(0.0);
        }
        let [from, to] = MENDED_JUMP.map(T::of);
        let t = ((to - (z / self.z).ln().abs()) / (to - from)).clamped(0.0, 1.0);
        t * t * (T::of(3.0) - T::of(2.0) * t)
    }
}
