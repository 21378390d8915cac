//! Tests made from the tables: what can be written and read comes back, and no bad file does harm.

use std::cell::RefCell;
use std::collections::{BTreeMap, BTreeSet};
use std::panic::catch_unwind;
use std::path::PathBuf;
use std::sync::{Arc, LazyLock};

use glam::{DVec2, DVec3};
use scene::message::LONGEST;
use scene::{
    Baking, BevLayer, BevLayout, BoxId, CameraMaps, CameraTruth, Class, Frame, GaussianScene, LidarSweep,
    Pose, Scene, SceneBox, SceneGaussian, SensorRig, TruthPixel, VoxelGrid,
};

use tempfile::TempDir;

use crate::export::{self, BoxVisibility, ExportPicture, Exporter, ObservationMasks, OutFile, Products};
use crate::import::{self, Content, ImportFile, Importer};
use crate::recipe::Recipe;
use crate::{FormatError, Holds, box_list, loom, occ3d, points_tests};

/// A small scene: a road, a car and its voxels, some paint.
pub(crate) fn scene() -> Scene {
    let mut layout = BevLayout::default();
    (0..200).for_each(|x| layout.set(BevLayer::DrivableArea, x, 100, true));
    let car = SceneBox {
        id: BoxId(4),
        class: Class::Car,
        center_m: DVec3::new(10.0 / 3.0, -3.25, 0.85),
        size_m: DVec3::new(4.6, 1.95, 1.7),
        yaw_rad: 0.1,
        velocity_mps: DVec2::new(3.0, -0.1),
        label: Default::default(),
    };
    let mut occupancy = VoxelGrid::new();
    (0..60).for_each(|i| occupancy.set(60 + i, 100 + i % 7, i % 16, (i % 17) as u8));
    let mut frame = Frame::new(layout, [(car.id, car)].into(), occupancy);
    frame.painted.set(3, 4, 5, Class::Manmade.id());
    frame.occupancy.set(3, 4, 5, Class::Manmade.id());
    let mut scene = Scene::single("small", frame, Arc::new(SensorRig::default()), 7);
    scene.prompt = "fog".into();
    scene
}

/// A scene of random voxels, boxes and layers, for round trips; the same for the same seed.
pub(crate) fn random_scene(seed: u64) -> Scene {
    let mut dice = Dice(seed.wrapping_mul(0x9e37_79b9_7f4a_7c15));
    let mut layout = BevLayout::default();
    let mut occupancy = VoxelGrid::new();
    for _ in 0..8 {
        let [x0, y0, w, l] = [200, 200, 60, 60].map(|n| dice.below(n));
        let layer = BevLayer::MAP[dice.below(BevLayer::MAP.len())];
        let label = 1 + dice.below(16) as u8;
        let z = dice.below(16);
        for (x, y) in (x0..(x0 + w).min(200)).flat_map(|x| (y0..(y0 + l).min(200)).map(move |y| (x, y))) {
            layout.set(layer, x, y, true);
            occupancy.set(x, y, z, label);
        }
    }
    for _ in 0..200 {
        let [x, y, z] = [200, 200, 16].map(|n| dice.below(n));
        occupancy.set(x, y, z, dice.below(17) as u8);
    }
    let mut number =
        |low: f64, high: f64| low + (high - low) * dice.below(1 << 20) as f64 / f64::from(1 << 20);
    let mut boxes = BTreeMap::new();
    for id in 1..=12 {
        let class = Class::OBJECTS[number(0.0, Class::OBJECTS.len() as f64) as usize];
        let b = SceneBox {
            id: BoxId(id),
            class,
            center_m: DVec3::new(number(-38.0, 38.0), number(-38.0, 38.0), number(0.2, 2.0)),
            size_m: DVec3::new(number(0.4, 12.0), number(0.3, 3.0), number(0.5, 4.0)),
            yaw_rad: number(-3.1, 3.1),
            velocity_mps: DVec2::new(number(-9.0, 9.0), number(-9.0, 9.0)),
            label: Default::default(),
        };
        boxes.insert(b.id, b);
    }
    let frame = Frame::new(layout, boxes, occupancy);
    Scene::single("random", frame, Arc::new(SensorRig::default()), seed)
}

