//! Figures that characterise LiDAR sweeps: what their slots end on, ranges, echo strengths, lost echoes. The real
//! values are in `assets/statistics/lidar.json`.

use std::collections::BTreeMap;

use super::logistic::{Logistic, auc};
use numeric::quantile::Sorted;
use scene::{Class, LidarPattern, LidarSweep};
use sensors::lidar::truth::{Echo, TruthRay};

/// Number of low rings, which hold most hits on the vehicle's own body, in a pattern with 32.
const LOW_RINGS: usize = 9;
/// Least range from which figures of ranges and strengths count echoes, as the real ones do, m; nearer echoes are of
/// the own vehicle.
const NEAREST_M: f64 = 3.0;
/// Limits of the ranges by which lost echoes are counted, m.
const RANGES_M: [f64; 6] = [3.0, 10.0, 20.0, 30.0, 40.0, 60.0];
/// Stride of the echoes that are samples for the predictor of lost ones; neighbours are alike.
const SAMPLED: usize = 3;

/// One echo for the predictor: its features, and whether it was lost.
type EchoSample = (Vec<f64>, bool);

/// Sums over sweeps.
#[derive(Clone, Debug, Default)]
pub struct SweepFigures {
    slots: usize,
    own: usize,
    own_low: usize,
    low_slots: usize,
    by_ring: [[usize; 3]; 32], // slots, own body, no echo
    ranges_m: Vec<f64>,
    strengths: Vec<f64>,
    strengths_of: BTreeMap<u8, Vec<f64>>,
    lost_of: BTreeMap<u8, [usize; 2]>, // lost, all
    lost_at: [[usize; 2]; RANGES_M.len()],
    halves: [Vec<EchoSample>; 2],
    sweeps: usize,
}

impl SweepFigures {
    /// Adds a simulated sweep, beam-major.
    pub fn add_truth(&mut self, rays: &[TruthRay], pattern: &LidarPattern) {
        let columns = (pattern.columns as usize).max(1);
        for (i, ray) in rays.iter().enumerate() {
            let (ring, range_m) = (i / columns, f64::from(ray.range_m));
            let own = ray.echo == Echo::OwnBody;
            let returned = ray.echo == Echo::Return && range_m >= NEAREST_M;
            self.slot(ring, own && ray.own_body_m > 0.0, returned);
            if returned {
                self.echo(range_m, f64::from(ray.intensity), ray.class);
            }
            if !matches!(ray.echo, Echo::Return | Echo::Lost) || range_m < NEAREST_M {
                continue;
            }
            let lost = ray.echo == Echo::Lost;
            let count = |to: &mut [usize; 2]| {
                to[0] += usize::from(lost);
                to[1] += 1;
            };
            count(self.lost_of.entry(ray.class.id()).or_default());
            if let Some(bin) = RANGES_M.iter().rposition(|from| range_m >= *from) {
                count(&mut self.lost_at[bin]);
            }
            if i % SAMPLED == 0 {
                self.halves[self.sweeps % 2].push((loss_features(ray, ring), lost));
            }
        }
        self.sweeps += 1;
    }

    /// Adds a sweep of the product; points of class "others" nearer than 3 m count as the own vehicle.
    pub fn add_sweep(&mut self, sweep: &LidarSweep, pattern: &LidarPattern) {
        let columns = (pattern.columns_in_sector() as usize).max(1);
        let mut ends = vec![None; sweep.rays];
        for point in &sweep.points {
            let slot = usize::from(point.ring) * columns + usize::from(point.azimuth);
            if let Some(end) = ends.get_mut(slot) {
                *end = Some(point);
            }
        }
        for (i, end) in ends.into_iter().enumerate() {
            let near = |m: f32| f64::from(m) < NEAREST_M;
            let own = end.is_some_and(|p| p.class == Class::Others && near(p.range_m));
            let returned = end.filter(|p| !near(p.range_m));
            self.slot(i / columns, own, returned.is_some());
            if let Some(point) = returned {
                self.echo(f64::from(point.range_m), f64::from(point.intensity), point.class);
            }
        }
        self.sweeps += 1;
    }

    fn slot(&mut self, ring: usize, own: bool, returned: bool) {
        let count = &mut self.by_ring[ring.min(31)];
        count[0] += 1;
        count[1] += usize::from(own);
        count[2] += usize::from(!own && !returned);
        self.slots += 1;
        self.own += usize::from(own);
        if ring < LOW_RINGS {
            self.low_slots += 1;
            self.own_low += usize::from(own);
        }
    }

