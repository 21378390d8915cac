//! Crisp camera maps: one exact ray per pixel through the voxels, instead of splats. Where a box
//! stands its analytic solids may take the place of its voxels, and lines on the road are drawn from
//! their polylines, so edges are finer than a voxel.

pub mod ground;
pub mod paint;
pub mod solids;

use std::collections::BTreeMap;
use std::ops::Range;

use glam::{DVec2, DVec3};
use rayon::prelude::*;

use super::scenery::SceneryShapes;
use crate::raycast::ColumnMasks;
pub use crate::raycast::rays::CameraRays;
use crate::raycast::units::Units;
pub use ground::GroundHeight;
use ground::GroundHeightField;
use paint::RoadMarkings;
use scene::raster::box_cells;
use scene::sensor_data::RenderId;
use scene::{BevLayout, BoxId, Camera, CameraMaps, Class, Lattice, SceneBox, SensorRig, VoxelGrid};
use solids::{SolidHit, SolidIndex};

/// Columns this far outside a box still belong to it, m: voxels stick out by up to half of one.
const FOOTPRINT_MARGIN_M: f64 = 0.3;
/// Voxels this far above a box's top or below its bottom still belong to it, m (the label smear is 0.8).
const HEIGHT_MARGIN_M: f64 = 0.5;
const SMEAR_M: f64 = 0.8;
/// Pixels of a row that share a list of the boxes that may cover them.
const PIECE: usize = 16;
/// Rows that are turned from hits into maps at a time.
const BAND: usize = 256;

/// Options of the marched maps.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MarchOptions {
    /// Where the ground lies.
    pub ground: GroundHeight,
    /// True to draw analytic solids instead of the voxels of boxes.
    pub boxes: bool,
    /// True to draw lines and crossings on the road as render ids 17 to 19.
    pub lines: bool,
    /// Number that varies the solids of a box together with its id.
    pub seed: u64,
}

impl Default for MarchOptions {
    /// Boxes and lines as exact as they are known, ground as labelled, as the splats show it.
    fn default() -> Self {
        Self {
            ground: GroundHeight::AsLabelled,
            boxes: true,
            lines: true,
            seed: 0,
        }
    }
}

/// A frame prepared for marching: some milliseconds to build, then shared by all cameras.
pub struct MarchScene {
    units: Units,
    grid: VoxelGrid,
    masks: ColumnMasks,
    ground: GroundHeightField,
    solids: SolidIndex,
    scenery: Option<SceneryShapes>,
    paint: RoadMarkings,
}

/// First surface on a ray.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MarchHit {
    /// Distance in units of the direction's length (m for a unit vector); 0 inside a voxel.
    pub t: f64,
    /// Render id: a class, or 17 to 19 for paint.
    pub id: RenderId,
    /// Outward unit normal of the face.
    pub normal: DVec3,
    /// The box whose solid was hit.
    pub box_id: Option<BoxId>,
}

/// Hits of all pixels of one camera, row-major, `height * width` values.
#[derive(Clone, Debug, PartialEq)]
pub struct MarchMaps {
    /// Pixels per row.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// The first surface through the middle of each pixel, `t` along the optical axis in m.
    pub hits: Vec<Option<MarchHit>>,
}

impl MarchScene {
    /// Prepares voxels, layout and boxes.
    pub fn new(
        occupancy: &VoxelGrid,
        layout: &BevLayout,
        boxes: &BTreeMap<BoxId, SceneBox>,
        options: &MarchOptions,
    ) -> Self {
        let (mut grid, mut ground) = ground::split(occupancy, options.ground);
        let drawn: Vec<&SceneBox> = boxes.values().filter(|_| options.boxes).collect();
        for b in &drawn {
            remove_voxels(&mut grid, &mut ground, b, options.ground, FOOTPRINT_MARGIN_M);
        }
        ground.fill_wanted();
        let paint = if options.lines {
            RoadMarkings::new(layout)
        } else {
            RoadMarkings::default()
        };
        let extent = grid.extent();
        Self {
            units: Units::from_extent(extent),
            masks: ColumnMasks::from_grid(&grid),
            grid,
            ground,
            solids: SolidIndex::of_boxes(extent, drawn.into_iter(), options.seed),
            scenery: None,
            paint,
        }
    }

    /// Casts solids of scenery of the same map instead of the voxels that they stand for.
    pub fn with_scenery(mut self, scenery: Option<SceneryShapes>) -> Self {
        if let Some(scenery) = &scenery {
            scenery.remove_from(&mut self.grid);
            self.masks = ColumnMasks::from_grid(&self.grid);
        }
        self.scenery = scenery;
        self
    }

