//! Maps of another extent than the networks' window: a job is done window by window, and the result of each window is
//! put back into the map.

use std::borrow::Cow;
use std::collections::BTreeSet;
use std::sync::Arc;

use super::plan::{CallTask, LatentWindow, NetworkCall, extent_of, plan};
use super::unfinished::Unfinished;
use crate::contract::{GenError, GenParams, GenReport, GenResult, Job, JobCtx, JobUpdate, RegionMode};
use crate::inpaint::{self, InpaintMask};
use crate::region::CELLS_PER_SIDE;
use scene::raster::box_cells;
use scene::{BevLayout, Extent, Frame, Scene, SceneBox, VoxelGrid, Window};

/// The window at the origin of a job's scene, as a job; `None` if the frame is that window.
pub(super) fn at_origin(job: &Job) -> Option<Job> {
    (job.scene.frame().extent() != Extent::WINDOW).then(|| Job {
        scene: Arc::new(job.scene.window_at(LatentWindow([0, 0]).to_window())),
        params: job.params.clone(),
    })
}

/// The job on the scene that the networks are asked about ([`Scene::for_generation`]): standing content, and moving
/// objects that are still drafts.
fn standing(job: &Job) -> Cow<'_, Job> {
    match job.scene.for_generation() {
        Cow::Borrowed(_) => Cow::Borrowed(job),
        Cow::Owned(scene) => Cow::Owned(Job {
            scene: Arc::new(scene),
            params: job.params.clone(),
        }),
    }
}

/// True if a job has nothing to generate.
pub fn is_idle(job: &Job) -> bool {
    if job.params.region != RegionMode::Auto {
        return false;
    }
    let inner = super::lattice::in_networks_lattice(job);
    let frame = inner.as_ref().unwrap_or(job).scene.for_generation();
    plan(frame.frame(), &job.params).is_empty()
}

