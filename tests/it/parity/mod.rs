//! The Rust networks against the Python ones that trained the shipped weights: goldens written by
//! training/export.py (PyTorch, f32) for exactly these files.

mod folders;
mod local;

use std::sync::Arc;

use app::open;
use glam::DVec3;
use job::pipeline::OccPipeline;
use job::refine::decode_refined;
use job::{GenParams, Job, JobCtx, Pipeline, RegionMode};
use nets::lidar::field::LidarRay;
use nets::lidar::{LearnedRay, LidarNet};
use nets::refiner::{Refiner, Rough};
use nets::scenery::{self, SceneryCondition, SceneryNet};
use nets::{
    Between, CELLS, CHANNELS, CellRect, ColumnHeights, DecoderInput, DitCondition, KeysValues, LATENT,
    ModelError, OccDitTime, OccModels, OccVae, Squares, TimeDecoder, fine_vae, tokens_of,
};
use safetensors::{Dtype, SafeTensors};
use scene::VoxelGrid;

const TOLERANCE: f32 = 1e-4;

fn models() -> Arc<OccModels> {
    OccModels::bundled().expect("the shipped weights")
}

struct Golden(Vec<u8>);

impl Golden {
    fn open(name: &str) -> Self {
        let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR"))
            .join("tests/reference")
            .join(name);
        Self(std::fs::read(&path).unwrap_or_else(|e| panic!("{}: {e}", path.display())))
    }

    fn bytes(&self, name: &str, dtype: Dtype) -> Vec<u8> {
        let file = SafeTensors::deserialize(&self.0).expect("a safetensors file");
        let tensor = file.tensor(name).expect("a tensor of the golden");
        assert_eq!(tensor.dtype(), dtype, "{name}");
        tensor.data().to_vec()
    }

    fn f32(&self, name: &str) -> Vec<f32> {
        let bytes = self.bytes(name, Dtype::F32);
        bytes
            .chunks_exact(4)
            .map(|b| f32::from_le_bytes(b.try_into().expect("4 bytes")))
            .collect()
    }

    fn i32(&self, name: &str) -> Vec<i32> {
        let bytes = self.bytes(name, Dtype::I32);
        bytes
            .chunks_exact(4)
            .map(|b| i32::from_le_bytes(b.try_into().expect("4 bytes")))
            .collect()
    }
}

fn assert_close(what: &str, found: impl IntoIterator<Item = f32>, truth: &[f32]) {
    let found: Vec<f32> = found.into_iter().collect();
    assert_eq!(found.len(), truth.len(), "{what}");
    let scale = truth.iter().fold(1.0f32, |m, v| m.max(v.abs()));
    let worst = found
        .iter()
        .zip(truth)
        .map(|(f, t)| (f - t).abs())
        .fold(0.0f32, f32::max);
    println!("{what}: largest difference {worst:.1e}, largest value {scale:.1}");
    assert!(
        worst <= TOLERANCE * scale,
        "{what}: {worst} apart, values up to {scale}"
    );
}

/// The scene of the VAE's golden.
fn scene(golden: &Golden) -> VoxelGrid {
    let mut grid = VoxelGrid::new();
    for (at, label) in golden
        .i32("voxels")
        .into_iter()
        .zip(golden.bytes("labels", Dtype::U8))
    {
        let at = at as usize;
        grid.set(at / 3200, at / 16 % 200, at % 16, label);
    }
    grid
}

/// Numbers in [-1.75, 1.75), as `uniform` in training/export.py makes them.
fn uniform(count: usize, stream: u64) -> Vec<f32> {
    let number = |i: u64| {
        let h = (i * 2_654_435_761 + stream * 40_503 + 12_345) % (1 << 32);
        let h = (h ^ (h >> 15)) * 2_246_822_519 % (1 << 32);
        (h as f64 / 4_294_967_296.0 * 3.5 - 1.75) as f32
    };
    (0..count as u64).map(number).collect()
}

