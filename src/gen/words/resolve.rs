//! Finds the boxes of a scene that a thing of a reading means. If several fit one, a question is asked; nothing is
//! guessed.

use super::notation;
use super::nouns::Noun;
use super::reading::{AnchorPhrase, ObjectPhrase, PaintWish, Pick, PlacePhrase, Quantity, Relation};
use super::remark::Remark;
use super::stage::{Question, Stage};
use place::holds::{RelationReference, ego, holds, in_role, role_of};
use scene::graph::{LaneRole, ObjectState, RelationKind, SizeHint};
use scene::{BoxId, SceneBox};

/// Boxes to take if too many fit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Spare {
    /// The nearest to the ego vehicle.
    Nearest,
    /// The farthest: for removals.
    Farthest,
}

/// The relation kind that a relation is measured as; `None` if boxes of a scene cannot be distinguished by it.
pub fn kind_of(
    relation: Relation,
    anchor: &AnchorPhrase,
    state: Option<ObjectState>,
) -> Option<RelationKind> {
    use RelationKind as K;
    let strip = matches!(
        anchor,
        AnchorPhrase::Lane(
            LaneRole::Roadside | LaneRole::LeftRoadside | LaneRole::RightRoadside | LaneRole::Carpark
        )
    );
    Some(match relation {
        Relation::On if strip && state == Some(ObjectState::Parked) => K::ParkedOn,
        Relation::On => K::On,
        Relation::Blocking => K::Blocking,
        Relation::Crossing => K::Crossing,
        Relation::Waiting => K::WaitingAt,
        Relation::Between => K::Between,
        Relation::Following => K::Following,
        Relation::Ahead => K::InFrontOf,
        Relation::Behind => K::Behind,
        Relation::Left => K::LeftOf,
        Relation::Right => K::RightOf,
        Relation::NextTo => K::NextTo,
        Relation::Near | Relation::At => K::Near,
        Relation::Far => K::FarFrom,
        Relation::Across => K::Across,
        Relation::Oncoming => K::OppositeDirection,
        Relation::SameWay => K::SameDirection,
        Relation::Facing => K::Facing,
        Relation::FacingAway => K::FacingAway,
        Relation::There | Relation::Like | Relation::InLine | Relation::SideBySide => return None,
    })
}

