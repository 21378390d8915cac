//! The plan that a prompt became, to be edited before a scene is made of it or in the open scene: chips that can be
//! locked, re-rolled or given another number; the scene graph; variants side by side.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::mpsc::{Receiver, channel};
use std::sync::{Arc, Mutex};

use egui::accesskit::Role;
use egui::{Sense, Ui, WidgetInfo, vec2};

use super::graph;
use super::recalled::{Recall, Recalled};
use crate::command::Command;
use crate::prompting::{Ask, Diffused, How, Keep, Laid, PlacementMethod, Remembered};
use editor::Edit;
use language::{t, tf};
use place::description::Description;
use place::to_graph::{Graphed, to_graph};
use runtime::guard::Panicked;
use widgets::theme;
use widgets::thumbnail;

use scene::{BoxId, Scene, SceneBox};

/// Number of variants side by side.
const VARIANTS: u64 = 4;

/// Origin of the last scene from words, reported by the thread that made it.
#[derive(Clone, Debug, Default)]
pub struct PromptOrigin(Arc<Mutex<Option<WhatWasTold>>>);

/// Details filled in from memory, boxes placed by the network, and notes about shortfalls.
type WhatWasTold = (
    Option<(Remembered, Option<Recalled>)>,
    Option<Diffused>,
    Vec<String>,
);

impl PromptOrigin {
    /// Reports how a layout was made.
    pub fn tell(&self, laid: &Laid) {
        let mut notes = laid.notes.clone();
        notes.extend(crate::text::shortfalls(laid));
        let recalled = |found: Remembered| {
            let picture = Recalled::from_retrieval(&found);
            (found, picture)
        };
        let remembered = laid.remembered.clone().map(recalled);
        if let Ok(mut told) = self.0.lock() {
            *told = Some((remembered, laid.diffused.clone(), notes));
        }
    }

    fn show(&self, ui: &mut Ui) {
        let Ok(told) = self.0.lock() else {
            return;
        };
        let Some((remembered, diffused, notes)) = &*told else {
            return;
        };
        let weak = |ui: &mut Ui, text: String| {
            ui.label(egui::RichText::new(text).small().color(theme::text_weak()));
        };
        if let Some((found, picture)) = remembered {
            let filled = found.filled.join(", ");
            let text = match found.road {
                true => tf!("From memory, its road: {filled}", filled = filled),
                false => tf!("From memory: {filled}", filled = filled),
            };
            weak(ui, text);
            if let Some(picture) = picture {
                picture.show(ui, t("This scene was filled in from"));
            }
        }
        if let Some(d) = diffused {
            weak(
                ui,
                tf!(
                    "Diffusion took {time} s; the projection moved boxes by {mean} m on average, {most} m at most; {n} were placed by rules.",
                    time = format!("{:.2}", d.report.diffusion_s),
                    mean = format!("{:.1}", d.mean_move_m),
                    most = format!("{:.1}", d.most_move_m),
                    n = d.by_rules
                ),
            );
        }
        for note in notes {
            ui.label(egui::RichText::new(t(note)).small().color(theme::warn()));
        }
    }
}

#[derive(Clone, Copy, Debug, Default, PartialEq)]
enum Stays {
    #[default]
    Nothing,
    Road,
    Objects,
}

struct Variants {
    of: Ask,
    coming: Receiver<Result<(u64, Laid), Panicked>>,
    found: BTreeMap<u64, Laid>,
    /// Why there are no more variants.
    problem: Option<String>,
}

/// Settings for a new scene besides the words.
#[derive(Default)]
pub struct PromptPlan {
    placer: PlacementMethod,
    memory: bool,
    stays: Stays,
    prompt: String,
    graphed: Option<Graphed>,    // edited by hand
    locked: BTreeSet<usize>,     // objects of the description
    made: Option<(String, u64)>, // the words and the seed that the open scene was made of
    rolls: u64,
    variants: Option<Variants>,
    recall: Recall,
    told: PromptOrigin,
}

impl PromptPlan {
    /// Cell in which the thread that makes a scene reports how its layout was made.
    pub fn told(&self) -> PromptOrigin {
        self.told.clone()
    }

    /// Drops the settings that belonged to other words.
    pub fn follow(&mut self, prompt: &str) {
        if self.prompt != prompt {
            self.prompt = prompt.to_string();
            self.graphed = None;
            self.locked.clear();
            self.variants = None;
        }
    }

    fn how(&self, scene: &Scene) -> How {
        let frame = scene.frame();
        How {
            placer: self.placer,
            memory: self.memory,
            keep: match self.stays {
                Stays::Nothing => Keep::Nothing,
                Stays::Road => Keep::Road(Arc::new(frame.layout.clone())),
                Stays::Objects => Keep::Objects(Arc::new(frame.boxes.clone())),
            },
            ..How::default()
        }
    }

