//! Nouns: new objects, those named before, road works, what is denied.

use super::super::description::{Absent, Anchor, Became, Count, Stated};
use super::super::lexicon::Sense;
use super::super::mention::{Frag, Mention, Pre, Prep, apply};
use super::super::tag::Tag;
use super::super::tokens::Span;
use super::super::words::edits::Pick;
use super::super::words::objects::{NOUNS, Noun, WORKS};
use super::{MOST_MENTIONS, Parser};
use crate::scene::Class;
use crate::scene::graph::{ObjectState, RelationKind};

impl Parser<'_> {
    pub(super) fn mention_by_id(&mut self, span: Span) {
        if let Some(noun) = NOUNS.last() {
            self.noun(noun, "box", false, span);
        }
    }

    pub(in super::super) fn absent(&mut self, classes: Vec<Class>, state: Option<ObjectState>, span: Span) {
        let index = self.reading.description.absent.len();
        let names: Vec<String> = classes.iter().take(3).map(|c| c.label()).collect();
        self.phrase(
            span,
            Became::Absent(index),
            &format!("none: {}", names.join(", ")),
        );
        self.d().absent.push(Absent { classes, state, span });
        self.pre = Pre::default();
        self.denied = true;
    }

    pub(super) fn noun(&mut self, noun: &'static Noun, word: &str, plural: bool, span: Span) {
        if self.named_together(noun, plural, span) {
            return;
        }
        let mut pre = std::mem::take(&mut self.pre);
        let whole = pre.span.map_or(span, |s| s.to(span));
        let zero = pre.count.is_some_and(|c| c.n == 0);
        if pre.not || zero || (self.not_goes_on && pre.count.is_none() && pre.article.is_none()) {
            // "one lane is not a car" has no meaning here; a denied anchor is not read.
            if self.pending.take().is_some() {
                self.unread(whole, Some("where something is not, is not read".into()));
                return;
            }
            self.absent(noun.classes.to_vec(), pre.state, whole);
            self.not_goes_on = true;
            return;
        }
        self.not_goes_on = false;
        self.denied = false;
        if !self.edits && self.pending.is_none() && self.tells(noun) {
            return;
        }
        if self.holds_others(noun, &pre)
            || self.rides(noun, word, &pre)
            || self.says_which(noun, word, plural, &pre)
            || self.is_that(noun, word, &pre)
        {
            self.adjectives_of_same(&pre, whole);
            return;
        }
        let total = !self.edits && self.pending.is_none() && self.in_total();
        if total && self.restates(noun, &pre) {
            return;
        }
        if total {
            pre.attributes.push("in total".into());
        }
        if !self.edits
            && matches!(word, "thing" | "things" | "anything" | "everything")
            && pre.count.is_none()
        {
            self.pending = None;
            return; // "can barely see a thing"
        }
        if self.mentions.len() >= MOST_MENTIONS {
            self.unread(whole, Some(format!("more than {MOST_MENTIONS} things are named")));
            return;
        }
        // Adjectives that say where.
        let wheres: Vec<String> = pre
            .attributes
            .iter()
            .filter_map(|a| a.strip_prefix('\u{1}').map(str::to_string))
            .collect();
        pre.attributes.retain(|a| !a.starts_with('\u{1}'));
        let only = usize::from(self.item(self.at + 1).is_some_and(|i| i.words == "only"));
        if word == "traffic"
            && matches!(self.item(self.at + 1 + only).map(|i| i.tag), Some(Tag::Mark))
            && self.noun_ahead(self.at + 2 + only)
        {
            // "oncoming traffic: two coaches" names them itself.
            self.new_clause();
            for kinds in &wheres {
                let kinds = RelationKind::ALL
                    .into_iter()
                    .filter(|k| kinds.split(',').any(|n| n == k.name()))
                    .collect();
                self.fronted.push(Frag {
                    prep: Prep::Rels(kinds),
                    anchor: Anchor::Ego,
                    and: None,
                    distance_m: None,
                    span: whole,
                });
            }
            return;
        }
        // "two vans, and their drivers stand behind them": one each
        // "a couple with a pushchair": theirs, and nobody more
        let carried =
            noun.nearest && noun.classes[0] == Class::Pedestrian && self.with && self.pending.is_none();
        if carried
            && !self.edits
            && self
                .last
                .first()
                .is_some_and(|i| self.mentions[*i].spec.class == Class::Pedestrian)
        {
            self.with = false;
            return;
        }
        let theirs = self
            .item(self.at.wrapping_sub(1))
            .is_some_and(|b| matches!(b.words.as_str(), "their" | "whose"));
        if theirs
            && plural
            && pre.count.is_none()
            && matches!(word, "drivers" | "owners" | "operators")
            && !self.edits
        {
            let hosts = if self.head.is_empty() {
                &self.before
            } else {
                &self.head
            };
            let vehicles = hosts.iter().map(|i| &self.mentions[*i].spec);
            let driven = vehicles.filter(|s| s.class.is_vehicle() && s.count.is_exact());
            let many: u32 = driven.map(|s| s.count.n).sum();
            pre.count = (many > 0).then(|| Count::exactly(many));
        }
        // "two children and their parents"
        let whose = self
            .item(self.at.wrapping_sub(1))
            .is_some_and(|b| matches!(b.words.as_str(), "their" | "his" | "her"));
        if whose && matches!(word, "parents" | "grandparents") && pre.count.is_none() && !self.edits {
            pre.count = Some(Count::exactly(2));
        }
        let some_one = !plural
            && noun.several == 1
            && self
                .item(self.at.wrapping_sub(1))
                .is_some_and(|i| i.words == "some");
        if some_one {
            pre.count = None; // "some guy"
        }
        let each = pre.each;
        let mut mention = Mention::new(noun, word, plural, pre, span);
        if each {
            mention.both = None;
        }
        let said = wheres.clone();
        for kinds in wheres {
            let kinds: Vec<RelationKind> = kinds
                .split(',')
                .filter_map(|n| RelationKind::ALL.into_iter().find(|k| k.name() == n))
                .collect();
            let frag = Frag {
                prep: Prep::Rels(kinds),
                anchor: Anchor::Ego,
                and: None,
                distance_m: None,
                span: whole,
            };
            apply(&mut mention.spec, &frag);
        }
        if matches!(word, "everything" | "anything") {
            mention.pick = mention.pick.or(Some(Pick::All));
        }
        mention.said_where = !said.is_empty();
        let index = self.coreferent(&mention).unwrap_or_else(|| {
            self.mentions.push(mention.clone());
            self.mentions.len() - 1
        });
        let old = index + 1 != self.mentions.len()
            || !std::ptr::eq(self.mentions[index].classes, mention.classes)
            || self.mentions[index].spec.span != mention.spec.span;
        if old && mention.spec.color.is_some() {
            self.mentions[index].spec.color = mention.spec.color.clone();
        }
        if self.pending.is_some() && !old && self.is_ego_car(index) {
            self.mentions.truncate(index);
            self.anchor(Anchor::Ego, span);
            return;
        }
        if self.pending.is_some() {
            if !old {
                self.mentions[index].is_anchor = true;
            }
            let before = self.head.clone();
            self.anchor(Anchor::Object(index), span);
            let open = self.pending.is_some(); // "between a van and ..."
            if !open && !before.is_empty() && !self.head.is_empty() {
                self.last = vec![index];
            }
            self.with = false;
            return;
        }
        if let Some((kind, rspan, subjects, topic)) = self.reversed.take() {
            let anchor = topic.or(subjects.first().map(|s| Anchor::Object(*s)));
            match anchor {
                Some(anchor) => {
                    let frag = Frag {
                        prep: Prep::Rels(vec![kind]),
                        anchor,
                        and: None,
                        distance_m: None,
                        span: rspan.to(span),
                    };
                    apply(&mut self.mentions[index].spec, &frag);
                    self.reversed = Some((kind, rspan, subjects, topic)); // "by cones and barriers"
                }
                // "the view to the left is blocked by a lorry"
                None if !self.fronted.is_empty() => {
                    for frag in self.fronted.clone() {
                        apply(&mut self.mentions[index].spec, &frag);
                    }
                }
                None => self.unread(rspan, Some("of what?".into())),
            }
            if self.head.is_empty() {
                self.head = vec![index];
            }
            self.last = vec![index];
            let walk = |i: &usize| self.mentions[*i].spec.class == Class::Pedestrian;
            if kind == RelationKind::NextTo
                && walk(&index)
                && self.head.iter().all(walk)
                && !self.head.contains(&index)
            {
                // Children accompanied by a teacher cross with them.
                self.head.push(index);
            }
            if kind == RelationKind::NextTo {
                // What is pushed goes where the one who pushes it goes.
                self.last.extend(self.reversed.iter().flat_map(|r| r.2.clone()));
            }
            return;
        }
        // A new subject, or one more of a list.
        // "a mother holds her child's hand": the child is with her
        let hers = self
            .item(self.at.wrapping_sub(1))
            .is_some_and(|b| matches!(b.words.as_str(), "his" | "her" | "their"))
            && mention.spec.class == Class::Pedestrian
            && matches!(self.head.as_slice(), [h] if self.mentions[*h].spec.class == Class::Pedestrian && *h != index);
        let host = self
            .head
            .first()
            .copied()
            .filter(|_| self.with || hers && !self.edits);
        self.with = false;
        // "a lorry has a motorbike on its left and a cyclist on its right": the lorry's right
        let shared = || {
            let sibling = self.last.last().filter(|_| self.anded && !self.edits)?;
            let m = self.mentions.get(*sibling)?;
            let host = m.host?;
            let by_host = m.spec.relations.iter().any(|r| r.anchor == Anchor::Object(host));
            let placed = matches!(self.sense(self.at + 1), Some(Sense::Possessed(_)))
                || matches!(self.sense(self.at + 1), Some(Sense::Rel(_)))
                    && matches!(self.sense(self.at + 2), Some(Sense::Pronoun));
            (by_host && placed && *sibling != index).then_some(host)
        };
        let host = host.or_else(shared);
        if !old {
            self.mentions[index].host = host;
        }
        if self.owned(index) {
            // "the deliveryman has parked his truck and walks": he walks
            let owner = self.head[0];
            let left = (1..4).any(|k| {
                self.item(self.at.wrapping_sub(k)).is_some_and(|i| {
                    i.words.split(' ').any(|w| {
                        matches!(
                            w,
                            "left" | "leaves" | "leaving" | "out" | "exited" | "abandoned" | "from"
                        )
                    })
                })
            });
            let state = self.mentions[owner].spec.state.take();
            let m = &mut self.mentions[index];
            m.spec.state = m.spec.state.or(state);
            m.host = None;
            // "has left his van"
            if left {
                m.spec.state = Some(ObjectState::Parked);
            }
            self.last = vec![index];
            self.topic = None;
            self.chain = false;
            return;
        }
        if self.linked && self.chain && !self.list.is_empty() {
            // "a car, a bus and a truck ahead" speaks of three, "three cars, a bus ahead" of the bus.
            self.list.push(index);
            self.head = if self.anded {
                self.list.clone()
            } else {
                vec![index]
            };
        } else {
            if !self.head.is_empty() {
                self.fronted_if_done();
            }
            self.list = vec![index];
            self.head = vec![index];
        }
        self.last = self.head.clone();
        if let (Some(each), false) = (self.fronted_both, old) {
            let m = &mut self.mentions[index];
            // "on both sides a row of three cones": a row on each
            let row = (1..=2).any(|k| {
                let word = self.at.checked_sub(k).and_then(|i| self.items.get(i));
                word.is_some_and(|w| w.words.starts_with("a ") && w.words.ends_with(" of"))
            });
            m.both = Some(each || row || m.spec.count.n == 1);
        }
        if let Some(state) = self.fronted_state
            && self.mentions[index].spec.state.is_none()
        {
            self.mentions[index].spec.state = Some(state);
        }
        for mut frag in self.fronted.clone() {
            if let (Some(before), Anchor::Object(_)) = (self.after_then(&frag), frag.anchor) {
                frag.anchor = Anchor::Object(before);
                frag.distance_m = None;
            }
            if frag.anchor != Anchor::Object(index) {
                apply(&mut self.mentions[index].spec, &frag);
            }
        }
        if !old && self.fronted.is_empty() && self.mentions[index].spec.relations.is_empty() {
            for frag in self.headed.clone() {
                apply(&mut self.mentions[index].spec, &frag);
            }
        }
        if !old && self.mentions[index].spec.relations.is_empty() {
            self.mentions[index].spec.relations = self.listed.clone();
        }
        if let Some(like) = self.alike.take().filter(|k| *k != index) {
            let other = self.mentions[like].spec.clone();
            let spec = &mut self.mentions[index].spec;
            spec.state = spec.state.or(other.state);
            let theirs = other
                .relations
                .into_iter()
                .filter(|r| r.anchor != Anchor::Object(index));
            spec.relations.extend(theirs);
        }
        if !old {
            self.next_in_order(index);
        }
        if let Some((metres, dspan)) = self.distance.take() {
            self.mentions[index].spec.relations.push(Stated {
                relation: RelationKind::Near,
                anchor: Anchor::Ego,
                and: None,
                distance_m: Some(metres),
                span: dspan,
            });
        }
        self.topic = None;
    }

    /// True if this is a vehicle of the person that the clause speaks of: "his truck".
    fn owned(&self, index: usize) -> bool {
        let mut k = self.at;
        while k > 0
            && matches!(
                self.sense(k - 1),
                Some(Sense::Size(_) | Sense::Color(_) | Sense::Attribute(_) | Sense::State(..))
            )
        {
            k -= 1;
        }
        let his = k
            .checked_sub(1)
            .and_then(|i| self.item(i))
            .is_some_and(|i| matches!(i.words.as_str(), "his" | "her" | "their"));
        let person = matches!(self.head.as_slice(), [h] if *h != index && self.mentions[*h].spec.class == Class::Pedestrian);
        his && person && !self.linked && !self.edits && self.mentions[index].spec.class.is_vehicle()
    }

    /// A noun after the list that a fronted place was said of: the place is used up.
    pub(super) fn fronted_if_done(&mut self) {
        if !self.chain {
            self.fronted.clear();
            self.fronted_state = None;
        }
        self.chain = true;
    }

    /// An object named before that "the ..." points to.
    pub(super) fn coreferent(&self, new: &Mention) -> Option<usize> {
        // "one worker near cones": those that were named
        let stem = |n: &str| n.trim_end_matches('s').to_string();
        let bare = new.bare
            && new.uncounted
            && self.pending.is_some()
            && new.spec.state.is_none()
            && self
                .mentions
                .iter()
                .any(|m| stem(&m.spec.noun) == stem(&new.spec.noun));
        // "A bulldozer blocks my lane. Bulldozer facing away from me."
        let opens = self
            .item(self.at.wrapping_sub(1))
            .is_none_or(|b| b.tag == Tag::Stop);
        let faces = matches!(
            self.sense(self.at + 1),
            Some(Sense::Rel(RelationKind::Facing | RelationKind::FacingAway))
        );
        let again = new.bare
            && !new.plural
            && opens
            && faces
            && self
                .mentions
                .iter()
                .filter(|m| m.spec.noun == new.spec.noun && !m.gone)
                .count()
                == 1;
        // "a bus and two vans crashed. Bus: 20 m ahead.": the label names it again
        let label = new.bare
            && new.uncounted
            && opens
            && self.pending.is_none()
            && self.item(self.at + 1).is_some_and(|n| n.words == ":")
            && self
                .mentions
                .iter()
                .filter(|m| stem(&m.spec.noun) == stem(&new.spec.noun) && !m.gone)
                .count()
                == 1;
        if !(new.definite || bare || again || label) || new.pick.is_some() || self.edits {
            return None;
        }
        let fits = |m: &Mention| {
            let nouns = m.classes[0] == new.classes[0]
                || (new.classes.len() > 1 && new.classes.contains(&m.spec.class));
            let colors = match (&m.spec.color, &new.spec.color) {
                (Some(a), Some(b)) => a == b,
                (None, Some(_)) => self.after_is(),
                _ => true,
            };
            let states = new.spec.state.is_none() || m.spec.state == new.spec.state;
            let counts = new.uncounted || m.spec.count.n == new.spec.count.n;
            !m.gone && nouns && colors && states && counts
        };
        // "the excavator and the bulldozer": those of one list are as many as are named; so are those of two kinds
        let listed = |i: usize| {
            self.pending.is_none()
                && self.linked
                && self.list.contains(&i)
                && self.mentions[i].spec.noun != new.spec.noun
        };
        let other =
            |i: usize| super::super::names::are_of_two_kinds(&self.mentions[i].spec.noun, &new.spec.noun);
        (0..self.mentions.len())
            .rev()
            .find(|&i| fits(&self.mentions[i]) && !listed(i) && !other(i))
    }

    pub(super) fn works(&mut self, span: Span) {
        if std::mem::take(&mut self.pre.not) {
            self.absent(
                vec![Class::TrafficCone, Class::Barrier, Class::ConstructionVehicle],
                None,
                span,
            );
            return;
        }
        self.pre = Pre::default();
        // Works are a place too: "a car in front of the roadworks" stands by their first part.
        let first = self.mentions.len();
        let led = self.pending.is_some();
        for (class, n) in WORKS {
            if let Some(noun) = NOUNS.iter().find(|x| x.classes == [*class]) {
                let mut m = Mention::new(noun, class.label().as_str(), *n > 1, Pre::default(), span);
                m.spec.count = if *n == 1 {
                    Count::about(1, 1, 2)
                } else {
                    Count::about(2, *n, 3 * n)
                };
                m.spec.state = Some(ObjectState::Parked);
                self.mentions.push(m);
            }
        }
        let all: Vec<usize> = (first..self.mentions.len()).collect();
        for &i in &all[1..] {
            self.mentions[i].spec.relations.push(Stated {
                relation: RelationKind::Near,
                anchor: Anchor::Object(first),
                and: None,
                distance_m: None,
                span,
            });
        }
        if led {
            let had = self.head.clone();
            self.anchor(Anchor::Object(first), span);
            if !had.is_empty() {
                self.last = vec![first];
            }
            return;
        }
        for frag in self.fronted.clone() {
            apply(&mut self.mentions[first].spec, &frag);
        }
        self.head = vec![first];
        self.last = vec![first];
    }
}
