//! Compiles `glsl/` with glslang and assembles `.spvasm`, warnings being errors, and writes a typed table of the shaders:
//! a misspelt shader does not compile, and everything the host must know of one (bindings by name, access, workgroup,
//! specialization constants, member offsets) is read from its SPIR-V.

use rspirv::dr::{Instruction, Module, Operand};
use rspirv::spirv::{Decoration, Dim, ExecutionMode, ImageFormat, Op, StorageClass};
use std::collections::{BTreeMap, HashMap};
use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::{env, fs};

#[path = "glsl/fragment.rs"]
mod fragment;
#[path = "glsl/sampled.rs"]
mod sampled;

fn main() {
    let root = PathBuf::from(env::var("CARGO_MANIFEST_DIR").expect("cargo sets CARGO_MANIFEST_DIR")).join("glsl");
    let out = PathBuf::from(env::var("OUT_DIR").expect("cargo sets OUT_DIR"));
    for folder in [root.clone(), root.join("common")] {
        let files = fs::read_dir(&folder).expect("it is there").flatten().map(|e| e.path());
        // Not for its guides.
        let files = files.filter(|f| f.is_file() && f.extension().is_none_or(|e| e != "md"));
        files.for_each(|f| println!("cargo:rerun-if-changed={}", f.display()));
    }
    println!("cargo:rerun-if-changed=build.rs");
    let mut files: Vec<PathBuf> = fs::read_dir(&root).expect("glsl/ is there").flatten().map(|e| e.path()).collect();
    files.sort();
    let mut table = String::new();
    let mut all = String::new();
    for file in files {
        for shader in compile(&file, &root) {
            let name = &shader.name;
            let words: Vec<u8> = shader.words.iter().flat_map(|w| w.to_le_bytes()).collect();
            fs::write(out.join(format!("{name}.spv")), words).expect("OUT_DIR is writable");
            writeln!(table, "{}", shader.rust()).expect("writing to a string");
            write!(all, "&{name}, ").expect("writing to a string");
        }
    }
    writeln!(table, "/// Every shader of the crate.\npub static ALL: &[&Shader] = &[{all}];")
        .expect("writing to a string");
    fs::write(out.join("shaders.rs"), table).expect("OUT_DIR is writable");
}

struct Compiled {
    name: String,
    stem: String,
    stage: &'static str,
    words: Vec<u32>,
    /// The module that samples what this one loads, where there is such.
    sampled: Option<String>,
    /// The fragment shader that does the same, where there is such.
    fragment: Option<String>,
    reflection: Reflection,
}

/// All variants of one file. A line `// variants: a X=0; b X=1 Y=2` near its head asks for one module a variant.
fn compile(file: &Path, root: &Path) -> Vec<Compiled> {
    let stem = file.file_stem().and_then(|s| s.to_str()).unwrap_or_default().to_owned();
    let upper = stem.to_uppercase().replace('-', "_");
    let (kind, stage, suffix) = match file.extension().and_then(|e| e.to_str()) {
        Some("comp") => (shaderc::ShaderKind::Compute, "Compute", ""),
        Some("vert") => (shaderc::ShaderKind::Vertex, "Vertex", "_VERT"),
        Some("frag") => (shaderc::ShaderKind::Fragment, "Fragment", "_FRAG"),
        Some("spvasm") => {
            let text = fs::read_to_string(file).expect("readable");
            let compiler = shaderc::Compiler::new().expect("shaderc starts");
            let artifact =
                compiler.assemble(&text, Some(&options(root))).unwrap_or_else(|e| fail(file, &e.to_string()));
            let mut words = artifact.as_binary().to_vec();
            // The assembler writes version 1.0 whatever it was asked for.
            words[1] = 0x0001_0500;
            return Compiled::both(format!("{upper}_SPIRV"), &stem, "Compute", words);
        }
        _ => return Vec::new(),
    };
    let text = fs::read_to_string(file).expect("readable");
    let variants: Vec<(String, Vec<String>)> = match text.lines().find_map(|l| l.strip_prefix("// variants:")) {
        None => vec![(String::new(), Vec::new())],
        Some(list) => list
            .split(';')
            .map(|v| {
                let mut words = v.split_whitespace().map(str::to_owned);
                (format!("_{}", words.next().unwrap_or_default().to_uppercase()), words.collect())
            })
            .collect(),
    };
    let compiler = shaderc::Compiler::new().expect("shaderc starts");
    let mut compiled = Vec::new();
    for (variant, defines) in variants {
        let mut options = options(root);
        for define in &defines {
            let (key, value) = define.split_once('=').unwrap_or((define, "1"));
            options.add_macro_definition(key, Some(value));
        }
        let label = file.display().to_string();
        let artifact = compiler
            .compile_into_spirv(&text, kind, &label, "main", Some(&options))
            .unwrap_or_else(|e| fail(file, &e.to_string()));
        let name = format!("{upper}{suffix}{variant}");
        let mut modules = Compiled::both(name.clone(), &stem, stage, artifact.as_binary().to_vec());
        if stage == "Compute" && text.contains("\"common/tiles.glsl\"") {
            options.add_macro_definition("FRAGMENT", Some("1"));
            let plain = compiler
                .preprocess(&text, &label, "main", Some(&options))
                .unwrap_or_else(|e| fail(file, &e.to_string()));
            if let Some(text) = fragment::fragment(&plain.as_text()) {
                let artifact = compiler
                    .compile_into_spirv(&text, shaderc::ShaderKind::Fragment, &label, "main", Some(&options))
                    .unwrap_or_else(|e| fail(file, &e.to_string()));
                let name = format!("{name}_AS_FRAGMENT");
                modules[0].fragment = Some(name.clone());
                modules.extend(Compiled::both(name, &stem, "Fragment", artifact.as_binary().to_vec()));
            }
        }
        compiled.extend(modules);
    }
    compiled
}

