//! Objects as a sentence names them, and what a relation means for each.

use super::description::{Anchor, Count, ObjectSpec, Stated};
use super::tokens::Span;
use super::words::edits::Pick;
use super::words::objects::{NOUNS, Noun};
use crate::scene::Class;
use crate::scene::graph::{LaneRole, ObjectState, RelationKind, SizeHint};

/// One mention of objects of one kind.
#[derive(Clone, Debug)]
pub struct Mention {
    /// What will stand in the description.
    pub spec: ObjectSpec,
    /// Every class that the noun may mean.
    pub classes: &'static [Class],
    /// "the".
    pub definite: bool,
    /// More than one, by form or number.
    pub plural: bool,
    /// True if no number was said.
    pub uncounted: bool,
    /// Which of several.
    pub pick: Option<Pick>,
    /// A box by its number.
    pub id: Option<u32>,
    /// On both sides; true if the count is for each.
    pub both: Option<bool>,
    /// Named only to say where something else is.
    pub is_anchor: bool,
    /// Who it was said to be with.
    pub host: Option<usize>,
    /// Neither an article nor a number stood before it.
    pub bare: bool,
    /// An adjective said where it is: "oncoming".
    pub said_where: bool,
    /// Used up by its parts.
    pub gone: bool,
    /// "The second one": of the kind of another, until it is told what it is.
    pub like: bool,
}

/// What was said before a noun.
#[derive(Clone, Debug, Default)]
pub struct Pre {
    /// Number.
    pub count: Option<Count>,
    /// `the`: true; `a`: false.
    pub article: Option<bool>,
    /// State.
    pub state: Option<ObjectState>,
    /// Size.
    pub size: Option<SizeHint>,
    /// Colour.
    pub color: Option<String>,
    /// Other words.
    pub attributes: Vec<String>,
    /// Turned around.
    pub not: bool,
    /// Which.
    pub pick: Option<Pick>,
    /// Box number.
    pub id: Option<u32>,
    /// "each".
    pub each: bool,
    /// Of all this.
    pub span: Option<Span>,
}

impl Pre {
    /// Takes the span of one more word in.
    pub fn cover(&mut self, span: Span) {
        self.span = Some(self.span.map_or(span, |s| s.to(span)));
    }
    /// True if anything but an article was said.
    pub fn says_something(&self) -> bool {
        self.count.is_some()
            || self.state.is_some()
            || self.size.is_some()
            || self.color.is_some()
            || !self.attributes.is_empty()
    }
}

impl Mention {
    /// A noun and what stood before it.
    pub fn new(noun: &'static Noun, word: &str, plural: bool, pre: Pre, span: Span) -> Self {
        let counted = pre.count.map(|c| {
            if noun.several > 1 && c.n == 1 {
                Count::about(2, noun.several, 30)
            } else {
                c
            }
        });
        let several = Count::about(2, noun.several, noun.several * 3);
        let count = match (counted, pre.article) {
            (Some(count), _) => count,
            _ if noun.several > 1 => several,
            (None, _) if plural => Count::about(2, 3, 8),
            _ => Count::exactly(1),
        };
        let mut attributes = pre.attributes;
        if noun.nearest {
            attributes.push(format!("shown as {}", noun.classes[0].label()));
        }
        let spec = ObjectSpec {
            class: noun.classes[0],
            noun: word.to_string(),
            count,
            state: pre.state.or(noun.state),
            size: pre.size.or(noun.size),
            color: pre.color,
            attributes,
            size_m: noun.size_m,
            relations: Vec::new(),
            span: pre.span.map_or(span, |s| s.to(span)),
        };
        Self {
            spec,
            classes: noun.classes,
            definite: pre.article == Some(true),
            plural: plural || count.n > 1,
            uncounted: pre.count.is_none(),
            pick: pre.pick,
            id: pre.id,
            both: None,
            is_anchor: false,
            host: None,
            bare: pre.article.is_none() && pre.count.is_none(),
            said_where: false,
            gone: false,
            like: false,
        }
    }
}

/// True for "everything" and the like.
pub fn means_all(m: &Mention) -> bool {
    m.classes.len() > 8
}

impl Mention {
    /// A person turns out to ride something of this class.
    pub fn mounts(&mut self, class: Class) {
        let Some(noun) = NOUNS.iter().find(|n| n.classes == [class]) else {
            return;
        };
        self.classes = noun.classes;
        self.spec.class = class;
        self.spec.size_m = noun.size_m;
        self.spec.noun = class.label();
    }
}

