//! Work in the background: one [`Worker`] thread per kind of product (occupancy, sweeps and pictures, findings). A newer
//! job of a kind replaces the older ones. A job asks between its steps whether it should stop. A panic ends the job, not
//! the thread.
//!
//! Every submitted job gets exactly one terminal update, in the order of submission. Other updates are dropped while
//! the receiver is behind; terminal updates never are.

use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::thread::JoinHandle;

use crossbeam_channel::{Receiver, Sender, unbounded};

use crate::guard::{Handed, Panicked, guarded};

/// Number of a submitted job; later jobs have greater ones.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct JobId(pub u64);

/// Callback after every update, on the worker's thread: wakes the event loop.
pub type Wake = Arc<dyn Fn() + Send + Sync>;

/// Number of updates that may wait for the receiver; beyond it, updates that are not terminal are dropped.
pub const MOST_WAITING: usize = 64;

/// A kind of product made in the background. Lives on the worker's thread.
pub trait Product: 'static {
    /// A job.
    type Request: Send + 'static;
    /// Update of a job, while it runs and at its end.
    type Update: Send + 'static;

    /// Does a job and returns its terminal update.
    fn make(&mut self, request: &Self::Request, ctx: &Ctx<'_, Self::Update>) -> Self::Update;

    /// Called after a panic: discards state that may be half-done.
    fn reset(&mut self);

    /// The terminal update of a job that was given up for a newer one or on request.
    fn given_up() -> Self::Update;

    /// The terminal update of a job that panicked.
    fn panicked(panic: Panicked) -> Self::Update;

    /// True for the last update of a job.
    fn is_terminal(update: &Self::Update) -> bool;

    /// True for an update that must arrive even if the receiver is behind.
    fn must_arrive(_: &Self::Update) -> bool {
        false
    }
}

/// An update with its job.
#[derive(Clone, Debug)]
pub struct Event<U> {
    /// The job.
    pub id: JobId,
    /// Its update.
    pub update: U,
}

/// Connection of a running job to its caller.
pub struct Ctx<'a, U> {
    stop: &'a (dyn Fn() -> bool + Sync),
    report: &'a (dyn Fn(U) + Sync),
}

impl<U> Ctx<'_, U> {
    /// True if the job is not wanted any more. Check it between steps.
    pub fn should_stop(&self) -> bool {
        (self.stop)()
    }

    /// Reports an update of a running job. Terminal updates are ignored: the worker sends those itself.
    pub fn tell(&self, update: U) {
        (self.report)(update);
    }
}

/// State that the submitting side and the worker thread share.
#[derive(Default)]
struct Orders {
    /// Id of the newest submitted job; 0 before the first.
    newest: AtomicU64,
    /// Jobs up to this id are not wanted any more.
    cancelled: AtomicU64,
}

impl Orders {
    fn is_unwanted(&self, id: JobId) -> bool {
        id.0 < self.newest.load(Ordering::Acquire) || id.0 <= self.cancelled.load(Ordering::Acquire)
    }
}

/// A job on its way to the thread.
type QueuedJob<R> = (JobId, Handed<R>);

/// Owns the thread of one kind of product. Dropping it stops the running job and waits for the thread.
pub struct Worker<R, U> {
    name: &'static str,
    jobs: Option<Sender<QueuedJob<R>>>, // None only while dropping
    updates: Receiver<Event<U>>,
    orders: Arc<Orders>,
    thread: Option<JoinHandle<()>>,
}

impl<R: Send + 'static, U: Send + 'static> Worker<R, U> {
    /// Starts a thread of this name. `product` runs on it and makes the object that does the work. Errors if the system
    /// gives no thread.
    pub fn start<P: Product<Request = R, Update = U>>(
        name: &'static str,
        product: impl FnOnce() -> P + Send + 'static,
        wake: Wake,
    ) -> std::io::Result<Self> {
        let (jobs, jobs_in) = unbounded();
        let (updates_out, updates) = unbounded();
        let orders = Arc::new(Orders::default());
        let outbox = Outbox {
            name,
            updates: updates_out,
            wake,
        };
        let seen_by_thread = orders.clone();
        let thread = std::thread::Builder::new()
            .name(name.into())
            .spawn(move || work(&jobs_in, &seen_by_thread, &outbox, product()))?;
        Ok(Self {
            name,
            jobs: Some(jobs),
            updates,
            orders,
            thread: Some(thread),
        })
    }

    /// Submits a job. The running job and the waiting ones are given up.
    pub fn submit(&mut self, request: R) -> JobId {
        let id = JobId(self.orders.newest.load(Ordering::Acquire) + 1);
        // Set before sending: the running job should end now, not when the thread takes the new one.
        self.orders.newest.store(id.0, Ordering::Release);
        if let Some(jobs) = &self.jobs {
            // The thread ends only when this sender is gone, so the send succeeds.
            let _ = jobs.send((id, Handed::new(self.name, request)));
        }
        id
    }

    /// Gives up every job submitted so far. Their terminal updates still come.
    pub fn cancel(&self) {
        let newest = self.orders.newest.load(Ordering::Acquire);
        self.orders.cancelled.fetch_max(newest, Ordering::AcqRel);
    }

    /// The job that was submitted last; 0 before the first.
    pub fn newest(&self) -> JobId {
        JobId(self.orders.newest.load(Ordering::Acquire))
    }

    /// All updates, oldest first. Call `try_iter` once per frame; all clones share one stream.
    pub fn updates(&self) -> &Receiver<Event<U>> {
        &self.updates
    }
}

