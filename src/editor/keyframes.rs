//! Keyframes as edits: one made where something is, one taken away, and a place copied to the frame after or before.

use crate::traffic::shown;
use scene::{BoxId, Edit, Key, Motion, Scene, Scope};

/// The keyframe of a thing (the ego vehicle if none) at the moment that is shown, where it is. Errors in one line, for a person.
pub fn key_here(scene: &Scene, id: Option<BoxId>) -> Result<Vec<Edit>, &'static str> {
    let (clip, now_s) = (scene.clip(), scene.time_s());
    if clip.length_s == 0.0 {
        return Err("This scene is one moment: make it longer first");
    }
    let mut keys = match clip.motion(id) {
        Some(Motion::Keys(keys)) => keys.clone(),
        Some(_) => return Err("It follows a path: keyframes are for what has none"),
        None => Vec::new(),
    };
    let here = shown(scene, id).ok_or("It is not there at this moment")?;
    let key = Key {
        time_s: now_s,
        at_m: here.at_m,
        yaw_deg: here.yaw_rad.to_degrees(),
    };
    match keys.iter_mut().find(|k| near(k.time_s, now_s, scene)) {
        Some(old) => *old = key,
        None => keys.push(key),
    }
    keys.sort_by(|a, b| a.time_s.total_cmp(&b.time_s));
    Ok(vec![with_keys(scene, id, keys)])
}

/// Takes the keyframe at the moment that is shown away. Errors in one line, for a person.
pub fn drop_key(scene: &Scene, id: Option<BoxId>) -> Result<Vec<Edit>, &'static str> {
    const NONE: &str = "There is no keyframe at this moment";
    let Some(Motion::Keys(keys)) = scene.clip().motion(id) else {
        return Err(NONE);
    };
    let mut left = keys.clone();
    left.retain(|k| !near(k.time_s, scene.time_s(), scene));
    if left.len() == keys.len() {
        return Err(NONE);
    }
    Ok(vec![with_keys(scene, id, left)])
}

/// Puts boxes where they are now at another frame, so many later (or earlier). The time of that frame, s, and the edits; those
/// of boxes that stand still are left out. Errors in one line, for a person.
pub fn copy_to_frame(scene: &Scene, ids: &[BoxId], step: i32) -> Result<(f64, Vec<Edit>), &'static str> {
    let clip = scene.clip();
    let there = clip.frame_at(scene.time_s()) as i64 + i64::from(step);
    let there = usize::try_from(there).ok().filter(|n| *n < clip.frames());
    let time_s = clip.time_of(there.ok_or("There is no frame there")?);
    let moving = ids.iter().filter(|id| clip.tracks.contains_key(id));
    let boxes = moving.filter_map(|id| scene.frame().boxes.get(id));
    let edits: Vec<Edit> = boxes
        .map(|b| Edit::At {
            frame: None,
            time_s: Some(time_s),
            track: None,
            scope: Some(Scope::Moment),
            edit: Box::new(Edit::MoveBox {
                id: b.id,
                center_m: Some(b.center_m),
                yaw_deg: Some(b.yaw_rad.to_degrees()),
                size_m: None,
            }),
        })
        .collect();
    match edits.is_empty() {
        true => Err("Choose something that moves: what stands is the same in every frame"),
        false => Ok((time_s, edits)),
    }
}

/// Two moments that are the same frame, or nearer than frames are.
fn near(a_s: f64, b_s: f64, scene: &Scene) -> bool {
    (a_s - b_s).abs() < 0.5 / scene.clip().rate_hz
}

/// Without a keyframe it stands again.
fn with_keys(scene: &Scene, id: Option<BoxId>, keys: Vec<Key>) -> Edit {
    let track = id.and_then(|id| scene.clip().tracks.get(&id));
    let [from_s, to_s] = track.map_or([None; 2], |t| t.there_s);
    Edit::SetMotion {
        id,
        motion: (!keys.is_empty()).then_some(Motion::Keys(keys)),
        from_s,
        to_s,
    }
}

#[cfg(test)]
mod tests {
    use glam::{DVec2, DVec3};

    use super::*;
    use crate::Apply;
    use scene::{BevLayout, Class, Frame, SceneBox, VoxelGrid};

    fn scene() -> Scene {
        let car = SceneBox {
            id: BoxId(3),
            class: Class::Car,
            center_m: DVec3::new(10.0, 4.0, 0.85),
            size_m: DVec3::new(4.6, 2.0, 1.7),
            yaw_rad: 0.0,
            velocity_mps: DVec2::ZERO,
            label: Default::default(),
        };
        let frame = Frame::new(BevLayout::default(), [(car.id, car)].into(), VoxelGrid::new());
        Scene::single("test", frame, Default::default(), 0)
    }

    fn apply(scene: &mut Scene, edits: &[Edit]) {
        crate::apply::apply_all(edits, scene).expect("sound");
    }

    #[test]
    fn keyframes_come_and_go() {
        let (mut scene, car) = (scene(), Some(BoxId(3)));
        assert!(key_here(&scene, car).is_err(), "one moment");
        let length = Edit::SetLength {
            length_s: 4.0,
            rate_hz: None,
        };
        length.apply(&mut scene).expect("sound");
        assert!(drop_key(&scene, car).is_err(), "there is none");
        let made = key_here(&scene, car).expect("there");
        apply(&mut scene, &made);
        scene.show(2.0);
        let made = key_here(&scene, car).expect("there");
        apply(&mut scene, &made);
        // Moved there, it goes there.
        let moved = Edit::At {
            frame: None,
            time_s: None,
            track: None,
            scope: Some(Scope::Moment),
            edit: Box::new(Edit::MoveBox {
                id: BoxId(3),
                center_m: Some(DVec3::new(20.0, 4.0, 0.85)),
                yaw_deg: None,
                size_m: None,
            }),
        };
        moved.apply(&mut scene).expect("sound");
        let at = |scene: &Scene, t: f64| scene.clip().moving(BoxId(3), t).expect("there").at_m.x;
        assert_eq!((at(&scene, 0.0), at(&scene, 2.0)), (10.0, 20.0));
        // The place of this frame holds in the next one, too.
        scene.show(1.0);
        let here = at(&scene, 1.0);
        let (time_s, edits) = copy_to_frame(&scene, &[BoxId(3)], 1).expect("there is one");
        apply(&mut scene, &edits);
        assert!((at(&scene, time_s) - here).abs() < 1e-9 && at(&scene, 2.0) == 20.0);
        assert!(copy_to_frame(&scene, &[], 1).is_err());
        scene.show(0.0);
        assert!(
            copy_to_frame(&scene, &[BoxId(3)], -1).is_err(),
            "before the first"
        );
        let before = scene.clip().motion(car).expect("moves").times_s().len();
        let dropped = drop_key(&scene, car).expect("there");
        apply(&mut scene, &dropped);
        assert_eq!(
            scene.clip().motion(car).expect("moves").times_s().len(),
            before - 1
        );
    }

    #[test]
    fn the_last_keyframe_leaves_it_standing() {
        let mut scene = scene();
        let length = Edit::SetLength {
            length_s: 4.0,
            rate_hz: None,
        };
        length.apply(&mut scene).expect("sound");
        for id in [Some(BoxId(3)), None] {
            let made = key_here(&scene, id).expect("there");
            apply(&mut scene, &made);
            assert!(scene.clip().motion(id).is_some());
            let dropped = drop_key(&scene, id).expect("there");
            apply(&mut scene, &dropped);
            assert!(scene.clip().motion(id).is_none());
        }
        assert!(key_here(&scene, Some(BoxId(9))).is_err());
    }
}
