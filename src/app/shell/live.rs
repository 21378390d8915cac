//! Scheduler of live generation: never during a drag; at once if generation is fast, else after a short pause (the
//! grace) in which more edits may follow; never the same input twice. It has no thread; it is asked once per frame.

use std::collections::VecDeque;
use std::sync::Arc;

use super::guard::{self, Pace, Pause};
use job::inpaint::InpaintMask;
pub use job::pipeline::Bounds;
use job::pipeline::parts;
use job::region::{CELLS, COLUMNS_PER_CELL, edited_columns};
use job::{ChosenDensities, GenParams, JobKey, RegionMode, Stage};
use runtime::worker::JobId;
use scene::{Lattice, Scene, SceneRev};

/// Edge of a latent cell, m.
const CELL_M: f64 = COLUMNS_PER_CELL as f64 * Lattice::OCC3D.voxel_m();
/// Mean time of runs up to which there is no grace, s.
const QUICK_S: f64 = 1.5;
/// The grace after the last edit if runs are slower, s.
const GRACE_S: f64 = 0.25;
/// Longest wait after the oldest edit that is not generated yet, s.
const LONGEST_WAIT_S: f64 = 3.0;
/// Time without edits before the worker warms up, s.
const WARM_UP_AFTER_S: f64 = 0.6;
/// Number of runs that the mean is taken over.
const REMEMBERED: usize = 10;

/// Advice of the scheduler.
#[derive(Clone, Debug, PartialEq)]
pub enum Advice {
    /// Do not act.
    Rest,
    /// Ask again after so many seconds.
    Wait(f64),
    /// Submit the scene with these parameters.
    Submit(GenParams),
    /// Submit the scene without an edit, so that the worker warms up for the first edit.
    WarmUp(GenParams),
    /// Cancel the running job, because its result would not be used.
    Cancel,
}

/// Size of the region that an edit touches.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Touched {
    /// True if the region is empty.
    pub is_empty: bool,
    /// Extent along x and y, m.
    pub extent_m: [f64; 2],
    /// Columns as a share of the networks' window, at most 1.
    pub share: f64,
}

/// Purpose of a job.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Purpose {
    /// Inpaints the edited region.
    Edit,
    /// Generates the whole scene.
    Full,
    /// Warms up the worker; the result equals the scene.
    WarmUp,
}

/// A running job.
#[derive(Clone, Debug, PartialEq)]
pub struct RunningJob {
    /// Its id at the worker.
    pub id: JobId,
    /// Its key: the scene's revision and the parameters.
    pub key: JobKey,
    /// Its purpose.
    pub purpose: Purpose,
    /// Time at which it was submitted, s.
    pub submitted_s: f64,
    /// Time of the edit that it is for, s.
    pub edited_s: f64,
    /// Stage, steps done, and all steps; `None` before the first update.
    pub progress: Option<(Stage, usize, usize)>,
    /// Size of the inpainted region along x and y, m.
    pub extent_m: [f64; 2],
    /// Share of all columns that it inpaints.
    pub share: f64,
    /// True if the user cancelled it and it has not ended yet.
    pub cancelled: bool,
}

impl RunningJob {
    /// Label of the undo step of its result; `None` if the result goes into the step of an edit.
    pub fn own_step(&self) -> Option<&'static str> {
        match (self.purpose, self.key.params.inpaint.is_empty()) {
            (Purpose::Full, _) => Some("Generate"),
            (Purpose::Edit, false) => Some("Inpaint region"),
            _ => None,
        }
    }
}

/// The scheduler.
#[derive(Debug)]
pub struct Live {
    /// True: generates after each edit.
    pub on: bool,
    /// Parameters of generation after an edit.
    pub params: GenParams,
    /// Parameters of generation of the whole scene.
    pub full_params: GenParams,
    /// Densities that the user chose; they override those of the parameters.
    pub named: ChosenDensities,
    /// The seed for generation on request; the scene's seed if `None`.
    pub seed: Option<u64>,
    /// Predicted time of the present preset, s; 0 if unknown.
    pub predicted_s: f64,
    /// The running job.
    pub running: Option<RunningJob>,
    /// The reason why the last edit is not generated automatically.
    pub paused: Option<Pause>,
    pace: Pace,
    seen: Option<(SceneRev, Touched)>,
    parts: Arc<[Bounds]>, // of the state in `seen`
    map_m: [f64; 2],      // size of the whole map
    last_edit_s: f64,
    oldest_edit_s: Option<f64>,
    asked: Option<JobKey>,
    recent_s: VecDeque<f64>,
    cold: bool,
    warm_up: bool,
}

