//! Scenes of this program: voxels come from the meshes as they lie now, so that parts moved or cut elsewhere come back
//! as they are seen.

use std::collections::btree_map::Entry;
use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

use glam::{DAffine3, DVec2, DVec3};
use scene::message::quoted;
use scene::moved::ColumnShift;
use scene::{
    BevLayout, BoxId, Class, Extent, Frame, Inferred, Scene, SceneBox, SensorRig, VoxelGrid, Window, infer,
};
use serde::de::DeserializeOwned;

use super::document::{GltfDocument, GltfNode, LeftOut};
use super::solid::Solid;
use super::surface::TriangleRasteriser;
use super::{BoxExtras, CLASS_MAP, ClassExtras, SceneExtras, VERSION, class_words, work};
use crate::FormatError;
use crate::import::ImportedScene;

/// A node within this of where its extras say was not moved: m, and the same for parts of a unit vector.
const STILL_M: f64 = 2e-3;
const STILL: f64 = 1e-4;

/// Farthest column of a map from the origin: 400 km.
const FARTHEST: u32 = 1_000_000;

/// Role of a node, by its own extras or those of a node around it.
enum Role {
    /// Voxels of a class.
    Class(Class),
    /// A box; its voxels are the meshes of this node and those below it.
    Box(Box<BoxExtras>),
}

/// The extras that describe the scene of a document; `None` if this program did not write it. Errors if they are of a
/// newer version, of other classes or otherwise not readable.
pub(crate) fn extras(document: &GltfDocument<'_>) -> Result<Option<SceneExtras>, FormatError> {
    for node in &document.nodes {
        let Some(text) = node
            .extras
            .as_deref()
            .filter(|text| text.contains("\"sceneloom\""))
        else {
            continue;
        };
        let extras: SceneExtras =
            serde_json::from_str(text).map_err(|e| FormatError::new(e).at(&"extras of the scene's node"))?;
        let told = &extras.sceneloom;
        if told.version > VERSION || told.class_map != CLASS_MAP {
            return Err(FormatError::new(format!(
                "a scene of version {} with classes {:?}, expected at most version {VERSION} with {CLASS_MAP:?}",
                told.version,
                quoted(&told.class_map, 40)
            )));
        }
        return Ok(Some(extras));
    }
    Ok(None)
}

/// The scene of a document of ours; `name` if the document does not tell its name.
pub(crate) fn scene(
    document: &GltfDocument<'_>,
    extras: &SceneExtras,
    name: &str,
) -> Result<ImportedScene, FormatError> {
    let told = &extras.sceneloom;
    let extent = Extent::new(told.extent.from, told.extent.columns).map_err(FormatError::new)?;
    if extent
        .from()
        .iter()
        .any(|column| column.unsigned_abs() > FARTHEST)
    {
        return Err(FormatError::new(format!(
            "a map from column {:?}, expected at most {FARTHEST} columns from the origin",
            extent.from()
        )));
    }
    let seed = told
        .seed
        .parse()
        .map_err(|_| FormatError::new(format!("seed {:?}, expected digits", quoted(&told.seed, 40))))?;
    let mut left_out = LeftOut::default();
    let roles = roles(document, &mut left_out);
    let shown = |node: usize, corners| match role_of(document, &roles, node) {
        Some(Role::Box(b)) if b.placeholder => None,
        _ => Some(corners),
    };
    // Of the two ways to voxels the dearer one is taken for all.
    let cost = |extent, corners| Solid::cost(extent, corners).max(TriangleRasteriser::cost(extent, corners));
    work::check(document, cost, extent, shown)?;
    let mut occupancy = VoxelGrid::over(extent);
    // Still parts first: a box that was moved into them then shows in front.
    for boxes in [false, true] {
        for (i, node) in document.nodes.iter().enumerate() {
            match role_of(document, &roles, i) {
                Some(Role::Class(class)) if !boxes => {
                    add_solid(document, node, *class, &mut occupancy, &mut left_out)?;
                }
                Some(Role::Box(b)) if boxes && !b.placeholder => {
                    add_solid(document, node, b.class, &mut occupancy, &mut left_out)?;
                }
                None if !boxes => add_surface(document, node, &mut occupancy, &mut left_out)?,
                _ => {}
            }
        }
    }
    let boxes = boxes(document, &roles, &mut left_out);
    let layout = layout(&occupancy);
    let background = match extent == Extent::WINDOW {
        true => infer::background(&occupancy, &layout),
        false => Default::default(),
    };
    let inferred = Inferred {
        layout: true,
        background: !background.is_empty(),
        ..Inferred::default()
    };
    let frame = Frame {
        inferred,
        ..Frame::new(layout, boxes, occupancy)
    };
    let name = extras.recipe["scene"].as_str().unwrap_or(name);
    let mut scene = Scene::single(name, frame, Arc::new(SensorRig::default()), seed);
    crate::recipe::restore(&extras.recipe, &mut scene);
    // (in a recipe the seed is a number, which programs round)
    scene.seed = seed;
    scene.background = Arc::new(background);
    Ok(ImportedScene {
        sweep: None,
        scene,
        inferred: &["layout", "background"],
        skipped: left_out.report(),
        notes: Vec::new(),
    })
}