/// A disc on the road and one on a car.
pub(crate) fn two_gaussians() -> GaussianScene {
    let road = SceneGaussian {
        position_m: [4.0, 1.5, -0.25],
        rotation_wxyz: [0.8, 0.0, 0.0, 0.6],
        std_m: [0.25, 0.125, 0.003],
        opacity: 0.95,
        color: [0.25, 0.5, 1.0],
        class: Class::DriveableSurface.id(),
        instance: 0,
        strength: 8.5,
    };
    let car = SceneGaussian {
        position_m: [9.0, -2.0, 1.25],
        rotation_wxyz: [0.5, 0.5, -0.1, 0.7],
        std_m: [0.5, 0.03, 0.06],
        opacity: 0.5,
        color: [-0.01, 0.75, 1.02],
        class: Class::Car.id(),
        instance: 4,
        strength: 28.0,
    };
    GaussianScene {
        gaussians: vec![road, car],
        baking: Baking {
            stands: 2,
            views: 12,
            size_px: [320, 180],
            samples: 100,
            most: 2,
            rounds: 3,
        },
    }
}

/// A return of a car straight ahead of a radar, of 10 dBsm, that moves away from it at a speed; the own vehicle stands.
pub(crate) fn radar_return(radar: &scene::RadarPattern, range_m: f64, speed_mps: f32) -> scene::RadarReturn {
    let at = radar.ego_from_sensor().apply(glam::DVec3::X * range_m);
    scene::RadarReturn {
        position_m: at.as_vec3().to_array(),
        range_m: range_m as f32,
        azimuth_rad: 0.0,
        elevation_rad: None,
        speed_mps,
        speed_over_ground_mps: speed_mps,
        rcs_dbsm: 10.0,
        snr_db: 20.0,
        class: Class::Car,
    }
}

/// Products of two cameras of four pixels and a sweep of one point. Observed are: by the LiDAR the lower half of the columns
/// ahead, by the cameras all but the lowest voxel of the columns to the left.
pub(crate) struct Small;

impl Products for Small {
    fn show(&mut self, _time_s: f64) -> Result<(), FormatError> {
        Ok(())
    }

    fn seen(&mut self) -> Result<BoxVisibility, FormatError> {
        Ok(BoxVisibility {
            lidar_returns: Some([(BoxId(4), 12)].into()),
            camera_pixels: None,
        })
    }

    fn observed(&mut self) -> Result<ObservationMasks, FormatError> {
        let words = |word: fn([usize; 2]) -> u16| ObservationMasks::EXTENT.all_columns().map(word).collect();
        Ok(ObservationMasks {
            lidar: words(|[x, _]| if x >= 100 { 0x00ff } else { 0 }),
            camera: words(|[_, y]| if y >= 100 { 0xfffe } else { 0 }),
        })
    }

    fn sweep(&mut self) -> Result<LidarSweep, FormatError> {
        let point = points_tests::point(DVec3::new(1.0, 2.0, 3.0), Class::Car);
        Ok(points_tests::sweep(vec![point]))
    }

    fn sweep_edits(&mut self, _: usize) -> Result<scene::SweepEdits, FormatError> {
        Ok(scene::SweepEdits::default())
    }

    fn radars(&mut self) -> Result<Vec<scene::RadarScan>, FormatError> {
        let rig = SensorRig::default();
        let scan = |radar: &scene::RadarPattern| scene::RadarScan {
            radar: radar.name.clone(),
            returns: vec![radar_return(radar, 15.0, 3.0)],
        };
        Ok(rig.radars.iter().map(scan).collect())
    }

    fn camera_maps(
        &mut self,
        take: &mut dyn FnMut(CameraMaps) -> Result<(), FormatError>,
    ) -> Result<(), FormatError> {
        let maps = |camera: &str| CameraMaps {
            camera: camera.into(),
            width: 2,
            height: 2,
            semantic: vec![0, 0, 4, 19],
            depth_m: vec![-1.0, 3.0, 1.5, 100.0],
            expected_m: vec![0.0; 4],
            median_m: vec![-1.0; 4],
            coverage: vec![0.0, 1.0, 1.0, 1.0],
        };
        take(maps("FRONT"))?;
        take(maps("../BACK"))
    }

    fn pictures(
        &mut self,
        take: &mut dyn FnMut(ExportPicture) -> Result<(), FormatError>,
    ) -> Result<(), FormatError> {
        take(self.view()?)
    }

    fn truth(
        &mut self,
        take: &mut dyn FnMut(ExportPicture, CameraTruth) -> Result<(), FormatError>,
    ) -> Result<(), FormatError> {
        let pixel = TruthPixel {
            class: Class::Car.id(),
            instance: 4,
            depth_m: 12.5,
            normal_in_camera: [0.0, 0.0, -1.0],
            flow_px: [0.5, f32::NAN],
        };
        let mut camera = SensorRig::default().cameras[1].resized(2, 1);
        camera.name = "FRONT".into();
        let truth = CameraTruth {
            camera,
            width: 2,
            height: 1,
            pixels: vec![pixel, TruthPixel::default()],
            flow_s: Some(0.1),
            boxes: Vec::new(),
        };
        let picture = ExportPicture {
            camera: "FRONT".into(),
            width: 2,
            height: 1,
            rgba: vec![255; 8],
        };
        take(picture, truth)
    }

