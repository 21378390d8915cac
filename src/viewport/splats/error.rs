//! Why the graphics card does not draw the camera maps; the caller draws them on the processor then.

/// Each message is one line.
#[derive(Debug, thiserror::Error)]
pub enum SplatError {
    /// A limit of the device is lower than the shaders need.
    #[error("graphics adapter {adapter:?} draws no splats: {limit} is {has}, needed {needs}")]
    Unable {
        /// Name of the adapter.
        adapter: String,
        /// Name of the limit in wgpu.
        limit: &'static str,
        /// Limit of the device.
        has: u64,
        /// Limit that the shaders need.
        needs: u64,
    },
    /// More Gaussians than the device can hold.
    #[error("{count} Gaussians, expected at most {max}")]
    Gaussians {
        /// How many there were.
        count: usize,
        /// How many there may be.
        max: usize,
    },
    /// The maps of one camera are larger than the device can hold.
    #[error("camera maps of {width}x{height} pixels do not fit the graphics device")]
    Size {
        /// Pixels per row.
        width: u32,
        /// Rows.
        height: u32,
    },
    /// Too many splats lie over each other.
    #[error("{touches} touches of splats and tiles in one image, expected at most {max}")]
    Crowded {
        /// How many there were.
        touches: u32,
        /// How many there may be.
        max: u32,
    },
    /// The driver refused a command, or the device was lost.
    #[error("the graphics device failed to draw splats: {0}")]
    Device(String),
}
