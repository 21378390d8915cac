//! Log of a document: written into its file and replayed from there, with steps left out of it, and undone by one of
//! several editors.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

use crate::document::{Document, UndoStep};
use crate::replay::{Replayed, replay};
use language::{t, tf};
use scene::op::{Author, Change, LoggedState, Op, OpId, OpLog};
use scene::{ProjectHistory, Scene};

/// A step that was left out of a history, and the later steps that could not follow.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct LeftOut {
    /// Name of the step.
    pub label: String,
    /// Later steps that do not apply without it, with the reason, a line each.
    pub skipped: Vec<String>,
    /// True if the scene is another one now; false if later steps replace all that the step did.
    pub changed: bool,
}

/// A step that cannot be left out.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum LeaveOutError {
    /// No step of that number.
    #[error("step {found} does not exist, expected 1 to {most}")]
    NoStep {
        /// Number asked for.
        found: usize,
        /// Number of the step that is shown.
        most: usize,
    },
    /// Left out already, or itself a step that leaves others out.
    #[error("step {0} is left out already, or leaves out others")]
    Already(usize),
}

/// One step back, for an editor that shares its document.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Undone {
    /// The last step was its own: the state before it is shown.
    Back(String),
    /// Others changed the scene since: its own last step was left out.
    LeftOut(LeftOut),
}

/// A line of the history.
#[derive(Clone, Copy, Debug)]
pub struct HistoryStep<'a> {
    /// Name.
    pub label: &'a str,
    /// Maker; none for the state that was opened.
    pub author: Option<&'a Author>,
    /// True if a later step leaves it out.
    pub is_left_out: bool,
}

impl Document {
    /// A document with the history that its file keeps, if there is one: undo goes on where it was saved. A history that
    /// this program replays to another state is kept as far as it goes, and said in a line.
    pub fn open(scene: Scene) -> (Self, Option<String>) {
        let ProjectHistory { log, log_problem, .. } = &*scene.kept;
        let problem = match (log_problem, log) {
            (Some(problem), _) => Some(problem.to_string()),
            (None, Some(log)) => log.problem(),
            (None, None) => None,
        };
        match (problem, log.clone()) {
            (Some(problem), _) => {
                let text = tf!(
                    "The history of the file is not used: {problem}",
                    problem = problem
                );
                (Self::new(scene), Some(text))
            }
            (None, Some(log)) => Self::replayed(scene, &log),
            (None, None) => (Self::new(scene), None),
        }
    }

    /// The log for a file of the state shown; none if nothing was changed.
    pub fn log(&self) -> Option<Arc<OpLog>> {
        let ops = self.steps.iter().flat_map(|step| step.ops.iter().cloned());
        let log = OpLog {
            origin: self.origin.clone(),
            label: self.steps[0].label.clone(),
            ops: ops.collect(),
            at: self.at,
        };
        (!log.ops.is_empty()).then(|| Arc::new(log))
    }

    /// The state shown, with the log as its file keeps it.
    pub fn to_save(&self) -> Scene {
        let mut scene = Scene::clone(self.settled_scene());
        Arc::make_mut(&mut scene.kept).log = self.log();
        scene
    }

