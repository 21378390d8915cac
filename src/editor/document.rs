//! The document: the only place where a scene changes. An edit is an undo step, a whole drag is one step, and a generated
//! result goes into the step of its edit.

use std::sync::Arc;

use scene::{Background, Frame, Scene, SceneRev, VoxelGrid};

use scene::{Edit, EditError};

/// A scene with its history. Each step is a snapshot; copy-on-write makes that a few kilobytes.
/// There is no mutable access to the scene, on purpose.
#[derive(Debug)]
pub struct Document {
    steps: Vec<UndoStep>, // never empty; the first is the state that was opened
    at: usize,            // step being shown
    drag: Option<Arc<Scene>>,
    saved: SceneRev,
    limit_bytes: usize,
}

#[derive(Debug)]
struct UndoStep {
    label: Label, // of the edit that led here
    scene: Arc<Scene>,
    bytes: usize, // not shared with the step before; 0 for the first
}

/// Name of an undo step.
pub type Label = std::borrow::Cow<'static, str>;

/// A result came too late: the document shows another state by now. A result that covers another part of the ground
/// than the frame is of another state too.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("the result belongs to an earlier state of the scene")]
pub struct Stale;

impl Document {
    /// States kept at most, the current one included, however small they are.
    pub const MAX_STEPS: usize = 4096;
    /// Memory that the history may take unless the user wants otherwise.
    pub const LIMIT_BYTES: usize = 256 << 20;
    /// Steps that can always be undone, however large they are.
    pub const LEAST_UNDO: usize = 8;

    /// A document that was just opened or made: nothing to undo, nothing unsaved.
    pub fn new(scene: Scene) -> Self {
        let saved = scene.content();
        let first = UndoStep {
            label: "Open".into(),
            scene: Arc::new(scene),
            bytes: 0,
        };
        Self {
            steps: vec![first],
            at: 0,
            drag: None,
            saved,
            limit_bytes: Self::LIMIT_BYTES,
        }
    }

    /// The state that is shown, with the drag in progress: views draw it, and generation starts from it.
    pub fn scene(&self) -> &Arc<Scene> {
        self.drag.as_ref().unwrap_or(&self.steps[self.at].scene)
    }

    /// The state without the drag in progress.
    pub fn settled_scene(&self) -> &Arc<Scene> {
        &self.steps[self.at].scene
    }

    /// Applies one edit as one undo step. A drag in progress is cancelled first. An edit that
    /// changes nothing makes no step. On error nothing has changed.
    pub fn apply(&mut self, label: impl Into<Label>, edit: &Edit) -> Result<(), EditError> {
        self.apply_all(label, std::slice::from_ref(edit))
    }

    /// Applies several edits as one undo step: all of them, or on error none.
    pub fn apply_all(&mut self, label: impl Into<Label>, edits: &[Edit]) -> Result<(), EditError> {
        let next = self.edited(edits)?;
        self.drag = None;
        self.push(label.into(), next);
        Ok(())
    }

    /// Shows the edit on top of the state in which the drag began. The first call begins the drag. Call it again whenever
    /// the pointer moves, with the whole change since the beginning. On error the previous preview stays.
    pub fn preview(&mut self, edit: &Edit) -> Result<(), EditError> {
        self.preview_all(std::slice::from_ref(edit))
    }

    /// Like [`Self::preview`], with several edits.
    pub fn preview_all(&mut self, edits: &[Edit]) -> Result<(), EditError> {
        self.drag = Some(Arc::new(self.edited(edits)?));
        Ok(())
    }

    /// True between the first preview and its commit or cancel.
    pub fn is_dragging(&self) -> bool {
        self.drag.is_some()
    }

    /// Makes the last preview one undo step. Without a drag, or without a change, nothing happens.
    pub fn commit_drag(&mut self, label: impl Into<Label>) {
        if let Some(dragged) = self.drag.take() {
            self.push(label.into(), Arc::unwrap_or_clone(dragged));
        }
    }

    /// Back to the state in which the drag began.
    pub fn cancel_drag(&mut self) {
        self.drag = None;
    }

