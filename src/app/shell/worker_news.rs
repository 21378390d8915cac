//! Submits jobs to the worker, and takes its updates.

use std::sync::Arc;
use std::time::Duration;

use super::app::SceneloomApp;
use crate::camera_views::Wanted;
use crate::panes::camera_strip::thousands;
use crate::sensing::Haste;
use crate::shell::live::{Advice, Purpose, RunningJob};
use crate::shell::staged::Again;
use crate::shell::status::Receipt;
use crate::shell::toasts::MessageLevel;
use job::{GenParams, GenResult, JobEvent, JobUpdate};
use language::{t, tf};
use scene::{Frame, Scene};

impl SceneloomApp {
    pub(crate) fn schedule(&mut self, ctx: &egui::Context) {
        let now_s = self.now_s();
        let scene = self.document.settled_scene().clone();
        self.generation.live.predicted_s = self
            .generation
            .tuning
            .predicted_now_s(&self.generation.live.params);
        match self
            .generation
            .live
            .advise(&scene, self.document.is_dragging(), now_s)
        {
            Advice::Rest => {}
            Advice::Wait(seconds) => {
                ctx.request_repaint_after(Duration::from_secs_f64(seconds));
            }
            Advice::Cancel => self.generation.worker.cancel(),
            Advice::Submit(params) | Advice::WarmUp(params) => self.submit(scene, params),
        }
        // Small pictures while the scene changes: large ones take as long as the generation itself.
        let changes = self.document.is_dragging() || self.generation.live.running.is_some();
        let haste = match self.state.playback.playing {
            true => Haste::Play {
                every_ms: self.state.playback.sensed_every_ms(),
            },
            false if changes => Haste::Preview,
            false => Haste::Rest,
        };
        if self.state.playback.sensors_are_due(now_s) {
            let count = self.document.scene().rig.cameras.len();
            let state = &self.state;
            let wanted = Wanted::from_settings(&state.cameras, &state.lidar, &state.radar, count);
            self.threads
                .sensing
                .paint_with(&self.preferences.settings.painting);
            self.threads.sensing.ask(self.document.scene(), wanted, haste);
        }
        self.state.cameras.frame_ended();
        self.state.radar.frame_ended();
    }

    pub(crate) fn submit(&mut self, scene: Arc<Scene>, params: GenParams) {
        let now_s = self.now_s();
        self.generation.submit(scene, params, now_s);
        self.frames.perf.job_begins();
    }

    pub(crate) fn take_event(&mut self, event: JobEvent) {
        match event.update {
            JobUpdate::Progress { stage, step, steps } => {
                if let Some(running) = self.generation.live.running.as_mut().filter(|r| r.id == event.id) {
                    running.progress = Some((stage, step, steps));
                    self.frames
                        .perf
                        .stage(stage, self.frames.clock.elapsed().as_secs_f64());
                }
            }
            JobUpdate::Preview(result) => {
                let mut scene = Scene::clone(self.document.scene());
                if scene.content() == result.rev() {
                    let mut frame = Frame::clone(scene.for_generation().frame());
                    frame.occupancy = result.occupancy.clone();
                    scene.set_generated(frame);
                    self.generation.preview = Some((result.rev(), Arc::new(scene)));
                }
            }
            JobUpdate::Finished(result) => {
                let now_s = self.now_s();
                let mut own_step = None;
                if let Some(running) = self.generation.live.ended(event.id) {
                    own_step = running.own_step();
                    let settled_s = (running.purpose == Purpose::Edit).then_some(now_s - running.edited_s);
                    self.frames.perf.job_ended(now_s, settled_s, "finished");
                    let full = running.purpose == Purpose::Full;
                    if running.purpose == Purpose::WarmUp {
                        let calls = result.report.network_calls;
                        let took_s = now_s - running.submitted_s;
                        let text = tf!(
                            "Ready to edit after {seconds} s, {n} network calls",
                            seconds = format!("{took_s:.1}"),
                            n = calls,
                        );
                        self.toasts.log(text, now_s);
                        return;
                    }
                    // A region that the user requested is not typical for the time of an edit.
                    if !full && running.key.params.strength == 0.0 {
                        self.generation
                            .live
                            .took(running.share, now_s - running.submitted_s);
                    }
                    if !full && running.key.rev == self.document.settled_scene().content() {
                        let edited = self.document.settled_scene().clone();
                        self.generation
                            .tuning
                            .note(edited, result.clone(), now_s - running.edited_s);
                    }
                    if running.key.rev == self.document.settled_scene().content() {
                        self.generation.receipt =
                            Some(Receipt::new(&result.report, now_s - running.edited_s, full));
                    }
                }
                if self.document.is_dragging() {
                    self.generation.finished = Some((result, own_step));
                } else {
                    self.adopt(&result, own_step);
                }
            }
            JobUpdate::Failed(error) => {
                if self
                    .generation
                    .live
                    .ended(event.id)
                    .is_some_and(|r| r.purpose == Purpose::Full)
                {
                    self.take_scenery_back();
                }
                self.generation.preview = None;
                self.generation.tuning.note_failure(&error.to_string());
                let now_s = self.now_s();
                self.frames.perf.job_ended(now_s, None, "failed");
                let text = if std::mem::replace(&mut self.generation.live.on, false) {
                    tf!("Generation failed: {error}. Live is off now.", error = error)
                } else {
                    tf!("Generation failed: {error}.", error = error)
                };
                self.toasts.push(MessageLevel::Error, text, now_s);
            }
            JobUpdate::Superseded => {
                if let Some(running) = self.generation.live.ended(event.id) {
                    if running.purpose == Purpose::Full {
                        self.take_scenery_back();
                    }
                    self.frames.perf.job_ended(self.now_s(), None, "cancelled");
                }
                self.generation.preview = None;
            }
        }
    }

