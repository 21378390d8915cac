//! Desk of a session: the document (its own or that of a window), the folder, versions, numbers of revisions, the
//! networks.

use std::collections::{HashMap, HashSet};
use std::path::PathBuf;
use std::sync::Arc;

use anyhow::{Context, bail};
use crossbeam_channel::bounded;
use schemars::JsonSchema;
use serde::Serialize;

use crate::change::ChangeSummary;
use crate::folder::Folder;
pub use app::shell::guests::DocumentTask;
use authoring::new_ground::with_scenery;
use editor::checks::{self, Finding};
use editor::{Document, Edit};
use formats::loom;
use job::pipeline::OccPipeline;
use job::region::edited_columns;
use nets::OccModels;
use scene::op::Author;
use scene::{KeptVersion, Scene, SceneRev};

/// True once the call in progress is not wanted any more.
pub type Stop = Arc<dyn Fn() -> bool + Send + Sync>;

/// Owner of the document.
pub enum Holder {
    /// The session itself.
    Own(Box<Document>),
    /// Another thread, such as that of a window. It is handed tasks, which it does one by one; false if it is gone.
    Elsewhere(Box<dyn FnMut(DocumentTask) -> bool + Send>),
}

impl Holder {
    /// Runs work on the document. Errors if its owner is gone.
    fn with<R: Send + 'static>(
        &mut self,
        work: impl FnOnce(&mut Document) -> R + Send + 'static,
    ) -> anyhow::Result<R> {
        match self {
            Self::Own(document) => Ok(work(document)),
            Self::Elsewhere(hand) => {
                let (answer, answered) = bounded(1);
                let task: DocumentTask = Box::new(move |document| drop(answer.send(work(document))));
                let handed = hand(task);
                let answer = handed.then(|| answered.recv().ok()).flatten();
                answer.context("the window that owns the scene lets nobody in any more")
            }
        }
    }
}

/// Result of a call that may change the scene.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct Done {
    /// Number of the state that the scene is in now. A state that comes back by undo has its old number.
    pub revision: u64,
    /// Name of the undo step; empty if nothing changed.
    pub step: String,
    /// Changes, in numbers.
    pub changed: ChangeSummary,
    /// Columns of voxels, 0.4 x 0.4 m each, that only sketch what was edited; `generate` draws them.
    pub draft_columns: usize,
    /// Warnings to look at, such as findings of the checks that were not there before.
    pub warnings: Vec<String>,
}

/// Warnings that a receipt holds at most.
const MOST_WARNINGS: usize = 8;
/// Numbers of states kept at most: more than there are steps and versions.
const MOST_REVISIONS: usize = 2 * Document::MAX_STEPS;
/// Versions kept at most.
const MOST_VERSIONS: usize = 64;

/// One scene and all that calls need to work on it.
pub struct Desk {
    holder: Holder,
    /// Folder in which files are read and written.
    pub folder: Folder,
    /// Whether the call in progress is still wanted.
    pub stop: Stop,
    weights: Option<PathBuf>,
    pipeline: Option<OccPipeline>,
    revisions: HashMap<SceneRev, u64>,
    /// Number of states that were numbered so far.
    numbered: u64,
    versions: Vec<(String, Arc<Scene>)>,
    /// Findings of the state that was checked last, without sensors.
    checked: Option<(SceneRev, Arc<Vec<Finding>>)>,
}

impl Desk {
    /// On a document, with a folder for files. Networks come from `weights`, or are the bundled ones.
    pub fn new(mut holder: Holder, folder: Folder, weights: Option<PathBuf>) -> Self {
        if let Holder::Own(document) = &mut holder {
            document.set_author(Author::ASSISTANT);
        }
        Self {
            holder,
            folder,
            stop: Arc::new(|| false),
            weights,
            pipeline: None,
            revisions: HashMap::new(),
            numbered: 0,
            versions: Vec::new(),
            checked: None,
        }
    }

    /// The scene as it is now. Errors if the document's owner is gone.
    pub fn scene(&mut self) -> anyhow::Result<Arc<Scene>> {
        self.look(|document| document.settled_scene().clone())
    }

