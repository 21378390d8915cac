//! Meshes of other programs: a whole scene, whose things are told by their names, or a single model, which becomes one
//! box.
//!
//! The axes of a scene are turned as programs with z up do when they write glTF: x stays x, -z becomes y, y becomes z.
//! The ground is taken to be near z = 0 and is put where the labels have it, two voxels lower; things on it reach down
//! to it.

use std::collections::BTreeMap;
use std::sync::Arc;

use glam::{DVec2, DVec3};
use scene::{BoxId, Class, Extent, Frame, Inferred, Lattice, Scene, SensorRig, VoxelGrid, Window, infer};

use super::class_words::{NameMeaning, paint_said, said};
use super::columns::{Heights, Statics};
use super::document::{GltfDocument, LeftOut};
use super::model::{ModelExtents, class_by_size, may_be_one};
use super::paint::Coats;
use super::surface::TriangleRasteriser;
use super::{own, single, work};
use crate::FormatError;
use crate::import::ImportedScene;

/// A single model is smaller than this, seen from above, m.
const MODEL_M: f64 = 25.0;
/// Most columns of a foreign map along a side: 819 m.
const MOST_SIDE: i32 = 2048;
/// A thing without a telling name is ground if it is lower than the first and longer than the second, m.
const FLAT_M: f64 = 0.5;
const LONG_M: f64 = 5.0;
/// A thing without a telling name that is no ground is manmade if its longest side is longer than this, m.
const LARGE_M: f64 = 2.5;

/// The corners of a box along the axes; empty if the first is above the second.
#[derive(Clone, Copy)]
pub(super) struct Bounds {
    pub(super) low: DVec3,
    pub(super) high: DVec3,
}

/// Facts about a node before its voxels are made.
pub(super) struct ForeignNode {
    pub(super) said: NameMeaning,
    /// Around its own mesh, and around all below it.
    pub(super) own: Bounds,
    pub(super) all: Bounds,
    /// The thing that it is a part of.
    pub(super) thing: Option<usize>,
    /// A class that an ancestor's name tells.
    pub(super) around: Option<Class>,
}

/// A thing that becomes a box.
struct ForeignObject {
    node: usize,
    class: Class,
    /// The class was told by the size.
    is_guess: bool,
}

/// The scene of a foreign document.
pub(crate) fn scene(document: &GltfDocument<'_>, name: &str) -> Result<ImportedScene, FormatError> {
    let mut left_out = LeftOut::default();
    let mut abouts = abouts(document, &mut left_out)?;
    let things = things(document, &mut abouts);
    let all = abouts.iter().map(|a| a.own).fold(Bounds::NONE, Bounds::with);
    if all.is_empty() {
        return Err(FormatError::new("no triangles, expected meshes"));
    }
    match model(document, &abouts, &things, &all, name) {
        Some(class) => single::scene(document, &abouts, &all, class, name, left_out),
        None => map(document, &abouts, &things, &all, name, left_out),
    }
}

fn abouts(document: &GltfDocument<'_>, left_out: &mut LeftOut) -> Result<Vec<ForeignNode>, FormatError> {
    let mut out: Vec<ForeignNode> = Vec::with_capacity(document.nodes.len());
    for node in &document.nodes {
        let mesh = node.mesh.map_or("", |mesh| document.names(mesh, 0)[0]);
        let own_name = said(&node.name);
        let told = if own_name.class.is_some() {
            own_name
        } else {
            NameMeaning {
                class: said(mesh).class,
                ..own_name
            }
        };
        let outer = node.parent.map(|parent| &out[parent]);
        let nothing = told.nothing || outer.is_some_and(|o| o.said.nothing);
        let around = outer.and_then(|o| o.said.class.or(o.around));
        let mut own = Bounds::NONE;
        match nothing && node.mesh.is_some() {
            true => left_out.add("meshes of the sky", 1),
            false => document.triangles(node, left_out, |_, corners| {
                corners
                    .into_iter()
                    .for_each(|p| own = own.with(Bounds { low: p, high: p }));
            })?,
        }
        out.push(ForeignNode {
            said: NameMeaning { nothing, ..told },
            own,
            all: own,
            thing: None,
            around,
        });
    }
    for i in (0..out.len()).rev() {
        if let Some(parent) = document.nodes[i].parent {
            out[parent].all = out[parent].all.with(out[i].all);
        }
    }
    Ok(out)
}

