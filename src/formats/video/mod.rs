//! Moving pictures: GIF, APNG and MP4, written frame by frame.

mod apng;
mod gif;
#[cfg(feature = "video")]
mod mp4;
#[cfg(not(feature = "video"))]
#[path = "absent.rs"]
mod mp4;

use std::path::Path;

use crate::error::FormatError;

/// Format of a file of moving pictures.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum VideoKind {
    /// 256 colours a frame; every browser and mail program shows it.
    Gif,
    /// All colours, no loss; browsers show it.
    Apng,
    /// H.264; small, and accepted by players and slides.
    Mp4,
}

impl VideoKind {
    /// Every kind with the ending of its files.
    pub const ALL: [(VideoKind, &'static str); 3] = [
        (VideoKind::Gif, "gif"),
        (VideoKind::Apng, "png"),
        (VideoKind::Mp4, "mp4"),
    ];

    /// By the ending of a file's name (`.apng` is as good as `.png`). Errors in one line.
    pub fn of_path(path: &Path) -> Result<Self, FormatError> {
        let ending = path.extension().and_then(|e| e.to_str()).map(str::to_lowercase);
        let of = |ending: &str| match ending {
            "apng" => Some(VideoKind::Apng),
            other => Self::ALL.iter().find(|(_, e)| *e == other).map(|(kind, _)| *kind),
        };
        ending.as_deref().and_then(of).ok_or_else(|| {
            FormatError::new(format!(
                "{}: the name of a clip ends in .gif, .png (an APNG) or .mp4",
                path.display()
            ))
        })
    }
}

/// Takes frames one after the other.
trait FrameEncoder: Send {
    /// The next frame, RGBA8 of the size that was named.
    fn frame(&mut self, rgba: &[u8]) -> Result<(), FormatError>;
    /// The whole file.
    fn finish(self: Box<Self>) -> Result<Vec<u8>, FormatError>;
}

/// A file of moving pictures that is being made. Equal frames give equal bytes.
pub struct VideoWriter {
    size: [u32; 2],
    encoder: Box<dyn FrameEncoder>,
}

impl VideoWriter {
    /// Largest side, pixels.
    pub const MAX_SIDE: u32 = 4096;
    /// Most frames of an APNG or GIF file.
    pub const MAX_FRAMES: u32 = 6000;

    /// For frames of `size` (width, height), `frames` of them, `rate_hz` per second. Errors in one line on a size or rate that
    /// cannot be written; MP4 takes even sides only.
    pub fn new(kind: VideoKind, size: [u32; 2], frames: u32, rate_hz: f64) -> Result<Self, FormatError> {
        let [width, height] = size;
        if !(2..=Self::MAX_SIDE).contains(&width) || !(2..=Self::MAX_SIDE).contains(&height) {
            return Err(FormatError::new(format!(
                "a clip of {width}x{height} pixels, expected sides of 2 to {}",
                Self::MAX_SIDE
            )));
        }
        if !(1..=Self::MAX_FRAMES).contains(&frames) || !(0.1..=100.0).contains(&rate_hz) {
            return Err(FormatError::new(format!(
                "a clip of {frames} frames, {rate_hz} a second, expected at most {} and .1 to 100",
                Self::MAX_FRAMES
            )));
        }
        let encoder: Box<dyn FrameEncoder> = match kind {
            VideoKind::Gif => Box::new(gif::Gif::new(size, rate_hz)?),
            VideoKind::Apng => Box::new(apng::Apng::new(size, frames, rate_hz)?),
            VideoKind::Mp4 => Box::new(mp4::Mp4::new(size, rate_hz)?),
        };
        Ok(Self { size, encoder })
    }

    /// Takes the next frame. Errors if it is of another size.
    pub fn frame(&mut self, rgba: &[u8]) -> Result<(), FormatError> {
        let [width, height] = self.size.map(|n| n as usize);
        if rgba.len() != width * height * 4 {
            return Err(FormatError::new(format!(
                "a frame of {} bytes, expected {width}x{height} pixels of 4",
                rgba.len()
            )));
        }
        self.encoder.frame(rgba)
    }

    /// The whole file.
    pub fn finish(self) -> Result<Vec<u8>, FormatError> {
        self.encoder.finish()
    }
}

#[cfg(test)]
mod tests {
    use std::io::Cursor;

    use super::*;

