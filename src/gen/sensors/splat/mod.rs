//! Camera maps by Gaussian splatting on the CPU: semantics, depth and coverage, after UniScene
//! (arXiv 2412.05435) equations 3 and 4 and 13 to 18.

pub mod cloud;
pub mod order;
pub mod project;
pub(crate) mod tile;

use rayon::prelude::*;

pub use crate::splat::cloud::{Gaussian, GaussianCloud};
pub use scene::splats::{RawMaps, SplatOptions};

use crate::raycast::rays::CameraRays;
use crate::splat::order::depth_order;
use crate::splat::project::{Conic, Footprint, SplatCamera};
use crate::splat::tile::{BlendThresholds, Splat, SplatPixels, TILE, Tile};
use scene::sensor_data::RENDER_IDS;
use scene::splats::MIN_DEPTH_COVERAGE;
use scene::{Camera, CameraMaps, Lens, SensorRig};

/// Size at which the editor shows a camera: a quarter of the nuScenes images.
pub const VIEW_SIZE: [u32; 2] = [400, 225];
/// Size while the user drags.
pub const PREVIEW_SIZE: [u32; 2] = [240, 135];

/// Renders one camera at `width` x `height` pixels (0 gives empty maps).
pub fn render(
    cloud: &GaussianCloud,
    camera: &Camera,
    width: u32,
    height: u32,
    options: &SplatOptions,
) -> CameraMaps {
    let raw = render_raw(cloud, camera, width, height, options);
    raw.into_camera_maps(&camera.name, options)
}

/// Renders every camera of a rig, in the rig's order.
pub fn render_rig(
    cloud: &GaussianCloud,
    rig: &SensorRig,
    width: u32,
    height: u32,
    options: &SplatOptions,
) -> Vec<CameraMaps> {
    let cameras = rig.cameras.par_iter();
    cameras
        .map(|c| render(cloud, c, width, height, options))
        .collect()
}

/// Renders one camera and returns all that was computed. The result does not depend on the number
/// of threads.
pub fn render_raw(
    cloud: &GaussianCloud,
    camera: &Camera,
    width: u32,
    height: u32,
    options: &SplatOptions,
) -> RawMaps {
    let (w, h) = (width as usize, height as usize);
    let mut maps = RawMaps::empty(w, h);
    if w == 0 || h == 0 {
        return maps;
    }
    let splats = project_all(cloud, camera, width, height, options);
    let bins = Bins::new(&splats, w, h);
    let limits = BlendThresholds {
        alpha_min: options.alpha_min,
        alpha_max: options.alpha_max.clamp(0.0, 0.999),
        t_stop: options.t_stop,
    };
    // A job is a row of tiles, which owns whole rows of each map.
    let rows = TILE * w;
    let jobs = (
        maps.coverage.par_chunks_mut(rows),
        maps.expected_m.par_chunks_mut(rows),
        maps.normalised_m.par_chunks_mut(rows),
        maps.median_m.par_chunks_mut(rows),
        maps.label.par_chunks_mut(rows),
        maps.margin.par_chunks_mut(rows),
        maps.transmittance.par_chunks_mut(rows),
    );
    jobs.into_par_iter().enumerate().for_each(
        |(tile_y, (coverage, expected, normalised, median, label, margin, transmittance))| {
            let y0 = tile_y * TILE;
            let rows = TILE.min(h - y0);
            let mut tile = Tile::new();
            for tile_x in 0..w.div_ceil(TILE) {
                let list = bins.list(tile_x, tile_y);
                if list.is_empty() {
                    continue;
                }
                let x0 = tile_x * TILE;
                let columns = TILE.min(w - x0);
                let resolved = tile.draw(&splats, list, [x0, y0], [columns, rows], limits);
                for (row, pixels) in resolved.iter().enumerate().take(rows) {
                    let at = row * w + x0..row * w + x0 + columns;
                    coverage[at.clone()].copy_from_slice(&pixels.coverage[..columns]);
                    expected[at.clone()].copy_from_slice(&pixels.expected_m[..columns]);
                    median[at.clone()].copy_from_slice(&pixels.median_m[..columns]);
                    label[at.clone()].copy_from_slice(&pixels.label[..columns]);
                    margin[at.clone()].copy_from_slice(&pixels.margin[..columns]);
                    transmittance[at.clone()].copy_from_slice(&pixels.transmittance[..columns]);
                    for (column, out) in normalised[at].iter_mut().enumerate() {
                        if pixels.coverage[column] >= MIN_DEPTH_COVERAGE {
                            *out = pixels.expected_m[column] / pixels.coverage[column];
                        }
                    }
                }
            }
        },
    );
    blind(&mut maps, camera, [width, height]);
    maps
}

