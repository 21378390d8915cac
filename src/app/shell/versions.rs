//! Versions of the scene: the result of each generation, kept to view it, compare with it and go back to it. They are
//! saved in the scene's file, with names and stars.

use std::path::Path;
use std::sync::{Arc, OnceLock};

use egui::TextureHandle;
use rayon::prelude::*;

use super::made_with::MadeWith;
use editor::Document;
use editor::checks::SeverityCounts;
use formats::loom;
use formats::recipe::{self, Recipe};
use language::{t, tf};
use runtime::guard::Handed;
use scene::{KeptVersion, Scene, SceneRev};

/// Label of a version that the user kept.
const KEPT: &str = "Kept";
/// Name under which panics of packing are reported.
const THREAD: &str = "versions";

/// A version as bytes for a file; `None` inside if it cannot be packed.
type Packed = OnceLock<Option<Arc<Vec<u8>>>>;

/// A scene as it was after a generation, or as it was opened.
pub struct Version {
    /// Name given by the user; empty if there is none.
    pub name: String,
    /// Label of the edit that led to it.
    pub label: String,
    /// Receipt of the generation.
    pub note: String,
    /// The scene.
    pub scene: Arc<Scene>,
    /// True if the user starred it.
    pub starred: bool,
    /// Picture of its occupancy from above.
    pub(crate) thumbnail: Option<TextureHandle>,
    /// Settings that it was made with, if it was generated and they are known.
    pub made: Option<MadeWith>,
    /// Counts of its findings, once it was on screen long enough to be checked.
    pub findings: Option<SeverityCounts>,
    packed: Arc<Packed>,
}

impl Version {
    fn new(label: String, note: String, scene: Arc<Scene>) -> Self {
        Self {
            name: String::new(),
            label,
            note,
            scene,
            starred: false,
            thumbnail: None,
            made: None,
            findings: None,
            packed: Arc::default(),
        }
    }

    /// Hands its scene to the thread that packs it.
    fn to_pack(&self) -> Handed<Arc<Scene>> {
        Handed::new(THREAD, self.scene.clone())
    }

    /// Its title: its name, else the label of the edit that led to it.
    pub fn title(&self) -> &str {
        if self.name.is_empty() {
            &self.label
        } else {
            &self.name
        }
    }
}

/// Packs a version. Runs on shared threads, where a panic that is not caught would end the program.
fn pack(scene: Handed<Arc<Scene>>) -> Option<Arc<Vec<u8>>> {
    match scene.run(|scene| loom::alone_to_bytes(&scene)) {
        Ok(Ok(bytes)) => return Some(Arc::new(bytes)),
        Ok(Err(error)) => tracing::warn!("a version cannot be kept: {error}"),
        Err(panic) => tracing::error!("a version cannot be kept: {panic}"),
    }
    None
}

/// A scene that was read, with the versions that its file keeps.
pub struct VersionedScene {
    /// The scene.
    pub scene: Scene,
    /// The scene with the history of its file.
    pub document: Document,
    /// The versions, the oldest first.
    pub versions: Vec<Version>,
    /// Number of versions that cannot be read.
    pub damaged: usize,
    /// Settings that the scene was made with, from a picture that was opened.
    pub made: Option<MadeWith>,
    /// Notes for the user about how the file was read, a line each.
    pub notes: Vec<String>,
}

impl From<authoring::open::OpenedScene> for VersionedScene {
    fn from(found: authoring::open::OpenedScene) -> Self {
        let mut opened = Self::from_scene(found.scene);
        opened.notes.splice(0..0, found.notes);
        opened
    }
}

impl From<Scene> for VersionedScene {
    fn from(scene: Scene) -> Self {
        Self::from_scene(scene)
    }
}

impl VersionedScene {
    /// Opens all versions, about 10 ms for each, and replays the history, a few milliseconds a step.
    pub fn from_scene(scene: Scene) -> Self {
        let own = match scene.kept.versions.is_empty() {
            true => None,
            false => loom::alone_to_bytes(&scene).ok(),
        };
        let version = |kept: &KeptVersion| {
            // The open state shares its memory with its version.
            let found = match own.as_ref() == Some(&kept.loom) {
                true => scene.clone(),
                false => loom::from_bytes(&kept.loom).ok()?.with_sweeps_of(&scene),
            };
            Some(Version {
                name: kept.name.clone(),
                starred: kept.starred,
                packed: Arc::new(OnceLock::from(Some(kept.loom.clone()))),
                made: kept.made().and_then(MadeWith::from_json),
                ..Version::new(kept.label.clone(), kept.said().to_owned(), Arc::new(found))
            })
        };
        let versions: Vec<Version> = scene.kept.versions.par_iter().filter_map(version).collect();
        let (document, note) = Document::open(scene.clone());
        Self {
            damaged: scene.kept.versions.len() - versions.len(),
            versions,
            scene,
            document,
            made: None,
            notes: Vec::from_iter(note),
        }
    }

