//! The networks on the processor's kernels against the same networks on candle (f32 both; features `cuda` and `metal`:
//! on a card).

use std::sync::Arc;

use dataset::occupancy_frame;
use glam::DVec3;
use nets::layout::input::{EdgeInput, LayoutInput, MAP_CHANNELS, MAP_SIDE, NodeGeometry, NodeInput, VALUES};
use nets::layout::net::LayoutNet;
use nets::lidar::LidarNet;
use nets::lidar::field::{LidarRay, SignedDistanceField};
use nets::lidar::update::Changed;
use nets::picture::{self, Condition, Motion, PictureDit, PictureVae, RingSize};
use nets::refiner::{Refiner, Rough};
use nets::scenery::{self, SceneryCondition, SceneryNet};
use nets::text::TextEncoder;
use nets::{
    BlockReuse, CELLS, CellRect, ColumnHeights, DecoderInput, DitCondition, KeysValues, OccDit, OccModels,
    OccVae, tokens_of,
};
use nn::weights::WeightFile;
use nn::{Ops, Precision};
use nn_candle::Candle;
use scene::{Class, Window};

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
    println!("{what}: {worst:.1e} of {largest:.2}");
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
    let eight = candle.forward_in(
        &x,
        1.0,
        &prepared,
        &mut kept,
        Precision::Int8,
        BlockReuse::Computed,
    );
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
    let middle = BlockReuse::Kept(&mut added);
    let first = net.forward_in(x, 437.5, &some, &mut kept, Precision::F32, middle);
    let middle = BlockReuse::Reused(&added);
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

/// All that a field holds of its voxels.
fn of_voxels(field: &SignedDistanceField) -> [Vec<f32>; 3] {
    let flat = |lines: &[nets::lidar::field::SiteFeatures]| lines.iter().flat_map(|l| l.0).collect();
    let planes = field.planes.iter().flatten().copied().collect();
    [flat(&field.hidden), flat(&field.appearance), planes]
}

/// Signed distances along some rays, and the logits of lost echoes.
fn seen<B: Ops>(net: &LidarNet<B>, field: &SignedDistanceField) -> [Vec<f32>; 2] {
    let t: Vec<f32> = (0..120).map(|i| 2.0 + 0.25 * i as f32).collect();
    let mut out = [Vec::new(), Vec::new()];
    for i in 0..64 {
        let (around, up) = (f64::from(i) * 0.098, -0.2 + 0.03 * f64::from(i % 8));
        let ray = LidarRay {
            origin: DVec3::new(0.3, -0.2, 1.8),
            direction: DVec3::new(around.cos() * up.cos(), around.sin() * up.cos(), up.sin()),
            range_m: [1.0, 60.0],
        };
        let (distances, met) = net.probe(field, &ray, &t).expect("a device");
        out[0].extend(distances);
        out[1].push(met.drop_logit);
    }
    out
}

/// A field, the field after a change, and what rays see of it.
#[test]
fn lidar_agrees_with_candle() {
    let ours = LidarNet::bundled().expect("the shipped weights load");
    let theirs = LidarNet::on(candle(), file(assets::weights::LIDAR)).expect("the shipped weights load");
    let grid = occupancy_frame(3, 1, |_| None).dense;
    let mut changed = grid.clone();
    for (x, y) in (118..130).flat_map(|x| (106..111).map(move |y| (x, y))) {
        (2..6).for_each(|z| changed.set(x, y, z, Class::Car.id()));
    }
    let mut a = ours.field(&grid).expect("finite");
    let mut b = theirs.field(&grid).expect("finite");
    assert!(a.keys == b.keys && a.keys.len() > 10_000);
    let compare = |a: &SignedDistanceField, b: &SignedDistanceField, when: &str| {
        let names = ["hidden", "appearance", "planes"];
        for ((a, b), name) in of_voxels(a).iter().zip(&of_voxels(b)).zip(names) {
            agree(a, b, &format!("{name} {when}"));
        }
        let names = ["signed distance", "lost echoes"];
        for ((a, b), name) in seen(&ours, a).iter().zip(&seen(&theirs, b)).zip(names) {
            agree(a, b, &format!("{name} {when}"));
        }
    };
    compare(&a, &b, "at first");
    let found = ours.update(&mut a, &changed).expect("finite");
    assert!(matches!(&found, Changed::In(regions) if !regions.is_empty()));
    assert_eq!(theirs.update(&mut b, &changed).expect("finite"), found);
    compare(&a, &b, "after a change");
}

/// Nodes of every kind, half of the edges with a distance; with and without a map.
fn layout_input(nodes: usize, map: bool) -> LayoutInput {
    let values = numbers(nodes * VALUES, 7);
    let node = |(i, values): (usize, &[f32])| NodeInput {
        kind: (i % 27) as u8,
        state: (i % 4) as u8,
        size: (i % 3) as u8,
        shape: [NodeGeometry::None, NodeGeometry::Box, NodeGeometry::Line][i % 3],
        locked: i % 5 == 0,
        values: values.try_into().expect("the numbers of a node"),
    };
    let edge = |i: usize| EdgeInput {
        from: (i * 7 % nodes) as u16,
        to: (i * 11 % nodes) as u16,
        relation: (i % 19) as u8,
        distance_m: i.is_multiple_of(2).then_some(i as f32 / 3.0),
    };
    let cells = MAP_SIDE * MAP_SIDE * MAP_CHANNELS;
    LayoutInput {
        nodes: values.chunks_exact(VALUES).enumerate().map(node).collect(),
        edges: (0..3 * nodes).map(edge).collect(),
        map: map.then(|| Arc::new((0..cells).map(|i| (i * 7919 % 256) as u8).collect())),
    }
}

