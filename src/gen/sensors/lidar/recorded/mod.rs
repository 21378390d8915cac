//! A recorded sweep under edits: which of its returns go, and what their rays meet instead. All other returns stay as they are.
//!
//! - Returns of an object whose box was removed or moved go, those of voxels that were painted free too, and those hidden by
//!   what is new.
//! - A ray that is free again goes on to the measured **ground** (`ground.rs`), or to an upright **surface** that is seen above
//!   the object (`surfaces.rs`); voxels of 0.4 m tell too little. So do rays between these from which nothing came back before
//!   (`beams.rs`).
//! - Rays that meet what is **new** end on its solids.
//! - What generation changed beside an edit changes no return.

mod added;
mod beams;
mod changes;
mod ground;
mod others;
mod own_returns;
mod surfaces;
#[cfg(test)]
mod tests;
pub mod trial;

use std::collections::{BTreeMap, HashSet};
use std::f64::consts::TAU;
use std::sync::Arc;

use glam::{DVec2, DVec3};
use numeric::splitmix::{hash, scatter};
use rayon::prelude::*;
use scene::{
    Class, LidarPattern, LidarPoint, LidarSweep, Pose, Provenance, RecordedReturn, Scene, SceneBox,
    SensorRig, SweepEdits, SweepRecording, SyntheticReturn,
};

use crate::lidar::rolling;
use added::{NewSolids, entered, is_in_windows, window};
use beams::{Beams, BesideRay};
use changes::{BESIDE_M, LOWEST_M, SceneChanges};
use ground::GroundMap;
use others::{OtherReturns, Told};
use surfaces::StandingReturns;

/// Range up to which rays are cast, m.
const FARTHEST_M: f64 = 120.0;
/// Nearest return, m.
const NEAREST_M: f64 = 0.5;
/// Distance in front of a return within which something new does not hide it, m.
const BEFORE_M: f64 = 0.05;
/// Standard deviation of ranges, m.
const NOISE_M: f64 = 0.02;
/// Height above the ground from which returns stand on it, m.
const STANDING_M: f64 = 0.3;
/// Other sweeps that tell of what an edit opens, at most.
const MOST_OTHERS: usize = 12;
/// Rays that one thread works on in a row.
const RAYS: usize = 2048;

/// The recording of a scene that is nearest in time to the moment shown, if the vehicle moves as it was recorded and its first
/// LiDAR is the one that recorded it.
pub fn recording_of(scene: &Scene) -> Option<&Arc<SweepRecording>> {
    let off_s = |sweep: &&Arc<SweepRecording>| (sweep.time_s - scene.time_s()).abs();
    let sweeps = scene.kept.sweeps.iter();
    let nearest = sweeps.min_by(|a, b| off_s(a).total_cmp(&off_s(b)))?;
    let before = &nearest.before;
    let is_there = scene.clip().ego == before.clip().ego
        && scene.canvas().world_from_ego == before.canvas().world_from_ego;
    let beams = |rig: &SensorRig| {
        let rig = rig.standing_at(&Pose::IDENTITY);
        let lidar = rig.lidars.first()?;
        let place_mm = (DVec3::from_array(lidar.translation_m) * 1e3).round();
        Some((lidar.elevations_deg.clone(), lidar.columns, place_mm.to_array()))
    };
    (is_there && beams(&scene.rig) == beams(&before.rig)).then_some(nearest)
}

fn sweep_at(scene: &Scene) -> Option<EditableSweep> {
    let recording = recording_of(scene)?.clone();
    Some(EditableSweep::new(recording, &scene.kept.sweeps))
}

/// The changes that edits of a scene make to its recorded sweep of the moment shown; `None` if it has none.
pub fn edits_of(scene: &Scene) -> Option<SweepEdits> {
    Some(sweep_at(scene)?.edits(scene))
}

/// The recorded sweep of a scene after its edits, in the world frame; `None` if it has none.
pub fn sweep_of(scene: &Scene) -> Option<LidarSweep> {
    let sweep = sweep_at(scene)?;
    Some(sweep.sweep(&sweep.edits(scene), scene))
}

