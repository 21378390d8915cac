//! The drive that a scene is of, moment by moment, and what becomes of the objects that are found in it.

use std::collections::BTreeMap;
use std::sync::Arc;

use glam::{DVec2, DVec3};
use scene::clip::ObjectVoxels;
use scene::{
    BoxId, Class, Clip, Extent, Frame, Key, Lattice, Motion, Pose, Recorded, Relief, SceneBox, Track,
};

use super::cloud::{is_own, strength_scale};
use super::drive::survey::SurveyedWorld;
use super::importer::{ImportedScene, of_sensor};
use crate::sweep_file::SweepFile;

/// A sweep of a drive, seen from the vehicle on the ground.
#[derive(Clone, Debug)]
pub struct SweepMoment {
    /// Moment of the clip, s.
    pub time_s: f64,
    /// Place of the vehicle on the ground.
    pub world_from_vehicle: Pose,
    /// Place of the sensor in the frame of the vehicle, m.
    pub sensor_m: DVec3,
    /// x and y in that frame, height above the ground (m) and strength of the echo (0 to 255) of each return.
    pub returns: Vec<[f32; 4]>,
}

/// An object that was followed through a drive.
#[derive(Clone, Debug)]
pub struct TrackedObject {
    /// Class of the object.
    pub class: Class,
    /// Length, width, height, m.
    pub size_m: DVec3,
    /// Where it was seen: number of the moment, place of its middle (m) and heading (rad), seen from above. A single one stands for
    /// an object that stands still.
    pub places: Vec<(usize, DVec2, f64)>,
}

/// Ground around the vehicle at a moment of a drive, as it looks: for each column of the networks' window, `[x][y]`, in the frame of
/// the vehicle its class, `None` where none shows.
pub type MomentGround = Vec<Option<Class>>;

/// Distance from the vehicle at which ground that it sees counts half as much, m.
const SURE_M: f64 = 15.0;
/// Share of the ground within 4 m of the vehicle that must be road, or what is seen of ground is not believed.
const BELIEVED_SHARE: f64 = 0.2;
/// Columns around a column that tell its ground too.
const AROUND: usize = 2;
/// Classes of ground.
const GROUND: [Class; 4] = [
    Class::DriveableSurface,
    Class::OtherFlat,
    Class::Sidewalk,
    Class::Terrain,
];

impl ImportedScene {
    /// Number of the moments of a drive without labels, 1 for a sweep by itself; 0 for all else.
    pub fn moments(&self) -> usize {
        let sweep = self.sweep.as_ref().filter(|sweep| sweep.drive.is_some());
        sweep.map_or(0, |sweep| sweep.files.len())
    }

    /// A moment of a drive. `None` beyond the last, or if its file cannot be read any more.
    pub fn moment(&self, number: usize) -> Option<SweepMoment> {
        let sweep = self.sweep.as_ref()?;
        let file = sweep.files.get(number)?;
        if !sweep.returns.is_empty() {
            return Some(SweepMoment {
                time_s: file.time_s,
                world_from_vehicle: Pose::IDENTITY,
                sensor_m: sweep.sensor_m,
                returns: sweep.returns.clone(),
            });
        }
        let there = self.scene.at(file.time_s);
        let frame = there.frame();
        let at_m = frame.world_from_ego.translation_m;
        let ahead = (frame.world_from_ego.rotation * DVec3::X).truncate();
        let mut world_from_vehicle = Pose::planar(at_m.x, at_m.y, ahead.to_angle());
        let relief = &frame.layout.relief;
        world_from_vehicle.translation_m.z = relief.height_m(at_m.truncate());
        let vehicle_from_world = world_from_vehicle.inverse();
        let read = SweepFile::open(file.format, &file.bytes).ok()?;
        let returns = read.returns(&file.world_from_file);
        let scale = strength_scale(returns.iter().flatten().map(|r| r.strength));
        let seen = returns.iter().flatten().filter_map(|r| {
            let (world, at) = (r.place(), vehicle_from_world.apply(r.place()));
            let height_m = world.z - relief.height_m(world.truncate());
            let strength = match r.strength.is_finite() {
                true => (r.strength * scale).clamp(0.0, 255.0),
                false => 0.0,
            };
            (!is_own(at)).then_some([at.x as f32, at.y as f32, height_m as f32, strength])
        });
        Some(SweepMoment {
            time_s: file.time_s,
            sensor_m: vehicle_from_world.apply(file.sensor_m),
            returns: seen.collect(),
            world_from_vehicle,
        })
    }

