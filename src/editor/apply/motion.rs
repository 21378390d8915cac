//! Edits of what moves: a box is lifted off the canvas with its voxels, or set down on it.

use std::sync::Arc;

use scene::clip::{ObjectVoxels, Track, upright};
use scene::{BoxId, Clip, Edit, EditError, Frame, Key, Motion, Scene, SceneBox, SourceFrame};

use crate::immediate;

/// Applies [`Edit::SetMotion`], [`Edit::SetLength`] and [`Edit::SetShape`]. On error nothing has changed.
pub(super) fn apply(edit: &Edit, scene: &mut Scene) -> Result<(), EditError> {
    match edit {
        Edit::SetMotion {
            id,
            motion,
            from_s,
            to_s,
        } => set(scene, *id, motion.as_ref(), [*from_s, *to_s]),
        Edit::SetLength { length_s, rate_hz } => {
            let mut clip = Clip::clone(scene.clip());
            clip.length_s = *length_s;
            clip.rate_hz = rate_hz.unwrap_or(clip.rate_hz);
            put(scene, None, clip)
        }
        Edit::SetShape { id, cells } => set_shape(scene, *id, cells),
        _ => Ok(()),
    }
}

/// Gives a box voxels of its own, or (without any) those of its class again. With its own it is a track from then on, which stands where it stood or moves as it moved.
fn set_shape(scene: &mut Scene, id: BoxId, cells: &[[i32; 3]]) -> Result<(), EditError> {
    let Some(b) = scene.frame().boxes.get(&id).copied() else {
        return Err(EditError::UnknownBox { id });
    };
    let lattice = scene.canvas().extent().lattice();
    let mut next = scene.clone();
    if cells.is_empty() {
        let Some(track) = next.clip().tracks.get(&id).filter(|t| t.own_shape) else {
            return Ok(()); // it has its class's voxels
        };
        let stands = track.stands();
        next.change_clip(|clip| {
            if let Some(track) = clip.tracks.get_mut(&id) {
                (track.voxels, track.settled) = (ObjectVoxels::drafted(lattice, &track.made), false);
                track.own_shape = false;
            }
        });
        if stands {
            // It needs no track to stand still: a plain box of its class replaces it.
            set(&mut next, Some(id), None, [None; 2])?;
            super::apply_all(&[Edit::RemoveBox { id }, b.into()], &mut next)?;
        }
        *scene = next;
        return Ok(());
    }
    // A track's box is as high above the ground everywhere.
    let relief = &scene.canvas().layout.relief;
    let mut made = upright(lattice, &b);
    made.center_m.z += relief.height_m(made.center_m.truncate()) - relief.height_m(b.center_m.truncate());
    let (mut made, voxels) = ObjectVoxels::of_cells(lattice, &made, cells).map_err(EditError::BadShape)?;
    if !next.clip().tracks.contains_key(&id) {
        set(&mut next, Some(id), Some(&standing(&b)), [None; 2])?;
    }
    let mut clip = Clip::clone(next.clip());
    if let Some(track) = clip.tracks.get_mut(&id) {
        made.velocity_mps = track.made.velocity_mps;
        (track.made, track.voxels) = (made, voxels);
        (track.settled, track.own_shape) = (true, true);
    }
    put(&mut next, None, clip)?;
    *scene = next;
    Ok(())
}

/// The motion of a box that stands where it is.
fn standing(b: &SceneBox) -> Motion {
    Motion::Keys(vec![Key {
        time_s: 0.0,
        at_m: b.center_m.truncate(),
        yaw_deg: b.yaw_rad.to_degrees(),
    }])
}

