//! The learned LiDAR: occupied voxels through a sparse 3-D UNet, a signed distance field sampled where it pays, NeuS
//! weights, echo strength and lost echoes (UniScene, section 3.3). The UNet sees the scene and no sensor: its features
//! stay when a sensor moves or another pattern looks. Trained by training/models/lidar.py.

pub mod field;
pub mod neus;
pub mod prior;
pub mod sites;
#[cfg(test)]
mod sparse_tests;
pub mod update;

use std::path::Path;
use std::sync::{Arc, OnceLock};

use rayon::prelude::*;
use serde::Deserialize;

use self::field::{
    APPEARANCE, HIDDEN, LidarRay, RAY_INPUTS, RaySampling, Room, SdfHead, SdfHit, SignedDistanceField,
    SiteFeatures, shoot_all,
};
use self::prior::SampleDensity;
use self::sites::{CHILDREN, Sites, TAPS, Volume, physical, surface};
use super::{ModelError, check_finite};
use nn::ops::OpsError;
use nn::weights::{self, WeightFile, WeightsError};
use nn::{Cpu, Ops};
use scene::{Class, VoxelGrid, Window};

/// File name of the weights.
pub const FILE: &str = "lidar.safetensors";
/// Shape of the finest level.
const SHAPE: [usize; 3] = [Window::NX, Window::NY, Window::NZ];
/// Classes that are not free.
const CLASSES: usize = Class::FREE as usize;
/// Rows that go through a linear layer in one piece.
const PIECE: usize = 512;
/// Rays that one thread works on in a row.
const RAYS: usize = 128;
/// Width of the two hidden layers behind a ray.
const RAY_WIDTH: usize = 32;

/// Sizes, as in the weight file's metadata.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LidarConfig {
    /// Channels of the three levels.
    pub widths: [usize; sites::LEVELS],
    /// False for the ablation: a voxel knows only its class and height.
    pub unet: bool,
}

/// Convolutions between the embedding and the heads.
struct Unet<B: Ops> {
    enter: [B::SparseResidual; 2],
    middle: [B::SparseResidual; 2],
    leave: [B::SparseResidual; 2], // level 1, level 0
    down: [B::SparseConvolution; 2],
    up: [B::SparseConvolution; 2], // to level 1, to level 0
}

/// The network, on a backend. Rays are followed through the field on the processor, whatever the backend.
pub struct LidarNet<B: Ops = Cpu> {
    ops: B,
    config: LidarConfig,
    class_table: Vec<f32>,
    height_table: Vec<f32>,
    unet: Option<Unet<B>>,
    norm: B::Norm,
    geometry: B::Linear,
    appearance: B::Linear,
    head: SdfHead,
    ray: [B::Linear; 3],
    trained: String,
}

/// One ray's answer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LearnedRay {
    /// Hit of the ray.
    pub met: SdfHit,
    /// Strength of the echo, 0 to 255.
    pub intensity: f32,
    /// Logit of losing the echo: at 0 or more the network predicts that a real sensor gets none.
    pub drop_logit: f32,
}

impl LearnedRay {
    /// True if at least half of the pulse met a surface.
    pub fn is_hit(&self) -> bool {
        self.met.log_pass <= -std::f32::consts::LN_2
    }

    /// Share of such echoes that a real sensor loses; 1/2 for NaN.
    pub fn drop_probability(&self) -> f32 {
        drop_probability(self.drop_logit)
    }
}

/// 1 / (1 + e^-logit), finite for every logit; 1/2 for NaN.
pub fn drop_probability(logit: f32) -> f32 {
    if logit.is_nan() {
        return 0.5;
    }
    let e = (-logit.abs()).exp();
    if logit >= 0.0 {
        1.0 / (1.0 + e)
    } else {
        e / (1.0 + e)
    }
}

impl LidarNet {
    /// The weights that ship with the program; unpacked once.
    pub fn bundled() -> Result<Arc<Self>, WeightsError> {
        static NET: OnceLock<Arc<LidarNet>> = OnceLock::new();
        if let Some(net) = NET.get() {
            return Ok(net.clone());
        }
        let bytes = assets::weights::LIDAR;
        let net = Self::new(WeightFile::parse(FILE, bytes)?)?;
        Ok(NET.get_or_init(|| Arc::new(net)).clone())
    }