/// `golden_condition` of training/export.py.
fn condition() -> DitCondition {
    let inside = |cell: usize| (10..31).contains(&(cell / 50)) && (17..40).contains(&(cell % 50));
    let mask: Vec<f32> = (0..CELLS).map(|c| f32::from(u8::from(inside(c)))).collect();
    let context = uniform(LATENT, 2)
        .into_iter()
        .enumerate()
        .map(|(i, v)| v * (1.0 - mask[i / CHANNELS]));
    let bits = |x: usize, y: usize| {
        (0..18)
            .map(|l| u32::from((x * 3 + y * 5 + l * 37) % 97 < 11) << l)
            .sum()
    };
    let heading = |x: usize, y: usize| match (x / 8 + y / 4) % 5 {
        0 => 1 + ((x * 7 + y * 3) % 240) as u8,
        _ => 0,
    };
    let heights = |x: usize, y: usize| ColumnHeights {
        standing: [
            [(x % 4 + 1) as u8, (x % 4 + 1 + y % 3) as u8]
                .map(|bin| if (x + y).is_multiple_of(3) { bin } else { 0 }),
            [2, 9].map(|bin| if (x / 2 + y).is_multiple_of(5) { bin } else { 0 }),
        ],
        ground: ((x + 2 * y) % 6) as u8,
    };
    DitCondition {
        bev: (0..40_000).map(|c| bits(c / 200, c % 200)).collect(),
        heading: (0..40_000).map(|c| heading(c / 200, c % 200)).collect(),
        named: [Some(0.25), None, Some(0.75), Some(0.5)],
        draft_latent: uniform(LATENT, 3),
        given: (0..2500)
            .map(|c| [c / 50 >= 20 && (5..33).contains(&(c % 50)), c % 50 < 30])
            .map(|groups| groups.map(|given| f32::from(u8::from(given))))
            .collect(),
        columns: (0..40_000).map(|c| heights(c / 200, c % 200)).collect(),
        ground: true,
        context: context.collect(),
        mask,
    }
}

/// `golden` of training/export_scenery.py.
#[test]
fn scenery_agrees_with_python() {
    let golden = Golden::open("parity_scenery.safetensors");
    let DitCondition { bev, columns, .. } = condition();
    let drawn = |cell: usize| {
        let (x, y) = (cell / scenery::SIDE, cell % scenery::SIDE);
        (20..77).contains(&x) && (31..90).contains(&y)
    };
    let condition = SceneryCondition {
        bev,
        ground: columns.iter().map(|c| c.ground).collect(),
        drawn: (0..scenery::CELLS).map(drawn).collect(),
        stands: scenery::map_of(&columns),
        named: [Some(0.25), None, Some(0.75)],
    };
    let net = SceneryNet::bundled().expect("the shipped weights");
    let x = uniform(scenery::CELLS * scenery::NUMBERS, 4);
    let truth = golden.f32("every_fifth_v");
    let times = golden.f32("t");
    for (t, truth) in times.iter().zip(truth.chunks_exact(truth.len() / times.len())) {
        let v = net.forward(&x, *t, &condition).expect("a sound condition");
        assert_close(&format!("v at {t}"), v.into_iter().step_by(5), truth);
    }
}

#[test]
fn vae_agrees_with_python() {
    agrees(&models().vae, &Golden::open("parity_vae.safetensors"));
}

/// `golden` of training/export_refiner.py.
#[test]
fn refiner_agrees_with_python() {
    let golden = Golden::open("parity_refiner.safetensors");
    let net = Refiner::bundled().expect("the shipped weights load");
    let window = CellRect {
        x: 3,
        y: 20,
        rows: 7,
        columns: 11,
        side: 50,
    };
    let places = 4 * 7 * 11;
    let [x, fine, told] = [5, 6, 8].map(|stream| uniform(16 * places, stream));
    let coarse = uniform(places / 4 * CHANNELS, 7);
    let rough = Rough {
        fine: &fine,
        told: &told,
        coarse: &coarse,
        window,
    };
    let truth = golden.f32("v");
    for (t, truth) in golden.f32("t").into_iter().zip(truth.chunks_exact(16 * places)) {
        let v = net.forward(&x, t, &rough).expect("finite input");
        assert_close(&format!("refiner, step {t}"), v, truth);
    }
    let mut bad = x.clone();
    bad[9] = f32::NAN;
    for (x, t) in [(&bad[..], 0.0), (&x[1..], 0.0), (&x, 1000.0), (&x, f32::NAN)] {
        let error = net.forward(x, t, &rough).expect_err("refused").to_string();
        assert_eq!(error.lines().count(), 1, "{error}");
    }
}