impl Stage<'_> {
    /// The boxes that several things mean together; `None` after a question, and if nothing fits.
    pub(super) fn those(&mut self, who: &[ObjectPhrase], spare: Spare) -> Option<Vec<BoxId>> {
        let mut all = Vec::new();
        let mut missing = false;
        for t in who {
            match self.that(t, spare) {
                Some(ids) => all.extend(ids),
                None => missing = true,
            }
        }
        let mut seen = std::collections::BTreeSet::new();
        all.retain(|id| seen.insert(*id));
        if all.is_empty() || missing && who.len() == 1 {
            return None;
        }
        self.speak_of(&all, who.first().map(|t| t.noun));
        Some(all)
    }

    pub(super) fn speak_of(&mut self, ids: &[BoxId], noun: Option<Noun>) {
        // ("four cars, the first one black, the others white": the others of the four)
        if ids.len() < self.last.len() && ids.iter().all(|id| self.last.contains(id)) {
            self.group.clone_from(&self.last);
        } else if !ids.iter().all(|id| self.group.contains(id)) {
            self.group.clear();
        }
        self.last = ids.to_vec();
        if let Some(noun) = noun.filter(|n| !matches!(n, Noun::It | Noun::One)) {
            self.last_noun = Some(noun);
        }
    }

    /// The boxes that a thing means.
    pub(super) fn that(&mut self, t: &ObjectPhrase, spare: Spare) -> Option<Vec<BoxId>> {
        let words = words_of(t);
        let mut fits = self.fitting(t);
        if fits.is_empty() {
            fits = self.fitting_loosely(t);
        }
        self.passed_over(t);
        if !t.quantity.is_certain() && t.id.is_none() {
            let open: Vec<BoxId> = fits
                .iter()
                .copied()
                .filter(|id| !self.stays.contains(id))
                .collect();
            // (if all of them were to stay, this act means them anyway)
            if !open.is_empty() {
                fits = open;
            }
        }
        if fits.is_empty() {
            if let Some(one) = self.only_one(t) {
                let place = self.candidate(&self.boxes[&one]).place;
                self.remark(Remark::OnlyOne { what: words, place });
                return Some(vec![one]);
            }
            // (the meaning of "it" depends on the answer to the question)
            if t.noun != Noun::It || self.out.questions.is_empty() {
                self.remark(Remark::Nobody { what: words });
            }
            return None;
        }
        if let Some(nth) = t.nth {
            // (among those that were added just now, if they are of this kind)
            if self.last.len() > 1
                && self
                    .last
                    .iter()
                    .all(|id| fits.contains(id) && !self.first.contains_key(id))
            {
                fits.clone_from(&self.last);
            }
            fits.sort_by(|a, b| self.range_m(*a).total_cmp(&self.range_m(*b)));
            let at = if nth == 0 {
                fits.len() - 1
            } else {
                nth as usize - 1
            };
            let Some(id) = fits.get(at) else {
                let (found, wanted) = (fits.len(), nth as usize);
                self.remark(Remark::TooFew {
                    what: words,
                    found,
                    wanted,
                });
                return None;
            };
            return Some(vec![*id]);
        }
        if let Some(pick) = t.pick {
            let n = match t.quantity {
                Quantity::N(n) | Quantity::TheN(n) => n as usize,
                Quantity::All | Quantity::Each => fits.len(),
                _ => 1,
            };
            fits.sort_by(|a, b| rank(&self.boxes[a], pick).total_cmp(&rank(&self.boxes[b], pick)));
            fits.truncate(n.max(1));
            return Some(fits);
        }
        match t.quantity {
            _ if t.id.is_some() => Some(fits),
            Quantity::All | Quantity::Each | Quantity::Many => Some(fits),
            Quantity::Unsaid => Some(fits),
            Quantity::Half => {
                let n = fits.len() / 2;
                Some(self.so_many(fits, n, spare, &words))
            }
            Quantity::Some => {
                let n = fits.len().min(3);
                Some(self.so_many(fits, n, spare, &words))
            }
            Quantity::N(n) | Quantity::Range(n, _) => self.counted(fits, n as usize, spare, &words),
            Quantity::TheN(n) if fits.len() > n as usize => {
                let fits = self.likely(fits, t, n as usize);
                if fits.len() > n as usize {
                    self.ask(t, &fits);
                    return None;
                }
                Some(fits)
            }
            Quantity::TheN(n) => self.counted(fits, n as usize, spare, &words),
            Quantity::The if t.noun == Noun::It => Some(fits),
            Quantity::The => {
                let fits = self.likely(fits, t, 1);
                if fits.len() > 1 {
                    self.ask(t, &fits);
                    return None;
                }
                Some(fits)
            }
        }
    }

    fn ask(&mut self, t: &ObjectPhrase, fits: &[BoxId]) {
        let thing = notation::thing(t);
        if self
            .out
            .questions
            .iter()
            .any(|q| q.act == self.act && q.thing == thing)
        {
            return;
        }
        let candidates = fits.iter().map(|id| self.candidate(&self.boxes[id])).collect();
        self.out.questions.push(Question {
            text: format!("{} {}: which?", fits.len(), plural(&words_of(t))),
            act: self.act,
            thing,
            candidates,
        });
    }

    fn counted(&mut self, fits: Vec<BoxId>, wanted: usize, spare: Spare, words: &str) -> Option<Vec<BoxId>> {
        if fits.len() < wanted {
            let found = fits.len();
            self.remark(Remark::TooFew {
                what: plural(words),
                found,
                wanted,
            });
        }
        Some(self.so_many(fits, wanted, spare, words))
    }

    /// The `n` boxes that are taken of those that fit, by distance.
    fn so_many(&mut self, mut fits: Vec<BoxId>, n: usize, spare: Spare, words: &str) -> Vec<BoxId> {
        if fits.len() > n {
            fits.sort_by(|a, b| self.range_m(*a).total_cmp(&self.range_m(*b)));
            let which = match spare {
                Spare::Nearest => "nearest",
                Spare::Farthest => {
                    fits.reverse();
                    "farthest"
                }
            };
            fits.truncate(n);
            self.remark(Remark::Chosen {
                what: plural(words),
                which,
            });
        }
        fits
    }

    pub(super) fn range_m(&self, id: BoxId) -> f64 {
        self.boxes
            .get(&id)
            .map_or(0.0, |b| b.center_m.truncate().length())
    }

    /// The `n` boxes of several that a listener would take: the ones named last, the ones in our lane, or the ones
    /// without a name. All of them if that gives another number.
    fn likely(&self, fits: Vec<BoxId>, t: &ObjectPhrase, n: usize) -> Vec<BoxId> {
        let just = |test: &dyn Fn(&BoxId) -> bool| -> Option<Vec<BoxId>> {
            let found: Vec<BoxId> = fits.iter().copied().filter(|id| test(id)).collect();
            (found.len() == n).then_some(found)
        };
        if !self.last.is_empty()
            && !t.other
            && let Some(found) = just(&|id| self.last.contains(id))
        {
            return found;
        }
        let before_us = t.places.iter().any(|p| {
            p.to == Some(AnchorPhrase::Ego)
                && p.metres.is_none()
                && matches!(p.relation, Relation::Ahead | Relation::Behind)
        });
        let ours = |id: &BoxId| in_role(&self.map, LaneRole::Ego, self.boxes[id].center_m.truncate());
        if before_us && let Some(found) = just(&ours) {
            return found;
        }
        if t.noun.is_plain()
            && t.paint.is_none()
            && let Some(found) = just(&|id| self.boxes[id].label.name.is_empty())
        {
            return found;
        }
        fits
    }

    /// Adds remarks on places that do not distinguish boxes.
    fn passed_over(&mut self, t: &ObjectPhrase) {
        for p in &t.places {
            if matches!(
                p.relation,
                Relation::There | Relation::InLine | Relation::SideBySide
            ) {
                let relation = p.relation;
                self.remark(Remark::PlaceIgnored { relation });
            }
        }
    }

    /// The only box of the kind, although more was stated about it than holds; never if a paint or a size does not
    /// match.
    fn only_one(&self, t: &ObjectPhrase) -> Option<BoxId> {
        if t.quantity != Quantity::The
            || t.other
            || t.noun == Noun::Thing
            || t.places.is_empty() && t.state.is_none()
        {
            return None;
        }
        let bare = ObjectPhrase {
            places: Vec::new(),
            state: None,
            ..t.clone()
        };
        let fits = self.fitting(&bare);
        match fits.as_slice() {
            [one] => Some(*one),
            _ => None,
        }
    }

    fn fitting_loosely(&self, t: &ObjectPhrase) -> Vec<BoxId> {
        let waits = t.state == Some(ObjectState::Waiting) || t.state == Some(ObjectState::Moving);
        let walks = t.noun.classes() == Noun::Person.classes();
        if !(waits && walks && !t.places.is_empty()) && t.size.is_none() {
            return Vec::new();
        }
        // (a person by the bus may have moved; "the big truck" may be no larger than others)
        self.fitting(&ObjectPhrase {
            state: if walks { None } else { t.state },
            size: None,
            ..t.clone()
        })
    }

    /// All boxes that fit a thing, regardless of its number.
    pub(super) fn fitting(&self, t: &ObjectPhrase) -> Vec<BoxId> {
        self.fitting_deep(t, 0)
    }

    fn fitting_deep(&self, t: &ObjectPhrase, depth: u8) -> Vec<BoxId> {
        if let Some(id) = t.id {
            return self
                .boxes
                .contains_key(&BoxId(id))
                .then_some(BoxId(id))
                .into_iter()
                .collect();
        }
        let mut fit = self.of_noun(t);
        fit.retain(|b| Some(b.id) != self.skip);
        if t.other {
            fit.retain(|b| !self.last.contains(&b.id));
            if fit.iter().any(|b| self.group.contains(&b.id)) {
                fit.retain(|b| self.group.contains(&b.id));
            }
        }
        match t.paint {
            Some(PaintWish::Is(p)) => fit.retain(|b| b.label.paint == Some(p)),
            Some(PaintWish::Not(p)) => fit.retain(|b| b.label.paint != Some(p)),
            None => {}
        }
        if let Some(state) = t.state {
            fit.retain(|b| self.does(b, state));
        }
        if let Some(size) = t.size {
            fit = by_size(fit, size);
        }
        for p in &t.places {
            let anchors = self.anchors(p, depth);
            fit.retain(|b| self.stands(b, p, t.state, &anchors));
        }
        let mut ids: Vec<BoxId> = fit.into_iter().map(|b| b.id).collect();
        for e in t.except.iter().filter(|_| depth == 0) {
            let not = self.excepted(e, &ids);
            ids.retain(|id| !not.contains(id));
        }
        ids
    }

    /// The boxes of `among` that an exception means: a number of them, a picked one, or all that fit.
    fn excepted(&self, e: &ObjectPhrase, among: &[BoxId]) -> Vec<BoxId> {
        let one = matches!(e.noun, Noun::One | Noun::Thing);
        let mut fit = if one && e.places.is_empty() && e.paint.is_none() && e.state.is_none() {
            among.to_vec()
        } else {
            self.fitting_deep(
                &ObjectPhrase {
                    noun: if one { Noun::Thing } else { e.noun },
                    ..e.clone()
                },
                1,
            )
        };
        fit.retain(|id| among.contains(id));
        let pick = e.pick.unwrap_or(Pick::Nearest);
        fit.sort_by(|a, b| rank(&self.boxes[a], pick).total_cmp(&rank(&self.boxes[b], pick)));
        let n = match (e.quantity, e.pick, e.nth) {
            (Quantity::N(n), ..) => n as usize,
            (_, Some(_), _) => 1,
            (_, _, Some(0)) => return fit.last().copied().into_iter().collect(),
            (_, _, Some(n)) => return fit.get(n as usize - 1).copied().into_iter().collect(),
            _ => fit.len(),
        };
        fit.truncate(n);
        fit
    }

    /// Boxes of the noun. A specific noun means boxes with that name; if there are none, boxes without a name.
    fn of_noun(&self, t: &ObjectPhrase) -> Vec<&SceneBox> {
        let noun = match t.noun {
            Noun::It => {
                return self.last.iter().filter_map(|id| self.boxes.get(id)).collect();
            }
            Noun::One => self.last_noun.unwrap_or(Noun::Thing),
            noun => noun,
        };
        let all: Vec<&SceneBox> = self
            .boxes
            .values()
            .filter(|b| noun.classes().contains(&b.class))
            .collect();
        if noun.is_plain() {
            return all;
        }
        let called = |name: &str| -> Vec<&SceneBox> {
            all.iter()
                .copied()
                .filter(|b| b.label.name.as_str() == name)
                .collect()
        };
        let own = called(noun.label().as_str());
        if !own.is_empty() { own } else { called("") }
    }

    /// The anchors of a place.
    fn anchors(&self, p: &PlacePhrase, depth: u8) -> Anchors {
        let of = |a: &Option<AnchorPhrase>| -> Vec<SceneBox> {
            match a {
                Some(AnchorPhrase::Ego) => vec![ego()],
                Some(AnchorPhrase::Thing(t)) if depth < 3 => self
                    .fitting_deep(t, depth + 1)
                    .iter()
                    .map(|id| self.boxes[id])
                    .collect(),
                _ => Vec::new(),
            }
        };
        let first = of(&p.to);
        let mut second = of(&p.and);
        if p.relation == Relation::Between && p.and.is_none() {
            second.clone_from(&first);
        }
        Anchors { first, second }
    }

    /// True if a place holds for a box.
    fn stands(&self, b: &SceneBox, p: &PlacePhrase, state: Option<ObjectState>, anchors: &Anchors) -> bool {
        use LaneRole as L;
        let Some(to) = &p.to else {
            return true;
        };
        let Some(kind) = kind_of(p.relation, to, state) else {
            let own = role_of(&self.map, b);
            let alike = |o: &SceneBox| o.id != b.id && role_of(&self.map, o) == own;
            return p.relation != Relation::Like || anchors.first.iter().any(alike);
        };
        let at = |target: &RelationReference, and: Option<&SceneBox>| {
            holds(&self.map, kind, b, target, and, p.metres) || loosely(&self.map, kind, b, target, p.metres)
        };
        match to {
            AnchorPhrase::Ego => match (side_of_ego(kind, b), p.metres) {
                (Some(held), None) => held,
                _ => at(&RelationReference::Thing(ego()), anchors.second.first()),
            },
            AnchorPhrase::Lane(role) => at(&RelationReference::Lane(*role), None),
            AnchorPhrase::Crossing => at(&RelationReference::Crossing, None),
            AnchorPhrase::Junction => at(&RelationReference::Junction, None),
            // (seen from the ego vehicle)
            AnchorPhrase::OtherSide => matches!(
                role_of(&self.map, b),
                Some(L::LeftRoadside | L::LeftSidewalk | L::Oncoming)
            ),
            AnchorPhrase::OtherLane => {
                matches!(role_of(&self.map, b), Some(L::Left | L::Right | L::Oncoming))
            }
            AnchorPhrase::EachOther => true,
            AnchorPhrase::Thing(_) => anchors.first.iter().filter(|o| o.id != b.id).any(|o| {
                let between =
                    |s: &SceneBox| s.id != o.id && s.id != b.id && at(&RelationReference::Thing(*o), Some(s));
                match kind {
                    RelationKind::Between => anchors.second.iter().any(between),
                    _ => at(&RelationReference::Thing(*o), None),
                }
            }),
        }
    }
}