impl<R, U> Drop for Worker<R, U> {
    fn drop(&mut self) {
        self.orders.cancelled.store(u64::MAX, Ordering::Release);
        self.jobs = None;
        if let Some(thread) = self.thread.take() {
            // An error here means a panic outside any job; it cannot be reported any more.
            let _ = thread.join();
        }
    }
}

struct Outbox<U> {
    name: &'static str,
    updates: Sender<Event<U>>,
    wake: Wake,
}

impl<U> Outbox<U> {
    fn send(&self, id: JobId, update: U, must_arrive: bool) {
        if must_arrive || self.updates.len() < MOST_WAITING {
            // The receiver lives as long as the worker, except at the very end.
            let _ = self.updates.send(Event { id, update });
            // A wake-up that panics must cost neither the job nor the thread.
            let _ = guarded(self.name, || (self.wake)());
        }
    }
}

fn work<P: Product>(
    jobs: &Receiver<QueuedJob<P::Request>>,
    orders: &Orders,
    outbox: &Outbox<P::Update>,
    mut product: P,
) {
    for (id, job) in jobs {
        let end = if orders.is_unwanted(id) {
            P::given_up()
        } else {
            let stop = || orders.is_unwanted(id);
            // The worker sends the terminal update; a product must not send a second one.
            let report = |update: P::Update| {
                if !P::is_terminal(&update) {
                    let must_arrive = P::must_arrive(&update);
                    outbox.send(id, update, must_arrive);
                }
            };
            let ctx = Ctx {
                stop: &stop,
                report: &report,
            };
            job.run(|request| product.make(&request, &ctx))
                .unwrap_or_else(|panic| {
                    // Its destructors may panic as well.
                    let _ = guarded(outbox.name, || product.reset());
                    P::panicked(panic)
                })
        };
        outbox.send(id, end, true);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::guard::panic_next;
    use std::time::Duration;

    /// Counts to what is asked for; told at every number.
    #[derive(Default)]
    struct Counting {
        made: usize,
    }

    #[derive(Debug, PartialEq)]
    enum Told {
        Number(usize),
        Done(usize),
        GivenUp,
        Failed(String),
    }

    impl Product for Counting {
        type Request = Option<usize>;
        type Update = Told;
        fn make(&mut self, to: &Option<usize>, ctx: &Ctx<'_, Told>) -> Told {
            self.made += 1;
            let Some(to) = *to else {
                while !ctx.should_stop() {
                    std::thread::yield_now();
                }
                return Told::GivenUp;
            };
            (0..to).for_each(|i| ctx.tell(Told::Number(i)));
            ctx.tell(Told::Done(99)); // must not pass
            Told::Done(self.made)
        }
        fn reset(&mut self) {
            self.made = 0;
            panic!("while throwing away");
        }
        fn given_up() -> Told {
            Told::GivenUp
        }
        fn panicked(panic: Panicked) -> Told {
            Told::Failed(panic.to_string())
        }
        fn is_terminal(update: &Told) -> bool {
            !matches!(update, Told::Number(_))
        }
        fn must_arrive(update: &Told) -> bool {
            matches!(update, Told::Number(i) if i % 100 == 0)
        }
    }

    fn worker() -> Worker<Option<usize>, Told> {
        Worker::start("counting", Counting::default, Arc::new(|| {})).expect("a thread")
    }

    fn next(worker: &Worker<Option<usize>, Told>) -> (u64, Told) {
        let event = worker.updates().recv_timeout(Duration::from_secs(30));
        event.map(|e| (e.id.0, e.update)).expect("an update")
    }

    #[test]
    fn a_panic_ends_one_job_and_the_next_one_works() {
        let mut w = worker();
        w.submit(Some(1));
        assert_eq!([next(&w), next(&w)], [(1, Told::Number(0)), (1, Told::Done(1))]);
        panic_next("counting");
        w.submit(Some(1));
        let failed = "counting panicked: asked for by a test".to_owned();
        assert_eq!(next(&w), (2, Told::Failed(failed)));
        w.submit(Some(0));
        assert_eq!(next(&w), (3, Told::Done(1)), "what the panic left is gone");
    }

    #[test]
    fn the_newest_of_a_kind_wins_and_kinds_do_not_disturb_each_other() {
        let (mut one, mut other) = (worker(), worker());
        one.submit(None);
        other.submit(None);
        one.submit(Some(0));
        assert_eq!(next(&one), (1, Told::GivenUp));
        assert_eq!(next(&one).0, 2);
        assert!(other.updates().is_empty(), "it still runs");
        other.cancel();
        assert_eq!(next(&other), (1, Told::GivenUp));
    }

    #[test]
    fn a_slow_receiver_loses_only_what_may_be_lost() {
        let mut w = worker();
        w.submit(Some(1000));
        let updates = w.updates().clone();
        while !updates.iter().any(|e| e.update == Told::Done(1)) {}
        w.submit(Some(1000));
        w.jobs = None; // the job ends undisturbed, and the thread after it
        w.thread.take().expect("running").join().expect("guarded");
        let left: Vec<Told> = updates.try_iter().map(|e| e.update).collect();
        assert_eq!(left.len(), MOST_WAITING + 9 + 1);
        assert_eq!(
            left[MOST_WAITING..MOST_WAITING + 2],
            [Told::Number(100), Told::Number(200)]
        );
        assert_eq!(left.last(), Some(&Told::Done(2)));
    }
}
