//! Views, layers and the 3D view.

use app::panes::id::PaneId;
use editor::tools::{VoxelVerb, voxel};
use egui::{Key, Modifiers};
use egui_kittest::kittest::Queryable;
use formats::loom;
use image::GenericImageView;
use scene::{BevLayer, BoxId, BoxLabel, Class, Edit, Paint};

use super::bench::{Bench, car};

#[test]
fn views_and_layers_answer_their_controls() {
    let mut bench = Bench::new();
    bench.off();
    assert!(bench.harness.query_by_label("No GPU adapter").is_some());
    bench.click("Show walkway");
    assert!(!bench.app().state.shows(BevLayer::Walkway));
    let bev = bench.pane("Bird's-eye view");
    bench.key(Modifiers::CTRL, Key::Tab);
    let swapped = bench.pane("Bird's-eye view");
    assert!(swapped.left() > bev.left() + 100.0, "{bev:?} {swapped:?}");
    bench.key(Modifiers::CTRL, Key::Tab);
    bench.key(Modifiers::NONE, Key::G);
    assert!(!bench.app().state.shown.grid);
    // The wheel keeps the point under the pointer where it is.
    let at = bench.bev(10.0, -5.0);
    bench.harness.hover_at(at);
    bench.harness.event(egui::Event::MouseWheel {
        unit: egui::MouseWheelUnit::Point,
        delta: egui::vec2(0.0, 120.0),
        phase: egui::TouchPhase::Move,
        source: egui::MouseWheelSource::Wheel,
        modifiers: Modifiers::NONE,
    });
    bench.steps(30);
    assert!(bench.bev(10.0, -5.0).distance(at) < 0.5);
    assert!(bench.bev(20.0, -5.0).distance(at) > 70.0, "closer than before");
    bench.key(Modifiers::NONE, Key::CloseBracket);
    assert!(bench.app().state.brush_m > 3.2);
    bench.click("Depth");
    bench.wait_until("sensors", |b| b.app().sensors_are_current());
    bench.click("Camera Front");
    assert!(bench.harness.query_by_label("Look through in 3D").is_some());
    bench.key(Modifiers::NONE, Key::Escape);
    assert!(bench.harness.query_by_label("Look through in 3D").is_none());
    bench.key(Modifiers::NONE, Key::Questionmark);
    assert!(bench.harness.query_by_label("Ctrl+Backspace").is_some());
}

#[test]
fn voxels_are_painted_and_shot_in_the_3d_view() {
    let mut bench = Bench::with(true);
    bench.off();
    let pane = bench.pane("3D view");
    bench.harness.hover_at(pane.center());
    bench.steps(2);
    assert_eq!(bench.app().state.pointed.pane, Some(PaneId::VIEW3D));
    bench.key(Modifiers::NONE, Key::B);
    assert_eq!(
        (bench.app().state.tool, bench.app().state.verb),
        (voxel::ID, VoxelVerb::Attach)
    );
    let before = bench.frame();
    let middle = pane.center() + egui::vec2(0.0, 60.0);
    bench.drag(&[middle, middle + egui::vec2(60.0, 0.0)], Modifiers::NONE);
    let after = bench.frame();
    let new: Vec<_> = after.painted.iter_set().collect();
    assert!(new.len() > 3, "{} voxels", new.len());
    assert!(new.iter().all(|(x, y, z, class)| {
        *class == Class::Manmade.id()
            && before.occupancy.get(*x, *y, *z) == Class::FREE
            && after.occupancy.get(*x, *y, *z) == *class
    }));
    assert_eq!(bench.history(), ["Open", "Attach voxels"]);
    bench.key(Modifiers::NONE, Key::R);
    bench.drag(&[middle], Modifiers::NONE);
    assert_eq!(bench.history(), ["Open", "Attach voxels", "Remove voxels"]);
    bench.key(Modifiers::CTRL, Key::Z);
    assert_eq!(bench.frame(), after);
    // Ctrl and the wheel change the brush in hand, not the viewpoint; without a brush they zoom.
    let turned = |bench: &mut Bench| {
        bench.harness.hover_at(middle);
        let modifiers = Modifiers::COMMAND;
        let wheel = egui::Event::MouseWheel {
            unit: egui::MouseWheelUnit::Point,
            delta: egui::vec2(0.0, 100.0),
            phase: egui::TouchPhase::Move,
            source: egui::MouseWheelSource::Wheel,
            modifiers,
        };
        bench.harness.event_modifiers(wheel, modifiers);
        bench.steps(30);
        let camera = bench.app().views.view3d.camera;
        (bench.app().state.voxel_size, camera)
    };
    let camera = bench.app().views.view3d.camera;
    let (size, now) = turned(&mut bench);
    assert!(size > 1 && now == camera, "{size}");
    bench.key(Modifiers::NONE, Key::V);
    let (same, now) = turned(&mut bench);
    assert!(same == size && now != camera, "{same}");
    // A click chooses the car where it is seen.
    bench.key(Modifiers::NONE, Key::V);
    bench.key(Modifiers::NONE, Key::Num7);
    let view = &bench.harness.state().views.view3d;
    let size = [view.rect.width() as u32, view.rect.height() as u32];
    let at = view.camera.project(car().center_m, size).expect("in view");
    let at = view.rect.min + egui::vec2(at.x as f32, at.y as f32);
    bench.drag(&[at], Modifiers::NONE);
    assert_eq!(bench.app().state.selected, Some(BoxId(7)));
    // The window's own picture is no blank frame.
    bench.wait_until("sensors", |b| b.app().sensors_are_current());
    bench.steps(20);
    let picture = bench.harness.render().expect("drawn");
    let pane = picture
        .view(pane.left() as u32, pane.top() as u32, 300, 300)
        .to_image();
    let colors: std::collections::HashSet<_> = pane.pixels().copied().collect();
    assert!(colors.len() > 100, "{} colours", colors.len());
    let path = bench.folder.path().join("scene.loom");
    loom::save(&path, bench.app().document.scene()).expect("saved");
    bench.app().document.mark_saved();
    bench.app().execute(
        app::Command::File(app::command::FileCommand::OpenPath(path.clone())),
        &egui::Context::default(),
    );
    bench.wait_until("the scene", |b| b.app().path().is_some());
    bench.key(Modifiers::NONE, Key::F12);
    let picture = path.with_extension("png");
    let back = app::scene_of(&picture).expect("its scene is inside");
    assert_eq!(back.frame().boxes, bench.frame().boxes);
    let shot = image::open(picture).expect("a picture").to_rgba8();
    let colors: std::collections::HashSet<_> = shot.pixels().copied().collect();
    assert!(colors.len() > 100, "{} colours", colors.len());
}

