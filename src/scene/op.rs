//! Log of a document: every change as a value, with its author and the change before it. The editor makes and replays it;
//! the project file keeps it.

use std::borrow::Cow;
use std::collections::BTreeSet;
use std::sync::{Arc, OnceLock};

use serde::{Deserialize, Serialize};

use crate::grid::VoxelPatch;
use crate::{Background, Edit, Scene, ThingId};

/// Number of a change within its log.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
pub struct OpId(pub u64);

/// Name of the editor that made a change. Editors that share a document undo their own changes.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(transparent)]
pub struct Author(pub Cow<'static, str>);

impl Author {
    /// Longest name, characters.
    pub const LONGEST: usize = 40;
    /// The user in a window, or on the command line.
    pub const USER: Self = Self(Cow::Borrowed("user"));
    /// An assistant, or another program that makes calls.
    pub const ASSISTANT: Self = Self(Cow::Borrowed("assistant"));

    /// The name.
    pub fn name(&self) -> &str {
        &self.0
    }
}

/// One change of a document.
#[derive(Clone, Debug)]
pub struct Op {
    /// Its number.
    pub id: OpId,
    /// The change before it; none before the first.
    pub parent: Option<OpId>,
    /// Maker of the change.
    pub author: Author,
    /// Name of its undo step.
    pub label: Cow<'static, str>,
    /// True if it belongs to the undo step of its parent: a result that came after its edit.
    pub joins: bool,
    /// Moment that was shown, s: an edit is of that moment.
    pub shown_s: f64,
    /// The change itself.
    pub change: Change,
}

/// Kinds of a change.
#[derive(Clone, Debug)]
pub enum Change {
    /// Edits, applied in order.
    Edits {
        /// The edits; boxes that they add bear their numbers.
        edits: Arc<[Edit]>,
        /// Number of the first thing that they add, if they add any.
        things_from: Option<ThingId>,
    },
    /// A generated occupancy, and scenery that came with it.
    Result {
        /// Difference from the occupancy of [`Scene::for_generation`]'s frame.
        patch: Arc<VoxelPatch>,
        /// Scenery from then on, if it changed.
        background: Option<Arc<Background>>,
    },
    /// Another state as a whole: a version, or a scene that was made elsewhere.
    Restore(Arc<LoggedState>),
    /// Earlier changes left out, and those after them applied again.
    Without {
        /// The changes that are left out.
        ops: Vec<OpId>,
        /// True if their maker took them back by undo, behind changes of others.
        is_undo: bool,
    },
}

impl Op {
    /// Memory that it takes, bytes, about; states are counted by their file, if they have one yet.
    pub fn bytes(&self) -> usize {
        let of_edit = |edit: &Edit| match edit {
            Edit::PaintVoxels { cells, .. } | Edit::UnlockVoxels { cells } => size_of_val(&cells[..]),
            Edit::SetShape { cells, .. } => size_of_val(&cells[..]),
            Edit::AddThings { forms } | Edit::DrawScenery { forms } => size_of_val(&forms[..]),
            _ => 0,
        };
        let inside = match &self.change {
            Change::Edits { edits, .. } => edits.iter().map(|e| size_of::<Edit>() + of_edit(e)).sum(),
            Change::Result { patch, .. } => 4 * patch.voxels() + size_of_val(patch.bricks()),
            Change::Restore(state) => state.file().map_or(0, |file| file.len()),
            Change::Without { ops, .. } => size_of_val(&ops[..]),
        };
        size_of::<Self>() + inside
    }
}

/// A state of the scene in a log. Its bytes as a file are kept once they were made.
#[derive(Debug)]
pub struct LoggedState {
    /// The state.
    pub scene: Arc<Scene>,
    file: OnceLock<Arc<Vec<u8>>>,
}

impl LoggedState {
    /// A state that no file holds yet.
    pub fn new(scene: &Arc<Scene>) -> Arc<Self> {
        Arc::new(Self {
            scene: scene.clone(),
            file: OnceLock::new(),
        })
    }

    /// A state that was read from a file of its own.
    pub fn read(scene: Scene, file: Arc<Vec<u8>>) -> Arc<Self> {
        Arc::new(Self {
            scene: Arc::new(scene),
            file: OnceLock::from(file),
        })
    }

    /// Its bytes as a file, if they were made already.
    pub fn file(&self) -> Option<&Arc<Vec<u8>>> {
        self.file.get()
    }

    /// Its bytes as a file; `pack` makes them the first time.
    pub fn packed<E>(&self, pack: impl FnOnce(&Scene) -> Result<Vec<u8>, E>) -> Result<Arc<Vec<u8>>, E> {
        if let Some(file) = self.file.get() {
            return Ok(file.clone());
        }
        let bytes = Arc::new(pack(&self.scene)?);
        Ok(self.file.get_or_init(|| bytes).clone())
    }
}

/// Changes of a document since a state, in order.
#[derive(Clone, Debug)]
pub struct OpLog {
    /// State before the first change.
    pub origin: Arc<LoggedState>,
    /// Name of that state in the history.
    pub label: Cow<'static, str>,
    /// The changes.
    pub ops: Vec<Op>,
    /// Undo steps up to the state that the file shows; changes after it can be redone.
    pub at: usize,
}

impl OpLog {
    /// Most changes of a log.
    pub const MAX_OPS: usize = 10_000;
    /// Most changes to be applied again because others before them were left out.
    pub const MOST_AGAIN: usize = 100_000;

    /// Number of undo steps.
    pub fn steps(&self) -> usize {
        self.ops.iter().filter(|op| !op.joins).count()
    }

    /// The first problem with the order of its changes, in one line; `None` if it is sound.
    pub fn problem(&self) -> Option<String> {
        let (found, most) = (self.ops.len(), Self::MAX_OPS);
        if found > most {
            return Some(format!("{found} changes, expected at most {most}"));
        }
        let mut known: BTreeSet<OpId> = BTreeSet::new();
        let mut last: Option<&Op> = None;
        let (mut withouts, mut again) = (0usize, 0usize);
        for op in &self.ops {
            let id = op.id.0;
            if let Some(parent) = op.parent.filter(|parent| !known.contains(parent)) {
                return Some(format!(
                    "change {id} follows change {}, which is not before it",
                    parent.0
                ));
            }
            if op.joins && op.parent != last.map(|last| last.id) {
                return Some(format!("change {id} joins another step than the last"));
            }
            if let Change::Without { ops, .. } = &op.change {
                if let Some(missing) = ops.iter().find(|id| !known.contains(*id)) {
                    return Some(format!(
                        "change {id} leaves out change {}, which is not before it",
                        missing.0
                    ));
                }
                withouts += 1;
                again += known.len();
            }
            if !known.insert(op.id) || id == u64::MAX {
                return Some(format!("change {id} is there twice, or beyond all numbers"));
            }
            if !op.shown_s.is_finite() {
                return Some(format!("change {id} is of no moment"));
            }
            last = Some(op);
        }
        // Each of them applies those after it again.
        let most = Self::MOST_AGAIN;
        if again > most {
            return Some(format!(
                "{withouts} changes leave out others, which is {again} changes to apply again, expected at most {most}"
            ));
        }
        let (at, steps) = (self.at, self.steps());
        (at > steps).then(|| format!("step {at} is shown, but there are {steps}"))
    }
}
