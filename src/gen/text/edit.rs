//! Edits of an open scene by text. The output is plain data; the application turns it into its own edits. A target that
//! fits several boxes is asked back, never guessed.

use std::collections::BTreeMap;

use glam::{DVec2, DVec3};
use serde::Serialize;

use super::description::{Became, Description, Phrase, Reading, TimeOfDay, Unread, Weather};
use super::edit_grammar::{Back, Command, Destination, Reader};
use super::holds::in_role;
use super::lanes::LaneMap;
use super::mention::Mention;
use super::second_look::Done;
use super::select::{Candidate, Chosen, choose};
use super::tokens::{LONGEST, Span};
use super::words::edits::{Pick, Verb};
use crate::generation::words_background::edits::ThingEdit;
use crate::scene::graph::{LaneRole, NodeKind, ObjectNode, ObjectState, RelationKind};
use crate::scene::{BevLayout, BoxId, BoxLabel, Class, SceneBox};

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
    /// Names and paints a box.
    Label {
        /// Which.
        id: BoxId,
        /// Its name and paint from now on.
        label: BoxLabel,
    },
    /// Paints a pedestrian crossing.
    Crossing {
        /// Its corners, m.
        outline_m: Vec<DVec2>,
    },
    /// Takes a pedestrian crossing away.
    EraseCrossing {
        /// Its corners, m.
        outline_m: Vec<DVec2>,
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
    /// Changes of the background, in order.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub things: Vec<ThingEdit>,
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

pub(super) struct Editor<'a> {
    pub(super) map: LaneMap<'a>,
    pub(super) layout: &'a BevLayout,
    pub(super) boxes: BTreeMap<BoxId, SceneBox>,
    style: String,
    pub(super) definite: Vec<Span>, // what "the" was said of in the present command
    pub(super) picks: Vec<(Span, super::words::edits::Pick)>, // which of several an anchor is
    pub(super) seed: u64,
    pub(super) last: Vec<BoxId>,    // what was spoken of last
    part_of: Vec<BoxId>,            // those that the last ones were picked from
    pub(super) gone: Vec<SceneBox>, // what was taken away last
    all_gone: Vec<SceneBox>,        // what was taken away before
    gone_kind: Option<Class>,       // and of what class it was, also after something moved
    pub(super) left: Vec<SceneBox>, // where what was moved last had stood
    pub(super) out: EditReading,
}

/// Reads an edit text for a scene. Commands are carried out one after another, each on what the one before left.
/// Where it needs a crossing that the map does not have, one is put in.
pub fn read_edit(text: &str, scene: &OpenScene<'_>, seed: u64) -> EditReading {
    super::edit_crossing::with_crossing(text, scene, |scene| read_on(text, scene, seed)).unwrap_or_else(
        || {
            let mut reading = read_on(text, scene, seed);
            super::edit_crossing::without_crossing(text, scene, &mut reading);
            reading
        },
    )
}

fn read_on(text: &str, scene: &OpenScene<'_>, seed: u64) -> EditReading {
    let mut editor = Editor {
        map: LaneMap::new(scene.layout),
        layout: scene.layout,
        boxes: scene.boxes.clone(),
        style: scene.prompt.to_string(),
        definite: Vec::new(),
        picks: Vec::new(),
        seed,
        last: Vec::new(),
        part_of: Vec::new(),
        gone: Vec::new(),
        all_gone: Vec::new(),
        gone_kind: None,
        left: Vec::new(),
        out: EditReading::default(),
    };
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
    // Sentence by sentence: what is there when one is read is what those before have left.
    let mut reader = Reader::new(text);
    let mut done = 0;
    while let Some(mut commands) = reader.next(&editor.map, &editor.boxes, &editor.last) {
        // "keep the bus and remove the cars": among other commands that only says what stays
        let others =
            commands.iter().filter(|c| c.verb != Verb::Note).count() > 1 || done > 0 || !reader.ended();
        for c in commands.iter_mut().filter(|c| c.verb == Verb::Keep && others) {
            let counted = c.change.is_some() || c.targets.iter().any(|t| !t.uncounted);
            if !c.only && !counted && !c.targets.is_empty() {
                c.verb = Verb::Note;
            }
        }
        editor.settle(&mut commands);
        let only = reader.ended() && done == 0 && commands.len() == 1;
        for (i, command) in commands.iter().enumerate() {
            if done < MOST_COMMANDS {
                // (of the same words the last command tells whether all is done)
                let again = commands[i + 1..]
                    .iter()
                    .any(|o| o.span.start < command.span.end && command.span.start < o.span.end);
                let words = if only { text } else { command.span.of(text) };
                editor.read_command(text, (!again).then_some(words), done, command);
            }
            done += 1;
        }
    }
    if done > MOST_COMMANDS {
        editor.note(format!(
            "{done} commands were given: the first {MOST_COMMANDS} are carried out"
        ));
    }
    editor.out
}