/// The recorded sweep of a scene after its edits; the exact one ([`rolling::exact`]) of a scene that has none.
pub fn sweep_or_exact(scene: &Scene) -> LidarSweep {
    sweep_of(scene).unwrap_or_else(|| rolling::exact(scene))
}

/// A recorded sweep, with what its returns tell of the ground and of surfaces.
#[derive(Debug)]
pub struct EditableSweep {
    recording: Arc<SweepRecording>,
    /// Other sweeps of the drive, the nearest in time first.
    others: Vec<Arc<SweepRecording>>,
    ground: GroundMap,
    standing: StandingReturns,
    beams: Beams,
    /// Strengths of returns by class, rising, and the median of all.
    strengths: BTreeMap<Class, Vec<f32>>,
    strength: f32,
    /// Height of each return above the ground, m; NaN where it is not known.
    heights_m: Vec<f32>,
}

/// End of a ray.
struct RayEnd {
    t_m: f64,
    class: Class,
    strength: f32,
    provenance: Provenance,
}

impl EditableSweep {
    /// Looks at a recording; this is needed once, however often its scene is edited. `all` are the sweeps of the drive.
    pub fn new(recording: Arc<SweepRecording>, all: &[Arc<SweepRecording>]) -> Self {
        let before = recording.before.at(recording.time_s);
        let mut others: Vec<_> = all
            .iter()
            .filter(|other| !Arc::ptr_eq(other, &recording))
            .collect();
        others.sort_by(|a, b| {
            let off_s = |sweep: &SweepRecording| (sweep.time_s - recording.time_s).abs();
            off_s(a).total_cmp(&off_s(b))
        });
        let others: Vec<_> = others.into_iter().take(MOST_OTHERS).cloned().collect();
        let boxes: Vec<SceneBox> = before.frame().boxes.values().copied().collect();
        let sensor = recording.sensor_m;
        let returns = || {
            recording
                .returns
                .iter()
                .zip(0u32..)
                .filter_map(|(r, i)| Some(((*r)?, i)))
        };
        let near = |r: &RecordedReturn| r.place().distance_squared(sensor) > 1.0;
        let in_a_box = |p: DVec3| {
            let over = |b: &SceneBox| {
                let at = b.to_local(p.with_z(b.center_m.z));
                (at.truncate().abs() - b.size_m.truncate() / 2.0 - DVec2::splat(BESIDE_M)).max_element() < 0.0
            };
            boxes.iter().any(over)
        };
        let on_ground = returns()
            .filter(|(r, _)| near(r) && !in_a_box(r.place()))
            .map(|(r, _)| (r.place(), r.strength));
        let ground = GroundMap::new(sensor.truncate(), on_ground);
        let height = |r: &Option<RecordedReturn>| {
            r.and_then(|r| Some(r.place().z - ground.height_m(r.place().truncate())?))
                .map_or(f32::NAN, |height_m| height_m as f32)
        };
        let heights_m: Vec<f32> = recording.returns.par_iter().map(height).collect();
        let standing = returns()
            .map(|(r, i)| (i, r.place(), f64::from(heights_m[i as usize]), r.strength))
            .filter(|(_, at, height_m, _)| *height_m > STANDING_M && at.distance_squared(sensor) > 1.0);
        let standing = StandingReturns::new(sensor, standing);
        let mut by_class: BTreeMap<Class, Vec<f32>> = BTreeMap::new();
        for (r, _) in returns().filter(|(r, _)| r.strength.is_finite()) {
            by_class
                .entry(class_of(&before, &r))
                .or_default()
                .push(r.strength);
        }
        by_class.values_mut().for_each(|s| s.sort_by(f32::total_cmp));
        let mut all: Vec<f32> = by_class.values().flatten().copied().collect();
        Self {
            others,
            beams: Beams::new(&recording),
            strength: median(&mut all),
            strengths: by_class,
            recording,
            ground,
            standing,
            heights_m,
        }
    }

