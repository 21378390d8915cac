//! A small network that perceives a scene from one LiDAR sweep: what stands in each column of the window, and boxes of things
//! by their centres. Twin of `training/models/lidar_perceiver.py`, trained by `training/train_perception.py` on procedural
//! worlds. Blocks and levels as in the segmenter of pictures; boxes as in CenterPoint (2006.11275).

pub mod against;
pub mod detection;
pub mod pillars;
pub mod stands;
#[cfg(test)]
mod tests;
mod views;

use std::path::Path;
use std::sync::{Arc, OnceLock};

use glam::Vec3;
use serde::Deserialize;

use crate::encoder::{EncoderLevel, PIECE};
use crate::picture::check_kind;
use crate::unet::UNet;
use crate::{ModelError, check_finite};
use detection::{BOX, Detection, DetectionGroup, decode};
use nn::map::FeatureMap;
use nn::weights::{self, WeightFile, WeightsError};
use nn::{Cpu, Ops};
use pillars::{PILLAR, pillars};
use scene::{LidarSweep, Pose};
use stands::Stands;

/// File name of the weights.
pub const FILE: &str = "lidar_perceiver.safetensors";
/// Score from which on a box counts as detected: the window and its lists show these boxes.
pub const SCORE: f32 = 0.3;
/// Numbers of a cell of the map of boxes: a logit of each group's centre, then those of a box.
const CELL: usize = DetectionGroup::ALL.len() + BOX;

/// Sizes of the network, as its weight file names them.
#[derive(Clone, Debug, PartialEq, Eq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PerceiverConfig {
    /// Channels at 0.8, 1.6 and 3.2 m.
    pub widths: [usize; 3],
    /// Kernels of the blocks at these levels on the way down.
    pub kernels: [Vec<usize>; 3],
}

impl PerceiverConfig {
    fn check(&self) -> Result<(), String> {
        if let Some(bad) = self.widths.iter().find(|w| !(1..=4096).contains(*w)) {
            return Err(format!("widths: expected 1 to 4096, found {bad}"));
        }
        match self.kernels.iter().flatten().find(|k| ![1, 3].contains(*k)) {
            Some(bad) => Err(format!("kernels: expected 1 or 3, found {bad}")),
            None => Ok(()),
        }
    }
}

/// Output of the network for a map of pillars.
#[derive(Clone, Debug, PartialEq)]
pub struct PerceiverOutput {
    /// Logits of what stands in each column, `[x][y][9]` in the order of [`Stands::ALL`].
    pub stands: FeatureMap,
    /// Numbers of each cell of 2 x 2 columns, `[x][y][15]`: logits of centres in the order of [`DetectionGroup::ALL`], then the
    /// numbers of a box.
    pub boxes: FeatureMap,
}

/// Predictions for a sweep.
#[derive(Clone, Debug, PartialEq)]
pub struct Perceived {
    /// Kind of thing that stands in each column of the window, `[x][y]`, 200 x 200 columns of 0.4 m.
    pub stands: Vec<Stands>,
    /// Detected things, the surest first.
    pub detections: Vec<Detection>,
}

/// The network with its weights, on a backend.
pub struct LidarPerceiver<B: Ops = Cpu> {
    ops: B,
    net: UNet<B>,
    norm: B::Norm,
    head: B::Linear,
    boxes: EncoderLevel<B>,
    box_norm: B::Norm,
    box_head: B::Linear,
}

impl LidarPerceiver {
    /// The weights that ship with the program; unpacked once.
    pub fn bundled() -> Result<Arc<Self>, WeightsError> {
        static NET: OnceLock<Arc<LidarPerceiver>> = OnceLock::new();
        if let Some(net) = NET.get() {
            return Ok(net.clone());
        }
        let file = WeightFile::parse(FILE, assets::weights::LIDAR_PERCEIVER)?;
        let net = Self::on(Cpu, file)?;
        Ok(NET.get_or_init(|| Arc::new(net)).clone())
    }

    /// The weights of a file, such as one that `training/train_perception.py` made.
    pub fn load(path: &Path) -> Result<Self, WeightsError> {
        let bytes = weights::read(path)?;
        let name = path.file_name().unwrap_or(path.as_os_str()).to_string_lossy();
        Self::on(Cpu, WeightFile::parse(&name, &bytes)?)
    }
}

