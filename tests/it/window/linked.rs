//! Panes that point at one place: what is chosen and pointed at in one is shown in the others.

use app::command::{Command, TimeCommand, ViewCommand};
use app::panes::id::PaneId;
use app::tools::ToolCommand;
use egui::{Key, Modifiers, Pos2, Rect};
use egui_kittest::kittest::Queryable;
use glam::DVec2;
use scene::BoxId;

use super::bench::{Bench, car};

fn show(bench: &mut Bench, pane: PaneId) {
    let ctx = bench.harness.ctx.clone();
    bench
        .app()
        .execute(Command::View(ViewCommand::ShowPane(pane)), &ctx);
    bench.steps(4);
}

/// A place of the sweep where the car is said to be.
fn on_the_car(bench: &mut Bench, pane: Rect) -> Pos2 {
    let azimuth = (car().center_m.y).atan2(car().center_m.x).to_degrees() as f32;
    let x = pane.left() + pane.width() * (180.0 - azimuth) / 360.0;
    for part in 1..60 {
        let at = egui::pos2(x, pane.top() + pane.height() * part as f32 / 60.0);
        bench.harness.hover_at(at);
        bench.steps(1);
        if bench.app().state.pointed.readout.contains("#7") {
            return at;
        }
    }
    panic!("no beam returns from the car");
}

#[test]
fn a_click_on_returns_chooses_their_box_and_the_place_is_marked_elsewhere() {
    let mut bench = Bench::new();
    bench.off();
    show(&mut bench, PaneId::LIDAR);
    bench.wait_until("sensors", |b| b.app().sensors_are_current());
    bench.steps(2);
    let pane = bench.pane("LiDAR sweep");
    let at = on_the_car(&mut bench, pane);
    bench.steps(2);
    let (by, place_m) = bench.app().state.pointed.place.expect("a place");
    assert_eq!(by, PaneId::LIDAR);
    assert!(car().contains(place_m, 0.3), "{place_m}");
    bench.drag(&[at], Modifiers::NONE);
    assert_eq!(bench.app().state.selected, Some(BoxId(7)));
    // Another click with Shift lets it go, and one beside any box chooses nothing.
    bench.steps(30);
    bench.drag(&[at], Modifiers::SHIFT);
    assert!(!bench.app().state.any_chosen());
    // The map tells its place too, and nothing is pointed at outside of the panes.
    let over = bench.bev(-10.0, 4.0);
    bench.harness.hover_at(over);
    bench.steps(3);
    let (by, place_m) = bench.app().state.pointed.place.expect("a place");
    assert_eq!(by, PaneId::BEV);
    assert!(
        place_m.truncate().distance(DVec2::new(-10.0, 4.0)) < 0.2,
        "{place_m}"
    );
    bench.harness.hover_at(egui::pos2(700.0, 5.0));
    bench.steps(3);
    assert_eq!(bench.app().state.pointed.place, None);
}

#[test]
fn an_orthographic_view_stays_so_when_it_is_turned() {
    let mut bench = Bench::with(true);
    bench.off();
    let pane = bench.pane("3D view");
    bench.harness.hover_at(pane.center());
    bench.steps(2);
    let turn = |bench: &mut Bench| {
        let before = bench.app().views.view3d.camera;
        let way = [pane.center(), pane.center() + egui::vec2(80.0, 30.0)];
        bench.drag(&way, Modifiers::ALT);
        let after = bench.app().views.view3d.camera;
        assert!(
            (after.yaw_rad - before.yaw_rad).abs() > 0.1,
            "{before:?} {after:?}"
        );
        after.ortho
    };
    let looks_from = bench.app().views.view3d.camera.eye_m();
    bench.key(Modifiers::NONE, Key::Num9);
    assert!(bench.app().views.view3d.camera.ortho);
    assert_eq!(bench.app().views.view3d.camera.eye_m(), looks_from);
    assert!(turn(&mut bench));
    bench.key(Modifiers::NONE, Key::Num9);
    assert!(!turn(&mut bench));
    // One of the five fixed ones becomes perspective.
    bench.key(Modifiers::NONE, Key::Num7);
    assert!(bench.app().views.view3d.camera.ortho);
    assert!(!turn(&mut bench));
}

/// What sensors show is where the vehicle is, also after it has driven on.
#[test]
fn places_in_cameras_and_sweep_go_along_with_the_vehicle() {
    let mut bench = Bench::new();
    bench.off();
    bench.click("Clip");
    bench.click("Motion of the ego vehicle…");
    bench.click("Drive along the lane");
    let drive = |bench: &mut Bench, time_s: f64| {
        let ctx = bench.harness.ctx.clone();
        bench
            .app()
            .execute(Command::Time(TimeCommand::Show(time_s)), &ctx);
        bench.steps(4);
        bench.wait_until("sensors", |b| b.app().sensors_are_current());
        bench.steps(2);
    };
    // Low in the middle of the front camera is the road, some metres ahead.
    let ahead = |bench: &mut Bench| {
        let front = bench.harness.get_by_label("Camera Front").rect();
        let at = egui::pos2(front.center().x, front.bottom() - front.height() * 0.2);
        bench.harness.hover_at(at);
        bench.steps(3);
        let (by, place_m) = bench.app().state.pointed.place.expect("a place");
        assert_eq!(by, PaneId::CAMERAS);
        let pose = bench.frame().world_from_ego;
        (pose.inverse().apply(place_m), pose.translation_m)
    };
    let (first_m, _) = ahead(&mut bench);
    drive(&mut bench, 1.0);
    let (later_m, driven_m) = ahead(&mut bench);
    assert!(driven_m.length() > 3.0, "{driven_m}");
    assert!(first_m.distance(later_m) < 1.0, "{first_m} {later_m}");
}

/// Who held Ctrl to take out still holds it when Enter closes the outline: nothing is generated.
#[test]
fn enter_closes_an_outline_whatever_is_held() {
    let mut bench = Bench::new();
    bench.off();
    let ctx = bench.harness.ctx.clone();
    let all = Command::Tools(ToolCommand::ChooseAll);
    bench.app().execute(all, &ctx);
    let polygon = Command::Tools(ToolCommand::Shortcut("polygon_select"));
    bench.app().execute(polygon, &ctx);
    bench.steps(2);
    for [x, y] in [[8.0, -2.0], [22.0, -2.0], [22.0, 9.0], [8.0, 9.0]] {
        let at = bench.bev(x, y);
        bench.drag(&[at], Modifiers::CTRL);
        bench.steps(30);
    }
    bench.key(Modifiers::CTRL, Key::Enter);
    assert!(!bench.app().state.any_chosen());
    bench.steps(10);
    assert!(bench.started.is_empty(), "nothing is generated");
}