    /// The recording.
    pub fn recording(&self) -> &Arc<SweepRecording> {
        &self.recording
    }

    /// The pattern of the sensor, with what the sweep does not tell from another one; `None` if its beams cannot be told.
    pub fn pattern(&self, like: &LidarPattern) -> Option<LidarPattern> {
        self.beams.pattern(&self.recording, like)
    }

    /// The changes that edits of its scene make to it: at its moment of a drive, else at the moment that is shown. They do not
    /// depend on the number of threads.
    pub fn edits(&self, scene: &Scene) -> SweepEdits {
        let before = self.recording.before.at(self.recording.time_s);
        let scene = &match self.others.is_empty() {
            true => scene.clone(),
            false => scene.at(self.recording.time_s),
        };
        let changes = SceneChanges::between(&before, scene, &self.ground);
        if changes.is_empty() {
            return SweepEdits::default();
        }
        let gone = self.gone(&changes);
        let uncertain = self.uncertain(&gone, &changes.gone);
        let new = NewSolids::new(&changes, self.recording.sensor_m, scene.seed);
        let others = self.told_by_others(&changes.gone);
        let returns = self.recording.returns.par_iter().enumerate().with_min_len(RAYS);
        let changed = returns.filter_map(|(i, r)| {
            let way = (*r)?.place() - self.recording.sensor_m;
            let range_m = way.length();
            let direction = way.try_normalize()?;
            let end = match gone[i] {
                true => {
                    let beside = self.beams.beside(i as u32, |record| !uncertain[record as usize]);
                    self.end(
                        direction,
                        range_m - STANDING_M,
                        (&new, &others),
                        &uncertain,
                        beside,
                    )
                }
                false => Some(new.met_by(self.recording.sensor_m, direction, range_m - BEFORE_M)?)
                    .map(|(t_m, class)| self.added(t_m, class)),
            };
            Some((
                i as u32,
                end.map(|end| self.synthetic(&end, direction, (i as u32, None), i as u64)),
            ))
        });
        let changed: BTreeMap<u32, Option<SyntheticReturn>> = changed.collect();
        let empty = self.beams.empty.par_iter().enumerate().with_min_len(RAYS);
        let added = empty.filter_map(|(i, ray)| {
            let opened = changes
                .gone
                .iter()
                .filter_map(|b| entered(b, self.recording.sensor_m, ray.direction))
                .min_by(f64::total_cmp);
            let end = match opened {
                Some(from_m) => {
                    let beside = self.beams.beside_empty(ray, |record| !uncertain[record as usize]);
                    self.end(ray.direction, from_m, (&new, &others), &uncertain, beside)?
                }
                None => {
                    let (t_m, class) = new.met_by(self.recording.sensor_m, ray.direction, FARTHEST_M)?;
                    self.added(t_m, class)
                }
            };
            let number = (i + self.heights_m.len()) as u64;
            let is_empty = |slot: &u32| matches!(self.recording.returns.get(*slot as usize), Some(None));
            let slot = ray.slot.filter(is_empty);
            Some(self.synthetic(&end, ray.direction, (ray.like, slot), number))
        });
        SweepEdits {
            changed,
            added: added.collect(),
        }
    }

