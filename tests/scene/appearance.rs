//! Textures, tangents, UVs, lights and cameras of files made here.

use glam::{Vec3, Vec4};
use pdss::scene::{Alpha, LightKind, LoadOptions, Projection, Scattering};
use serde_json::{Value, json};

use crate::check::assert_sound;
use crate::fixture::{Fixture, add_attribute, base64, square};

fn png(width: u32, height: u32) -> Vec<u8> {
    let mut bytes = std::io::Cursor::new(Vec::new());
    let image = image::RgbImage::from_fn(width, height, |x, y| image::Rgb([x as u8, y as u8, 255]));
    image.write_to(&mut bytes, image::ImageFormat::Png).unwrap();
    bytes.into_inner()
}

/// The square with UVs and a textured, normal-mapped material.
fn textured() -> Value {
    let mut document = square();
    add_attribute(&mut document, "TEXCOORD_0", "VEC2", &[0., 1., 1., 1., 0., 0., 1., 0.]);
    document["images"] = json!([{"uri": "a.png"}]);
    document["samplers"] = json!([{"wrapS": 33071, "magFilter": 9728}]);
    document["textures"] = json!([{"source": 0, "sampler": 0}]);
    document["materials"] = json!([{
        "pbrMetallicRoughness": {"baseColorTexture": {"index": 0}, "metallicFactor": 0},
        "normalTexture": {"index": 0, "scale": 0.5},
        "alphaMode": "MASK",
    }]);
    document["meshes"][0]["primitives"][0]["material"] = json!(0);
    document
}

#[test]
fn textures_are_decoded_once_for_each_use() {
    use pdss::scene::{Filter, Wrap};
    let made = Fixture::new();
    std::fs::write(made.0.path().join("a.png"), png(3, 2)).unwrap();
    let scene = made.load(&textured()).unwrap();
    assert_sound(&scene);
    assert_eq!(scene.textures.len(), 2, "colour and data");
    let base = &scene.textures[scene.materials[0].base_color_texture.unwrap()];
    let (normal, scale) = scene.materials[0].normal_texture.unwrap();
    assert!(base.srgb && !scene.textures[normal].srgb && scale == 0.5);
    assert_eq!((base.width, base.height, base.name.as_str()), (3, 2, "a.png"));
    assert_eq!(base.rgba8[4..8], [1, 0, 255, 255]);
    assert_eq!((base.wrap, base.filter), ([Wrap::Clamp, Wrap::Repeat], Filter::Nearest));
    assert_eq!(scene.materials[0].alpha, Alpha::Mask(0.5));
    // v runs down the square, so u = +x and the bitangent, against v, = +y.
    assert!(scene.tangents.iter().all(|t| (Vec4::from(*t) - Vec4::new(1., 0., 0., 1.)).length() < 1e-6));

    std::fs::write(made.0.path().join("a.png"), &png(3, 2)[..40]).unwrap();
    assert!(made.refusal(&textured()).contains("images[0]: damaged image"));
    std::fs::remove_file(made.0.path().join("a.png")).unwrap();
    assert!(made.refusal(&textured()).contains("images[0].uri: cannot read"));
    std::fs::write(made.0.path().join("a.png"), b"GIF89a\x01\0\x01\0\0\0\0").unwrap();
    let scene = made.load(&textured()).unwrap();
    assert!(scene.textures.is_empty() && scene.tangents.is_empty() && scene.uvs.is_empty());
    assert!(scene.warnings.iter().any(|w| w.contains("images[0]: ")), "{:?}", scene.warnings);
}

#[test]
fn mirrored_tangents_keep_their_bitangent() {
    let made = Fixture::new();
    std::fs::write(made.0.path().join("a.png"), png(1, 1)).unwrap();
    let mut given = textured();
    add_attribute(&mut given, "TANGENT", "VEC4", &[1., 0., 0., 1.].repeat(4));
    add_attribute(&mut given, "NORMAL", "VEC3", &[0., 0., 1.].repeat(4));
    for mut document in [given, textured()] {
        document["nodes"][0]["scale"] = json!([-1, 1, 1]);
        let scene = made.load(&document).unwrap();
        assert_sound(&scene);
        for (t, n) in scene.tangents.iter().zip(&scene.normals) {
            let tangent = Vec3::from_slice(t);
            let bitangent = t[3] * Vec3::from(*n).cross(tangent);
            assert!((tangent - Vec3::NEG_X).length() < 1e-6 && (bitangent - Vec3::Y).length() < 1e-6);
        }
    }
}

