//! Models from other files: put into the scene, or given to a box as its shape.

use std::path::PathBuf;

use crossbeam_channel::{Receiver, TryRecvError, bounded};
use egui::Context;

use super::app::{SceneloomApp, one_line};
use super::file_dialogs::Purpose;
use language::{t, tf};
use scene::{BoxId, Model};

/// A model that is being read.
pub(crate) struct Reading {
    /// The box that gets its shape; `None` if it is put into the scene.
    target: Option<BoxId>,
    model: Receiver<anyhow::Result<Model>>,
}

impl SceneloomApp {
    /// Asks for the file of a model.
    pub(crate) fn ask_model(&mut self, to_chosen: bool, ctx: &Context) {
        if to_chosen && self.state.selected.is_none() {
            return self.note(t("Choose a box first"));
        }
        let purpose = if to_chosen {
            Purpose::ModelShape
        } else {
            Purpose::Model
        };
        let folder = self.suggested("glb");
        let folder = folder.parent().unwrap_or(std::path::Path::new("")).join("");
        self.files.dialogs.ask(purpose, &folder, ctx);
    }

    /// Reads a model on a thread of its own.
    pub(crate) fn read_model(&mut self, path: PathBuf, to_chosen: bool, ctx: &Context) {
        let (send, model) = bounded(1);
        let wake = ctx.clone();
        let make = move || anyhow::Ok(formats::model::read(&path, None)?);
        let thread = runtime::guard::spawn("model", make, move |model| {
            // Sending fails if another model was requested meanwhile.
            let _ = send.send(model.unwrap_or_else(|panic| Err(panic.into())));
            wake.request_repaint();
        });
        let target = self.state.selected.filter(|_| to_chosen);
        match thread {
            Ok(_) => self.files.model = Some(Reading { target, model }),
            Err(error) => self.fail(tf!("Not placed: {error}", error = error)),
        }
    }

    /// Places a model that has been read at the centre of the bird's-eye view, or gives its shape to the box that waits
    /// for it.
    pub(crate) fn take_model(&mut self) {
        let Some(reading) = self.files.model.take() else {
            return;
        };
        let model = match reading.model.try_recv() {
            Err(TryRecvError::Empty) => {
                self.files.model = Some(reading);
                return;
            }
            Err(TryRecvError::Disconnected) => {
                return self.fail(t("Not placed: reading it ended unexpectedly").to_owned());
            }
            Ok(Err(error)) => return self.fail(tf!("Not placed: {error}", error = one_line(&error))),
            Ok(Ok(model)) => model,
        };
        let scene = self.document.settled_scene().clone();
        if let Some(id) = reading.target {
            match scene.frame().boxes.get(&id) {
                Some(b) => self.apply("Give the box a model's shape", &editor::models::give(&model, b)),
                None => self.fail(t("Not placed: the box is gone").to_owned()),
            }
            return;
        }
        let (at_m, _) = self.views.canvas.place();
        match editor::models::place(&scene, &model, at_m, None) {
            Ok(placed) => {
                let name = model.label.called(t(&model.class.label()));
                self.apply(tf!("Place a model: {name}", name = name), &placed.edits);
                self.state.choose(&[placed.id], crate::tools::Choose::Only);
            }
            Err(problem) => self.fail(tf!("Not placed: {error}", error = problem)),
        }
    }
}
