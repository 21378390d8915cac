//! A scene as Gaussians in a GLB, by the ratified extension `KHR_gaussian_splatting` of glTF 2.0.

use glam::{Quat, Vec3};
use scene::truth::class_names;
use scene::{GaussianScene, SceneGaussian};
use serde_json::{Map, Value, json};

use super::{ExportSpan, Exporter, OutFile, Product};
use crate::glb::container;
use crate::recipe::{NAME, Recipe};
use crate::{FormatError, Holds};

/// See [`to_bytes`].
pub const EXPORTER: Exporter = Exporter {
    id: "gaussians-glb",
    title: "Splats: 3-D Gaussians, GLB (KHR_gaussian_splatting), a node for each box and class",
    file_name: Some("scene_gaussians.glb"),
    holds: &[Holds::Pictures],
    lost: "",
    span: ExportSpan::Moment,
    needs: &[Product::Gaussians],
    write: |_, products| {
        let gaussians = products.gaussians()?;
        let bytes = to_bytes(&gaussians, products.recipe())?;
        Ok(vec![OutFile::new("scene_gaussians.glb", bytes)])
    },
};

const EXTENSION: &str = "KHR_gaussian_splatting";
const FLOAT: u32 = 5126;
const UNSIGNED_BYTE: u32 = 5121;
const ARRAY_BUFFER: u32 = 34962;

/// GLB 2.0, y up: our (x, y, z) is (x, z, -y) there. Each box is a node with a mesh of one primitive of mode POINTS; so
/// is each class of the Gaussians that belong to no box, and so is the sky. Attributes besides those of the extension:
/// `COLOR_0` for viewers that do not know it (linear, as glTF wants it), `_CLASS` (as in truth maps) and `_STRENGTH`
/// (of a LiDAR's echo, 0 to 255). `extras` of a node name class and instance; those of the scene hold the recipe and
/// all classes. Errors if there is no Gaussian, or if there are more than 4 GiB of them, the most that a GLB holds.
pub fn to_bytes(scene: &GaussianScene, recipe: &Recipe) -> Result<Vec<u8>, FormatError> {
    let mut parts: Vec<&SceneGaussian> = scene.gaussians.iter().collect();
    if parts.is_empty() {
        return Err(FormatError::new("there are 0 Gaussians, expected at least one"));
    }
    parts.sort_by_key(|g| (g.instance, g.class));
    let names = class_names();
    let mut file = GlbBuilder::default();
    for part in parts.chunk_by(|a, b| (a.instance, a.class) == (b.instance, b.class)) {
        let (class, instance) = (part[0].class, part[0].instance);
        let class_name = names.get(usize::from(class)).map_or("others", String::as_str);
        let name = match instance {
            0 => class_name.to_owned(),
            id => format!("{class_name} {id}"),
        };
        let extras = json!({ "class": class, "class_name": class_name, "instance": instance });
        file.add(name, extras, part);
    }
    let b = &scene.baking;
    let extras = json!({
        "classes": names,
        "frame": "y up, m; ego x forward = x, ego y left = -z, ego z up = y",
        "baked_from": {
            "places": b.stands,
            "pictures": b.views,
            "size_px": b.size_px,
            "samples": b.samples,
            "most": b.most,
            "rounds": b.rounds,
        },
        NAME: recipe,
    });
    file.finish(extras)
}

/// A GLB that grows.
#[derive(Default)]
struct GlbBuilder {
    bytes: Vec<u8>,
    views: Vec<Value>,
    accessors: Vec<Value>,
    meshes: Vec<Value>,
    nodes: Vec<Value>,
}

impl GlbBuilder {
    /// An attribute of `count` elements, which `bytes` holds `stride` bytes apart; returns its accessor.
    fn attribute(&mut self, bytes: &[u8], stride: Option<usize>, mut accessor: Map<String, Value>) -> usize {
        let mut view = json!({
            "buffer": 0,
            "byteOffset": self.bytes.len(),
            "byteLength": bytes.len(),
            "target": ARRAY_BUFFER,
        });
        if let Some(stride) = stride {
            view["byteStride"] = stride.into();
        }
        self.bytes.extend(bytes);
        self.bytes.resize(self.bytes.len().next_multiple_of(4), 0);
        accessor.insert("bufferView".into(), self.views.len().into());
        self.views.push(view);
        self.accessors.push(accessor.into());
        self.accessors.len() - 1
    }

