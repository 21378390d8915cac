//! Bounds on the memory and the work of a server.

use std::time::Duration;

use callers::{CallerLimits, Wait};

/// Pixels of a picture at most: 4096 x 4096.
pub const MOST_PIXELS: u64 = 1 << 24;
/// Pixels of all pictures of one request at most.
pub const MOST_PIXELS_TOGETHER: u64 = 1 << 26;
/// Pictures and sweeps of one request at most.
pub const MOST_ITEMS: usize = 64;
/// Moved objects of one request at most: as many as a clip has tracks.
pub const MOST_OBJECTS: usize = 2000;
/// Bytes of a request at most. Requests beyond it are refused before they are read.
pub const MOST_REQUEST_BYTES: usize = 4 << 20;
/// Bytes of an answer at most; AlpaSim's runtime takes as many.
pub const MOST_ANSWER_BYTES: usize = 64 << 20;
/// Requests of one connection at the same time.
pub const MOST_STREAMS: u32 = 64;
/// Connections, bodies and answers: how many of each wait, and for how long. Clients that hold a channel open between two
/// simulations are idle; others make a new one by themselves.
pub const CALLERS: CallerLimits = CallerLimits {
    strangers: Wait {
        most: 256,
        within: Duration::from_secs(10),
    },
    idle: Wait {
        most: 256,
        within: Duration::from_secs(3600),
    },
    reading: Wait {
        most: 64,
        within: Duration::from_secs(30),
    },
    sending: Wait {
        most: 64,
        within: Duration::from_secs(120),
    },
};
/// Scenes that a server lists at most.
pub const MOST_SCENES: usize = 100_000;
/// Longest frame of a camera and longest spin of a LiDAR, us.
pub const LONGEST_FRAME_US: u64 = 1_000_000;
/// Farthest from the origin that anything may be, m: as far as boxes may be.
pub const FARTHEST_M: f64 = 10_000.0;
