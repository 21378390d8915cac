//! How numbers are stored, files beside the document, and what is wrong with a file.

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use glam::DVec3;
use serde_json::{Value, json};

use super::{Blocks, read, read_at, refusal, text};

#[test]
fn other_ways_to_store_numbers_are_read() {
    let plain = Blocks::of(&[
        ("house", DVec3::new(9.0, 2.0, 0.0), DVec3::new(8.0, 4.0, 6.0)),
        ("road", DVec3::ZERO, DVec3::new(50.0, 0.1, 8.0)),
    ]);
    let expected = read(&text(&plain)).scene.frame().occupancy.clone();
    let same = |document: &Value, what: &str| {
        assert!(
            read(&text(document)).scene.frame().occupancy == expected,
            "{what}"
        );
    };
    // Quantised to 16 bits, normalised.
    let corners: Vec<u8> = (0..8u32)
        .flat_map(|i| [0, 1, 2].map(|axis| if i >> axis & 1 == 0 { -32767i16 } else { 32767 }))
        .flat_map(i16::to_le_bytes)
        .collect();
    let with = |bytes: &[u8], accessor: Value, scale: Option<[f64; 3]>| {
        let mut document = plain.clone();
        let data = format!("data:;base64,{}", STANDARD.encode(bytes));
        document["buffers"]
            .as_array_mut()
            .expect("buffers")
            .push(json!({"byteLength": bytes.len(), "uri": data}));
        document["bufferViews"]
            .as_array_mut()
            .expect("views")
            .push(json!({"buffer": 1, "byteLength": bytes.len()}));
        document["accessors"][0] = accessor;
        if let Some(scale) = scale {
            document["nodes"][0]["scale"] = json!(scale);
        }
        document
    };
    let quantised =
        json!({"bufferView": 4, "componentType": 5122, "normalized": true, "count": 8, "type": "VEC3"});
    let mut document = with(&corners, quantised, Some([4.0, 2.0, 3.0]));
    document["extensionsRequired"] = json!(["KHR_mesh_quantization"]);
    same(&document, "quantised");
    // Zeros, all of them replaced.
    let mut sparse: Vec<u8> = (0..8u8).collect();
    sparse.extend(
        (0..8u32)
            .flat_map(|i| {
                let half = [4.0f32, 2.0, 3.0];
                [0, 1, 2].map(|axis| {
                    if i >> axis & 1 == 0 {
                        -half[axis]
                    } else {
                        half[axis]
                    }
                })
            })
            .flat_map(f32::to_le_bytes),
    );
    let replaced = json!({"componentType": 5126, "count": 8, "type": "VEC3", "sparse": {"count": 8,
        "indices": {"bufferView": 4, "componentType": 5121}, "values": {"bufferView": 4, "byteOffset": 8}}});
    same(&with(&sparse, replaced, None), "sparse");
    // Triangles that are listed corner by corner, as a fan and as a strip of their own.
    let mut document = plain.clone();
    document["meshes"][0]["primitives"][0]["mode"] = json!(1);
    assert_eq!(read(&text(&document)).skipped["meshes of points or lines"], 1);
    document["meshes"][0]["primitives"][0]["mode"] = json!(5);
    read(&text(&document));
}

#[test]
fn strips_and_fans_have_their_triangles() {
    for (mode, order) in [(5, [0, 1, 2, 3]), (6, [0, 1, 3, 2])] {
        let corners: Vec<u8> = order
            .into_iter()
            .flat_map(|i: u32| {
                [
                    f64::from(i % 2) * 30.0 - 15.0,
                    0.0,
                    f64::from(i / 2) * 30.0 - 15.0,
                ]
            })
            .flat_map(|v| (v as f32).to_le_bytes())
            .collect();
        let document = json!({
            "asset": {"version": "2.0"},
            "nodes": [{"mesh": 0, "name": "road"}],
            "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "mode": mode}]}],
            "accessors": [{"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3"}],
            "bufferViews": [{"buffer": 0, "byteLength": 48}],
            "buffers": [{"byteLength": 48, "uri": format!("data:;base64,{}", STANDARD.encode(corners))}],
        });
        let road = read(&text(&document)).scene.frame().occupancy.count_set();
        assert!((75 * 75..77 * 77).contains(&road), "mode {mode}: {road} voxels");
    }
}