#[test]
fn layout_agrees_with_candle() {
    let ours = LayoutNet::bundled().expect("the shipped weights load");
    let theirs = LayoutNet::on(candle(), file(assets::weights::LAYOUT)).expect("the shipped weights load");
    let single = |v: Vec<f64>| -> Vec<f32> { v.into_iter().map(|v| v as f32).collect() };
    for (nodes, map) in [(1, false), (40, true), (77, false)] {
        let mut input = layout_input(nodes, map);
        if nodes == 1 {
            input.nodes[0].shape = NodeGeometry::Box;
            input.nodes[0].locked = false;
            input.edges.clear();
        }
        let a = ours.embed(&input).expect("a sound graph");
        let b = theirs.embed(&input).expect("a sound graph");
        let x: Vec<f64> = numbers(nodes * VALUES, 8).into_iter().map(f64::from).collect();
        for t in [0.0, 437.5, 999.0] {
            let a = single(ours.predict(&a, &x, t).expect("finite"));
            let b = single(theirs.predict(&b, &x, t).expect("finite"));
            agree(&a, &b, &format!("layout of {nodes} nodes at {t}"));
        }
    }
}

#[test]
fn text_agrees_with_candle() {
    let ours = TextEncoder::bundled().expect("the shipped weights load");
    let theirs = TextEncoder::on(candle(), file(assets::weights::TEXT)).expect("the shipped weights load");
    let of = |text: &str| {
        [
            ours.encode(text).expect("a device"),
            theirs.encode(text).expect("a device"),
        ]
    };
    for text in ["night", "two buses wait at a roundabout in the rain, many people"] {
        let [a, b] = of(text);
        agree(&a, &b, text);
    }
    let [a, b] = of("");
    assert!(a == b && a.iter().all(|v| *v == 0.0));
}

/// A frame of three cameras that also hears the frame before, and its pictures.
#[test]
fn pictures_agree() {
    let (vae, dit) = (assets::weights::PICTURES_VAE, assets::weights::PICTURES_DIT);
    let size = RingSize::new(3, [32, 48]).expect("a size");
    let pixels = 3 * 32 * 48;
    let condition = Condition {
        size,
        classes: (0..pixels).map(|i| (i / 7 % 20) as u8).collect(),
        depth_m: (0..pixels).map(|i| (i % 97) as f32 * 0.5).collect(),
        facings: (0..pixels).map(|i| (i / 5 % 17) as u8 | 0x80).collect(),
        time: Some(1),
        weather: None,
        cameras: numbers(21, 7).as_chunks().0.to_vec(),
    };
    let motion = Motion {
        focal_px: [30.0, 30.0],
        center_px: [24.0, 16.0],
        then_from_now: [[1.0, 0.0, 0.0, 0.1], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.5]],
    };
    let x = numbers(3 * 24 * 8, 8);
    let depths = [&condition.depth_m[..]; 2];
    let before = picture::warp(size, &numbers(3 * 24 * 8, 9), depths, &[motion; 3]).expect("finite");

    let (ours, theirs) = (
        PictureDit::new(file(dit)).expect("weights"),
        PictureDit::on(candle(), file(dit)).expect("weights"),
    );
    let (told, told_too) = (
        ours.tell(&condition).expect("a condition"),
        theirs.tell(&condition).expect("a condition"),
    );
    agree(
        &ours.v(&x, 500.0, &told, Some(&before)).expect("finite"),
        &theirs.v(&x, 500.0, &told_too, Some(&before)).expect("finite"),
        "v of pictures",
    );
    let (ours, theirs) = (
        PictureVae::new(file(vae)).expect("weights"),
        PictureVae::on(candle(), file(vae)).expect("weights"),
    );
    let drawn = ours.decode(&x, size.cells()).expect("finite");
    agree(
        &drawn,
        &theirs.decode(&x, size.cells()).expect("finite"),
        "pictures",
    );
    let latents = ours.encode(&drawn, size.pixels()).expect("finite");
    agree(
        &latents,
        &theirs.encode(&drawn, size.pixels()).expect("finite"),
        "latents of pictures",
    );
}

/// An edit from its inversion to the labels that are shown, on candle as on the processor's kernels: nearly every voxel alike.
#[test]
fn an_edit_is_generated_end_to_end_on_candle() {
    let scene = app::open::from_template("straight", 3).expect("a template");
    let mut document = editor::Document::new(scene);
    let id = *document.scene().frame().boxes.keys().next().expect("a box");
    document
        .apply("Remove", &editor::Edit::RemoveBox { id })
        .expect("sound");
    let job = job::Job {
        scene: document.scene().clone(),
        params: job::GenParams {
            steps: 3,
            fine_steps: 1,
            ..job::GenParams::default()
        },
    };
    let generated = |mut pipeline: Box<dyn job::Pipeline>| {
        pipeline.run(&job, &job::JobCtx::detached()).expect("a result")
    };
    let ours = generated(Box::new(job::pipeline::OccPipeline::new(
        OccModels::bundled().expect("weights"),
    )));
    let theirs = generated(Box::new(job::pipeline::OccPipeline::new(Arc::new(
        OccModels::on(candle()).expect("weights"),
    ))));
    let differ = ours.occupancy.count_different(&theirs.occupancy);
    let changed = ours.report.voxels_changed;
    println!("{differ} voxels differ, {changed} were changed");
    assert!(changed > 10 && differ * 50 <= changed, "{differ} of {changed}");
    assert_eq!(ours.report.network_calls, theirs.report.network_calls);
}
