//! The fused kernels of the networks against the same network written with candle 0.11 (f32 both).

use dataset::occupancy_frame;
use nets::candle_dit::CandleDit;
use nets::candle_vae::CandleVae;
use nets::{ColumnHeights, DitCondition, OccModels};

const WEIGHTS: &[u8] = assets::weights::OCC_DIT;

/// Numbers in -1..1 from a hash of their index.
fn numbers(count: usize, stream: u32) -> Vec<f32> {
    let hash = |i: u32| (i ^ stream.wrapping_mul(0x9e37_79b9)).wrapping_mul(2_654_435_761);
    (0..count as u32)
        .map(|i| (hash(i) >> 8) as f32 / (1 << 23) as f32 - 1.0)
        .collect()
}

/// Tolerance 1e-4 of the largest value: two f32 programs that add in different orders.
#[test]
fn dit_agrees_with_candle() {
    let models = OccModels::bundled().expect("the shipped weights load");
    let candle = CandleDit::new(WEIGHTS, models.dit.config().heads).expect("the shipped weights load");
    let mask: Vec<f32> = (0..2500).map(|i| f32::from(u8::from(i % 50 > 20))).collect();
    let heights = |i: u8| ColumnHeights {
        standing: [[i % 3, i % 3 + i % 3 * 2], [0, 0]],
        ground: i % 5,
    };
    let condition = DitCondition {
        bev: (0..40_000u32)
            .map(|i| i.wrapping_mul(747_796_405) & 0x3_ffff & (i >> 3))
            .collect(),
        heading: (0..40_000u32).map(|i| (i * 7 % 961 / 4) as u8).collect(),
        named: [Some(0.5), None, Some(0.1), Some(1.0)],
        draft_latent: numbers(20_000, 1),
        given: (0..2500)
            .map(|i| [i % 7 < 4, i % 3 < 2].map(|g| f32::from(u8::from(g))))
            .collect(),
        columns: (0..40_000).map(|i| heights(i as u8)).collect(),
        ground: true,
        context: numbers(20_000, 2)
            .iter()
            .enumerate()
            .map(|(i, v)| v * (1.0 - mask[i / 8]))
            .collect(),
        mask,
    };
    let ours = models.dit.prepare(&condition).expect("a sound condition");
    let theirs = candle.condition(&condition).expect("a sound condition");
    let x = numbers(20_000, 3);
    for t in [0.0f32, 437.5, 999.0] {
        let a = models.dit.forward(&x, t, &ours).expect("finite");
        let b = candle
            .forward(&x, f64::from(t), &condition, &theirs)
            .expect("finite");
        let largest = b.iter().fold(0f32, |m, v| m.max(v.abs()));
        let worst = a.iter().zip(&b).fold(0f32, |m, (a, b)| m.max((a - b).abs()));
        assert!(
            largest > 0.1 && worst <= 1e-4 * largest,
            "t {t}: {worst} of {largest}"
        );
    }
}

/// Tolerance 1e-4 of the largest value, and one label of ten thousand where two classes are as likely.
#[test]
fn vae_agrees_with_candle() {
    let models = OccModels::bundled().expect("the shipped weights load");
    let bytes = assets::weights::OCC_VAE;
    let candle = CandleVae::new(bytes, models.vae.config().clone()).expect("the shipped weights load");
    let frame = occupancy_frame(3, 1, |_| None);
    let ours = models.vae.encode(&frame.dense).expect("a sound grid");
    let theirs = candle.encode(&frame.dense).expect("a sound grid");
    let largest = theirs.iter().fold(0f32, |m, v| m.max(v.abs()));
    let worst = ours
        .iter()
        .zip(&theirs)
        .fold(0f32, |m, (a, b)| m.max((a - b).abs()));
    assert_eq!(ours.len(), theirs.len());
    assert!(largest > 0.1 && worst <= 1e-4 * largest, "{worst} of {largest}");
    let ours = models.vae.decode(&theirs).expect("a sound latent").to_dense();
    let theirs = candle.decode(&theirs).expect("a sound latent");
    assert_eq!(ours.len(), theirs.len());
    let differ = ours
        .iter()
        .zip(&theirs)
        .filter(|(a, b)| u32::from(**a) != **b)
        .count();
    assert!(
        differ <= ours.len() / 10_000,
        "{differ} of {} labels differ",
        ours.len()
    );
}
