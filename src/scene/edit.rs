//! Every change of a scene as a value, with its errors and its JSON: the common output of tools, words, command line
//! and files. The editor applies them.

use glam::{DVec2, DVec3};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::clip::Manoeuvre;
use crate::grid::Extent;
use crate::roads::RoadChange;
use crate::shape::Shape;
use crate::{
    Arrangement, BevLayer, BoxId, BoxLabel, Class, Conditions, Form, Frame, Motion, Polyline, SceneBox,
    Scope, SensorRig, Template, ThingId,
};

/// One change of the frame that is shown (or, for the prompt and the sensors, of the scene). As JSON:
/// `{"remove_box": {"id": 7}}`; unknown keys are refused by name.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
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
        /// Centre in the world frame, m.
        #[schemars(with = "[f64; 3]")]
        center_m: DVec3,
        /// Length, width, height, m.
        #[schemars(with = "[f64; 3]")]
        size_m: DVec3,
        /// Heading, degrees counter-clockwise from x.
        yaw_deg: f64,
        /// Velocity over ground in the world frame's axes, m/s; none means standing.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        #[schemars(with = "Option<[f64; 2]>")]
        velocity_mps: Option<DVec2>,
        /// Its number; none means the next one free.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        id: Option<BoxId>,
        /// Name and paint.
        #[serde(default, skip_serializing_if = "BoxLabel::is_empty")]
        label: BoxLabel,
    },
    /// Moves, turns or resizes a box; what is left out stays.
    MoveBox {
        /// The box.
        id: BoxId,
        /// New centre in the world frame, m.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        #[schemars(with = "Option<[f64; 3]>")]
        center_m: Option<DVec3>,
        /// New heading, degrees counter-clockwise from x.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        yaw_deg: Option<f64>,
        /// New length, width, height, m.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        #[schemars(with = "Option<[f64; 3]>")]
        size_m: Option<DVec3>,
    },
    /// Names and paints a box; what is left out of the label is none. No voxel changes, and nothing is generated.
    LabelBox {
        /// The box.
        id: BoxId,
        /// Its name and paint from now on.
        label: BoxLabel,
    },
    /// Groups, hides or locks boxes and things, or the opposite. No voxel changes, and nothing is generated.
    Arrange {
        /// The boxes.
        #[serde(default, skip_serializing_if = "Vec::is_empty")]
        boxes: Vec<BoxId>,
        /// The things.
        #[serde(default, skip_serializing_if = "Vec::is_empty")]
        things: Vec<ThingId>,
        /// Change of their arrangement.
        how: Arrangement,
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
        /// Cells to set or clear.
        shape: Shape,
        /// True sets, false clears.
        value: bool,
    },
    /// Puts things beside the road, and their voxels. They stay when scenery is drawn anew.
    AddThings {
        /// Kinds and places, world frame.
        forms: Vec<Form>,
    },
    /// Puts scenery drawn by a seed beside the road, and its voxels. It goes when scenery is drawn anew.
    DrawScenery {
        /// Kinds and places, world frame.
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
        #[schemars(with = "[f64; 2]")]
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
        /// Its new kind and place, world frame.
        form: Form,
    },
    /// Takes man-made and plant voxels out that belong to no thing, and lays the ground where they stood. Painted voxels stay.
    ClearScenery {
        /// Area to clear; everywhere if left out.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        shape: Option<Shape>,
    },
    /// Puts lines on the ground: lane centres, and dividers, stop lines and crossings with the cells of their layer.
    AddPolylines {
        /// Kinds and vertices of the lines, world frame, m; at least two vertices each.
        lines: Vec<Polyline>,
    },
    /// Changes the road network. What it draws differently from before is drawn anew: layers, lines, ground. In a scene that has
    /// no network yet, what is painted is recognised first.
    ChangeRoads {
        /// Change to apply.
        change: RoadChange,
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
    /// An edit at another moment than the one that is shown, and what it means for other moments. What stands still is changed
    /// for all moments anyway. At most one of `frame`, `time_s` and `track` is given, and at least one of all keys.
    At {
        /// Number of the frame.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        frame: Option<usize>,
        /// Time in the clip, s.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        time_s: Option<f64>,
        /// A moving object that the edit is of: the moment is one at which it is there.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        track: Option<BoxId>,
        /// For which moments a moving object changes its place; the whole track if left out.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        scope: Option<Scope>,
        /// Edit to apply there.
        edit: Box<Edit>,
    },
    /// Gives a box voxels of its own, in place of those of its class: they go wherever it goes and are not generated. Another
    /// size or class takes them away again.
    SetShape {
        /// The box.
        id: BoxId,
        /// Voxels of 0.4 m that are its class's, as `[ahead, left, up]` from its middle seen from above and from its
        /// underside: `[0, 0, 0]` is ahead of and left of the middle, and the underside is in it. None: its class's again.
        cells: Vec<[i32; 3]>,
    },
    /// Lets an object or the ego vehicle move, or (without a motion) stand where it is at the moment that is shown.
    SetMotion {
        /// The box; the ego vehicle if left out.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        id: Option<BoxId>,
        /// How it moves from now on, world frame.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        motion: Option<Motion>,
        /// When it appears, s; it is there from the beginning if left out. Not of the ego vehicle.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        from_s: Option<f64>,
        /// When it disappears, s; it is there to the end if left out. Not of the ego vehicle.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        to_s: Option<f64>,
    },
    /// So many seconds more: what moves at the end goes on along its lane and behind whoever is ahead, the ego vehicle too, and
    /// the map grows to where it comes.
    Forecast {
        /// How many, s.
        seconds: f64,
    },
    /// Makes the map larger, in the world frame. Roads go on beyond the edge as they reach it; what is new is to be generated.
    ExtendMap {
        /// So much farther along x, m.
        #[serde(default)]
        ahead_m: f64,
        /// So much farther against x, m.
        #[serde(default)]
        behind_m: f64,
        /// So much farther along y, m.
        #[serde(default)]
        left_m: f64,
        /// So much farther against y, m.
        #[serde(default)]
        right_m: f64,
    },
    /// Lets a box move in a way that has a name, from where it is at the moment that is shown, along the lanes of the map. A
    /// scene of one moment becomes a clip.
    LetMove {
        /// The box; the ego vehicle if left out.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        id: Option<BoxId>,
        /// How.
        template: Template,
        /// Speed, m/s; a usual one of its class if left out.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        mps: Option<f64>,
        /// When what it is about begins, s; soon if left out.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        from_s: Option<f64>,
        /// It begins when so much is between it and the ego vehicle, m, in place of at a time; who follows keeps so much to the
        /// one ahead. Bumper to bumper.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        gap_m: Option<f64>,
    },
    /// Lets everything that says how fast it is but stands go on along its lane, each at a distance to the one ahead. What would
    /// come into something, a wall, a parked vehicle or one another, stays where it is.
    LetTrafficDrive {},
    /// Sets how long the scene lasts. What happens later than that stays, and is not shown.
    SetLength {
        /// Length, s; 0 for a scene of one moment.
        length_s: f64,
        /// Frames per second of what is written; as before if left out.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        rate_hz: Option<f64>,
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
        /// Place of the finding, world frame, m.
        #[schemars(with = "[f64; 3]")]
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
        /// Place of the finding, world frame, m.
        #[schemars(with = "[f64; 3]")]
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
}

fn is_zero(number: &f64) -> bool {
    *number == 0.0
}

/// Reason why an edit was refused; the scene is unchanged then. One line each.
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
    /// A locked box would change.
    #[error("box {} is locked", .id.0)]
    LockedBox {
        /// The box.
        id: BoxId,
    },
    /// A locked thing would change.
    #[error("thing {} is locked", .id.0)]
    LockedThing {
        /// The thing.
        id: ThingId,
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
    /// A change of roads that is not possible.
    #[error("{0}")]
    BadRoads(String),
    /// A map that is too large.
    #[error("{0}")]
    BadMap(String),
    /// The frame holds the largest number of boxes already.
    #[error("this frame holds {} boxes already, expected at most {}", .0, Frame::MAX_BOXES)]
    TooManyBoxes(usize),
    /// The frame holds the largest number of waivers already.
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
    /// The item to correct was edited before, and that edit is not generated yet.
    #[error("{0} has an edit that is not generated yet, expected none under a correction")]
    Unsettled(String),
    /// Voxels and the prompt are not inferred, so they cannot be corrected.
    #[error("only boxes and map layers can be corrected")]
    NoCorrection,
    /// A number that cannot be used.
    #[error("{field} is {found}, expected {expected}")]
    Number {
        /// Key of the edit.
        field: &'static str,
        /// Its value.
        found: String,
        /// Values that are accepted.
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
    #[error("cell {cell:?} is outside the grid of {extent}")]
    CellOutside {
        /// The index: x, y and perhaps z.
        cell: Vec<usize>,
        /// The grid.
        extent: Extent,
    },
    /// A result of another map than the frame's.
    #[error("a result of {found} is no result of this frame, expected {expected}")]
    OtherExtent {
        /// Extent of the result.
        found: Extent,
        /// Extent of the frame.
        expected: Extent,
    },
    /// A shape that misses the grid or every cell centre.
    #[error("the shape covers no cell of the grid")]
    NoCell,
    /// A waiver of no check, without a place or without a reason.
    #[error("{0}")]
    BadWaiver(String),
    /// A moment that the clip does not have, or no moment.
    #[error("{0}")]
    BadMoment(String),
    /// A shape that is not sound; see [`ObjectVoxels::of_cells`](crate::clip::ObjectVoxels::of_cells).
    #[error("{0}")]
    BadShape(String),
    /// A motion or a length that is not sound; see [`Clip::problem`](crate::Clip::problem).
    #[error("{0}")]
    BadMotion(String),
    /// A move that names no change.
    #[error("move_box needs at least one of center_m, yaw_deg and size_m")]
    NothingToMove,
}

impl Edit {
    /// Lets a box, or (`None`) the ego vehicle, carry out a manoeuvre.
    pub fn let_move(how: &Manoeuvre, id: Option<BoxId>, class: Option<Class>) -> Self {
        let usual = Template::usual_mps(class);
        let paced = how.pace.map(|pace| pace.factor() * usual);
        Self::LetMove {
            id,
            template: how.what,
            mps: how.kmh.map(|kmh| kmh / 3.6).or(paced),
            from_s: how.from_s,
            gap_m: how.gap_m,
        }
    }

    /// The box that [`Edit::AddBox`] puts in, where the edit names its number.
    pub fn added_box(&self) -> Option<SceneBox> {
        match self {
            Self::AddBox {
                class,
                center_m,
                size_m,
                yaw_deg,
                velocity_mps,
                id: Some(id),
                label,
            } => Some(SceneBox {
                id: *id,
                class: *class,
                center_m: *center_m,
                size_m: *size_m,
                yaw_rad: yaw_deg.to_radians(),
                velocity_mps: velocity_mps.unwrap_or_default(),
                label: *label,
            }),
            _ => None,
        }
    }

    /// True if the edit changes a box.
    pub fn is_of_a_box(&self) -> bool {
        matches!(
            self,
            Self::AddBox { .. }
                | Self::RemoveBox { .. }
                | Self::MoveBox { .. }
                | Self::LabelBox { .. }
                | Self::SetBoxClass { .. }
        )
    }

    /// True if the edit changes things of the background.
    pub fn is_of_things(&self) -> bool {
        matches!(
            self,
            Self::AddThings { .. }
                | Self::DrawScenery { .. }
                | Self::RemoveThings { .. }
                | Self::MoveThings { .. }
                | Self::RaiseThings { .. }
                | Self::ChangeThing { .. }
        )
    }
}

impl From<SceneBox> for Edit {
    /// An edit that adds exactly this box, with its id.
    fn from(b: SceneBox) -> Self {
        Self::AddBox {
            class: b.class,
            center_m: b.center_m,
            size_m: b.size_m,
            yaw_deg: b.yaw_rad.to_degrees(),
            velocity_mps: Some(b.velocity_mps),
            id: Some(b.id),
            label: b.label,
        }
    }
}
