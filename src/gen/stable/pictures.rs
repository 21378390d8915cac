//! Pictures as plain numbers.

#[cfg(feature = "networks")]
use candle_core::{DType, Device, Tensor};

#[cfg(feature = "networks")]
use crate::Machine;
use crate::{StableError, check_finite, check_length, wrong};

/// Most pixels of a picture along a side.
const MOST_PX: usize = 8192;
/// Number of colours of a pixel.
const COLOURS: usize = 3;

/// Pictures of one size: `[picture][row][column][3]`, sRGB from -1 to 1.
#[derive(Clone, Debug, PartialEq)]
pub struct PictureBatch {
    count: usize,
    size: [usize; 2],
    rgb: Vec<f32>,
}

impl PictureBatch {
    /// `count` pictures of `size` (height and width, px). Errors if the numbers do not fit, are not finite, or a side
    /// has more than 8192 pixels.
    pub fn new(count: usize, size: [usize; 2], rgb: Vec<f32>) -> Result<Self, StableError> {
        if size.iter().any(|side| !(1..=MOST_PX).contains(side)) {
            let found = format!("{} x {}", size[0], size[1]);
            return Err(wrong(
                "size of pictures",
                found,
                format!("1 to {MOST_PX} px a side"),
            ));
        }
        check_length(
            "pictures",
            rgb.len(),
            count.saturating_mul(size[0] * size[1] * COLOURS),
        )?;
        check_finite("picture", &rgb)?;
        Ok(Self { count, size, rgb })
    }

    /// Pictures from bytes `[picture][row][column][3]`. Errors as [`new`](Self::new).
    pub fn from_bytes(count: usize, size: [usize; 2], bytes: &[u8]) -> Result<Self, StableError> {
        let rgb = bytes.iter().map(|b| f32::from(*b) / 127.5 - 1.0).collect();
        Self::new(count, size, rgb)
    }

    /// The pictures as bytes; those of [`from_bytes`](Self::from_bytes) are restored exactly.
    pub fn to_bytes(&self) -> Vec<u8> {
        let byte = |v: &f32| ((v.clamp(-1.0, 1.0) + 1.0) * 127.5).round() as u8;
        self.rgb.iter().map(byte).collect()
    }

    /// Number of pictures.
    pub fn count(&self) -> usize {
        self.count
    }

    /// Height and width, px.
    pub fn size(&self) -> [usize; 2] {
        self.size
    }

    /// All numbers.
    pub fn rgb(&self) -> &[f32] {
        &self.rgb
    }
}

#[cfg(feature = "networks")]
impl PictureBatch {
    /// These pictures with the pixels of `other` wherever `mask` `[picture][row][column]` is false, to the bit. Both
    /// are of the same size.
    pub(crate) fn except(mut self, mask: &[bool], other: &Self) -> Self {
        let pixels = self
            .rgb
            .chunks_exact_mut(COLOURS)
            .zip(other.rgb.chunks_exact(COLOURS));
        for ((own, kept), anew) in pixels.zip(mask) {
            if !anew {
                own.copy_from_slice(kept);
            }
        }
        self
    }

    /// The pictures as `[n, 3, height, width]` in 32 bits.
    pub(crate) fn tensor(&self, machine: &Machine) -> Result<Tensor, StableError> {
        let [height, width] = self.size;
        let x = Tensor::from_slice(&self.rgb, (self.count, height, width, COLOURS), &Device::Cpu)?;
        Ok(x.permute((0, 3, 1, 2))?
            .contiguous()?
            .to_device(&machine.device)?)
    }

    /// Pictures from `[n, 3, height, width]`, clamped to -1 and 1. Errors if a number is not finite.
    pub(crate) fn of_tensor(x: &Tensor) -> Result<Self, StableError> {
        let (count, _, height, width) = x.dims4()?;
        let x = x.to_dtype(DType::F32)?.to_device(&Device::Cpu)?;
        let mut rgb = x
            .permute((0, 2, 3, 1))?
            .contiguous()?
            .flatten_all()?
            .to_vec1::<f32>()?;
        check_finite("decoded picture", &rgb)?;
        rgb.iter_mut().for_each(|v| *v = v.clamp(-1.0, 1.0));
        Self::new(count, [height, width], rgb)
    }
}