#[test]
fn texture_transforms_are_baked_and_disagreement_is_said() {
    let made = Fixture::new();
    std::fs::write(made.0.path().join("a.png"), png(1, 1)).unwrap();
    let mut document = textured();
    let quarter = std::f64::consts::FRAC_PI_2;
    let turned = json!({"KHR_texture_transform": {"offset": [0.25, 0], "scale": [2, 1], "rotation": quarter}});
    document["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"]["extensions"] = turned;
    let scene = made.load(&document).unwrap();
    // (1, 1) -> scaled (2, 1) -> turned (1, -2) -> moved (1.25, -2).
    assert!(scene.uvs.iter().any(|uv| (uv[0] - 1.25).abs() < 1e-6 && (uv[1] + 2.0).abs() < 1e-6));
    assert_sound(&scene);
    // The normal map reads them as they are: the second kind, and the tangents are its own.
    assert_eq!(scene.materials[0].second_uvs, 1 << 2);
    assert!(scene.second_uvs.iter().all(|uv| uv.iter().all(|x| *x == 0. || *x == 1.)));
    assert!(!scene.warnings.iter().any(|w| w.contains("left out")), "{:?}", scene.warnings);
    assert!(scene.tangents.iter().all(|t| (Vec4::from(*t) - Vec4::new(1., 0., 0., 1.)).length() < 1e-6));
    let mut third = document.clone();
    third["materials"][0]["occlusionTexture"] =
        json!({"index": 0, "extensions": {"KHR_texture_transform": {"scale": [3, 3]}}});
    let left = made.load(&third).unwrap();
    assert_eq!(left.materials[0].occlusion_texture, None);
    assert!(left.materials[0].normal_texture.is_some());
    assert!(left.warnings.iter().any(|w| w.starts_with("1 textures left out that read a third kind of UVs")));
    document["materials"][0]["normalTexture"]["extensions"] =
        document["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"]["extensions"].clone();
    let scene = made.load(&document).unwrap();
    assert!(scene.materials[0].normal_texture.is_some());
    assert_sound(&scene);
}

#[test]
fn uvs_can_be_kept_without_a_texture() {
    let mut document = textured();
    document["materials"] = json!([{}]);
    let made = Fixture::new();
    assert!(made.load(&document).unwrap().uvs.is_empty());
    let options = LoadOptions { keep_uvs: true, ..LoadOptions::default() };
    assert_eq!(made.load_with(&document, &options).unwrap().uvs.len(), 4);
}

#[test]
fn sparse_and_quantized_accessors_are_read() {
    // Four positions as normalized signed bytes, the last replaced by a sparse one.
    let mut bytes = vec![0u8, 0, 0, 0, 127, 0, 0, 0, 0, 127, 0, 0, 0, 0, 0, 0];
    bytes.extend([0u8, 1, 2, 2, 1, 3, 3, 0]);
    bytes.extend([127u8, 127, 0x80]);
    let mut document = square();
    document["buffers"][0] = json!({"byteLength": bytes.len(), "uri": base64(&bytes)});
    document["bufferViews"] = json!([
        {"buffer": 0, "byteLength": 16, "byteStride": 4},
        {"buffer": 0, "byteOffset": 16, "byteLength": 8},
        {"buffer": 0, "byteOffset": 24, "byteLength": 3},
    ]);
    document["accessors"][0] = json!({
        "bufferView": 0, "componentType": 5120, "normalized": true, "type": "VEC3", "count": 4,
        "sparse": {
            "count": 1,
            "indices": {"bufferView": 1, "byteOffset": 6, "componentType": 5121},
            "values": {"bufferView": 2},
        },
    });
    document["extensionsRequired"] = json!(["KHR_mesh_quantization"]);
    let made = Fixture::new();
    let scene = made.load(&document).unwrap();
    assert_sound(&scene);
    // The most negative byte clamps to -1.
    assert_eq!(scene.bounds.size(), Vec3::splat(1000.0));
    document["accessors"][0]["sparse"]["indices"]["byteOffset"] = json!(5);
    document["accessors"][0]["sparse"]["count"] = json!(2);
    assert!(made.refusal(&document).contains("accessors[0].sparse"));
}

