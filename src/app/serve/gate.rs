//! Gate that bounds the number of requests inside, and of those that are worked on.

use std::sync::Arc;

use tokio::sync::{OwnedSemaphorePermit, Semaphore};
use tonic::Status;

use crate::scenes::one_line;

/// Lets so many requests in, and works on fewer of them at a time.
#[derive(Clone)]
pub struct Gate {
    places: Arc<Semaphore>,
    jobs: Arc<Semaphore>,
    most: [usize; 2],
}

impl Gate {
    /// Makes a gate for so many jobs at a time, while so many more requests wait.
    pub fn new(jobs: usize, waiting: usize) -> Self {
        Self {
            places: Arc::new(Semaphore::new(jobs + waiting)),
            jobs: Arc::new(Semaphore::new(jobs)),
            most: [jobs, waiting],
        }
    }

    /// A place inside, to be held until the answer is sent. Errors if all are taken.
    pub fn enter(&self) -> Result<OwnedSemaphorePermit, Status> {
        self.places.clone().try_acquire_owned().map_err(|_| {
            let [jobs, waiting] = self.most;
            Status::resource_exhausted(format!(
                "{jobs} requests are rendered and {waiting} wait, expected fewer at a time: ask again later"
            ))
        })
    }

    /// Runs the work on a thread that may block, once it is its turn. A panic becomes an error, and the next request is
    /// served.
    pub async fn run<T: Send + 'static>(
        &self,
        work: impl FnOnce() -> Result<T, Status> + Send + 'static,
    ) -> Result<T, Status> {
        let job = self.jobs.clone().acquire_owned().await;
        let job = job.map_err(|_| Status::unavailable("the server is ending"))?;
        // The job is over when the work is, even if the caller has gone.
        let worked = tokio::task::spawn_blocking(move || {
            let out = work();
            drop(job);
            out
        });
        worked.await.unwrap_or_else(|error| {
            let said = match error.try_into_panic() {
                Ok(panic) => said(&*panic),
                Err(_) => "the server is ending".into(),
            };
            Err(Status::internal(format!("the renderer panicked: {said}")))
        })
    }
}

/// The message of a panic, in one line.
fn said(panic: &(dyn std::any::Any + Send)) -> String {
    let text = panic.downcast_ref::<&str>().copied();
    let text = text.or_else(|| panic.downcast_ref::<String>().map(String::as_str));
    one_line(text.unwrap_or("no message"))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn block_on<T>(future: impl Future<Output = T>) -> T {
        let runtime = tokio::runtime::Builder::new_current_thread().build();
        runtime.expect("a runtime").block_on(future)
    }

    #[test]
    fn a_panic_is_an_error_and_the_next_is_served() {
        let gate = Gate::new(1, 0);
        for i in 0..3 {
            let panicked = gate.run(move || -> Result<u32, Status> { panic!("broken\n{i}") });
            let error = block_on(panicked).expect_err("a panic");
            assert_eq!(error.code(), tonic::Code::Internal);
            assert_eq!(error.message(), format!("the renderer panicked: broken {i}"));
        }
        assert_eq!(block_on(gate.run(|| Ok(7))).expect("served"), 7);
    }

    #[test]
    fn only_so_many_come_in() {
        let gate = Gate::new(1, 2);
        let inside: Vec<_> = (0..3).map(|_| gate.enter().expect("a place")).collect();
        let refused = gate.enter().map(|_| ()).expect_err("full");
        assert_eq!(refused.code(), tonic::Code::ResourceExhausted);
        drop(inside);
        assert!(gate.enter().is_ok());
    }

    #[test]
    fn only_so_many_work_at_a_time() {
        use std::sync::atomic::{AtomicUsize, Ordering};
        let (gate, now, most) = (
            Gate::new(2, 10),
            Arc::new(AtomicUsize::new(0)),
            Arc::new(AtomicUsize::new(0)),
        );
        block_on(async {
            let mut all = Vec::new();
            for _ in 0..10 {
                let (gate, now, most) = (gate.clone(), now.clone(), most.clone());
                all.push(tokio::spawn(async move {
                    gate.run(move || {
                        most.fetch_max(now.fetch_add(1, Ordering::SeqCst) + 1, Ordering::SeqCst);
                        std::thread::sleep(std::time::Duration::from_millis(5));
                        now.fetch_sub(1, Ordering::SeqCst);
                        Ok(())
                    })
                    .await
                }));
            }
            for one in all {
                one.await.expect("no panic").expect("served");
            }
        });
        assert_eq!(most.load(Ordering::SeqCst), 2);
    }
}
