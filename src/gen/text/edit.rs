//! Edits of an open scene by text. The output is plain data; the application turns it into its own edits. A target that
//! fits several boxes is asked back, never guessed.

use std::collections::BTreeMap;

use glam::{DVec2, DVec3};
use serde::Serialize;

use super::description::{Became, Description, Phrase, Reading, TimeOfDay, Unread, Weather};
use super::edit_grammar::{Command, Destination, commands};
use super::holds::{ego, in_role};
use super::lanes::LaneMap;
use super::mention::Mention;
use super::place::place_with;
use super::rephrase::Change;
use super::select::{Candidate, Chosen, choose, where_is};
use super::to_graph::to_graph;
use super::tokens::{LONGEST, Span};
use super::words::edits::Verb;
use crate::scene::graph::{LaneRole, Locked, Node, NodeKind, ObjectNode, ObjectState, RelationKind};
use crate::scene::{BevLayout, BoxId, Class, SceneBox};

/// Most commands of one text that are carried out.
pub const MOST_COMMANDS: usize = 100;

/// One change of a scene.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum TextEdit {
    /// Takes a box away.
    Remove {
        /// Which.
        id: BoxId,
    },
    /// Puts a box in; its id is free in the scene.
    Add {
        /// The box.
        object: SceneBox,
    },
    /// Moves or turns a box.
    Move {
        /// Which.
        id: BoxId,
        /// New centre, m.
        center_m: DVec3,
        /// New heading, rad.
        yaw_rad: f64,
    },
    /// Puts another class (with its size) in the place of a box.
    Replace {
        /// Which.
        id: BoxId,
        /// The new box, of the same id.
        object: SceneBox,
    },
    /// Sets the text that describes the style.
    Style {
        /// `night, rain`.
        prompt: String,
    },
}

/// The words that name a target: an answer replaces them by a number, and leaves the rest of the command as it is.
fn words_of(mention: &Mention, c: &Command) -> String {
    let span = mention.spec.span;
    let from = span.start.checked_sub(c.span.start);
    let words = from.and_then(|from| c.text.get(from..span.end.saturating_sub(c.span.start)));
    words
        .filter(|w| !w.trim().is_empty())
        .unwrap_or(&c.text)
        .to_owned()
}

/// A target that fits several boxes.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Question {
    /// `3 parked cars: which?`
    pub text: String,
    /// The words that named it, as they stand in the text.
    pub phrase: String,
    /// The boxes that fit.
    pub candidates: Vec<Candidate>,
}

/// All that came of an edit text.
#[derive(Clone, Debug, Default, Serialize)]
pub struct EditReading {
    /// Changes, in order.
    pub edits: Vec<TextEdit>,
    /// What must be answered first; the edits of the other commands stand.
    pub questions: Vec<Question>,
    /// Part by part.
    pub phrases: Vec<Phrase>,
    /// What was not understood.
    pub not_understood: Vec<Unread>,
    /// What could not be done, and decisions worth knowing.
    pub notes: Vec<String>,
}

/// An open scene, as far as text edits need it.
#[derive(Clone, Copy, Debug)]
pub struct OpenScene<'a> {
    /// Boxes by id.
    pub boxes: &'a BTreeMap<BoxId, SceneBox>,
    /// Map.
    pub layout: &'a BevLayout,
    /// The style text it has.
    pub prompt: &'a str,
}

struct Editor<'a> {
    map: LaneMap<'a>,
    layout: &'a BevLayout,
    boxes: BTreeMap<BoxId, SceneBox>,
    style: String,
    definite: Vec<super::tokens::Span>, // what "the" was said of in the present command
    seed: u64,
    out: EditReading,
}

