//! Meshes of other programs: a whole scene, whose things are told by their names, or a single model, which becomes one box.
//!
//! A scene keeps its axes as the programs write them that have z up themselves: x stays x, -z becomes y, y becomes z. The
//! ground is taken to be near z = 0 and is put where the labels have it, two voxels lower; what stands on it reaches down to it.

use std::collections::BTreeMap;
use std::sync::Arc;

use glam::{DAffine3, DVec2, DVec3};
use scene::raster::box_cells;
use scene::solid::fill::{SMEAR, smear_down};
use scene::{
    BevLayout, BoxId, BoxName, Class, Extent, Frame, Inferred, Scene, SceneBox, SensorRig, VoxelGrid, draft,
    infer,
};

use super::class_words::{Said, said};
use super::document::{Document, LeftOut};
use super::model::{Outline, class_by_size, may_be_one};
use super::own;
use super::surface::Surface;
use crate::FormatError;
use crate::import::Loaded;

/// A single model is smaller than this, seen from above, m.
const MODEL_M: f64 = 25.0;
/// A model around the origin, where the ego vehicle is, is put so far ahead, m.
const AHEAD_M: f64 = 8.0;
/// Most columns of a foreign map along a side: 819 m.
const MOST_SIDE: i32 = 2048;
/// Something without a telling name is ground if it is lower than the first and longer than the second, m.
const FLAT_M: f64 = 0.5;
const LONG_M: f64 = 5.0;
/// And manmade if it is larger than this, m.
const LARGE_M: f64 = 2.5;

/// The corners of a box along the axes; empty if the first is above the second.
#[derive(Clone, Copy)]
struct Bounds {
    low: DVec3,
    high: DVec3,
}

/// What is known of a node before its voxels are made.
struct About {
    said: Said,
    /// Around its own mesh, and around all below it.
    own: Bounds,
    all: Bounds,
    /// The thing that it is a part of.
    thing: Option<usize>,
    /// A class that an ancestor's name tells.
    around: Option<Class>,
}

/// A thing that becomes a box.
struct Thing {
    node: usize,
    class: Class,
    /// The class was told by the size.
    is_guess: bool,
}

/// The scene of a foreign document.
pub(crate) fn scene(document: &Document<'_>, name: &str) -> Result<Loaded, FormatError> {
    let mut left_out = LeftOut::default();
    let mut abouts = abouts(document, &mut left_out)?;
    let things = things(document, &mut abouts);
    let all = abouts.iter().map(|a| a.own).fold(Bounds::NONE, Bounds::with);
    if all.is_empty() {
        return Err(FormatError::new("no triangles, expected meshes"));
    }
    match model(document, &abouts, &things, &all, name) {
        Some(class) => one_model(document, &abouts, &all, class, name, left_out),
        None => map(document, &abouts, &things, &all, name, left_out),
    }
}