    /// The first surface along a ray of the ego frame. `direction` need not have unit length; `None`
    /// for NaN and infinite input and for a zero direction.
    pub fn cast(&self, origin_in_ego: DVec3, direction: DVec3) -> Option<MarchHit> {
        self.cast_among(origin_in_ego, direction, |unit, limit_m| {
            self.solids.cast(origin_in_ego, unit, limit_m)
        })
    }

    #[inline]
    fn cast_among<'a>(
        &self,
        origin_in_ego: DVec3,
        direction: DVec3,
        solids: impl FnOnce(DVec3, f64) -> Option<SolidHit<'a>>,
    ) -> Option<MarchHit> {
        let speed = direction.length();
        if !(origin_in_ego.is_finite() && speed.is_finite() && speed > 1e-12) {
            return None;
        }
        let (origin, unit) = (self.units.to_voxels(origin_in_ego), direction / speed);
        let ground = self.ground.cast(origin, unit, f64::INFINITY);
        let mut best = ground.as_ref().map_or(f64::INFINITY, |h| h.t);
        let mut hit = ground.map(|h| {
            let p = self.units.to_ego(origin + unit * h.t).truncate();
            (self.road_id(h.class, h.normal, p), h.normal, None)
        });
        if let Some(s) = solids(unit, best * Lattice::OCC3D.voxel_m()) {
            best = s.t_m / Lattice::OCC3D.voxel_m();
            let id = s.solid.class.id();
            hit = Some((id, s.solid.normal_at(s.origin + unit * s.t_m), s.box_id));
        }
        let scenery = self.scenery.as_ref();
        if let Some(s) = scenery.and_then(|s| s.cast(origin_in_ego, unit, best * Lattice::OCC3D.voxel_m())) {
            best = s.t_m / Lattice::OCC3D.voxel_m();
            hit = Some((
                s.solid.class.id(),
                s.solid.normal_at(s.origin + unit * s.t_m),
                None,
            ));
        }
        // Last, since it costs most and ends at the hit found so far. A voxel at exactly that distance does not replace
        // it.
        if let Some((t, voxel)) = self.masks.cast_in_voxels(origin, unit, best)
            && (t < best || hit.is_none())
        {
            best = t;
            let normal = face_normal(origin, unit, t, voxel);
            let p = self.units.to_ego(origin + unit * t).truncate();
            hit = Some((self.road_id(self.label(voxel), normal, p), normal, None));
        }
        hit.map(|(id, normal, box_id)| MarchHit {
            t: best * Lattice::OCC3D.voxel_m() / speed,
            id,
            normal,
            box_id,
        })
    }

    fn label(&self, [x, y, z]: [usize; 3]) -> u8 {
        // A label outside the table means a damaged grid: shown as others.
        Some(self.grid.get(x, y, z))
            .filter(|v| *v < Class::FREE)
            .unwrap_or(0)
    }

    /// Paint lies only on top of the road.
    fn road_id(&self, label: u8, normal: DVec3, p: DVec2) -> RenderId {
        if label == Class::DriveableSurface.id() && normal.z > 0.5 {
            return self.paint.render_id(p).unwrap_or(label);
        }
        label
    }

    /// Marches one camera at `width` x `height` pixels (0 gives empty maps).
    pub fn render(&self, camera: &Camera, width: u32, height: u32) -> MarchMaps {
        MarchMaps {
            width: width as usize,
            height: height as usize,
            hits: self.rows(camera, [width, height], 0..height as usize),
        }
    }

    /// The hits of some rows of a picture of that size.
    fn rows(&self, camera: &Camera, size: [u32; 2], rows: Range<usize>) -> Vec<Option<MarchHit>> {
        let w = size[0] as usize;
        let mut hits = vec![None; w * rows.len()];
        if !hits.is_empty() {
            let rays = CameraRays::new(camera, size[0], size[1]);
            let boxes = self.solids.in_view(&rays);
            hits.par_chunks_mut(w).enumerate().for_each(|(i, row)| {
                let v = (rows.start + i) as f64 + 0.5;
                let boxes = boxes.row(v);
                for (i, piece) in row.chunks_mut(PIECE).enumerate() {
                    let first = i * PIECE;
                    let boxes = boxes.piece(first as f64, (first + PIECE) as f64);
                    for (u, out) in piece.iter_mut().enumerate() {
                        let ray = rays.at((first + u) as f64 + 0.5, v);
                        *out = self.cast_among(ray.origin, ray.direction, |unit, limit_m| {
                            self.solids
                                .cast_pixel(&boxes, (ray.origin, unit), ray.after_s, limit_m)
                        });
                    }
                }
            });
        }
        hits
    }

    /// The maps of [`MarchMaps::into_camera_maps`], made a band of rows at a time: hits take four times the memory of maps.
    pub fn render_maps(&self, camera: &Camera, width: u32, height: u32) -> CameraMaps {
        let mut maps = CameraMaps {
            camera: camera.name.clone(),
            width: width as usize,
            height: height as usize,
            semantic: Vec::new(),
            depth_m: Vec::new(),
            expected_m: Vec::new(),
            median_m: Vec::new(),
            coverage: Vec::new(),
        };
        let pixels = maps.width * maps.height;
        maps.semantic.reserve_exact(pixels);
        for plane in [
            &mut maps.depth_m,
            &mut maps.expected_m,
            &mut maps.median_m,
            &mut maps.coverage,
        ] {
            plane.reserve_exact(pixels);
        }
        for first in (0..maps.height).step_by(BAND) {
            let rows = first..(first + BAND).min(maps.height);
            let band = MarchMaps {
                width: maps.width,
                height: rows.len(),
                hits: self.rows(camera, [width, height], rows),
            };
            let band = band.into_camera_maps("");
            maps.semantic.extend(band.semantic);
            maps.depth_m.extend(band.depth_m);
            maps.expected_m.extend(band.expected_m);
            maps.median_m.extend(band.median_m);
            maps.coverage.extend(band.coverage);
        }
        maps
    }

    /// The maps of every camera of a rig, in the rig's order.
    pub fn render_rig(&self, rig: &SensorRig, width: u32, height: u32) -> Vec<CameraMaps> {
        let cameras = rig.cameras.par_iter();
        cameras.map(|c| self.render_maps(c, width, height)).collect()
    }
}