    /// The sweep after edits, as the sensors of the program give one: in the world frame, each return with its class. Strengths
    /// are told from 0 to 255.
    pub fn sweep(&self, edits: &SweepEdits, scene: &Scene) -> LidarSweep {
        let strongest = match self.strongest() {
            most if most <= 1.0 => 255.0,
            most if most > 255.0 => 255.0 / most,
            _ => 1.0,
        };
        let sensor = self.recording.sensor_m;
        let file_from_world = self.recording.world_from_file.inverse().rotation;
        let lidar = scene.rig.lidars.first();
        let columns = lidar.map_or(1, |lidar| lidar.columns.max(1));
        let first_rad = lidar.map_or(0.0, |lidar| lidar.first_azimuth_deg.to_radians());
        let point = |at: DVec3, strength: f32, record: u32, class: Class| {
            let way = file_from_world * (at - sensor);
            let turn = (way.y.atan2(way.x) - first_rad).rem_euclid(TAU) / TAU;
            let up_rad = way.z.atan2(way.truncate().length());
            LidarPoint {
                position_in_ego: at.as_vec3().to_array(),
                range_m: (at - sensor).length() as f32,
                ring: self.beams.ring(record, up_rad).unwrap_or_default(),
                azimuth: ((turn * f64::from(columns)) as u32).min(columns - 1) as u16,
                class,
                intensity: match strength.is_finite() {
                    true => (strength * strongest).clamp(0.0, 255.0),
                    false => 0.0,
                },
                drop_probability: 0.0,
                time_s: 0.0,
                velocity_mps: [0.0; 2],
            }
        };
        let synthetic = |s: &SyntheticReturn| point(s.at_m, s.strength, s.like, s.class);
        let recorded = self
            .recording
            .returns
            .par_iter()
            .enumerate()
            .filter_map(|(i, r)| match edits.changed.get(&(i as u32)) {
                Some(instead) => instead.as_ref().map(|new| (synthetic(new), new.provenance)),
                None => {
                    let of_file = r.map(|r| point(r.place(), r.strength, i as u32, class_of(scene, &r)));
                    of_file.map(|point| (point, Provenance::Recorded))
                }
            });
        let (mut points, mut provenance): (Vec<LidarPoint>, Vec<Provenance>) = recorded.unzip();
        points.extend(edits.added.iter().map(synthetic));
        provenance.extend(edits.added.iter().map(|new| new.provenance));
        LidarSweep {
            points,
            rays: self.recording.returns.len() + self.beams.empty.len(),
            physical: true,
            provenance,
        }
    }

    /// Largest strength, but for the strongest hundredth.
    fn strongest(&self) -> f32 {
        let returns = self.recording.returns.iter().flatten();
        let mut known: Vec<f32> = returns.map(|r| r.strength).filter(|s| s.is_finite()).collect();
        known.sort_by(f32::total_cmp);
        known.get(known.len() * 99 / 100).copied().unwrap_or(1.0)
    }

    /// Records whose returns are in a box, but for those on the ground below it.
    fn held(&self, b: &SceneBox, beside_m: f64) -> impl Iterator<Item = usize> {
        let bottom_m = b.center_m.z - b.size_m.z / 2.0;
        let (reach, middle, b) = (
            b.size_m.truncate().length() / 2.0 + beside_m,
            b.center_m.truncate(),
            *b,
        );
        let returns = self.recording.returns.iter().enumerate();
        returns.filter_map(move |(i, r)| {
            let at = (*r)?.place();
            let is_near = at.truncate().distance_squared(middle) <= reach * reach;
            let on_ground = f64::from(self.heights_m[i]) <= LOWEST_M;
            let is_above = at.z > bottom_m + LOWEST_M && !on_ground;
            (is_near && is_above && b.contains(at, beside_m)).then_some(i)
        })
    }

    /// Records whose returns are not there any more, one flag each.
    fn gone(&self, changes: &SceneChanges) -> Vec<bool> {
        let mut gone = vec![false; self.recording.returns.len()];
        for b in &changes.gone {
            let of_others = |p: DVec3| changes.kept.iter().any(|other| other.contains(p, 0.0));
            let placed = |i: usize| self.recording.returns[i].map(|r| (i, r.place()));
            let inside: Vec<(usize, DVec3)> = self.held(b, BESIDE_M).filter_map(placed).collect();
            let mut own = inside.clone();
            own.retain(|(_, p)| !of_others(*p));
            let is_inside: HashSet<usize> = inside.iter().map(|(i, _)| *i).collect();
            let top_m = b.center_m.z + b.size_m.z / 2.0 + own_returns::ABOVE_M;
            let near = self
                .held(b, own_returns::AROUND_M)
                .filter(|i| !is_inside.contains(i));
            let near = near
                .filter_map(placed)
                .filter(|(_, p)| p.z <= top_m && !of_others(*p));
            let beyond = own_returns::beyond_box(b, self.recording.sensor_m, &own, &near.collect::<Vec<_>>());
            let all = own.iter().map(|(i, _)| *i).chain(beyond);
            all.for_each(|i| gone[i] = true);
        }
        if !changes.freed.is_empty() {
            for (i, r) in self.recording.returns.iter().enumerate() {
                let voxel = r.and_then(|r| changes.extent.voxel_at(r.place()));
                gone[i] |= voxel.is_some_and(|voxel| changes.freed.contains(&voxel));
            }
        }
        gone
    }

