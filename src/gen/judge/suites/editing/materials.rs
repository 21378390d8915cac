//! Materials that edits are tried on: complete worlds, simulated labels of the same worlds, frames of a data set.

use std::path::PathBuf;
use std::sync::Arc;

use authoring::open;
use calibration::held_out::{TEST_SEED, scene};
use dataset::world_of;
use scene::{Frame, Scene, SensorRig, Unobserved};
use world::voxelize::{Drive, Vertical, labelled};

/// Scenes of one kind.
pub enum TrialScenes {
    /// Held-out worlds with all their voxels; holds their number.
    Complete(usize),
    /// Held-out worlds as a simulated labelling drive sees them, with the worlds' own layout and boxes; holds their
    /// number.
    Labels(usize),
    /// Frames from files; layout and boxes are inferred.
    Files(Vec<PathBuf>),
}

impl TrialScenes {
    /// Name in reports.
    pub fn name(&self) -> &'static str {
        match self {
            TrialScenes::Complete(_) => "complete",
            TrialScenes::Labels(_) => "labels",
            TrialScenes::Files(_) => "frames",
        }
    }

    /// Number of scenes.
    pub fn count(&self) -> usize {
        match self {
            TrialScenes::Complete(n) | TrialScenes::Labels(n) => *n,
            TrialScenes::Files(files) => files.len(),
        }
    }

    /// Scene `index`. Errors name the file that cannot be read.
    pub fn scene(&self, index: usize) -> anyhow::Result<Scene> {
        Ok(match self {
            TrialScenes::Complete(_) => scene(index as u64),
            TrialScenes::Labels(_) => labelled_scene(index as u64),
            TrialScenes::Files(files) => open::labels(&files[index])?,
        })
    }
}

/// Labels of held-out world `index` as a scene, with the places that the labelling drive did not observe.
fn labelled_scene(index: u64) -> Scene {
    let (world, seed) = world_of(TEST_SEED, index, |_| None);
    let rig = SensorRig::default();
    let seen = labelled(&world, &rig, &Drive::default(), Vertical::Occ3d, seed);
    let mut frame = Frame::new(world.layout.clone(), world.boxes.clone(), seen.grid);
    frame.inferred.unobserved = Unobserved::from_observed(&seen.by_lidar);
    Scene::single("held out labels", frame, Arc::new(rig), seed)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn labels_are_of_the_same_world_and_say_what_they_miss() {
        let whole = TrialScenes::Complete(1).scene(0).expect("a world");
        let seen = TrialScenes::Labels(1).scene(0).expect("a world");
        let (whole, seen) = (whole.frame(), seen.frame());
        assert_eq!((&whole.boxes, &whole.layout), (&seen.boxes, &seen.layout));
        assert!(seen.occupancy.count_set() < whole.occupancy.count_set());
        let unobserved = seen.inferred.unobserved.as_ref().expect("a mask");
        assert!(
            (0.3..0.98).contains(&unobserved.total()),
            "{}",
            unobserved.total()
        );
        let missing = TrialScenes::Files(vec![PathBuf::from("/nowhere/labels.npz")]);
        assert!(missing.scene(0).is_err() && missing.count() == 1);
    }
}
