//! Memory that one state of a scene takes beside another one: parts that both share count once.

use std::collections::BTreeMap;
use std::mem::size_of;
use std::sync::Arc;

use super::arranged::{Arranged, Members};
use super::background::{Background, Thing, ThingId};
use super::clip::OwnShape;
use super::grid::{BRICK, BrickGrid};
use super::roads::{Road, RoadNetwork};
use super::{
    BevLayout, BoxId, Clip, Frame, Motion, Polyline, Scene, SceneBox, SensorRig, SourceFrame, Track,
};

/// Memory of a map of boxes beside the boxes themselves: about so many bytes a box.
const NODE_BYTES: usize = 32;

type OwnShapes = BTreeMap<BoxId, OwnShape>;

impl Scene {
    /// Bytes that this state holds and `other` does not: copied bricks, layers, boxes and lines. An estimate from below,
    /// good to a few kilobytes a frame.
    pub fn bytes_beside(&self, other: &Scene) -> usize {
        let (canvas, of) = (self.canvas(), other.canvas());
        size_of::<Scene>()
            + beside(&self.prompt, &other.prompt, str::len)
            + beside(&self.words, &other.words, |words| texts(words))
            + beside(&self.rig, &other.rig, rig)
            + beside(&self.background, &other.background, things)
            + beside(&self.roads, &other.roads, roads)
            + beside(&self.arranged, &other.arranged, arranged)
            + beside(canvas, of, |canvas| frame_bytes(canvas, Some(of)))
            + beside(self.clip(), other.clip(), |clip| clip_bytes(clip, other.clip()))
            + self.view_bytes(other)
    }

    /// Bytes of the moment that is shown, where it is not the canvas: it shares memory with the canvas, or with the
    /// moment that the other state shows.
    fn view_bytes(&self, other: &Scene) -> usize {
        let view = self.frame();
        match Arc::ptr_eq(view, self.canvas()) {
            true => 0,
            false => beside(view, other.frame(), |view| {
                frame_bytes(view, Some(self.canvas())).min(frame_bytes(view, Some(other.frame())))
            }),
        }
    }
}

/// Bytes of `own`; 0 where both are the same memory.
fn beside<T: ?Sized>(own: &Arc<T>, other: &Arc<T>, bytes: impl FnOnce(&T) -> usize) -> usize {
    match Arc::ptr_eq(own, other) {
        true => 0,
        false => bytes(own),
    }
}

fn texts(texts: &[String]) -> usize {
    texts.iter().map(|text| size_of::<String>() + text.len()).sum()
}

fn rig(rig: &SensorRig) -> usize {
    let sensors = size_of_val(&rig.cameras[..]) + size_of_val(&rig.lidars[..]);
    size_of::<SensorRig>() + sensors + size_of_val(&rig.radars[..])
}

fn things(background: &Background) -> usize {
    let of =
        |thing: &Thing| size_of::<(ThingId, Thing)>() + NODE_BYTES + size_of_val(&thing.form.points_m()[..]);
    background.iter().map(of).sum()
}

fn roads(network: &RoadNetwork) -> usize {
    let road = |road: &Road| {
        size_of_val(&road.via_m[..])
            + size_of_val(&road.left[..])
            + size_of_val(&road.right[..])
            + size_of_val(&road.crossings[..])
            + size_of_val(&road.stops[..])
    };
    size_of_val(&network.nodes[..])
        + size_of_val(&network.roads[..])
        + network.roads.iter().map(road).sum::<usize>()
}

fn arranged(arranged: &Arranged) -> usize {
    let members = |m: &Members| (m.boxes.len() + m.things.len()) * (size_of::<BoxId>() + NODE_BYTES);
    let groups = arranged
        .groups
        .iter()
        .map(|g| size_of_val(g) + members(&g.members));
    groups.sum::<usize>() + members(&arranged.hidden) + members(&arranged.locked)
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
            size_of_val(&track.voxels.labels[..])
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
    if !other.is_some_and(|f| Arc::ptr_eq(&frame.own_shapes, &f.own_shapes)) {
        bytes += own_shapes(&frame.own_shapes, other.map(|f| &*f.own_shapes));
    }
    bytes
        + (frame.inferred.boxes.len() + frame.absent.len()) * (size_of::<BoxId>() + NODE_BYTES)
        + frame.covered_m.len() * (size_of::<(BoxId, f64)>() + NODE_BYTES)
}

fn own_shapes(shapes: &OwnShapes, other: Option<&OwnShapes>) -> usize {
    let shape = |(id, own): (&BoxId, &OwnShape)| {
        let of = other.and_then(|of| of.get(id));
        let shared = of.is_some_and(|of| Arc::ptr_eq(&of.voxels, &own.voxels));
        let voxels = if shared {
            0
        } else {
            size_of_val(&own.voxels.labels[..])
        };
        size_of::<(BoxId, OwnShape)>() + NODE_BYTES + voxels
    };
    shapes.iter().map(shape).sum()
}

/// Bytes of a source, which shares memory with the one before it, or with its own frame.
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
    handles + own * BRICK * BRICK * grid.extent().nz()
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use super::*;
    use crate::background::{Form, Tree, TreeKind};
    use crate::{BevLayer, Class, VoxelGrid};

    /// Memory that an incomplete count would miss in the history: 4096 steps of a street of 1000 trees are 400 MB.
    #[test]
    fn whatever_an_edit_copies_counts() {
        let frame = Frame::new(BevLayout::default(), BTreeMap::new(), VoxelGrid::new());
        let before = Scene::single("test", frame, Arc::new(SensorRig::default()), 0);
        let none = before.clone().bytes_beside(&before);
        let more = |change: &dyn Fn(&mut Scene)| {
            let mut after = before.clone();
            change(&mut after);
            after.bytes_beside(&before) - none
        };
        let trees = more(&|scene| {
            let tree = Tree {
                position_m: glam::DVec2::ZERO,
                height_m: 8.0,
                crown_radius_m: 2.0,
                kind: TreeKind::Broadleaf,
            };
            for _ in 0..1000 {
                Arc::make_mut(&mut scene.background).add(Form::Tree(tree.clone()));
            }
        });
        assert!(trees > 1000 * size_of::<Thing>(), "{trees}");
        let words = more(&|scene| scene.words = Arc::new(vec!["w".repeat(1000); 100]));
        assert!((100_000..110_000).contains(&words), "{words}");
        let rig = more(&|scene| scene.rig = Arc::new(SensorRig::default()));
        assert!(rig >= size_of_val(&before.rig.cameras[..]), "{rig}");
    }

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
