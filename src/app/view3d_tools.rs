//! What the pointer does in the 3D view: boxes chosen and moved, layers painted on the ground,
//! voxels attached, removed and recoloured.

use std::collections::BTreeSet;

use egui::{Key, Modifiers, PointerButton, Pos2, Response, Ui};
use glam::DVec2;

use editor::pick::{self, Hit, Ray, VoxelHit};
use editor::{Edit, Shape, voxel_ops};
use scene::raster::disc_cells;
use scene::{BevLayer, Class, Frame, GridSpec};

use super::command::Command;
use super::pointer::{self, Step};
use super::state::{Tool, UiState, VoxelVerb};
use super::tools::things;
use super::tools::view3d::{self as tools, ViewGesture};
use super::view3d::{View3d, View3dInput, point_of};

/// What the pointer is doing.
#[derive(Clone, Debug, Default, PartialEq)]
pub enum Gesture3d {
    /// Nothing.
    #[default]
    None,
    /// Was cancelled, or turns the camera; waits for the button to come up.
    Ignored,
    /// Of the tools in `tools/view3d.rs`.
    Tool(ViewGesture),
    /// Places a box on release, unless the pointer moves.
    Place {
        /// Where the pointer went down.
        pressed: Pos2,
        /// The pointer has left the place where it went down.
        moved: bool,
    },
    /// Paints a map layer.
    Stroke {
        /// Way so far, ego frame, m.
        points_m: Vec<DVec2>,
        /// Layer painted.
        layer: BevLayer,
        /// Width, m.
        width_m: f64,
        /// Clears instead of setting.
        erase: bool,
    },
    /// Paints voxels.
    Voxels {
        /// Indices so far.
        cells: BTreeSet<[usize; 3]>,
        /// Class they get.
        class: Class,
        /// What is done.
        verb: VoxelVerb,
        /// Where the pointer was.
        last: Pos2,
    },
}

/// Points that the pointer may move and still click.
const CLICK_SLACK: f32 = 4.0;
/// Distance between two samples of a quick stroke, points.
const SAMPLE_EVERY: f32 = 3.0;

impl View3d {
    /// Answers the pointer; pushes what should happen.
    pub(super) fn interact(
        &mut self,
        ui: &Ui,
        response: &Response,
        steps: &[Step],
        input: &View3dInput<'_>,
        state: &UiState,
        commands: &mut Vec<Command>,
    ) {
        let (space, ctrl, escape) = ui.input(|i| {
            let escape = i.key_pressed(Key::Escape);
            (i.key_down(Key::Space), i.modifiers.ctrl, escape)
        });
        if escape && self.gesture != Gesture3d::None {
            if self.gesture != Gesture3d::Ignored {
                commands.push(Command::CancelDrag);
            }
            self.gesture = Gesture3d::Ignored;
        }
        let mut held = std::mem::take(&mut self.gesture);
        tools::keys(ui, self, &mut held, input, state, commands);
        self.gesture = held;
        for step in steps {
            match *step {
                Step::Press(PointerButton::Primary, at, modifiers) => {
                    let camera = modifiers.alt || space;
                    if modifiers.alt && state.tool == Tool::Voxel {
                        tools::pick_class(self, input, at, commands);
                    }
                    self.gesture = match camera {
                        true => Gesture3d::Ignored,
                        false => self.begin(input, state, at, modifiers, commands),
                    };
                    self.drag(input, state, at, ctrl, commands);
                }
                Step::Move(at) => self.drag(input, state, at, ctrl, commands),
                Step::Release(PointerButton::Primary, at) if self.gesture != Gesture3d::None => {
                    self.drag(input, state, at, ctrl, commands);
                    let gesture = std::mem::take(&mut self.gesture);
                    self.end(gesture, input, state, at, commands);
                }
                _ => {}
            }
        }
        // After the pointer: the click that ends an outline is one of its points.
        things::press::keys(ui, response, state, commands);
        if response.hovered() && self.gesture == Gesture3d::None {
            let icon = match state.tool {
                Tool::Select => egui::CursorIcon::Default,
                Tool::Measure | Tool::Region => egui::CursorIcon::NotAllowed,
                Tool::Thing(_) if !state.tools.things.is_open() => egui::CursorIcon::NotAllowed,
                _ => egui::CursorIcon::Crosshair,
            };
            ui.ctx().set_cursor_icon(icon);
        }
    }

