//! The tables and the pictures of a clip, by numbers.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

use glam::{DVec2, DVec3};
use parquet::file::reader::{FileReader, SerializedFileReader};
use parquet::record::{Field as Cell, Row, RowAccessor};
use scene::clip::ObjectVoxels;
use scene::{
    BevLayer, BoxId, Camera, Class, Frame, Key, Motion, Polyline, PolylineKind, Scene, SceneBox, SensorRig,
    Track,
};

use super::draw::MultisamplePicture;
use super::draw_scene::{ColoredMap, Shot};
use super::ftheta::FTheta;
use super::map::ScenarioMap;
use super::{ObjectCategory, boxes_at, category, clip_id, ego_at, scenario_from_world, tables, times_s};
use crate::table_tests::{Small, random_scene};

fn a_box(id: u32, class: Class, at: DVec3) -> SceneBox {
    let [length, width, height] = class.typical_size_m().expect("an object");
    SceneBox {
        id: BoxId(id),
        class,
        center_m: at,
        size_m: DVec3::new(length, width, height),
        yaw_rad: 0.0,
        velocity_mps: DVec2::ZERO,
        label: Default::default(),
    }
}

fn key(time_s: f64, x: f64, y: f64, yaw_deg: f64) -> Key {
    Key {
        time_s,
        at_m: DVec2::new(x, y),
        yaw_deg,
    }
}

/// Two seconds of a drive to the left of the map's x axis: a truck stands there, a car moves and goes at 1.2 s.
fn drive() -> Scene {
    let mut layout = scene::BevLayout::default();
    for [x, y] in layout.extent().all_columns() {
        layout.set(BevLayer::DrivableArea, x, y, (80..120).contains(&x));
    }
    let line = |kind, points: &[[f64; 2]]| Polyline {
        kind,
        points_m: points.iter().map(|p| DVec2::from_array(*p)).collect(),
    };
    layout.polylines = Arc::new(vec![
        line(PolylineKind::LaneCenter, &[[1.75, -30.0], [1.75, 30.0]]),
        line(PolylineKind::RoadDivider, &[[0.0, -30.0], [0.0, 30.0]]),
        line(PolylineKind::LaneDivider, &[[3.5, -30.0], [3.5, 30.0]]),
        line(PolylineKind::StopLine, &[[0.0, 10.0], [7.0, 10.0]]),
        line(
            PolylineKind::PedCrossing,
            &[[-8.0, 12.0], [8.0, 12.0], [8.0, 15.0], [-8.0, 15.0]],
        ),
        line(
            PolylineKind::PedCrossing,
            &[[f64::NAN, 12.0], [8.0, 12.0], [8.0, 15.0]],
        ),
    ]);
    for line in layout.polylines.clone().iter() {
        scene::raster::draw_polyline(&mut layout, line);
    }
    let truck = SceneBox {
        yaw_rad: 0.5,
        ..a_box(3, Class::Truck, DVec3::new(3.0, 20.0, 1.425))
    };
    let frame = Frame::new(layout, [(truck.id, truck)].into(), scene::VoxelGrid::new());
    let mut scene = Scene::single("a/drive ", frame, Arc::new(SensorRig::default()), 9);
    scene.change_clip(|clip| {
        clip.length_s = 2.0;
        // It drives along y: its x axis is the map's y.
        clip.ego = Some(Motion::Keys(vec![
            key(0.0, 3.5, -10.0, 90.0),
            key(2.0, 3.5, 10.0, 90.0),
        ]));
        let car = a_box(8, Class::Car, DVec3::new(-3.5, 0.0, 0.85));
        let track = Track {
            made: car,
            motion: Motion::Keys(vec![key(0.0, -3.5, 10.0, 270.0), key(2.0, -3.5, -10.0, 270.0)]),
            there_s: [None, Some(1.2)],
            voxels: ObjectVoxels::empty(),
            settled: true,
            own_shape: false,
        };
        clip.tracks.insert(car.id, track);
    });
    scene
}

