//! What the sweeps of a drive see together: the ground with its height, what stands on it, and what moved.
//!
//! A return that others saw through, at other moments, is of something that moves: it is left out of the voxels. Classes of
//! returns without labels are told by their shapes, once for all sweeps ([`super::super::cloud::geometry`]).

use std::collections::BTreeMap;
use std::sync::Arc;

use glam::{DVec2, DVec3};
use scene::{
    BevLayout, BoxId, Class, Extent, Frame, Inferred, Lattice, Pose, Relief, Scene, SceneBox, SensorRig,
    VoxelGrid, draft, infer,
};

use super::align::surveyed;
use crate::import::cloud::geometry::{Passed, shapes};

/// Distance beyond a box within which voxels are its own, m.
const OWN_M: f64 = 0.25;
/// A return this far outside of a box still comes from what is in it, m.
const BESIDE_M: f64 = 0.15;
/// Returns lower above the ground than this are of the ground: whether they move is not asked, m.
const STANDS_M: f64 = 0.3;
/// Width of the cells of a panorama, degrees, and how far up and down it reaches.
const CELL_DEG: f64 = 1.0;
const REACH_DEG: f64 = 45.0;
/// Distance of the places that the vehicle passed, m.
const PASSED_EVERY_M: f64 = 0.5;
/// A ray that passes a place ends this much farther than it, m; one that ends this near to it meets it.
const PASSED_M: f64 = 0.7;
const MET_M: f64 = 0.4;
/// Sweeps before and after that are asked whether they saw through a return: near ones, and farther ones for what moves slowly.
const ASKED: [usize; 8] = [1, 2, 3, 5, 8, 12, 18, 27];
/// Fewest sweeps that saw through it.
const LEAST_THROUGH: usize = 2;
/// Share of the returns of a voxel that others saw through from which all of it moved.
const MOVED_SHARE: f64 = 0.4;
/// Share of what stands that others saw through from which the poses cannot fit.
const MISFIT_SHARE: f64 = 0.1;
/// Ground within this of z = 0, m, in this share of the columns is level.
const LEVEL_M: f32 = 0.15;
const LEVEL_SHARE: f64 = 0.97;
/// Ground up to so many columns from road lies beside it.
const BESIDE_ROAD: usize = 8;

/// A sweep of a drive: its returns thinned to 0.25 m ([`surveyed`]), in m in the frame of the sensor.
#[derive(Debug)]
pub(crate) struct Survey {
    points: Vec<DVec3>,
}

impl Survey {
    /// Thins returns, in m in the frame of the sensor, without those of the own vehicle.
    pub(crate) fn new(returns: impl Iterator<Item = DVec3>) -> Self {
        Self {
            points: surveyed(returns),
        }
    }

    /// The points that are left, m.
    pub(crate) fn points(&self) -> &[DVec3] {
        &self.points
    }
}

/// A sweep at its place.
#[derive(Debug)]
pub(crate) struct PlacedSurvey {
    survey: Survey,
    world_from_sensor: Pose,
    /// Place on the ground below the sensor, m, in the world frame.
    foot_m: DVec3,
    /// Direction away from the ground that the vehicle stands on, in the frame of the sensor.
    up: DVec3,
}

impl PlacedSurvey {
    /// A sweep of a sensor that stands over the ground like the first one, which this pose puts above the origin of the world.
    pub(crate) fn of_sensor(survey: Survey, world_from_sensor: Pose, world_from_first: &Pose) -> Self {
        let foot = world_from_first.inverse().apply(DVec3::ZERO);
        Self {
            survey,
            foot_m: world_from_sensor.apply(foot),
            up: world_from_first.rotation.inverse() * DVec3::Z,
            world_from_sensor,
        }
    }

    /// A sweep at the origin of the world, whose ground has this height there, m, and these slopes.
    pub(crate) fn of_ground(survey: Survey, world_from_sensor: Pose, height_m: f64, slope: DVec2) -> Self {
        let up = (-slope).extend(1.0).normalize();
        Self {
            survey,
            world_from_sensor,
            foot_m: DVec3::Z * height_m,
            up: world_from_sensor.rotation.inverse() * up,
        }
    }
}