    /// All steps kept, oldest first; the first is the oldest state itself.
    pub fn history_steps(&self) -> Vec<HistoryStep<'_>> {
        let left_out = self.left_out();
        let mut lines = Vec::with_capacity(self.steps.len());
        for step in &self.steps {
            lines.push(HistoryStep {
                label: &step.label,
                author: step.ops.first().filter(|op| !op.joins).map(|op| &op.author),
                is_left_out: step.ops.iter().any(|op| left_out.contains(&op.id)),
            });
        }
        lines
    }

    /// Replays the history from its origin up to the step shown; true if that gives the same scene.
    /// Errors with the first change that does not apply.
    pub fn replays(&self) -> Result<bool, String> {
        let log = self.log();
        let Some(log) = log else { return Ok(true) };
        let mut again = Self::begun(&log);
        again.play(&log.ops)?;
        let step = again.steps.get(self.at);
        Ok(step.is_some_and(|step| step.scene.is_same(self.settled_scene())))
    }

    /// Leaves a step up to the one shown out of the history: the later ones are applied again where they can be. This is
    /// a step of its own, which undo takes back.
    pub fn leave_out(&mut self, index: usize) -> Result<LeftOut, LeaveOutError> {
        let (found, most) = (index, self.at);
        if !(1..=most).contains(&index) {
            return Err(LeaveOutError::NoStep { found, most });
        }
        self.cancel_drag();
        let step = &self.steps[index];
        let ids: Vec<OpId> = step.ops.iter().map(|op| op.id).collect();
        let label = step.label.to_string();
        let leaves_out = step.ops.iter().any(|op| matches!(op.change, Change::Without(_)));
        let left_out = self.left_out();
        if leaves_out || ids.iter().any(|id| left_out.contains(id)) {
            return Err(LeaveOutError::Already(index));
        }
        let (scene, skipped) = self
            .without(self.tip(), &ids)
            .map_err(|_| LeaveOutError::Already(index))?;
        let scene = scene.at(self.settled_scene().time_s());
        let changed = !scene.is_same(self.settled_scene());
        if changed {
            self.push("Leave out a step".into(), Arc::new(scene), || {
                Change::Without(ids)
            });
        }
        Ok(LeftOut {
            label,
            skipped,
            changed,
        })
    }

    /// Takes back the last change of the editor that works on the document now; see [`Self::set_author`]. Changes that others
    /// made since stay. The user takes back those of others too, once none of their own is left. During a drag only the
    /// drag is cancelled (`None`).
    pub fn undo_own(&mut self) -> Option<Undone> {
        if self.is_dragging() {
            self.cancel_drag();
            return None;
        }
        let index = self.next_to_undo()?;
        if index == self.at {
            return self.undo().map(|label| Undone::Back(label.to_owned()));
        }
        self.leave_out(index).ok().map(Undone::LeftOut)
    }

    /// Name of the step that [`Self::undo_own`] would take back.
    pub fn undo_own_label(&self) -> Option<&str> {
        self.next_to_undo().map(|index| &*self.steps[index].label)
    }

    /// Brings back what [`Self::undo_own`] took back; the name of the step.
    pub fn redo_own(&mut self) -> Option<String> {
        if self.can_redo() || self.is_dragging() {
            return self.redo().map(str::to_owned);
        }
        let label = self.steps[self.own_left_out()?].label.to_string();
        self.undo();
        self.forget_redo();
        Some(label)
    }

    /// Name of the step that [`Self::redo_own`] would bring back.
    pub fn redo_own_label(&self) -> Option<&str> {
        if self.can_redo() {
            return self.redo_label();
        }
        self.own_left_out().map(|index| &*self.steps[index].label)
    }

    /// The step that the one shown leaves out, if the present editor did that.
    fn own_left_out(&self) -> Option<usize> {
        let op = self.steps[self.at].ops.first()?;
        let ids = without_ids(op).filter(|_| op.author == self.author)?;
        let holds = |step: &UndoStep| step.ops.iter().any(|op| ids.contains(&op.id));
        self.steps.iter().position(holds)
    }

    /// The step that the present editor would take back next.
    fn next_to_undo(&self) -> Option<usize> {
        let left_out = self.left_out();
        let is_user = self.author == Author::USER;
        let open = |index: &usize| {
            let op = self.steps[*index].ops.first();
            op.is_some_and(|op| !matches!(op.change, Change::Without(_)) && !left_out.contains(&op.id))
        };
        let own = |index: &usize| {
            let op = self.steps[*index].ops.first();
            // Steps of earlier sessions are the user's, whoever made them.
            op.is_some_and(|op| op.author == self.author || is_user && op.id < self.opened_until)
        };
        let mut open_steps = (1..=self.at).rev().filter(open);
        let last_open = open_steps.clone().next().filter(|_| is_user);
        open_steps.find(own).or(last_open)
    }

    /// Changes that a step up to the one shown leaves out.
    fn left_out(&self) -> BTreeSet<OpId> {
        let ops = self.steps[..=self.at].iter().flat_map(|step| &step.ops);
        ops.filter_map(without_ids).flatten().copied().collect()
    }

    /// The last change that led to the state shown.
    fn tip(&self) -> Option<OpId> {
        self.steps[self.at].ops.last().map(|op| op.id)
    }

    /// A document at the origin of a log.
    fn begun(log: &OpLog) -> Self {
        let mut document = Self::new(Scene::clone(&log.origin.scene));
        document.origin = log.origin.clone();
        document.steps[0].label = log.label.clone();
        document
    }

    /// The document that a log leads to, with `scene` as the state shown.
    fn replayed(scene: Scene, log: &OpLog) -> (Self, Option<String>) {
        let mut document = Self::begun(log);
        let problem = document.play(&log.ops).err();
        document.at = log.at.min(document.steps.len() - 1);
        let shown = Arc::new(scene.without_log());
        let same = document.settled_scene().is_same(&shown);
        let text = match (problem, same) {
            (None, true) => None,
            (Some(problem), _) => Some(tf!(
                "The history of the file breaks off: {problem}",
                problem = problem
            )),
            (None, false) => Some(t("The scene was changed outside the history of its file").to_owned()),
        };
        let next = log.ops.iter().map(|op| op.id.0).max().unwrap_or(0) + 1;
        (document.next_op, document.opened_until) = (next, OpId(next));
        if same {
            let at = document.at;
            document.steps[at].scene = shown;
        } else {
            document.at = document.steps.len() - 1;
            let state = LoggedState::new(&shown);
            let label = "Changed outside the history";
            document.push(label.into(), shown, || Change::Restore(state));
        }
        document.mark_saved();
        document.forget_oldest();
        (document, text)
    }

    /// Applies the changes of a log to the origin, each to the state that it was made on. Errors with the first that does not
    /// apply; those before it stay.
    fn play(&mut self, ops: &[Op]) -> Result<(), String> {
        let mut states: BTreeMap<OpId, Arc<Scene>> = BTreeMap::new();
        for op in ops {
            let named = |reason: String| format!("{:?}: {reason}", &*op.label);
            let before = match op.parent {
                Some(parent) => states.get(&parent).cloned(),
                None => Some(self.origin.scene.clone()),
            };
            let before = before.ok_or_else(|| named("the change before it is missing".into()))?;
            let scene = match &op.change {
                Change::Without(ids) => self.without(op.parent, ids).map_err(named)?.0.at(op.shown_s),
                _ => replay(&before, op).map_err(named)?.scene,
            };
            let scene = Arc::new(scene);
            states.insert(op.id, scene.clone());
            self.put(op.clone(), scene);
        }
        Ok(())
    }

    /// The state that the changes up to `tip` lead to without some of them and without all that were left out before; and
    /// those that do not apply then, a line each. Errors in one line if there is none of them.
    fn without(&self, tip: Option<OpId>, ids: &[OpId]) -> Result<(Scene, Vec<String>), String> {
        let chain = self.chain(tip);
        let mut out: BTreeSet<OpId> = ids.iter().copied().collect();
        out.extend(chain.iter().filter_map(|op| without_ids(op)).flatten());
        let first = chain.iter().position(|op| out.contains(&op.id));
        let mut from = first.ok_or("there is nothing to leave out")?;
        // The nearest state that is there is a step's, or the origin.
        let mut state = loop {
            let Some(before) = from.checked_sub(1) else {
                break self.origin.scene.clone();
            };
            let is_last = |step: &&UndoStep| step.ops.last().is_some_and(|op| op.id == chain[before].id);
            match self.steps.iter().find(is_last) {
                Some(step) => break step.scene.clone(),
                None => from = before,
            }
        };
        let mut skipped = Vec::new();
        let mut is_skipped = false;
        for op in &chain[from..] {
            if matches!(op.change, Change::Without(_)) {
                continue;
            }
            // The result of an edit goes with it.
            is_skipped = out.contains(&op.id) || op.joins && is_skipped;
            if is_skipped {
                continue;
            }
            match replay(&state, op) {
                Ok(Replayed { scene, unmatched }) => {
                    if unmatched > 0 {
                        skipped.push(format!(
                            "{}: {unmatched} voxels of its result do not fit",
                            op.label
                        ));
                    }
                    state = Arc::new(scene);
                }
                Err(reason) => {
                    skipped.push(format!("{}: {reason}", op.label));
                    is_skipped = true;
                }
            }
        }
        Ok((Arc::unwrap_or_clone(state), skipped))
    }

    /// Changes from the origin up to `tip`, each the parent of the next.
    fn chain(&self, tip: Option<OpId>) -> Vec<&Op> {
        let all = self.steps.iter().flat_map(|step| &step.ops);
        let by_id: BTreeMap<OpId, &Op> = all.map(|op| (op.id, op)).collect();
        let (mut chain, mut at) = (Vec::new(), tip);
        while let Some(op) = at.and_then(|id| by_id.get(&id)) {
            chain.push(*op);
            at = op.parent;
        }
        chain.reverse();
        chain
    }
}

/// The changes that a change leaves out, if it does.
fn without_ids(op: &Op) -> Option<&Vec<OpId>> {
    match &op.change {
        Change::Without(ids) => Some(ids),
        _ => None,
    }
}

#[cfg(test)]
#[path = "log_tests.rs"]
mod tests;
