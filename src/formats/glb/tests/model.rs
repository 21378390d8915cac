//! Single models, made here and by other programs.

use std::path::PathBuf;

use glam::DVec3;
use scene::{BoxId, Class, Extent, Paint};
use serde_json::json;

use super::{Blocks, read, read_at, text};

#[test]
fn a_single_model_is_one_box_ahead_of_the_vehicle() {
    let car = Blocks::of(&[("body", DVec3::new(0.0, 0.3, 0.0), DVec3::new(1.9, 1.5, 4.4))]);
    let loaded = read_at(&text(&car), "my_sedan", None).expect("a car");
    let b = loaded.scene.frame().boxes[&BoxId(1)];
    assert_eq!((b.class, b.label.name.as_str()), (Class::Car, "my_sedan"));
    assert!(
        (b.center_m - DVec3::new(10.2, 0.0, 0.75)).length() < 1e-5 && b.yaw_rad == 0.0,
        "{}",
        b.center_m
    );
    assert!((b.size_m - DVec3::new(4.4, 1.9, 1.5)).length() < 1e-6);
    let voxels = loaded
        .scene
        .frame()
        .occupancy
        .iter_set()
        .filter(|v| v.3 == 4)
        .count();
    assert!((44 * 6..60 * 8).contains(&voxels), "{voxels} voxels");
    assert!(loaded.inferred.is_empty());
    // By its size, where no name tells: a guess.
    let loaded = read_at(&text(&car), "untitled", None).expect("a car");
    assert_eq!(loaded.scene.frame().boxes[&BoxId(1)].class, Class::Car);
    assert_eq!(
        (loaded.inferred, loaded.scene.frame().inferred.boxes.len()),
        (&["boxes"][..], 1)
    );
    // Where it stands elsewhere on the map it stays, on the ground.
    let aside = Blocks::of(&[("bench", DVec3::new(6.0, 7.0, 9.0), DVec3::new(2.0, 1.0, 1.0))]);
    let loaded = read(&text(&aside));
    let frame = loaded.scene.frame();
    assert!(frame.boxes.is_empty());
    let bench: Vec<_> = frame
        .occupancy
        .iter_set()
        .filter(|v| v.3 == Class::Manmade.id())
        .collect();
    let [x, y] = Extent::WINDOW.column_at(6.0, -9.0).expect("on the map");
    assert!(
        !bench.is_empty()
            && bench
                .iter()
                .all(|v| v.0.abs_diff(x) < 4 && v.1.abs_diff(y) < 4 && v.2 < 6)
    );
}

/// A body and four tyres, as a foreign program writes them.
fn truck() -> Blocks {
    let mut out = Blocks::new();
    out.block("body", DVec3::new(0.0, 1.2, 0.0), DVec3::new(1.9, 1.5, 4.4));
    for (x, z) in [(-0.8, -1.4), (0.8, -1.4), (-0.8, 1.4), (0.8, 1.4)] {
        out.block("tyre", DVec3::new(x, 0.4, z), DVec3::new(0.3, 0.8, 0.8));
    }
    out
}

fn painted(document: &serde_json::Value, name: &str) -> Option<Paint> {
    let loaded = read_at(&text(document), name, None).expect("a truck");
    loaded.scene.frame().boxes[&BoxId(1)].label.paint
}

#[test]
fn a_model_is_painted_as_its_materials_say() {
    let mut document = truck().document();
    assert_eq!(painted(&document, "truck"), None, "nothing says a colour");
    document["materials"] = json!([
        {"pbrMetallicRoughness": {"baseColorFactor": [0.83, 0.55, 0.01, 1.0]}},
        {"pbrMetallicRoughness": {"baseColorFactor": [0.01, 0.01, 0.01, 1.0]}},
        {"pbrMetallicRoughness": {"baseColorFactor": [0.8, 0.0, 0.0, 0.2]}, "alphaMode": "BLEND"},
    ]);
    for i in 0..5 {
        document["meshes"][i]["primitives"][0]["material"] = json!(usize::from(i > 0));
    }
    assert_eq!(painted(&document, "truck"), Some(Paint::Yellow));
    // What is seen through has no paint.
    document["meshes"][0]["primitives"][0]["material"] = json!(2);
    assert_eq!(painted(&document, "truck"), Some(Paint::Black));
    // A name tells it where no material does; a material is believed first.
    let plain = truck().document();
    assert_eq!(painted(&plain, "vehicle-truck-yellow"), Some(Paint::Yellow));
    assert_eq!(painted(&document, "vehicle-truck-yellow"), Some(Paint::Black));
}

