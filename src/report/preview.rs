//! Views of numbers as pictures for people. The EXR of the same view holds the numbers themselves.

use super::stats::quantile;
use super::tone;
use crate::settings::View;

/// From a view's numbers to colours of 0..1.
type Map = Box<dyn Fn([f32; 3]) -> [f32; 3]>;

/// RGBA8 texels of a view, and what its colours mean. Uncovered pixels are transparent black.
///
/// Directions -1..1 become 0..1. Curvature, which has no natural range, becomes 0.5 + H / (2 s), s being its 98th percentile in
/// this picture; depths and positions are divided likewise. Light is encoded as sRGB; everything else is clamped to 0..1.
pub fn encode(view: View, pixels: &[[f32; 4]]) -> (Vec<u8>, String) {
    let covered = || pixels.iter().filter(|p| p[3] > 0.);
    let largest = |channels: usize| -> f32 {
        let size = |p: &[f32; 4]| p[..channels].iter().fold(0f32, |a, b| a.max(b.abs()));
        let mut sizes: Vec<f64> = covered().map(|p| f64::from(size(p))).filter(|s| s.is_finite()).collect();
        sizes.sort_by(f64::total_cmp);
        quantile(&sizes, 0.98).filter(|s| *s > 0.).unwrap_or(1.) as f32
    };
    let (map, meaning): (Map, String) = match view {
        View::Normal | View::ShadingNormal | View::SoftNormal => {
            (Box::new(|c| c.map(|x| 0.5 * x + 0.5)), "-1..1 as 0..1".to_owned())
        }
        View::Position => {
            let s = largest(3);
            (Box::new(move |c| c.map(|x| 0.5 * x / s + 0.5)), format!("{:.4} mm..{s:.4} mm as 0..1", -s))
        }
        View::Curvature | View::SoftCurvature => {
            let s = largest(1);
            (Box::new(move |c| [0.5 * c[0] / s + 0.5; 3]), format!("H of {:.5}..{s:.5} 1/mm as 0..1", -s))
        }
        View::Depth => {
            let s = largest(1);
            (Box::new(move |c| [c[0] / s; 3]), format!("0..{s:.3} mm as 0..1"))
        }
        View::Ao => (Box::new(|c| [c[0]; 3]), "visibility as it is".to_owned()),
        View::Material | View::Lit => (Box::new(|c| c), "numbers as they are".to_owned()),
        View::Final | View::Albedo | View::Irradiance | View::Scatter => {
            (Box::new(|c| c.map(|x| tone::encode(f64::from(x)) as f32)), "sRGB, no tone curve".to_owned())
        }
    };
    let byte = |x: f32| (x.clamp(0., 1.) * 255. + 0.5) as u8;
    let texel = |p: &[f32; 4]| match *p {
        [r, g, b, a] if a > 0. => {
            let [r, g, b] = map([r, g, b]).map(byte);
            [r, g, b, byte(a)]
        }
        _ => [0; 4],
    };
    (pixels.iter().flat_map(texel).collect(), meaning)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn flat_is_mid_grey_and_the_sign_of_curvature_is_seen() {
        let pixel = |h: f32| [h, 0., 0., 1.];
        let (texels, _) = encode(View::Curvature, &[pixel(0.), pixel(0.1), pixel(-0.1), [9., 9., 9., 0.]]);
        assert_eq!(texels, [[128, 128, 128, 255], [255; 4], [0, 0, 0, 255], [0; 4]].concat());
    }

    #[test]
    fn what_is_not_a_number_is_still_a_colour() {
        let (texels, _) = encode(View::Depth, &[[f32::NAN, 0., 0., 1.], [f32::INFINITY, 0., 0., 1.], [2., 0., 0., 1.]]);
        assert_eq!(texels, [[0, 0, 0, 255], [255; 4], [255; 4]].concat());
        assert_eq!(encode(View::Curvature, &[]).0, Vec::<u8>::new());
    }

    #[test]
    fn light_is_encoded() {
        let (texels, _) = encode(View::Scatter, &[[0.215_860_5, 0., 1., 1.]]);
        assert_eq!(texels, [128, 0, 255, 255]);
    }
}
