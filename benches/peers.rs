//! Our side of `benches/peers/*.py`, which time this program beside others in one run, taking turns. Called with a folder
//! (`cargo bench --bench peers -- FOLDER`, or the binary itself) it writes the inputs and its answers there, as safetensors
//! and JSON, then reads one name of a job per line and answers with the milliseconds that it took. Without a folder it
//! only says so.

use std::io::{BufRead, Write};
use std::path::Path;
use std::time::Instant;

use dataset::occupancy_frame;
use diffusion::schedule::{Betas, Schedule, Spacing};
use diffusion::solver::{Branch, Denoiser, Guidance, Prediction, Sampler, SolverError, SolverKind};
use formats::occ3d;
use glam::DVec3;
use nets::{ColumnHeights, DitCondition, GROUPS, OccModels};
use numeric::philox::{Stream, normal_field};
use rayon::prelude::*;
use safetensors::{Dtype, tensor::TensorView};
use scene::splats::SplatOptions;
use scene::{Class, SensorRig, VoxelGrid, Window};
use sensors::raycast::ColumnMasks;
use sensors::splat;
use sensors::splat::cloud::GaussianCloud;

/// Pictures that are splatted.
const SIZE: [u32; 2] = [240, 135];
/// Steps of the samplers, and numbers of their state.
const STEPS: usize = 20;
const STATE: usize = 200_000;

/// A network that costs next to nothing, so that the loop around it is what is timed: 0.7 x / (1 + |x|) + 0.0005 t.
struct Closed;

impl Denoiser for Closed {
    type Error = SolverError;
    fn predict(&mut self, x: &[f64], t: f64, _: Branch) -> Result<Vec<f64>, SolverError> {
        Ok(x.iter().map(|x| 0.7 * x / (1.0 + x.abs()) + 0.0005 * t).collect())
    }
}

fn sampler(solver: SolverKind) -> Sampler {
    let betas = Betas::Linear {
        first: 1e-4,
        last: 0.02,
    };
    let schedule = Schedule::new(betas, 1000, false).expect("valid");
    Sampler {
        solver,
        levels: schedule.levels(STEPS, Spacing::Trailing).expect("valid"),
        prediction: Prediction::Epsilon,
        guidance: Guidance::NONE,
    }
}

/// Arrays for one safetensors file.
#[derive(Default)]
struct Arrays(Vec<(String, Dtype, Vec<usize>, Vec<u8>)>);

impl Arrays {
    fn f32(&mut self, name: &str, shape: &[usize], values: impl IntoIterator<Item = f32>) {
        let bytes = values.into_iter().flat_map(f32::to_le_bytes).collect();
        self.0.push((name.into(), Dtype::F32, shape.to_vec(), bytes));
    }
    fn f64(&mut self, name: &str, shape: &[usize], values: impl IntoIterator<Item = f64>) {
        let bytes = values.into_iter().flat_map(f64::to_le_bytes).collect();
        self.0.push((name.into(), Dtype::F64, shape.to_vec(), bytes));
    }
    fn i32(&mut self, name: &str, shape: &[usize], values: impl IntoIterator<Item = i32>) {
        let bytes = values.into_iter().flat_map(i32::to_le_bytes).collect();
        self.0.push((name.into(), Dtype::I32, shape.to_vec(), bytes));
    }
    fn u8(&mut self, name: &str, shape: &[usize], values: Vec<u8>) {
        self.0.push((name.into(), Dtype::U8, shape.to_vec(), values));
    }
    fn save(self, path: &Path) {
        let views = self.0.iter().map(|(name, dtype, shape, bytes)| {
            let view = TensorView::new(*dtype, shape.clone(), bytes);
            (name.as_str(), view.expect("as many numbers as the shape says"))
        });
        let bytes = safetensors::serialize(views, None).expect("serializable");
        std::fs::write(path, bytes).expect("a folder that can be written");
    }
}

fn reference_grid() -> VoxelGrid {
    let path = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/tests/reference/raycast/occupancy.npz"
    );
    let file = std::fs::File::open(path).expect("the reference grid");
    let mut zip = zip::ZipArchive::new(file).expect("an npz file");
    let array = zip.by_name("occupancy.npy").expect("an occupancy array");
    let array = npyz::NpyFile::new(array).expect("an npy file");
    let occupied: Vec<u8> = array.into_vec().expect("u8");
    let label = |o: &u8| if *o == 1 { Class::Manmade.id() } else { Class::FREE };
    VoxelGrid::from_dense(&occupied.iter().map(label).collect::<Vec<_>>()).expect("640,000 labels")
}

