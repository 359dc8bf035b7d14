//! Unit vectors as two snorm16 (Meyer et al. 2010): the f64 twin of `glsl/common/octahedral.glsl`.

/// Steps of a coordinate.
const STEPS: f64 = 32767.0;

/// The two coordinates in whole steps, -32767..=32767. `n` need not be of unit length, but not zero.
pub fn encode(n: [f64; 3]) -> [i16; 2] {
    let sum = n[0].abs() + n[1].abs() + n[2].abs();
    let p = [n[0] / sum, n[1] / sum];
    let p = if n[2] < 0.0 { [(1.0 - p[1].abs()) * sign(p[0]), (1.0 - p[0].abs()) * sign(p[1])] } else { p };
    p.map(|x| (x * STEPS).round() as i16)
}

/// The unit vector of two coordinates. -32768 counts as -32767.
pub fn decode(code: [i16; 2]) -> [f64; 3] {
    let [x, y] = code.map(|c| f64::from(c.max(-32767)));
    let z = STEPS - x.abs() - y.abs();
    let fold = (-z).max(0.0);
    let n = [x - fold * sign(x), y - fold * sign(y), z];
    let length = (n[0] * n[0] + n[1] * n[1] + n[2] * n[2]).sqrt();
    n.map(|v| v / length)
}

fn sign(x: f64) -> f64 {
    if x >= 0.0 { 1.0 } else { -1.0 }
}