fn parsed<T: DeserializeOwned>(node: &GltfNode) -> Option<T> {
    serde_json::from_str(node.extras.as_deref()?).ok()
}

/// The role that each node has by its own extras. Counts boxes whose extras are not readable.
fn roles(document: &GltfDocument<'_>, left_out: &mut LeftOut) -> Vec<Option<Role>> {
    let mut role = |node: &GltfNode| {
        let text = node.extras.as_deref()?;
        if let Some(b) = parsed::<BoxExtras>(node) {
            return Some(Role::Box(Box::new(b)));
        }
        let class = parsed::<ClassExtras>(node).map(|extras| extras.class);
        let is_box = text.contains("\"size_m\"");
        left_out.add("boxes whose extras are not readable", usize::from(is_box));
        class.filter(|class| *class != Class::Free).map(Role::Class)
    };
    document.nodes.iter().map(&mut role).collect()
}

/// The role of a node: its own, or that of the nearest node around it that has one.
fn role_of<'a>(document: &GltfDocument<'_>, roles: &'a [Option<Role>], node: usize) -> Option<&'a Role> {
    let around = std::iter::successors(Some(node), |i| document.nodes[*i].parent);
    around.into_iter().find_map(|i| roles[i].as_ref())
}

/// Adds the inside of a node's mesh. A primitive whose material is named after another class is of that class: meshes
/// were joined.
fn add_solid(
    document: &GltfDocument<'_>,
    node: &GltfNode,
    class: Class,
    grid: &mut VoxelGrid,
    left_out: &mut LeftOut,
) -> Result<(), FormatError> {
    let Some(mesh) = node.mesh else {
        return Ok(());
    };
    let extent = grid.extent();
    let mut solids: BTreeMap<Class, Solid> = BTreeMap::new();
    document.triangles(node, left_out, |primitive, corners| {
        let [_, material] = document.names(mesh, primitive);
        let class = Class::from_name(material).unwrap_or(class);
        solids
            .entry(class)
            .or_insert_with(|| Solid::new(extent))
            .add(corners);
    })?;
    for (class, solid) in solids {
        solid.fill(|[x, y, z]| grid.set(x, y, z, class.id()))?;
    }
    Ok(())
}

/// Adds the surface of a mesh that this program did not write: a part that was added to the scene elsewhere.
fn add_surface(
    document: &GltfDocument<'_>,
    node: &GltfNode,
    grid: &mut VoxelGrid,
    left_out: &mut LeftOut,
) -> Result<(), FormatError> {
    let Some(mesh) = node.mesh else {
        return Ok(());
    };
    let mut surface = TriangleRasteriser::new(grid.extent());
    document.triangles(node, left_out, |primitive, corners| {
        let [name, material] = document.names(mesh, primitive);
        let named = [node.name.as_str(), material, name].into_iter();
        let class = named.filter_map(|name| class_words::said(name).class).next();
        let label = class.unwrap_or(Class::Manmade).id();
        surface.visit(corners, |[x, y], [low, high]| {
            let to = high.min(Window::NZ as f64 - 1.0);
            if high >= 0.0 && low < Window::NZ as f64 {
                (low.max(0.0) as usize..=to as usize).for_each(|z| grid.set(x, y, z, label));
            }
        });
    })?;
    surface.finish()
}

