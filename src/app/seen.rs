//! The scene as the large views show it, without hidden objects. Made once per state.

use std::sync::Arc;

use editor::arranged;
use scene::Scene;

/// A scene and its copy without hidden objects.
#[derive(Debug, Default)]
struct VisibleSceneCache {
    of: Option<(Arc<Scene>, Arc<Scene>)>,
}

impl VisibleSceneCache {
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

/// Copies without hidden objects, of the scene on screen and of the scene without the drag in progress.
#[derive(Debug, Default)]
pub struct SeenScenes {
    shown: VisibleSceneCache,
    settled: VisibleSceneCache,
}

impl SeenScenes {
    /// The two scenes without hidden objects.
    pub fn update(&mut self, shown: &Arc<Scene>, settled: &Arc<Scene>) -> SeenScene {
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

/// Scenes that the large views draw and their tools work on.
#[derive(Clone, Debug)]
pub struct SeenScene {
    /// The scene on screen, a drag in progress included.
    pub scene: Arc<Scene>,
    /// The scene without the drag in progress.
    pub settled: Arc<Scene>,
}