impl MarchMaps {
    /// Labels, depths along the optical axis and coverage (1 on every hit) as the splats give them.
    pub fn into_camera_maps(self, camera: &str) -> CameraMaps {
        let depth_m: Vec<f32> = self
            .hits
            .iter()
            .map(|h| h.as_ref().map_or(-1.0, |h| h.t as f32))
            .collect();
        CameraMaps {
            camera: camera.into(),
            width: self.width,
            height: self.height,
            semantic: self.hits.iter().map(|h| h.as_ref().map_or(0, |h| h.id)).collect(),
            // One surface with all the weight: its depth in every sense.
            coverage: depth_m.iter().map(|d| f32::from(*d >= 0.0)).collect(),
            expected_m: depth_m.iter().map(|d| d.max(0.0)).collect(),
            median_m: depth_m.clone(),
            depth_m,
        }
    }
}

/// Removes the voxels that a box's solids stand for, up to `margin_m` outside its footprint.
pub(crate) fn remove_voxels(
    grid: &mut VoxelGrid,
    ground: &mut GroundHeightField,
    b: &SceneBox,
    height: GroundHeight,
    margin_m: f64,
) {
    if b.problem().is_some() {
        return;
    }
    let (bottom, top) = (
        b.center_m.z - b.size_m.z / 2.0,
        b.center_m.z + b.size_m.z / 2.0 + HEIGHT_MARGIN_M,
    );
    let bottom = match height {
        // The smear of the labels below the object stays: it joins the solids to the low ground.
        GroundHeight::AsLabelled => bottom,
        GroundHeight::Physical => bottom - SMEAR_M - HEIGHT_MARGIN_M,
    };
    let extent = grid.extent();
    box_cells(extent, b, margin_m, |x, y| {
        for z in 0..Lattice::OCC3D.bins() {
            let middle = extent.center(x, y, z).z;
            if (bottom..top).contains(&middle) && grid.get(x, y, z) == b.class.id() {
                grid.set(x, y, z, Class::FREE);
                ground.want(x, y);
            }
        }
    });
}

/// Normal of the face of `voxel` that the ray enters by at `t`.
fn face_normal(origin: DVec3, unit: DVec3, t: f64, voxel: [usize; 3]) -> DVec3 {
    let p = origin + unit * t;
    let mut best = (f64::INFINITY, DVec3::Z);
    for axis in 0..3 {
        let d = unit[axis];
        if d == 0.0 {
            continue;
        }
        let plane = voxel[axis] as f64 + if d > 0.0 { 0.0 } else { 1.0 };
        let gap = (p[axis] - plane).abs();
        if gap < best.0 {
            let mut normal = DVec3::ZERO;
            normal[axis] = -d.signum();
            best = (gap, normal);
        }
    }
    best.1
}

#[cfg(test)]
mod tests;