/// The sweeps of a drive, put together.
#[derive(Debug)]
pub(crate) struct SurveyedDrive {
    sweeps: Vec<PlacedSurvey>,
    /// Objects that move, by sweep, if a person or a data set told the objects.
    told: Option<Vec<Vec<SceneBox>>>,
}

impl SurveyedDrive {
    /// A drive of which nothing is known but its sweeps.
    pub(crate) fn new(sweeps: Vec<PlacedSurvey>) -> Self {
        Self { sweeps, told: None }
    }

    /// A drive whose objects are known; `moving` are those that move, by sweep.
    pub(crate) fn with_objects(sweeps: Vec<PlacedSurvey>, moving: Vec<Vec<SceneBox>>) -> Self {
        Self {
            sweeps,
            told: Some(moving),
        }
    }

    /// Objects that move, by sweep, if the objects are known.
    pub(crate) fn told(&self) -> Option<&[Vec<SceneBox>]> {
        self.told.as_deref()
    }

    /// What stands still, within 40 m of the vehicle; `moving` are objects that are known to move, by sweep, `told` classes of the
    /// ground that are known, by column of [`extent`](Self::extent). `None` if no point lies on the map, or the map would be too
    /// large.
    pub(crate) fn world(&self, moving: &[Vec<SceneBox>], told: &[Option<Class>]) -> Option<SurveyedWorld> {
        together(&self.sweeps, self.extent()?, moving, told)
    }

    /// The map; `None` if it would be too large.
    pub(crate) fn extent(&self) -> Option<Extent> {
        let feet: Vec<DVec3> = self.sweeps.iter().map(|s| s.foot_m).collect();
        extent_around(&feet).ok()
    }
}

/// Ground within 40 m of places along x and y. Errors in one line if it is too large.
pub(crate) fn extent_around(places: &[DVec3]) -> Result<Extent, String> {
    let low = places.iter().copied().fold(DVec3::INFINITY, DVec3::min);
    let high = places.iter().copied().fold(DVec3::NEG_INFINITY, DVec3::max);
    let reach = Extent::WINDOW.max_m().x;
    let column = |metres: f64| (metres * Lattice::OCC3D.per_m()).floor() as i32;
    let from = [column(low.x - reach), column(low.y - reach)];
    let to = |metres: f64| ((metres + reach) * Lattice::OCC3D.per_m()).ceil() as i32;
    let size = |axis: usize, high: f64| usize::try_from(to(high).saturating_sub(from[axis])).unwrap_or(0);
    Extent::new(from, [size(0, high.x), size(1, high.y)])
}

/// What stands still in a drive.
pub(crate) struct SurveyedWorld {
    /// Map layers with the measured relief.
    pub(crate) layout: BevLayout,
    /// Voxels.
    pub(crate) voxels: VoxelGrid,
    /// Points left out because others saw through them, and points that stand on the ground, these among them.
    pub(crate) seen_through: usize,
    pub(crate) standing: usize,
    /// Points above or below the map.
    pub(crate) off_heights: usize,
}

impl SurveyedWorld {
    /// The world with drafts of objects that are known.
    pub(crate) fn with_drafts<'a>(mut self, boxes: impl Iterator<Item = &'a SceneBox>) -> Self {
        boxes.for_each(|b| draft::stamp_box(&mut self.voxels, b));
        self
    }

    /// The scene that stands still, with these objects: what is in them gets their class.
    pub(crate) fn scene(mut self, name: &str, boxes: BTreeMap<BoxId, SceneBox>) -> Scene {
        boxes.values().for_each(|b| relabel(&mut self.voxels, b));
        let background = infer::background(&self.voxels, &self.layout);
        let frame = Frame {
            inferred: Inferred {
                layout: true,
                boxes: boxes.keys().copied().collect(),
                background: !background.is_empty(),
                ..Inferred::default()
            },
            ..Frame::new(self.layout, boxes, self.voxels)
        };
        let mut scene = Scene::single(name, frame, Arc::new(SensorRig::default()), 0);
        scene.background = Arc::new(background);
        scene
    }

    /// Notes for a person.
    pub(crate) fn notes(&self) -> Vec<String> {
        let share = self.seen_through as f64 / self.standing.max(1) as f64;
        let mut out = Vec::new();
        if share > MISFIT_SHARE {
            out.push(format!(
                "the poses do not fit: other sweeps saw through {:.0} % of what stands (poses of another sensor, inverted, or in \
                 another order?)",
                100.0 * share
            ));
        } else if self.seen_through > 0 {
            out.push(format!(
                "{} points of what moves are left out of the voxels",
                self.seen_through
            ));
        }
        if self.off_heights > 0 {
            out.push(format!("{} points lie above or below the map", self.off_heights));
        }
        out
    }
}

