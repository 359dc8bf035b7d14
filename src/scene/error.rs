//! What can go wrong between a name on the command line and a [`Scene`](super::Scene): each cause is one line that says
//! where the input is wrong and what would be right.

use thiserror::Error;

/// Why a scene could not be made. Every message is a single line meant for the person who chose the input.
#[derive(Debug, Error)]
pub enum SceneError {
    /// The file itself could not be read.
    #[error("{file}: {reason}")]
    Read {
        /// Path as it was given.
        file: String,
        /// What the operating system said.
        reason: std::io::Error,
    },
    /// The file breaks a rule of glTF, or lies about its own contents.
    #[error("{file}: {place}: {reason}")]
    Invalid {
        /// Path as it was given.
        file: String,
        /// The property at fault, such as `accessors[3].bufferView`.
        place: String,
        /// What is wrong and what would be right.
        reason: String,
    },
    /// `shape:...` names no shape, or its sizes make no surface.
    #[error("{shape}: {reason}")]
    Shape {
        /// The text as it was given.
        shape: String,
        /// What is wrong and what would be right.
        reason: String,
    },
    /// No drawn material has this name.
    #[error("no material is named '{name}'; the scene has {known}")]
    Material {
        /// The name that was asked for.
        name: String,
        /// The names there are, quoted, with commas.
        known: String,
    },
    /// An option of the caller is out of its range.
    #[error("{option} = {value}: {reason}")]
    Option {
        /// Name of the option.
        option: &'static str,
        /// Its value.
        value: f64,
        /// What would be right.
        reason: &'static str,
    },
}

/// A fault inside a glTF file, before the file's name is known to it.
#[derive(Debug)]
pub(super) struct Fault {
    pub place: String,
    pub reason: String,
}

impl Fault {
    pub fn new(place: impl Into<String>, reason: impl Into<String>) -> Self {
        Self { place: place.into(), reason: reason.into() }
    }

    pub fn in_file(self, file: &str) -> SceneError {
        SceneError::Invalid {
            file: file.to_owned(),
            place: self.place,
            // A message is one line whatever a hostile name in the file holds.
            reason: self.reason.replace(['\n', '\r'], " "),
        }
    }
}
