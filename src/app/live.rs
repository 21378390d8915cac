//! When to generate: nothing while dragging, at once where it is quick and after a short grace where
//! it is not, never the same input twice. Knows no thread: it is asked once per frame and answers.

use std::collections::VecDeque;

use crate::generation::job::{GenParams, JobId, JobKey, Named, RegionMode, Stage};
use crate::generation::region::Region;
use crate::scene::{Scene, SceneRev};

/// Runs up to this mean need no grace, s.
const QUICK_S: f64 = 1.5;
/// Wait after the last edit where runs are slower, s.
const GRACE_S: f64 = 0.25;
/// Longest wait after the oldest edit that is not generated yet, s.
const LONGEST_WAIT_S: f64 = 3.0;
/// Quiet time before the worker gets ready, s.
const WARM_UP_AFTER_S: f64 = 0.6;
/// Runs that the mean is taken of.
const REMEMBERED: usize = 10;

/// What should happen now.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Advice {
    /// Nothing.
    Rest,
    /// Ask again after so many seconds.
    Wait(f64),
    /// Submit the scene with these parameters.
    Submit(GenParams),
    /// Submit it although nothing was edited: the worker gets ready for the first edit.
    WarmUp(GenParams),
    /// Stop what runs: its result would be of no use.
    Cancel,
}

/// What an edit touches, in short.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Touched {
    /// Nothing to generate.
    pub is_empty: bool,
    /// Extent along x and y, m.
    pub extent_m: [f64; 2],
    /// Lowest and highest column along x and y, both included.
    pub bounds: Option<([usize; 2], [usize; 2])>,
}

/// What a job is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Purpose {
    /// Redraws what was edited.
    Edit,
    /// Draws everything.
    Full,
    /// Gets the worker ready; its result is what is there already.
    WarmUp,
}

/// A job on its way.
#[derive(Clone, Debug, PartialEq)]
pub struct Running {
    /// Its name at the worker.
    pub id: JobId,
    /// What was asked for.
    pub key: JobKey,
    /// What for.
    pub purpose: Purpose,
    /// When, s.
    pub submitted_s: f64,
    /// When the edit was made that it answers, s.
    pub edited_s: f64,
    /// Stage, steps done, all steps; none before the first news.
    pub progress: Option<(Stage, usize, usize)>,
    /// What it redraws, along x and y, m.
    pub extent_m: [f64; 2],
}

/// The scheduler.
#[derive(Debug)]
pub struct Live {
    /// Generate after each edit.
    pub on: bool,
    /// How to generate what was edited.
    pub params: GenParams,
    /// How to generate everything.
    pub full_params: GenParams,
    /// Densities asked for; they go before those of the parameters.
    pub named: Named,
    /// The job on its way.
    pub running: Option<Running>,
    seen: Option<(SceneRev, Touched)>,
    last_edit_s: f64,
    oldest_edit_s: Option<f64>,
    asked: Option<JobKey>,
    recent_s: VecDeque<f64>,
    cold: bool,
    warm_up: bool,
}

impl Live {
    /// Switched on; nothing seen yet. With `warm_up` the worker is to get ready while nothing is edited.
    pub fn new(params: GenParams, full_params: GenParams, warm_up: bool) -> Self {
        Self {
            on: true,
            params,
            full_params,
            named: Named::default(),
            cold: warm_up,
            warm_up,
            running: None,
            seen: None,
            last_edit_s: f64::NEG_INFINITY,
            oldest_edit_s: None,
            asked: None,
            recent_s: VecDeque::new(),
        }
    }

    /// Parameters for all of a scene, or for what was edited in it.
    pub fn params_for(&self, scene: &Scene, full: bool) -> GenParams {
        let (params, region) = match full {
            true => (self.full_params, RegionMode::Full),
            false => (self.params, RegionMode::Auto),
        };
        GenParams {
            seed: scene.seed,
            region,
            named: self.named.or_else(&params.named),
            ..params
        }
    }