    fn gaussians(&mut self) -> Result<GaussianScene, FormatError> {
        Ok(two_gaussians())
    }

    fn recipe(&self) -> &'static Recipe {
        static RECIPE: LazyLock<Recipe> = LazyLock::new(|| Recipe::of(&scene()));
        &RECIPE
    }

    fn world_from_ego(&self) -> Pose {
        Pose::from_wxyz([1.0, 0.0, 0.0, 0.0], [5.0, 0.0, 0.0])
    }

    fn view(&mut self) -> Result<ExportPicture, FormatError> {
        Ok(ExportPicture {
            camera: "FRONT".into(),
            width: 1,
            height: 1,
            rgba: vec![1, 2, 3, 255],
        })
    }
}

/// Reads bytes as a file of the format. A format of several files finds the others of its small scene beside it.
fn read(importer: &Importer, bytes: &[u8]) -> Result<Content, FormatError> {
    thread_local! {
        static FOLDERS: RefCell<BTreeMap<&'static str, (TempDir, PathBuf)>> = RefCell::default();
    }
    let path = importer.in_folder.map(|first| {
        FOLDERS.with_borrow_mut(|folders| {
            let (_, path) = folders.entry(importer.id).or_insert_with(|| {
                let exporter = export::from_id(importer.id).expect("it is written too");
                let files = (exporter.write)(&scene(), &mut Small).expect(exporter.id);
                let folder = in_folder(&files);
                let first = first(folder.path()).expect("the format knows its own folder");
                (folder, first)
            });
            path.clone()
        })
    });
    (importer.read)(&ImportFile {
        bytes,
        name: "small",
        path: path.as_deref(),
        options: Default::default(),
    })
}

/// A folder with these files.
pub(crate) fn in_folder(files: &[OutFile]) -> TempDir {
    let folder = tempfile::tempdir().expect("a folder");
    for file in files {
        let path = folder.path().join(&file.name);
        std::fs::create_dir_all(path.parent().expect("a folder")).expect("made");
        std::fs::write(path, &file.bytes).expect("written");
    }
    folder
}

fn exporters() -> impl Iterator<Item = &'static Exporter> {
    export::all().iter().copied().chain([&export::loom::EXPORTER])
}

/// Panics where `b` has not what the format says to hold of `a`.
fn assert_holds(holds: Holds, a: &Scene, b: &Scene) {
    let (of_a, of_b) = (a.frame(), b.frame());
    match holds {
        Holds::Scene => {
            assert_eq!(
                (&a.name, &a.prompt, &a.rig, &a.background, a.seed, a.time_s()),
                (&b.name, &b.prompt, &b.rig, &b.background, b.seed, b.time_s())
            );
            assert!(a.canvas() == b.canvas() && a.clip() == b.clip());
        }
        Holds::Occupancy => assert!(of_a.occupancy == of_b.occupancy),
        Holds::Boxes => assert_eq!(of_a.boxes, of_b.boxes),
        // Each format's own tests say what of these comes back.
        Holds::Roads | Holds::Points | Holds::Pictures => {}
    }
}

/// A scene written in a format and read again, if the format is read at all.
pub(crate) fn round_trip(exporter: &Exporter, scene: &Scene) -> Option<Content> {
    if exporter.needs == [export::Product::Recording] {
        return None;
    }
    let files = (exporter.write)(scene, &mut Small).expect(exporter.id);
    let names: BTreeSet<&str> = files.iter().map(|f| f.name.as_str()).collect();
    assert_eq!(names.len(), files.len(), "{}: a name twice", exporter.id);
    assert!(names.iter().all(|name| is_tidy(name)), "{names:?}");
    let importer = import::all().iter().find(|i| i.id == exporter.id)?;
    let folder = in_folder(&files);
    let first = match (importer.in_folder, files.as_slice()) {
        (Some(first), _) => first(folder.path()).expect("the format knows its own folder"),
        (None, [file]) => folder.path().join(&file.name),
        (None, files) => panic!("{}: {} files, expected one", exporter.id, files.len()),
    };
    Some(import::read_resampled(importer, &first).expect(exporter.id))
}

