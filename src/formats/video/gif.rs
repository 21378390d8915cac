//! GIF: each frame with a palette of its own.

use gif::{Encoder as GifEncoder, Frame, Repeat};

use super::FrameEncoder;
use crate::error::FormatError;

/// How coarsely the palette is searched for, 1 to 30: colours of a rendered scene are few.
const SPEED: i32 = 10;

pub(super) struct Gif {
    size: [u16; 2],
    delay: u16, // hundredths of a second
    encoder: GifEncoder<Vec<u8>>,
}

impl Gif {
    pub(super) fn new([width, height]: [u32; 2], rate_hz: f64) -> Result<Self, FormatError> {
        let size = [width, height].map(|n| u16::try_from(n).unwrap_or(u16::MAX));
        let mut encoder = GifEncoder::new(Vec::new(), size[0], size[1], &[]).map_err(FormatError::new)?;
        encoder.set_repeat(Repeat::Infinite).map_err(FormatError::new)?;
        Ok(Self {
            size,
            // Players take less than two hundredths for ten.
            delay: (100.0 / rate_hz).round().clamp(2.0, 6000.0) as u16,
            encoder,
        })
    }
}

impl FrameEncoder for Gif {
    fn frame(&mut self, rgba: &[u8]) -> Result<(), FormatError> {
        let mut pixels = rgba.to_vec();
        let mut frame = Frame::from_rgba_speed(self.size[0], self.size[1], &mut pixels, SPEED);
        frame.delay = self.delay;
        self.encoder.write_frame(&frame).map_err(FormatError::new)
    }

    fn finish(self: Box<Self>) -> Result<Vec<u8>, FormatError> {
        self.encoder.into_inner().map_err(FormatError::new)
    }
}
