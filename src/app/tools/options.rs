//! What the tools hold in hand between two frames: options, selection, clipboard, points of an outline.

use std::collections::{BTreeMap, BTreeSet};

use glam::{DVec2, DVec3};

use crate::bev_image::DRAW_ORDER;
use crate::canvas_tools;
use crate::scenery::Drawer;
use crate::state::UiState;
use editor::Edit;
use editor::arrange::{Clipboard, Pivot, Row};
use editor::flood::FillBounds;
use editor::lane_strip::LaneStrip;
use editor::measure::Measure;
use editor::transform::{Kind, Orientation, Snap};
use editor::voxel_ops::{self, Cell};
use job::GenParams;
use job::redraw::RedrawMask;
use scene::{BevLayer, BoxId, Class, Frame, Scene, SceneBox, SceneRev, ThingId, variants};

use super::Choose;

/// States of the scene whose selection is kept.
const REMEMBERED_SELECTIONS: usize = 512;
/// What is drawn anew has no inverted noise that already holds most of it.
const FEWEST_STEPS_ANEW: u32 = 10;

/// What a drag of the brush draws.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum PaintShape {
    /// A stroke along the way; straight with Ctrl.
    #[default]
    Stroke,
    /// An upright rectangle from corner to corner.
    Rectangle,
    /// A straight stroke.
    Line,
    /// An outline, point by point.
    Polygon,
    /// A street along points.
    Street,
    /// What is connected and alike.
    Fill,
    /// Takes over the layer under the pointer.
    Pick,
}

/// How a region is marked.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum RegionShape {
    /// From corner to corner.
    #[default]
    Rectangle,
    /// What an outline goes around.
    Lasso,
    /// Along the way.
    Brush,
}

impl PaintShape {
    /// True for strokes, whose width the brush has.
    pub fn has_width(self) -> bool {
        matches!(self, PaintShape::Stroke | PaintShape::Line)
    }

    /// Every shape with its name and key.
    pub const ALL: [(PaintShape, &'static str, &'static str); 7] = [
        (PaintShape::Stroke, "Freehand", "B; straight with Ctrl held"),
        (PaintShape::Rectangle, "Rectangle", "U"),
        (PaintShape::Line, "Line", "L"),
        (PaintShape::Polygon, "Polygon", "P"),
        (PaintShape::Street, "Street", "P again"),
        (PaintShape::Fill, "Fill", "K"),
        (PaintShape::Pick, "Pick", "I, or Alt+click"),
    ];
}

/// What a drag of the voxel tool does.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum VoxelMode {
    /// Follows the pointer.
    #[default]
    Brush,
    /// A box from corner to corner, its height by the wheel.
    Block,
    /// A straight line.
    Row,
    /// What is connected and of one class.
    Fill,
    /// Chooses what is connected and of one class.
    Wand,
    /// Pulls a face out or pushes it in.
    Extrude,
}

impl VoxelMode {
    /// Every mode with its name and hint.
    pub const ALL: [(VoxelMode, &'static str, &'static str); 6] = [
        (VoxelMode::Brush, "Dab", "B"),
        (VoxelMode::Block, "Block", "U; wheel sets the height"),
        (VoxelMode::Row, "Row", "L"),
        (VoxelMode::Fill, "Flood", "K; connected voxels of one class"),
        (VoxelMode::Wand, "Wand", "Shift+O; chooses connected voxels"),
        (VoxelMode::Extrude, "Pull", "P; drags a face out or in"),
    ];
}

/// What the tools hold.
#[derive(Clone, Debug)]
pub struct ToolState {
    /// What was copied.
    pub clipboard: Clipboard,
    /// Selecting draws lassos instead of rectangles.
    pub lasso: bool,
    /// What dragging a chosen box changes.
    pub gizmo: Kind,
    /// Whose axes gizmo and number fields use.
    pub orientation: Orientation,
    /// About what several boxes turn.
    pub pivot: Pivot,
    /// Moves snap to the grid without Ctrl, too.
    pub snap_grid: bool,
    /// Step of that grid, m.
    pub grid_m: f64,
    /// Moves snap to lanes.
    pub snap_lane: bool,
    /// Moves snap to the ground.
    pub snap_ground: bool,
    /// A mirrored box that changes sides is turned.
    pub mirror_keeps_direction: bool,
    /// What the brush draws.
    pub shape: PaintShape,
    /// Points of an outline or street that is being drawn, ego frame, m.
    pub points_m: Vec<DVec2>,
    /// What a street has.
    pub street: LaneStrip,
    /// What bounds a fill.
    pub fill: FillBounds,
    /// What is measured.
    pub measure: Measure,
    /// What the voxel tool does.
    pub voxel_mode: VoxelMode,
    /// Height of the voxel brush and of a new block, voxels.
    pub voxel_height: usize,
    /// Voxels are painted on both sides of the ego x axis.
    pub symmetry: bool,
    /// Voxels chosen by the wand.
    pub voxels: Vec<Cell>,
    /// Cells to be drawn anew although nothing was edited there.
    pub region: RedrawMask,
    /// They are marked by a brush of the brush's size; false: by rectangles.
    pub region_shape: RegionShape,
    /// How far they leave what is there, 0 to 1.
    pub region_strength: f64,
    /// How often cells were drawn anew: each time other noise.
    pub region_draws: u64,
    /// What draws scenery.
    pub drawer: Drawer,
    /// Times that scenery was drawn.
    pub scenery_draws: u64,
    /// Kind of the next box of each class, by index among its kinds; none means the typical size.
    pub variants: BTreeMap<Class, usize>,
    /// Bit per map layer that is not painted.
    pub layers_locked: u32,
    /// Opacity of each map layer over what lies below it, in draw order, 0 to 1.
    pub layer_opacity: [f32; DRAW_ORDER.len()],
    /// Opacity of all map layers together over voxels, 0 to 1.
    pub layers_opacity: f32,
    /// Layers shown before one was shown alone.
    pub before_solo: Option<u32>,
    /// What was chosen in states of the scene, by their revision: undo brings it back.
    pub selections: BTreeMap<SceneRev, (Vec<BoxId>, Vec<ThingId>)>,
    /// The dialog of rows, if it is open.
    pub row_open: bool,
    /// Its numbers.
    pub row: Row,
    /// What the tools for things hold.
    pub things: super::things::ThingState,
    /// Where the pointer is over the bird's-eye view, ego frame, m.
    pub pointer_m: Option<DVec2>,
}