    /// The request for a scene of these words. If the open scene was made of the same words, locked objects keep their
    /// places, and the road stays with them.
    pub fn ask(&mut self, prompt: &str, read: &Description, seed: u64, scene: &Scene) -> Ask {
        self.follow(prompt);
        let description = read.clone();
        let mut how = self.how(scene);
        if let Some((of, made_seed)) = &self.made
            && *of == prompt
            && !self.locked.is_empty()
        {
            let nodes = to_graph(&description, *made_seed).nodes;
            let boxes = &scene.frame().boxes;
            how.locked = self
                .locked
                .iter()
                .flat_map(|i| nodes.get(*i).into_iter().flatten())
                .filter_map(|id| boxes.get(&BoxId(*id)).map(|b| (*id, *b)))
                .collect();
            if how.keep == Keep::Nothing {
                how.keep = Keep::Road(Arc::new(scene.frame().layout.clone()));
            }
        }
        Ask {
            prompt: prompt.to_string(),
            description,
            graphed: self.graphed.clone(),
            seed,
            how,
        }
    }

    /// True if the last scene from words was made of this prompt.
    pub fn made_of(&self, prompt: &str) -> bool {
        self.made.as_ref().is_some_and(|(of, _)| of == prompt)
    }

    /// Notes that a scene is made of this prompt.
    pub fn makes(&mut self, prompt: &str, seed: u64) {
        self.made = Some((prompt.to_string(), seed));
    }

    /// Draws the switches: placer, memory, and the part of the open scene that stays.
    pub fn switches(&mut self, ui: &mut Ui) {
        let mut diffusion = self.placer == PlacementMethod::Diffusion;
        let said = t(
            "Boxes by the layout network and a projection; off: by rules, which keep to the words more exactly",
        );
        if ui
            .checkbox(&mut diffusion, t("Diffusion"))
            .on_hover_text(said)
            .changed()
        {
            self.placer = if diffusion {
                PlacementMethod::Diffusion
            } else {
                PlacementMethod::Rules
            };
            self.variants = None;
        }
        let said = t("What the words leave open comes from the nearest remembered scenes");
        if ui
            .checkbox(&mut self.memory, t("Memory"))
            .on_hover_text(said)
            .changed()
        {
            self.variants = None;
        }
        let name = |s: Stays| match s {
            Stays::Nothing => t("keep nothing"),
            Stays::Road => t("keep the road"),
            Stays::Objects => t("keep the objects"),
        };
        let combo = egui::ComboBox::from_id_salt("what stays")
            .selected_text(name(self.stays))
            .show_ui(ui, |ui| {
                for s in [Stays::Nothing, Stays::Road, Stays::Objects] {
                    if ui.selectable_value(&mut self.stays, s, name(s)).changed() {
                        self.variants = None;
                    }
                }
            });
        combo.response.widget_info(|| {
            WidgetInfo::labeled(Role::ComboBox, true, t("What of this scene a new one keeps"))
        });
    }

    /// Draws the chip of an object with its menu: number, lock, other place. Commands change the open scene. Returns
    /// the new number if the user chose one.
    pub fn object_menu(
        &mut self,
        ui: &mut Ui,
        objects: &[usize],
        text: &str,
        scene: &Scene,
        read: &Description,
        commands: &mut Vec<Command>,
    ) -> Option<u32> {
        let prompt = self.prompt.clone();
        // (the first object is the one that was named; the others are its anchors, or more of it in a row)
        let first = *objects.first()?;
        let class = read.foreground.get(first)?.class;
        let alike = objects
            .iter()
            .filter_map(|i| read.foreground.get(*i))
            .filter(|o| o.class == class);
        let count = match read.foreground.get(first)?.count.n {
            1 => alike.map(|o| o.count.n).sum(),
            n => n,
        };
        let mut wanted = None;
        let locked = self.locked.contains(&first);
        let mut shown = text.to_string();
        if locked {
            shown = tf!("{things} (locked)", things = shown);
        }
        let here = self.made.as_ref().is_some_and(|(of, _)| *of == prompt);
        let response = widgets::chip::menu(ui, &shown, |ui| {
            ui.horizontal(|ui| {
                ui.label(t("Number"));
                let mut n = count;
                let drag = ui.add(egui::DragValue::new(&mut n).range(0..=count.max(60)));
                drag.widget_info(|| {
                    WidgetInfo::labeled(Role::SpinButton, true, tf!("Number of {things}", things = text))
                });
                if n != count {
                    wanted = Some(n);
                }
            });
            let mut lock = locked;
            let said = t("A re-roll or another seed leaves these where they are");
            if ui
                .add_enabled(here, egui::Checkbox::new(&mut lock, t("Lock")))
                .on_hover_text(said)
                .changed()
            {
                for i in objects {
                    if lock {
                        self.locked.insert(*i);
                    } else {
                        self.locked.remove(i);
                    }
                }
            }
            let again = ui
                .add_enabled(here && !locked, egui::Button::new(t("Re-roll these")))
                .on_hover_text(t("Other places for these; all else stays"));
            if again.clicked() {
                commands.extend(self.roll(objects, scene, read));
                ui.close();
            }
            if !here {
                ui.label(
                    egui::RichText::new(t("after New scene"))
                        .small()
                        .color(theme::text_weak()),
                );
            }
        });
        let label = tf!("Change {what}", what = text);
        response.widget_info(|| WidgetInfo::labeled(Role::Button, true, &label));
        wanted
    }

