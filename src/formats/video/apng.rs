//! APNG: a PNG with more frames.

use std::io;
use std::sync::{Arc, Mutex};

use png::{BitDepth, ColorType, Writer};

use super::FrameEncoder;
use crate::error::FormatError;

/// Bytes that the encoder has written; it does not give them back itself.
#[derive(Clone, Default)]
struct EncodedBytes(Arc<Mutex<Vec<u8>>>);

impl io::Write for EncodedBytes {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let mut all = self.0.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
        all.extend_from_slice(bytes);
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

pub(super) struct Apng {
    written: EncodedBytes,
    writer: Writer<EncodedBytes>,
}

impl Apng {
    pub(super) fn new([width, height]: [u32; 2], frames: u32, rate_hz: f64) -> Result<Self, FormatError> {
        let written = EncodedBytes::default();
        let mut encoder = png::Encoder::new(written.clone(), width, height);
        encoder.set_color(ColorType::Rgba);
        encoder.set_depth(BitDepth::Eight);
        encoder.set_animated(frames, 0).map_err(FormatError::new)?;
        // Milliseconds: 29.97 a second is 33.
        let delay_ms = (1000.0 / rate_hz).round().clamp(1.0, 60_000.0) as u16;
        encoder
            .set_frame_delay(delay_ms, 1000)
            .map_err(FormatError::new)?;
        let writer = encoder.write_header().map_err(FormatError::new)?;
        Ok(Self { written, writer })
    }
}

impl FrameEncoder for Apng {
    fn frame(&mut self, rgba: &[u8]) -> Result<(), FormatError> {
        self.writer.write_image_data(rgba).map_err(FormatError::new)
    }

    fn finish(self: Box<Self>) -> Result<Vec<u8>, FormatError> {
        self.writer.finish().map_err(FormatError::new)?;
        let all = self.written.0.lock();
        Ok(std::mem::take(
            &mut *all.unwrap_or_else(std::sync::PoisonError::into_inner),
        ))
    }
}