#[test]
fn buffers_beside_the_file_are_read_and_no_others() {
    let mut document = Blocks::of(&[("house", DVec3::new(20.0, 2.0, 0.0), DVec3::new(8.0, 4.0, 6.0))]);
    let data = document["buffers"][0]["uri"].as_str().expect("a data address");
    let bytes = STANDARD
        .decode(data.split_once(',').expect("data").1)
        .expect("base64");
    let folder = tempfile::tempdir().expect("a folder");
    std::fs::create_dir(folder.path().join("a file")).expect("a folder");
    std::fs::create_dir(folder.path().join("a file/buffers")).expect("a folder");
    std::fs::write(folder.path().join("a file/buffers/mesh 1.bin"), &bytes).expect("written");
    std::fs::write(folder.path().join("secret.bin"), &bytes).expect("written");
    let path = folder.path().join("a file/scene.gltf");
    let mut read_from = |uri: &str| {
        document["buffers"][0]["uri"] = json!(uri);
        read_at(&text(&document), "a file", Some(path.clone()))
    };
    read_from("buffers/mesh%201.bin").expect("beside it");
    read_from("./buffers/mesh%201.bin").expect("beside it");
    for uri in [
        "../secret.bin",
        "buffers/../../secret.bin",
        "%2e%2e/secret.bin",
        "..\\secret.bin",
        "/etc/hostname",
        "file:///etc/hostname",
        "https://example.org/mesh.bin",
        "",
    ] {
        let line = read_from(uri).expect_err(uri).to_string();
        assert!(
            line.contains("expected the name of a file in the same folder"),
            "{uri}: {line}"
        );
    }
    assert!(
        read_from("missing.bin")
            .expect_err("missing")
            .to_string()
            .contains("missing.bin")
    );
    let line = read_at(&text(&document), "a file", None)
        .expect_err("no folder")
        .to_string();
    assert!(line.contains("read from memory"), "{line}");
}

#[test]
fn bad_foreign_files_are_one_line() {
    let sound = Blocks::of(&[("house", DVec3::new(20.0, 2.0, 0.0), DVec3::new(8.0, 4.0, 6.0))]);
    let with = |pointer: &str, value: Value| {
        let mut document = sound.clone();
        *document.pointer_mut(pointer).expect(pointer) = value;
        refusal(&text(&document))
    };
    assert!(with("/asset/version", json!("1.0")).contains("expected 2.0"));
    assert!(with("/accessors/0/count", json!(4_000_000_000u64)).contains("4000000000 elements"));
    assert!(with("/accessors/1/count", json!(4_000_000_000u64)).contains("triangles, expected at most"));
    assert!(with("/accessors/1/count", json!(100_000)).contains("100000 elements"));
    assert!(with("/bufferViews/0/byteLength", json!(4_000_000_000u64)).contains("4000000000 bytes"));
    assert!(with("/bufferViews/0/byteOffset", json!(u64::MAX)).contains("18446744073709551615"));
    assert!(with("/buffers/0/byteLength", json!(1 << 30)).contains("expected 1073741824"));
    assert!(with("/buffers/0/uri", json!("data:;base64,!!!")).contains("buffer 0"));
    assert!(with("/buffers/0/uri", json!("data:text/plain,abc")).contains("not base64"));
    assert!(with("/nodes/0/mesh", json!(7)).contains("mesh 7"));
    assert!(with("/scene", json!(3)).contains("scene 3"));
    assert!(with("/scenes/0/nodes", json!([0, 0])).contains("two parents"));
    assert!(with("/scenes/0/nodes", json!([])).contains("no triangles"));
    assert!(with("/accessors/0/type", json!("SCALAR")).contains("expected positions"));
    assert!(with("/accessors/0/componentType", json!(1)).contains("accessor 0"));
    assert!(with("/meshes/0/primitives/0/attributes", json!({"POSITION": 1})).contains("expected positions"));
    assert!(with("/nodes/0", json!({"children": [0], "name": "x".repeat(100_000)})).contains("two parents"));
    let mut document = sound.clone();
    document["extensionsRequired"] = json!(["KHR_draco_mesh_compression"]);
    assert!(refusal(&text(&document)).contains("KHR_draco_mesh_compression"));
    // A chain of nodes.
    let mut document = sound.clone();
    let mut chain: Vec<Value> = (1..5000).map(|i| json!({"children": [i]})).collect();
    chain.push(json!({"mesh": 0}));
    document["nodes"] = json!(chain);
    assert!(refusal(&text(&document)).contains("below 257 others"));
    // Numbers that are not finite are left out.
    let bytes: Vec<u8> = [f32::NAN; 24].into_iter().flat_map(f32::to_le_bytes).collect();
    let mut document = sound;
    let data = format!("data:;base64,{}", STANDARD.encode(&bytes));
    document["buffers"]
        .as_array_mut()
        .expect("buffers")
        .push(json!({"byteLength": bytes.len(), "uri": data}));
    document["bufferViews"][0] = json!({"buffer": 1, "byteLength": bytes.len()});
    assert!(refusal(&text(&document)).contains("no triangles"));
    document["nodes"] = json!([document["nodes"][0], {"mesh": 1, "name": "road"}]);
    let second = Blocks::of(&[
        ("road", DVec3::ZERO, DVec3::ONE),
        ("road", DVec3::ZERO, DVec3::new(50.0, 0.1, 9.0)),
    ]);
    for list in ["accessors", "bufferViews", "meshes"] {
        let mut all = second[list].as_array().expect("a list").clone();
        all.extend(document[list].as_array().expect("a list").iter().cloned());
        document[list] = json!(all);
    }
    document["buffers"] = json!([second["buffers"][0], document["buffers"][1]]);
    document["accessors"][0]["bufferView"] = json!(4);
    document["scenes"][0]["nodes"] = json!([0, 1]);
    document["nodes"][0]["mesh"] = json!(0);
    assert_eq!(
        read(&text(&document)).skipped["triangles with numbers that are not finite"],
        12
    );
}
