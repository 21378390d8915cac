//! Names, version and limits of a project file.

/// Version written.
pub const VERSION: u32 = 12;
/// Frames that a project of version 1 to 4 may hold.
pub(super) const MAX_FRAMES: usize = 10_000;
/// Largest project file that is written and read, bytes.
pub const LARGEST_FILE: u64 = 512 << 20;

pub(super) const FORMAT: &str = "sceneloom";
pub(super) const MANIFEST: &str = "manifest.json";
pub(super) const SCENE: &str = "scene.json";
