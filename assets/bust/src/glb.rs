//! Writes the bust as one binary glTF file: 16-bit positions, normals and UVs (KHR_mesh_quantization), textures inside.

use glam::{DVec2, DVec3, dvec2, dvec3};
use serde_json::{Value, json};

use crate::bake::{THICKEST, Textures};
use crate::eyes;
use crate::mesh::Mesh;
use crate::{paint, sculpt};

/// mm that the largest 16-bit position stands for.
const EXTENT: f64 = 200.;
/// The middle of the box, mm above the pupils.
const MIDDLE: f64 = -78.;

/// A mesh ready to be stored.
#[derive(Default)]
struct Soup {
    positions: Vec<DVec3>,
    normals: Vec<DVec3>,
    uvs: Vec<DVec2>,
}

/// The file under construction.
#[derive(Default)]
struct File {
    bin: Vec<u8>,
    views: Vec<Value>,
    accessors: Vec<Value>,
}

impl File {
    fn view(&mut self, bytes: &[u8], stride: Option<usize>, target: Option<u32>) -> usize {
        self.bin.resize(self.bin.len().next_multiple_of(4), 0);
        let mut view = json!({"buffer": 0, "byteOffset": self.bin.len(), "byteLength": bytes.len()});
        if let Some(stride) = stride {
            view["byteStride"] = json!(stride);
        }
        if let Some(target) = target {
            view["target"] = json!(target);
        }
        self.bin.extend(bytes);
        self.views.push(view);
        self.views.len() - 1
    }

    fn accessor(&mut self, accessor: Value) -> usize {
        self.accessors.push(accessor);
        self.accessors.len() - 1
    }

    /// Vertices as three accessors.
    fn vertices(&mut self, soup: &Soup) -> Value {
        const VERTICES: Option<u32> = Some(34962);
        let short = |x: f64| (x.clamp(-1., 1.) * 32767.).round() as i16;
        let place = |p: &DVec3| (*p - dvec3(0., MIDDLE, 0.)) / EXTENT;
        let four = |p: DVec3| [short(p.x), short(p.y), short(p.z), 0];
        let places: Vec<[i16; 4]> = soup.positions.iter().map(|p| four(place(p))).collect();
        let (mut low, mut high) = ([i16::MAX; 3], [i16::MIN; 3]);
        for p in &places {
            (0..3).for_each(|k| (low[k], high[k]) = (low[k].min(p[k]), high[k].max(p[k])));
        }
        let count = places.len();
        let bytes =
            |list: &[[i16; 4]]| -> Vec<u8> { list.as_flattened().iter().flat_map(|x| x.to_le_bytes()).collect() };
        let view = self.view(&bytes(&places), Some(8), VERTICES);
        let position = self
            .accessor(json!({"bufferView": view, "componentType": 5122, "normalized": true, "type": "VEC3",
            "count": count, "min": low, "max": high}));
        let normals: Vec<[i16; 4]> = soup.normals.iter().map(|&n| four(n)).collect();
        let view = self.view(&bytes(&normals), Some(8), VERTICES);
        let normal = self.accessor(
            json!({"bufferView": view, "componentType": 5122, "normalized": true, "type": "VEC3", "count": count}),
        );
        let unit = |x: f64| ((x.clamp(0., 1.) * 65535.).round() as u16).to_le_bytes();
        let uvs: Vec<u8> = soup.uvs.iter().flat_map(|q| [unit(q.x), unit(q.y)].concat()).collect();
        let view = self.view(&uvs, Some(4), VERTICES);
        let uv = self.accessor(
            json!({"bufferView": view, "componentType": 5123, "normalized": true, "type": "VEC2", "count": count}),
        );
        json!({"POSITION": position, "NORMAL": normal, "TEXCOORD_0": uv})
    }

    fn primitive(&mut self, attributes: &Value, triangles: &[[u32; 3]], material: usize) -> Value {
        let bytes: Vec<u8> = triangles.as_flattened().iter().flat_map(|&i| (i as u16).to_le_bytes()).collect();
        let view = self.view(&bytes, None, Some(34963));
        let indices = self.accessor(
            json!({"bufferView": view, "componentType": 5123, "type": "SCALAR", "count": 3 * triangles.len()}),
        );
        json!({"attributes": attributes, "indices": indices, "material": material})
    }

