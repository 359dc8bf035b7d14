//! Runs one screen kernel on a G-buffer that the host made.
use ash::vk;
use gpu_allocator::MemoryLocation;
use pdss::gpu::commands::{Guarded, Recorder};
use pdss::gpu::image::{Image, ImageDesc};
use pdss::gpu::pass::Bound;
use pdss::gpu::pipeline::Pipeline;
use pdss::gpu::timing::{Timer, TimingMode};
use pdss::gpu::usage::State;
use pdss::gpu::{Buffer, Gpu, Usage};
use pdss::shaders::Shader;
use pdss::skin::curvature::GBuffer;
use pdss::skin::octahedral;
use std::collections::HashMap;
use std::sync::Arc;

/// What a word of the output is before a kernel runs.
pub const UNTOUCHED: u32 = 0x7fc0_1234;

/// Distances and normals as the G-buffer's formats hold them.
pub struct Stored {
    pub z: Vec<f32>,
    pub normal: Vec<u32>,
}

pub fn stored(g: &GBuffer) -> Stored {
    let code = |n: &[f64; 3]| {
        let [x, y] = octahedral::encode(*n).map(|w| u32::from(w as u16));
        x | y << 16
    };
    Stored { z: g.z.iter().map(|z| *z as f32).collect(), normal: g.normal.iter().map(code).collect() }
}

/// The twin's input: exactly what the kernel reads.
pub fn decoded(s: &Stored, g: &GBuffer) -> GBuffer {
    let normal = |code: &u32| octahedral::decode([*code as i16, (*code >> 16) as i16]);
    // The projection, too, is in f32 on the device.
    let mut camera = g.camera;
    camera.ray_scale = camera.ray_scale.map(|v| f64::from(v as f32));
    camera.ray_offset = camera.ray_offset.map(|v| f64::from(v as f32));
    GBuffer {
        z: s.z.iter().map(|z| f64::from(*z)).collect(),
        normal: s.normal.iter().map(normal).collect(),
        camera,
        ..*g
    }
}

/// One pixel of the output.
#[derive(Clone, Copy)]
pub struct Texel {
    pub bits: [u32; 2],
    pub h: f64,
    /// sign(K) sqrt|K| q.
    pub root_k: f64,
    pub confidence: f64,
}

pub struct Rig {
    gpu: Arc<Gpu>,
    size: [u32; 2],
    frame: Vec<(&'static str, Vec<u8>)>,
    inputs: HashMap<&'static str, (vk::Format, Vec<u8>)>,
    tiles: Vec<u8>,
}

fn buffer(gpu: &Arc<Gpu>, name: &str, bytes: &[u8], usage: vk::BufferUsageFlags) -> Buffer {
    let mut b = Buffer::new(gpu, name, bytes.len() as u64, usage, MemoryLocation::CpuToGpu).expect("a buffer");
    b.write(bytes).expect("mapped");
    b
}

impl Rig {
    pub fn new(gpu: &Arc<Gpu>, stored: &Stored, g: &GBuffer) -> Self {
        let size = [g.width as u32, g.height as u32];
        let bytes = |v: &[f64]| v.iter().flat_map(|x| (*x as f32).to_le_bytes()).collect::<Vec<u8>>();
        let frame = vec![
            ("ray_scale", bytes(&g.camera.ray_scale)),
            ("ray_offset", bytes(&g.camera.ray_offset)),
            ("size", size.iter().flat_map(|v| v.to_le_bytes()).collect()),
            ("perspective", bytes(&[if g.camera.perspective { 1.0 } else { 0.0 }])),
            ("pixels_per_mm", bytes(&[g.camera.pixels_per_mm()])),
        ];
        let words = |v: Vec<u32>| v.iter().flat_map(|x| x.to_le_bytes()).collect::<Vec<u8>>();
        let [across, down] = size.map(|n| n.div_ceil(8));
        let tiles = (0..down).flat_map(|y| (0..across).map(move |x| y << 16 | x));
        let inputs = HashMap::from([
            ("viewz", (vk::Format::R32_SFLOAT, words(stored.z.iter().map(|z| z.to_bits()).collect()))),
            ("normal", (vk::Format::R32_UINT, words(stored.normal.clone()))),
            ("curvature", (vk::Format::R32G32_UINT, words(vec![UNTOUCHED; 2 * stored.z.len()]))),
        ]);
        let tiles = words([across * down, 1, 1, 0].into_iter().chain(tiles).collect());
        Self { gpu: gpu.clone(), size, frame, inputs, tiles }
    }

