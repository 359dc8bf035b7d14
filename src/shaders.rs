//! The shaders, as the build compiled them: code and everything the host must know, read from the SPIR-V itself.

use ash::vk;

/// Which stage of the pipeline a module is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ShaderStage {
    /// A compute kernel.
    Compute,
    /// A vertex shader.
    Vertex,
    /// A fragment shader.
    Fragment,
}

/// What a binding binds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BindingKind {
    /// An image read and written by texel.
    StorageImage,
    /// An image with its sampler.
    SampledImage,
    /// A uniform buffer.
    Uniform,
    /// A storage buffer.
    Storage,
}

/// One resource of a shader; it is bound by its name.
#[derive(Clone, Copy, Debug)]
pub struct Binding {
    /// The variable's name in GLSL: the name of the target or buffer bound to it.
    pub name: &'static str,
    /// Binding number in set 0.
    pub binding: u32,
    /// What it binds.
    pub kind: BindingKind,
    /// The shader reads it.
    pub read: bool,
    /// The shader writes it.
    pub write: bool,
    /// Declared texel format of a storage image; UNDEFINED where it has none. Of a sampled one R32_UINT for integers, else UNDEFINED.
    pub format: vk::Format,
}

/// The layout of one block, or of a struct inside one, as the compiler laid it out.
#[derive(Clone, Copy, Debug)]
pub struct Block {
    /// Name of the block's type.
    pub name: &'static str,
    /// Bytes, without a trailing runtime array.
    pub size: u32,
    /// Name and byte offset of each member.
    pub members: &'static [(&'static str, u32)],
}

/// One compiled module.
#[derive(Debug)]
pub struct Shader {
    /// Name in this table.
    pub name: &'static str,
    /// File stem under `glsl/`.
    pub stem: &'static str,
    /// Stage.
    pub stage: ShaderStage,
    /// SPIR-V, little endian.
    pub code: &'static [u8],
    /// The same, made by the build to sample the images that this one loads; none where it loads none.
    pub sampled: Option<&'static Shader>,
    /// The fragment shader, made by the build, that does the same over tiles; none where a stage stores to what it reads.
    pub fragment: Option<&'static Shader>,
    /// Threads of a workgroup.
    pub workgroup: [u32; 3],
    /// Bytes of push constants.
    pub push_size: u32,
    /// Resources, by binding number.
    pub bindings: &'static [Binding],
    /// Outputs by location: the names of the targets that are attached.
    pub outputs: &'static [&'static str],
    /// Specialization constants: name and id. Those that the optimiser removed are absent.
    pub constants: &'static [(&'static str, u32)],
    /// Blocks with their member offsets, each followed by the structs inside it.
    pub blocks: &'static [Block],
}

/// A module is the one of its name.
impl PartialEq for Shader {
    fn eq(&self, other: &Shader) -> bool {
        self.name == other.name
    }
}

include!(concat!(env!("OUT_DIR"), "/shaders.rs"));