impl Live {
    /// A scheduler that is on and has seen no scene. With `warm_up` the worker warms up while nothing is edited.
    pub fn new(params: GenParams, full_params: GenParams, warm_up: bool) -> Self {
        Self {
            on: true,
            params,
            full_params,
            named: ChosenDensities::default(),
            seed: None,
            cold: warm_up,
            warm_up,
            predicted_s: 0.0,
            running: None,
            paused: None,
            pace: Pace::default(),
            seen: None,
            parts: Arc::default(),
            map_m: [80.0; 2],
            last_edit_s: f64::NEG_INFINITY,
            oldest_edit_s: None,
            asked: None,
            recent_s: VecDeque::new(),
        }
    }

    /// Parameters for the whole scene, or for the edited region.
    pub fn params_for(&self, scene: &Scene, full: bool) -> GenParams {
        let (params, region) = match full {
            true => (self.full_params.clone(), RegionMode::Full),
            false => (self.params.clone(), RegionMode::Auto),
        };
        // An edit starts from the noise of the existing scene; another seed would only change the rest without need.
        let seed = self.seed.filter(|_| full).unwrap_or(scene.seed);
        GenParams {
            seed,
            region,
            named: self.named.or_else(&params.named),
            ..params
        }
    }

    /// The advice for the present moment. `scene` is the settled scene; `now_s` must not go backward.
    pub fn advise(&mut self, scene: &Scene, dragging: bool, now_s: f64) -> Advice {
        if dragging {
            return Advice::Rest;
        }
        let touched = self.touched_by(scene, now_s);
        self.paused = None;
        if let Some(running) = &self.running
            && running.key.rev != scene.content()
            && running.purpose != Purpose::WarmUp
            && (touched.is_empty || !self.on)
        {
            return Advice::Cancel;
        }
        let params = self.params_for(scene, false);
        if self.on && touched.is_empty && self.cold && self.running.is_none() {
            let ready_s = self.last_edit_s + WARM_UP_AFTER_S;
            return if now_s < ready_s {
                Advice::Wait(ready_s - now_s)
            } else {
                Advice::WarmUp(params)
            };
        }
        if !self.waits(scene.content(), &touched) {
            return Advice::Rest;
        }
        self.paused = guard::pause(
            scene,
            touched.share,
            self.pace.predicted_s(touched.share).max(self.predicted_s),
        );
        if self.paused.is_some() {
            return Advice::Rest;
        }
        let oldest_s = *self.oldest_edit_s.get_or_insert(now_s);
        let ready_s = (self.last_edit_s + self.grace_s()).min(oldest_s + LONGEST_WAIT_S);
        if now_s < ready_s {
            return Advice::Wait(ready_s - now_s);
        }
        Advice::Submit(params)
    }

    fn waits(&self, rev: SceneRev, touched: &Touched) -> bool {
        self.on && !touched.is_empty && self.asked.clone().is_none_or(|k| k.rev != rev)
    }

    /// True if an edit waits to be generated automatically: for the end of a drag or of its grace.
    pub fn has_waiting(&self, rev: SceneRev) -> bool {
        let seen = self.seen.filter(|(of, _)| *of == rev);
        seen.is_some_and(|(_, touched)| self.waits(rev, &touched)) && self.paused.is_none()
    }

    /// Drops the waiting edit: this state is not generated automatically any more, the next edit will be.
    pub fn drop_waiting(&mut self, scene: &Scene) {
        self.asked = Some(JobKey {
            rev: scene.content(),
            params: self.params_for(scene, false),
        });
        self.paused = None;
    }

