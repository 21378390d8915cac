//! Log of a document: written into its file and replayed from there, with steps left out of it, and undone by one of
//! several editors.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;
use std::time::{Duration, Instant};

use crate::document::{Document, UndoStep};
use crate::replay::{Renumbered, Replayed, replay};
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
    /// Left out already.
    #[error("step {0} is left out already")]
    Already(usize),
    /// A step that leaves others out: undo takes it back.
    #[error("step {0} leaves out others, expected another step")]
    LeavesOut(usize),
    /// A step that put another scene or version in place of the whole.
    #[error("step {0} replaced the whole scene, expected another step")]
    Whole(usize),
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
    /// True if [`Document::leave_out`] takes it.
    pub can_leave_out: bool,
}

impl Document {
    /// Memory that a history may take while it is opened; the user's limit comes after that.
    const OPENED_BYTES: usize = 1 << 30;
    /// Longest time that a replay takes before it breaks off.
    const LONGEST_REPLAY: Duration = Duration::from_secs(60);

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
        if let Some(log) = self.log() {
            Arc::make_mut(&mut scene.kept).log = Some(log);
        }
        scene
    }

    /// All steps kept, oldest first; the first is the oldest state itself.
    pub fn history_steps(&self) -> Vec<HistoryStep<'_>> {
        let left_out = self.left_out();
        let mut lines = Vec::with_capacity(self.steps.len());
        for (i, step) in self.steps.iter().enumerate() {
            lines.push(HistoryStep {
                label: &step.label,
                author: step.ops.first().filter(|op| !op.joins).map(|op| &op.author),
                is_left_out: step.ops.iter().any(|op| left_out.contains(&op.id)),
                can_leave_out: self.leaves_out(i, &left_out).is_ok(),
            });
        }
        lines
    }

    /// Replays the history from its origin up to the step shown; true if that gives the same scene.
    /// Errors with the first change that does not apply.
    pub fn replays(&self) -> Result<bool, String> {
        let log = self.log();
        let Some(log) = log else { return Ok(true) };
        let mut again = Self::begun(&log, &self.settled_scene().kept);
        again.play(&log.ops)?;
        let step = again.steps.get(self.at);
        Ok(step.is_some_and(|step| step.scene.is_same(self.settled_scene())))
    }

    /// Leaves a step up to the one shown out of the history: the later ones are applied again where they can be. This is
    /// a step of its own, which undo takes back.
    pub fn leave_out(&mut self, index: usize) -> Result<LeftOut, LeaveOutError> {
        self.leave_out_as(index, false)
    }

    fn leave_out_as(&mut self, index: usize, is_undo: bool) -> Result<LeftOut, LeaveOutError> {
        self.leaves_out(index, &self.left_out())?;
        self.cancel_drag();
        let step = &self.steps[index];
        let ops: Vec<OpId> = step.ops.iter().map(|op| op.id).collect();
        let mut left = LeftOut {
            label: step.label.to_string(),
            skipped: Vec::new(),
            changed: false,
        };
        // A step before a state that replaced the whole is not behind the scene any more.
        let Some((scene, skipped)) = self.without(self.tip(), &ops) else {
            return Ok(left);
        };
        let scene = scene.at(self.settled_scene().time_s());
        if !scene.is_same(self.settled_scene()) {
            left.changed = true;
            left.skipped = skipped;
            let name = if is_undo { "Undo" } else { "Leave out a step" };
            self.push(name.into(), Arc::new(scene), || Change::Without { ops, is_undo });
        }
        Ok(left)
    }

    /// Errors if a step cannot be left out; `left_out` are those that are already.
    fn leaves_out(&self, index: usize, left_out: &BTreeSet<OpId>) -> Result<(), LeaveOutError> {
        let (found, most) = (index, self.at);
        if !(1..=most).contains(&index) {
            return Err(LeaveOutError::NoStep { found, most });
        }
        for op in &self.steps[index].ops {
            match &op.change {
                _ if left_out.contains(&op.id) => return Err(LeaveOutError::Already(index)),
                Change::Without { .. } => return Err(LeaveOutError::LeavesOut(index)),
                Change::Restore(_) => return Err(LeaveOutError::Whole(index)),
                Change::Edits { .. } | Change::Result { .. } => {}
            }
        }
        Ok(())
    }

    /// Takes back the last change of the editor that works on the document now; see [`Self::set_author`]. Changes that others
    /// made since stay. The user takes back those of others too, once none of their own is left. During a drag only the
    /// drag is cancelled (`None`).
    pub fn undo_own(&mut self) -> Option<Undone> {
        if self.is_dragging() {
            self.cancel_drag();
            return None;
        }
        for index in self.to_undo() {
            if index == self.at {
                return self.undo().map(|label| Undone::Back(label.to_owned()));
            }
            // A step that later ones replaced, or that replaced the whole scene, cannot be taken back from under them.
            let left = self.leave_out_as(index, true).ok().filter(|left| left.changed);
            if let Some(left) = left {
                return Some(Undone::LeftOut(left));
            }
        }
        None
    }

    /// Name of the step that [`Self::undo_own`] would take back.
    pub fn undo_own_label(&self) -> Option<&str> {
        let index = self.to_undo().first().copied()?;
        Some(&self.steps[index].label)
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

    /// The step that the present editor took back last from under others, if nothing came after that.
    fn own_left_out(&self) -> Option<usize> {
        let op = self.steps[self.at].ops.first();
        let op = op.filter(|op| op.author == self.author)?;
        let Change::Without { ops, is_undo: true } = &op.change else {
            return None;
        };
        let holds = |step: &UndoStep| step.ops.iter().any(|op| ops.contains(&op.id));
        self.steps.iter().position(holds)
    }

    /// Steps that the present editor may take back, the next one first.
    fn to_undo(&self) -> Vec<usize> {
        let left_out = self.left_out();
        let is_user = self.author == Author::USER;
        let open = |index: &usize| {
            let op = self.steps[*index].ops.first();
            op.is_some_and(|op| match &op.change {
                // Only as the last one: it was made on all that came before.
                Change::Without { is_undo, .. } => !is_undo && *index == self.at,
                _ => !left_out.contains(&op.id),
            })
        };
        let own = |index: &usize| {
            let op = self.steps[*index].ops.first();
            // Steps of earlier sessions are the user's, whoever made them.
            op.is_some_and(|op| match op.id < self.opened_until {
                true => is_user,
                false => op.author == self.author,
            })
        };
        let steps = (1..=self.at).rev().filter(open);
        let (mine, others): (Vec<usize>, Vec<usize>) = steps.partition(own);
        match is_user {
            true => [mine, others].concat(),
            false => mine,
        }
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

    /// A document at the origin of a log; all its states have what their file keeps beside them.
    fn begun(log: &OpLog, kept: &Arc<ProjectHistory>) -> Self {
        let mut origin = Scene::clone(&log.origin.scene);
        origin.kept = kept.clone();
        let mut document = Self::new(origin);
        document.limit_bytes = Self::OPENED_BYTES;
        document.origin = log.origin.clone();
        document.steps[0].label = log.label.clone();
        document
    }

    /// The document that a log leads to, with `scene` as the state shown.
    fn replayed(scene: Scene, log: &OpLog) -> (Self, Option<String>) {
        let mut document = Self::begun(log, &scene.kept);
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
    /// apply, or once it takes longer than [`Self::LONGEST_REPLAY`]; those before it stay.
    fn play(&mut self, ops: &[Op]) -> Result<(), String> {
        let start = Instant::now();
        let kept = self.settled_scene().kept.clone();
        // A state is held until the last change that was made on it.
        let uses = ops.iter().enumerate().map(|(i, op)| (op.parent, i));
        let last_use: BTreeMap<Option<OpId>, usize> = uses.collect();
        let mut states = BTreeMap::from([(None, self.settled_scene().clone())]);
        for (i, op) in ops.iter().enumerate() {
            let named = |reason: &str| format!("{:?}: {reason}", &*op.label);
            if start.elapsed() > Self::LONGEST_REPLAY {
                return Err(named("replaying it takes too long"));
            }
            let before = states.get(&op.parent);
            let before = before.ok_or_else(|| named("the change before it is missing"))?;
            let mut scene = match &op.change {
                Change::Without { ops, .. } => {
                    let left = self.without(op.parent, ops);
                    let (scene, _) = left.ok_or_else(|| named("it leaves out what is not there"))?;
                    scene.at(op.shown_s)
                }
                _ => replay(before, op).map_err(|reason| named(&reason))?.scene,
            };
            scene.kept = kept.clone();
            let scene = Arc::new(scene);
            if last_use.get(&op.parent) == Some(&i) {
                states.remove(&op.parent);
            }
            if last_use.contains_key(&Some(op.id)) {
                states.insert(Some(op.id), scene.clone());
            }
            self.put(op.clone(), scene);
        }
        Ok(())
    }

    /// The state that the changes up to `tip` lead to without some of them and without all that were left out before; and
    /// those that do not apply then, a line each. `None` if none of them led to that state.
    fn without(&self, tip: Option<OpId>, ids: &[OpId]) -> Option<(Scene, Vec<String>)> {
        let chain = self.chain(tip);
        let mut out: BTreeSet<OpId> = ids.iter().copied().collect();
        if !chain.iter().any(|op| out.contains(&op.id)) {
            return None;
        }
        out.extend(chain.iter().filter_map(|op| without_ids(op)).flatten());
        let mut from = chain.iter().position(|op| out.contains(&op.id))?;
        // The nearest state that is there is a step's, or the origin.
        let mut state = loop {
            let Some(before) = from.checked_sub(1) else {
                break self.first_state();
            };
            let is_last = |step: &&UndoStep| step.ops.last().is_some_and(|op| op.id == chain[before].id);
            match self.steps.iter().find(is_last) {
                Some(step) => break step.scene.clone(),
                None => from = before,
            }
        };
        let mut skipped = Vec::new();
        let mut renumbered = Renumbered::default();
        let mut is_skipped = false;
        for op in &chain[from..] {
            if without_ids(op).is_some() {
                continue;
            }
            // The result of an edit goes with it.
            is_skipped = out.contains(&op.id) || op.joins && is_skipped;
            if is_skipped {
                renumbered.note(op);
                continue;
            }
            let again = match renumbered.problem(op) {
                Some(problem) => Err(problem.to_owned()),
                None => replay(&state, op),
            };
            match again {
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
                    renumbered.note(op);
                    is_skipped = true;
                }
            }
        }
        Some((Arc::unwrap_or_clone(state), skipped))
    }

    /// The state before the first change.
    fn first_state(&self) -> Arc<Scene> {
        let mut scene = Scene::clone(&self.origin.scene);
        scene.kept = self.steps[0].scene.kept.clone();
        Arc::new(scene)
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
        Change::Without { ops, .. } => Some(ops),
        _ => None,
    }
}

#[cfg(test)]
#[path = "log_tests.rs"]
mod tests;
