//! The networks on the processor's kernels against the same networks on candle (f32 both; features `cuda` and `metal`:
//! on a card).

use dataset::occupancy_frame;
use nets::refiner::{Refiner, Rough};
use nets::scenery::{self, SceneryCondition, SceneryNet};
use nets::{
    CELLS, CellRect, ColumnHeights, DecoderInput, DitCondition, KeysValues, Middle, OccDit, OccModels,
    OccVae, tokens_of,
};
use nn::weights::WeightFile;
use nn::{Ops, Precision};
use nn_candle::Candle;
use scene::Window;

/// Numbers in -1..1 from a hash of their index.
fn numbers(count: usize, stream: u32) -> Vec<f32> {
    let hash = |i: u32| (i ^ stream.wrapping_mul(0x9e37_79b9)).wrapping_mul(2_654_435_761);
    (0..count as u32)
        .map(|i| (hash(i) >> 8) as f32 / (1 << 23) as f32 - 1.0)
        .collect()
}

fn file(bytes: &'static [u8]) -> WeightFile<'static> {
    WeightFile::parse("shipped", bytes).expect("a sound file")
}

fn candle() -> Candle {
    Candle::best().expect("a device")
}

/// Within 1e-4 of the largest value: two f32 programs that add in different orders.
fn agree(ours: &[f32], theirs: &[f32], what: &str) {
    assert_eq!(ours.len(), theirs.len());
    let largest = theirs.iter().fold(0f32, |m, v| m.max(v.abs()));
    let pairs = ours.iter().zip(theirs);
    let worst = pairs.fold(0f32, |m, (a, b)| m.max((a - b).abs()));
    assert!(
        largest > 0.1 && worst <= 1e-4 * largest,
        "{what}: {worst} of {largest}"
    );
}

fn condition() -> DitCondition {
    let mask: Vec<f32> = (0..2500).map(|i| f32::from(u8::from(i % 50 > 20))).collect();
    let heights = |i: u8| ColumnHeights {
        standing: [[i % 3, i % 3 + i % 3 * 2], [0, 0]],
        ground: i % 5,
    };
    DitCondition {
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
    }
}

#[test]
fn dit_agrees_with_candle() {
    let models = OccModels::bundled().expect("the shipped weights load");
    let candle = OccDit::on(candle(), file(assets::weights::OCC_DIT)).expect("the shipped weights load");
    let condition = condition();
    let ours = models.dit.prepare(&condition).expect("a sound condition");
    let theirs = candle.prepare(&condition).expect("a sound condition");
    let x = numbers(20_000, 3);
    for t in [0.0f32, 437.5, 999.0] {
        let a = models.dit.forward(&x, t, &ours).expect("finite");
        let b = candle.forward(&x, t, &theirs).expect("finite");
        agree(&a, &b, &format!("t {t}"));
    }
}

/// Some tokens among the others' keys and values, with the middle blocks reused.
#[test]
fn a_part_of_the_dit_agrees_with_candle() {
    let models = OccModels::bundled().expect("the shipped weights load");
    let candle = OccDit::on(candle(), file(assets::weights::OCC_DIT)).expect("the shipped weights load");
    let (condition, x) = (condition(), numbers(20_000, 3));
    let cells: Vec<bool> = (0..CELLS).map(|c| c / 50 < 9 && c % 50 > 30).collect();
    let (a, b) = (
        part_of(&models.dit, &condition, &x, &cells),
        part_of(&candle, &condition, &x, &cells),
    );
    agree(&a[0], &b[0], "some tokens");
    agree(&a[1], &b[1], "middle reused");
    assert!(a[0] != a[1]);
    let prepared = candle.prepare(&condition).expect("a sound condition");
    let mut kept = KeysValues::default();
    let eight = candle.forward_in(&x, 1.0, &prepared, &mut kept, Precision::Int8, Middle::Computed);
    let told = eight.expect_err("not there").to_string();
    assert_eq!(told, "candle: eight bits are for the processor's own kernels");
}

fn part_of<B: Ops>(net: &OccDit<B>, condition: &DitCondition, x: &[f32], cells: &[bool]) -> [Vec<f32>; 2] {
    let all = net.prepare(condition).expect("a sound condition");
    let mut kept = KeysValues::default();
    net.forward_some(x, 500.0, &all, &mut kept).expect("finite");
    let some = net
        .prepare_some(condition, tokens_of(cells, 1))
        .expect("a sound condition");
    let mut added = Vec::new();
    let middle = Middle::Kept(&mut added);
    let first = net.forward_in(x, 437.5, &some, &mut kept, Precision::F32, middle);
    let middle = Middle::Reused(&added);
    let second = net.forward_in(x, 300.0, &some, &mut kept, Precision::F32, middle);
    [first.expect("finite"), second.expect("finite")]
}

/// One label of ten thousand may differ, where two classes are as likely.
#[test]
fn vae_agrees_with_candle() {
    let models = OccModels::bundled().expect("the shipped weights load");
    let candle = OccVae::on(candle(), file(assets::weights::OCC_VAE)).expect("the shipped weights load");
    let frame = occupancy_frame(3, 1, |_| None);
    let ours = models.vae.encode(&frame.dense).expect("a sound grid");
    let theirs = candle.encode(&frame.dense).expect("a sound grid");
    agree(&ours, &theirs, "latent");
    let observed: Vec<u32> = (0..Window::COLUMNS as u32)
        .map(|c| c * 7919 % (1 << 17))
        .collect();
    let informed = DecoderInput {
        draft: Some(&frame.draft),
        observed: Some(&observed),
    };
    for input in [DecoderInput::default(), informed] {
        let cells = vec![true; CELLS];
        let ours = models
            .vae
            .decode_with(&theirs, &cells, input)
            .expect("a sound latent");
        let theirs = candle
            .decode_with(&theirs, &cells, input)
            .expect("a sound latent");
        let differ = ours.count_different(&theirs);
        assert!(differ <= Window::VOXELS / 10_000, "{differ} labels differ");
    }
    let [a, b] = [
        models
            .vae
            .logits(&theirs, 1234, informed)
            .expect("a sound latent"),
        candle.logits(&theirs, 1234, informed).expect("a sound latent"),
    ];
    agree(&a, &b, "logits");
}

#[test]
fn refiner_and_scenery_agree_with_candle() {
    let ours = Refiner::bundled().expect("the shipped weights load");
    let fine = file(assets::weights::OCC_VAE_FINE);
    let theirs =
        Refiner::on(candle(), file(assets::weights::REFINER), fine).expect("the shipped weights load");
    let mut cells = [false; CELLS];
    (300..310).for_each(|c| cells[c] = true);
    let window = CellRect::around(&cells, 4).expect("ten cells");
    let fine = 4 * window.rows * window.columns * 16;
    let (state, rough, told) = (numbers(fine, 1), numbers(fine, 2), numbers(fine, 3));
    let rough = Rough {
        fine: &rough,
        told: &told,
        coarse: &numbers(fine / 8, 4),
        window,
    };
    let a = ours.forward(&state, 321.0, &rough).expect("finite");
    let b = theirs.forward(&state, 321.0, &rough).expect("finite");
    agree(&a, &b, "refiner");

    let ours = SceneryNet::bundled().expect("the shipped weights load");
    let theirs = SceneryNet::on(candle(), file(assets::weights::SCENERY)).expect("the shipped weights load");
    let size = scenery::CELLS * scenery::NUMBERS;
    let condition = SceneryCondition {
        bev: (0..40_000u32)
            .map(|i| i.wrapping_mul(747_796_405) & 0x3_ffff)
            .collect(),
        ground: (0..40_000).map(|i| (i % 5) as u8).collect(),
        named: [Some(0.5), None, Some(1.0)],
        drawn: (0..scenery::CELLS).map(|c| c % 3 > 0).collect(),
        stands: numbers(size, 5),
    };
    let x = numbers(size, 6);
    let a = ours.forward(&x, 700.0, &condition).expect("finite");
    let b = theirs.forward(&x, 700.0, &condition).expect("finite");
    agree(&a, &b, "scenery");
}
