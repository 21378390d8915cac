//! Pictures of a scene: by the program's own renderer and by networks, and the crisp maps that both are made from.

pub mod appearance;
pub mod color;
pub mod march;
pub mod mpi;
pub mod painter;
pub mod perspective;
pub mod picture_hints;
pub mod scenery;