fn main() {
    let folder = std::env::args().skip(1).find(|a| !a.starts_with('-'));
    let Some(folder) = folder.map(std::path::PathBuf::from) else {
        return println!("peers: our side of benches/peers/*.py, see benches/peers/README.md");
    };
    let models = OccModels::bundled().expect("the shipped weights load");
    let frame = occupancy_frame(3, 0, |_| None);
    let latent = models.vae.encode(&frame.dense).expect("a sound grid");
    let condition = DitCondition {
        bev: frame.bev.clone(),
        heading: frame.heading.clone(),
        named: [None; 4],
        draft_latent: models.vae.encode(&frame.draft).expect("a sound grid"),
        given: vec![[0.0; GROUPS]; 2500],
        columns: vec![ColumnHeights::default(); 40_000],
        ground: false,
        mask: vec![1.0; 2500],
        context: vec![0.0; 20_000],
    };
    let prepared = models.dit.prepare(&condition).expect("a sound condition");
    let masks = ColumnMasks::from_grid(&reference_grid());
    let rays: Vec<DVec3> = (0..32)
        .flat_map(|beam| {
            let el = (-30.67 + 41.34 * f64::from(beam) / 31.0).to_radians();
            (0..1084).map(move |step| {
                let az = std::f64::consts::TAU * f64::from(step) / 1084.0 - std::f64::consts::PI;
                DVec3::new(el.cos() * az.cos(), el.cos() * az.sin(), el.sin())
            })
        })
        .collect();
    let origin = DVec3::new(40.0, 40.0, 2.24) / Window::VOXEL_M;
    let cast = || -> Vec<f32> {
        let mut ranges = vec![0.0f32; rays.len()];
        let pairs = ranges.par_chunks_mut(512).zip(rays.par_chunks(512));
        pairs.for_each(|(out, rays)| {
            for (out, d) in out.iter_mut().zip(rays) {
                let hit = masks.cast_in_voxels(origin, *d, f64::INFINITY);
                *out = hit.map_or(f32::INFINITY, |h| (h.0 * Window::VOXEL_M) as f32);
            }
        });
        ranges
    };
    let cloud = GaussianCloud::from_grid_shell(&frame.dense, &[], 1);
    let rig = SensorRig::default();
    let options = SplatOptions::default();
    let splats = || -> Vec<_> {
        let cameras = rig.cameras.iter();
        cameras
            .map(|c| splat::render_raw(&cloud, c, SIZE[0], SIZE[1], &options))
            .collect()
    };
    let start = normal_field(1, Stream::Start, STATE, 1);
    let sample = |kind| {
        let states = sampler(kind).sample(start.clone(), &mut Closed, |_| Ok(()));
        states.expect("finite").pop().expect("the last state")
    };
    let npz = occ3d::to_bytes(&frame.dense);

    // Inputs and answers, for the other side to begin with and to be compared with.
    let mut out = Arrays::default();
    out.u8("labels", &[200, 200, 16], frame.dense.to_dense());
    out.f32("latent", &[50, 50, 8], latent.iter().copied());
    let decoded = models.vae.decode(&latent).expect("a sound latent");
    out.u8("decoded", &[200, 200, 16], decoded.to_dense());
    out.i32("bev", &[200, 200], condition.bev.iter().map(|b| *b as i32));
    out.u8("heading", &[200, 200], condition.heading.clone());
    out.f32("draft", &[50, 50, 8], condition.draft_latent.iter().copied());
    let v = models.dit.forward(&latent, 500.0, &prepared).expect("finite");
    out.f32("v", &[50, 50, 8], v);
    let occupied = reference_grid()
        .to_dense()
        .iter()
        .map(|v| u8::from(*v != Class::FREE))
        .collect();
    out.u8("occupied", &[200, 200, 16], occupied);
    out.f32(
        "rays",
        &[rays.len(), 3],
        rays.iter().flat_map(|d| d.as_vec3().to_array()),
    );
    out.f32("ranges", &[rays.len()], cast());
    let gaussians = cloud.gaussians();
    out.f32(
        "gaussians",
        &[gaussians.len(), 3],
        gaussians.iter().flat_map(|g| g.position_m),
    );
    out.u8(
        "ids",
        &[gaussians.len()],
        gaussians.iter().map(|g| g.id).collect(),
    );
    let maps = splats();
    let shape = [maps.len(), SIZE[1] as usize, SIZE[0] as usize];
    out.f32(
        "coverage",
        &shape,
        maps.iter().flat_map(|m| m.coverage.iter().copied()),
    );
    out.f32(
        "depth",
        &shape,
        maps.iter().flat_map(|m| m.expected_m.iter().copied()),
    );
    out.i32(
        "label",
        &shape,
        maps.iter().flat_map(|m| m.label.iter().map(|l| i32::from(*l))),
    );
    out.f64("start", &[STATE], start.iter().copied());
    out.f64("ddim", &[STATE], sample(SolverKind::Ddim));
    out.f64("dpmpp", &[STATE], sample(SolverKind::DpmPp2M));
    out.save(&folder.join("ours.safetensors"));
    let rig_json = serde_json::to_string(&rig).expect("plain numbers");
    std::fs::write(folder.join("rig.json"), rig_json).expect("a folder that can be written");
    std::fs::write(folder.join("labels.npz"), &npz).expect("a folder that can be written");

    println!("ready {}", rayon::current_num_threads());
    for line in std::io::stdin().lock().lines().map_while(Result::ok) {
        let begun = Instant::now();
        // What is made is counted, so that nothing is left out as unused.
        let made = match line.trim() {
            "encode" => models.vae.encode(&frame.dense).map_or(0, |v| v.len()),
            "decode" => models.vae.decode(&latent).map_or(0, |g| g.bricks().len()),
            "dit" => models
                .dit
                .forward(&latent, 500.0, &prepared)
                .map_or(0, |v| v.len()),
            "raycast" => cast().len(),
            "masks" => usize::from(ColumnMasks::from_grid(&frame.dense).column(3, 4)) + 1,
            "splats" => splats().len(),
            "ddim" => sample(SolverKind::Ddim).len(),
            "dpmpp" => sample(SolverKind::DpmPp2M).len(),
            "npz" => occ3d::read(&npz).map_or(0, |f| f.labels.bricks().len()),
            other => {
                println!("unknown job {other:?}");
                continue;
            }
        };
        println!("{:.6} {made}", begun.elapsed().as_secs_f64() * 1e3);
        let _ = std::io::stdout().flush();
    }
}
