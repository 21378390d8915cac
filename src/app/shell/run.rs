//! Opens the window: graphics, the first scene, the event loop.

use std::path::PathBuf;
use std::sync::Arc;

use super::app::{AppConfig, SceneloomApp};
use super::guests::AssistantListener;
use super::{gone, settings};
use crate::{open, pipeline};
use formats::loom;
use job::GenParams;
use runtime::pool;
use scene::Scene;
use widgets::software_ui;

/// Opens the editor on a scene, with the bundled networks. `path` is the file it came from; only a `.loom` is saved
/// back. Measurements go to `trace`. Assistants use the `door`, if the user allows them. Errors as [`run_window_with`].
pub fn run_window(
    scene: Scene,
    path: Option<PathBuf>,
    trace: Option<PathBuf>,
    door: Option<Box<dyn AssistantListener>>,
) -> anyhow::Result<()> {
    super::logging::start();
    if let Some(line) = pool::start_workers(true) {
        tracing::warn!("{line}");
    }
    let config = AppConfig {
        scene,
        picture: path
            .clone()
            .filter(|p| p.extension().is_some_and(|e| e.eq_ignore_ascii_case("png"))),
        path: path.filter(|p| p.extension().is_some_and(|e| e == "loom")),
        build_pipeline: Box::new(|| Ok(Box::new(pipeline::WarmPipeline::bundled()?))),
        params: GenParams::default(),
        full_params: job::GenParams::whole_scene(),
        warm_up: true,
        open: Arc::new(crate::file),
        save: Arc::new(|scene, path| {
            loom::save(path, scene)?;
            Ok(())
        }),
        new_scene: Arc::new(new_scene),
        native_dialogs: true,
        settings_file: settings::Settings::file(),
    };
    run_window_with(config, trace, door)
}

/// A world of a random template and seed.
fn new_scene() -> anyhow::Result<Scene> {
    use world::template::TEMPLATES;
    let since = std::time::SystemTime::now().duration_since(std::time::UNIX_EPOCH);
    let seed = since.map_or(1, |d| u64::from(d.subsec_nanos()) ^ d.as_secs()) % 100_000;
    let name = TEMPLATES[seed as usize % TEMPLATES.len()];
    let mut scene =
        open::from_template(name, seed).ok_or_else(|| anyhow::anyhow!("there is no template {name:?}"))?;
    scene.name = format!("{name} {seed}").into();
    Ok(scene)
}

/// Opens the window and returns when it is closed. Errors in one line if there is no display or no graphics adapter (a
/// software one is enough), if the file for measurements cannot be written, or if the window is taken away from
/// outside.
pub fn run_window_with(
    config: AppConfig,
    trace: Option<PathBuf>,
    door: Option<Box<dyn AssistantListener>>,
) -> anyhow::Result<()> {
    let viewport = egui::ViewportBuilder::default()
        .with_app_id("sceneloom")
        .with_title(format!("{} – Sceneloom", config.scene.name))
        .with_inner_size([1600.0, 950.0])
        .with_min_inner_size([960.0, 600.0])
        .with_drag_and_drop(true);
    let options = eframe::NativeOptions {
        viewport,
        renderer: eframe::Renderer::Wgpu,
        wgpu_options: wgpu_options(),
        persist_window: false,
        dithering: false,
        ..Default::default()
    };
    let start = move |cc: &eframe::CreationContext<'_>| -> Result<Box<dyn eframe::App>, _> {
        let mut app = SceneloomApp::new(config, cc.wgpu_render_state.clone(), &cc.egui_ctx)?;
        app.keep_copies(&cc.egui_ctx);
        if let Some(door) = door {
            app = app.with_door(door);
        }
        if let Some(state) = &cc.wgpu_render_state {
            software_ui::install(&cc.egui_ctx, state);
        }
        if let Some(path) = trace {
            app.trace_to(&path)?;
        }
        Ok(Box::new(app))
    };
    gone::guarded(|| eframe::run_native("sceneloom", options, Box::new(start)))
}

/// Options for any adapter, a software one too, with limits that all of them support.
fn wgpu_options() -> egui_wgpu::WgpuConfiguration {
    let mut setup = egui_wgpu::WgpuSetupCreateNew::without_display_handle();
    setup.power_preference =
        wgpu::PowerPreference::from_env().unwrap_or(wgpu::PowerPreference::HighPerformance);
    setup.device_descriptor = Arc::new(|adapter| wgpu::DeviceDescriptor {
        label: Some("window"),
        required_limits: wgpu::Limits::downlevel_defaults().using_resolution(adapter.limits()),
        ..Default::default()
    });
    egui_wgpu::WgpuConfiguration {
        wgpu_setup: egui_wgpu::WgpuSetup::CreateNew(setup),
        ..Default::default()
    }
}
