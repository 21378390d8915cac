//! Large and far triangles: told from the file before any voxel is made.

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use scene::{Class, Extent};
use serde_json::{Value, json};

use super::{read, refusal, text};

/// A document of one node that shows one triangle (x and z of its corners in the axes of glTF, m) so many times.
fn pile(name: &str, corners: [[f32; 2]; 3], times: usize) -> Value {
    let mut bytes: Vec<u8> = corners
        .iter()
        .flat_map(|[x, z]| [*x, 1.0, *z])
        .flat_map(f32::to_le_bytes)
        .collect();
    bytes.extend([0u8, 1, 2].repeat(times));
    let uri = format!("data:application/octet-stream;base64,{}", STANDARD.encode(&bytes));
    json!({
        "asset": {"version": "2.0"},
        "scene": 0,
        "scenes": [{"nodes": [0, 1]}],
        "nodes": [{"name": name, "mesh": 0}, {"name": "empty"}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"},
            {"bufferView": 1, "componentType": 5121, "count": 3 * times, "type": "SCALAR"},
        ],
        "bufferViews": [
            {"buffer": 0, "byteOffset": 0, "byteLength": 36},
            {"buffer": 0, "byteOffset": 36, "byteLength": 3 * times},
        ],
        "buffers": [{"byteLength": bytes.len(), "uri": uri}],
    })
}

/// Around the origin, as large as the map or larger.
fn around(reach: f32) -> [[f32; 2]; 3] {
    [[-reach, -reach], [3.0 * reach, -reach], [-reach, 3.0 * reach]]
}

/// 50,000 of them took 13 s, a million more than 40 s.
#[test]
fn a_pile_of_large_triangles_is_refused_beforehand_and_named() {
    for (reach, times) in [(500.0, 1000), (500.0, 50_000), (1e9, 10_000), (39.0, 50_000)] {
        let line = refusal(&text(&pile("hall \"roof\"", around(reach), times)));
        let told = "triangles that cover about ";
        assert!(line.starts_with(told) && line.contains(" in node 0 "), "{line}");
        let columns: u64 = line[told.len()..]
            .split(' ')
            .next()
            .and_then(|n| n.parse().ok())
            .expect("a number");
        let each = columns as f64 / times as f64;
        let on_map = if reach < 100.0 {
            390.0 * 390.0 / 2.0
        } else {
            2048.0 * 2048.0
        };
        assert!(
            each > 0.9 * on_map && each < 1.2 * on_map,
            "{each} columns of {on_map}"
        );
    }
}

#[test]
fn some_large_triangles_are_read() {
    let loaded = read(&text(&pile("grass", around(39.0), 40)));
    let frame = loaded.scene.frame();
    assert_eq!(
        frame.extent(),
        Extent::new([-98, -293], [391, 391]).expect("sound")
    );
    let [x, y] = frame.extent().column_at(0.1, -0.1).expect("on the map");
    assert!(frame.occupancy.column(x, y).contains(&Class::Terrain.id()));
}

/// A triangle far away beside one that is near costs nothing, and the map does not grow with it.
#[test]
fn far_triangles_cost_nothing() {
    for far in [1e6f32, 1e11, 3e38] {
        let mut corners = around(10.0);
        corners[1] = [far, far];
        let loaded = read(&text(&pile("grass", corners, 20)));
        let extent = loaded.scene.frame().extent();
        assert!(extent.nx() <= 2048 && extent.ny() <= 2048, "{extent:?}");
    }
}
