//! Keeps the findings of the quality checks up to date with the scene, on a thread of its own, half a second after the
//! last change. The checks include how well the sensors see each box.

use std::sync::Arc;

use crate::findings::check;
use editor::checks::Finding;
use runtime::guard::Panicked;
use runtime::worker::{Ctx, Product, Worker};
use scene::{Scene, SceneRev};

/// Time without changes before a scene is checked, s.
const AFTER_S: f64 = 0.5;

/// The newest findings, and the thread that makes them.
pub struct Checking {
    worker: Worker<Arc<Scene>, Checked>,
    changed: Option<(SceneRev, f64)>,
    asked: Option<SceneRev>,
    last: Option<(SceneRev, Arc<Vec<Finding>>)>,
    /// Last job for a forgotten scene: findings of it and of earlier jobs are dropped.
    forgotten: u64,
    problem: Option<String>,
}

/// How a check ended.
enum Checked {
    Found(SceneRev, Vec<Finding>),
    GivenUp,
    Failed(Panicked),
}

/// The product of the thread: findings.
struct Checker;

impl Product for Checker {
    type Request = Arc<Scene>;
    type Update = Checked;

    fn make(&mut self, scene: &Arc<Scene>, _: &Ctx<'_, Checked>) -> Checked {
        Checked::Found(scene.rev, check(scene))
    }

    fn reset(&mut self) {}

    fn given_up() -> Checked {
        Checked::GivenUp
    }

    fn panicked(panic: Panicked) -> Checked {
        Checked::Failed(panic)
    }

    fn is_terminal(_: &Checked) -> bool {
        true
    }
}

impl Checking {
    /// Starts the thread `checks`; `wake` is called when there are new findings. Errors if the system gives no thread.
    pub fn spawn(wake: impl Fn() + Send + Sync + 'static) -> std::io::Result<Self> {
        Ok(Self {
            worker: Worker::start("checks", || Checker, Arc::new(wake))?,
            forgotten: 0,
            problem: None,
            changed: None,
            asked: None,
            last: None,
        })
    }

    /// Takes in the news, and requests a check once the scene has rested. To be called every frame. Returns the seconds
    /// after which it wants to be called again, if no other event comes. `now_s` never runs backward.
    pub fn update(&mut self, scene: &Arc<Scene>, dragging: bool, now_s: f64) -> Option<f64> {
        let forgotten = self.forgotten;
        let events = self.worker.updates().try_iter();
        for checked in events.filter(|e| e.id.0 > forgotten).map(|e| e.update) {
            match checked {
                Checked::Found(rev, findings) => self.last = Some((rev, Arc::new(findings))),
                Checked::GivenUp => {}
                Checked::Failed(panic) => self.problem = Some(panic.to_string()),
            }
        }
        if self.changed.is_none_or(|(rev, _)| rev != scene.rev) {
            self.changed = Some((scene.rev, now_s));
        }
        if self.asked == Some(scene.rev) || dragging {
            return None;
        }
        let ready_s = self.changed.map_or(now_s, |(_, at_s)| at_s) + AFTER_S;
        if now_s < ready_s {
            return Some(ready_s - now_s);
        }
        self.asked = Some(scene.rev);
        self.worker.submit(scene.clone());
        None
    }

    /// Forgets the findings, and those that are still to come, because another scene is shown.
    pub fn forget(&mut self) {
        self.worker.cancel();
        self.forgotten = self.worker.newest().0;
        (self.last, self.asked) = (None, None);
    }

    /// The reason why a scene could not be checked; returned once. Later scenes are checked again.
    pub fn take_problem(&mut self) -> Option<String> {
        self.problem.take()
    }

    /// The newest findings, errors first; `None` before the first check is done.
    pub fn findings(&self) -> Option<&Arc<Vec<Finding>>> {
        self.last.as_ref().map(|(_, findings)| findings)
    }

    /// True if the findings are of another state.
    pub fn is_stale(&self, rev: SceneRev) -> bool {
        self.last.as_ref().is_none_or(|(of, _)| *of != rev)
    }
}

#[cfg(test)]
mod tests {
    use std::time::{Duration, Instant};

    use super::*;
    use crate::open;

    #[test]
    fn the_newest_scene_is_checked_after_a_rest() {
        let mut checking = Checking::spawn(|| {}).expect("a thread");
        let mut scene = open::from_template("straight", 3).expect("a template");
        for i in 0..10 {
            scene.rev = SceneRev::fresh();
            let now_s = f64::from(i) * 0.25;
            let wait_s = checking.update(&Arc::new(scene.clone()), false, now_s);
            assert_eq!(wait_s, Some(AFTER_S), "each change starts the rest again");
        }
        let scene = Arc::new(scene);
        assert_eq!(checking.update(&scene, true, 9.0), None, "not while dragging");
        assert!(checking.findings().is_none() && checking.is_stale(scene.rev));
        let start = Instant::now();
        while checking.is_stale(scene.rev) {
            assert!(start.elapsed() < Duration::from_secs(60), "no findings");
            assert_eq!(checking.update(&scene, false, 9.0), None);
            std::thread::sleep(Duration::from_millis(2));
        }
        assert_eq!(checking.findings().map(|f| f.to_vec()), Some(check(&scene)));
    }
}