    /// Adds the settings that the scene was made with, if the file is a picture that carries them.
    pub fn told_by(self, file: &Path) -> Self {
        let is_picture = file.extension().is_some_and(|e| e.eq_ignore_ascii_case("png"));
        let made = || {
            let bytes = std::fs::read(file).ok()?;
            let inside = formats::png::notes_inside(&bytes).ok()?;
            let (_, json) = inside.text.iter().find(|(name, _)| name == recipe::NAME)?;
            let recipe: Recipe = serde_json::from_str(json).ok()?;
            serde_json::from_value(recipe.parameters).ok()
        };
        Self {
            made: if is_picture { made() } else { None },
            ..self
        }
    }
}

/// All versions of the session, the oldest first.
#[derive(Default)]
pub struct Versions {
    list: Vec<Version>,
    /// True if a name, a star or a removal is not saved yet.
    pub(crate) changed: bool,
    /// The version that is being renamed, and the text typed so far.
    pub(crate) renaming: Option<(SceneRev, String)>,
}

impl Versions {
    /// Longest name, characters.
    pub const LONGEST_NAME: usize = 80;
    /// Most versions without star and name. Scenes share equal parts; one takes a few hundred kilobytes.
    pub const MAX: usize = 64;

    /// Notes the findings of a state, if it is a version.
    pub fn note_findings(&mut self, rev: SceneRev, counts: SeverityCounts) {
        if let Some(i) = self.index_of(rev) {
            self.list[i].findings = Some(counts);
        }
    }

    /// The findings of a version in words, with the difference from the last checked version before it: "3 errors, 2
    /// warnings (4 fewer)". `None` if it was not checked.
    pub fn findings_in_words(&self, i: usize) -> Option<String> {
        let now = self.list.get(i)?.findings?;
        let errors = match now.errors {
            0 => None,
            1 => Some(t("1 error").to_owned()),
            n => Some(tf!("{n} errors", n = n)),
        };
        let warnings = match now.warnings {
            0 => None,
            1 => Some(t("1 warning").to_owned()),
            n => Some(tf!("{n} warnings", n = n)),
        };
        let parts: Vec<String> = [errors, warnings].into_iter().flatten().collect();
        let text = if parts.is_empty() {
            t("no findings").to_owned()
        } else {
            parts.join(", ")
        };
        let all = |c: SeverityCounts| c.errors + c.warnings;
        let before = self.list[..i].iter().rev().find_map(|v| v.findings);
        Some(match before.map(|b| (all(now), all(b))) {
            Some((now, before)) if now > before => {
                tf!("{findings} ({n} more)", findings = text, n = now - before)
            }
            Some((now, before)) if now < before => {
                tf!("{findings} ({n} fewer)", findings = text, n = before - now)
            }
            _ => text,
        })
    }

    /// Adds a version, unless a version has the same state. If there are too many, the oldest one without star and name
    /// is dropped.
    pub fn push(&mut self, label: String, note: String, scene: Arc<Scene>) {
        self.push_made(label, note, scene, None);
    }

    /// Adds a version with the settings that it was made with; see [`Self::push`].
    pub fn push_made(&mut self, label: String, note: String, scene: Arc<Scene>, made: Option<MadeWith>) {
        if self.list.iter().any(|v| v.scene.content() == scene.content()) {
            return;
        }
        let version = Version {
            made,
            ..Version::new(label, note, scene)
        };
        let (packed, scene) = (version.packed.clone(), version.to_pack());
        // Packed in advance, so that saving does not wait for it.
        rayon::spawn(move || {
            packed.get_or_init(|| pack(scene));
        });
        self.list.push(version);
        let is_plain = |v: &Version| !v.starred && v.name.is_empty();
        if self.list.iter().filter(|v| is_plain(v)).count() > Self::MAX
            && let Some(oldest) = self.list.iter().position(is_plain)
        {
            self.list.remove(oldest);
        }
    }

    /// Stars the version of a state, adding one if there is none, and asks for its name.
    pub(crate) fn keep(&mut self, scene: &Arc<Scene>) {
        let rev = scene.content();
        self.push(KEPT.to_owned(), String::new(), scene.clone());
        if let Some(i) = self.index_of(rev) {
            self.list[i].starred = true;
            self.changed = true;
            self.renaming = Some((rev, self.list[i].name.clone()));
        }
    }

