//! Every change a user can make to a scene, as a value: what the window, the command line and tests apply.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

use glam::{DVec2, DVec3};
use serde::{Deserialize, Serialize};

use scene::grid::NOT_PAINTED;
use scene::{
    BevLayer, BevLayout, BoxId, BoxLabel, BoxName, Class, Conditions, Form, Frame, GridSpec, Polyline, Scene,
    SceneBox, SensorRig, SourceFrame, ThingId, VoxelGrid, VoxelPaint, Waiver, raster,
};

use super::Shape;
use super::checks::waive;
use super::shape::at_least;
use super::{immediate, junction, things};

/// Texts of words that a scene keeps, and letters of each.
const MOST_WORDS: usize = 200;
const LONGEST_WORDS: usize = 2000;

/// One change of the current frame (or, for the prompt and the sensors, of the scene). As JSON:
/// `{"remove_box": {"id": 7}}`; unknown keys are refused by name.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum Edit {
    /// Takes a box out, and its voxels.
    RemoveBox {
        /// The box.
        id: BoxId,
    },
    /// Puts a box in, and voxels of its class.
    AddBox {
        /// One of the ten object classes.
        class: Class,
        /// Centre in the ego frame, m.
        center_m: DVec3,
        /// Length, width, height, m.
        size_m: DVec3,
        /// Heading, degrees counter-clockwise from ego x.
        yaw_deg: f64,
        /// Velocity over ground in the ego frame's axes, m/s; none means standing.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        velocity_mps: Option<DVec2>,
        /// Its number; none means the next one free.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        id: Option<BoxId>,
        /// What it is called and how it is painted.
        #[serde(default, skip_serializing_if = "BoxLabel::is_empty")]
        label: BoxLabel,
    },
    /// Moves, turns or resizes a box; what is left out stays.
    MoveBox {
        /// The box.
        id: BoxId,
        /// New centre in the ego frame, m.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        center_m: Option<DVec3>,
        /// New heading, degrees counter-clockwise from ego x.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        yaw_deg: Option<f64>,
        /// New length, width, height, m.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        size_m: Option<DVec3>,
    },
    /// Names and paints a box; what is left out of the label is none. No voxel changes, and nothing is generated.
    LabelBox {
        /// The box.
        id: BoxId,
        /// Its name and paint from now on.
        label: BoxLabel,
    },
    /// Turns a box into another class; its size and paint stay, its name goes.
    SetBoxClass {
        /// The box.
        id: BoxId,
        /// One of the ten object classes.
        class: Class,
    },
    /// Sets or clears a map layer. Clearing dividers or stop lines cuts the lines behind them there.
    PaintBev {
        /// One of the eight map layers.
        layer: BevLayer,
        /// Where.
        shape: Shape,
        /// True sets, false clears.
        value: bool,
    },
    /// Puts things beside the road, and their voxels.
    AddThings {
        /// What and where, world frame.
        forms: Vec<Form>,
    },
    /// Takes things out, and their voxels.
    RemoveThings {
        /// The things.
        ids: Vec<ThingId>,
    },
    /// Moves and turns things together.
    MoveThings {
        /// The things.
        ids: Vec<ThingId>,
        /// How far in the world frame, m.
        by_m: DVec2,
        /// Turn about the middle of them all, degrees counter-clockwise.
        #[serde(default, skip_serializing_if = "is_zero")]
        turn_deg: f64,
    },
    /// Makes things higher (or, with a negative number, lower).
    RaiseThings {
        /// The things.
        ids: Vec<ThingId>,
        /// By how much, m; a storey is 3 m.
        by_m: f64,
    },
    /// Gives a thing another form.
    ChangeThing {
        /// The thing.
        id: ThingId,
        /// What and where from now on, world frame.
        form: Form,
    },
    /// Takes man-made and plant voxels out that belong to no thing, and lays the ground where they stood. Painted voxels stay.
    ClearScenery {
        /// Where; everywhere if left out.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        shape: Option<Shape>,
    },
    /// Puts lines on the ground: lane centres, and dividers, stop lines and crossings with the cells of their layer.
    AddPolylines {
        /// What they mean and where they run, ego frame, m; at least two vertices each.
        lines: Vec<Polyline>,
    },
    /// Sets voxels to a class (`free` removes them) and locks them.
    PaintVoxels {
        /// Indices `[x, y, z]`.
        cells: Vec<[usize; 3]>,
        /// Any class.
        class: Class,
    },
    /// Gives painted voxels back to generation; what they show stays for now.
    UnlockVoxels {
        /// Indices `[x, y, z]`.
        cells: Vec<[usize; 3]>,
    },
    /// Gives every painted voxel of the frame back to generation.
    ClearPaint {},
    /// Corrects what was inferred wrongly when the frame was imported: the box or layer changes, in the source
    /// too, and no voxel does, so that nothing is generated.
    Correct {
        /// A change of a box or of a map layer.
        edit: Box<Edit>,
    },
    /// Confirms what was inferred when the frame was imported: it is marked as a guess no more.
    ConfirmInferred {},
    /// Lets a finding of the checks stand, with the reason. One that was waived before gets the new reason.
    Waive {
        /// Name of the check.
        check: String,
        /// The box it is about, if it is about one.
        #[serde(default, rename = "box", skip_serializing_if = "Option::is_none")]
        box_id: Option<BoxId>,
        /// Where it was found, ego frame, m.
        where_m: DVec3,
        /// Why it may stay; not empty.
        reason: String,
    },
    /// Takes a waiver back: the finding counts again. Nothing if there is none.
    Unwaive {
        /// Name of the check.
        check: String,
        /// The box it is about, if it is about one.
        #[serde(default, rename = "box", skip_serializing_if = "Option::is_none")]
        box_id: Option<BoxId>,
        /// Where it was found, ego frame, m.
        where_m: DVec3,
    },
    /// Replaces the text that describes the style.
    SetPrompt {
        /// The text; empty means none.
        prompt: String,
    },
    /// Replaces light and air. No voxel changes.
    SetConditions {
        /// The new ones.
        conditions: Conditions,
    },
    /// Notes words that were typed to change the scene.
    KeepWords {
        /// The words.
        words: String,
    },
    /// Replaces the sensors of the vehicle. No voxel changes.
    SetRig {
        /// The new ones.
        rig: Box<SensorRig>,
    },
    /// Takes a generated occupancy as the frame's own and as the source of what comes. Not in JSON.
    #[serde(skip)]
    AdoptResult {
        /// What was generated for the current state.
        occupancy: VoxelGrid,
    },
}

