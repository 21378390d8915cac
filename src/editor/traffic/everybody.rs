//! Positions of all objects at the moments that followers look at, worked out once for all followers.

use scene::{BoxId, Scene};

use super::follow::{Other, STEP_S};
use super::template::everybody_at;

/// Most positions that are kept; in a larger scene they are worked out on each call.
const MOST: usize = 500_000;

/// Positions of all objects from a moment of a scene on.
pub(crate) struct Everybody<'s> {
    scene: &'s Scene,
    from_s: f64,
    table: Vec<Vec<Other>>,
}

impl<'s> Everybody<'s> {
    /// Works the positions out over `length_s` from `from_s` on.
    pub(crate) fn from_scene(scene: &'s Scene, from_s: f64, length_s: f64) -> Self {
        let moments = (length_s / STEP_S).ceil().clamp(1.0, 6000.0) as usize + 2;
        let bodies = scene.canvas().boxes.len() + scene.clip().tracks.len() + 1;
        let kept = if moments * bodies <= MOST { moments } else { 0 };
        let at = |i: usize| everybody_at(scene, from_s + i as f64 * STEP_S);
        Self {
            scene,
            from_s,
            table: (0..kept).map(at).collect(),
        }
    }

    /// The objects without `own`, so long after the first moment.
    pub(crate) fn others(&self, own: Option<BoxId>, after_s: f64) -> Vec<Other> {
        let mut all = match self.table.get((after_s / STEP_S).round() as usize) {
            Some(all) => all.clone(),
            None => everybody_at(self.scene, self.from_s + after_s),
        };
        all.retain(|o| o.id != own);
        all
    }
}