    /// What the state shown asks for. `scene` is the settled one; `now_s` never runs backward.
    pub fn advise(&mut self, scene: &Scene, dragging: bool, now_s: f64) -> Advice {
        if dragging {
            return Advice::Rest;
        }
        let touched = self.look(scene, now_s);
        if let Some(running) = &self.running
            && running.key.rev != scene.rev
            && running.purpose != Purpose::WarmUp
            && (touched.is_empty || !self.on)
        {
            return Advice::Cancel;
        }
        let params = self.params_for(scene, false);
        let key = JobKey {
            rev: scene.rev,
            params,
        };
        if self.on && touched.is_empty && self.cold && self.running.is_none() {
            let ready_s = self.last_edit_s + WARM_UP_AFTER_S;
            return if now_s < ready_s {
                Advice::Wait(ready_s - now_s)
            } else {
                Advice::WarmUp(params)
            };
        }
        if !self.on || touched.is_empty || self.asked.is_some_and(|k| k.rev == key.rev) {
            return Advice::Rest;
        }
        let oldest_s = *self.oldest_edit_s.get_or_insert(now_s);
        let ready_s = (self.last_edit_s + self.grace_s()).min(oldest_s + LONGEST_WAIT_S);
        if now_s < ready_s {
            return Advice::Wait(ready_s - now_s);
        }
        Advice::Submit(params)
    }

    /// What the edits of a scene touch; looked up once per state.
    pub fn look(&mut self, scene: &Scene, now_s: f64) -> Touched {
        if let Some((rev, touched)) = self.seen
            && rev == scene.rev
        {
            return touched;
        }
        let region = Region::of_edit(scene.frame(), self.params.halo_columns as usize);
        let touched = Touched {
            is_empty: region.is_empty(),
            extent_m: region.extent_m(),
            bounds: region.bounds,
        };
        self.seen = Some((scene.rev, touched));
        self.last_edit_s = now_s;
        touched
    }

    /// Notes that a job was submitted.
    pub fn submitted(&mut self, id: JobId, key: JobKey, now_s: f64) {
        let full = key.params.region == RegionMode::Full;
        let (purpose, extent_m) = match self.seen {
            Some((_, touched)) if !full && touched.is_empty && key.params.redraw.is_empty() => {
                (Purpose::WarmUp, [0.0; 2])
            }
            Some((_, touched)) if !full => (Purpose::Edit, touched.extent_m),
            _ => (Purpose::Full, [80.0; 2]),
        };
        // A source that was drawn anew has to be inverted before it can be edited.
        self.cold = self.warm_up && purpose == Purpose::Full;
        self.asked = Some(key);
        self.oldest_edit_s = None;
        self.running = Some(Running {
            id,
            key,
            purpose,
            submitted_s: now_s,
            edited_s: if full { now_s } else { self.last_edit_s.max(0.0) },
            progress: None,
            extent_m,
        });
    }

    /// Notes that the job ended; what it was, if it was the one on its way.
    pub fn ended(&mut self, id: JobId) -> Option<Running> {
        self.running.take_if(|r| r.id == id)
    }

    /// Notes how long a finished job took.
    pub fn took(&mut self, seconds: f64) {
        self.recent_s.push_back(seconds);
        if self.recent_s.len() > REMEMBERED {
            self.recent_s.pop_front();
        }
    }

    /// Notes that the source is not the one that the worker got ready for.
    pub fn source_changed(&mut self) {
        self.cold = self.warm_up;
    }

    /// Lets the state be asked for again, after the user switched live on or undid a cancel.
    pub fn forget_asked(&mut self) {
        self.asked = None;
    }

    /// Forgets everything about the last document; the pace stays.
    pub fn reset(&mut self) {
        (self.seen, self.asked, self.oldest_edit_s) = (None, None, None);
        self.cold = self.warm_up;
    }