fn is_zero(number: &f64) -> bool {
    *number == 0.0
}

/// Why an edit was refused; the scene is then as before. One line each.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum EditError {
    /// No box of that id.
    #[error("box {} does not exist in this frame", .id.0)]
    UnknownBox {
        /// The id asked for.
        id: BoxId,
    },
    /// A box of that id is there already.
    #[error("box {} exists already in this frame", .id.0)]
    DuplicateBox {
        /// The id asked for.
        id: BoxId,
    },
    /// No thing of that id.
    #[error("thing {} does not exist in this scene", .id.0)]
    UnknownThing {
        /// The id asked for.
        id: ThingId,
    },
    /// The thing that would result is not sound; see [`Form::problem`].
    #[error("{0}")]
    BadThing(String),
    /// As many boxes as a frame holds are there.
    #[error("this frame holds {} boxes already, expected at most {}", .0, Frame::MAX_BOXES)]
    TooManyBoxes(usize),
    /// As many waivers as a frame holds are there.
    #[error("this frame holds {} waivers already, expected at most {}", .0, Frame::MAX_WAIVERS)]
    TooManyWaivers(usize),
    /// No id is left for a new box.
    #[error("no box id is left above {}", u32::MAX)]
    NoIdLeft,
    /// The box that would result is not sound; see [`SceneBox::problem`].
    #[error("{0}")]
    BadBox(String),
    /// The sensors that would result are not sound; see [`SensorRig::problem`].
    #[error("{0}")]
    BadRig(String),
    /// The conditions that would result are not sound; see [`Conditions::problem`].
    #[error("{0}")]
    BadConditions(String),
    /// Layers of objects come from boxes.
    #[error("layer {:?} shows boxes and cannot be painted, expected one of the eight map layers", .0.name())]
    ObjectLayer(BevLayer),
    /// What is corrected was edited before, and that edit is not generated yet.
    #[error("{0} has an edit that is not generated yet, expected none under a correction")]
    Unsettled(String),
    /// Voxels and the prompt are not inferred.
    #[error("only boxes and map layers can be corrected")]
    NoCorrection,
    /// A number that cannot be used.
    #[error("{field} is {found}, expected {expected}")]
    Number {
        /// Key of the edit.
        field: &'static str,
        /// Its value.
        found: String,
        /// What would do.
        expected: &'static str,
    },
    /// A list that is too short.
    #[error("{field} holds {found} entries, expected at least {expected}")]
    TooFew {
        /// Key of the edit.
        field: &'static str,
        /// Entries found.
        found: usize,
        /// Entries needed.
        expected: usize,
    },
    /// An index beyond the grid.
    #[error(
        "cell {cell:?} is outside the grid of {} x {} x {}",
        GridSpec::NX,
        GridSpec::NY,
        GridSpec::NZ
    )]
    CellOutside {
        /// The index: x, y and perhaps z.
        cell: Vec<usize>,
    },
    /// A shape that misses the grid or every cell centre.
    #[error("the shape covers no cell of the grid")]
    NoCell,
    /// A waiver of no check, without a place or without a reason.
    #[error("{0}")]
    BadWaiver(String),
    /// A move that names no change.
    #[error("move_box needs at least one of center_m, yaw_deg and size_m")]
    NothingToMove,
}

