//! A reading as the description of a new scene.

use super::beside::{NearTo, SceneryClause as Beside};
use super::notation::{self, NotationError};
use super::nouns::Noun;
use super::plan::{Nowhere, PlacementPlan};
use super::reading::{
    ActKind, Amount, AnchorPhrase as Said, Destination, Feature, LaneSide, ObjectPhrase, PaintWish,
    PlacePhrase, Quantity, Reading, Relation, Traits, Turn,
};
use super::remark::Remark;
use super::resolve::words_of;
use place::description::{Absent, Anchor, Count, Density, Description, Road};
use scene::Class;
use scene::clip::{Manoeuvre, Template};
use scene::graph::{LaneRole, RelationKind};

/// A description and the acts that it comes from.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Described {
    /// The description.
    pub description: Description,
    /// Parts of the reading that it cannot hold, by act.
    pub remarks: Vec<(usize, Remark)>,
    /// Origin of each object of the foreground: the act, and the thing of that act, that named it.
    pub from: Vec<(usize, usize)>,
}

/// The description of a line of notation.
///
/// # Errors
///
/// If the line is not valid notation.
pub fn described(line: &str) -> Result<Description, NotationError> {
    Ok(describe(&notation::parse(line)?).description)
}

/// The description of a new scene.
pub fn describe(reading: &Reading) -> Described {
    let mut s = Describing::default();
    for (i, act) in reading.acts.iter().enumerate() {
        s.act = i;
        s.plan.at = (i, 0);
        if !(s.conditions(&act.what) || s.road(&act.what)) {
            s.things(&act.what);
        }
    }
    let mut out = s.done();
    beside(&reading.background, &mut out.description);
    out
}

/// Adds the scenery of a reading. If it mentions a crossing or a junction, the road gets one.
fn beside(background: &[Beside], d: &mut Description) {
    for said in background {
        match said.place.near {
            Some(NearTo::Crossing) => d.road.crossing = !d.road.no_crossing,
            Some(NearTo::Junction) if d.road.kind.is_none() => d.road.kind = Some(Road::Intersection),
            _ => {}
        }
        let comma = if d.summary.is_empty() { "" } else { "; " };
        d.summary.push_str(&format!("{comma}{}", said.described()));
        d.background.push(said.clone());
    }
}

#[derive(Default)]
struct Describing {
    d: Description,
    plan: PlacementPlan,
    remarks: Vec<(usize, Remark)>,
    /// True if nothing else shall be there.
    alone: bool,
    act: usize,
}

impl Describing {
    fn remark(&mut self, remark: Remark) {
        self.remarks.push((self.act, remark));
    }

    /// Light, surroundings, traffic; true if the act is about them.
    fn conditions(&mut self, what: &ActKind) -> bool {
        let d = &mut self.d;
        match what {
            ActKind::Time { what } => d.time_of_day = Some(*what),
            ActKind::Weather { what } => d.weather = Some(*what),
            ActKind::Env { what } => d.environment = Some(*what),
            ActKind::Density { what } => d.density = Some(*what),
            ActKind::Length { seconds } => d.length_s = Some(*seconds),
            _ => return false,
        }
        true
    }

    /// The road; true if the act is about it.
    fn road(&mut self, what: &ActKind) -> bool {
        let road = &mut self.d.road;
        match what {
            ActKind::Road { what } => road.kind = Some(*what),
            ActKind::Lanes { n } => road.lanes = Some((*n).min(12)),
            ActKind::OneWay => road.one_way = true,
            ActKind::Narrow => road.narrow = true,
            ActKind::Wide => road.wide = true,
            ActKind::OwnLane { what } => {
                road.own_lane = Some(match what {
                    LaneSide::Left => LaneRole::Left,
                    LaneSide::Right => LaneRole::Right,
                    LaneSide::Middle => LaneRole::Ego,
                });
            }
            ActKind::Has {
                what: Feature::Crossing,
                places,
            } => {
                road.crossing = true;
                let ahead = |p: &&PlacePhrase| p.relation == Relation::Ahead && p.to == Some(Said::Ego);
                road.crossing_m = places.iter().find(ahead).and_then(|p| p.metres);
                let other = places.iter().find(|p| !ahead(p)).map(|p| p.relation);
                if let Some(relation) = other {
                    self.remark(Remark::PlaceIgnored { relation });
                }
            }
            ActKind::Has {
                what: Feature::Sidewalk,
                ..
            } => road.sidewalk = true,
            ActKind::Lacks {
                what: Feature::Crossing,
            } => road.no_crossing = true,
            ActKind::Lacks {
                what: Feature::Sidewalk,
            } => road.no_sidewalk = true,
            _ => return false,
        }
        true
    }

