//! Images and textures of a file, decoded in parallel, each image once.

use std::io::Cursor;
use std::path::Path;

use image::error::ImageError;
use image::{ImageReader, Limits, RgbaImage};
use rayon::prelude::*;

use super::accessor::{Budget, View};
use super::basis;
use super::container::{decode_base64, read_uri};
use super::json::At;
use crate::scene::error::Fault;
use crate::scene::material::{Filter, Texture, Wrap};

/// Longest side of an image.
pub(super) const MAX_SIDE: u32 = 32_768;
/// What decoding may allocate besides 16 times the encoded bytes.
const MEMORY_FLOOR: u64 = 256 << 20;

/// A texture of the file.
pub(super) struct TextureSource {
    name: String,
    /// Index into the file's `images`; `None` where only an extension names one.
    pub image: Option<usize>,
    wrap: [Wrap; 2],
    filter: Filter,
}

/// All textures of the file.
pub(super) fn read_textures(root: &At) -> Result<Vec<TextureSource>, Fault> {
    let samplers: Vec<_> = root.list("samplers")?.iter().map(read_sampler).collect::<Result<_, _>>()?;
    let images = root.list("images")?;
    let mut textures = Vec::new();
    for (index, at) in root.list("textures")?.iter().enumerate() {
        let other = |name: &str| match at.extension(name)? {
            Some(of) => of.index("source", images.len(), "images"),
            None => Ok(None),
        };
        // Basis Universal loses most, so anything that stands beside it comes first.
        let [webp, basis] = ["EXT_texture_webp", "KHR_texture_basisu"].map(other);
        let image = webp?.or(at.index("source", images.len(), "images")?).or(basis?);
        let sampler = at.index("sampler", samplers.len(), "samplers")?;
        let (wrap, filter) = match sampler {
            Some(sampler) => samplers[sampler],
            None => ([Wrap::Repeat; 2], Filter::Linear),
        };
        let mut names = vec![at.text("name")?];
        if let Some(image) = image {
            names.push(images[image].text("name")?);
            names.push(images[image].text("uri")?.filter(|uri| !uri.starts_with("data:")));
        }
        let name = names.into_iter().flatten().find(|name| !name.is_empty());
        textures.push(TextureSource {
            name: name.map_or_else(|| format!("texture {index}"), str::to_owned),
            image,
            wrap,
            filter,
        });
    }
    Ok(textures)
}

fn read_sampler(at: &At) -> Result<([Wrap; 2], Filter), Fault> {
    let wrap = |key: &str| match at.uint(key)? {
        None | Some(10497) => Ok(Wrap::Repeat),
        Some(33071) => Ok(Wrap::Clamp),
        Some(33648) => Ok(Wrap::Mirror),
        Some(other) => Err(Fault::new(at.place(key), format!("there is no mode {other}; 33071, 33648 and 10497 are"))),
    };
    let filter = match at.uint("magFilter")? {
        Some(9728) => Filter::Nearest,
        None | Some(9729) => Filter::Linear,
        Some(other) => {
            return Err(Fault::new(at.place("magFilter"), format!("there is no filter {other}; 9728 and 9729 are")));
        }
    };
    Ok(([wrap("wrapS")?, wrap("wrapT")?], filter))
}

/// A decoded image, or why this program cannot decode its kind.
pub(super) type Decoded = Result<RgbaImage, String>;

/// Decodes the images with these indices; the others stay `None`.
pub(super) fn decode_images(
    root: &At,
    wanted: &[bool],
    views: &[View],
    folder: &Path,
) -> Result<Vec<Option<Decoded>>, Fault> {
    let images = root.list("images")?;
    images
        .par_iter()
        .zip(wanted)
        .map(|(at, &wanted)| {
            if !wanted {
                return Ok(None);
            }
            match at.index("bufferView", views.len(), "bufferViews")? {
                Some(view) => decode(at, views[view].bytes).map(Some),
                None => decode(at, &read_bytes(at, folder)?).map(Some),
            }
        })
        .collect()
}

fn read_bytes(at: &At, folder: &Path) -> Result<Vec<u8>, Fault> {
    let uri = at.required(at.text("uri")?, "uri")?;
    let bytes = match uri.strip_prefix("data:").and_then(|d| d.split_once(";base64,")) {
        Some((_, body)) => decode_base64(body.as_bytes()),
        None => read_uri(uri, folder, None),
    };
    bytes.map_err(|reason| Fault::new(at.place("uri"), reason))
}

/// Decodes one image. A kind that is not compiled in is no fault of the file; damage is.
fn decode(at: &At, bytes: &[u8]) -> Result<Decoded, Fault> {
    let mut limits = Limits::default();
    limits.max_image_width = Some(MAX_SIDE);
    limits.max_image_height = Some(MAX_SIDE);
    let most = (bytes.len() as u64).saturating_mul(16) + MEMORY_FLOOR;
    limits.max_alloc = Some(most);
    let unknown = |kind: &str| {
        let place = at.path();
        Ok(Err(format!("{place}: {kind} cannot be decoded; its texture is left out")))
    };
    if basis::is_ktx2(bytes) {
        return basis::decode(at, bytes, most);
    }
    let mut reader = match ImageReader::new(Cursor::new(bytes)).with_guessed_format() {
        Ok(reader) => reader,
        Err(e) => return Err(Fault::new(at.path(), e.to_string())),
    };
    let Some(format) = reader.format() else {
        return unknown("this kind of image");
    };
    reader.limits(limits);
    match reader.decode() {
        Ok(image) => Ok(Ok(image.into_rgba8())),
        Err(ImageError::Unsupported(_)) => unknown(&format!("{format:?}")),
        Err(e) => Err(Fault::new(at.path(), format!("damaged image: {e}"))),
    }
}

impl TextureSource {
    /// The texture made from its decoded image.
    pub fn build(&self, image: &RgbaImage, srgb: bool, budget: &mut Budget) -> Result<Texture, Fault> {
        budget.take(&format!("texture '{}'", self.name), image.as_raw().len(), 1)?;
        Ok(Texture {
            name: self.name.clone(),
            width: image.width(),
            height: image.height(),
            rgba8: image.as_raw().clone(),
            srgb,
            wrap: self.wrap,
            filter: self.filter,
        })
    }
}
