//! Staged results: a result that the user requested waits for a verdict: accept, decline, or accept a part. Meanwhile
//! it is shown beside the state before.

use std::sync::Arc;

use egui::{Align2, Order, Rect, RichText, Ui};

use super::app::SceneloomApp;
use super::toasts::MessageLevel;
use crate::command::{Command, GenerationCommand, StagedPart, Verdict};
use crate::panes::camera_strip::thousands;
use crate::panes::compare::CompareMode;
use crate::scenery::{SceneryWish, TYPICAL_BUILDING, TYPICAL_VEGETATION};
use crate::tools::{Hand, ToolState};
use authoring::whole::{leaves_place_open, scenery_first};
use editor::checks::{Finding, Severity};
use editor::part::{AcceptedPart, changed_by_class};
use job::inpaint::InpaintMask;
use job::{GenParams, RegionMode};
use language::{t, tf};
use scene::background::in_extent;
use scene::raster::box_cells;
use scene::{Background, Class, Scene, SceneRev, Thing};
use widgets::theme;

/// Most classes in the menu of parts.
const MOST_CLASSES: usize = 8;

/// How a result can be made again.
#[derive(Clone, Debug, PartialEq)]
pub enum Again {
    /// By the networks, with these parameters.
    Generate(Box<GenParams>),
    /// By drawing scenery.
    Scenery(Box<SceneryWish>),
}

impl Again {
    /// The seed of the result.
    pub fn seed(&self) -> u64 {
        match self {
            Self::Generate(params) => params.seed,
            Self::Scenery(wish) => wish.seed,
        }
    }
}

/// A result that waits for a verdict. Further edits without a verdict accept it.
pub struct Staged {
    /// The state with the result.
    pub rev: SceneRev,
    /// The state before, one undo step back.
    pub before: Arc<Scene>,
    /// How to make it again with another seed; `None` if another seed gives the same result.
    pub again: Option<Again>,
    changed: Vec<(Class, usize)>,
    /// For a forecast: the added time, s, and the number of objects that go on.
    longer: Option<(f64, usize)>,
    compare: CompareMode, // the user's mode, before both states were shown
}

/// Id of the bar of the staged result.
pub(super) fn bar_id() -> egui::Id {
    egui::Id::unique("staged")
}

impl SceneloomApp {
    /// Stages the present state, which is one step after `before`. If another seed can give another result, both states
    /// are compared with a wipe.
    pub(crate) fn stage(&mut self, before: Arc<Scene>, again: Option<Again>) {
        self.end_staging();
        let after = self.document.settled_scene();
        let occupancy = |scene: &Scene| scene.frame().occupancy.clone();
        let changed = changed_by_class(&occupancy(&before), &occupancy(after));
        if changed.is_empty() {
            return;
        }
        let beside = again.is_some();
        let staged = Staged {
            rev: after.content(),
            before: before.clone(),
            again,
            changed,
            longer: None,
            compare: self.state.compare.mode,
        };
        if beside {
            self.views.compare.chosen = Some(before);
            if self.state.compare.mode == CompareMode::Off {
                self.state.compare.mode = CompareMode::Wipe;
            }
        }
        self.generation.staged = Some(staged);
    }

    /// Stages the present state, which is a forecast of `before`.
    pub(crate) fn stage_forecast(&mut self, before: Arc<Scene>, objects: usize) {
        self.end_staging();
        let after = self.document.settled_scene();
        let longer_s = after.clip().length_s - before.clip().length_s;
        self.generation.staged = Some(Staged {
            rev: after.content(),
            before,
            again: None,
            changed: Vec::new(),
            longer: Some((longer_s, objects)),
            compare: self.state.compare.mode,
        });
    }

    /// The staged result, if the document still shows it.
    pub fn staged(&self) -> Option<&Staged> {
        let rev = self.document.settled_scene().content();
        self.generation.staged.as_ref().filter(|s| s.rev == rev)
    }

    /// Forgets the staged result if another state is shown now.
    pub(crate) fn tidy_staging(&mut self) {
        if self.generation.staged.is_some() && self.staged().is_none() {
            self.end_staging();
        }
    }