impl Default for ToolState {
    fn default() -> Self {
        Self {
            clipboard: Clipboard::default(),
            lasso: false,
            gizmo: Kind::default(),
            orientation: Orientation::default(),
            pivot: Pivot::default(),
            snap_grid: false,
            grid_m: 0.4,
            snap_lane: false,
            snap_ground: false,
            mirror_keeps_direction: true,
            shape: PaintShape::default(),
            points_m: Vec::new(),
            street: LaneStrip::default(),
            fill: FillBounds::default(),
            measure: Measure::default(),
            voxel_mode: VoxelMode::default(),
            voxel_height: 1,
            symmetry: false,
            voxels: Vec::new(),
            region: RedrawMask::default(),
            region_shape: RegionShape::default(),
            region_strength: 1.0,
            region_draws: 0,
            drawer: Drawer::Rules(None),
            scenery_draws: 0,
            variants: BTreeMap::new(),
            layers_locked: 0,
            layer_opacity: [1.0; DRAW_ORDER.len()],
            layers_opacity: 0.5,
            before_solo: None,
            selections: BTreeMap::new(),
            row_open: false,
            row: Row::default(),
            things: super::things::ThingState::default(),
            pointer_m: None,
        }
    }
}

impl ToolState {
    /// True if the layer must not be painted.
    pub fn is_locked(&self, layer: BevLayer) -> bool {
        self.layers_locked & layer.bit() != 0
    }

    /// What a move snaps to now; `ctrl` held means the grid.
    pub fn snap(&self, ctrl: bool) -> Snap {
        Snap {
            grid_m: (self.snap_grid || ctrl).then_some(self.grid_m),
            lane: self.snap_lane && !ctrl,
            ground: self.snap_ground,
        }
    }

    /// Makes parameters draw the region anew.
    pub fn draw_anew(&mut self, params: &mut GenParams) {
        self.region_draws += 1;
        params.redraw = self.region;
        params.strength = self.region_strength;
        params.steps = params.steps.max(FEWEST_STEPS_ANEW);
        params.seed = params.seed.wrapping_add(self.region_draws);
    }

    /// Voxels with their mirror images, if symmetry is on.
    pub fn both_sides(&self, cells: Vec<Cell>) -> Vec<Cell> {
        match self.symmetry {
            true => voxel_ops::mirrored(&cells),
            false => cells,
        }
    }

    /// Length, width and height of the next box of a class, m; `None` for a class that is no object.
    pub fn size_of(&self, class: Class) -> Option<DVec3> {
        let kind = self.variants.get(&class);
        let chosen = kind.and_then(|i| variants::of_class(class).nth(*i));
        chosen
            .map(|v| v.size_m)
            .or(class.typical_size_m())
            .map(DVec3::from_array)
    }
}

impl UiState {
    /// The chosen boxes, the one chosen last first.
    pub fn chosen(&self) -> Vec<BoxId> {
        let Some(first) = self.selected else {
            return Vec::new();
        };
        let others = self.selection.iter().copied().filter(|id| *id != first);
        // Who sets `selected` alone means that box alone.
        match self.selection.contains(&first) {
            true => std::iter::once(first).chain(others).collect(),
            false => vec![first],
        }
    }

    /// True if that box is one of the chosen.
    pub fn is_chosen(&self, id: BoxId) -> bool {
        match self.selected {
            Some(first) if first == id => true,
            Some(first) => self.selection.contains(&first) && self.selection.contains(&id),
            None => false,
        }
    }

