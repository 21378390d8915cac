//! A glTF document with its buffers, its tree of nodes laid out in a list, and its triangles in our axes.

use std::borrow::Cow;
use std::collections::BTreeMap;
use std::path::{Component, Path};

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use glam::{DAffine3, DMat3, DMat4, DQuat, DVec3};
use gltf::json::mesh::{Mode, Primitive, Semantic};
use gltf::json::scene::Node as JsonNode;
use gltf::json::validation::Checked;
use gltf::json::{Root, deserialize};
use scene::message::quoted;

use super::accessor::{Indices, PicturePlaces, Positions, from, get};
use super::{container, z_up_from_y_up};
use crate::FormatError;
use crate::import::ImportFile;

/// Largest file beside a document, bytes.
const LARGEST_BUFFER: u64 = 512 << 20;
/// Largest picture of a document, bytes.
const LARGEST_PICTURE: u64 = 64 << 20;
/// Most triangles that are read, each as often as nodes show it.
const MOST_TRIANGLES: u64 = 1 << 26;
/// Most nodes that are around one another.
const DEEPEST: usize = 256;
/// Extensions that may be required of a reader without changing where triangles are: by the beginning of their names.
const HARMLESS: [&str; 8] = [
    "KHR_mesh_quantization",
    "KHR_materials_",
    "KHR_texture_",
    "KHR_lights_",
    "KHR_animation_",
    "KHR_xmp",
    "EXT_texture_",
    "EXT_lights_",
];

/// A document that was read, and the nodes of its scene.
pub(crate) struct GltfDocument<'a> {
    /// The JSON document as in the file.
    pub(crate) root: Root,
    /// Every node that the scene shows, parents before their children.
    pub(crate) nodes: Vec<GltfNode>,
    /// Name of the scene; empty without one.
    pub(crate) scene_name: String,
    buffers: Vec<Cow<'a, [u8]>>,
    /// The file itself; other files beside it are read through this.
    source: &'a ImportFile<'a>,
}

/// A node of the scene.
pub(crate) struct GltfNode {
    /// Its name; empty without one.
    pub(crate) name: String,
    /// Place of its parent in the list.
    pub(crate) parent: Option<usize>,
    /// Takes points of the node to our axes (z up), m.
    pub(crate) world_from_node: DAffine3,
    /// Its mesh in the document.
    pub(crate) mesh: Option<usize>,
    /// Its extras as JSON.
    pub(crate) extras: Option<String>,
}

/// Parts that were left out while triangles were read, counted by kind.
#[derive(Default)]
pub(crate) struct LeftOut {
    counts: BTreeMap<&'static str, usize>,
}

impl LeftOut {
    /// Adds `n` to the count of a kind.
    pub(crate) fn add(&mut self, what: &'static str, n: usize) {
        if n > 0 {
            *self.counts.entry(what).or_default() += n;
        }
    }

    /// Counts by kind, for a report.
    pub(crate) fn report(self) -> BTreeMap<String, usize> {
        self.counts
            .into_iter()
            .map(|(what, n)| (what.to_owned(), n))
            .collect()
    }
}

impl<'a> GltfDocument<'a> {
    /// Reads a GLB file, or glTF as JSON with its buffers inside or beside it.
    pub(crate) fn read(source: &'a ImportFile<'a>) -> Result<Self, FormatError> {
        let (json, bin) = match container::is_glb(source.bytes) {
            true => {
                let chunks = container::split(source.bytes)?;
                (chunks.json, chunks.bin)
            }
            false => (source.bytes, None),
        };
        let root: Root = deserialize::from_slice(json).map_err(FormatError::new)?;
        check(&root)?;
        let buffers = buffers(&root, bin, source)?;
        let (nodes, scene_name) = nodes(&root)?;
        Ok(Self {
            root,
            nodes,
            scene_name,
            buffers,
            source,
        })
    }