#[test]
fn fine_vae_agrees_with_python() {
    let fine = fine_vae().expect("the shipped weights load");
    agrees(&fine, &Golden::open("parity_vae_fine.safetensors"));
}

fn agrees(vae: &OccVae, golden: &Golden) {
    let latent = golden.f32("latent");
    assert_close("latent", vae.encode(&scene(golden)).expect("labels"), &latent);
    let draft = scene(golden);
    let observed = (0..40_000u32).map(|c| match (3 * (c / 200) + 5 * (c % 200)) % 7 {
        0..4 => 1 << 16 | ((c / 200) * (c % 200)) & 0xffff,
        _ => 0,
    });
    let observed: Vec<u32> = observed.collect();
    let informed = DecoderInput {
        draft: Some(&draft),
        observed: Some(&observed),
    };
    for (name, input) in [("logits", DecoderInput::default()), ("logits_told", informed)] {
        let (logits, cells) = (golden.f32(name), golden.i32("cells"));
        let of_cell = logits.len() / cells.len();
        assert_eq!(of_cell, (200 / vae.config().side()).pow(2) * 16 * 18);
        for (cell, truth) in cells.into_iter().zip(logits.chunks_exact(of_cell)) {
            let found = vae.logits(&latent, cell as usize, input);
            assert_close(
                &format!("{name} of cell {cell}"),
                found.expect("a finite latent"),
                truth,
            );
        }
    }
}

/// `golden` of training/export_time.py.
#[test]
fn temporal_blocks_agree_with_python() {
    let (models, golden) = (models(), Golden::open("parity_occ_dit_time.safetensors"));
    let time = OccDitTime::bundled().expect("the shipped weights");
    let poses = [[0.0, 0.0, 0.0], [3.1, 0.4, 0.05], [12.9, 1.2, 0.4]];
    let between = Between::of(&poses, 0.5, Squares::TOKENS.by_number(time.config().same_cell));
    let prepared: Vec<_> = poses
        .iter()
        .map(|_| models.dit.prepare(&condition()).expect("a condition"))
        .collect();
    let x: Vec<Vec<f32>> = uniform(3 * LATENT, 9)
        .chunks_exact(LATENT)
        .map(<[f32]>::to_vec)
        .collect();
    let truth = golden.f32("every_fiftieth_v");
    for (t, truth) in golden
        .f32("t")
        .into_iter()
        .zip(truth.chunks_exact(3 * LATENT / 50))
    {
        let v = time
            .forward(&models.dit, &x, t, &prepared, &between)
            .expect("a finite state");
        assert_close(
            &format!("v at t = {t}"),
            v.concat().into_iter().step_by(50),
            truth,
        );
    }
    let error = time.forward(&models.dit, &x[..2], 1.0, &prepared, &between);
    assert!(error.is_err(), "two states for three frames");
    let cells = Between::of(&poses, 0.5, Squares::CELLS);
    let error = time.forward(&models.dit, &x, 1.0, &prepared, &cells);
    assert!(error.is_err(), "places of cells, not of tokens");
}

/// `golden` of training/export_time_decoder.py.
#[test]
fn the_temporal_decoder_agrees_with_python() {
    let golden = Golden::open("parity_time_decoder.safetensors");
    let decoder = TimeDecoder::bundled().expect("the shipped weights");
    let poses = [[0.0, 0.0, 0.0], [3.1, 0.4, 0.05], [12.9, 1.2, 0.4]];
    let mut latents: Vec<Vec<f32>> = uniform(3 * LATENT, 9)
        .chunks_exact(LATENT)
        .map(<[f32]>::to_vec)
        .collect();
    let found = decoder.apply(&latents, &poses, 0.5).expect("finite latents");
    let truth = golden.f32("every_fiftieth_latent");
    assert_close("latents", found.concat().into_iter().step_by(50), &truth);
    assert!(
        decoder.apply(&latents[..2], &poses, 0.5).is_err(),
        "two latents of three frames"
    );
    latents[1][7] = f32::NAN;
    assert!(decoder.apply(&latents, &poses, 0.5).is_err(), "not a number");
}

