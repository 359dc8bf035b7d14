//! Materials and textures as the renderer needs them: factors, texture slots, alpha, and which profile scatters.

/// The surface of a draw: glTF's metallic-roughness model.
#[derive(Clone, Debug, PartialEq)]
pub struct Material {
    /// Name in the file, or `material N` for the N-th without a name.
    pub name: String,
    /// Linear RGBA, 0..1; multiplies the texture.
    pub base_color: [f32; 4],
    /// 0 dielectric .. 1 metal; multiplies the texture's blue.
    pub metallic: f32,
    /// Perceptual roughness 0..1 (GGX alpha is its square); multiplies the texture's green.
    pub roughness: f32,
    /// Index into [`Scene::textures`](super::Scene::textures), sRGB.
    pub base_color_texture: Option<usize>,
    /// Index into the textures, linear: G roughness, B metallic.
    pub metallic_roughness_texture: Option<usize>,
    /// Index into the textures, linear, tangent space; and the factor on its x and y.
    pub normal_texture: Option<(usize, f32)>,
    /// Index into the textures, linear, R; and the strength 0..1.
    pub occlusion_texture: Option<(usize, f32)>,
    /// How alpha is read.
    pub alpha: Alpha,
    /// Whether back faces are drawn, with the normal turned towards the viewer.
    pub double_sided: bool,
    /// Index of refraction, at least 1, or 0 for a surface that reflects all (KHR_materials_ior); 1.5 if not given, and then that of the
    /// profile where one is assigned.
    pub ior: f32,
    /// Linear radiance that it gives off, not negative; multiplies the texture.
    pub emission: [f32; 3],
    /// Index into the textures, sRGB.
    pub emission_texture: Option<usize>,
    /// Its base colour is what is seen, whatever the light (KHR_materials_unlit).
    pub unlit: bool,
    /// Whether the file says that light passes into the surface and comes out diffusely
    /// (KHR_materials_diffuse_transmission with a factor above 0).
    pub translucent: bool,
    /// How light goes on inside, where the file says so.
    pub scattering: Option<Scattering>,
    /// Part of the reflectance at normal incidence that the index of refraction gives, 0..1 (KHR_materials_specular).
    pub specular: f32,
    /// Index into the caller's list of profiles; `None` does not scatter. Loaders leave it `None`.
    pub scatter: Option<usize>,
}

impl Material {
    /// Index of refraction where a file states none.
    pub const DEFAULT_IOR: f32 = 1.5;

    /// A white dielectric of medium roughness, untextured and opaque. (glTF's own default is a metal.)
    pub fn new(name: &str) -> Self {
        Self {
            name: name.to_owned(),
            base_color: [1.0; 4],
            metallic: 0.0,
            roughness: 0.5,
            base_color_texture: None,
            metallic_roughness_texture: None,
            normal_texture: None,
            occlusion_texture: None,
            alpha: Alpha::Opaque,
            double_sided: false,
            ior: Self::DEFAULT_IOR,
            emission: [0.0; 3],
            emission_texture: None,
            unlit: false,
            translucent: false,
            scattering: None,
            specular: 1.0,
            scatter: None,
        }
    }

    /// Whether light enters the surface and may come out elsewhere: lit, not blended, and rather dielectric than metal.
    pub fn is_opaque_dielectric(&self) -> bool {
        self.alpha != Alpha::Blend && self.metallic < 0.5 && !self.unlit
    }

    /// Whether it is drawn, or drawn again, over the lit picture: blended, unlit, or giving off light.
    pub fn is_overlaid(&self) -> bool {
        self.alpha == Alpha::Blend || self.unlit || self.emission.iter().any(|e| *e > 0.0)
    }

    /// Whether any texture is read, so that UVs are needed.
    pub fn is_textured(&self) -> bool {
        self.base_color_texture.is_some()
            || self.metallic_roughness_texture.is_some()
            || self.normal_texture.is_some()
            || self.occlusion_texture.is_some()
            || self.emission_texture.is_some()
    }
}

/// The inside of a material as glTF has it (KHR_materials_volume and its companions).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scattering {
    /// mm after which white light has the colour `attenuation`; above 0, finite.
    pub distance_mm: f64,
    /// Linear RGB, 0..1, below 1.
    pub attenuation: [f64; 3],
    /// What comes back after all scattering, linear RGB, 0..1.
    pub multiscatter: [f64; 3],
    /// Mean cosine of the phase function, -1..1.
    pub anisotropy: f64,
}

/// What the alpha channel of the base colour means.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Alpha {
    /// Ignored.
    Opaque,
    /// Below this cutoff (0..1) the surface is absent.
    Mask(f32),
    /// Coverage, blended over what lies behind.
    Blend,
}

/// An image decoded to memory, with how it is sampled. One file used both as colour and as data becomes two textures.
#[derive(Clone, Debug, PartialEq)]
pub struct Texture {
    /// Name in the file, else its URI, else `texture N`.
    pub name: String,
    /// Pixels across, at least 1.
    pub width: u32,
    /// Pixels down, at least 1; row 0 is v = 0.
    pub height: u32,
    /// 4 bytes a pixel, row by row from the top, alpha not premultiplied.
    pub rgba8: Vec<u8>,
    /// Whether RGB is sRGB-encoded (used as colour) rather than linear data.
    pub srgb: bool,
    /// Addressing in u and v.
    pub wrap: [Wrap; 2],
    /// Magnification filter; minification is the renderer's choice.
    pub filter: Filter,
}

/// What a texture coordinate outside 0..1 reads.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Wrap {
    /// The tile next door.
    Repeat,
    /// The tile next door, mirrored.
    Mirror,
    /// The edge.
    Clamp,
}

/// How texels are joined when magnified.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Filter {
    /// Interpolated.
    Linear,
    /// The one that holds the point.
    Nearest,
}