    fn grace_s(&self) -> f64 {
        let mean_s = self.recent_s.iter().sum::<f64>() / self.recent_s.len().max(1) as f64;
        if mean_s <= QUICK_S { 0.0 } else { GRACE_S }
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;
    use std::sync::Arc;

    use super::*;
    use crate::scene::{BevLayer, BevLayout, Frame, SensorRig, VoxelGrid};

    fn scene() -> Scene {
        let frame = Frame::new(BevLayout::default(), BTreeMap::new(), VoxelGrid::new());
        Scene::single("test", frame, Arc::new(SensorRig::default()), 7)
    }

    fn paint(scene: &mut Scene, x: usize) {
        scene.frame_mut().layout.set(BevLayer::DrivableArea, x, 50, true);
    }

    fn submit(live: &mut Live, scene: &Scene, params: GenParams, now_s: f64, id: u64) {
        live.submitted(
            JobId(id),
            JobKey {
                rev: scene.rev,
                params,
            },
            now_s,
        );
    }

    #[test]
    fn an_edit_is_generated_once_and_not_while_dragging() {
        let (mut live, mut scene) = (
            Live::new(GenParams::default(), GenParams::default(), false),
            scene(),
        );
        assert_eq!(live.advise(&scene, false, 0.0), Advice::Rest);
        paint(&mut scene, 40);
        assert_eq!(live.advise(&scene, true, 1.0), Advice::Rest);
        let Advice::Submit(params) = live.advise(&scene, false, 2.0) else {
            panic!("a quick worker is asked at once");
        };
        assert_eq!((params.seed, params.region), (7, RegionMode::Auto));
        submit(&mut live, &scene, params, 2.0, 1);
        assert_eq!(live.advise(&scene, false, 2.1), Advice::Rest);
        assert!(live.ended(JobId(1)).is_some());
        // Failed or cancelled: the same input is not tried again by itself.
        assert_eq!(live.advise(&scene, false, 9.0), Advice::Rest);
        live.forget_asked();
        assert!(matches!(live.advise(&scene, false, 9.1), Advice::Submit(_)));
    }

    #[test]
    fn slow_runs_get_a_grace_that_ends() {
        let (mut live, mut scene) = (
            Live::new(GenParams::default(), GenParams::default(), false),
            scene(),
        );
        (0..3).for_each(|_| live.took(4.0));
        live.advise(&scene, false, 0.0);
        let mut now_s = 10.0;
        let mut waited = 0;
        // Strokes every 0.2 s: each restarts the grace, but not for ever.
        let submitted_s = loop {
            paint(&mut scene, 20 + waited);
            match live.advise(&scene, false, now_s) {
                Advice::Wait(s) => assert!((0.0..=GRACE_S).contains(&s)),
                Advice::Submit(_) => break now_s,
                other => panic!("{other:?}"),
            }
            (waited, now_s) = (waited + 1, now_s + 0.2);
        };
        assert!((12.9..13.3).contains(&submitted_s), "{submitted_s}");
    }

    #[test]
    fn what_became_useless_is_cancelled() {
        let (mut live, mut scene) = (
            Live::new(GenParams::default(), GenParams::default(), false),
            scene(),
        );
        let before = scene.clone();
        paint(&mut scene, 40);
        let Advice::Submit(params) = live.advise(&scene, false, 1.0) else {
            panic!()
        };
        submit(&mut live, &scene, params, 1.0, 1);
        // Undone: the state before needs nothing.
        assert_eq!(live.advise(&before, false, 1.1), Advice::Cancel);
        assert!(live.ended(JobId(2)).is_none() && live.ended(JobId(1)).is_some());
        assert_eq!(live.advise(&before, false, 1.2), Advice::Rest);
    }

    #[test]
    fn off_means_off() {
        let (mut live, mut scene) = (
            Live::new(GenParams::default(), GenParams::default(), false),
            scene(),
        );
        live.on = false;
        paint(&mut scene, 40);
        assert_eq!(live.advise(&scene, false, 1.0), Advice::Rest);
        live.on = true;
        assert!(matches!(live.advise(&scene, false, 1.1), Advice::Submit(_)));
    }

    #[test]
    fn the_worker_gets_ready_once_and_an_edit_comes_first() {
        let mut scene = scene();
        let mut live = Live::new(GenParams::default(), GenParams::default(), true);
        assert!(matches!(live.advise(&scene, false, 0.0), Advice::Wait(_)));
        let Advice::WarmUp(params) = live.advise(&scene, false, 1.0) else {
            panic!()
        };
        submit(&mut live, &scene, params, 1.0, 1);
        assert_eq!(live.running.as_ref().map(|r| r.purpose), Some(Purpose::WarmUp));
        assert_eq!(live.advise(&scene, false, 2.0), Advice::Rest);
        paint(&mut scene, 40);
        assert!(matches!(live.advise(&scene, false, 2.1), Advice::Submit(_)));
        // Drawn anew: the source is another one.
        let full = live.params_for(&scene, true);
        submit(&mut live, &scene, full, 3.0, 2);
        live.ended(JobId(2));
        let settled = self::scene();
        assert!(matches!(live.advise(&settled, false, 4.0), Advice::Wait(_)));
        assert!(matches!(live.advise(&settled, false, 5.0), Advice::WarmUp(_)));
    }
}
