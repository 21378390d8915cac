//! Errors of drawing without a window.

pub(super) use scene::message::one_line; // drivers say more

/// Why a picture could not be made; each message is one line.
#[derive(Debug, thiserror::Error)]
pub enum ViewportError {
    /// No driver offers an adapter, not even a software one.
    #[error("no graphics adapter: {0} (a software one comes with Mesa: apt install mesa-vulkan-drivers)")]
    NoAdapter(String),
    /// The adapter refuses a device.
    #[error("graphics adapter {adapter:?} gives no device: {reason}")]
    NoDevice {
        /// Name of the adapter.
        adapter: String,
        /// The driver's words, on one line.
        reason: String,
    },
    /// The picture asked for is empty or larger than the device can hold.
    #[error("image size is {width}x{height}, expected 1 to {max} pixels per side")]
    Size {
        /// Pixels per row that were asked for.
        width: u32,
        /// Rows that were asked for.
        height: u32,
        /// Largest side the device allows.
        max: u32,
    },
    /// Supersampling outside of the useful range.
    #[error("supersampling is {0}, expected 1 to 8")]
    Supersample(u32),
    /// The device was lost or the picture could not be read back.
    #[error("the picture could not be read back from the graphics device: {0}")]
    Readback(String),
}
