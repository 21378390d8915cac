//! Features of occupancy for distribution distances ("F3D"): an encoder with fixed weights that ship as
//! `assets/weights/f3d.safetensors` and never change, so that figures of different models and days can be compared. It
//! is the encoder of the occupancy VAE of this project's second session (commit 5750f81), trained on procedural worlds,
//! labels and drafts.
//!
//! The features of a frame are the means over the 50x50 cells of its 192 channels after the last norm.
//! Published F3D figures come from other extractors and do not compare.

use serde::Deserialize;

use nets::ModelError;
use nets::encoder::OccupancyEncoder;
use nn::Cpu;
use nn::map::CellRect;
use nn::weights::{WeightFile, WeightsError};
use scene::VoxelGrid;

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Config {
    widths: Vec<usize>,
    kernels: Vec<Vec<usize>>,
}

/// The extractor with its weights.
pub struct Extractor {
    encoder: OccupancyEncoder,
    side: usize,
}

impl Extractor {
    /// The extractor that ships with the program.
    pub fn bundled() -> Result<Self, WeightsError> {
        let bytes = assets::weights::F3D;
        let mut file = WeightFile::parse("f3d.safetensors", bytes)?;
        let Config { widths, kernels } = file.config("config")?;
        if widths.len() != 3 || kernels.len() != 3 {
            return Err(file.config_error("config", "expected three levels".into()));
        }
        let encoder = OccupancyEncoder::new(&Cpu, &mut file, &widths, &kernels)?;
        file.finish()?;
        Ok(Self { encoder, side: 50 })
    }

    /// The 192 features of every cell (4 x 4 columns) of a frame before they are pooled, 50 x 50 cells row by row.
    pub fn cells(&self, grid: &VoxelGrid) -> Result<Vec<Vec<f64>>, ModelError> {
        let map = self.encoder.features(&Cpu, grid, CellRect::whole(self.side))?;
        let cells = map.data.chunks_exact(map.width);
        Ok(cells
            .map(|cell| cell.iter().map(|v| f64::from(*v)).collect())
            .collect())
    }

    /// The 192 features of a frame.
    pub fn features(&self, grid: &VoxelGrid) -> Result<Vec<f64>, ModelError> {
        let map = self.encoder.features(&Cpu, grid, CellRect::whole(self.side))?;
        let mut sums = vec![0.0; map.width];
        for cell in map.data.chunks_exact(map.width) {
            sums.iter_mut().zip(cell).for_each(|(s, v)| *s += f64::from(*v));
        }
        let cells = (map.rows * map.columns) as f64;
        Ok(sums.into_iter().map(|s| s / cells).collect())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::frechet::frechet_distance;
    use crate::kernel::{Kernel, mmd2};
    use dataset::occupancy_frame;

    /// Worlds are nearer to other worlds than their drafts are, and those than labels: by F3D and by KID.
    #[test]
    fn distances_rank_what_looks_alike() {
        let extractor = Extractor::bundled().expect("the shipped weights load");
        let frames: Vec<_> = (0..24).map(|i| occupancy_frame(2, i, |_| None)).collect();
        let of = |pick: fn(&dataset::OccupancyFrame) -> &VoxelGrid, part: usize| {
            let some = frames[part * 12..][..12].iter();
            some.map(|f| extractor.features(pick(f)).expect("sound labels"))
                .collect::<Vec<_>>()
        };
        let worlds = of(|f| &f.dense, 0);
        let all = [of(|f| &f.dense, 1), of(|f| &f.draft, 1), of(|f| &f.labels, 1)];
        let f3d = all
            .each_ref()
            .map(|x| frechet_distance(&worlds, x).expect("sound"));
        let kid = all
            .each_ref()
            .map(|x| mmd2(Kernel::Cubic, &worlds, x).expect("sound"));
        assert!(f3d[0] * 2.0 < f3d[1] && f3d[0] * 2.0 < f3d[2], "{f3d:?}");
        assert!(kid[0] < kid[1] && kid[0] < kid[2], "{kid:?}");
    }
}
