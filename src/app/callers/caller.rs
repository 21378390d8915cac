//! The states of a connection, and the places of each state.

use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

use crate::places::{CallerPlace, Ending, Places};

/// Interval between two checks of the deadlines.
const SWEEP_EVERY: Duration = Duration::from_millis(250);

/// Bound of a state: so many connections or requests at a time, each for so long.
#[derive(Clone, Copy, Debug)]
pub struct Wait {
    /// Most at a time.
    pub most: usize,
    /// Longest time of one.
    pub within: Duration,
}

impl Wait {
    fn places(self) -> Places {
        Places::new(self.most, self.within)
    }
}

/// How many may be in each state, and for how long.
#[derive(Clone, Copy, Debug)]
pub struct CallerLimits {
    /// Connections of which no request was read yet.
    pub strangers: Wait,
    /// Connections that have asked and do not ask now.
    pub idle: Wait,
    /// Requests whose body comes in.
    pub reading: Wait,
    /// Answers that go out.
    pub sending: Wait,
}

/// All callers of a server. Clones share the same state.
#[derive(Clone, Debug)]
pub struct Callers {
    strangers: Places,
    idle: Places,
    reading: Places,
    sending: Places,
}

impl Callers {
    /// Starts without callers.
    pub fn new(limits: CallerLimits) -> Self {
        Self {
            strangers: limits.strangers.places(),
            idle: limits.idle.places(),
            reading: limits.reading.places(),
            sending: limits.sending.places(),
        }
    }

    /// A connection that was just made: a stranger.
    pub fn connected(&self) -> Arc<Caller> {
        let ending = Arc::new(Ending::default());
        let place = self.strangers.take(ending.clone(), Instant::now());
        Arc::new(Caller {
            callers: self.clone(),
            ending,
            state: Mutex::new(ConnectionState {
                asking: 0,
                is_known: false,
                place: Some(place),
            }),
        })
    }

    /// A place for the body of a request to come in, and the signal that tells that the server waits for it no longer.
    pub fn reading(&self) -> (Arc<Ending>, CallerPlace) {
        let ending = Arc::new(Ending::default());
        (ending.clone(), self.reading.take(ending, Instant::now()))
    }

    /// Ends all connections and requests that have taken too long, over and over.
    pub fn make_room(&self) {
        let _ended = self.strangers.end_oldest() || self.idle.end_oldest();
    }

    /// Ends whatever has taken too long, over and over.
    pub async fn keep_deadlines(&self) {
        loop {
            tokio::time::sleep(SWEEP_EVERY).await;
            let now = Instant::now();
            for places in [&self.strangers, &self.idle, &self.reading, &self.sending] {
                places.sweep(now);
            }
        }
    }
}

/// One connection.
#[derive(Debug)]
pub struct Caller {
    callers: Callers,
    ending: Arc<Ending>,
    state: Mutex<ConnectionState>,
}

#[derive(Debug)]
struct ConnectionState {
    /// Requests of it that are not answered yet.
    asking: usize,
    /// A request of it was read whole.
    is_known: bool,
    /// None while it asks: its requests have their own.
    place: Option<CallerPlace>,
}

impl Caller {
    /// The signal that tells it to end.
    pub fn ending(&self) -> &Ending {
        &self.ending
    }

    /// The callers of its server.
    pub fn callers(&self) -> &Callers {
        &self.callers
    }

    /// Begins a request.
    pub fn asks(self: &Arc<Self>) -> Asking {
        self.with(|state| {
            state.asking += 1;
            state.place = None;
        });
        Asking(self.clone())
    }

    fn with<T>(&self, work: impl FnOnce(&mut ConnectionState) -> T) -> T {
        work(&mut self.state.lock().unwrap_or_else(PoisonError::into_inner))
    }
}

/// A request that is not answered yet, until it is dropped.
#[derive(Debug)]
pub struct Asking(Arc<Caller>);

impl Asking {
    /// Notes that the request was read whole and its sender may ask: the connection is no stranger any more.
    pub fn is_read(&self) {
        self.0.with(|state| state.is_known = true);
    }

    /// A place for its answer to go out. Where that takes too long, the connection ends.
    pub fn sending(&self) -> CallerPlace {
        let sending = &self.0.callers.sending;
        sending.take(self.0.ending.clone(), Instant::now())
    }
}

impl Drop for Asking {
    fn drop(&mut self) {
        let caller = &self.0;
        caller.with(|state| {
            state.asking -= 1;
            if state.asking == 0 {
                let places = match state.is_known {
                    true => &caller.callers.idle,
                    false => &caller.callers.strangers,
                };
                state.place = Some(places.take(caller.ending.clone(), Instant::now()));
            }
        });
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn callers() -> Callers {
        let wait = |most| Wait {
            most,
            within: Duration::from_secs(600),
        };
        Callers::new(CallerLimits {
            strangers: wait(2),
            idle: wait(3),
            reading: wait(2),
            sending: wait(2),
        })
    }

    fn known(callers: &Callers) -> Arc<Caller> {
        let caller = callers.connected();
        caller.asks().is_read();
        caller
    }

    #[test]
    fn strangers_give_way_to_strangers_alone() {
        let callers = callers();
        let (idle, busy) = (known(&callers), callers.connected());
        let asking = busy.asks();
        let strangers: Vec<_> = (0..100).map(|_| callers.connected()).collect();
        let ended = strangers.iter().filter(|s| s.ending().is_told()).count();
        assert_eq!(ended, 98);
        assert!(!idle.ending().is_told() && !busy.ending().is_told());
        drop(asking);
        assert_eq!(callers.strangers.taken(), 2, "its request was never read");
        assert!(!busy.ending().is_told(), "it came last");
    }

    #[test]
    fn who_asks_never_gives_way_and_idles_from_when_it_was_answered() {
        let callers = callers();
        let busy = known(&callers);
        let first = busy.asks();
        let second = busy.asks();
        let idle: Vec<_> = (0..10).map(|_| known(&callers)).collect();
        let ended: Vec<bool> = idle.iter().map(|i| i.ending().is_told()).collect();
        assert!(ended[..7].iter().all(|e| *e) && ended[7..].iter().all(|e| !e));
        drop(first);
        assert!(!idle[7].ending().is_told(), "another request of it waits");
        drop(second);
        assert!(idle[7].ending().is_told() && !busy.ending().is_told());
    }

    #[test]
    fn who_has_gone_holds_no_place() {
        let callers = callers();
        let gone = known(&callers);
        let asking = gone.asks();
        let sending = asking.sending();
        drop(gone);
        drop(sending);
        drop(asking);
        let stranger = callers.connected();
        assert_eq!(callers.strangers.taken(), 1);
        drop(stranger);
        let taken = [
            &callers.strangers,
            &callers.idle,
            &callers.reading,
            &callers.sending,
        ]
        .map(Places::taken);
        assert_eq!(taken, [0; 4]);
    }

    #[test]
    fn a_body_that_does_not_come_gives_way_and_an_answer_that_is_not_taken_ends_its_connection() {
        let callers = callers();
        let reading: Vec<_> = (0..3).map(|_| callers.reading()).collect();
        let told: Vec<bool> = reading.iter().map(|(ending, _)| ending.is_told()).collect();
        assert_eq!(told, [true, false, false]);
        let answered = |_| {
            let caller = callers.connected();
            let asking = caller.asks();
            (asking.sending(), asking, caller)
        };
        let answered: Vec<_> = (0..3).map(answered).collect();
        let told: Vec<bool> = answered.iter().map(|(_, _, c)| c.ending().is_told()).collect();
        assert_eq!(told, [true, false, false]);
    }
}