    /// The class of the ground in each column of a map, as most moments see it. Nothing if hardly any of the ground around the
    /// vehicle would be road: then they are not believed.
    fn ground_of(&self, extent: Extent, seen: &[MomentGround]) -> Vec<Option<Class>> {
        let told = self.ground_seen(extent, seen);
        let sweeps = self.sweep.iter().flat_map(|sweep| &sweep.files);
        let (mut all, mut road) = (0usize, 0usize);
        for file in sweeps {
            let there = self.scene.at(file.time_s).frame().world_from_ego;
            for (along, aside) in (-4..=4).flat_map(|x| (-4..=4).map(move |y| (x, y))) {
                let at = there.apply(DVec3::new(f64::from(along), f64::from(aside), 0.0));
                let column = extent.column_at(at.x, at.y);
                if let Some(class) = column.and_then(|[x, y]| told[extent.index(x, y)]) {
                    all += 1;
                    road += usize::from(class == Class::DriveableSurface);
                }
            }
        }
        match road as f64 >= BELIEVED_SHARE * all as f64 {
            true => told,
            false => vec![None; told.len()],
        }
    }

    /// The class of the ground in each column of a map, as most moments see it.
    fn ground_seen(&self, extent: Extent, seen: &[MomentGround]) -> Vec<Option<Class>> {
        let files = self.sweep.iter().flat_map(|sweep| &sweep.files);
        let poses: Vec<Pose> = files
            .map(|file| self.scene.at(file.time_s).frame().world_from_ego.inverse())
            .collect();
        let votes = |[x, y]: [usize; 2]| {
            let at = extent.center(x, y, 0);
            let mut votes = [0.0f32; GROUND.len()];
            for (vehicle_from_world, seen) in poses.iter().zip(seen) {
                let here = vehicle_from_world.apply(at).truncate();
                let column = Extent::WINDOW.column_at(here.x, here.y);
                let class = column.and_then(|[x, y]| *seen.get(Extent::WINDOW.index(x, y))?);
                if let Some(kind) = class.and_then(|class| GROUND.iter().position(|c| *c == class)) {
                    votes[kind] += (1.0 / (1.0 + here.length_squared() / (SURE_M * SURE_M))) as f32;
                }
            }
            votes
        };
        let votes: Vec<[f32; GROUND.len()]> = extent.all_columns().map(votes).collect();
        let column = |[x, y]: [usize; 2]| {
            let mut around = [0.0f32; GROUND.len()];
            for x in x.saturating_sub(AROUND)..=(x + AROUND).min(extent.nx() - 1) {
                for y in y.saturating_sub(AROUND)..=(y + AROUND).min(extent.ny() - 1) {
                    let of = votes[extent.index(x, y)];
                    around.iter_mut().zip(of).for_each(|(sum, vote)| *sum += vote);
                }
            }
            let most = (0..GROUND.len()).max_by(|a, b| around[*a].total_cmp(&around[*b]))?;
            (around[most] > 0.0).then_some(GROUND[most])
        };
        extent.all_columns().map(column).collect()
    }

    /// True if the objects of a drive are known, so that none are to be found.
    pub fn knows_objects(&self) -> bool {
        let drive = self.sweep.as_ref().and_then(|sweep| sweep.drive.as_ref());
        drive.is_some_and(|drive| drive.told().is_some())
    }

    /// The scene of a drive whose objects are known, with ground as its moments show it.
    pub fn with_ground(mut self, ground: &[MomentGround]) -> Self {
        let drive = self.sweep.as_ref().and_then(|sweep| sweep.drive.clone());
        let told = drive.as_ref().and_then(|drive| drive.extent());
        let told = told.map(|extent| self.ground_of(extent, ground));
        let moving = drive.as_ref().and_then(|drive| drive.told());
        let world = drive.as_ref().zip(moving).zip(told);
        if let Some(world) = world.and_then(|((drive, moving), told)| drive.world(moving, &told)) {
            let standing = self.scene.canvas().boxes.clone();
            self.replace_world(world.with_drafts(standing.values()), standing);
        }
        self
    }