    /// Replaces all versions by those of another file.
    pub fn replace(&mut self, versions: Vec<Version>) {
        *self = Self {
            list: versions,
            ..Self::default()
        };
    }

    /// The versions for a file of the state `saved`: all of them, but the version of that state itself only if it has a
    /// name, a star or known settings.
    pub fn kept(&self, saved: SceneRev) -> Vec<KeptVersion> {
        let more = |v: &Version| v.starred || !v.name.is_empty() || v.made.is_some();
        let is_kept = |v: &&Version| more(v) || v.scene.content() != saved;
        let kept: Vec<&Version> = self.list.iter().filter(is_kept).collect();
        let version = |v: &&Version| {
            Some(KeptVersion {
                name: v.name.clone(),
                label: v.label.clone(),
                note: match &v.made {
                    Some(made) => format!("{}\n{}", v.note, made.to_json()),
                    None => v.note.clone(),
                },
                starred: v.starred,
                loom: v.packed.get_or_init(|| pack(v.to_pack())).clone()?,
            })
        };
        kept.par_iter().filter_map(version).collect()
    }

    /// Removes a version.
    pub fn remove(&mut self, rev: SceneRev) {
        self.list.retain(|v| v.scene.content() != rev);
        self.changed = true;
    }

    /// Renames a version; an empty name removes its name.
    pub fn rename(&mut self, rev: SceneRev, name: &str) {
        if let Some(i) = self.index_of(rev) {
            let name: String = name.trim().chars().take(Self::LONGEST_NAME).collect();
            self.changed |= self.list[i].name != name;
            self.list[i].name = name;
        }
    }

    /// Stars a version, or removes its star.
    pub fn star(&mut self, rev: SceneRev) {
        if let Some(i) = self.index_of(rev) {
            self.list[i].starred = !self.list[i].starred;
            self.changed = true;
        }
    }

    /// The settings that the version of a state was made with.
    pub fn made(&self, rev: SceneRev) -> Option<&MadeWith> {
        self.list[self.index_of(rev)?].made.as_ref()
    }

    /// All versions, the oldest first.
    pub fn list(&self) -> &[Version] {
        &self.list
    }

    pub(crate) fn list_mut(&mut self) -> &mut [Version] {
        &mut self.list
    }

    /// The index of the version of a state.
    pub fn index_of(&self, rev: SceneRev) -> Option<usize> {
        self.list.iter().position(|v| v.scene.content() == rev)
    }

    /// The version to compare a state with if the user chose none: the one before it, or the newest for a state that is
    /// no version.
    pub fn before(&self, rev: SceneRev) -> Option<&Arc<Scene>> {
        let index = match self.index_of(rev) {
            Some(index) => index.checked_sub(1)?,
            None => self.list.len().checked_sub(1)?,
        };
        Some(&self.list[index].scene)
    }

