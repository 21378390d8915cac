//! Points into a scene: code that all formats of point clouds share.
//!
//! Points are counted into the voxels of the networks' window. A voxel gets the class that most of its points have; the
//! class of points without a label is told by their shape ([`geometry`]). Labels of this program and of Occ3D have the
//! road under the vehicle in the lowest bin, two bins below its height; clouds have it at its height. The ground of a
//! cloud is therefore moved so that its level around the vehicle comes to the middle of the lowest bin. Other points
//! stay.
//!
//! A cloud whose ground lies beside the map, as a sweep in its sensor's frame, is lifted as a whole before that ([`level`]), or
//! by as much as the user says.

pub(super) mod geometry;
mod level;
mod sweep;

use std::collections::BTreeMap;
use std::sync::{Arc, LazyLock};

use glam::DVec3;
use scene::{Class, Extent, Pose, Recorded, SensorRig, VoxelGrid, Window};

use super::{GUESSED, ImportFile, ImportedScene, labelled};
use level::GroundPlane;
use sweep::SweepReturns;
pub(super) use sweep::strength_scale;

/// Layers per voxel in which heights are counted: 0.05 m each.
const FINE: usize = 8;
/// Layers of the window.
const LAYERS: usize = Window::NZ * FINE;
/// Classes that a number can hold beside its place.
const CLASSES: u32 = 32;
/// Points that wait until they are counted.
const PENDING: usize = 1 << 20;
/// Points that wait until the height of the ground is known; of a larger cloud these tell it.
const WAITING: usize = 1 << 22;
/// Nearest return to the sensor, m: sensors write nearer places where no echo came back.
const EMPTY_M: f64 = 0.1;
/// Unlabelled points of one voxel of which the shape is looked at.
const MOST_PER_VOXEL: u8 = 32;
/// The layer in which the level of the ground is put: above it is the middle of the lowest bin.
const GROUND_LAYER: usize = FINE / 2;
/// The level of the ground is looked for within this distance of the vehicle, m, from at least so many points.
const LEVEL_REACH_M: f64 = 20.0;
const LEAST_FOR_LEVEL: u64 = 20;
/// Ground below the first layer is where labels have it; ground above the last one (0.3 m) is a hill and stays.
const LOWEST_LEVEL: usize = FINE - 1;
const HIGHEST_LEVEL: usize = 25;
/// Heights above the road at which vehicles carry sensors, m.
const MOUNTS_M: std::ops::RangeInclusive<f64> = 1.2..=4.5;
/// A point of the own vehicle lies higher above the ground than the first and at most the second beyond its box, m.
const OWN_FROM_M: f64 = 0.3;
const OWN_MARGIN_M: f64 = 0.2;

/// Label of a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Label {
    /// It stands for a class.
    Class(Class),
    /// It stands for no class: "others", counted.
    Unknown,
    /// There is none: the shape tells the class.
    None,
}

/// Error of a cloud of which no point would be left.
#[derive(Debug, PartialEq, thiserror::Error)]
#[error("{}", self.line())]
pub struct NothingOnTheMap {
    /// Points in the file.
    pub points: usize,
    /// Points without a place, or at the sensor itself: no echo came back.
    pub empty: usize,
}

impl NothingOnTheMap {
    fn line(&self) -> String {
        let Self { points, empty } = self;
        match *empty > 0 && empty == points {
            true => format!("no return among {points} points: none has a place away from the sensor"),
            false => format!(
                "none of {points} points lies on the map, expected x and y within 40 m of the ego and z from -1 to 5.4 m (ego frame)"
            ),
        }
    }
}

