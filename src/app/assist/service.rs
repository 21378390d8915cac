//! The thread that works on a desk: calls from any number of clients are carried out one by one, in the order in which they came.

use std::io;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::thread::JoinHandle;

use crossbeam_channel::{Receiver, Sender, TrySendError, bounded};
use serde_json::{Map, Value};

use crate::call::{Call, CallAnswer};
use crate::desk::{Desk, Stop};
use runtime::guard::guarded;

/// Calls that may wait while one is carried out.
pub const MOST_WAITING: usize = 32;
/// Stack of the thread, bytes: as a main thread has it.
const STACK: usize = 8 << 20;
const THREAD: &str = "assistant";

/// Callback that gets the answer.
type Reply = Box<dyn FnOnce(Result<CallAnswer, String>) + Send>;

struct QueuedCall {
    name: String,
    args: Map<String, Value>,
    stop: Stop,
    reply: Reply,
    _counted: Counted,
}

/// Error of a full queue: as many calls wait as may wait, or the thread is gone.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Busy;

impl Busy {
    /// In words.
    pub fn message(self) -> String {
        format!("busy: {MOST_WAITING} calls wait already, expected fewer; call again when they are answered")
    }
}

/// Handle by which calls are asked for. Clones ask the same thread; it ends with the last of them.
#[derive(Clone)]
pub struct Service {
    queue: Sender<QueuedCall>,
    unanswered: Arc<AtomicUsize>,
}

/// Counts one call until it is answered or given up.
struct Counted(Arc<AtomicUsize>);

impl Drop for Counted {
    fn drop(&mut self) {
        self.0.fetch_sub(1, Ordering::Release);
    }
}

impl Service {
    /// Starts the thread; `make` makes its desk there. Errors if the system gives no thread.
    pub fn start(make: impl FnOnce() -> Desk + Send + 'static) -> io::Result<(Self, JoinHandle<()>)> {
        let (queue, requests) = bounded(MOST_WAITING);
        let thread = std::thread::Builder::new()
            .name(THREAD.into())
            .stack_size(STACK)
            .spawn(move || work(make(), &requests))?;
        let service = Self {
            queue,
            unanswered: Arc::default(),
        };
        Ok((service, thread))
    }

    /// Asks for a call; `reply` gets its answer on the other thread. Once `stop` is true the call is given up: at once if it
    /// has not begun, and before its next step if it is a generation. Refused if as many wait as may wait.
    pub fn ask(
        &self,
        name: String,
        args: Map<String, Value>,
        stop: Stop,
        reply: impl FnOnce(Result<CallAnswer, String>) + Send + 'static,
    ) -> Result<(), Busy> {
        self.unanswered.fetch_add(1, Ordering::AcqRel);
        let request = QueuedCall {
            name,
            args,
            stop,
            reply: Box::new(reply),
            _counted: Counted(self.unanswered.clone()),
        };
        self.queue.try_send(request).map_err(|refused| match refused {
            TrySendError::Full(_) | TrySendError::Disconnected(_) => Busy,
        })
    }

    /// True while no call waits or is carried out.
    pub fn is_idle(&self) -> bool {
        self.unanswered.load(Ordering::Acquire) == 0
    }
}

fn work(mut desk: Desk, requests: &Receiver<QueuedCall>) {
    for request in requests {
        let QueuedCall {
            name,
            args,
            stop,
            reply,
            _counted,
        } = request;
        if stop() {
            reply(Err("the call was cancelled before it began".into()));
            continue;
        }
        desk.stop = stop;
        let answer = guarded(THREAD, || Call::answer(&name, args, &mut desk));
        reply(answer.unwrap_or_else(|panicked| Err(panicked.to_string())));
    }
}