    /// The region that the edits of a scene touch; computed once per state.
    pub fn touched_by(&mut self, scene: &Scene, now_s: f64) -> Touched {
        if let Some((rev, touched)) = self.seen
            && rev == scene.content()
        {
            return touched;
        }
        let standing = scene.for_generation();
        let frame = standing.frame();
        let columns = edited_columns(frame, self.params.halo_columns as usize);
        let parts = parts(frame.extent(), &columns);
        let count = columns.iter().filter(|c| **c).count();
        let cell_m2 = frame.extent().voxel_m().powi(2);
        let touched = Touched {
            is_empty: parts.is_empty(),
            extent_m: size_m(&parts, frame.extent().voxel_m()),
            share: (count as f64 * cell_m2 / (COLUMNS as f64 * Lattice::OCC3D.voxel_m().powi(2))).min(1.0),
        };
        self.parts = parts.into();
        self.map_m = [frame.extent().nx(), frame.extent().ny()].map(|n| n as f64 * frame.extent().voxel_m());
        self.seen = Some((scene.content(), touched));
        self.last_edit_s = now_s;
        touched
    }

    /// The parts of the last state that are generated separately.
    pub fn parts(&self) -> Arc<[Bounds]> {
        self.parts.clone()
    }

    /// Notes that a job was submitted.
    pub fn submitted(&mut self, id: JobId, key: JobKey, now_s: f64) {
        let full = key.params.region == RegionMode::Full;
        // A job that the user requested is not for the last edit, which may be long ago.
        let by_hand = full || self.paused.is_some() || !key.params.inpaint.is_empty();
        let (purpose, extent_m, share) = match self.seen {
            Some((_, touched)) if !full && touched.is_empty && key.params.inpaint.is_empty() => {
                (Purpose::WarmUp, [0.0; 2], 0.0)
            }
            Some((_, touched)) if !full => {
                let (extent_m, share) = with_inpainted(&touched, &key.params.inpaint);
                (Purpose::Edit, extent_m, share)
            }
            _ => (Purpose::Full, self.map_m, 1.0),
        };
        // A source that was inpainted has to be inverted before it can be edited.
        self.cold = self.warm_up && (purpose == Purpose::Full || key.params.strength > 0.0);
        self.asked = Some(key.clone());
        self.paused = None;
        self.oldest_edit_s = None;
        self.running = Some(RunningJob {
            id,
            key,
            purpose,
            submitted_s: now_s,
            edited_s: if by_hand { now_s } else { self.last_edit_s.max(0.0) },
            progress: None,
            extent_m,
            share,
            cancelled: false,
        });
    }

    /// Notes that a job ended, and returns it if it was the running one.
    pub fn ended(&mut self, id: JobId) -> Option<RunningJob> {
        self.running.take_if(|r| r.id == id)
    }

    /// Notes the time of a finished job, with the share of the columns that it inpainted.
    pub fn took(&mut self, share: f64, seconds: f64) {
        self.pace.note(share, seconds);
        self.recent_s.push_back(seconds);
        if self.recent_s.len() > REMEMBERED {
            self.recent_s.pop_front();
        }
    }

    /// Notes that the worker is not warmed up for the present source.
    pub fn source_changed(&mut self) {
        self.cold = self.warm_up;
    }

    /// Allows this state to be generated again, after the user switched live generation on or undid a cancel.
    pub fn forget_asked(&mut self) {
        self.asked = None;
    }

    /// Forgets the last document, but not the times of runs.
    pub fn reset(&mut self) {
        (self.seen, self.asked, self.oldest_edit_s) = (None, None, None);
        self.cold = self.warm_up;
    }

    fn grace_s(&self) -> f64 {
        let mean_s = self.recent_s.iter().sum::<f64>() / self.recent_s.len().max(1) as f64;
        if mean_s <= QUICK_S { 0.0 } else { GRACE_S }
    }
}

/// Size of all parts together along x and y, m.
fn size_m(parts: &[Bounds], voxel_m: f64) -> [f64; 2] {
    [0, 1].map(|axis| {
        let low = parts.iter().map(|(low, _)| low[axis]).min();
        let high = parts.iter().map(|(_, high)| high[axis]).max();
        low.zip(high)
            .map_or(0.0, |(low, high)| (high + 1 - low) as f64 * voxel_m)
    })
}