fn abouts(document: &Document<'_>, left_out: &mut LeftOut) -> Result<Vec<About>, FormatError> {
    let mut out: Vec<About> = Vec::with_capacity(document.nodes.len());
    for node in &document.nodes {
        let mesh = node.mesh.map_or("", |mesh| document.names(mesh, 0)[0]);
        let own_name = said(&node.name);
        let told = if own_name.class.is_some() {
            own_name
        } else {
            Said {
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
        out.push(About {
            said: Said { nothing, ..told },
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
fn things(document: &Document<'_>, abouts: &mut [About]) -> Vec<Thing> {
    let mut out: Vec<Thing> = Vec::new();
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
                out.push(Thing {
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
    document: &Document<'_>,
    abouts: &[About],
    things: &[Thing],
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

/// Class of something without a telling name.
fn by_extent(high: &DVec3, low: &DVec3) -> Class {
    let size = *high - *low;
    let long = size.x.max(size.y);
    match () {
        () if size.z < FLAT_M && long > LONG_M => Class::OtherFlat,
        () if size.max_element() > LARGE_M => Class::Manmade,
        () => Class::Others,
    }
}

/// A single model on open ground.
fn one_model(
    document: &Document<'_>,
    abouts: &[About],
    all: &Bounds,
    (class, is_guess): (Class, bool),
    name: &str,
    left_out: LeftOut,
) -> Result<Loaded, FormatError> {
    let shown = abouts.iter().position(|a| !a.own.is_empty()).unwrap_or(0);
    let first = std::iter::successors(Some(shown), |i| document.nodes[*i].parent)
        .last()
        .unwrap_or(shown);
    let mut outline = Outline::new(&document.nodes[first].world_from_node);
    each_triangle(document, |_, _, corners| {
        corners.into_iter().for_each(|p| outline.add(p))
    })?;
    let id = BoxId(1);
    let b = outline
        .to_box(id, if class.is_object() { class } else { Class::Car })
        .ok_or_else(|| FormatError::new("a model without extent, or farther than 10 km away"))?;
    // On the ground, on the map, and not where the ego vehicle is.
    let extent = Extent::WINDOW;
    let reach = DVec2::splat(all.radius_m()) + b.center_m.truncate().abs();
    let is_on_map = reach.cmple(extent.max_m().truncate()).all();
    let is_at_ego = !is_on_map || b.contains(DVec3::new(0.0, 0.0, b.center_m.z), 0.0);
    let up = DVec3::Z * (b.size_m.z / 2.0 - b.center_m.z);
    let place = match is_at_ego {
        true => {
            let to = DVec3::new(AHEAD_M + b.size_m.x / 2.0, 0.0, b.center_m.z) + up;
            DAffine3::from_translation(to)
                * DAffine3::from_rotation_z(-b.yaw_rad)
                * DAffine3::from_translation(-b.center_m)
        }
        false => DAffine3::from_translation(up),
    };
    let b = SceneBox {
        center_m: place.transform_point3(b.center_m),
        yaw_rad: if is_at_ego { 0.0 } else { b.yaw_rad },
        label: scene::BoxLabel {
            name: label(name, class),
            paint: None,
        },
        ..b
    };
    let layout = BevLayout::over(extent);
    let mut occupancy = draft::draft(&layout, std::iter::empty());
    let mut boxes = BTreeMap::new();
    if class.is_object() {
        let mut heights = Heights::new(extent);
        each_triangle(document, |_, _, corners| {
            heights.add(corners.map(|p| place.transform_point3(p)))
        })?;
        heights.fill(&b, &mut occupancy)?;
        boxes.insert(id, b);
    } else {
        let mut solid = Statics::new(extent);
        each_triangle(document, |node, primitive, corners| {
            let told = static_class(document, abouts, node, primitive).unwrap_or(class);
            let told = if told.is_object() { class } else { told };
            solid.add(told, corners.map(|p| place.transform_point3(p)));
        })?;
        solid.finish(&mut occupancy)?;
    }
    let guesses = if is_guess {
        boxes.keys().copied().collect()
    } else {
        Default::default()
    };
    let frame = Frame {
        inferred: Inferred {
            boxes: guesses,
            ..Inferred::default()
        },
        ..Frame::new(layout, boxes, occupancy)
    };
    Ok(Loaded {
        scene: Scene::single(name, frame, Arc::new(SensorRig::default()), 0),
        inferred: if is_guess { &["boxes"] } else { &[] },
        skipped: left_out.report(),
    })
}

/// A model's name for its box, unless it only says the class.
fn label(name: &str, class: Class) -> BoxName {
    match name == class.name() {
        true => BoxName::default(),
        false => BoxName::new(name),
    }
}

/// A whole scene.
fn map(
    document: &Document<'_>,
    abouts: &[About],
    things: &[Thing],
    all: &Bounds,
    name: &str,
    mut left_out: LeftOut,
) -> Result<Loaded, FormatError> {
    let (extent, shift_m) = extent(all);
    let place = |corners: [DVec3; 3]| corners.map(|p| p + shift_m);
    let mut solid = Statics::new(extent);
    let mut outlines: Vec<Outline> = things
        .iter()
        .map(|t| Outline::new(&document.nodes[t.node].world_from_node))
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
    let mut heights: Vec<Heights> = things.iter().map(|_| Heights::new(extent)).collect();
    each_triangle(document, |node, _, corners| {
        if let Some(thing) = abouts[node].thing {
            heights[thing].add(place(corners));
        }
    })?;
    let mut inferred = Inferred {
        layout: true,
        ..Inferred::default()
    };
    for ((thing, outline), heights) in things.iter().zip(&outlines).zip(heights) {
        let id = BoxId(boxes.len() as u32 + 1);
        match outline.to_box(id, thing.class) {
            Some(b) if boxes.len() < Frame::MAX_BOXES => {
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
    Ok(Loaded {
        scene,
        inferred: &["layout", "background"],
        skipped: left_out.report(),
    })
}

/// Class of a part of what stands still: by its node's name, its material, its mesh and what is around it. `None` where none
/// of them tells.
fn static_class(document: &Document<'_>, abouts: &[About], node: usize, primitive: usize) -> Option<Class> {
    let about = &abouts[node];
    let mesh = document.nodes[node].mesh?;
    let material = said(document.names(mesh, primitive)[1]).class;
    let own = about.said.class;
    // A road's node may have a material for its sidewalk.
    let finer = material.filter(|m| m.is_ground() && own.is_some_and(Class::is_ground));
    finer.or(own).or(material).or(about.around)
}

/// Visits every triangle with its node and primitive, in our axes, m.
fn each_triangle(
    document: &Document<'_>,
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

/// The extent of a map around all that is shown, and the move that brings that onto it, m: none if the origin is within it and
/// part of it is at the height of the map.
fn extent(all: &Bounds) -> (Extent, DVec3) {
    let middle = (all.low + all.high) / 2.0;
    let columns = |m: f64| (m * 2.5).round();
    let is_around =
        all.low.truncate().cmple(DVec2::ZERO).all() && all.high.truncate().cmpge(DVec2::ZERO).all();
    let near = all.low.truncate().cmpge(DVec2::splat(-400.0)).all()
        && all.high.truncate().cmple(DVec2::splat(400.0)).all();
    let level = match is_around || near {
        true => DVec2::ZERO,
        false => DVec2::new(-columns(middle.x), -columns(middle.y)) / 2.5,
    };
    let is_at_height = all.low.z < Extent::TOP_M && all.high.z > Extent::BOTTOM_M;
    let up = if is_at_height { 0.0 } else { -all.low.z };
    let (low, high) = (all.low.truncate() + level, all.high.truncate() + level);
    let window = Extent::WINDOW;
    let fits = low.cmpge(window.min_m().truncate()).all() && high.cmple(window.max_m().truncate()).all();
    let half = MOST_SIDE / 2;
    let side = |low: f64, high: f64| {
        let from = ((low * 2.5).floor() as i32).clamp(-half, half - 1);
        let to = ((high * 2.5).ceil() as i32).clamp(from + 1, half);
        (from, (to - from) as usize)
    };
    let ((x, nx), (y, ny)) = (side(low.x, high.x), side(low.y, high.y));
    let extent = match fits {
        true => window,
        false => Extent::new([x, y], [nx, ny]).unwrap_or(window),
    };
    (extent, level.extend(up))
}

/// The surfaces of what stands still, as they are measured; ground apart.
struct Statics {
    surface: Surface,
    stands: VoxelGrid,
    ground: VoxelGrid,
}

impl Statics {
    fn new(extent: Extent) -> Self {
        Self {
            surface: Surface::new(extent),
            stands: VoxelGrid::over(extent),
            ground: VoxelGrid::over(extent),
        }
    }

    /// Adds a triangle (m). False if it touches no voxel.
    fn add(&mut self, class: Class, corners: [DVec3; 3]) -> bool {
        let grid = if class.is_ground() {
            &mut self.ground
        } else {
            &mut self.stands
        };
        let mut touched = false;
        self.surface.visit(corners, |[x, y], [low, high]| {
            let top = Extent::NZ as f64;
            if high >= 0.0 && low < top {
                touched = true;
                // Of ground its highest voxel in the column is enough: it has no sides.
                let from = if class.is_ground() {
                    high.min(top - 1.0)
                } else {
                    low.max(0.0)
                };
                (from as usize..=high.min(top - 1.0) as usize).for_each(|z| grid.set(x, y, z, class.id()));
            }
        });
        touched
    }

    /// Puts all into a grid in the convention of the labels: ground two bins lower, what stands on it reaching down to it.
    fn finish(self, grid: &mut VoxelGrid) -> Result<(), FormatError> {
        self.surface.finish()?;
        for [x, y] in grid.extent().all_columns() {
            let (mut column, ground) = (*self.stands.column(x, y), self.ground.column(x, y));
            if column.iter().chain(ground).all(|label| *label == Class::FREE) {
                continue;
            }
            smear_down(&mut column);
            let mut lowest = None;
            for (z, class) in ground
                .iter()
                .enumerate()
                .filter(|(_, class)| **class != Class::FREE)
            {
                let bin = z.saturating_sub(SMEAR);
                lowest.get_or_insert(bin);
                if column[bin] == Class::FREE {
                    column[bin] = *class;
                }
            }
            column[..lowest.unwrap_or(0)].fill(Class::FREE);
            let out = grid.column_mut(x, y);
            for (to, label) in out
                .iter_mut()
                .zip(column)
                .filter(|(_, label)| *label != Class::FREE)
            {
                *to = label;
            }
        }
        Ok(())
    }
}

/// How high a thing is in each column that it touches.
struct Heights {
    surface: Surface,
    top: BTreeMap<[usize; 2], f64>,
}

impl Heights {
    fn new(extent: Extent) -> Self {
        Self {
            surface: Surface::new(extent),
            top: BTreeMap::new(),
        }
    }

    fn add(&mut self, corners: [DVec3; 3]) {
        let top = &mut self.top;
        self.surface.visit(corners, |column, [_, high]| {
            let known = top.entry(column).or_insert(high);
            *known = known.max(high);
        });
    }

    /// Fills the columns of the box from the ground to what was found there. As in the draft of a box, a voxel counts once a
    /// sixth of it is filled.
    fn fill(self, b: &SceneBox, grid: &mut VoxelGrid) -> Result<(), FormatError> {
        self.surface.finish()?;
        let extent = grid.extent();
        let bottom = extent
            .to_voxel_units(b.center_m - DVec3::Z * (b.size_m.z / 2.0))
            .z;
        let mut columns = Vec::new();
        box_cells(extent, b, 0.0, |x, y| columns.push([x, y]));
        for [x, y] in columns {
            let Some(top) = self.top.get(&[x, y]) else {
                continue;
            };
            let column = grid.column_mut(x, y);
            let ground = |label: &u8| Class::from_id(*label).is_some_and(Class::is_ground);
            let base = column.iter().position(ground);
            let below = (bottom.floor().clamp(0.0, Extent::NZ as f64 - 1.0) as usize).saturating_sub(SMEAR);
            let base = base.filter(|base| *base <= below + 1).unwrap_or(below);
            let layers = ((top - 1.0 / 6.0).floor() + 1.0).clamp(0.0, Extent::NZ as f64) as usize;
            column[base..layers.max(base + 1)].fill(b.class.id());
        }
        Ok(())
    }
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

    fn is_empty(&self) -> bool {
        self.low.x > self.high.x
    }

    /// The longer side, seen from above, m.
    fn long_m(&self) -> f64 {
        (self.high - self.low).truncate().max_element()
    }

    /// Half of the diagonal, m.
    fn radius_m(&self) -> f64 {
        (self.high - self.low).length() / 2.0
    }
}
