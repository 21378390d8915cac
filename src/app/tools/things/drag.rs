//! Chosen things dragged on either view: moved together with the chosen boxes, a corner pulled, raised. Each move of the
//! pointer starts over from what was there when the button went down.

use glam::DVec2;

use crate::state::UiState;
use editor::arrange::boxes_of;
use editor::pick_things::{self, way_in_world};
use editor::{Edit, kerb};
use scene::{Form, Frame, Scene, SceneBox, ThingId};

use super::draft::KERB_M;
use super::{carry, words};

/// What was taken hold of.
#[derive(Clone, Debug, PartialEq)]
pub struct ThingDrag {
    /// The chosen things, world frame.
    start: Vec<(ThingId, Form)>,
    boxes: Vec<SceneBox>,
    /// What the pointer changes of them.
    pull: Pull,
}

/// What a drag changes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Pull {
    /// The place of all of them.
    Place,
    /// One corner of the first.
    Corner(usize),
    /// The height of all of them.
    Height,
}

/// Keys that are held while something is dragged.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Held {
    /// Alt: snaps to no kerb.
    pub free: bool,
    /// Ctrl: snaps to the grid.
    pub grid: bool,
}

impl From<egui::Modifiers> for Held {
    fn from(m: egui::Modifiers) -> Self {
        Self {
            free: m.alt,
            grid: m.ctrl || m.command,
        }
    }
}

impl ThingDrag {
    /// Takes hold of what is chosen; `None` without a thing.
    pub fn new(scene: &Scene, state: &UiState, pull: Pull) -> Option<Self> {
        let things = state.tools.things.chosen_in(&scene.background);
        let start: Vec<_> = things.map(|t| (t.id, t.form.clone())).collect();
        (!start.is_empty()).then(|| Self {
            start,
            boxes: boxes_of(scene.frame(), &state.chosen()),
            pull,
        })
    }

    /// What is pulled.
    pub fn pull(&self) -> Pull {
        self.pull
    }

    /// Edits for a way on the ground of the ego frame, m, and a way up, m.
    pub fn edits(&self, frame: &Frame, state: &UiState, way_m: DVec2, up_m: f64, held: Held) -> Vec<Edit> {
        let ids = || self.start.iter().map(|(id, _)| *id).collect();
        match self.pull {
            Pull::Place => {
                let way_m = self.snapped(frame, state, way_m, held);
                let mut edits: Vec<Edit> = self.boxes.iter().map(|b| moved_box(b, way_m)).collect();
                edits.push(Edit::MoveThings {
                    ids: ids(),
                    by_m: way_in_world(&frame.world_from_ego, way_m),
                    turn_deg: 0.0,
                });
                edits
            }
            Pull::Corner(index) => {
                let (id, form) = &self.start[0];
                let Some(&corner_m) = form.points_m().get(index) else {
                    return Vec::new();
                };
                let at_m = corner_m + way_in_world(&frame.world_from_ego, way_m);
                let form = pick_things::with_corner(form, index, at_m);
                // An outline that crosses itself is not shown: the one before stays.
                let sound = form.problem().is_none();
                sound
                    .then_some(Edit::ChangeThing { id: *id, form })
                    .into_iter()
                    .collect()
            }
            Pull::Height => {
                let lowest = self
                    .start
                    .iter()
                    .map(|(_, f)| f.height_m())
                    .fold(f64::MAX, f64::min);
                let step_m = 0.1;
                let by_m = (up_m / step_m).round() * step_m;
                vec![Edit::RaiseThings {
                    ids: ids(),
                    by_m: by_m.max(LEAST_M - lowest),
                }]
            }
        }
    }

    fn snapped(&self, frame: &Frame, state: &UiState, way_m: DVec2, held: Held) -> DVec2 {
        if state.tools.things.snap_kerb && !held.free {
            let forms: Vec<Form> = self.start.iter().map(|(_, f)| f.clone()).collect();
            let here = carry::in_ego(&forms, frame);
            if let Some(rest_m) = kerb::way_to_kerb(&frame.layout, &here, way_m, KERB_M) {
                return way_m + rest_m;
            }
        }
        match state.tools.snap(held.grid).grid_m {
            Some(grid_m) => (way_m / grid_m).round() * grid_m,
            None => way_m,
        }
    }

