//! Versions of the scene: what each generation led to, kept to be looked at, compared with and gone back to.

use std::sync::Arc;

use egui::TextureHandle;

use scene::{Scene, SceneRev};

/// A scene as it was when something was generated or opened.
pub struct Version {
    /// The edit that led here.
    pub label: String,
    /// What the generation took.
    pub note: String,
    /// The scene.
    pub scene: Arc<Scene>,
    /// The user wants to keep it.
    pub starred: bool,
    /// Its occupancy from above.
    pub(crate) thumbnail: Option<TextureHandle>,
}

/// All versions of the session, the oldest first.
#[derive(Default)]
pub struct Versions {
    list: Vec<Version>,
}

impl Versions {
    /// Versions kept that are not starred. Scenes share what they have in common: one takes a few hundred kilobytes.
    pub const MAX: usize = 64;

    /// Adds a version, unless the newest is the same; the oldest that is not starred may have to go.
    pub fn push(&mut self, label: String, note: String, scene: Arc<Scene>) {
        if self.list.iter().any(|v| v.scene.content() == scene.content()) {
            return;
        }
        self.list.push(Version {
            label,
            note,
            scene,
            starred: false,
            thumbnail: None,
        });
        let plain = self.list.iter().filter(|v| !v.starred).count();
        if plain > Self::MAX
            && let Some(oldest) = self.list.iter().position(|v| !v.starred)
        {
            self.list.remove(oldest);
        }
    }

    /// Forgets all of them.
    pub fn clear(&mut self) {
        self.list.clear();
    }

    /// All versions, the oldest first.
    pub fn list(&self) -> &[Version] {
        &self.list
    }

    pub(crate) fn list_mut(&mut self) -> &mut [Version] {
        &mut self.list
    }

    /// The version of that state.
    pub fn of(&self, rev: SceneRev) -> Option<usize> {
        self.list.iter().position(|v| v.scene.content() == rev)
    }

    /// The version to compare a state with when the user chose none: the one before it, or the newest for a state that
    /// is no version yet.
    pub fn before(&self, rev: SceneRev) -> Option<&Arc<Scene>> {
        let index = match self.of(rev) {
            Some(index) => index.checked_sub(1)?,
            None => self.list.len().checked_sub(1)?,
        };
        Some(&self.list[index].scene)
    }

    /// The version `step` places after (or before) that state's.
    pub fn neighbour(&self, rev: SceneRev, step: i32) -> Option<&Arc<Scene>> {
        let index = match self.of(rev) {
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
    fn versions_are_found_kept_and_bounded() {
        let mut versions = Versions::default();
        let scenes: Vec<_> = (0..Versions::MAX + 6).map(|_| scene()).collect();
        for (i, s) in scenes.iter().enumerate() {
            versions.push(format!("{i}"), String::new(), s.clone());
            versions.push("again".into(), String::new(), s.clone());
            if i == 1 {
                versions.list_mut()[1].starred = true;
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
}