impl Edit {
    /// Applies the change to the scene's current frame: the authored data and, at once, a rough
    /// version in the voxels (a correction leaves them). All or nothing: on error the scene is as before. A change that
    /// changes nothing leaves the revision as it is. The frame's `source` is touched by
    /// [`Edit::AdoptResult`] and [`Edit::Correct`] only.
    pub fn apply(&self, scene: &mut Scene) -> Result<(), EditError> {
        match self {
            Self::SetPrompt { prompt } => {
                if scene.prompt.as_ref() != prompt {
                    scene.rev = scene::SceneRev::fresh();
                    scene.prompt = prompt.as_str().into();
                }
            }
            Self::SetConditions { conditions } => {
                if let Some(problem) = conditions.problem() {
                    return Err(EditError::BadConditions(problem));
                }
                if scene.conditions != *conditions {
                    scene.rev = scene::SceneRev::fresh();
                    scene.conditions = *conditions;
                }
            }
            Self::KeepWords { words } => {
                scene.rev = scene::SceneRev::fresh();
                let kept = Arc::make_mut(&mut scene.words);
                kept.push(words.chars().take(LONGEST_WORDS).collect());
                let over = kept.len().saturating_sub(MOST_WORDS);
                kept.drain(..over);
            }
            Self::SetRig { rig } => {
                if let Some(problem) = rig.problem() {
                    return Err(EditError::BadRig(problem));
                }
                if *scene.rig != **rig {
                    scene.rev = scene::SceneRev::fresh();
                    scene.rig = Arc::new(SensorRig::clone(rig));
                }
            }
            Self::ClearScenery { shape } => {
                let cells = shape.as_ref().map(Shape::cells).transpose()?;
                things::clear_scenery(scene, cells.as_deref());
            }
            edit if edit.is_of_things() => {
                if let Some(background) = things::changed(self, &scene.background)? {
                    things::replace_background(scene, background);
                }
            }
            edit => {
                // A frame is a few hundred pointers; working on a copy makes "all or nothing" certain.
                let mut frame = Frame::clone(scene.frame());
                edit.apply_to(&mut frame)?;
                if frame != **scene.frame() {
                    *scene.frame_mut() = frame;
                }
            }
        }
        Ok(())
    }

