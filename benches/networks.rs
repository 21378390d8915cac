//! Times the networks with the shipped weights, on the processor's kernels and on candle: `cargo bench --bench networks`. Medians in one run, the two taking turns.

use std::time::Instant;

use dataset::occupancy_frame;
use nets::{BlockReuse, ColumnHeights, DitCondition, GROUPS, KeysValues, OccDit, OccModels, OccVae};
use nn::Precision;
use nn::layers::{MatrixView, matmul};
use nn::packed_matrix::{InitialSum, PackedMatrix};
use nn::weights::WeightFile;
use nn_candle::Candle;
use numeric::quantile::median;

const RUNS: usize = 15;

fn timed<T>(out: &mut Vec<f64>, work: impl FnOnce() -> T) -> T {
    let start = Instant::now();
    let result = work();
    out.push(start.elapsed().as_secs_f64() * 1e3);
    result
}

/// A layer's product, 80 x 192 times 192 x 768, against a packed matrix and through gemm, on one core.
fn products() {
    let [m, n, k] = [80, 768, 192];
    let number = |i: usize| (i % 97) as f32 / 97.0 - 0.5;
    let a: Vec<f32> = (0..m * k).map(number).collect();
    let b: Vec<f32> = (0..k * n).map(number).collect();
    let mut out = vec![0.0; m * n];
    let packed = PackedMatrix::new(MatrixView::rows(&b, n), k, n);
    let (int8, bias) = (packed.to_int8(), vec![0.0; n]);
    let [mut ours, mut theirs, mut bytes] = [const { Vec::new() }; 3];
    for _ in 0..20 * RUNS {
        timed(&mut bytes, || int8.multiply(&a, &bias, &mut out));
        timed(&mut ours, || {
            packed.multiply(&a, k, [m, 0, k], InitialSum::Zero, &mut out, n)
        });
        timed(&mut theirs, || {
            matmul(
                &mut out,
                n,
                false,
                MatrixView::rows(&a, k),
                MatrixView::rows(&b, n),
                [m, n, k],
            );
        });
    }
    let rate = |ms: &[f64]| 2e-6 * (m * n * k) as f64 / median(ms);
    println!(
        "product of a layer, one core: packed {:.0}, gemm {:.0}, eight bits {:.0} GFLOP/s",
        rate(&ours),
        rate(&theirs),
        rate(&bytes)
    );
}

fn main() {
    let models = OccModels::bundled().expect("the shipped weights load");
    let file = |bytes| WeightFile::parse("shipped", bytes).expect("the shipped weights load");
    let device = Candle::best().expect("a device");
    let candle =
        OccDit::on(device.clone(), file(assets::weights::OCC_DIT)).expect("the shipped weights load");
    let candle_vae = OccVae::on(device, file(assets::weights::OCC_VAE)).expect("the shipped weights load");
    let frame = occupancy_frame(3, 0, |_| None);
    let [mut encode, mut decode, mut ours, mut theirs, mut int8, mut reused] = [const { Vec::new() }; 6];
    let [mut their_encode, mut their_decode] = [const { Vec::new() }; 2];
    let latent = models.vae.encode(&frame.dense).expect("a sound grid");
    let condition = DitCondition {
        bev: frame.bev,
        heading: frame.heading,
        named: [None; 4],
        draft_latent: models.vae.encode(&frame.draft).expect("a sound grid"),
        given: vec![[0.0; GROUPS]; 2500],
        columns: vec![ColumnHeights::default(); 40_000],
        ground: false,
        mask: vec![1.0; 2500],
        context: vec![0.0; 20_000],
    };
    let prepared = models.dit.prepare(&condition).expect("a sound condition");
    let tokens = candle.prepare(&condition).expect("a sound condition");
    for run in 0..RUNS + 2 {
        if run == 2 {
            // The first two warm up.
            for values in [
                &mut encode,
                &mut decode,
                &mut ours,
                &mut theirs,
                &mut int8,
                &mut reused,
                &mut their_encode,
                &mut their_decode,
            ] {
                values.clear();
            }
        }
        timed(&mut encode, || models.vae.encode(&frame.dense)).expect("a sound grid");
        timed(&mut decode, || models.vae.decode(&latent)).expect("a sound latent");
        timed(&mut their_encode, || candle_vae.encode(&frame.dense)).expect("a sound grid");
        timed(&mut their_decode, || candle_vae.decode(&latent)).expect("a sound latent");
        timed(&mut ours, || models.dit.forward(&latent, 500.0, &prepared)).expect("finite");
        let mut added = Vec::new();
        let in_int8 = timed(&mut int8, || {
            let (mut kept, middle) = (KeysValues::default(), BlockReuse::Kept(&mut added));
            models
                .dit
                .forward_in(&latent, 500.0, &prepared, &mut kept, Precision::Int8, middle)
        })
        .expect("finite");
        timed(&mut reused, || {
            let (mut kept, middle) = (KeysValues::default(), BlockReuse::Reused(&added));
            models
                .dit
                .forward_in(&latent, 500.0, &prepared, &mut kept, Precision::F32, middle)
        })
        .expect("finite");
        if run == 0 {
            let exact = models.dit.forward(&latent, 500.0, &prepared).expect("finite");
            let square =
                |v: &mut dyn Iterator<Item = f32>| v.map(|v| f64::from(v).powi(2)).sum::<f64>().sqrt();
            let error = square(&mut in_int8.iter().zip(&exact).map(|(a, b)| a - b));
            println!(
                "eight bits: relative RMS error of v {:.4}",
                error / square(&mut exact.iter().copied())
            );
        }
        timed(&mut theirs, || candle.forward(&latent, 500.0, &tokens)).expect("finite");
    }
    products();
    println!("median of {RUNS}, ms");
    for (name, values) in [
        ("encode", encode),
        ("decode", decode),
        ("encode, candle", their_encode),
        ("decode, candle", their_decode),
        ("DiT step", ours),
        ("DiT step, 8 bits", int8),
        ("middle reused", reused),
        ("DiT step, candle", theirs),
    ] {
        println!("{name:<18} {:>8.1}", median(&values));
    }
}
