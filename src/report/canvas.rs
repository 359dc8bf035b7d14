//! A picture put together from pictures and words.

use font8x8::legacy::BASIC_LEGACY;

/// Pixels of a letter at scale 1.
const LETTER: u32 = 8;

/// RGBA8, row by row from the top.
#[derive(Clone, Debug, PartialEq)]
pub struct Canvas {
    /// Pixels across and down.
    pub size: [u32; 2],
    /// Four bytes a pixel.
    pub texels: Vec<u8>,
}

impl Canvas {
    /// A canvas of one colour.
    pub fn new(size: [u32; 2], color: [u8; 3]) -> Canvas {
        let [r, g, b] = color;
        Canvas { size, texels: [r, g, b, 255].repeat(size[0] as usize * size[1] as usize) }
    }

    /// Sets a pixel, where it is on the canvas; `coverage` 0..255 mixes it with what is there.
    fn set(&mut self, x: u32, y: u32, color: [u8; 3], coverage: u8) {
        if x >= self.size[0] || y >= self.size[1] {
            return;
        }
        let at = (y as usize * self.size[0] as usize + x as usize) * 4;
        for (old, new) in self.texels[at..at + 3].iter_mut().zip(color) {
            let (o, n, a) = (u32::from(*old), u32::from(new), u32::from(coverage));
            *old = ((o * (255 - a) + n * a + 127) / 255) as u8;
        }
    }

    /// Puts an RGBA picture down, shrunk or enlarged to `to` (pixels): each pixel is the mean of those that fall on it, or the
    /// nearest. `from` is the part of the picture that is shown: x, y, width, height.
    pub fn picture(&mut self, at: [u32; 2], to: [u32; 2], texels: &[u8], size: [u32; 2], from: [u32; 4]) {
        let [x0, y0, w, h] = from;
        let range = |i: u32, n: u32, first: u32, count: u32| {
            let low = first + (u64::from(i) * u64::from(count) / u64::from(n)) as u32;
            let high = first + (u64::from(i + 1) * u64::from(count)).div_ceil(u64::from(n)) as u32;
            if count <= n { low..low + 1 } else { low..high.min(first + count) }
        };
        for y in 0..to[1] {
            for x in 0..to[0] {
                let (mut sum, mut count) = ([0u32; 4], 0);
                for v in range(y, to[1], y0, h) {
                    for u in range(x, to[0], x0, w) {
                        let i = (v as usize * size[0] as usize + u as usize) * 4;
                        let Some(texel) = texels.get(i..i + 4) else { continue };
                        let a = u32::from(texel[3]);
                        (0..3).for_each(|c| sum[c] += u32::from(texel[c]) * a);
                        sum[3] += a;
                        count += 1;
                    }
                }
                if sum[3] > 0 {
                    let color = [0, 1, 2].map(|c| (sum[c] / sum[3]) as u8);
                    self.set(at[0] + x, at[1] + y, color, (sum[3] / count) as u8);
                }
            }
        }
    }

    /// Writes a line of ASCII, each letter 8 pixels times `scale`.
    pub fn text(&mut self, at: [u32; 2], scale: u32, color: [u8; 3], line: &str) {
        for (i, letter) in line.bytes().enumerate() {
            let rows = BASIC_LEGACY.get(usize::from(letter)).copied().unwrap_or_default();
            for y in 0..LETTER * scale {
                for x in 0..LETTER * scale {
                    if rows[(y / scale) as usize] >> (x / scale) & 1 == 1 {
                        self.set(at[0] + i as u32 * LETTER * scale + x, at[1] + y, color, 255);
                    }
                }
            }
        }
    }

    /// The frame of a rectangle, two pixels wide.
    pub fn frame(&mut self, [x, y, w, h]: [u32; 4], color: [u8; 3]) {
        for i in 0..w.max(h) {
            for k in 0..2 {
                if i < w {
                    self.set(x + i, y + k, color, 255);
                    self.set(x + i, (y + h).saturating_sub(1 + k), color, 255);
                }
                if i < h {
                    self.set(x + k, y + i, color, 255);
                    self.set((x + w).saturating_sub(1 + k), y + i, color, 255);
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pictures_shrink_to_their_mean_and_letters_are_where_they_should_be() {
        let mut canvas = Canvas::new([4, 2], [0; 3]);
        let checker: Vec<u8> = (0..16u32).flat_map(|i| [((i + i / 4) % 2 * 200) as u8, 0, 0, 255]).collect();
        canvas.picture([1, 0], [2, 2], &checker, [4, 4], [0, 0, 4, 4]);
        assert_eq!(canvas.texels.chunks(4).map(|t| t[0]).collect::<Vec<_>>(), [0, 100, 100, 0, 0, 100, 100, 0]);
        let mut letters = Canvas::new([16, 16], [255; 3]);
        letters.text([8, 0], 1, [0; 3], "I");
        let dark = |x: u32| (0..16).filter(|y| letters.texels[((y * 16 + x) * 4) as usize] == 0).count();
        assert!((0..8).all(|x| dark(x) == 0) && (8..16).map(dark).sum::<usize>() > 8, "a letter beside its place");
    }
}
