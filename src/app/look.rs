//! What the 3D view shows a scene as.

/// What the 3D view shows the scene as.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Look {
    /// Voxels in the colours of their classes.
    #[default]
    Voxels,
    /// What a camera would see there.
    Pictures,
}
