//! Buffers of the splat renderer: they stay between frames and grow when they must.

use super::pipelines::{DIGIT_BITS, GROUP, SORT_BLOCK};

/// A buffer that is replaced only when it is too small.
#[derive(Debug)]
pub(crate) struct Growing {
    label: &'static str,
    usage: wgpu::BufferUsages,
    buffer: Option<wgpu::Buffer>,
}

impl Growing {
    pub fn new(label: &'static str, usage: wgpu::BufferUsages) -> Growing {
        Growing {
            label,
            usage,
            buffer: None,
        }
    }

    /// A buffer of at least `bytes` bytes (and at least 64, one item of any kind). Its content is lost if it grows.
    pub fn at_least(&mut self, device: &wgpu::Device, bytes: u64) -> &wgpu::Buffer {
        let bytes = bytes.max(64).next_multiple_of(16);
        if self.buffer.as_ref().is_some_and(|b| b.size() < bytes) {
            self.buffer = None; // frees it before the larger one is made
        }
        self.buffer.get_or_insert_with(|| {
            device.create_buffer(&wgpu::BufferDescriptor {
                label: Some(self.label),
                size: bytes,
                usage: self.usage,
                mapped_at_creation: false,
            })
        })
    }

    /// Lets go of the buffer.
    pub fn clear(&mut self) {
        self.buffer = None;
    }

    /// The buffer that [`Growing::at_least`] made last, if there is one.
    pub fn get(&self) -> Option<&wgpu::Buffer> {
        self.buffer.as_ref()
    }
}

/// Settings of the sort's passes: one slot for each digit of a key, and one for the scan of touches.
#[derive(Debug)]
pub(super) struct PassSettings {
    buffer: wgpu::Buffer,
}

/// Bytes of a slot: the largest alignment that a device asks for.
const SLOT: u64 = 256;
const DIGITS: u32 = u32::BITS / DIGIT_BITS;

impl PassSettings {
    pub fn new(device: &wgpu::Device, queue: &wgpu::Queue) -> PassSettings {
        let buffer = device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("splat passes"),
            size: SLOT * u64::from(DIGITS + 1),
            usage: wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        for digit in 0..DIGITS {
            let settings = [digit * DIGIT_BITS, 1 << DIGIT_BITS, SORT_BLOCK, u32::MAX];
            queue.write_buffer(&buffer, SLOT * u64::from(digit), bytemuck::bytes_of(&settings));
        }
        PassSettings { buffer }
    }

    /// How many touches there is room for; the scan cuts the number off there.
    pub fn set_room(&self, queue: &wgpu::Queue, room: u32) {
        let settings = [0, 1, GROUP, room];
        queue.write_buffer(
            &self.buffer,
            SLOT * u64::from(DIGITS),
            bytemuck::bytes_of(&settings),
        );
    }

    pub fn digit(&self, digit: u32) -> wgpu::BindingResource<'_> {
        wgpu::BindingResource::Buffer(wgpu::BufferBinding {
            buffer: &self.buffer,
            offset: SLOT * u64::from(digit.min(DIGITS)),
            size: wgpu::BufferSize::new(16),
        })
    }

    pub fn touches(&self) -> wgpu::BindingResource<'_> {
        self.digit(DIGITS)
    }
}
