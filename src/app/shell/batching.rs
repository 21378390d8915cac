//! What the window does about batches: the queue runs while the user goes on; variants are marked and opened.

use std::path::PathBuf;

use egui::Ui;

use super::app::{SceneloomApp, one_line};
use super::toasts::Level;
use crate::batch::Queue;
use crate::batch::plan::Plan;
use crate::batch::queue::State;
use crate::windows::batch_plan::BASE;
use crate::windows::batches::{Asked, BatchesInput, BatchesWindow};
use formats::loom;

/// The queue and its window.
#[derive(Default)]
pub struct Batching {
    /// All batches of the session.
    pub queue: Queue,
    /// What the window shows; `None` while it is closed.
    pub(crate) window: Option<BatchesWindow>,
    /// Kept while the window is closed.
    closed: Option<BatchesWindow>,
}

impl SceneloomApp {
    /// The queue of batches.
    pub fn batches(&self) -> &Queue {
        &self.files.batching.queue
    }

    /// Opens the window of batches, or closes it.
    pub(crate) fn toggle_batches(&mut self) {
        let batching = &mut self.files.batching;
        match batching.window.take() {
            Some(window) => batching.closed = Some(window),
            None => {
                let kept = batching.closed.take();
                let suggested = self.suggested("loom").with_extension("");
                let name = suggested
                    .file_name()
                    .unwrap_or_default()
                    .to_string_lossy()
                    .into_owned();
                let folder = suggested.with_file_name(format!("{name}_batch"));
                self.files.batching.window = Some(kept.unwrap_or_else(|| BatchesWindow::new(&folder)));
            }
        }
    }

    /// Lets the queue go on, and tells which batches ended.
    pub(crate) fn update_batches(&mut self, ctx: &egui::Context) {
        let wake = ctx.clone();
        let ended = self.files.batching.queue.tick(move || wake.request_repaint());
        for id in ended {
            let Some(item) = self.files.batching.queue.item(id) else {
                continue;
            };
            let name = item.name.clone();
            let (level, text) = match &item.state {
                State::Done(report) if report.failed.is_empty() => (
                    Level::Info,
                    format!("Batch {name}: {} variants are ready", report.variants),
                ),
                State::Done(report) => (
                    Level::Error,
                    format!(
                        "Batch {name}: {} of {} variants failed",
                        report.failed.len(),
                        report.variants
                    ),
                ),
                State::Failed(why) => (Level::Error, format!("Batch {name}: {why}")),
                _ => continue,
            };
            let now_s = self.now_s();
            self.toasts.push(level, text, now_s);
        }
    }

    /// Draws the window and does what it asks for.
    pub(crate) fn batches_ui(&mut self, ui: &Ui) {
        let Some(mut window) = self.files.batching.window.take() else {
            return;
        };
        let scene = self.document.settled_scene().clone();
        let chosen = self
            .state
            .selected
            .filter(|id| scene.frame().boxes.contains_key(id));
        let names: Vec<String> = self
            .generation
            .tuning
            .presets
            .all
            .iter()
            .map(|p| p.name.clone())
            .collect();
        let input = BatchesInput {
            scene: &scene,
            chosen,
            qualities: &names,
        };
        let mut open = true;
        let asked = window.ui(ui, &mut self.files.batching.queue, &input, &mut open);
        let marked = match asked {
            None => Ok(()),
            Some(Asked::Add) => {
                let added = self.add_batch(&window, chosen);
                window.form.problem = added.as_ref().err().map(one_line);
                if let Ok(id) = added {
                    (window.chosen, window.is_new) = (Some(id), false);
                    window.forget_pictures();
                }
                Ok(())
            }
            Some(Asked::Star(id, variant)) => self.files.batching.queue.mark(id, |m| m.star(variant)),
            Some(Asked::Discard(id, variant)) => self.files.batching.queue.mark(id, |m| m.discard(variant)),
            Some(Asked::Open(id, variant)) => {
                self.open_variant(id, variant, ui.ctx());
                Ok(())
            }
        };
        if let Err(error) = marked {
            self.fail(format!("Not marked: {}", one_line(&error)));
        }
        match open {
            true => self.files.batching.window = Some(window),
            false => self.files.batching.closed = Some(window),
        }
    }

    /// Adds what the form says; of the open scene a copy lies in the folder.
    fn add_batch(&mut self, window: &BatchesWindow, chosen: Option<scene::BoxId>) -> anyhow::Result<u64> {
        let (form, output) = (&window.form, window.form.output());
        let queue = &mut self.files.batching.queue;
        if form.from_file {
            let file = PathBuf::from(form.plan_file.trim());
            let folder = file.parent().unwrap_or(std::path::Path::new("")).to_path_buf();
            return queue.add(Plan::read(&file)?, &folder, &output);
        }
        let scene = self.document.settled_scene();
        let base = output.join(BASE);
        let bytes = loom::alone_to_bytes(scene)?;
        if base.exists() && formats::input::read(&base, loom::LARGEST_FILE)? != bytes {
            anyhow::bail!("{}: the folder holds variants of another scene", output.display());
        }
        let id = queue.add(form.plan(scene, chosen), &output, &output)?;
        let written = formats::atomic::write(&base, &bytes);
        if written.is_err() {
            queue.remove(id);
        }
        written?;
        Ok(id)
    }

    /// Opens a variant as a scene of its own; it is made anew.
    fn open_variant(&mut self, id: u64, variant: usize, ctx: &egui::Context) {
        let Some(item) = self.files.batching.queue.item(id) else {
            return;
        };
        if self.document.is_dirty() {
            let text = "Save the scene first: opening a variant takes its place".to_owned();
            let now_s = self.now_s();
            self.toasts.push(Level::Error, text, now_s);
            return;
        }
        match item.batch() {
            Ok(batch) => {
                let what = format!("Opening variant {variant} of {}", item.name);
                self.load(what, None, false, ctx, move || batch.scene(variant));
            }
            Err(error) => self.fail(one_line(&error)),
        }
    }
}