    /// Applies edits in order; an error stops there. Things that are changed one after another are drawn once, at the end.
    pub fn apply_all(edits: &[Self], scene: &mut Scene) -> Result<(), EditError> {
        let goes_on =
            |a: &Self, b: &Self| a.is_of_things() && b.is_of_things() || a.is_of_a_box() && b.is_of_a_box();
        for run in edits.chunk_by(goes_on) {
            if run[0].is_of_a_box() {
                super::box_run::apply(run, scene)?;
                continue;
            }
            if !run[0].is_of_things() {
                run.iter().try_for_each(|edit| edit.apply(scene))?;
                continue;
            }
            let mut background = None;
            for edit in run {
                let before = background.as_ref().unwrap_or(&*scene.background);
                background = things::changed(edit, before)?.or(background);
            }
            if let Some(background) = background {
                things::replace_background(scene, background);
            }
        }
        Ok(())
    }

    /// True if it changes a box.
    pub(super) fn is_of_a_box(&self) -> bool {
        matches!(
            self,
            Self::AddBox { .. }
                | Self::RemoveBox { .. }
                | Self::MoveBox { .. }
                | Self::LabelBox { .. }
                | Self::SetBoxClass { .. }
        )
    }

    /// True if it changes things of the background.
    pub fn is_of_things(&self) -> bool {
        matches!(
            self,
            Self::AddThings { .. }
                | Self::RemoveThings { .. }
                | Self::MoveThings { .. }
                | Self::RaiseThings { .. }
                | Self::ChangeThing { .. }
        )
    }

    pub(super) fn apply_to(&self, frame: &mut Frame) -> Result<(), EditError> {
        match self {
            Self::RemoveBox { id } => {
                let old = take_box(frame, *id)?;
                immediate::clear_box(frame, &old);
            }
            Self::AddBox {
                class,
                center_m,
                size_m,
                yaw_deg,
                velocity_mps,
                id,
                label,
            } => {
                if frame.boxes.len() >= Frame::MAX_BOXES {
                    return Err(EditError::TooManyBoxes(frame.boxes.len()));
                }
                let id = match *id {
                    Some(id) => id,
                    None => next_id(frame)?,
                };
                if frame.boxes.contains_key(&id) {
                    return Err(EditError::DuplicateBox { id });
                }
                let new = SceneBox {
                    id,
                    class: *class,
                    center_m: *center_m,
                    size_m: *size_m,
                    yaw_rad: yaw_deg.to_radians(),
                    velocity_mps: velocity_mps.unwrap_or_default(),
                    label: *label,
                };
                put_box(frame, new)?;
            }
            Self::MoveBox {
                id,
                center_m,
                yaw_deg,
                size_m,
            } => {
                if center_m.is_none() && yaw_deg.is_none() && size_m.is_none() {
                    return Err(EditError::NothingToMove);
                }
                change_box(frame, *id, |b| {
                    b.center_m = center_m.unwrap_or(b.center_m);
                    b.size_m = size_m.unwrap_or(b.size_m);
                    b.yaw_rad = yaw_deg.map_or(b.yaw_rad, f64::to_radians);
                })?;
            }
            Self::LabelBox { id, label } => {
                let b = frame.boxes.get_mut(id).ok_or(EditError::UnknownBox { id: *id })?;
                b.label = *label;
                // The source takes it over: a label is no change that waits for the networks.
                if frame.source.boxes.get(id).is_some_and(|b| b.label != *label)
                    && let Some(b) = Arc::make_mut(&mut frame.source).boxes.get_mut(id)
                {
                    b.label = *label;
                }
            }
            Self::SetBoxClass { id, class } => change_box(frame, *id, |b| {
                if b.class != *class {
                    b.label.name = BoxName::default();
                }
                b.class = *class;
            })?,
            Self::PaintBev { layer, shape, value } => {
                if layer.is_object() {
                    return Err(EditError::ObjectLayer(*layer));
                }
                let mut cells = shape.cells()?;
                if !value {
                    junction::cut_lines(&mut frame.layout, *layer, &cells);
                }
                cells.retain(|&[x, y]| frame.layout.has(*layer, x, y) != *value);
                for &[x, y] in &cells {
                    frame.layout.set(*layer, x, y, *value);
                }
                if immediate::shapes_ground(*layer) {
                    immediate::lay_ground(frame, &cells);
                }
            }
            Self::AddPolylines { lines } => {
                check_lines(lines)?;
                add_lines(&mut frame.layout, lines);
            }
            Self::PaintVoxels { cells, class } => {
                check_voxels(cells)?;
                for &[x, y, z] in cells {
                    frame.painted.set(x, y, z, class.id());
                    frame.occupancy.set(x, y, z, class.id());
                }
            }
            Self::UnlockVoxels { cells } => {
                check_voxels(cells)?;
                for &[x, y, z] in cells {
                    frame.painted.set(x, y, z, NOT_PAINTED);
                }
            }
            Self::Correct { edit } => correct(frame, edit)?,
            Self::ConfirmInferred {} => {
                frame.inferred.layout = false;
                frame.inferred.background = false;
                frame.inferred.boxes.clear();
            }
            Self::Waive {
                check,
                box_id,
                where_m,
                reason,
            } => {
                let new = waive::checked(check, *box_id, *where_m, reason)?;
                let list = Arc::make_mut(&mut frame.waivers);
                list.retain(|w| !same_finding(w, check, *box_id, *where_m));
                if list.len() >= Frame::MAX_WAIVERS {
                    return Err(EditError::TooManyWaivers(list.len()));
                }
                list.push(new);
            }
            Self::Unwaive {
                check,
                box_id,
                where_m,
            } => Arc::make_mut(&mut frame.waivers).retain(|w| !same_finding(w, check, *box_id, *where_m)),
            Self::ClearPaint {} => frame.painted = VoxelPaint::new(),
            Self::AdoptResult { occupancy } => adopt(frame, occupancy.clone()),
            // These concern the scene, see `apply`.
            Self::SetPrompt { .. }
            | Self::SetConditions { .. }
            | Self::KeepWords { .. }
            | Self::SetRig { .. }
            | Self::ClearScenery { .. }
            | Self::AddThings { .. }
            | Self::RemoveThings { .. }
            | Self::MoveThings { .. }
            | Self::RaiseThings { .. }
            | Self::ChangeThing { .. } => {}
        }
        Ok(())
    }
}

