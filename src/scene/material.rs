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
    /// How much of a dielectric's gloss there is, and of which colour.
    pub specular: Specular,
    /// A clear varnish over everything else.
    pub coat: Coat,
    /// Fibres that glow where they are seen edge on, between coat and surface.
    pub sheen: Sheen,
    /// Share of the light that scatters inside where the material has a profile, 0..1; the rest leaves where it enters
    /// (KHR_materials_diffuse_transmission's factor).
    pub scatter_mask: f32,
    /// Index into the textures, linear, A: multiplies the share.
    pub scatter_mask_texture: Option<usize>,
    /// How thick the body is under the surface, mm; 0: the file does not say (KHR_materials_volume).
    pub thickness_mm: f32,
    /// Index into the textures, linear, G: multiplies the thickness.
    pub thickness_texture: Option<usize>,
    /// A bit for each [`MAPS`] entry whose texture reads the scene's second coordinates.
    pub second_uvs: u32,
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
            specular: Specular { factor: 1.0, color: [1.0; 3], factor_texture: None, color_texture: None },
            coat: Coat::default(),
            sheen: Sheen::default(),
            scatter_mask: 1.0,
            scatter_mask_texture: None,
            thickness_mm: 0.0,
            thickness_texture: None,
            second_uvs: 0,
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
        self.maps().iter().any(Option::is_some)
    }

    /// Whether its gloss is more than one plain dielectric's or metal's: a coat, sheen, a weight or a colour of its own.
    pub fn is_coated(&self) -> bool {
        let Specular { factor, color, .. } = self.specular;
        self.coat.factor > 0.0 || self.sheen.color.iter().any(|c| *c > 0.0) || factor != 1.0 || color != [1.0; 3]
    }

    /// Whether anything is reflected at its surface. Nothing is where a dielectric's gloss has the factor 0, which takes what is
    /// reflected edge on, too, and neither coat nor sheen lies over it. An index of refraction of 1 leaves that, as in glTF.
    pub fn reflects(&self) -> bool {
        self.metallic > 0.0
            || self.specular.factor > 0.0
            || self.coat.factor > 0.0
            || self.sheen.color.iter().any(|c| *c > 0.0)
    }

    /// Its textures, in the order of [`MAPS`].
    pub fn maps(&self) -> [Option<usize>; MAPS.len()] {
        [
            self.base_color_texture,
            self.metallic_roughness_texture,
            self.normal_texture.map(|t| t.0),
            self.occlusion_texture.map(|t| t.0),
            self.emission_texture,
            self.scatter_mask_texture,
            self.thickness_texture,
            self.coat.factor_texture,
            self.coat.roughness_texture,
            self.sheen.color_texture,
            self.sheen.roughness_texture,
            self.specular.factor_texture,
            self.specular.color_texture,
        ]
    }
}

/// Textures of a material, in one order for all who count them: the shaders' name, and the constant that says it is there.
pub const MAPS: [(&str, &str); 13] = [
    ("base_color_map", "BASE_MAP"),
    ("metallic_roughness_map", "ROUGH_MAP"),
    ("normal_map", "NORMAL_MAP"),
    ("occlusion_map", "OCCLUSION_MAP"),
    ("emission_map", "EMISSION_MAP"),
    ("scatter_map", "SCATTER_MAP"),
    ("thickness_map", "THICKNESS_MAP"),
    ("coat_map", "COAT_MAP"),
    ("coat_roughness_map", "COAT_ROUGH_MAP"),
    ("sheen_map", "SHEEN_MAP"),
    ("sheen_roughness_map", "SHEEN_ROUGH_MAP"),
    ("specular_map", "SPECULAR_MAP"),
    ("specular_color_map", "SPECULAR_COLOR_MAP"),
];

/// A dielectric's gloss beside its index of refraction (KHR_materials_specular).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Specular {
    /// Factor on all of it, 0..1.
    pub factor: f32,
    /// Factor on the reflectance at normal incidence, linear RGB, not negative; what comes out is held to 1.
    pub color: [f32; 3],
    /// Index into the textures, linear, A.
    pub factor_texture: Option<usize>,
    /// Index into the textures, sRGB.
    pub color_texture: Option<usize>,
}

/// A clear varnish of F0 .04, not bent by normal maps (KHR_materials_clearcoat).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Coat {
    /// Share of the surface that has it, 0..1.
    pub factor: f32,
    /// Perceptual roughness, 0..1.
    pub roughness: f32,
    /// Index into the textures, linear, R.
    pub factor_texture: Option<usize>,
    /// Index into the textures, linear, G.
    pub roughness_texture: Option<usize>,
}

/// Sheen of fibres (KHR_materials_sheen).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Sheen {
    /// Linear RGB, 0..1; black: there is none.
    pub color: [f32; 3],
    /// Perceptual roughness, 0..1.
    pub roughness: f32,
    /// Index into the textures, sRGB.
    pub color_texture: Option<usize>,
    /// Index into the textures, linear, A.
    pub roughness_texture: Option<usize>,
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