fn together(
    sweeps: &[PlacedSurvey],
    extent: Extent,
    moving: &[Vec<SceneBox>],
    told: &[Option<Class>],
) -> Option<SurveyedWorld> {
    let passed = passed(sweeps);
    let (mut points, mut of_sweep) = (Vec::new(), Vec::new());
    for (i, sweep) in sweeps.iter().enumerate() {
        for p in &sweep.survey.points {
            let at = sweep.world_from_sensor.apply(*p);
            let boxes = moving.get(i).map_or(&[][..], Vec::as_slice);
            let is_moving = || boxes.iter().any(|b| near(b, at) && b.contains(at, BESIDE_M));
            if extent.column_at(at.x, at.y).is_some() && !is_moving() {
                points.push(at);
                of_sweep.push(i);
            }
        }
    }
    if points.is_empty() {
        return None;
    }
    let shapes = shapes(&points, extent, &passed);
    let panoramas: Vec<Panorama> = sweeps.iter().map(|s| Panorama::of(&s.survey.points)).collect();
    let sensors: Vec<Pose> = sweeps.iter().map(|s| s.world_from_sensor.inverse()).collect();
    let stands: Vec<bool> = (0..points.len())
        .map(|i| !shapes.classes[i].is_ground() && shapes.above_m[i] >= STANDS_M)
        .collect();
    let through: Vec<bool> = (0..points.len())
        .map(|i| stands[i] && is_seen_through(points[i], of_sweep[i], &panoramas, &sensors))
        .collect();
    let moved = moved(extent, &points, &stands, &through);
    let mut out = SurveyedWorld {
        layout: BevLayout::over(extent),
        voxels: VoxelGrid::over(extent),
        seen_through: 0,
        standing: stands.iter().filter(|stands| **stands).count(),
        off_heights: 0,
    };
    let mut votes = Vec::with_capacity(points.len());
    // Sums and counts of the heights of road, and of other ground, in each column.
    let mut heights = vec![[(0.0f64, 0u32); 2]; extent.columns()];
    for (i, p) in points.iter().enumerate() {
        if moved[i] {
            out.seen_through += 1;
            continue;
        }
        let Some([x, y]) = extent.column_at(p.x, p.y) else {
            continue;
        };
        let column = extent.index(x, y);
        let class = match shapes.classes[i] {
            class if class.is_ground() => told.get(column).copied().flatten().unwrap_or(class),
            class => class,
        };
        let z = match class.is_ground() {
            true => {
                let is_beside = usize::from(shapes.classes[i] != Class::DriveableSurface);
                let (sum, count) = &mut heights[column][is_beside];
                (*sum, *count) = (*sum + p.z, *count + 1);
                (p.z > extent.min_m().z).then(|| Lattice::OCC3D.ground_bin(p.z))
            }
            false => extent.voxel_at(*p).map(|[.., z]| z),
        };
        match z {
            Some(z) => votes.push(((column * extent.nz() + z) as u32, class.id())),
            None => out.off_heights += 1,
        }
    }
    votes.sort_unstable();
    for votes in votes.chunk_by(|a, b| a.0 == b.0) {
        let winner = votes.chunk_by(|a, b| a == b).max_by_key(|same| {
            (
                same.len(),
                same[0].1 != Class::Others.id(),
                std::cmp::Reverse(same[0].1),
            )
        });
        if let Some(winner) = winner {
            let at = winner[0].0 as usize;
            let [x, y] = extent.column(at / extent.nz());
            out.voxels.set(x, y, at % extent.nz(), winner[0].1);
        }
    }
    out.layout.relief = relief(extent, &heights);
    lay_ground(&mut out, told);
    let relief = std::mem::take(&mut out.layout.relief);
    out.layout = infer::layout(&out.voxels);
    out.layout.relief = relief;
    (!votes.is_empty()).then_some(out)
}

