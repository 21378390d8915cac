//! Device and number type that networks run in.

use candle_core::{DType, Device};

use crate::StableError;

/// A processor or a graphics card, with the type that weights are held and multiplied in.
#[derive(Clone, Debug)]
pub struct Machine {
    /// Device of the tensors.
    pub(crate) device: Device,
    /// Type of weights and activations. Norms and softmax are always computed in 32 bits.
    pub(crate) dtype: DType,
    /// Reason why this is the processor, though the build has a feature for a card.
    pub(crate) without_card: Option<String>,
}

impl Machine {
    /// The processor, in 32 bits.
    pub fn cpu() -> Self {
        Self {
            device: Device::Cpu,
            dtype: DType::F32,
            without_card: None,
        }
    }

    /// The first card that this build has a feature for, in 16 bits (bfloat16 on CUDA, whose range no activation
    /// exceeds; half precision on Metal); otherwise the processor.
    pub fn best() -> Self {
        if cfg!(feature = "cuda") {
            Self::on_card(Device::new_cuda(0), DType::BF16)
        } else if cfg!(feature = "metal") {
            Self::on_card(Device::new_metal(0), DType::F16)
        } else {
            Self::cpu()
        }
    }

    /// A card, or the processor with the reason.
    fn on_card(card: candle_core::Result<Device>, dtype: DType) -> Self {
        match card {
            Ok(device) => Self {
                device,
                dtype,
                without_card: None,
            },
            Err(error) => Self {
                without_card: Some(StableError::from(error).to_string()),
                ..Self::cpu()
            },
        }
    }

    /// Reason why this is the processor, though the build has a feature for a card.
    pub fn without_card(&self) -> Option<&str> {
        self.without_card.as_deref()
    }

    /// This device in 32 bits, for reference results.
    pub fn exact(&self) -> Self {
        Self {
            dtype: DType::F32,
            ..self.clone()
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn without_a_card_the_processor_computes() {
        let card = Err(candle_core::Error::Msg("no CUDA device".into()));
        let machine = Machine::on_card(card, DType::BF16);
        assert!(machine.device.is_cpu() && machine.dtype == DType::F32);
        assert_eq!(machine.without_card(), Some("candle: no CUDA device"));
    }
}
