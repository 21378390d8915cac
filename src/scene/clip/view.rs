//! View of the canvas at a moment.

use std::collections::BTreeSet;
use std::sync::Arc;

use super::{Clip, OwnShape};
use crate::{BoxId, Class, Frame, Pose, SceneBox};

/// Classes with legs that step or pedal as far as the object moves.
const STEPPING: [Class; 2] = [Class::Pedestrian, Class::Bicycle];

impl Clip {
    /// The canvas at a time, with every moving object that is there then. Copies pointers, and the voxels of the
    /// objects.
    pub fn view(&self, canvas: &Arc<Frame>, time_s: f64) -> Arc<Frame> {
        let relief = &canvas.layout.relief;
        let world_from_ego = self.ego_at(time_s, &canvas.world_from_ego, relief);
        if self.tracks.is_empty() && world_from_ego == canvas.world_from_ego && time_s == canvas.time_s {
            return canvas.clone();
        }
        let there = self.boxes_at(time_s, canvas);
        let present: BTreeSet<BoxId> = there.iter().map(|b| b.id).collect();
        let absent = self.tracks.keys().filter(|id| !present.contains(id));
        let mut frame = self.with(canvas, &there, time_s, world_from_ego);
        frame.absent = Arc::new(absent.copied().collect());
        Arc::new(frame)
    }

    /// The boxes of all tracks at a time, where they are there.
    pub fn boxes_at(&self, time_s: f64, canvas: &Frame) -> Vec<SceneBox> {
        let relief = &canvas.layout.relief;
        let ids = self.tracks.keys();
        ids.filter_map(|id| self.box_at(*id, time_s, relief)).collect()
    }

    /// The frame to generate: the canvas with those moving objects whose voxels are still drafts, each where it was
    /// made. It is the same at every time.
    pub fn unsettled(&self, canvas: &Arc<Frame>) -> Arc<Frame> {
        if self.tracks.is_empty() {
            return canvas.clone();
        }
        let drafts = self.tracks.values().filter(|t| !t.settled);
        let drafts: Vec<SceneBox> = drafts.map(|t| t.made).collect();
        let mut frame = self.with(canvas, &drafts, canvas.time_s, canvas.world_from_ego);
        let settled = self.tracks.iter().filter(|(_, t)| t.settled);
        frame.absent = Arc::new(settled.map(|(id, _)| *id).collect());
        Arc::new(frame)
    }

    /// The canvas with these boxes of tracks, and their voxels.
    fn with(&self, canvas: &Frame, boxes: &[SceneBox], time_s: f64, world_from_ego: Pose) -> Frame {
        let mut frame = Frame {
            time_s,
            world_from_ego,
            ..canvas.clone()
        };
        if boxes.is_empty() {
            return frame;
        }
        let own = boxes.iter().filter_map(|b| Some((b.id, self.tracks.get(&b.id)?)));
        let own = own.filter(|(_, track)| track.own_shape).map(|(id, track)| {
            let (made, voxels) = (track.made, track.voxels.clone());
            (id, OwnShape { made, voxels })
        });
        frame.own_shapes = Arc::new(own.collect());
        let stepping = boxes.iter().filter(|b| STEPPING.contains(&b.class));
        let covered = stepping.map(|b| (b.id, self.covered_m(b.id, time_s)));
        frame.covered_m = Arc::new(covered.collect());
        let source = Arc::make_mut(&mut frame.source);
        for b in boxes {
            let Some(track) = self.tracks.get(&b.id) else {
                continue;
            };
            frame.boxes.insert(b.id, *b);
            track
                .voxels
                .stamp(&mut frame.occupancy, &canvas.painted, &track.made, b);
            if track.settled {
                source.boxes.insert(b.id, *b);
                track
                    .voxels
                    .stamp(&mut source.occupancy, &canvas.painted, &track.made, b);
            }
        }
        frame
    }
}