/// Panics where a format that loses nothing has not brought back what it holds.
fn assert_comes_back(exporter: &Exporter, scene: &Scene) -> bool {
    let Some(back) = round_trip(exporter, scene) else {
        return false;
    };
    let importer = import::all().iter().find(|i| i.id == exporter.id);
    let holds = importer.map_or(&[][..], |i| i.holds);
    if let Content::Scene(loaded) = back
        && exporter.lost.is_empty()
    {
        let both = holds.iter().filter(|what| exporter.holds.contains(what));
        both.for_each(|what| assert_holds(*what, scene, &loaded.scene));
    }
    true
}

#[test]
fn what_can_be_written_and_read_comes_back() {
    let scene = scene();
    let both: Vec<&str> = exporters()
        .filter(|e| assert_comes_back(e, &scene))
        .map(|e| e.id)
        .collect();
    println!("read and written: {both:?}");
    assert!(["occ3d", "boxes", "loom"].iter().all(|id| both.contains(id)));
}

/// Formats that lose something have a test of their own of what comes back.
#[test]
fn a_hundred_random_scenes_come_back() {
    let both = |e: &&'static Exporter| e.lost.is_empty() && import::all().iter().any(|i| i.id == e.id);
    for exporter in exporters().filter(both) {
        for seed in 0..100 {
            assert!(
                assert_comes_back(exporter, &random_scene(seed)),
                "{}",
                exporter.id
            );
        }
    }
}

/// True for a path of letters, digits and `-_.` that stays in its folder.
fn is_tidy(path: &str) -> bool {
    let tidy = |part: &str| {
        let letters = part.chars().all(|c| c.is_alphanumeric() || "-_.".contains(c));
        letters && !part.is_empty() && part != "." && part != ".."
    };
    path.split('/').all(tidy)
}

#[test]
fn every_line_of_the_tables_is_whole() {
    let mut ids = BTreeMap::new();
    for i in import::all() {
        assert_eq!(ids.insert(i.id, ()), None, "{} twice", i.id);
        assert!(
            !i.title.is_empty() && !i.holds.is_empty() && i.largest > 0,
            "{}",
            i.id
        );
        for e in i.extensions {
            assert!(!e.contains('.') && *e == e.to_lowercase(), "{e}");
            let claimed = import::all().iter().filter(|o| o.extensions.contains(e)).count();
            assert_eq!(claimed, 1, "{e}");
        }
        let sample = (i.sample)();
        assert!(
            (i.recognises)(&sample) || !i.extensions.is_empty(),
            "{} does not recognise its own sample and has no extension",
            i.id
        );
        let others = import::all()
            .iter()
            .filter(|o| o.id != i.id && (o.recognises)(&sample));
        assert_eq!(others.count(), 0, "the sample of {} is claimed by others", i.id);
        read(i, &sample).expect(i.id);
    }
    let mut ids = BTreeMap::new();
    for e in exporters() {
        assert_eq!(ids.insert(e.id, ()), None, "{} twice", e.id);
        assert!(!e.title.is_empty() && !e.holds.is_empty(), "{}", e.id);
    }
    assert!(
        import::in_words().contains("point clouds (.pcd)")
            && import::in_words().contains("nuScenes tables (a folder)"),
        "{}",
        import::in_words()
    );
    assert!(import::extensions().contains(&"xodr"));
}

/// A seeded stream of numbers, good enough to damage files with.
struct Dice(u64);

impl Dice {
    fn below(&mut self, n: usize) -> usize {
        self.0 = self
            .0
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 33) as usize % n
    }
}

/// One line about a bad file, or none if it is read; never a panic.
pub(crate) fn refusal(importer: &'static Importer, bytes: &[u8]) -> Option<String> {
    let outcome = catch_unwind(|| read(importer, bytes).map(drop));
    let line = outcome
        .unwrap_or_else(|_| panic!("{} panics", importer.id))
        .err()?
        .to_string();
    assert!(
        !line.is_empty() && !line.contains(char::is_control),
        "{}: {line:?}",
        importer.id
    );
    assert!(line.chars().count() <= LONGEST, "{}: {line}", importer.id);
    Some(line)
}

#[test]
fn empty_truncated_and_random_files_are_one_line() {
    for importer in import::all() {
        let sample = (importer.sample)();
        refusal(importer, b"").expect("an empty file is refused");
        for part in [1, 2, 5, 9] {
            let cut = sample.len() * part / 10;
            assert!(
                refusal(importer, &sample[..cut]).is_some(),
                "{} cut at {cut}",
                importer.id
            );
        }
        let mut dice = Dice(26);
        for length in [1, 40, 4000, 100_000] {
            let noise: Vec<u8> = (0..length).map(|_| dice.below(256) as u8).collect();
            refusal(importer, &noise).expect("noise is refused");
        }
        for _ in 0..60 {
            let mut damaged = sample.clone();
            for _ in 0..=dice.below(4) {
                let at = dice.below(damaged.len());
                damaged[at] = dice.below(256) as u8;
            }
            refusal(importer, &damaged);
        }
    }
}

