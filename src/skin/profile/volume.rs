//! A profile from what glTF says of a volume.

use super::{Profile, Shape};
use crate::scene::Scattering;

/// Albedo of single scattering from that of all: what an infinite volume sends back when each event keeps this part (Kulla &
/// Conty 2017, as KHR_materials_volume_scatter has it; here with the anisotropy g of KHR_materials_scatter). Both 0..1.
pub fn single_albedo(multiscatter: f64, g: f64) -> f64 {
    let m = multiscatter;
    let s = 4.09712 + 4.20863 * m - (9.59217 + 41.6808 * m + 17.7126 * m * m).sqrt();
    ((1. - s * s) / (1. - g * s * s)).clamp(0., 1.)
}

impl Profile {
    /// Burley's profile of a volume: extinction -ln(color) / distance; of it, by the single-scattering albedo, a part scatters,
    /// which similarity reduces by 1 - g; l = 1 / (s' + a), d = l / (1.9 - A + 3.5 (A - 0.8)^2), A the multiple-scattering colour
    /// (Christensen & Burley 2015, as for the built-in profiles).
    pub fn of_volume(name: &str, volume: &Scattering, ior: f64) -> Profile {
        let d = |c: usize| {
            let extinction = -volume.attenuation[c].max(1e-12).ln() / volume.distance_mm;
            let (a, g) = (volume.multiscatter[c], volume.anisotropy);
            let albedo = single_albedo(a, g);
            let reduced = extinction * (albedo * (1. - g) + 1. - albedo);
            1. / (reduced * (1.9 - a + 3.5 * (a - 0.8).powi(2)))
        };
        Profile {
            name: name.to_owned(),
            source: "the file's KHR_materials_volume and what it says of scattering".to_owned(),
            shape: Shape::Burley { d: std::array::from_fn(d) },
            ior,
            albedo: Some(volume.multiscatter),
            lobes: None,
        }
    }
}
