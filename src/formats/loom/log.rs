//! `log.json` and the states and results beside it: the changes of a document, named by the hash of their bytes.

use std::borrow::Cow;
use std::collections::BTreeMap;
use std::io::{Cursor, Read, Seek};
use std::sync::Arc;

use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};

use scene::grid::VoxelPatch;
use scene::message::quoted;
use scene::op::{Author, Change, LoggedState, Op, OpId, OpLog};
use scene::{Background, Edit, Extent, ProjectHistory, Scene, Thing, ThingId};

use super::archive::{MAX_JSON, Reader, Writer, parse, within};
use super::migrate;
use super::patch_bytes::{patch_from_bytes, patch_to_bytes};
use super::read::read_alone;
use super::write::alone_to_bytes;
use super::{LARGEST_FILE, ProjectError};

const LOG: &str = "log.json";
/// All results, one after the other: they resemble each other, so that they pack better together.
const RESULTS: &str = "log/results.voxels";
/// Folder of the states and results.
const FOLDER: &str = "log/";

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct LogHeader {
    /// Hash of the state before the first change.
    origin: String,
    /// Name of that state.
    label: Cow<'static, str>,
    /// Undo steps up to the state of the file.
    at: usize,
    changes: Vec<OpHeader>,
    /// Hashes of the results, in their order, and how many bytes each has.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    results: Vec<(String, usize)>,
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct OpHeader {
    id: OpId,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    parent: Option<OpId>,
    author: Author,
    step: Cow<'static, str>,
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    joins: bool,
    #[serde(default, skip_serializing_if = "is_zero")]
    shown_s: f64,
    change: ChangeHeader,
}

#[derive(Serialize, Deserialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
enum ChangeHeader {
    Edits {
        edits: Arc<[Edit]>,
        #[serde(default, skip_serializing_if = "Option::is_none")]
        things_from: Option<ThingId>,
    },
    Result {
        voxels: String,
        #[serde(default, skip_serializing_if = "Option::is_none")]
        background: Option<Vec<Thing>>,
    },
    Restore(String),
    Without {
        changes: Vec<OpId>,
        #[serde(default, skip_serializing_if = "std::ops::Not::not")]
        is_undo: bool,
    },
}

fn is_zero(number: &f64) -> bool {
    *number == 0.0
}

fn hash(bytes: &[u8]) -> String {
    let digest = Sha256::digest(bytes);
    digest[..16].iter().map(|b| format!("{b:02x}")).collect()
}

fn state_entry(hash: &str) -> String {
    format!("{FOLDER}{hash}.loom")
}

/// Entries of the log that are to be written, by name: equal states and results are one entry.
#[derive(Default)]
struct Blobs {
    states: BTreeMap<String, Arc<Vec<u8>>>,
    patches: BTreeMap<String, Vec<u8>>,
}

impl Blobs {
    fn state(&mut self, state: &LoggedState) -> Result<String, ProjectError> {
        let bytes = state.packed(alone_to_bytes)?;
        let name = hash(&bytes);
        self.states.insert(name.clone(), bytes);
        Ok(name)
    }

    fn change(&mut self, change: &Change) -> Result<ChangeHeader, ProjectError> {
        Ok(match change {
            Change::Edits { edits, things_from } => ChangeHeader::Edits {
                edits: edits.clone(),
                things_from: *things_from,
            },
            Change::Result { patch, background } => {
                let bytes = patch_to_bytes(patch);
                let voxels = hash(&bytes);
                self.patches.insert(voxels.clone(), bytes);
                let background = background.as_ref().map(|things| things.iter().cloned().collect());
                ChangeHeader::Result { voxels, background }
            }
            Change::Restore(state) => ChangeHeader::Restore(self.state(state)?),
            Change::Without { ops, is_undo } => ChangeHeader::Without {
                changes: ops.clone(),
                is_undo: *is_undo,
            },
        })
    }
}

/// The entries of a log.
struct Packed {
    header: Vec<u8>,
    states: BTreeMap<String, Arc<Vec<u8>>>,
    results: Vec<u8>,
}

/// Writes the log, if there is one. A log that is too large for a file, or not sound, is left out: the scene is worth more.
pub(super) fn write(out: &mut Writer, kept: &ProjectHistory) -> Result<(), ProjectError> {
    let Some(log) = &kept.log else { return Ok(()) };
    let packed = match packed(log, kept) {
        Ok(packed) => packed,
        Err(problem) => {
            tracing::warn!("the history is left out of the file: {problem}");
            return Ok(());
        }
    };
    out.put(LOG, &packed.header)?;
    for (name, bytes) in &packed.states {
        out.packed(&state_entry(name), bytes)?;
    }
    if !packed.results.is_empty() {
        out.put(RESULTS, &packed.results)?;
    }
    Ok(())
}

/// The entries of a log. States that are versions of the file too are written once, as those.
fn packed(log: &OpLog, kept: &ProjectHistory) -> Result<Packed, ProjectError> {
    if let Some(problem) = log.problem() {
        return Err(ProjectError::Unsound(problem));
    }
    let mut blobs = Blobs::default();
    let origin = blobs.state(&log.origin)?;
    let op = |op: &Op| {
        Ok(OpHeader {
            id: op.id,
            parent: op.parent,
            author: op.author.clone(),
            step: op.label.clone(),
            joins: op.joins,
            shown_s: op.shown_s,
            change: blobs.change(&op.change)?,
        })
    };
    let changes = log.ops.iter().map(op).collect::<Result<_, ProjectError>>()?;
    let lengths = blobs.patches.iter();
    let header = LogHeader {
        origin,
        label: log.label.clone(),
        at: log.at,
        changes,
        results: lengths.map(|(name, bytes)| (name.clone(), bytes.len())).collect(),
    };
    let header = serde_json::to_vec(&header).map_err(|e| ProjectError::Json {
        entry: LOG.into(),
        detail: e.to_string(),
    })?;
    within("the size of log.json", header.len() as u64, MAX_JSON)?;
    for version in &kept.versions {
        blobs.states.remove(&hash(&version.loom));
    }
    let results: Vec<u8> = blobs.patches.into_values().flatten().collect();
    let states: usize = blobs.states.values().map(|bytes| bytes.len()).sum();
    let bytes = (states + results.len()) as u64;
    within("the size of the history", bytes, LARGEST_FILE / 4)?;
    Ok(Packed {
        header,
        states: blobs.states,
        results,
    })
}

/// Reads the log into `kept`, which has the versions already. A log that is not sound is no reason to refuse the scene: the
/// problem is kept in its place.
pub(super) fn read<R: Read + Seek>(file: &mut Reader<R>, kept: &mut ProjectHistory) {
    if file.has(LOG) {
        match read_log(file, kept) {
            Ok(log) => kept.log = Some(Arc::new(log)),
            Err(problem) => kept.log_problem = Some(problem.to_string().into()),
        }
    }
    file.forget(FOLDER);
}

fn read_log<R: Read + Seek>(file: &mut Reader<R>, kept: &ProjectHistory) -> Result<OpLog, ProjectError> {
    let header: LogHeader = parse(LOG, &file.bytes(LOG, MAX_JSON)?)?;
    let versions = kept.versions.iter().map(|v| (hash(&v.loom), v.loom.clone()));
    let mut found = Found {
        versions: versions.collect(),
        states: BTreeMap::new(),
        voxels: 0,
        patches: read_results(file, &header.results)?,
        file,
    };
    let origin = found.state(&header.origin)?;
    let op = |op: OpHeader| {
        Ok(Op {
            id: op.id,
            parent: op.parent,
            author: Author(quoted(op.author.name(), Author::LONGEST).into()),
            label: quoted(&op.step, Scene::LONGEST_NAME).into(),
            joins: op.joins,
            shown_s: op.shown_s,
            change: found.change(op.change)?,
        })
    };
    let ops = header
        .changes
        .into_iter()
        .map(op)
        .collect::<Result<_, ProjectError>>()?;
    let log = OpLog {
        origin,
        label: quoted(&header.label, Scene::LONGEST_NAME).into(),
        ops,
        at: header.at,
    };
    match log.problem() {
        Some(problem) => Err(ProjectError::Unsound(format!("{LOG}: {problem}"))),
        None => Ok(log),
    }
}

/// The results by their hashes.
fn read_results<R: Read + Seek>(
    file: &mut Reader<R>,
    results: &[(String, usize)],
) -> Result<BTreeMap<String, Arc<VoxelPatch>>, ProjectError> {
    let mut patches = BTreeMap::new();
    if results.is_empty() {
        return Ok(patches);
    }
    let damaged = |detail: String| ProjectError::Damaged {
        entry: RESULTS.into(),
        detail,
    };
    let all = file.bytes(RESULTS, LARGEST_FILE)?;
    let mut left = &all[..];
    for (name, length) in results {
        let (bytes, rest) = left
            .split_at_checked(*length)
            .ok_or_else(|| damaged("cut short".into()))?;
        if hash(bytes) != *name {
            return Err(damaged("its bytes are others than their hash says".into()));
        }
        let patch = patch_from_bytes(bytes).map_err(damaged)?;
        patches.insert(name.clone(), Arc::new(patch));
        left = rest;
    }
    Ok(patches)
}

/// States and results of a log, each read once.
struct Found<'a, R> {
    file: &'a mut Reader<R>,
    versions: BTreeMap<String, Arc<Vec<u8>>>,
    states: BTreeMap<String, Arc<LoggedState>>,
    /// Voxels of all states that were read: a small file could hold many large maps.
    voxels: usize,
    patches: BTreeMap<String, Arc<VoxelPatch>>,
}