    fn end_staging(&mut self) -> Option<Staged> {
        let staged = self.generation.staged.take()?;
        // A compare mode that the user chose meanwhile stays.
        if staged.again.is_some() && self.state.compare.mode == CompareMode::Wipe {
            self.state.compare.mode = staged.compare;
        }
        self.views.compare.chosen = None;
        Some(staged)
    }

    /// Carries out the verdict of the user. Has no effect without a staged result.
    pub(crate) fn decide(&mut self, verdict: Verdict) {
        if self.staged().is_none() || self.document.is_dragging() {
            return;
        }
        match verdict {
            Verdict::Accept => drop(self.end_staging()),
            Verdict::Decline => {
                self.step_back();
            }
            Verdict::NextSeed => self.next_seed(),
            Verdict::Take(taken) => self.take_part(taken),
        }
    }

    fn next_seed(&mut self) {
        let Some(again) = self.staged().and_then(|s| s.again.clone()) else {
            return;
        };
        let Some(before) = self.step_back() else { return };
        match again {
            Again::Generate(mut params) => {
                params.seed = params.seed.wrapping_add(1);
                // The field shows the seed in use.
                self.state.seed.value = self.state.seed.value.map(|_| params.seed);
                if self.draws_scenery_first() && params.region == RegionMode::Full {
                    return self.generate_on_scenery(*params);
                }
                let now_s = self.now_s();
                self.generation.live.touched_by(&before, now_s);
                self.submit(before, *params);
            }
            Again::Scenery(mut wish) => {
                wish.seed = wish.seed.wrapping_add(1);
                self.put_scenery(*wish, true);
            }
        }
    }

    /// True for a scene that does not set its kind of place. Its scenery is drawn first, because scenery from the
    /// networks alone is ragged.
    pub(crate) fn draws_scenery_first(&self) -> bool {
        leaves_place_open(self.document.settled_scene()) && !self.state.tools.things.locked
    }

    /// Draws scenery with the seed of `params` and generates on it, as one undo step.
    pub(crate) fn generate_on_scenery(&mut self, params: GenParams) {
        let before = self.document.settled_scene().clone();
        let edits = match scenery_first(&before, &params) {
            Ok(edits) => edits,
            Err(error) => return self.fail(tf!("No scenery was drawn: {error}", error = error)),
        };
        self.apply("Generate", &edits);
        let scene = self.document.settled_scene().clone();
        self.generation.drawn_first =
            (scene.content() != before.content()).then(|| (scene.content(), before));
        let now_s = self.now_s();
        self.generation.live.touched_by(&scene, now_s);
        self.submit(scene, params);
    }

    /// Removes scenery that was drawn for a generation that did not finish.
    pub(crate) fn take_scenery_back(&mut self) {
        if let Some((rev, _)) = self.generation.drawn_first.take()
            && rev == self.document.settled_scene().content()
        {
            self.document.undo();
        }
    }

    /// Regenerates the scenery beside the roads, in the marked region or everywhere.
    pub(crate) fn draw_scenery(&mut self) {
        if self.document.is_dragging() {
            return;
        }
        self.state.tools.scenery_draws += 1;
        let mut seed = self.document.settled_scene().seed;
        seed = seed.wrapping_add(self.state.tools.scenery_draws);
        // A staged result is replaced.
        if let Some(Again::Scenery(waits)) = self.staged().and_then(|s| s.again.clone()) {
            seed = waits.seed.wrapping_add(1);
            self.step_back();
        }
        // The sliders' typical values stand for a factor of 1.
        let times = |named: Option<f32>, typical: f64| named.map_or(1.0, |v| f64::from(v) / typical);
        let wish = SceneryWish {
            seed,
            by: self.state.tools.drawer,
            green: times(self.state.named.vegetation, TYPICAL_VEGETATION),
            built: times(self.state.named.building, TYPICAL_BUILDING),
            region: self.state.tools.region.clone(),
        };
        self.put_scenery(wish, true);
    }