    /// The ablation that ships beside it, trained without the UNet.
    pub fn without_unet() -> Result<Self, WeightsError> {
        let bytes = assets::weights::LIDAR_FLAT;
        Self::new(WeightFile::parse("lidar_flat.safetensors", bytes)?)
    }

    /// `lidar.safetensors` of a folder.
    pub fn from_dir(folder: &Path) -> Result<Arc<Self>, WeightsError> {
        let bytes = weights::read(&folder.join(FILE))?;
        Ok(Arc::new(Self::new(WeightFile::parse(FILE, &bytes)?)?))
    }

    /// Loads the network onto the processor. Takes every tensor of the file.
    pub fn new(w: WeightFile<'_>) -> Result<Self, WeightsError> {
        Self::on(Cpu, w)
    }
}

impl<B: Ops> LidarNet<B> {
    /// Loads the network onto a backend; otherwise as [`LidarNet::new`].
    pub fn on(ops: B, mut w: WeightFile<'_>) -> Result<Self, WeightsError> {
        let config: LidarConfig = w.config("config")?;
        let w0 = config.widths[0];
        if config.widths.iter().any(|v| !(1..=1024).contains(v)) {
            return Err(w.config_error(
                "config",
                format!("widths are {:?}, expected 1 to 1024", config.widths),
            ));
        }
        let unet = match config.unet {
            true => Some(Unet::new(&ops, &mut w, config.widths)?),
            false => None,
        };
        let array = |values: Vec<f32>| -> [f32; HIDDEN] { std::array::from_fn(|i| values[i]) };
        let first = w.take("sdf1.weight", &[HIDDEN, HIDDEN])?;
        let head = SdfHead {
            support: array(w.take("support", &[HIDDEN])?),
            first: std::array::from_fn(|i| std::array::from_fn(|o| first[o * HIDDEN + i])),
            first_bias: array(w.take("sdf1.bias", &[HIDDEN])?),
            second: array(w.take("sdf2.weight", &[1, HIDDEN])?),
            second_bias: w.take("sdf2.bias", &[1])?[0],
            s: w.take("log_s", &[1])?[0].exp(),
        };
        if !(head.s > 0.0 && head.s.is_finite()) {
            let reason = format!(
                "the steepness exp(log_s) is {}, expected finite and above 0",
                head.s
            );
            return Err(w.config_error("log_s", reason));
        }
        let mut linear = |name: &str, inputs, outputs| ops.linear(&mut w, name, [inputs, outputs], &[]);
        let net = Self {
            geometry: linear("geometry", w0, HIDDEN + 4)?,
            appearance: linear("appearance", w0, APPEARANCE)?,
            ray: [
                linear("ray0", RAY_INPUTS, RAY_WIDTH)?,
                linear("ray1", RAY_WIDTH, RAY_WIDTH)?,
                linear("ray2", RAY_WIDTH, 2)?,
            ],
            class_table: w.take("class_table", &[CLASSES, w0])?,
            height_table: w.take("height_table", &[Window::NZ, w0])?,
            norm: ops.load_norm(&mut w, "norm", w0)?,
            unet,
            head,
            trained: format!("lidar ({} steps)", w.metadata("steps").unwrap_or("?")),
            config,
            ops,
        };
        w.finish()?;
        Ok(net)
    }

    /// Name of the weights.
    pub fn name(&self) -> &str {
        &self.trained
    }

    /// Steepness of the NeuS weights, 1/m.
    pub fn steepness(&self) -> f32 {
        self.head.s
    }

    /// The field of a scene in the vertical convention of labels. It depends on the voxels alone: keep it for other
    /// poses and patterns. Labels beyond the table count as `others`.
    pub fn field(&self, grid: &VoxelGrid) -> Result<SignedDistanceField, ModelError> {
        let (keys, classes) = voxels(grid);
        self.field_of(keys, classes)
    }

