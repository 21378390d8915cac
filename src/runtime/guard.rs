//! Panic guards for background threads: a panic ends one piece of work, is reported as one line, and the program goes
//! on.

use std::any::Any;
use std::cell::Cell;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::thread::JoinHandle;

use thiserror::Error;

/// Thread and message of a panic. Displays as one line.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error("{thread} panicked: {message}")]
pub struct Panicked {
    /// Name of the thread.
    pub thread: String,
    /// Message of the panic, on one line.
    pub message: String,
}

impl Panicked {
    /// Takes the message from the payload of a panic.
    pub fn new(thread: &str, payload: &(dyn Any + Send)) -> Self {
        let text = payload
            .downcast_ref::<&str>()
            .copied()
            .or_else(|| payload.downcast_ref::<String>().map(String::as_str));
        Self {
            thread: thread.to_owned(),
            message: scene::message::one_line(text.unwrap_or("no message")),
        }
    }
}

/// Runs work on this thread; a panic becomes an error. The caller must discard what the work left half-done.
pub fn guarded<T>(thread: &str, work: impl FnOnce() -> T) -> Result<T, Panicked> {
    catch_unwind(AssertUnwindSafe(work)).map_err(|payload| Panicked::new(thread, &*payload))
}

thread_local! {
    static PANIC_NEXT: Cell<Option<&'static str>> = const { Cell::new(None) };
}

/// For tests: makes the next piece of work panic that the calling thread hands to the thread of this name. Work of
/// other threads, and so of other tests of the same program, is not affected.
pub fn panic_next(thread: &'static str) {
    PANIC_NEXT.with(|next| next.set(Some(thread)));
}

/// A piece of work for another thread. It is made where the work is requested, and run on that thread.
pub struct Handed<R> {
    request: R,
    thread: &'static str,
    panics: bool,
}

impl<R> Handed<R> {
    /// A request for the thread of this name.
    pub fn new(thread: &'static str, request: R) -> Self {
        let panics = PANIC_NEXT.with(|next| {
            let hit = next.get() == Some(thread);
            if hit {
                next.set(None);
            }
            hit
        });
        Self {
            request,
            thread,
            panics,
        }
    }

    /// The request.
    pub fn request(&self) -> &R {
        &self.request
    }

    /// Does the work; a panic becomes an error.
    pub fn run<T>(self, work: impl FnOnce(R) -> T) -> Result<T, Panicked> {
        guarded(self.thread, || {
            if self.panics {
                panic!("asked for by a test");
            }
            work(self.request)
        })
    }
}

/// Starts a thread that does one thing and ends. `tell` gets the result, also after a panic. Errors if the system gives
/// no thread.
pub fn spawn<T: 'static>(
    name: &'static str,
    work: impl FnOnce() -> T + Send + 'static,
    tell: impl FnOnce(Result<T, Panicked>) + Send + 'static,
) -> std::io::Result<JoinHandle<()>> {
    let handed = Handed::new(name, work);
    std::thread::Builder::new().name(name.to_owned()).spawn(move || {
        let answer = handed.run(|work| work());
        // A panic inside `tell` cannot be reported any more.
        let _ = guarded(name, || tell(answer));
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::mpsc::channel;

    #[test]
    fn a_panic_is_told_as_one_line() {
        let error = guarded::<()>("checks", || panic!("index 7\n\nis out of range")).expect_err("a panic");
        assert_eq!(error.to_string(), "checks panicked: index 7; is out of range");
        let error = guarded::<()>("x", || std::panic::resume_unwind(Box::new(7))).expect_err("a panic");
        assert_eq!(error.message, "no message");
        assert_eq!(guarded("x", || 3), Ok(3));
    }

    #[test]
    fn a_thread_tells_its_result_or_its_panic() {
        let (send, answers) = channel();
        for k in 0..3 {
            let send = send.clone();
            let work = move || if k == 1 { panic!("one") } else { k };
            let thread = spawn("counting", work, move |answer| {
                send.send(answer).expect("the test listens");
                panic!("while telling");
            });
            thread.expect("a thread").join().expect("guarded");
            let expected = match k {
                1 => Err("counting panicked: one".to_owned()),
                k => Ok(k),
            };
            let found = answers.recv().expect("an answer").map_err(|e| e.to_string());
            assert_eq!(found, expected);
        }
    }

    #[test]
    fn a_panic_on_order_hits_one_piece_of_work_of_one_thread() {
        panic_next("b");
        let runs = ["a", "b", "b"].map(|thread| Handed::new(thread, ()).run(|()| ()).is_ok());
        assert_eq!(runs, [true, false, true]);
        panic_next("a");
        let elsewhere = std::thread::spawn(|| Handed::new("a", ()).run(|()| ()).is_ok());
        assert!(elsewhere.join().expect("guarded"), "another thread's work");
        assert!(Handed::new("a", ()).run(|()| ()).is_err());
    }
}
