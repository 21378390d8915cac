//! What an edit costs by the share of the map it touches, beside a dense one:
//! `cargo bench --bench locality`. One network step, local and dense taking turns; medians.

use std::time::Instant;

use dataset::occupancy_frame;
use nets::{CELLS, ColumnHeights, DitCondition, GROUPS, KeysValues, OccModels, tokens_of};
use numeric::quantile::median;

const RUNS: usize = 25;
const SIDE: usize = 50;
/// Cells along a side of the edited square: 1, 5, 15, 30 and 100 % of the area.
const SIDES: [usize; 5] = [5, 11, 19, 27, 50];

fn main() {
    let models = OccModels::bundled().expect("the shipped weights load");
    let frame = occupancy_frame(3, 0, |_| None);
    let latent = models.vae.encode(&frame.dense).expect("a sound grid");
    let condition = DitCondition {
        bev: frame.bev,
        heading: frame.heading,
        named: [None; 4],
        draft_latent: models.vae.encode(&frame.draft).expect("a sound grid"),
        given: vec![[0.0; GROUPS]; CELLS],
        columns: vec![ColumnHeights::default(); 40_000],
        ground: false,
        mask: vec![1.0; CELLS],
        context: vec![0.0; latent.len()],
    };
    let all = models.dit.prepare(&condition).expect("a sound condition");
    let (mut kept, mut kept_dense) = (KeysValues::default(), KeysValues::default());
    models
        .dit
        .forward_some(&latent, 500.0, &all, &mut kept)
        .expect("finite");
    println!("area %   tokens   step ms   dense ms   speed-up   decode ms   dense ms   speed-up");
    for side in SIDES {
        let first = (SIDE - side) / 2;
        let inside = |c: usize| (first..first + side).contains(&c);
        let cells: Vec<bool> = (0..CELLS).map(|c| inside(c / SIDE) && inside(c % SIDE)).collect();
        let tokens = tokens_of(&cells, 1);
        let some = models
            .dit
            .prepare_some(&condition, tokens.clone())
            .expect("a sound condition");
        let mut ms: [Vec<f64>; 4] = Default::default();
        for run in 0..RUNS + 2 {
            let timed: [&mut dyn FnMut(); 4] = [
                &mut || drop(models.dit.forward_some(&latent, 500.0, &some, &mut kept)),
                &mut || drop(models.dit.forward_some(&latent, 500.0, &all, &mut kept_dense)),
                &mut || drop(models.vae.decode_cells(&latent, &cells)),
                &mut || drop(models.vae.decode(&latent)),
            ];
            for (ms, work) in ms.iter_mut().zip(timed) {
                let start = Instant::now();
                work();
                // The first two warm up.
                if run >= 2 {
                    ms.push(start.elapsed().as_secs_f64() * 1e3);
                }
            }
        }
        let [step, dense, decode, decode_all] = ms.map(|v| median(&v));
        println!(
            "{:6.1} {:8} {step:9.2} {dense:10.2} {:10.1} {decode:11.2} {decode_all:10.2} {:10.1}",
            side.pow(2) as f64 / CELLS as f64 * 100.0,
            tokens.len(),
            dense / step,
            decode_all / decode
        );
    }
}
