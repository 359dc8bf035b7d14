//! How a command can fail, and the exit code that says so.

use pdss::compare::CompareError;
use pdss::frame::FrameError;
use pdss::gpu::GpuError;
use pdss::report::picture::PictureError;
use pdss::scene::SceneError;
use pdss::skin::profile::ProfileError;
use std::error::Error;
use std::fmt::{self, Display};
use std::process::ExitCode;

/// Why a command did not do what it was asked; each is one line.
#[derive(Debug)]
pub enum Failure {
    /// Something that was begun went wrong, or a check failed. Exit code 1.
    Run(String),
    /// The command line or a file is wrong. Exit code 2.
    Input(String),
    /// There is no device to run on. Exit code 3.
    Device(String),
}

impl Failure {
    /// The exit code.
    pub fn code(&self) -> ExitCode {
        ExitCode::from(match self {
            Failure::Run(_) => 1,
            Failure::Input(_) => 2,
            Failure::Device(_) => 3,
        })
    }
}

impl Display for Failure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (Failure::Run(text) | Failure::Input(text) | Failure::Device(text)) = self;
        f.write_str(text)
    }
}

/// An error and its causes on one line. A cause that the line above it has already quoted is not said again.
fn line(error: &dyn Error) -> String {
    let mut text = error.to_string();
    let mut cause = error.source();
    while let Some(error) = cause {
        let words = error.to_string();
        if !text.contains(&words) {
            text = format!("{text}: {words}");
        }
        cause = error.source();
    }
    text.replace(['\n', '\r'], " ")
}

impl From<GpuError> for Failure {
    fn from(error: GpuError) -> Self {
        match error {
            GpuError::NoDevice(_) | GpuError::NoValidation => Failure::Device(line(&error)),
            _ => Failure::Run(line(&error)),
        }
    }
}

impl From<FrameError> for Failure {
    fn from(error: FrameError) -> Self {
        match error {
            FrameError::Gpu(error) => error.into(),
            FrameError::View { .. }
            | FrameError::Atlas { .. }
            | FrameError::Profiles { .. }
            | FrameError::Lights { .. } => Failure::Input(line(&error)),
            FrameError::Plan(_) => Failure::Run(line(&error)),
        }
    }
}

impl From<SceneError> for Failure {
    fn from(error: SceneError) -> Self {
        Failure::Input(line(&error))
    }
}

impl From<ProfileError> for Failure {
    fn from(error: ProfileError) -> Self {
        Failure::Input(line(&error))
    }
}

impl From<CompareError> for Failure {
    fn from(error: CompareError) -> Self {
        match error {
            CompareError::Frame(error) => error.into(),
            CompareError::Picture(error) => error.into(),
            _ => Failure::Input(line(&error)),
        }
    }
}

impl From<PictureError> for Failure {
    fn from(error: PictureError) -> Self {
        let text = line(&error);
        match error {
            PictureError::Pixels { .. } | PictureError::Encode { .. } => Failure::Run(text),
            _ => Failure::Input(text),
        }
    }
}