    /// The version `step` places after (or before) that of a state.
    pub fn neighbour(&self, rev: SceneRev, step: i32) -> Option<&Arc<Scene>> {
        let index = match self.index_of(rev) {
            Some(index) => index.checked_add_signed(step as isize)?,
            None if step < 0 => self.list.len().checked_sub(1)?,
            None => return None,
        };
        self.list.get(index).map(|v| &v.scene)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use scene::{Frame, VoxelGrid};

    fn scene() -> Arc<Scene> {
        let frame = Frame::new(Default::default(), Default::default(), VoxelGrid::new());
        Arc::new(Scene::single("s", frame, Arc::default(), 0))
    }

    #[test]
    fn findings_are_kept_with_each_version() {
        let mut versions = Versions::default();
        let counts = |errors, warnings| SeverityCounts {
            errors,
            warnings,
            infos: 9,
        };
        let scenes: Vec<_> = (0..3).map(|_| scene()).collect();
        for scene in &scenes {
            versions.push("edit".into(), String::new(), scene.clone());
        }
        versions.note_findings(scenes[0].content(), counts(1, 3));
        versions.note_findings(scenes[2].content(), counts(0, 1));
        versions.note_findings(SceneRev::fresh(), counts(7, 7));
        assert_eq!(
            versions.findings_in_words(0).as_deref(),
            Some("1 error, 3 warnings")
        );
        assert_eq!(versions.findings_in_words(1), None);
        assert_eq!(
            versions.findings_in_words(2).as_deref(),
            Some("1 warning (3 fewer)")
        );
        versions.note_findings(scenes[2].content(), counts(0, 0));
        assert_eq!(
            versions.findings_in_words(2).as_deref(),
            Some("no findings (4 fewer)")
        );
        assert_eq!(versions.findings_in_words(9), None);
    }

    #[test]
    fn versions_are_found_kept_and_bounded() {
        let mut versions = Versions::default();
        let scenes: Vec<_> = (0..Versions::MAX + 6).map(|_| scene()).collect();
        for (i, s) in scenes.iter().enumerate() {
            versions.push(format!("{i}"), String::new(), s.clone());
            versions.push("again".into(), String::new(), s.clone());
            if i == 1 {
                versions.star(scenes[1].content());
            }
        }
        assert_eq!(versions.list().len(), Versions::MAX + 1);
        assert_eq!(versions.list()[0].label, "1", "a star stays");
        let rev = |i: usize| scenes[scenes.len() - 1 - i].content();
        let same = |found: Option<&Arc<Scene>>, i: usize| found.map(|s| s.rev) == Some(rev(i));
        assert!(same(versions.before(rev(0)), 1));
        assert!(
            same(versions.before(scene().content()), 0),
            "an edit is compared with the newest"
        );
        assert!(same(versions.neighbour(rev(1), 1), 0) && versions.neighbour(rev(0), 1).is_none());
        assert!(versions.before(scenes[1].content()).is_none());
    }

    #[test]
    fn a_state_is_kept_once_and_stays_though_many_come_after_it() {
        let mut versions = Versions::default();
        let kept = scene();
        versions.keep(&kept);
        versions.keep(&kept);
        assert_eq!(versions.list().len(), 1);
        assert!(versions.changed && versions.list()[0].starred);
        assert!(
            versions
                .renaming
                .as_ref()
                .is_some_and(|(rev, _)| *rev == kept.content())
        );
        for _ in 0..Versions::MAX + 3 {
            versions.push("edit".into(), String::new(), scene());
        }
        assert_eq!(versions.index_of(kept.content()), Some(0));
        assert_eq!(versions.kept(kept.content()).len(), Versions::MAX + 1);
    }

    /// On shared threads, a panic that is not caught would abort the program.
    #[test]
    fn a_panic_while_packing_costs_that_version_alone() {
        let mut versions = Versions::default();
        versions.push("before".into(), String::new(), scene());
        runtime::guard::panic_next(THREAD);
        versions.push("panics".into(), String::new(), scene());
        versions.push("after".into(), String::new(), scene());
        let kept = versions.kept(SceneRev::fresh());
        let labels: Vec<&str> = kept.iter().map(|v| &*v.label).collect();
        assert_eq!(labels, ["before", "after"]);
        assert_eq!(versions.list().len(), 3, "it can still be gone back to");
    }

    #[test]
    fn they_come_back_from_the_file() {
        let mut versions = Versions::default();
        let scenes: Vec<_> = (0..3)
            .map(|i| {
                let mut scene = Scene::clone(&scene());
                scene.seed = i;
                Arc::new(scene)
            })
            .collect();
        for s in &scenes {
            let params = job::GenParams {
                seed: 7 + s.seed,
                ..Default::default()
            };
            let made = (s.seed == 1).then(|| MadeWith::new(&params, None));
            versions.push_made("Add a car".into(), "0.1 s".into(), s.clone(), made);
        }
        assert!(!versions.changed);
        versions.rename(scenes[0].content(), "  before the rain ");
        versions.star(scenes[1].content());
        assert!(std::mem::take(&mut versions.changed));
        let mut saved = Scene::clone(&scenes[2]);
        let kept = versions.kept(saved.content());
        assert_eq!(kept.len(), 2, "the state that is saved is the file itself");
        versions.rename(saved.content(), "now");
        let mut kept = versions.kept(saved.content());
        kept.push(KeptVersion {
            loom: Arc::new(vec![1, 2, 3]),
            ..kept[0].clone()
        });
        saved.kept = Arc::new(scene::ProjectHistory {
            versions: kept,
            typed: Vec::new(),
            ..Default::default()
        });
        let opened = VersionedScene::from_scene(saved);
        let found: Vec<_> = opened
            .versions
            .iter()
            .map(|v| (v.title(), v.starred, v.scene.seed))
            .collect();
        assert_eq!(
            found,
            [
                ("before the rain", false, 0),
                ("Add a car", true, 1),
                ("now", false, 2)
            ]
        );
        let made: Vec<_> = opened
            .versions
            .iter()
            .map(|v| (v.note.as_str(), v.made.as_ref().map(|m| m.params.seed)))
            .collect();
        assert_eq!(made, [("0.1 s", None), ("0.1 s", Some(8)), ("0.1 s", None)]);
        assert_eq!(opened.damaged, 1);
        assert_eq!(opened.versions[2].scene.content(), opened.scene.content());
        versions.replace(opened.versions);
        versions.remove(opened.scene.content());
        assert!(versions.changed && versions.list().len() == 2);
    }
}
