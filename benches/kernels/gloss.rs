//! The end of `glsl/light.comp`: colour, gloss of two lobes, ambient light, tone curve.

use super::data::Table;
use super::light::{Job, Lanes3, Surface, V3, at, sample};
use super::vector::{LANES, Lanes, along, dot, exp2, log2, to_unorm, unit};
use std::f32::consts::PI;

/// A lobe of a block: what it reflects of a white sky, and the factor on one bounce.
#[inline(always)]
fn lobe(t: &Table, nv: &Lanes, roughness: &Lanes, f0: &Lanes3, share: f32) -> (Lanes3, Lanes3) {
    let zero = [0.; LANES];
    let (mut x, mut y) = (zero, zero);
    for i in 0..LANES {
        x[i] = nv[i].sqrt() * (t.size[0] as f32 - 1.);
        y[i] = roughness[i] * (t.size[1] as f32 - 1.);
    }
    let (a, b) = (sample(t, 0, &x, &y), sample(t, 1, &x, &y));
    let (mut boost, mut reflected) = ([zero; 3], [zero; 3]);
    for c in 0..3 {
        for i in 0..LANES {
            boost[c][i] = share * (1. + f0[c][i] * (1. / (a[i] + b[i]) - 1.));
            reflected[c][i] = boost[c][i] * (f0[c][i] * a[i] + b[i]);
        }
    }
    (boost, reflected)
}

/// One of a word's four bytes, of 1.
#[inline(always)]
fn byte(word: u32, c: usize) -> f32 {
    (word >> (8 * c) & 255) as i32 as f32 * (1. / 255.)
}

#[inline(always)]
fn ggx(nl: f32, nv: f32, nh: f32, roughness: f32) -> f32 {
    let alpha = (roughness * roughness).max(2e-3);
    let a2 = alpha * alpha;
    let d = nh * nh * (a2 - 1.) + 1.;
    let visibility = 0.5 / (nl * (nv * nv * (1. - a2) + a2).sqrt() + nv * (nl * nl * (1. - a2) + a2).sqrt());
    a2 / (PI * d * d) * visibility * nl
}

#[inline(always)]
fn srgb(x: f32) -> f32 {
    let x = x.clamp(0., 1.);
    let curve = 1.055 * exp2((log2(x.max(1e-30)) * (1. / 2.4)).max(-126.)) - 0.055;
    if x <= 0.003_130_8 { 12.92 * x } else { curve }
}