/// The boxes as their nodes lie. One whose id is there already, because it was copied, gets the next one free.
fn boxes(
    document: &GltfDocument<'_>,
    roles: &[Option<Role>],
    left_out: &mut LeftOut,
) -> BTreeMap<BoxId, SceneBox> {
    let mut out: BTreeMap<BoxId, SceneBox> = BTreeMap::new();
    let mut copies = Vec::new();
    for (node, role) in document.nodes.iter().zip(roles) {
        let Some(Role::Box(extras)) = role else {
            continue;
        };
        let b = as_it_lies(extras, &node.world_from_node);
        if b.problem().is_some() {
            left_out.add("boxes that are upright or finite no more", 1);
            continue;
        }
        match out.entry(b.id) {
            Entry::Occupied(_) => copies.push(b),
            Entry::Vacant(place) => {
                place.insert(b);
            }
        }
    }
    let taken: BTreeSet<u32> = out.keys().map(|id| id.0).collect();
    let free = (1..).filter(|id| !taken.contains(id));
    for (b, id) in copies.into_iter().zip(free) {
        let id = BoxId(id);
        out.insert(id, SceneBox { id, ..b });
    }
    if out.len() > Frame::MAX_BOXES {
        left_out.add(
            "boxes beyond the most that a frame holds",
            out.len() - Frame::MAX_BOXES,
        );
        out = out.into_iter().take(Frame::MAX_BOXES).collect();
    }
    out
}

/// A box as its node lies: the very numbers of its extras if it was not moved.
fn as_it_lies(extras: &BoxExtras, world_from_node: &DAffine3) -> SceneBox {
    let told = extras.scene_box();
    let linear = world_from_node.matrix3;
    let heading = told.heading();
    let close = |a: DVec3, b: DVec3, within: f64| (a - b).abs().max_element() <= within;
    let unmoved = close(world_from_node.translation, told.center_m, STILL_M)
        && close(linear.x_axis, heading.extend(0.0), STILL)
        && close(linear.y_axis, heading.perp().extend(0.0), STILL)
        && close(linear.z_axis, DVec3::Z, STILL);
    if unmoved {
        return told;
    }
    let scale = DVec3::new(
        linear.x_axis.length(),
        linear.y_axis.length(),
        linear.z_axis.length(),
    );
    let ahead = linear.x_axis.truncate();
    let yaw_rad = match ahead.length() > 1e-6 {
        true => ahead.to_angle(),
        false => f64::NAN, // stands on its end
    };
    SceneBox {
        center_m: world_from_node.translation,
        size_m: told.size_m * scale,
        yaw_rad,
        velocity_mps: DVec2::from_angle(yaw_rad - told.yaw_rad).rotate(told.velocity_mps),
        ..told
    }
}

/// Map layers from the ground labels of a map of any extent, window by window.
pub(crate) fn layout(labels: &VoxelGrid) -> BevLayout {
    let extent = labels.extent();
    if extent == Extent::WINDOW {
        return infer::layout(labels);
    }
    let mut out = BevLayout::over(extent);
    let window = [Extent::WINDOW.nx(), Extent::WINDOW.ny()];
    for x in (0..extent.nx()).step_by(window[0]) {
        for y in (0..extent.ny()).step_by(window[1]) {
            let corner = [extent.from()[0] + x as i32, extent.from()[1] + y as i32];
            let origin = Extent::WINDOW.from();
            let by = ColumnShift([origin[0] - corner[0], origin[1] - corner[1]]);
            let there = infer::layout(&by.grid(labels).crop(Extent::WINDOW));
            out.paste(&by.back().layout(&there));
        }
    }
    out
}