/// Rows of the tables by name.
fn rows_of(scene: &Scene) -> BTreeMap<&'static str, Vec<Row>> {
    let rows = |bytes: Vec<u8>| {
        let mut file = tempfile::tempfile().expect("a file");
        std::io::Write::write_all(&mut file, &bytes).expect("written");
        let reader = SerializedFileReader::new(file).expect("parquet");
        let rows = reader.get_row_iter(None).expect("rows");
        rows.map(|row| row.expect("a row")).collect()
    };
    let all = tables::tables(scene).expect("sound").into_iter();
    all.map(|(name, bytes)| (name, rows(bytes))).collect()
}

/// A number within the structs of a row.
fn number(row: &Row, path: &[&str]) -> f64 {
    let (name, rest) = path.split_first().expect("a path");
    let (_, cell) = row.get_column_iter().find(|(n, _)| n == name).expect(name);
    match cell {
        Cell::Group(inner) => number(inner, rest),
        Cell::Double(value) => *value,
        Cell::Long(value) => *value as f64,
        other => panic!("{name}: {other}"),
    }
}

fn vector(row: &Row, path: [&str; 2]) -> DVec3 {
    DVec3::from_array(["x", "y", "z"].map(|axis| number(row, &[path[0], path[1], axis])))
}

#[test]
fn rows_are_in_the_frame_of_the_first_moment() {
    let rows = rows_of(&drive());
    let names: BTreeSet<&str> = rows.keys().copied().collect();
    let expected = [
        "calibration_estimate",
        "crosswalk",
        "egomotion_estimate",
        "lane",
        "lane_line",
        "obstacle",
        "road_boundary",
        "wait_line",
    ];
    assert_eq!(names, expected.into());
    let ego = &rows["egomotion_estimate"];
    assert_eq!(ego.len(), 21);
    for (i, row) in ego.iter().enumerate() {
        assert_eq!(number(row, &["key", "timestamp_micros"]), i as f64 * 1e5);
        let turn = number(row, &["egomotion_estimate", "orientation", "w"]);
        assert!((turn - 1.0).abs() < 1e-9, "it drives straight on");
    }
    assert!(vector(&ego[0], ["egomotion_estimate", "location"]).length() < 1e-9);
    // 20 m in 2 s along its own x.
    let last = vector(&ego[20], ["egomotion_estimate", "location"]);
    assert!((last - DVec3::new(20.0, 0.0, 0.0)).length() < 1e-6, "{last}");
    // The truck stands 30 m ahead and half a metre to the left, turned by 0.5 rad less a quarter turn; the car comes towards
    // the vehicle 7 m to its left.
    let obstacles = &rows["obstacle"];
    let of = |id: &str| -> Vec<&Row> {
        let is = |row: &&Row| row.get_group(1).expect("a struct").get_string(0).expect("an id") == id;
        obstacles.iter().filter(is).collect()
    };
    let (truck, car) = (of("3"), of("8"));
    assert_eq!((truck.len(), car.len(), obstacles.len()), (21, 12, 33));
    assert!((vector(truck[5], ["obstacle", "center"]) - DVec3::new(30.0, 0.5, 1.425)).length() < 1e-9);
    assert!((vector(truck[5], ["obstacle", "size"]) - DVec3::new(6.9, 2.5, 2.85)).length() < 1e-12);
    let half = (0.5 - std::f64::consts::FRAC_PI_2).rem_euclid(std::f64::consts::TAU) / 2.0;
    for (axis, expected) in [("x", 0.0), ("y", 0.0), ("z", half.sin()), ("w", half.cos())] {
        assert!(
            (number(truck[5], &["obstacle", "orientation", axis]) - expected).abs() < 1e-9,
            "{axis}"
        );
    }
    assert!((vector(car[0], ["obstacle", "center"]) - DVec3::new(20.0, 7.0, 0.85)).length() < 1e-9);
    assert!((vector(car[10], ["obstacle", "center"]) - DVec3::new(10.0, 7.0, 0.85)).length() < 1e-6);
    let text = |row: &Row| row.to_string();
    assert!(text(car[0]).contains("automobile") && text(truck[0]).contains("heavy_truck"));
    assert!(text(&rows["lane_line"][0]).contains("SOLID_GROUP") && rows["lane_line"].len() == 2);
    assert_eq!(
        (
            rows["crosswalk"].len(),
            rows["wait_line"].len(),
            rows["lane"].len()
        ),
        (1, 1, 1)
    );
    // The two sides of the road, 8 m to either side of the map's y axis.
    assert_eq!(rows["road_boundary"].len(), 2);
    assert!(text(&rows["lane"][0]).contains("\"SOLID\"") && text(&rows["lane"][0]).contains("\"DASHED\""));
}

