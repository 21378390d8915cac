//! What the large views show of a scene: without what the user has hidden. Made once per state.

use std::sync::Arc;

use editor::arranged;
use scene::Scene;

/// A scene and what is seen of it.
#[derive(Debug, Default)]
struct Kept {
    of: Option<(Arc<Scene>, Arc<Scene>)>,
}

impl Kept {
    fn seen(&mut self, scene: &Arc<Scene>) -> Arc<Scene> {
        match &self.of {
            Some((of, seen)) if Arc::ptr_eq(of, scene) => seen.clone(),
            _ => {
                let seen = arranged::seen(scene);
                self.of = Some((scene.clone(), seen.clone()));
                seen
            }
        }
    }
}

/// What is seen of the scene on screen, and of the one without the drag in progress.
#[derive(Debug, Default)]
pub struct SeenScenes {
    shown: Kept,
    settled: Kept,
}

impl SeenScenes {
    /// Of both.
    pub fn of(&mut self, shown: &Arc<Scene>, settled: &Arc<Scene>) -> SeenScene {
        let shown_seen = self.shown.seen(shown);
        let settled = match Arc::ptr_eq(shown, settled) {
            true => shown_seen.clone(),
            false => self.settled.seen(settled),
        };
        SeenScene {
            scene: shown_seen,
            settled,
        }
    }
}

/// What the large views draw and what their tools work on.
#[derive(Clone, Debug)]
pub struct SeenScene {
    /// The scene on screen, a drag in progress included.
    pub scene: Arc<Scene>,
    /// The scene without the drag in progress.
    pub settled: Arc<Scene>,
}