    /// Goes back to the state before the staged result, and returns it.
    fn step_back(&mut self) -> Option<Arc<Scene>> {
        let staged = self.end_staging()?;
        self.generation.worker.cancel();
        self.document.undo();
        self.generation.live.source_changed();
        Some(staged.before)
    }

    fn take_part(&mut self, taken: StagedPart) {
        if let Some(Again::Scenery(wish)) = self.staged().and_then(|s| s.again.clone()) {
            // A thing is accepted whole or not at all.
            let region = self.state.tools.region.clone();
            if self.step_back().is_some() {
                self.put_scenery(SceneryWish { region, ..*wish }, false);
            }
            return;
        }
        let after = self.document.settled_scene().clone();
        let part = match taken {
            StagedPart::Class(class) => AcceptedPart::Class(class),
            StagedPart::Region => {
                AcceptedPart::Columns(self.state.tools.region.columns(after.frame().extent()))
            }
            StagedPart::Chosen => AcceptedPart::Columns(columns_chosen(&self.state.tools, &after)),
        };
        let Some(staged) = self.staged() else { return };
        let old = &staged.before.frame().occupancy;
        let mixed = part.taken(old, &after.frame().occupancy);
        if old.count_different(&mixed) == 0 {
            let now_s = self.now_s();
            let text = t("Nothing of the new result lies there");
            return self.toasts.push(MessageLevel::Info, text, now_s);
        }
        let things = part_of_things(&staged.before, &after, &part);
        if let Some(before) = self.step_back()
            && self
                .document
                .adopt_with_things("Accept a part", before.content(), mixed, things)
                .is_ok()
        {
            let scene = self.document.settled_scene().clone();
            self.generation
                .versions
                .push("Accept a part".to_owned(), String::new(), scene);
            self.state.tools.region = InpaintMask::default();
        }
    }

    /// Draws the bar of the staged result, over the lower edge of `over`.
    pub(crate) fn staged_ui(&self, ui: &Ui, over: Rect, commands: &mut Vec<Command>) {
        let Some(staged) = self.staged() else { return };
        let area = egui::Area::new(bar_id())
            .order(Order::Middle)
            .pivot(Align2::CENTER_BOTTOM)
            .fixed_pos(over.center_bottom() + egui::vec2(0.0, -12.0));
        area.show(ui.ctx(), |ui| {
            theme::dialog_frame(ui.style()).show(ui, |ui| {
                if let Some((longer_s, _)) = staged.longer {
                    let from_s = self.document.scene().clip().length_s - longer_s;
                    self.faults_after(ui, from_s);
                }
                bar(ui, staged, &self.state.tools, commands);
            });
        });
    }
}

impl SceneloomApp {
    /// Draws the first error that the checks found from a time on, and the number of further ones.
    fn faults_after(&self, ui: &mut Ui, from_s: f64) {
        let Some(findings) = self.threads.checking.findings() else {
            return;
        };
        let later = |f: &&Finding| f.severity == Severity::Error && f.time_s.is_some_and(|t| t >= from_s);
        let mut faults = findings.iter().filter(later);
        if let Some(first) = faults.next() {
            let more = faults.count();
            let first = theme::sentence(t(&first.text));
            let text = if more > 0 {
                tf!("{finding}, and {n} more", finding = first, n = more)
            } else {
                first
            };
            ui.label(RichText::new(text).color(theme::bad()));
        }
    }
}

