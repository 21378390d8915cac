//! What stands beside the road, as a part of the condition.

use std::sync::Arc;

use scene::background::Columns;
use scene::{Background, BevLayout, Class, Extent, Relief, Scene, VoxelGrid, Window};

/// The voxels of a frame's background, kept from one job to the next: most edits leave it alone.
#[derive(Clone)]
pub struct Standing {
    background: Arc<Background>,
    relief: Relief,
    columns: Arc<Columns>,
}

impl Standing {
    /// The background of a scene's frame on the ground of `layout`; reuses `last` if nothing changed. `None` if the scene
    /// has no background, or only one that was guessed from voxels, which lacks much of what is there.
    pub fn of(scene: &Scene, layout: &BevLayout, last: Option<&Self>) -> Option<Self> {
        let frame = scene.frame();
        if scene.background.is_empty() || frame.inferred.background {
            return None;
        }
        let same =
            |last: &&Self| Arc::ptr_eq(&last.background, &scene.background) && last.relief == layout.relief;
        if let Some(last) = last.filter(same) {
            return Some(last.clone());
        }
        let mut columns = Columns::new();
        for thing in scene.background.in_extent(Extent::WINDOW) {
            for (at, labels) in thing.columns(layout) {
                let all = columns.entry(at).or_insert([Class::FREE; Window::NZ]);
                let taken = labels.iter().zip(all).filter(|(label, _)| **label != Class::FREE);
                taken.for_each(|(label, to)| *to = *label);
            }
        }
        Some(Self {
            background: scene.background.clone(),
            relief: layout.relief.clone(),
            columns: Arc::new(columns),
        })
    }

    /// Puts it into a draft wherever no object stands.
    pub fn stand_in(&self, draft: &mut VoxelGrid) {
        for ([x, y], labels) in &*self.columns {
            let column = draft.column_mut(*x, *y);
            for (label, to) in labels
                .iter()
                .zip(column)
                .filter(|(label, _)| **label != Class::FREE)
            {
                if !Class::from_id(*to).is_some_and(Class::is_object) {
                    *to = *label;
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use scene::{Frame, SensorRig, draft};
    use world::World;
    use world::voxelize::{Vertical, complete};

    fn scene(seed: u64) -> Scene {
        let world = World::random(seed);
        let grid = complete(&world, Vertical::Occ3d);
        let frame = Frame::new(world.layout.clone(), world.boxes.clone(), grid);
        let mut scene = Scene::single("world", frame, Arc::new(SensorRig::default()), seed);
        scene.background = Arc::new(world.background.clone());
        scene
    }

    /// What stands in the draft is what the world holds: nearly all of its manmade and vegetation, and nothing else.
    #[test]
    fn a_draft_with_the_background_is_nearly_the_world() {
        for seed in [3, 8] {
            let scene = scene(seed);
            let frame = scene.frame();
            let standing = Standing::of(&scene, &frame.layout, None).expect("a background");
            let bare = draft::draft(&frame.layout, frame.boxes.values());
            let mut full = bare.clone();
            standing.stand_in(&mut full);
            let (mut both, mut either) = (0, 0);
            for (x, y) in (0..Window::COLUMNS).map(|c| (c / Window::NY, c % Window::NY)) {
                for z in 0..Window::NZ {
                    let of = |grid: &VoxelGrid| Class::from_id(grid.get(x, y, z));
                    let stands = |c: Option<Class>| matches!(c, Some(Class::Manmade | Class::Vegetation));
                    let (here, there) = (stands(of(&full)), stands(of(&frame.occupancy)));
                    both += usize::from(here && there);
                    either += usize::from(here || there);
                    if of(&bare).is_some_and(Class::is_object) {
                        assert_eq!(of(&full), of(&bare), "an object gives way");
                    }
                }
            }
            assert!(either > 2000 && both * 100 > either * 90, "{both} of {either}");
        }
    }

    #[test]
    fn what_is_not_known_is_not_given() {
        let mut scene = scene(5);
        let layout = scene.frame().layout.clone();
        let first = Standing::of(&scene, &layout, None).expect("a background");
        let again = Standing::of(&scene, &layout, Some(&first)).expect("a background");
        assert!(
            Arc::ptr_eq(&first.columns, &again.columns),
            "kept from job to job"
        );
        let mut guessed = scene.clone();
        guessed.change_canvas(|f| f.inferred.background = true);
        assert!(Standing::of(&guessed, &layout, Some(&first)).is_none());
        let mut fewer = (*scene.background).clone();
        let id = fewer.iter().next().expect("a thing").id;
        fewer.remove(id);
        scene.background = Arc::new(fewer);
        let other = Standing::of(&scene, &layout, Some(&first)).expect("a background");
        assert_ne!(first.columns, other.columns);
        scene.background = Arc::default();
        assert!(Standing::of(&scene, &layout, None).is_none());
    }
}
