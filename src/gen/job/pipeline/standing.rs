//! Scenery as a part of the condition.

use std::sync::Arc;

use crate::region::Region;
use scene::background::ColumnLabels;
use scene::{Background, BevLayout, Class, Extent, Relief, Scene, VoxelGrid, Window};

/// Number of things of a scene whose background describes the places beside its roads, so that the networks invent
/// nothing else; `None` if they may invent.
pub fn given(scene: &Scene) -> Option<usize> {
    let says = scene.background.describes_place() && !scene.frame().inferred.background;
    says.then(|| scene.background.len())
}

/// Puts things that the networks were not given, because they do not describe the place (signs, lamps), into the
/// generated region of the window.
pub fn keep_loose_things(scene: &Scene, region: &Region, generated: &mut VoxelGrid) {
    let frame = scene.frame();
    if given(scene).is_some() || frame.inferred.background {
        return;
    }
    for thing in scene.background.in_extent(Extent::WINDOW) {
        let columns = thing.columns(&frame.layout);
        let held = columns
            .iter()
            .filter(|([x, y], _)| region.columns[x * Window::NY + y]);
        for ([x, y], labels) in held {
            stand_in_column(labels, generated.column_mut(*x, *y));
        }
    }
}

/// Puts labels into a column except where an object stands.
fn stand_in_column(labels: &[u8], column: &mut [u8]) {
    let held = labels
        .iter()
        .zip(column)
        .filter(|(label, _)| **label != Class::FREE);
    for (label, to) in held {
        if !Class::from_id(*to).is_some_and(Class::is_object) {
            *to = *label;
        }
    }
}

/// The voxels of a frame's background, kept from one job to the next, since most edits leave it unchanged.
#[derive(Clone)]
pub struct SceneryVoxels {
    background: Arc<Background>,
    relief: Relief,
    columns: Arc<ColumnLabels>,
}

impl SceneryVoxels {
    /// The background of a scene's frame on the ground of `layout`; reuses `last` if nothing changed. `None` if none of
    /// its things describes the kind of place (a sign alone does not stop invention), or if it was inferred from
    /// voxels, which misses many things.
    pub fn from_scene(scene: &Scene, layout: &BevLayout, last: Option<&Self>) -> Option<Self> {
        given(scene)?;
        let same =
            |last: &&Self| Arc::ptr_eq(&last.background, &scene.background) && last.relief == layout.relief;
        if let Some(last) = last.filter(same) {
            return Some(last.clone());
        }
        let mut columns = ColumnLabels::new();
        for thing in scene.background.in_extent(Extent::WINDOW) {
            for (at, labels) in thing.columns(layout) {
                let all = columns.entry(at).or_insert_with(|| vec![Class::FREE; Window::NZ]);
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

    /// Puts the background into a draft except where an object stands.
    pub fn stand_in(&self, draft: &mut VoxelGrid) {
        for ([x, y], labels) in &*self.columns {
            stand_in_column(labels, draft.column_mut(*x, *y));
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
            let standing = SceneryVoxels::from_scene(&scene, &frame.layout, None).expect("a background");
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
        let first = SceneryVoxels::from_scene(&scene, &layout, None).expect("a background");
        let again = SceneryVoxels::from_scene(&scene, &layout, Some(&first)).expect("a background");
        assert!(
            Arc::ptr_eq(&first.columns, &again.columns),
            "kept from job to job"
        );
        let mut guessed = scene.clone();
        guessed.change_canvas(|f| f.inferred.background = true);
        assert!(SceneryVoxels::from_scene(&guessed, &layout, Some(&first)).is_none());
        let mut fewer = (*scene.background).clone();
        let id = fewer.iter().next().expect("a thing").id;
        fewer.remove(id);
        scene.background = Arc::new(fewer);
        let other = SceneryVoxels::from_scene(&scene, &layout, Some(&first)).expect("a background");
        assert_ne!(first.columns, other.columns);
        scene.background = Arc::default();
        assert!(SceneryVoxels::from_scene(&scene, &layout, None).is_none());
        assert_eq!(given(&scene), None);
    }

    /// One sign says nothing of the place: networks go on inventing, and the sign stands in what they give.
    #[test]
    fn a_sign_silences_nothing_and_stays() {
        use scene::Form;
        use scene::background::{Post, PostKind};
        let mut scene = scene(5);
        let layout = scene.frame().layout.clone();
        assert_eq!(given(&scene), Some(scene.background.len()));
        let mut sign = Background::default();
        let at = glam::DVec2::new(9.0, -11.0);
        sign.add(Form::Post(Post::typical(PostKind::Sign, at, 0.0)));
        let columns = sign.iter().next().expect("a sign").columns(&layout);
        scene.background = Arc::new(sign);
        assert!(SceneryVoxels::from_scene(&scene, &layout, None).is_none() && given(&scene).is_none());
        let mut generated = VoxelGrid::new();
        keep_loose_things(&scene, &Region::empty(), &mut generated);
        assert_eq!(generated.count_set(), 0, "outside of the region nothing changes");
        keep_loose_things(&scene, &Region::full(), &mut generated);
        let stands = columns.values().flatten().filter(|l| **l != Class::FREE).count();
        assert!(stands > 2 && generated.count_set() == stands);
    }
}