    /// Name of a mesh and of the material of one of its primitives; empty without.
    pub(crate) fn names(&self, mesh: usize, primitive: usize) -> [&str; 2] {
        let mesh = self.root.meshes.get(mesh);
        let name = mesh.and_then(|m| m.name.as_deref()).unwrap_or_default();
        let material = mesh
            .and_then(|m| m.primitives.get(primitive)?.material)
            .and_then(|m| self.root.materials.get(m.value())?.name.as_deref());
        [name, material.unwrap_or_default()]
    }

    /// Visits the triangles of a node's own mesh with the place of their primitive in it, in our axes, m. Those with a number
    /// that is not finite are left out.
    pub(crate) fn triangles(
        &self,
        node: &GltfNode,
        left_out: &mut LeftOut,
        mut visit: impl FnMut(usize, [DVec3; 3]),
    ) -> Result<(), FormatError> {
        let Some(mesh) = node.mesh else {
            return Ok(());
        };
        let mesh = get(&self.root.meshes, mesh, "mesh")?;
        for (i, primitive) in mesh.primitives.iter().enumerate() {
            let mut broken = 0;
            let sound = self.corners(primitive, left_out, |corners, _| {
                let corners = corners.map(|p| node.world_from_node.transform_point3(p));
                match corners.iter().all(|p| p.is_finite()) {
                    true => visit(i, corners),
                    false => broken += 1,
                }
            });
            left_out.add("triangles with numbers that are not finite", broken);
            sound?;
        }
        Ok(())
    }

    /// Places of a primitive's corners in the pictures of that set; `None` if the primitive has no such set or it
    /// cannot be read.
    pub(crate) fn picture_places(&self, primitive: &Primitive, set: u32) -> Option<PicturePlaces<'_>> {
        let semantic = Checked::Valid(Semantic::TexCoords(set));
        let accessor = primitive.attributes.get(&semantic)?;
        PicturePlaces::new(&self.root, &self.buffers, accessor.value()).ok()
    }

    /// The bytes of a picture: in a buffer, in its address, or in a file beside the document. Errors in one line where they are in
    /// none of these.
    pub(crate) fn picture(&self, index: usize) -> Result<Cow<'_, [u8]>, FormatError> {
        let picture = get(&self.root.images, index, "image")?;
        match (&picture.buffer_view, &picture.uri) {
            (Some(view), _) => Ok(Cow::Borrowed(from(&self.root, &self.buffers, view.value(), 0)?.0)),
            (None, Some(uri)) => Ok(Cow::Owned(addressed(uri, self.source, LARGEST_PICTURE)?)),
            (None, None) => Err(FormatError::new(format!(
                "image {index} is nowhere: it has no address"
            ))),
        }
    }

    /// Triangles of this node as often as they are shown, at most.
    fn count(&self, node: &GltfNode) -> u64 {
        let mesh = node.mesh.and_then(|mesh| self.root.meshes.get(mesh));
        let primitives = mesh.map_or(&[][..], |m| &m.primitives);
        let triangles = |p: &Primitive| {
            let position = p.attributes.get(&Checked::Valid(Semantic::Positions));
            let counted = p.indices.or(position.copied());
            let accessor = counted.and_then(|a| self.root.accessors.get(a.value()));
            let corners = accessor.map_or(0, |a| a.count.0);
            match p.mode {
                Checked::Valid(Mode::TriangleStrip | Mode::TriangleFan) => corners.saturating_sub(2),
                _ => corners / 3,
            }
        };
        primitives.iter().map(triangles).fold(0, u64::saturating_add)
    }

    /// Errors where the scene has more triangles than are read.
    pub(crate) fn check_size(&self) -> Result<(), FormatError> {
        let found = self
            .nodes
            .iter()
            .map(|n| self.count(n))
            .fold(0, u64::saturating_add);
        match found {
            found if found > MOST_TRIANGLES => Err(FormatError::new(format!(
                "{found} triangles, expected at most {MOST_TRIANGLES}"
            ))),
            _ => Ok(()),
        }
    }

    /// Visits the triangles of a primitive in its node's axes, m, with the numbers of their corners.
    pub(crate) fn corners(
        &self,
        primitive: &Primitive,
        left_out: &mut LeftOut,
        mut visit: impl FnMut([DVec3; 3], [u64; 3]),
    ) -> Result<(), FormatError> {
        let step = match primitive.mode {
            Checked::Valid(Mode::Triangles) => 3,
            Checked::Valid(Mode::TriangleStrip | Mode::TriangleFan) => 1,
            _ => {
                left_out.add("meshes of points or lines", 1);
                return Ok(());
            }
        };
        let Some(position) = primitive.attributes.get(&Checked::Valid(Semantic::Positions)) else {
            left_out.add("meshes without positions", 1);
            return Ok(());
        };
        let positions = Positions::new(&self.root, &self.buffers, position.value())?;
        let indices = primitive.indices.map(|i| i.value());
        let indices = Indices::new(&self.root, &self.buffers, indices, positions.count())?;
        let is_fan = primitive.mode == Checked::Valid(Mode::TriangleFan);
        let mut first = 0;
        while first + 3 <= indices.count() {
            let order = match (step, is_fan) {
                (1, true) => [0, first + 1, first + 2],
                (1, false) if first % 2 == 1 => [first + 1, first, first + 2],
                _ => [first, first + 1, first + 2],
            };
            let corner = |i: u64| {
                let i = indices.get(i)?;
                Some((positions.get(i)?, i))
            };
            match order.map(corner) {
                [Some(a), Some(b), Some(c)] => visit([a.0, b.0, c.0], [a.1, b.1, c.1]),
                _ => left_out.add("triangles with corners that are not there", 1),
            }
            first += step;
        }
        Ok(())
    }
}

