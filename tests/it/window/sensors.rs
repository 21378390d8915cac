//! The camera strip, the sensors' window and the LiDAR's choices.

use app::camera_views::CameraPicture;
use app::camera_views::LidarModel;
use editor::Edit;
use egui::{Key, Modifiers};
use egui_kittest::kittest::Queryable;
use scene::SensorRig;
use sensors::cameras::{self, ViewId, layout, learned, normals, perceived, pictures, planes};

use super::bench::Bench;

impl Bench {
    fn rig(&mut self) -> SensorRig {
        SensorRig::clone(&self.app().document.scene().rig)
    }

    fn sensed(&mut self) {
        self.steps(2);
        self.wait_until("sensors", |b| b.app().sensors_are_current());
        self.steps(2);
    }
}

#[test]
fn the_strip_shows_what_is_asked_for() {
    let mut bench = Bench::new();
    bench.off();
    bench.sensed();
    // Learned pictures are offered by the settings alone.
    assert!(bench.harness.query_by_label(learned::VIEW.title).is_none());
    bench.app().preferences.settings.learned_pictures = true;
    bench.steps(2);
    // The last one is what it shows at first.
    for view in cameras::views().into_iter().rev() {
        let name = view.title;
        bench.click(name);
        assert_eq!(bench.app().state.cameras.view, view.id);
        bench.sensed();
        let views = bench.app().sensing().cameras().expect("pictures").clone();
        assert_eq!(views.len(), 6);
        let fits = |p: &CameraPicture| match p {
            CameraPicture::Maps(_) => [ViewId::SEMANTIC, ViewId::DEPTH].contains(&view.id),
            CameraPicture::Planes(_) => view.id == planes::VIEW.id,
            CameraPicture::Layout(_) => view.id == layout::VIEW.id,
            CameraPicture::Picture(_) => {
                let all = [&pictures::VIEW, &normals::VIEW, &learned::VIEW, &perceived::VIEW];
                all.iter().any(|v| v.id == view.id)
            }
        };
        assert!(views.iter().all(|v| fits(&v.picture)), "{name}");
    }
    // Hovering a picture tells what is behind the pixel.
    let front = bench.harness.get_by_label("Camera Front").rect();
    bench
        .harness
        .hover_at(front.center_bottom() - egui::vec2(0.0, 4.0));
    bench.steps(3);
    let readout = bench.app().state.pointed.readout.clone();
    assert!(
        readout.starts_with("Front  ·  driveable surface  ·  ") && readout.contains(" m away"),
        "{readout}"
    );
    // The learned sweep measures within voxels and knows how strong echoes are.
    bench.app().state.lidar.model = LidarModel::Learned;
    bench.sensed();
    bench.wait_until("the learned sweep", |b| {
        let sweep = b.app().sensing().lidar().expect("a sweep").clone();
        sweep.points.iter().any(|p| p.intensity > 0.0)
    });
}

#[test]
fn sensors_are_added_changed_and_removed_with_undo() {
    let mut bench = Bench::new();
    bench.off();
    bench.click("Sensors…");
    let before = bench.rig();
    bench.click("Camera CAM_BACK");
    bench.click("Remove sensor");
    assert_eq!(bench.rig().cameras.len(), 5);
    assert!(bench.rig().cameras.iter().all(|c| c.name != "CAM_BACK"));
    bench.key(Modifiers::CTRL, Key::Z);
    assert_eq!(bench.rig(), before);
    bench.click("Add camera");
    assert_eq!(bench.rig().cameras.len(), 7);
    assert_eq!(bench.history(), ["Open", "Add camera"]);
    bench.sensed();
    assert_eq!(bench.app().sensing().cameras().map(|c| c.len()), Some(7));
    bench.click("Show CAM_FRONT");
    bench.sensed();
    assert_eq!(bench.app().sensing().cameras().map(|c| c.len()), Some(6));
    // A number is dragged: the sensor moves while it is, and that is one step.
    bench.click("Camera CAM_1");
    let yaw = bench.harness.get_by_label("Yaw").rect().center();
    bench.drag(&[yaw, yaw + egui::vec2(60.0, 0.0)], Modifiers::NONE);
    let turned = bench.rig().cameras[6].aim();
    assert!(
        turned.yaw_deg > 1.0 && turned.pitch_deg.abs() < 1e-6,
        "{turned:?}"
    );
    assert_eq!(bench.history(), ["Open", "Add camera", "Aim sensor"]);
    // Another LiDAR, chosen by its pattern.
    bench.click("Add LiDAR");
    bench.click("VLP-16");
    assert_eq!(bench.rig().lidars.len(), 2);
    bench.click("Show this one");
    assert_eq!(bench.rig().lidars[0].elevations_deg.len(), 16);
    bench.sensed();
    let rays = bench.app().sensing().lidar().map(|l| l.rays);
    assert_eq!(rays, Some(16 * 1800));
    // A rig that is not sound changes nothing.
    let now = bench.rig();
    let mut bad = now.clone();
    bad.cameras[0].focal_px[0] = f64::NAN;
    let edit = Edit::SetRig { rig: Box::new(bad) };
    assert!(bench.app().document.apply("Bad", &edit).is_err());
    assert_eq!(bench.rig(), now);
}

#[test]
fn sensors_go_out_to_a_file_and_come_back() {
    let mut bench = Bench::new();
    bench.off();
    let path = bench.folder.path().join("rig.json");
    bench.click("Sensors…");
    let before = bench.rig();
    bench.click("Export…");
    bench.give_path(&path, "Export file");
    bench.click("Camera CAM_FRONT");
    bench.click("Remove sensor");
    assert_ne!(bench.rig(), before);
    assert_eq!(app::open::rig(&path).expect("a rig"), before);
    bench.click("Import…");
    bench.give_path(&path, "Import file");
    assert_eq!(bench.rig(), before);
    std::fs::write(&path, "{\"name\": 3}").expect("written");
    bench.click("Import…");
    bench.give_path(&path, "Import file");
    assert_eq!(bench.rig(), before, "a bad file changes nothing");
}
