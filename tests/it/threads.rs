//! The same bits on 1, 2 and 16 threads, for every job that spreads its work: what the rows of the extremes table promise
//! they promise on any machine.

use std::sync::Arc;

use dataset::occupancy_frame;
use diffusion::solver::SolverKind;
use editor::{Document, Edit};
use graph_layout::diffuse::place_with;
use job::pipeline::OccPipeline;
use job::refine::decode_refined;
use job::region::Region;
use job::{GenParams, Job, JobCtx, Pipeline, RegionMode};
use nets::layout::net::LayoutNet;
use nets::lidar::LidarNet;
use nets::{DecoderInput, OccModels, fine_vae};
use nn::Precision;
use numeric::hash::Fnv1a;
use place::to_graph::to_graph;
use scene::{Class, Conditions, Frame, Scene, SensorRig, TimeOfDay, Weather};
use sensors::lidar::learned::{Drops, rig_sweep};
use sensors::pictures::appearance::{Appearance, Quality};
use sensors::pictures::march::{MarchOptions, MarchScene};
use sensors::splat::cloud::GaussianCloud;
use sensors::{lidar, splat};
use words::describe::described;
use world::voxelize::{Vertical, complete};
use world::{World, template, traffic};

const THREADS: [usize; 3] = [1, 2, 16];

/// Names results.
#[derive(Clone, Copy)]
struct Hash(Fnv1a);

impl Hash {
    fn new() -> Self {
        Self(Fnv1a::new())
    }
    fn bytes(self, bytes: impl IntoIterator<Item = u8>) -> Self {
        Self(self.0.with(bytes))
    }
    fn f32s<'a>(self, values: impl IntoIterator<Item = &'a f32>) -> Self {
        self.bytes(values.into_iter().flat_map(|v| v.to_bits().to_le_bytes()))
    }
    fn f64s(self, values: impl IntoIterator<Item = f64>) -> Self {
        self.bytes(values.into_iter().flat_map(|v| v.to_bits().to_le_bytes()))
    }
}

/// Runs a job in pools of each size; its hash must be one and the same.
fn same_bits(what: &str, job: impl Fn() -> Hash + Sync) {
    let hashes = THREADS.map(|threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
        pool.expect("a pool").install(|| job().0.get())
    });
    println!("{what}: {:016x}", hashes[0]);
    assert_ne!(hashes[0], Hash::new().0.get(), "{what}: nothing was hashed");
    assert!(
        hashes.iter().all(|h| *h == hashes[0]),
        "{what}: {hashes:x?} on {THREADS:?} threads"
    );
}

fn scene() -> Scene {
    let layout = template::layout("intersection", 4).expect("a template");
    let boxes = traffic::place(&layout, 4, &traffic::TrafficSpec::NORMAL);
    let world = World::new(layout, boxes, 4);
    let grid = complete(&world, Vertical::Occ3d);
    let frame = Frame::new(world.layout.clone(), world.boxes.clone(), grid);
    Scene::single("test", frame, Arc::new(SensorRig::default()), 4)
}

#[test]
fn edit_by_inversion() {
    let (auto, full) = (RegionMode::Auto, RegionMode::Full);
    let (ddim, dpmpp) = (SolverKind::Ddim, SolverKind::DpmPp2M);
    for (solver, guidance, region, precision) in [
        (ddim, 1.0, auto, Precision::F32),
        (ddim, 1.0, auto, Precision::Int8),
        (dpmpp, 2.0, full, Precision::F32),
    ] {
        same_bits("edit", || {
            let mut document = Document::new(scene());
            let boxes = &document.scene().frame().boxes;
            let car = boxes.iter().find(|(_, b)| b.class == Class::Car);
            let id = *car.expect("a car").0;
            document.apply("Remove", &Edit::RemoveBox { id }).expect("there");
            let params = GenParams {
                steps: 3,
                solver,
                guidance,
                region,
                precision,
                keep_objects: region == auto,
                strength: 0.5,
                ..GenParams::default()
            };
            let job = Job {
                scene: document.scene().clone(),
                params,
            };
            let mut pipeline = OccPipeline::new(OccModels::bundled().expect("the shipped weights"));
            let result = pipeline.run(&job, &JobCtx::detached()).expect("a result");
            Hash::new().bytes(result.occupancy.to_dense()).f64s(
                [result.report.noise_std, result.report.noise_max_abs]
                    .into_iter()
                    .flatten(),
            )
        });
    }
}

