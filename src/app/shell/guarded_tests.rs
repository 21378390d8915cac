//! Tests that a panic on a thread of the window is reported in one line, and that the next piece of work is done.

use std::sync::Arc;
use std::time::{Duration, Instant};

use egui::Context;
use tempfile::tempdir;

use crate::command::ViewCommand;
use crate::export::ExportOptions;
use crate::panes::id::PaneId;
use crate::scenery::{SceneryMethod, SceneryWish};
use crate::sensing::Haste;
use crate::shell::workspace::Workspace;
use crate::{AppConfig, SceneloomApp, open};
use calibration::calibrate::{CalibrationEvent, Measurement, MeasurementTask};
use editor::Edit;
use job::{GenError, GenParams};
use runtime::guard::panic_next;

const PATIENCE: Duration = Duration::from_secs(120);

fn app() -> SceneloomApp {
    let config = AppConfig {
        scene: open::from_template("straight", 3).expect("a template"),
        path: None,
        picture: None,
        build_pipeline: Box::new(|| Err(GenError::failed("no pipeline here"))),
        params: GenParams::default(),
        full_params: GenParams::default(),
        warm_up: false,
        open: Arc::new(open::file),
        save: Arc::new(|_, _| Ok(())),
        new_scene: Arc::new(|| anyhow::bail!("no new scene here")),
        native_dialogs: false,
        settings_file: None,
    };
    SceneloomApp::new(config, None, &Context::default()).expect("threads")
}

/// Updates the window until the newest message contains a text.
fn wait_for(app: &mut SceneloomApp, text: &str) {
    let start = Instant::now();
    while !app.toasts.last().is_some_and(|t| t.contains(text)) {
        let last = app.toasts.last();
        assert!(start.elapsed() < PATIENCE, "{last:?}, expected {text:?}");
        app.update(&Context::default());
        std::thread::sleep(Duration::from_millis(2));
    }
}

#[test]
fn opening() {
    let mut app = app();
    let ctx = Context::default();
    let make = || Ok(open::from_template("straight", 4).expect("a template"));
    panic_next("open");
    app.load("Opening a file".into(), None, false, &ctx, make);
    wait_for(&mut app, "Opening a file: open panicked: asked for by a test");
    assert!(app.files.opening.is_none());
    app.load("Opening a file".into(), None, false, &ctx, make);
    while app.files.opening.is_some() {
        app.update(&ctx);
    }
    assert_eq!(
        app.document.scene().frame().boxes,
        make().expect("a scene").frame().boxes
    );
}

#[test]
fn exports() {
    let mut app = app();
    let folder = tempdir().expect("a folder");
    let path = folder.path().join("labels.npz");
    panic_next("export");
    for expected in ["Not exported: export panicked: asked for by a test", "Exported"] {
        let formats = vec![&formats::export::occ3d::EXPORTER];
        app.start_export(
            formats,
            ExportOptions::default(),
            path.clone(),
            &Context::default(),
        );
        wait_for(&mut app, expected);
    }
    assert!(path.is_file());
}

#[test]
fn scenery() {
    let mut app = app();
    let wish = SceneryWish {
        by: SceneryMethod::Network,
        ..SceneryWish::of_seed(5)
    };
    let before = app.document.settled_scene().content();
    panic_next("scenery");
    app.put_scenery(wish.clone(), false);
    wait_for(
        &mut app,
        "No scenery was drawn: scenery panicked: asked for by a test",
    );
    assert_eq!(app.document.settled_scene().content(), before);
    app.put_scenery(wish, false);
    let start = Instant::now();
    while app.document.settled_scene().content() == before {
        assert!(start.elapsed() < PATIENCE, "{:?}", app.toasts.last());
        app.update(&Context::default());
        std::thread::sleep(Duration::from_millis(2));
    }
}

#[test]
fn checks_and_sensors() {
    let mut app = app();
    let wanted =
        crate::camera_views::Wanted::from_settings(&app.state.cameras, &app.state.lidar, &app.state.radar, 6);
    panic_next("checks");
    wait_for(
        &mut app,
        "The scene was not checked: checks panicked: asked for by a test",
    );
    assert!(app.threads.checking.findings().is_none());
    panic_next("sensing");
    app.threads
        .sensing
        .ask(app.document.scene(), wanted, Haste::Preview);
    wait_for(
        &mut app,
        "The sensors show an older scene: sensing panicked: asked for by a test",
    );
    let prompt = "another state".to_owned();
    app.apply("Prompt", &[Edit::SetPrompt { prompt }]);
    let rev = app.document.settled_scene().content();
    app.threads
        .sensing
        .ask(app.document.scene(), wanted, Haste::Preview);
    let start = Instant::now();
    while app.threads.checking.is_stale(rev) || app.threads.sensing.lidar_stale(rev) {
        assert!(start.elapsed() < PATIENCE, "no findings");
        app.update(&Context::default());
        std::thread::sleep(Duration::from_millis(2));
    }
}

#[test]
fn measuring() {
    let next = |measurement: &Measurement| {
        let start = Instant::now();
        loop {
            if let Some(news) = measurement.next() {
                return news;
            }
            assert!(start.elapsed() < PATIENCE, "no news");
            std::thread::sleep(Duration::from_millis(2));
        }
    };
    let start = || {
        Measurement::start(MeasurementTask::Calibrate(trade::Presets::bundled()), || {}).expect("a thread")
    };
    panic_next("measure");
    let CalibrationEvent::Failed(line) = next(&start()) else {
        panic!("it goes on");
    };
    assert_eq!(line, "measure panicked: asked for by a test");
    assert!(matches!(next(&start()), CalibrationEvent::Progress(..)));
}

#[test]
fn a_workspace_keeps_the_panes_that_were_opened_in_it() {
    let mut app = app();
    let ctx = Context::default();
    let go = |app: &mut SceneloomApp, to| app.view_command(ViewCommand::Workspace(to), &ctx);
    let pane = PaneId::named("perception");
    app.view_command(ViewCommand::ShowPane(pane), &ctx);
    go(&mut app, Workspace::Paint);
    assert!(app.views.dock.find(pane).is_none());
    go(&mut app, Workspace::Edit);
    assert!(app.views.dock.find(pane).is_some(), "the pane is gone");
    // Choosing the same workspace again resets its panes.
    go(&mut app, Workspace::Edit);
    assert!(app.views.dock.find(pane).is_none());
}
