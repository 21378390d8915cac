//! Where networks run, and in which numbers.

use candle_core::{DType, Device};

use crate::StableError;

/// A processor or a card, and the type that weights are held and multiplied in there.
#[derive(Clone, Debug)]
pub struct Machine {
    /// Where tensors lie.
    pub(crate) device: Device,
    /// Type of weights and activations. Norms and softmax are always computed in 32 bits.
    pub(crate) dtype: DType,
}

impl Machine {
    /// The processor, in 32 bits.
    pub fn cpu() -> Self {
        Self {
            device: Device::Cpu,
            dtype: DType::F32,
        }
    }

    /// The first card that this build has a feature for, in 16 bits (bfloat16 on CUDA, whose range no activation leaves; half
    /// precision on Metal); the processor where there is none. Errors if the card cannot be opened.
    pub fn best() -> Result<Self, StableError> {
        let (device, dtype) = if cfg!(feature = "cuda") {
            (Device::new_cuda(0)?, DType::BF16)
        } else if cfg!(feature = "metal") {
            (Device::new_metal(0)?, DType::F16)
        } else {
            (Device::Cpu, DType::F32)
        };
        Ok(Self { device, dtype })
    }

    /// The same place, in 32 bits: the reference.
    pub fn exact(&self) -> Self {
        Self {
            device: self.device.clone(),
            dtype: DType::F32,
        }
    }
}
