//! Profiles as data: the built-in ones and the reader of their TOML files.

use super::{Gaussian, Profile, Shape};
use crate::skin::specular::Lobes;
use serde::Deserialize;
use std::ops::Range;
use std::path::Path;
use toml::Spanned;

/// Index of refraction where a file states none: between water and fat, what skin is commonly given.
const DEFAULT_IOR: f64 = 1.4;

macro_rules! built_in {
    ($($name:literal),* $(,)?) => {
        [$(($name, include_str!(concat!("../../../assets/profiles/", $name, ".toml")))),*]
    };
}

/// (name, file) of each built-in profile.
pub(super) static BUILT_IN: [(&str, &str); 13] = built_in![
    "skin",
    "skin1",
    "skin2",
    "marble",
    "wholemilk",
    "skimmilk",
    "cream",
    "ketchup",
    "potato",
    "apple",
    "chicken1",
    "chicken2",
    "spectralon",
];

/// Why a profile could not be had. Each is one line: what, where, and what would be right.
#[derive(Debug, thiserror::Error)]
pub enum ProfileError {
    /// Neither a built-in name nor a path to a TOML file.
    #[error("no profile is called '{name}': give a path ending in .toml, or one of {known}")]
    Unknown {
        /// What was asked for.
        name: String,
        /// The built-in names.
        known: String,
    },
    /// The file could not be read.
    #[error("cannot read the profile {path}: {source}")]
    Read {
        /// The path as given.
        path: String,
        /// The system's reason.
        source: std::io::Error,
    },
    /// The file says something that is not a profile.
    #[error("{path}:{line}: {problem}")]
    Invalid {
        /// The path as given.
        path: String,
        /// Line in the file, from 1.
        line: usize,
        /// What is wrong and what would be right.
        problem: String,
    },
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct File {
    name: Option<String>,
    source: Option<String>,
    ior: Option<Spanned<f64>>,
    albedo: Option<Spanned<[f64; 3]>>,
    gaussians: Option<Spanned<Vec<Spanned<Term>>>>,
    burley_d_mm: Option<Spanned<[f64; 3]>>,
    sigma_s_prime_per_mm: Option<Spanned<[f64; 3]>>,
    sigma_a_per_mm: Option<Spanned<[f64; 3]>>,
    specular: Option<Spanned<Specular>>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Specular {
    roughness: [f64; 2],
    mix: f64,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Term {
    variance_mm2: f64,
    weight: [f64; 3],
}

pub(super) fn resolve(arg: &str) -> Result<Profile, ProfileError> {
    let name = if arg == "milk" { "wholemilk" } else { arg };
    if let Some((name, text)) = BUILT_IN.iter().find(|(known, _)| *known == name) {
        return parse(text, &format!("built-in {name}.toml"), name);
    }
    let path = Path::new(arg);
    if path.extension().is_none_or(|e| !e.eq_ignore_ascii_case("toml")) {
        return Err(ProfileError::Unknown { name: arg.to_owned(), known: Profile::names().join(", ") });
    }
    let text = std::fs::read_to_string(path).map_err(|source| ProfileError::Read { path: arg.to_owned(), source })?;
    let stem = path.file_stem().map(|s| s.to_string_lossy().into_owned()).unwrap_or_default();
    parse(&text, arg, &stem)
}

pub(super) fn parse(text: &str, path: &str, stem: &str) -> Result<Profile, ProfileError> {
    let reader = Reader { text, path };
    let file: File = toml::from_str(text).map_err(|e| {
        let one_line = e.message().split('\n').map(str::trim).collect::<Vec<_>>().join(" ");
        reader.error(e.span().unwrap_or(0..0), one_line)
    })?;
    if let Some(ior) = &file.ior
        && !(1.0..=10.0).contains(ior.get_ref())
    {
        return Err(reader.error(ior.span(), format!("ior is {}, it must lie in 1..10", ior.get_ref())));
    }
    if let Some(albedo) = &file.albedo
        && !albedo.get_ref().iter().all(|a| (0.0..=1.0).contains(a))
    {
        return Err(reader.error(albedo.span(), format!("albedo is {:?}, it must lie in 0..1", albedo.get_ref())));
    }
    if let Some(specular) = &file.specular {
        let Specular { roughness, mix } = specular.get_ref();
        if !roughness.iter().all(|r| (0.1..=4.0).contains(r)) || !(0.0..=1.0).contains(mix) {
            let problem = format!("specular is roughness {roughness:?}, mix {mix}: they must lie in 0.1..4 and 0..1");
            return Err(reader.error(specular.span(), problem));
        }
    }
    let shape = reader.shape(&file)?;
    Ok(Profile {
        name: file.name.unwrap_or_else(|| stem.to_owned()),
        source: file.source.unwrap_or_default(),
        shape,
        ior: file.ior.map_or(DEFAULT_IOR, Spanned::into_inner),
        albedo: file.albedo.map(Spanned::into_inner),
        lobes: file.specular.map(|s| {
            let Specular { roughness, mix } = s.into_inner();
            Lobes { roughness, mix }
        }),
    })
}

/// The text and its name: what is needed to say where something is wrong.
struct Reader<'a> {
    text: &'a str,
    path: &'a str,
}

impl Reader<'_> {
    fn error(&self, span: Range<usize>, problem: impl Into<String>) -> ProfileError {
        let before = self.text.as_bytes().iter().take(span.start);
        let line = 1 + before.filter(|&&b| b == b'\n').count();
        ProfileError::Invalid { path: self.path.to_owned(), line, problem: problem.into() }
    }

    fn shape(&self, file: &File) -> Result<Shape, ProfileError> {
        match (&file.gaussians, &file.burley_d_mm, &file.sigma_s_prime_per_mm, &file.sigma_a_per_mm) {
            (Some(terms), None, None, None) => self.gaussians(terms),
            (None, Some(d), None, None) => Ok(Shape::Burley { d: self.lengths("burley_d_mm", d)? }),
            (None, None, Some(scattering), Some(absorption)) => {
                let Some(albedo) = &file.albedo else {
                    return Err(self.error(scattering.span(), "sigma_s_prime_per_mm needs albedo = [r, g, b] as well"));
                };
                self.coefficients(scattering, absorption, *albedo.get_ref())
            }
            (gaussians, burley, scattering, absorption) => {
                let spans = [gaussians.as_ref().map(Spanned::span), burley.as_ref().map(Spanned::span)];
                let more = [scattering.as_ref().map(Spanned::span), absorption.as_ref().map(Spanned::span)];
                let last = spans.into_iter().chain(more).flatten().max_by_key(|s| s.start);
                let want =
                    "a profile has exactly one of gaussians, burley_d_mm, or sigma_s_prime_per_mm with sigma_a_per_mm";
                Err(self.error(last.unwrap_or(0..0), want))
            }
        }
    }

    fn gaussians(&self, terms: &Spanned<Vec<Spanned<Term>>>) -> Result<Shape, ProfileError> {
        for term in terms.get_ref() {
            let Term { variance_mm2, weight } = term.get_ref();
            if !weight.iter().chain([variance_mm2]).all(|x| x.is_finite() && *x >= 0.0) {
                let found = format!("variance_mm2 = {variance_mm2}, weight = {weight:?}: none may be negative or NaN");
                return Err(self.error(term.span(), found));
            }
        }
        let terms_of = |c: usize| terms.get_ref().iter().map(move |t| t.get_ref().weight[c]);
        let sums: [f64; 3] = std::array::from_fn(|c| terms_of(c).fold(0.0, |sum, w| sum + w));
        if !sums.iter().all(|s| s.is_finite() && *s > 0.0) {
            return Err(
                self.error(terms.span(), format!("the weights sum to {sums:?}; each channel needs some energy"))
            );
        }
        // Published sums are 1 but for a last bit, which is not worth another set of weights.
        let scale = sums.map(|s| if (s - 1.0).abs() < 1e-9 { 1.0 } else { 1.0 / s });
        let normalised =
            |t: &Term| Gaussian { variance: t.variance_mm2, weight: std::array::from_fn(|c| t.weight[c] * scale[c]) };
        Ok(Shape::Gaussians(terms.get_ref().iter().map(|t| normalised(t.get_ref())).collect()))
    }

    fn lengths(&self, key: &str, value: &Spanned<[f64; 3]>) -> Result<[f64; 3], ProfileError> {
        let numbers = *value.get_ref();
        if numbers.iter().all(|x| x.is_finite() && *x >= 0.0) {
            Ok(numbers)
        } else {
            Err(self.error(value.span(), format!("{key} is {numbers:?}: none may be negative, NaN or infinite")))
        }
    }

    /// Burley's shape distance from measured coefficients: Christensen & Burley 2015, the s of a diffuse surface by the
    /// mean free path, 3.9 % from the path traced truth.
    fn coefficients(
        &self,
        scattering: &Spanned<[f64; 3]>,
        absorption: &Spanned<[f64; 3]>,
        albedo: [f64; 3],
    ) -> Result<Shape, ProfileError> {
        let s = self.lengths("sigma_s_prime_per_mm", scattering)?;
        let a = self.lengths("sigma_a_per_mm", absorption)?;
        let d: [f64; 3] =
            std::array::from_fn(|c| 1.0 / ((s[c] + a[c]) * (1.9 - albedo[c] + 3.5 * (albedo[c] - 0.8).powi(2))));
        if d.iter().all(|d| d.is_finite()) {
            Ok(Shape::Burley { d })
        } else {
            Err(self
                .error(scattering.span(), "sigma_s' + sigma_a is 0 in a channel, so its mean free path is infinite"))
        }
    }
}