    /// Chooses boxes; the last of them becomes the first of the selection. Alone they are without things, too.
    pub fn choose(&mut self, ids: &[BoxId], how: Choose) {
        let mut now: BTreeSet<BoxId> = match how {
            Choose::Only => {
                self.tools.things.chosen.clear();
                BTreeSet::new()
            }
            Choose::Add | Choose::Toggle => self.chosen().into_iter().collect(),
        };
        for id in ids {
            if how == Choose::Toggle && now.contains(id) {
                now.remove(id);
            } else {
                now.insert(*id);
            }
        }
        let newest = ids
            .iter()
            .rev()
            .chain(self.selected.iter())
            .find(|id| now.contains(*id));
        self.selected = newest.or(now.last()).copied();
        self.selection = now;
    }

    /// Drops boxes and things that are not there any more from the selection.
    pub fn tidy_selection(&mut self, scene: &Scene) {
        let boxes = &scene.frame().boxes;
        let things = &mut self.tools.things.chosen;
        things.retain(|id| scene.background.get(*id).is_some());
        let mut left = self.chosen();
        left.retain(|id| boxes.contains_key(id));
        self.selected = self
            .selected
            .filter(|id| left.contains(id))
            .or(left.first().copied());
        self.selection = left.into_iter().collect();
    }

    /// Keeps what is chosen in a state of the scene, for when an undo comes back to it.
    pub fn remember_selection(&mut self, rev: SceneRev) {
        let kept = &mut self.tools.selections;
        kept.insert(rev, Default::default());
        if kept.len() > REMEMBERED_SELECTIONS {
            kept.pop_first();
        }
        let things = self.tools.things.chosen.iter().copied().collect();
        let chosen = (self.chosen(), things);
        self.tools.selections.insert(rev, chosen);
    }

    /// Chooses what was chosen last in a state of the scene; all stays if that was nothing.
    pub fn recall_selection(&mut self, rev: SceneRev, scene: &Scene) {
        let (mut ids, mut things) = self.tools.selections.get(&rev).cloned().unwrap_or_default();
        ids.retain(|id| scene.frame().boxes.contains_key(id));
        things.retain(|id| scene.background.get(*id).is_some());
        if !ids.is_empty() || !things.is_empty() {
            self.choose(&ids, Choose::Only);
            self.selected = ids.first().copied();
            self.choose_things(&things, Choose::Add);
        }
    }

    /// A box of the size chosen for the next one, on the ground; `None` for a class that is no object.
    pub fn new_box(&self, frame: &Frame, class: Class, at_m: DVec2, yaw_rad: f64) -> Option<SceneBox> {
        let b = canvas_tools::new_box(frame, class, at_m, yaw_rad)?;
        let size_m = self.tools.size_of(class)?;
        Some(SceneBox {
            size_m,
            center_m: at_m.extend(frame.layout.relief.height_m(at_m) + size_m.z / 2.0),
            ..b
        })
    }

    /// The first layer that edits would paint although it is locked.
    pub fn locked_layer(&self, edits: &[Edit]) -> Option<BevLayer> {
        edits.iter().find_map(|edit| match edit {
            Edit::PaintBev { layer, .. } if self.tools.is_locked(*layer) => Some(*layer),
            Edit::Correct { edit } => self.locked_layer(std::slice::from_ref(edit)),
            _ => None,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn boxes_join_and_leave_the_selection() {
        let [a, b, c] = [BoxId(1), BoxId(2), BoxId(3)];
        let mut ui = UiState::default();
        ui.choose(&[a, b], Choose::Only);
        assert_eq!((ui.selected, ui.chosen()), (Some(b), vec![b, a]));
        ui.choose(&[b], Choose::Toggle);
        assert_eq!(ui.chosen(), [a]);
        ui.choose(&[c], Choose::Add);
        assert_eq!(ui.chosen(), [c, a]);
        assert!(ui.is_chosen(a) && !ui.is_chosen(b));
        // Setting the one alone means it alone.
        ui.selected = Some(b);
        assert_eq!(ui.chosen(), [b]);
        assert!(!ui.is_chosen(a));
        ui.choose(&[], Choose::Only);
        assert_eq!((ui.selected, ui.chosen()), (None, vec![]));
    }

    #[test]
    fn locked_layers_and_kinds() {
        let mut ui = UiState::default();
        ui.tools.layers_locked = BevLayer::Walkway.bit();
        let paint = |layer| Edit::PaintBev {
            layer,
            shape: editor::Shape::Cells(vec![[1, 1]]),
            value: true,
        };
        assert_eq!(ui.locked_layer(&[paint(BevLayer::StopLine)]), None);
        let correct = Edit::Correct {
            edit: Box::new(paint(BevLayer::Walkway)),
        };
        assert_eq!(ui.locked_layer(&[correct]), Some(BevLayer::Walkway));
        assert_eq!(ui.tools.size_of(Class::Bus), Some(DVec3::new(11.0, 2.95, 3.5)));
        ui.tools.variants.insert(Class::Bus, 2);
        assert_eq!(ui.tools.size_of(Class::Bus), Some(DVec3::new(18.0, 2.55, 3.1)));
        assert_eq!(ui.tools.size_of(Class::Terrain), None);
    }
}