/// True if the waiver names that finding, to the millimetre where it has no box.
fn same_finding(w: &Waiver, check: &str, box_id: Option<BoxId>, where_m: DVec3) -> bool {
    &*w.check == check && w.box_id == box_id && (box_id.is_some() || w.where_m.distance(where_m) < 1e-3)
}

/// Makes a generated occupancy the frame's own and its source. Painted voxels keep what was painted.
pub(super) fn adopt(frame: &mut Frame, mut occupancy: VoxelGrid) {
    for (x, y, z, class) in frame.painted.iter_set() {
        occupancy.set(x, y, z, class);
    }
    frame.occupancy = occupancy;
    frame.source = Arc::new(SourceFrame {
        layout: frame.layout.clone(),
        boxes: frame.boxes.clone(),
        occupancy: frame.occupancy.clone(),
    });
}

fn next_id(frame: &Frame) -> Result<BoxId, EditError> {
    let taken: &BTreeMap<_, _> = &frame.boxes;
    if taken.contains_key(&BoxId(u32::MAX)) {
        // `next_box_id` counts up from the highest; the lowest gap instead.
        let above_zero = taken.keys().filter(|id| id.0 > 0);
        let free = (1..).zip(above_zero).find(|(free, id)| id.0 != *free);
        return free.map(|(id, _)| BoxId(id)).ok_or(EditError::NoIdLeft);
    }
    Ok(frame.next_box_id())
}