/// Columns of the networks' window.
const COLUMNS: usize = CELLS * COLUMNS_PER_CELL * COLUMNS_PER_CELL;

/// Extent, m, and share of the columns, of an edited region together with inpainted cells. Both are upper bounds.
fn with_inpainted(touched: &Touched, inpaint: &InpaintMask) -> ([f64; 2], f64) {
    let mut extent_m = touched.extent_m;
    for axis in 0..2 {
        let along = || inpaint.cells().map(|cell| cell[axis]);
        if let (Some(low), Some(high)) = (along().min(), along().max()) {
            extent_m[axis] = extent_m[axis].max(f64::from(high + 1 - low) * CELL_M);
        }
    }
    let share = inpaint.count() as f64 / CELLS as f64;
    (extent_m, (touched.share + share).min(1.0))
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;
    use std::sync::Arc;

    use super::*;
    use scene::{BevLayer, BevLayout, Frame, SensorRig, VoxelGrid};

    fn scene() -> Scene {
        let frame = Frame::new(BevLayout::default(), BTreeMap::new(), VoxelGrid::new());
        Scene::single("test", frame, Arc::new(SensorRig::default()), 7)
    }

    fn paint(scene: &mut Scene, x: usize) {
        scene.change_canvas(|f| f.layout.set(BevLayer::DrivableArea, x, 50, true));
    }

    fn submit(live: &mut Live, scene: &Scene, params: GenParams, now_s: f64, id: u64) {
        live.submitted(
            JobId(id),
            JobKey {
                rev: scene.content(),
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
        // After a failure or a cancel, the same input is not generated again automatically.
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
        (0..3).for_each(|_| live.took(0.01, 4.0));
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
        // After undo, the earlier state needs no generation.
        assert_eq!(live.advise(&before, false, 1.1), Advice::Cancel);
        assert!(live.ended(JobId(2)).is_none() && live.ended(JobId(1)).is_some());
        assert_eq!(live.advise(&before, false, 1.2), Advice::Rest);
    }

    #[test]
    fn large_edits_wait_for_the_user_and_what_waits_can_be_dropped() {
        let (mut live, mut scene) = (
            Live::new(GenParams::default(), GenParams::default(), false),
            scene(),
        );
        let before = scene.clone();
        for x in 0..120 {
            (0..200).for_each(|y| scene.change_canvas(|f| f.layout.set(BevLayer::DrivableArea, x, y, true)));
        }
        assert_eq!(live.advise(&scene, false, 1.0), Advice::Rest);
        assert!(
            matches!(live.paused, Some(Pause::Large(share)) if share > 0.6),
            "{:?}",
            live.paused
        );
        assert!(!live.has_waiting(scene.content()));
        // After undo, there is no reason to report any more.
        live.advise(&before, false, 1.1);
        assert_eq!(live.paused, None);
        // On request it is generated.
        let params = live.params_for(&scene, false);
        live.touched_by(&scene, 1.2);
        submit(&mut live, &scene, params, 1.2, 1);
        assert_eq!(live.running.as_ref().map(|r| r.purpose), Some(Purpose::Edit));
        live.ended(JobId(1));
        // A small edit waits during a drag. If it is dropped, it is not generated, but the next edit is.
        let mut small = before.clone();
        paint(&mut small, 40);
        live.touched_by(&small, 2.0);
        assert_eq!(live.advise(&small, true, 2.0), Advice::Rest);
        assert!(live.has_waiting(small.content()));
        live.drop_waiting(&small);
        assert!(!live.has_waiting(small.content()));
        assert_eq!(live.advise(&small, false, 3.0), Advice::Rest);
        paint(&mut small, 41);
        assert!(matches!(live.advise(&small, false, 4.0), Advice::Submit(_)));
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
        // After an inpainting the source has changed.
        let full = live.params_for(&scene, true);
        submit(&mut live, &scene, full, 3.0, 2);
        live.ended(JobId(2));
        let settled = self::scene();
        assert!(matches!(live.advise(&settled, false, 4.0), Advice::Wait(_)));
        assert!(matches!(live.advise(&settled, false, 5.0), Advice::WarmUp(_)));
    }
}