impl<R: Read + Seek> Found<'_, R> {
    fn state(&mut self, name: &str) -> Result<Arc<LoggedState>, ProjectError> {
        if let Some(state) = self.states.get(name) {
            return Ok(state.clone());
        }
        let bytes = match self.versions.get(name) {
            Some(version) => version.clone(),
            None => Arc::new(self.file.bytes(&state_entry(name), LARGEST_FILE)?),
        };
        if hash(&bytes) != name {
            return Err(ProjectError::Damaged {
                entry: quoted(&state_entry(name), 80),
                detail: "its bytes are others than its name says".into(),
            });
        }
        let scene = read_alone(Cursor::new(&bytes[..]), &migrate::ALL)?;
        self.voxels += scene.canvas().extent().voxels();
        within(
            "the number of voxels of all states",
            self.voxels as u64,
            2 * Extent::MAX_VOXELS as u64,
        )?;
        let state = LoggedState::read(scene, bytes);
        self.states.insert(name.to_owned(), state.clone());
        Ok(state)
    }

    fn change(&mut self, change: ChangeHeader) -> Result<Change, ProjectError> {
        Ok(match change {
            ChangeHeader::Edits { edits, things_from } => Change::Edits { edits, things_from },
            ChangeHeader::Result { voxels, background } => {
                let missing =
                    || ProjectError::Unsound(format!("{LOG}: the result {} is missing", quoted(&voxels, 40)));
                let patch = self.patches.get(&voxels).cloned().ok_or_else(missing)?;
                let background = background.map(|things| {
                    let count = things.len();
                    let background: Background = things.into_iter().collect();
                    match (background.len() == count, background.problem()) {
                        (true, None) => Ok(Arc::new(background)),
                        (false, _) => Err(ProjectError::Unsound(format!(
                            "{LOG}: two things of a result have the same id"
                        ))),
                        (true, Some(problem)) => Err(ProjectError::Unsound(format!("{LOG}: {problem}"))),
                    }
                });
                Change::Result {
                    patch,
                    background: background.transpose()?,
                }
            }
            ChangeHeader::Restore(name) => Change::Restore(self.state(&name)?),
            ChangeHeader::Without { changes, is_undo } => Change::Without {
                ops: changes,
                is_undo,
            },
        })
    }
}
