//! Limits of the size of pictures: on the pixels of one, and on the memory of a run.

/// Most pixels of one picture: 8K (7680 x 4320) fits, 8192 x 8192 does not.
pub const MAX_IMAGE_PIXELS: u64 = 1 << 25;

/// Most memory that the pictures of one run take, bytes. They are rendered and written one after another (small ones in
/// groups, which take less than a large one), so it counts what one picture takes and what is kept until the end, such
/// as a sheet of all of them.
pub const MAX_RUN_BYTES: u64 = 3 << 30;

/// Memory of pictures that are small enough to be rendered side by side, bytes.
const SIDE_BY_SIDE_BYTES: u64 = 64_000_000;

/// Error of rendering pictures.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum CameraError {
    /// More pixels than [`MAX_IMAGE_PIXELS`].
    #[error("a picture of {width}x{height} has {pixels} pixels, expected at most {MAX_IMAGE_PIXELS}")]
    Pixels {
        /// Width asked for.
        width: u32,
        /// Height asked for.
        height: u32,
        /// Their product.
        pixels: u64,
    },
    /// More memory than [`MAX_RUN_BYTES`].
    #[error(
        "pictures of {width}x{height} take {} MB, expected at most {} MB: a smaller size fits",
        bytes / 1_000_000,
        MAX_RUN_BYTES / 1_000_000
    )]
    Memory {
        /// Width asked for.
        width: u32,
        /// Height asked for.
        height: u32,
        /// Memory that the pictures take, bytes.
        bytes: u64,
    },
    /// A network could not be read or refuses its input.
    #[error("picture networks: {0}")]
    Network(String),
    /// The picture is no longer wanted.
    #[error("cancelled")]
    Cancelled,
}

/// Checks the size of pictures. One picture takes `bytes_per_pixel` while it is made; `kept_bytes` stay until the end
/// of the run. Errors if that is more than the bounds allow.
pub fn check([width, height]: [u32; 2], bytes_per_pixel: u64, kept_bytes: u64) -> Result<(), CameraError> {
    let pixels = u64::from(width) * u64::from(height);
    if pixels > MAX_IMAGE_PIXELS {
        return Err(CameraError::Pixels {
            width,
            height,
            pixels,
        });
    }
    let bytes = (pixels * bytes_per_pixel).saturating_add(kept_bytes);
    match bytes > MAX_RUN_BYTES {
        true => Err(CameraError::Memory { width, height, bytes }),
        false => Ok(()),
    }
}

/// Number of pictures of a size that are rendered side by side if one takes `bytes_per_pixel`, at least one.
pub fn side_by_side([width, height]: [u32; 2], bytes_per_pixel: u64) -> usize {
    let one = (u64::from(width) * u64::from(height)).saturating_mul(bytes_per_pixel);
    (SIDE_BY_SIDE_BYTES / one.max(1)).max(1) as usize
}
