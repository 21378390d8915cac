//! Tests of the table: what holds for every source in it.

mod heading;
mod lenses;
mod normal_maps;

use std::collections::BTreeSet;

use super::*;
use scene::{BevLayout, TimeOfDay, VoxelGrid, Weather};
use world::World;
use world::voxelize::{Vertical, complete};

fn street() -> Frame {
    street_and_things().0
}

fn street_and_things() -> (Frame, Background) {
    let world = World::random(5);
    let grid = complete(&world, Vertical::Occ3d);
    let frame = Frame::new(world.layout.clone(), world.boxes.clone(), grid);
    (frame, world.background.clone())
}

/// One camera's picture by one source, in the colours of its first view.
fn rgba(
    source: &'static dyn CameraSource,
    frame: &Frame,
    conditions: Conditions,
    camera: &Camera,
) -> Vec<u8> {
    let picture = drawn(source, frame, conditions, camera, [80, 45]).expect("a small picture");
    picture.rgba(source.views()[0].id, 12.0).1
}

/// The same with what stands beside the roads.
fn rgba_beside(
    source: &'static dyn CameraSource,
    frame: &Frame,
    background: &Background,
    conditions: Conditions,
    camera: &Camera,
) -> Vec<u8> {
    let input = CameraInput {
        frame,
        rig: &SensorRig::default(),
        background,
        conditions,
        detail: Detail::Full,
        paint: None,
        cache: None,
    };
    let options = RenderOptions {
        size: [80, 45],
        quality: Quality::Preview,
    };
    let ready = PreparedSource::new(source, &input);
    let picture = ready.render(camera, &options, RenderContext::processor());
    let picture = picture.expect("a small picture");
    picture.rgba(source.views()[0].id, 12.0).1
}

fn drawn(
    source: &'static dyn CameraSource,
    frame: &Frame,
    conditions: Conditions,
    camera: &Camera,
    size: [u32; 2],
) -> Result<CameraPicture, CameraError> {
    let input = CameraInput {
        frame,
        rig: &SensorRig::default(),
        background: &Background::default(),
        conditions,
        detail: Detail::Full,
        paint: None,
        cache: None,
    };
    let options = RenderOptions {
        size,
        quality: Quality::Preview,
    };
    PreparedSource::new(source, &input).render(camera, &options, RenderContext::processor())
}

#[test]
fn names_are_unique_and_every_view_has_a_source() {
    let ids: BTreeSet<&str> = all().iter().map(|s| s.id().name()).collect();
    assert_eq!(ids.len(), all().len(), "{ids:?}");
    let views = views();
    for view in &views {
        let sources = sources_of(view.id);
        assert!(!sources.is_empty());
        for source in sources {
            assert_eq!(source_of(view.id, source.id()).id(), source.id());
        }
    }
    let titles: BTreeSet<&str> = views.iter().map(|v| v.title).collect();
    assert_eq!(titles.len(), views.len(), "{titles:?}");
    // What the window starts with.
    assert_eq!(source_of(ViewId::default(), SourceId::default()).id(), shapes::ID);
    // A source that does not give the view is no choice for it.
    assert_eq!(source_of(pictures::VIEW.id, splats::ID).id().name(), "pictures");
}

