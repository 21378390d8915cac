//! Scenery drawn by a network: a map is sampled, extruded on the ground, and things are inferred from it.

use std::sync::Arc;

use crate::contract::GenError;
use diffusion::solver::{Branch, Denoiser, Guidance, Sampler, SolverKind};
use nets::column_heights;
use nets::scenery::{self, CELLS, NAMED, NUMBERS, SceneryCondition, SceneryNet, columns_of};
use numeric::philox::{Stream, normal_field};
use scene::{Background, BevLayer, Class, Scene, VoxelGrid, Window, draft, infer, raster};

/// Steps of the sampler.
const STEPS: usize = 16;
/// Bins above a road from which crowns may hang over it: 2.8 m.
const CLEARANCE: u8 = 7;
/// Indices into a cell's numbers: whether something stands there, followed by its heights.
const BUILT: usize = 0;
const LOW: usize = 2;
const GROWN: usize = 4;

/// The things that the network of `net` draws for a scene's frame in `columns` (`[x][y]`), to suit the road and the
/// voxels that stand elsewhere in its occupancy. `named`: vegetation, building and clutter if the user chose them, 0 to
/// 1.
pub fn drawn_scenery(
    net: &Arc<SceneryNet>,
    scene: &Scene,
    columns: &[bool],
    named: [Option<f32>; NAMED],
    seed: u64,
) -> Result<Background, GenError> {
    let frame = scene.frame();
    let bare = draft::draft(&frame.layout, frame.boxes.values());
    let heights = column_heights(&bare, &frame.occupancy);
    let drawn: Vec<bool> = (0..CELLS)
        .map(|cell| columns_of(cell).all(|c| columns[c]))
        .collect();
    let condition = SceneryCondition {
        bev: raster::bev_channels(&frame.layout, frame.boxes.values()),
        ground: heights.iter().map(|h| h.ground).collect(),
        stands: scenery::map_of(&heights),
        drawn: drawn.clone(),
        named,
    };
    let sampler = Sampler::standard(SolverKind::Ddim, STEPS, Guidance::NONE)?;
    let start = normal_field(seed, Stream::Scenery, CELLS, NUMBERS);
    let mut drawing = SceneryDenoiser {
        net: net.clone(),
        condition,
    };
    let states = sampler.sample(start, &mut drawing, |_| Ok(()))?;
    let map = states.last().ok_or_else(|| GenError::failed("no state"))?;
    let mut grid = bare;
    for cell in (0..CELLS).filter(|cell| drawn[*cell]) {
        extrude(
            &map[cell * NUMBERS..][..NUMBERS],
            cell,
            &drawing.condition,
            &mut grid,
        );
    }
    Ok(infer::background(&grid, &frame.layout))
}

/// Extrudes a cell of a map into free voxels of a grid. Objects keep their voxels, nothing manmade is put on the road,
/// and crowns over it keep the clearance.
fn extrude(numbers: &[f64], cell: usize, condition: &SceneryCondition, grid: &mut VoxelGrid) {
    let bins = |at: usize| scenery::bins_above(numbers[at] as f32).round().max(0.0) as u8;
    let mut parts = Vec::new();
    for at in [BUILT, LOW] {
        if numbers[at] > 0.0 {
            parts.push((Class::Manmade, 0, bins(at + 1).max(1)));
        }
    }
    if numbers[GROWN] > 0.0 {
        let top = bins(GROWN + 1).max(1);
        parts.push((Class::Vegetation, bins(GROWN + 2).min(top - 1), top));
    }
    for c in columns_of(cell) {
        let road = condition.bev[c] & BevLayer::DrivableArea.bit() != 0;
        let column = grid.column_mut(c / Window::NY, c % Window::NY);
        for (class, base, top) in &parts {
            let base = if road { (*base).max(CLEARANCE) } else { *base };
            if road && *class == Class::Manmade {
                continue;
            }
            let bins = base..*top;
            for z in bins
                .map(|z| usize::from(condition.ground[c] + z))
                .filter(|z| *z < Window::NZ)
            {
                if column[z] == Class::FREE {
                    column[z] = class.id();
                }
            }
        }
    }
}

/// The network as a sampler sees it.
struct SceneryDenoiser {
    net: Arc<SceneryNet>,
    condition: SceneryCondition,
}

impl Denoiser for SceneryDenoiser {
    type Error = GenError;

    fn predict(&mut self, x: &[f64], t: f64, _: Branch) -> Result<Vec<f64>, GenError> {
        let x: Vec<f32> = x.iter().map(|v| *v as f32).collect();
        let v = self
            .net
            .forward(&x, t as f32, &self.condition)
            .map_err(GenError::failed)?;
        Ok(v.into_iter().map(f64::from).collect())
    }
}