    /// Moves some objects of the open scene to other places, as one undo step.
    fn roll(&mut self, objects: &[usize], scene: &Scene, read: &Description) -> Option<Command> {
        let (prompt, made_seed) = self.made.clone()?;
        self.follow(&prompt);
        let description = read.clone();
        let graphed = self
            .graphed
            .clone()
            .unwrap_or_else(|| to_graph(&description, made_seed));
        let open: BTreeSet<u32> = objects
            .iter()
            .flat_map(|i| graphed.nodes.get(*i).into_iter().flatten().copied())
            .collect();
        self.roll_nodes(&open, graphed, description, scene)
    }

    fn roll_nodes(
        &mut self,
        open: &BTreeSet<u32>,
        graphed: Graphed,
        description: Description,
        scene: &Scene,
    ) -> Option<Command> {
        self.rolls += 1;
        let frame = scene.frame();
        let nodes: BTreeSet<u32> = graphed.graph.objects().map(|o| o.0).collect();
        let locked: BTreeMap<u32, SceneBox> = frame
            .boxes
            .values()
            .filter(|b| nodes.contains(&b.id.0) && !open.contains(&b.id.0))
            .map(|b| (b.id.0, *b))
            .collect();
        let how = How {
            placer: self.placer,
            keep: Keep::Road(Arc::new(frame.layout.clone())),
            others: frame
                .boxes
                .values()
                .filter(|b| !nodes.contains(&b.id.0))
                .copied()
                .collect(),
            locked,
            ..How::default()
        };
        let ask = Ask {
            prompt: self.prompt.clone(),
            description,
            graphed: Some(graphed),
            seed: self.rolls.wrapping_mul(7919),
            how,
        };
        let laid = ask.lay_out();
        self.told.tell(&laid);
        let mut edits = Vec::new();
        for b in laid.placement.boxes.iter().filter(|b| open.contains(&b.id.0)) {
            if frame.boxes.contains_key(&b.id) {
                edits.push(Edit::MoveBox {
                    id: b.id,
                    center_m: Some(b.center_m),
                    yaw_deg: Some(b.yaw_rad.to_degrees()),
                    size_m: None,
                });
            }
        }
        (!edits.is_empty()).then_some(Command::Apply("Re-roll", edits))
    }

    /// Starts a thread that lays out the variants.
    fn start_variants(&mut self, ask: &Ask, ctx: &egui::Context) {
        let (send, coming) = channel();
        let (work, wake) = (ask.clone(), ctx.clone());
        let (tell, wake_last) = (send.clone(), wake.clone());
        let lay_out = move || {
            for k in 0..VARIANTS {
                let ask = Ask {
                    seed: work.seed.wrapping_add(k),
                    ..work.clone()
                };
                // The receiver is gone once other variants are asked for.
                if send.send(Ok((ask.seed, ask.lay_out()))).is_err() {
                    break;
                }
                wake.request_repaint();
            }
        };
        let thread = runtime::guard::spawn("variants", lay_out, move |ended| {
            if let Err(panic) = ended {
                let _ = tell.send(Err(panic));
                wake_last.request_repaint();
            }
        });
        self.variants = Some(Variants {
            of: ask.clone(),
            coming,
            found: BTreeMap::new(),
            problem: thread.err().map(|e| format!("the system gives no thread: {e}")),
        });
    }

    /// Seed of the first variant that arrives.
    #[cfg(test)]
    pub(super) fn first_variant(&mut self, ask: &Ask) -> Result<u64, String> {
        self.start_variants(ask, &egui::Context::default());
        let Some(variants) = &self.variants else {
            return Err("no variants were begun".into());
        };
        match variants.coming.recv() {
            Ok(came) => came.map(|(seed, _)| seed).map_err(|panic| panic.to_string()),
            Err(_) => Err("the thread ended without an answer".into()),
        }
    }

