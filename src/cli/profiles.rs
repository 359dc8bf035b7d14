//! Which material scatters how: `--profile`, `--profile-material`, and what the file says.

use super::failure::Failure;
use pdss::frame::uniforms::MAX_PROFILES;
use pdss::scene::Scene;
use pdss::skin::profile::Profile;

/// How things scatter where no profile is named.
const DEFAULT_PROFILE: &str = "skin";

/// What the command line says.
pub struct Wish<'a> {
    /// `--profile`; none where it is left out.
    pub profile: Option<&'a str>,
    /// `--profile-material`, each NAME or NAME=PROFILE.
    pub materials: &'a [String],
}

impl Wish<'_> {
    /// Names of profiles that are wrong, before a large file is read.
    ///
    /// # Errors
    /// The first that there is no profile for.
    pub fn check(&self) -> Result<(), Failure> {
        resolve(self.profile.unwrap_or(DEFAULT_PROFILE))?;
        Ok(())
    }

    /// Marks the materials that scatter; the profiles that they scatter by, in the order of [`Material::scatter`].
    ///
    /// # Errors
    /// Where a material or a profile has no such name.
    ///
    /// [`Material::scatter`]: pdss::scene::Material::scatter
    pub fn assign(&self, scene: &mut Scene) -> Result<Vec<Profile>, Failure> {
        let mut profiles: Vec<Profile> = match self.profile {
            Some(name) => resolve(name)?.into_iter().collect(),
            None => of_file(scene),
        };
        // A name with a sign of equality in it is still the name of a material.
        let whole = |text: &str| scene.materials.iter().any(|m| m.name == text);
        let (plain, own): (Vec<&str>, Vec<&str>) =
            self.materials.iter().map(String::as_str).partition(|t| whole(t) || !t.contains('='));
        if !profiles.is_empty() {
            if plain.is_empty() {
                scene.assign_profile(None, 0)?;
            }
            for name in plain {
                scene.assign_profile(Some(name), 0)?;
            }
            if self.profile.is_none() {
                by_volume(scene, &profiles);
            }
        }
        for (name, of) in own.into_iter().filter_map(|t| t.rsplit_once('=')) {
            let wanted = resolve(of)?;
            let known = wanted.as_ref().and_then(|w| profiles.iter().position(|p| p == w));
            scene.assign_profile(Some(name), known.unwrap_or(profiles.len()))?;
            match wanted {
                Some(_) if known.is_some() => {}
                Some(profile) => profiles.push(profile),
                None => scene.materials.iter_mut().filter(|m| m.name == name).for_each(|m| m.scatter = None),
            }
        }
        Ok(leave_out_unused(scene, profiles))
    }
}

fn resolve(name: &str) -> Result<Option<Profile>, Failure> {
    Ok(if name == "none" { None } else { Some(Profile::resolve(name)?) })
}

/// The profiles of the scene's own materials, the largest's first; skin where they say nothing.
fn of_file(scene: &mut Scene) -> Vec<Profile> {
    let mut profiles: Vec<Profile> = Vec::new();
    let (mut volumes, mut beyond) = (Vec::new(), 0);
    for (material, volume) in scene.scatterings() {
        if volumes.contains(&volume) {
            continue;
        }
        if profiles.len() == MAX_PROFILES {
            beyond += 1;
            continue;
        }
        profiles.push(Profile::of_volume(&material.name, &volume, f64::from(material.ior.max(1.))));
        volumes.push(volume);
    }
    if beyond > 0 {
        let line = format!("{MAX_PROFILES} profiles a frame: {beyond} more scatter as '{}' does", profiles[0].name);
        scene.warnings.push(line);
    }
    if profiles.is_empty() { Profile::resolve(DEFAULT_PROFILE).into_iter().collect() } else { profiles }
}

/// Gives each material that scatters the profile of its own volume.
fn by_volume(scene: &mut Scene, profiles: &[Profile]) {
    for m in scene.materials.iter_mut().filter(|m| m.scatter.is_some()) {
        let own = m.scattering.map(|volume| Profile::of_volume(&m.name, &volume, f64::from(m.ior.max(1.))));
        let same = |p: &Profile| own.as_ref().is_some_and(|own| own.shape == p.shape);
        m.scatter = Some(profiles.iter().position(same).unwrap_or(0));
    }
}

/// Drops the profiles that nothing drawn scatters by; the first stays, if there is one, for what is said of the frame.
fn leave_out_unused(scene: &mut Scene, profiles: Vec<Profile>) -> Vec<Profile> {
    let used = |k: usize| {
        let by = |m: usize| scene.materials.get(m).is_some_and(|m| m.scatter == Some(k));
        scene.draws.iter().any(|d| d.index_count > 0 && by(d.material))
    };
    let mut kept: Vec<usize> = (0..profiles.len()).filter(|k| used(*k)).collect();
    if kept.is_empty() && !profiles.is_empty() {
        kept.push(0);
    }
    for m in &mut scene.materials {
        m.scatter = m.scatter.and_then(|k| kept.iter().position(|of| *of == k));
    }
    kept.into_iter().map(|k| profiles[k].clone()).collect()
}
