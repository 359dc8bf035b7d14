//! Tables kept in the cache, that of `pdss` and `preintegrated` and that of gloss: integrating them takes tenths of a second.

use crate::cache::{Cache, hash, program};
use crate::skin::lut::{Integral, Lut};
use crate::skin::profile::Profile;
use crate::skin::specular;

/// As [`Lut::build`], looked for in `cache` first and kept there.
pub fn kept(cache: Option<&Cache>, profile: &Profile, integral: Integral) -> Lut {
    let Some(cache) = cache else { return Lut::build(profile, integral) };
    // Numbers are written so that they are read back to the bit: the words tell apart what the numbers do.
    let facts = format!("{} {integral:?} {:?}", program(), profile.shape);
    let key = hash(&[facts.as_bytes()]);
    cache.read("table", key).and_then(|bytes| read(&bytes)).unwrap_or_else(|| {
        let made = Lut::build(profile, integral);
        cache.write("table", key, &written(&made));
        made
    })
}

/// [`specular::table`] as it is uploaded, looked for in `cache` first and kept there.
pub fn gloss(cache: Option<&Cache>) -> Vec<u8> {
    let key = hash(&[&program().to_le_bytes()]);
    let bytes = 4 * specular::SIDE * specular::SIDE;
    let found = cache.and_then(|c| c.read("gloss", key)).filter(|found| found.len() == bytes);
    found.unwrap_or_else(|| {
        let made = bytemuck::cast_slice(specular::table()).to_vec();
        if let Some(cache) = cache {
            cache.write("gloss", key, &made);
        }
        made
    })
}

fn written(lut: &Lut) -> Vec<u8> {
    let mut bytes = lut.knee_per_mm.to_le_bytes().to_vec();
    bytes.extend(lut.size.iter().flat_map(|x| x.to_le_bytes()));
    bytes.extend_from_slice(bytemuck::cast_slice(&lut.texels));
    bytes
}

fn read(bytes: &[u8]) -> Option<Lut> {
    let knee_per_mm = f64::from_le_bytes(bytes.get(..8)?.try_into().ok()?);
    let side = |at: usize| Some(u32::from_le_bytes(bytes.get(at..at + 4)?.try_into().ok()?));
    let size = [side(8)?, side(12)?];
    let texels: Vec<[f32; 4]> = bytes.get(16..)?.chunks_exact(16).map(bytemuck::pod_read_unaligned).collect();
    (texels.len() as u64 == u64::from(size[0]) * u64::from(size[1])).then_some(Lut { size, texels, knee_per_mm })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_kept_is_what_was_built() {
        let folder = tempfile::tempdir().expect("a folder");
        let cache = Cache::in_folder(folder.path());
        let files = || std::fs::read_dir(folder.path()).expect("there").count();
        let skin = Profile::resolve("skin").expect("built in");
        let built = Lut::build(&skin, Integral::Sphere);
        for kept_already in [0, 1] {
            assert_eq!(files(), kept_already);
            assert_eq!(kept(Some(&cache), &skin, Integral::Sphere), built);
        }
        // Twins: another integral, and a profile a millionth wider, are other tables.
        assert_ne!(kept(Some(&cache), &skin, Integral::Ring), built);
        assert_ne!(kept(Some(&cache), &skin.scaled(1. + 1e-6), Integral::Sphere).knee_per_mm, built.knee_per_mm);
        assert_eq!(files(), 3);
        let gloss_of: &[u8] = bytemuck::cast_slice(specular::table());
        assert!([1, 2].into_iter().all(|_| gloss(Some(&cache)) == gloss_of) && files() == 4);
        assert_eq!(read(&written(&built)[..1000]), None, "cut off");
    }
}
