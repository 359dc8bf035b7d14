//! Display curves on the CPU, linear light 0.. in and out: the twin of `glsl/common/tonemap.glsl`.

/// Khronos PBR Neutral (2024): takes off the veil of a 4 % Fresnel reflection, then compresses and desaturates the peak. Scene
/// light in, display light of 0..1 out.
pub fn neutral(color: [f64; 3]) -> [f64; 3] {
    const START: f64 = 0.8 - 0.04;
    const DESATURATION: f64 = 0.15;
    let least = color[0].min(color[1]).min(color[2]);
    let veil = if least < 0.08 { least - 6.25 * least * least } else { 0.04 };
    let color = color.map(|c| c - veil);
    let peak = color[0].max(color[1]).max(color[2]);
    if peak < START {
        return color;
    }
    let d = 1. - START;
    let squeezed = 1. - d * d / (peak + d - START);
    let white = 1. - 1. / (DESATURATION * (peak - squeezed) + 1.);
    color.map(|c| c * squeezed / peak * (1. - white) + squeezed * white)
}

/// sRGB code 0..1 to linear light (IEC 61966-2-1).
pub fn decode(code: f64) -> f64 {
    if code <= 0.04045 { code / 12.92 } else { ((code + 0.055) / 1.055).powf(2.4) }
}

/// Linear light to an sRGB code.
pub fn encode(light: f64) -> f64 {
    if light <= 0.003_130_8 { light * 12.92 } else { 1.055 * light.powf(1. / 2.4) - 0.055 }
}