    /// The name of the undo step that it makes.
    pub fn label(&self) -> String {
        let forms: Vec<&Form> = self.start.iter().map(|(_, f)| f).collect();
        let what = words::count(&forms);
        match self.pull {
            Pull::Place if self.boxes.is_empty() => format!("Move {what}"),
            Pull::Place => format!("Move {} boxes and things", self.boxes.len() + forms.len()),
            Pull::Corner(_) => format!("Reshape {what}"),
            Pull::Height => format!("Raise {what}"),
        }
    }
}

/// Things are not dragged lower than this, m.
const LEAST_M: f64 = 0.5;

fn moved_box(b: &SceneBox, way_m: DVec2) -> Edit {
    Edit::MoveBox {
        id: b.id,
        center_m: Some(b.center_m + way_m.extend(0.0)),
        yaw_deg: None,
        size_m: None,
    }
}

/// Edits that let the chosen things go where the edits of a drag of boxes take the first of these.
pub(crate) fn along_with(
    mut edits: Vec<Edit>,
    boxes: &[SceneBox],
    frame: &Frame,
    state: &UiState,
) -> Vec<Edit> {
    let ids: Vec<ThingId> = state.tools.things.chosen.iter().copied().collect();
    let first = edits.iter().find_map(|edit| match edit {
        Edit::MoveBox {
            id,
            center_m: Some(center_m),
            yaw_deg: None,
            size_m: None,
        } => boxes.iter().find(|b| b.id == *id).map(|b| *center_m - b.center_m),
        _ => None,
    });
    if let (Some(way_m), false) = (first, ids.is_empty()) {
        edits.push(Edit::MoveThings {
            ids,
            by_m: way_in_world(&frame.world_from_ego, way_m.truncate()),
            turn_deg: 0.0,
        });
    }
    edits
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::tools::Choose;
    use scene::background::Building;
    use scene::{Background, BevLayout, Pose, VoxelGrid};

    #[test]
    fn drags_start_over_and_keep_outlines_sound() {
        let mut frame = Frame::new(BevLayout::default(), Default::default(), VoxelGrid::new());
        frame.world_from_ego = Pose::planar(100.0, 0.0, std::f64::consts::FRAC_PI_2);
        let mut scene = Scene::single("test", frame, Arc::default(), 0);
        let mut background = Background::default();
        let house = Building::rectangle(DVec2::new(100.0, 10.0), DVec2::new(4.0, 3.0), DVec2::X, 6.0);
        let id = background.add(Form::Building(house));
        scene.background = Arc::new(background);
        let mut state = UiState::default();
        assert_eq!(ThingDrag::new(&scene, &state, Pull::Place), None);
        state.choose_things(&[id], Choose::Only);
        let drag = |pull| ThingDrag::new(&scene, &state, pull).expect("a house is chosen");
        let frame = scene.frame();
        // Ahead of the ego vehicle is y of the world.
        let moved = drag(Pull::Place).edits(frame, &state, DVec2::X * 2.0, 0.0, Held::default());
        let [Edit::MoveThings { by_m, .. }] = &moved[..] else {
            panic!("{moved:?}");
        };
        assert!(by_m.distance(DVec2::Y * 2.0) < 1e-9, "{by_m}");
        let lowered = drag(Pull::Height).edits(frame, &state, DVec2::ZERO, -50.0, Held::default());
        assert!(matches!(&lowered[..], [Edit::RaiseThings { by_m, .. }] if *by_m == -5.5));
        let corner = drag(Pull::Corner(2));
        let pulled = corner.edits(frame, &state, DVec2::X, 0.0, Held::default());
        let [Edit::ChangeThing { form, .. }] = &pulled[..] else {
            panic!("{pulled:?}");
        };
        assert!(form.points_m()[2].distance(DVec2::new(104.0, 14.0)) < 1e-9);
        // Over the opposite wall it would cross.
        assert!(
            corner
                .edits(frame, &state, DVec2::new(-9.0, 2.0), 0.0, Held::default())
                .is_empty()
        );
        assert_eq!(corner.label(), "Reshape building");
    }
}