    /// Draws the variants. Returns the seed of the chosen one.
    pub fn variants(&mut self, ui: &mut Ui, ask: &Ask) -> Option<u64> {
        let mut chosen = None;
        let button = ui
            .button(t("Variants"))
            .on_hover_text(t("Four layouts of these words, side by side; a click takes one"));
        if button.clicked() {
            self.start_variants(ask, ui.ctx());
        }
        let Some(variants) = &mut self.variants else {
            return None;
        };
        for came in variants.coming.try_iter() {
            match came {
                Ok((seed, laid)) => drop(variants.found.insert(seed, laid)),
                Err(panic) => variants.problem = Some(panic.to_string()),
            }
        }
        if let Some(problem) = &variants.problem {
            let text = tf!("No more variants: {problem}", problem = problem);
            ui.label(egui::RichText::new(text).small().color(theme::warn()));
        }
        // Square, like the map.
        let width = ((ui.available_width() - 8.0) / 2.0).clamp(80.0, 260.0);
        let first = variants.of.seed;
        for pair in 0..VARIANTS / 2 {
            ui.horizontal(|ui| {
                for k in [2 * pair, 2 * pair + 1] {
                    let seed = first.wrapping_add(k);
                    let (rect, response) = ui.allocate_exact_size(vec2(width, width), Sense::click());
                    let name = tf!("Variant of seed {seed}", seed = seed);
                    response.widget_info(|| WidgetInfo::labeled(Role::Button, true, &name));
                    let fill = if response.hovered() {
                        theme::field_hover()
                    } else {
                        theme::well()
                    };
                    ui.painter().rect_filled(rect, theme::RADIUS, fill);
                    match variants.found.get(&seed) {
                        Some(laid) => thumbnail::scene(ui, rect, &laid.road.layout, &laid.placement.boxes),
                        None => {
                            ui.painter().text(
                                rect.center(),
                                egui::Align2::CENTER_CENTER,
                                "...",
                                egui::FontId::proportional(12.0),
                                theme::text_weak(),
                            );
                        }
                    }
                    ui.painter().text(
                        rect.left_bottom() + vec2(4.0, -3.0),
                        egui::Align2::LEFT_BOTTOM,
                        tf!("seed {n}", n = seed),
                        egui::FontId::proportional(10.0),
                        theme::text_weak(),
                    );
                    widgets::icons::focus_ring(ui, &response, rect);
                    if let Some(laid) = variants.found.get(&seed) {
                        let boxes = &laid.placement.boxes;
                        thumbnail::enlarged(
                            &response,
                            &laid.road.layout,
                            boxes,
                            t("A click makes this scene"),
                        );
                    }
                    if response.clicked() {
                        chosen = Some(seed);
                    }
                }
            });
        }
        chosen
    }

    /// Draws the remembered scene that is nearest to the words, while memory is on.
    pub fn recalled(&mut self, ui: &mut Ui, ask: &Ask) {
        if self.memory {
            self.recall.show(ui, ask);
        }
    }

    /// Draws how the last scene was made.
    pub fn origin(&self, ui: &mut Ui) {
        self.told.show(ui);
    }

    /// Draws the scene graph, which can be edited. Returns true if it is to be placed again.
    pub fn graph(
        &mut self,
        ui: &mut Ui,
        description: &Description,
        seed: u64,
        scene: &Scene,
        commands: &mut Vec<Command>,
    ) -> bool {
        let mut place = false;
        egui::CollapsingHeader::new(t("Scene graph"))
            .id_salt("scene graph")
            .default_open(false)
            .show(ui, |ui| {
                let before = self
                    .graphed
                    .clone()
                    .unwrap_or_else(|| to_graph(description, seed));
                let mut graphed = before.clone();
                graph::picture(ui, &graphed.graph);
                let rolled = graph::nodes(ui, &mut graphed, self.made.is_some());
                graph::edges(ui, &mut graphed.graph);
                if graphed != before {
                    self.graphed = Some(graphed.clone());
                    self.variants = None;
                }
                if let Some(id) = rolled {
                    let ids = BTreeSet::from([id]);
                    commands.extend(self.roll_nodes(&ids, graphed.clone(), description.clone(), scene));
                }
                ui.horizontal(|ui| {
                    let button = ui
                        .button(t("Place this graph"))
                        .on_hover_text(t("A new scene of these nodes and relations"));
                    place = button.clicked();
                    let edited = self.graphed.is_some();
                    if ui
                        .add_enabled(edited, egui::Button::new(t("As the words say")))
                        .clicked()
                    {
                        self.graphed = None;
                    }
                });
                if let Some(problem) = graphed.graph.problem() {
                    ui.label(egui::RichText::new(problem).color(theme::warn()));
                    place = false;
                }
            });
        place
    }
}