fn check(root: &Root) -> Result<(), FormatError> {
    let version = &root.asset.version;
    if version.split('.').next() != Some("2") {
        return Err(FormatError::new(format!(
            "glTF version {:?}, expected 2.0",
            quoted(version, 20)
        )));
    }
    let needed = root.extensions_required.iter();
    let mut unknown = needed.filter(|name| !HARMLESS.iter().any(|known| name.starts_with(known)));
    match unknown.next() {
        Some(name) => Err(FormatError::new(format!(
            "the file needs the extension {:?}, expected meshes without compression",
            quoted(name, 60)
        ))),
        None => Ok(()),
    }
}

fn buffers<'a>(
    root: &Root,
    bin: Option<&'a [u8]>,
    source: &'a ImportFile<'_>,
) -> Result<Vec<Cow<'a, [u8]>>, FormatError> {
    let mut out = Vec::with_capacity(root.buffers.len());
    for (i, buffer) in root.buffers.iter().enumerate() {
        let bytes = match (&buffer.uri, bin) {
            (None, Some(bin)) if i == 0 => Cow::Borrowed(bin),
            (None, _) => {
                return Err(FormatError::new(format!(
                    "buffer {i} is nowhere: it has no address"
                )));
            }
            (Some(uri), _) => Cow::Owned(
                addressed(uri, source, LARGEST_BUFFER).map_err(|e| e.at(&format_args!("buffer {i}")))?,
            ),
        };
        if (bytes.len() as u64) < buffer.byte_length.0 {
            return Err(FormatError::new(format!(
                "buffer {i}: {} bytes, expected {}",
                bytes.len(),
                buffer.byte_length.0
            )));
        }
        out.push(bytes);
    }
    Ok(out)
}

/// The bytes at an address: written into it (base64), or in a file beside the document and in no folder above it.
fn addressed(uri: &str, source: &ImportFile<'_>, limit: u64) -> Result<Vec<u8>, FormatError> {
    if let Some(data) = uri.strip_prefix("data:") {
        let text = data.split_once(";base64,").map(|(_, text)| text);
        let text = text.ok_or_else(|| FormatError::new("a data address that is not base64"))?;
        return STANDARD.decode(text).map_err(FormatError::new);
    }
    let relative = percent_decoded(uri);
    let shown = quoted(&relative, 80);
    let parts = Path::new(&relative).components();
    let inside = |c: Component<'_>| matches!(c, Component::Normal(_) | Component::CurDir);
    let is_plain = !relative.contains(['\\', ':', '\0']);
    if relative.is_empty() || !is_plain || !parts.into_iter().all(inside) {
        return Err(FormatError::new(format!(
            "{shown:?}: expected the name of a file in the same folder or below it"
        )));
    }
    source.beside(&relative, limit)
}