/// The topmost nodes that are things, and which nodes are parts of them.
fn things(document: &GltfDocument<'_>, abouts: &mut [ForeignNode]) -> Vec<ForeignObject> {
    let mut out: Vec<ForeignObject> = Vec::new();
    for i in 0..abouts.len() {
        let outer = document.nodes[i].parent.and_then(|parent| abouts[parent].thing);
        let about = &abouts[i];
        let class = about
            .said
            .class
            .or(about.around)
            .filter(|class| class.is_object());
        let is_one = |class: &Class| !about.all.is_empty() && may_be_one(*class, about.all.long_m());
        let thing = match (outer, class.filter(|_| !about.said.several).filter(is_one)) {
            (Some(thing), _) => Some(thing),
            (None, Some(class)) => {
                out.push(ForeignObject {
                    node: i,
                    class,
                    is_guess: false,
                });
                Some(out.len() - 1)
            }
            (None, None) => None,
        };
        abouts[i].thing = thing;
    }
    out
}

/// The class of the model that a document is, if it is one: objects become a box, others voxels. The flag says that it was
/// told by the size.
fn model(
    document: &GltfDocument<'_>,
    abouts: &[ForeignNode],
    things: &[ForeignObject],
    all: &Bounds,
    name: &str,
) -> Option<(Class, bool)> {
    let shown = || abouts.iter().filter(|a| !a.own.is_empty());
    let apart = shown().any(|a| a.thing.is_none());
    if all.long_m() > MODEL_M || things.len() > 1 || (things.len() == 1 && apart) {
        return None;
    }
    let node_names = abouts.iter().map(|a| a.said.class);
    let materials = document.root.materials.iter().filter_map(|m| m.name.as_deref());
    let first = [said(name).class, said(&document.scene_name).class].into_iter();
    let named = things
        .iter()
        .map(|t| Some(t.class))
        .chain(first)
        .chain(node_names);
    let named = named.chain(materials.map(|m| said(m).class)).flatten().next();
    match named {
        Some(class) if class.is_ground() => None,
        Some(class) if class.is_object() && !may_be_one(class, all.long_m()) => None,
        Some(class) => Some((class, false)),
        None => {
            let by_size = class_by_size(all.high - all.low);
            Some((
                by_size.unwrap_or_else(|| by_extent(&all.high, &all.low)),
                by_size.is_some(),
            ))
        }
    }
}

/// Class of a thing without a telling name.
fn by_extent(high: &DVec3, low: &DVec3) -> Class {
    let size = *high - *low;
    let long = size.x.max(size.y);
    match () {
        () if size.z < FLAT_M && long > LONG_M => Class::OtherFlat,
        () if size.max_element() > LARGE_M => Class::Manmade,
        () => Class::Others,
    }
}

/// A whole scene.
fn map(
    document: &GltfDocument<'_>,
    abouts: &[ForeignNode],
    things: &[ForeignObject],
    all: &Bounds,
    name: &str,
    mut left_out: LeftOut,
) -> Result<ImportedScene, FormatError> {
    let (extent, shift_m) = extent(all);
    let place = |corners: [DVec3; 3]| corners.map(|p| p + shift_m);
    work::check(document, TriangleRasteriser::cost, extent, |node, corners| {
        let about = &abouts[node];
        (about.thing.is_some() || !about.said.nothing).then(|| place(corners))
    })?;
    let mut solid = Statics::new(extent);
    let mut outlines: Vec<ModelExtents> = things
        .iter()
        .map(|t| ModelExtents::new(&document.nodes[t.node].world_from_node))
        .collect();
    let mut beside = 0;
    each_triangle(document, |node, primitive, corners| {
        let about = &abouts[node];
        let corners = place(corners);
        match about.thing {
            Some(thing) => corners.into_iter().for_each(|p| outlines[thing].add(p)),
            None if about.said.nothing => {}
            None => {
                let told = static_class(document, abouts, node, primitive);
                let class = told.unwrap_or_else(|| by_extent(&about.own.high, &about.own.low));
                beside += usize::from(!solid.add(class, corners));
            }
        }
    })?;
    left_out.add("triangles beside, above or below the map", beside);
    let mut occupancy = VoxelGrid::over(extent);
    solid.finish(&mut occupancy)?;
    let mut boxes = BTreeMap::new();
    let mut inferred = Inferred {
        layout: true,
        ..Inferred::default()
    };
    let mut coats = Coats::new(document);
    for (number, (thing, outline)) in things.iter().zip(&outlines).enumerate() {
        let id = BoxId(boxes.len() as u32 + 1);
        match outline.to_box(id, thing.class) {
            Some(mut b) if boxes.len() < Frame::MAX_BOXES => {
                let mut heights = Heights::new(extent, &b);
                // The nodes of a thing follow its own.
                let of_thing = |node: &usize| abouts[*node].thing == Some(number);
                let end = (thing.node..abouts.len()).take_while(of_thing).count() + thing.node;
                let nodes = &document.nodes[thing.node..end];
                b.label.paint = coats.paint(nodes)?.or_else(|| paint_said(&nodes[0].name));
                for node in nodes {
                    document.triangles(node, &mut LeftOut::default(), |_, corners| {
                        heights.add(place(corners))
                    })?;
                }
                heights.fill(&b, &mut occupancy)?;
                if thing.is_guess {
                    inferred.boxes.insert(id);
                }
                boxes.insert(id, b);
            }
            _ => left_out.add("things without extent, or farther than 10 km away", 1),
        }
    }
    let layout = own::layout(&occupancy);
    let background = match extent == Extent::WINDOW {
        true => infer::background(&occupancy, &layout),
        false => Default::default(),
    };
    inferred.background = !background.is_empty();
    let frame = Frame {
        inferred,
        ..Frame::new(layout, boxes, occupancy)
    };
    let mut scene = Scene::single(name, frame, Arc::new(SensorRig::default()), 0);
    scene.background = Arc::new(background);
    Ok(ImportedScene {
        sweep: None,
        scene,
        inferred: &["layout", "background"],
        skipped: left_out.report(),
        notes: Vec::new(),
    })
}

