//! The way back from a frame to the scene: a change in the view of a moment becomes a change of the canvas, or of the
//! object that moves there. `fold(view) = scene` for a view that was not changed.

use std::collections::{BTreeMap, BTreeSet, HashMap};
use std::sync::Arc;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{Clip, KeyframeSampling, MARGIN_M, Moving, ObjectVoxels, Track};
use crate::grid::NOT_PAINTED;
use crate::raster::box_cells;
use crate::{BoxId, Frame, SceneBox, SourceFrame, VoxelGrid, VoxelPaint};

/// Largest distance from a box at which a painted voxel still belongs to the object, m: one on its roof.
const ONTO_M: f64 = 0.6;

/// Effect that moving an object at one moment has on its other moments.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Scope {
    /// It moves as before, elsewhere.
    #[default]
    WholeTrack,
    /// It moves as before until then, and elsewhere from then on.
    FromHereOn,
    /// It comes by there at that moment, and is where it was at its other keyframes.
    Moment,
}

impl Scope {
    /// Every one.
    pub const ALL: [Scope; 3] = [Scope::Moment, Scope::FromHereOn, Scope::WholeTrack];
}

/// A frame as it was made from the canvas, with the places of the tracks in it.
pub struct ComposedFrame<'a> {
    /// The frame.
    pub frame: &'a Frame,
    /// Boxes of the tracks that are in it.
    pub boxes: &'a [SceneBox],
    /// The moment, s.
    pub time_s: f64,
}

/// The canvas and the clip whose view is `after`, if their view was `seen` before.
pub fn fold(
    canvas: &Frame,
    clip: &Clip,
    seen: &ComposedFrame<'_>,
    after: &Frame,
    scope: Scope,
) -> (Frame, Clip) {
    let before = seen.frame;
    let moving: BTreeMap<BoxId, SceneBox> = seen.boxes.iter().map(|b| (b.id, *b)).collect();
    let mut next = Frame {
        time_s: canvas.time_s,
        world_from_ego: canvas.world_from_ego,
        boxes: after.boxes.clone(),
        layout: after.layout.clone(),
        occupancy: canvas.occupancy.clone(),
        painted: canvas.painted.clone(),
        inferred: after.inferred.clone(),
        waivers: after.waivers.clone(),
        source: canvas.source.clone(),
        absent: Arc::default(),
        own_shapes: Arc::default(),
        covered_m: Arc::default(),
    };
    if clip.ego.is_none() {
        next.world_from_ego = after.world_from_ego;
    }
    next.boxes.retain(|id, _| !moving.contains_key(id));

    let owners = Owners::of(clip, canvas, &moving, &after.boxes);
    let mut touched = BTreeSet::new();
    let changes = differing(&before.occupancy, &after.occupancy);
    owners.put_back(&mut next.occupancy, &changes, after, &mut touched);
    for [x, y] in differing(&before.painted, &after.painted) {
        for (z, label) in after.painted.column(x, y).iter().enumerate() {
            // Voxels painted on an object are a part of it.
            if *label == NOT_PAINTED || owners.owner(after, [x, y, z]).is_none() {
                next.painted.set(x, y, z, *label);
            }
        }
    }
    if !Arc::ptr_eq(&before.source, &after.source) && before.source != after.source {
        let mut source = SourceFrame {
            layout: after.source.layout.clone(),
            boxes: after.source.boxes.clone(),
            occupancy: canvas.source.occupancy.clone(),
        };
        source.boxes.retain(|id, _| !moving.contains_key(id));
        let changes = differing(&before.source.occupancy, &after.source.occupancy);
        let mut ignored = BTreeSet::new();
        owners.put_source_back(
            &mut source.occupancy,
            &changes,
            &after.source.occupancy,
            &mut ignored,
        );
        next.source = Arc::new(source);
    }

    let mut clip_after = clip.clone();
    for (id, was) in &moving {
        let Some(track) = clip_after.tracks.get_mut(id) else {
            continue;
        };
        let Some(now) = after.boxes.get(id) else {
            // An object removed at one moment alone would reappear out of nowhere: it leaves for good.
            let was_there = track.there_s[0].is_none_or(|from| from < seen.time_s) && seen.time_s > 0.0;
            match scope != Scope::WholeTrack && was_there {
                true => track.there_s[1] = Some(seen.time_s),
                false => drop(clip_after.tracks.remove(id)),
            }
            continue;
        };
        follow(track, clip, (was, now), seen.time_s, scope);
        let same_shape = |a: &SceneBox, b: &SceneBox| {
            (a.class, a.size_m) == (b.class, b.size_m) && (a.center_m.z - b.center_m.z).abs() < 1e-9
        };
        let moved = (was.center_m, was.yaw_rad) != (now.center_m, now.yaw_rad);
        if (was.class, was.size_m) != (now.class, now.size_m) {
            track.own_shape = false;
        }
        if track.own_shape {
            let ground_m = |b: &SceneBox| next.layout.relief.height_m(b.center_m.truncate());
            let lift_m = now.center_m.z - ground_m(now) - (was.center_m.z - ground_m(was));
            if lift_m.abs() > 1e-9 {
                lift_own_shape(track, lift_m);
            }
        }
        // An object that was only moved keeps its voxels and ignores the rough ones that the move put there; a shape of
        // its own it keeps at any height.
        let keeps = track.own_shape || same_shape(was, now);
        if !keeps || touched.contains(id) && !moved {
            track.voxels = ObjectVoxels::cut(&after.occupancy, now, |cell, label| {
                owners.is_of(&next.occupancy, *id, cell, label)
            });
            track.made = SceneBox {
                velocity_mps: was.velocity_mps,
                ..*now
            };
        }
        let source = after.source.boxes.get(id);
        track.settled = track.own_shape || source.is_some_and(|b| same_shape(b, now));
    }
    (next, clip_after)
}