    /// The scene with another world around the vehicle and these standing objects; how things move stays.
    fn replace_world(&mut self, world: SurveyedWorld, standing: BTreeMap<BoxId, SceneBox>) {
        let inferred = self.scene.canvas().inferred.boxes.clone();
        let is_told = self.knows_objects();
        let mut scene = world.scene(&self.scene.name, standing);
        (scene.rig, scene.seed) = (self.scene.rig.clone(), self.scene.seed);
        if let Some(mount_m) = self.sweep.as_ref().and_then(|sweep| sweep.mount_m) {
            of_sensor(&mut scene, mount_m);
        }
        (scene.conditions, scene.prompt) = (self.scene.conditions, self.scene.prompt.clone());
        let clip = self.scene.clip().clone();
        scene.change_clip(|still| *still = Arc::unwrap_or_clone(clip));
        let pose = self.scene.canvas().world_from_ego;
        let recorded = Arc::new(Recorded::all_of(&scene));
        scene.change_canvas(|canvas| {
            canvas.world_from_ego = pose;
            canvas.inferred.recorded = recorded;
            if is_told {
                canvas.inferred.boxes = inferred;
            }
        });
        self.scene = scene;
    }

    /// The scene of a drive with objects that were found in its sweeps and ground as its moments show it: objects that stand are boxes,
    /// those that move are tracks, and their returns leave the voxels.
    pub fn with_tracked(mut self, objects: &[TrackedObject], ground: &[MomentGround]) -> Self {
        let Some(drive) = self.sweep.as_ref().and_then(|sweep| sweep.drive.clone()) else {
            return self;
        };
        let times_s: Vec<f64> = self
            .sweep
            .iter()
            .flat_map(|sweep| sweep.files.iter().map(|file| file.time_s))
            .collect();
        let relief = self.scene.frame().layout.relief.clone();
        let (mut standing, mut tracks) = (BTreeMap::new(), BTreeMap::new());
        let mut moving = vec![Vec::new(); times_s.len()];
        for (object, id) in objects.iter().zip(1..) {
            let Some(first) = object.places.first() else {
                continue;
            };
            let made = on_ground(&relief, object.at(BoxId(id), first));
            if made.problem().is_some() {
                continue;
            }
            if object.places.len() == 1 && standing.len() < Frame::MAX_BOXES {
                standing.insert(made.id, made);
                continue;
            }
            let track = object.track(made, &times_s);
            if track.problem().is_none() && tracks.len() < Clip::MAX_TRACKS {
                tracks.insert(made.id, track);
                for place in &object.places {
                    moving[place.0].push(on_ground(&relief, object.at(made.id, place)));
                }
            }
        }
        let told = drive.extent().map(|extent| self.ground_of(extent, ground));
        let Some(world) = told.and_then(|told| drive.world(&moving, &told)) else {
            return self;
        };
        // What stands is on the ground that was measured.
        let relief = &world.layout.relief;
        for b in standing.values_mut() {
            *b = on_ground(relief, *b);
        }
        let mut clip = Clip::clone(self.scene.clip());
        clip.tracks = tracks;
        if clip.problem().is_some() {
            return self;
        }
        self.scene.change_clip(|still| *still = clip);
        self.replace_world(world, standing);
        self
    }
}

/// An object on the ground below it.
fn on_ground(relief: &Relief, b: SceneBox) -> SceneBox {
    let ground_m = relief.height_m(b.center_m.truncate());
    SceneBox {
        center_m: b.center_m.with_z(ground_m + b.size_m.z / 2.0),
        ..b
    }
}

impl TrackedObject {
    fn at(&self, id: BoxId, &(_, at_m, yaw_rad): &(usize, DVec2, f64)) -> SceneBox {
        SceneBox {
            id,
            class: self.class,
            center_m: at_m.extend(self.size_m.z / 2.0),
            size_m: self.size_m,
            yaw_rad,
            velocity_mps: DVec2::ZERO,
            label: Default::default(),
        }
    }

    fn track(&self, made: SceneBox, times_s: &[f64]) -> Track {
        let mut yaw_rad = made.yaw_rad;
        let keys = self.places.iter().map(|(moment, at_m, turned_rad)| {
            // Headings go on beyond half a turn.
            yaw_rad += DVec2::from_angle(yaw_rad).angle_to(DVec2::from_angle(*turned_rad));
            Key {
                time_s: times_s[*moment],
                at_m: *at_m,
                yaw_deg: yaw_rad.to_degrees(),
            }
        });
        let [first, last] = [self.places.first(), self.places.last()].map(|place| place.map_or(0, |p| p.0));
        Track {
            made,
            motion: Motion::Keys(keys.collect()),
            there_s: [
                (first > 0).then(|| times_s[first]),
                times_s.get(last + 1).copied(),
            ],
            voxels: ObjectVoxels::drafted(Lattice::OCC3D, &made),
            settled: true,
            own_shape: false,
        }
    }
}
