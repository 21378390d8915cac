//! State of the user's hand: the current tool, the selection, and the options that tools share. Nothing here is saved.

use std::collections::{BTreeMap, BTreeSet};

use glam::{DVec2, DVec3};

use crate::Edit;
use crate::arrange::{Clipboard, LANE_REACH_M, Pivot};
use crate::flood::FillBounds;
use crate::lanes::nearest_lane;
use crate::roads::Street;
use crate::rows::CopyRows;
use crate::transform::{Orientation, Snap, TransformKind};
use crate::voxel_ops::{self, VoxelIndex};
use scene::{
    BevLayer, BevLayout, BoxId, BoxLabel, Class, Extent, Frame, Lattice, Scene, SceneBox, SceneRev, ThingId,
    variants,
};

use super::ToolId;
use super::beside::ThingState;
use super::modes::{ChooseBy, PaintShape, RegionShape, VoxelMode, VoxelTip, VoxelVerb};
use super::paints::PaintsBefore;
use super::road::RoadHand;
use super::saved::Stamp;

/// States of the scene whose selection is kept.
const REMEMBERED_SELECTIONS: usize = 512;

/// Map layers from the lowest to the uppermost, as the papers draw them; boxes come after.
pub const DRAW_ORDER: [BevLayer; 8] = [
    BevLayer::DrivableArea,
    BevLayer::RoadBlock,
    BevLayer::Walkway,
    BevLayer::StopLine,
    BevLayer::CarparkArea,
    BevLayer::PedCrossing,
    BevLayer::RoadDivider,
    BevLayer::LaneDivider,
];

/// How boxes join the selection.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Choose {
    /// Replaces the selection by them.
    Only,
    /// Adds them to the selection.
    Add,
    /// Each changes sides.
    Toggle,
    /// Takes them out of the selection.
    Remove,
}

/// The current tool, the selection, and the options that tools share.
#[derive(Clone, Debug)]
pub struct Hand {
    /// Tool in hand.
    pub tool: ToolId,
    /// The box chosen last.
    pub selected: Option<BoxId>,
    /// All chosen boxes; see [`Hand::chosen`].
    pub selection: BTreeSet<BoxId>,
    /// Layer that the brush paints.
    pub layer: BevLayer,
    /// Diameter of the brush, m.
    pub brush_m: f64,
    /// True: the brush clears instead of setting.
    pub erase: bool,
    /// Class of the next box.
    pub box_class: Class,
    /// Verb of the voxel brush.
    pub verb: VoxelVerb,
    /// Class that the voxel brush paints.
    pub voxel_class: Class,
    /// Edge of the voxel brush, voxels, 1 to 5.
    pub voxel_size: usize,
    /// Bit per map layer that is drawn.
    pub layers_shown: u32,
    /// Copied boxes.
    pub clipboard: Clipboard,
    /// How several things are chosen at once.
    pub choose_by: ChooseBy,
    /// Transform that dragging a chosen box makes.
    pub gizmo: TransformKind,
    /// Axes that gizmo and number fields use.
    pub orientation: Orientation,
    /// Point about which several boxes turn.
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
    /// Shape that the brush draws.
    pub shape: PaintShape,
    /// Lanes and widths of the next street.
    pub street: Street,
    /// Selection of the road tool.
    pub road: RoadHand,
    /// Border of a fill.
    pub fill: FillBounds,
    /// Mode of the voxel tool.
    pub voxel_mode: VoxelMode,
    /// Shape of the voxel brush.
    pub voxel_tip: VoxelTip,
    /// Height of the voxel brush and of a new block, voxels.
    pub voxel_height: usize,
    /// How far the wheel was turned toward the next size of the voxel brush; see [`Hand::scale_brush`].
    pub wheel_turned: f64,
    /// Voxels are painted on both sides of the ego x axis.
    pub symmetry: bool,
    /// Chosen voxels.
    pub voxels: Vec<VoxelIndex>,
    /// Voxels that the stamp sets down.
    pub stamp: Stamp,
    /// An outline chooses voxels behind others, too.
    pub voxels_through: bool,
    /// How a region is marked.
    pub region_shape: RegionShape,
    /// How strongly inpainting replaces the old content, 0 to 1.
    pub region_strength: f64,
    /// Area marked for inpainting, m²; the window counts it.
    pub region_m2: f64,
    /// Kind of the next box of each class, by index among its kinds; none means the typical size.
    pub variants: BTreeMap<Class, usize>,
    /// Bit per map layer that is not painted.
    pub layers_locked: u32,
    /// Selections by the revision of the scene, so that undo restores them.
    pub selections: BTreeMap<SceneRev, (Vec<BoxId>, Vec<ThingId>)>,
    /// The dialog of rows, if it is open.
    pub row_open: bool,
    /// Numbers of that dialog.
    pub row: CopyRows,
    /// Options, selection and clipboard of the scenery tools.
    pub things: ThingState,
    /// Layer and class that were painted with before.
    pub painted_before: PaintsBefore,
}