/// As a picture the 3D view shows the same from the same place: what is clicked there is chosen, and edits show.
#[test]
fn the_3d_view_is_shown_as_a_picture() {
    let mut bench = Bench::with(true);
    bench.off();
    let paint = Edit::LabelBox {
        id: car().id,
        label: BoxLabel {
            paint: Some(Paint::Red),
            ..BoxLabel::default()
        },
    };
    bench.app().document.apply("Paint", &paint).expect("painted");
    let pane = bench.pane("3D view");
    bench.harness.hover_at(pane.center());
    bench.steps(4);
    assert!(bench.app().views.view3d.picture().is_none());
    bench.key(Modifiers::NONE, Key::Num8);
    let whole = |bench: &mut Bench| {
        let wide = bench.app().views.view3d.rect.width() as usize;
        bench.wait_until("the whole picture", |b| {
            b.app()
                .views
                .view3d
                .picture()
                .is_some_and(|image| image.width + 1 >= wide)
        });
        bench.app().views.view3d.picture().expect("a picture").clone()
    };
    let image = whole(&mut bench);
    // The boxes stand as much lower in the view as the ground of the voxels lies.
    let roof_m = car().center_m - glam::DVec3::new(0.3, 0.0, 0.6 - 0.8);
    let size = [image.width as u32, image.height as u32];
    let pixel = bench
        .app()
        .views
        .view3d
        .camera
        .project(roof_m, size)
        .expect("in view");
    let at = (pixel.y as usize * image.width + pixel.x as usize) * 4;
    let [r, g, b] = [0, 1, 2].map(|k| f32::from(image.rgba[at + k]));
    assert!(r > 1.4 * g && r > 1.4 * b, "{r} {g} {b} at {pixel}");
    let share = egui::vec2(pixel.x as f32 / size[0] as f32, pixel.y as f32 / size[1] as f32);
    let rect = bench.app().views.view3d.rect;
    bench.drag(&[rect.min + share * rect.size()], Modifiers::NONE);
    assert_eq!(bench.app().state.selected, Some(car().id));
    let gone = Edit::RemoveBox { id: car().id };
    bench.app().document.apply("Delete", &gone).expect("gone");
    bench.steps(2);
    bench.wait_until("a picture without the car", |b| {
        b.app()
            .views
            .view3d
            .picture()
            .is_some_and(|now| now.width < image.width)
    });
    let without = whole(&mut bench);
    assert!(without.width == image.width && without.rgba[at] < image.rgba[at]);
}
