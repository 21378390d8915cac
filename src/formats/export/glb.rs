//! A scene as GLB: the occupancy as a mesh for each class, boxes as nodes; see [`crate::glb`].

use std::collections::BTreeMap;

use glam::DVec3;
use scene::clip::{MARGIN_M, ObjectVoxels};
use scene::raster::box_cells;
use scene::{BoxId, Class, Frame, Scene, SceneBox, VoxelGrid, Window};
use serde::Serialize;

use super::{ExportSpan, Exporter, OutFile};
use crate::glb::mesh::{Mesh, meshes};
use crate::glb::{
    BoxExtras, CLASS_MAP, ClassExtras, ExtrasHeader, SceneExtras, VERSION, container, y_up_from_z_up,
};
use crate::recipe::Recipe;
use crate::{FormatError, Holds};

/// See [`crate::glb`].
pub const EXPORTER: Exporter = Exporter {
    id: "glb",
    title: "Meshes: GLB (glTF 2.0) with a mesh for each class and a node for each box",
    file_name: Some("scene.glb"),
    holds: &[Holds::Occupancy, Holds::Boxes],
    lost: "",
    span: ExportSpan::Moment,
    needs: &[],
    write: |scene, products| {
        let bytes = to_bytes(scene, products.recipe())?;
        Ok(vec![OutFile::new("scene.glb", bytes)])
    },
};

/// The scene of the moment as a GLB file, with how it came to be.
pub fn to_bytes(scene: &Scene, recipe: &Recipe) -> Result<Vec<u8>, FormatError> {
    let frame = scene.frame();
    if let Some(problem) = frame.boxes.values().find_map(SceneBox::problem) {
        return Err(FormatError::new(problem));
    }
    let (still, own) = apart(frame);
    let extent = still.extent();
    let mut document = GltfBuilder::default();
    let place = |corner: DVec3| extent.from_voxel_units(corner);
    let by_class = meshes(
        [extent.nx(), extent.ny()],
        |x, y| *still.window_column(x, y),
        place,
    );
    let mut classes = Vec::new();
    for (label, mesh) in &by_class {
        let Some(class) = Class::from_id(*label) else {
            continue;
        };
        let mesh = document.mesh(class.name(), class, mesh);
        classes.push(document.node(WrittenNode {
            name: class.name().to_owned(),
            mesh: Some(mesh),
            extras: Some(Extras::Class(ClassExtras {
                class,
                class_id: class.id(),
            })),
            ..WrittenNode::default()
        }));
    }
    let mut boxes = Vec::new();
    for b in frame.boxes.values() {
        boxes.push(document.box_node(b, own.get(&b.id)));
    }
    let mut children = Vec::new();
    for (name, list) in [("occupancy", classes), ("boxes", boxes)] {
        if !list.is_empty() {
            children.push(document.node(WrittenNode {
                name: name.to_owned(),
                children: list,
                ..WrittenNode::default()
            }));
        }
    }
    let turn = y_up_from_z_up();
    let root = document.node(WrittenNode {
        name: format!("{} (z up)", scene.name),
        children,
        rotation: Some(turn.to_array()),
        extras: Some(Extras::Scene(SceneExtras {
            sceneloom: told(scene),
            recipe: serde_json::to_value(recipe).map_err(FormatError::new)?,
        })),
        ..WrittenNode::default()
    });
    document.finish(&scene.name, root)
}

fn told(scene: &Scene) -> ExtrasHeader {
    ExtrasHeader {
        version: VERSION,
        seed: scene.seed.to_string(),
        class_map: CLASS_MAP.to_owned(),
        extent: scene.frame().extent().into(),
        voxel_m: Window::VOXEL_M,
        frame: "ego: x forward, y left, z up, m".to_owned(),
    }
}

/// Takes the voxels of each box apart from all others. A box has the voxels of its class in its footprint, and those in
/// the margin around it that are in no other box's footprint.
fn apart(frame: &Frame) -> (VoxelGrid, BTreeMap<BoxId, ObjectVoxels>) {
    let extent = frame.extent();
    let mut owners: BTreeMap<(usize, Class), BoxId> = BTreeMap::new();
    for margin_m in [0.0, MARGIN_M] {
        for b in frame.boxes.values() {
            box_cells(extent, b, margin_m, |x, y| {
                owners.entry((extent.index(x, y), b.class)).or_insert(b.id);
            });
        }
    }
    let mut still = frame.occupancy.clone();
    let mut own = BTreeMap::new();
    for b in frame.boxes.values() {
        let is_own = |[x, y, _]: [usize; 3], label: u8| {
            label == b.class.id() && owners.get(&(extent.index(x, y), b.class)) == Some(&b.id)
        };
        let voxels = ObjectVoxels::cut(&frame.occupancy, b, is_own);
        if voxels.labels.is_empty() {
            continue;
        }
        for (i, column) in voxels.labels.chunks_exact(Window::NZ).enumerate() {
            let from = extent.from();
            let at = [i / voxels.size[1], i % voxels.size[1]];
            let [x, y] = [0, 1].map(|axis| (voxels.from[axis] - from[axis]) as usize + at[axis]);
            for z in (0..Window::NZ).filter(|z| column[*z] != Class::FREE) {
                still.set(x, y, z, Class::FREE);
            }
        }
        own.insert(b.id, ObjectVoxels::clone(&voxels));
    }
    (still, own)
}