    /// The frame's constants, each where this shader's own reflection says.
    fn constants(&self, shader: &Shader) -> Vec<u8> {
        let block = shader.blocks.iter().find(|b| b.name == "FrameBlock").expect("every screen stage knows the frame");
        let mut bytes = vec![0; block.size as usize];
        for (name, value) in &self.frame {
            // The optimiser keeps a block whole; what is missing would read as 0 and fail the comparison.
            if let Some((_, offset)) = block.members.iter().find(|m| m.0 == *name) {
                bytes[*offset as usize..][..value.len()].copy_from_slice(value);
            }
        }
        bytes
    }

    /// The kernel's output.
    pub fn run(&self, shader: &'static Shader) -> Vec<Texel> {
        self.repeat(shader, 0).0
    }

    /// The kernel's output, and its times in ns over `timed` more runs of the same commands.
    pub fn repeat(&self, shader: &'static Shader, timed: usize) -> (Vec<Texel>, Vec<f64>) {
        use vk::{BufferUsageFlags as B, ImageUsageFlags as I};
        let gpu = &self.gpu;
        let pipeline = Pipeline::compute(gpu, shader.name, shader, &[]).expect("a pipeline");
        let frame = buffer(gpu, "frame", &self.constants(shader), B::UNIFORM_BUFFER);
        let tiles = buffer(gpu, "tiles", &self.tiles, B::STORAGE_BUFFER);
        let mut images = HashMap::new();
        let mut uploads = HashMap::new();
        let mut states = HashMap::new();
        for (name, (format, bytes)) in &self.inputs {
            let desc = ImageDesc::new(name, *format, self.size, I::STORAGE | I::TRANSFER_DST | I::TRANSFER_SRC);
            images.insert(*name, Image::new(gpu, desc).expect("an image"));
            uploads.insert(*name, buffer(gpu, name, bytes, B::TRANSFER_SRC));
            states.insert(*name, State::NEW);
        }
        let length = self.inputs["curvature"].1.len() as u64;
        let result = Buffer::new(gpu, "result", length, B::TRANSFER_DST, MemoryLocation::GpuToCpu).expect("a buffer");

        let timer = (timed > 0).then(|| Timer::new(gpu, 3, TimingMode::Isolated).expect("timestamps"));
        let mut recorder = Recorder::new(gpu, timer).expect("a recorder");
        let mut barriers = |uses: &[(&'static str, Usage)]| -> Vec<_> {
            let next = |(name, usage): &(&'static str, Usage)| {
                let barrier = states.get_mut(name).and_then(|s: &mut State| s.next(*usage, true));
                barrier.map(|b| (Guarded::Image(&images[name]), b))
            };
            uses.iter().filter_map(next).collect()
        };
        let all = ["viewz", "normal", "curvature"];
        let mut pass = recorder.pass("upload", &barriers(&all.map(|n| (n, Usage::CopyTo))));
        for name in all {
            pass.upload(&uploads[name], &images[name], &[(0, self.size)]);
        }
        drop(pass);
        let uses =
            [("viewz", Usage::ComputeRead), ("normal", Usage::ComputeRead), ("curvature", Usage::ComputeReadWrite)];
        let mut pass = recorder.pass("curvature", &barriers(&uses));
        let count = (self.tiles.len() / 4 - 4) as u32;
        pass.dispatch_over(&pipeline, [8 * count, 8], &[], |name| match name {
            "frame" => Some(Bound::Buffer(&frame)),
            "tile_list" => Some(Bound::Buffer(&tiles)),
            _ => images.get(name).map(Bound::Image),
        })
        .expect("everything is bound");
        drop(pass);
        let mut pass = recorder.pass("read back", &barriers(&[("curvature", Usage::CopyFrom)]));
        pass.read_back(&images["curvature"], &result);
        drop(pass);
        let recorded = recorder.finish().expect("recorded");
        recorded.run().expect("the frame ran");
        let mut times = Vec::new();
        for _ in 0..timed {
            recorded.run().expect("the frame ran");
            let stamps = recorded.timer().map(|t| t.read().expect("timestamps"));
            times.extend(stamps.and_then(|s| s[1]));
        }

        let word = |b: &[u8]| u32::from_le_bytes([b[0], b[1], b[2], b[3]]);
        let half = |w: u32| half::f16::from_bits(w as u16).to_f64();
        let texel = |b: &[u8]| {
            let bits = [word(b), word(&b[4..])];
            let h = f64::from(f32::from_bits(bits[0]));
            Texel { bits, h, root_k: half(bits[1]), confidence: half(bits[1] >> 16) }
        };
        (result.bytes().expect("mapped").chunks_exact(8).map(texel).collect(), times)
    }
}