#[test]
fn dit_agrees_with_python() {
    let (models, golden) = (models(), Golden::open("parity_dit.safetensors"));
    let prepared = models.dit.prepare(&condition()).expect("a condition");
    let truth = golden.f32("every_fifth_v");
    for (t, truth) in golden.f32("t").into_iter().zip(truth.chunks_exact(LATENT / 5)) {
        let v = models
            .dit
            .forward(&uniform(LATENT, 1), t, &prepared)
            .expect("a finite state");
        assert_close(&format!("v at t = {t}"), v.into_iter().step_by(5), truth);
    }
}

/// The labels are the lowest class among the largest logits (row 33), for every cell asked.
#[test]
fn row_33_decode() {
    let models = models();
    let latent = uniform(LATENT, 7);
    let grid = models.vae.decode(&latent).expect("a finite latent");
    for cell in [0, 49, 1275, 2499] {
        let logits = models
            .vae
            .logits(&latent, cell, DecoderInput::default())
            .expect("a finite latent");
        for (voxel, logits) in logits.chunks_exact(18).enumerate() {
            let best = nn::kernels::argmax(logits).expect("no NaN");
            let (x, y) = (cell / 50 * 4 + voxel / 64, cell % 50 * 4 + voxel / 16 % 4);
            let found = usize::from(grid.get(x, y, voxel % 16));
            assert!(
                found == best || logits[best] - logits[found] < 1e-4,
                "cell {cell}, voxel {voxel}"
            );
        }
    }
    for bad in [f32::NAN, f32::INFINITY, 1e38] {
        let mut latent = latent.clone();
        latent[777] = bad;
        let error = models.vae.decode(&latent).expect_err("not finite");
        assert!(
            matches!(
                error,
                ModelError::NotFinite {
                    what: "latent",
                    index: 777,
                    ..
                }
            ),
            "{error}"
        );
    }
    assert!(matches!(
        models.vae.decode(&latent[1..]),
        Err(ModelError::Length {
            found: 19_999,
            expected: LATENT,
            ..
        })
    ));
    assert!(matches!(
        models.vae.decode_cells(&latent, &[true]),
        Err(ModelError::Length { found: 1, .. })
    ));
}

/// Row 30 of the extremes table: no token, one, some and all of them; all is dense bit for bit, some agree
/// with dense as long as the others' keys and values are those of the same state.
#[test]
fn row_30_dirty_tokens() {
    let (models, condition, x) = (models(), condition(), uniform(LATENT, 1));
    let all = models.dit.prepare(&condition).expect("a condition");
    let dense = models.dit.forward(&x, 321.0, &all).expect("a finite state");
    let mut kept = KeysValues::default();
    let again = models
        .dit
        .forward_some(&x, 321.0, &all, &mut kept)
        .expect("finite");
    assert_eq!((again, kept.bytes()), (dense.clone(), 8 * 625 * 2 * 192 * 4));
    let mut cells = vec![false; CELLS];
    for (wanted, tokens) in [(0..0, 0), (510..511, 1), (300..460, 50), (0..CELLS, 625)] {
        cells[wanted.clone()].fill(true);
        let places = tokens_of(&cells, 0);
        assert_eq!(places.len(), tokens);
        let some = models.dit.prepare_some(&condition, places).expect("a condition");
        let mut seen = kept.clone();
        let found = models
            .dit
            .forward_some(&x, 321.0, &some, &mut seen)
            .expect("finite");
        let scale = dense.iter().fold(0f32, |m, v| m.max(v.abs()));
        for cell in wanted {
            for i in cell * CHANNELS..(cell + 1) * CHANNELS {
                assert!(
                    (found[i] - dense[i]).abs() <= 1e-5 * scale,
                    "{} and {}",
                    found[i],
                    dense[i]
                );
            }
        }
        assert_eq!(found.iter().filter(|v| **v != 0.0).count(), tokens * 4 * CHANNELS);
        cells.fill(false);
    }
    // Without keys and values only all tokens make sense.
    let one = models.dit.prepare_some(&condition, vec![7]).expect("a condition");
    let error = models
        .dit
        .forward_some(&x, 321.0, &one, &mut KeysValues::default());
    assert_eq!(
        error.expect_err("too few tokens").to_string(),
        "tokens has 1 values, expected 625"
    );
}