    fn hit(&self, frame: &Frame, at: Pos2) -> Option<(Hit, Ray)> {
        let ray = self.pointer(at)?.ray;
        Some((pick::pick(frame, &ray)?, ray))
    }

    fn begin(
        &self,
        input: &View3dInput<'_>,
        state: &UiState,
        at: Pos2,
        modifiers: Modifiers,
        commands: &mut Vec<Command>,
    ) -> Gesture3d {
        if let Some(gesture) = tools::begin(self, input, state, at, modifiers, commands) {
            return gesture;
        }
        let shift = modifiers.shift;
        match state.tool {
            Tool::Select | Tool::Measure | Tool::Region | Tool::Thing(_) => Gesture3d::Ignored,
            Tool::AddBox => Gesture3d::Place {
                pressed: at,
                moved: false,
            },
            Tool::Brush if state.tools.is_locked(state.layer) => Gesture3d::Ignored,
            Tool::Brush => Gesture3d::Stroke {
                points_m: Vec::new(),
                layer: state.layer,
                width_m: state.brush_m,
                erase: state.erase || shift,
            },
            Tool::Voxel => {
                let verb = if shift { VoxelVerb::Remove } else { state.verb };
                let class = if verb == VoxelVerb::Remove {
                    Class::Free
                } else {
                    state.voxel_class
                };
                Gesture3d::Voxels {
                    cells: BTreeSet::new(),
                    class,
                    verb,
                    last: at,
                }
            }
        }
    }

    fn drag(
        &mut self,
        input: &View3dInput<'_>,
        state: &UiState,
        at: Pos2,
        ctrl: bool,
        commands: &mut Vec<Command>,
    ) {
        // Taken out so that picking can borrow the view.
        let mut gesture = std::mem::take(&mut self.gesture);
        match &mut gesture {
            Gesture3d::None | Gesture3d::Ignored => {}
            Gesture3d::Tool(held) => tools::drag(held, self, input, state, at, ctrl, commands),
            Gesture3d::Place { pressed, moved } => *moved |= pressed.distance(at) > CLICK_SLACK,
            Gesture3d::Stroke {
                points_m,
                layer,
                width_m,
                erase,
            } => {
                if let Some((hit, ray)) = self.hit(input.settled.frame(), at) {
                    let at_m = point_of(&hit, &ray).truncate();
                    if points_m.last().is_none_or(|last| last.distance(at_m) > 0.1) {
                        points_m.push(at_m);
                        let shape = Shape::Line {
                            points_m: points_m.clone(),
                            width_m: *width_m,
                        };
                        if shape.cells().is_ok() {
                            let edit = Edit::PaintBev {
                                layer: *layer,
                                shape,
                                value: !*erase,
                            };
                            pointer::preview(commands, vec![edit]);
                        }
                    }
                }
            }
            Gesture3d::Voxels {
                cells,
                class,
                verb,
                last,
            } => {
                let before = cells.len();
                let samples = (last.distance(at) / SAMPLE_EVERY).ceil().max(1.0) as usize;
                for i in 1..=samples {
                    let between = last.lerp(at, i as f32 / samples as f32);
                    if let Some(p) = self.pointer(between) {
                        cells.extend(target(input.settled.frame(), *verb, size(state), &p.ray));
                    }
                }
                *last = at;
                if cells.len() > before {
                    let both = state.tools.both_sides(cells.iter().copied().collect());
                    let grid = &input.settled.frame().occupancy;
                    let cells = voxel_ops::only(grid, both, *verb == VoxelVerb::Attach);
                    pointer::preview(commands, vec![Edit::PaintVoxels { cells, class: *class }]);
                }
            }
        }
        self.gesture = gesture;
    }