/// Reads an edit text for a scene. Commands are carried out one after another, each on what the one before left.
pub fn read_edit(text: &str, scene: &OpenScene<'_>, seed: u64) -> EditReading {
    let mut editor = Editor {
        map: LaneMap::new(scene.layout),
        layout: scene.layout,
        boxes: scene.boxes.clone(),
        style: scene.prompt.to_string(),
        definite: Vec::new(),
        seed,
        out: EditReading::default(),
    };
    let all = commands(text);
    if all.len() > MOST_COMMANDS {
        editor.note(format!(
            "{} commands were given: the first {MOST_COMMANDS} are carried out",
            all.len()
        ));
    }
    if text.len() > LONGEST {
        editor.out.not_understood.push(Unread {
            span: Span {
                start: LONGEST,
                end: text.len(),
            },
            text: "...".into(),
            why: Some(format!("only the first {LONGEST} bytes are read")),
        });
    }
    for (i, command) in all.into_iter().take(MOST_COMMANDS).enumerate() {
        let before = editor.out.edits.len();
        let asked = editor.out.questions.len();
        let meaning = editor.carry_out(&command);
        editor
            .out
            .not_understood
            .extend(command.reading.not_understood.iter().cloned());
        let spelling = command
            .reading
            .notes
            .iter()
            .filter(|n| n.contains("was read as"))
            .cloned();
        editor.out.notes.extend(spelling);
        let n = editor.out.edits.len() - before;
        let meaning = match meaning {
            Some(m) => format!("{m}: {n} changes"),
            None if editor.out.questions.len() > asked => "asked back".into(),
            None => "nothing".into(),
        };
        editor.out.phrases.push(Phrase {
            span: command.span,
            text: command.span.of(text).to_string(),
            became: Became::Command(i),
            meaning,
        });
    }
    editor.out
}

