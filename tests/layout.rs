//! What crosses to the shaders: every member of every Rust struct against its offset in the compiled SPIR-V, by name.
use bytemuck::{Pod, Zeroable};
use pdss::frame::uniforms::{EnvironmentBlock, FrameBlock, InertPush, LightBlock, LightEntry, MaterialPush};
use pdss::shaders::{ALL, Block, Shader};
use std::mem::{offset_of, size_of};

/// A Rust struct as the shaders must see it.
struct Layout {
    size: usize,
    members: Vec<(&'static str, usize)>,
}

/// Name and offset of every member. The pattern has no `..`: a member that is not listed does not compile.
macro_rules! layout {
    ($type:ident { $($member:ident),* $(,)? }) => {{
        let _ = |$type { $($member: _),* }: $type| {};
        Layout { size: size_of::<$type>(), members: vec![$((stringify!($member), offset_of!($type, $member))),*] }
    }};
}

fn frame() -> Layout {
    layout!(FrameBlock {
        clip_from_world,
        view_from_world,
        world_from_view,
        ray_scale,
        ray_offset,
        size,
        perspective,
        pixels_per_mm,
        origin,
        light_unit,
        ambient_mean,
        exposure,
        ambient_slope,
        length_mm,
        up,
        lut_knee,
        level,
        share,
        occlusion,
        sharp,
    })
}

/// Push constants of one number, sent as it is: `stages::blur` and `stages::shadow`.
fn single(name: &'static str) -> Layout {
    Layout { size: 4, members: vec![(name, 0)] }
}

/// The Rust twin of a block, by the block's name and, for push constants, whose they are.
fn twin(shader: &Shader, block: &Block) -> Option<Layout> {
    Some(match (shader.stem, block.name) {
        (_, "FrameBlock") => frame(),
        (_, "EnvironmentBlock") => {
            layout!(EnvironmentBlock { sky_from_view, intensity, first, last, blur, knee, harmonic })
        }
        (_, "LightBlock") => layout!(LightBlock { shadow_from_view, light }),
        (_, "Light") => {
            layout!(LightEntry {
                position,
                kind,
                color,
                range_mm,
                axis,
                inner_cos,
                outer_cos,
                layer,
                texel_mm,
                slot,
                part
            })
        }
        ("gbuffer" | "forward" | "unwrap" | "entrance" | "overlay", "Push") => layout!(MaterialPush {
            base_color,
            roughness,
            metallic,
            normal_scale,
            occlusion_strength,
            alpha_cutoff,
            reflectance,
            bare,
            scatter,
            emission,
            thickness,
            sheen,
            sheen_roughness,
            specular_tint,
            specular,
            coat,
            coat_roughness,
            profile,
        }),
        ("blur" | "translucent", "Push") => single("variance"),
        ("shadow", "Push") => single("layer"),
        ("inert", "Push") => layout!(InertPush { layer, shift }),
        // A list of tiles starts with what `stages::tiles` resets it to: four words.
        (_, "TileBlock" | "SurfaceTiles" | "ScatterTiles") => {
            Layout { size: 16, members: vec![("dispatch", 0), ("pad", 12), ("tile", 16)] }
        }
        ("shadow" | "entrance" | "inert", "ShadowWorldBlock") => {
            Layout { size: 0, members: vec![("shadow_from_world", 0)] }
        }
        // Arrays of vec4, and nothing before them.
        ("lut_probe", "QueryBlock") => Layout { size: 0, members: vec![("query", 0)] },
        ("lut_probe", "AnswerBlock") => Layout { size: 0, members: vec![("answer", 0)] },
        ("seams", "GutterBlock") => Layout { size: 0, members: vec![("texel", 0)] },
        (_, "KernelBlock") => Layout { size: 0, members: vec![("entry", 0)] },
        _ => return None,
    })
}

/// Every difference between the two. Assembly may leave out members that it does not read, and what follows them.
fn differences(shader: &Shader, block: &Block, rust: &Layout) -> Vec<String> {
    let place = format!("{}, {}", shader.name, block.name);
    let mut list = Vec::new();
    for (name, offset) in block.members {
        match rust.members.iter().find(|m| m.0 == *name) {
            Some((_, o)) if *o == *offset as usize => {}
            Some((_, o)) => list.push(format!("{place}.{name}: at {offset} in GLSL, at {o} in Rust")),
            None => list.push(format!("{place}.{name}: not in Rust")),
        }
    }
    if !shader.name.contains("_SPIRV") {
        for (name, _) in rust.members.iter().filter(|m| !block.members.iter().any(|x| x.0 == m.0)) {
            list.push(format!("{place}.{name}: not in GLSL"));
        }
        if block.size as usize != rust.size {
            list.push(format!("{place}: {} bytes in GLSL, {} in Rust", block.size, rust.size));
        }
    }
    list
}

#[test]
fn every_member_lies_where_the_shaders_read_it() {
    let mut wrong = Vec::new();
    let (mut blocks, mut members) = (0, 0);
    let mut names = std::collections::BTreeMap::<&str, usize>::new();
    for shader in ALL {
        for block in shader.blocks {
            blocks += 1;
            members += block.members.len();
            *names.entry(block.name).or_default() += 1;
            match twin(shader, block) {
                Some(rust) => wrong.extend(differences(shader, block, &rust)),
                None => wrong.push(format!("{}, {}: nobody compares it with Rust", shader.name, block.name)),
            }
        }
        assert!(shader.push_size <= 128, "{}: more push constants than every device has", shader.name);
    }
    println!("{} shaders, {blocks} blocks, {members} members: {names:?}", ALL.len());
    assert_eq!(wrong, Vec::<String>::new());
    for name in ["FrameBlock", "LightBlock", "Light", "Push", "TileBlock"] {
        assert!(names.contains_key(name), "no shader has a {name}: was anything compared?");
    }
}

/// The likeliest slip, std140's idea of a vec3, moves what follows by four bytes.
#[repr(C)]
#[derive(Clone, Copy, Pod, Zeroable)]
struct PaddedLight {
    position: [f32; 4],
    kind: i32,
    color: [f32; 3],
    range_mm: f32,
    axis: [f32; 3],
    inner_cos: f32,
    outer_cos: f32,
    layer: i32,
    texel_mm: f32,
    slot: i32,
    part: f32,
}

/// Two members of one type changed places: same size, same padding.
#[repr(C)]
#[derive(Clone, Copy, Pod, Zeroable)]
struct SwappedLight {
    position: [f32; 3],
    kind: i32,
    color: [f32; 3],
    range_mm: f32,
    axis: [f32; 3],
    outer_cos: f32,
    inner_cos: f32,
    layer: i32,
    texel_mm: f32,
    slot: i32,
    part: f32,
}

/// A member that GLSL has and Rust does not.
#[repr(C)]
#[derive(Clone, Copy, Pod, Zeroable)]
struct ShortLight {
    position: [f32; 3],
    kind: i32,
    color: [f32; 3],
    range_mm: f32,
    axis: [f32; 3],
    inner_cos: f32,
    outer_cos: f32,
    layer: i32,
    texel_mm: f32,
    slot: i32,
}

#[test]
fn wrong_structs_are_caught() {
    let find = |name: &str| ALL.iter().find_map(|s| Some((*s, s.blocks.iter().find(|b| b.name == name)?)));
    let (shader, light) = find("Light").expect("some shader has lights");
    let wrong = [
        layout!(PaddedLight {
            position,
            kind,
            color,
            range_mm,
            axis,
            inner_cos,
            outer_cos,
            layer,
            texel_mm,
            slot,
            part
        }),
        layout!(SwappedLight {
            position,
            kind,
            color,
            range_mm,
            axis,
            inner_cos,
            outer_cos,
            layer,
            texel_mm,
            slot,
            part
        }),
        layout!(ShortLight { position, kind, color, range_mm, axis, inner_cos, outer_cos, layer, texel_mm, slot }),
    ];
    for layout in wrong {
        let found = differences(shader, light, &layout);
        println!("{found:?}");
        assert!(!found.is_empty());
    }
    let (shader, block) = find("FrameBlock").expect("some shader knows the frame");
    for at in 0..frame().members.len() {
        let mut moved = frame();
        moved.members[at].1 += 4;
        assert_eq!(differences(shader, block, &moved).len(), 1);
        let mut missing = frame();
        missing.members.remove(at);
        assert_eq!(differences(shader, block, &missing).len(), 1);
    }
    let mut long = frame();
    long.size += 4;
    assert_eq!(differences(shader, block, &long).len(), 1);
}
