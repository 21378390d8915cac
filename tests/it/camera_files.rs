//! `sceneloom render` and the table of camera sources: what it offers, what it checks before it writes, what it costs.

use std::path::Path;

use scene::SensorRig;
use sensors::cameras::{self, normals};

use crate::cli::{Folder, json, refused, sceneloom};

fn rig(dir: &Folder, name: &str, change: impl FnOnce(&mut SensorRig)) -> String {
    let mut rig = SensorRig::default();
    change(&mut rig);
    dir.write(name, serde_json::to_string(&rig).expect("a rig is JSON"))
}

#[test]
fn the_help_names_every_view_and_source() {
    let output = sceneloom(&["render", "--help"]);
    let help = String::from_utf8_lossy(&output.stdout);
    // Lines are broken anywhere.
    let help: Vec<&str> = help.split_whitespace().collect();
    let help = help.join(" ");
    let names: Vec<&str> = cameras::views().iter().map(|v| v.id.name()).collect();
    assert!(help.contains(&names.join(", ")), "{help}");
    for source in cameras::sources_of(cameras::ViewId::SEMANTIC) {
        assert!(help.contains(source.id().name()), "{}", source.id().name());
    }
}

#[test]
fn normal_maps_are_written_beside_other_pictures() {
    let dir = Folder::new();
    let (scene, out) = (dir.scene(), dir.path("out"));
    let report = json(&sceneloom(&[
        "render", &scene, "--what", "normals", "--size", "96x54", "-o", &out, "--json",
    ]));
    // One for each camera, a sheet of all, and the calibration.
    assert_eq!(report["files"].as_array().map(Vec::len), Some(6 + 1 + 1));
    assert!(report["wall_s"]["normals"].is_number());
    let front = image::open(Path::new(&out).join("CAM_FRONT_normals.png"))
        .expect("a picture")
        .to_rgb8();
    assert_eq!(front.dimensions(), (96, 54));
    // Sky above, and below the road, which points up.
    assert_eq!(front.get_pixel(48, 1).0, normals::SKY);
    let [r, g, b] = front.get_pixel(48, 50).0;
    assert!(
        g > 240 && r.abs_diff(128) < 12 && b.abs_diff(128) < 16,
        "{r} {g} {b}"
    );
    let sheet = image::open(Path::new(&out).join("normals.png"))
        .expect("a sheet")
        .to_rgb8();
    assert_eq!(sheet.dimensions(), (3 * (96 + 6) + 6, 2 * (54 + 6) + 6));
}

#[test]
fn everything_that_needs_no_card_is_written_at_once() {
    let dir = Folder::new();
    let (scene, out) = (dir.scene(), dir.path("out"));
    let what = "semantic,depth,appearance,perceived,mpi,perspective,normals,truth,lidar,bev";
    let render = |what: &str| {
        let words = [
            "render", &scene, "--what", what, "--size", "48x27", "-o", &out, "--json",
        ];
        let report = json(&sceneloom(&words));
        let files = report["files"].as_array().expect("files").clone();
        let names: std::collections::BTreeSet<String> = files
            .iter()
            .filter_map(|f| f.as_str())
            .map(str::to_lowercase)
            .collect();
        assert_eq!(names.len(), files.len(), "two files of one name: {names:?}");
    };
    // Depths of rays and those of the truth are not the same: before, the second one was refused for its name.
    render(what);
    let at = |name: &str| std::fs::read(Path::new(&out).join(name)).unwrap_or_else(|e| panic!("{name}: {e}"));
    let [rays, truth] = ["CAM_FRONT_depth_mm.png", "truth/CAM_FRONT_depth_mm.png"].map(at);
    assert_ne!(rays, truth);
    at("truth/truth.json");
    assert!(!Path::new(&out).join("truth.json").exists());
    // Alone, the truth needs no folder of its own.
    render("truth");
    assert_eq!(at("CAM_FRONT_depth_mm.png"), truth);
}

