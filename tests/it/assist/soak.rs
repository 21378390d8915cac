//! A session does not grow with its calls: the short form of tests/soak.py.

use serde_json::json;

use super::process::Talk;

/// Rounds before it is measured, and while it is.
const WARM: usize = 60;
const MEASURED: usize = 240;
/// What a thousand calls may leave behind, MiB: less than the allocator gives and takes.
const MOST_MIB: u64 = 24;

/// A change that is taken back leaves nothing: one step is in the history however often it is made.
#[test]
fn changes_that_are_taken_back_leave_no_memory_behind() {
    let dir = tempfile::tempdir().expect("a folder");
    let mut talk = Talk::start("session", dir.path());
    talk.did("new", json!({ "template": "t-junction", "seed": 3 }));
    let mut round = |i: usize| {
        let box_ = json!({ "add_box": {
            "class": "pedestrian", "center_m": [8 + i % 20, 3, 0.9], "size_m": [0.7, 0.7, 1.8], "yaw_deg": i % 360,
        } });
        let strip = json!({ "paint_bev": {
            "layer": "walkway", "value": i.is_multiple_of(2),
            "shape": { "rect": { "min_m": [i % 40, -12], "max_m": [i % 40 + 2, -10] } },
        } });
        talk.did("apply", json!({ "edits": [box_, strip] }));
        talk.did("state", json!({ "roads": false }));
        talk.did("undo", json!({}));
        if i.is_multiple_of(20) {
            talk.did("render", json!({ "what": ["bev"], "replace": true }));
        }
        talk.memory_mib()
    };
    let warm = (0..WARM).map(&mut round).max().expect("rounds");
    let most = (WARM..WARM + MEASURED).map(&mut round).max().expect("rounds");
    println!("{warm} MiB after {WARM} rounds, {most} MiB at most in the next {MEASURED}");
    assert!(most <= warm + MOST_MIB, "{warm} MiB, then {most} MiB");
    assert!(talk.end().1);
}
