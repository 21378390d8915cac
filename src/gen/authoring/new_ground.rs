//! Edits that make a map larger, and the scenery on the new ground.

use super::scenery::SceneryWish;
use editor::{Edit, apply_all};
use job::inpaint::InpaintMask;
use scene::{Lattice, Scene};

/// Edits that may make a map larger, followed by edits that draw scenery beside the new roads if there is scenery
/// beside the old ones. Every place that applies edits of a user (window, command line, assistants, batches) takes them
/// from here.
pub fn with_scenery(scene: &Scene, mut edits: Vec<Edit>) -> Vec<Edit> {
    let mut larger = scene.clone();
    if edits.iter().any(may_grow) && apply_all(&edits, &mut larger).is_ok() {
        edits.extend(beside_new_ground(scene, &larger));
    }
    edits
}

/// True for an edit after which a map may be larger.
fn may_grow(edit: &Edit) -> bool {
    match edit {
        Edit::ExtendMap { .. } | Edit::LetMove { id: None, .. } | Edit::Forecast { .. } => true,
        Edit::At { edit, .. } => may_grow(edit),
        _ => false,
    }
}

/// Edits that draw scenery where a map has become larger; none if there was no scenery before.
pub fn beside_new_ground(before: &Scene, larger: &Scene) -> Vec<Edit> {
    let (old, new) = (before.canvas().extent(), larger.canvas().extent());
    let is_drawn = new.lattice() == Lattice::OCC3D;
    if old == new || !is_drawn || !before.background.describes_place() {
        return Vec::new();
    }
    let mut region = InpaintMask::of_rect(new, new.min_m().truncate(), new.max_m().truncate());
    let was_there = |[x, y]: &[usize; 2]| {
        let p = new.center(*x, *y, 0);
        old.column_at(p.x, p.y).is_some()
    };
    let old_columns: Vec<[usize; 2]> = new.all_columns().filter(was_there).collect();
    region.set_columns(new, &old_columns, false);
    let wish = SceneryWish {
        region,
        ..SceneryWish::of_seed(before.seed)
    };
    // The rules never fail.
    wish.edits(larger).unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::open;
    use scene::Class;

    /// A larger map has scenery on its new ground, whatever enlarged it, but none if the old ground had none.
    #[test]
    fn new_ground_has_scenery_where_the_old_one_has() {
        let scene = open::from_template("straight", 7).expect("a template");
        let extend = Edit::ExtendMap {
            ahead_m: 40.0,
            behind_m: 0.0,
            left_m: 0.0,
            right_m: 0.0,
        };
        let grown = |scene: &Scene, edits: Vec<Edit>| {
            let mut larger = scene.clone();
            apply_all(&with_scenery(scene, edits), &mut larger).expect("sound");
            larger
        };
        let larger = grown(&scene, vec![extend.clone()]);
        let beyond = |scene: &Scene| {
            let things = scene.background.iter();
            things.filter(|t| t.form.middle_m().x > 40.0).count()
        };
        assert!(beyond(&larger) > 5 && beyond(&scene) == 0, "{}", beyond(&larger));
        let frame = larger.canvas();
        let standing = frame.occupancy.iter_set().filter(|(x, y, _, label)| {
            let stands = [Class::Manmade.id(), Class::Vegetation.id()].contains(label);
            stands && frame.extent().center(*x, *y, 0).x > 42.0
        });
        assert!(standing.count() > 500);
        // The new things are drawn ones, and the old things are unchanged.
        let new = larger.background.iter().filter(|t| t.form.middle_m().x > 40.0);
        assert!(new.into_iter().all(|t| !t.placed));
        assert!(
            scene
                .background
                .iter()
                .all(|t| larger.background.get(t.id) == Some(t))
        );
        let mut bare = scene.clone();
        bare.background = Default::default();
        assert!(grown(&bare, vec![extend.clone()]).background.is_empty());
        // Wrapped in a moment it grows as well.
        let at = Edit::At {
            frame: None,
            time_s: Some(0.0),
            track: None,
            scope: None,
            edit: Box::new(extend),
        };
        assert_eq!(beyond(&grown(&scene, vec![at])), beyond(&larger));
    }
}