/// Colour, gloss, ambient light and the tone curve. `tilt`: the levels' mean n.up per channel, where the sky is scattered, too.
#[inline(always)]
pub fn finish(j: &Job<'_>, f: &Surface, ao: &Lanes, exitance: &Lanes3, tilt: Option<&Lanes3>, out: &mut [u32; LANES]) {
    let (d, b, zero) = (j.data, j.frame, [0.; LANES]);
    let (mut base, mut material) = ([0; LANES], [0; LANES]);
    for i in 0..LANES {
        base[i] = d.albedo[f.at[i]];
        material[i] = d.material[f.at[i]];
    }
    // What does not scatter is lit by its own normal.
    let (mut shown, mut open) = ([zero; 3], zero);
    let lamps = [&j.lights.light[0], &j.lights.light[1]];
    for c in 0..3 {
        for i in 0..LANES {
            let own = f.sharp[0][i] * lamps[0].color[c] + f.sharp[1][i] * lamps[1].color[c];
            shown[c][i] = if f.z[i] < 0. { exitance[c][i] } else { own };
        }
    }
    for i in 0..LANES {
        open[i] = if f.z[i] < 0. { ao[i] } else { 1. };
    }
    let (mut color, mut f0, mut nv, mut kept) = ([zero; 3], [zero; 3], zero, zero);
    let (mut first, mut second, mut occluded) = (zero, zero, zero);
    for i in 0..LANES {
        kept[i] = 1. - byte(material[i], 1);
        occluded[i] = byte(material[i], 2);
    }
    for c in 0..3 {
        for i in 0..LANES {
            let (x, f) = (byte(base[i], c), byte(material[i], 3));
            color[c][i] = x * x;
            f0[c][i] = f * f + (x * x - f * f) * byte(material[i], 1);
        }
    }
    let mut two = zero;
    for i in 0..LANES {
        two[i] = if base[i] >> 24 > 127 { 1. } else { 0. };
    }
    let (wide, narrow) = (j.lobes.roughness[0] as f32, j.lobes.roughness[1] as f32);
    let mix = j.lobes.mix as f32;
    for i in 0..LANES {
        nv[i] = dot(at(&f.n, i), at(&f.v, i)).clamp(0., 1.);
        let roughness = byte(material[i], 0);
        first[i] = if two[i] > 0. { (roughness * wide).min(1.) } else { roughness };
        second[i] = (roughness * narrow).min(1.);
    }
    let (mut boost, mut reflected) = lobe(j.gloss, &nv, &first, &f0, 1.);
    let (mut boost2, reflected2) = lobe(j.gloss, &nv, &second, &f0, mix);
    for c in 0..3 {
        for i in 0..LANES {
            let share = if two[i] > 0. { 1. - mix } else { 1. };
            boost[c][i] *= share;
            boost2[c][i] *= two[i];
            reflected[c][i] = reflected[c][i] * share + reflected2[c][i] * two[i];
        }
    }
    let mut gloss = [zero; 3];
    for lamp in lamps {
        let (sharp, l) = (&f.sharp[lamp.slot as usize], lamp.position);
        let (mut a, mut b, mut fresnel) = (zero, zero, zero);
        for i in 0..LANES {
            let (n, v) = (at(&f.n, i), at(&f.v, i));
            let half = unit(along(v, l, 1.));
            let nl = dot(n, l);
            let nh = dot(n, half).clamp(0., 1.);
            let m = 1. - dot(v, half).clamp(0., 1.);
            fresnel[i] = m * m * m * m * m;
            let shade = if nl > 1e-3 { (sharp[i] / nl).min(1.) } else { 0. };
            let (nl, nv) = (nl.max(1e-6), dot(n, v).max(1e-4));
            a[i] = ggx(nl, nv, nh, first[i]) * shade;
            b[i] = ggx(nl, nv, nh, second[i]) * shade;
        }
        for c in 0..3 {
            for i in 0..LANES {
                let lobes = boost[c][i] * a[i] + boost2[c][i] * b[i];
                gloss[c][i] += lobes * (f0[c][i] + (1. - f0[c][i]) * fresnel[i]) * lamp.color[c];
            }
        }
    }
    let mut rgb = [zero; 3];
    for c in 0..3 {
        let mut up = zero;
        for i in 0..LANES {
            up[i] = dot(at(&f.n, i), b.up);
        }
        if let Some(t) = tilt {
            for i in 0..LANES {
                up[i] = if f.z[i] < 0. { t[c][i] } else { up[i] };
            }
        }
        for i in 0..LANES {
            let diffuse = kept[i] * (1. - reflected[c][i]);
            let sky = (b.ambient_mean[c] + b.ambient_slope[c] * up[i]) * open[i] * occluded[i];
            let radiance = diffuse * color[c][i] * (shown[c][i] * (1. / PI) + sky);
            rgb[c][i] = (radiance + gloss[c][i] + reflected[c][i] * sky) * b.exposure;
        }
    }
    for i in 0..LANES {
        let [r, g, b] = neutral(at(&rgb, i));
        let word = to_unorm(srgb(r), 255.) | to_unorm(srgb(g), 255.) << 8 | to_unorm(srgb(b), 255.) << 16 | 255 << 24;
        out[i] = if f.z[i] != 0. { word } else { 0 };
    }
}

#[inline(always)]
fn neutral(color: V3) -> V3 {
    const START: f32 = 0.76;
    let least = color[0].min(color[1].min(color[2]));
    let offset = if least < 0.08 { least - 6.25 * least * least } else { 0.04 };
    let color = [color[0] - offset, color[1] - offset, color[2] - offset];
    let peak = color[0].max(color[1].max(color[2]));
    let d = 1. - START;
    let squeezed = 1. - d * d / (peak + d - START);
    let g = 1. - 1. / (0.15 * (peak - squeezed) + 1.);
    let scale = squeezed / peak;
    let even = [
        color[0] * scale + (squeezed - color[0] * scale) * g,
        color[1] * scale + (squeezed - color[1] * scale) * g,
        color[2] * scale + (squeezed - color[2] * scale) * g,
    ];
    let low = peak < START;
    [if low { color[0] } else { even[0] }, if low { color[1] } else { even[1] }, if low { color[2] } else { even[2] }]
}
