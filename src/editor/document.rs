//! The document: the only place where a scene changes. An edit is an undo step, a whole drag is one step, and a generated
//! result goes into the step of its edit. Every change is an [`Op`] of its log; the states between them are kept as a cache.

use std::collections::BTreeSet;
use std::sync::Arc;

use crate::replay::{edited, numbered, with_result};
use scene::grid::VoxelPatch;
use scene::op::{Author, Change, LoggedState, Op, OpId};
use scene::{Background, Scene, SceneRev, VoxelGrid};

use scene::{Edit, EditError};

/// A scene with its history. Each step is a snapshot; copy-on-write makes that a few kilobytes.
/// There is no mutable access to the scene, on purpose.
#[derive(Debug)]
pub struct Document {
    pub(crate) steps: Vec<UndoStep>, // never empty; the first is the oldest state
    pub(crate) at: usize,            // step being shown
    drag: Option<Drag>,
    saved: SceneRev,
    pub(crate) limit_bytes: usize,
    pub(crate) author: Author,
    pub(crate) origin: Arc<LoggedState>, // of the first step
    pub(crate) next_op: u64,
    pub(crate) opened_until: OpId, // changes below it were there when the document was opened
}

/// A drag in progress: the edits of its last preview, and the state that they lead to.
#[derive(Debug)]
struct Drag {
    edits: Vec<Edit>,
    scene: Arc<Scene>,
}