#[test]
fn vae() {
    let models = OccModels::bundled().expect("the shipped weights");
    let (fine, grid) = (
        fine_vae().expect("the shipped weights"),
        occupancy_frame(3, 0, |_| None).dense,
    );
    for (what, vae) in [("vae", &models.vae), ("fine vae", &fine)] {
        same_bits(what, || {
            let latent = vae.encode(&grid).expect("labels");
            let labels = vae.decode(&latent).expect("a finite latent");
            Hash::new().f32s(&latent).bytes(labels.to_dense())
        });
    }
}

#[test]
fn refined() {
    let models = OccModels::bundled().expect("the shipped weights");
    let latent = models.vae.encode(&occupancy_frame(3, 0, |_| None).dense);
    let (latent, all) = (latent.expect("labels"), Region::full().latent_cells);
    same_bits("refined", || {
        let grid = decode_refined(&models, &latent, &all, DecoderInput::default(), (2, 5));
        Hash::new().bytes(grid.expect("a finite latent").to_dense())
    });
}

#[test]
fn worlds() {
    same_bits("world", || {
        Hash::new().bytes(complete(&World::random(7), Vertical::Occ3d).to_dense())
    });
}

#[test]
fn exact_sweep() {
    let scene = scene();
    same_bits("sweep", || {
        let sweep = lidar::rig_sweep(&scene.frame().occupancy, &scene.rig).expect("a LiDAR");
        let numbers = sweep.points.iter().flat_map(|p| &p.position_in_ego);
        Hash::new()
            .f32s(numbers)
            .f32s(sweep.points.iter().map(|p| &p.range_m))
    });
}

#[test]
fn learned_sweep() {
    let (scene, net) = (scene(), LidarNet::bundled().expect("the shipped weights"));
    same_bits("learned sweep", || {
        let sweep = rig_sweep(&net, &scene.frame().occupancy, &scene.rig, Drops::Drawn(3)).expect("finite");
        let points = || sweep.points.iter();
        Hash::new()
            .f32s(points().flat_map(|p| &p.position_in_ego))
            .f32s(points().map(|p| &p.intensity))
            .f32s(points().map(|p| &p.drop_probability))
    });
}

#[test]
fn splats_and_shapes() {
    let scene = scene();
    let frame = scene.frame();
    let cloud = GaussianCloud::from_grid(&frame.occupancy, &frame.bev_channels());
    same_bits("splats", || {
        let maps = splat::render_rig(&cloud, &scene.rig, 160, 90, &Default::default());
        maps.iter().fold(Hash::new(), |h, m| {
            h.bytes(m.semantic.iter().copied())
                .f32s(&m.depth_m)
                .f32s(&m.coverage)
        })
    });
    let march = MarchScene::new(
        &frame.occupancy,
        &frame.layout,
        &frame.boxes,
        &MarchOptions::default(),
    );
    same_bits("shapes", || {
        let maps = march.render_rig(&scene.rig, 160, 90);
        maps.iter().fold(Hash::new(), |h, m| {
            h.bytes(m.semantic.iter().copied()).f32s(&m.depth_m)
        })
    });
}

#[test]
fn layout_diffusion() {
    let net = LayoutNet::bundled().expect("the shipped weights");
    let description = described(
        "add 1 bus ( ahead ego ) and 5 moving car ( near the bus ) and 3 cone ( right ego ) and 2 person",
    );
    let graph = to_graph(&description.expect("valid"), 1).graph;
    let layout = template::layout("intersection", 4).expect("a template");
    same_bits("layout diffusion", || {
        let (boxes, _) =
            place_with(&net, &graph, &std::collections::BTreeMap::new(), &layout, 5, 9).expect("placed");
        assert!(boxes.len() > 5);
        boxes.iter().fold(Hash::new(), |h, b| {
            h.f64s(b.center_m.to_array())
                .f64s(b.size_m.to_array())
                .f64s([b.yaw_rad])
        })
    });
}

#[test]
fn pictures() {
    let mut scene = scene();
    let mut rig = SensorRig::clone(&scene.rig);
    rig.cameras.truncate(2);
    scene.rig = Arc::new(rig);
    for (time, weather) in [
        (TimeOfDay::Day, Weather::Clear),
        (TimeOfDay::Night, Weather::Rain),
    ] {
        same_bits("picture", || {
            let conditions = Conditions::usual(time, weather, 3);
            let appearance = Appearance::new(scene.frame(), &scene.rig, &conditions);
            let cameras = scene.rig.cameras.iter();
            let pictures = cameras.map(|c| appearance.render(c, 96, 54, Quality::Full));
            pictures.fold(Hash::new(), |h, p| h.bytes(p.rgba))
        });
    }
}
