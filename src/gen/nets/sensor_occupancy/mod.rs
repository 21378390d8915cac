//! A network that predicts voxels from one LiDAR sweep and the pictures of the cameras, or from either alone. Twin of
//! `training/models/sensor_occupancy.py`, trained by `training/train_sensor_occupancy.py` on procedural worlds. The
//! classes that the segmenter predicts in pictures are painted on the voxels, see `sensors::perceive::voxels`.

#[cfg(test)]
mod tests;

use std::path::Path;
use std::sync::{Arc, OnceLock};

use rayon::prelude::*;
use serde::Deserialize;

use crate::encoder::{HEIGHT, PIECE};
use crate::perceiver::pillars::{PILLAR, pillars};
use crate::picture::{SHOWN, check_kind};
use crate::unet::UNet;
use crate::{ModelError, check_finite, check_length};
use nn::map::FeatureMap;
use nn::weights::{self, WeightFile, WeightsError};
use nn::{Cpu, Ops};
use scene::{Class, VoxelGrid, Window};

/// File name of the weights.
pub const FILE: &str = "sensor_occupancy.safetensors";
/// Class painted on a voxel that no camera sees.
pub const UNSEEN: u8 = SHOWN as u8;
/// Labels of a voxel, free included.
const LABELS: usize = Class::FREE as usize + 1;
/// Numbers of a column's direction from the vehicle, from which rays come.
const WAY: usize = 2;

/// Sizes of the network, as its weight file names them.
#[derive(Clone, Debug, PartialEq, Eq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SensorOccupancyConfig {
    /// Channels at 0.8, 1.6 and 3.2 m.
    pub widths: [usize; 3],
    /// Kernels of the blocks at these levels on the way down.
    pub kernels: [Vec<usize>; 3],
    /// Numbers of a painted class.
    pub paint: usize,
}

impl SensorOccupancyConfig {
    fn check(&self) -> Result<(), String> {
        let sizes = self.widths.iter().chain([&self.paint]);
        if let Some(bad) = sizes.into_iter().find(|w| !(1..=4096).contains(*w)) {
            return Err(format!("widths and paint: expected 1 to 4096, found {bad}"));
        }
        match self.kernels.iter().flatten().find(|k| ![1, 3].contains(*k)) {
            Some(bad) => Err(format!("kernels: expected 1 or 3, found {bad}")),
            None => Ok(()),
        }
    }
}

/// The network with its weights, on a backend.
pub struct SensorOccupancy<B: Ops = Cpu> {
    ops: B,
    /// Numbers of each class that a camera may show, then of [`UNSEEN`].
    paint: Vec<f32>,
    net: UNet<B>,
    norm: B::Norm,
    head: B::Linear,
}

impl SensorOccupancy {
    /// The weights that ship with the program; unpacked once.
    pub fn bundled() -> Result<Arc<Self>, WeightsError> {
        static NET: OnceLock<Arc<SensorOccupancy>> = OnceLock::new();
        if let Some(net) = NET.get() {
            return Ok(net.clone());
        }
        let file = WeightFile::parse(FILE, assets::weights::SENSOR_OCCUPANCY)?;
        let net = Self::on(Cpu, file)?;
        Ok(NET.get_or_init(|| Arc::new(net)).clone())
    }

    /// The weights of a file, such as one that `training/train_sensor_occupancy.py` made.
    pub fn load(path: &Path) -> Result<Self, WeightsError> {
        let bytes = weights::read(path)?;
        let name = path.file_name().unwrap_or(path.as_os_str()).to_string_lossy();
        Self::on(Cpu, WeightFile::parse(&name, &bytes)?)
    }
}

impl<B: Ops> SensorOccupancy<B> {
    /// Takes all tensors of a file; refuses one that is missing, misshapen, not finite or unknown.
    pub fn on(ops: B, mut file: WeightFile<'_>) -> Result<Self, WeightsError> {
        check_kind(&file, "sensor_occupancy")?;
        let config: SensorOccupancyConfig = file.config("config")?;
        config
            .check()
            .map_err(|reason| file.config_error("config", reason))?;
        let (w, fine) = (&mut file, config.widths[0]);
        let inputs = PILLAR + WAY + HEIGHT * config.paint;
        let net = Self {
            paint: w.take("paint.weight", &[SHOWN + 1, config.paint])?,
            net: UNet::new(&ops, w, inputs, config.widths, &config.kernels)?,
            norm: ops.load_norm(w, "norm", fine)?,
            head: ops.linear(w, "head", [fine, 4 * HEIGHT * LABELS], &[1, 1])?,
            ops,
        };
        file.finish()?;
        Ok(net)
    }