#[test]
fn lights_and_cameras_stand_where_their_nodes_are() {
    let mut document = square();
    document["extensions"] = json!({"KHR_lights_punctual": {"lights": [
        {"type": "directional", "intensity": 3, "color": [1, 0.5, 0]},
        {"type": "point", "range": 2},
        {"type": "spot", "spot": {"outerConeAngle": 0.5}},
    ]}});
    let light = |i: usize| json!({"KHR_lights_punctual": {"light": i}});
    let half = 0.5f64.sqrt();
    document["nodes"] = json!([
        {"mesh": 0, "children": [1, 2, 3, 4, 5]},
        // Turned so that -Z points down: the light comes from above.
        {"extensions": light(0), "rotation": [-half, 0, 0, half], "scale": [3, 3, 3]},
        {"extensions": light(1), "translation": [0, 0, 1]},
        {"extensions": light(2)},
        {"camera": 0, "translation": [0.5, 0.5, 2], "name": "front"},
        {"camera": 1},
    ]);
    document["cameras"] = json!([
        {"type": "perspective", "perspective": {"yfov": 0.5, "znear": 0.1}},
        {"type": "orthographic", "orthographic": {"xmag": 1, "ymag": 0.5, "znear": 0, "zfar": 10}},
    ]);
    let made = Fixture::new();
    let scene = made.load(&document).unwrap();
    let [sun, bulb, spot] = &scene.lights[..] else { panic!() };
    let LightKind::Directional { direction } = sun.kind else { panic!() };
    assert!((direction - Vec3::Y).length() < 1e-6 && sun.intensity == 3.0 && sun.color[1] == 0.5);
    let LightKind::Point { position } = bulb.kind else { panic!() };
    assert_eq!((position, bulb.range_mm), (Vec3::new(-500.0, -500.0, 1000.0), Some(2000.0)));
    let LightKind::Spot { direction, inner_cos, outer_cos, .. } = spot.kind else { panic!() };
    assert_eq!((direction, inner_cos), (Vec3::NEG_Z, 1.0));
    assert!((outer_cos - 0.5f32.cos()).abs() < 1e-6);
    let [front, flat] = &scene.cameras[..] else { panic!() };
    assert_eq!((front.name.as_str(), front.eye), ("front", Vec3::new(0.0, 0.0, 2000.0)));
    assert_eq!((front.forward, front.up, front.near_mm), (Vec3::NEG_Z, Vec3::Y, 100.0));
    assert_eq!(flat.projection, Projection::Orthographic { height_mm: 1000.0 });
    document["cameras"][0]["perspective"]["yfov"] = json!(4);
    assert!(made.refusal(&document).contains("cameras[0].perspective: it sees nothing"));
}