#[derive(Debug)]
pub(crate) struct UndoStep {
    pub(crate) label: Label, // of the change that led here
    pub(crate) scene: Arc<Scene>,
    pub(crate) ops: Vec<Op>, // that led here; none for the first
    bytes: usize,            // not shared with the step before; 0 for the first
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
        let scene = Arc::new(scene.without_log());
        let origin = LoggedState::new(&scene);
        let first = UndoStep {
            label: "Open".into(),
            scene,
            ops: Vec::new(),
            bytes: 0,
        };
        Self {
            steps: vec![first],
            at: 0,
            drag: None,
            saved,
            limit_bytes: Self::LIMIT_BYTES,
            author: Author::USER,
            origin,
            next_op: 1,
            opened_until: OpId(0),
        }
    }

    /// Names the maker of the changes from now on; returns the one before.
    pub fn set_author(&mut self, author: Author) -> Author {
        std::mem::replace(&mut self.author, author)
    }

    /// The state that is shown, with the drag in progress: views draw it, and generation starts from it.
    pub fn scene(&self) -> &Arc<Scene> {
        let drag = self.drag.as_ref().map(|drag| &drag.scene);
        drag.unwrap_or(&self.steps[self.at].scene)
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
        let before = self.settled_scene().clone();
        let next = Arc::new(next);
        self.push(label.into(), next.clone(), || numbered(edits, &before, &next));
        Ok(())
    }

    /// Shows the edit on top of the state in which the drag began. The first call begins the drag. Call it again whenever
    /// the pointer moves, with the whole change since the beginning. On error the previous preview stays.
    pub fn preview(&mut self, edit: &Edit) -> Result<(), EditError> {
        self.preview_all(std::slice::from_ref(edit))
    }

    /// Like [`Self::preview`], with several edits.
    pub fn preview_all(&mut self, edits: &[Edit]) -> Result<(), EditError> {
        self.drag = Some(Drag {
            scene: Arc::new(self.edited(edits)?),
            edits: edits.to_vec(),
        });
        Ok(())
    }

    /// True between the first preview and its commit or cancel.
    pub fn is_dragging(&self) -> bool {
        self.drag.is_some()
    }

    /// Makes the last preview one undo step. Without a drag, or without a change, nothing happens.
    pub fn commit_drag(&mut self, label: impl Into<Label>) {
        if let Some(Drag { scene, edits }) = self.drag.take() {
            let before = self.settled_scene().clone();
            self.push(label.into(), scene.clone(), || numbered(&edits, &before, &scene));
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
        let (scene, change) = self.with_result(content, occupancy, None)?;
        let content = scene.content();
        let op = self.op(self.steps[self.at].label.clone(), true, change);
        let step = &mut self.steps[self.at];
        step.scene = Arc::new(scene);
        step.ops.push(op);
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
        let (scene, change) = self.with_result(content, occupancy, None)?;
        self.push(label.into(), Arc::new(scene), || change);
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
        let (scene, change) = self.with_result(content, occupancy, Some(Arc::new(background)))?;
        self.push(label.into(), Arc::new(scene), || change);
        Ok(self.settled_scene().content())
    }

    /// The step that is shown, with a generated occupancy, and the change that leads there.
    fn with_result(
        &self,
        content: SceneRev,
        occupancy: VoxelGrid,
        background: Option<Arc<Background>>,
    ) -> Result<(Scene, Change), Stale> {
        let shown = self.settled_scene();
        if self.drag.is_some() || shown.content() != content {
            return Err(Stale);
        }
        let asked = shown.for_generation();
        let patch = VoxelPatch::between(&asked.frame().occupancy, &occupancy).ok_or(Stale)?;
        let scene = with_result(shown, occupancy, background.as_ref()).map_err(|_| Stale)?;
        let patch = Arc::new(patch);
        Ok((scene, Change::Result { patch, background }))
    }

    /// Shows a state that was kept elsewhere (a version), as an undo step. Does nothing if that state is shown already.
    pub fn restore(&mut self, label: impl Into<Label>, scene: &Scene) {
        self.drag = None;
        let scene = Arc::new(scene.clone().without_log());
        let state = self.logged(&scene);
        self.push(label.into(), scene, || Change::Restore(state));
    }

    /// Takes over all that another document did since the state shown here, as one undo step. Errors if the other began with
    /// another state.
    pub fn take_over(&mut self, label: impl Into<Label>, other: Document) -> Result<(), Stale> {
        let label = label.into();
        if self.drag.is_some() || other.origin.scene.content() != self.settled_scene().content() {
            return Err(Stale);
        }
        let scene = other.settled_scene().clone();
        let ops = other
            .steps
            .into_iter()
            .take(other.at + 1)
            .flat_map(|step| step.ops);
        let mut ops = ops.map(|op| (op.shown_s, op.change));
        let Some((shown_s, change)) = ops.next() else {
            return Ok(());
        };
        self.push(label.clone(), scene, || change);
        for (shown_s, change) in ops {
            let op = self.op(label.clone(), true, change);
            self.steps[self.at].ops.push(Op { shown_s, ..op });
        }
        if let Some(op) = self.steps[self.at].ops.first_mut() {
            op.shown_s = shown_s;
        }
        self.weigh(self.at);
        Ok(())
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

    /// A state for the log: the one that the log has already, if there is one.
    pub(crate) fn logged(&self, scene: &Arc<Scene>) -> Arc<LoggedState> {
        let restored = |op: &Op| match &op.change {
            Change::Restore(state) => Some(state.clone()),
            _ => None,
        };
        let in_steps = self.steps.iter().flat_map(|step| &step.ops).filter_map(restored);
        let known = std::iter::once(self.origin.clone()).chain(in_steps);
        let same = |state: &Arc<LoggedState>| state.scene.content() == scene.content();
        known
            .into_iter()
            .find(same)
            .unwrap_or_else(|| LoggedState::new(scene))
    }

    fn edited(&self, edits: &[Edit]) -> Result<Scene, EditError> {
        edited(self.settled_scene(), edits)
    }

    /// Adds a step, if its state differs from the one shown; steps that could be redone go.
    pub(crate) fn push(&mut self, label: Label, scene: Arc<Scene>, change: impl FnOnce() -> Change) {
        if scene.content() == self.settled_scene().content() {
            return;
        }
        self.steps.truncate(self.at + 1);
        let op = self.op(label.clone(), false, change());
        let bytes = scene.bytes_beside(self.settled_scene()) + op.bytes();
        self.steps.push(UndoStep {
            label,
            scene,
            ops: vec![op],
            bytes,
        });
        self.at = self.steps.len() - 1;
        self.forget_oldest();
    }

    /// Forgets the steps that could be redone.
    pub(crate) fn forget_redo(&mut self) {
        self.steps.truncate(self.at + 1);
    }

    /// Puts a change that was replayed behind the last step, or into the step that it joins.
    pub(crate) fn put(&mut self, op: Op, scene: Arc<Scene>) {
        let joined = |step: &UndoStep| step.ops.last().map(|last| last.id) == op.parent;
        let into = match op.joins {
            true => self.steps.iter().rposition(joined),
            false => None,
        };
        let index = into.unwrap_or_else(|| {
            self.steps.push(UndoStep {
                label: op.label.clone(),
                scene: scene.clone(),
                ops: Vec::new(),
                bytes: 0,
            });
            self.steps.len() - 1
        });
        let step = &mut self.steps[index];
        step.scene = scene;
        step.ops.push(op);
        self.weigh(index);
    }

    /// A new change of the state that is shown.
    fn op(&mut self, label: Label, joins: bool, change: Change) -> Op {
        let id = OpId(self.next_op);
        self.next_op += 1;
        Op {
            id,
            parent: self.steps[self.at].ops.last().map(|op| op.id),
            author: self.author.clone(),
            label,
            joins,
            shown_s: self.settled_scene().time_s(),
            change,
        }
    }

    /// Counts again the bytes that a step does not share with the one before it.
    fn weigh(&mut self, index: usize) {
        if let Some([before, step]) = index.checked_sub(1).and_then(|i| self.steps.get_mut(i..=index)) {
            let ops: usize = step.ops.iter().map(Op::bytes).sum();
            step.bytes = step.scene.bytes_beside(&before.scene) + ops;
        }
    }

    pub(crate) fn forget_oldest(&mut self) {
        let (mut bytes, mut gone) = (self.history_bytes(), 0);
        let too_much = |bytes: usize, left: usize| bytes > self.limit_bytes || left > Self::MAX_STEPS;
        while gone + Self::LEAST_UNDO < self.at && too_much(bytes, self.steps.len() - gone) {
            // The next step becomes the oldest one, whose bytes count as 0.
            bytes -= self.steps[gone + 1].bytes;
            gone += 1;
        }
        if gone > 0 {
            self.steps.drain(..gone);
            self.at -= gone;
            self.begin_at_oldest();
        }
    }

    /// Lets the log begin at the oldest step that is left. A step that needs a state or a change that is gone becomes the
    /// state that it led to.
    fn begin_at_oldest(&mut self) {
        let oldest = &mut self.steps[0];
        oldest.bytes = 0;
        self.origin = LoggedState::new(&oldest.scene);
        let last = std::mem::take(&mut oldest.ops).pop().map(|op| op.id);
        let mut known = BTreeSet::new();
        for step in &mut self.steps[1..] {
            let Some(first) = step.ops.first_mut() else {
                continue;
            };
            if first.parent == last {
                first.parent = None;
            } else if first.parent.is_none_or(|parent| !known.contains(&parent)) {
                step.become_state();
            }
            let gone = |op: &Op| match &op.change {
                Change::Without { ops, .. } => ops.iter().any(|id| !known.contains(id)),
                _ => false,
            };
            if step.ops.iter().any(gone) {
                step.become_state();
            }
            known.extend(step.ops.iter().map(|op| op.id));
        }
    }
}

impl UndoStep {
    /// Replaces the changes by one: the state that they led to.
    fn become_state(&mut self) {
        let Some(last) = self.ops.pop() else { return };
        self.ops = vec![Op {
            parent: None,
            joins: false,
            change: Change::Restore(LoggedState::new(&self.scene)),
            ..last
        }];
    }
}

#[cfg(test)]
#[path = "document_tests.rs"]
pub(crate) mod tests;
