//! A small plot.
use crate::point::Curves;
use std::fmt::Write;

const COLOURS: [&str; 7] = ["#000", "#c33", "#c33", "#282", "#282", "#33c", "#33c"];

/// Light over the distance from the spot, logarithmic, the red channel; what is claimed dashed.
pub fn svg(curves: &Curves, mm_per_ring: f64) -> String {
    let mut out = String::from(
        "<svg xmlns='http://www.w3.org/2000/svg' viewBox='0 0 640 420' font-family='sans-serif' font-size='12'>\n",
    );
    let top = curves.iter().map(|c| c.1[0][0]).fold(1e-9, f64::max);
    let y = |v: f64| 20. + 60. * (top / v.max(1e-9)).log10().clamp(0., 6.);
    for (i, (name, rings)) in curves.iter().enumerate() {
        let points: Vec<String> =
            rings.iter().enumerate().map(|(r, v)| format!("{:.1},{:.1}", 50. + 9. * r as f64, y(v[0]))).collect();
        let dash = if name.ends_with("claims") { " stroke-dasharray='5 4'" } else { "" };
        let colour = COLOURS[i % COLOURS.len()];
        let _ = writeln!(out, "<polyline fill='none' stroke='{colour}'{dash} points='{}'/>", points.join(" "));
        let _ = writeln!(out, "<text x='440' y='{}' fill='{colour}'>{name}</text>", 30 + 16 * i);
    }
    for decade in 0..=6 {
        let _ = writeln!(out, "<text x='8' y='{}'>1e-{decade}</text>", 24 + 60 * decade);
    }
    for mm in 0..=15 {
        let _ = writeln!(out, "<text x='{:.0}' y='405'>{mm}</text>", 46. + 9. * f64::from(mm) / mm_per_ring);
    }
    out + "<text x='560' y='418'>mm</text></svg>\n"
}