    const SIZE: [u32; 2] = [64, 48];
    const FRAMES: u32 = 7;

    /// A red square that moves to the right over blue.
    fn picture(i: u32) -> Vec<u8> {
        let inside = |x: u32, y: u32| (8 * i..8 * i + 16).contains(&x) && (16..32).contains(&y);
        let pixels = (0..SIZE[0] * SIZE[1]).map(|p| (p % SIZE[0], p / SIZE[0]));
        let color = |(x, y)| match inside(x, y) {
            true => [220, 30, 30, 255],
            false => [30, 40, 160, 255],
        };
        pixels.flat_map(color).collect()
    }

    fn written(kind: VideoKind) -> Vec<u8> {
        let mut writer = VideoWriter::new(kind, SIZE, FRAMES, 10.0).expect("a small clip");
        (0..FRAMES).for_each(|i| writer.frame(&picture(i)).expect("of that size"));
        writer.finish().expect("all frames")
    }

    fn near(a: &[u8], b: &[u8], tolerance: u8) {
        let worst = a.iter().zip(b).map(|(a, b)| a.abs_diff(*b)).max();
        assert!(a.len() == b.len() && worst <= Some(tolerance), "{worst:?}");
    }

    #[test]
    fn every_kind_is_read_back_by_other_code() {
        for (kind, _) in VideoKind::ALL {
            assert_eq!(written(kind), written(kind), "{kind:?}: the same bytes");
        }
        let bytes = written(VideoKind::Gif);
        let mut options = ::gif::DecodeOptions::new();
        options.set_color_output(::gif::ColorOutput::RGBA);
        let mut decoder = options.read_info(Cursor::new(bytes)).expect("a GIF");
        let mut n = 0;
        while let Some(frame) = decoder.read_next_frame().expect("sound") {
            assert_eq!(frame.delay, 10);
            near(&frame.buffer, &picture(n), 12);
            n += 1;
        }
        assert_eq!(n, FRAMES);
        let mut reader = png::Decoder::new(Cursor::new(written(VideoKind::Apng)))
            .read_info()
            .expect("a PNG");
        assert_eq!(
            reader.info().animation_control().map(|a| a.num_frames),
            Some(FRAMES)
        );
        for i in 0..FRAMES {
            let mut pixels = vec![0; SIZE[0] as usize * SIZE[1] as usize * 4];
            reader.next_frame(&mut pixels).expect("a frame");
            assert_eq!(pixels, picture(i), "no loss");
        }
        let bytes = written(VideoKind::Mp4);
        let len = bytes.len() as u64;
        let movie = ::mp4::Mp4Reader::read_header(Cursor::new(bytes), len).expect("an MP4");
        let track = movie.tracks().values().next().expect("a track");
        assert_eq!(
            (u32::from(track.width()), u32::from(track.height())),
            (SIZE[0], SIZE[1])
        );
        assert_eq!((track.sample_count(), track.frame_rate().round()), (FRAMES, 10.0));
        assert_eq!(movie.duration().as_millis(), 700);
    }

    #[test]
    fn what_cannot_be_written_is_told_in_one_line() {
        let new = |kind, size, frames, rate| VideoWriter::new(kind, size, frames, rate).map(|_| ());
        for (result, says) in [
            (new(VideoKind::Gif, [0, 9], 3, 10.0), "0x9 pixels"),
            (new(VideoKind::Apng, [9000, 9], 3, 10.0), "sides of 2 to 4096"),
            (new(VideoKind::Mp4, [33, 20], 3, 10.0), "even"),
            (new(VideoKind::Gif, SIZE, 0, 10.0), "0 frames"),
            (new(VideoKind::Gif, SIZE, 3, f64::NAN), "NaN a second"),
        ] {
            let error = result.expect_err(says).to_string();
            assert!(error.contains(says) && !error.contains('\n'), "{error}");
        }
        let mut writer = VideoWriter::new(VideoKind::Gif, SIZE, 2, 10.0).expect("small");
        assert!(writer.frame(&[0; 12]).is_err());
        assert_eq!(
            VideoKind::of_path(Path::new("a.APNG")).expect("known"),
            VideoKind::Apng
        );
        let error = VideoKind::of_path(Path::new("a.avi"))
            .expect_err("unknown")
            .to_string();
        assert!(error.contains(".gif, .png (an APNG) or .mp4"), "{error}");
    }
}
