//! Mip levels of a texture.

use super::Texture;

/// All levels in one run of bytes, RGBA8, the largest first.
#[derive(Clone, Debug)]
pub struct Mips {
    /// Texels, row by row from the top.
    pub bytes: Vec<u8>,
    /// Where each level starts, and its width and height.
    pub levels: Vec<(u64, [u32; 2])>,
}

impl Mips {
    /// Box-filtered, in linear light where the texture is a colour.
    pub fn of(texture: &Texture) -> Mips {
        let mut size = [texture.width, texture.height];
        let mut bytes = texture.rgba8.clone();
        let mut levels = vec![(0, size)];
        let decode: Vec<f32> = (0..256u32)
            .map(|i| {
                let c = i as f32 / 255.;
                if !texture.srgb {
                    c
                } else if c <= 0.04045 {
                    c / 12.92
                } else {
                    ((c + 0.055) / 1.055).powf(2.4)
                }
            })
            .collect();
        let encode = |x: f32| {
            let c = if !texture.srgb {
                x
            } else if x <= 0.003_130_8 {
                x * 12.92
            } else {
                1.055 * x.powf(1. / 2.4) - 0.055
            };
            (c * 255. + 0.5) as u8
        };
        let mut last = 0;
        while size != [1, 1] {
            let next = size.map(|x| (x / 2).max(1));
            let mut level = Vec::with_capacity((next[0] * next[1] * 4) as usize);
            let texel = |x: u32, y: u32| last + ((y.min(size[1] - 1) * size[0] + x.min(size[0] - 1)) * 4) as usize;
            for y in 0..next[1] {
                for x in 0..next[0] {
                    let at = [
                        texel(2 * x, 2 * y),
                        texel(2 * x + 1, 2 * y),
                        texel(2 * x, 2 * y + 1),
                        texel(2 * x + 1, 2 * y + 1),
                    ];
                    for c in 0..3 {
                        level.push(encode(at.iter().map(|i| decode[bytes[i + c] as usize]).sum::<f32>() / 4.));
                    }
                    level.push((at.iter().map(|i| u32::from(bytes[i + 3])).sum::<u32>().div_ceil(4)) as u8);
                }
            }
            last = bytes.len();
            levels.push((last as u64, next));
            bytes.extend_from_slice(&level);
            size = next;
        }
        Mips { bytes, levels }
    }
}
