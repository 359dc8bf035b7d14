//! What lies over and under a surface, as files have it: coat, sheen, specular, scatter mask, thickness.

use pdss::scene::{Coat, Sheen};
use serde_json::{Value, json};

use crate::check::assert_sound;
use crate::fixture::{Fixture, add_attribute, square};

/// A picture of 2 x 1 whose alpha is these two bytes.
fn alpha(left: u8, right: u8) -> Vec<u8> {
    let mut bytes = std::io::Cursor::new(Vec::new());
    let image = image::RgbaImage::from_fn(2, 1, |x, _| image::Rgba([9, 99, 9, if x == 0 { left } else { right }]));
    image.write_to(&mut bytes, image::ImageFormat::Png).unwrap();
    bytes.into_inner()
}

/// The square with UVs, one texture and a material of these extensions.
fn with(extensions: Value) -> Value {
    let mut document = square();
    add_attribute(&mut document, "TEXCOORD_0", "VEC2", &[0., 1., 1., 1., 0., 0., 1., 0.]);
    document["images"] = json!([{"uri": "a.png"}]);
    document["textures"] = json!([{"source": 0}]);
    document["materials"] = json!([{"pbrMetallicRoughness": {"metallicFactor": 0}, "extensions": extensions}]);
    document["meshes"][0]["primitives"][0]["material"] = json!(0);
    document
}

#[test]
fn coat_sheen_and_specular_are_read_with_their_textures() {
    let made = Fixture::new();
    std::fs::write(made.0.path().join("a.png"), alpha(0, 255)).unwrap();
    let scene = made
        .load(&with(json!({
            "KHR_materials_clearcoat": {"clearcoatFactor": 0.75, "clearcoatRoughnessFactor": 0.25,
                "clearcoatTexture": {"index": 0}, "clearcoatRoughnessTexture": {"index": 0},
                "clearcoatNormalTexture": {"index": 0}},
            "KHR_materials_sheen": {"sheenColorFactor": [0.5, 0.25, 7], "sheenColorTexture": {"index": 0}},
            "KHR_materials_specular": {"specularFactor": 0.5, "specularColorFactor": [2, 1, 0],
                "specularTexture": {"index": 0}, "specularColorTexture": {"index": 0}},
        })))
        .unwrap();
    assert_sound(&scene);
    let m = &scene.materials[0];
    let linear = m.specular.factor_texture;
    let srgb = m.specular.color_texture;
    assert!(!scene.textures[linear.unwrap()].srgb && scene.textures[srgb.unwrap()].srgb && scene.textures.len() == 2);
    assert_eq!(m.coat, Coat { factor: 0.75, roughness: 0.25, factor_texture: linear, roughness_texture: linear });
    let sheen = Sheen { color: [0.5, 0.25, 1.], roughness: 0., color_texture: srgb, roughness_texture: None };
    assert_eq!(m.sheen, sheen);
    assert_eq!((m.specular.factor, m.specular.color), (0.5, [2., 1., 0.]));
    assert!(m.is_coated());
    for said in ["sheenColorFactor: 7 makes no sense; 1 is taken", "clearcoatNormalTexture: not read"] {
        assert!(scene.warnings.iter().any(|w| w.contains(said)), "{said}: {:?}", scene.warnings);
    }
    // Nothing that is not seen is read; a reference that leads nowhere is refused all the same.
    let off = json!({"KHR_materials_clearcoat": {"clearcoatTexture": {"index": 0}}, "KHR_materials_sheen": {},
        "KHR_materials_specular": {}});
    let scene = made.load(&with(off)).unwrap();
    assert!(!scene.materials[0].is_coated() && scene.textures.is_empty());
    let nowhere = json!({"KHR_materials_clearcoat": {"clearcoatTexture": {"index": 5}}});
    assert!(made.refusal(&with(nowhere)).contains("clearcoatTexture.index"));
}

#[test]
fn a_mask_that_is_one_number_is_no_texture_and_none_at_all_scatters_nothing() {
    let made = Fixture::new();
    let through = json!({"KHR_materials_diffuse_transmission": {"diffuseTransmissionFactor": 0.5,
        "diffuseTransmissionTexture": {"index": 0}}});
    for (pair, mask, textured) in [([51, 204], 0.5, true), ([255, 255], 0.5, false), ([0, 0], 0., false)] {
        std::fs::write(made.0.path().join("a.png"), alpha(pair[0], pair[1])).unwrap();
        let mut scene = made.load(&with(through.clone())).unwrap();
        let m = &scene.materials[0];
        assert_eq!((m.scatter_mask, m.scatter_mask_texture.is_some()), (mask, textured), "{pair:?}");
        scene.assign_profile(None, 0).unwrap();
        assert_eq!(scene.materials[0].scatter.is_some(), mask > 0.);
    }
    let volume = json!({"KHR_materials_volume": {"thicknessFactor": 0.002, "thicknessTexture": {"index": 0}}});
    let scene = made.load(&with(volume)).unwrap();
    let m = &scene.materials[0];
    assert!((m.thickness_mm - 2.).abs() < 1e-6 && m.thickness_texture.is_some());
}

#[test]
fn vertices_that_tangents_double_keep_all_they_have() {
    // Two triangles whose coordinates are mirrored: the vertices between them need two tangents.
    let made = Fixture::new();
    std::fs::write(made.0.path().join("a.png"), alpha(255, 255)).unwrap();
    let mut document = with(json!({}));
    add_attribute(&mut document, "TEXCOORD_1", "VEC2", &[0., 0., 1., 0., 0., 1., 0., 0.]);
    add_attribute(&mut document, "COLOR_0", "VEC4", &[0.1f32, 0.2, 0.3, 1.].repeat(4));
    document["materials"][0]["pbrMetallicRoughness"] = json!({"baseColorTexture": {"index": 0}});
    for set in [0, 1] {
        document["materials"][0]["normalTexture"] = json!({"index": 0, "texCoord": set});
        let scene = made.load(&document).unwrap();
        assert_sound(&scene);
        assert_eq!(scene.positions.len() > 4, set == 1, "mirrored on the second set alone");
        let all = scene.positions.len();
        assert_eq!([scene.colors.len(), scene.uvs.len(), scene.tangents.len()], [all; 3]);
        assert_eq!(scene.second_uvs.len(), if set == 1 { all } else { 0 });
    }
}
