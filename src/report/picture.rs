//! Pictures on disk: PNG for people, EXR for measuring. A picture appears whole under its name, or not at all.

use super::tone;
use image::codecs::openexr::{OpenExrDecoder, OpenExrEncoder};
use image::codecs::png::{PngDecoder, PngEncoder};
use image::{DynamicImage, ExtendedColorType, ImageEncoder, ImageError};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

/// What a picture file holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// RGBA, 8 bit, sRGB-encoded.
    Png,
    /// RGBA, 32-bit float, linear.
    Exr,
}

/// A picture that was read.
#[derive(Clone, Debug)]
pub struct Picture {
    /// What it was.
    pub format: Format,
    /// Width and height in pixels.
    pub size: [u32; 2],
    /// Linear RGBA, row by row from the top.
    pub pixels: Vec<[f32; 4]>,
}

/// Why a picture could not be written or read.
#[derive(Debug, thiserror::Error)]
pub enum PictureError {
    /// A name that says nothing of the format.
    #[error("{}: pictures are .png or .exr", .0.display())]
    Extension(PathBuf),
    /// Nowhere to write.
    #[error("{}: there is no directory {}", .file.display(), .directory.display())]
    Directory {
        /// The picture.
        file: PathBuf,
        /// What is missing.
        directory: PathBuf,
    },
    /// The name is taken by a directory.
    #[error("{}: that is a directory", .0.display())]
    Taken(PathBuf),
    /// The pixels do not fill the picture.
    #[error("{}: {got} pixels do not make a picture of {width} x {height}", .file.display())]
    Pixels {
        /// The picture.
        file: PathBuf,
        /// Pixels across.
        width: u32,
        /// Pixels down.
        height: u32,
        /// Pixels given.
        got: usize,
    },
    /// The system refused.
    #[error("{}: {reason}", .file.display())]
    Write {
        /// The picture.
        file: PathBuf,
        /// What the system said.
        reason: io::Error,
    },
    /// A file that is no EXR, or cannot be read.
    #[error("{}: {reason}", .file.display())]
    Read {
        /// The picture.
        file: PathBuf,
        /// What the decoder said.
        reason: ImageError,
    },
    /// The encoder refused.
    #[error("{}: {reason}", .file.display())]
    Encode {
        /// The picture.
        file: PathBuf,
        /// What the encoder said.
        reason: ImageError,
    },
}

/// The format that a name asks for, once it is sure that there is a place for it.
///
/// # Errors
/// An extension other than `.png` and `.exr`, a directory that is not there, a name that is a directory.
pub fn format_of(file: &Path) -> Result<Format, PictureError> {
    let extension = file.extension().and_then(|e| e.to_str()).map(str::to_ascii_lowercase);
    let format = match extension.as_deref() {
        Some("png") => Format::Png,
        Some("exr") => Format::Exr,
        _ => return Err(PictureError::Extension(file.to_owned())),
    };
    if file.is_dir() {
        return Err(PictureError::Taken(file.to_owned()));
    }
    let directory = directory(file);
    if directory.is_dir() {
        Ok(format)
    } else {
        Err(PictureError::Directory { file: file.to_owned(), directory: directory.to_owned() })
    }
}

/// Writes RGBA8 texels, sRGB-encoded, row by row from the top.
///
/// # Errors
/// Where the pixels do not fill the picture, or it cannot be written.
pub fn write_png(file: &Path, size: [u32; 2], texels: &[u8]) -> Result<(), PictureError> {
    check(file, size, texels.len() / 4)?;
    replace(file, |w| PngEncoder::new(w).write_image(texels, size[0], size[1], ExtendedColorType::Rgba8))
}

/// Writes linear RGBA f32 pixels, row by row from the top.
///
/// # Errors
/// Where the pixels do not fill the picture, or it cannot be written.
pub fn write_exr(file: &Path, size: [u32; 2], pixels: &[[f32; 4]]) -> Result<(), PictureError> {
    check(file, size, pixels.len())?;
    let bytes = bytemuck::cast_slice(pixels);
    replace(file, |w| OpenExrEncoder::new(w).write_image(bytes, size[0], size[1], ExtendedColorType::Rgba32F))
}

/// Reads an EXR as linear RGBA f32 pixels, row by row from the top; A is 1 where the file has none.
///
/// # Errors
/// Where the file is not an EXR, or cannot be read.
pub fn read_exr(file: &Path) -> Result<([u32; 2], Vec<[f32; 4]>), PictureError> {
    let failed = |reason: ImageError| PictureError::Read { file: file.to_owned(), reason };
    let reader = std::fs::File::open(file).map_err(|e| failed(ImageError::IoError(e)))?;
    let decoder = OpenExrDecoder::new(io::BufReader::new(reader)).map_err(failed)?;
    let picture = DynamicImage::from_decoder(decoder).map_err(failed)?.into_rgba32f();
    let size = [picture.width(), picture.height()];
    Ok((size, picture.pixels().map(|p| p.0).collect()))
}

/// Reads a picture as linear RGBA f32 pixels, row by row from the top, and says what it was: EXR as it is, PNG decoded from
/// sRGB (8 or 16 bit; alpha is linear).
///
/// # Errors
/// An extension other than `.png` and `.exr`; a file that is not what its name says, or cannot be read.
pub fn read(file: &Path) -> Result<Picture, PictureError> {
    let extension = file.extension().and_then(|e| e.to_str()).map(str::to_ascii_lowercase);
    match extension.as_deref() {
        Some("exr") => read_exr(file).map(|(size, pixels)| Picture { format: Format::Exr, size, pixels }),
        Some("png") => {
            let failed = |reason: ImageError| PictureError::Read { file: file.to_owned(), reason };
            let reader = std::fs::File::open(file).map_err(|e| failed(ImageError::IoError(e)))?;
            let decoder = PngDecoder::new(io::BufReader::new(reader)).map_err(failed)?;
            let picture = DynamicImage::from_decoder(decoder).map_err(failed)?.into_rgba32f();
            let size = [picture.width(), picture.height()];
            let light = |c: f32| tone::decode(f64::from(c)) as f32;
            let pixels = picture.pixels().map(|p| [light(p.0[0]), light(p.0[1]), light(p.0[2]), p.0[3]]).collect();
            Ok(Picture { format: Format::Png, size, pixels })
        }
        _ => Err(PictureError::Extension(file.to_owned())),
    }
}

