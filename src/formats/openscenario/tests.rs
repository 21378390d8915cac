use std::sync::Arc;

use glam::{DVec2, DVec3};
use roxmltree::{Document, Node};
use scene::clip::{ObjectVoxels, Path, Speed};
use scene::{
    BevLayout, BoxId, Class, Conditions, Extent, Frame, Key, Motion, Relief, Scene, SceneBox, SensorRig, Sun,
    TimeOfDay, Track, VoxelGrid, Weather,
};

use super::*;
use crate::table_tests;

fn a_box(id: u32, class: Class, at: [f64; 3], size: [f64; 3], yaw_rad: f64) -> SceneBox {
    SceneBox {
        id: BoxId(id),
        class,
        center_m: at.into(),
        size_m: size.into(),
        yaw_rad,
        velocity_mps: DVec2::ZERO,
        label: Default::default(),
    }
}

fn track(made: SceneBox, motion: Motion, there_s: [Option<f64>; 2]) -> Track {
    Track {
        made,
        motion,
        there_s,
        voxels: ObjectVoxels::empty(),
        settled: true,
        own_shape: false,
    }
}

/// A bus that drives a bend for 4 s, a pedestrian who is there from 1 to 3 s, a cone; the ego vehicle drives on a grade.
fn scene() -> Scene {
    let mut layout = BevLayout::over(Extent::new([-60, -40], [300, 80]).expect("sound"));
    layout.relief = Relief::from_fn(layout.extent(), |p| 0.05 * p.x);
    let occupancy = VoxelGrid::over(layout.extent());
    let cone = a_box(9, Class::TrafficCone, [6.0, 3.0, 0.8], [0.4, 0.4, 1.05], 0.3);
    let frame = Frame::new(layout, [(cone.id, cone)].into(), occupancy);
    let mut scene = Scene::single("a \"clip\" & more", frame, Arc::new(SensorRig::default()), 1);
    scene.conditions = Conditions {
        sun: Some(Sun {
            azimuth_deg: 0.0,
            elevation_deg: 45.0,
        }),
        ..Conditions::usual(TimeOfDay::Dusk, Weather::Rain, 1)
    };
    let bus = a_box(7, Class::Bus, [10.0, -4.0, 2.25], [11.0, 2.9, 3.5], 0.0);
    let path = Path {
        points_m: vec![
            DVec2::new(10.0, -4.0),
            DVec2::new(30.0, -4.0),
            DVec2::new(50.0, 10.0),
        ],
        start_m: 0.0,
        speeds: vec![Speed {
            time_s: 0.0,
            mps: 8.0,
        }],
        rear_first: false,
    };
    let walker = a_box(5, Class::Pedestrian, [20.0, 5.0, 1.9], [0.7, 0.7, 1.8], -1.5);
    let key = |time_s: f64, y: f64| Key {
        time_s,
        at_m: DVec2::new(20.0, y),
        yaw_deg: -90.0,
    };
    let ahead = |time_s: f64, x: f64| Key {
        time_s,
        at_m: DVec2::new(x, 0.0),
        yaw_deg: 0.0,
    };
    scene.change_clip(|clip| {
        clip.length_s = 4.0;
        clip.tracks
            .insert(bus.id, track(bus, Motion::Path(path), [None; 2]));
        let walk = Motion::Keys(vec![key(1.0, 5.0), key(3.0, 2.0)]);
        clip.tracks
            .insert(walker.id, track(walker, walk, [Some(1.0), Some(3.0)]));
        clip.ego = Some(Motion::Keys(vec![ahead(0.0, 0.0), ahead(4.0, 40.0)]));
    });
    scene
}

fn text(scene: &Scene) -> String {
    String::from_utf8(to_bytes(scene).expect("written")).expect("text")
}

fn number(node: Node<'_, '_>, field: &str) -> f64 {
    let text = node.attribute(field).unwrap_or_else(|| panic!("{field}"));
    text.parse().unwrap_or_else(|e| panic!("{field}: {e}"))
}

fn all<'a>(document: &'a Document<'_>, name: &'static str) -> Vec<Node<'a, 'a>> {
    document.descendants().filter(|n| n.has_tag_name(name)).collect()
}