/// Gives a box, or (`None`) the ego vehicle, a motion, or takes it away.
pub(super) fn set(
    scene: &mut Scene,
    id: Option<BoxId>,
    motion: Option<&Motion>,
    there_s: [Option<f64>; 2],
) -> Result<(), EditError> {
    let mut clip = Clip::clone(scene.clip());
    let mut canvas = None;
    match (id, motion) {
        (None, motion) => {
            if motion.is_none() && clip.ego.is_some() {
                let mut still = Frame::clone(scene.canvas());
                still.world_from_ego = scene.frame().world_from_ego;
                canvas = Some(still);
            }
            clip.ego = motion.cloned();
        }
        (Some(id), Some(motion)) => {
            if let Some(track) = clip.tracks.get_mut(&id) {
                track.motion = motion.clone();
                track.there_s = there_s;
            } else {
                let mut frame = Frame::clone(scene.canvas());
                let mut track = lift(&mut frame, id)?;
                track.motion = motion.clone();
                track.there_s = there_s;
                if clip.tracks.len() >= Clip::MAX_TRACKS {
                    let (found, most) = (clip.tracks.len(), Clip::MAX_TRACKS);
                    return Err(EditError::BadMotion(format!(
                        "{found} objects move already, expected at most {most}"
                    )));
                }
                clip.tracks.insert(id, track);
                canvas = Some(frame);
            }
        }
        (Some(id), None) if clip.tracks.get(&id).is_some_and(|t| t.own_shape) => {
            // It stands still as a track: its voxels are its own.
            let (from_s, relief) = (scene.clip().tracks[&id].there_s[0], &scene.canvas().layout.relief);
            let at_first = || scene.clip().box_at(id, from_s.unwrap_or(0.0), relief);
            let now = scene.frame().boxes.get(&id).copied().or_else(at_first);
            if let Some(track) = clip.tracks.get_mut(&id) {
                track.motion = standing(&now.unwrap_or(track.made));
                track.there_s = [None; 2];
            }
        }
        (Some(id), None) => {
            let Some(track) = clip.tracks.remove(&id) else {
                return match scene.canvas().boxes.contains_key(&id) {
                    true => Ok(()), // it stands already
                    false => Err(EditError::UnknownBox { id }),
                };
            };
            let mut frame = Frame::clone(scene.canvas());
            let relief = &frame.layout.relief;
            let now = scene.clip().box_at(id, scene.time_s(), relief);
            let now = SceneBox {
                velocity_mps: Default::default(),
                ..now.unwrap_or(track.made)
            };
            set_down(&mut frame, &track, now);
            canvas = Some(frame);
        }
    }
    if clip.length_s == 0.0 {
        // The first motion of a scene decides its length.
        let times = motion.map(Motion::times_s).unwrap_or_default();
        let last_s = times.into_iter().fold(0.0, f64::max);
        clip.length_s = last_s.clamp(0.0, Clip::MAX_LENGTH_S);
    }
    put(scene, canvas, clip)
}

/// Replaces the clip, and perhaps the canvas, if the clip is sound.
fn put(scene: &mut Scene, canvas: Option<Frame>, clip: Clip) -> Result<(), EditError> {
    if let Some(problem) = clip.problem() {
        return Err(EditError::BadMotion(problem));
    }
    match canvas {
        Some(canvas) => scene.set_parts(canvas, clip),
        None if clip != **scene.clip() => scene.change_clip(|old| *old = clip),
        None => {}
    }
    Ok(())
}

/// Takes a box off the canvas, its voxels with it; ground is laid where it stood, in the source too if it was settled.
fn lift(canvas: &mut Frame, id: BoxId) -> Result<Track, EditError> {
    let b = *canvas.boxes.get(&id).ok_or(EditError::UnknownBox { id })?;
    let settled = canvas.source.boxes.get(&id).is_some_and(|of| {
        (of.class, of.center_m, of.size_m, of.yaw_rad) == (b.class, b.center_m, b.size_m, b.yaw_rad)
    });
    let before = canvas.occupancy.clone();
    canvas.boxes.remove(&id);
    canvas.inferred.boxes.remove(&id);
    immediate::clear_box(canvas, &b);
    // Its voxels are those that went with it, as `clear_box` tells them from a neighbour's.
    let after = &canvas.occupancy;
    let voxels = ObjectVoxels::cut(&before, &b, |[x, y, z], label| {
        label == b.class.id() && after.get(x, y, z) != label
    });
    if settled {
        let mut source = Frame {
            layout: canvas.source.layout.clone(),
            boxes: canvas.source.boxes.clone(),
            occupancy: canvas.source.occupancy.clone(),
            ..canvas.clone()
        };
        source.boxes.remove(&id);
        immediate::clear_box(&mut source, &b);
        canvas.source = Arc::new(SourceFrame {
            layout: source.layout,
            boxes: source.boxes,
            occupancy: source.occupancy,
        });
    }
    Ok(Track {
        made: b,
        motion: Motion::Keys(Vec::new()),
        there_s: [None; 2],
        voxels,
        settled,
        own_shape: false,
    })
}

/// Puts a track's object onto the canvas, and into the source if it was settled.
fn set_down(canvas: &mut Frame, track: &Track, now: SceneBox) {
    canvas.boxes.insert(now.id, now);
    track
        .voxels
        .stamp(&mut canvas.occupancy, &canvas.painted, &track.made, &now);
    if track.settled {
        let source = Arc::make_mut(&mut canvas.source);
        source.boxes.insert(now.id, now);
        track
            .voxels
            .stamp(&mut source.occupancy, &canvas.painted, &track.made, &now);
    }
}
