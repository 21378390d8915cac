//! The size of a latent of the whole map.

/// Latent cells along x and along y.
pub const SIDE: usize = 50;
/// Latent cells in all.
pub const CELLS: usize = SIDE * SIDE;
/// Numbers per latent cell.
pub const CHANNELS: usize = 8;
/// Numbers in a latent: `[x][y][channel]`.
pub const LATENT: usize = CELLS * CHANNELS;