    fn image(&mut self, name: &str, mime: &str, bytes: &[u8]) -> Value {
        let view = self.view(bytes, None, None);
        json!({"name": name, "mimeType": mime, "bufferView": view})
    }
}

/// The half and its mirror image; the vertices of the face's middle are shared, those of the cut stand twice.
fn whole(half: &Mesh, uv: &[DVec2]) -> (Soup, Vec<[u32; 3]>) {
    let mut soup = Soup::default();
    let mut twin = Vec::new();
    for (p, q) in half.positions.iter().zip(uv) {
        let mut n = sculpt::normal(*p);
        if p.x == 0. {
            n = dvec3(0., n.y, n.z).normalize();
        }
        soup.positions.push(*p);
        soup.normals.push(n);
        soup.uvs.push(*q);
    }
    for (i, own) in uv.iter().enumerate() {
        if own.x == 0.5 {
            twin.push(i as u32);
            continue;
        }
        twin.push(soup.positions.len() as u32);
        let (p, n, q) = (soup.positions[i], soup.normals[i], *own);
        soup.positions.push(dvec3(-p.x, p.y, p.z));
        soup.normals.push(dvec3(-n.x, n.y, n.z));
        soup.uvs.push(dvec2(1. - q.x, q.y));
    }
    let mirrored = half.triangles.iter().map(|t| [twin[t[0] as usize], twin[t[2] as usize], twin[t[1] as usize]]);
    let triangles = half.triangles.iter().copied().chain(mirrored).collect();
    (soup, triangles)
}

/// Both halves as the baker needs them.
pub fn both(half: &Mesh, uv: &[DVec2]) -> (Mesh, Vec<DVec2>) {
    let (soup, triangles) = whole(half, uv);
    (Mesh { positions: soup.positions, triangles }, soup.uvs)
}

