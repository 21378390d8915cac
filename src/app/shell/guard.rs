//! Conditions in which live generation waits for the user: the region is too large, the run would take too long, or the
//! input is invalid.

use std::collections::VecDeque;

use language::tf;
use scene::Scene;

/// Largest share of the columns that is generated automatically.
pub const MOST_SHARE: f64 = 0.4;
/// Longest run that is started automatically, s.
pub const LONGEST_S: f64 = 8.0;
/// Number of runs that a prediction is based on.
const REMEMBERED: usize = 10;

/// The reason why an edit is not generated automatically.
#[derive(Clone, Debug, PartialEq)]
pub enum Pause {
    /// The edit touches this share of the columns.
    Large(f64),
    /// The generation would take about this long, s.
    Slow(f64),
    /// Boxes or sensors hold invalid numbers.
    Unsound(String),
}

impl Pause {
    /// The reason as one line for the user.
    pub fn text(&self) -> String {
        match self {
            Self::Large(share) => tf!(
                "Live waits: {percent} % of the map was edited",
                percent = format!("{:.0}", share * 100.0),
            ),
            Self::Slow(seconds) => tf!(
                "Live waits: it would take about {seconds} s",
                seconds = format!("{seconds:.0}"),
            ),
            Self::Unsound(problem) => tf!("Live waits: {problem}", problem = problem),
        }
    }
}

/// Times of past runs, each with the share of the columns that it redrew.
#[derive(Clone, Debug, Default)]
pub struct Pace(VecDeque<(f64, f64)>);

impl Pace {
    /// Notes the time of a run that redrew a share of the columns, s.
    pub fn note(&mut self, share: f64, seconds: f64) {
        if share > 0.0 && seconds.is_finite() {
            self.0.push_back((share, seconds));
            if self.0.len() > REMEMBERED {
                self.0.pop_front();
            }
        }
    }

    /// Predicted time of a run for a share, s; 0 before the first run. The time grows with the square root of the
    /// share: by `cargo bench --bench locality`, 1, 5, 15 and 30 % of the map take .10, .17, .28 and .43 of the time of
    /// the whole map.
    pub fn predicted_s(&self, share: f64) -> f64 {
        let sum: f64 = self.0.iter().map(|(of, s)| s * (share / of).sqrt()).sum();
        sum / self.0.len().max(1) as f64
    }
}

/// The reason why an edit of a share should wait; `None` if it should not.
pub fn pause(scene: &Scene, share: f64, predicted_s: f64) -> Option<Pause> {
    let problem = scene
        .frame()
        .boxes
        .values()
        .find_map(|b| b.problem())
        .or_else(|| scene.rig.problem());
    if let Some(problem) = problem {
        return Some(Pause::Unsound(problem));
    }
    if share > MOST_SHARE {
        return Some(Pause::Large(share));
    }
    (predicted_s > LONGEST_S).then_some(Pause::Slow(predicted_s))
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;
    use std::sync::Arc;

    use super::*;
    use scene::{BevLayout, BoxId, Class, Frame, SceneBox, SensorRig, VoxelGrid};

    #[test]
    fn large_slow_and_unsound_edits_wait() {
        let frame = Frame::new(BevLayout::default(), BTreeMap::new(), VoxelGrid::new());
        let mut scene = Scene::single("test", frame, Arc::new(SensorRig::default()), 7);
        assert_eq!(pause(&scene, 0.05, 0.3), None);
        assert_eq!(pause(&scene, 0.41, 0.3), Some(Pause::Large(0.41)));
        assert_eq!(pause(&scene, 0.05, 9.0), Some(Pause::Slow(9.0)));
        let bad = SceneBox {
            id: BoxId(1),
            class: Class::Car,
            center_m: glam::DVec3::NAN,
            size_m: glam::DVec3::ONE,
            yaw_rad: 0.0,
            velocity_mps: glam::DVec2::ZERO,
            label: Default::default(),
        };
        scene.change_canvas(|f| f.boxes.insert(BoxId(1), bad));
        assert!(matches!(pause(&scene, 0.05, 0.3), Some(Pause::Unsound(_))));
        assert!(Pause::Large(0.524).text().contains("52 %"));
    }

    #[test]
    fn larger_regions_take_longer_but_less_than_in_proportion() {
        let mut pace = Pace::default();
        assert_eq!(pace.predicted_s(0.3), 0.0, "nothing is known yet");
        for _ in 0..20 {
            pace.note(0.01, 0.5);
        }
        pace.note(0.0, 100.0);
        pace.note(0.1, f64::NAN);
        assert!((pace.predicted_s(0.01) - 0.5).abs() < 1e-9);
        assert!((pace.predicted_s(0.25) - 2.5).abs() < 1e-9);
    }
}