    fn add(&mut self, things: &[ObjectPhrase]) {
        self.plan.add(things, &mut Nowhere);
    }

    /// Adds things, and applies statements about things that were named.
    fn things(&mut self, what: &ActKind) {
        match what {
            ActKind::Add { things } => self.add(things),
            ActKind::No { who } | ActKind::Remove { who } => who.iter().for_each(|t| self.absent(t)),
            ActKind::Keep { who } => {
                self.alone = true;
                self.add(&who.iter().map(as_new).collect::<Vec<_>>());
            }
            ActKind::Set { who, traits } => who.iter().for_each(|t| self.set(t, traits)),
            ActKind::Count { who, amount } => who.iter().for_each(|t| self.count(t, *amount)),
            ActKind::Move {
                who,
                to: Destination::To(places),
            }
            | ActKind::Turn {
                who,
                turn: Turn::To(places),
            } => who.iter().for_each(|t| self.place(t, places)),
            ActKind::Replace { things, .. } => self.add(things),
            ActKind::Go { who, how } if who.is_empty() => {
                let how = Manoeuvre { gap_m: None, ..*how };
                self.d.ego_motion = Some(self.d.ego_motion.map_or(how, |before| how.after(&before).0));
            }
            ActKind::Go { who, how } => who.iter().for_each(|t| self.go(t, how)),
            ActKind::Leave { .. } => {}
            _ => self.remark(Remark::Nobody {
                what: "thing to change".into(),
            }),
        }
    }

    fn absent(&mut self, t: &ObjectPhrase) {
        self.alone |= t.other;
        // (an empty lane is not an empty scene)
        if !t.other && t.places.is_empty() && t.paint.is_none() {
            self.d.absent.push(Absent {
                classes: t.noun.classes().to_vec(),
                state: t.state,
            });
        }
    }

    /// Objects that a thing means, with a remark if there are none.
    fn those(&mut self, t: &ObjectPhrase) -> Vec<usize> {
        let them = self.matching(t);
        if them.is_empty() {
            self.remark(Remark::Nobody { what: words_of(t) });
        }
        them
    }

    fn set(&mut self, t: &ObjectPhrase, traits: &Traits) {
        let mut paint = traits.paint;
        if let Some(of) = &traits.paint_of {
            let model = self.those(of).first().copied();
            paint = model.and_then(|k| self.plan.specs[k].label.paint);
        }
        for k in self.those(t) {
            let s = &mut self.plan.specs[k];
            s.state = traits.state.or(s.state);
            s.size = traits.size.or(s.size);
            s.label.paint = paint.or(s.label.paint);
        }
    }

    /// Makes objects move; an object that was not named before is new.
    fn go(&mut self, t: &ObjectPhrase, how: &Manoeuvre) {
        let mut them = self.matching(t);
        if them.is_empty() {
            self.add(&[as_new(t)]);
            them = self.plan.specs.len().checked_sub(1).into_iter().collect();
        }
        for k in them {
            let (how, all) = match &self.plan.specs[k].motion {
                Some(before) => how.after(before),
                None => (*how, true),
            };
            self.plan.specs[k].motion = Some(how);
            if !all {
                self.remark(Remark::OneMotion { what: words_of(t) });
            }
            if let Some(role) = self.usual_start(k, how.what) {
                let place = PlacePhrase {
                    relation: Relation::On,
                    to: Some(Said::Lane(role)),
                    and: None,
                    metres: None,
                };
                self.plan.also_at(k, &[place], &mut Nowhere);
            }
        }
    }

    /// Lane or strip in which an object starts a manoeuvre if neither its lane nor its side was stated.
    fn usual_start(&self, k: usize, what: Template) -> Option<LaneRole> {
        let spec = &self.plan.specs[k];
        let is_lane = |r: &place::description::Stated| {
            matches!(r.anchor, Anchor::Lane(_) | Anchor::Crossing | Anchor::Junction)
                || matches!(r.anchor, Anchor::Object(_)) && r.relation == RelationKind::Between
        };
        if spec.relations.iter().any(is_lane) {
            return None;
        }
        let walks = spec.class == Class::Pedestrian;
        match what {
            Template::CutIn => Some(LaneRole::Left),
            Template::Cross if walks => Some(LaneRole::RightSidewalk),
            Template::Cross => Some(LaneRole::Cross),
            Template::PullOut => Some(LaneRole::RightRoadside),
            _ => None,
        }
    }

