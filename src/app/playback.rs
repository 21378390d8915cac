//! Playback of a clip: the moment to show at each time, and the moments for which edits count. It has no clock; the
//! caller passes the time.

use scene::{Motion, Moving, Scope};

/// A copied motion and its start.
#[derive(Clone, Debug, PartialEq)]
pub struct Copied {
    /// The motion.
    pub motion: Motion,
    /// State of the copied object at the beginning of the motion.
    pub start: Moving,
}

/// Settings and state of the playback.
#[derive(Clone, Debug, PartialEq)]
pub struct Playback {
    /// True while it plays.
    pub playing: bool,
    /// Speed relative to real time.
    pub speed: f64,
    /// True if it starts over at its end.
    pub looping: bool,
    /// The part that is played, s; all of it if `None`.
    pub span_s: Option<[f64; 2]>,
    /// Moments for which an edit of a moving object counts.
    pub scope: Scope,
    /// True if the paths of moving objects are shown in both views.
    pub paths: bool,
    /// True if the chosen object is also shown a second earlier and a second later.
    pub onion: bool,
    /// True if the 3D view moves along with the chosen object, or with the ego vehicle.
    pub follow: bool,
    /// The copied motion.
    pub copied: Option<Copied>,
    /// True if the scene was already a clip when it was last checked.
    pub known: bool,
    last_s: Option<f64>,
    sensed_s: Option<f64>,
}

impl Default for Playback {
    fn default() -> Self {
        Self {
            playing: false,
            speed: 1.0,
            looping: true,
            span_s: None,
            scope: Scope::WholeTrack,
            paths: true,
            onion: true,
            follow: false,
            copied: None,
            known: false,
            last_s: None,
            sensed_s: None,
        }
    }
}

/// Longest time by which one tick advances the clip, s. Longer pauses, for example of a hidden window, are cut to it.
const LONGEST_TICK_S: f64 = 0.5;
/// Least time between two moments that the sensors are told while it plays, s.
const SENSORS_EVERY_S: f64 = 0.03;
/// Least and most time between two moments of a clip that sensors show while it plays, ms.
const SENSED_EVERY_MS: [u32; 2] = [25, 400];

impl Playback {
    /// Speeds to choose from.
    pub const SPEEDS: [f64; 5] = [0.25, 0.5, 1.0, 2.0, 4.0];

    /// First and last moment that are played, in a clip of this length, s.
    pub fn span(&self, length_s: f64) -> [f64; 2] {
        match self.span_s {
            Some([from, to]) if from < to && from < length_s => [from.max(0.0), to.min(length_s)],
            _ => [0.0, length_s],
        }
    }

    /// True if the sensors should be told the moment now: always while paused, and every now and then while it plays. They take
    /// the newest one when they are done with the one before.
    pub fn sensors_are_due(&mut self, now_s: f64) -> bool {
        let waited_s = self.sensed_s.map_or(f64::INFINITY, |last_s| now_s - last_s);
        let due = !self.playing || waited_s.is_nan() || waited_s >= SENSORS_EVERY_S;
        if due {
            self.sensed_s = self.playing.then_some(now_s);
        }
        due
    }

    /// Time between two moments of the clip that sensors show while it plays, ms: a tenth of a second on the clock, within limits.
    pub fn sensed_every_ms(&self) -> u32 {
        let [least_ms, most_ms] = SENSED_EVERY_MS;
        ((100.0 * self.speed).round() as u32).clamp(least_ms, most_ms)
    }

    /// The moment to show now, s; `None` if it is still `shown_s`.
    pub fn tick(&mut self, shown_s: f64, length_s: f64, now_s: f64) -> Option<f64> {
        let last_s = self.last_s.replace(now_s);
        if !self.playing {
            self.last_s = None;
            return None;
        }
        let [from, to] = self.span(length_s);
        let passed_s = now_s - last_s.unwrap_or(now_s);
        let passed_s = match passed_s.is_nan() {
            true => 0.0,
            false => passed_s.clamp(0.0, LONGEST_TICK_S),
        };
        let mut next_s = shown_s.max(from) + passed_s * self.speed;
        if next_s >= to {
            match self.looping && to > from {
                true => next_s = from + (next_s - to).rem_euclid(to - from),
                false => {
                    next_s = to;
                    self.playing = false;
                }
            }
        }
        (next_s != shown_s).then_some(next_s)
    }

    /// Starts or pauses. Returns the moment to start from if `shown_s` is at the end or outside the played part.
    pub fn toggle(&mut self, shown_s: f64, length_s: f64) -> Option<f64> {
        self.playing = !self.playing && length_s > 0.0;
        self.last_s = None;
        let [from, to] = self.span(length_s);
        (self.playing && (shown_s >= to || shown_s < from)).then_some(from)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sensors_look_always_at_rest_and_now_and_then_while_it_plays() {
        let looks = |every_s: f64, playing: bool| {
            let mut playback = Playback {
                playing,
                ..Playback::default()
            };
            let times = (0..100).map(|i| f64::from(i) * every_s);
            times.filter(|t| playback.sensors_are_due(*t)).count()
        };
        assert_eq!([looks(0.01, false), looks(0.1, false)], [100, 100]);
        assert!((25..=34).contains(&looks(0.01, true)) && looks(0.1, true) == 100);
        let mut playback = Playback {
            playing: true,
            ..Playback::default()
        };
        assert!(playback.sensors_are_due(f64::NAN));
    }

    #[test]
    fn it_plays_in_real_time_and_starts_over() {
        let mut p = Playback::default();
        assert_eq!(p.tick(0.0, 8.0, 10.0), None);
        assert_eq!(p.toggle(0.0, 8.0), None);
        assert_eq!(p.tick(0.0, 8.0, 10.0), None, "the first tick is the start");
        assert_eq!(p.tick(0.0, 8.0, 10.1), Some(10.1 - 10.0));
        p.speed = 2.0;
        assert!((p.tick(1.0, 8.0, 10.3).expect("plays") - 1.4).abs() < 1e-9);
        assert!((p.tick(7.9, 8.0, 10.4).expect("plays") - 0.1).abs() < 1e-9);
        // After a minute in a hidden window, the clip does not jump.
        assert!((p.tick(1.0, 8.0, 70.0).expect("plays") - 2.0).abs() < 1e-9);
        assert_eq!(p.tick(1.0, 8.0, 60.0), None, "a clock that goes back");
        assert!(p.tick(1.0, 8.0, f64::NAN).is_none_or(f64::is_finite));
    }

    #[test]
    fn without_a_loop_it_ends_at_its_out_point() {
        let mut p = Playback {
            looping: false,
            span_s: Some([1.0, 3.0]),
            ..Playback::default()
        };
        assert_eq!(p.toggle(5.0, 8.0), Some(1.0));
        p.tick(1.0, 8.0, 0.0);
        assert_eq!(p.tick(2.9, 8.0, 0.3), Some(3.0));
        assert!(!p.playing);
        assert_eq!(p.toggle(3.0, 8.0), Some(1.0), "from the end it starts over");
        p.span_s = Some([9.0, 10.0]);
        assert_eq!(p.span(8.0), [0.0, 8.0], "a span beyond the clip is none");
    }

    #[test]
    fn a_scene_of_one_moment_does_not_play() {
        let mut p = Playback::default();
        assert_eq!(p.toggle(0.0, 0.0), None);
        assert!(!p.playing);
    }
}
