//! OpenEXR files of one layer or many, with a record of how they were made. All layers are channels of one part, named as is
//! usual, `layer.R`; the picture itself is R, G, B and A. What other programs show of a file that they only half understand is
//! then the picture.

use super::picture::{PictureError, check, replace};
use crate::frame::Inputs;
use crate::gpu::DeviceInfo;
use crate::skin::profile::Profile;
use exr::meta::attribute::AttributeValue;
use exr::prelude::{
    AnyChannel, AnyChannels, Encoding, FlatSamples, Image, ImageAttributes, Layer as Part, LayerAttributes, Text, Vec2,
    WritableImage,
};
use image::ImageError;
use image::error::{EncodingError, ImageFormatHint};
use std::path::Path;

/// One of a file's pictures.
pub struct Layer {
    /// Its name; empty for the picture itself.
    name: String,
    /// Names and texels of its channels, row by row from the top.
    channels: Vec<(&'static str, Vec<f32>)>,
}

impl Layer {
    /// The picture itself, R, G, B, A.
    pub fn picture(pixels: &[[f32; 4]]) -> Layer {
        Layer { name: String::new(), channels: planes(pixels, &["R", "G", "B", "A"]) }
    }

    /// A named layer of 1 to 3 numbers a pixel: R, or R and G, or R, G and B. The picture's A says where any of them means
    /// something.
    pub fn named(name: &str, numbers: usize, pixels: &[[f32; 4]]) -> Layer {
        Layer { name: name.to_owned(), channels: planes(pixels, &["R", "G", "B"][..numbers.clamp(1, 3)]) }
    }
}

fn planes(pixels: &[[f32; 4]], names: &[&'static str]) -> Vec<(&'static str, Vec<f32>)> {
    names.iter().enumerate().map(|(i, name)| (*name, pixels.iter().map(|p| p[i]).collect())).collect()
}

/// How a picture was made: attributes of the file, by name.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Made(pub Vec<(&'static str, String)>);

impl Made {
    /// Everything that decides a picture. `scene` and `profile` as they were named; settings are JSON, the camera and the lights
    /// as the program prints them.
    pub fn of(scene: &str, inputs: &Inputs<'_>, device: &DeviceInfo) -> Made {
        let name = |v: Option<clap::builder::PossibleValue>| v.map_or_else(String::new, |v| v.get_name().to_owned());
        let settings = &inputs.settings;
        let environment = inputs
            .scene
            .environment
            .as_ref()
            .map(|e| format!("{}, rotation {} degrees, intensity {}", e.name, e.rotation_deg, e.intensity));
        let mut list = vec![
            ("pdss:scene", scene.to_owned()),
            ("pdss:method", name(clap::ValueEnum::to_possible_value(&settings.method))),
            ("pdss:quality", name(clap::ValueEnum::to_possible_value(&settings.quality))),
            ("pdss:profile", Profile::joined(&inputs.profiles)),
            ("pdss:settings", serde_json::to_string(settings).unwrap_or_default()),
            ("pdss:camera", format!("{:?}", inputs.camera)),
            ("pdss:lights", format!("{:?}", inputs.lights)),
            ("pdss:version", env!("CARGO_PKG_VERSION").to_owned()),
            ("pdss:device", device.name.clone()),
            ("pdss:driver", device.driver.clone()),
        ];
        list.extend(environment.map(|e| ("pdss:environment", e)));
        list.extend(option_env!("PDSS_COMMIT").map(|c| ("pdss:commit", c.to_owned())));
        Made(list)
    }
}

/// Writes linear 32-bit layers, whole or not at all.
///
/// # Errors
/// Where a layer does not fill the picture, two channels have one name, or the file cannot be written.
pub fn write(file: &Path, size: [u32; 2], layers: &[Layer], made: &Made) -> Result<(), PictureError> {
    let mut channels = Vec::new();
    for layer in layers {
        for (channel, texels) in &layer.channels {
            check(file, size, texels.len())?;
            let name = if layer.name.is_empty() { (*channel).to_owned() } else { format!("{}.{channel}", layer.name) };
            channels.push(AnyChannel::new(text(&name), FlatSamples::F32(texels.clone())));
        }
    }
    let mut attributes = LayerAttributes { software_name: Some(text("pdss")), ..LayerAttributes::default() };
    for (name, value) in &made.0 {
        attributes.other.insert(text(name), AttributeValue::Text(text(value)));
    }
    let [width, height] = size.map(|x| x as usize);
    let part = Part::new(Vec2(width, height), attributes, Encoding::SMALL_LOSSLESS, AnyChannels::sort(channels.into()));
    let image = Image::new(ImageAttributes::with_size(Vec2(width, height)), part);
    replace(file, |w| {
        let failed = |e: exr::error::Error| match e {
            exr::error::Error::Io(e) => ImageError::IoError(e),
            e => ImageError::Encoding(EncodingError::new(ImageFormatHint::Name("OpenEXR".into()), e)),
        };
        image.write().to_buffered(w).map_err(failed)
    })
}

/// The file's texts are bytes; what is not ASCII is put as a question mark.
fn text(s: &str) -> Text {
    Text::from(s.chars().map(|c| if c.is_ascii() && c != '\0' { c } else { '?' }).collect::<String>().as_str())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::picture;
    use exr::prelude::{ReadChannels, ReadLayers, read};

    type Outcome = Result<(), Box<dyn std::error::Error>>;

    fn ramp(scale: f32) -> Vec<[f32; 4]> {
        (0..6).map(|i| [-1., 1e-30, 3e38, 0.5].map(|x| x * scale * i as f32 / 6.)).collect()
    }

    #[test]
    fn layers_come_back_by_name_to_the_bit_with_how_they_were_made() -> Outcome {
        let dir = tempfile::tempdir()?;
        let file = dir.path().join("a.exr");
        let (picture, normal, depth) = (ramp(1.), ramp(0.3), ramp(0.7));
        let layers = [Layer::named("normal", 3, &normal), Layer::picture(&picture), Layer::named("depth", 1, &depth)];
        let made = Made(vec![("pdss:scene", "a b\u{e9}".to_owned()), ("pdss:method", "moments".to_owned())]);
        write(&file, [3, 2], &layers, &made)?;
        let image = read()
            .no_deep_data()
            .largest_resolution_level()
            .all_channels()
            .first_valid_layer()
            .all_attributes()
            .from_file(&file)?;
        let part = image.layer_data;
        let names: Vec<String> = part.channel_data.list.iter().map(|c| c.name.to_string()).collect();
        assert_eq!(names, ["A", "B", "G", "R", "depth.R", "normal.B", "normal.G", "normal.R"]);
        let bits = |name: &str| -> Vec<u32> {
            let channel = part.channel_data.list.iter().find(|c| c.name.eq(name)).expect("there");
            channel.sample_data.values_as_f32().map(f32::to_bits).collect()
        };
        let want = |p: &[[f32; 4]], i: usize| p.iter().map(|x| x[i].to_bits()).collect::<Vec<_>>();
        for (name, of, i) in [
            ("R", &picture, 0),
            ("A", &picture, 3),
            ("normal.G", &normal, 1),
            ("normal.B", &normal, 2),
            ("depth.R", &depth, 0),
        ] {
            assert_eq!(bits(name), want(of, i), "{name}");
        }
        assert_ne!(bits("normal.R"), want(&picture, 0), "layers are told apart");
        let attribute = |name: &str| part.attributes.other.get(&Text::from(name)).cloned();
        assert_eq!(attribute("pdss:method"), Some(AttributeValue::Text(Text::from("moments"))));
        assert_eq!(attribute("pdss:scene"), Some(AttributeValue::Text(Text::from("a b?"))));
        // A reader that knows of no layers sees the picture.
        let (size, plain) = picture::read_exr(&file)?;
        assert_eq!((size, plain), ([3, 2], picture));
        assert_eq!(std::fs::read_dir(dir.path())?.count(), 1, "nothing temporary is left");
        assert!(write(&file, [3, 3], &layers, &made).is_err(), "too few texels");
        Ok(())
    }
}