    /// Goes one step back and returns the label of the step that was undone. During a drag only the drag is cancelled
    /// (`None`).
    pub fn undo(&mut self) -> Option<&str> {
        if self.drag.take().is_some() || self.at == 0 {
            return None;
        }
        let time_s = self.scene().time_s();
        self.at -= 1;
        self.show(time_s);
        Some(&self.steps[self.at + 1].label)
    }

    /// Goes one step forward again and returns the label of the step that was redone. During a drag only the drag is
    /// cancelled (`None`).
    pub fn redo(&mut self) -> Option<&str> {
        if self.drag.take().is_some() || self.at + 1 == self.steps.len() {
            return None;
        }
        let time_s = self.scene().time_s();
        self.at += 1;
        self.show(time_s);
        Some(&self.steps[self.at].label)
    }

    /// True if [`Self::undo`] has a step to go back.
    pub fn can_undo(&self) -> bool {
        self.at > 0
    }

    /// True if [`Self::redo`] has a step to go forward.
    pub fn can_redo(&self) -> bool {
        self.at + 1 < self.steps.len()
    }

    /// Label of the step that [`Self::undo`] would take back.
    pub fn undo_label(&self) -> Option<&str> {
        self.can_undo().then(|| &*self.steps[self.at].label)
    }

    /// Label of the step that [`Self::redo`] would bring back.
    pub fn redo_label(&self) -> Option<&str> {
        self.can_redo().then(|| &*self.steps[self.at + 1].label)
    }