    fn end(
        &mut self,
        gesture: Gesture3d,
        input: &View3dInput<'_>,
        state: &UiState,
        at: Pos2,
        commands: &mut Vec<Command>,
    ) {
        match gesture {
            Gesture3d::None | Gesture3d::Ignored => {}
            Gesture3d::Tool(held) => tools::end(held, self, input, state, at, commands),
            Gesture3d::Place { moved: true, .. } => {}
            Gesture3d::Place { .. } => {
                if let Some((hit, ray)) = self.hit(input.scene.frame(), at) {
                    let at_m = point_of(&hit, &ray).truncate();
                    let lane = super::canvas_tools::lane_heading(input.scene.frame(), at_m);
                    commands.push(Command::AddBox {
                        class: state.box_class,
                        at_m,
                        yaw_rad: lane.unwrap_or(0.0),
                    });
                }
            }
            Gesture3d::Stroke { erase, .. } => {
                commands.push(Command::Commit(if erase { "Erase layer" } else { "Paint layer" }));
            }
            Gesture3d::Voxels { verb, .. } => commands.push(Command::Commit(match verb {
                VoxelVerb::Attach => "Attach voxels",
                VoxelVerb::Remove => "Remove voxels",
                VoxelVerb::Recolour => "Recolour voxels",
            })),
        }
    }

    /// The voxels that a click would change.
    pub(super) fn voxel_target(
        &self,
        input: &View3dInput<'_>,
        state: &UiState,
        ray: &Ray,
    ) -> Vec<[usize; 3]> {
        target(input.settled.frame(), state.verb, size(state), ray)
    }
}

/// Edge of the brush across the face, and its height along the normal, voxels.
fn size(state: &UiState) -> [usize; 2] {
    [state.voxel_size, state.voxel_size.max(state.tools.voxel_height)]
}

/// Voxels of the first face along the ray that the brush covers: free ones in front of it to attach,
/// others behind it to remove or recolour.
pub(super) fn target(frame: &Frame, verb: VoxelVerb, size: [usize; 2], ray: &Ray) -> Vec<[usize; 3]> {
    let Some(hit) = pick::ray_voxels(ray, &frame.occupancy, |_, _| true) else {
        // On empty ground voxels are attached to the floor of the grid.
        if verb != VoxelVerb::Attach {
            return Vec::new();
        }
        let floor_m = GridSpec::MIN_M[2] + GridSpec::VOXEL_M / 2.0;
        let ground = pick::ray_ground(ray, floor_m).and_then(GridSpec::voxel_at);
        let floor = ground.map(|[x, y, _]| VoxelHit {
            cell: [x, y, 0],
            label: Class::FREE,
            normal: [0, 0, 1],
            distance_m: 0.0,
        });
        return floor.map_or_else(Vec::new, |hit| cube(frame, hit.cell, hit.normal, size, true));
    };
    match verb {
        VoxelVerb::Attach => hit
            .neighbour()
            .map_or_else(Vec::new, |cell| cube(frame, cell, hit.normal, size, true)),
        _ => cube(frame, hit.cell, hit.normal.map(|n| -n), size, false),
    }
}

/// A block of voxels that begins at `cell` and reaches along `direction`, centred across it; only the
/// voxels that are free, or only those that are not.
fn cube(
    frame: &Frame,
    cell: [usize; 3],
    direction: [i32; 3],
    [across, height]: [usize; 2],
    free: bool,
) -> Vec<[usize; 3]> {
    let limit = [GridSpec::NX, GridSpec::NY, GridSpec::NZ];
    let range = |axis: usize| {
        let at = cell[axis] as i64;
        let size = if direction[axis] == 0 { across } else { height } as i64;
        let low = match direction[axis] {
            0 => at - (size - 1) / 2,
            d if d > 0 => at,
            _ => at - size + 1,
        };
        low.max(0)..(low + size).min(limit[axis] as i64)
    };
    let mut cells = Vec::new();
    for x in range(0) {
        for y in range(1) {
            for z in range(2) {
                let [x, y, z] = [x, y, z].map(|v| v as usize);
                if (frame.occupancy.get(x, y, z) == Class::FREE) == free {
                    cells.push([x, y, z]);
                }
            }
        }
    }
    cells
}

