//! `eval lidar`: the learned sweep and the voxel cast against the analytic surfaces of held-out worlds.

use std::time::Instant;

use serde_json::{Value, json};

use super::world::lidar::lidar_rows;
use crate::suite::{Bar, Options, SuiteFigures};
use calibration::MeasurementProgress;
use calibration::held_out::TEST_SEED;
use calibration::machine::peak_rss_mb;
use dataset::world_of;
use metrics::lidar::{bird_map, jsd, mmd};
use metrics::logistic::{Logistic, auc};
use metrics::sweep::{SweepFigures, loss_features};
use nets::lidar::field::{LidarRay, RaySampling};
use nets::lidar::sites::physical;
use nets::lidar::{LearnedRay, LidarNet};
use numeric::quantile::{Sorted, median};
use scene::{Class, SensorRig, VoxelGrid, Window};
use sensors::lidar::learned::{self, Drops};
use sensors::lidar::truth::{self, Echo, TruthRay};
use sensors::raycast::ColumnMasks;
use world::draw::{Draw, hash};
use world::voxelize::{Drive, Vertical, complete, labels};

/// Samples of a ray without the prior (UniScene's first stage).
const UNIFORM: usize = 144;
/// UniScene, table 5: voxel cast over learned, MMD and JSD. The bars are about these ratios.
const MMD_RATIO: f64 = 8.15 / 2.40;
const JSD_RATIO: f64 = 0.149 / 0.108;
/// The longest a sweep may take, s.
const SWEEP_S: f64 = 0.25;

/// Figures of one method over all sweeps.
#[derive(Default)]
struct SweepMethodFigures {
    range_error_m: Vec<f64>,
    agree: [usize; 2], // rays, of those that agree on hit or miss
    maps: Vec<Vec<f64>>,
    wall_s: Vec<f64>,
    points: usize,
}

impl SweepMethodFigures {
    /// Adds a sweep: the range found by each ray, and whether a found echo came back.
    fn add(
        &mut self,
        rays: &[LidarRay],
        truth: &[TruthRay],
        found: &[Option<f64>],
        kept: impl Fn(usize) -> bool,
        wall_s: f64,
    ) {
        self.wall_s.push(wall_s);
        let mut points = Vec::new();
        for (i, (ray, real)) in rays.iter().zip(truth).enumerate() {
            if real.echo == Echo::OwnBody {
                continue;
            }
            let there = surface(ray, real);
            let seen = found[i].filter(|t| in_grid(ray, *t));
            self.agree[0] += 1;
            self.agree[1] += usize::from(there.is_some() == seen.is_some());
            if let (Some(real), Some(t)) = (there, seen) {
                self.range_error_m.push((t - real).abs());
            }
            if let Some(t) = seen.filter(|_| kept(i)) {
                points.push((ray.direction * t).to_array());
            }
        }
        self.points += points.len();
        // `bird_map` takes heights above the sensor and distances in its own frame; a turn about the vertical does not
        // matter.
        self.maps.push(bird_map(points));
    }

    fn report(&self, truth: &SweepMethodFigures) -> anyhow::Result<Value> {
        let error = &self.range_error_m;
        let sorted = Sorted::new(error.iter().copied());
        let mean = error.iter().sum::<f64>() / error.len().max(1) as f64;
        let within =
            |limit: f64| error.iter().filter(|e| **e < limit).count() as f64 / error.len().max(1) as f64;
        Ok(json!({
            "range_error_m": { "p50": sorted.quantile(0.5), "mean": mean, "p95": sorted.quantile(0.95) },
            "within_0.1_m": within(0.1),
            "hit_or_miss_agrees": self.agree[1] as f64 / self.agree[0].max(1) as f64,
            "jsd": jsd(&truth.maps, &self.maps),
            "mmd_1e-4": mmd(&truth.maps, &self.maps)? * 1e4,
            "points_per_sweep": self.points / self.maps.len().max(1),
            "wall_s": median(&self.wall_s),
            "wall_least_s": self.wall_s.iter().copied().fold(f64::INFINITY, f64::min),
        }))
    }
}