/// Writes a text beside a picture, whole or not at all.
///
/// # Errors
/// Where it cannot be written.
pub fn write_text(file: &Path, text: &str) -> Result<(), PictureError> {
    replace(file, |w| w.write_all(text.as_bytes()).map_err(ImageError::IoError))
}

/// Writes bytes, pieces one after the other, whole or not at all.
///
/// # Errors
/// Where they cannot be written.
pub fn write_bytes(file: &Path, pieces: &[&[u8]]) -> Result<(), PictureError> {
    replace(file, |w| pieces.iter().try_for_each(|p| w.write_all(p)).map_err(ImageError::IoError))
}

pub(super) fn check(file: &Path, [width, height]: [u32; 2], got: usize) -> Result<(), PictureError> {
    if got as u64 == u64::from(width) * u64::from(height) {
        Ok(())
    } else {
        Err(PictureError::Pixels { file: file.to_owned(), width, height, got })
    }
}

fn directory(file: &Path) -> &Path {
    match file.parent() {
        Some(parent) if !parent.as_os_str().is_empty() => parent,
        _ => Path::new("."),
    }
}

/// Writes under a temporary name beside the file and renames, so that nobody ever reads half a picture.
pub(super) fn replace<F>(file: &Path, encode: F) -> Result<(), PictureError>
where
    F: FnOnce(&mut BufWriter<&mut std::fs::File>) -> Result<(), ImageError>,
{
    let failed = |reason: io::Error| PictureError::Write { file: file.to_owned(), reason };
    let mut builder = tempfile::Builder::new();
    builder.prefix(".pdss-").suffix(".part");
    // Temporary files are their owner's alone unless told otherwise; a picture is as readable as any new file.
    #[cfg(unix)]
    builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
    let mut part = builder.tempfile_in(directory(file)).map_err(failed)?;
    let mut writer = BufWriter::new(part.as_file_mut());
    encode(&mut writer).map_err(|reason| match reason {
        ImageError::IoError(reason) => failed(reason),
        reason => PictureError::Encode { file: file.to_owned(), reason },
    })?;
    writer.flush().map_err(failed)?;
    drop(writer);
    part.persist(file).map_err(|e| failed(e.error))?;
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use image::ImageReader;

    type Outcome = Result<(), Box<dyn std::error::Error>>;

    #[test]
    fn an_exr_keeps_every_bit_of_all_four_channels() -> Outcome {
        let dir = tempfile::tempdir()?;
        let file = dir.path().join("a.exr");
        let pixels: Vec<[f32; 4]> = (0..6)
            .map(|i| {
                let x = i as f32;
                [-x / 3., 1e-30 * x, 3.4e38 / (1. + x), [0., 1., 0.25][i % 3]]
            })
            .collect();
        write_exr(&file, [3, 2], &pixels)?;
        let back = ImageReader::open(&file)?.decode()?.into_rgba32f();
        assert_eq!(back.dimensions(), (3, 2));
        let same =
            |want: &[[f32; 4]]| back.pixels().zip(want).all(|(a, b)| a.0.map(f32::to_bits) == b.map(f32::to_bits));
        assert!(same(&pixels));
        let opaque: Vec<[f32; 4]> = pixels.iter().map(|p| [p[0], p[1], p[2], 1.]).collect();
        assert!(!same(&opaque), "a lost alpha would be seen");
        Ok(())
    }

    #[test]
    fn a_png_keeps_its_bytes_and_replaces_its_elder() -> Outcome {
        let dir = tempfile::tempdir()?;
        let file = dir.path().join("a.PNG");
        write_png(&file, [1, 1], &[9; 4])?;
        let texels: Vec<u8> = (0..24).map(|i| i * 10).collect();
        write_png(&file, [2, 3], &texels)?;
        assert_eq!(ImageReader::open(&file)?.decode()?.into_rgba8().into_raw(), texels);
        assert_eq!(std::fs::read_dir(dir.path())?.count(), 1, "nothing temporary is left");
        Ok(())
    }

    #[test]
    fn what_cannot_be_written_is_said_and_leaves_nothing() -> Outcome {
        let dir = tempfile::tempdir()?;
        let path = |name: &str| dir.path().join(name);
        assert!(matches!(format_of(&path("a.jpg")), Err(PictureError::Extension(_))));
        assert!(matches!(format_of(&path("png")), Err(PictureError::Extension(_))));
        assert!(matches!(format_of(&path("no/a.png")), Err(PictureError::Directory { .. })));
        std::fs::create_dir(path("d.png"))?;
        assert!(matches!(format_of(&path("d.png")), Err(PictureError::Taken(_))));
        assert_eq!(format_of(Path::new("a.exr"))?, Format::Exr);
        assert!(matches!(write_png(&path("a.png"), [2, 2], &[0; 4]), Err(PictureError::Pixels { got: 1, .. })));
        assert!(matches!(write_exr(&path("no/a.exr"), [1, 1], &[[0.; 4]]), Err(PictureError::Write { .. })));
        assert!(!path("a.png").exists());
        Ok(())
    }
}
