//! Names for content: what was measured, on what, by which program, in 32 hexadecimal digits. Equal keys, equal results.

use crate::frame::Inputs;
use crate::scene::Scene;
use crate::truth::Effort;
use std::fmt::{self, Debug, Write};
use std::io::Read;
use std::path::Path;

/// The text of everything that decides a truth besides its inputs: a change there makes another truth.
const TRUTH_SOURCES: [(&str, &str); 12] = [
    ("ambient.rs", include_str!("../truth/ambient.rs")),
    ("bands.rs", include_str!("../truth/bands.rs")),
    ("bump.rs", include_str!("../truth/bump.rs")),
    ("cloud.rs", include_str!("../truth/cloud.rs")),
    ("eye.rs", include_str!("../truth/eye.rs")),
    ("kernel.rs", include_str!("../truth/kernel.rs")),
    ("lighting.rs", include_str!("../truth/lighting.rs")),
    ("mod.rs", include_str!("../truth/mod.rs")),
    ("near.rs", include_str!("../truth/near.rs")),
    ("random.rs", include_str!("../truth/random.rs")),
    ("state.rs", include_str!("../truth/state.rs")),
    ("surface.rs", include_str!("../truth/surface.rs")),
];

/// FNV-1a of 128 bits (Fowler, Noll & Vo). Not for secrets: nobody is kept from making two contents of one key.
#[derive(Clone, Copy, Debug)]
pub struct Digest(u128);

impl Default for Digest {
    fn default() -> Self {
        Digest(0x6c62_272e_07bb_0142_62b8_2175_6295_c58d)
    }
}

impl Digest {
    /// Adds bytes and their number, so that `ab c` is not `a bc`.
    pub fn bytes(&mut self, bytes: &[u8]) -> &mut Self {
        self.raw(bytes);
        self.raw(&(bytes.len() as u64).to_le_bytes());
        self
    }

    /// Adds a value as it prints itself: shortest decimals, which name a float exactly.
    pub fn debug(&mut self, value: &impl Debug) -> &mut Self {
        // Writing to a digest does not fail; the separator stands for the length.
        let _ = write!(self, "{value:?}\0");
        self
    }

    /// The key.
    pub fn finish(&self) -> String {
        format!("{:032x}", self.0)
    }

    fn raw(&mut self, bytes: &[u8]) {
        for b in bytes {
            self.0 = (self.0 ^ u128::from(*b)).wrapping_mul(0x0000_0000_0100_0000_0000_0000_0000_013b);
        }
    }
}

impl Write for Digest {
    fn write_str(&mut self, s: &str) -> fmt::Result {
        self.raw(s.as_bytes());
        Ok(())
    }
}

/// Adds everything that is drawn: geometry, materials, textures; not the scene's name.
pub fn scene(digest: &mut Digest, s: &Scene) {
    digest.debug(&(s.origin, s.bounds, &s.draws, &s.materials));
    digest.bytes(bytemuck::cast_slice(&s.positions)).bytes(bytemuck::cast_slice(&s.normals));
    digest.bytes(bytemuck::cast_slice(&s.tangents)).bytes(bytemuck::cast_slice(&s.uvs));
    digest.bytes(bytemuck::cast_slice(&s.indices));
    for t in &s.textures {
        digest.debug(&(t.width, t.height, t.srgb, t.wrap, t.filter)).bytes(&t.rgba8);
    }
}

/// The key of a truth: scene, camera, lights, profile, size, shadows, effort, and the code that integrates.
pub fn of_truth(inputs: &Inputs<'_>, effort: &Effort) -> String {
    let mut digest = Digest::default();
    for (name, text) in TRUTH_SOURCES {
        digest.bytes(name.as_bytes()).bytes(text.as_bytes());
    }
    scene(&mut digest, inputs.scene);
    let s = &inputs.settings;
    digest.debug(&(&inputs.camera, &inputs.lights, &inputs.profiles)).debug(&(s.size, s.no_shadows, effort));
    digest.finish()
}

