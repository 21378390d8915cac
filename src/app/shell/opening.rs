//! Takes over scenes that were read from a file. Edits made while the file was read are not lost: the new scene waits
//! until the user has decided about them.

use crossbeam_channel::TryRecvError;
use egui::Context;

use super::app::{SceneloomApp, one_line};
use super::files::{Arrived, Left, Next, Opening};
use super::toasts::MessageLevel;
use super::versions::VersionedScene;
use crate::panes::compare::CompareMode;
use job::ChosenDensities;
use job::inpaint::InpaintMask;
use language::tf;

impl SceneloomApp {
    /// The state that would be left if another scene were opened now.
    pub(crate) fn left(&self) -> Left {
        Left {
            content: self.document.settled_scene().content(),
            unsaved: self.document.is_dirty(),
        }
    }

    /// True if there are unsaved changes that the user was not asked about when that state was left.
    fn edited_since(&self, left: Left) -> bool {
        self.document.is_dirty() && self.left() != left
    }

    /// Takes over a scene that was read. Waits during a drag, and while another question is open.
    pub(crate) fn take_opened(&mut self, ctx: &Context) {
        self.leave_arrived();
        if self.document.is_dragging() || self.files.unsaved.is_some() || self.files.dialogs.is_open() {
            return;
        }
        let Some(opening) = &self.files.opening else {
            return;
        };
        let answer = match opening.scene.try_recv() {
            Err(TryRecvError::Empty) => return,
            Ok(answer) => answer,
            Err(TryRecvError::Disconnected) => Err(anyhow::anyhow!("reading it ended unexpectedly")),
        };
        let Some(opening) = self.files.opening.take() else {
            return;
        };
        match answer {
            // A scene that becomes an undo step replaces no document.
            Ok(opened) if opening.step.is_none() && self.edited_since(opening.leaves) => {
                self.files.arrived = Some(Box::new(Arrived { opening, opened }));
                self.files.unsaved = Some(Next::Arrived);
                ctx.request_repaint();
            }
            Ok(opened) => self.show_opened(opening, opened, ctx),
            Err(error) => {
                self.note_opened(opening.recovers, false);
                self.fail(format!("{}: {}", opening.what, one_line(&error)));
            }
        }
    }

    /// Shows the scene that waited.
    pub(crate) fn show_arrived(&mut self, ctx: &Context) {
        if let Some(arrived) = self.files.arrived.take() {
            let Arrived { opening, opened } = *arrived;
            self.show_opened(opening, opened, ctx);
        }
    }

    /// Drops the waiting scene if the question about it is closed: the user stays, or saving was cancelled.
    fn leave_arrived(&mut self) {
        if !self.files.dialogs.is_open() {
            // The dialog for the file's name was closed.
            self.files.after_save = None;
        }
        let next = [&self.files.unsaved, &self.files.after_save];
        if next.iter().any(|n| **n == Some(Next::Arrived)) {
            return;
        }
        if let Some(arrived) = self.files.arrived.take() {
            self.note_opened(arrived.opening.recovers, false);
            let text = tf!(
                "{name} was not opened: your changes stay",
                name = arrived.opened.scene.name
            );
            let now_s = self.now_s();
            self.toasts.push(MessageLevel::Info, text, now_s);
        }
    }

    fn show_opened(&mut self, opening: Opening, opened: VersionedScene, ctx: &Context) {
        let now_s = self.now_s();
        let VersionedScene {
            scene,
            document,
            versions,
            damaged,
            made,
            notes,
        } = opened;
        self.forget_shown(ctx);
        self.views.prompt.opened(&scene);
        if opening.is_import {
            let text = tf!(
                "Imported {name} as a draft. Ctrl+Enter generates it.",
                name = scene.name
            );
            self.toasts.push(MessageLevel::Info, text, now_s);
        } else {
            self.toasts.log(tf!("Opened {name}", name = scene.name), now_s);
        }
        for note in notes {
            self.toasts.push(MessageLevel::Info, note, now_s);
        }
        let version = match opening.step {
            Some(label) => {
                self.document.restore(label, &scene);
                label
            }
            None => {
                self.document = document;
                self.generation.versions.replace(versions);
                "As opened"
            }
        };
        self.tell_damaged(damaged);
        let opened = self.document.settled_scene().clone();
        self.generation
            .versions
            .push_made(version.into(), String::new(), opened, made.clone());
        if let Some(path) = &opening.path {
            self.preferences.settings.remember(path);
        }
        // The viewpoint of the old scene has no meaning in the new one.
        let extent = self.extent();
        self.views.view3d.frame_map(extent);
        // Saving must not replace the file of another scene without asking.
        self.files.path = opening.path;
        self.state.choose(&[], crate::tools::Choose::Only);
        self.state.correcting = false;
        self.state.tools.region = InpaintMask::default();
        self.state.tools.voxels.clear();
        // Unfinished work of the tools belongs to the old map.
        self.state.tools.toolbox = Default::default();
        self.state.tools.hand.road = Default::default();
        self.state.named = ChosenDensities::default();
        self.state.seed.value = None;
        if let Some(made) = made {
            self.take_knobs(&made);
        }
        self.note_opened(opening.recovers, true);
        ctx.request_repaint();
    }

    /// Forgets all results and marks of the old scene.
    fn forget_shown(&mut self, ctx: &Context) {
        self.generation.forget_scene();
        self.threads.sensing.forget();
        self.views.view3d.forget_scene();
        self.threads.checking.forget();
        self.threads.planning.close();
        self.views.compare.forget();
        self.state.compare.mode = CompareMode::Off;
        self.state.shown.finding_marks = None;
        self.state.shown.detection_marks = None;
        crate::panes::checks::forget(ctx);
        // Panes compare this count to drop values of another scene.
        self.state.opened += 1;
    }

    /// Reports how many versions of a file could not be read.
    pub(crate) fn tell_damaged(&mut self, damaged: usize) {
        if damaged > 0 {
            self.fail(tf!("{n} versions in the file cannot be read", n = damaged));
        }
    }

    /// Text about the waiting scene, for the question about unsaved changes.
    pub(crate) fn waits_to_be_shown(&self) -> Option<String> {
        let arrived = self.files.arrived.as_ref()?;
        Some(tf!(
            "“{name}” has been read and waits.",
            name = arrived.opened.scene.name
        ))
    }
}
