//! The way a class moves (drives, walks), for the texts of findings.

use scene::Class;

/// Way of moving.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Locomotion {
    /// On its own wheels, with an engine.
    Drives,
    /// On foot.
    Walks,
    /// Neither of the two, or it is ridden: a word that fits every class.
    Moves,
}

/// The way things of a class move.
pub fn locomotion_of(class: Class) -> Locomotion {
    match class {
        Class::Pedestrian => Locomotion::Walks,
        class if class.is_vehicle() => Locomotion::Drives,
        _ => Locomotion::Moves,
    }
}