fn options(root: &Path) -> shaderc::CompileOptions<'static> {
    let mut options = shaderc::CompileOptions::new().expect("shaderc starts");
    options.set_target_env(shaderc::TargetEnv::Vulkan, shaderc::EnvVersion::Vulkan1_3 as u32);
    // 1.6 would state workgroup sizes by id, which needs maintenance4.
    options.set_target_spirv(shaderc::SpirvVersion::V1_5);
    options.set_optimization_level(shaderc::OptimizationLevel::Performance);
    // Debug information keeps the names, by which resources are bound.
    options.set_generate_debug_info();
    options.set_warnings_as_errors();
    let root = root.to_owned();
    options.set_include_callback(move |name, _, _, _| {
        let path = root.join(name);
        let content = fs::read_to_string(&path).map_err(|e| format!("{}: {e}", path.display()))?;
        Ok(shaderc::ResolvedInclude { resolved_name: path.display().to_string(), content })
    });
    options
}

fn fail(file: &Path, message: &str) -> ! {
    println!("cargo:warning={}: {}", file.display(), message.lines().next().unwrap_or_default());
    panic!("{}:\n{message}", file.display())
}

#[derive(Default)]
struct Reflection {
    workgroup: [u32; 3],
    bindings: Vec<String>,
    outputs: Vec<String>,
    constants: Vec<String>,
    blocks: Vec<String>,
    push: u32,
}

impl Reflection {
    fn of(words: &[u32]) -> Self {
        let module = rspirv::dr::load_words(words).expect("glslang writes valid SPIR-V");
        Reader::new(&module).read()
    }
}

/// SPIR-V looked up by id.
struct Reader<'a> {
    module: &'a Module,
    names: HashMap<u32, String>,
    members: BTreeMap<(u32, u32), String>,
    decorations: HashMap<u32, Vec<(Decoration, u32)>>,
    member_decorations: HashMap<(u32, u32), Vec<(Decoration, u32)>>,
    types: HashMap<u32, &'a Instruction>,
}

fn id(operand: &Operand) -> u32 {
    operand.id_ref_any().unwrap_or_default()
}
fn int(operand: &Operand) -> u32 {
    match operand {
        Operand::LiteralBit32(v) => *v,
        _ => 0,
    }
}
fn string(operand: &Operand) -> String {
    match operand {
        Operand::LiteralString(s) => s.clone(),
        _ => String::new(),
    }
}
fn decoration(operand: &Operand) -> Decoration {
    match operand {
        Operand::Decoration(d) => *d,
        _ => Decoration::RelaxedPrecision,
    }
}

impl<'a> Reader<'a> {
    fn new(module: &'a Module) -> Self {
        let mut reader = Reader {
            module,
            names: HashMap::new(),
            members: BTreeMap::new(),
            decorations: HashMap::new(),
            member_decorations: HashMap::new(),
            types: HashMap::new(),
        };
        for i in &module.debug_names {
            match i.class.opcode {
                Op::Name => drop(reader.names.insert(id(&i.operands[0]), string(&i.operands[1]))),
                Op::MemberName => {
                    drop(reader.members.insert((id(&i.operands[0]), int(&i.operands[1])), string(&i.operands[2])))
                }
                _ => {}
            }
        }
        for i in &module.annotations {
            match i.class.opcode {
                Op::Decorate => reader
                    .decorations
                    .entry(id(&i.operands[0]))
                    .or_default()
                    .push((decoration(&i.operands[1]), i.operands.get(2).map(int).unwrap_or_default())),
                Op::MemberDecorate => reader
                    .member_decorations
                    .entry((id(&i.operands[0]), int(&i.operands[1])))
                    .or_default()
                    .push((decoration(&i.operands[2]), i.operands.get(3).map(int).unwrap_or_default())),
                _ => {}
            }
        }
        for i in &module.types_global_values {
            if let Some(result) = i.result_id {
                reader.types.insert(result, i);
            }
        }
        reader
    }