impl Editor<'_> {
    fn push(&mut self, edit: TextEdit) {
        match &edit {
            TextEdit::Remove { id } => {
                self.boxes.remove(id);
            }
            TextEdit::Add { object } | TextEdit::Replace { object, .. } => {
                self.boxes.insert(object.id, *object);
            }
            TextEdit::Move {
                id,
                center_m,
                yaw_rad,
            } => {
                if let Some(b) = self.boxes.get_mut(id) {
                    let turn = yaw_rad - b.yaw_rad;
                    b.center_m = *center_m;
                    b.yaw_rad = *yaw_rad;
                    b.velocity_mps = DVec2::from_angle(turn).rotate(b.velocity_mps);
                }
            }
            TextEdit::Style { prompt } => self.style.clone_from(prompt),
        }
        self.out.edits.push(edit);
    }

    fn note(&mut self, text: impl Into<String>) {
        self.out.notes.push(text.into());
    }

    /// Carries out one command; what it did in words, `None` if nothing.
    fn carry_out(&mut self, c: &Command) -> Option<String> {
        let mut done = Vec::new();
        self.definite.clone_from(&c.definite);
        if self.style_of(c) {
            done.push("style".to_string());
        }
        match c.verb {
            Verb::Remove | Verb::Clear => {
                if c.reading.description.foreground.is_empty()
                    && c.reading.description.absent.is_empty()
                    && c.verb == Verb::Clear
                    && done.is_empty()
                {
                    // "clear my lane"
                    if let Some(role) = c.place {
                        let ids: Vec<BoxId> = self
                            .boxes
                            .values()
                            .filter(|b| in_role(&self.map, role, b.center_m.truncate()))
                            .map(|b| b.id)
                            .collect();
                        ids.iter().for_each(|id| self.push(TextEdit::Remove { id: *id }));
                        done.push("cleared".into());
                    }
                } else if c.targets.is_empty() && !c.reading.description.absent.is_empty() {
                    // "clear the kerb: no parked cars"
                    self.take_absent(&c.reading.description);
                    done.push("removed".into());
                } else if let Some(ids) = self.targets(c, true) {
                    ids.iter().for_each(|id| self.push(TextEdit::Remove { id: *id }));
                    done.push("removed".into());
                }
            }
            Verb::Add => {
                if self.add(&c.reading.description) {
                    done.push("added".into());
                }
                if !c.reading.description.absent.is_empty() {
                    self.take_absent(&c.reading.description);
                    done.push("removed".into());
                }
            }
            Verb::Keep => {
                self.keep(c);
                done.push("kept so many".into());
            }
            Verb::Move => {
                if let Some(ids) = self.targets(c, false) {
                    for id in ids {
                        self.shift(id, c);
                    }
                    done.push("moved".into());
                }
            }
            Verb::Turn => {
                if let Some(ids) = self.targets(c, false) {
                    for id in ids {
                        self.turn(id, c);
                    }
                    done.push("turned".into());
                }
            }
            Verb::Replace => {
                if let Some(ids) = self.targets(c, false) {
                    self.replace_all(&ids, c);
                    done.push("replaced".into());
                }
            }
            Verb::Paint => {
                if let Some(ids) = self.targets(c, false) {
                    let list: Vec<String> = ids.iter().map(|i| i.0.to_string()).collect();
                    self.note(format!(
                        "boxes have no colour: box {} stays as it is; pictures invent the colours of vehicles",
                        list.join(", ")
                    ));
                }
            }
            Verb::Make => {
                if done.is_empty() && !self.make(c) {
                    self.note(format!("{:?}: what it should become was not understood", c.text));
                } else if done.is_empty() {
                    done.push("changed".into());
                }
            }
        }
        (!done.is_empty()).then(|| done.join(", "))
    }

    /// Time and weather; true if any was said.
    fn style_of(&mut self, c: &Command) -> bool {
        let d = &c.reading.description;
        if d.time_of_day.is_none() && d.weather.is_none() && d.environment.is_none() {
            return false;
        }
        // "turn off the rain", "remove the fog", "stop the snow"
        let stops = matches!(c.verb, Verb::Remove | Verb::Clear) && d.foreground.is_empty();
        let old = super::parse::read(&self.style).description;
        let weather = if stops && d.weather.is_some() {
            Some(Weather::Clear)
        } else {
            d.weather
        };
        let time = if stops && d.time_of_day == Some(TimeOfDay::Night) {
            Some(TimeOfDay::Day)
        } else {
            d.time_of_day
        };
        let new = Description {
            time_of_day: time.or(old.time_of_day),
            weather: weather.or(old.weather),
            environment: d.environment.or(old.environment),
            ..Description::default()
        };
        let prompt = new.style();
        if prompt != self.style {
            self.push(TextEdit::Style { prompt });
        }
        true
    }

    /// The boxes that a command is about; asks back or notes where none or several fit.
    fn targets(&mut self, c: &Command, removing: bool) -> Option<Vec<BoxId>> {
        let Some(mention) = c.targets.first() else {
            self.note(format!("{:?}: what should change was not understood", c.text));
            return None;
        };
        let mut all = Vec::new();
        for (k, mention) in c.targets.iter().enumerate() {
            if k > 0 && !removing {
                break;
            }
            let chosen = match c.nth {
                Some(nth) => super::select::in_order(&self.map, &self.boxes, mention, &c.mentions, nth),
                None => choose(&self.map, &self.boxes, mention, &c.mentions),
            };
            match chosen {
                Chosen::These(ids) => all.extend(ids),
                Chosen::None(what) => self.note(format!("no {what} is in the scene")),
                Chosen::TooFew { what, found, wanted } => {
                    self.note(format!("{wanted} {what} were named, {found} are in the scene"));
                }
                Chosen::Several { what, candidates } => {
                    self.out.questions.push(Question {
                        text: format!("{} {what}: which?", candidates.len()),
                        phrase: words_of(mention, c),
                        candidates,
                    });
                }
            }
        }
        let _ = mention;
        all.sort_unstable();
        all.dedup();
        (!all.is_empty()).then_some(all)
    }

    fn next_id(&self) -> BoxId {
        BoxId(
            self.boxes
                .keys()
                .next_back()
                .map_or(1, |id| id.0.saturating_add(1)),
        )
    }

    /// Adds what a description names; what it refers to by "the" may be a box of the scene.
    fn add(&mut self, d: &Description) -> bool {
        let mut d = d.clone();
        d.density = None;
        // Anchors that are in the scene already are locked there.
        let refers: Vec<usize> = d
            .foreground
            .iter()
            .flat_map(|o| o.relations.iter())
            .flat_map(|r| [Some(r.anchor), r.and])
            .flatten()
            .filter_map(|a| match a {
                super::description::Anchor::Object(i) => Some(i),
                _ => None,
            })
            .collect();
        let mut graphed = to_graph(&d, self.seed);
        let mut locked: Vec<u32> = Vec::new();
        for (i, o) in d.foreground.iter().enumerate() {
            if !refers.contains(&i) || !self.definite.contains(&o.span) {
                continue;
            }
            let fits: Vec<SceneBox> = self
                .boxes
                .values()
                .filter(|b| b.class == o.class)
                .filter(|b| o.state.is_none_or(|s| super::select::state_of(&self.map, b, s)))
                .copied()
                .collect();
            let fits = if o.count.n == 1 {
                super::select::of_size(&fits, &o.noun, o.size_m)
            } else {
                fits
            };
            let nodes = graphed.nodes.get(i).cloned().unwrap_or_default();
            if fits.len() > nodes.len() {
                self.out.questions.push(Question {
                    text: format!("{} {}: which?", fits.len(), o.noun),
                    phrase: o.noun.clone(),
                    candidates: fits.iter().map(|b| where_is(&self.map, b)).collect(),
                });
                return false;
            }
            if fits.is_empty() {
                self.note(format!("no {} is in the scene: one is added", o.noun));
            }
            for (node, b) in nodes.iter().zip(&fits) {
                if let Some(n) = graphed.graph.nodes.iter_mut().find(|n: &&mut Node| n.id == *node) {
                    n.locked = Some(Locked::Box(*b));
                    locked.push(*node);
                }
            }
        }
        let mut others: Vec<SceneBox> = self.boxes.values().copied().collect();
        let held: Vec<SceneBox> = graphed
            .graph
            .nodes
            .iter()
            .filter_map(|n| match n.locked {
                Some(Locked::Box(b)) => Some(b),
                _ => None,
            })
            .collect();
        others.retain(|b| !held.iter().any(|h| h.id == b.id));
        let placement = place_with(&graphed.graph, self.layout, self.seed, &graphed.sizes_m, &others);
        for b in placement.boxes.iter().filter(|b| !locked.contains(&b.id.0)) {
            let object = SceneBox {
                id: self.next_id(),
                ..*b
            };
            self.push(TextEdit::Add { object });
        }
        let added = placement.boxes.len() - locked.len().min(placement.boxes.len());
        if !placement.left_out.is_empty() {
            let wanted = added + placement.left_out.len();
            self.note(format!(
                "{added} of {wanted} were placed: {}",
                placement.left_out[0].1
            ));
        }
        if !placement.unmet.is_empty() {
            let names: Vec<&str> = placement
                .unmet
                .iter()
                .map(|i| graphed.graph.edges[*i].relation.name())
                .collect();
            self.note(format!("not everything said could be met: {}", names.join(", ")));
        }
        added > 0
    }

    fn take_absent(&mut self, d: &Description) {
        for a in &d.absent {
            let ids: Vec<BoxId> = self
                .boxes
                .values()
                .filter(|b| a.classes.contains(&b.class))
                .filter(|b| a.state.is_none_or(|s| super::select::state_of(&self.map, b, s)))
                .map(|b| b.id)
                .collect();
            ids.iter().for_each(|id| self.push(TextEdit::Remove { id: *id }));
        }
    }

    fn keep_only(&mut self, ids: &[BoxId]) {
        let others: Vec<BoxId> = self
            .boxes
            .keys()
            .filter(|id| !ids.contains(id))
            .copied()
            .collect();
        others
            .iter()
            .for_each(|id| self.push(TextEdit::Remove { id: *id }));
    }

    /// "only two cars": removes the farthest or adds.
    fn keep(&mut self, c: &Command) {
        for m in &c.targets {
            let fitting = super::select::fitting(&self.map, &self.boxes, m, &c.mentions);
            let wanted = match c.change {
                Some(Change::Times(f)) => (fitting.len() as f64 * f).round() as usize,
                Some(Change::Plus(n)) => (fitting.len() as i64 + n).max(0) as usize,
                None => m.spec.count.n as usize,
            };
            if c.change.is_none() && m.definite && !m.plural {
                // "keep only the bus"
                match choose(&self.map, &self.boxes, m, &c.mentions) {
                    Chosen::These(ids) => self.keep_only(&ids),
                    _ => self.note(format!("{:?}: which is to stay was not clear", c.text)),
                }
                continue;
            }
            if c.change.is_none() && m.uncounted && m.plural {
                // "only cars", "keep the cars": everything else of its kind goes.
                self.keep_only(&fitting);
                continue;
            }
            if fitting.len() > wanted {
                let mut by_range: Vec<(f64, BoxId)> = fitting
                    .iter()
                    .map(|id| (self.boxes[id].center_m.truncate().length(), *id))
                    .collect();
                by_range.sort_by(|a, b| b.0.total_cmp(&a.0));
                for (_, id) in by_range.iter().take(fitting.len() - wanted) {
                    self.push(TextEdit::Remove { id: *id });
                }
                self.note(format!("the {} farthest were removed", fitting.len() - wanted));
            } else if fitting.len() < wanted {
                let mut spec = m.spec.clone();
                spec.count = super::description::Count::exactly((wanted - fitting.len()) as u32);
                let d = Description {
                    foreground: vec![spec],
                    ..Description::default()
                };
                self.add(&d);
            }
        }
    }

    /// A new place for one box: by metres, or where a relation holds.
    fn shift(&mut self, id: BoxId, c: &Command) {
        let Some(b) = self.boxes.get(&id).copied() else {
            return;
        };
        let moved = match &c.destination {
            Some(Destination::By { direction, metres }) => {
                let metres = metres.unwrap_or_else(|| {
                    let free = [3.5, 7.0, 5.0, 10.5, 2.0].into_iter().find(|m| {
                        let new = SceneBox {
                            center_m: b.center_m + (*direction * *m).extend(0.0),
                            ..b
                        };
                        let apart = |o: &SceneBox| super::holds::overlap_m(&new, o, 0.2) <= 0.0;
                        apart(&ego()) && self.boxes.values().all(|o| o.id == id || apart(o))
                    });
                    let metres = free.unwrap_or(3.5);
                    self.out
                        .notes
                        .push(format!("no distance was said: moved by {metres} m"));
                    metres
                });
                b.center_m + (*direction * metres).extend(0.0)
            }
            Some(Destination::Toward { away, metres }) => {
                let p = b.center_m.truncate();
                let metres = metres.unwrap_or(3.5);
                let step = if *away {
                    metres
                } else {
                    -metres.min((p.length() - 4.0).max(0.0))
                };
                b.center_m + (p.normalize_or(DVec2::X) * step).extend(0.0)
            }
            Some(Destination::Place(spec)) => {
                let mut spec = spec.clone();
                let said = c.text.to_lowercase();
                // The other side is that on which it is not.
                if b.center_m.y > 0.0
                    && [
                        "opposite",
                        "other side",
                        "far side",
                        "across the",
                        "other pavement",
                        "other sidewalk",
                    ]
                    .iter()
                    .any(|w| said.contains(w))
                {
                    spec.relations.iter_mut().for_each(mirrored);
                }
                let d = Description {
                    foreground: c.with_anchors(&spec, b.class),
                    ..Description::default()
                };
                self.move_to(b, &d);
                let strip = |r: &super::description::Stated| {
                    use super::description::Anchor::Lane;
                    let aside = matches!(
                        r.anchor,
                        Lane(
                            LaneRole::Roadside
                                | LaneRole::LeftRoadside
                                | LaneRole::RightRoadside
                                | LaneRole::Carpark
                        )
                    );
                    aside && matches!(r.relation, RelationKind::On | RelationKind::ParkedOn)
                };
                let parks = said.contains("park")
                    || d.foreground
                        .first()
                        .is_some_and(|o| o.relations.iter().any(strip));
                if let Some(moved) = self
                    .boxes
                    .get(&id)
                    .copied()
                    .filter(|m| parks && m.class.is_vehicle() && m.velocity_mps.length() > 0.0)
                {
                    // Who stands at the roadside does not drive.
                    let object = SceneBox {
                        velocity_mps: DVec2::ZERO,
                        ..moved
                    };
                    self.push(TextEdit::Replace { id, object });
                }
                return;
            }
            None => {
                self.note(format!("{:?}: where to was not understood", c.text));
                return;
            }
        };
        if moved.truncate().abs().max_element() > 40.0 {
            self.note(format!(
                "box {} would leave the scene, which reaches 40 m from the ego vehicle: not moved",
                id.0
            ));
            return;
        }
        let new = SceneBox { center_m: moved, ..b };
        let hit = self
            .boxes
            .values()
            .find(|o| o.id != id && super::holds::overlap_m(&new, o, 0.0) > 0.0);
        if let Some(o) = hit {
            self.note(format!(
                "box {} now overlaps box {} ({})",
                id.0,
                o.id.0,
                o.class.label()
            ));
        } else if super::holds::overlap_m(&new, &ego(), 0.0) > 0.0 {
            self.note(format!("box {} now overlaps the ego vehicle", id.0));
        }
        self.push(TextEdit::Move {
            id,
            center_m: moved,
            yaw_rad: b.yaw_rad,
        });
    }

    fn move_to(&mut self, b: SceneBox, d: &Description) {
        let gone = self.boxes.remove(&b.id);
        let before = self.out.edits.len();
        let asked = self.out.questions.len();
        self.add(d);
        let added: Vec<TextEdit> = self.out.edits.split_off(before);
        for e in &added {
            if let TextEdit::Add { object } = e {
                self.boxes.remove(&object.id);
            }
        }
        if let Some(old) = gone {
            self.boxes.insert(old.id, old);
        }
        match added.first() {
            Some(TextEdit::Add { object }) => {
                let center_m = object.center_m.truncate().extend(b.center_m.z);
                self.push(TextEdit::Move {
                    id: b.id,
                    center_m,
                    yaw_rad: object.yaw_rad,
                });
            }
            _ if self.out.questions.len() > asked => {}
            _ => self.note(format!("box {} finds no room there: not moved", b.id.0)),
        }
    }

    fn turn(&mut self, id: BoxId, c: &Command) {
        let Some(b) = self.boxes.get(&id).copied() else {
            return;
        };
        let yaw_rad = match c.turn {
            Some(super::edit_grammar::Turn::By(rad)) => b.yaw_rad + rad,
            Some(super::edit_grammar::Turn::ToEgo) => (-b.center_m.truncate()).to_angle(),
            Some(super::edit_grammar::Turn::FromEgo) => b.center_m.truncate().to_angle(),
            Some(super::edit_grammar::Turn::WithLane) => self
                .map
                .nearest(b.center_m.truncate())
                .map_or(0.0, |l| l.dir.to_angle()),
            Some(super::edit_grammar::Turn::WithEgo) => {
                self.map.nearest(b.center_m.truncate()).map_or(0.0, |l| {
                    if l.dir.x < 0.0 {
                        (-l.dir).to_angle()
                    } else {
                        l.dir.to_angle()
                    }
                })
            }
            None => {
                self.note(format!("{:?}: how far to turn was not understood", c.text));
                return;
            }
        };
        self.push(TextEdit::Move {
            id,
            center_m: b.center_m,
            yaw_rad,
        });
    }

    /// One for one; where both sides are counted, those too many go and those too few are added.
    fn replace_all(&mut self, ids: &[BoxId], c: &Command) {
        let all = c.targets.first().is_some_and(|m| m.uncounted && m.plural);
        let wanted = match &c.by {
            Some(by) if !by.uncounted && (!all || by.spec.count.n > 1) => by.spec.count.n as usize,
            _ => ids.len(),
        };
        for id in ids.iter().skip(wanted.max(1)) {
            self.push(TextEdit::Remove { id: *id });
        }
        for id in ids.iter().take(wanted.max(1)) {
            self.replace(*id, c);
        }
        if let Some(by) = c.by.as_ref().filter(|_| wanted > ids.len()) {
            let mut spec = by.spec.clone();
            spec.count = super::description::Count::exactly((wanted - ids.len()) as u32);
            spec.relations
                .retain(|r| !matches!(r.anchor, super::description::Anchor::Object(_)));
            self.add(&Description {
                foreground: vec![spec],
                ..Description::default()
            });
        }
    }

    fn replace(&mut self, id: BoxId, c: &Command) {
        let (Some(b), Some(by)) = (self.boxes.get(&id).copied(), &c.by) else {
            self.note(format!("{:?}: replaced by what?", c.text));
            return;
        };
        let Some(size) = by.spec.size_m.or(by.spec.class.typical_size_m()) else {
            return;
        };
        let size_m = DVec3::from_array(size);
        let mut new = SceneBox {
            class: by.spec.class,
            size_m,
            center_m: b
                .center_m
                .truncate()
                .extend(b.center_m.z - b.size_m.z / 2.0 + size_m.z / 2.0),
            ..b
        };
        // A longer one may need a step along its course.
        let hits = |n: &SceneBox| {
            self.boxes
                .values()
                .any(|o| o.id != id && super::holds::overlap_m(n, o, 0.2) > 0.0)
                || super::holds::overlap_m(n, &ego(), 0.2) > 0.0
        };
        let steps = (0..40).map(|k| f64::from((k + 1) / 2) * if k % 2 == 0 { 0.5 } else { -0.5 });
        let start = new;
        for step in steps {
            let tried = SceneBox {
                center_m: start.center_m + (start.heading() * step).extend(0.0),
                ..start
            };
            if !hits(&tried) && tried.center_m.truncate().abs().max_element() < 38.0 {
                if step != 0.0 {
                    self.out.notes.push(format!(
                        "box {} stands {:.1} m further along, clear of others",
                        id.0,
                        step.abs()
                    ));
                }
                new = tried;
                break;
            }
        }
        if let Some(o) = self
            .boxes
            .values()
            .find(|o| o.id != id && super::holds::overlap_m(&new, o, 0.0) > 0.0)
        {
            self.out
                .notes
                .push(format!("the larger box {} now overlaps box {}", id.0, o.id.0));
        }
        self.push(TextEdit::Replace { id, object: new });
    }

    /// "make the bus red", "make the car a truck", "make the car stop", "make it five cones".
    fn make(&mut self, c: &Command) -> bool {
        if c.by.is_some() {
            if let Some(ids) = self.targets(c, false) {
                self.replace_all(&ids, c);
            }
            return true;
        }
        let Some(m) = c.targets.first() else {
            return false;
        };
        if m.spec.color.is_some() || c.color {
            self.note("boxes have no colour: nothing changes; pictures invent the colours of vehicles");
            return true;
        }
        if c.turn.is_some() {
            if let Some(ids) = self.targets(c, false) {
                ids.into_iter().for_each(|id| self.turn(id, c));
            }
            return true;
        }
        if let Some(state) = c.state {
            if let Some(ids) = self.targets(c, false) {
                for id in ids {
                    let Some(b) = self.boxes.get(&id).copied() else {
                        continue;
                    };
                    let speed = match (state, b.class) {
                        (ObjectState::Moving, Class::Pedestrian) => 1.4,
                        (ObjectState::Moving, _) => 8.0,
                        _ => 0.0,
                    };
                    let object = SceneBox {
                        velocity_mps: b.heading() * speed,
                        ..b
                    };
                    self.push(TextEdit::Replace { id, object });
                }
            }
            return true;
        }
        if !m.uncounted {
            self.keep(c);
            return true;
        }
        if c.destination.is_some() {
            if let Some(ids) = self.targets(c, false) {
                ids.into_iter().for_each(|id| self.shift(id, c));
            }
            return true;
        }
        false
    }
}