/// How a place was said.
#[derive(Clone, Debug, PartialEq)]
pub enum Prep {
    /// By relations.
    Rels(Vec<RelationKind>),
    /// in, on
    In,
    /// at, by
    At,
    /// across
    Across,
    /// across the street
    FarSide,
    /// the other side of the street for what is beyond it: the right one
    NearSide,
}

/// A place that was said, before it is known of what.
#[derive(Clone, Debug, PartialEq)]
pub struct Frag {
    /// How.
    pub prep: Prep,
    /// Of what.
    pub anchor: Anchor,
    /// The second one of `between`.
    pub and: Option<Anchor>,
    /// How far, m.
    pub distance_m: Option<f64>,
    /// Where it was said.
    pub span: Span,
}

fn walks(class: Class) -> bool {
    class == Class::Pedestrian
}

/// What the place means for these objects: adds relations, and the state that follows from it.
pub fn apply(spec: &mut ObjectSpec, frag: &Frag) {
    use Anchor::{Crossing, Ego, Junction, Lane, Object};
    use LaneRole as L;
    use RelationKind as R;
    let mut out: Vec<(R, Anchor)> = Vec::new();
    let parked = spec.state == Some(ObjectState::Parked);
    let moving = spec.state == Some(ObjectState::Moving);
    let strip = |left: bool, class: Class| match (walks(class), left) {
        (true, true) => L::LeftSidewalk,
        (true, false) => L::RightSidewalk,
        (false, true) => L::LeftRoadside,
        (false, false) => L::RightRoadside,
    };
    // People at the edge of a road stand on the sidewalk.
    let anchor = match frag.anchor {
        Lane(L::Roadside) if walks(spec.class) => Lane(L::Sidewalk),
        Lane(L::LeftRoadside) if walks(spec.class) => Lane(L::LeftSidewalk),
        Lane(L::RightRoadside) if walks(spec.class) => Lane(L::RightSidewalk),
        other => other,
    };
    let on = |anchor: Anchor| {
        let strip = matches!(
            anchor,
            Lane(
                L::Roadside
                    | L::LeftRoadside
                    | L::RightRoadside
                    | L::Carpark
                    | L::Sidewalk
                    | L::LeftSidewalk
                    | L::RightSidewalk
            )
        );
        (if parked && strip { R::ParkedOn } else { R::On }, anchor)
    };
    let crosses = spec.relations.iter().any(|r| r.relation == R::Crossing);
    match &frag.prep {
        Prep::Rels(kinds) => {
            for &kind in kinds {
                match (kind, anchor) {
                    (R::LeftOf | R::RightOf, Lane(L::Road | L::Ego)) => {
                        let left = kind == R::LeftOf;
                        out.push((kind, Ego));
                        if parked || (walks(spec.class) && !crosses) || (!moving && !walks(spec.class)) {
                            out.push(on(Lane(strip(left, spec.class))));
                        }
                    }
                    (R::InFrontOf | R::Behind, Lane(L::Road)) => out.push((kind, Ego)),
                    (R::Near | R::NextTo, Lane(L::Road)) => {
                        out.push(on(Lane(if walks(spec.class) {
                            L::Sidewalk
                        } else {
                            L::Roadside
                        })));
                    }
                    (R::Near | R::NextTo, Lane(strip))
                        if !matches!(strip, L::Ego | L::Left | L::Right | L::Oncoming) =>
                    {
                        out.push(on(Lane(strip)));
                    }
                    (R::NextTo, Crossing | Junction) => out.push((R::Near, anchor)),
                    (R::Across, Lane(_) | Ego) => far_side(spec.class, parked, &mut out),
                    (R::Across, Crossing | Junction) => out.push((R::Near, anchor)),
                    (R::Blocking, Ego) => out.push((R::Blocking, Lane(L::Ego))),
                    // What closes off something else stands by it.
                    (R::Blocking, Object(_)) if matches!(spec.class, Class::TrafficCone | Class::Barrier) => {
                        out.push((R::NextTo, anchor));
                    }
                    (R::Blocking, Crossing | Junction) => out.push((R::On, anchor)),
                    (R::Facing, Crossing | Junction) => out.push((R::Near, anchor)),
                    (R::Facing | R::FacingAway, Lane(_)) => {}
                    (R::Following, Lane(_)) => out.push((R::On, anchor)),
                    (R::Crossing, Crossing) => out.extend([(R::Crossing, Lane(L::Road)), (R::On, Crossing)]),
                    (R::Crossing, Junction) if walks(spec.class) => {
                        out.extend([(R::Crossing, Lane(L::Road)), (R::Near, Junction)]);
                    }
                    (R::Crossing, Junction) => out.push((R::On, Junction)),
                    (R::Crossing, Lane(L::Sidewalk | L::LeftSidewalk | L::RightSidewalk)) => {
                        out.push((R::On, anchor))
                    }
                    (R::Crossing, Lane(L::LeftRoadside)) => {
                        out.extend([(R::Crossing, Lane(L::Road)), (R::LeftOf, Ego)]);
                    }
                    (R::Crossing, Lane(L::RightRoadside)) => {
                        out.extend([(R::Crossing, Lane(L::Road)), (R::RightOf, Ego)]);
                    }
                    (R::Crossing, Lane(L::Roadside)) => out.push((R::Crossing, Lane(L::Road))),
                    (R::Crossing, Ego | Object(_)) => out.push((R::Crossing, Lane(L::Road))),
                    _ => out.push((kind, anchor)),
                }
                match kind {
                    R::Crossing | R::Following | R::OppositeDirection | R::SameDirection => {
                        spec.state = spec.state.or(Some(ObjectState::Moving));
                    }
                    R::WaitingAt | R::Blocking => spec.state = Some(ObjectState::Waiting),
                    _ => {}
                }
            }
        }
        Prep::In => match anchor {
            // Who is in a car park is parked, unless something else is said.
            Lane(L::Carpark) if spec.state.is_none() && spec.class.is_vehicle() => {
                spec.state = Some(ObjectState::Parked);
                out.push((R::ParkedOn, anchor));
            }
            Ego => {}
            Object(_) => out.push((R::NextTo, anchor)),
            Lane(L::Road) if parked => out.push((R::ParkedOn, Lane(L::Roadside))),
            _ => out.push(on(anchor)),
        },
        Prep::At => match anchor {
            Ego => out.push((R::Near, Ego)),
            Object(_) => out.push((R::NextTo, anchor)),
            Crossing if crosses => out.push((R::On, Crossing)),
            Crossing | Junction if spec.state == Some(ObjectState::Waiting) => {
                out.push((R::WaitingAt, anchor))
            }
            Crossing | Junction => out.push((R::Near, anchor)),
            Lane(L::Road) if parked => out.push((R::ParkedOn, Lane(L::Roadside))),
            Lane(L::Road) if walks(spec.class) && !crosses => out.push((R::On, Lane(L::Sidewalk))),
            Lane(_) => out.push(on(anchor)),
        },
        Prep::Across => match anchor {
            Lane(_) if walks(spec.class) || moving => out.push((R::Crossing, anchor)),
            Lane(_) => out.push((R::Blocking, anchor)),
            Crossing => {
                if !walks(spec.class) && !moving {
                    spec.state = Some(ObjectState::Waiting); // it lies across it
                }
                out.push((R::On, Crossing));
            }
            _ => out.push((R::Across, anchor)),
        },
        Prep::FarSide => far_side(spec.class, parked, &mut out),
        Prep::NearSide => {
            out.push((R::RightOf, Ego));
            out.push(on(Lane(strip(false, spec.class))));
        }
    }
    // The left kerb is on the left.
    let side = match out.last() {
        Some((R::On | R::ParkedOn, Lane(L::LeftRoadside | L::LeftSidewalk))) => Some(R::LeftOf),
        Some((R::On | R::ParkedOn, Lane(L::RightRoadside | L::RightSidewalk))) => Some(R::RightOf),
        _ => None,
    };
    if let Some(side) = side.filter(|s| !out.iter().any(|(k, _)| k == s)) {
        out.push((side, Ego));
    }
    for (i, (relation, anchor)) in out.into_iter().enumerate() {
        let stated = Stated {
            relation,
            anchor,
            and: if relation == R::Between { frag.and } else { None },
            distance_m: frag.distance_m.filter(|_| i == 0),
            span: frag.span,
        };
        let same = |s: &Stated| (s.relation, s.anchor, s.and) == (stated.relation, stated.anchor, stated.and);
        match spec.relations.iter_mut().find(|s| same(s)) {
            Some(old) => old.distance_m = old.distance_m.or(stated.distance_m),
            None => spec.relations.push(stated),
        }
    }
}

/// The far side of the street as the ego sees it: the left one in right-hand traffic.
fn far_side(class: Class, parked: bool, out: &mut Vec<(RelationKind, Anchor)>) {
    use RelationKind as R;
    out.push((R::LeftOf, Anchor::Ego));
    out.push(match (walks(class), parked) {
        (true, _) => (R::On, Anchor::Lane(LaneRole::LeftSidewalk)),
        (false, true) => (R::ParkedOn, Anchor::Lane(LaneRole::LeftRoadside)),
        (false, false) if class.is_vehicle() || class == Class::Motorcycle => {
            (R::On, Anchor::Lane(LaneRole::Oncoming))
        }
        (false, false) => (R::On, Anchor::Lane(LaneRole::LeftRoadside)),
    });
}