/// Places that the vehicle passed, half a metre apart, with the ground that it stood on.
fn passed(sweeps: &[PlacedSurvey]) -> Vec<Passed> {
    let ground = |sweep: &PlacedSurvey| {
        let up = sweep.world_from_sensor.rotation * sweep.up;
        (sweep.foot_m, -up.truncate() / up.z.max(0.1))
    };
    let mut out = Vec::new();
    let mut add = |(foot_m, slope): (DVec3, DVec2)| {
        out.push(Passed {
            at_m: foot_m.truncate(),
            ground: Some((foot_m.z, slope)),
        });
    };
    for two in sweeps.windows(2) {
        let [(from_m, from_slope), (to_m, to_slope)] = [ground(&two[0]), ground(&two[1])];
        let steps = (from_m.distance(to_m) / PASSED_EVERY_M).ceil().clamp(1.0, 200.0) as usize;
        for share in (0..steps).map(|i| i as f64 / steps as f64) {
            add((from_m.lerp(to_m, share), from_slope.lerp(to_slope, share)));
        }
    }
    sweeps.last().into_iter().for_each(|last| add(ground(last)));
    out
}

/// Lays ground whose class is known where no point lies: between the rings of the sweeps.
fn lay_ground(world: &mut SurveyedWorld, told: &[Option<Class>]) {
    let extent = world.layout.extent();
    for ([x, y], class) in extent.all_columns().zip(told) {
        let Some(class) = class else { continue };
        if world
            .voxels
            .column(x, y)
            .iter()
            .any(|label| *label != Class::FREE)
        {
            continue;
        }
        world
            .voxels
            .set(x, y, draft::ground_bin(&world.layout, x, y), class.id());
    }
}

/// The relief of measured ground, from sums and counts of heights of road and of other ground in each column. Walkways lie higher than
/// the relief: other ground counts where no road is near.
fn relief(extent: Extent, heights: &[[(f64, u32); 2]]) -> Relief {
    let mean = |(sum, n): (f64, u32)| match n {
        0 => f32::NAN,
        n => (sum / f64::from(n)) as f32,
    };
    let mut known: Vec<f32> = heights.iter().map(|[road, _]| mean(*road)).collect();
    let is_near_road = |[x, y]: [usize; 2]| {
        let xs = x.saturating_sub(BESIDE_ROAD)..=(x + BESIDE_ROAD).min(extent.nx() - 1);
        xs.into_iter().any(|x| {
            let ys = y.saturating_sub(BESIDE_ROAD)..=(y + BESIDE_ROAD).min(extent.ny() - 1);
            ys.into_iter().any(|y| heights[extent.index(x, y)][0].1 > 0)
        })
    };
    for (c, at) in extent.all_columns().enumerate() {
        if heights[c][1].1 > 0 && known[c].is_nan() && !is_near_road(at) {
            known[c] = mean(heights[c][1]);
        }
    }
    let all = known.iter().filter(|h| !h.is_nan());
    let level = all.clone().filter(|h| h.abs() <= LEVEL_M).count();
    match level as f64 >= LEVEL_SHARE * all.count() as f64 {
        true => Relief::FLAT,
        false => infer::smooth_relief(extent, &known),
    }
}

fn near(b: &SceneBox, p: DVec3) -> bool {
    let reach_m = b.size_m.length() / 2.0 + 1.0;
    p.distance_squared(b.center_m) <= reach_m * reach_m
}

/// True if more sweeps saw through a place than met something there.
fn is_seen_through(at: DVec3, of_sweep: usize, panoramas: &[Panorama], sensors: &[Pose]) -> bool {
    let (mut through, mut met) = (0, 0);
    let asked = ASKED
        .iter()
        .flat_map(|by| [of_sweep.checked_sub(*by), Some(of_sweep + by)]);
    for i in asked.flatten().filter(|i| *i < panoramas.len()) {
        let p = sensors[i].apply(at);
        let away_m = p.length();
        let Some((nearest_m, is_met)) = panoramas[i].towards(p, away_m) else {
            continue;
        };
        through += usize::from(!is_met && nearest_m > away_m + PASSED_M);
        met += usize::from(is_met);
    }
    through >= LEAST_THROUGH && through > met
}