/// True if a distance along the ray lies in the grid: outside, there are no labels.
fn in_grid(ray: &LidarRay, t: f64) -> bool {
    let p = ray.origin + ray.direction * t;
    t >= ray.range_m[0] && Window::voxel_at(p).is_some()
}

/// Distance to the true surface, if there is one in the grid.
fn surface(ray: &LidarRay, real: &TruthRay) -> Option<f64> {
    let t = f64::from(real.range_m);
    (real.echo != Echo::Nothing && t > 0.0 && in_grid(ray, t)).then_some(t)
}

/// Echo strengths and losses of the learned sweep against the real ones.
#[derive(Default)]
struct Echoes {
    strength_error: Vec<f64>,
    real_strength: Vec<f64>,
    lost: Vec<f64>,     // predicted share, of echoes that were lost
    returned: Vec<f64>, // of those that came back
    /// Known features of the same echoes, and whether they were lost; sweeps go to the two parts in turn.
    known: [(Vec<Vec<f64>>, Vec<bool>); 2],
    sweeps: usize,
}

impl Echoes {
    fn add(&mut self, rays: &[LidarRay], truth: &[TruthRay], answers: &[LearnedRay]) {
        self.sweeps += 1;
        for ((ray, real), answer) in rays.iter().zip(truth).zip(answers) {
            if real.echo == Echo::OwnBody || surface(ray, real).is_none() || !answer.is_hit() {
                continue;
            }
            let known = &mut self.known[self.sweeps % 2];
            known.0.push(loss_features(real, 0));
            known.1.push(real.echo == Echo::Lost);
            let share = f64::from(answer.drop_probability());
            if real.echo == Echo::Lost {
                self.lost.push(share);
            } else {
                self.returned.push(share);
                let strength = f64::from(real.intensity);
                self.strength_error
                    .push((f64::from(answer.intensity) - strength).abs());
                self.real_strength.push(strength);
            }
        }
    }

    /// Probability that a lost echo has a greater predicted share than one that came back; 0.5 = no information.
    fn drop_auc(&self) -> f64 {
        let scores = [&self.lost[..], &self.returned[..]].concat();
        let lost: Vec<bool> = (0..scores.len()).map(|i| i < self.lost.len()).collect();
        auc(&scores, &lost)
    }

    /// The AUC that true class, range and angle allow: a logistic fit on every other sweep, judged on the rest.
    fn known_auc(&self) -> Option<f64> {
        let [(rows, lost), (test, outcomes)] = &self.known;
        let fit = Logistic::fit(rows, lost)?;
        let scores: Vec<f64> = test.iter().map(|row| fit.probability(row)).collect();
        Some(auc(&scores, outcomes))
    }

    fn report(&self) -> Value {
        let mean = |v: &[f64]| v.iter().sum::<f64>() / v.len().max(1) as f64;
        let middle = median(&self.real_strength);
        let constant: Vec<f64> = self.real_strength.iter().map(|v| (v - middle).abs()).collect();
        let (lost, returned) = (self.lost.len() as f64, self.returned.len() as f64);
        json!({
            "intensity_mean_error": mean(&self.strength_error),
            "intensity_mean_error_of_a_constant": mean(&constant),
            "drop_rate": lost / (lost + returned),
            "drop_rate_predicted": (mean(&self.lost) * lost + mean(&self.returned) * returned) / (lost + returned),
            "drop_auc": self.drop_auc(),
            "drop_auc_of_truth": self.known_auc(),
            "predicted_where_lost": mean(&self.lost),
            "predicted_where_returned": mean(&self.returned),
        })
    }
}

/// All methods on one kind of occupancy.
#[derive(Default)]
struct Suite {
    truth: SweepMethodFigures,
    labelled: SweepMethodFigures,
    lifted: SweepMethodFigures,
    learned: SweepMethodFigures,
    keep_all: SweepMethodFigures,
    uniform: SweepMethodFigures,
    flat: SweepMethodFigures,
    echoes: Echoes,
    field_s: Vec<f64>,
    shoot_s: Vec<f64>,
    samples: [usize; 2],
}