/// Boxes that a place refers to: those of its anchor, and of the second one of `between`.
struct Anchors {
    first: Vec<SceneBox>,
    second: Vec<SceneBox>,
}

/// Side as people name it: a car 30 m ahead in the left lane is on the left.
fn side_of_ego(kind: RelationKind, b: &SceneBox) -> Option<bool> {
    let (x, y) = (b.center_m.x, b.center_m.y);
    match kind {
        RelationKind::LeftOf => Some(y > 1.0),
        RelationKind::RightOf => Some(y < -1.0),
        RelationKind::InFrontOf => Some(x > 3.0 && y.abs() < x.max(3.0)),
        RelationKind::Behind => Some(x < -0.5 && y.abs() < (-x).max(3.0)),
        _ => None,
    }
}

/// True if people would use the relation loosely although it does not hold exactly.
fn loosely(
    map: &place::lanes::LaneMap<'_>,
    kind: RelationKind,
    b: &SceneBox,
    to: &RelationReference,
    metres: Option<f64>,
) -> bool {
    use RelationKind as K;
    let near = || holds(map, K::Near, b, to, None, metres);
    let stands = b.velocity_mps.length() < 0.5;
    match (kind, to) {
        (K::WaitingAt, RelationReference::Crossing | RelationReference::Junction) => stands && near(),
        (K::On | K::Crossing, RelationReference::Crossing) => holds(map, K::Crossing, b, to, None, metres),
        (K::Crossing, RelationReference::Lane(_)) => {
            holds(map, K::On, b, &RelationReference::Crossing, None, metres)
        }
        (K::Near | K::On, RelationReference::Junction) => {
            let close = |c: glam::DVec2| c.distance(b.center_m.truncate()) < 24.0;
            b.center_m.x > 2.0 && map.junction.is_some_and(close)
        }
        (K::Blocking, RelationReference::Lane(_)) => holds(map, K::On, b, to, None, metres),
        (K::NextTo, RelationReference::Thing(_)) => near(),
        (K::Following, RelationReference::Thing(o)) if o.id.0 == u32::MAX => {
            b.center_m.x < 0.0 && b.center_m.y.abs() < 2.5
        }
        _ => false,
    }
}

