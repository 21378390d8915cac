//! Against the numbers of the twin, and what happens at the edges.

use super::*;
use crate::twin::{Twin, returns, uniform};

const TWIN: Twin = Twin("sensor_occupancy");

/// Classes from 0 to 22 as the twin makes them.
fn painted() -> Vec<u8> {
    let numbers = uniform(Window::VOXELS, 5);
    let class = |u: &f32| ((u + 1.75) / 3.5 * (SHOWN + 1) as f32).floor() as u8;
    numbers.iter().map(|u| class(u).min(UNSEEN)).collect()
}

fn shipped() -> Arc<SensorOccupancy> {
    SensorOccupancy::bundled().expect("the shipped weights")
}

fn square(side: usize, width: usize) -> FeatureMap {
    FeatureMap {
        data: uniform(side * side * width, 2),
        rows: side,
        columns: side,
        width,
    }
}

#[test]
fn networks_say_what_the_twin_says() {
    let tiny = SensorOccupancy::load(&TWIN.path("tiny.safetensors")).expect("the tiny network");
    for (name, net) in [("shipped", &*shipped()), ("tiny", &tiny)] {
        let said = net.forward(square(16, net.inputs())).expect("finite");
        TWIN.compare(&format!("{name}_logits"), &said.data);
        let columns = net.columns(&pillars(returns()), &painted());
        let rows = (94..106).flat_map(|x| (94..106).map(move |y| (x * Window::NY + y) * columns.width));
        let found: Vec<f32> = rows
            .flat_map(|at| columns.data[at..at + columns.width].iter().copied())
            .collect();
        TWIN.compare(&format!("{name}_columns"), &found);
    }
}

#[test]
fn bad_input_is_refused_in_one_line() {
    let net = shipped();
    let refusal = |map: FeatureMap| net.forward(map).expect_err("refused").to_string();
    let width = net.inputs();
    let mut short = square(16, width);
    short.data.pop();
    assert!(refusal(short).starts_with("columns has "));
    assert_eq!(
        refusal(square(12, width)),
        "rows is 12, expected a multiple of 8 up to 4096"
    );
    let mut nan = square(8, width);
    nan.data[7] = f32::NAN;
    assert!(refusal(nan).starts_with("columns: value 7 is NaN"));
    let told = net.voxels([], &[0; 3]).expect_err("refused").to_string();
    assert_eq!(told, "painted has 3 values, expected 640000");
    let other = WeightFile::parse("text", assets::weights::TEXT).expect("a file");
    let told = SensorOccupancy::on(Cpu, other)
        .map(|_| ())
        .expect_err("another network");
    let told = told.to_string();
    assert!(
        told.contains("expected sensor_occupancy") && !told.contains('\n'),
        "{told}"
    );
}

/// Without returns and pictures there is a guess; NaN returns change nothing of it, classes that do not exist count as unseen.
#[test]
fn silence_is_answered_and_threads_change_nothing() {
    let unseen = vec![UNSEEN; Window::VOXELS];
    let run = |threads, returns: Vec<[f32; 4]>, painted: &[u8]| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
        pool.expect("a pool")
            .install(|| shipped().voxels(returns, painted).expect("finite"))
    };
    let silent = run(1, vec![], &unseen);
    assert_eq!(silent, run(2, vec![[f32::NAN; 4]], &vec![255; Window::VOXELS]));
    let heard = run(1, returns(), &painted());
    assert_eq!(heard, run(2, returns(), &painted()));
    assert_ne!(silent, heard);
}