    /// Looks at the document.
    pub fn look<R: Send + 'static>(
        &mut self,
        look: impl FnOnce(&Document) -> R + Send + 'static,
    ) -> anyhow::Result<R> {
        self.holder.with(move |document| look(document))
    }

    /// True if the document is this session's own.
    pub fn is_own(&self) -> bool {
        matches!(self.holder, Holder::Own(_))
    }

    /// Changes the document in a way that is no undo step, or brings its own; returns the result of `work` and the
    /// states before and after.
    pub fn with<R: Send + 'static>(
        &mut self,
        work: impl FnOnce(&mut Document) -> R + Send + 'static,
    ) -> anyhow::Result<(R, [Arc<Scene>; 2])> {
        self.holder.with(move |document| {
            let before = document.settled_scene().clone();
            let out = work(document);
            (out, [before, document.settled_scene().clone()])
        })
    }

    /// Applies edits as one undo step: all of them, or on error none. Where they make the map larger, scenery comes with them as
    /// in the window.
    pub fn apply(&mut self, step: String, edits: Vec<Edit>) -> anyhow::Result<Done> {
        let label = step.clone();
        let ((said, applied), states) = self.with(move |document| {
            let said = editor::remarks(document.settled_scene(), &edits);
            let edits = with_scenery(document.settled_scene(), edits);
            (said, document.apply_all(label, &edits))
        })?;
        applied?;
        let mut done = self.done(step, &states);
        done.warnings.splice(0..0, said);
        Ok(done)
    }

    /// Replaces the state `from` by another state, as one undo step. Errors if the scene has changed since. Findings of
    /// the new state are no warnings: it is another scene, or its maker checks it.
    pub fn put(&mut self, step: String, from: SceneRev, scene: Scene) -> anyhow::Result<Done> {
        let label = step.clone();
        let (is_current, states) = self.with(move |document| {
            let is_current = document.settled_scene().content() == from;
            if is_current {
                document.restore(label, &scene);
            }
            is_current
        })?;
        self.was_put(step, is_current, &states)
    }

    /// Puts what a copy of the document did into the document, as one undo step. Errors if the scene has changed since.
    pub fn take_over(&mut self, step: String, copy: Document) -> anyhow::Result<Done> {
        let label = step.clone();
        let (is_current, states) = self.with(move |document| document.take_over(label, copy).is_ok())?;
        self.was_put(step, is_current, &states)
    }

    fn was_put(&mut self, step: String, is_current: bool, states: &[Arc<Scene>; 2]) -> anyhow::Result<Done> {
        match is_current {
            true => Ok(Done {
                warnings: Vec::new(),
                ..self.done(step, states)
            }),
            false => bail!("the scene was changed in the window meanwhile: nothing was done, call again"),
        }
    }

    /// The receipt of a change.
    pub fn done(&mut self, step: String, [before, after]: &[Arc<Scene>; 2]) -> Done {
        let changed = ChangeSummary::between(before, after);
        self.number(before.content());
        let differs = before.content() != after.content();
        let warnings = match differs {
            true => self.warnings(before, after),
            false => Vec::new(),
        };
        Done {
            revision: self.number(after.content()),
            step: if differs { step } else { String::new() },
            changed,
            draft_columns: draft_columns(after),
            warnings,
        }
    }

    /// The number of a state: states are numbered from 1 in the order in which this session sees them. One that can come back,
    /// by undo or as a version, keeps its number.
    pub fn number(&mut self, state: SceneRev) -> u64 {
        if let Some(number) = self.revisions.get(&state) {
            return *number;
        }
        self.numbered += 1;
        self.revisions.insert(state, self.numbered);
        let number = self.numbered;
        if self.revisions.len() > MOST_REVISIONS {
            self.forget_revisions(state);
        }
        number
    }

    /// Forgets the numbers of states that are gone for good, other than `newest`.
    fn forget_revisions(&mut self, newest: SceneRev) {
        // (if the document's owner is gone, no old state comes back)
        let steps = self.look(|document| document.contents().collect::<Vec<_>>());
        let mut there: HashSet<SceneRev> = steps.unwrap_or_default().into_iter().collect();
        there.extend(self.versions.iter().map(|(_, scene)| scene.content()));
        there.insert(newest);
        self.revisions.retain(|state, _| there.contains(state));
    }

    /// The open findings of the checks that need no sensors.
    fn findings(&mut self, scene: &Scene) -> Arc<Vec<Finding>> {
        if let Some((of, found)) = &self.checked
            && *of == scene.rev
        {
            return found.clone();
        }
        let found = checks::run_checks(scene, None);
        let open = checks::waive::open(scene.frame(), &found).cloned().collect();
        let found: Arc<Vec<Finding>> = Arc::new(open);
        self.checked = Some((scene.rev, found.clone()));
        found
    }

    /// Findings that are new in a later state of the same scene.
    fn warnings(&mut self, before: &Scene, after: &Scene) -> Vec<String> {
        let known: Vec<_> = self.findings(before).iter().map(same).collect();
        let found = self.findings(after);
        let new: Vec<&Finding> = found.iter().filter(|f| !known.contains(&same(f))).collect();
        let mut out: Vec<String> = new.iter().take(MOST_WARNINGS).map(|f| told(f)).collect();
        if new.len() > MOST_WARNINGS {
            let more = new.len() - MOST_WARNINGS;
            out.push(format!("{more} more findings; check lists them"));
        }
        out
    }

    /// The networks, read when they are first asked for.
    pub fn pipeline(&mut self) -> anyhow::Result<&mut OccPipeline> {
        if self.pipeline.is_none() {
            let models = OccModels::open(self.weights.as_deref())?;
            self.pipeline = Some(OccPipeline::new(models));
        }
        self.pipeline.as_mut().context("no networks")
    }

    /// The scene as it is saved: its file keeps the history and the versions of this session, with their names and a star.
    pub fn to_save(&mut self) -> anyhow::Result<Scene> {
        let mut scene = self.look(Document::to_save)?;
        let kept = Arc::make_mut(&mut scene.kept);
        kept.versions
            .retain(|v| self.versions.iter().all(|(name, _)| *name != v.name));
        for (name, version) in &self.versions {
            kept.versions.push(KeptVersion {
                name: name.clone(),
                label: "Kept in a session".into(),
                note: String::new(),
                starred: true,
                loom: Arc::new(loom::alone_to_bytes(version)?),
            });
        }
        Ok(scene)
    }

    /// Takes over the named versions that a scene's file keeps, as far as there is room and they can be read.
    pub fn take_versions(&mut self, scene: &Scene) {
        for kept in scene.kept.versions.iter().filter(|v| !v.name.is_empty()) {
            if let Ok(version) = loom::from_bytes(&kept.loom)
                && self
                    .keep(kept.name.clone(), Arc::new(version.with_sweeps_of(scene)))
                    .is_err()
            {
                return;
            }
        }
    }

    /// States kept under a name, the oldest first.
    pub fn versions(&self) -> &[(String, Arc<Scene>)] {
        &self.versions
    }

    /// The state kept under a name.
    pub fn version(&self, name: &str) -> anyhow::Result<Arc<Scene>> {
        let found = self.versions.iter().find(|(of, _)| of == name);
        found.map(|(_, scene)| scene.clone()).with_context(|| {
            let names: Vec<&str> = self.versions.iter().map(|(of, _)| of.as_str()).collect();
            match names.is_empty() {
                true => format!("no version {name:?}: none was kept yet"),
                false => format!("no version {name:?}, expected one of {}", names.join(", ")),
            }
        })
    }

    /// Keeps a state under a name; another of that name goes. Errors if there are as many as are kept.
    pub fn keep(&mut self, name: String, scene: Arc<Scene>) -> anyhow::Result<()> {
        let others = self.versions.iter().filter(|(of, _)| *of != name).count();
        if others >= MOST_VERSIONS {
            bail!("{others} versions are kept already, expected fewer than {MOST_VERSIONS}");
        }
        self.versions.retain(|(of, _)| *of != name);
        self.versions.push((name, scene));
        Ok(())
    }
}