#[test]
fn conditions_are_checked() {
    let models = models();
    let good = condition();
    let refusal = |change: &dyn Fn(&mut DitCondition)| {
        let mut bad = good.clone();
        change(&mut bad);
        models.dit.prepare(&bad).expect_err("refused").to_string()
    };
    assert_eq!(
        refusal(&|c| c.bev.truncate(3)),
        "layout has 3 values, expected 40000"
    );
    assert_eq!(
        refusal(&|c| c.mask.push(0.0)),
        "mask has 2501 values, expected 2500"
    );
    assert_eq!(
        refusal(&|c| c.given.clear()),
        "given background has 0 values, expected 2500"
    );
    assert!(refusal(&|c| c.context[5] = f32::NAN).starts_with("context: value 5 is NaN"));
    let prepared = models.dit.prepare(&good).expect("a condition");
    for t in [-1.0, 1000.0, f32::NAN] {
        assert!(matches!(
            models.dit.forward(&good.context, t, &prepared),
            Err(ModelError::Timestep(_))
        ));
    }
    let null = models.dit.null_condition(&good);
    assert!(null.mask == good.mask && null.context == good.context);
    assert!(null.bev.iter().all(|b| *b == 0) && null.draft_latent.iter().all(|v| *v == 0.0));
    assert_ne!(models.dit.prepare(&null).expect("a condition"), prepared);
    let mut grid = VoxelGrid::new();
    grid.set(3, 4, 5, 18);
    assert_eq!(
        models.vae.encode(&grid),
        Err(ModelError::Label {
            x: 3,
            y: 4,
            z: 5,
            found: 18
        })
    );
}

#[test]
fn lidar_agrees_with_python() {
    let golden = Golden::open("parity_lidar.safetensors");
    let net = LidarNet::bundled().expect("the shipped weights");
    let keys: Vec<u32> = golden.i32("keys").into_iter().map(|k| k as u32).collect();
    let sites = keys.len(); // the field has one more: what lies beside all of them
    let field = net
        .field_of(keys, golden.bytes("classes", Dtype::U8))
        .expect("a finite field");
    let rows = field.hidden.iter().zip(&field.planes).take(sites);
    let geometry = rows.flat_map(|(hidden, plane)| hidden.0.iter().chain(plane).copied());
    assert_close(
        "geometry",
        geometry.step_by(97),
        &golden.f32("every_97th_geometry"),
    );
    let appearance = field.appearance.iter().take(sites).flat_map(|line| line.0);
    assert_close(
        "appearance",
        appearance.step_by(97),
        &golden.f32("every_97th_appearance"),
    );
    let (t, d, origin) = (golden.f32("t"), golden.f32("directions"), golden.f32("origin"));
    let vector = |v: &[f32]| DVec3::new(v[0].into(), v[1].into(), v[2].into());
    let samples = t.len() / (d.len() / 3);
    let (mut sdf, mut met) = (Vec::new(), Vec::new());
    for (t, d) in t.chunks_exact(samples).zip(d.chunks_exact(3)) {
        let ray = LidarRay {
            origin: vector(&origin),
            direction: vector(d),
            range_m: [1.0, 100.0],
        };
        let (f, answer) = net.probe(&field, &ray, t).expect("the processor never fails");
        sdf.extend(f);
        met.push(answer);
    }
    assert_close("signed distance", sdf, &golden.f32("sdf"));
    let of = |value: fn(&LearnedRay) -> f32| met.iter().map(value);
    assert_close(
        "ln of what passes",
        of(|r| r.met.log_pass.max(-30.0)),
        &golden.f32("log_pass"),
    );
    // A ray that meets nothing has no depth, and no strength to speak of.
    let seen: Vec<bool> = golden.f32("log_pass").iter().map(|p| *p < -0.01).collect();
    assert!(seen.iter().filter(|s| **s).count() > 20);
    let only = |values: Vec<f32>| -> Vec<f32> {
        values
            .into_iter()
            .zip(&seen)
            .filter(|(_, s)| **s)
            .map(|(v, _)| v)
            .collect()
    };
    let depth = only(golden.f32("depth"));
    assert_close("depth", only(of(|r| r.met.mean_m).collect()), &depth);
    assert_close(
        "drop logit",
        only(of(|r| r.drop_logit).collect()),
        &only(golden.f32("drop")),
    );
    let strength = only(golden.f32("strength"))
        .into_iter()
        .map(|v| v.clamp(0.0, 1.0).powi(2))
        .collect::<Vec<_>>();
    assert_close("strength", only(of(|r| r.intensity / 255.0).collect()), &strength);
}
