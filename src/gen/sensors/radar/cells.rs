//! Cells of a radar's measurement: echoes add up in them, and peaks become returns.

use std::collections::HashMap;

use glam::DVec3;

use numeric::splitmix::{hash, scatter};
use scene::{Class, Pose, RadarPattern, RadarReturn};

/// Cross-section of the target that a radar's reach is given for, m².
const REFERENCE_M2: f64 = 10.0;
/// Share of the mean strength that an echo must have where a target is found in one of two scans: the median of the exponential
/// distribution (a target of many scatterers, Swerling's first case).
const MEDIAN: f64 = std::f64::consts::LN_2;
/// Least cross-section that is told, m²: near the sensor its gain is turned down, else every patch of road would be a target.
const LEAST_M2: f64 = 0.01;
/// Strength of such an echo above the noise, dB: usual detectors find it among few false alarms.
const THRESHOLD_DB: f64 = 13.0;

/// A piece of surface that a ray met.
pub struct Patch {
    /// Position in the sensor frame, m.
    pub in_sensor: DVec3,
    /// Distance, m.
    pub range_m: f64,
    /// Speed at which the distance grows, m/s.
    pub speed_mps: f64,
    /// The part of it that is the own vehicle's motion, m/s.
    pub own_mps: f64,
    /// Cross-section, m².
    pub cross_section_m2: f64,
    /// Class of the surface.
    pub class: Class,
}

/// A hash of two words.
pub fn mix(a: u64, b: u64) -> u64 {
    hash(a ^ hash(b))
}

/// Field of view, and bins of range, azimuth, speed and elevation.
type CellKey = [i32; 5];

/// Sum of the echoes in a cell; positions and speeds are weighted by cross-section.
#[derive(Clone, Default)]
struct Cell {
    cross_section_m2: f64,
    direction: DVec3,
    range_m: f64,
    speed_mps: f64,
    own_mps: f64,
    by_class: [f64; Class::COUNT],
}

/// The cells of one scan.
pub struct Cells<'a> {
    radar: &'a RadarPattern,
    cells: HashMap<CellKey, Cell>,
}

impl<'a> Cells<'a> {
    /// No echoes yet.
    pub fn new(radar: &'a RadarPattern) -> Self {
        Self {
            radar,
            cells: HashMap::new(),
        }
    }

    /// Adds the echo of a piece of surface; pieces out of the field of view are left out.
    pub fn add(&mut self, patch: Patch) {
        let radar = self.radar;
        let azimuth_deg = patch.in_sensor.y.atan2(patch.in_sensor.x).to_degrees();
        let Some(field) = radar.field_at(azimuth_deg, patch.range_m) else {
            return;
        };
        let f = &radar.fields[field];
        let bin = |value: f64, step: f64| (value / step).floor() as i32;
        let speed_mps = radar.measured_speed_mps(patch.speed_mps);
        let up_deg = (patch.in_sensor.z / patch.range_m)
            .clamp(-1.0, 1.0)
            .asin()
            .to_degrees();
        let key = [
            field as i32,
            bin(patch.range_m, f.range_step_m),
            bin(azimuth_deg, f.azimuth_step_deg),
            bin(speed_mps, radar.speed_step_mps),
            match radar.elevation_step_deg {
                0.0 => 0,
                step => bin(up_deg, step),
            },
        ];
        let cell = self.cells.entry(key).or_default();
        let weight = patch.cross_section_m2;
        cell.cross_section_m2 += weight;
        cell.direction += patch.in_sensor / patch.range_m * weight;
        cell.range_m += patch.range_m * weight;
        cell.speed_mps += speed_mps * weight;
        cell.own_mps += patch.own_mps * weight;
        cell.by_class[usize::from(patch.class.id())] += weight;
    }

