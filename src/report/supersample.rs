//! Anti-aliasing for pictures people look at: several samples a pixel, averaged in linear light. A frame that is timed or
//! measured has one.

use super::tone;

/// Averages blocks of `n` x `n` pixels of an sRGB-encoded RGBA picture of `size` x n pixels; returns `size` pixels with
/// straight alpha, so that a silhouette blends with whatever the picture is laid over.
pub fn average(pixels: &[u8], size: [u32; 2], n: u32) -> Vec<u8> {
    let linear: Vec<f32> = (0..256).map(|i| tone::decode(f64::from(i) / 255.) as f32).collect();
    let [width, height] = size.map(|x| x as usize);
    let n = n as usize;
    let mut out = Vec::with_capacity(width * height * 4);
    for y in 0..height {
        for x in 0..width {
            let (mut sum, mut alpha) = ([0f32; 3], 0f32);
            for sub in 0..n * n {
                let at = ((y * n + sub / n) * width * n + x * n + sub % n) * 4;
                let Some([r, g, b, a]) = pixels.get(at..at + 4).and_then(|p| <[u8; 4]>::try_from(p).ok()) else {
                    continue;
                };
                let a = f32::from(a) / 255.;
                for (s, c) in sum.iter_mut().zip([r, g, b]) {
                    *s += linear[usize::from(c)] * a;
                }
                alpha += a;
            }
            let scale = if alpha > 0. { 1. / alpha } else { 0. };
            out.extend(sum.map(|s| byte(tone::encode(f64::from(s * scale)) as f32)));
            out.push(byte(alpha / (n * n) as f32));
        }
    }
    out
}

fn byte(x: f32) -> u8 {
    (x * 255. + 0.5) as u8
}

#[cfg(test)]
mod tests {
    use super::average;

    #[test]
    fn light_is_averaged_not_codes_and_background_has_no_colour() {
        let flat = [90u8, 120, 200, 255].repeat(16);
        assert_eq!(average(&flat, [2, 2], 2), [90u8, 120, 200, 255].repeat(4));
        let half = [[255u8, 255, 255, 255], [0, 0, 0, 255]].concat().repeat(2);
        // The mean of the codes would be 128: half of white's light is 188.
        assert_eq!(average(&half, [1, 1], 2), [188, 188, 188, 255]);
        let edge = [[200u8, 100, 50, 255], [0, 0, 0, 0]].concat().repeat(2);
        assert_eq!(average(&edge, [1, 1], 2), [200, 100, 50, 128]);
    }
}