impl Default for Hand {
    fn default() -> Self {
        Self {
            tool: ToolId::SELECT,
            selected: None,
            selection: BTreeSet::new(),
            layer: BevLayer::DrivableArea,
            brush_m: 3.2,
            erase: false,
            box_class: Class::Car,
            verb: VoxelVerb::Attach,
            voxel_class: Class::Manmade,
            voxel_size: 1,
            layers_shown: 0xff,
            clipboard: Clipboard::default(),
            choose_by: ChooseBy::default(),
            gizmo: TransformKind::default(),
            orientation: Orientation::default(),
            pivot: Pivot::default(),
            snap_grid: false,
            grid_m: Lattice::OCC3D.voxel_m(),
            snap_lane: false,
            snap_ground: false,
            mirror_keeps_direction: true,
            shape: PaintShape::default(),
            street: Street::default(),
            road: RoadHand::default(),
            fill: FillBounds::default(),
            voxel_mode: VoxelMode::default(),
            voxel_tip: VoxelTip::default(),
            voxel_height: 1,
            wheel_turned: 0.0,
            symmetry: false,
            voxels: Vec::new(),
            voxels_through: false,
            stamp: Stamp::default(),
            region_shape: RegionShape::default(),
            region_strength: 1.0,
            region_m2: 0.0,
            variants: BTreeMap::new(),
            layers_locked: 0,
            selections: BTreeMap::new(),
            row_open: false,
            row: CopyRows::default(),
            things: ThingState::default(),
            painted_before: PaintsBefore::default(),
        }
    }
}

impl Hand {
    /// Limits of the brush's diameter, m.
    pub const BRUSH_M: std::ops::RangeInclusive<f64> = 0.4..=12.0;
    /// Largest edge of the voxel brush.
    pub const MAX_VOXEL_SIZE: usize = 5;
    /// Diameters that the keys step through, m.
    const BRUSH_STEPS_M: [f64; 11] = [0.4, 0.8, 1.2, 1.6, 2.4, 3.2, 4.0, 5.6, 7.2, 9.6, 12.0];

    /// True if a map layer is drawn.
    pub fn shows(&self, layer: BevLayer) -> bool {
        self.layers_shown & layer.bit() != 0
    }

    /// The brush in hand one step larger or smaller.
    pub fn step_brush(&mut self, step: i32) {
        if self.tool == ToolId::VOXEL {
            let size = self.voxel_size as i32 + step;
            self.voxel_size = size.clamp(1, Self::MAX_VOXEL_SIZE as i32) as usize;
            return;
        }
        let sizes = Self::BRUSH_STEPS_M;
        self.brush_m = if step > 0 {
            let larger = sizes.into_iter().find(|s| *s > self.brush_m + 1e-6);
            larger.unwrap_or(*Self::BRUSH_M.end())
        } else {
            let smaller = sizes.into_iter().rev().find(|s| *s < self.brush_m - 1e-6);
            smaller.unwrap_or(*Self::BRUSH_M.start())
        };
    }

