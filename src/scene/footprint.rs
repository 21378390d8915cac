//! How much memory one state of a scene takes beside another one: what both share counts once.

use std::mem::size_of;
use std::sync::Arc;

use super::grid::{Brick, BrickGrid};
use super::{BevLayout, BoxId, Clip, Frame, Motion, Polyline, Scene, SceneBox, SourceFrame, Track};

/// A map of boxes keeps about this much beside the boxes themselves, each.
const NODE_BYTES: usize = 32;

impl Scene {
    /// Bytes that this state holds and `other` does not: copied bricks, layers, boxes and lines. An estimate from below,
    /// good to a few kilobytes a frame.
    pub fn bytes_beside(&self, other: &Scene) -> usize {
        let mut bytes = size_of::<Scene>();
        if !Arc::ptr_eq(&self.prompt, &other.prompt) {
            bytes += self.prompt.len();
        }
        let (canvas, of) = (self.canvas(), other.canvas());
        if !Arc::ptr_eq(canvas, of) {
            bytes += frame_bytes(canvas, Some(of));
        }
        if !Arc::ptr_eq(self.clip(), other.clip()) {
            bytes += clip_bytes(self.clip(), other.clip());
        }
        bytes
    }
}

fn clip_bytes(clip: &Clip, other: &Clip) -> usize {
    let track = |(id, track): (&BoxId, &Track)| {
        let shared = other
            .tracks
            .get(id)
            .is_some_and(|of| Arc::ptr_eq(&track.voxels, &of.voxels));
        let voxels = if shared {
            0
        } else {
            size_of_val(&track.voxels.columns[..])
        };
        size_of::<Track>() + NODE_BYTES + motion_bytes(&track.motion) + voxels
    };
    let ego = clip.ego.as_ref().map_or(0, motion_bytes);
    size_of::<Clip>() + ego + clip.tracks.iter().map(track).sum::<usize>()
}

fn motion_bytes(motion: &Motion) -> usize {
    match motion {
        Motion::Keys(keys) => size_of_val(&keys[..]),
        Motion::Path(path) => size_of_val(&path.points_m[..]) + size_of_val(&path.speeds[..]),
        Motion::Attached { .. } => 0,
    }
}

fn frame_bytes(frame: &Frame, other: Option<&Frame>) -> usize {
    let mut bytes = size_of::<Frame>() + boxes(frame.boxes.len());
    bytes += layout(&frame.layout, other.map(|f| &f.layout));
    bytes += grid(&frame.occupancy, other.map(|f| &f.occupancy));
    bytes += grid(&frame.painted, other.map(|f| &f.painted));
    if !other.is_some_and(|f| Arc::ptr_eq(&frame.source, &f.source)) {
        bytes += source(&frame.source, frame, other.map(|f| &*f.source));
    }
    bytes
}

/// A source shares with the one before it, or with its own frame.
fn source(source: &SourceFrame, frame: &Frame, other: Option<&SourceFrame>) -> usize {
    let beside = |of: Option<&SourceFrame>| {
        grid(&source.occupancy, of.map(|s| &s.occupancy)) + layout(&source.layout, of.map(|s| &s.layout))
    };
    let beside_frame =
        grid(&source.occupancy, Some(&frame.occupancy)) + layout(&source.layout, Some(&frame.layout));
    size_of::<SourceFrame>() + boxes(source.boxes.len()) + beside(other).min(beside_frame)
}

fn boxes(count: usize) -> usize {
    count * (size_of::<(BoxId, SceneBox)>() + NODE_BYTES)
}

fn layout(layout: &BevLayout, other: Option<&BevLayout>) -> usize {
    let mut bytes = match other {
        Some(of) if layout.shares_cells(of) => 0,
        _ => size_of_val(layout.cells()),
    };
    if !other.is_some_and(|of| Arc::ptr_eq(&layout.polylines, &of.polylines)) {
        let of = |line: &Polyline| size_of::<Polyline>() + size_of_val(&line.points_m[..]);
        bytes += layout.polylines.iter().map(of).sum::<usize>();
    }
    bytes
}

fn grid<const FILL: u8>(grid: &BrickGrid<FILL>, other: Option<&BrickGrid<FILL>>) -> usize {
    let handles = size_of_val(grid.bricks());
    let own = match other {
        Some(of) => grid.changed_bricks(of).len(),
        None => grid.bricks().len(),
    };
    handles + own * size_of::<Brick>()
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use super::*;
    use crate::{BevLayer, Class, SensorRig, VoxelGrid};

    #[test]
    fn only_what_is_not_shared_counts() {
        let frame = Frame::new(BevLayout::default(), BTreeMap::new(), VoxelGrid::new());
        let before = Scene::single("test", frame, Arc::new(SensorRig::default()), 0);
        let same = before.clone();
        assert!(same.bytes_beside(&before) < 1024, "nothing but the handles");
        let mut one = before.clone();
        one.change_canvas(|f| f.occupancy.set(3, 4, 5, Class::Car.id()));
        let one_brick = one.bytes_beside(&before);
        assert!((4096..16_384).contains(&one_brick), "{one_brick}");
        let mut layers = before.clone();
        layers.change_canvas(|f| f.layout.set(BevLayer::DrivableArea, 1, 2, true));
        let painted = layers.bytes_beside(&before);
        assert!((160_000..175_000).contains(&painted), "{painted}");
        // Every brick.
        let mut all = before.clone();
        for x in 0..200 {
            for y in 0..200 {
                all.change_canvas(|f| f.occupancy.set(x, y, 0, Class::Car.id()));
            }
        }
        let every = all.bytes_beside(&before);
        assert!(every > 169 * 4096 && every < 169 * 4096 + 16_384, "{every}");
    }
}
