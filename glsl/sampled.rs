//! From a compute shader that reads storage images, the same that fetches texels of sampled ones: which of the two loads faster
//! is the device's affair (`src/gpu/suit.rs`), and no shader is written twice.

use rspirv::binary::Assemble;
use rspirv::dr::{Instruction, Module, Operand};
use rspirv::spirv::{Decoration, ImageFormat, ImageOperands, Op, StorageClass, Word};
use std::collections::HashMap;

/// An image's own type, and that of the image with a sampler.
type Types = (Word, Word);

/// The module with every image that is only read made a sampled one; `None` where there is none such.
pub fn sampled(words: &[u32]) -> Option<Vec<u32>> {
    let mut module = rspirv::dr::load_words(words).expect("glslang writes valid SPIR-V");
    let images = read_only(&module);
    if images.is_empty() {
        return None;
    }
    let mut zero = None;
    let mut types: HashMap<Word, Types> = HashMap::new();
    for (variable, image) in images {
        module.annotations.retain(|a| {
            a.operands[0] != Operand::IdRef(variable) || a.operands[1] != Operand::Decoration(Decoration::NonWritable)
        });
        let mut operands = defined(&module, image).operands.clone();
        operands[5] = Operand::LiteralBit32(1);
        operands[6] = Operand::ImageFormat(ImageFormat::Unknown);
        let own = constant(&mut module, Op::TypeImage, None, operands);
        let with_sampler = constant(&mut module, Op::TypeSampledImage, None, vec![Operand::IdRef(own)]);
        let class = Operand::StorageClass(StorageClass::UniformConstant);
        let pointer = constant(&mut module, Op::TypePointer, None, vec![class, Operand::IdRef(with_sampler)]);
        types.insert(variable, (own, with_sampler));
        // Behind its type, wherever that was put.
        let at = module.types_global_values.iter().position(|i| i.result_id == Some(variable)).expect("it was found");
        let mut moved = module.types_global_values.remove(at);
        moved.result_type = Some(pointer);
        module.types_global_values.push(moved);
        let int = vec![Operand::LiteralBit32(32), Operand::LiteralBit32(1)];
        let int = constant(&mut module, Op::TypeInt, None, int);
        zero = Some(constant(&mut module, Op::Constant, Some(int), vec![Operand::LiteralBit32(0)]));
    }
    fetch(&mut module, &types, zero.expect("there is an image"));
    Some(module.assemble())
}

/// Variables that are images, read and never written, with the image's type.
fn read_only(module: &Module) -> Vec<(Word, Word)> {
    let kept = |id: Word| {
        let of = |a: &&Instruction| a.class.opcode == Op::Decorate && a.operands[0] == Operand::IdRef(id);
        module.annotations.iter().filter(of).any(|a| a.operands[1] == Operand::Decoration(Decoration::NonWritable))
    };
    let variables = module.types_global_values.iter().filter(|i| i.class.opcode == Op::Variable);
    variables
        .filter_map(|v| {
            let pointee = defined(module, v.result_type?).operands[1].id_ref_any()?;
            let image = defined(module, pointee).class.opcode == Op::TypeImage;
            v.result_id.filter(|id| image && kept(*id)).map(|id| (id, pointee))
        })
        .collect()
}

fn defined(module: &Module, id: Word) -> &Instruction {
    module.types_global_values.iter().find(|i| i.result_id == Some(id)).expect("types are defined")
}

fn fresh(module: &mut Module) -> Word {
    let header = module.header.as_mut().expect("a module has a header");
    header.bound += 1;
    header.bound - 1
}

/// The id of a type or constant, defined once.
fn constant(module: &mut Module, op: Op, of: Option<Word>, operands: Vec<Operand>) -> Word {
    let same = |i: &&Instruction| i.class.opcode == op && i.result_type == of && i.operands == operands;
    if let Some(there) = module.types_global_values.iter().find(same) {
        return there.result_id.expect("types have one");
    }
    let id = fresh(module);
    module.types_global_values.push(Instruction::new(op, of, Some(id), operands));
    id
}

/// Turns loads of those variables into loads with a sampler, and their reads into fetches of level 0.
fn fetch(module: &mut Module, types: &HashMap<Word, Types>, zero: Word) {
    let mut functions = std::mem::take(&mut module.functions);
    let mut loaded: HashMap<Word, Word> = HashMap::new();
    for block in functions.iter_mut().flat_map(|f| &mut f.blocks) {
        let mut all = Vec::with_capacity(block.instructions.len());
        for mut i in std::mem::take(&mut block.instructions) {
            let first = i.operands.first().and_then(Operand::id_ref_any);
            match i.class.opcode {
                Op::Load if first.is_some_and(|v| types.contains_key(&v)) => {
                    let (own, with_sampler) = types[&first.expect("just seen")];
                    i.result_type = Some(with_sampler);
                    loaded.insert(i.result_id.expect("a load has one"), own);
                }
                Op::ImageRead | Op::ImageQuerySize if first.is_some_and(|v| loaded.contains_key(&v)) => {
                    let image = first.expect("just seen");
                    let own = fresh(module);
                    all.push(Instruction::new(Op::Image, Some(loaded[&image]), Some(own), vec![Operand::IdRef(image)]));
                    let read = i.class.opcode == Op::ImageRead;
                    let mut operands = vec![Operand::IdRef(own)];
                    operands.extend(i.operands.drain(1..));
                    if read {
                        // What else is said of a read (that integers are not signed) takes no id.
                        let said = match operands.get(2) {
                            Some(Operand::ImageOperands(said)) => *said,
                            _ => ImageOperands::NONE,
                        };
                        assert!(
                            (ImageOperands::ZERO_EXTEND | ImageOperands::SIGN_EXTEND).contains(said),
                            "a plain read"
                        );
                        operands.truncate(2);
                        operands.push(Operand::ImageOperands(said | ImageOperands::LOD));
                    }
                    operands.push(Operand::IdRef(zero));
                    let op = if read { Op::ImageFetch } else { Op::ImageQuerySizeLod };
                    i = Instruction::new(op, i.result_type, i.result_id, operands);
                }
                _ => {}
            }
            all.push(i);
        }
        block.instructions = all;
    }
    module.functions = functions;
}