/// A box without voxels as a cuboid around its middle.
fn cuboid(size_m: DVec3) -> Mesh {
    let corner = |x: f64, y: f64, z: f64| (DVec3::new(x, y, z) * size_m).as_vec3().to_array();
    let ends = [-0.5, 0.5];
    let corners = ends.map(|x| ends.map(|y| ends.map(|z| corner(x, y, z))));
    Mesh {
        positions: corners.concat().concat(),
        indices: vec![
            0, 1, 3, 0, 3, 2, 4, 6, 7, 4, 7, 5, // back, front
            0, 4, 5, 0, 5, 1, 2, 3, 7, 2, 7, 6, // right, left
            0, 2, 6, 0, 6, 4, 1, 5, 7, 1, 7, 3, // bottom, top
        ],
    }
}

/// A glTF document in the making, with its one buffer.
#[derive(Default)]
struct GltfBuilder {
    nodes: Vec<WrittenNode>,
    meshes: Vec<MeshOut>,
    materials: Vec<GltfMaterial>,
    material_of: BTreeMap<Class, usize>,
    accessors: Vec<Accessor>,
    views: Vec<GltfBufferView>,
    bytes: Vec<u8>,
}

impl GltfBuilder {
    fn node(&mut self, node: WrittenNode) -> usize {
        self.nodes.push(node);
        self.nodes.len() - 1
    }

    fn box_node(&mut self, b: &SceneBox, voxels: Option<&ObjectVoxels>) -> usize {
        let name = format!("{} {}", b.called(), b.id.0);
        let mesh = match voxels {
            None => cuboid(b.size_m),
            Some(voxels) => {
                let [from_x, from_y] = voxels.from.map(f64::from);
                // In the box's own frame, so that the node's transform moves them.
                let place = |corner: DVec3| {
                    let at =
                        DVec3::new(from_x + corner.x, from_y + corner.y, corner.z) / voxels.lattice.per_m();
                    b.to_local(at + DVec3::Z * voxels.lattice.bottom_m())
                };
                let column = |x, y| *voxels.column(x, y).first_chunk().expect("a column of the window");
                meshes(voxels.size, column, place)
                    .remove(&b.class.id())
                    .unwrap_or_default()
            }
        };
        let (sin, cos) = (b.yaw_rad.rem_euclid(std::f64::consts::TAU) / 2.0).sin_cos();
        let mesh = self.mesh(&name, b.class, &mesh);
        self.node(WrittenNode {
            mesh: Some(mesh),
            translation: Some(b.center_m.to_array()),
            rotation: Some([0.0, 0.0, sin, cos]),
            extras: Some(Extras::Box(BoxExtras::from_box(b, voxels.is_some()))),
            name,
            ..WrittenNode::default()
        })
    }

    fn mesh(&mut self, name: &str, class: Class, mesh: &Mesh) -> usize {
        let bound = |of: fn(f32, f32) -> f32| {
            let all = mesh.positions.iter().copied();
            all.reduce(|a, b| std::array::from_fn(|i| of(a[i], b[i])))
        };
        let (min, max) = (bound(f32::min), bound(f32::max));
        let bytes: &[u8] = bytemuck::cast_slice(&mesh.positions);
        let view = self.view(bytes, ARRAY_BUFFER);
        self.accessors.push(Accessor {
            buffer_view: view,
            component_type: FLOAT,
            count: mesh.positions.len(),
            kind: "VEC3",
            min,
            max,
        });
        let position = self.accessors.len() - 1;
        // The highest index of a type is kept free: some programs begin a new strip there.
        let (view, component_type) = match u16::try_from(mesh.positions.len()) {
            Ok(_) => {
                let short: Vec<u8> = mesh
                    .indices
                    .iter()
                    .flat_map(|i| (*i as u16).to_le_bytes())
                    .collect();
                (self.view(&short, ELEMENT_ARRAY_BUFFER), UNSIGNED_SHORT)
            }
            Err(_) => {
                let long: Vec<u8> = mesh.indices.iter().flat_map(|i| i.to_le_bytes()).collect();
                (self.view(&long, ELEMENT_ARRAY_BUFFER), UNSIGNED_INT)
            }
        };
        self.accessors.push(Accessor {
            buffer_view: view,
            component_type,
            count: mesh.indices.len(),
            kind: "SCALAR",
            min: None,
            max: None,
        });
        let material = self.material(class);
        self.meshes.push(MeshOut {
            name: name.to_owned(),
            primitives: [Primitive {
                attributes: Attributes { position },
                indices: position + 1,
                material,
            }],
        });
        self.meshes.len() - 1
    }