    /// Adopts a result into the document, if the document still shows the state that it was made for.
    pub(crate) fn adopt(&mut self, result: &GenResult, own_step: Option<&'static str>) {
        self.generation.preview = None;
        let before = self.document.settled_scene().clone();
        let drawn = self
            .generation
            .drawn_first
            .take()
            .filter(|(rev, _)| *rev == result.rev());
        let own_step_label = own_step.filter(|_| drawn.is_none());
        // A requested region becomes its own step; the result of an edit goes into the step of the edit.
        let adopted = match own_step_label {
            Some(label) => self
                .document
                .adopt_as_step(label, result.rev(), result.occupancy.clone())
                .is_ok(),
            None => self
                .document
                .adopt(result.rev(), result.occupancy.clone())
                .is_ok(),
        };
        if adopted {
            let now_s = self.now_s();
            let note = self
                .generation
                .receipt
                .as_ref()
                .map_or_else(String::new, Receipt::text);
            let label = self.document.undo_label().unwrap_or("Generated");
            let scene = self.document.settled_scene().clone();
            let label = label.to_owned();
            let made = self.made_with(&result.key.params);
            self.generation
                .versions
                .push_made(label, note.clone(), scene, Some(made));
            self.views.compare.chosen = None;
            if self.generation.receipt.is_some() {
                self.toasts.log(note, now_s);
            }
            for note in &result.report.notes {
                self.toasts.log(note.clone(), now_s);
            }
            let words = self
                .generation
                .words
                .take()
                .filter(|(rev, _)| *rev == result.rev());
            match (own_step, words) {
                (Some(_), _) => {
                    let first = drawn.is_some();
                    let before = drawn.map_or(before, |(_, before)| before);
                    // Scenery that was drawn first does depend on the seed.
                    let given = if first { 0 } else { result.report.things_given };
                    self.say_what_differs(&before, given);
                    self.stage(before, Some(Again::Generate(Box::new(result.key.params.clone()))));
                }
                (None, Some((_, before))) => self.stage(before, None),
                (None, None) => {}
            }
        }
    }

    /// Reports the parts that a requested generation left unchanged: no voxel differs, or the existing things stay.
    fn say_what_differs(&mut self, before: &Scene, things: usize) {
        let after = self.document.settled_scene();
        let voxels = before.frame().occupancy.count_different(&after.frame().occupancy);
        let text = match (voxels, things) {
            (0, 0) => t("Generated: no voxel differs from before").to_owned(),
            (_, 0) => return,
            (voxels, things) => tf!(
                "Generated: {voxels} voxels differ. All {things} things beside the roads stay, whatever the seed; Regenerate scenery draws others",
                voxels = thousands(voxels),
                things = thousands(things),
            ),
        };
        let now_s = self.now_s();
        self.toasts.push(MessageLevel::Info, text, now_s);
    }

    /// Ends a generation of the whole scene and adopts its last preview.
    pub(crate) fn stop_here(&mut self) {
        let before = self.document.settled_scene().clone();
        let whole = |r: &&mut RunningJob| r.purpose == Purpose::Full && r.key.rev == before.content();
        let Some(running) = self.generation.live.running.as_mut().filter(whole) else {
            return;
        };
        let Some((_, shown)) = self
            .generation
            .preview
            .take_if(|(rev, _)| *rev == before.content())
        else {
            return;
        };
        running.cancelled = true;
        let params = running.key.params.clone();
        let (step, steps) = running.progress.map_or((0, 0), |(_, step, steps)| (step, steps));
        self.generation.worker.cancel();
        let label = "Generate, stopped early";
        let occupancy = shown.frame().occupancy.clone();
        let drawn = self
            .generation
            .drawn_first
            .take()
            .filter(|(rev, _)| *rev == before.content());
        let adopted = match drawn {
            Some(_) => self.document.adopt(before.content(), occupancy),
            None => self.document.adopt_as_step(label, before.content(), occupancy),
        };
        if adopted.is_ok() {
            let note = tf!("After {step} of {steps} steps", step = step, steps = steps);
            let scene = self.document.settled_scene().clone();
            let made = self.made_with(&params);
            self.generation
                .versions
                .push_made(label.to_owned(), note, scene, Some(made));
            self.generation.receipt = None;
            self.generation.live.source_changed();
            self.stage(
                drawn.map_or(before, |(_, before)| before),
                Some(Again::Generate(Box::new(params))),
            );
        }
    }
}