/// Runs a job in the window at the origin alone.
pub(super) fn in_window(
    job: &Job,
    ctx: &JobCtx<'_>,
    mut run: impl FnMut(&Job, &JobCtx<'_>) -> Result<GenResult, GenError>,
) -> Result<GenResult, GenError> {
    let job = &*standing(job);
    let Some(cut) = at_origin(job) else {
        return run(job, ctx);
    };
    let mut map = Frame::clone(job.scene.frame());
    let result = run(&cut, ctx)?;
    map.occupancy.paste(&result.occupancy);
    Ok(GenResult {
        occupancy: map.occupancy,
        ..result
    })
}

/// Runs a job window by window. Previews and the result are of the whole map. A whole map that was stopped before is
/// resumed.
pub(super) fn over_the_map(
    job: &Job,
    ctx: &JobCtx<'_>,
    unfinished: &mut Unfinished,
    mut run: impl FnMut(&Job, &JobCtx<'_>) -> Result<GenResult, GenError>,
) -> Result<GenResult, GenError> {
    let job = &*standing(job);
    if job.scene.frame().extent() == Extent::WINDOW {
        return run(job, ctx);
    }
    let mut map = GeneratedMap {
        scene: Scene::clone(&job.scene),
        params: job.params.clone(),
    };
    let rounds = plan(job.scene.frame(), &job.params);
    let all: usize = rounds.iter().map(Vec::len).sum();
    let (mut report, mut done, mut made) = (GenReport::default(), 0, 0);
    let mut holes = BTreeSet::new();
    let mut kept = unfinished.begin(job);
    for round in &rounds {
        let before = map.scene.clone();
        for part in round {
            ctx.check()?;
            done += 1;
            let Some(cut) = map.cut(&before, round, part) else {
                continue;
            };
            let stop = || ctx.check().is_err();
            made += 1;
            if let Some(result) = kept.as_ref().and_then(|kept| kept.part(made - 1)) {
                map.take(part, &cut, &result);
                map.note_holes(part, &cut, &result, &mut holes);
                report.add(&result.report);
                continue;
            }
            let (so_far, report_so_far) = (&map, &report);
            let forward = |update: JobUpdate| match update {
                JobUpdate::Preview(result) => ctx.preview(GenResult {
                    key: job.key(),
                    occupancy: so_far.with(part, &cut, &result),
                    report: report_so_far.clone(),
                }),
                JobUpdate::Progress { stage, step, steps } => ctx.report(JobUpdate::Progress {
                    stage,
                    step: (done - 1) * steps + step,
                    steps: all * steps,
                }),
                other => ctx.report(other),
            };
            let inner = match ctx.previews() {
                true => JobCtx::new(&stop, &forward).with_previews(),
                false => JobCtx::new(&stop, &forward),
            };
            let result = run(&cut.job, &inner)?;
            if let Some(kept) = &mut kept {
                kept.keep(&result);
            }
            map.take(part, &cut, &result);
            map.note_holes(part, &cut, &result, &mut holes);
            report.add(&result.report);
            if ctx.previews() && done < all {
                ctx.preview(GenResult {
                    key: job.key(),
                    occupancy: map.scene.frame().occupancy.clone(),
                    report: report.clone(),
                });
            }
        }
    }
    if let Some(kept) = kept {
        kept.end();
    }
    report.region_share = report.region_columns as f64 / job.scene.frame().extent().columns() as f64;
    let occupancy = map.scene.frame().occupancy.clone();
    // Holes only of the parts that were taken over: windows overlap, and the rest of each result is discarded.
    report.close(holes.into_iter().collect());
    report.voxels_changed = job.scene.frame().source.occupancy.count_different(&occupancy);
    Ok(GenResult {
        key: job.key(),
        occupancy,
        report,
    })
}

/// A part as a job in the window at the origin.
struct Cut {
    job: Job,
    /// Flags of the columns of that window, `[x][y]`, that are taken over; `None` for those of the part's task.
    columns: Option<Vec<bool>>,
}

/// A map that is being generated.
struct GeneratedMap {
    /// The scene as generated so far.
    scene: Scene,
    /// The job's parameters; cells to inpaint are removed once they are done.
    params: GenParams,
}

impl GeneratedMap {
    /// Cuts a part of a round out of the map as it was before the round; `None` if nothing is left to do there.
    fn cut(&self, before: &Scene, round: &[NetworkCall], part: &NetworkCall) -> Option<Cut> {
        let mut scene = window(before, part.place);
        let mut params = GenParams {
            seed: part.place.seed(self.params.seed),
            inpaint: InpaintMask::default(),
            ..self.params.clone()
        };
        let mut columns = None;
        match &part.task {
            CallTask::Whole(_) => {}
            CallTask::Edit => {
                params.inpaint = self.params.inpaint.from_cell(part.place.0);
                if inpaint::region_of(scene.frame(), &params).is_empty() {
                    return None;
                }
            }
            CallTask::Seam(cells) => {
                let cells = InpaintMask::of_cells(cells).from_cell(part.place.0);
                params.region = RegionMode::Auto;
                params.strength = 1.0;
                // An object across the seam was drawn in two halves: it is drawn again, by one part alone.
                let first_at = |b: &SceneBox| {
                    let touching = round.iter().filter(|p| p.seam_touches(part.place, b));
                    touching.map(|p| p.place).min()
                };
                let mut again = Vec::new();
                scene.change_canvas(|frame| {
                    let mut source = (*frame.source).clone();
                    source.boxes.retain(|_, b| {
                        let mine = cells.touches(b) && first_at(b) == Some(part.place);
                        again.extend(mine.then_some(*b));
                        !mine
                    });
                    frame.source = Arc::new(source);
                });
                params.inpaint = cells.clone();
                // Its halo may lie in the cells of another part: that part takes those columns over.
                let mut own = cells.columns(Extent::WINDOW);
                for b in &again {
                    box_cells(Extent::WINDOW, b, inpaint::KEPT_M, |x, y| {
                        own[Extent::WINDOW.index(x, y)] = true
                    });
                }
                let wanted = inpaint::wanted_columns(scene.frame(), &params);
                columns = Some(
                    wanted
                        .into_iter()
                        .zip(own)
                        .map(|(wanted, own)| wanted && own)
                        .collect(),
                );
            }
        }
        let scene = Arc::new(scene);
        Some(Cut {
            job: Job { scene, params },
            columns,
        })
    }

    /// The map's voxels with a result put in its place.
    fn with(&self, part: &NetworkCall, cut: &Cut, result: &GenResult) -> VoxelGrid {
        let mut occupancy = self.scene.frame().occupancy.clone();
        let made = part.place.to_window().back().grid(&result.occupancy);
        match (&part.task, &cut.columns) {
            (CallTask::Whole(cells), _) => occupancy.paste(&made.crop(extent_of(cells))),
            (_, None) => occupancy.paste(&made),
            (_, Some(columns)) => {
                let taken = Extent::WINDOW
                    .all_columns()
                    .zip(columns)
                    .filter(|(_, taken)| **taken);
                for ([x, y], _) in taken {
                    let p = made.extent().center(x, y, 0);
                    if let Some([to_x, to_y]) = occupancy.extent().column_at(p.x, p.y) {
                        *occupancy.window_column_mut(to_x, to_y) = *made.window_column(x, y);
                    }
                }
            }
        }
        occupancy
    }

    /// Records the closed holes of a result on the map, and forgets earlier ones in columns that it redraws.
    fn note_holes(
        &self,
        part: &NetworkCall,
        cut: &Cut,
        result: &GenResult,
        holes: &mut BTreeSet<[usize; 3]>,
    ) {
        let (window, map) = (part.place.extent(), self.scene.frame().extent());
        let on_map = |x: usize, y: usize| {
            let p = window.center(x, y, 0);
            map.column_at(p.x, p.y)
        };
        let own = match &part.task {
            CallTask::Whole(cells) => Some(extent_of(cells)),
            CallTask::Edit | CallTask::Seam(_) => None,
        };
        let taken = |x: usize, y: usize| {
            let p = window.center(x, y, 0);
            own.is_none_or(|own| own.column_at(p.x, p.y).is_some())
                && cut.columns.as_ref().is_none_or(|c| c[Extent::WINDOW.index(x, y)])
        };
        if let Some(columns) = &cut.columns {
            let drawn = Extent::WINDOW
                .all_columns()
                .zip(columns)
                .filter(|(_, taken)| **taken);
            for [x, y] in drawn.filter_map(|([x, y], _)| on_map(x, y)) {
                for z in 0..Window::NZ {
                    holes.remove(&[x, y, z]);
                }
            }
        }
        let closed = result.report.holes.iter().filter(|[x, y, _]| taken(*x, *y));
        holes.extend(closed.filter_map(|[x, y, z]| on_map(*x, *y).map(|[x, y]| [x, y, *z])));
    }

    /// Takes over a result.
    fn take(&mut self, part: &NetworkCall, cut: &Cut, result: &GenResult) {
        let occupancy = self.with(part, cut, result);
        let settled = match &part.task {
            CallTask::Whole(cells) => extent_of(cells),
            CallTask::Edit | CallTask::Seam(_) => part.place.extent(),
        };
        self.scene.change_canvas(|frame| {
            frame.occupancy = occupancy;
            frame.settle_within(settled);
        });
        if part.task == CallTask::Edit {
            self.params.inpaint = self.params.inpaint.without(part.place.0, CELLS_PER_SIDE as i32);
        }
    }
}

/// The content of a window of a scene. Roads are continued beyond the border of the map, as in the training data.
fn window(scene: &Scene, place: LatentWindow) -> Scene {
    let (to_window, extent, map) = (place.to_window(), place.extent(), scene.frame());
    let mut scene = scene.window_at(to_window);
    let shared = map.extent().overlap(&extent);
    if shared.is_some_and(|shared| shared.size == [extent.nx(), extent.ny()]) {
        return scene;
    }
    scene.change_canvas(|frame| {
        let continued = |layout: &BevLayout| to_window.layout(&layout.crop_continued(extent));
        frame.layout = continued(&map.layout);
        let mut source = (*frame.source).clone();
        source.layout = continued(&map.source.layout);
        frame.source = Arc::new(source);
    });
    scene
}

#[cfg(test)]
mod tests {
    use super::*;
    use scene::{BevLayer, BoxId, Class, SensorRig};
    use std::sync::Mutex;

    fn map() -> Extent {
        Extent::new([-150, -110], [480, 320]).expect("sound")
    }

    fn scene() -> Scene {
        let mut occupancy = VoxelGrid::over(map());
        occupancy.set(400, 160, 3, Class::Manmade.id()); // 100 m ahead
        occupancy.set(150, 110, 0, Class::DriveableSurface.id()); // below the ego vehicle
        let frame = Frame::new(BevLayout::over(map()), Default::default(), occupancy);
        Scene::single("map", frame, Arc::new(SensorRig::default()), 1)
    }

    fn job(scene: Scene, params: GenParams) -> Job {
        let scene = Arc::new(scene);
        Job { scene, params }
    }

    /// Instead of networks: vegetation wherever something is to be generated, as high as the job's seed and what stands in the
    /// window say.
    fn grow(job: &Job, ctx: &JobCtx<'_>) -> Result<GenResult, GenError> {
        let frame = job.scene.frame();
        assert_eq!(frame.extent(), Extent::WINDOW);
        let columns = match job.params.region {
            RegionMode::Auto => inpaint::wanted_columns(frame, &job.params),
            RegionMode::Full => vec![true; Extent::WINDOW.columns()],
        };
        let mut grid = frame.source.occupancy.clone();
        let around = frame.source.occupancy.count_set() as u64;
        let high = 1 + (job.params.seed.wrapping_add(around) % 13) as usize;
        for ([x, y], _) in Extent::WINDOW.all_columns().zip(&columns).filter(|(_, c)| **c) {
            (0..high).for_each(|z| grid.set(x, y, z, Class::Vegetation.id()));
        }
        ctx.progress(crate::Stage::Denoise, 1, 2)?;
        let result = GenResult {
            key: job.key(),
            occupancy: grid,
            report: GenReport {
                network_calls: 1,
                region_columns: columns.iter().filter(|c| **c).count(),
                ..GenReport::default()
            },
        };
        ctx.preview(result.clone());
        Ok(result)
    }

    fn car(id: u32, x_m: f64, y_m: f64) -> SceneBox {
        crate::region::tests::car(id, x_m, y_m, 0.0)
    }

    #[test]
    fn an_edit_far_from_the_origin_is_generated_where_it_is() {
        let mut scene = scene();
        scene.change_canvas(|frame| {
            for b in [car(1, 100.0, 0.0), car(2, 5.0, 0.0)] {
                frame.boxes.insert(b.id, b);
            }
        });
        let before = scene.frame().occupancy.clone();
        let updates = Mutex::new(Vec::new());
        let report = |update| updates.lock().expect("not poisoned").push(update);
        let stop = || false;
        let ctx = JobCtx::new(&stop, &report).with_previews();
        let job = job(scene, GenParams::default());
        assert!(!is_idle(&job));
        let result = over_the_map(&job, &ctx, &mut Unfinished::default(), grow).expect("runs");
        assert_eq!((result.key.clone(), result.report.network_calls), (job.key(), 2));
        assert_eq!(result.occupancy.extent(), map());
        let label = |x_m, y_m| {
            let [x, y] = map().column_at(x_m, y_m).expect("on the map");
            result.occupancy.get(x, y, 0)
        };
        assert_eq!([label(100.0, 0.0), label(5.0, 0.0)], [Class::Vegetation.id(); 2]);
        let changed = result.occupancy.count_different(&before);
        assert!(changed > 100 && changed < 4000, "{changed}");
        assert!(result.report.region_columns < 2000);
        let updates = updates.into_inner().expect("not poisoned");
        let steps: Vec<_> = updates
            .iter()
            .filter_map(|u| match u {
                JobUpdate::Progress { step, steps, .. } => Some((*step, *steps)),
                _ => None,
            })
            .collect();
        assert_eq!(steps, [(1, 4), (3, 4)], "of both windows together");
        let sizes = updates.iter().filter_map(|u| match u {
            JobUpdate::Preview(result) => Some(result.occupancy.extent()),
            _ => None,
        });
        assert!(sizes.clone().count() >= 2 && sizes.into_iter().all(|e| e == map()));
        // One that has nothing to do asks no network.
        let mut settled = Scene::clone(&job.scene);
        settled.change_canvas(Frame::settle);
        let idle = Job {
            scene: Arc::new(settled),
            params: GenParams::default(),
        };
        assert!(is_idle(&idle));
        let none = |_: &Job, _: &JobCtx<'_>| panic!("no network is asked");
        let result =
            over_the_map(&idle, &JobCtx::detached(), &mut Unfinished::default(), none).expect("nothing");
        assert_eq!(result.occupancy, before);
    }

    #[test]
    fn cells_that_are_marked_far_away_change_once_each() {
        let mut mask = InpaintMask::default();
        // A strip of 112 m: more than a window.
        let columns: Vec<[usize; 2]> = (100..380).flat_map(|x| (150..170).map(move |y| [x, y])).collect();
        mask.set_columns(map(), &columns, true);
        let params = GenParams {
            inpaint: mask.clone(),
            strength: 1.0,
            ..GenParams::default()
        };
        let job = job(scene(), params);
        let result = over_the_map(&job, &JobCtx::detached(), &mut Unfinished::default(), grow).expect("runs");
        let held = mask.columns(map()).iter().filter(|c| **c).count();
        assert_eq!(result.report.region_columns, held, "none twice, none left out");
        for [x, y] in map().all_columns() {
            let grown = result.occupancy.get(x, y, 0) == Class::Vegetation.id();
            assert_eq!(grown, mask.has_column(map(), [x, y]), "{x} {y}");
        }
    }

    #[test]
    fn a_whole_map_is_made_of_windows_with_their_own_seeds_and_seams() {
        let mut scene = scene();
        scene.change_canvas(|frame| {
            let b = car(1, 6.4, 2.0); // where two windows meet
            frame.boxes.insert(b.id, b);
            frame.settle();
            frame.layout.set(BevLayer::Walkway, 0, 0, true);
        });
        let params = GenParams {
            region: RegionMode::Full,
            seed: 5,
            ..GenParams::default()
        };
        let job = job(scene, params);
        let calls = Mutex::new(Vec::new());
        let log = |job: &Job, ctx: &JobCtx<'_>| {
            let frame = job.scene.frame();
            let redrawn = job.params.strength > 0.0 && frame.source.boxes.is_empty();
            calls
                .lock()
                .expect("not poisoned")
                .push((job.params.clone(), redrawn));
            grow(job, ctx)
        };
        let result = over_the_map(&job, &JobCtx::detached(), &mut Unfinished::default(), log).expect("runs");
        let calls = calls.into_inner().expect("not poisoned");
        let seams: Vec<_> = calls.iter().filter(|(p, _)| p.strength == 1.0).collect();
        assert_eq!((calls.len(), seams.len()), (15, 9));
        assert!(
            seams.iter().any(|(_, redrawn)| *redrawn),
            "the car across a seam is drawn again"
        );
        let seeds: std::collections::BTreeSet<u64> = calls.iter().map(|(p, _)| p.seed).collect();
        assert_eq!(seeds.len(), calls.len());
        let free = |[x, y]: &[usize; 2]| result.occupancy.get(*x, *y, 0) == Class::FREE;
        assert!(!map().all_columns().any(|c| free(&c)), "no column is left out");
        // The same whatever came first: windows of one kind see nothing of each other.
        let again = over_the_map(&job, &JobCtx::detached(), &mut Unfinished::default(), grow).expect("runs");
        assert_eq!(again.occupancy, result.occupancy);
    }

    /// Windows overlap: a hole that two of them close counts once, and one beyond the map or in another's part not at all.
    #[test]
    fn counts_of_a_whole_map_are_of_what_differs() {
        let params = GenParams {
            region: RegionMode::Full,
            ..GenParams::default()
        };
        let job = job(scene(), params);
        let everywhere = |job: &Job, ctx: &JobCtx<'_>| {
            let mut result = grow(job, ctx)?;
            let columns = Extent::WINDOW.all_columns();
            result.report.close(columns.map(|[x, y]| [x, y, 0]).collect());
            Ok(result)
        };
        let result = over_the_map(&job, &JobCtx::detached(), &mut Unfinished::default(), everywhere);
        let report = result.expect("runs").report;
        assert_eq!(report.holes_closed, map().columns());
        let source = &job.scene.frame().source.occupancy;
        let again = over_the_map(&job, &JobCtx::detached(), &mut Unfinished::default(), grow).expect("runs");
        assert_eq!(report.voxels_changed, source.count_different(&again.occupancy));
    }

    #[test]
    fn a_job_that_is_stopped_ends_between_windows_and_goes_on_there() {
        let done = std::cell::Cell::new(0);
        let params = GenParams {
            region: RegionMode::Full,
            ..GenParams::default()
        };
        let stopped = std::sync::atomic::AtomicBool::new(false);
        let stop = || stopped.load(std::sync::atomic::Ordering::Relaxed);
        let ignore = |_| {};
        let ctx = JobCtx::new(&stop, &ignore);
        let run = |job: &Job, ctx: &JobCtx<'_>| {
            done.set(done.get() + 1);
            stopped.store(done.get() == 3, std::sync::atomic::Ordering::Relaxed);
            match done.get() < 3 {
                true => grow(job, ctx),
                false => Err(GenError::Superseded),
            }
        };
        let (job, mut unfinished) = (job(scene(), params.clone()), Unfinished::default());
        let error = over_the_map(&job, &ctx, &mut unfinished, run).expect_err("stopped");
        assert_eq!((error, done.get()), (GenError::Superseded, 3));
        // The same scene under another revision: two windows are there already.
        let again = self::job(scene(), params.clone());
        assert_ne!(again.key(), job.key());
        let calls = std::cell::Cell::new(0);
        let count = |job: &Job, ctx: &JobCtx<'_>| {
            calls.set(calls.get() + 1);
            grow(job, ctx)
        };
        let resumed = over_the_map(&again, &JobCtx::detached(), &mut unfinished, count).expect("runs");
        let whole =
            over_the_map(&again, &JobCtx::detached(), &mut Unfinished::default(), grow).expect("runs");
        assert_eq!(resumed.occupancy, whole.occupancy);
        assert_eq!(resumed.report.network_calls, whole.report.network_calls);
        assert_eq!(calls.get() + 2, whole.report.network_calls);
        // An edit between leaves it alone; another seed begins anew.
        unfinished.begin(&again).expect("a whole map").keep(&resumed);
        assert!(
            unfinished
                .begin(&self::job(scene(), GenParams::default()))
                .is_none()
        );
        assert!(unfinished.part(0).is_some());
        let other = self::job(scene(), GenParams { seed: 77, ..params });
        assert!(unfinished.begin(&other).expect("a whole map").part(0).is_none());
    }

    #[test]
    fn the_parts_of_a_round_may_be_made_in_any_order() {
        let params = GenParams {
            region: RegionMode::Full,
            ..GenParams::default()
        };
        let made = |reverse: bool| {
            let mut scene = scene();
            scene.change_canvas(|f| {
                f.boxes.insert(BoxId(3), car(3, 6.0, 19.0));
            });
            let mut map = GeneratedMap {
                params: params.clone(),
                scene,
            };
            for mut round in plan(map.scene.frame(), &map.params) {
                let before = map.scene.clone();
                if reverse {
                    round.reverse();
                }
                for part in &round {
                    let cut = map.cut(&before, &round, part).expect("work to do");
                    let result = grow(&cut.job, &JobCtx::detached()).expect("grown");
                    map.take(part, &cut, &result);
                }
            }
            map.scene.frame().occupancy.clone()
        };
        assert_eq!(made(false), made(true));
    }
}
