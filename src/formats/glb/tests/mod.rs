//! Files as other programs write them, and ours after a stay elsewhere.

mod files;
mod foreign;
mod model;
mod own;
mod work;

use std::path::PathBuf;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use glam::DVec3;
use serde_json::{Value, json};

use crate::FormatError;
use crate::import::glb::IMPORTER;
use crate::import::{Content, ImportFile, ImportedScene};

fn read_at(bytes: &[u8], name: &str, path: Option<PathBuf>) -> Result<ImportedScene, FormatError> {
    let source = ImportFile {
        bytes,
        name,
        path: path.as_deref(),
        options: Default::default(),
    };
    match (IMPORTER.read)(&source)? {
        Content::Scene(loaded) => Ok(*loaded),
        other => panic!("{other:?}, expected a scene"),
    }
}

fn read(bytes: &[u8]) -> ImportedScene {
    read_at(bytes, "a file", None).expect("sound")
}

fn refusal(bytes: &[u8]) -> String {
    let line = read_at(bytes, "a file", None).expect_err("refused").to_string();
    assert!(!line.contains('\n') && line.chars().count() <= 300, "{line}");
    line
}

/// A document of blocks as a foreign program writes it: name, place of the middle and size, all in the axes of glTF (y up).
struct Blocks {
    nodes: Vec<Value>,
    meshes: Vec<Value>,
    accessors: Vec<Value>,
    views: Vec<Value>,
    bytes: Vec<u8>,
}

impl Blocks {
    fn new() -> Self {
        Self {
            nodes: Vec::new(),
            meshes: Vec::new(),
            accessors: Vec::new(),
            views: Vec::new(),
            bytes: Vec::new(),
        }
    }

    fn of(blocks: &[(&str, DVec3, DVec3)]) -> Value {
        let mut out = Self::new();
        blocks
            .iter()
            .for_each(|(name, at, size)| out.block(name, *at, *size));
        out.document()
    }

    fn view(&mut self, bytes: &[u8]) -> usize {
        self.views
            .push(json!({"buffer": 0, "byteOffset": self.bytes.len(), "byteLength": bytes.len()}));
        self.bytes.extend(bytes);
        self.bytes.resize(self.bytes.len().next_multiple_of(4), 0);
        self.views.len() - 1
    }

    fn block(&mut self, name: &str, at: DVec3, size: DVec3) {
        let corners: Vec<u8> = (0..8u32)
            .flat_map(|i| [0, 1, 2].map(|axis| if i >> axis & 1 == 0 { -0.5 } else { 0.5 } * size[axis]))
            .flat_map(|v| (v as f32).to_le_bytes())
            .collect();
        let faces: [u8; 36] = [
            0, 2, 1, 1, 2, 3, 4, 5, 6, 5, 7, 6, 0, 1, 4, 1, 5, 4, 2, 6, 3, 3, 6, 7, 0, 4, 2, 2, 4, 6, 1, 3,
            5, 3, 7, 5,
        ];
        let (corners, faces) = (self.view(&corners), self.view(&faces));
        let n = self.accessors.len();
        self.accessors
            .push(json!({"bufferView": corners, "componentType": 5126, "count": 8, "type": "VEC3"}));
        self.accessors
            .push(json!({"bufferView": faces, "componentType": 5121, "count": 36, "type": "SCALAR"}));
        self.meshes
            .push(json!({"primitives": [{"attributes": {"POSITION": n}, "indices": n + 1}]}));
        self.nodes
            .push(json!({"name": name, "mesh": self.meshes.len() - 1, "translation": at.to_array()}));
    }

    fn document(self) -> Value {
        let data = format!(
            "data:application/octet-stream;base64,{}",
            STANDARD.encode(&self.bytes)
        );
        json!({
            "asset": {"version": "2.0"},
            "scene": 0,
            "scenes": [{"nodes": (0..self.nodes.len()).collect::<Vec<_>>()}],
            "nodes": self.nodes,
            "meshes": self.meshes,
            "accessors": self.accessors,
            "bufferViews": self.views,
            "buffers": [{"byteLength": self.bytes.len(), "uri": data}],
        })
    }
}

fn text(document: &Value) -> Vec<u8> {
    serde_json::to_vec(document).expect("JSON")
}