/// Makes a shape of its own again, `lift_m` metres higher above the ground; voxels that no longer fit into a grid are
/// cut off.
fn lift_own_shape(track: &mut Track, lift_m: f64) {
    let cells = track.voxels.cells(&track.made);
    let mut made = track.made;
    made.center_m.z += lift_m;
    if let Ok((made, voxels)) = ObjectVoxels::of_cells(track.voxels.lattice, &made, &cells) {
        (track.made, track.voxels) = (made, voxels);
    }
}

/// Applies the changes of a track's box to the track.
fn follow(track: &mut Track, clip: &Clip, (was, now): (&SceneBox, &SceneBox), time_s: f64, scope: Scope) {
    track.made.class = now.class;
    track.made.label = now.label;
    track.made.size_m = now.size_m;
    let (from, to) = (Moving::from(was), Moving::from(now));
    if (from.at_m, from.yaw_rad) == (to.at_m, to.yaw_rad) {
        return;
    }
    let parent = |id: BoxId, time_s: f64| clip.moving(id, time_s);
    let sampling = KeyframeSampling {
        length_s: clip.length_s,
        parent: &parent,
    };
    track.motion = match scope {
        Scope::WholeTrack => track.motion.carried(&from, &to),
        Scope::FromHereOn => track.motion.carried_from(time_s, &from, &to, &sampling),
        Scope::Moment => track.motion.through(time_s, &to, &sampling),
    };
}

/// Columns in which two grids differ.
fn differing<const FILL: u8>(
    a: &crate::grid::BrickGrid<FILL>,
    b: &crate::grid::BrickGrid<FILL>,
) -> Vec<[usize; 2]> {
    let mut out = Vec::new();
    for brick in a.changed_bricks(b) {
        let (from, size) = b.brick_columns(brick);
        for x in from[0]..from[0] + size[0] {
            for y in from[1]..from[1] + size[1] {
                if a.column(x, y) != b.column(x, y) {
                    out.push([x, y]);
                }
            }
        }
    }
    out
}

/// Which voxels belong to which moving object.
struct Owners<'a> {
    canvas: &'a Frame,
    /// Tracks in whose old voxels a column lies: id and bins.
    stamped: HashMap<[usize; 2], Vec<(BoxId, u64)>>,
    /// Tracks within whose old or new footprint and margin a column lies.
    near: HashMap<[usize; 2], Vec<BoxId>>,
    /// The boxes as they are now.
    now: BTreeMap<BoxId, SceneBox>,
}

impl<'a> Owners<'a> {
    fn of(
        clip: &Clip,
        canvas: &'a Frame,
        moving: &BTreeMap<BoxId, SceneBox>,
        after: &BTreeMap<BoxId, SceneBox>,
    ) -> Self {
        let extent = canvas.extent();
        let mut out = Self {
            canvas,
            stamped: HashMap::new(),
            near: HashMap::new(),
            now: BTreeMap::new(),
        };
        for (id, was) in moving {
            let Some(track) = clip.tracks.get(id) else {
                continue;
            };
            track.voxels.visit(extent, &track.made, was, |[x, y, z], _| {
                let list = out.stamped.entry([x, y]).or_default();
                match list.iter_mut().find(|(of, _)| of == id) {
                    Some((_, bins)) => *bins |= 1 << z,
                    None => list.push((*id, 1 << z)),
                }
            });
            let now = after.get(id);
            for b in [Some(was), now.filter(|now| *now != was)].into_iter().flatten() {
                box_cells(extent, b, MARGIN_M, |x, y| {
                    let list = out.near.entry([x, y]).or_default();
                    if !list.contains(id) {
                        list.push(*id);
                    }
                });
            }
            if let Some(now) = now {
                out.now.insert(*id, *now);
            }
        }
        out
    }