/// An address with `%20` and the like as characters.
fn percent_decoded(uri: &str) -> String {
    let mut out = Vec::with_capacity(uri.len());
    let mut rest = uri.as_bytes();
    while let Some((first, after)) = rest.split_first() {
        let digits = after.get(..2).filter(|_| *first == b'%');
        let digits = digits.and_then(|d| std::str::from_utf8(d).ok());
        match digits.and_then(|d| u8::from_str_radix(d, 16).ok()) {
            Some(byte) => {
                out.push(byte);
                rest = &after[2..];
            }
            None => {
                out.push(*first);
                rest = after;
            }
        }
    }
    String::from_utf8_lossy(&out).into_owned()
}

/// The nodes of the scene, parents first, and the scene's name. Without a scene it begins at all nodes that are no
/// node's child.
fn nodes(root: &Root) -> Result<(Vec<GltfNode>, String), FormatError> {
    let shown = match (root.scene, root.scenes.len()) {
        (Some(scene), _) => Some(get(&root.scenes, scene.value(), "scene")?),
        (None, 0) => None,
        (None, _) => root.scenes.first(),
    };
    let first: Vec<usize> = match shown {
        Some(scene) => scene.nodes.iter().map(|n| n.value()).collect(),
        None => {
            let mut is_child = vec![false; root.nodes.len()];
            for child in root.nodes.iter().flat_map(|n| n.children.iter().flatten()) {
                if let Some(flag) = is_child.get_mut(child.value()) {
                    *flag = true;
                }
            }
            (0..root.nodes.len()).filter(|i| !is_child[*i]).collect()
        }
    };
    let name = shown.and_then(|s| s.name.clone()).unwrap_or_default();
    let up = DAffine3::from_mat3(z_up_from_y_up());
    let mut seen = vec![false; root.nodes.len()];
    let mut open: Vec<(usize, Option<usize>, DAffine3, usize)> =
        first.into_iter().rev().map(|i| (i, None, up, 0)).collect();
    let mut out: Vec<GltfNode> = Vec::new();
    while let Some((index, parent, outer, depth)) = open.pop() {
        let node: &JsonNode = get(&root.nodes, index, "node")?;
        if std::mem::replace(&mut seen[index], true) {
            return Err(FormatError::new(format!(
                "node {index} has two parents, expected a tree of nodes"
            )));
        }
        if depth > DEEPEST {
            return Err(FormatError::new(format!(
                "node {index} is below {depth} others, expected at most {DEEPEST}"
            )));
        }
        let world_from_node = outer * local(node);
        let at = out.len();
        out.push(GltfNode {
            name: node.name.clone().unwrap_or_default(),
            parent,
            world_from_node,
            mesh: node.mesh.map(|m| m.value()),
            extras: node.extras.as_ref().map(|e| e.get().to_owned()),
        });
        let children = node.children.iter().flatten().rev();
        open.extend(children.map(|c| (c.value(), Some(at), world_from_node, depth + 1)));
    }
    Ok((out, name))
}

/// A node's own transform.
fn local(node: &JsonNode) -> DAffine3 {
    if let Some(matrix) = node.matrix {
        let m = DMat4::from_cols_array(&matrix.map(f64::from));
        return DAffine3::from_mat4(m);
    }
    let vector = |v: Option<[f32; 3]>, or: f32| DVec3::from_array(v.unwrap_or([or; 3]).map(f64::from));
    let turn = node
        .rotation
        .map_or(DQuat::IDENTITY, |q| DQuat::from_array(q.0.map(f64::from)));
    // A quaternion of no length is taken as no rotation.
    let turn = match turn.length() > 1e-6 && turn.is_finite() {
        true => turn.normalize(),
        false => DQuat::IDENTITY,
    };
    DAffine3 {
        matrix3: DMat3::from_quat(turn) * DMat3::from_diagonal(vector(node.scale, 1.0)),
        translation: vector(node.translation, 0.0),
    }
}
