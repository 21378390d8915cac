//! Edits that hold for a region only: objects outside are left as they are, and new ones are put inside.

use glam::DVec2;

use scene::{BoxId, Edit, Form, Scene, ThingId};

use super::arranged::{box_of, things_of};

/// Edits as far as they are of a region, and how many objects they leave out. New boxes and things of which none would
/// be in the region are moved there together; those that then still lie outside are left out. Roads, lines, painted
/// cells, time and weather hold for the whole scene. `inside` tells of a point of the ground, world frame, m;
/// `middle_m` is the middle of the region.
pub fn within(
    scene: &Scene,
    edits: Vec<Edit>,
    inside: &dyn Fn(DVec2) -> bool,
    middle_m: DVec2,
) -> (Vec<Edit>, usize) {
    let by_m = way_in(&edits, inside, middle_m);
    let relief = &scene.frame().layout.relief;
    let box_is_in = |id: BoxId| {
        let b = scene.frame().boxes.get(&id);
        b.is_some_and(|b| inside(b.center_m.truncate()))
    };
    let thing_is_in = |id: &ThingId| {
        let thing = scene.background.get(*id);
        thing.is_some_and(|t| inside(t.form.middle_m()))
    };
    let (mut out, mut left) = (Vec::with_capacity(edits.len()), 0);
    for mut edit in edits {
        match &mut edit {
            Edit::AddBox { center_m, .. } => {
                let to = center_m.truncate() + by_m;
                let up = relief.height_m(to) - relief.height_m(center_m.truncate());
                *center_m = to.extend(center_m.z + up);
                if !inside(to) {
                    left += 1;
                    continue;
                }
            }
            Edit::AddThings { forms } | Edit::DrawScenery { forms } => {
                let all = forms.len();
                forms.iter_mut().for_each(|f| f.map_points(|p| p + by_m, 0.0));
                forms.retain(|f| inside(f.middle_m()));
                left += all - forms.len();
                if forms.is_empty() {
                    continue;
                }
            }
            Edit::RemoveThings { ids } | Edit::MoveThings { ids, .. } | Edit::RaiseThings { ids, .. } => {
                let all = ids.len();
                ids.retain(thing_is_in);
                left += all - ids.len();
                if ids.is_empty() {
                    continue;
                }
            }
            other => {
                let is_in = match box_of(other) {
                    Some(id) => box_is_in(id),
                    None => things_of(other).iter().all(thing_is_in),
                };
                if !is_in {
                    left += 1;
                    continue;
                }
            }
        }
        out.push(edit);
    }
    (out, left)
}

/// Shift of the new objects: none if some of them would be in the region, else so that their middle is the region's.
fn way_in(edits: &[Edit], inside: &dyn Fn(DVec2) -> bool, middle_m: DVec2) -> DVec2 {
    let places: Vec<DVec2> = edits
        .iter()
        .flat_map(|edit| match edit {
            Edit::AddBox { center_m, .. } => vec![center_m.truncate()],
            Edit::AddThings { forms } | Edit::DrawScenery { forms } => {
                forms.iter().map(Form::middle_m).collect()
            }
            _ => Vec::new(),
        })
        .collect();
    if places.is_empty() || places.iter().any(|p| inside(*p)) {
        return DVec2::ZERO;
    }
    middle_m - places.iter().sum::<DVec2>() / places.len() as f64
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Document;
    use glam::DVec3;
    use scene::{BevLayout, Class, Frame, VoxelGrid};

    fn car(x: f64) -> Edit {
        Edit::AddBox {
            class: Class::Car,
            center_m: DVec3::new(x, 0.0, 0.8),
            size_m: DVec3::new(4.4, 1.8, 1.6),
            yaw_deg: 0.0,
            velocity_mps: None,
            id: None,
            label: Default::default(),
        }
    }

    #[test]
    fn only_what_lies_in_the_region_changes_and_what_comes_comes_there() {
        let layout = BevLayout::default();
        let frame = Frame::new(layout, Default::default(), VoxelGrid::new());
        let mut document = Document::new(Scene::single("t", frame, Default::default(), 1));
        document
            .apply_all("Three", &[car(-20.0), car(0.0), car(20.0)])
            .expect("sound");
        let scene = document.scene().clone();
        let ahead = |p: DVec2| p.x > 5.0;
        let middle = DVec2::new(30.0, 0.0);
        let gone: Vec<Edit> = (1..=3).map(|id| Edit::RemoveBox { id: BoxId(id) }).collect();
        let (edits, left) = within(&scene, gone, &ahead, middle);
        assert_eq!((edits, left), (vec![Edit::RemoveBox { id: BoxId(3) }], 2));
        let x = |edits: &[Edit]| -> Vec<f64> {
            let center = |e: &Edit| match e {
                Edit::AddBox { center_m, .. } => center_m.x,
                _ => f64::NAN,
            };
            edits.iter().map(center).collect()
        };
        // Both are outside: they come together to its middle.
        let (edits, left) = within(&scene, vec![car(-10.0), car(-4.0)], &ahead, middle);
        assert_eq!((x(&edits), left), (vec![27.0, 33.0], 0));
        // One is inside already: the other does not come.
        let (edits, left) = within(&scene, vec![car(-10.0), car(8.0)], &ahead, middle);
        assert_eq!((x(&edits), left), (vec![8.0], 1));
        let night = Edit::SetPrompt {
            prompt: "night".into(),
        };
        let (edits, left) = within(&scene, vec![night.clone()], &ahead, middle);
        assert_eq!((edits, left), (vec![night], 0));
    }
}
