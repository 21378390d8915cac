//! MP4 with H.264, by Cisco's encoder (BSD).

use std::io::Cursor;

use mp4::{AvcConfig, Bytes, FourCC, MediaConfig, Mp4Config, Mp4Sample, Mp4Writer, TrackConfig, TrackType};
use openh264::OpenH264API;
use openh264::encoder::{
    BitRate, Encoder as H264, EncoderConfig, FrameRate, FrameType, IntraFramePeriod, QpRange, RateControlMode,
};
use openh264::formats::{RgbaSliceU8, YUVBuffer};

use super::FrameEncoder;
use crate::error::FormatError;

/// Units of time in a second, as the file counts them.
const TIMESCALE: u32 = 90_000;
/// Parts of the bit stream that describe it: sequence and picture parameters.
const SPS: u8 = 7;
const PPS: u8 = 8;

pub(super) struct Mp4 {
    size: [u32; 2],
    duration: u32,
    encoder: H264,
    /// Begun with the first frame, whose parameters its header holds.
    file: Option<Mp4Writer<Cursor<Vec<u8>>>>,
    frames: u64,
}

impl Mp4 {
    pub(super) fn new(size: [u32; 2], rate_hz: f64) -> Result<Self, FormatError> {
        let [width, height] = size;
        if !width.is_multiple_of(2) || !height.is_multiple_of(2) {
            return Err(FormatError::new(format!(
                "an MP4 of {width}x{height} pixels, expected even sides"
            )));
        }
        let config = EncoderConfig::new()
            .max_frame_rate(FrameRate::from_hz(rate_hz as f32))
            .rate_control_mode(RateControlMode::Off)
            .bitrate(BitRate::from_bps(width * height * 8))
            .qp(QpRange::new(16, 30))
            .intra_frame_period(IntraFramePeriod::from_num_frames((rate_hz * 2.0).max(1.0) as u32))
            .skip_frames(false)
            .num_threads(1); // more would give other bytes
        let encoder = H264::with_api_config(OpenH264API::from_source(), config).map_err(FormatError::new)?;
        Ok(Self {
            size,
            duration: (f64::from(TIMESCALE) / rate_hz).round() as u32,
            encoder,
            file: None,
            frames: 0,
        })
    }
}

fn begin(size: [u32; 2], sps: &[u8], pps: &[u8]) -> Result<Mp4Writer<Cursor<Vec<u8>>>, FormatError> {
    let brand = |name: &[u8; 4]| FourCC { value: *name };
    let config = Mp4Config {
        major_brand: brand(b"isom"),
        minor_version: 512,
        compatible_brands: vec![brand(b"isom"), brand(b"iso2"), brand(b"avc1"), brand(b"mp41")],
        timescale: TIMESCALE,
    };
    let mut file = Mp4Writer::write_start(Cursor::new(Vec::new()), &config).map_err(FormatError::new)?;
    let [width, height] = size.map(|n| n as u16);
    let track = TrackConfig {
        track_type: TrackType::Video,
        timescale: TIMESCALE,
        language: "und".into(),
        media_conf: MediaConfig::AvcConfig(AvcConfig {
            width,
            height,
            seq_param_set: sps.to_vec(),
            pic_param_set: pps.to_vec(),
        }),
    };
    file.add_track(&track).map_err(FormatError::new)?;
    Ok(file)
}

/// The unit without the start code before it.
fn bare(unit: &[u8]) -> &[u8] {
    let zeros = unit.iter().take_while(|b| **b == 0).count();
    unit.get(zeros + 1..).unwrap_or_default()
}

impl FrameEncoder for Mp4 {
    fn frame(&mut self, rgba: &[u8]) -> Result<(), FormatError> {
        let size = (self.size[0] as usize, self.size[1] as usize);
        let yuv = YUVBuffer::from_rgba8_source(RgbaSliceU8::new(rgba, size));
        let stream = self.encoder.encode(&yuv).map_err(FormatError::new)?;
        let (mut sps, mut pps, mut sample) = (Vec::new(), Vec::new(), Vec::new());
        for layer in (0..stream.num_layers()).filter_map(|i| stream.layer(i)) {
            for unit in (0..layer.nal_count()).filter_map(|i| layer.nal_unit(i)) {
                let unit = bare(unit);
                match unit.first().map(|b| b & 31) {
                    Some(SPS) => sps = unit.to_vec(),
                    Some(PPS) => pps = unit.to_vec(),
                    Some(_) => {
                        sample.extend_from_slice(&(unit.len() as u32).to_be_bytes());
                        sample.extend_from_slice(unit);
                    }
                    None => {}
                }
            }
        }
        let is_sync = matches!(stream.frame_type(), FrameType::IDR);
        let file = match &mut self.file {
            Some(file) => file,
            none => none.insert(begin(self.size, &sps, &pps)?),
        };
        let sample = Mp4Sample {
            start_time: self.frames * u64::from(self.duration),
            duration: self.duration,
            rendering_offset: 0,
            is_sync,
            bytes: Bytes::from(sample),
        };
        file.write_sample(1, &sample).map_err(FormatError::new)?;
        self.frames += 1;
        Ok(())
    }

    fn finish(self: Box<Self>) -> Result<Vec<u8>, FormatError> {
        let Some(mut file) = self.file else {
            return Err(FormatError::new("a clip without a frame"));
        };
        file.write_end().map_err(FormatError::new)?;
        Ok(file.into_writer().into_inner())
    }
}