    fn floats<const N: usize>(&mut self, values: impl Iterator<Item = [f32; N]>) -> usize {
        let (mut bytes, mut count) = (Vec::new(), 0usize);
        for value in values {
            count += 1;
            bytes.extend(value.into_iter().flat_map(f32::to_le_bytes));
        }
        let kind = ["SCALAR", "VEC2", "VEC3", "VEC4"][N - 1];
        self.attribute(&bytes, None, accessor(FLOAT, kind, count))
    }

    /// A node, its mesh and its primitive.
    fn add(&mut self, name: String, extras: Value, part: &[&SceneGaussian]) {
        let place = |g: &&SceneGaussian| {
            let [x, y, z] = g.position_m;
            [x, z, -y]
        };
        let position = self.floats(part.iter().map(place));
        let (mut low, mut high) = (Vec3::INFINITY, Vec3::NEG_INFINITY);
        for p in part.iter().map(place).map(Vec3::from) {
            (low, high) = (low.min(p), high.max(p));
        }
        self.accessors[position]["min"] = json!(low.to_array());
        self.accessors[position]["max"] = json!(high.to_array());
        let rotation = self.floats(part.iter().map(|g| y_up(g.rotation_wxyz).to_array()));
        let scale = self.floats(part.iter().map(|g| g.std_m));
        let opacity = self.floats(part.iter().map(|g| [g.opacity]));
        let sh0 = self.floats(part.iter().map(|g| g.sh0()));
        let strength = self.floats(part.iter().map(|g| [g.strength]));
        let colors: Vec<u8> = part.iter().flat_map(|g| fallback(g)).collect();
        let mut color = accessor(UNSIGNED_BYTE, "VEC4", part.len());
        color.insert("normalized".into(), true.into());
        let color = self.attribute(&colors, None, color);
        // Attributes begin at multiples of four bytes.
        let classes: Vec<u8> = part.iter().flat_map(|g| [g.class, 0, 0, 0]).collect();
        let class = self.attribute(&classes, Some(4), accessor(UNSIGNED_BYTE, "SCALAR", part.len()));
        let mut attributes = Map::new();
        let mut set = |name: &str, accessor: usize| attributes.insert(name.to_owned(), accessor.into());
        set("POSITION", position);
        set("COLOR_0", color);
        set(&format!("{EXTENSION}:ROTATION"), rotation);
        set(&format!("{EXTENSION}:SCALE"), scale);
        set(&format!("{EXTENSION}:OPACITY"), opacity);
        set(&format!("{EXTENSION}:SH_DEGREE_0_COEF_0"), sh0);
        set("_CLASS", class);
        set("_STRENGTH", strength);
        self.nodes
            .push(json!({ "name": name, "mesh": self.meshes.len(), "extras": extras }));
        self.meshes.push(json!({
            "name": name,
            "primitives": [{
                "mode": 0,
                "attributes": attributes,
                "extensions": { EXTENSION: {
                    "kernel": "ellipse",
                    "colorSpace": "srgb_rec709_display",
                    "projection": "perspective",
                    "sortingMethod": "cameraDistance",
                } },
            }],
        }));
    }

    fn finish(self, extras: Value) -> Result<Vec<u8>, FormatError> {
        let nodes: Vec<usize> = (0..self.nodes.len()).collect();
        let document = json!({
            "asset": { "version": "2.0", "generator": concat!("sceneloom ", env!("CARGO_PKG_VERSION")) },
            "extensionsUsed": [EXTENSION],
            "scene": 0,
            "scenes": [{ "nodes": nodes, "extras": extras }],
            "nodes": self.nodes,
            "meshes": self.meshes,
            "accessors": self.accessors,
            "bufferViews": self.views,
            "buffers": [{ "byteLength": self.bytes.len() }],
        });
        container::join(document.to_string().as_bytes(), &self.bytes)
    }
}