/// The code that measures: the commit where the build was told it (PDSS_COMMIT), else the running program's own bytes.
pub fn of_code() -> String {
    if let Some(commit) = option_env!("PDSS_COMMIT") {
        return format!("commit {commit}");
    }
    let key = std::env::current_exe().and_then(|file| of_file(&file));
    key.map_or_else(|_| "build unknown".to_owned(), |key| format!("build {}", &key[..12]))
}

fn of_file(file: &Path) -> std::io::Result<String> {
    let mut digest = Digest::default();
    let mut part = vec![0; 1 << 16];
    let mut reader = std::fs::File::open(file)?;
    loop {
        match reader.read(&mut part)? {
            0 => return Ok(digest.finish()),
            n => digest.raw(&part[..n]),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::frame::Output;
    use crate::scene::{Camera, Light};
    use crate::settings::{Settings, Size};
    use crate::skin::profile::Profile;

    #[test]
    fn the_digest_is_fnv_1a() {
        // Test vectors of its authors.
        assert_eq!(Digest::default().finish(), "6c62272e07bb014262b821756295c58d");
        let mut a = Digest::default();
        a.raw(b"a");
        assert_eq!(a.finish(), "d228cb696f1a8caf78912b704e4a8964");
        let two = |a: &[u8], b: &[u8]| Digest::default().bytes(a).bytes(b).finish();
        assert_ne!(two(b"ab", b"c"), two(b"a", b"bc"));
    }

    #[test]
    fn every_source_of_truth_is_in_its_key() -> Result<(), std::io::Error> {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("src/truth");
        let mut files: Vec<String> = std::fs::read_dir(folder)?
            .map(|e| Ok(e?.file_name().display().to_string()))
            .collect::<Result<_, std::io::Error>>()?;
        files.sort();
        // These judge pictures and make none.
        files.retain(|f| f != "metrics.rs" && f != "flip.rs");
        assert_eq!(files, TRUTH_SOURCES.map(|s| s.0));
        Ok(())
    }

    #[test]
    fn whatever_changes_a_truth_changes_its_key() -> Result<(), Box<dyn std::error::Error>> {
        let (a, b) = (Scene::shape("shape:sphere:10")?, Scene::shape("shape:sphere:11")?);
        let again = a.clone();
        let mut scattering = a.clone();
        scattering.assign_profile(None, 0)?;
        let camera = |yaw: f64| Camera::orbit(yaw, 0., 100., None, 30., &a);
        let inputs = |scene, yaw, light, profile: &str, width, no_shadows| -> Result<_, Box<dyn std::error::Error>> {
            let size = Size { width, height: 8 };
            Ok(Inputs {
                scene,
                camera: camera(yaw),
                lights: vec![Light::directional(light, 0., 1.)],
                profiles: vec![Profile::resolve(profile)?],
                settings: Settings { size, no_shadows, ..Settings::default() },
                timing: None,
                output: Output::Linear,
            })
        };
        let effort = Effort::default();
        let first = of_truth(&inputs(&a, 0., 0., "skin", 8, false)?, &effort);
        assert_eq!(first, of_truth(&inputs(&again, 0., 0., "skin", 8, false)?, &effort));
        let others = [
            of_truth(&inputs(&b, 0., 0., "skin", 8, false)?, &effort),
            of_truth(&inputs(&scattering, 0., 0., "skin", 8, false)?, &effort),
            of_truth(&inputs(&a, 1., 0., "skin", 8, false)?, &effort),
            of_truth(&inputs(&a, 0., 1., "skin", 8, false)?, &effort),
            of_truth(&inputs(&a, 0., 0., "marble", 8, false)?, &effort),
            of_truth(&inputs(&a, 0., 0., "skin", 9, false)?, &effort),
            of_truth(&inputs(&a, 0., 0., "skin", 8, true)?, &effort),
            of_truth(&inputs(&a, 0., 0., "skin", 8, false)?, &Effort { samples: 5000, ..effort }),
        ];
        let mut all = others.to_vec();
        all.push(first);
        all.sort();
        all.dedup();
        assert_eq!(all.len(), 9);
        Ok(())
    }
}