/// Points on the map, and their labels.
#[derive(Default)]
pub(super) struct Cloud {
    /// Points within the map seen from above, until it is known how far they are lifted; with their strength.
    waiting: Vec<(DVec3, f32, Label)>,
    /// How points are moved: lifted by the user, or by the ground, once it is known.
    level: Option<Pose>,
    /// The user said how far.
    is_asked: bool,
    /// The sensor's place on the vehicle is a guess: the ground shows how high it is.
    is_guessed: bool,
    /// Returns for a network that finds objects.
    sweep: SweepReturns,
    /// Notes on what was done with the height, for a person.
    notes: Vec<String>,
    /// Column, layer and class of a point in one number.
    pending: Vec<u32>,
    /// Sorted numbers of the same kind, each with the count of its points.
    counted: Vec<(u32, u32)>,
    loose: Vec<Loose>,
    /// Loose points of each voxel.
    held: Vec<u8>,
    unlabelled: bool,
    added: usize,
    not_finite: usize,
    elsewhere: usize,
    above: usize,
    unknown: usize,
    own: usize,
    empty: usize,
}

/// A point of which the shape of its surroundings is looked at: without label, or labelled as ground.
struct Loose {
    /// Place in the window along x, y and z, in [`Loose::PARTS`] of a voxel.
    at: [u16; 3],
    labelled: bool,
}

impl Loose {
    /// Parts of a voxel along x, y and z: 1.25 mm and 0.1 mm. A whole number, so that a point stays in its voxel.
    const PARTS: DVec3 = DVec3::new(320.0, 320.0, 4096.0);

    fn new(at: DVec3, labelled: bool) -> Self {
        let parts = Window::to_voxel_units(at) * Self::PARTS;
        Self {
            at: parts.to_array().map(|v| v as u16),
            labelled,
        }
    }

    fn position_m(&self) -> DVec3 {
        let parts = DVec3::from_array(self.at.map(|v| f64::from(v) + 0.5));
        Window::from_voxel_units(parts / Self::PARTS)
    }
}

impl Cloud {
    /// An empty cloud of a file: lifted as the user says, else by the height of its ground.
    pub(super) fn from_source(source: &ImportFile<'_>) -> Self {
        Self {
            level: source.options.lift_m.map(lifted),
            is_asked: source.options.lift_m.is_some(),
            ..Self::default()
        }
    }

    /// The same for a sensor whose place on the vehicle is a guess.
    pub(super) fn of_guessed_sensor(source: &ImportFile<'_>) -> Self {
        Self {
            is_guessed: true,
            ..Self::from_source(source)
        }
    }

    /// One point, in m in the frame of the sensor or of the ego, the number of its class in Occ3D if it has one, and the strength
    /// of its echo if it has one.
    pub(super) fn add(&mut self, at: DVec3, label: Option<f64>, strength: Option<f64>) {
        let label = match label {
            Some(id) if (0.0..f64::from(Class::FREE)).contains(&id) && id.fract() == 0.0 => {
                Class::from_id(id as u8).map_or(Label::Unknown, Label::Class)
            }
            Some(_) => Label::Unknown,
            None => Label::None,
        };
        match label == Label::None && is_empty_return(at) {
            true => self.add_empty(),
            false => self.add_point(at, label, strength.unwrap_or(0.0) as f32),
        }
    }

    /// Says that the points are a map of many sweeps, in which no objects are looked for.
    pub(super) fn is_map(&mut self) {
        self.sweep.is_map = true;
    }

    fn add_empty(&mut self) {
        self.added += 1;
        self.empty += 1;
    }

    /// One slot of a sensor, in m in its frame: a point, unless no echo came back.
    pub(super) fn add_return(&mut self, at: DVec3, ego_from_sensor: &Pose, label: Label, strength: f32) {
        if label == Label::None && is_empty_return(at) {
            self.add_empty();
            return;
        }
        self.sweep.sensor_m = Some(ego_from_sensor.translation_m);
        self.sweep.ego_from_file = *ego_from_sensor;
        self.add_point(ego_from_sensor.apply(at), label, strength);
    }

    /// One point, in m; its height is taken as that of the ego frame unless the ground shows otherwise.
    pub(super) fn add_point(&mut self, at: DVec3, label: Label, strength: f32) {
        self.added += 1;
        if !at.is_finite() {
            self.not_finite += 1;
        } else if Window::column_at(at.x, at.y).is_none() {
            self.elsewhere += 1;
        } else if let Some(level) = self.level {
            self.place(level.apply(at), label, strength);
        } else {
            self.waiting.push((at, strength, label));
            if self.waiting.len() >= WAITING {
                self.find_level();
            }
        }
    }

