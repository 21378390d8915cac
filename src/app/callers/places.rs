//! Places of callers that the server waits for: so many, each for so long; the oldest makes room for a new one.

use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

use tokio::sync::watch;

/// Signal to a caller that the server waits for it no longer. Once sent, it stays sent.
#[derive(Debug)]
pub struct Ending(watch::Sender<bool>);

impl Default for Ending {
    fn default() -> Self {
        Self(watch::Sender::new(false))
    }
}

impl Ending {
    /// Sends the signal.
    pub fn tell(&self) {
        self.0.send_replace(true);
    }

    /// True once the signal was sent.
    pub fn is_told(&self) -> bool {
        *self.0.borrow()
    }

    /// Ready once the signal was sent, or the sender is gone.
    pub fn told(&self) -> impl Future<Output = ()> + Send + use<> {
        let mut told = self.0.subscribe();
        async move { drop(told.wait_for(|told| *told).await) }
    }
}

/// A bounded number of places. Clones share them.
#[derive(Clone, Debug)]
pub struct Places(Arc<SharedPlaces>);

#[derive(Debug)]
struct SharedPlaces {
    most: usize,
    within: Duration,
    waiting: Mutex<WaitingCallers>,
}

/// Waiting callers with the time of their arrival; numbers grow, so the first number came first.
#[derive(Debug, Default)]
struct WaitingCallers {
    next: u64,
    all: BTreeMap<u64, (Instant, Arc<Ending>)>,
}

impl WaitingCallers {
    /// Ends the oldest, if there is one.
    fn end_oldest(&mut self) -> bool {
        let oldest = self.all.pop_first();
        oldest.map(|(_, (_, ending))| ending.tell()).is_some()
    }
}

impl Places {
    /// Makes `most` places, at least one, each held for `within` at most.
    pub fn new(most: usize, within: Duration) -> Self {
        Self(Arc::new(SharedPlaces {
            most: most.max(1),
            within,
            waiting: Mutex::default(),
        }))
    }

    /// A place from now on. Where all are taken, the oldest of them is told that it ends.
    pub fn take(&self, ending: Arc<Ending>, now: Instant) -> CallerPlace {
        self.with(|waiting| {
            while waiting.all.len() >= self.0.most {
                waiting.end_oldest();
            }
            let number = waiting.next;
            waiting.next += 1;
            waiting.all.insert(number, (now, ending));
            CallerPlace {
                of: self.clone(),
                number,
            }
        })
    }

    /// Ends all whose time is over.
    pub fn sweep(&self, now: Instant) {
        self.with(|waiting| {
            let over = |at: &Instant| now.saturating_duration_since(*at) >= self.0.within;
            while waiting.all.first_key_value().is_some_and(|(_, (at, _))| over(at)) {
                waiting.end_oldest();
            }
        });
    }

    /// Ends the oldest, if there is one; true if there was.
    pub fn end_oldest(&self) -> bool {
        self.with(WaitingCallers::end_oldest)
    }

    /// How many are taken.
    pub fn taken(&self) -> usize {
        self.with(|waiting| waiting.all.len())
    }

    fn with<T>(&self, work: impl FnOnce(&mut WaitingCallers) -> T) -> T {
        work(&mut self.0.waiting.lock().unwrap_or_else(PoisonError::into_inner))
    }
}

/// A place, until it is dropped.
#[derive(Debug)]
pub struct CallerPlace {
    of: Places,
    number: u64,
}

impl Drop for CallerPlace {
    fn drop(&mut self) {
        self.of.with(|waiting| drop(waiting.all.remove(&self.number)));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn come(places: &Places, now: Instant) -> (Arc<Ending>, CallerPlace) {
        let ending = Arc::new(Ending::default());
        (ending.clone(), places.take(ending, now))
    }

    #[test]
    fn the_oldest_gives_way_to_whoever_comes() {
        let places = Places::new(3, Duration::from_secs(10));
        let now = Instant::now();
        let all: Vec<_> = (0..1000).map(|_| come(&places, now)).collect();
        let told: Vec<bool> = all.iter().map(|(ending, _)| ending.is_told()).collect();
        assert_eq!(places.taken(), 3);
        assert!(told[..997].iter().all(|told| *told) && told[997..].iter().all(|told| !told));
    }

    #[test]
    fn who_has_left_makes_room() {
        let places = Places::new(2, Duration::from_secs(10));
        let now = Instant::now();
        let (first, first_place) = come(&places, now);
        let (second, _second_place) = come(&places, now);
        drop(first_place);
        let _third = come(&places, now);
        assert!(!first.is_told() && !second.is_told());
        assert_eq!(places.taken(), 2);
    }

    #[test]
    fn whose_time_is_over_is_told_and_nobody_else() {
        let places = Places::new(9, Duration::from_secs(10));
        let start = Instant::now();
        let (early, _early_place) = come(&places, start);
        let (late, _late_place) = come(&places, start + Duration::from_secs(5));
        places.sweep(start + Duration::from_secs(9));
        assert!(!early.is_told());
        places.sweep(start + Duration::from_secs(10));
        assert!(early.is_told() && !late.is_told());
        assert_eq!(places.taken(), 1);
    }

    #[test]
    fn who_is_told_hears_it_also_later() {
        let ending = Ending::default();
        ending.tell();
        let runtime = tokio::runtime::Builder::new_current_thread().build();
        runtime.expect("a runtime").block_on(ending.told());
    }
}