/// Centre of a box from the place of its reference point.
fn center(entity: Node<'_, '_>, position: Node<'_, '_>) -> DVec3 {
    let offset = entity
        .descendants()
        .find(|n| n.has_tag_name("Center"))
        .expect("a centre");
    let [x, y, z] = ["x", "y", "z"].map(|f| number(offset, f));
    let [px, py, pz] = ["x", "y", "z"].map(|f| number(position, f));
    let turned = DVec2::from_angle(number(position, "h")).rotate(DVec2::new(x, y));
    DVec3::new(px + turned.x, py + turned.y, pz + z)
}

#[test]
fn every_track_is_where_it_is_at_every_frame() {
    let scene = scene();
    let text = text(&scene);
    let document = Document::parse(&text).expect("well formed");
    let entities = all(&document, "ScenarioObject");
    assert_eq!(entities.len(), 4);
    let entity = |name: &str| {
        *entities
            .iter()
            .find(|e| e.attribute("name") == Some(name))
            .expect(name)
    };
    let trajectories = all(&document, "Trajectory");
    assert_eq!(trajectories.len(), 3);
    let relief = &scene.canvas().layout.relief;
    for (name, id, first, count) in [("bus_7", 7, 0.0, 41), ("pedestrian_5", 5, 1.0, 20)] {
        let path = trajectories
            .iter()
            .find(|t| t.attribute("name") == Some(name))
            .expect(name);
        let vertices: Vec<Node<'_, '_>> = path.descendants().filter(|n| n.has_tag_name("Vertex")).collect();
        assert_eq!(vertices.len(), count, "{name}");
        assert!((number(vertices[0], "time") - first).abs() < 1e-9);
        for vertex in vertices {
            let expected = scene
                .clip()
                .box_at(BoxId(id), number(vertex, "time"), relief)
                .expect("there");
            let position = vertex
                .descendants()
                .find(|n| n.has_tag_name("WorldPosition"))
                .expect("a place");
            let found = center(entity(name), position);
            assert!(
                found.distance(expected.center_m) < 1e-6,
                "{name} {found} {}",
                expected.center_m
            );
        }
        let size = entity(name)
            .descendants()
            .find(|n| n.has_tag_name("Dimensions"))
            .expect("a size");
        let made = scene.clip().tracks[&BoxId(id)].made.size_m;
        assert_eq!(
            ["length", "width", "height"].map(|f| number(size, f)),
            made.to_array()
        );
    }
    // The ego vehicle climbs: its nose goes up, which is a negative pitch about y to the left.
    let ego = trajectories
        .iter()
        .find(|t| t.attribute("name") == Some("Ego"))
        .expect("Ego");
    let last = ego
        .descendants()
        .rfind(|n| n.has_tag_name("WorldPosition"))
        .expect("a place");
    assert!((number(last, "x") - 40.0).abs() < 1e-6 && (number(last, "z") - 2.0).abs() < 1e-3);
    assert!((number(last, "p") + 0.05f64.atan()).abs() < 1e-3);
    // The walker waits unseen, appears and leaves.
    let shows: Vec<&str> = all(&document, "VisibilityAction")
        .iter()
        .map(|v| v.attribute("graphics").expect("said"))
        .collect();
    assert_eq!(shows, ["false", "true", "false"]);
}

#[test]
fn weather_time_and_end_are_those_of_the_scene() {
    let text = text(&scene());
    let document = Document::parse(&text).expect("well formed");
    let one = |name: &'static str| all(&document, name)[0];
    assert_eq!(
        one("TimeOfDay").attribute("dateTime"),
        Some("2026-06-21T20:00:00")
    );
    assert_eq!(one("Precipitation").attribute("precipitationType"), Some("rain"));
    assert_eq!(one("RoadCondition").attribute("wetness"), Some("wetWithPuddles"));
    // The sun stands where x leads: in the east.
    assert!((number(one("Sun"), "azimuth") - std::f64::consts::FRAC_PI_2).abs() < 1e-8);
    assert_eq!(
        one("FileHeader").attribute("description"),
        Some("a \"clip\" & more")
    );
    let stop = one("StopTrigger");
    let stop = stop
        .descendants()
        .find(|n| n.has_tag_name("SimulationTimeCondition"))
        .expect("a time");
    assert_eq!(number(stop, "value"), 4.0);
    assert_eq!(one("LogicFile").attribute("filepath"), Some(MAP));
    for weather in Weather::ALL {
        for time in TimeOfDay::ALL {
            let mut scene = scene();
            scene.conditions = Conditions::usual(time, weather, 1);
            Document::parse(&self::text(&scene)).expect("well formed");
        }
    }
}