    fn decorated(&self, id: u32, what: Decoration) -> Option<u32> {
        self.decorations.get(&id)?.iter().find(|d| d.0 == what).map(|d| d.1)
    }

    fn name(&self, id: u32) -> String {
        self.names.get(&id).cloned().unwrap_or_default()
    }

    fn read(&self) -> Reflection {
        let mut r = Reflection { workgroup: [1; 3], ..Default::default() };
        for mode in &self.module.execution_modes {
            if mode.operands.get(1) == Some(&Operand::ExecutionMode(ExecutionMode::LocalSize)) {
                r.workgroup = [int(&mode.operands[2]), int(&mode.operands[3]), int(&mode.operands[4])];
            }
        }
        let (mut bindings, mut outputs) = (Vec::new(), Vec::new());
        for i in &self.module.types_global_values {
            let result = i.result_id.unwrap_or_default();
            match i.class.opcode {
                Op::Variable => {
                    self.variable(i, result, &mut bindings, &mut r);
                    let location = self.decorated(result, Decoration::Location);
                    if let Some(at) = location.filter(|_| i.operands[0] == Operand::StorageClass(StorageClass::Output))
                    {
                        outputs.push((at, format!("{:?}", self.name(result))));
                    }
                }
                Op::SpecConstant | Op::SpecConstantTrue | Op::SpecConstantFalse => {
                    if let Some(spec) = self.decorated(result, Decoration::SpecId) {
                        // Sides of a workgroup have no name, and are the tile's.
                        let name = match spec {
                            50 => "TILE_X".to_owned(),
                            51 => "TILE_Y".to_owned(),
                            _ => self.name(result),
                        };
                        r.constants.push(format!("({name:?}, {spec})"));
                    }
                }
                _ => {}
            }
        }
        bindings.sort();
        outputs.sort();
        r.outputs = outputs.into_iter().map(|o| o.1).collect();
        r.bindings = bindings.into_iter().map(|b| b.1).collect();
        r
    }

    fn variable(&self, i: &Instruction, result: u32, bindings: &mut Vec<(u32, String)>, r: &mut Reflection) {
        let Operand::StorageClass(class) = i.operands[0] else { return };
        let pointee = i.result_type.map(|t| id(&self.types[&t].operands[1])).unwrap_or_default();
        if class == StorageClass::PushConstant {
            r.push = self.block(pointee).1;
            self.blocks(pointee, &mut r.blocks);
            return;
        }
        let Some(binding) = self.decorated(result, Decoration::Binding) else { return };
        let mut name = self.name(result);
        if name.is_empty() {
            name = self.name(pointee);
        }
        let ty = self.types[&pointee];
        let (mut read, mut write) = (
            self.decorated(result, Decoration::NonReadable).is_none(),
            self.decorated(result, Decoration::NonWritable).is_none(),
        );
        let (kind, format) = match ty.class.opcode {
            Op::TypeImage => {
                assert!(ty.operands[1] != Operand::Dim(Dim::DimSubpassData), "no subpass inputs");
                ("StorageImage", format_name(&ty.operands[6]))
            }
            Op::TypeSampledImage => {
                write = false;
                let texel = self.types[&id(&self.types[&id(&ty.operands[0])].operands[0])].class.opcode;
                ("SampledImage", if texel == Op::TypeInt { "R32_UINT" } else { "UNDEFINED" })
            }
            Op::TypeStruct => {
                self.blocks(pointee, &mut r.blocks);
                if class == StorageClass::Uniform {
                    write = false;
                    ("Uniform", "UNDEFINED")
                } else {
                    let all = |d: Decoration| {
                        (0..ty.operands.len() as u32).all(|m| {
                            self.member_decorations.get(&(pointee, m)).is_some_and(|v| v.iter().any(|x| x.0 == d))
                        })
                    };
                    read &= !all(Decoration::NonReadable);
                    write &= !all(Decoration::NonWritable);
                    ("Storage", "UNDEFINED")
                }
            }
            other => panic!("binding {name}: {other:?} is not a kind of resource this project binds"),
        };
        let text = format!(
            "Binding {{ name: {name:?}, binding: {binding}, kind: BindingKind::{kind}, read: {read}, write: {write}, format: vk::Format::{format} }}"
        );
        bindings.push((binding, text));
    }