/// Left for right.
fn mirrored(r: &mut super::description::Stated) {
    use super::description::Anchor::Lane;
    if r.relation == RelationKind::LeftOf {
        r.relation = RelationKind::RightOf;
    }
    r.anchor = match r.anchor {
        Lane(LaneRole::LeftSidewalk) => Lane(LaneRole::RightSidewalk),
        Lane(LaneRole::LeftRoadside) => Lane(LaneRole::RightRoadside),
        Lane(LaneRole::Oncoming) => Lane(LaneRole::Ego),
        other => other,
    };
}

/// A graph node of a class, for callers that lock boxes.
pub fn node_of(class: Class) -> NodeKind {
    NodeKind::Object(ObjectNode::new(class))
}

/// The reading of a plain prompt, for callers that have one already.
pub fn is_style_only(reading: &Reading) -> bool {
    let d = &reading.description;
    d.foreground.is_empty() && d.absent.is_empty() && (d.time_of_day.is_some() || d.weather.is_some())
}

/// Relations that a destination may state.
pub(super) fn places_it(kind: RelationKind) -> bool {
    !matches!(
        kind,
        RelationKind::SameDirection | RelationKind::OppositeDirection
    )
}

/// Roles that "clear" may empty.
pub(super) fn clears(role: LaneRole) -> bool {
    role != LaneRole::Carpark
}
