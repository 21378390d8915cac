//! Purpose of a text.

/// Whether a text makes a scene or changes one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mode {
    /// A new scene.
    Prompt,
    /// A change of the scene that is there.
    Edit,
}