/// A picture changes with what its source says it needs, and with nothing else.
#[test]
fn sources_need_what_they_say() {
    let (mut frame, things) = street_and_things();
    let camera = SensorRig::default().cameras[1].clone();
    // Where the labels have no ground, the layout says what lies there.
    for (x, y) in (105..150).flat_map(|x| (40..160).map(move |y| (x, y))) {
        frame.occupancy.column_mut(x, y)[..2].fill(scene::Class::FREE);
    }
    let day = Conditions {
        seed: 5,
        ..Conditions::default()
    };
    let dusk = Conditions {
        time: TimeOfDay::Dusk,
        weather: Weather::Rain,
        ..day
    };
    let without = |layout: bool, boxes: bool, occupancy: bool| {
        let mut less = frame.clone();
        if layout {
            less.layout = BevLayout::default();
        }
        if boxes {
            less.boxes.clear();
        }
        if occupancy {
            less.occupancy = VoxelGrid::new();
        }
        less
    };
    let (no_layout, no_boxes, no_voxels) = (
        without(true, false, false),
        without(false, true, false),
        without(false, false, true),
    );
    for source in all() {
        let base = rgba(*source, &frame, day, &camera);
        let differs = |frame: &Frame, conditions| rgba(*source, frame, conditions, &camera) != base;
        let found = Needs {
            occupancy: differs(&no_voxels, day),
            layout: differs(&no_layout, day),
            boxes: differs(&no_boxes, day),
            // Public weights begin with the rendering, which shows things as they are; the own network hears classes alone.
            background: source.id() == super::learned::ID
                || rgba_beside(*source, &frame, &things, day, &camera) != base,
            conditions: differs(&frame, dusk),
        };
        assert_eq!(source.about().needs, found, "{}", source.id().name());
    }
}

#[test]
fn every_source_keeps_the_bounds_and_stops_when_cancelled() {
    let (frame, camera) = (street(), SensorRig::default().cameras[0].clone());
    for source in all() {
        let name = source.id().name();
        let large = drawn(*source, &frame, Conditions::default(), &camera, [8192, 8192]);
        let Err(error) = large else {
            panic!("{name} draws 67 million pixels")
        };
        let line = error.to_string();
        assert!(line.contains("67108864") && line.contains("33554432"), "{line}");
        // Every source can draw 4K.
        assert_eq!(
            bounds::check([3840, 2160], source.about().bytes_per_pixel, 0),
            Ok(()),
            "{name}"
        );
        let empty = drawn(*source, &frame, Conditions::default(), &camera, [0, 7]);
        assert!(empty.is_ok_and(|p| p.rgba(source.views()[0].id, 1.0).1.is_empty()));
        let input = CameraInput {
            frame: &frame,
            rig: &SensorRig::default(),
            background: &Background::default(),
            conditions: Conditions::default(),
            detail: Detail::Live,
            paint: None,
            cache: None,
        };
        let options = RenderOptions {
            size: [16, 9],
            quality: Quality::Preview,
        };
        let context = RenderContext {
            card: None,
            cancelled: &|| true,
        };
        let stopped = PreparedSource::new(*source, &input).render(&camera, &options, context);
        assert!(matches!(stopped, Err(CameraError::Cancelled)), "{name}");
    }
    let full = bounds::check([8000, 4000], 200, 0).expect_err("6.4 GB");
    assert!(full.to_string().contains("6400 MB"), "{full}");
    assert!(bounds::check([100, 100], 10, bounds::MAX_RUN_BYTES).is_err());
    assert!(bounds::check([u32::MAX; 2], u64::MAX, u64::MAX).is_err());
}

#[test]
fn small_pictures_side_by_side_are_those_one_after_another() {
    let (frame, rig) = (street(), SensorRig::default());
    let options = RenderOptions {
        size: [80, 45],
        quality: Quality::Preview,
    };
    for source in all() {
        let (name, view) = (source.id().name(), source.views()[0].id);
        let input = CameraInput {
            frame: &frame,
            rig: &rig,
            background: &Background::default(),
            conditions: Conditions::default(),
            detail: Detail::Full,
            paint: None,
            cache: None,
        };
        let ready = PreparedSource::new(*source, &input);
        assert!(ready.side_by_side(&options) >= rig.cameras.len(), "{name}");
        let all = ready
            .render_all(&rig.cameras, &options, None)
            .expect("small pictures");
        assert_eq!(all.len(), rig.cameras.len());
        for (camera, picture) in rig.cameras.iter().zip(&all) {
            let alone = ready
                .render(camera, &options, RenderContext::processor())
                .expect("small");
            assert!(picture.rgba(view, 12.0) == alone.rgba(view, 12.0), "{name}");
        }
    }
    assert_eq!(bounds::side_by_side([3840, 2160], 80), 1);
    assert_eq!(bounds::side_by_side([u32::MAX; 2], u64::MAX), 1);
}