    /// The returns, strongest first: cells no weaker than their neighbours, as far as chance lets them stand out of the noise.
    pub fn returns(&self, world_from_sensor: &Pose, seed: u64) -> Vec<RadarReturn> {
        let mut keys: Vec<&CellKey> = self.cells.keys().collect();
        keys.sort_unstable();
        let seed = self
            .radar
            .name
            .bytes()
            .fold(seed, |seed, byte| mix(seed, byte.into()));
        let peaks = keys.into_iter().filter(|key| self.is_peak(key));
        let mut out: Vec<RadarReturn> = peaks
            .filter_map(|key| {
                let of_cell = key.iter().fold(seed, |seed, part| mix(seed, *part as u32 as u64));
                self.detect(key, world_from_sensor, of_cell)
            })
            .collect();
        out.sort_by(|a, b| b.snr_db.total_cmp(&a.snr_db));
        out.truncate(self.radar.most_returns as usize);
        out
    }

    /// True for a cell that is no weaker than any beside it, in the same field of view.
    fn is_peak(&self, key: &CellKey) -> bool {
        let own = self.cells[key].cross_section_m2;
        let steps = (0..81).map(|i| [i % 3 - 1, i / 3 % 3 - 1, i / 9 % 3 - 1, i / 27 - 1]);
        let stronger = |[range, azimuth, speed, up]: [i32; 4]| {
            let near = [
                key[0],
                key[1] + range,
                key[2] + azimuth,
                key[3] + speed,
                key[4] + up,
            ];
            let other = self.cells.get(&near).map_or(0.0, |cell| cell.cross_section_m2);
            // Of two equal ones the first is the peak.
            other > own || (other == own && near < *key)
        };
        !steps.into_iter().any(stronger)
    }

    fn detect(&self, key: &CellKey, world_from_sensor: &Pose, seed: u64) -> Option<RadarReturn> {
        let (radar, cell) = (self.radar, &self.cells[key]);
        let total = cell.cross_section_m2;
        if total <= 0.0 {
            return None;
        }
        let range_m = cell.range_m / total;
        let draw = |n: u64| scatter(mix(seed, n));
        // Fading: many scatterers of one target add up in chance phases.
        let fading = -(1.0 - draw(0)).max(1e-12).ln();
        let cross_section_m2 = total * fading;
        let strength = cross_section_m2 / REFERENCE_M2 * (radar.car_range_m / range_m).powi(4);
        if strength < MEDIAN || cross_section_m2 < LEAST_M2 || range_m < radar.min_range_m {
            return None;
        }
        let snr_db = THRESHOLD_DB + 10.0 * (strength / MEDIAN).log10();
        // Accuracy of a peak by its strength (Skolnik): a resolution cell over the root of twice the ratio.
        let share = (2.0 * 10f64.powf(snr_db / 10.0)).sqrt().recip();
        let noise = |n: u64| (draw(n) + draw(n + 1) + draw(n + 2) + draw(n + 3) - 2.0) * 3f64.sqrt() * share;
        let f = &radar.fields[key[0] as usize];
        let direction = cell.direction.normalize_or(DVec3::X);
        let range_m = (range_m + noise(1) * f.range_step_m).max(radar.min_range_m);
        let azimuth = direction.y.atan2(direction.x) + noise(5) * f.azimuth_step_deg.to_radians();
        let speed_mps = cell.speed_mps / total + noise(9) * radar.speed_step_mps;
        let elevation = (radar.elevation_step_deg > 0.0)
            .then(|| direction.z.clamp(-1.0, 1.0).asin() + noise(13) * radar.elevation_step_deg.to_radians());
        let (sin_e, cos_e) = elevation.unwrap_or(0.0).sin_cos();
        let (sin_a, cos_a) = azimuth.sin_cos();
        let in_sensor = DVec3::new(cos_e * cos_a, cos_e * sin_a, sin_e) * range_m;
        let most = cell.by_class.iter().enumerate().max_by(|a, b| a.1.total_cmp(b.1));
        Some(RadarReturn {
            position_m: world_from_sensor.apply(in_sensor).as_vec3().to_array(),
            range_m: range_m as f32,
            azimuth_rad: azimuth as f32,
            elevation_rad: elevation.map(|e| e as f32),
            speed_mps: speed_mps as f32,
            speed_over_ground_mps: (speed_mps - cell.own_mps / total) as f32,
            rcs_dbsm: (10.0 * cross_section_m2.log10()) as f32,
            snr_db: snr_db as f32,
            class: most
                .and_then(|(id, _)| Class::from_id(id as u8))
                .unwrap_or(Class::Others),
        })
    }
}