#[test]
fn a_model_is_painted_as_the_picture_of_its_material_says() {
    let mut blocks = truck();
    // Eight corners, all in the left half of the picture.
    let places: Vec<u8> = (0..16)
        .flat_map(|i| (if i % 2 == 0 { 0.25f32 } else { 0.5 }).to_le_bytes())
        .collect();
    let view = blocks.view(&places);
    blocks
        .accessors
        .push(json!({"bufferView": view, "componentType": 5126, "count": 8, "type": "VEC2"}));
    let places = blocks.accessors.len() - 1;
    let mut png = std::io::Cursor::new(Vec::new());
    image::RgbImage::from_fn(64, 64, |x, _| {
        image::Rgb(if x < 32 { [250, 205, 60] } else { [20, 60, 190] })
    })
    .write_to(&mut png, image::ImageFormat::Png)
    .expect("encoded");
    let view = blocks.view(png.get_ref());
    let mut document = blocks.document();
    document["images"] = json!([{"bufferView": view, "mimeType": "image/png"}]);
    document["textures"] = json!([{"source": 0}]);
    let paint_of = |document: &mut serde_json::Value, texture: serde_json::Value| {
        document["materials"] = json!([{"pbrMetallicRoughness": {"baseColorTexture": texture}}]);
        for i in 0..5 {
            let primitive = &mut document["meshes"][i]["primitives"][0];
            primitive["attributes"]["TEXCOORD_0"] = json!(places);
            primitive["material"] = json!(0);
        }
        painted(document, "truck")
    };
    let of = |x: f64| json!({"index": 0, "extensions": {"KHR_texture_transform": {"offset": [x, 0.0]}}});
    assert_eq!(paint_of(&mut document, json!({"index": 0})), Some(Paint::Yellow));
    assert_eq!(paint_of(&mut document, of(0.5)), Some(Paint::Blue));
    assert_eq!(
        paint_of(&mut document, of(7.0)),
        Some(Paint::Yellow),
        "pictures repeat"
    );
    // A picture that cannot be read says nothing, and the model is read all the same.
    document["images"] = json!([{"uri": "elsewhere.png"}]);
    assert_eq!(paint_of(&mut document, json!({"index": 0})), None);
}

/// The sample models, where they are: real files of another program.
#[test]
fn sample_models_are_read() {
    let beside = concat!(env!("CARGO_MANIFEST_DIR"), "/../../../shared/data");
    let folder = std::env::var_os("SCENELOOM_DATA").map_or_else(|| PathBuf::from(beside), PathBuf::from);
    let folder = folder.join("gltf");
    if !folder.is_dir() {
        return println!("{}: no sample models there", folder.display());
    }
    let read = |name: &str| {
        let path = folder.join(name);
        let bytes = std::fs::read(&path).expect(name);
        let stem = path.file_stem().expect("a name").to_string_lossy().into_owned();
        read_at(&bytes, &stem, Some(path)).expect(name).scene
    };
    for (name, class, paint, size_m) in [
        (
            "racing/vehicle-truck-yellow.glb",
            Class::Truck,
            Paint::Yellow,
            [2.8, 1.5, 1.55],
        ),
        (
            "racing/vehicle-motorcycle.glb",
            Class::Motorcycle,
            Paint::Green,
            [2.44, 1.09, 1.27],
        ),
        (
            "platformer/character.glb",
            Class::Pedestrian,
            Paint::Purple,
            [0.64, 1.2, 1.1],
        ),
    ] {
        let scene = read(name);
        let b = scene.frame().boxes[&BoxId(1)];
        assert_eq!((b.class, b.label.paint), (class, Some(paint)), "{name}");
        assert!(
            (b.size_m - DVec3::from_array(size_m)).abs().max_element() < 0.02,
            "{name}: {}",
            b.size_m
        );
        assert!(b.yaw_rad == 0.0 && (b.center_m.z - b.size_m.z / 2.0).abs() < 1e-6);
        let own = scene.frame().occupancy.iter_set().filter(|v| v.3 == class.id());
        assert!(own.count() >= 6, "{name}");
    }
    for (name, class) in [
        ("city/building-small-c.glb", Class::Manmade),
        ("city/building-garage.glb", Class::Manmade),
        ("city/grass-trees-tall.glb", Class::Vegetation),
    ] {
        let scene = read(name);
        assert!(scene.frame().boxes.is_empty(), "{name}");
        let voxels = scene.frame().occupancy.iter_set().filter(|v| v.3 == class.id());
        assert!(voxels.count() >= 6, "{name}");
    }
}