/// The words of a command and three more: its span may leave out some at the end.
fn and_more(text: &str, span: Span) -> &str {
    let rest = text.get(span.end..).unwrap_or("");
    let more: usize = rest
        .split_inclusive(char::is_whitespace)
        .take(4)
        .map(str::len)
        .sum();
    let stop = rest[..more].find(['.', ';', '!', '?', ',']).unwrap_or(more);
    text.get(span.start..span.end + stop)
        .unwrap_or_else(|| span.of(text))
}

impl Editor<'_> {
    /// Carries out one command, looks at it again as its `words` stand in the text, if any, and reports it.
    fn read_command(&mut self, text: &str, words: Option<&str>, i: usize, command: &Command) {
        let before = self.out.edits.len();
        let asked = self.out.questions.len();
        let noted = self.out.notes.len();
        let scene = self.boxes.clone();
        let mut meaning = self.carry_out(command);
        let done = Done {
            edits: before..self.out.edits.len(),
            before: scene,
            asked: self.out.questions.len() > asked,
        };
        if let Some(did) =
            words.and_then(|words| self.look_again(words, and_more(text, command.span), command, &done))
        {
            // (what was not clear at first is done now)
            let settled = [
                "not everything said could be met",
                "was not understood",
                "was not clear",
                " is in the scene",
            ];
            let new = self.out.notes.split_off(noted);
            let stays = |n: &String| !settled.iter().any(|s| n.contains(s));
            self.out.notes.extend(new.into_iter().filter(stays));
            meaning = Some(meaning.map_or(did.to_string(), |m| format!("{m}, {did}")));
        }
        self.out
            .not_understood
            .extend(command.reading.not_understood.iter().cloned());
        let spelling = command
            .reading
            .notes
            .iter()
            .filter(|n| n.contains("was read as"))
            .cloned();
        self.out.notes.extend(spelling);
        let n = self.out.edits.len() - before;
        let meaning = match meaning {
            Some(m) => format!("{m}: {n} changes"),
            None if self.out.questions.len() > asked => "asked back".into(),
            None => "nothing".into(),
        };
        self.out.phrases.push(Phrase {
            span: command.span,
            text: command.span.of(text).to_string(),
            became: Became::Command(i),
            meaning,
        });
    }

    pub(super) fn push(&mut self, edit: TextEdit) {
        match &edit {
            TextEdit::Remove { id } => {
                let gone = self.boxes.remove(id);
                self.gone_kind = gone.map(|b| b.class);
                self.gone.extend(gone);
                self.all_gone.extend(gone);
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
                    self.left.push(*b);
                    let turn = yaw_rad - b.yaw_rad;
                    b.center_m = *center_m;
                    b.yaw_rad = *yaw_rad;
                    b.velocity_mps = DVec2::from_angle(turn).rotate(b.velocity_mps);
                }
            }
            TextEdit::Label { id, label } => {
                if let Some(b) = self.boxes.get_mut(id) {
                    b.label = *label;
                }
            }
            TextEdit::Style { prompt } => self.style.clone_from(prompt),
            TextEdit::Crossing { .. } | TextEdit::EraseCrossing { .. } => {}
        }
        self.out.edits.push(edit);
    }

    pub(super) fn note(&mut self, text: impl Into<String>) {
        self.out.notes.push(text.into());
    }

    /// Carries out one command; what it did in words, `None` if nothing.
    fn carry_out(&mut self, c: &Command) -> Option<String> {
        let mut done = Vec::new();
        self.definite.clone_from(&c.definite);
        self.picks.clone_from(&c.picks);
        if self.style_of(c) {
            done.push("style".to_string());
        }
        if !matches!(c.verb, Verb::Add | Verb::Note) {
            self.left.clear();
        }
        // ("take it away" again leaves what is gone as it was)
        let gone_before = match c.verb {
            Verb::Remove | Verb::Clear | Verb::Move => std::mem::take(&mut self.gone),
            _ => Vec::new(),
        };
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
                            .filter(|b| match role {
                                // (on a narrow street whoever drives is near its edge)
                                LaneRole::Roadside | LaneRole::LeftRoadside | LaneRole::RightRoadside => {
                                    let own = super::holds::role_of(&self.map, b);
                                    own == Some(role)
                                        || role == LaneRole::Roadside
                                            && matches!(
                                                own,
                                                Some(LaneRole::LeftRoadside | LaneRole::RightRoadside)
                                            )
                                }
                                _ => in_role(&self.map, role, b.center_m.truncate()),
                            })
                            .filter(|b| on_side(&c.text, role, b))
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
                if self.only_named(c) {
                    // ("move them" means those that were spoken of)
                    if let Some(m) = c.targets.first() {
                        let spoken = super::select::fitting(&self.map, &self.boxes, m, &c.mentions);
                        if !spoken.is_empty() {
                            self.last = spoken;
                        }
                    }
                    self.note(format!(
                        "{:?}: what should become of it was not understood",
                        c.text
                    ));
                    return (!done.is_empty()).then(|| done.join(", "));
                }
                let d = &c.reading.description;
                let there: Vec<BoxId> = self.last.clone();
                let there: Vec<BoxId> = there
                    .into_iter()
                    .filter(|id| self.boxes.contains_key(id))
                    .collect();
                if c.in_place {
                    self.named_spot(c);
                }
                let put = c.in_place.then(|| self.put_in_place(c)).flatten();
                let added = if let Some(put) = put {
                    if put {
                        done.push("moved".into());
                    }
                    false
                } else if c.in_place && !(self.gone.is_empty() && self.left.is_empty()) {
                    self.add_in_place(d)
                } else if c.in_place && !there.is_empty() {
                    self.replace_all(&there, c);
                    true
                } else {
                    let mut d = d.clone();
                    // "park a van next to her"
                    if let (Some(state), Some(first)) = (c.state, d.foreground.first_mut()) {
                        first.state.get_or_insert(state);
                    }
                    if let [only] = d.foreground.as_mut_slice() {
                        self.as_the_others(only, c);
                    }
                    self.add(&d)
                };
                if added {
                    done.push("added".into());
                }
                // ("neither cones nor anything else stands ahead of us" speaks of a place)
                let text = c.text.to_lowercase();
                let all = c.implied && c.reading.description.absent.iter().any(|a| a.classes.len() > 6);
                let placed = [" in ", " on ", " ahead", " behind", " left", " right"]
                    .iter()
                    .any(|w| text.contains(w));
                if all && placed {
                    self.note(format!("{:?}: what should go was not understood", c.text));
                } else if !c.reading.description.absent.is_empty() {
                    // ("a fence at the kerb instead of the barriers": the new one stays)
                    let new = if added { self.last.clone() } else { Vec::new() };
                    self.take_absent_but(&c.reading.description, &new);
                    done.push("removed".into());
                }
            }
            Verb::Keep => {
                self.keep(c);
                done.push("kept so many".into());
            }
            // "the truck waits 20 m behind us", where there is none: there is one now
            Verb::Move if self.tells_of_absent(c) => {
                if let (Some(Destination::Place(spec)), Some(m)) = (&c.destination, c.targets.first()) {
                    self.note(format!("no {} is in the scene: one is added", m.spec.noun));
                    let foreground = c.with_anchors(spec, spec.class);
                    if self.add(&Description {
                        foreground,
                        ..Description::default()
                    }) {
                        done.push("added".into());
                    }
                }
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
            // "the motorcycle is not required; replace it with a van": it is gone already
            Verb::Replace if self.replaces_gone(c) => {
                let by = c.by.iter().map(|m| m.spec.clone());
                let new = Description {
                    foreground: by.collect(),
                    ..Description::default()
                };
                if self.add_in_place(&new) {
                    done.push("added".into());
                }
            }
            Verb::Replace => {
                if let Some(ids) = self.targets(c, false) {
                    self.replace_all(&ids, c);
                    let moved = ids.iter().filter(|_| c.destination.is_some());
                    for id in moved
                        .filter(|id| self.boxes.contains_key(id))
                        .copied()
                        .collect::<Vec<_>>()
                    {
                        self.shift(id, c);
                    }
                    done.push("replaced".into());
                }
            }
            Verb::Swap => {
                if let Some(pair) = self.targets(c, true) {
                    match pair.as_slice() {
                        [a, b] => {
                            self.swap(*a, *b);
                            done.push("exchanged".into());
                        }
                        _ => self.note(format!("{:?}: which two change places was not clear", c.text)),
                    }
                }
            }
            // "why is the cyclist in front of me?": only what "he" will mean
            Verb::Note => {
                for m in &c.targets {
                    let chosen = match choose(&self.map, &self.boxes, m, &c.mentions) {
                        // ("one van stays where it is": whichever)
                        Chosen::Several { candidates, .. } if !m.definite && !m.uncounted => {
                            let ids = candidates.iter().map(|x| x.id);
                            Chosen::These(ids.take(m.spec.count.n as usize).collect())
                        }
                        other => other,
                    };
                    if let Chosen::These(ids) = chosen {
                        // "the other one" is of the same kind
                        self.part_of = self
                            .boxes
                            .values()
                            .filter(|b| m.classes.contains(&b.class))
                            .map(|b| b.id)
                            .collect();
                        self.last = ids;
                    }
                }
            }
            Verb::Paint => {
                if self.recolour(c) {
                    done.push("painted".into());
                }
            }
            Verb::Make => {
                // "the pickup has stopped for the night": it was spoken of
                if let Some(only) = c.targets.first()
                    && (c.targets.len() == 1 || c.implied)
                    && c.nth.is_none()
                    && let Chosen::These(ids) = choose(&self.map, &self.boxes, only, &c.mentions)
                {
                    self.last = ids;
                }
                if done.is_empty() && !self.make(c) {
                    self.note(format!("{:?}: what it should become was not understood", c.text));
                } else if done.is_empty() {
                    done.push("changed".into());
                }
            }
        }
        if self.gone.is_empty() && matches!(c.verb, Verb::Remove | Verb::Clear) {
            self.gone = gone_before;
        }
        (!done.is_empty()).then(|| done.join(", "))
    }

    /// "where the taxi was": of all that is gone, the taxi.
    fn named_spot(&mut self, c: &Command) {
        let words = super::tokens::tokens(&c.text);
        let text = |i: usize| words.get(i).map_or("", |t| t.text.as_str());
        let Some(i) =
            (0..words.len()).find(|i| text(*i) == "where" && matches!(text(i + 1), "the" | "my" | "that"))
        else {
            return;
        };
        let end = (i + 2..words.len()).find(|k| {
            matches!(
                text(*k),
                "was" | "were" | "stood" | "is" | "used" | "had" | "sat" | "waited" | "parked" | "drove"
            )
        });
        let np = &words[i + 1..end.unwrap_or(words.len())];
        let (_, mentions) = super::edit_command::parse(&c.text, &super::tag::tag(np));
        let Some(m) = mentions.first() else { return };
        let fit: Vec<&SceneBox> = self
            .all_gone
            .iter()
            .filter(|b| super::names::may_be(b, m))
            .collect();
        let spots: Vec<SceneBox> = super::names::called(fit, m).into_iter().copied().collect();
        if !spots.is_empty() {
            self.gone = spots;
            self.left.clear();
        }
    }

    /// True if a sentence tells in metres where something stands of which the scene has none.
    fn tells_of_absent(&self, c: &Command) -> bool {
        let ([m], Some(Destination::Place(spec))) = (c.targets.as_slice(), &c.destination) else {
            return false;
        };
        let measured = spec
            .relations
            .iter()
            .any(|r| r.distance_m.is_some() && r.anchor == super::description::Anchor::Ego);
        let words = c.text.to_lowercase();
        let states = ["the ", "my ", "our "].iter().any(|w| words.starts_with(w));
        let none = |m: &Mention| {
            matches!(choose(&self.map, &self.boxes, m, &c.mentions), Chosen::None(_))
                && !self.boxes.values().any(|b| m.classes.contains(&b.class))
        };
        states
            && measured
            && !m.plural
            && m.id.is_none()
            && m.pick.is_none()
            && c.back.is_none()
            && c.nth.is_none()
            && none(m)
    }

    /// True if what a command replaces was taken away just before.
    fn replaces_gone(&self, c: &Command) -> bool {
        let Some(m) = c
            .targets
            .first()
            .filter(|_| c.by.is_some() && c.targets.len() == 1)
        else {
            return false;
        };
        let gone = self.gone.iter().any(|b| m.classes.contains(&b.class));
        gone && super::select::fitting(&self.map, &self.boxes, m, &c.mentions).is_empty()
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
    pub(super) fn targets(&mut self, c: &Command, removing: bool) -> Option<Vec<BoxId>> {
        if let Some(found) = &c.found {
            let ids: Vec<BoxId> = found
                .iter()
                .filter(|id| self.boxes.contains_key(id))
                .copied()
                .collect();
            return (!ids.is_empty()).then_some(ids);
        }
        if let Some(back) = c.back {
            let ids: Vec<BoxId> = match back {
                Back::Same => self.last.clone(),
                Back::Others => {
                    let rest = self.part_of.iter().filter(|id| !self.last.contains(id));
                    let rest: Vec<BoxId> = rest.copied().filter(|id| self.boxes.contains_key(id)).collect();
                    // ("delete the car in front and let the other one fall back": of the kind that is gone)
                    let kind = self.gone_kind.filter(|_| rest.is_empty());
                    let alike = self
                        .boxes
                        .values()
                        .filter(|b| Some(b.class) == kind)
                        .map(|b| b.id);
                    rest.iter().copied().chain(alike).collect()
                }
                Back::Person => self.someone(),
            };
            let ids: Vec<BoxId> = ids.into_iter().filter(|id| self.boxes.contains_key(id)).collect();
            if ids.is_empty() {
                self.note(format!("{:?}: who is meant was not clear", c.text));
                return None;
            }
            return Some(ids);
        }
        if c.targets.is_empty() {
            self.note(format!("{:?}: what should change was not understood", c.text));
            return None;
        }
        let spared: Vec<BoxId> = c
            .except
            .iter()
            .flat_map(|m| match choose(&self.map, &self.boxes, m, &c.except) {
                Chosen::These(ids) => ids,
                _ => super::select::fitting(&self.map, &self.boxes, m, &c.except),
            })
            .collect();
        let mut all = Vec::new();
        for (k, mention) in c.targets.iter().enumerate() {
            let pair = c.verb == Verb::Replace && c.by.as_ref().is_some_and(|by| by.plural);
            if k > 0 && !removing && !c.each && !pair {
                break;
            }
            let chosen = match c.nth {
                Some(nth) => super::select::in_order(&self.map, &self.boxes, mention, &c.mentions, nth),
                None => choose(&self.map, &self.boxes, mention, &c.mentions),
            };
            match chosen {
                Chosen::These(ids) => {
                    if mention.pick == Some(Pick::Any) {
                        self.part_of = super::select::fitting(&self.map, &self.boxes, mention, &c.mentions);
                    }
                    all.extend(ids);
                }
                Chosen::None(what) => self.note(format!("no {what} is in the scene")),
                Chosen::TooFew { what, found, wanted } => {
                    self.note(format!("{wanted} {what} were named, {found} are in the scene"));
                }
                // Of several alike the one that was spoken of just before.
                Chosen::Several { ref candidates, .. }
                    if candidates.iter().filter(|x| self.last.contains(&x.id)).count() == 1 =>
                {
                    let recent = candidates.iter().map(|x| x.id);
                    all.extend(recent.filter(|id| self.last.contains(id)));
                }
                // ("but keep the black car" tells which of two is not meant)
                Chosen::Several { ref candidates, .. }
                    if !mention.plural
                        && candidates.iter().filter(|x| !spared.contains(&x.id)).count() == 1 =>
                {
                    let others = candidates.iter().map(|x| x.id);
                    all.extend(others.filter(|id| !spared.contains(id)));
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
        all.retain(|id| !spared.contains(id));
        // "remove everything else": but what was spoken of
        let others = |m: &Mention| m.plural && m.uncounted && m.spec.noun.starts_with("other ");
        if c.targets.iter().any(super::mention::means_all) && c.text.to_lowercase().contains(" else")
            || c.targets.iter().any(others)
        {
            all.retain(|id| !self.last.contains(id));
        }
        all.sort_unstable();
        all.dedup();
        // ("erase the other two": of those that were spoken of, never of all that is there)
        let words = c.text.to_lowercase();
        let few = [
            "the other two",
            "the other three",
            "the other four",
            "the other one",
        ];
        let few = few.iter().any(|w| words.contains(w)) || words.ends_with("the other");
        if few && c.targets.iter().any(others) && !self.last.is_empty() {
            let kinds: Vec<Class> = self
                .last
                .iter()
                .filter_map(|id| self.boxes.get(id))
                .map(|b| b.class)
                .collect();
            all.retain(|id| self.boxes.get(id).is_some_and(|b| kinds.contains(&b.class)));
            if all.is_empty() {
                self.note(format!("{:?}: which are meant was not clear", c.text));
            }
        }
        if !all.is_empty() {
            self.last.clone_from(&all);
        }
        (!all.is_empty()).then_some(all)
    }

    /// Whom "he" or "she" can mean where nobody was named: the only person, or the only rider.
    fn someone(&self) -> Vec<BoxId> {
        let alive = |id: &&BoxId| self.boxes.contains_key(id);
        let named: Vec<BoxId> = self.last.iter().filter(alive).copied().collect();
        if !named.is_empty() {
            return named;
        }
        let of = |list: &[Class]| -> Vec<BoxId> {
            let fit = self.boxes.values().filter(|b| list.contains(&b.class));
            fit.map(|b| b.id).collect()
        };
        [&[Class::Pedestrian][..], &[Class::Bicycle, Class::Motorcycle]]
            .into_iter()
            .map(of)
            .find(|ids| ids.len() == 1)
            .unwrap_or_default()
    }

    /// "three more cones": where the others are.
    fn as_the_others(&self, spec: &mut super::description::ObjectSpec, c: &Command) {
        let more = c.text.to_lowercase();
        let more = [
            "more",
            "another",
            "additional",
            "extra",
            "further",
            "a second",
            "a third",
            "a fourth",
            "a fifth",
            "a sixth",
        ]
        .iter()
        .any(|w| more.contains(w))
            || ["second ", "third ", "fourth ", "fifth "]
                .iter()
                .any(|w| more.starts_with(w))
            || c.targets.iter().any(|m| m.pick == Some(Pick::More));
        // ("on the sidewalk" is the one where they are)
        let strip = |r: &super::description::Stated| {
            let wide = [LaneRole::Sidewalk, LaneRole::Roadside];
            r.relation == RelationKind::On
                && wide
                    .iter()
                    .any(|w| r.anchor == super::description::Anchor::Lane(*w))
        };
        if more && spec.relations.iter().all(strip) {
            let alike: Vec<BoxId> = self
                .boxes
                .values()
                .filter(|b| b.class == spec.class)
                .map(|b| b.id)
                .collect();
            self.like_the_others(spec, &alike);
        }
    }

    pub(super) fn next_id(&self) -> BoxId {
        BoxId(
            self.boxes
                .keys()
                .next_back()
                .map_or(1, |id| id.0.saturating_add(1)),
        )
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
            // "the four people are friends of mine": a remark
            if c.implied && m.definite {
                return false;
            }
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

/// "the left side of the road" is half of it.
fn on_side(words: &str, role: LaneRole, b: &SceneBox) -> bool {
    let said = words.to_lowercase();
    match (role, said.contains("left"), said.contains("right")) {
        (LaneRole::Road, true, false) => b.center_m.y > 1.0,
        (LaneRole::Road, false, true) => b.center_m.y < -1.0,
        _ => true,
    }
}