    /// A block, and the structs that its members are or are arrays of.
    fn blocks(&self, id_: u32, list: &mut Vec<String>) {
        list.push(self.block(id_).0);
        for operand in &self.types[&id_].operands {
            let mut member = id(operand);
            while matches!(self.types[&member].class.opcode, Op::TypeArray | Op::TypeRuntimeArray) {
                member = id(&self.types[&member].operands[0]);
            }
            if self.types[&member].class.opcode == Op::TypeStruct {
                self.blocks(member, list);
            }
        }
    }

    /// A block as Rust text, and its size in bytes (the end of its last member; a runtime array counts nothing).
    fn block(&self, id_: u32) -> (String, u32) {
        let ty = self.types[&id_];
        let mut text = String::new();
        let mut size = 0;
        for (m, operand) in ty.operands.iter().enumerate() {
            let key = (id_, m as u32);
            let offset = self
                .member_decorations
                .get(&key)
                .and_then(|v| v.iter().find(|d| d.0 == Decoration::Offset))
                .map(|d| d.1)
                .unwrap_or_default();
            let name = self.members.get(&key).cloned().unwrap_or_default();
            write!(text, "({name:?}, {offset}), ").expect("writing to a string");
            size = size.max(offset + self.size_of(id(operand)));
        }
        (format!("Block {{ name: {:?}, size: {size}, members: &[{text}] }}", self.name(id_)), size)
    }

    fn size_of(&self, id_: u32) -> u32 {
        let ty = self.types[&id_];
        match ty.class.opcode {
            Op::TypeFloat | Op::TypeInt => int(&ty.operands[0]) / 8,
            Op::TypeVector | Op::TypeMatrix => self.size_of(id(&ty.operands[0])) * int(&ty.operands[1]),
            Op::TypeArray => {
                let length = self.types[&id(&ty.operands[1])];
                let stride = self.decorated(id_, Decoration::ArrayStride).unwrap_or_default();
                stride * int(&length.operands[0])
            }
            Op::TypeStruct => self.block(id_).1,
            _ => 0,
        }
    }
}

fn format_name(operand: &Operand) -> &'static str {
    match operand {
        Operand::ImageFormat(ImageFormat::R32f) => "R32_SFLOAT",
        Operand::ImageFormat(ImageFormat::R32ui) => "R32_UINT",
        Operand::ImageFormat(ImageFormat::Rg32ui) => "R32G32_UINT",
        Operand::ImageFormat(ImageFormat::Rgba32ui) => "R32G32B32A32_UINT",
        Operand::ImageFormat(ImageFormat::Rgba8) => "R8G8B8A8_UNORM",
        Operand::ImageFormat(ImageFormat::Rgb10A2) => "A2B10G10R10_UNORM_PACK32",
        Operand::ImageFormat(ImageFormat::Rgba16f) => "R16G16B16A16_SFLOAT",
        Operand::ImageFormat(ImageFormat::Rgba32f) => "R32G32B32A32_SFLOAT",
        Operand::ImageFormat(ImageFormat::Unknown) => "UNDEFINED",
        other => panic!("image format {other:?} is not in the build's table"),
    }
}

impl Compiled {
    /// A module and, of one over tiles that reads images, the one that samples them.
    fn both(name: String, stem: &str, stage: &'static str, words: Vec<u32>) -> Vec<Self> {
        let new = |name: String, words: Vec<u32>, sampled| {
            let reflection = Reflection::of(&words);
            Compiled { name, stem: stem.to_owned(), stage, words, sampled, fragment: None, reflection }
        };
        let both = stage == "Compute" || name.ends_with("_AS_FRAGMENT");
        let second = if both { sampled::sampled(&words) } else { None };
        let second = second.map(|words| new(format!("{name}_SAMPLED"), words, None));
        std::iter::once(new(name, words, second.as_ref().map(|s| s.name.clone()))).chain(second).collect()
    }

    fn rust(&self) -> String {
        let Compiled { name, stem, stage, reflection: r, .. } = self;
        let other = |name: &Option<String>| name.as_ref().map_or("None".to_owned(), |s| format!("Some(&{s})"));
        let (sampled, fragment) = (other(&self.sampled), other(&self.fragment));
        format!(
            "/// `glsl/{stem}`, as compiled by the build.\npub static {name}: Shader = Shader {{ name: {name:?}, stem: {stem:?}, stage: ShaderStage::{stage}, code: include_bytes!(concat!(env!(\"OUT_DIR\"), \"/{name}.spv\")), sampled: {sampled}, fragment: {fragment}, workgroup: {:?}, push_size: {}, bindings: &[{}], outputs: &[{}], constants: &[{}], blocks: &[{}] }};",
            r.workgroup,
            r.push,
            r.bindings.join(", "),
            r.outputs.join(", "),
            r.constants.join(", "),
            r.blocks.join(", ")
        )
    }
}
