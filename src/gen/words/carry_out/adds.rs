//! New things: their places are found around the objects that are there already.

use glam::DVec3;

use super::super::nouns::Noun;
use super::super::plan::{AnchorResolver, PlacementPlan, label_of};
use super::super::reading::{ObjectPhrase, Quantity, Relation};
use super::super::remark::Remark;
use super::super::resolve::Spare;
use super::super::stage::Stage;
use place::description::{Anchor, Count, Description, ObjectSpec, Stated};
use place::holds::{RelationReference, holds, role_of};
use place::off::off;
use place::rules::{Placement, place_from};
use place::to_graph::to_graph;
use scene::graph::{LaneRole, Locked, ObjectState, RelationKind, SizeHint};
use scene::{BoxId, BoxLabel, Class, SceneBox};

/// Places that were found for a plan.
pub(super) struct Arranged {
    pub(super) new: Vec<SceneBox>,
    pub(super) left_out: Vec<String>,
    pub(super) unmet: Vec<RelationKind>,
    /// Distances that differ from the ones asked for: relation, and distance asked for and found, m.
    pub(super) off: Vec<(RelationKind, [f64; 2])>,
}

impl AnchorResolver for Stage<'_> {
    fn find(&mut self, t: &ObjectPhrase) -> Result<Vec<SceneBox>, ()> {
        let asked = self.out.questions.len();
        match self.that(t, Spare::Nearest) {
            Some(ids) => Ok(ids.iter().map(|id| self.boxes[id]).collect()),
            None if self.out.questions.len() > asked => Err(()),
            // (a thing that is not there is added, and a remark says so)
            None => Ok(Vec::new()),
        }
    }

    fn role(&self, b: &SceneBox) -> Option<LaneRole> {
        role_of(&self.map, b)
    }

    fn last_noun(&self) -> Option<Noun> {
        self.last_noun
    }
}

