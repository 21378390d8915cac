//! Timing for the benchmarks: wall time, and the processor time all threads spent (Linux), which
//! tells more on a busy machine.

use std::time::Instant;

use numeric::quantile::{median, quantile};

/// Nanoseconds that the threads of this process have run so far, if the system tells.
fn cpu_ns() -> Option<u64> {
    let mut total = 0;
    for task in std::fs::read_dir("/proc/self/task").ok()?.flatten() {
        let text = std::fs::read_to_string(task.path().join("schedstat")).ok()?;
        total += text.split_whitespace().next()?.parse::<u64>().ok()?;
    }
    Some(total)
}

/// Runs `run` a few times to warm up, then `repeats` times, and prints what it took.
pub fn time(what: &str, repeats: usize, mut run: impl FnMut() -> usize) {
    let mut result = 0;
    for _ in 0..3 {
        result = run();
    }
    let before = cpu_ns();
    let times_ms: Vec<f64> = (0..repeats)
        .map(|_| {
            let start = Instant::now();
            assert_eq!(run(), result, "{what}: the same each time");
            start.elapsed().as_secs_f64() * 1e3
        })
        .collect();
    let cpu = before
        .zip(cpu_ns())
        .map(|(a, b)| (b - a) as f64 / 1e6 / repeats as f64);
    let cpu = cpu.map_or(String::new(), |ms| format!(", processor {ms:.2} ms"));
    println!(
        "{what}: median {:.2} ms, least {:.2} ms{cpu} ({result})",
        median(&times_ms),
        quantile(&times_ms, 0.0)
    );
}
