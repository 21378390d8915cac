//! The timeline: a motion by template, playing, stepping, moving what moves at a moment, and undo.

use egui::{Key, Modifiers};
use egui_kittest::kittest::Queryable;
use scene::{BoxId, Scope};

use super::bench::Bench;

fn car_x_m(bench: &Bench) -> f64 {
    bench.frame().boxes[&BoxId(7)].center_m.x
}

fn time_s(bench: &mut Bench) -> f64 {
    bench.app().document.scene().time_s()
}

#[test]
fn a_car_drives_plays_and_is_moved_at_a_moment() {
    let mut bench = Bench::new();
    bench.off();
    bench.click("Clip");
    let at = bench.bev(14.0, 3.0);
    bench.drag(&[at], Modifiers::NONE);
    let begins_m = car_x_m(&bench);
    bench.click("Motion of car 7…");
    bench.click("Drive along the lane");
    let scene = bench.app().document.scene().clone();
    assert!(scene.clip().length_s > 1.0 && scene.clip().motion(Some(BoxId(7))).is_some());
    let canvas = scene.canvas().clone();
    // A step is a frame.
    let step_s = 1.0 / scene.clip().rate_hz;
    bench.click("Frame forward");
    assert!((time_s(&mut bench) - step_s).abs() < 1e-9);
    bench.click("Frame back");
    assert_eq!(time_s(&mut bench), 0.0);
    // It plays, and what moves is elsewhere; showing is no edit.
    let history = bench.history();
    bench.click("Play");
    bench.wait_until("half a second", |b| time_s(b) > 0.5);
    bench.click("Play");
    let (now_s, now_m) = (time_s(&mut bench), car_x_m(&bench));
    assert!(now_s > 0.4, "{now_s}");
    assert!((now_m - begins_m).abs() > 1.0, "{begins_m} {now_m}");
    assert_eq!(bench.history(), history);
    assert_eq!(bench.app().document.scene().canvas().occupancy, canvas.occupancy);
    // Moved here from here on: where it began it begins still.
    bench.click("From here on");
    assert_eq!(bench.app().state.playback.scope, Scope::FromHereOn);
    let at_m = bench.frame().boxes[&BoxId(7)].center_m;
    let [from, to] = [0.0, 2.0].map(|dy| bench.bev(at_m.x, at_m.y + dy));
    bench.drag(&[from, to], Modifiers::NONE);
    let moved_m = bench.frame().boxes[&BoxId(7)].center_m;
    assert!((moved_m.y - at_m.y - 2.0).abs() < 0.5, "{moved_m}");
    assert_eq!(time_s(&mut bench), now_s, "the moment stays");
    bench.click("To the start");
    assert!((car_x_m(&bench) - begins_m).abs() < 0.05);
    bench.click("To the end");
    let length_s = bench.app().document.scene().clip().length_s;
    assert_eq!(time_s(&mut bench), length_s);
    // All of it comes back.
    bench.key(Modifiers::CTRL, Key::Z);
    bench.key(Modifiers::CTRL, Key::Z);
    assert!(
        bench
            .app()
            .document
            .scene()
            .clip()
            .motion(Some(BoxId(7)))
            .is_none()
    );
    assert!((car_x_m(&bench) - begins_m).abs() < 1e-9);
}

#[test]
fn keys_play_and_step_as_in_video_editors() {
    let mut bench = Bench::new();
    bench.off();
    bench.click("Clip");
    assert!(bench.harness.query_by_label("Play").is_none(), "nothing moves");
    bench.click("Motion of the ego vehicle…");
    bench.click("Drive along the lane");
    bench.key(Modifiers::NONE, Key::Period);
    bench.key(Modifiers::NONE, Key::Period);
    let step_s = 1.0 / bench.app().document.scene().clip().rate_hz;
    assert!((time_s(&mut bench) - 2.0 * step_s).abs() < 1e-9);
    let pose = bench.frame().world_from_ego;
    assert!(pose.translation_m.length() > 0.1, "the vehicle drives");
    bench.key(Modifiers::NONE, Key::Comma);
    assert!((time_s(&mut bench) - step_s).abs() < 1e-9);
    bench.key(Modifiers::NONE, Key::Space);
    assert!(bench.app().state.playback.playing);
    bench.wait_until("it plays", |b| time_s(b) > step_s);
    bench.key(Modifiers::NONE, Key::Space);
    assert!(!bench.app().state.playback.playing);
}

#[test]
fn a_clip_of_the_map_and_of_cameras_is_saved_at_a_chosen_size() {
    let mut bench = Bench::new();
    bench.off();
    bench.click("Clip");
    bench.click("Motion of the ego vehicle…");
    bench.click("Drive along the lane");
    bench.app().state.playback.span_s = Some([0.0, 0.2]);
    let saved = |bench: &mut Bench, name: &str| {
        let path = bench.folder.path().join(name);
        bench.click("Save moving pictures…");
        bench.give_path(&path, "Save clip");
        bench.wait_until("the clip", |_| path.exists());
        let bytes = std::fs::read(&path).expect("there");
        assert!(bytes.starts_with(b"GIF89a"));
        [6, 8].map(|at| u16::from_le_bytes([bytes[at], bytes[at + 1]]))
    };
    let ctx = bench.harness.ctx.clone();
    let ask = app::command::Command::File(app::command::FileCommand::SaveClip);
    bench.app().execute(ask, &ctx);
    bench.steps(3);
    bench.click("Map");
    bench.app().state.windows.capture.options.shot.size = [320, 200];
    assert_eq!(saved(&mut bench, "map.gif"), [320, 200]);
    bench.app().state.windows.capture.options.subject = app::capture::Subject::Cameras;
    bench.app().state.windows.capture.options.camera_size = [80, 46];
    bench.app().state.windows.capture.camera = Some(1);
    bench.steps(2);
    assert_eq!(saved(&mut bench, "front.gif"), [80, 46]);
    bench.app().state.windows.capture.camera = None;
    let [width, height] = saved(&mut bench, "all.gif");
    assert!(width > 3 * 80 && height > 2 * 46, "{width} x {height}");
}
