//! Batches in the window: the queue runs while the user works; variants are marked and opened.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use egui::Ui;

use super::app::{SceneloomApp, one_line};
use super::files::Next;
use super::toasts::MessageLevel;
use crate::batch::Queue;
use crate::batch::plan::BatchPlan;
use crate::batch::queue::BatchState;
use crate::windows::batch_plan::BASE;
use crate::windows::batches::{BatchAction, BatchesInput, BatchesWindow};
use formats::loom;
use language::tf;
use scene::{ProjectHistory, Scene};

/// The queue and its window.
#[derive(Default)]
pub struct Batching {
    /// All batches of the session.
    pub queue: Queue,
    /// State of the window; `None` while it is closed.
    pub(crate) window: Option<BatchesWindow>,
    /// State of the window, kept while it is closed.
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
                self.files.batching.window =
                    Some(kept.unwrap_or_else(|| BatchesWindow::new(&free_folder(&folder))));
            }
        }
    }

    /// Advances the queue, and reports the batches that ended.
    pub(crate) fn update_batches(&mut self, ctx: &egui::Context) {
        let wake = ctx.clone();
        let ended = self.files.batching.queue.tick(move || wake.request_repaint());
        for id in ended {
            let Some(item) = self.files.batching.queue.item(id) else {
                continue;
            };
            let name = item.name.clone();
            let (level, text) = match &item.state {
                BatchState::Done(report) if report.failed.is_empty() => (
                    MessageLevel::Info,
                    tf!(
                        "Batch {name}: {n} variants are ready",
                        name = name,
                        n = report.variants
                    ),
                ),
                BatchState::Done(report) => (
                    MessageLevel::Error,
                    tf!(
                        "Batch {name}: {n} of {all} variants failed",
                        name = name,
                        n = report.failed.len(),
                        all = report.variants,
                    ),
                ),
                BatchState::Failed(why) => (
                    MessageLevel::Error,
                    tf!("Batch {name}: {error}", name = name, error = why),
                ),
                _ => continue,
            };
            let now_s = self.now_s();
            self.toasts.push(level, text, now_s);
        }
    }

    /// Draws the window and carries out its requests.
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
            Some(BatchAction::Add) => {
                let added = self.add_batch(&window, chosen);
                window.form.problem = added.as_ref().err().map(one_line);
                if let Ok(id) = added {
                    (window.chosen, window.is_new) = (Some(id), false);
                    window.forget_pictures();
                    window.form.folder = free_folder(&window.form.output()).display().to_string();
                }
                Ok(())
            }
            Some(BatchAction::Star(id, variant)) => self.files.batching.queue.mark(id, |m| m.star(variant)),
            Some(BatchAction::Discard(id, variant)) => {
                self.files.batching.queue.mark(id, |m| m.discard(variant))
            }
            Some(BatchAction::Open(id, variant)) => {
                self.guarded(Next::Variant(id, variant), ui.ctx());
                Ok(())
            }
        };
        if let Err(error) = marked {
            self.fail(tf!("Not marked: {error}", error = one_line(&error)));
        }
        match open {
            true => self.files.batching.window = Some(window),
            false => self.files.batching.closed = Some(window),
        }
    }

    /// Adds the batch of the form. For variants of the open scene, a copy of the scene is written into the folder.
    fn add_batch(&mut self, window: &BatchesWindow, chosen: Option<scene::BoxId>) -> anyhow::Result<u64> {
        let (form, output) = (&window.form, window.form.output());
        let queue = &mut self.files.batching.queue;
        if form.from_file {
            let file = PathBuf::from(form.plan_file.trim());
            let folder = file.parent().unwrap_or(Path::new("")).to_path_buf();
            return queue.add(BatchPlan::read(&file)?, &folder, &output);
        }
        let scene = self.document.settled_scene();
        let base = output.join(BASE);
        let mut alone = Scene::clone(scene);
        alone.kept = Arc::new(ProjectHistory {
            sweeps: scene.kept.sweeps.clone(),
            ..ProjectHistory::default()
        });
        let bytes = loom::to_bytes(&alone)?;
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

    /// Opens a variant as a new scene; it is made again.
    pub(super) fn open_variant(&mut self, id: u64, variant: usize, ctx: &egui::Context) {
        let Some(item) = self.files.batching.queue.item(id) else {
            return;
        };
        match item.batch() {
            Ok(batch) => {
                let what = tf!("Opening variant {n} of {name}", n = variant, name = item.name);
                self.load(what, None, false, ctx, move || batch.scene(variant));
            }
            Err(error) => self.fail(one_line(&error)),
        }
    }
}

/// The folder itself if it does not exist yet, else the next free name: `a_batch_2`, `a_batch_3` and so on.
fn free_folder(folder: &Path) -> PathBuf {
    let name = folder
        .file_name()
        .unwrap_or_default()
        .to_string_lossy()
        .into_owned();
    let number = |c: char| c.is_ascii_digit();
    let stem = name.trim_end_matches(number).strip_suffix('_').unwrap_or(&name);
    let numbered = |i: u32| folder.with_file_name(format!("{stem}_{i}"));
    std::iter::once(folder.to_path_buf())
        .chain((2..10_000).map(numbered))
        .find(|path| !path.exists())
        .unwrap_or_else(|| folder.to_path_buf())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn folders_that_are_there_get_a_number() {
        let dir = tempfile::tempdir().expect("a folder");
        let first = dir.path().join("a_batch");
        assert_eq!(free_folder(&first), first);
        std::fs::create_dir(&first).expect("made");
        let second = dir.path().join("a_batch_2");
        assert_eq!(free_folder(&first), second);
        std::fs::create_dir(&second).expect("made");
        assert_eq!(free_folder(&second), dir.path().join("a_batch_3"));
    }
}