impl Suite {
    fn add(
        &mut self,
        nets: &[&LidarNet; 2],
        grid: &VoxelGrid,
        rays: &[LidarRay],
        truth: &[TruthRay],
        seed: u64,
    ) -> anyhow::Result<()> {
        let real: Vec<Option<f64>> = rays.iter().zip(truth).map(|(r, t)| surface(r, t)).collect();
        self.truth
            .add(rays, truth, &real, |i| truth[i].echo == Echo::Return, 0.0);
        for (method, grid) in [
            (&mut self.labelled, grid.clone()),
            (&mut self.lifted, raised(grid)),
        ] {
            let start = Instant::now();
            let masks = ColumnMasks::from_grid(&grid);
            let cast = |r: &LidarRay| masks.cast(r.origin, r.direction, r.range_m[1]).map(|h| h.range_m);
            let found: Vec<Option<f64>> = rays.iter().map(cast).collect();
            method.add(rays, truth, &found, |_| true, start.elapsed().as_secs_f64());
        }
        let [net, flat] = nets;
        let start = Instant::now();
        let field = net.field(grid)?;
        let field_s = start.elapsed().as_secs_f64();
        let answers = net.shoot(&field, rays, RaySampling::Prior)?;
        let wall_s = start.elapsed().as_secs_f64();
        self.field_s.push(field_s);
        self.shoot_s.push(wall_s - field_s);
        self.samples[0] += rays.len();
        self.samples[1] += answers.iter().map(|a| usize::from(a.met.samples)).sum::<usize>();
        let kept = |answers: &[LearnedRay], i: usize| {
            !Draw::new(hash(seed ^ i as u64), "lost echo").chance(f64::from(answers[i].drop_probability()))
        };
        self.learned
            .add(rays, truth, &ranges(&answers), |i| kept(&answers, i), wall_s);
        self.keep_all
            .add(rays, truth, &ranges(&answers), |_| true, wall_s);
        self.echoes.add(rays, truth, &answers);
        let start = Instant::now();
        let answers = net.shoot(&field, rays, RaySampling::Uniform(UNIFORM))?;
        let wall_s = field_s + start.elapsed().as_secs_f64();
        self.uniform
            .add(rays, truth, &ranges(&answers), |i| kept(&answers, i), wall_s);
        let start = Instant::now();
        let answers = flat.shoot(&flat.field(grid)?, rays, RaySampling::Prior)?;
        let wall_s = start.elapsed().as_secs_f64();
        self.flat
            .add(rays, truth, &ranges(&answers), |i| kept(&answers, i), wall_s);
        Ok(())
    }

    fn report(mut self, kind: &'static str, bars: &mut Vec<Bar>) -> anyhow::Result<Value> {
        let truth = std::mem::take(&mut self.truth);
        let [labelled, lifted, learned] =
            [&mut self.labelled, &mut self.lifted, &mut self.learned].map(|m| m.report(&truth));
        let (labelled, lifted, learned) = (labelled?, lifted?, learned?);
        let ratio = |of: &Value, name: &str| -> f64 {
            let at = |v: &Value| v.pointer(name).and_then(Value::as_f64).unwrap_or(f64::NAN);
            at(of) / at(&learned)
        };
        let names = [
            "/range_error_m/p50",
            "/range_error_m/mean",
            "/range_error_m/p95",
            "/jsd",
            "/mmd_1e-4",
        ];
        let ratios = |of: &Value| -> Value {
            names
                .iter()
                .map(|n| (n[1..].replace('/', "_"), json!(ratio(of, n))))
                .collect()
        };
        if kind == "complete" {
            bars.push((
                "range error p50, lifted voxel cast / learned",
                ratio(&lifted, names[0]),
                2.0,
            ));
            bars.push((
                "range error mean, lifted voxel cast / learned",
                ratio(&lifted, names[1]),
                2.0,
            ));
            bars.push((
                "JSD, lifted voxel cast / learned",
                ratio(&lifted, names[3]),
                JSD_RATIO,
            ));
            bars.push((
                "MMD, lifted voxel cast / learned",
                ratio(&lifted, names[4]),
                MMD_RATIO,
            ));
            bars.push((
                "allowed time / time of a sweep",
                SWEEP_S / median(&self.learned.wall_s),
                1.0,
            ));
        }
        Ok(json!({
            "voxel_cast_as_labelled": labelled,
            "voxel_cast_lifted": lifted,
            "learned": learned,
            "as_labelled_over_learned": ratios(&labelled),
            "lifted_over_learned": ratios(&lifted),
            "echoes": self.echoes.report(),
            "field_s": median(&self.field_s),
            "rays_s": median(&self.shoot_s),
            "samples_per_ray": self.samples[1] as f64 / self.samples[0].max(1) as f64,
            "ablations": {
                "without_unet": self.flat.report(&truth)?,
                "uniform_samples": self.uniform.report(&truth)?,
                "without_drop_head": self.keep_all.report(&truth)?,
            },
        }))
    }
}

