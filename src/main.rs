//! Parses arguments, runs, reports the error once, exits.
use std::path::PathBuf;
fn main() {
    let a: Vec<String> = std::env::args().collect();
    let t = std::time::Instant::now();
    let r = sceneloom::generation::dataset::write_occupancy(
        &PathBuf::from(&a[3]),
        a[1].parse().unwrap(),
        a[2].parse().unwrap(),
        |n| {
            eprintln!("{n} {:.1}s", t.elapsed().as_secs_f64());
            true
        },
    );
    println!("{r:?}");
}