    /// Records that tell nothing of what is around objects that are gone: those that are gone too, and what lies low in their
    /// place, one flag each.
    fn uncertain(&self, gone: &[bool], boxes: &[SceneBox]) -> Vec<bool> {
        let in_place = |(i, r): (usize, &Option<RecordedReturn>)| {
            let at = r.map(|r| r.place());
            gone[i] || at.is_some_and(|at| boxes.iter().any(|b| b.contains(at, BESIDE_M)))
        };
        let returns = self.recording.returns.par_iter().enumerate();
        returns.with_min_len(RAYS).map(in_place).collect()
    }

    /// End of a ray beyond a distance, where something was taken away. `beside` are the returns that stay on both sides of
    /// it on its beam.
    fn end(
        &self,
        direction: DVec3,
        from_m: f64,
        (new, others): (&NewSolids, &OtherReturns),
        uncertain: &[bool],
        beside: [Option<BesideRay>; 2],
    ) -> Option<RayEnd> {
        let sensor = self.recording.sensor_m;
        let there = |record: u32| !uncertain[record as usize];
        let added = new.met_by(sensor, direction, FARTHEST_M);
        let told = others.told(direction, from_m);
        // The beam's own error of height, and relief finer than the map, go on between its returns.
        let above_m = match told {
            Some(Told::Ground(above_m)) => above_m,
            _ => self.ground_offset_m(beside),
        };
        let from = sensor - DVec3::Z * above_m;
        let ground = self.ground.met_by(from, direction, FARTHEST_M).map(|t_m| {
            let at = sensor + direction * t_m;
            RayEnd {
                t_m,
                class: self.ground_class(at),
                strength: self.ground.strength(at.truncate()).unwrap_or(self.strength),
                provenance: match told {
                    Some(Told::Ground(_)) => Provenance::OtherSweep,
                    _ => Provenance::Ground,
                },
            }
        });
        let seen = match told {
            Some(Told::Standing(t_m, strength)) => Some(RayEnd {
                t_m,
                class: self.class_at(sensor + direction * t_m),
                strength,
                provenance: Provenance::OtherSweep,
            }),
            _ => None,
        };
        // What was seen need not be guessed.
        let standing = told.is_none().then_some(&self.standing);
        let surface = standing
            .and_then(|standing| standing.met_by(direction, from_m, there))
            .map(|hit| {
                let like = self.recording.returns[hit.record as usize];
                RayEnd {
                    t_m: hit.t_m,
                    class: like.map_or(Class::Others, |r| class_of(&self.recording.before, &r)),
                    strength: hit.strength,
                    provenance: Provenance::Continued,
                }
            });
        let added = added.map(|(t_m, class)| self.added(t_m, class));
        let ends = [added, ground, seen, surface].into_iter().flatten();
        ends.min_by(|a, b| a.t_m.total_cmp(&b.t_m))
            .filter(|end| end.t_m >= NEAREST_M)
    }

    /// Returns of the other sweeps where objects are gone.
    fn told_by_others(&self, gone: &[SceneBox]) -> OtherReturns {
        let sensor = self.recording.sensor_m;
        let windows: Vec<[f64; 2]> = gone
            .iter()
            .map(|b| {
                window(
                    b.center_m.truncate(),
                    b.size_m.truncate().length() / 2.0 + 1.0,
                    sensor,
                )
            })
            .collect();
        let moving = |other: &SweepRecording| -> Vec<SceneBox> {
            let then = other.before.at(other.time_s);
            let is_meant =
                |b: &&SceneBox| gone.iter().any(|g| g.id == b.id) || then.clip().tracks.contains_key(&b.id);
            let boxes = then.frame().boxes.values().filter(is_meant).copied();
            boxes.chain(gone.iter().copied()).collect()
        };
        OtherReturns::new(sensor, &self.others, &windows, moving, &self.ground)
    }