/// Takes out what splats spread to where the lens sees nothing.
fn blind(maps: &mut RawMaps, camera: &Camera, [width, height]: [u32; 2]) {
    if camera.lens == Lens::Pinhole {
        return;
    }
    let (rays, w) = (CameraRays::new(camera, width, height), width as usize);
    let nothing = RawMaps::empty(1, 1);
    for i in 0..w * height as usize {
        let at = [i % w, i / w].map(|v| v as f64 + 0.5);
        if rays.at(at[0], at[1]).direction == glam::DVec3::ZERO {
            maps.coverage[i] = nothing.coverage[0];
            maps.expected_m[i] = nothing.expected_m[0];
            maps.normalised_m[i] = nothing.normalised_m[0];
            maps.median_m[i] = nothing.median_m[0];
            maps.label[i] = nothing.label[0];
            maps.margin[i] = nothing.margin[0];
            maps.transmittance[i] = nothing.transmittance[0];
        }
    }
}

/// Splats that may touch the image, near to far, equal depths in the cloud's order.
fn project_all(
    cloud: &GaussianCloud,
    camera: &Camera,
    width: u32,
    height: u32,
    options: &SplatOptions,
) -> Vec<SplatPixels> {
    let view = SplatCamera::new(camera, width, height, options.jacobian_clamp);
    let size = [width, height];
    let one = |g: &Gaussian| -> Option<SplatPixels> {
        let position = glam::Vec3::from(g.position_m).as_dvec3();
        let footprint = view.project(position, f64::from(g.std_m), options.near_m, options.far_m)?;
        if usize::from(g.id) >= RENDER_IDS {
            return None;
        }
        placed(&footprint, (g.opacity, g.id), size, options)
    };
    let splats: Vec<SplatPixels> = cloud.gaussians().par_iter().filter_map(one).collect();
    let depths: Vec<f32> = splats.iter().map(|(s, _)| s.depth_m).collect();
    depth_order(&depths)
        .into_iter()
        .map(|i| splats[i as usize])
        .collect()
}

/// A footprint with an opacity and an id as the inner loop wants it, and the pixels of a picture of `size` that it may touch;
/// `None` if it touches none.
pub(super) fn placed(
    footprint: &Footprint,
    (opacity, id): (f32, u8),
    size: [u32; 2],
    options: &SplatOptions,
) -> Option<SplatPixels> {
    let conic = Conic::new(footprint.covariance_px2, options.low_pass_px2)?;
    let mut opacity = opacity.clamp(0.0, 1.0);
    if options.compensate_opacity {
        opacity *= conic.compensation as f32;
    }
    // Not above 0 also drops NaN.
    if !(opacity > 0.0 && opacity >= options.alpha_min) {
        return None;
    }
    let min_exponent = (options.alpha_min / opacity).ln(); // -inf without a threshold
    // Where the exponent meets the threshold; a hair more, since alpha is rounded.
    let reach = (-2.0 * f64::from(min_exponent)).sqrt() + 1e-3;
    let mut bounds = [[0; 2]; 2];
    for axis in 0..2 {
        let (mean, half) = (footprint.mean_px[axis], reach * conic.extent_px[axis]);
        let limit = f64::from(size[axis].min(u32::from(u16::MAX)));
        // Pixel i is sampled at i + 1/2.
        let first = (mean - half - 0.5).ceil().clamp(0.0, limit);
        let end = ((mean + half - 0.5).floor() + 1.0).clamp(0.0, limit);
        if first >= end {
            return None;
        }
        bounds[axis] = [first as u16, end as u16];
    }
    let splat = Splat {
        mean_px: footprint.mean_px.map(|v| v as f32),
        along: (-0.5 * conic.along) as f32,
        shear: conic.shear as f32,
        across: (-0.5 * conic.across) as f32,
        opacity,
        min_exponent,
        depth_m: footprint.depth_m as f32,
        id,
    };
    Some((splat, bounds))
}

/// For each tile the splats that may touch it, near to far.
pub(super) struct Bins {
    tiles_x: usize,
    starts: Vec<u32>,
    splats: Vec<u32>,
}

impl Bins {
    /// Bins of splats that are sorted near to far.
    pub fn new(splats: &[SplatPixels], width: usize, height: usize) -> Bins {
        let (tiles_x, tiles_y) = (width.div_ceil(TILE), height.div_ceil(TILE));
        let tiles = |&[x, y]: &[[u16; 2]; 2]| {
            let range = |[first, end]: [u16; 2]| usize::from(first) / TILE..usize::from(end).div_ceil(TILE);
            range(y).flat_map(move |ty| range(x).map(move |tx| ty * tiles_x + tx))
        };
        let mut starts = vec![0u32; tiles_x * tiles_y + 1];
        for (_, bounds) in splats {
            for tile in tiles(bounds) {
                starts[tile + 1] += 1;
            }
        }
        for i in 1..starts.len() {
            starts[i] += starts[i - 1];
        }
        let mut next = starts.clone();
        let mut lists = vec![0; *starts.last().expect("one more than tiles") as usize];
        for (index, (_, bounds)) in splats.iter().enumerate() {
            for tile in tiles(bounds) {
                lists[next[tile] as usize] = index as u32;
                next[tile] += 1;
            }
        }
        Bins {
            tiles_x,
            starts,
            splats: lists,
        }
    }

    /// The splats of a tile.
    pub fn list(&self, tile_x: usize, tile_y: usize) -> &[u32] {
        let tile = tile_y * self.tiles_x + tile_x;
        &self.splats[self.starts[tile] as usize..self.starts[tile + 1] as usize]
    }
}

#[cfg(test)]
mod tests;