    /// Finds how far the cloud is lifted, and places the points that wait for it.
    fn find_level(&mut self) {
        let waiting = std::mem::take(&mut self.waiting);
        let is_labelled = waiting.iter().any(|(.., label)| *label != Label::None);
        let shows_ground = |label: Label| match label {
            Label::Class(class) => class.is_ground(),
            Label::Unknown => false,
            Label::None => !is_labelled,
        };
        let points = waiting.iter().filter(|(.., label)| shows_ground(*label));
        let ground = GroundPlane::from_points(points.map(|(at, ..)| *at));
        let lift_m = ground.map_or(0.0, |ground| match is_labelled {
            true => ground.lift_m(),
            false => ground.unlabelled_lift_m(),
        });
        // A sensor whose place is a guess stands as high as its ground shows, if a vehicle can carry it there.
        let mount_m = self.sweep.sensor_m.map_or(0.0, |at| at.z) + lift_m;
        let is_placed = self.is_guessed && !is_labelled && MOUNTS_M.contains(&mount_m);
        let lift_m = match self.is_guessed && !is_placed {
            true => ground.map_or(0.0, GroundPlane::lift_m),
            false => lift_m,
        };
        let level = match ground {
            Some(ground) if !self.is_guessed && ground.is_below_a_sensor() => ground.leveling(),
            _ => lifted(lift_m),
        };
        self.level = Some(level);
        self.sweep.ground = ground.map(|ground| ground.moved(&level));
        // A cloud that does not stand on its ground is in the frame of its sensor.
        let is_lifted = !is_labelled && lift_m > 0.0;
        if is_lifted || ground.is_some_and(GroundPlane::is_below_a_sensor) {
            self.sweep.sensor_m.get_or_insert(DVec3::ZERO);
        }
        self.sweep.sensor_m = self.sweep.sensor_m.map(|at| level.apply(at));
        self.notes = match ground {
            Some(ground) if is_placed && lift_m != 0.0 => {
                ground.placed_notes(self.sweep.sensor_m.map_or(0.0, |at| at.z))
            }
            Some(ground) => ground.notes(lift_m),
            None if is_labelled => Vec::new(),
            None => vec!["no ground found around the sensor: heights stay as they are in the file".into()],
        };
        for (at, strength, label) in waiting {
            self.place(level.apply(at), label, strength);
        }
    }

    /// How points are moved so that they stand on the ground, and notes on that for a person.
    pub(super) fn leveled(mut self) -> (Pose, Vec<String>) {
        if self.level.is_none() {
            self.find_level();
        }
        (self.level.unwrap_or_default(), self.notes)
    }

    /// One point, in m in the ego frame.
    fn place(&mut self, at: DVec3, label: Label, strength: f32) {
        let Some([x, y, z]) = Window::voxel_at(at) else {
            // Those beside the map were counted before.
            self.above += 1;
            return;
        };
        let class = match label {
            Label::Class(class) => Some(class),
            Label::Unknown => Some(Class::Others),
            Label::None => None,
        };
        if class.is_none_or(|class| class == Class::Others) && is_own(at) {
            self.own += 1;
            return;
        }
        self.unknown += usize::from(label == Label::Unknown);
        self.unlabelled |= class.is_none();
        if class.is_none() {
            self.sweep.add(at, strength);
        }
        if class.is_none_or(Class::is_ground) {
            self.hold(at, (x * Window::NY + y) * Window::NZ + z, class.is_some());
        }
        if let Some(class) = class {
            self.count(at, class);
        }
    }

    /// True if no point lies on the map.
    pub(super) fn is_empty(&self) -> bool {
        self.pending.is_empty() && self.counted.is_empty() && self.loose.is_empty()
    }

