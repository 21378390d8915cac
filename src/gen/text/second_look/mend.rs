//! How a command is mended: boxes are placed where what was said of them holds, or nothing is changed.

use std::collections::BTreeMap;

use super::words::{Article, article, classes};
use crate::generation::text::description::{Anchor, Count, Description, ObjectSpec, Stated};
use crate::generation::text::edit::{Editor, TextEdit};
use crate::generation::text::holds::{Target, ego, holds};
use crate::generation::text::place::place_from;
use crate::generation::text::to_graph::to_graph;
use crate::scene::graph::{Locked, ObjectState, RelationKind};
use crate::scene::{BoxId, SceneBox};

impl Editor<'_> {
    /// True if a relation holds of a box, to any of those that its anchor may mean.
    pub(super) fn stands(&self, d: &Description, r: &Stated, b: &SceneBox) -> bool {
        let things = |a: &Anchor| -> Vec<SceneBox> {
            match a {
                Anchor::Ego => vec![ego()],
                Anchor::Object(j) => {
                    let fit = d.foreground.get(*j).map(classes).unwrap_or_default();
                    self.boxes
                        .values()
                        .filter(|o| fit.contains(&o.class) && o.id != b.id)
                        .copied()
                        .collect()
                }
                _ => Vec::new(),
            }
        };
        let to: Vec<Target> = match &r.anchor {
            Anchor::Lane(role) => vec![Target::Lane(*role)],
            Anchor::Crossing => vec![Target::Crossing],
            Anchor::Junction => vec![Target::Junction],
            other => things(other).into_iter().map(Target::Thing).collect(),
        };
        if r.relation == RelationKind::Between {
            let seconds = r.and.as_ref().map(things).unwrap_or_default();
            return to.iter().any(|t| {
                seconds
                    .iter()
                    .any(|s| holds(&self.map, r.relation, b, t, Some(s), r.distance_m))
            });
        }
        to.iter()
            .any(|t| holds(&self.map, r.relation, b, t, None, r.distance_m))
    }

    /// Places for `n` of the `i`-th objects of a description where all that is said of them holds; `None` if there are none, or
    /// if what they are told by is not clear. The boxes `without` are not in the way.
    fn places(
        &self,
        d: &Description,
        i: usize,
        n: usize,
        without: &[BoxId],
        from: Option<&SceneBox>,
    ) -> Option<Vec<SceneBox>> {
        let mut spec = d.foreground.get(i)?.clone();
        spec.count = Count::exactly(n as u32);
        if let Some(b) = from {
            spec.class = b.class;
            spec.size_m = Some(b.size_m.to_array());
            spec.size = None;
            if spec.state.is_none()
                && spec
                    .relations
                    .iter()
                    .all(|r| r.relation != RelationKind::ParkedOn)
            {
                spec.state = Some(if b.velocity_mps.length() > 0.5 {
                    ObjectState::Moving
                } else {
                    ObjectState::Waiting
                });
            }
        }
        let mut out = Description {
            foreground: vec![spec],
            ..Description::default()
        };
        let mut held: Vec<(usize, Vec<SceneBox>)> = Vec::new();
        let mut index: BTreeMap<usize, usize> = BTreeMap::new();
        let mut relations = std::mem::take(&mut out.foreground[0].relations);
        for r in &mut relations {
            for a in [Some(&mut r.anchor), r.and.as_mut()].into_iter().flatten() {
                let Anchor::Object(j) = *a else { continue };
                if let Some(k) = index.get(&j) {
                    *a = Anchor::Object(*k);
                    continue;
                }
                let o = d.foreground.get(j)?.clone();
                let mut fits: Vec<SceneBox> = self
                    .meant(&o)
                    .into_iter()
                    .filter(|b| !without.contains(&b.id))
                    .collect();
                if o.count.n == 1 {
                    fits = self.likely(fits, &o);
                }
                if fits.is_empty() || o.count.n == 1 && fits.len() > 1 {
                    return None;
                }
                let k = out.foreground.len();
                out.foreground.push(ObjectSpec {
                    count: Count::exactly(fits.len() as u32),
                    relations: Vec::new(),
                    ..o
                });
                held.push((k, fits));
                index.insert(j, k);
                *a = Anchor::Object(k);
            }
        }
        out.foreground[0].relations = relations;
        let stated = out.foreground[0].relations.len();
        let mut graphed = to_graph(&out, self.seed);
        // (a statement that the graph does not take would seem to hold)
        if graphed.graph.edges.len() != n * stated {
            return None;
        }
        let mut locked = Vec::new();
        let mut stay = Vec::new();
        for (k, fits) in &held {
            for (id, b) in graphed.nodes.get(*k)?.iter().zip(fits) {
                graphed.graph.nodes.iter_mut().find(|x| x.id == *id)?.locked = Some(Locked::Box(*b));
                locked.push(*id);
                stay.push(b.id);
            }
        }
        let others: Vec<SceneBox> = self
            .boxes
            .values()
            .filter(|b| !stay.contains(&b.id) && !without.contains(&b.id))
            .copied()
            .collect();
        let placement = place_from(
            &graphed.graph,
            self.layout,
            self.seed,
            &graphed.sizes_m,
            &others,
            from,
        );
        let new: Vec<SceneBox> = placement
            .boxes
            .iter()
            .filter(|b| !locked.contains(&b.id.0))
            .copied()
            .collect();
        (placement.cost() == 0 && new.len() == n).then_some(new)
    }

    /// The same; where metres from us were said, "behind the cones" may be as we see them.
    fn places_either(
        &self,
        d: &Description,
        i: usize,
        n: usize,
        without: &[BoxId],
        from: Option<&SceneBox>,
    ) -> Option<Vec<SceneBox>> {
        self.places(d, i, n, without, from).or_else(|| {
            let mut d = d.clone();
            let own = &mut d.foreground.get_mut(i)?.relations;
            let measured = own
                .iter()
                .any(|r| r.anchor == Anchor::Ego && r.distance_m.is_some());
            let all = own.len();
            own.retain(|r| {
                !(matches!(r.anchor, Anchor::Object(_))
                    && matches!(r.relation, RelationKind::InFrontOf | RelationKind::Behind))
            });
            let fewer = own.len() < all;
            (measured && fewer)
                .then(|| self.places(&d, i, n, without, from))
                .flatten()
        })
    }

    /// What is called "the truck" and was there before is not another one: it stands where that was put. True if so.
    pub(super) fn take_back(
        &mut self,
        words: &str,
        d: &Description,
        added: &[BoxId],
        before: &BTreeMap<BoxId, SceneBox>,
    ) -> bool {
        let lower = words.to_lowercase();
        let mut any = false;
        for spec in &d.foreground {
            let fit = classes(spec);
            let named = |o: &&ObjectSpec| classes(o).iter().any(|k| fit.contains(k));
            let mine: Vec<SceneBox> = added
                .iter()
                .filter_map(|id| self.boxes.get(id))
                .filter(|b| fit.contains(&b.class))
                .copied()
                .collect();
            if mine.is_empty()
                || d.foreground.iter().filter(named).count() > 1
                || article(words, spec) == Article::Indefinite
                || !lower.contains(&spec.noun.to_lowercase())
            {
                continue;
            }
            let alone = ObjectSpec {
                relations: Vec::new(),
                state: None,
                ..spec.clone()
            };
            let old: Vec<SceneBox> = self
                .meant(&alone)
                .into_iter()
                .filter(|b| before.contains_key(&b.id))
                .collect();
            let subject = !spec.relations.is_empty();
            if old.is_empty() || subject && (old.len() != 1 || mine.len() != 1) {
                continue;
            }
            if !subject && d.foreground.len() == 1 {
                continue;
            }
            let ids: Vec<BoxId> = mine.iter().map(|b| b.id).collect();
            self.out
                .edits
                .retain(|e| !matches!(e, TextEdit::Add { object } if ids.contains(&object.id)));
            ids.iter().for_each(|id| {
                self.boxes.remove(id);
            });
            if let (true, [old], [new]) = (subject, old.as_slice(), mine.as_slice()) {
                self.put(*old, new);
            }
            any = true;
        }
        any
    }

    /// Puts a box of the scene where another was placed for it.
    fn put(&mut self, old: SceneBox, place: &SceneBox) {
        let object = SceneBox {
            center_m: place.center_m.truncate().extend(old.center_m.z),
            yaw_rad: place.yaw_rad,
            velocity_mps: place.velocity_mps,
            ..old
        };
        let fresh = self.out.edits.iter_mut().find_map(|e| match e {
            TextEdit::Add { object: o } if o.id == old.id => Some(o),
            _ => None,
        });
        if let Some(fresh) = fresh {
            *fresh = object;
            self.boxes.insert(old.id, object);
            return;
        }
        self.push(TextEdit::Move {
            id: old.id,
            center_m: object.center_m,
            yaw_rad: object.yaw_rad,
        });
        let moves = |b: &SceneBox| b.velocity_mps.length() > 0.5;
        if moves(&old) != moves(&object) {
            self.push(TextEdit::Replace { id: old.id, object });
        }
    }

    /// Puts boxes where what is said of them holds; true if there is such a place.
    pub(super) fn place_again(&mut self, d: &Description, i: usize, ids: &[BoxId]) -> bool {
        let from = ids
            .first()
            .and_then(|id| self.boxes.get(id))
            .copied()
            .filter(|_| ids.len() == 1);
        let Some(new) = self.places_either(d, i, ids.len(), ids, from.as_ref()) else {
            return false;
        };
        for (id, place) in ids.iter().zip(new) {
            if let Some(old) = self.boxes.get(id).copied() {
                self.put(old, &place);
            }
        }
        true
    }

    /// Adds what a command passed over; true if there is a place for it.
    pub(super) fn add_passed_over(&mut self, d: &Description, i: usize, n: usize) -> bool {
        let Some(new) = self.places_either(d, i, n, &[], None) else {
            return false;
        };
        self.last.clear();
        for b in new {
            let object = SceneBox {
                id: self.next_id(),
                ..b
            };
            self.last.push(object.id);
            self.push(TextEdit::Add { object });
        }
        true
    }
}
