//! One tagged word: what it does to what was read so far.

use super::super::description::{Anchor, Became, Count, Density};
use super::super::lexicon::Sense;
use super::super::mention::{Pre, Prep};
use super::super::tag::{Item, Tag};
use super::super::words::edits::{Pick, Verb};
use super::super::words::objects::NOUNS;
use super::{Parser, is_color, is_prenominal, places_color};
use crate::scene::Class;
use crate::scene::graph::{LaneRole, ObjectState, RelationKind};

impl<'a> Parser<'a> {
    pub(super) fn sense_step(&mut self, sense: Sense, item: &'a Item) -> bool {
        let span = item.span;
        let prenominal = self.noun_directly(self.at + 1);
        match sense {
            // "walking down the pavement, away from me"
            Sense::Away
                if item.words == "away from"
                    && self.pending.is_none()
                    && self.distance.is_none()
                    && (!self.edits
                        || matches!(
                            self.sense(self.at.wrapping_sub(1)),
                            Some(Sense::State(ObjectState::Moving, _))
                        ))
                    && !matches!(
                        self.sense(self.at.wrapping_sub(1)),
                        Some(Sense::Unit(_) | Sense::EgoRel(_) | Sense::Rel(_))
                    )
                    && self
                        .item(self.at.wrapping_sub(1))
                        .is_some_and(|b| !matches!(b.words.as_str(), "far" | "not far"))
                    && matches!(self.sense(self.at + 1), Some(Sense::Ego)) =>
            {
                self.begin(Prep::Rels(vec![RelationKind::FacingAway]), span);
            }
            Sense::Filler | Sense::Unit(_) | Sense::Away | Sense::Bound(_) => {
                return self.small_word(item);
            }
            Sense::Fraction(share) => {
                if let Some(Sense::Unit(m)) = self.sense(self.at + 1) {
                    self.at += 1;
                    let span = span.to(self.items[self.at].span);
                    self.distance_said(share * m, span);
                } else {
                    return true;
                }
            }
            Sense::Pick(pick) => {
                match pick {
                    Pick::More => {}
                    // "the cone furthest away"
                    _ if self.edits && !self.noun_ahead(self.at + 1) && !self.last.is_empty() => {
                        for i in self.last.clone() {
                            self.mentions[i].pick = Some(pick);
                        }
                        self.pending = None;
                        return false;
                    }
                    // "one car 10 m ahead and one 20 m ahead, all in our lane"
                    Pick::All
                        if matches!(item.words.as_str(), "all" | "all of")
                            && (self.all_named() || self.all_again()) =>
                    {
                        return false;
                    }
                    _ => self.pre.pick = Some(pick),
                }
                self.pre.cover(span);
            }
            // "a cyclist has to swing out into the oncoming lane"
            Sense::Verb(Verb::Move)
                if !self.edits
                    && !self.head.is_empty()
                    && self
                        .item(self.at.wrapping_sub(1))
                        .is_some_and(|b| b.words == "to") =>
            {
                return true;
            }
            // "the two cars in front of me move over to the right"
            Sense::Verb(Verb::Move)
                if !self.edits && !self.fresh && !self.last.is_empty() && self.pending.is_none() =>
            {
                self.state(ObjectState::Moving, true, false, item);
            }
            // "a man with a stick": a thing, no command
            Sense::Verb(_)
                if !self.edits
                    && matches!(self.sense(self.at.wrapping_sub(1)), Some(Sense::Article(false))) =>
            {
                self.pre = Pre::default();
                self.with = false;
            }
            Sense::Verb(verb) => {
                // In a description, "remove all cars" means that there are none, other verbs add nothing.
                self.flush();
                self.pre = Pre {
                    not: verb == Verb::Remove,
                    ..Pre::default()
                };
                self.fresh = true;
                self.head.clear();
                return true;
            }
            Sense::And | Sense::Or => {
                if let Some(p) = &self.pending
                    && p.first.is_some()
                {
                    return true; // between A and B
                }
                self.flush();
                if sense == Sense::And {
                    self.not_goes_on &= self
                        .items
                        .get(self.at + 1)
                        .is_some_and(|i| matches!(i.tag, Tag::Is(Sense::Noun(..))))
                        || self.list_goes_on();
                }
                self.linked = true;
                self.anded = true;
                self.fresh = true;
                self.relative = false;
                return true;
            }
            Sense::But => {
                self.soft_end();
                return true;
            }
            Sense::Article(definite) => {
                self.pre.article = Some(definite);
                self.pre.cover(span);
                return true;
            }
            // "deserted except for a bicycle"
            Sense::Not
                if item.words.starts_with("except")
                    && (self.d().density == Some(Density::Empty)
                        || !self.d().absent.is_empty()
                        || self.mentions.is_empty() && !self.edits) =>
            {
                // "everything is quiet except for one lorry": nothing else is there
                if self.mentions.is_empty() && self.d().absent.is_empty() && !self.edits {
                    self.d().density = Some(Density::Empty);
                }
                self.denied = false;
                self.not_goes_on = false;
                return true;
            }
            // "bicycles and motorbikes are there not any"
            Sense::Not
                if matches!(item.words.as_str(), "not any" | "none" | "absent")
                    && self.ends(self.at + 1)
                    && self.none_of_these(span) => {}
            // "motor vehicles of any other kind are not permitted"
            Sense::Not if self.refused(self.at + 1) && self.none_of_these(span) => {
                while !self.ends(self.at + 1) {
                    self.at += 1;
                }
            }
            // "pedestrians: none"
            Sense::Not if item.words == "none" && self.none_of_it(2, span) => {}
            Sense::Not => {
                self.pre.not = true;
                self.pre.cover(span);
                return true;
            }
            Sense::Nobody => {
                self.absent(vec![Class::Pedestrian], None, span);
            }
            Sense::Count(count)
                if !count.is_exact() && matches!(self.sense(self.at + 1), Some(Sense::Unit(_))) =>
            {
                self.at += 1;
                let span = span.to(self.items[self.at].span);
                self.unread(span, Some("how many?".into()));
            }
            Sense::Count(count) => {
                // "no cars, no nothing, just one man"
                let just = self
                    .item(self.at.wrapping_sub(1))
                    .is_some_and(|b| matches!(b.words.as_str(), "just" | "only" | "simply" | "merely"))
                    || item.words.starts_with("just ")
                    || item.words.starts_with("only ");
                if just {
                    self.pre.not = false;
                    self.not_goes_on = false;
                    self.denied = false;
                }
                let unit = matches!(self.sense(self.at + 1), Some(Sense::Unit(_)));
                if unit && self.try_distance(f64::from(count.n), span) {
                    return self.distance.is_some();
                }
                if let (Some(Sense::Fraction(share)), Some(Sense::Unit(m))) =
                    (self.sense(self.at + 1), self.sense(self.at + 2))
                {
                    self.at += 2;
                    let span = span.to(self.items[self.at].span);
                    self.distance_said((f64::from(count.n) + share) * m, span);
                    return false;
                }
                self.count(count, span);
            }
            Sense::State(state, finite) => self.state(state, finite, prenominal, item),
            // "a Mini"
            Sense::Size(_)
                if item.words == "mini" && !self.noun_ahead(self.at + 1) && self.pre.article.is_some() =>
            {
                self.noun(&NOUNS[0], "mini", false, span);
            }
            Sense::Size(size) => {
                if prenominal {
                    self.pre.size = Some(size);
                    self.pre.cover(span);
                } else if !matches!(
                    self.sense(self.at + 1),
                    Some(Sense::Place(..) | Sense::RoadKind(..))
                ) {
                    let targets = self.subjects(true);
                    for t in targets {
                        self.mentions[t].spec.size = Some(size);
                    }
                }
            }
            Sense::Color(color) => self.color(color, prenominal, span),
            Sense::Attribute(word) => {
                if prenominal {
                    self.pre.attributes.push(word.to_string());
                    self.pre.cover(span);
                } else {
                    for t in self.targets() {
                        self.mentions[t].spec.attributes.push(word.to_string());
                    }
                }
            }
            Sense::Noun(_, false) if item.words.is_ascii() && self.noun_next() => {
                // "tanker lorry", "bus driver": the last noun says what it is.
                self.pre.cover(span);
                self.pre.attributes.push(item.words.clone());
            }
            Sense::Noun(noun, plural) => {
                let word = item.read_as.unwrap_or(&item.words).to_string();
                self.noun(noun, &word, plural, span);
            }
            Sense::Works => self.works(span),
            // "the lead vehicle"
            Sense::Rel(_)
                if matches!(
                    item.words.as_str(),
                    "lead"
                        | "leading"
                        | "preceding"
                        | "following"
                        | "trailing"
                        | "tailgating"
                        | "pursuing"
                        | "chasing"
                ) && (self.pre.article.is_some() || item.words == "lead" && self.fresh)
                    && self.noun_directly(self.at + 1) =>
            {
                let ahead = matches!(item.words.as_str(), "lead" | "leading" | "preceding");
                let kind = if ahead {
                    RelationKind::InFrontOf
                } else {
                    RelationKind::Behind
                };
                self.fronted_once(&[kind], span);
            }
            Sense::Possessed(kind) => {
                self.begin(Prep::Rels(vec![kind]), span);
                let its = Item {
                    words: "it".into(),
                    ..item.clone()
                };
                return self.pronoun(&its);
            }
            // "the approaching car"
            Sense::Rel(_)
                if matches!(item.words.as_str(), "approaching" | "opposing")
                    && (self.pre.article.is_some() || self.pre.count.is_some())
                    && self.noun_directly(self.at + 1) =>
            {
                self.fronted_once(&[RelationKind::OppositeDirection], span);
            }
            Sense::Rel(_) if self.stands_alone(item) => return true,
            Sense::Rel(kind) => {
                if kind == RelationKind::Near
                    && matches!(item.words.as_str(), "around" | "about")
                    && !self.anchor_ahead(self.at + 1)
                {
                    return true;
                }
                self.begin(Prep::Rels(vec![kind]), span);
            }
            Sense::EgoRel(kinds) => {
                self.ego_named |= item.words.contains("ego") || item.words.contains("vehicle");
                let led = self.pre.article.is_some() || self.pre.count.is_some();
                if is_prenominal(&item.words)
                    && self.noun_directly(self.at + 1)
                    && (led || !self.takes_object(item))
                {
                    self.fronted_once(kinds, span);
                    return false;
                }
                let of = self.item(self.at + 1).is_some_and(|n| n.words == "of");
                // "on the left a bus, in front a cone and behind a person"
                let listed = self.fresh
                    && self.fronted.last().is_some_and(|f| f.anchor == Anchor::Ego)
                    && matches!(
                        self.sense(self.at + 1),
                        Some(Sense::Article(false) | Sense::Count(_))
                    )
                    && self.noun_ahead(self.at + 1);
                if listed {
                    self.begin(Prep::Rels(kinds.to_vec()), span);
                    self.anchor(Anchor::Ego, span);
                } else if (of || self.takes_object(item)) && self.anchor_ahead(self.at + 1) {
                    self.begin(Prep::Rels(kinds.to_vec()), span);
                } else {
                    let fresh = self.fresh;
                    let by_other = self.by_other(kinds, item);
                    self.begin(Prep::Rels(kinds.to_vec()), span);
                    let host = self
                        .last
                        .first()
                        .and_then(|&i| self.mentions[i].host)
                        .filter(|_| !fresh)
                        .filter(|_| {
                            matches!(
                                item.words.as_str(),
                                "behind" | "in front" | "close behind" | "right behind" | "ahead"
                            )
                        });
                    self.anchor(host.or(by_other).map_or(Anchor::Ego, Anchor::Object), span);
                    self.farther_on(item, span);
                }
            }
            Sense::Reversed(kind) => {
                self.flush();
                let subjects = self.subjects(false);
                let ego = self.ego_subject.then_some(Anchor::Ego);
                let topic = self.topic.take().map(|t| t.0).filter(|_| ego.is_none()).or(ego);
                self.reversed = Some((kind, span, subjects, topic));
            }
            Sense::Fixed(kind, anchor) => {
                self.reading.description.road.crossing |= anchor == Anchor::Crossing;
                self.begin(Prep::Rels(vec![kind]), span);
                self.anchor(anchor, span);
            }
            // "hurries across the street"
            Sense::FarSide
                if (item.words.starts_with("across") || item.words.starts_with("over"))
                    && (matches!(
                        self.sense(self.at.wrapping_sub(1)),
                        Some(Sense::State(ObjectState::Moving, _) | Sense::Attribute(_))
                    ) || self.at > 0
                        && self.items[self.at - 1].tag == Tag::Unknown
                        && self
                            .last
                            .iter()
                            .all(|t| self.mentions[*t].spec.state == Some(ObjectState::Moving)))
                    && !self.last.is_empty() =>
            {
                self.begin(Prep::Rels(vec![RelationKind::Crossing]), span);
                self.anchor(Anchor::Lane(LaneRole::Road), span);
            }
            Sense::FarSide => {
                let prep = self.other_side(item);
                self.begin(prep, span);
                self.anchor(Anchor::Ego, span);
            }
            Sense::BothSides(each) => self.both_sides(each, span),
            // "drives off", "the sun is going down"
            Sense::In
                if matches!(
                    item.words.as_str(),
                    "up" | "down" | "off" | "over" | "through" | "line" | "lines"
                ) && !self.place_ahead(self.at + 1) =>
            {
                return true;
            }
            Sense::In => {
                // "on" before a bound or a kind of road is a small word.
                self.begin(Prep::In, span);
            }
            Sense::At => self.begin(Prep::At, span),
            Sense::Across => self.begin(Prep::Across, span),
            Sense::Place(anchor, road) => self.place(anchor, road, item),
            Sense::RoadKind(road, environment) => self.road_kind(road, environment, span),
            Sense::OneWay => {
                self.d().road.one_way = true;
                self.phrase(span, Became::Road, "one-way road");
                self.drop_pending();
            }
            Sense::Width(narrow) => {
                let road = &mut self.d().road;
                (road.narrow, road.wide) = (narrow, !narrow);
                self.phrase(
                    span,
                    Became::Road,
                    if narrow { "narrow road" } else { "wide road" },
                );
                self.drop_pending();
            }
            Sense::Ego => {
                let third = !matches!(
                    item.words.as_str(),
                    "me" | "us" | "i" | "we" | "my car" | "our car" | "myself" | "you"
                );
                if self.pending.is_some() {
                    self.anchor(Anchor::Ego, span);
                } else {
                    // "in front from me"
                    let of = self
                        .item(self.at.wrapping_sub(1))
                        .is_some_and(|b| matches!(b.words.as_str(), "from" | "of" | "to" | "than" | "for"));
                    self.ego_subject |= self.head.is_empty() && !self.edits && !of;
                    self.ego_named |= third;
                    return true;
                }
                self.ego_named |= third;
            }
            Sense::Pronoun => return self.pronoun(item),
            Sense::Part(_) if self.pending.is_some() && !self.noun_ahead(self.at + 1) => {
                // "one in front of the other"
                let targets = self.targets();
                let noun = targets.first().map(|t| self.mentions[*t].spec.noun.clone());
                if self.ego_has_another(item) {
                    return false;
                }
                let other = (0..self.mentions.len())
                    .rev()
                    .find(|i| !targets.contains(i) && Some(&self.mentions[*i].spec.noun) == noun.as_ref());
                match other {
                    Some(i) => self.anchor(Anchor::Object(i), span),
                    None => {
                        let span = self.pending.take().map_or(span, |p| p.span.to(span));
                        self.unread(span, Some("what it points to was not named".into()));
                    }
                }
            }
            Sense::Part(all) => self.part(all, Count::exactly(1), span),
            Sense::Time(time) => {
                if (is_color(&item.words) || item.words == "dark") && prenominal {
                    self.pre.attributes.push(item.words.clone());
                    return false;
                }
                self.time(time, span);
            }
            Sense::Weather(weather) => {
                let described =
                    is_color(&item.words) && (prenominal || self.after_is() && !self.head.is_empty());
                if described {
                    let word = places_color(&item.words);
                    self.color(word, prenominal, span);
                } else {
                    self.weather(weather, span);
                    // "on an overcast day"
                    let day = item.words.ends_with(" day") || item.words.ends_with(" daytime");
                    if day && self.reading.description.time_of_day.is_none() {
                        self.time(super::super::description::TimeOfDay::Day, span);
                    }
                }
            }
            Sense::Environment(environment) => {
                if !self.pre.not {
                    self.d().environment.get_or_insert(environment);
                    self.phrase(
                        span,
                        Became::Environment,
                        &format!("surroundings: {}", environment.name()),
                    );
                }
                self.drop_pending();
                self.pre = Pre::default();
            }
            Sense::Density(density) => {
                let density = match (self.pre.not, density) {
                    (true, Density::Empty) => Density::Light,
                    (true, _) => Density::Empty,
                    (false, d) => d,
                };
                self.pre.not = false;
                self.d().density = Some(density);
                self.phrase(span, Became::Density, &format!("traffic: {}", density.name()));
                if self
                    .pending
                    .as_ref()
                    .is_some_and(|p| matches!(p.prep, Prep::In | Prep::At))
                    && !self.anchor_ahead(self.at + 1)
                {
                    self.drop_pending();
                }
                return true;
            }
            // "two deer-watchers", "a dog owner"
            Sense::Cannot(_)
                if !self.edits
                    && self.noun_directly(self.at + 1)
                    && item.span.end + 1 == self.items[self.at + 1].span.start
                    && !item.words.ends_with('s') =>
            {
                return true;
            }
            Sense::Background => {
                self.with = false;
                let lead = self.pending.take();
                if let Some(p) = lead.filter(|p| matches!(p.prep, Prep::Rels(_))) {
                    let span = p.span.to(span);
                    self.unread(
                        span,
                        Some("surroundings are drawn freely: nothing can be placed by them".into()),
                    );
                } else if self.pre.not {
                    self.unread(span, Some("surroundings are drawn freely".into()));
                } else {
                    let index = self.reading.description.background.len();
                    let word = item.words.clone();
                    self.phrase(span, Became::Background(index), &format!("background: {word}"));
                    self.d().background.push(word);
                }
                self.pre = Pre::default();
            }
            Sense::Cannot(why) => {
                self.with = false;
                let span = self.pre.span.map_or(span, |s| s.to(span));
                let span = self.pending.take().map_or(span, |p| p.span.to(span));
                self.pre = Pre::default();
                self.unread(span, Some(why.into()));
            }
        }
        false
    }
}