fn ranges(answers: &[LearnedRay]) -> Vec<Option<f64>> {
    let range = |a: &LearnedRay| a.is_hit().then_some(f64::from(a.met.median_m));
    answers.iter().map(range).collect()
}

/// The voxels at their physical height: the fairer baseline.
fn raised(grid: &VoxelGrid) -> VoxelGrid {
    let (labels, mut out) = (physical(grid), VoxelGrid::new());
    for (k, label) in labels.iter().enumerate().filter(|(_, l)| **l != Class::FREE) {
        out.set(
            k / (Window::NY * Window::NZ),
            k / Window::NZ % Window::NY,
            k % Window::NZ,
            *label,
        );
    }
    out
}

impl Options {
    /// Judges complete worlds, and labels as a drive through them would give.
    pub(crate) fn lidar(&self, progress: &dyn MeasurementProgress) -> anyhow::Result<SuiteFigures> {
        let net = match &self.weights {
            Some(dir) => LidarNet::from_dir(dir)?,
            None => LidarNet::bundled()?,
        };
        let flat = LidarNet::without_unet()?;
        let pattern = SensorRig::default().lidars[0].clone();
        let rays = learned::rays(&pattern, glam::DVec3::ZERO);
        let mut suites = [("complete", Suite::default()), ("labels", Suite::default())];
        let [mut returned, mut lost, mut nothing] = [0usize; 3];
        let rig = SensorRig::default();
        let (mut product, mut real) = (SweepFigures::default(), SweepFigures::default());
        for i in 0..self.frames {
            progress.at("lidar", i, self.frames);
            let (world, seed) = world_of(TEST_SEED, i as u64, |_| None);
            let truth = truth::sweep(&world, &pattern, seed);
            for real in &truth {
                match real.echo {
                    Echo::Return => returned += 1,
                    Echo::Lost => lost += 1,
                    Echo::Nothing => nothing += 1,
                    Echo::OwnBody => {}
                }
            }
            let grids = [
                complete(&world, Vertical::Occ3d),
                labels(&world, &pattern, &Drive::default(), Vertical::Occ3d, seed),
            ];
            real.add_truth(&truth, &pattern);
            let sweep = learned::rig_sweep(&net, &grids[0], &rig, Drops::Drawn(seed))?;
            product.add_sweep(&sweep, &pattern);
            for ((_, suite), grid) in suites.iter_mut().zip(&grids) {
                suite.add(&[&net, &flat], grid, &rays, &truth, seed)?;
            }
        }
        let (mut report, mut bars) = (json!({}), Vec::new());
        for (kind, suite) in suites {
            report[kind] = suite.report(kind, &mut bars)?;
        }
        let all = (returned + lost + nothing).max(1) as f64;
        let share = |n: usize| n as f64 / all;
        report["truth"] =
            json!({ "returned": share(returned), "lost": share(lost), "nothing": share(nothing) });
        // A logistic fit on class, range, angle and ring: the least that a drop head can learn.
        report["truth"]["lost_auc"] = json!(real.loss_auc());
        report["sweeps"] = lidar_rows(&product)?.0.into();
        report["model"] = net.name().into();
        report["peak_rss_mb"] = json!(peak_rss_mb());
        Ok((report, bars))
    }
}