#[test]
fn a_scene_that_stands_still_is_told_for_a_second() {
    let scene = crate::table_tests::scene();
    assert_eq!(times_s(&scene, 10.0).len(), 11);
    let rows = rows_of(&scene);
    assert_eq!(
        (rows["egomotion_estimate"].len(), rows["obstacle"].len()),
        (11, 11)
    );
    assert!(!rows.contains_key("crosswalk"));
    let mut odd = drive();
    odd.change_clip(|clip| clip.length_s = 0.25);
    assert_eq!(times_s(&odd, 10.0), [0.0, 0.1, 0.2, 0.25]);
    assert_eq!(clip_id(&odd), "a_drive_");
    odd.name = "/ /".into();
    assert_eq!(clip_id(&odd), "scene_9");
}

#[test]
fn tables_are_the_same_bytes_and_bad_scenes_one_line() {
    for seed in 0..5 {
        let scene = random_scene(seed);
        assert_eq!(
            tables::tables(&scene).expect("sound"),
            tables::tables(&scene).expect("sound")
        );
    }
    let mut scene = drive();
    scene.change_canvas(|canvas| canvas.boxes.get_mut(&BoxId(3)).expect("it").center_m.x = f64::NAN);
    assert!(
        tables::tables(&scene)
            .expect_err("NaN")
            .to_string()
            .contains("box 3")
    );
    let mut scene = drive();
    Arc::make_mut(&mut scene.rig).cameras[0].focal_px[0] = f64::NAN;
    assert!(
        tables::tables(&scene)
            .expect_err("NaN")
            .to_string()
            .contains("CAM_FRONT_LEFT")
    );
}

#[test]
fn every_class_has_a_category_that_readers_know() {
    let kinds: Vec<ObjectCategory> = Class::OBJECTS.iter().map(|c| category(*c).1).collect();
    for kind in [
        ObjectCategory::Car,
        ObjectCategory::Truck,
        ObjectCategory::Pedestrian,
        ObjectCategory::Cyclist,
        ObjectCategory::Others,
    ] {
        assert!(kinds.contains(&kind), "{kind:?}");
    }
}

/// A picture of a camera ahead, and its pixels.
fn picture(scene: &Scene, time_s: f64, camera: &Camera) -> impl Fn(usize, usize) -> [u8; 3] + use<> {
    let model = FTheta::from_camera(camera).resized(1280, 720);
    let to_scenario = scenario_from_world(scene);
    let mut canvas = MultisamplePicture::new(1280, 720);
    let mut shot = Shot {
        canvas: &mut canvas,
        model: &model,
        scenario_from_camera: to_scenario * ego_at(scene, time_s) * camera.ego_from_camera(),
    };
    let painted = ColoredMap::from_map(&ScenarioMap::from_scene(scene, &to_scenario));
    shot.draw(&painted, &boxes_at(scene, time_s, &to_scenario));
    let rgba = canvas.rgba();
    assert_eq!(rgba.len(), 1280 * 720 * 4);
    if let Some(folder) = std::env::var_os("SCENELOOM_PICTURES") {
        let name = format!("control_{time_s}.png");
        image::save_buffer(
            std::path::Path::new(&folder).join(name),
            &rgba,
            1280,
            720,
            image::ExtendedColorType::Rgba8,
        )
        .expect("written");
    }
    move |u, v| {
        let at = (v * 1280 + u) * 4;
        [rgba[at], rgba[at + 1], rgba[at + 2]]
    }
}

