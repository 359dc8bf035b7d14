//! Normal maps on the CPU: what `glsl/gbuffer.frag` does, mip levels included (Vulkan 1.3, 16.5.7: no anisotropy).

use super::surface::Face;
use crate::scene::{Filter, Mips, Scene, Texture, Wrap};
use glam::DVec3;

/// The unit normal that light falls on. `n` is the interpolated one, turned to the viewer; `sign` is -1 where it was
/// turned; `shares` are barycentric; `texels` says how many texels of a map of some size lie between pixels.
pub fn normal(
    scene: &Scene,
    maps: &[Option<Mips>],
    face: &Face,
    shares: [f64; 3],
    n: DVec3,
    sign: f64,
    texels: impl FnOnce([f64; 2]) -> f64,
) -> DVec3 {
    let map = scene.materials.get(face.material as usize).and_then(|m| m.normal_texture);
    let found = |(index, strength): (usize, f32)| {
        Some((scene.textures.get(index)?, maps.get(index)?.as_ref()?, f64::from(strength)))
    };
    let Some((texture, mips, strength)) = map.and_then(found) else { return n };
    let corner = |i: usize| {
        let vertex = face.vertices[i] as usize;
        Some((scene.uvs.get(vertex)?, scene.tangents.get(vertex)?))
    };
    let (mut uv, mut tangent, mut hand) = ([0.; 2], DVec3::ZERO, 0.);
    for (i, share) in shares.into_iter().enumerate() {
        let Some((c, t)) = corner(i) else { return n };
        uv = [uv[0] + share * f64::from(c[0]), uv[1] + share * f64::from(c[1])];
        tangent += share * DVec3::new(f64::from(t[0]), f64::from(t[1]), f64::from(t[2]));
        hand += share * f64::from(t[3]);
    }
    let level = texels([f64::from(texture.width), f64::from(texture.height)]).log2();
    let m = trilinear(texture, mips, uv, level).map(|x| x * 2. - 1.);
    let tangent = (tangent - n * n.dot(tangent)).normalize_or_zero();
    if tangent == DVec3::ZERO {
        return n;
    }
    let across = n.cross(tangent) * hand * sign;
    (tangent * (m[0] * strength) + across * (m[1] * strength) + n * m[2].max(1e-3)).normalize_or(n)
}

/// Red, green, blue 0..1, between the two levels nearest to `level`; NaN and what is beyond the ends are the ends.
fn trilinear(texture: &Texture, mips: &Mips, uv: [f64; 2], level: f64) -> [f64; 3] {
    let level = level.max(0.).min(mips.levels.len() as f64 - 1.);
    let (low, t) = (level.floor(), level.fract());
    let near = fetch(texture, mips, uv, low as usize);
    if t == 0. {
        return near;
    }
    let far = fetch(texture, mips, uv, low as usize + 1);
    [0, 1, 2].map(|c| near[c] + (far[c] - near[c]) * t)
}

/// Red, green, blue 0..1 of one level, bilinear or nearest.
fn fetch(texture: &Texture, mips: &Mips, uv: [f64; 2], level: usize) -> [f64; 3] {
    let Some((start, size)) = mips.levels.get(level) else { return [0.5, 0.5, 1.] };
    let size = size.map(i64::from);
    let at = [uv[0] * size[0] as f64 - 0.5, uv[1] * size[1] as f64 - 0.5];
    let texel = |x: i64, y: i64| {
        let (x, y) = (wrap(x, size[0], texture.wrap[0]), wrap(y, size[1], texture.wrap[1]));
        let first = *start as usize + ((y * size[0] + x) * 4) as usize;
        [0, 1, 2].map(|c| mips.bytes.get(first + c).map_or(0., |b| f64::from(*b) / 255.))
    };
    if texture.filter == Filter::Nearest {
        return texel(at[0].round() as i64, at[1].round() as i64);
    }
    let (x, y) = (at[0].floor(), at[1].floor());
    let (s, t) = (at[0] - x, at[1] - y);
    let (x, y) = (x as i64, y as i64);
    let corners = [texel(x, y), texel(x + 1, y), texel(x, y + 1), texel(x + 1, y + 1)];
    let weights = [(1. - s) * (1. - t), s * (1. - t), (1. - s) * t, s * t];
    [0, 1, 2].map(|c| (0..4).map(|i| weights[i] * corners[i][c]).sum())
}

fn wrap(x: i64, size: i64, how: Wrap) -> i64 {
    match how {
        Wrap::Repeat => x.rem_euclid(size),
        Wrap::Clamp => x.clamp(0, size - 1),
        Wrap::Mirror => {
            let x = x.rem_euclid(2 * size);
            x.min(2 * size - 1 - x)
        }
    }
}