/// Key that tells findings apart; numbers in their texts may change.
fn same(f: &Finding) -> (&'static str, Option<scene::BoxId>, [i64; 3]) {
    let place = match f.box_id {
        Some(_) => [0; 3],
        None => f.where_m.to_array().map(|v| v.round() as i64),
    };
    (f.check, f.box_id, place)
}

/// The text of a finding in a line.
fn told(f: &Finding) -> String {
    let [x, y, _] = f.where_m.to_array();
    let of_box = f.box_id.map_or(String::new(), |id| format!(", box {}", id.0));
    format!(
        "{}: {} [{}{of_box}] at {x:.1}, {y:.1} m",
        f.severity.name(),
        f.text,
        f.check
    )
}

/// Columns that the networks have not drawn since they were edited.
pub fn draft_columns(scene: &Scene) -> usize {
    let of = scene.for_generation();
    edited_columns(of.frame(), 0).iter().filter(|c| **c).count()
}

#[cfg(test)]
mod tests {
    use super::*;
    use scene::{Frame, VoxelGrid};

    fn desk() -> (tempfile::TempDir, Desk) {
        let dir = tempfile::tempdir().expect("a folder");
        let folder = Folder::new(dir.path()).expect("a folder");
        let frame = Frame::new(Default::default(), Default::default(), VoxelGrid::new());
        let scene = Scene::single("s", frame, Arc::default(), 0);
        let document = Box::new(Document::new(scene));
        (dir, Desk::new(Holder::Own(document), folder, None))
    }

    #[test]
    fn numbers_of_states_that_are_gone_for_good_are_forgotten_and_those_that_come_back_are_not() {
        let (_dir, mut desk) = desk();
        let first = desk.scene().expect("a scene");
        assert_eq!(desk.number(first.content()), 1);
        let kept = Arc::new(Scene::clone(&first));
        let version = {
            let mut other = Scene::clone(&kept);
            other.touch();
            Arc::new(other)
        };
        assert_eq!(desk.number(version.content()), 2);
        desk.keep("v".into(), version.clone()).expect("room");
        for i in 0..3 * MOST_REVISIONS as u64 {
            assert_eq!(desk.number(SceneRev::fresh()), i + 3, "no number twice");
            assert!(desk.revisions.len() <= MOST_REVISIONS + 1);
        }
        assert_eq!(desk.number(first.content()), 1, "undo could bring it back");
        assert_eq!(desk.number(version.content()), 2);
    }
}