/// A camera 1.5 m above the rear axle that looks ahead, 90 degrees wide: 640 pixels are 1 m aside at 1 m.
fn camera() -> Camera {
    Camera {
        translation_m: [0.0, 0.0, 1.5],
        ..Camera::new("AHEAD", 90.0)
    }
}

fn near(found: [u8; 3], expected: [f64; 3], what: &str) {
    let off = found
        .iter()
        .zip(expected)
        .map(|(a, b)| (f64::from(*a) - b).abs())
        .fold(0.0, f64::max);
    assert!(off <= 4.0, "{what}: {found:?}, expected {expected:?}");
}

#[test]
fn a_car_ahead_to_the_left_is_where_it_is_in_the_colours_of_its_kind() {
    let mut scene = crate::table_tests::scene();
    let car = a_box(1, Class::Car, DVec3::new(12.3, 4.0, 0.85));
    let hidden = SceneBox {
        size_m: DVec3::splat(1.0),
        ..a_box(2, Class::Pedestrian, DVec3::new(25.0, 8.0, 0.85))
    };
    scene.change(Default::default(), |frame| {
        frame.boxes = [car, hidden].map(|b| (b.id, b)).into();
        frame.layout = scene::BevLayout::default();
    });
    let pixel = picture(&scene, 0.0, &camera());
    // The middle of its back is 10 m ahead, 4 m to the left, .65 m below the camera: the colour of the back, a twentieth darker.
    let (u, v) = (640.0 - 640.0 * 4.0 / 10.0, 360.0 + 640.0 * 0.65 / 10.0);
    near(
        pixel(u as usize, v as usize),
        [126.0 * 0.95, 206.0 * 0.95, 255.0 * 0.95],
        "its back",
    );
    // Its right side, in the middle of its length: between both colours. The side is at y = 3.025 m.
    let (u, v) = (640.0 - 640.0 * 3.025 / 12.3, 360.0 + 640.0 * 0.65 / 12.3);
    let shade = 1.0 - 12.3 / 200.0;
    near(
        pixel(u as usize, v as usize),
        [63.0 * shade, 126.0 * shade, 195.5 * shade],
        "its side",
    );
    // The edge between both is grey, and nothing is seen of the one behind it.
    let (u, v) = (640.0 - 640.0 * 3.025 / 10.0, 360.0 + 640.0 * 0.65 / 10.0);
    near(pixel(u as usize, v as usize), [190.0; 3], "the edge");
    assert_eq!(pixel(1000, 400), [0; 3]);
    let reds = (0..1280)
        .flat_map(|u| (0..720).map(move |v| (u, v)))
        .filter(|(u, v)| {
            let [r, _, b] = pixel(*u, *v);
            r > 100 && b < 90
        });
    assert_eq!(reds.count(), 0, "the pedestrian is hidden");
}