fn by_size(fit: Vec<&SceneBox>, size: SizeHint) -> Vec<&SceneBox> {
    let volume = |b: &SceneBox| b.size_m.x * b.size_m.y * b.size_m.z;
    let usual = |b: &SceneBox| b.class.typical_size_m().map_or(1.0, |s| s[0] * s[1] * s[2]);
    fit.into_iter()
        .filter(|b| match size {
            SizeHint::Large => volume(b) > 1.12 * usual(b),
            SizeHint::Small => volume(b) < 0.9 * usual(b),
        })
        .collect()
}

/// Rank of a box for a pick: the picked one has the lowest.
fn rank(b: &SceneBox, pick: Pick) -> f64 {
    let p = b.center_m.truncate();
    let volume = b.size_m.x * b.size_m.y * b.size_m.z;
    match pick {
        Pick::Nearest => p.length(),
        Pick::Farthest => -p.length(),
        Pick::Leftmost => -p.y,
        Pick::Rightmost => p.y,
        Pick::Frontmost => -p.x,
        Pick::Rearmost => p.x,
        Pick::Largest => -volume,
        Pick::Smallest => volume,
    }
}

/// A thing in words, without number and places: `parked red car`.
pub fn words_of(t: &ObjectPhrase) -> String {
    let mut out: Vec<String> = Vec::new();
    out.extend(t.state.map(|s| match s {
        ObjectState::Moving => "moving".into(),
        ObjectState::Parked => "parked".into(),
        ObjectState::Waiting => "standing".into(),
    }));
    out.extend(t.paint.map(|p| match p {
        PaintWish::Is(p) => p.name().into(),
        PaintWish::Not(p) => format!("not {}", p.name()),
    }));
    out.push(match t.id {
        Some(id) => format!("box {id}"),
        None => t.noun.words(),
    });
    out.join(" ")
}

/// The plural of a noun phrase in words.
pub fn plural(words: &str) -> String {
    match words.rsplit_once(' ').map_or(words, |w| w.1) {
        "person" => format!("{}people", words.trim_end_matches("person")),
        "man" | "woman" | "policeman" => format!("{}en", words.trim_end_matches("an")),
        "child" => format!("{words}ren"),
        "it" => "of them".into(),
        _ => super::lexicon::plural(words),
    }
}