impl<B: Ops> LidarPerceiver<B> {
    /// Takes all tensors of a file; refuses one that is missing, misshapen, not finite or unknown.
    pub fn on(ops: B, mut file: WeightFile<'_>) -> Result<Self, WeightsError> {
        check_kind(&file, "lidar_perceiver")?;
        let config: PerceiverConfig = file.config("config")?;
        config
            .check()
            .map_err(|reason| file.config_error("config", reason))?;
        let (w, point, fine) = (&mut file, &[1, 1], config.widths[0]);
        let net = Self {
            net: UNet::new(&ops, w, PILLAR, config.widths, &config.kernels)?,
            norm: ops.load_norm(w, "norm", fine)?,
            head: ops.linear(w, "head", [fine, 4 * Stands::ALL.len()], point)?,
            boxes: EncoderLevel::new(&ops, w, "boxes", fine, &[3])?,
            box_norm: ops.load_norm(w, "box_norm", fine)?,
            box_head: ops.linear(w, "box_head", [fine, CELL], point)?,
            ops,
        };
        file.finish()?;
        Ok(net)
    }

    /// Output of the network for a map of pillars. Errors if its sides are not multiples of 8 columns, it has not 19
    /// numbers a column, or a number is not finite.
    pub fn forward(&self, pillars: FeatureMap) -> Result<PerceiverOutput, ModelError> {
        for (what, side) in [("rows", pillars.rows), ("columns", pillars.columns)] {
            if side == 0 || side % 8 != 0 || side > 4096 {
                return Err(ModelError::OutOfRange {
                    what,
                    found: side,
                    expected: "a multiple of 8 up to 4096",
                });
            }
        }
        let expected = pillars.rows * pillars.columns * PILLAR;
        crate::check_length("pillars", pillars.data.len(), expected)?;
        check_finite("pillars", &pillars.data)?;
        let ops = &self.ops;
        let map = self.net.apply(ops, pillars)?;
        let stands = ops.apply(&self.head, &ops.norm(&self.norm, map.clone())?, PIECE)?;
        let near = self.boxes.apply(ops, map)?;
        let boxes = ops.apply(&self.box_head, &ops.norm(&self.box_norm, near)?, PIECE)?;
        let said = PerceiverOutput {
            stands: ops.download(ops.unfold(&stands)?)?,
            boxes: ops.download(boxes)?,
        };
        check_finite("what stands", &said.stands.data)?;
        check_finite("boxes", &said.boxes.data)?;
        Ok(said)
    }

    /// Predictions for returns: x, y, z (m, in the frame of the vehicle that measured them) and echo strength (0 to
    /// 255) of each. Returns that are not finite or outside the window of 80 x 80 m are left out; without any return
    /// all pillars are empty. Boxes below `score` are left out. The same returns give the same on any number of
    /// threads.
    pub fn perceive(
        &self,
        returns: impl IntoIterator<Item = [f32; 4]>,
        score: f32,
    ) -> Result<Perceived, ModelError> {
        let said = self.forward(pillars(returns))?;
        let (columns, _) = said.stands.data.as_chunks::<{ Stands::ALL.len() }>();
        Ok(Perceived {
            stands: columns.iter().map(Stands::likeliest).collect(),
            detections: decode(&said.boxes, score),
        })
    }

    /// Predictions for a sweep in the frame of a map, seen from its vehicle; boxes from [`SCORE`] on, in the frame of
    /// the vehicle.
    pub fn perceive_sweep(
        &self,
        sweep: &LidarSweep,
        map_from_vehicle: &Pose,
    ) -> Result<Perceived, ModelError> {
        let to_vehicle = map_from_vehicle.inverse();
        let returns = sweep.points.iter().map(|point| {
            let at = to_vehicle.apply(Vec3::from(point.position_in_ego).as_dvec3());
            let [x, y, z] = at.as_vec3().to_array();
            [x, y, z, point.intensity]
        });
        self.perceive(returns, SCORE)
    }
}
