//! A reading as the description of a new scene.

use super::nouns::Noun;
use super::plan::Plan;
use super::reading::{Feature, LaneSide, Quantity, Reading, Thing, What};
use super::remark::Remark;
use crate::generation::place::description::{Absent, Anchor, Count, Density, Description, Road};
use crate::scene::graph::LaneRole;

/// A description and where it comes from.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Described {
    /// The description.
    pub description: Description,
    /// What of the reading it cannot hold, by act.
    pub remarks: Vec<(usize, Remark)>,
    /// Of each object of the foreground: the act and the thing of it that named it.
    pub from: Vec<(usize, usize)>,
}

/// The description of a new scene.
pub fn describe(reading: &Reading) -> Described {
    let mut d = Description::default();
    let mut plan = Plan::default();
    let mut remarks = Vec::new();
    let mut nobody = super::plan::Nowhere;
    let mut alone = false;
    for (i, act) in reading.acts.iter().enumerate() {
        plan.at = (i, 0);
        match &act.what {
            What::Add { things } => plan.add(things, &mut nobody),
            What::Time { what } => d.time_of_day = Some(*what),
            What::Weather { what } => d.weather = Some(*what),
            What::Env { what } => d.environment = Some(*what),
            What::Density { what } => d.density = Some(*what),
            What::Road { what } => d.road.kind = Some(*what),
            What::Lanes { n } => d.road.lanes = Some((*n).min(12)),
            What::OneWay => d.road.one_way = true,
            What::Narrow => d.road.narrow = true,
            What::Wide => d.road.wide = true,
            What::OwnLane { what } => {
                d.road.own_lane = Some(match what {
                    LaneSide::Left => LaneRole::Left,
                    LaneSide::Right => LaneRole::Right,
                    LaneSide::Middle => LaneRole::Ego,
                });
            }
            What::Has {
                what: Feature::Crossing,
                ..
            } => d.road.crossing = true,
            What::Has {
                what: Feature::Sidewalk,
                ..
            } => d.road.sidewalk = true,
            What::Lacks {
                what: Feature::Crossing,
            } => d.road.no_crossing = true,
            What::Lacks {
                what: Feature::Sidewalk,
            } => d.road.no_sidewalk = true,
            What::No { who } | What::Remove { who } => {
                for t in who {
                    alone |= t.other;
                    // (an empty lane is not an empty scene)
                    if !t.other && t.places.is_empty() && t.paint.is_none() {
                        d.absent.push(Absent {
                            classes: t.noun.classes().to_vec(),
                            state: t.state,
                        });
                    }
                }
            }
            What::Keep { who } => {
                alone = true;
                plan.add(&who.iter().map(as_new).collect::<Vec<_>>(), &mut nobody);
            }
            // What is said of things that were named: of a new scene it is part of them.
            What::Set { who, look } => {
                for t in who {
                    for k in matching(&plan, t) {
                        let s = &mut plan.specs[k];
                        s.state = look.state.or(s.state);
                        s.size = look.size.or(s.size);
                        if let Some(p) = look.paint {
                            s.label.paint = Some(p);
                        }
                    }
                }
            }
            What::Count { who, amount } => {
                if let super::reading::Amount::To(least, most) = amount {
                    for t in who {
                        let them = matching(&plan, t);
                        match them.first() {
                            Some(k) => plan.specs[*k].count = Count::about(*least, *least, *most),
                            None => {
                                let t = t.clone().with(Quantity::Range(*least, *most));
                                plan.add(&[t], &mut nobody);
                            }
                        }
                    }
                }
            }
            What::Move {
                who,
                to: super::reading::Destination::To(places),
            }
            | What::Turn {
                who,
                turn: super::reading::Turn::To(places),
            } => {
                for t in who {
                    if matching(&plan, t).is_empty() {
                        let mut t = as_new(t);
                        t.places.extend(places.iter().cloned());
                        plan.add(&[t], &mut nobody);
                    } else {
                        remarks.push((i, Remark::Already));
                    }
                }
            }
            What::Leave { .. } => {}
            What::Replace { things, .. } => plan.add(things, &mut nobody),
            What::Move { .. } | What::Turn { .. } | What::Swap { .. } => {
                remarks.push((
                    i,
                    Remark::Nobody {
                        what: "thing to change".into(),
                    },
                ));
            }
        }
    }
    let from = plan.from;
    d.foreground = plan.specs;
    if alone && d.density.is_none() {
        d.density = Some(Density::Empty);
    }
    let crossing = d
        .foreground
        .iter()
        .flat_map(|o| &o.relations)
        .any(|r| r.anchor == Anchor::Crossing);
    d.road.crossing |= crossing && !d.road.no_crossing;
    let walks = |r: LaneRole| {
        matches!(
            r,
            LaneRole::Sidewalk | LaneRole::LeftSidewalk | LaneRole::RightSidewalk
        )
    };
    let sidewalk = d
        .foreground
        .iter()
        .flat_map(|o| &o.relations)
        .any(|r| matches!(r.anchor, Anchor::Lane(role) if walks(role)));
    d.road.sidewalk |= sidewalk && !d.road.no_sidewalk;
    let junction = d
        .foreground
        .iter()
        .flat_map(|o| &o.relations)
        .any(|r| r.anchor == Anchor::Junction);
    if junction && d.road.kind.is_none() {
        d.road.kind = Some(Road::Intersection);
    }
    d.summarise();
    Described {
        description: d,
        remarks,
        from,
    }
}

/// The description of a line of notation.
///
/// # Errors
///
/// If it is none.
pub fn described(line: &str) -> Result<Description, super::notation::NotationError> {
    Ok(describe(&super::notation::parse(line)?).description)
}

/// Things that were named as if they were there, as new ones.
fn as_new(t: &Thing) -> Thing {
    let quantity = match t.quantity {
        Quantity::The | Quantity::Unsaid => Quantity::N(1),
        Quantity::TheN(n) => Quantity::N(n),
        Quantity::All | Quantity::Half => Quantity::Some,
        q => q,
    };
    Thing {
        quantity,
        other: false,
        ..t.clone()
    }
}

/// Specs that a thing means.
fn matching(plan: &Plan, t: &Thing) -> Vec<usize> {
    let paint = |k: &usize| match t.paint {
        Some(super::reading::PaintWish::Is(p)) => plan.specs[*k].label.paint == Some(p),
        _ => true,
    };
    let kind = |k: &usize| t.noun.classes().contains(&plan.specs[*k].class);
    let fit: Vec<usize> = (0..plan.specs.len()).filter(kind).filter(paint).collect();
    match t.noun {
        Noun::It | Noun::One => fit.last().copied().into_iter().collect(),
        _ => fit,
    }
}
