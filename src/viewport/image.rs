//! The 3D view as an image in memory: screenshots, `shot`, tests.

use super::error::one_line;
use super::target::RenderTarget;
use super::{ViewCamera, ViewScene, Viewport, ViewportError};

/// Largest supersampling: 64 pictures for one.
pub const MAX_SUPERSAMPLE: u32 = 8;

impl Viewport {
    /// The picture drawn last as RGBA8, sRGB, premultiplied alpha, top row first.
    pub fn shown(&self, device: &wgpu::Device, queue: &wgpu::Queue) -> Result<Vec<u8>, ViewportError> {
        read_back(device, queue, &self.target)
    }

    /// Draws a scene as RGBA8, sRGB, straight alpha, `width * height * 4` bytes, top row first.
    ///
    /// `supersample` N draws N x N pictures, each shifted by a part of a pixel, and averages them (colour weighted by
    /// alpha). So N does not limit the size of the picture beyond the device's limit, and lines keep their width.
    /// [`super::Background::Transparent`] gives a transparent picture. The picture in the window is not changed.
    pub fn render_to_image(
        &mut self,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        camera: &ViewCamera,
        scene: &ViewScene<'_>,
        [width, height]: [u32; 2],
        supersample: u32,
    ) -> Result<Vec<u8>, ViewportError> {
        let max = device.limits().max_texture_dimension_2d;
        if !(1..=max).contains(&width) || !(1..=max).contains(&height) {
            return Err(ViewportError::Size { width, height, max });
        }
        if !(1..=MAX_SUPERSAMPLE).contains(&supersample) {
            return Err(ViewportError::Supersample(supersample));
        }
        let samples = if supersample > 1 { 1 } else { scene.options.samples };
        let target = RenderTarget::new(device, [width, height], super::view::samples(samples));
        let mut sums = vec![0u32; width as usize * height as usize * 4];
        for i in 0..supersample * supersample {
            let part = |k: u32| (f64::from(k) + 0.5) / f64::from(supersample) - 0.5;
            let jitter_px = [part(i % supersample), part(i / supersample)];
            self.draw_into(device, queue, &target, camera, scene, jitter_px);
            let picture = read_back(device, queue, &target)?;
            for (sum, value) in sums.iter_mut().zip(picture) {
                *sum += u32::from(value);
            }
        }
        self.forget();
        Ok(straight_alpha(&sums, supersample * supersample))
    }
}

/// Averages sums of `n` premultiplied values and divides the alpha out.
fn straight_alpha(sums: &[u32], n: u32) -> Vec<u8> {
    let mut out = Vec::with_capacity(sums.len());
    for texel in sums.chunks_exact(4) {
        let alpha = texel[3];
        let color = |sum: u32| {
            let scaled = (u64::from(sum) * 255 + u64::from(alpha) / 2).checked_div(u64::from(alpha));
            scaled.unwrap_or(0).min(255) as u8
        };
        out.extend([color(texel[0]), color(texel[1]), color(texel[2])]);
        out.push(((alpha + n / 2) / n) as u8);
    }
    out
}

/// The picture as the device holds it (premultiplied), without the padding of its rows.
pub(super) fn read_back(
    device: &wgpu::Device,
    queue: &wgpu::Queue,
    target: &RenderTarget,
) -> Result<Vec<u8>, ViewportError> {
    let [width, height] = target.size;
    let row = width as usize * 4;
    let padded = row.next_multiple_of(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT as usize);
    let buffer = device.create_buffer(&wgpu::BufferDescriptor {
        label: Some("read back"),
        size: padded as u64 * u64::from(height),
        usage: wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ,
        mapped_at_creation: false,
    });
    let mut encoder = device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
    encoder.copy_texture_to_buffer(
        target.color.as_image_copy(),
        wgpu::TexelCopyBufferInfo {
            buffer: &buffer,
            layout: wgpu::TexelCopyBufferLayout {
                offset: 0,
                bytes_per_row: Some(padded as u32),
                rows_per_image: None,
            },
        },
        target.color.size(),
    );
    queue.submit([encoder.finish()]);
    let (sender, receiver) = std::sync::mpsc::channel();
    buffer.map_async(wgpu::MapMode::Read, .., move |result| {
        // The receiver lives until the end of this function; if it is gone, nobody waits.
        let _ = sender.send(result);
    });
    device
        .poll(wgpu::PollType::wait_indefinitely())
        .map_err(|e| ViewportError::Readback(one_line(&e)))?;
    match receiver.try_recv() {
        Ok(Ok(())) => {}
        Ok(Err(e)) => return Err(ViewportError::Readback(one_line(&e))),
        Err(e) => return Err(ViewportError::Readback(one_line(&e))),
    }
    let mapped = buffer
        .get_mapped_range(..)
        .map_err(|e| ViewportError::Readback(one_line(&e)))?;
    let mut out = Vec::with_capacity(row * height as usize);
    for line in mapped.chunks_exact(padded) {
        out.extend_from_slice(&line[..row]);
    }
    Ok(out)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn alpha_is_divided_out() {
        // Two of four pictures opaque red, the others empty: half transparent, fully red.
        assert_eq!(straight_alpha(&[510, 0, 0, 510], 4), [255, 0, 0, 128]);
        assert_eq!(straight_alpha(&[0, 0, 0, 0], 4), [0, 0, 0, 0]);
        assert_eq!(straight_alpha(&[17, 34, 51, 255], 1), [17, 34, 51, 255]);
    }
}