    /// Numbers of a column.
    fn inputs(&self) -> usize {
        PILLAR + WAY + HEIGHT * self.paint.len() / (SHOWN + 1)
    }

    /// Logits `[x][y][16][18]` of each voxel's label for a map of columns as `columns` makes them. Errors if the sides
    /// are not multiples of 8 columns, the numbers of a column do not fit, or one is not finite.
    pub fn forward(&self, columns: FeatureMap) -> Result<FeatureMap, ModelError> {
        for (what, side) in [("rows", columns.rows), ("columns", columns.columns)] {
            if side == 0 || side % 8 != 0 || side > 4096 {
                return Err(ModelError::OutOfRange {
                    what,
                    found: side,
                    expected: "a multiple of 8 up to 4096",
                });
            }
        }
        let expected = columns.rows * columns.columns * self.inputs();
        check_length("columns", columns.data.len(), expected)?;
        check_finite("columns", &columns.data)?;
        let ops = &self.ops;
        let map = self.net.apply(ops, columns)?;
        let logits = ops.apply(&self.head, &ops.norm(&self.norm, map)?, PIECE)?;
        let logits = ops.download(ops.unfold(&logits)?)?;
        check_finite("logits", &logits.data)?;
        Ok(logits)
    }

    /// Input of the network: for each column its pillar of returns, its direction from the vehicle, and the classes
    /// painted on its voxels. `painted` is `[x][y][16]`, classes as `scene::truth` counts them, or [`UNSEEN`].
    fn columns(&self, pillars: &FeatureMap, painted: &[u8]) -> FeatureMap {
        let (inputs, paint) = (self.inputs(), self.paint.len() / (SHOWN + 1));
        let middle = |i: usize| (i as f32 + 0.5) * Window::VOXEL_M as f32 + Window::MIN_M[0] as f32;
        let mut data = vec![0.0; Window::COLUMNS * inputs];
        let places = data
            .par_chunks_exact_mut(inputs)
            .zip(pillars.data.par_chunks_exact(PILLAR))
            .zip(painted.par_chunks_exact(HEIGHT))
            .enumerate();
        places.for_each(|(i, ((column, pillar), painted))| {
            column[..PILLAR].copy_from_slice(pillar);
            let [x, y] = [i / Window::NY, i % Window::NY].map(middle);
            let far = x.hypot(y);
            column[PILLAR..PILLAR + WAY].copy_from_slice(&[x / far, y / far]);
            for (out, class) in column[PILLAR + WAY..].chunks_exact_mut(paint).zip(painted) {
                let class = usize::from(*class).min(SHOWN);
                out.copy_from_slice(&self.paint[class * paint..][..paint]);
            }
        });
        FeatureMap {
            data,
            rows: Window::NX,
            columns: Window::NY,
            width: inputs,
        }
    }

    /// Predicts the voxels of the window of 80 x 80 m from a sweep and painted classes: returns as of [`pillars`], none
    /// if the LiDAR is not used; `painted` is `[x][y][16]`, all [`UNSEEN`] if the cameras are not used. The same input
    /// gives the same on any number of threads. Errors if `painted` has another length.
    pub fn voxels(
        &self,
        returns: impl IntoIterator<Item = [f32; 4]>,
        painted: &[u8],
    ) -> Result<VoxelGrid, ModelError> {
        check_length("painted", painted.len(), Window::COLUMNS * HEIGHT)?;
        let logits = self.forward(self.columns(&pillars(returns), painted))?;
        let (voxels, _) = logits.data.as_chunks::<LABELS>();
        let labels: Vec<u8> = voxels.par_iter().map(likeliest).collect();
        VoxelGrid::from_dense(&labels).map_err(|found| ModelError::OutOfRange {
            what: "voxel",
            found,
            expected: "one with a label",
        })
    }
}

/// Label of the largest logit; on a tie the first one.
fn likeliest(logits: &[f32; LABELS]) -> u8 {
    let mut best = 0;
    for (i, logit) in logits.iter().enumerate() {
        if *logit > logits[best] {
            best = i;
        }
    }
    best as u8
}