fn accessor(component: u32, kind: &str, count: usize) -> Map<String, Value> {
    let mut out = Map::new();
    out.insert("componentType".into(), component.into());
    out.insert("type".into(), kind.into());
    out.insert("count".into(), count.into());
    out
}

/// The quaternion in a frame with y up.
fn y_up([w, x, y, z]: [f32; 4]) -> Quat {
    let half = std::f32::consts::FRAC_1_SQRT_2;
    (Quat::from_xyzw(-half, 0.0, 0.0, half) * Quat::from_xyzw(x, y, z, w)).normalize()
}

/// Linear colour and opacity, 255 is 1.
fn fallback(g: &SceneGaussian) -> [u8; 4] {
    let byte = |v: f32| (v.clamp(0.0, 1.0) * 255.0).round() as u8;
    let linear = |v: f32| match v.max(0.0) {
        v if v <= 0.040_45 => v / 12.92,
        v => ((v + 0.055) / 1.055).powf(2.4),
    };
    let [r, g_, b] = g.color.map(|v| byte(linear(v)));
    [r, g_, b, byte(g.opacity)]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::table_tests::two_gaussians;

    fn floats(bytes: &[u8]) -> Vec<f32> {
        let words = bytes.chunks_exact(4).map(|w| w.try_into().expect("four bytes"));
        words.map(f32::from_le_bytes).collect()
    }

    #[test]
    fn what_is_written_follows_the_extension() {
        let scene = two_gaussians();
        let bytes = to_bytes(&scene, &Recipe::default()).expect("two Gaussians");
        let chunks = container::split(&bytes).expect("a GLB");
        let document: Value = serde_json::from_slice(chunks.json).expect("JSON");
        let data = chunks.bin.expect("bytes");
        assert_eq!(document["buffers"][0]["byteLength"], data.len());
        assert_eq!(document["extensionsUsed"], json!([EXTENSION]));
        // What belongs to no box comes first.
        assert_eq!(document["nodes"].as_array().map(Vec::len), Some(2));
        assert_eq!(document["nodes"][1]["name"], "car 4");
        assert_eq!(document["nodes"][1]["extras"]["instance"], 4);
        let primitive = &document["meshes"][1]["primitives"][0];
        assert_eq!(primitive["mode"], 0);
        assert_eq!(primitive["extensions"][EXTENSION]["kernel"], "ellipse");
        let values = |name: &str| {
            let accessor =
                &document["accessors"][primitive["attributes"][name].as_u64().expect(name) as usize];
            let view = &document["bufferViews"][accessor["bufferView"].as_u64().expect("a view") as usize];
            let number = |key: &str| view[key].as_u64().expect("a number") as usize;
            assert_eq!(number("byteOffset") % 4, 0);
            data[number("byteOffset")..number("byteOffset") + number("byteLength")].to_vec()
        };
        let g = scene
            .gaussians
            .iter()
            .find(|g| g.instance == 4)
            .expect("the car's");
        let [x, y, z] = g.position_m;
        assert_eq!(floats(&values("POSITION")), [x, z, -y]);
        assert_eq!(floats(&values("KHR_gaussian_splatting:SCALE")), g.std_m);
        assert_eq!(floats(&values("KHR_gaussian_splatting:OPACITY")), [g.opacity]);
        assert_eq!(
            floats(&values("KHR_gaussian_splatting:SH_DEGREE_0_COEF_0")),
            g.sh0()
        );
        assert_eq!(values("_CLASS")[0], g.class);
        assert_eq!(floats(&values("_STRENGTH")), [g.strength]);
        // Its long axis lies along the turned heading, with y up.
        let q = floats(&values("KHR_gaussian_splatting:ROTATION"));
        let long = Quat::from_xyzw(q[0], q[1], q[2], q[3]) * Vec3::X;
        let [w, a, b, c] = g.rotation_wxyz;
        let heading = Quat::from_xyzw(a, b, c, w) * Vec3::X;
        assert!((long - Vec3::new(heading.x, heading.z, -heading.y)).length() < 1e-6);
    }

    #[test]
    fn no_gaussians_make_no_file() {
        let error = to_bytes(&GaussianScene::default(), &Recipe::default()).expect_err("nothing");
        assert!(error.to_string().contains("expected at least one"));
    }
}