    /// Class of what stands at a place of the scene before any edit.
    fn class_at(&self, at: DVec3) -> Class {
        let r = RecordedReturn {
            at_m: at.as_vec3().to_array(),
            strength: f32::NAN,
            ring: RecordedReturn::NO_RING,
        };
        class_of(&self.recording.before, &r)
    }

    /// Height of the ground above the map's, as returns of a beam on both sides of a ray have it, m.
    fn ground_offset_m(&self, beside: [Option<BesideRay>; 2]) -> f64 {
        let on_ground = |b: BesideRay| {
            let above_m = f64::from(self.heights_m[b.record as usize]);
            (above_m.abs() < STANDING_M).then_some((above_m, b.apart_rad))
        };
        match beside.map(|b| b.and_then(on_ground)) {
            [Some((a_m, a)), Some((b_m, b))] if a + b > 0.0 => (a_m * b + b_m * a) / (a + b),
            [Some((m, _)), _] | [None, Some((m, _))] => m,
            [None, None] => 0.0,
        }
    }

    fn ground_class(&self, at: DVec3) -> Class {
        let frame = self.recording.before.frame();
        let column = frame.extent().column_at(at.x, at.y);
        let labels = column.map(|[x, y]| frame.occupancy.column(x, y));
        let ground = labels.and_then(|labels| {
            let classes = labels.iter().filter_map(|label| Class::from_id(*label));
            classes.into_iter().find(|class| class.is_ground())
        });
        ground.unwrap_or(Class::DriveableSurface)
    }

    fn added(&self, t_m: f64, class: Class) -> RayEnd {
        RayEnd {
            t_m,
            class,
            strength: self.strength,
            provenance: Provenance::Added,
        }
    }

    fn synthetic(
        &self,
        end: &RayEnd,
        direction: DVec3,
        (like, slot): (u32, Option<u32>),
        number: u64,
    ) -> SyntheticReturn {
        // The sum of three even draws is nearly normal.
        let draw = |k: u64| scatter(hash(number * 4 + k)) - 0.5;
        // What is new is as strong as some return of its class.
        let alike = self
            .strengths
            .get(&end.class)
            .filter(|_| end.provenance == Provenance::Added);
        let drawn = alike.and_then(|all| all.get(((draw(3) + 0.5) * all.len() as f64) as usize));
        let noise_m = (draw(0) + draw(1) + draw(2)) * 2.0 * NOISE_M;
        SyntheticReturn {
            at_m: self.recording.sensor_m + direction * (end.t_m + noise_m),
            strength: drawn.copied().unwrap_or(end.strength),
            class: end.class,
            provenance: end.provenance,
            like,
            slot,
        }
    }
}

/// Class of what a recorded return lies on: that of its voxel, else of the ground below.
fn class_of(scene: &Scene, r: &RecordedReturn) -> Class {
    let (frame, at) = (scene.frame(), r.place());
    let extent = frame.extent();
    let Some([x, y]) = extent.column_at(at.x, at.y) else {
        return Class::Others;
    };
    let labels = frame.occupancy.column(x, y);
    let known = |label: u8| Class::from_id(label).filter(|c| *c != Class::Free);
    let own = extent.voxel_at(at).and_then(|[_, _, z]| known(labels[z]));
    own.or_else(|| labels.iter().filter_map(|l| known(*l)).find(|c| c.is_ground()))
        .unwrap_or(Class::Others)
}

fn median(values: &mut [f32]) -> f32 {
    values.sort_by(f32::total_cmp);
    values.get(values.len() / 2).copied().unwrap_or(f32::NAN)
}