#[test]
fn lines_and_crossings_are_where_they_are() {
    let scene = drive();
    let pixel = picture(&scene, 0.0, &camera());
    // A point of the ground in the vehicle's frame: ahead, left.
    let ground = |x: f64, y: f64| {
        pixel(
            (640.0 - 640.0 * y / x) as usize,
            (360.0 + 640.0 * 1.5 / x) as usize,
        )
    };
    let shade = |x: f64| 1.0 - x / 200.0;
    // The divider is 3.5 m to the left; in the near its two lines are seen apart.
    near(
        ground(8.0, 3.6),
        [255.0 * shade(8.0), 255.0 * shade(8.0), 0.0],
        "the divider",
    );
    near(
        ground(8.0, 3.4),
        [255.0 * shade(8.0), 255.0 * shade(8.0), 0.0],
        "the divider",
    );
    // The stop line is 20 m ahead, the crossing from 22 m on.
    near(
        ground(20.0, 0.5),
        [108.0 * shade(20.0), 179.0 * shade(20.0), 59.0 * shade(20.0)],
        "the stop line",
    );
    near(
        ground(23.5, -0.6),
        [139.0 * shade(23.5), 93.0 * shade(23.5), 255.0 * shade(23.5)],
        "the crossing",
    );
    // The side of the road, 4.5 m to the right.
    near(
        ground(8.0, -4.5),
        [253.0 * shade(8.0), 1.0, 232.0 * shade(8.0)],
        "the side of the road",
    );
    assert_eq!(ground(9.0, 1.5), [0; 3]);
    // One second later all is 10 m nearer.
    let pixel = picture(&scene, 1.0, &camera());
    let ground = |x: f64, y: f64| {
        pixel(
            (640.0 - 640.0 * y / x) as usize,
            (360.0 + 640.0 * 1.5 / x) as usize,
        )
    };
    near(
        ground(13.5, -0.6),
        [139.0 * shade(13.5), 93.0 * shade(13.5), 255.0 * shade(13.5)],
        "the crossing",
    );
}

#[test]
fn a_box_around_the_camera_is_not_drawn() {
    let mut scene = crate::table_tests::scene();
    let around = a_box(1, Class::Truck, DVec3::new(0.0, 0.0, 1.4));
    scene.change(Default::default(), |frame| {
        frame.boxes = [(around.id, around)].into();
        frame.layout = scene::BevLayout::default();
    });
    let pixel = picture(&scene, 0.0, &camera());
    let lit = |u: usize, v: usize| pixel(u, v) != [0; 3];
    assert!(
        !(0..1280)
            .step_by(7)
            .any(|u| (0..720).step_by(7).any(|v| lit(u, v)))
    );
}

#[test]
fn the_video_has_thirty_pictures_a_second_for_each_camera() {
    let mut scene = drive();
    scene.change_clip(|clip| clip.length_s = 0.2);
    let mut small = camera();
    (small.width, small.height, small.focal_px, small.center_px) = (200, 112, [100.0; 2], [100.0, 56.0]);
    let mut aside = small.clone();
    aside.name = "ASIDE".into();
    aside.set_aim(scene::rig::Aim {
        yaw_deg: 66.0,
        pitch_deg: 0.0,
        roll_deg: 0.0,
    });
    Arc::make_mut(&mut scene.rig).cameras = vec![small, aside];
    let write = || {
        let exporter = crate::export::from_id("control-video").expect("in the table");
        (exporter.write)(&scene, &mut Small).expect("sound")
    };
    let files = write();
    let names: Vec<&str> = files.iter().map(|f| f.name.as_str()).collect();
    // Those of the rig, and the five that readers look for besides.
    assert_eq!(
        (names.len(), &names[..2]),
        (
            7,
            &[
                "a_drive_.camera_front_wide_120fov.mp4",
                "a_drive_.camera_cross_left_120fov.mp4"
            ][..]
        )
    );
    let mut own = 0;
    assert_eq!(files, write(), "the same bytes");
    for file in files {
        let length = file.bytes.len() as u64;
        let movie = ::mp4::Mp4Reader::read_header(std::io::Cursor::new(file.bytes), length).expect("an MP4");
        let track = movie.tracks().values().next().expect("a track");
        assert_eq!((track.sample_count(), track.frame_rate().round()), (7, 30.0));
        own += usize::from((track.width(), track.height()) == (200, 112));
    }
    assert_eq!(own, 2, "sizes are those of the rig's cameras");
    Arc::make_mut(&mut scene.rig).cameras.clear();
    let exporter = crate::export::from_id("control-video").expect("in the table");
    let error = (exporter.write)(&scene, &mut Small).expect_err("no cameras");
    assert!(error.to_string().contains("no cameras"));
}
