//! Sentences about what stands beside the road, as typed values. A clause is taken only if every word of it is known
//! here and it names a thing of the background; everything else is left to the readers of [`words`](super::words).

pub mod edits;
mod lexicon;
mod place;
mod read;
mod targets;
#[cfg(test)]
mod tests;
mod tokens;
pub mod wishes;

pub use lexicon::{Verb, What};
pub use read::take;
pub use tokens::Span;

/// A side of the ego's road.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SideOf {
    /// Left of it.
    Left,
    /// Right of it.
    Right,
}

/// What something is near to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NearTo {
    /// A pedestrian crossing.
    Crossing,
    /// A junction.
    Junction,
    /// The ego vehicle.
    Ego,
}

/// Where, as far as it was said.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Where {
    /// Which side of the ego's road; `None` is either.
    pub side: Option<SideOf>,
    /// Ahead of the ego vehicle (true) or behind it.
    pub ahead: Option<bool>,
    /// How far ahead, behind, or from what it is near to, m.
    pub distance_m: Option<f64>,
    /// Near to what.
    pub near: Option<NearTo>,
    /// All along the road.
    pub along: bool,
}

/// How high, or by how much.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Amount {
    /// So many storeys.
    Storeys(f64),
    /// So many metres.
    Metres(f64),
}

/// One clause about the background.
#[derive(Clone, Debug, PartialEq)]
pub struct Said {
    /// What is asked for.
    pub verb: Verb,
    /// Of what.
    pub what: What,
    /// Number of a thing: `tree #12`.
    pub id: Option<u32>,
    /// All of them, or a kind as a whole: a plural, `no`, `all`.
    pub plural: bool,
    /// "The": one or those that are there already.
    pub definite: bool,
    /// A number of things.
    pub count: Option<u32>,
    /// A row of them.
    pub row: bool,
    /// Nearest (true) or furthest.
    pub nearest: Option<bool>,
    /// Many (true) or few.
    pub dense: Option<bool>,
    /// Tall (true) or low.
    pub tall: Option<bool>,
    /// The height that they have or get.
    pub height: Option<Amount>,
    /// By how much they change.
    pub by: Option<Amount>,
    /// Way of a move in the ego frame: metres ahead and to the left.
    pub way: Option<(f64, f64)>,
    /// Where.
    pub place: Where,
    /// Bytes of the text.
    pub span: Span,
    /// Those that name the thing, without the amount of a change.
    pub target: Span,
}

/// What of a text is about the background, and the rest with the same bytes in the same places.
#[derive(Clone, Debug, Default)]
pub struct Taken {
    /// Clause by clause.
    pub said: Vec<Said>,
    /// The text with spaces for what was taken.
    pub rest: String,
}