/// Applies a change to what was authored, in the frame and in its source, and to no voxel.
fn correct(frame: &mut Frame, edit: &Edit) -> Result<(), EditError> {
    let before = frame.clone();
    edit.apply_to(frame)?;
    frame.occupancy = before.occupancy;
    let source = Arc::make_mut(&mut frame.source);
    match edit {
        Edit::AddBox { .. } | Edit::RemoveBox { .. } | Edit::MoveBox { .. } | Edit::SetBoxClass { .. } => {
            let ids: BTreeSet<_> = before.boxes.keys().chain(frame.boxes.keys()).collect();
            for id in ids {
                if before.boxes.get(id) == frame.boxes.get(id) {
                    continue;
                }
                // The source would take over the pending edit with the correction, and it would never be generated.
                if before.boxes.get(id) != source.boxes.get(id) {
                    return Err(EditError::Unsettled(format!("box {}", id.0)));
                }
                match frame.boxes.get(id) {
                    Some(b) => source.boxes.insert(*id, *b),
                    None => source.boxes.remove(id),
                };
            }
        }
        Edit::PaintBev { layer, shape, value } => {
            let mut cells = shape.cells()?;
            if !value {
                junction::cut_lines(&mut source.layout, *layer, &cells);
            }
            cells.retain(|[x, y]| before.layout.has(*layer, *x, *y) != *value);
            for [x, y] in cells {
                if source.layout.has(*layer, x, y) == *value {
                    return Err(EditError::Unsettled(format!("column ({x}, {y})")));
                }
                source.layout.set(*layer, x, y, *value);
            }
        }
        Edit::AddPolylines { lines } => add_lines(&mut source.layout, lines),
        _ => return Err(EditError::NoCorrection),
    }
    Ok(())
}

fn take_box(frame: &mut Frame, id: BoxId) -> Result<SceneBox, EditError> {
    frame.inferred.boxes.remove(&id);
    frame.boxes.remove(&id).ok_or(EditError::UnknownBox { id })
}

fn put_box(frame: &mut Frame, new: SceneBox) -> Result<(), EditError> {
    if let Some(problem) = new.problem() {
        return Err(EditError::BadBox(problem));
    }
    frame.boxes.insert(new.id, new);
    immediate::stamp_box(frame, &new);
    Ok(())
}

fn change_box(frame: &mut Frame, id: BoxId, change: impl FnOnce(&mut SceneBox)) -> Result<(), EditError> {
    let old = *frame.boxes.get(&id).ok_or(EditError::UnknownBox { id })?;
    let mut new = old;
    change(&mut new);
    if new == old {
        return Ok(());
    }
    // A box that is not sound leaves this copy of the frame half changed; the scene keeps the old one.
    take_box(frame, id)?;
    immediate::clear_box(frame, &old);
    put_box(frame, new)
}

fn add_lines(layout: &mut BevLayout, lines: &[Polyline]) {
    for line in lines {
        raster::draw_polyline(layout, line);
    }
    Arc::make_mut(&mut layout.polylines).extend_from_slice(lines);
}

fn check_lines(lines: &[Polyline]) -> Result<(), EditError> {
    at_least("lines", lines.len(), 1)?;
    for line in lines {
        at_least("points_m", line.points_m.len(), 2)?;
        let limit = DVec2::splat(SceneBox::LIMIT_M);
        // Written so that NaN fails too.
        if let Some(p) = line.points_m.iter().find(|p| !p.abs().cmple(limit).all()) {
            return Err(EditError::Number {
                field: "points_m",
                found: format!("[{}, {}]", p.x, p.y),
                expected: "finite numbers within 1000 m",
            });
        }
    }
    Ok(())
}

fn check_voxels(cells: &[[usize; 3]]) -> Result<(), EditError> {
    at_least("cells", cells.len(), 1)?;
    let outside = |c: &&[usize; 3]| c[0] >= GridSpec::NX || c[1] >= GridSpec::NY || c[2] >= GridSpec::NZ;
    match cells.iter().find(outside) {
        Some(c) => Err(EditError::CellOutside { cell: c.to_vec() }),
        None => Ok(()),
    }
}

#[cfg(test)]
#[path = "edit_tests.rs"]
mod tests;