    /// Points that are not in the scene, or not with their label, counted by kind.
    fn skipped(&self) -> BTreeMap<String, usize> {
        let counts = [
            ("empty returns, at the sensor itself", self.empty),
            ("points that are not finite", self.not_finite),
            ("points beside the map", self.elsewhere),
            ("points above or below the map", self.above),
            ("points on the own vehicle", self.own),
            ("labels without a class, taken as others", self.unknown),
        ];
        let some = counts.into_iter().filter(|(_, n)| *n > 0);
        some.map(|(what, n)| (what.to_owned(), n)).collect()
    }

    /// The scene of the points; `left_out` counts the other content of the file by kind.
    pub(super) fn scene(
        mut self,
        name: &str,
        left_out: BTreeMap<String, usize>,
    ) -> Result<ImportedScene, NothingOnTheMap> {
        match self.level {
            None => self.find_level(),
            Some(by) if self.is_asked => {
                self.notes = vec![format!("lifted by {:.2} m, as asked for", by.translation_m.z)];
                self.sweep.find_ground(by.translation_m.z);
            }
            Some(_) => {}
        }
        let notes = std::mem::take(&mut self.notes);
        if self.is_empty() {
            return Err(NothingOnTheMap {
                points: self.added,
                empty: self.empty + self.not_finite,
            });
        }
        let mut skipped = left_out;
        skipped.extend(self.skipped());
        let by_shape = self.unlabelled;
        if by_shape {
            let loose = std::mem::take(&mut self.loose);
            self.held = Vec::new();
            let at: Vec<DVec3> = loose.iter().map(Loose::position_m).collect();
            let shapes = geometry::shapes(&at, Extent::WINDOW, &[geometry::Passed::HERE]);
            for ((point, at), class) in loose.iter().zip(&at).zip(shapes.classes) {
                if !point.labelled {
                    self.count(*at, class);
                }
            }
        }
        let added = self.added;
        let (mut sweep, level) = (std::mem::take(&mut self.sweep), self.level.unwrap_or_default());
        if !by_shape {
            sweep.ground = None;
        }
        let mut scene = labelled(name, self.grid(), None);
        if by_shape {
            scene.change_canvas(|canvas| canvas.inferred.recorded = Arc::new(Recorded::of_voxels()));
        }
        Ok(ImportedScene {
            scene,
            sweep: sweep.finished(&level).filter(|_| added <= sweep::MOST),
            inferred: match by_shape {
                true => &GUESSED_BY_SHAPE,
                false => &GUESSED,
            },
            skipped,
            notes,
        })
    }

    fn hold(&mut self, at: DVec3, voxel: usize, labelled: bool) {
        if self.held.is_empty() {
            self.held = vec![0; Window::VOXELS];
        }
        if self.held[voxel] < MOST_PER_VOXEL {
            self.held[voxel] += 1;
            self.loose.push(Loose::new(at, labelled));
        }
    }

    fn count(&mut self, at: DVec3, class: Class) {
        let u = Window::to_voxel_units(at);
        let column = (u.x as usize).min(Window::NX - 1) * Window::NY + (u.y as usize).min(Window::NY - 1);
        let layer = ((u.z * FINE as f64) as usize).min(LAYERS - 1);
        let place = (column * LAYERS + layer) as u32;
        self.pending.push(place * CLASSES + u32::from(class.id()));
        if self.pending.len() >= PENDING {
            self.settle();
        }
    }

    /// Counts the points that wait.
    fn settle(&mut self) {
        self.pending.sort_unstable();
        let new = self.pending.chunk_by(|a, b| a == b);
        let mut all: Vec<(u32, u32)> = std::mem::take(&mut self.counted);
        all.extend(new.map(|points| (points[0], points.len() as u32)));
        self.pending.clear();
        self.counted = summed(all);
    }

