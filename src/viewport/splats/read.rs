//! From the device's buffers to maps.

use super::SplatError;
use crate::error::one_line;
use scene::splats::{MIN_DEPTH_COVERAGE, RawMaps};

/// Waits for the device and shows the first `bytes` of a buffer to `reader`.
pub(crate) fn mapped<T>(
    device: &wgpu::Device,
    buffer: &wgpu::Buffer,
    bytes: u64,
    reader: impl FnOnce(&[u32]) -> T,
) -> Result<T, SplatError> {
    let failed = |e: &dyn std::fmt::Display| SplatError::Device(one_line(&e));
    let (sender, receiver) = std::sync::mpsc::channel();
    buffer.map_async(wgpu::MapMode::Read, ..bytes, move |result| {
        // The receiver lives until the end of this function; if it is gone, nobody waits.
        let _ = sender.send(result);
    });
    device
        .poll(wgpu::PollType::wait_indefinitely())
        .map_err(|e| failed(&e))?;
    match receiver.try_recv() {
        Ok(Ok(())) => {}
        Ok(Err(e)) => return Err(failed(&e)),
        Err(e) => return Err(failed(&e)),
    }
    let out = {
        let range = buffer.get_mapped_range(..bytes).map_err(|e| failed(&e))?;
        reader(bytemuck::cast_slice(&range))
    };
    buffer.unmap();
    Ok(out)
}

/// One camera's planes as maps; margin and transmittance stay empty if they were not computed.
pub(super) fn raw_maps(width: usize, height: usize, words: &[u32]) -> RawMaps {
    let n = width * height;
    let plane = |i: usize| words.get(i * n..(i + 1) * n).unwrap_or(&[]);
    let floats = |i: usize| bytemuck::cast_slice::<u32, f32>(plane(i)).to_vec();
    let (coverage, expected_m) = (floats(0), floats(1));
    let normalised = |(&expected, &coverage): (&f32, &f32)| {
        if coverage >= MIN_DEPTH_COVERAGE {
            expected / coverage
        } else {
            -1.0
        }
    };
    RawMaps {
        width,
        height,
        normalised_m: expected_m.iter().zip(&coverage).map(normalised).collect(),
        coverage,
        expected_m,
        median_m: floats(2),
        label: plane(3).iter().map(|&id| id as i32 as i16).collect(),
        margin: floats(4),
        transmittance: floats(5),
    }
}
