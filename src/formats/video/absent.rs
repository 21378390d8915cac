//! Face of the H.264 encoder in a program that was built without it: it cannot be begun.

use std::convert::Infallible;

use super::FrameEncoder;
use crate::error::FormatError;

pub(super) struct Mp4(Infallible);

impl Mp4 {
    /// Errors with how to get a program that writes MP4.
    pub(super) fn new(_: [u32; 2], _: f64) -> Result<Self, FormatError> {
        Err(FormatError::new(
            "MP4 is not in this program; build it with cargo build --release --features video, or write a .gif or an APNG (.png)",
        ))
    }
}

impl FrameEncoder for Mp4 {
    fn frame(&mut self, _: &[u8]) -> Result<(), FormatError> {
        match self.0 {}
    }

    fn finish(self: Box<Self>) -> Result<Vec<u8>, FormatError> {
        match self.0 {}
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn beginning_says_how_to_get_the_encoder() {
        let problem = Mp4::new([64, 48], 10.0).err().expect("absent");
        assert!(problem.to_string().contains("--features video"));
    }
}