    fn view(&mut self, bytes: &[u8], target: u32) -> usize {
        self.bytes.resize(self.bytes.len().next_multiple_of(4), 0);
        self.views.push(GltfBufferView {
            buffer: 0,
            byte_offset: self.bytes.len(),
            byte_length: bytes.len(),
            target,
        });
        self.bytes.extend(bytes);
        self.views.len() - 1
    }

    fn material(&mut self, class: Class) -> usize {
        let materials = &mut self.materials;
        *self.material_of.entry(class).or_insert_with(|| {
            let [r, g, b] = class.color().map(linear);
            materials.push(GltfMaterial {
                name: class.name(),
                pbr: Pbr {
                    base_color_factor: [r, g, b, 1.0],
                    metallic_factor: 0.0,
                    roughness_factor: 1.0,
                },
            });
            materials.len() - 1
        })
    }

    fn finish(self, scene: &str, root: usize) -> Result<Vec<u8>, FormatError> {
        let document = GltfExport {
            asset: Asset {
                version: "2.0",
                generator: concat!("sceneloom ", env!("CARGO_PKG_VERSION")),
            },
            scene: 0,
            scenes: [SceneOut {
                name: scene.to_owned(),
                nodes: [root],
            }],
            nodes: self.nodes,
            meshes: self.meshes,
            materials: self.materials,
            accessors: self.accessors,
            buffers: match self.bytes.len() {
                0 => vec![],
                byte_length => vec![Buffer { byte_length }],
            },
            buffer_views: self.views,
        };
        let json = serde_json::to_vec(&document).map_err(FormatError::new)?;
        container::join(&json, &self.bytes)
    }
}

/// sRGB of a byte to a linear share of 1, as `baseColorFactor` wants it.
fn linear(srgb: u8) -> f64 {
    let v = f64::from(srgb) / 255.0;
    let linear = match v <= 0.04045 {
        true => v / 12.92,
        false => ((v + 0.055) / 1.055).powf(2.4),
    };
    (linear * 1e6).round() / 1e6
}

const UNSIGNED_SHORT: u32 = 5123;
const UNSIGNED_INT: u32 = 5125;
const FLOAT: u32 = 5126;
const ARRAY_BUFFER: u32 = 34962;
const ELEMENT_ARRAY_BUFFER: u32 = 34963;

#[derive(Serialize)]
#[serde(rename_all = "camelCase")]
struct GltfExport {
    asset: Asset,
    scene: usize,
    scenes: [SceneOut; 1],
    nodes: Vec<WrittenNode>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    meshes: Vec<MeshOut>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    materials: Vec<GltfMaterial>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    accessors: Vec<Accessor>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    buffer_views: Vec<GltfBufferView>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    buffers: Vec<Buffer>,
}

#[derive(Serialize)]
struct Asset {
    version: &'static str,
    generator: &'static str,
}

#[derive(Serialize)]
struct SceneOut {
    name: String,
    nodes: [usize; 1],
}

#[derive(Default, Serialize)]
struct WrittenNode {
    name: String,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    children: Vec<usize>,
    #[serde(skip_serializing_if = "Option::is_none")]
    mesh: Option<usize>,
    #[serde(skip_serializing_if = "Option::is_none")]
    translation: Option<[f64; 3]>,
    /// x, y, z, w.
    #[serde(skip_serializing_if = "Option::is_none")]
    rotation: Option<[f64; 4]>,
    #[serde(skip_serializing_if = "Option::is_none")]
    extras: Option<Extras>,
}

#[derive(Serialize)]
#[serde(untagged)]
enum Extras {
    Scene(SceneExtras),
    Class(ClassExtras),
    Box(BoxExtras),
}

#[derive(Serialize)]
struct MeshOut {
    name: String,
    primitives: [Primitive; 1],
}

#[derive(Serialize)]
struct Primitive {
    attributes: Attributes,
    indices: usize,
    material: usize,
}

#[derive(Serialize)]
struct Attributes {
    #[serde(rename = "POSITION")]
    position: usize,
}

#[derive(Serialize)]
struct GltfMaterial {
    name: &'static str,
    #[serde(rename = "pbrMetallicRoughness")]
    pbr: Pbr,
}

#[derive(Serialize)]
#[serde(rename_all = "camelCase")]
struct Pbr {
    base_color_factor: [f64; 4],
    metallic_factor: f64,
    roughness_factor: f64,
}

#[derive(Serialize)]
#[serde(rename_all = "camelCase")]
struct Accessor {
    buffer_view: usize,
    component_type: u32,
    count: usize,
    #[serde(rename = "type")]
    kind: &'static str,
    #[serde(skip_serializing_if = "Option::is_none")]
    min: Option<[f32; 3]>,
    #[serde(skip_serializing_if = "Option::is_none")]
    max: Option<[f32; 3]>,
}

#[derive(Serialize)]
#[serde(rename_all = "camelCase")]
struct GltfBufferView {
    buffer: usize,
    byte_offset: usize,
    byte_length: usize,
    target: u32,
}

#[derive(Serialize)]
#[serde(rename_all = "camelCase")]
struct Buffer {
    byte_length: usize,
}