    fn echo(&mut self, range_m: f64, strength: f64, class: Class) {
        self.ranges_m.push(range_m);
        self.strengths.push(strength);
        self.strengths_of.entry(class.id()).or_default().push(strength);
    }

    /// Share of a ring's slots that end on the own body, and share of those without an echo.
    pub fn ring(&self, ring: usize) -> [f64; 2] {
        let [slots, own, none] = self.by_ring[ring.min(31)];
        [own, none].map(|n| share(n, slots))
    }

    /// Every figure by its name. Units: shares of slots, m, strengths of 255.
    pub fn figures(&self) -> BTreeMap<String, f64> {
        let mut out = BTreeMap::new();
        let mut put = |name: &str, value: f64| {
            if value.is_finite() {
                out.insert(name.to_owned(), value);
            }
        };
        put("own_body.share", share(self.own, self.slots));
        put("own_body.share_of_rings_0_8", share(self.own_low, self.low_slots));
        put(
            "own_body.share_of_rings_9_31",
            share(self.own - self.own_low, self.slots - self.low_slots),
        );
        put("own_body.in_rings_0_8", share(self.own_low, self.own));
        put("return.share", share(self.ranges_m.len(), self.slots));
        let none: usize = self.by_ring.iter().map(|r| r[2]).sum();
        put("no_return.share", share(none, self.slots));
        for (name, rings) in [
            ("no_return.rings_0_8", 0..9),
            ("no_return.rings_9_19", 9..20),
            ("no_return.rings_20_31", 20..32),
        ] {
            let sum = |k: usize| self.by_ring[rings.clone()].iter().map(|r| r[k]).sum::<usize>();
            put(name, share(sum(2), sum(0)));
        }
        let sorted = |values: &[f64]| Sorted::new(values.iter().copied());
        let ranges_m = sorted(&self.ranges_m);
        for (name, q) in [("p50", 0.5), ("p90", 0.9), ("p99", 0.99)] {
            put(&format!("range_m.{name}"), ranges_m.quantile(q));
        }
        let far = self.ranges_m.iter().filter(|m| **m > 40.0).count();
        put("range_m.share_beyond_40", share(far, self.ranges_m.len()));
        let strengths = sorted(&self.strengths);
        for (name, q) in [("p50", 0.5), ("p95", 0.95), ("p99", 0.99)] {
            put(&format!("strength.{name}"), strengths.quantile(q));
        }
        let named = |id: u8| Class::from_id(id).map_or("unknown", Class::name);
        for (id, of) in &self.strengths_of {
            let of = sorted(of);
            put(&format!("strength.{}.p50", named(*id)), of.quantile(0.5));
            put(&format!("strength.{}.p95", named(*id)), of.quantile(0.95));
        }
        for (id, [lost, all]) in &self.lost_of {
            put(&format!("lost.{}", named(*id)), share(*lost, *all));
        }
        for (bin, [lost, all]) in self.lost_at.iter().enumerate() {
            let name = match RANGES_M.get(bin + 1) {
                Some(to) => format!("lost.{}_{to}_m", RANGES_M[bin]),
                None => format!("lost.beyond_{}_m", RANGES_M[bin]),
            };
            put(&name, share(*lost, *all));
        }
        put("lost.auc", self.loss_auc());
        out
    }

    /// Area under the ROC curve of a predictor of lost echoes by class, range, angle and ring: a logistic fit on every
    /// other sweep, judged on the rest. NaN with fewer than two sweeps, or if no echo is lost.
    pub fn loss_auc(&self) -> f64 {
        let [train, test] = self.halves.each_ref().map(|half| {
            let (rows, lost): (Vec<Vec<f64>>, Vec<bool>) = half.iter().cloned().unzip();
            (rows, lost)
        });
        let Some(fit) = Logistic::fit(&train.0, &train.1) else {
            return f64::NAN;
        };
        let scores: Vec<f64> = test.0.iter().map(|row| fit.probability(row)).collect();
        auc(&scores, &test.1)
    }
}

/// Features of a ray that may predict a lost echo: a constant, range, angle, ring, class.
pub fn loss_features(ray: &TruthRay, ring: usize) -> Vec<f64> {
    let (range_m, cosine) = (f64::from(ray.range_m), f64::from(ray.cos_incidence));
    let mut row = vec![
        1.0,
        range_m.max(1.0).ln() - 2.3,
        range_m / 30.0,
        cosine,
        cosine.max(0.02).ln(),
        ring as f64 / 31.0,
    ];
    row.extend((0..Class::FREE).map(|id| f64::from(u8::from(id == ray.class.id()))));
    row
}

fn share(n: usize, of: usize) -> f64 {
    n as f64 / of as f64
}

