//! Places, kinds of road, time and weather.

use super::super::description::{Anchor, Became, Environment, Road, TimeOfDay, Weather};
use super::super::lexicon::Sense;
use super::super::mention::{Pre, Prep};
use super::super::tag::{Item, Tag};
use super::super::tokens::Span;
use super::Parser;
use crate::scene::graph::{LaneRole, RelationKind};

impl Parser<'_> {
    pub(super) fn place(&mut self, anchor: Anchor, road: Option<Road>, item: &Item) {
        let span = item.span;
        let own = item.words.starts_with("its ")
            || item.words.starts_with("their ")
            || item.words.starts_with("his ");
        let against = |t: &usize| {
            let relations = &self.mentions[*t].spec.relations;
            relations
                .iter()
                .any(|r| r.relation == RelationKind::OppositeDirection)
        };
        if own && self.pending.is_some() && self.targets().iter().any(against) {
            self.pending = None; // its own lane is the oncoming one
            return;
        }
        // "we are on the motorway, and in the lane to our right a coach drives"
        let of_next = self.pending.as_ref().is_some_and(|p| p.fresh && p.anded)
            && matches!(anchor, Anchor::Lane(_))
            && self.noun_ahead(self.at + 1);
        self.ego_subject &= !of_next;
        let before = self
            .item(self.at.wrapping_sub(1))
            .map_or("", |b| b.words.as_str());
        let middle = item
            .words
            .split(' ')
            .chain(before.split(' '))
            .any(|w| matches!(w, "middle" | "centre" | "center"));
        let own_lane = match anchor {
            Anchor::Lane(role @ (LaneRole::Left | LaneRole::Right)) => Some(role),
            Anchor::Lane(LaneRole::Ego) if middle => Some(LaneRole::Ego),
            _ => None,
        };
        if self.ego_subject && self.head.is_empty() && self.last.is_empty() && self.pending.is_some() {
            self.d().road.own_lane = own_lane;
            self.pending = None; // "we stand by the traffic light" sets the stage
        }
        // "in that same lane"
        let same = item.words == "same lane" && self.at > 0
            || matches!(item.words.as_str(), "lane")
                && self
                    .item(self.at.wrapping_sub(1))
                    .is_some_and(|b| matches!(b.words.as_str(), "that" | "this" | "same" | "the"));
        // "behind it in the same lane": the lane of what it is behind
        if same && anchor == Anchor::Lane(LaneRole::Ego) && self.lane_of_other() {
            return;
        }
        let anchor = match self
            .last_lane
            .filter(|_| same && anchor == Anchor::Lane(LaneRole::Ego))
        {
            Some(lane) => lane,
            None => anchor,
        };
        if matches!(
            anchor,
            Anchor::Lane(LaneRole::Left | LaneRole::Right | LaneRole::Oncoming)
        ) {
            self.last_lane = Some(anchor);
        }
        if anchor != Anchor::Lane(LaneRole::Road) {
            self.last_place = Some(anchor);
        }
        let not = std::mem::take(&mut self.pre.not);
        let definite = self.pre.article == Some(true);
        self.pre = Pre::default();
        if not && self.pending.is_none() {
            match anchor {
                Anchor::Crossing => self.d().road.no_crossing = true,
                Anchor::Lane(LaneRole::Sidewalk) => self.d().road.no_sidewalk = true,
                Anchor::Junction => self.d().road.kind = Some(Road::Straight),
                _ => {
                    self.unread(span, Some("a road without it cannot be made".into()));
                    return;
                }
            }
            self.phrase(span, Became::Road, &format!("none: {}", item.words));
            return;
        }
        // What must be there for the place to be.
        match anchor {
            Anchor::Crossing => self.d().road.crossing = true,
            Anchor::Lane(LaneRole::Sidewalk | LaneRole::LeftSidewalk | LaneRole::RightSidewalk) => {
                self.d().road.sidewalk = true
            }
            _ => {}
        }
        if let Some(kind) = road {
            let lamp = item.words.contains("light")
                || item.words.contains("sign")
                || item.words.contains("line")
                || item.words.contains("signal");
            let wish = &mut self.reading.description.road.kind;
            // "traffic light" does not turn a t-junction into crossroads.
            if wish.is_none() || (!lamp && *wish != Some(Road::Roundabout) && *wish != Some(Road::TJunction))
            {
                *wish = Some(kind);
            }
        }
        if self.pending.is_some() {
            // "stopped by a pedestrian who is on the crosswalk" says where that one is
            let of_one = self.relative
                && self
                    .fronted
                    .last()
                    .is_some_and(|f| matches!(f.anchor, Anchor::Object(_)));
            let fronts = self.head.is_empty() && (!self.ego_subject || self.last.is_empty())
                && !of_one
                // "waiting at the right kerb for a gap: an old man"
                && (self.fronted_state.is_none() || anchor == Anchor::Lane(LaneRole::Road));
            let next_noun = self.noun_ahead(self.at + 1)
                // "in our lane ahead of us is a truck"
                || self.inverted_ahead(self.at + 1)
                // "at the zebra ahead four people are waiting"
                || matches!(self.sense(self.at + 1), Some(Sense::EgoRel(_))) && self.noun_ahead(self.at + 2)
                || matches!(
                    self.item(self.at + 1).map(|i| i.tag),
                    Some(Tag::Comma | Tag::Mark)
                );
            let vague = matches!(anchor, Anchor::Lane(LaneRole::Road))
                || (road.is_some() && !definite && !matches!(anchor, Anchor::Lane(LaneRole::Carpark)));
            let plain = self
                .pending
                .as_ref()
                .is_some_and(|p| matches!(p.prep, Prep::In | Prep::At));
            if fronts && plain && (vague || !next_noun) {
                // "On a busy street, ..." sets the stage and says nothing of one object.
                self.pending = None;
                self.phrase(span, Became::Road, &item.words);
            } else {
                if road.is_some() {
                    self.phrase(span, Became::Road, &item.words);
                }
                self.anchor(anchor, span);
                // "in my lane ahead"
                let ahead = item.words.ends_with(" ahead") || item.words.ends_with(" in front of me");
                if ahead && matches!(anchor, Anchor::Lane(LaneRole::Ego)) && !self.edits {
                    self.begin(Prep::Rels(vec![RelationKind::InFrontOf]), span);
                    self.anchor(Anchor::Ego, span);
                }
            }
            return;
        }
        if self.bare_place(anchor) {
            // "truck 30 m ahead ego lane", "2 peds left sidewalk"
            self.begin(Prep::In, span);
            self.anchor(anchor, span);
            return;
        }
        let opened = self.item(self.at.wrapping_sub(1)).is_some_and(|b| {
            matches!(
                b.tag,
                super::super::tag::Tag::Comma | super::super::tag::Tag::Mark
            )
        });
        // "left lane one car, right lane two trucks"
        let fresh = matches!(
            self.item(self.at + 1).map(|n| n.tag),
            Some(Tag::Number(_) | Tag::Is(Sense::Article(false) | Sense::Count(_)))
        ) && !matches!(self.sense(self.at + 2), Some(Sense::Unit(_)));
        let told = !matches!(anchor, Anchor::Lane(LaneRole::Road) | Anchor::Junction);
        if (opened
            || self
                .item(self.at.wrapping_sub(1))
                .is_none_or(|b| b.tag == Tag::Stop))
            && !self.edits
            && fresh
            && told
            && self.noun_ahead(self.at + 1)
        {
            self.new_clause();
            self.begin(Prep::In, span);
            self.anchor(anchor, span);
            return;
        }
        if opened
            && self.ends(self.at + 1)
            && !self.head.is_empty()
            && !matches!(anchor, Anchor::Lane(LaneRole::Road))
        {
            // "Ped 2: left pavement", "a van, left lane, 20 m ahead"
            self.begin(
                if anchor == Anchor::Junction {
                    Prep::At
                } else {
                    Prep::In
                },
                span,
            );
            self.anchor(anchor, span);
            return;
        }
        if road.is_some() || matches!(anchor, Anchor::Crossing | Anchor::Lane(LaneRole::Sidewalk)) {
            self.phrase(span, Became::Road, &item.words);
        }
        self.topic = Some((anchor, span));
    }

    /// In the lane of what the target is behind or ahead of. True if it is that of something.
    fn lane_of_other(&mut self) -> bool {
        let targets = self.targets();
        // (the truck of "behind the truck" was named last)
        let placed = |t: &usize| {
            self.mentions[*t].spec.relations.iter().any(|r| {
                matches!(
                    r.relation,
                    RelationKind::Behind | RelationKind::Following | RelationKind::InFrontOf
                ) && matches!(r.anchor, Anchor::Object(_))
            })
        };
        let targets: Vec<usize> = if targets.iter().any(placed) {
            targets
        } else {
            self.head.clone()
        };
        let Some(&t) = targets.first() else {
            return false;
        };
        let to = self.mentions[t]
            .spec
            .relations
            .iter()
            .find_map(|r| match (r.relation, r.anchor) {
                (
                    RelationKind::Behind | RelationKind::Following | RelationKind::InFrontOf,
                    Anchor::Object(i),
                ) => Some((r.relation, i)),
                _ => None,
            });
        let Some((relation, other)) = to else {
            return false;
        };
        self.pending = None;
        self.pre = Pre::default();
        let lane = self.mentions[other]
            .spec
            .relations
            .iter()
            .find(|r| {
                matches!(r.relation, RelationKind::On | RelationKind::OppositeDirection)
                    && matches!(
                        r.anchor,
                        Anchor::Lane(
                            LaneRole::Ego
                                | LaneRole::Left
                                | LaneRole::Right
                                | LaneRole::Oncoming
                                | LaneRole::Cross
                        ) | Anchor::Ego
                    )
            })
            .copied();
        for t in targets {
            let list = &mut self.mentions[t].spec.relations;
            if relation == RelationKind::Behind {
                for r in list
                    .iter_mut()
                    .filter(|r| r.anchor == Anchor::Object(other) && r.relation == relation)
                {
                    r.relation = RelationKind::Following; // in its lane, going its way
                }
            }
            if let Some(lane) = lane {
                list.push(super::super::description::Stated {
                    distance_m: None,
                    ..lane
                });
            }
        }
        true
    }

    pub(super) fn road_kind(&mut self, road: Road, environment: Option<Environment>, span: Span) {
        let not = std::mem::take(&mut self.pre.not);
        self.pre = Pre::default();
        self.drop_pending();
        if not {
            self.unread(span, Some("which road it is not, is not read".into()));
            return;
        }
        let wish = &mut self.reading.description.road.kind;
        // A junction on a highway is a junction.
        let keeps = matches!(
            wish,
            Some(Road::Intersection | Road::TJunction | Road::Roundabout | Road::Parking)
        ) && matches!(road, Road::Straight | Road::Suburb);
        if !keeps {
            *wish = Some(road);
        }
        if let Some(environment) = environment {
            self.d().environment.get_or_insert(environment);
        }
        self.phrase(span, Became::Road, &format!("road: {}", road.name()));
        if self.pending.is_some() {
            self.pending = None;
        }
        self.topic = Some((Anchor::Lane(LaneRole::Road), span));
    }

    pub(super) fn time(&mut self, time: TimeOfDay, span: Span) {
        let not = std::mem::take(&mut self.pre.not);
        self.drop_pending();
        self.pre = Pre::default();
        if not {
            self.unread(span, Some("when it is not, is not read".into()));
            return;
        }
        let old = self.reading.description.time_of_day;
        match old {
            Some(old) if old != time => {
                // "late afternoon sun at night": the first one stays.
                let note = format!(
                    "{} and {} were said: it is {}",
                    old.name(),
                    time.name(),
                    old.name()
                );
                if !(old == TimeOfDay::Day || time == TimeOfDay::Day) {
                    self.reading.notes.push(note);
                } else if old == TimeOfDay::Day {
                    self.d().time_of_day = Some(time);
                }
            }
            _ => self.d().time_of_day = Some(time),
        }
        self.phrase(span, Became::Time, &format!("time: {}", time.name()));
    }

    pub(super) fn weather(&mut self, weather: Weather, span: Span) {
        let not = std::mem::take(&mut self.pre.not) || self.not_goes_on;
        self.drop_pending();
        self.pre = Pre::default();
        if not {
            let dry = if weather == Weather::Clear {
                Weather::Overcast
            } else {
                Weather::Clear
            };
            if self.reading.description.weather.is_none() {
                self.d().weather = Some(dry);
            }
            self.phrase(span, Became::Weather, &format!("weather: not {}", weather.name()));
            return;
        }
        match self.reading.description.weather {
            Some(old) if old != weather => {
                let rank = |w: Weather| match w {
                    Weather::Sandstorm => 5,
                    Weather::Snow => 4,
                    Weather::Rain => 3,
                    Weather::Fog => 2,
                    Weather::Overcast => 1,
                    Weather::Clear => 0,
                };
                let kept = if rank(weather) > rank(old) { weather } else { old };
                if rank(old).min(rank(weather)) > 1 || kept == Weather::Clear {
                    self.reading.notes.push(format!(
                        "{} and {} were said: pictures show {}",
                        old.name(),
                        weather.name(),
                        kept.name()
                    ));
                }
                self.d().weather = Some(kept);
            }
            _ => self.d().weather = Some(weather),
        }
        self.phrase(span, Became::Weather, &format!("weather: {}", weather.name()));
    }
}