fn bar(ui: &mut Ui, staged: &Staged, tools: &ToolState, commands: &mut Vec<Command>) {
    let n: usize = staged.changed.iter().map(|(_, n)| n).sum();
    let seed = staged
        .again
        .as_ref()
        .map_or_else(String::new, |a| format!("  ·  {}", tf!("seed {n}", n = a.seed())));
    let of_things = matches!(staged.again, Some(Again::Scenery(_)));
    let text = match staged.longer.map(|(s, objects)| (format!("{s:.1}"), objects)) {
        Some((longer, 0)) => tf!("Forecast: {seconds} s more, we drive on", seconds = longer),
        Some((longer, 1)) => tf!("Forecast: {seconds} s more, 1 object goes on", seconds = longer),
        Some((longer, objects)) => tf!(
            "Forecast: {seconds} s more, {n} objects go on",
            seconds = longer,
            n = objects,
        ),
        None => format!("{}{seed}", tf!("New result: {n} voxels differ", n = thousands(n))),
    };
    ui.label(RichText::new(text).color(theme::text_strong()));
    let mut decide = |clicked: bool, verdict| {
        if clicked {
            commands.push(Command::Generation(GenerationCommand::Decide(verdict)));
        }
    };
    let mut mark = false;
    ui.horizontal(|ui| {
        let accept = egui::Button::new(t("Accept")).fill(theme::accent_fill());
        let accept = ui
            .add(accept)
            .on_hover_text(t("Keep it. Any further edit does so too"));
        decide(accept.clicked(), Verdict::Accept);
        let decline = ui.button(t("Decline")).on_hover_text(t("Back to what was there"));
        decide(decline.clicked(), Verdict::Decline);
        if staged.again.is_some() {
            let next = ui
                .button(t("Next seed"))
                .on_hover_text(t("Another one in its place"));
            decide(next.clicked(), Verdict::NextSeed);
        }
        if staged.longer.is_some() {
            return;
        }
        ui.menu_button(t("Accept a part"), |ui| {
            let mut entry = |ui: &mut Ui, enabled, text: &str, taken| {
                let clicked = ui.add_enabled(enabled, egui::Button::new(text)).clicked();
                decide(clicked, Verdict::Take(taken));
            };
            let marked = !tools.region.is_empty();
            entry(ui, marked, t("In the marked region"), StagedPart::Region);
            mark = ui
                .button(t("Mark a region…"))
                .on_hover_text(t("Rectangle, lasso or brush in the bird's-eye view"))
                .clicked();
            if of_things {
                return;
            }
            entry(
                ui,
                tools.any_chosen(),
                t("Where chosen boxes and things stand"),
                StagedPart::Chosen,
            );
            ui.separator();
            for (class, n) in staged.changed.iter().take(MOST_CLASSES) {
                let text = tf!(
                    "Only {class}, {n} voxels",
                    class = t(&class.label().to_lowercase()),
                    n = thousands(*n),
                );
                entry(ui, true, &text, StagedPart::Class(*class));
            }
        })
        .response
        .on_hover_text(t("The rest stays as it was"));
    });
    if mark {
        commands.push(Command::Tool(editor::tools::region::ID));
    }
}

/// The things of `before`, and the new things that lie completely in the part.
fn part_of_things(before: &Scene, after: &Scene, part: &AcceptedPart) -> Background {
    let taken = |thing: &&Thing| match part {
        AcceptedPart::Class(class) => thing.form.class() == *class,
        AcceptedPart::Columns(columns) => {
            let extent = after.frame().extent();
            let mut inside = true;
            authoring::scenery_around::columns(extent, &thing.form, 0.0, |x, y| {
                inside &= columns[extent.index(x, y)];
            });
            inside
        }
    };
    let new = |thing: &&Thing| before.background.get(thing.id).is_none();
    let came = after.background.iter().filter(new).filter(taken);
    before.background.iter().chain(came).cloned().collect()
}

/// Columns of chosen boxes and things, with a margin of one voxel.
fn columns_chosen(hand: &Hand, scene: &Scene) -> Vec<bool> {
    let frame = scene.frame();
    let extent = frame.extent();
    let mut columns = vec![false; extent.columns()];
    let mut set = |x: usize, y: usize| columns[extent.index(x, y)] = true;
    for b in hand.chosen().iter().filter_map(|id| frame.boxes.get(id)) {
        box_cells(extent, b, extent.voxel_m(), &mut set);
    }
    let things = hand.things.chosen.iter();
    let things = things.filter_map(|id| scene.background.get(*id));
    for thing in in_extent(extent, things) {
        authoring::scenery_around::columns(extent, &thing.form, extent.voxel_m(), &mut set);
    }
    columns
}