/// Class of a still part: by its node's name, its material, its mesh, or the names around it. `None` if none of them
/// tells a class.
pub(super) fn static_class(
    document: &GltfDocument<'_>,
    abouts: &[ForeignNode],
    node: usize,
    primitive: usize,
) -> Option<Class> {
    let about = &abouts[node];
    let mesh = document.nodes[node].mesh?;
    let material = said(document.names(mesh, primitive)[1]).class;
    let own = about.said.class;
    // A road's node may have a material for its sidewalk.
    let finer = material.filter(|m| m.is_ground() && own.is_some_and(Class::is_ground));
    finer.or(own).or(material).or(about.around)
}

/// Visits every triangle with its node and primitive, in our axes, m.
pub(super) fn each_triangle(
    document: &GltfDocument<'_>,
    mut visit: impl FnMut(usize, usize, [DVec3; 3]),
) -> Result<(), FormatError> {
    let mut counted_before = LeftOut::default();
    for (i, node) in document.nodes.iter().enumerate() {
        document.triangles(node, &mut counted_before, |primitive, corners| {
            visit(i, primitive, corners)
        })?;
    }
    Ok(())
}

/// The extent of a map around everything that is shown, and the shift that brings it onto that map, m. Along the ground
/// the shift is zero if the origin is within it or all of it lies within 400 m of the origin; upwards it is zero if
/// part of it is at the height of the map.
fn extent(all: &Bounds) -> (Extent, DVec3) {
    let middle = (all.low + all.high) / 2.0;
    let columns = |m: f64| (m * Lattice::OCC3D.per_m()).round();
    let is_around =
        all.low.truncate().cmple(DVec2::ZERO).all() && all.high.truncate().cmpge(DVec2::ZERO).all();
    let near = all.low.truncate().cmpge(DVec2::splat(-400.0)).all()
        && all.high.truncate().cmple(DVec2::splat(400.0)).all();
    let level = match is_around || near {
        true => DVec2::ZERO,
        false => DVec2::new(-columns(middle.x), -columns(middle.y)) / Lattice::OCC3D.per_m(),
    };
    let is_at_height = all.low.z < Window::MAX_M[2] && all.high.z > Window::MIN_M[2];
    let up = if is_at_height { 0.0 } else { -all.low.z };
    let (low, high) = (all.low.truncate() + level, all.high.truncate() + level);
    let window = Extent::WINDOW;
    let fits = low.cmpge(window.min_m().truncate()).all() && high.cmple(window.max_m().truncate()).all();
    let half = MOST_SIDE / 2;
    let side = |low: f64, high: f64| {
        let from = ((low * Lattice::OCC3D.per_m()).floor() as i32).clamp(-half, half - 1);
        let to = ((high * Lattice::OCC3D.per_m()).ceil() as i32).clamp(from + 1, half);
        (from, (to - from) as usize)
    };
    let ((x, nx), (y, ny)) = (side(low.x, high.x), side(low.y, high.y));
    let extent = match fits {
        true => window,
        false => Extent::new([x, y], [nx, ny]).unwrap_or(window),
    };
    (extent, level.extend(up))
}

impl Bounds {
    const NONE: Self = Self {
        low: DVec3::INFINITY,
        high: DVec3::NEG_INFINITY,
    };

    fn with(self, other: Self) -> Self {
        Self {
            low: self.low.min(other.low),
            high: self.high.max(other.high),
        }
    }

    pub(super) fn is_empty(&self) -> bool {
        self.low.x > self.high.x
    }

    /// The longer side, seen from above, m.
    pub(super) fn long_m(&self) -> f64 {
        (self.high - self.low).truncate().max_element()
    }

    /// Half of the diagonal, m.
    pub(super) fn radius_m(&self) -> f64 {
        (self.high - self.low).length() / 2.0
    }
}