    /// Labels of all states kept, oldest first; the first is the oldest state itself.
    pub fn history(&self) -> impl ExactSizeIterator<Item = &str> + '_ {
        self.steps.iter().map(|s| &*s.label)
    }

    /// All states kept, oldest first, by their content.
    pub fn contents(&self) -> impl ExactSizeIterator<Item = SceneRev> + '_ {
        self.steps.iter().map(|s| s.scene.content())
    }

    /// Memory that the history takes beside its oldest state, bytes: the parts of each step that are not shared with
    /// the step before.
    pub fn history_bytes(&self) -> usize {
        self.steps.iter().map(|s| s.bytes).sum()
    }

    /// Memory limit of the history, bytes; see [`Self::set_history_limit`].
    pub fn history_limit(&self) -> usize {
        self.limit_bytes
    }

    /// Bounds the memory of the history. The oldest states go first; the one shown and [`Self::LEAST_UNDO`] before it
    /// stay.
    pub fn set_history_limit(&mut self, bytes: usize) {
        self.limit_bytes = bytes;
        self.forget_oldest();
    }

    /// Index into [`Self::history`] of the state shown.
    pub fn position(&self) -> usize {
        self.at
    }

    /// Shows the state at that index of [`Self::history`]; false if there is none. Cancels a drag.
    pub fn jump_to(&mut self, index: usize) -> bool {
        if index >= self.steps.len() {
            return false;
        }
        let time_s = self.settled_scene().time_s();
        self.at = index;
        self.show(time_s);
        true
    }

    /// True if the settled state is not the one last opened or saved.
    pub fn is_dirty(&self) -> bool {
        self.settled_scene().content() != self.saved
    }

    /// Notes that the settled state has been written to a file.
    pub fn mark_saved(&mut self) {
        self.saved = self.settled_scene().content();
    }

    /// Notes that the settled state is in no file of the user's: it was recovered.
    pub fn mark_unsaved(&mut self) {
        self.saved = SceneRev::fresh();
    }

    /// Puts a generated occupancy into the step that is shown, if that is the state `content` (of [`Scene::content`]) which it
    /// was generated for, whatever moment is shown. It is the occupancy of [`Scene::for_generation`]'s frame, and becomes the
    /// source of what comes; painted voxels stay. No undo step is added. Returns the new state.
    pub fn adopt(&mut self, content: SceneRev, occupancy: VoxelGrid) -> Result<SceneRev, Stale> {
        let scene = self.with_result(content, occupancy, None)?;
        let content = scene.content();
        self.steps[self.at].scene = Arc::new(scene);
        self.weigh(self.at);
        self.weigh(self.at + 1);
        self.forget_oldest();
        Ok(content)
    }

    /// Like [`Self::adopt`], but adds an undo step: for a region that the user asked to inpaint.
    pub fn adopt_as_step(
        &mut self,
        label: impl Into<Label>,
        content: SceneRev,
        occupancy: VoxelGrid,
    ) -> Result<SceneRev, Stale> {
        let scene = self.with_result(content, occupancy, None)?;
        self.push(label.into(), scene);
        Ok(self.settled_scene().content())
    }

    /// Like [`Self::adopt_as_step`], and replaces the things beside the roads, whose voxels are in the occupancy.
    pub fn adopt_with_things(
        &mut self,
        label: impl Into<Label>,
        content: SceneRev,
        occupancy: VoxelGrid,
        background: Background,
    ) -> Result<SceneRev, Stale> {
        let scene = self.with_result(content, occupancy, Some(background))?;
        self.push(label.into(), scene);
        Ok(self.settled_scene().content())
    }

    /// The step that is shown, with a generated occupancy.
    fn with_result(
        &self,
        content: SceneRev,
        occupancy: VoxelGrid,
        background: Option<Background>,
    ) -> Result<Scene, Stale> {
        let shown = self.settled_scene();
        if self.drag.is_some() || shown.content() != content {
            return Err(Stale);
        }
        let mut frame = Frame::clone(shown.for_generation().frame());
        super::apply::adopt(&mut frame, occupancy).map_err(|_| Stale)?;
        let mut scene = Scene::clone(shown);
        if let Some(background) = background {
            scene.background = Arc::new(background);
        }
        scene.set_generated(frame);
        Ok(scene)
    }

    /// Shows a state that was kept elsewhere (a version), as an undo step. Does nothing if that state is shown already.
    pub fn restore(&mut self, label: impl Into<Label>, scene: &Scene) {
        self.drag = None;
        self.push(label.into(), scene.clone());
    }

    /// Shows another moment of the scene; not an undo step, and nothing to save. False if it is shown already. Cancels a
    /// drag.
    pub fn show(&mut self, time_s: f64) -> bool {
        self.drag = None;
        let scene = &mut self.steps[self.at].scene;
        let mut other = Scene::clone(scene);
        let shown = other.show(time_s);
        if shown {
            *scene = Arc::new(other);
        }
        shown
    }

    fn edited(&self, edits: &[Edit]) -> Result<Scene, EditError> {
        super::arranged::locked(self.settled_scene(), edits)?;
        let mut scene = Scene::clone(self.settled_scene());
        super::apply::apply_all(edits, &mut scene)?;
        Ok(scene)
    }

    fn push(&mut self, label: Label, scene: Scene) {
        if scene.content() == self.settled_scene().content() {
            return;
        }
        self.steps.truncate(self.at + 1);
        let bytes = scene.bytes_beside(self.settled_scene());
        self.steps.push(UndoStep {
            label,
            scene: Arc::new(scene),
            bytes,
        });
        self.at = self.steps.len() - 1;
        self.forget_oldest();
    }

    /// Counts again the bytes that a step does not share with the one before it.
    fn weigh(&mut self, index: usize) {
        if let Some([before, step]) = index.checked_sub(1).and_then(|i| self.steps.get_mut(i..=index)) {
            step.bytes = step.scene.bytes_beside(&before.scene);
        }
    }

    fn forget_oldest(&mut self) {
        let (mut bytes, mut gone) = (self.history_bytes(), 0);
        let too_much = |bytes: usize, left: usize| bytes > self.limit_bytes || left > Self::MAX_STEPS;
        while gone + Self::LEAST_UNDO < self.at && too_much(bytes, self.steps.len() - gone) {
            // The next step becomes the oldest one, whose bytes count as 0.
            bytes -= self.steps[gone + 1].bytes;
            gone += 1;
        }
        if gone > 0 {
            self.steps.drain(..gone);
            self.steps[0].bytes = 0;
            self.at -= gone;
        }
    }
}

#[cfg(test)]
#[path = "document_tests.rs"]
mod tests;