#[test]
fn what_cannot_be_had_is_told_before_anything_is_written() {
    let dir = Folder::new();
    let (scene, out) = (dir.scene(), dir.path("out"));
    let blind = rig(&dir, "no_lidar.json", |r| r.lidars.clear());
    let dark = rig(&dir, "no_camera.json", |r| r.cameras.clear());
    let render = |more: &[&str], needles: &[&str]| {
        refused(&[&["render", &scene, "-o", &out], more].concat(), needles);
        assert!(!Path::new(&out).exists(), "{more:?}");
    };
    render(&["--what", "semantic,bev,lidar", "--rig", &blind], &["no lidar"]);
    render(&["--what", "bev,normals", "--rig", &dark], &["no camera"]);
    for view in cameras::views() {
        let what = format!("bev,{}", view.id.name());
        render(
            &["--what", &what, "--size", "8192x8192"],
            &["67108864 pixels", "33554432"],
        );
    }
    // A picture fits, a sheet of more than a hundred does not.
    let many = rig(&dir, "many.json", |r| {
        let one = r.cameras[0].clone();
        r.cameras = (0..60)
            .map(|i| scene::Camera {
                name: format!("C{i}"),
                ..one.clone()
            })
            .collect();
    });
    render(
        &["--what", "normals", "--size", "7680x4320", "--rig", &many],
        &["7680x4320", "MB, expected at most"],
    );
    let shot = dir.path("shot.png");
    refused(
        &["shot", &scene, "--size", "8192x8192", "-o", &shot],
        &["67108864 pixels"],
    );
    let export = |format: &str| {
        refused(
            &[
                "export",
                &scene,
                "--format",
                format,
                "--size",
                "8192x8192",
                "-o",
                &out,
            ],
            &["67108864 pixels"],
        );
        assert!(!Path::new(&out).exists());
    };
    ["semantic", "depth", "pictures"].into_iter().for_each(export);
}

/// What one picture takes, rendered and written, is no more than its source says: the peak of a run with large pictures
/// beyond that of one with small ones.
#[test]
fn a_run_takes_the_memory_that_its_source_states() {
    const SIZE: [u32; 2] = [1280, 720];
    let dir = Folder::new();
    let (scene, out) = (dir.scene(), dir.path("out"));
    let one = rig(&dir, "one.json", |r| r.cameras.truncate(1));
    let six = rig(&dir, "six.json", |r| assert_eq!(r.cameras.len(), 6));
    let pixels = f64::from(SIZE[0] * SIZE[1]);
    let per_pixel = |mb: f64| mb * f64::from(1 << 20) / pixels;
    let mut rig_is_measured = false;
    for view in cameras::views() {
        for source in cameras::sources_of(view.id) {
            let peak_mb = |size: &str, rig: &str| {
                let mut args = vec!["render", &scene, "--what", view.id.name(), "--preview", "--json"];
                args.extend(["--size", size, "--rig", rig, "-o", &out]);
                if cameras::sources_of(view.id).len() > 1 {
                    args.extend(["--source", source.id().name()]);
                }
                json(&sceneloom(&args))["peak_rss_mb"].as_f64()
            };
            let large = format!("{}x{}", SIZE[0], SIZE[1]);
            let (Some(small), Some(single)) = (peak_mb("64x36", &one), peak_mb(&large, &one)) else {
                return println!("this system does not tell a process's peak memory");
            };
            let taken = per_pixel(single - small);
            let stated = source.about().bytes_per_pixel as f64;
            println!(
                "{} from {}: {taken:.0} bytes a pixel of {stated}",
                view.title,
                source.about().title
            );
            // The sheet of pictures in colours has one camera here.
            assert!(
                taken <= stated + 8.0,
                "{}: {taken} of {stated}",
                source.about().title
            );
            // The command goes through the cameras in one way for all sources.
            if !std::mem::replace(&mut rig_is_measured, true) {
                let more = peak_mb(&large, &six).map_or(f64::INFINITY, |all| per_pixel(all - single));
                println!("{more:.0} bytes a pixel more for five other cameras");
                // A camera keeps its place in the sheet, 4 bytes a pixel, and what the allocator does not give back; all
                // maps of five cameras would be 85.
                assert!(more <= 60.0, "{more} for five cameras");
            }
        }
    }
}