    /// Scales the brush in hand by a factor. The voxel brush has few sizes: each takes about a notch of the wheel.
    pub fn scale_brush(&mut self, factor: f64) {
        const NOTCH: f64 = 0.18;
        // Written so that NaN fails too.
        if !(factor.is_finite() && factor > 0.0) {
            return;
        }
        if self.tool != ToolId::VOXEL {
            self.brush_m = (self.brush_m * factor).clamp(*Self::BRUSH_M.start(), *Self::BRUSH_M.end());
            return;
        }
        self.wheel_turned = (self.wheel_turned + factor.ln()).clamp(-1.0, 1.0);
        while self.wheel_turned.abs() >= NOTCH {
            let step = self.wheel_turned.signum();
            self.wheel_turned -= step * NOTCH;
            self.step_brush(step as i32);
        }
    }

    /// The voxel brush one voxel higher or lower.
    pub fn step_height(&mut self, step: i32) {
        let height = self.voxel_height as i32 + step;
        self.voxel_height = height.clamp(1, scene::Lattice::OCC3D.bins() as i32) as usize;
    }

    /// True if the layer must not be painted.
    pub fn is_locked(&self, layer: BevLayer) -> bool {
        self.layers_locked & layer.bit() != 0
    }

    /// The snaps of a move now; `ctrl` held means the grid.
    pub fn snap(&self, ctrl: bool) -> Snap {
        Snap {
            grid_m: (self.snap_grid || ctrl).then_some(self.grid_m),
            lane: self.snap_lane && !ctrl,
            ground: self.snap_ground,
        }
    }