    /// The field of sorted, unique voxels at their physical height, and their classes.
    pub fn field_of(&self, keys: Vec<u32>, classes: Vec<u8>) -> Result<SignedDistanceField, ModelError> {
        let mut field = SignedDistanceField {
            hidden: vec![SiteFeatures([0.0; HIDDEN]); keys.len() + 1],
            planes: vec![[0.0; 4]; keys.len() + 1],
            appearance: vec![SiteFeatures([0.0; APPEARANCE]); keys.len() + 1],
            cells: SampleDensity::new(&keys, &classes),
            volume: Volume::new(SHAPE, &keys),
            keys,
            classes,
        };
        let SignedDistanceField {
            keys,
            classes,
            hidden,
            planes,
            appearance,
            ..
        } = &mut field;
        self.fill(keys, classes, [hidden, appearance], planes)?;
        Ok(field)
    }

    /// Computes the field's numbers of each voxel: hidden numbers and appearance, planes. The lists may be longer.
    fn fill(
        &self,
        keys: &[u32],
        classes: &[u8],
        [hidden, appearance]: [&mut [SiteFeatures]; 2],
        planes: &mut [[f32; 4]],
    ) -> Result<(), ModelError> {
        if keys.is_empty() {
            return Ok(());
        }
        let ops = &self.ops;
        let normed = ops.norm(&self.norm, self.features(keys, classes)?)?;
        let geometry = ops.download(ops.apply(&self.geometry, &normed, PIECE)?)?.data;
        let looks = ops.download(ops.apply(&self.appearance, &normed, PIECE)?)?.data;
        geometry
            .par_chunks(PIECE * (HIDDEN + 4))
            .zip(looks.par_chunks(PIECE * APPEARANCE))
            .zip(hidden.par_chunks_mut(PIECE))
            .zip(appearance.par_chunks_mut(PIECE))
            .zip(planes.par_chunks_mut(PIECE))
            .try_for_each(|((((geometry, looks), hidden), appearance), planes)| {
                for values in [geometry, looks] {
                    check_finite("features of the LiDAR's voxels", values)?;
                }
                let rows = geometry.chunks_exact(HIDDEN + 4);
                for ((row, hidden), plane) in rows.zip(hidden).zip(planes) {
                    hidden.0.copy_from_slice(&row[..HIDDEN]);
                    plane.copy_from_slice(&row[HIDDEN..]);
                }
                for (row, appearance) in looks.chunks_exact(APPEARANCE).zip(appearance) {
                    appearance.0.copy_from_slice(row);
                }
                Ok(())
            })
    }

    /// Features of the voxels by the UNet, `[site][channel]`.
    fn features(&self, keys: &[u32], classes: &[u8]) -> Result<B::Tensor, OpsError> {
        let width = self.config.widths[0];
        let mut x = vec![0.0; keys.len() * width];
        x.par_chunks_mut(PIECE * width)
            .zip(keys.par_chunks(PIECE))
            .zip(classes.par_chunks(PIECE))
            .for_each(|((x, keys), classes)| {
                for ((x, key), class) in x.chunks_exact_mut(width).zip(keys).zip(classes) {
                    let z = *key as usize % SHAPE[2];
                    let of_class = &self.class_table[usize::from(*class) * width..][..width];
                    let of_height = &self.height_table[z * width..][..width];
                    for ((x, a), b) in x.iter_mut().zip(of_class).zip(of_height) {
                        *x = a + b;
                    }
                }
            });
        let x = self.ops.sequence(x, width)?;
        match &self.unet {
            Some(unet) => unet.apply(&self.ops, x, &Sites::new(SHAPE, keys.to_vec())),
            None => Ok(x),
        }
    }

    /// Hits of rays, in their order, on all cores; the same on any number of threads. Errors if the backend cannot
    /// compute.
    pub fn shoot(
        &self,
        field: &SignedDistanceField,
        rays: &[LidarRay],
        sampling: RaySampling,
    ) -> Result<Vec<LearnedRay>, ModelError> {
        let piece = |rays: &[LidarRay]| {
            let mut met = vec![SdfHit::default(); rays.len()];
            shoot_all(field, &self.head, rays, sampling, &mut Room::default(), &mut met);
            self.heads(&met)
        };
        let pieces: Vec<_> = rays.par_chunks(RAYS).map(piece).collect::<Result<_, _>>()?;
        Ok(pieces.concat())
    }

