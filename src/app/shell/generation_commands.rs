//! Carries out commands about generation and its results.

use egui::Context;

use super::app::SceneloomApp;
use super::live::RunningJob;
use super::toasts::MessageLevel;
use crate::command::GenerationCommand;
use job::pipeline::windows_over;
use language::t;

impl SceneloomApp {
    /// Carries out one generation command.
    pub(crate) fn generation_command(&mut self, command: GenerationCommand, ctx: &Context) {
        match command {
            GenerationCommand::Generate { full } => self.generate(full),
            GenerationCommand::DrawScenery => self.draw_scenery(),
            GenerationCommand::Decide(verdict) => self.decide(verdict),
            GenerationCommand::StopHere => self.stop_here(),
            GenerationCommand::Cancel { running, waiting } => {
                if waiting {
                    self.generation.live.drop_waiting(self.document.settled_scene());
                }
                if running && self.generation.cancel() {
                    let now_s = self.now_s();
                    let map = self.document.settled_scene().frame().extent();
                    let several = windows_over(map).len() > 1;
                    let text = match several && self.generation.runs_whole() {
                        true => t("Generation cancelled. Generate goes on where it stopped"),
                        false => t("Generation cancelled"),
                    };
                    self.toasts.push(MessageLevel::Info, text, now_s);
                }
            }
            GenerationCommand::RestoreVersion(rev) => {
                if let Some(i) = self.generation.versions.index_of(rev) {
                    let scene = self.generation.versions.list()[i].scene.clone();
                    self.restore(&scene);
                }
            }
            GenerationCommand::StepVersion(step) => {
                let rev = self.document.settled_scene().content();
                if let Some(scene) = self.generation.versions.neighbour(rev, step).cloned() {
                    self.restore(&scene);
                }
            }
            GenerationCommand::UseAgain(rev) => self.use_again(rev),
            GenerationCommand::KeepVersion => {
                self.generation.versions.keep(self.document.settled_scene());
                self.views.dock.open(crate::panes::id::PaneId::VERSIONS);
            }
            GenerationCommand::ToggleLive => {
                self.generation.live.on = !self.generation.live.on;
                self.generation.live.forget_asked();
            }
            GenerationCommand::Quality(preset) => self.set_quality(preset),
            GenerationCommand::Calibrate => {
                let ctx = ctx.clone();
                self.generation.tuning.calibrate(move || ctx.request_repaint());
            }
            GenerationCommand::Refine => {
                let ctx = ctx.clone();
                self.generation.tuning.refine(move || ctx.request_repaint());
            }
            GenerationCommand::StopMeasuring => self.generation.tuning.stop(),
        }
    }

    /// Makes a version the present state. Its result is kept with it, so no generation is needed.
    pub(crate) fn restore(&mut self, scene: &scene::Scene) {
        self.generation.worker.cancel();
        self.document.restore("Go to version", scene);
        self.generation.live.source_changed();
        self.views.compare.chosen = None;
    }

    pub(crate) fn generate(&mut self, full: bool) {
        if self.document.is_dragging() {
            return;
        }
        let scene = self.document.settled_scene().clone();
        let now_s = self.now_s();
        let inpaints = !full && !self.state.tools.region.is_empty();
        if !full && !inpaints && self.generation.live.touched_by(&scene, now_s).is_empty {
            let text = t("Nothing was edited since the last generation");
            self.toasts.push(MessageLevel::Info, text, now_s);
            return;
        }
        if (full || inpaints) && self.state.seed.another {
            self.state.seed.roll();
        }
        self.generation.live.seed = self.state.seed.value;
        let mut params = self.generation.live.params_for(&scene, full);
        if inpaints {
            self.state.tools.inpaint_region(&mut params);
            params.seed = self.state.seed.seed_for(params.seed);
        }
        if full && self.draws_scenery_first() {
            return self.generate_on_scenery(params);
        }
        let same = |r: &RunningJob| r.key.rev == scene.content() && r.key.params == params;
        if !self.generation.live.running.as_ref().is_some_and(same) {
            self.generation.live.touched_by(&scene, now_s);
            self.submit(scene, params);
        }
    }

    /// Applies the settings of a preset from the next edit on.
    pub(crate) fn set_quality(&mut self, preset: usize) {
        let Some(preset) = self.generation.tuning.presets.all.get(preset) else {
            return;
        };
        self.generation.live.params = preset.knobs.on(self.generation.live.params.clone());
        self.preferences.settings.quality.clone_from(&preset.name);
        // The source's trajectory was made with the old settings.
        self.generation.live.source_changed();
    }
}