    /// Each voxel by the vote of its points; of equally many the lowest class, "others" last.
    fn grid(mut self) -> VoxelGrid {
        self.settle();
        let level = ground_level(&self.counted);
        let voxel = |(key, count): &(u32, u32)| {
            let (place, class) = (*key as usize / CLASSES as usize, key % CLASSES);
            let (column, layer) = (place / LAYERS, place % LAYERS);
            let is_ground = Class::from_id(class as u8).is_some_and(Class::is_ground);
            let layer = match level.filter(|_| is_ground) {
                Some(level) => (layer + GROUND_LAYER).saturating_sub(level).min(LAYERS - 1),
                None => layer,
            };
            let voxel = column * Window::NZ + layer / FINE;
            (voxel as u32 * CLASSES + class, *count)
        };
        let votes = summed(self.counted.iter().map(voxel).collect());
        let mut grid = VoxelGrid::new();
        for votes in votes.chunk_by(|a, b| a.0 / CLASSES == b.0 / CLASSES) {
            let winner = votes.iter().max_by_key(|(key, count)| {
                let class = key % CLASSES;
                let others = u32::from(Class::Others.id());
                (*count, class != others, std::cmp::Reverse(class))
            });
            let Some((key, _)) = winner else { continue };
            let voxel = (key / CLASSES) as usize;
            let (x, y, z) = (
                voxel / (Window::NY * Window::NZ),
                voxel / Window::NZ % Window::NY,
                voxel % Window::NZ,
            );
            grid.set(x, y, z, (key % CLASSES) as u8);
        }
        grid
    }
}

/// Guessed parts of a scene from a cloud without labels.
const GUESSED_BY_SHAPE: [&str; 4] = ["classes", "layout", "boxes", "background"];

/// Equal keys as one, their counts added up; sorted.
fn summed(mut all: Vec<(u32, u32)>) -> Vec<(u32, u32)> {
    all.sort_unstable();
    all.dedup_by(|next, kept| {
        let same = next.0 == kept.0;
        if same {
            kept.1 = kept.1.saturating_add(next.1);
        }
        same
    });
    all
}

/// The layer that the road around the vehicle lies in, or the ground if there is no road; `None` if it is where labels have
/// it, above 0.3 m, or not known.
fn ground_level(counted: &[(u32, u32)]) -> Option<usize> {
    let near = |place: usize| {
        let column = place / LAYERS;
        let center = Window::center(column / Window::NY, column % Window::NY, 0);
        center.truncate().length() <= LEVEL_REACH_M
    };
    let level = |is_meant: &dyn Fn(Class) -> bool| {
        let mut points = [0u64; LAYERS];
        for (key, count) in counted {
            let place = (key / CLASSES) as usize;
            let class = Class::from_id((key % CLASSES) as u8);
            if class.is_some_and(is_meant) && near(place) {
                points[place % LAYERS] += u64::from(*count);
            }
        }
        let all: u64 = points.iter().sum();
        let mut below = 0;
        let median = points.iter().position(|n| {
            below += n;
            2 * below >= all
        });
        median.filter(|_| all >= LEAST_FOR_LEVEL)
    };
    let found = level(&|class| class == Class::DriveableSurface).or_else(|| level(&Class::is_ground))?;
    (LOWEST_LEVEL..=HIGHEST_LEVEL).contains(&found).then_some(found)
}

fn lifted(by_m: f64) -> Pose {
    Pose {
        translation_m: DVec3::Z * by_m,
        ..Pose::default()
    }
}

/// True for a place of a sensor's frame where nothing came back.
fn is_empty_return(at: DVec3) -> bool {
    at.length_squared() < EMPTY_M * EMPTY_M
}

/// True for a place on the vehicle that carries the sensors, that of the default rig.
pub(super) fn is_own(at: DVec3) -> bool {
    static OWN: LazyLock<(DVec3, DVec3)> = LazyLock::new(|| {
        let rig = SensorRig::default();
        let half = DVec3::from_array(rig.ego_size_m) / 2.0 + DVec3::splat(OWN_MARGIN_M);
        (DVec3::from_array(rig.ego_center_m), half)
    });
    let (center, half) = *OWN;
    at.z > OWN_FROM_M && (at - center).abs().cmple(half).all()
}

#[cfg(test)]
mod sweep_tests;
#[cfg(test)]
mod tests;
