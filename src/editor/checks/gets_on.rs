//! What a class does when it changes its place, for the texts of findings.

use scene::Class;

/// How something gets on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum GetsOn {
    /// On its own wheels, with an engine.
    Drives,
    /// On foot.
    Walks,
    /// Neither, or it is ridden: what can be said of everything.
    Moves,
}

/// How things of a class get on.
pub fn gets_on(class: Class) -> GetsOn {
    match class {
        Class::Pedestrian => GetsOn::Walks,
        class if class.is_vehicle() => GetsOn::Drives,
        _ => GetsOn::Moves,
    }
}