    /// Takes changed columns over into the canvas, but for voxels of moving objects; collects whose voxels changed.
    fn put_back(
        &self,
        canvas: &mut VoxelGrid,
        columns: &[[usize; 2]],
        after: &Frame,
        touched: &mut BTreeSet<BoxId>,
    ) {
        self.put(canvas, columns, &after.occupancy, touched, |cell| {
            self.owner(after, cell)
        });
    }

    fn put_source_back(
        &self,
        canvas: &mut VoxelGrid,
        columns: &[[usize; 2]],
        after: &VoxelGrid,
        touched: &mut BTreeSet<BoxId>,
    ) {
        self.put(canvas, columns, after, touched, |cell| {
            self.owner_of(after, None, cell)
        });
    }

    fn put(
        &self,
        canvas: &mut VoxelGrid,
        columns: &[[usize; 2]],
        after: &VoxelGrid,
        touched: &mut BTreeSet<BoxId>,
        owner: impl Fn([usize; 3]) -> Option<BoxId>,
    ) {
        for &[x, y] in columns {
            let column = after.column(x, y);
            for (z, &label) in column.iter().enumerate() {
                match owner([x, y, z]) {
                    Some(id) => {
                        touched.insert(id);
                    }
                    None => canvas.set(x, y, z, label),
                }
            }
        }
    }

    /// The moving object that a voxel of the new frame belongs to, or belonged to.
    fn owner(&self, after: &Frame, cell: [usize; 3]) -> Option<BoxId> {
        self.owner_of(&after.occupancy, Some(&after.painted), cell)
    }

    fn owner_of(
        &self,
        after: &VoxelGrid,
        painted: Option<&VoxelPaint>,
        [x, y, z]: [usize; 3],
    ) -> Option<BoxId> {
        let near = self.near.get(&[x, y])?;
        let mut stamped = self.stamped.get(&[x, y]).into_iter().flatten().rev();
        // The later one was stamped over the earlier.
        if let Some((id, _)) = stamped.find(|(_, bins)| bins >> z & 1 == 1) {
            return Some(*id);
        }
        let label = after.get(x, y, z);
        let of_class = near
            .iter()
            .find(|id| self.now.get(id).is_some_and(|b| b.class.id() == label));
        // A voxel that stands where the canvas has one of that class is the canvas's own.
        let of_class = of_class
            .copied()
            .filter(|_| self.canvas.occupancy.get(x, y, z) != label);
        of_class.or_else(|| {
            // What is painted onto it is a part of it.
            let painted = painted?;
            let onto = painted.get(x, y, z) != self.canvas.painted.get(x, y, z);
            let p = self.canvas.extent().center(x, y, z);
            let holds = |id: &&BoxId| self.now.get(id).is_some_and(|b| b.contains(p, ONTO_M));
            near.iter().find(|id| onto && holds(id)).copied()
        })
    }

    /// True if a voxel of the new frame is a part of this object.
    fn is_of(&self, canvas: &VoxelGrid, id: BoxId, [x, y, z]: [usize; 3], label: u8) -> bool {
        label != crate::Class::FREE && label != canvas.get(x, y, z) && self.nearest(id, [x, y])
    }

    /// True if no other moving object's box is nearer to a column than this one's.
    fn nearest(&self, id: BoxId, [x, y]: [usize; 2]) -> bool {
        let Some(others) = self.near.get(&[x, y]) else {
            return true;
        };
        let p = self.canvas.extent().center(x, y, 0);
        let outside_m = |b: &SceneBox| {
            let local = b.to_local(p.truncate().extend(b.center_m.z)).truncate();
            (local.abs() - b.size_m.truncate() / 2.0)
                .max(glam::DVec2::ZERO)
                .length()
        };
        let own = self.now.get(&id).map_or(f64::INFINITY, outside_m);
        let others = others.iter().filter(|other| **other != id);
        others
            .filter_map(|other| self.now.get(other))
            .all(|other| own <= outside_m(other))
    }
}
