//! Scenery by the network, on a thread of its own because it takes about a second.

use std::sync::Arc;
use std::time::Duration;

use crossbeam_channel::{Receiver, TryRecvError, bounded};

use super::app::SceneloomApp;
use super::staged::Again;
use super::toasts::MessageLevel;
use crate::scenery::{SceneryMethod, SceneryWish};
use editor::Edit;
use job::GenError;
use language::{t, tf};
use scene::{Scene, SceneRev};

/// Time after which the window checks again whether the scenery is done.
const LOOK_AGAIN: Duration = Duration::from_millis(40);

/// Scenery that is being drawn.
pub(crate) struct SceneryJob {
    wish: SceneryWish,
    before: Arc<Scene>,
    /// True if the result waits for the user's decision.
    staged: bool,
    edits: Receiver<Result<Vec<Edit>, GenError>>,
}

impl SceneryJob {
    /// True if it is drawn for this state.
    pub(crate) fn is_of(&self, content: SceneRev) -> bool {
        self.before.content() == content
    }
}

impl SceneloomApp {
    /// Draws scenery for the present scene. With `staged` the result waits for the user's decision.
    pub(crate) fn put_scenery(&mut self, wish: SceneryWish, staged: bool) {
        let before = self.document.settled_scene().clone();
        if wish.by != SceneryMethod::Network {
            let edits = wish.edits(&before);
            return self.take_scenery(wish, &before, edits, staged);
        }
        let (send, edits) = bounded(1);
        let (wanted, scene) = (wish.clone(), before.clone());
        let draw = move || wanted.edits(&scene);
        let thread = runtime::guard::spawn("scenery", draw, move |edits| {
            // Sending fails if other scenery was requested meanwhile.
            let _ = send.send(edits.unwrap_or_else(|panic| Err(GenError::failed(panic))));
        });
        match thread {
            Ok(_) => {
                let now_s = self.now_s();
                self.toasts
                    .push(MessageLevel::Info, t("The network draws scenery"), now_s);
                self.generation.drawing = Some(SceneryJob {
                    wish,
                    before,
                    staged,
                    edits,
                });
            }
            Err(error) => self.fail(tf!("No scenery was drawn: {error}", error = error)),
        }
    }

    /// Takes finished scenery, unless the scene has changed meanwhile.
    pub(crate) fn update_drawing(&mut self, ctx: &egui::Context) {
        let Some(drawing) = &self.generation.drawing else {
            return;
        };
        let edits = match drawing.edits.try_recv() {
            Err(TryRecvError::Empty) => return ctx.request_repaint_after(LOOK_AGAIN),
            Ok(edits) => edits,
            Err(TryRecvError::Disconnected) => Err(GenError::failed("drawing it ended unexpectedly")),
        };
        let Some(SceneryJob {
            wish, before, staged, ..
        }) = self.generation.drawing.take()
        else {
            return;
        };
        if self.document.is_dragging() || self.document.settled_scene().content() != before.content() {
            let now_s = self.now_s();
            let text = t("The scene changed meanwhile: no scenery was drawn");
            return self.toasts.push(MessageLevel::Info, text, now_s);
        }
        self.take_scenery(wish, &before, edits, staged);
    }

    fn take_scenery(
        &mut self,
        wish: SceneryWish,
        before: &Arc<Scene>,
        edits: Result<Vec<Edit>, GenError>,
        staged: bool,
    ) {
        let edits = match edits {
            Ok(edits) => edits,
            Err(error) => return self.fail(tf!("No scenery was drawn: {error}", error = error)),
        };
        self.apply("Draw scenery", &edits);
        let after = self.document.settled_scene().clone();
        if after.frame().occupancy == before.frame().occupancy {
            let now_s = self.now_s();
            let text = t("Generated: no voxel differs from before");
            self.toasts.push(MessageLevel::Info, text, now_s);
        }
        if after.content() != before.content() {
            let note = tf!("Seed {n}", n = wish.seed);
            self.generation
                .versions
                .push("Draw scenery".to_owned(), note, after);
            if staged {
                self.stage(before.clone(), Some(Again::Scenery(Box::new(wish))));
            }
        }
    }
}