    /// Voxels of a map with their mirror images, if symmetry is on.
    pub fn both_sides(&self, extent: Extent, cells: Vec<VoxelIndex>) -> Vec<VoxelIndex> {
        match self.symmetry {
            true => voxel_ops::mirrored(extent, &cells),
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

impl Hand {
    /// The chosen boxes, the one chosen last first.
    pub fn chosen(&self) -> Vec<BoxId> {
        let Some(first) = self.selected else {
            return Vec::new();
        };
        let others = self.selection.iter().copied().filter(|id| *id != first);
        // A caller that sets `selected` alone means that box alone.
        match self.selection.contains(&first) {
            true => std::iter::once(first).chain(others).collect(),
            false => vec![first],
        }
    }

    /// True if an outline chooses: a press that begins one drags nothing.
    pub fn outlines(&self) -> bool {
        self.choose_by != ChooseBy::Rectangle
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
                self.things.chosen.clear();
                BTreeSet::new()
            }
            Choose::Add | Choose::Toggle | Choose::Remove => self.chosen().into_iter().collect(),
        };
        for id in ids {
            if how == Choose::Remove || how == Choose::Toggle && now.contains(id) {
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
        let things = &mut self.things.chosen;
        things.retain(|id| scene.background.get(*id).is_some());
        let mut left = self.chosen();
        left.retain(|id| boxes.contains_key(id));
        self.selected = self
            .selected
            .filter(|id| left.contains(id))
            .or(left.first().copied());
        self.selection = left.into_iter().collect();
    }

    /// Keeps the selection of a state of the scene, for an undo that comes back to it.
    pub fn remember_selection(&mut self, rev: SceneRev) {
        let kept = &mut self.selections;
        kept.insert(rev, Default::default());
        if kept.len() > REMEMBERED_SELECTIONS {
            kept.pop_first();
        }
        let things = self.things.chosen.iter().copied().collect();
        let chosen = (self.chosen(), things);
        self.selections.insert(rev, chosen);
    }

    /// Restores the last selection of a state of the scene; without one the present selection stays.
    pub fn recall_selection(&mut self, rev: SceneRev, scene: &Scene) {
        let (mut ids, mut things) = self.selections.get(&rev).cloned().unwrap_or_default();
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
        let b = new_box(frame, class, at_m, yaw_rad)?;
        let size_m = self.size_of(class)?;
        Some(SceneBox {
            size_m,
            center_m: at_m.extend(frame.layout.relief.height_m(at_m) + size_m.z / 2.0),
            ..b
        })
    }

    /// The first layer that edits would change although it is locked: the one they paint, or ground that it would replace.
    pub fn locked_layer(&self, layout: &BevLayout, edits: &[Edit]) -> Option<BevLayer> {
        edits.iter().find_map(|edit| match edit {
            Edit::PaintBev { layer, .. } if self.is_locked(*layer) => Some(*layer),
            Edit::PaintBev {
                layer,
                shape,
                value: true,
            } if !layer.replaces().is_empty() => {
                let mut locked = layer
                    .replaces()
                    .iter()
                    .copied()
                    .filter(|other| self.is_locked(*other))
                    .peekable();
                locked.peek()?;
                let cells = shape.cells(layout.extent()).unwrap_or_default();
                locked.find(|other| cells.iter().any(|[x, y]| layout.has(*other, *x, *y)))
            }
            Edit::ChangeRoads { .. } => scene::roads::LAYERS.into_iter().find(|l| self.is_locked(*l)),
            Edit::Correct { edit } => self.locked_layer(layout, std::slice::from_ref(edit)),
            _ => None,
        })
    }
}

/// Heading of the nearest lane, if one is within reach of a point, rad.
pub fn lane_heading(frame: &Frame, at_m: DVec2) -> Option<f64> {
    nearest_lane(&frame.layout, at_m, LANE_REACH_M).map(|lane| lane.yaw_rad)
}

/// A box of typical size that stands on the ground; `None` for a class that is no object.
fn new_box(frame: &Frame, class: Class, at_m: DVec2, yaw_rad: f64) -> Option<SceneBox> {
    let size_m = DVec3::from_array(class.typical_size_m()?);
    let id = frame
        .boxes
        .keys()
        .next_back()
        .map_or(Some(1), |id| id.0.checked_add(1))?;
    Some(SceneBox {
        id: BoxId(id),
        class,
        center_m: at_m.extend(frame.layout.relief.height_m(at_m) + size_m.z / 2.0),
        size_m,
        yaw_rad,
        velocity_mps: DVec2::ZERO,
        label: BoxLabel::default(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use scene::{BevLayout, Polyline, PolylineKind, VoxelGrid};

    #[test]
    fn new_boxes_follow_the_nearest_lane() {
        let lane = |from: [f64; 2], to: [f64; 2]| Polyline {
            kind: PolylineKind::LaneCenter,
            points_m: vec![from.into(), to.into()],
        };
        let lanes = vec![lane([-30.0, 2.0], [30.0, 2.0]), lane([30.0, -2.0], [-30.0, -2.0])];
        let layout = BevLayout::from_cells(vec![0; 40_000], lanes).expect("the right size");
        let frame = Frame::new(layout, BTreeMap::new(), VoxelGrid::new());
        let yaw = |x, y| lane_heading(&frame, DVec2::new(x, y));
        assert_eq!(yaw(0.0, 1.0), Some(0.0));
        assert!((yaw(0.0, -1.0).expect("near").abs() - std::f64::consts::PI).abs() < 1e-12);
        assert_eq!(yaw(0.0, 9.0), None);
        let car = new_box(&frame, Class::Car, DVec2::new(1.0, 2.0), 0.0).expect("an object");
        assert!((car.center_m.z - car.size_m.z / 2.0).abs() < 1e-12 && car.problem().is_none());
        assert!(new_box(&frame, Class::Terrain, DVec2::ZERO, 0.0).is_none());
    }

    #[test]
    fn the_brush_steps_through_its_sizes_and_stays_in_range() {
        let mut ui = Hand {
            tool: crate::tools::brush::ID,
            ..Hand::default()
        };
        for _ in 0..30 {
            ui.step_brush(1);
        }
        assert_eq!(ui.brush_m, 12.0);
        for _ in 0..30 {
            ui.step_brush(-1);
        }
        assert_eq!(ui.brush_m, 0.4);
        ui.step_brush(1);
        assert_eq!(ui.brush_m, 0.8);
        ui.tool = ToolId::VOXEL;
        for (step, size) in [(-1, 1), (1, 2), (1, 3), (1, 4), (1, 5), (1, 5)] {
            ui.step_brush(step);
            assert_eq!(ui.voxel_size, size);
        }
    }

    #[test]
    fn the_wheel_makes_brushes_larger_and_smaller() {
        let mut ui = Hand {
            tool: crate::tools::brush::ID,
            ..Hand::default()
        };
        ui.scale_brush(2.0);
        assert_eq!(ui.brush_m, 6.4);
        ui.scale_brush(f64::NAN);
        ui.scale_brush(1e9);
        assert_eq!((ui.brush_m, ui.voxel_size), (12.0, 1));
        ui.tool = ToolId::VOXEL;
        // A notch comes in small parts.
        for _ in 0..4 {
            ui.scale_brush(1.05);
        }
        assert_eq!((ui.brush_m, ui.voxel_size), (12.0, 2));
        for _ in 0..8 {
            ui.scale_brush(1.0 / 1.05);
        }
        assert_eq!(ui.voxel_size, 1);
    }

    #[test]
    fn boxes_join_and_leave_the_selection() {
        let [a, b, c] = [BoxId(1), BoxId(2), BoxId(3)];
        let mut ui = Hand::default();
        ui.choose(&[a, b], Choose::Only);
        assert_eq!((ui.selected, ui.chosen()), (Some(b), vec![b, a]));
        ui.choose(&[b], Choose::Toggle);
        assert_eq!(ui.chosen(), [a]);
        ui.choose(&[c], Choose::Add);
        assert_eq!(ui.chosen(), [c, a]);
        assert!(ui.is_chosen(a) && !ui.is_chosen(b));
        ui.choose(&[c, b], Choose::Remove);
        assert_eq!(ui.chosen(), [a]);
        ui.choose(&[a], Choose::Remove);
        assert_eq!((ui.selected, ui.chosen()), (None, vec![]));
        // Setting the one alone means it alone.
        ui.selected = Some(b);
        assert_eq!(ui.chosen(), [b]);
        assert!(!ui.is_chosen(a));
        ui.choose(&[], Choose::Only);
        assert_eq!((ui.selected, ui.chosen()), (None, vec![]));
    }

    #[test]
    fn locked_layers_and_kinds() {
        let mut ui = Hand {
            layers_locked: BevLayer::Walkway.bit(),
            ..Hand::default()
        };
        let paint = |layer| Edit::PaintBev {
            layer,
            shape: crate::Shape::Cells(vec![[1, 1]]),
            value: true,
        };
        let mut layout = BevLayout::default();
        assert_eq!(ui.locked_layer(&layout, &[paint(BevLayer::StopLine)]), None);
        // Ground replaces other ground.
        assert_eq!(ui.locked_layer(&layout, &[paint(BevLayer::DrivableArea)]), None);
        layout.set(BevLayer::Walkway, 1, 1, true);
        let locked = ui.locked_layer(&layout, &[paint(BevLayer::DrivableArea)]);
        assert_eq!(locked, Some(BevLayer::Walkway));
        let correct = Edit::Correct {
            edit: Box::new(paint(BevLayer::Walkway)),
        };
        assert_eq!(ui.locked_layer(&layout, &[correct]), Some(BevLayer::Walkway));
        assert_eq!(ui.size_of(Class::Bus), Some(DVec3::new(11.0, 2.95, 3.5)));
        ui.variants.insert(Class::Bus, 2);
        assert_eq!(ui.size_of(Class::Bus), Some(DVec3::new(18.0, 2.55, 3.1)));
        assert_eq!(ui.size_of(Class::Terrain), None);
    }
}