#[test]
fn a_scene_that_stands_still_has_no_story() {
    let scene = table_tests::scene();
    let text = text(&scene);
    assert_eq!(
        text.as_bytes(),
        to_bytes(&scene).expect("again"),
        "the same bytes"
    );
    let document = Document::parse(&text).expect("well formed");
    assert!(all(&document, "Story").is_empty());
    let car = scene.frame().boxes[&BoxId(4)];
    let private = all(&document, "Private");
    let private = private
        .iter()
        .find(|p| p.attribute("entityRef") == Some("car_4"))
        .expect("car_4");
    let speed = private
        .descendants()
        .find(|n| n.has_tag_name("AbsoluteTargetSpeed"))
        .expect("a speed");
    assert!((number(speed, "value") - car.velocity_mps.dot(car.heading())).abs() < 1e-8);
    let place = private
        .descendants()
        .find(|n| n.has_tag_name("WorldPosition"))
        .expect("a place");
    let entity = all(&document, "ScenarioObject")[1];
    assert!(center(entity, place).distance(car.center_m) < 1e-8);
}

#[test]
fn a_hundred_random_scenes_keep_their_boxes() {
    for seed in 0..100 {
        let scene = table_tests::random_scene(seed);
        let text = text(&scene);
        let document = Document::parse(&text).expect("well formed");
        let entities = all(&document, "ScenarioObject");
        for (entity, b) in entities[1..].iter().zip(scene.frame().boxes.values()) {
            let name = entity.attribute("name").expect("a name");
            let private = all(&document, "Private");
            let private = private
                .iter()
                .find(|p| p.attribute("entityRef") == Some(name))
                .expect(name);
            let place = private
                .descendants()
                .find(|n| n.has_tag_name("WorldPosition"))
                .expect("a place");
            assert!(
                center(*entity, place).distance(b.center_m) < 1e-7,
                "{seed} {name}"
            );
        }
    }
}

#[test]
fn too_many_poses_are_refused_in_one_line() {
    let mut scene = scene();
    let made = a_box(1, Class::Car, [0.0; 3], [4.0, 2.0, 1.5], 0.0);
    scene.change_clip(|clip| {
        (clip.length_s, clip.rate_hz) = (59.9, 100.0);
        for id in 100..900 {
            let made = SceneBox {
                id: BoxId(id),
                ..made
            };
            let motion = Motion::Keys(vec![Key {
                time_s: 0.0,
                at_m: DVec2::ZERO,
                yaw_deg: 0.0,
            }]);
            clip.tracks.insert(made.id, track(made, motion, [None; 2]));
        }
    });
    let line = to_bytes(&scene).expect_err("too many").to_string();
    assert!(
        line.contains("trajectories of 5991 poses, expected at most 4000000"),
        "{line}"
    );
}

/// Writes a scenario for readers of other programs: `SCENELOOM_OUT=folder cargo test … for_readers -- --ignored`.
#[test]
#[ignore = "writes files"]
fn for_readers() {
    let out = std::path::PathBuf::from(std::env::var("SCENELOOM_OUT").expect("a folder"));
    for (name, scene) in [("clip", scene()), ("still", table_tests::scene())] {
        let folder = out.join(name);
        std::fs::create_dir_all(&folder).expect("made");
        for file in
            (crate::export::openscenario::EXPORTER.write)(&scene, &mut table_tests::Small).expect("written")
        {
            std::fs::write(folder.join(file.name), file.bytes).expect("written");
        }
    }
}