/// The bytes of the file.
pub fn write(half: &Mesh, uv: &[DVec2], textures: &Textures, eyes_image: &image::RgbImage) -> anyhow::Result<Vec<u8>> {
    let (soup, triangles) = whole(half, uv);
    anyhow::ensure!(soup.positions.len() < 65_535, "{} vertices are too many for 16 bits", soup.positions.len());
    let mut file = File::default();
    // Hair where all three corners are thick with it: the border lies where the paint is already dark.
    let corner = |i: u32| {
        let p = soup.positions[i as usize];
        paint::hair(dvec3(p.x.abs(), p.y, p.z))
    };
    let (hair, skin): (Vec<_>, Vec<_>) = triangles.iter().partition(|t| t.iter().all(|&i| corner(i) > 0.8));
    let attributes = file.vertices(&soup);
    let mut primitives = vec![file.primitive(&attributes, &skin, 0), file.primitive(&attributes, &hair, 1)];
    let (ball, faces) = eyes::ball(32, 48);
    let mut balls = Soup::default();
    let mut eye_triangles = Vec::new();
    for side in [1., -1.] {
        let first = balls.positions.len() as u32;
        for v in &ball {
            let flip = dvec3(side, 1., 1.);
            balls.positions.push(v.position * flip);
            balls.normals.push(v.normal * flip);
            // The picture holds the right eye first; each square keeps its mirror image within itself.
            let x = if side > 0. { 0.5 + v.uv.x / 2. } else { v.uv.x / 2. };
            balls.uvs.push(dvec2(x, v.uv.y));
        }
        let order = |t: &[u32; 3]| if side > 0. { *t } else { [t[0], t[2], t[1]] };
        eye_triangles.extend(faces.iter().map(|t| order(t).map(|i| first + i)));
    }
    let attributes = file.vertices(&balls);
    primitives.push(file.primitive(&attributes, &eye_triangles, 2));
    let images = vec![
        file.image("color", "image/jpeg", &jpeg(&textures.color, 88)?),
        file.image("occlusion-roughness", "image/jpeg", &jpeg(&textures.surface, 88)?),
        file.image("thickness", "image/png", &png(&textures.thickness.clone().into())?),
        file.image("eyes", "image/png", &png(&eyes_image.clone().into())?),
    ];
    let surface = |name: &str| {
        json!({"name": name, "occlusionTexture": {"index": 1}, "pbrMetallicRoughness": {
            "baseColorTexture": {"index": 0}, "metallicRoughnessTexture": {"index": 1}, "metallicFactor": 0}})
    };
    let mut skin = surface("Skin");
    skin["extensions"] = json!({
        "KHR_materials_diffuse_transmission": {"diffuseTransmissionFactor": 1},
        "KHR_materials_volume": {"thicknessFactor": THICKEST / 1000., "thicknessTexture": {"index": 2}},
    });
    let eyes = json!({"name": "Eyes", "pbrMetallicRoughness": {
        "baseColorTexture": {"index": 3}, "metallicFactor": 0, "roughnessFactor": 0.09}});
    // A portrait: from the side of the key, a little above, the shoulders in the picture.
    let (yaw, pitch, distance, target) = (22f64.to_radians(), 3f64.to_radians(), 830., dvec3(0., -72., 5.));
    let d = dvec3(yaw.sin() * pitch.cos(), pitch.sin(), yaw.cos() * pitch.cos());
    let eye = (target + distance * d) / 1000.;
    let turn = glam::DQuat::from_rotation_y(yaw) * glam::DQuat::from_rotation_x(-pitch);
    let json = json!({
        "asset": {"version": "2.0", "generator": "pdss assets/bust", "copyright": "MIT OR Apache-2.0"},
        "extensionsUsed": ["KHR_materials_diffuse_transmission", "KHR_materials_volume", "KHR_mesh_quantization"],
        "extensionsRequired": ["KHR_mesh_quantization"],
        "scene": 0,
        "scenes": [{"name": "bust", "nodes": [0, 1]}],
        "nodes": [
            {"name": "bust", "mesh": 0, "scale": [EXTENT / 1000., EXTENT / 1000., EXTENT / 1000.], "translation": [0, MIDDLE / 1000., 0]},
            {"name": "portrait", "camera": 0, "translation": eye.to_array(), "rotation": turn.to_array()},
        ],
        "cameras": [{"name": "portrait", "type": "perspective", "perspective": {"yfov": 30f64.to_radians(), "znear": 0.01}}],
        "meshes": [{"name": "bust", "primitives": primitives}],
        "materials": [skin, surface("Hair"), eyes],
        "textures": [{"source": 0, "sampler": 0}, {"source": 1, "sampler": 0}, {"source": 2, "sampler": 0}, {"source": 3, "sampler": 0}],
        "samplers": [{"wrapS": 33071, "wrapT": 33071, "magFilter": 9729, "minFilter": 9987}],
        "images": images,
        "bufferViews": file.views,
        "accessors": file.accessors,
        "buffers": [{"byteLength": file.bin.len()}],
    });
    Ok(container(&serde_json::to_vec(&json)?, &file.bin))
}

fn container(json: &[u8], bin: &[u8]) -> Vec<u8> {
    let mut out = Vec::new();
    let (json_len, bin_len) = (json.len().next_multiple_of(4), bin.len().next_multiple_of(4));
    for word in [0x4654_6c67, 2, (28 + json_len + bin_len) as u32, json_len as u32, 0x4e4f_534a] {
        out.extend(u32::to_le_bytes(word));
    }
    out.extend(json);
    out.resize(20 + json_len, b' ');
    out.extend((bin_len as u32).to_le_bytes());
    out.extend(0x004e_4942u32.to_le_bytes());
    out.extend(bin);
    out.resize(28 + json_len + bin_len, 0);
    out
}

fn png(image: &image::DynamicImage) -> anyhow::Result<Vec<u8>> {
    let mut out = std::io::Cursor::new(Vec::new());
    image.write_to(&mut out, image::ImageFormat::Png)?;
    Ok(out.into_inner())
}

fn jpeg(image: &image::RgbImage, quality: u8) -> anyhow::Result<Vec<u8>> {
    let mut out = Vec::new();
    image.write_with_encoder(image::codecs::jpeg::JpegEncoder::new_with_quality(&mut out, quality))?;
    Ok(out)
}
