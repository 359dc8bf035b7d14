//! What a frame reads of one profile: constants and tables. Of several profiles each has its own.

use super::constants::Constants;
use super::setup::Setup;
use super::upload::{Pixels, Upload, constants, texels};
use super::{FrameError, Inputs, environment, table};
use crate::gpu::pass::Bound;
use crate::gpu::{Buffer, Gpu, Image, Sampler};
use crate::settings::Method;
use crate::skin::profile::Profile;
use crate::skin::{self, penumbra};
use ash::vk;
use std::sync::Arc;

/// Names that [`Inside::find`] knows.
pub const NAMES: &[&str] = &["frame", "lut", "penumbra", "kernel", "gutter", "environment", "bands"];

/// Constants and tables of a profile.
pub struct Inside {
    frame: Buffer,
    kernel: Option<Buffer>,
    gutter: Option<Buffer>,
    lut: Option<Image>,
    lut_knee: f32,
    penumbra: Option<Image>,
    sky: Option<(Buffer, Image)>,
}

impl Inside {
    /// Of one setup; `sky` is what is known of the sky of the scene, and `most` the most irradiance that comes from all around.
    ///
    /// # Errors
    /// Where memory or the driver gives out.
    pub fn new(
        gpu: &Arc<Gpu>,
        uploads: &mut Upload,
        inputs: &Inputs<'_>,
        s: &Setup,
        sky: Option<&environment::Bands>,
        most: f32,
    ) -> Result<Inside, FrameError> {
        let profile = inputs.profiles.get(s.profile);
        let forward = s.settings.method == Method::Preintegrated && s.diffuses;
        let lut = (forward || s.settings.method == Method::Pdss && !s.levels.levels.is_empty())
            .then(|| profile.map(|p| table::kept(gpu.store(), p, s.settings.integral.into())))
            .flatten();
        let lut_knee = lut.as_ref().map_or(1., |l| l.knee_per_mm as f32);
        let lut_pixels = lut.as_ref().map(|l| {
            let (size, halves) = l.planes();
            let bytes: Vec<u8> = halves.iter().flat_map(|h| h.to_le_bytes()).collect();
            texels("lut", vk::Format::R16_SFLOAT, size, &bytes)
        });
        let penumbra = match (profile, s.kernel.first()) {
            (Some(profile), Some(row)) if forward => {
                let bytes: Vec<u8> = penumbra::table(profile, row[3]).iter().flat_map(|h| h.to_le_bytes()).collect();
                Some(uploads.image(texels("penumbra", vk::Format::R16G16B16A16_SFLOAT, penumbra::SIZE, &bytes))?)
            }
            _ => None,
        };
        let storage = vk::BufferUsageFlags::STORAGE_BUFFER;
        let gutter = (!s.gutter.is_empty())
            .then(|| uploads.buffer("gutter", bytemuck::cast_slice(&s.gutter), storage))
            .transpose()?;
        let sky = sky.zip(inputs.scene.environment.as_deref()).map(|(sky, environment)| {
            let block = environment::block(environment, sky, inputs, profile);
            let uniform = vk::BufferUsageFlags::UNIFORM_BUFFER;
            let block = constants(gpu, "environment", bytemuck::bytes_of(&block), uniform)?;
            Ok::<_, FrameError>((block, uploads.image(bands(profile))?))
        });
        let Constants { frame, kernel } = Constants::of(inputs, s, lut_knee, most);
        let kernel = (!kernel.is_empty()).then(|| constants(gpu, "kernel", bytemuck::cast_slice(&kernel), storage));
        Ok(Inside {
            frame: constants(gpu, "frame", bytemuck::bytes_of(&frame), vk::BufferUsageFlags::UNIFORM_BUFFER)?,
            kernel: kernel.transpose()?,
            gutter,
            lut: lut_pixels.map(|p| uploads.image(p)).transpose()?,
            lut_knee,
            penumbra,
            sky: sky.transpose()?,
        })
    }

    /// Writes the constants of another eye or other lights.
    ///
    /// # Errors
    /// Where a buffer is not the host's to write.
    pub fn rewrite(
        &mut self,
        inputs: &Inputs<'_>,
        s: &Setup,
        sky: Option<&environment::Bands>,
        most: f32,
    ) -> Result<(), FrameError> {
        let Constants { frame, kernel } = Constants::of(inputs, s, self.lut_knee, most);
        self.frame.write(bytemuck::bytes_of(&frame))?;
        if let Some(buffer) = &mut self.kernel {
            buffer.write(bytemuck::cast_slice(&kernel))?;
        }
        if let (Some((block, _)), Some(sky), Some(environment)) =
            (&mut self.sky, sky, inputs.scene.environment.as_deref())
        {
            let of = environment::block(environment, sky, inputs, inputs.profiles.get(s.profile));
            block.write(bytemuck::bytes_of(&of))?;
        }
        Ok(())
    }

    /// The resource behind a name of [`NAMES`].
    pub fn find<'a>(&'a self, name: &str, linear: &'a Sampler) -> Option<Bound<'a>> {
        let table = |image: &'a Option<Image>| image.as_ref().map(|i| Bound::Sampled(i, linear));
        match name {
            "frame" => Some(Bound::Buffer(&self.frame)),
            "kernel" => self.kernel.as_ref().map(Bound::Buffer),
            "gutter" => self.gutter.as_ref().map(Bound::Buffer),
            "lut" => table(&self.lut),
            "penumbra" => table(&self.penumbra),
            "environment" => self.sky.as_ref().map(|s| Bound::Buffer(&s.0)),
            "bands" => self.sky.as_ref().map(|s| Bound::Sampled(&s.1, linear)),
            _ => None,
        }
    }
}

/// The table of what scattering leaves of the sky's bands.
fn bands(profile: Option<&Profile>) -> Pixels {
    let gaussians = profile.map_or(Vec::new(), |p| p.gaussians().gaussians);
    let rows = skin::sky::table(&gaussians, skin::sky::knee(&gaussians));
    let halves: Vec<half::f16> = rows.iter().flatten().map(|x| half::f16::from_f32(*x)).collect();
    let size = [skin::sky::TABLE as u32, 2];
    texels("bands", vk::Format::R16G16B16A16_SFLOAT, size, bytemuck::cast_slice(&halves))
}
