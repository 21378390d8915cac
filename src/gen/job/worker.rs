//! The background thread of occupancy generation: the [`Product`] that runs a [`Pipeline`].

use std::sync::Arc;

use crate::contract::{GenError, Job, JobCtx, JobUpdate, Pipeline};
use runtime::guard::Panicked;
pub use runtime::worker::Wake;
use runtime::worker::{Ctx, Product, Worker};

/// Owns the thread `gen-worker`. Dropping it stops the running job and waits for the thread.
pub type GenWorker = Worker<Job, JobUpdate>;

/// Starts the thread. `build` runs on it and makes the pipeline (reads weights): for the first job, and again after a panic
/// or if it failed. Errors if the system gives no thread.
pub fn spawn<P, B>(build: B, wake: Wake) -> std::io::Result<GenWorker>
where
    P: Pipeline + 'static,
    B: FnMut() -> Result<P, GenError> + Send + 'static,
{
    let product = move || Occupancy {
        build,
        pipeline: None::<P>,
    };
    Worker::start("gen-worker", product, wake)
}

/// Occupancy as a product. Builds its pipeline when the first job needs it.
struct Occupancy<P, B> {
    build: B,
    pipeline: Option<P>,
}

impl<P, B> Product for Occupancy<P, B>
where
    P: Pipeline + 'static,
    B: FnMut() -> Result<P, GenError> + 'static,
{
    type Request = Job;
    type Update = JobUpdate;

    fn make(&mut self, job: &Job, ctx: &Ctx<'_, JobUpdate>) -> JobUpdate {
        let (stop, report) = (|| ctx.should_stop(), |update| ctx.tell(update));
        let ctx = JobCtx::new(&stop, &report).with_previews();
        let mut run = || {
            job.params.check()?;
            let ready = match &mut self.pipeline {
                Some(ready) => ready,
                None => self.pipeline.insert((self.build)()?),
            };
            ready.run(job, &ctx)
        };
        match run() {
            Ok(result) => JobUpdate::Finished(Arc::new(result)),
            Err(GenError::Superseded) => JobUpdate::Superseded,
            Err(error) => JobUpdate::Failed(error),
        }
    }

    fn reset(&mut self) {
        drop(self.pipeline.take());
    }

    fn given_up() -> JobUpdate {
        JobUpdate::Superseded
    }

    fn panicked(panic: Panicked) -> JobUpdate {
        JobUpdate::Failed(GenError::Panicked(panic.message))
    }

    fn is_terminal(update: &JobUpdate) -> bool {
        update.is_terminal()
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;
    use std::sync::atomic::{AtomicUsize, Ordering};
    use std::time::Duration;

    use crossbeam_channel::{Receiver, Sender, unbounded};

    use super::*;
    use crate::contract::{GenParams, GenReport, GenResult, JobEvent, Stage, UpdateGate};
    use runtime::worker::MOST_WAITING;
    use scene::{BevLayout, Frame, Scene, SensorRig, VoxelGrid};

    /// What the test tells the running job to do next.
    enum Do {
        /// Report a step; ends the job if it is not wanted any more.
        Step,
        /// Report a preview.
        Preview,
        /// Report this many steps and previews at once, then say "flooded".
        Flood(usize),
        /// Run until stopped.
        UntilStopped,
        Finish,
        Fail,
        Panic,
    }

    /// Does what the test says, step by step.
    struct Scripted {
        orders: Receiver<Do>,
        started: Sender<String>,
        steps: usize,
    }

    fn result_of(job: &Job) -> GenResult {
        GenResult {
            key: job.key(),
            occupancy: VoxelGrid::new(),
            report: GenReport::default(),
        }
    }

    impl Pipeline for Scripted {
        fn run(&mut self, job: &Job, ctx: &JobCtx<'_>) -> Result<GenResult, GenError> {
            let thread = std::thread::current().name().unwrap_or_default().to_owned();
            self.started.send(thread).expect("the test listens");
            let mut step = || {
                self.steps += 1;
                ctx.progress(Stage::Denoise, self.steps, 99)
            };
            loop {
                match self.orders.recv().expect("the test lives") {
                    Do::Step => step()?,
                    Do::Preview => ctx.preview(result_of(job)),
                    Do::Flood(n) => {
                        for _ in 0..n {
                            step()?;
                            ctx.preview(result_of(job));
                        }
                        self.started.send("flooded".into()).expect("the test listens");
                    }
                    Do::UntilStopped => loop {
                        ctx.check()?;
                        std::thread::yield_now();
                    },
                    Do::Finish => return Ok(result_of(job)),
                    Do::Fail => return Err(GenError::failed("no luck\ntoday")),
                    Do::Panic => panic!("scripted"),
                }
            }
        }
    }

    struct Bench {
        worker: GenWorker,
        orders: Sender<Do>,
        started: Receiver<String>,
        wakes: Arc<AtomicUsize>,
        builds: Arc<AtomicUsize>,
    }

    fn bench() -> Bench {
        let (orders, orders_in) = unbounded();
        let (started_out, started) = unbounded();
        let wakes = Arc::new(AtomicUsize::new(0));
        let builds = Arc::new(AtomicUsize::new(0));
        let (count_wakes, count_builds) = (wakes.clone(), builds.clone());
        let build = move || {
            count_builds.fetch_add(1, Ordering::SeqCst);
            Ok(Scripted {
                orders: orders_in.clone(),
                started: started_out.clone(),
                steps: 0,
            })
        };
        let wake = Arc::new(move || {
            count_wakes.fetch_add(1, Ordering::SeqCst);
        });
        Bench {
            worker: spawn(build, wake).expect("a thread"),
            orders,
            started,
            wakes,
            builds,
        }
    }

    fn job() -> Job {
        let frame = Frame::new(BevLayout::default(), BTreeMap::new(), VoxelGrid::new());
        Job {
            scene: Arc::new(Scene::single("test", frame, Arc::new(SensorRig::default()), 0)),
            params: GenParams::default(),
        }
    }

    /// A limit so that a broken worker fails the test instead of hanging it; never waited for otherwise.
    const PATIENCE: Duration = Duration::from_secs(30);

    impl Bench {
        fn tell(&self, what: Do) {
            self.orders.send(what).expect("the pipeline listens");
        }
        fn wait_started(&self) -> String {
            self.started.recv_timeout(PATIENCE).expect("a job starts")
        }
        fn next(&self) -> (u64, String) {
            let event = self.worker.updates().recv_timeout(PATIENCE).expect("an update");
            short(&event)
        }
    }

    fn short(event: &JobEvent) -> (u64, String) {
        let what = match &event.update {
            JobUpdate::Progress { stage, step, steps } => format!("{} {step}/{steps}", stage.name()),
            JobUpdate::Preview(_) => "preview".into(),
            JobUpdate::Finished(_) => "finished".into(),
            JobUpdate::Failed(error) => format!("failed: {error}"),
            JobUpdate::Superseded => "superseded".into(),
        };
        (event.id.0, what)
    }

    fn news(id: u64, what: &str) -> (u64, String) {
        (id, what.to_owned())
    }

    #[test]
    fn a_job_reports_and_finishes() {
        let mut b = bench();
        let asked = job();
        let id = b.worker.submit(asked.clone());
        assert_eq!(b.wait_started(), "gen-worker");
        b.tell(Do::Step);
        assert_eq!(b.next(), (id.0, "denoise 1/99".into()));
        b.tell(Do::Preview);
        assert_eq!(b.next(), (id.0, "preview".into()));
        b.tell(Do::Finish);
        let event = b.worker.updates().recv_timeout(PATIENCE).expect("an update");
        let JobUpdate::Finished(result) = event.update else {
            panic!("{event:?}");
        };
        assert_eq!(
            (event.id, result.key.clone(), result.rev()),
            (id, asked.key(), asked.scene.content())
        );
        // Another moment of the same content is the same job.
        let mut other = asked.clone();
        let scene = Arc::make_mut(&mut other.scene);
        let content = scene.content();
        scene.change_clip(|clip| clip.length_s = 2.0);
        let asked = other.key();
        Arc::make_mut(&mut other.scene).show(1.0);
        assert!(other.key() == asked && asked.rev != content);
        drop(b.worker); // joins, so that the wake-up after the last update is counted
        assert_eq!(b.wakes.load(Ordering::SeqCst), 3);
    }

    #[test]
    fn the_newest_job_wins() {
        let mut b = bench();
        b.worker.submit(job());
        b.wait_started();
        b.tell(Do::Step);
        assert_eq!(b.next(), news(1, "denoise 1/99"));
        for _ in 0..3 {
            b.worker.submit(job());
        }
        b.tell(Do::Step); // finds out between two steps
        assert_eq!(b.next(), news(1, "superseded"));
        assert_eq!(b.next(), news(2, "superseded"));
        assert_eq!(b.next(), news(3, "superseded"));
        b.wait_started();
        b.tell(Do::Finish);
        assert_eq!(b.next(), news(4, "finished"));
        assert!(b.started.try_recv().is_err(), "jobs 2 and 3 never started");
        assert_eq!(b.builds.load(Ordering::SeqCst), 1, "one pipeline for all");
    }

    #[test]
    fn cancel_ends_what_was_submitted_and_nothing_later() {
        let mut b = bench();
        b.worker.cancel(); // nothing there: no harm
        b.worker.submit(job());
        b.wait_started();
        b.tell(Do::UntilStopped);
        b.worker.cancel();
        assert_eq!(b.next(), news(1, "superseded"));
        b.worker.submit(job());
        b.wait_started();
        b.tell(Do::Finish);
        assert_eq!(b.next(), news(2, "finished"));
        b.worker.cancel(); // ended already: no second update
        b.worker.submit(job());
        b.wait_started();
        b.tell(Do::Finish);
        assert_eq!(b.next(), news(3, "finished"));
    }

    #[test]
    fn errors_and_panics_end_one_job_only() {
        let mut b = bench();
        b.worker.submit(job());
        b.wait_started();
        b.tell(Do::Fail);
        assert_eq!(b.next(), news(1, "failed: no luck; today"));
        assert_eq!(b.builds.load(Ordering::SeqCst), 1);
        b.worker.submit(job());
        b.wait_started();
        b.tell(Do::Panic);
        assert_eq!(b.next(), news(2, "failed: generation panicked: scripted"));
        b.worker.submit(job());
        b.wait_started();
        // A new pipeline: the old one's count of steps is gone.
        assert_eq!(b.builds.load(Ordering::SeqCst), 2);
        b.tell(Do::Step);
        assert_eq!(b.next(), news(3, "denoise 1/99"));
        b.tell(Do::Finish);
        assert_eq!(b.next(), news(3, "finished"));
        let mut bad = job();
        bad.params.steps = 0;
        b.worker.submit(bad);
        assert_eq!(b.next(), news(4, "failed: steps is 0, expected 1 to 1000"));
    }

    #[test]
    fn a_pipeline_that_cannot_be_built_is_tried_again() {
        struct Instant;
        impl Pipeline for Instant {
            fn run(&mut self, job: &Job, _: &JobCtx<'_>) -> Result<GenResult, GenError> {
                Ok(result_of(job))
            }
        }
        let mut attempts = 0;
        let build = move || {
            attempts += 1;
            match attempts {
                1 => Err(GenError::failed("tensor \"a\" is missing")),
                2 => panic!("while building"),
                _ => Ok(Instant),
            }
        };
        let panicking_wake = Arc::new(|| panic!("a wake-up that panics"));
        let mut worker = spawn(build, panicking_wake).expect("a thread");
        let mut next = || {
            worker.submit(job());
            short(&worker.updates().recv_timeout(PATIENCE).expect("an update")).1
        };
        assert_eq!(next(), "failed: tensor \"a\" is missing");
        assert_eq!(next(), "failed: generation panicked: while building");
        assert_eq!(next(), "finished");
    }

    #[test]
    fn a_slow_receiver_loses_previews_but_no_ending() {
        let mut b = bench();
        b.worker.submit(job());
        b.wait_started();
        b.tell(Do::Flood(10_000));
        assert_eq!(b.wait_started(), "flooded");
        b.tell(Do::Finish); // looks at no order to stop
        let updates = b.worker.updates().clone();
        drop(b.worker); // joins
        let left: Vec<_> = updates.try_iter().map(|e| short(&e)).collect();
        assert_eq!(left.len(), MOST_WAITING + 1);
        assert_eq!(left[0], news(1, "denoise 1/99"));
        assert_eq!(left[1], news(1, "preview"));
        assert_eq!(left[MOST_WAITING], news(1, "finished"));
    }

    #[test]
    fn dropping_stops_and_joins() {
        let mut b = bench();
        let updates = b.worker.updates().clone();
        b.worker.submit(job());
        b.wait_started();
        b.tell(Do::UntilStopped);
        b.worker.submit(job());
        drop(b.worker);
        let ends: Vec<_> = updates.try_iter().map(|e| short(&e)).collect();
        assert_eq!(ends, [news(1, "superseded"), news(2, "superseded")]);
        assert!(b.started.try_recv().is_err(), "job 2 never started");
        drop(bench()); // nothing ever submitted
    }

    /// Row 61 of the extremes table, with the worker: a result that was ready just as a newer job came
    /// is delivered (it is good for its own revision), and the gate drops what is older than the screen.
    #[test]
    fn row_61_results_keep_the_order_of_their_ids() {
        let mut b = bench();
        b.worker.submit(job());
        b.wait_started();
        b.worker.submit(job());
        b.tell(Do::Finish); // job 1 does not look for a newer job any more
        b.wait_started();
        b.tell(Do::Step);
        b.tell(Do::Finish);
        let events: Vec<JobEvent> = (0..3)
            .map(|_| b.worker.updates().recv_timeout(PATIENCE).expect("an update"))
            .collect();
        let told: Vec<_> = events.iter().map(short).collect();
        let expected = [news(1, "finished"), news(2, "denoise 1/99"), news(2, "finished")];
        assert_eq!(told, expected);
        let mut gate = UpdateGate::default();
        assert!(events.iter().all(|e| gate.admit(e)));
        assert!(!events.iter().any(|e| gate.admit(e)), "shown twice");
        let mut late = UpdateGate::default();
        assert!(late.admit(&events[1]) && !late.admit(&events[0]));
    }

    /// Exactly one ending per job and in order, whatever the timing.
    #[test]
    fn every_job_ends_once_and_in_order() {
        struct Quick;
        impl Pipeline for Quick {
            fn run(&mut self, job: &Job, ctx: &JobCtx<'_>) -> Result<GenResult, GenError> {
                for step in 0..3 {
                    ctx.progress(Stage::Invert, step, 3)?;
                    std::thread::yield_now();
                }
                if job.params.seed % 7 == 3 {
                    // A panic without the hundreds of messages.
                    std::panic::resume_unwind(Box::new("scripted"));
                }
                Ok(result_of(job))
            }
        }
        let mut worker = spawn(|| Ok(Quick), Arc::new(|| {})).expect("a thread");
        let base = job();
        for seed in 0..2000u64 {
            let mut next = base.clone();
            next.params.seed = seed;
            worker.submit(next);
            if seed % 3 == 0 {
                std::thread::yield_now();
            }
            if seed % 11 == 5 {
                worker.cancel();
            }
        }
        let updates = worker.updates().clone();
        drop(worker);
        let ends: Vec<u64> = updates
            .try_iter()
            .filter(|e| e.update.is_terminal())
            .map(|e| e.id.0)
            .collect();
        assert_eq!(ends, (1..=2000).collect::<Vec<u64>>());
    }
}