/// Files that promise more than they hold, or quote a megabyte: for each format what would hurt it most.
#[test]
fn huge_claims_and_long_names_are_one_line() {
    let of = |id: &str| {
        import::all()
            .iter()
            .find(|i| i.id == id)
            .copied()
            .expect("a format")
    };
    let long = "x".repeat(1 << 20);
    let replaced = |id: &str, from: &str, to: &str| {
        let text = String::from_utf8((of(id).sample)()).expect("text");
        assert!(text.contains(from), "{from}");
        text.replacen(from, to, 1).into_bytes()
    };
    let zipped = |name: &str, bytes: &[u8]| {
        let mut zip = zip::ZipWriter::new(std::io::Cursor::new(Vec::new()));
        zip.start_file(name, zip::write::SimpleFileOptions::default())
            .expect("memory");
        std::io::Write::write_all(&mut zip, bytes).expect("memory");
        zip.finish().expect("memory").into_inner()
    };
    let npy = |shape: &str| {
        let header = format!("{{'descr': '|u1', 'fortran_order': False, 'shape': {shape}, }}\n");
        let mut npy = b"\x93NUMPY\x01\x00".to_vec();
        npy.extend((header.len() as u16).to_le_bytes());
        npy.extend(header.as_bytes());
        npy
    };
    let cases = [
        ("pcd", replaced("pcd", "POINTS 5", "POINTS 18446744073709551615")),
        (
            "pcd",
            replaced("pcd", "FIELDS x y z intensity", &format!("FIELDS x y z {long}")),
        ),
        (
            "pcd",
            replaced("pcd", "10.1 -3.1 0.1", &format!("10.1 {long} 0.1")),
        ),
        ("boxes", replaced("boxes", "\"car\"", &format!("{long:?}"))),
        ("boxes", replaced("boxes", "sceneloom_boxes", &long)),
        (
            "opendrive",
            replaced("opendrive", "length=\"300\"", &format!("length=\"{long}\"")),
        ),
        (
            "opendrive",
            replaced("opendrive", "<line/>", &format!("<{long}/>")),
        ),
        (
            "occ3d",
            zipped("semantics.npy", &npy("(99999999999, 99999999999, 9)")),
        ),
        (
            "occ3d",
            zipped("semantics.npy", &npy(&format!("(1, '{}')", "x".repeat(3000)))),
        ),
        ("occ3d", zipped(&format!("{}.npy", &long[..60_000]), b"")),
        (
            "loom",
            zipped(
                "manifest.json",
                format!("{{\"format\":{long:?},\"version\":1}}").as_bytes(),
            ),
        ),
        (
            "loom",
            zipped(
                "manifest.json",
                format!("{{\"format\":\"sceneloom\",\"version\":1,{long:?}:1}}").as_bytes(),
            ),
        ),
        (
            "loom",
            zipped(
                "manifest.json",
                br#"{"format":"sceneloom","version":18446744073709551615,"frames":0}"#,
            ),
        ),
    ];
    for (id, bytes) in cases {
        refusal(of(id), &bytes).unwrap_or_else(|| panic!("{id}: read, expected a refusal"));
    }
    // A zip with a foreign entry of a long name beside all that belongs to it.
    let mut zip = zip::ZipWriter::new_append(std::io::Cursor::new((of("loom").sample)())).expect("ours");
    zip.start_file(&long[..60_000], zip::write::SimpleFileOptions::default())
        .expect("memory");
    let foreign = zip.finish().expect("memory").into_inner();
    let line = refusal(of("loom"), &foreign).expect("an unknown entry");
    assert!(
        line.starts_with("entry \"xxx") && line.ends_with("is not known"),
        "{line}"
    );
}

/// The readers that other code calls directly keep to one line, too.
#[test]
fn typed_errors_are_as_short() {
    let long = "x".repeat(1 << 20);
    let boxes = format!("{{\"format\":{long:?},\"version\":1}}");
    let lines = [
        box_list::read(boxes.as_bytes()).expect_err("cut off"),
        loom::from_bytes(long.as_bytes()).expect_err("no zip").to_string(),
        occ3d::read(long.as_bytes()).expect_err("no zip").to_string(),
    ];
    for line in lines {
        assert!(line.chars().count() <= LONGEST && !line.contains('\n'), "{line}");
    }
}