/// The inside of a material, by both spellings of the draft, its successor and the plain extension; and what makes no sense.
#[test]
fn scattering_is_read_however_it_is_spelt() {
    let made = Fixture::new();
    let load = |extensions: serde_json::Value| {
        let mut document = square();
        document["materials"] = json!([{"name": "wax", "extensions": extensions}]);
        document["meshes"][0]["primitives"][0]["material"] = json!(0);
        let options = LoadOptions { mm_per_unit: Some(10.0), ..LoadOptions::default() };
        made.load_with(&document, &options).unwrap()
    };
    let volume = json!({"attenuationDistance": 0.2, "attenuationColor": [0.5, 0.25, 0.125]});
    let expected = Scattering {
        distance_mm: 2.0,
        attenuation: [0.5, 0.25, 0.125],
        multiscatter: [0.5, 0.75, 1.0].map(|c: f32| f64::from(c)),
        anisotropy: 0.0,
    };
    let color = [0.5, 0.75, 1.0];
    for of in [
        json!({"KHR_materials_volume_scatter": {"multiscatterColor": color}}),
        json!({"KHR_materials_volume_scatter": {"multiscatterColorFactor": color}}),
        json!({"KHR_materials_scatter": {"scatterStrengthFactor": 1, "multiscatterColorFactor": color}}),
        json!({"KHR_materials_diffuse_transmission":
            {"diffuseTransmissionFactor": 0.5, "diffuseTransmissionColorFactor": color}}),
    ] {
        let mut of = of;
        of["KHR_materials_volume"] = volume.clone();
        let scene = load(of.clone());
        assert!(scene.materials[0].translucent, "{of}");
        assert_eq!(scene.materials[0].scattering, Some(expected), "{of}");
        assert_eq!(scene.scatterings().len(), 1);
    }
    // Glass holds light, too, but does not scatter it.
    let glass = load(json!({"KHR_materials_volume": volume}));
    assert!(!glass.materials[0].translucent && glass.materials[0].scattering.is_none());
    // Strength 0 scatters nothing.
    let still =
        load(json!({"KHR_materials_volume": volume, "KHR_materials_scatter": {"multiscatterColorFactor": color}}));
    assert_eq!(still.materials[0].scattering, None);
    let odd = load(json!({
        "KHR_materials_volume": {"attenuationDistance": -1, "attenuationColor": [0.5, 0.5, 0.5]},
        "KHR_materials_volume_scatter": {"multiscatterColor": [2, 0.5, 0.5]},
    }));
    assert_eq!(odd.materials[0].scattering, None);
    for words in ["attenuationDistance: light goes on for ever", "multiscatterColor: 2 makes no sense; 1 is taken"] {
        assert!(odd.warnings.iter().any(|w| w.contains(words)), "{:?}", odd.warnings);
    }
}

/// A texture of light that cannot be read leaves no light: its factor, mostly white, would glow all over.
#[test]
fn emission_without_its_texture_is_dark() {
    let made = Fixture::new();
    std::fs::write(made.0.path().join("a.png"), png(1, 1)).unwrap();
    let mut document = textured();
    document["materials"][0]["emissiveFactor"] = json!([1, 1, 1]);
    document["materials"][0]["normalTexture"]["texCoord"] = json!(1);
    let mut load = |set: u32| {
        document["materials"][0]["emissiveTexture"] = json!({"index": 0, "texCoord": set});
        made.load(&document).unwrap()
    };
    let glowing = load(0);
    assert!(glowing.materials[0].emission == [1.; 3] && glowing.materials[0].emission_texture.is_some());
    let dark = load(2);
    assert!(dark.materials[0].emission == [0.; 3] && dark.materials[0].emission_texture.is_none());
    assert!(dark.warnings.iter().any(|w| w.starts_with("1 textures left out that read a third kind of UVs")));
    std::fs::write(made.0.path().join("a.png"), b"GIF89a\x01\0\x01\0\0\0\0").unwrap();
    assert_eq!(load(0).materials[0].emission, [0.; 3]);
}

/// Factors, colours of vertices and the like: as they stand, or said and brought into their range.
#[test]
fn emission_unlit_and_colours_of_vertices_are_read() {
    let mut document = square();
    document["materials"] = json!([{
        "emissiveFactor": [1, 0.5, 0.25],
        "pbrMetallicRoughness": {"roughnessFactor": -3, "metallicFactor": 0.5},
        "extensions": {
            "KHR_materials_emissive_strength": {"emissiveStrength": 8},
            "KHR_materials_unlit": {},
            "KHR_materials_specular": {"specularFactor": 0.25},
        },
    }]);
    document["meshes"][0]["primitives"][0]["material"] = json!(0);
    let made = Fixture::new();
    let scene = made.load(&document).unwrap();
    let material = &scene.materials[0];
    assert_eq!((material.emission, material.unlit, material.specular.factor), ([8., 4., 2.], true, 0.25));
    assert_eq!((material.roughness, material.metallic), (0.0, 0.5));
    let said = "materials[0].pbrMetallicRoughness.roughnessFactor: -3 makes no sense; 0 is taken";
    assert!(scene.warnings.iter().any(|w| w == said), "{:?}", scene.warnings);
    assert!(scene.colors.is_empty());
    add_attribute(&mut document, "COLOR_0", "VEC3", &[0.5, 0.25, 2.0].repeat(4));
    assert_eq!(made.load(&document).unwrap().colors, [[0.5, 0.25, 2.0, 1.0]; 4]);
}