/// Points that moved: of voxels that hold mostly points that others saw through.
fn moved(extent: Extent, points: &[DVec3], stands: &[bool], through: &[bool]) -> Vec<bool> {
    let voxel = |p: &DVec3| {
        extent
            .voxel_at(*p)
            .map(|[x, y, z]| extent.index(x, y) * extent.nz() + z)
    };
    let mut counts = vec![(0u32, 0u32); extent.voxels()];
    for ((p, stands), through) in points.iter().zip(stands).zip(through) {
        if let Some(voxel) = voxel(p).filter(|_| *stands) {
            counts[voxel].0 += 1;
            counts[voxel].1 += u32::from(*through);
        }
    }
    let is_moved = |((p, stands), through): ((&DVec3, &bool), &bool)| {
        let of_voxel = voxel(p).map(|voxel| counts[voxel]);
        let mostly = of_voxel.is_some_and(|(all, moved)| f64::from(moved) >= MOVED_SHARE * f64::from(all));
        *stands && (mostly || *through)
    };
    points.iter().zip(stands).zip(through).map(is_moved).collect()
}

/// How far a sensor sees in each direction.
struct Panorama {
    /// Nearest and farthest return of each cell, m; infinite and 0 without any.
    cells: Vec<[f32; 2]>,
}

impl Panorama {
    const WIDE: usize = (360.0 / CELL_DEG) as usize;
    const HIGH: usize = (2.0 * REACH_DEG / CELL_DEG) as usize;

    fn of(points: &[DVec3]) -> Self {
        let mut cells = vec![[f32::INFINITY, 0.0]; Self::WIDE * Self::HIGH];
        for p in points {
            if let Some([turn, up]) = Self::cell(*p) {
                let cell = &mut cells[turn * Self::HIGH + up];
                let away_m = p.length() as f32;
                *cell = [cell[0].min(away_m), cell[1].max(away_m)];
            }
        }
        Self { cells }
    }

    fn cell(p: DVec3) -> Option<[usize; 2]> {
        let flat = DVec2::new(p.x, p.y);
        let turn = flat.to_angle().to_degrees().rem_euclid(360.0) / CELL_DEG;
        let up = (p.z.atan2(flat.length()).to_degrees() + REACH_DEG) / CELL_DEG;
        (up >= 0.0 && (up as usize) < Self::HIGH).then_some([turn as usize % Self::WIDE, up as usize])
    }

    /// The nearest return in the cell of a place and those beside it, m, and whether one of them is as far away as the place; `None`
    /// without any in the cell itself.
    fn towards(&self, p: DVec3, away_m: f64) -> Option<(f64, bool)> {
        let [turn, up] = Self::cell(p)?;
        if self.cells[turn * Self::HIGH + up][1] == 0.0 {
            return None;
        }
        let (mut nearest_m, mut is_met) = (f32::INFINITY, false);
        for turn in [turn + Self::WIDE - 1, turn, turn + 1] {
            for up in up.saturating_sub(1)..=(up + 1).min(Self::HIGH - 1) {
                let cell = self.cells[turn % Self::WIDE * Self::HIGH + up];
                nearest_m = nearest_m.min(cell[0]);
                is_met |= cell.iter().any(|m| (f64::from(*m) - away_m).abs() <= MET_M);
            }
        }
        Some((f64::from(nearest_m), is_met))
    }
}

/// Gives the voxels of an object its class.
fn relabel(grid: &mut VoxelGrid, b: &SceneBox) {
    let extent = grid.extent();
    let grown = SceneBox {
        size_m: b.size_m + DVec3::new(2.0 * OWN_M, 2.0 * OWN_M, 0.0),
        ..*b
    };
    let [bottom_m, top_m] = [-1.0, 1.0].map(|side| b.center_m.z + side * b.size_m.z / 2.0);
    for (x, y, _) in draft::box_columns(extent, &grown) {
        for z in 0..extent.nz() {
            let height_m = extent.center(x, y, z).z;
            let label = grid.get(x, y, z);
            let stands = Class::from_id(label).is_some_and(|c| c != Class::Free && !c.is_ground());
            if stands && (bottom_m..=top_m + OWN_M).contains(&height_m) {
                grid.set(x, y, z, b.class.id());
            }
        }
    }
}

#[cfg(test)]
#[path = "survey_tests.rs"]
mod tests;
