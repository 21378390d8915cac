//! The processor's sparse convolutions on the sites of the LiDAR network.

use super::sites::{CHILDREN, Sites, TAPS};
use crate::golden::{Golden, gap};
use nn::map::FeatureMap;
use nn::rules::RuleBook;
use nn::{Cpu, Ops};

type Convolution = <Cpu as Ops>::SparseConvolution;

const SHAPE: [usize; 3] = [6, 6, 4];

/// `[out][in][taps]` to a convolution over (tap, in, out); `swap` for `[in][out][taps]`.
fn convolution(golden: &Golden, name: &str, [inputs, outputs, taps]: [usize; 3], swap: bool) -> Convolution {
    let weight = golden.f32(&format!("{name}.weight"));
    let mut ordered = vec![0.0; weight.len()];
    for (i, v) in weight.iter().enumerate() {
        let (a, b, tap) = (
            i / (taps * if swap { outputs } else { inputs }),
            i / taps,
            i % taps,
        );
        let (input, output) = if swap { (a, b % outputs) } else { (b % inputs, a) };
        ordered[(tap * inputs + input) * outputs + output] = *v;
    }
    let bias = golden.f32(&format!("{name}.bias"));
    Cpu.sparse_from(&ordered, bias, taps).expect("sound")
}

fn apply(conv: &Convolution, x: &[f32], inputs: usize, rules: &RuleBook) -> Vec<f32> {
    let x = FeatureMap {
        data: x.to_vec(),
        rows: x.len() / inputs,
        columns: 1,
        width: inputs,
    };
    Cpu.sparse(conv, &x, rules).expect("sound").data
}

/// Sites where `active` is set, and rows of the dense `[channel][x][y][z]` field there.
fn rows(field: &[f64], channels: usize, keys: &[u32]) -> Vec<f32> {
    let places = field.len() / channels;
    let row = |k: &u32| {
        (0..channels)
            .map(|c| field[c * places + *k as usize] as f32)
            .collect::<Vec<_>>()
    };
    keys.iter().flat_map(row).collect()
}

fn keys(active: &[f64]) -> Vec<u32> {
    (0..active.len() as u32)
        .filter(|k| active[*k as usize] > 0.0)
        .collect()
}

fn f64s(values: Vec<f32>) -> Vec<f64> {
    values.into_iter().map(f64::from).collect()
}

/// Row 53 of the extremes table: no, one, some and all voxels against torch 2.15.0 in float64 (reference/nn.json,
/// 1e-5 of the largest value); strided and transposed convolution; borders; duplicates.
#[test]
fn row_53_sparse_convolutions() {
    let golden = Golden::nn();
    let conv = convolution(&golden, "sparse", [3, 5, TAPS], false);
    for name in ["none", "one", "some", "all"] {
        let mut active = keys(&f64s(golden.f32(&format!("sparse.{name}.active"))));
        let x = rows(&f64s(golden.f32(&format!("sparse.{name}.x"))), 3, &active);
        let truth = golden.f64(&format!("sparse.{name}.submanifold"));
        active.extend(active.clone()); // duplicates count once
        let sites = Sites::new(SHAPE, active);
        let found = apply(&conv, &x, 3, &sites.levels[0].around);
        assert_eq!(found.len(), sites.levels[0].keys.len() * 5);
        if found.is_empty() {
            assert!(truth.iter().all(|v| *v == 0.0));
            continue;
        }
        let expected = f64s(rows(&truth, 5, &sites.levels[0].keys));
        assert!(
            gap(&found, &expected) < 1e-5,
            "{name}: {}",
            gap(&found, &expected)
        );
    }
    let sites = Sites::new(SHAPE, keys(&f64s(golden.f32("sparse.some.active"))));
    let (fine, coarse) = (&sites.levels[0], &sites.levels[1]);
    assert_eq!(coarse.keys, keys(&golden.f64("sparse.down.active")));
    let x = rows(&golden.f64("sparse.some.submanifold"), 5, &fine.keys);
    let down = apply(
        &convolution(&golden, "sparse.down", [5, 4, CHILDREN], false),
        &x,
        5,
        &coarse.children,
    );
    let expected = f64s(rows(&golden.f64("sparse.down.out"), 4, &coarse.keys));
    assert!(gap(&down, &expected) < 1e-5);
    let up = apply(
        &convolution(&golden, "sparse.up", [4, 3, CHILDREN], true),
        &down,
        4,
        &fine.parent,
    );
    let expected = f64s(rows(&golden.f64("sparse.up.out"), 3, &fine.keys));
    assert!(gap(&up, &expected) < 1e-5);
}

#[test]
fn threads_do_not_change_a_bit() {
    let keys: Vec<u32> = (0..200 * 200 * 16).step_by(31).collect();
    let sites = Sites::new([200, 200, 16], keys);
    let x: Vec<f32> = (0..sites.levels[0].keys.len() * 3)
        .map(|i| (i as f32 * 0.37).sin())
        .collect();
    let conv = convolution(&Golden::nn(), "sparse", [3, 5, TAPS], false);
    let on = |threads| {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .expect("a pool");
        pool.install(|| apply(&conv, &x, 3, &sites.levels[0].around))
    };
    assert_eq!(on(1), on(3));
}