impl Stage<'_> {
    pub(super) fn add(&mut self, things: &[ObjectPhrase]) {
        let (there, new): (Vec<&ObjectPhrase>, Vec<&ObjectPhrase>) = things
            .iter()
            .partition(|t| t.places.iter().any(|p| p.relation == Relation::There));
        for t in there {
            self.add_there(t);
        }
        let mut list: Vec<ObjectPhrase> = Vec::new();
        for t in new {
            let bare = t.places.is_empty() && matches!(t.quantity, Quantity::N(_));
            let alike = if bare { self.joined_by(t) } else { Vec::new() };
            if alike.is_empty() {
                list.push(t.clone());
            } else {
                self.add_like(t, &alike);
            }
        }
        if !list.is_empty() {
            let plan = self.plan(&list);
            self.put(plan);
        }
    }

    /// Boxes of the same kind that small things and people join if no place was stated.
    fn joined_by(&self, t: &ObjectPhrase) -> Vec<BoxId> {
        let class = t.noun.classes()[0];
        let joins = matches!(class, Class::TrafficCone | Class::Barrier | Class::Pedestrian)
            || t.state == Some(ObjectState::Parked);
        let same = |b: &&SceneBox| b.class == class && t.state.is_none_or(|s| self.does(b, s));
        if joins {
            self.boxes.values().filter(same).map(|b| b.id).collect()
        } else {
            Vec::new()
        }
    }

    fn plan(&mut self, things: &[ObjectPhrase]) -> PlacementPlan {
        let mut plan = PlacementPlan {
            follows: true,
            ..PlacementPlan::default()
        };
        plan.add(things, self);
        plan
    }

    /// Places the objects of a plan.
    fn put(&mut self, plan: PlacementPlan) {
        if plan.asked {
            return;
        }
        let mut relaxed = plan.specs.clone();
        let follows = relaxed
            .iter_mut()
            .flat_map(|s| &mut s.relations)
            .filter(|r| r.relation == RelationKind::Following && matches!(r.anchor, Anchor::Object(_)));
        let mut any = false;
        for r in follows {
            r.relation = RelationKind::Behind;
            any = true;
        }
        let bound = self.in_strips_of_neighbours(&plan);
        let mut found = match bound {
            Some(specs) => self.arrange(&specs, &plan.held, None),
            None => self.arrange(&plan.specs, &plan.held, None),
        };
        if !(found.left_out.is_empty() && found.unmet.is_empty()) {
            found = self.arrange(&plan.specs, &plan.held, None);
        }
        if any && !(found.left_out.is_empty() && found.unmet.is_empty()) {
            found = self.arrange(&relaxed, &plan.held, None);
        }
        let wanted = found.new.len() + found.left_out.len();
        let mut last = Vec::new();
        for b in &found.new {
            let object = SceneBox {
                id: self.next_id(),
                ..*b
            };
            last.push(object.id);
            self.add_box(object);
        }
        if let Some(why) = found.left_out.first() {
            self.remark(Remark::LeftOut {
                placed: found.new.len(),
                wanted,
                why: why.clone(),
            });
        }
        if !found.unmet.is_empty() {
            self.remark(Remark::Unmet {
                relations: found.unmet.iter().map(|r| r.name()).collect(),
            });
        }
        self.tell_off(&found.off);
        if !last.is_empty() {
            self.last = last;
            self.last_noun = None;
            if let Some(b) = self.last.first().and_then(|id| self.boxes.get(id)) {
                self.last_noun = Some(super::super::nouns::Noun::of_class(b.class));
            }
        }
    }

    /// Adds a remark for each distance that differs from the one asked for.
    pub(super) fn tell_off(&mut self, off: &[(RelationKind, [f64; 2])]) {
        for (relation, [asked_m, found_m]) in off {
            let tenth = |m: f64| (m * 10.0).round() / 10.0;
            self.remark(Remark::Off {
                relation: relation.name(),
                asked_m: tenth(*asked_m),
                found_m: tenth(*found_m),
            });
        }
    }

    /// The specs of a plan in which objects next to existing boxes stand in those boxes' strip, if no other place was
    /// stated; `None` if nothing changes.
    fn in_strips_of_neighbours(&self, plan: &PlacementPlan) -> Option<Vec<ObjectSpec>> {
        let mut specs = plan.specs.clone();
        let mut any = false;
        for s in &mut specs {
            let [r] = s.relations.as_slice() else { continue };
            let (RelationKind::NextTo, Anchor::Object(j)) = (r.relation, r.anchor) else {
                continue;
            };
            let boxes = plan.held.get(j).and_then(Option::as_ref).into_iter().flatten();
            let roles: Vec<_> = boxes
                .filter(|b| b.class == s.class)
                .map(|b| role_of(&self.map, b))
                .collect();
            if let Some(Some(role)) = roles.first()
                && roles.iter().all(|x| *x == Some(*role))
            {
                let anchor = Anchor::Lane(*role);
                s.relations.push(Stated {
                    relation: RelationKind::On,
                    anchor,
                    ..*r
                });
                any = true;
            }
        }
        any.then_some(specs)
    }

    /// Finds places; `from` is the box that is moved there, which does not count as an obstacle.
    pub(super) fn arrange(
        &mut self,
        specs: &[ObjectSpec],
        held: &[Option<Vec<SceneBox>>],
        from: Option<&SceneBox>,
    ) -> Arranged {
        let mut d = Description {
            foreground: specs.to_vec(),
            ..Description::default()
        };
        self.lanes_that_are_there(&mut d);
        let mut graphed = to_graph(&d, self.seed);
        let mut locked: Vec<u32> = Vec::new();
        let mut stay: Vec<BoxId> = from.map(|b| b.id).into_iter().collect();
        for (i, boxes) in held.iter().enumerate() {
            let nodes = graphed.nodes.get(i).cloned().unwrap_or_default();
            for (node, b) in nodes.iter().zip(boxes.iter().flatten()) {
                if let Some(n) = graphed.graph.nodes.iter_mut().find(|n| n.id == *node) {
                    n.locked = Some(Locked::Box(*b));
                    locked.push(*node);
                    stay.push(b.id);
                }
            }
        }
        let others: Vec<SceneBox> = self
            .boxes
            .values()
            .filter(|b| !stay.contains(&b.id))
            .copied()
            .collect();
        let p: Placement = place_from(
            &graphed.graph,
            &self.map,
            self.seed,
            &graphed.sizes_m,
            &others,
            from,
        );
        let stated: Vec<f64> = specs
            .iter()
            .flat_map(|s| s.relations.iter().filter_map(|r| r.distance_m))
            .collect();
        // (of several in a line the first stands at the stated place)
        let is_stated = |m: f64| stated.iter().any(|s| (s - m).abs() < 1e-9);
        let off = off(&graphed.graph, &self.map, &p.boxes)
            .into_iter()
            .map(|o| (graphed.graph.edges[o.edge], o))
            .filter(|(e, o)| !locked.contains(&e.from) && is_stated(o.asked_m))
            .map(|(e, o)| (e.relation, [o.asked_m, o.found_m]))
            .collect();
        Arranged {
            off,
            new: p
                .boxes
                .iter()
                .filter(|b| !locked.contains(&b.id.0))
                .copied()
                .collect(),
            left_out: p.left_out.into_iter().map(|l| l.1).collect(),
            unmet: p
                .unmet
                .iter()
                .map(|i| graphed.graph.edges[*i])
                .filter(|e| !locked.contains(&e.from))
                .map(|e| e.relation)
                .collect(),
        }
    }

    /// "The left lane" of a street with one lane each way is the oncoming one.
    fn lanes_that_are_there(&self, d: &mut Description) {
        let has = |role: LaneRole| self.map.points.iter().any(|p| p.role == role);
        if has(LaneRole::Left) || !has(LaneRole::Oncoming) {
            return;
        }
        for r in d.foreground.iter_mut().flat_map(|o| &mut o.relations) {
            if r.anchor == Anchor::Lane(LaneRole::Left) {
                r.anchor = Anchor::Lane(LaneRole::Oncoming);
            }
        }
    }

    /// Adds more of a kind where all of that kind stand.
    pub(super) fn add_like(&mut self, t: &ObjectPhrase, others: &[BoxId]) {
        let mut plan = self.plan(std::slice::from_ref(t));
        let on = |relation, anchor| Stated {
            relation,
            anchor,
            and: None,
            distance_m: None,
        };
        let crosses = |id: &BoxId| {
            let on = |b| {
                holds(
                    &self.map,
                    RelationKind::On,
                    b,
                    &RelationReference::Crossing,
                    None,
                    None,
                )
            };
            self.boxes.get(id).is_some_and(on)
        };
        let people = t.noun.classes()[0] == Class::Pedestrian;
        let spec = &mut plan.specs[0];
        if !spec.relations.is_empty() || others.is_empty() {
            self.put(plan);
            return;
        }
        if people && others.iter().all(crosses) {
            spec.relations.push(on(RelationKind::On, Anchor::Crossing));
        } else {
            let roles: Vec<Option<LaneRole>> = others.iter().map(|id| self.role_of(*id)).collect();
            let same = roles[0].filter(|r| roles.iter().all(|x| *x == Some(*r)));
            let lot = roles
                .contains(&Some(LaneRole::Carpark))
                .then_some(LaneRole::Carpark);
            if let Some(role) = same.or(lot.filter(|_| t.state == Some(ObjectState::Parked))) {
                spec.relations.push(on(RelationKind::On, Anchor::Lane(role)));
            }
        }
        self.put(plan);
    }

    /// Adds things where others were removed; if none were, where the last named thing stands.
    fn add_there(&mut self, t: &ObjectPhrase) {
        let rest: Vec<_> = t
            .places
            .iter()
            .filter(|p| p.relation != Relation::There)
            .cloned()
            .collect();
        let t = ObjectPhrase {
            places: rest,
            ..t.clone()
        };
        let spots = std::mem::take(&mut self.gone);
        if spots.is_empty() {
            let near = self.last.first().copied();
            match near.and_then(|id| self.role_of(id)) {
                Some(_) => self.add_like(&t, &near.into_iter().collect::<Vec<_>>()),
                None => {
                    self.remark(Remark::NoSpot);
                    let plan = self.plan(&[t]);
                    self.put(plan);
                }
            }
            return;
        }
        let wanted = super::super::plan::count_of(t.quantity).n as usize;
        let put = self.put_at(&t, &spots, wanted);
        if put < wanted {
            let more = ObjectPhrase {
                quantity: Quantity::N((wanted - put) as u32),
                ..t
            };
            let stood = self.last.clone();
            self.add_like(&more, &stood);
        }
    }

    /// Puts new things in the places of old boxes. Returns how many.
    pub(super) fn put_at(&mut self, t: &ObjectPhrase, spots: &[SceneBox], wanted: usize) -> usize {
        let mut last = Vec::new();
        for old in spots.iter().take(wanted) {
            let id = self.next_id();
            let Some(new) = in_place_of(old, t, id) else {
                continue;
            };
            let object = self.clear_of_others(new).unwrap_or(new);
            last.push(id);
            self.add_box(object);
        }
        let n = last.len();
        self.last = last;
        n
    }

    pub(super) fn as_spec(&self, b: &SceneBox) -> ObjectSpec {
        ObjectSpec {
            class: b.class,
            count: Count::exactly(1),
            state: None,
            size: None,
            label: BoxLabel::default(),
            size_m: Some(b.size_m.to_array()),
            relations: Vec::new(),
            motion: None,
        }
    }
}

/// A box of another kind in the place of an old one.
pub(super) fn in_place_of(old: &SceneBox, t: &ObjectPhrase, id: BoxId) -> Option<SceneBox> {
    let class = t.noun.classes()[0];
    let factor = match t.size {
        Some(SizeHint::Large) => 1.18,
        Some(SizeHint::Small) => 0.85,
        None => 1.0,
    };
    let size_m = DVec3::from_array(t.noun.size_m().or(class.typical_size_m())?) * factor;
    let base_m = old.center_m.z - old.size_m.z / 2.0;
    let speed = match t.state {
        Some(ObjectState::Moving) => Stage::pace(class),
        Some(_) => 0.0,
        None if old.velocity_mps.length() > 0.5 => old.velocity_mps.length().min(Stage::pace(class).max(0.0)),
        None => 0.0,
    };
    Some(SceneBox {
        id,
        class,
        size_m,
        center_m: old.center_m.truncate().extend(base_m + size_m.z / 2.0),
        velocity_mps: old.heading() * speed,
        label: label_of(t),
        ..*old
    })
}