/// The highest voxel of each column in a disc: what a brush on the ground would cover.
pub(super) fn tops_in_disc(frame: &Frame, center_m: DVec2, radius_m: f64) -> Vec<[usize; 3]> {
    let mut cells = Vec::new();
    disc_cells(center_m, radius_m, |x, y| {
        let column = frame.occupancy.column(x, y);
        cells.push([x, y, column.iter().rposition(|v| *v != Class::FREE).unwrap_or(0)]);
    });
    cells
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use glam::DVec3;

    use super::*;
    use scene::{BevLayout, VoxelGrid};

    fn frame() -> Frame {
        let mut grid = VoxelGrid::new();
        for x in 90..110 {
            for y in 90..110 {
                grid.set(x, y, 0, Class::Terrain.id());
            }
        }
        grid.set(100, 100, 1, Class::Manmade.id());
        Frame::new(BevLayout::default(), BTreeMap::new(), grid)
    }

    fn down(x: usize, y: usize) -> Ray {
        let p = GridSpec::center(x, y, 15);
        Ray::new(p + DVec3::Z * 5.0, -DVec3::Z).expect("a direction")
    }

    #[test]
    fn attaching_builds_up_and_removing_digs_down() {
        let frame = frame();
        let at = |verb, size, x, y| target(&frame, verb, [size; 2], &down(x, y));
        assert_eq!(at(VoxelVerb::Attach, 1, 100, 100), vec![[100, 100, 2]]);
        assert_eq!(at(VoxelVerb::Remove, 1, 100, 100), vec![[100, 100, 1]]);
        assert_eq!(at(VoxelVerb::Recolour, 1, 95, 95), vec![[95, 95, 0]]);
        // Three cells on a side stand on the face; a voxel that is there already stays.
        assert_eq!(at(VoxelVerb::Attach, 3, 99, 99).len(), 27 - 1);
        assert!(
            at(VoxelVerb::Attach, 3, 99, 99)
                .iter()
                .all(|c| (1..=3).contains(&c[2]))
        );
        // Digging below the floor is not possible.
        assert_eq!(at(VoxelVerb::Remove, 3, 95, 95).len(), 9);
        // Where nothing was seen voxels are put on the floor, and nothing can be removed.
        assert_eq!(at(VoxelVerb::Attach, 1, 10, 10), vec![[10, 10, 0]]);
        assert!(at(VoxelVerb::Remove, 1, 10, 10).is_empty());
    }

    #[test]
    fn faces_from_the_side() {
        let frame = frame();
        let from = GridSpec::center(80, 100, 1);
        let ray = Ray::new(from, DVec3::X).expect("a direction");
        assert_eq!(
            target(&frame, VoxelVerb::Attach, [1, 1], &ray),
            vec![[99, 100, 1]]
        );
        assert_eq!(target(&frame, VoxelVerb::Attach, [1, 3], &ray).len(), 3);
        assert_eq!(target(&frame, VoxelVerb::Remove, [2, 2], &ray).len(), 1);
        // The top of the grid is a limit, not an error.
        let mut tall = frame.clone();
        tall.occupancy.set(50, 50, 15, 1);
        assert!(target(&tall, VoxelVerb::Attach, [1, 1], &down(50, 50)).is_empty());
    }

    #[test]
    fn the_ground_brush_covers_tops() {
        let cells = tops_in_disc(&frame(), GridSpec::center(100, 100, 0).truncate(), 0.6);
        assert!(cells.contains(&[100, 100, 1]) && cells.contains(&[101, 100, 0]));
    }
}
