//! Guards: corrections of what the networks made, so that a result does what the user asked for and nothing else. Each is a
//! function and a row of [`GUARDS`], which run in this order.

pub mod clear;
pub mod grounded;
pub mod holes;
pub mod objects;
pub mod unchanged;

use crate::contract::GenReport;
use crate::inpaint::InpaintMask;
use crate::pipeline::standing;
use crate::region::Region;
use crate::request::VoxelRequest;
use scene::{Frame, Scene, VoxelGrid};

/// Content of a window that guards compare a generated result with.
pub struct GuardInput<'a> {
    /// The scene, its map being the networks' window.
    pub scene: &'a Scene,
    /// Columns that were generated.
    pub region: &'a Region,
    /// Cells in which new content is wanted.
    pub inpainted: &'a InpaintMask,
    /// Voxels and columns that the user asks for.
    pub request: &'a VoxelRequest<'a>,
    /// The source, decoded by the same decoder; `None` if the whole scene was generated.
    pub source: Option<&'a VoxelGrid>,
    /// The ground should have no holes.
    pub complete: bool,
}

impl GuardInput<'_> {
    fn frame(&self) -> &Frame {
        self.scene.frame()
    }

    fn is_whole(&self) -> bool {
        self.source.is_none()
    }
}

/// Results that a guard is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Task {
    Edits,
    All,
}

/// A correction of generated voxels.
pub struct Guard {
    /// Its name.
    pub name: &'static str,
    task: Task,
    /// Runs also if the job does not ask for its objects to be kept (`GenParams::keep_objects`).
    always: bool,
    /// Corrects the voxels and notes in the report how many.
    run: fn(&GuardInput<'_>, &mut VoxelGrid, &mut GenReport),
}

/// All guards, in the order in which they run.
pub const GUARDS: [Guard; 8] = [
    Guard {
        name: "unchanged",
        task: Task::Edits,
        always: true,
        run: |on, generated, report| {
            let Some(source) = on.source else { return };
            let (frame, region) = (on.frame(), on.region);
            report.unchanged_kept =
                unchanged::keep_unchanged(frame, region, on.inpainted, on.request, source, generated);
        },
    },
    Guard {
        name: "objects",
        task: Task::All,
        always: false,
        run: |on, generated, report| {
            report.objects_kept = objects::keep_objects(on.frame(), on.region, on.is_whole(), generated);
        },
    },
    Guard {
        name: "ground",
        task: Task::Edits,
        always: false,
        run: |on, generated, report| {
            report.ground_kept = objects::keep_ground(on.frame(), on.region, generated);
        },
    },
    Guard {
        name: "unobserved",
        task: Task::Edits,
        always: false,
        run: |on, generated, report| {
            report.unobserved_kept =
                clear::keep_unobserved(on.frame(), on.region, on.inpainted, on.request, generated);
        },
    },
    Guard {
        name: "invented",
        task: Task::Edits,
        always: false,
        run: |on, generated, report| {
            report.invented_cleared =
                clear::keep_clear(on.frame(), on.region, on.inpainted, on.request, generated);
        },
    },
    Guard {
        name: "holes",
        task: Task::All,
        always: false,
        run: |on, generated, report| {
            let (layout, before) = (&on.frame().layout, &on.frame().source.occupancy);
            report.close(match (on.is_whole(), on.complete) {
                (true, true) => holes::close_holes(layout, generated),
                (true, false) => Vec::new(),
                (false, complete) => {
                    holes::close_holes_of_edit(layout, before, (on.region, complete), generated)
                }
            });
        },
    },
    Guard {
        name: "grounded",
        task: Task::All,
        always: false,
        run: |on, generated, report| {
            let all = on.is_whole();
            report.grounded(grounded::keep_grounded(
                on.frame(),
                on.region,
                all,
                on.request,
                generated,
            ));
        },
    },
    Guard {
        name: "loose things",
        task: Task::All,
        always: true,
        run: |on, generated, _| standing::keep_loose_things(on.scene, on.region, generated),
    },
];

/// Runs the guards over generated voxels. `keep` is false for a job that takes what the networks made.
pub fn run(on: &GuardInput<'_>, keep: bool, generated: &mut VoxelGrid, report: &mut GenReport) {
    let of_task = |guard: &&Guard| guard.task == Task::All || !on.is_whole();
    let wanted = GUARDS.iter().filter(of_task).filter(|guard| guard.always || keep);
    for guard in wanted {
        (guard.run)(on, generated, report);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use scene::draft::ground_class;
    use scene::{BevLayer, BevLayout, Class, SensorRig, VoxelGrid};
    use std::sync::Arc;

    /// A road whose networks left nothing: a whole scene that should be complete gets its ground, an edit keeps what it
    /// had, and a job that takes what the networks made gets neither.
    #[test]
    fn guards_run_for_their_task_and_only_if_wanted() {
        let mut layout = BevLayout::default();
        (90..110).for_each(|x| layout.set(BevLayer::DrivableArea, x, 100, true));
        let frame = Frame::new(layout, Default::default(), VoxelGrid::new());
        let scene = Scene::single("road", frame, Arc::new(SensorRig::default()), 1);
        let (region, inpainted) = (Region::full(), InpaintMask::default());
        let request = VoxelRequest::from_frame(scene.frame());
        let decoded = VoxelGrid::new();
        let made = |source, complete, keep| {
            let on = GuardInput {
                scene: &scene,
                region: &region,
                inpainted: &inpainted,
                request: &request,
                source,
                complete,
            };
            let (mut generated, mut report) = (VoxelGrid::new(), GenReport::default());
            run(&on, keep, &mut generated, &mut report);
            (generated.count_set(), report.holes_closed)
        };
        assert_eq!(
            ground_class(scene.frame().layout.cell(100, 100)),
            Class::DriveableSurface
        );
        let (voxels, holes) = made(None, true, true);
        assert!(holes >= 20 && voxels == holes, "{voxels} voxels, {holes} holes");
        assert_eq!(made(None, false, true), (0, 0));
        assert_eq!(made(None, true, false), (0, 0));
        assert_eq!(
            made(Some(&decoded), false, true),
            (0, 0),
            "it had no ground before"
        );
        assert!(made(Some(&decoded), true, true).1 >= 20);
    }

    #[test]
    fn every_guard_has_a_name_of_its_own() {
        let names: std::collections::BTreeSet<&str> = GUARDS.iter().map(|g| g.name).collect();
        assert_eq!(names.len(), GUARDS.len());
    }
}