#[cfg(test)]
mod tests {
    use super::*;
    use scene::{LidarPoint, SensorRig};
    use sensors::lidar::truth::sweep;
    use world::World;

    /// Counted by hand: 4 slots on the own body, 2 echoes, the rest nothing.
    #[test]
    fn slots_are_counted_as_what_they_are() {
        let mut pattern = SensorRig::default().lidars[0].clone();
        (pattern.columns, pattern.elevations_deg) = (2, vec![-30.0, -20.0, 0.0, 5.0, 10.0]);
        let ray = |echo, range_m: f32, own_body_m: f32| TruthRay {
            range_m,
            class: Class::Car,
            intensity: 40,
            cos_incidence: 0.5,
            echo,
            own_body_m,
        };
        let (own, blind) = (ray(Echo::OwnBody, 9.0, 0.7), ray(Echo::OwnBody, 9.0, 0.0));
        let (seen, lost) = (ray(Echo::Return, 50.0, 0.0), ray(Echo::Lost, 12.0, 0.0));
        let (near, none) = (ray(Echo::Return, 2.0, 0.0), ray(Echo::Nothing, 0.0, 0.0));
        let rays = [own, own, own, own, blind, seen, seen, lost, near, none];
        let mut sums = SweepFigures::default();
        sums.add_truth(&rays, &pattern);
        let found = sums.figures();
        assert_eq!((found["own_body.share"], found["return.share"]), (0.4, 0.2));
        assert_eq!((found["no_return.share"], found["lost.car"]), (0.4, 1.0 / 3.0));
        assert_eq!((found["range_m.p50"], found["strength.p99"]), (50.0, 40.0));
        assert_eq!((found["lost.10_20_m"], found["lost.40_60_m"]), (1.0, 0.0));
        assert!(!found.contains_key("lost.auc"), "one sweep is no test set");
        let point = |ring, azimuth, range_m, class| LidarPoint {
            position_in_ego: [0.0; 3],
            range_m,
            ring,
            azimuth,
            class,
            intensity: 5.0,
            drop_probability: 0.0,
            time_s: 0.0,
            velocity_mps: [0.0; 2],
        };
        let mut product = SweepFigures::default();
        let sweep = LidarSweep {
            points: vec![
                point(0, 1, 0.7, Class::Others),
                point(1, 0, 1.4, Class::Car),
                point(4, 1, 30.0, Class::Others),
            ],
            rays: 10,
            physical: true,
            provenance: Vec::new(),
        };
        product.add_sweep(&sweep, &pattern);
        let found = product.figures();
        assert_eq!((found["own_body.share"], found["return.share"]), (0.1, 0.1));
        assert_eq!(product.ring(0), [0.5, 0.5]);
    }

    /// Shares, ranges, echo strengths and losses inside what real sweeps (and their accepted ranges) say.
    #[test]
    fn sweeps_are_like_real_ones() {
        let pattern = &SensorRig::default().lidars[0];
        let mut sums = SweepFigures::default();
        for seed in 40..52 {
            sums.add_truth(&sweep(&World::random(seed), pattern, seed), pattern);
        }
        let found = sums.figures();
        for (name, value) in &found {
            println!("{name} {value:.4}");
        }
        for (name, low, high) in [
            ("own_body.share", 0.10, 0.14),
            ("own_body.in_rings_0_8", 0.95, 1.0),
            ("own_body.share_of_rings_0_8", 0.34, 0.46),
            ("return.share", 0.5, 0.82),
            ("no_return.share", 0.1, 0.33),
            ("no_return.rings_20_31", 0.2, 0.65),
            ("range_m.p50", 5.5, 10.5),
            ("range_m.p90", 25.0, 40.0),
            ("range_m.p99", 49.0, 71.0),
            ("strength.p50", 8.0, 20.0),
            ("strength.p95", 46.0, 75.0),
            ("strength.p99", 78.0, 101.0),
            ("strength.driveable_surface.p50", 5.0, 11.0),
            ("strength.sidewalk.p50", 9.0, 16.0),
            ("strength.manmade.p50", 7.0, 26.0),
            ("strength.vegetation.p50", 12.0, 30.0),
            ("strength.car.p50", 0.0, 9.0),
            ("strength.pedestrian.p50", 8.5, 34.0),
            ("lost.driveable_surface", 0.0, 0.05),
            ("lost.vegetation", 0.03, 0.14),
            ("lost.manmade", 0.015, 0.12),
            ("lost.auc", 0.62, 0.95),
        ] {
            assert!((low..=high).contains(&found[name]), "{name}: {}", found[name]);
        }
    }
}