    fn count(&mut self, t: &ObjectPhrase, amount: Amount) {
        let them = self.matching(t);
        match (amount, them.first()) {
            (Amount::To(least, most), Some(k)) => {
                self.plan.specs[*k].count = Count::about(least, least, most)
            }
            (Amount::To(least, most), None) => self.add(&[t.clone().with(Quantity::Range(least, most))]),
            (Amount::Times(f), Some(_)) => {
                for k in them {
                    let n = f64::from(self.plan.specs[k].count.n) * f.clamp(0.0, 100.0);
                    self.plan.specs[k].count = Count::exactly(n.round() as u32);
                }
            }
            (Amount::Times(_), None) => self.remark(Remark::Nobody { what: words_of(t) }),
        }
    }

    fn place(&mut self, t: &ObjectPhrase, places: &[PlacePhrase]) {
        let them = self.matching(t);
        if them.is_empty() {
            let mut t = as_new(t);
            t.places.extend(places.iter().cloned());
            self.add(&[t]);
        }
        for k in them {
            self.plan.also_at(k, places, &mut Nowhere);
        }
    }

    /// Objects that a thing means.
    fn matching(&mut self, t: &ObjectPhrase) -> Vec<usize> {
        let fits = |k: &usize| {
            let (spec, named) = (&self.plan.specs[*k], self.plan.thing_of(*k));
            let paint = match t.paint {
                Some(PaintWish::Is(p)) => spec.label.paint == Some(p),
                Some(PaintWish::Not(p)) => spec.label.paint != Some(p),
                None => true,
            };
            let kind = match t.noun {
                Noun::It | Noun::One | Noun::Thing => true,
                noun if noun.is_plain() => noun.classes().contains(&spec.class),
                noun => noun == named.noun,
            };
            let state = t.state.is_none() || t.state == spec.state;
            let places = t.places.is_empty() || t.places.iter().any(|p| named.places.contains(p));
            paint && kind && state && places
        };
        let mut fit: Vec<usize> = (0..self.plan.specs.len()).filter(fits).collect();
        if matches!(t.noun, Noun::It | Noun::One) && t.quantity != Quantity::All {
            fit = fit.last().copied().into_iter().collect();
        }
        // (before they are placed it is unknown which of several equal ones is the nearest)
        let one = t.nth.or(t.pick.map(|_| 1)).filter(|_| fit.len() > 1);
        if let Some(n) = one {
            let k = fit.len() - 1;
            fit = vec![fit[if n == 0 { k } else { (n as usize - 1).min(k) }]];
            self.remark(Remark::Chosen {
                what: words_of(t),
                which: "first named",
            });
        }
        fit
    }

    fn done(self) -> Described {
        let (mut d, from) = (self.d, self.plan.from);
        d.foreground = self.plan.specs;
        if self.alone && d.density.is_none() {
            d.density = Some(Density::Empty);
        }
        let is_at = |test: &dyn Fn(Anchor) -> bool| {
            let mut relations = d.foreground.iter().flat_map(|o| &o.relations);
            relations.any(|r| test(r.anchor))
        };
        let walks = |a: Anchor| {
            use LaneRole as L;
            matches!(a, Anchor::Lane(L::Sidewalk | L::LeftSidewalk | L::RightSidewalk))
        };
        let crossing = is_at(&|a| a == Anchor::Crossing);
        let sidewalk = is_at(&walks);
        let junction = is_at(&|a| a == Anchor::Junction);
        d.road.crossing |= crossing && !d.road.no_crossing;
        d.road.sidewalk |= sidewalk && !d.road.no_sidewalk;
        if junction && d.road.kind.is_none() {
            d.road.kind = Some(Road::Intersection);
        }
        d.summarise();
        Described {
            description: d,
            remarks: self.remarks,
            from,
        }
    }
}

/// Things that were named as existing, as new ones.
fn as_new(t: &ObjectPhrase) -> ObjectPhrase {
    let quantity = match t.quantity {
        Quantity::The | Quantity::Unsaid => Quantity::N(1),
        Quantity::TheN(n) => Quantity::N(n),
        Quantity::All | Quantity::Each | Quantity::Half => Quantity::Some,
        q => q,
    };
    ObjectPhrase {
        quantity,
        other: false,
        ..t.clone()
    }
}