    /// Signed distances at positions along a ray and what it meets there; for tests and pictures. Errors if the backend cannot
    /// compute.
    pub fn probe(
        &self,
        field: &SignedDistanceField,
        ray: &LidarRay,
        t: &[f32],
    ) -> Result<(Vec<f32>, LearnedRay), ModelError> {
        let [o, d] = [ray.origin, ray.direction].map(|v| v.as_vec3().to_array());
        let f: Vec<f32> = t
            .iter()
            .map(|t| field.sdf(&self.head, std::array::from_fn(|a| o[a] + d[a] * t)))
            .collect();
        let tails: Vec<f32> = f.iter().map(|f| neus::tail(self.head.s * f)).collect();
        let met = field.render(self.head.s, [o, d], [t, &f, &tails], &mut Vec::new());
        Ok((f, self.heads(&[met])?[0]))
    }

    /// Echo strength and drops of some rays.
    fn heads(&self, met: &[SdfHit]) -> Result<Vec<LearnedRay>, OpsError> {
        let (ops, rows) = (&self.ops, met.len());
        let inputs = met.iter().flat_map(|m| m.inputs).collect();
        let mut x = ops.sequence(inputs, RAY_INPUTS)?;
        for (i, layer) in self.ray.iter().enumerate() {
            x = ops.apply(layer, &x, rows)?;
            if i < 2 {
                x = ops.relu(x)?;
            }
        }
        let numbers = ops.download(x)?.data;
        let each = met.iter().zip(numbers.chunks_exact(2));
        Ok(each
            .map(|(met, out)| LearnedRay {
                met: *met,
                intensity: (out[0].clamp(0.0, 1.0).powi(2)) * 255.0,
                drop_logit: out[1],
            })
            .collect())
    }
}

/// The voxels that the network works on, in rising order, and their classes.
fn voxels(grid: &VoxelGrid) -> (Vec<u32>, Vec<u8>) {
    let labels = physical(grid);
    let keys = surface(&labels);
    let classes = keys
        .iter()
        .map(|k| labels[*k as usize].min(CLASSES as u8 - 1))
        .collect();
    (keys, classes)
}

impl<B: Ops> Unet<B> {
    fn new(ops: &B, w: &mut WeightFile<'_>, [w0, w1, w2]: [usize; 3]) -> Result<Self, WeightsError> {
        let strided = |w: &mut WeightFile<'_>, name: &str, from, to| {
            ops.load_sparse(w, name, [CHILDREN, to], &[CHILDREN, from, to])
        };
        let (down, up) = (
            [strided(w, "down0", w0, w1)?, strided(w, "down1", w1, w2)?],
            [strided(w, "up1", w2, w1)?, strided(w, "up0", w1, w0)?],
        );
        let mut block = |name: &str, width| ops.load_sparse_residual(w, name, [TAPS, width]);
        Ok(Self {
            enter: [block("enter0", w0)?, block("enter1", w1)?],
            middle: [block("middle0", w2)?, block("middle1", w2)?],
            leave: [block("leave1", w1)?, block("leave0", w0)?],
            down,
            up,
        })
    }

    fn apply(&self, ops: &B, x: B::Tensor, sites: &Sites) -> Result<B::Tensor, OpsError> {
        let [l0, l1, l2] = &sites.levels;
        // One buffer for all norms: fresh memory costs as much as what is written into it.
        let mut room = B::Room::default();
        let x0 = ops.sparse_residual(&self.enter[0], x, &l0.around, &mut room)?;
        let x1 = ops.sparse(&self.down[0], &x0, &l1.children)?;
        let x1 = ops.sparse_residual(&self.enter[1], x1, &l1.around, &mut room)?;
        let mut x2 = ops.sparse(&self.down[1], &x1, &l2.children)?;
        for block in &self.middle {
            x2 = ops.sparse_residual(block, x2, &l2.around, &mut room)?;
        }
        let x1 = ops.sparse_onto(&self.up[0], &x2, &l1.parent, x1)?;
        let x1 = ops.sparse_residual(&self.leave[0], x1, &l1.around, &mut room)?;
        let x0 = ops.sparse_onto(&self.up[1], &x1, &l0.parent, x0)?;
        ops.sparse_residual(&self.leave[1], x0, &l0.around, &mut room)
    }
}
