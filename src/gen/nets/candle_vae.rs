//! The occupancy VAE written once more with candle's own operations, as plainly as it goes: a reference for the fused
//! kernels of `src/gen/model`, in values (`tests/candle.rs`) and in time (`benches/networks.rs`). Maps are [x, y, channels].

use std::collections::HashMap;

use super::occ_vae::VaeConfig;
use candle_core::{D, DType, Device, Result, Tensor, safetensors};

use scene::{Class, GridSpec, VoxelGrid};

const EPSILON: f64 = 1e-6;
const HEIGHT: usize = GridSpec::NZ;

/// Weights by name, f32, on the CPU.
pub struct CandleVae {
    tensors: HashMap<String, Tensor>,
    config: VaeConfig,
}

impl CandleVae {
    /// From the bytes of a weight file; `config` stands in its metadata.
    pub fn new(bytes: &[u8], config: VaeConfig) -> Result<Self> {
        let mut tensors = safetensors::load_buffer(bytes, &Device::Cpu)?;
        for tensor in tensors.values_mut() {
            *tensor = tensor.to_dtype(DType::F32)?;
        }
        Ok(Self { tensors, config })
    }

    fn get(&self, name: &str) -> Result<&Tensor> {
        let missing = || candle_core::Error::Msg(format!("tensor {name} is missing"));
        self.tensors.get(name).ok_or_else(missing)
    }

    /// A 1 x 1 convolution.
    fn linear(&self, name: &str, x: &Tensor) -> Result<Tensor> {
        let weight = self.get(&format!("{name}.weight"))?;
        let (out, inner) = (weight.dim(0)?, weight.dim(1)?);
        let (w, h, _) = x.dims3()?;
        let y = x
            .reshape((w * h, inner))?
            .matmul(&weight.reshape((out, inner))?.t()?)?;
        y.broadcast_add(self.get(&format!("{name}.bias"))?)?
            .reshape((w, h, out))
    }

    fn norm(&self, name: &str, x: &Tensor) -> Result<Tensor> {
        let centered = x.broadcast_sub(&x.mean_keepdim(D::Minus1)?)?;
        let variance = centered.sqr()?.mean_keepdim(D::Minus1)?;
        let normed = centered.broadcast_div(&(variance + EPSILON)?.sqrt()?)?;
        let scaled = normed.broadcast_mul(self.get(&format!("{name}.weight"))?)?;
        scaled.broadcast_add(self.get(&format!("{name}.bias"))?)
    }

    fn block(&self, name: &str, kernel: usize, x: &Tensor) -> Result<Tensor> {
        let normed = self.norm(&format!("{name}.norm"), x)?;
        let first = format!("{name}.conv1");
        let hidden = if kernel == 1 {
            self.linear(&first, &normed)?
        } else {
            let planes = normed.permute((2, 0, 1))?.unsqueeze(0)?.contiguous()?;
            let weight = self.get(&format!("{first}.weight"))?;
            let y = planes.conv2d(weight, kernel / 2, 1, 1, 1)?.squeeze(0)?;
            let y = y.permute((1, 2, 0))?.contiguous()?;
            y.broadcast_add(self.get(&format!("{first}.bias"))?)?
        };
        x + self.linear(&format!("{name}.conv2"), &hidden.gelu_erf()?)?
    }

    fn level(&self, part: &str, level: usize, kernels: &[usize], mut x: Tensor) -> Result<Tensor> {
        for (i, kernel) in kernels.iter().enumerate() {
            x = self.block(&format!("{part}.{level}.blocks.{i}"), *kernel, &x)?;
        }
        Ok(x)
    }

    /// Normalised mean latent [side * side * channels] of a grid.
    pub fn encode(&self, grid: &VoxelGrid) -> Result<Vec<f32>> {
        let (mut codes, mut columns) = (Vec::new(), Vec::new());
        for x in 0..GridSpec::NX {
            for y in 0..GridSpec::NY {
                for (z, label) in grid.column(x, y).iter().enumerate() {
                    if *label != Class::FREE {
                        codes.push((z * Class::FREE as usize + *label as usize) as u32);
                        columns.push((x * GridSpec::NY + y) as u32);
                    }
                }
            }
        }
        let width = self.config.widths[0];
        let mut x = Tensor::zeros((GridSpec::COLUMNS, width), DType::F32, &Device::Cpu)?;
        if !codes.is_empty() {
            let n = codes.len();
            let rows = self
                .get("embed.weight")?
                .index_select(&Tensor::from_vec(codes, n, &Device::Cpu)?, 0)?;
            x = x.index_add(&Tensor::from_vec(columns, n, &Device::Cpu)?, &rows, 0)?;
        }
        let mut x = x.reshape((GridSpec::NX, GridSpec::NY, width))?;
        for (i, kernels) in self.config.encoder_kernels.iter().enumerate() {
            if i > 0 {
                x = self.linear(&format!("down.{}", i - 1), &fold(&x)?)?;
            }
            x = self.level("encoder", i, kernels, x)?;
        }
        let both = self.linear("encoder_head", &self.norm("encoder_norm", &x)?)?;
        let mean = both.narrow(2, 0, self.config.latent)?;
        let latent = mean
            .broadcast_sub(self.get("latent_mean")?)?
            .broadcast_div(self.get("latent_std")?)?;
        latent.flatten_all()?.to_vec1()
    }

    /// The likeliest class of each voxel, z fastest, then y, for a normalised latent.
    pub fn decode(&self, latent: &[f32]) -> Result<Vec<u32>> {
        let side = self.config.side();
        let x = Tensor::from_slice(latent, (side, side, self.config.latent), &Device::Cpu)?;
        let x = x
            .broadcast_mul(self.get("latent_std")?)?
            .broadcast_add(self.get("latent_mean")?)?;
        let mut x = self.linear("decoder_stem", &x)?;
        for (i, kernels) in self.config.decoder_kernels.iter().enumerate() {
            if i > 0 {
                x = unfold(&self.linear(&format!("up.{}", i - 1), &x)?)?;
            }
            x = self.level("decoder", i, kernels, x)?;
        }
        let features = self.linear("decoder_head", &self.norm("decoder_norm", &x)?)?;
        let table = self.get("class_table")?;
        let voxels = features.reshape((GridSpec::COLUMNS * HEIGHT, table.dim(1)?))?;
        let logits = voxels
            .matmul(&table.t()?)?
            .broadcast_add(self.get("class_bias")?)?;
        logits.argmax(D::Minus1)?.to_vec1()
    }
}

/// [x, y, c] -> [x/2, y/2, 4c], channel order (dx, dy, c).
fn fold(x: &Tensor) -> Result<Tensor> {
    let (w, h, c) = x.dims3()?;
    x.reshape((w / 2, 2, h / 2, 2, c))?
        .permute((0, 2, 1, 3, 4))?
        .contiguous()?
        .reshape((w / 2, h / 2, 4 * c))
}

/// The inverse of [`fold`].
fn unfold(x: &Tensor) -> Result<Tensor> {
    let (w, h, c) = x.dims3()?;
    x.reshape((w, h, 2, 2, c / 4))?
        .permute((0, 2, 1, 3, 4))?
        .contiguous()?
        .reshape((2 * w, 2 * h, c / 4))
}
