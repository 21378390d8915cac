//! The window of batches: the queue, and the variants of one batch as small pictures that can be starred and discarded.

use std::collections::HashMap;
use std::path::PathBuf;

use egui::accesskit::Role;
use egui::{Color32, Rect, Sense, TextureHandle, TextureOptions, Ui, WidgetInfo, pos2, vec2};

use super::batch_plan::PlanForm;
use crate::batch::queue::{BatchState, Item, Priority, Queue};
use language::{t, tf};
use scene::{BoxId, Scene};
use widgets::{icons, theme};

/// Size of a small picture, points.
const PICTURE: egui::Vec2 = vec2(226.0, 81.0);
/// Height of the caption below it, with number, changes and star, points.
const CAPTION: f32 = 22.0;
/// Largest height of the window, points.
const HEIGHT: f32 = 640.0;
/// Most pictures read from disk in one frame.
const READ_AT_ONCE: usize = 6;
/// Most pictures kept in memory.
const MOST_PICTURES: usize = 400;

/// Input of the window.
pub struct BatchesInput<'a> {
    /// The open scene.
    pub scene: &'a Scene,
    /// The chosen object of the scene.
    pub chosen: Option<BoxId>,
    /// Names of the quality presets.
    pub qualities: &'a [String],
}

/// Request of the user.
pub enum BatchAction {
    /// Add the batch of the form.
    Add,
    /// Open a variant as a scene.
    Open(u64, usize),
    /// Star a variant, or take the star away.
    Star(u64, usize),
    /// Discard a variant, or take it back in.
    Discard(u64, usize),
}

/// Filter of the variants.
#[derive(Clone, Copy, Default, PartialEq)]
enum VariantFilter {
    #[default]
    All,
    Starred,
    Kept,
    Failed,
}

/// State of the window.
pub struct BatchesWindow {
    /// The form.
    pub form: PlanForm,
    /// True if the form is shown in place of a batch.
    pub is_new: bool,
    /// The batch whose variants are shown.
    pub chosen: Option<u64>,
    shown: VariantFilter,
    pictures: HashMap<PathBuf, Option<TextureHandle>>,
}

impl BatchesWindow {
    /// A window with the form, for a folder beside the scene's file.
    pub fn new(folder: &std::path::Path) -> Self {
        Self {
            form: PlanForm::new(folder),
            is_new: true,
            chosen: None,
            shown: VariantFilter::All,
            pictures: HashMap::new(),
        }
    }

    /// Draws the window. Returns the request of the user.
    pub fn ui(
        &mut self,
        ui: &Ui,
        queue: &mut Queue,
        input: &BatchesInput<'_>,
        open: &mut bool,
    ) -> Option<BatchAction> {
        let mut asked = None;
        egui::Window::new(t("Batches"))
            .id(egui::Id::unique("batches"))
            .open(open)
            .default_pos(egui::pos2(260.0, 90.0))
            .default_size([1010.0, HEIGHT])
            .max_height((ui.ctx().content_rect().height() - 120.0).min(HEIGHT))
            .show(ui.ctx(), |ui| {
                egui::Panel::left("batch queue")
                    .exact_size(240.0)
                    .resizable(false)
                    .show(ui, |ui| self.queue_ui(ui, queue));
                egui::CentralPanel::default().show(ui, |ui| {
                    let item = self.chosen.filter(|_| !self.is_new);
                    match item.filter(|id| queue.item(*id).is_some()) {
                        Some(id) => {
                            header(ui, queue, id);
                            if let Some(item) = queue.item(id) {
                                asked = self.sheet(ui, item);
                            }
                        }
                        None => {
                            let add = self.form.ui(ui, input.scene, input.chosen, input.qualities);
                            asked = add.then_some(BatchAction::Add);
                        }
                    }
                });
            });
        asked
    }

    fn queue_ui(&mut self, ui: &mut Ui, queue: &Queue) {
        if ui.selectable_label(self.is_new, t("New batch…")).clicked() {
            self.is_new = true;
        }
        ui.separator();
        if queue.items().is_empty() {
            let text = t("A batch makes many variants of a scene, one after the other, while you go on.");
            ui.label(egui::RichText::new(text).small().color(theme::text_weak()));
        }
        egui::ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
            for item in queue.items() {
                let is_chosen = !self.is_new && self.chosen == Some(item.id);
                let (color, right) = told(item, queue.next_up() == Some(item.id));
                if icons::row(ui, color, &item.name, &right, is_chosen, &item.name).clicked() {
                    (self.chosen, self.is_new) = (Some(item.id), false);
                }
            }
        });
    }

    fn sheet(&mut self, ui: &mut Ui, item: &Item) -> Option<BatchAction> {
        let all = item.plan.count();
        let marks = &item.marks;
        let kinds = [
            (VariantFilter::All, t("All"), t("every variant")),
            (
                VariantFilter::Kept,
                t("Kept"),
                t("without those that were discarded"),
            ),
            (VariantFilter::Starred, t("Starred"), t("with a star")),
            (VariantFilter::Failed, t("Failed"), t("could not be made")),
        ];
        icons::segments(ui, &mut self.shown, &kinds);
        let failed = |v: usize| {
            item.failed
                .iter()
                .find(|(of, _)| *of == v)
                .map(|(_, why)| why.as_str())
        };
        let shown: Vec<usize> = (0..all)
            .filter(|v| match self.shown {
                VariantFilter::All => true,
                VariantFilter::Kept => !marks.discarded.contains(v),
                VariantFilter::Starred => marks.starred.contains(v),
                VariantFilter::Failed => failed(*v).is_some(),
            })
            .collect();
        if item.plan.pack.is_some() {
            ui.label(t(
                "The variants lie in tars; there are no small pictures of them.",
            ));
            return None;
        }
        let mut asked = None;
        let cell = PICTURE + vec2(0.0, CAPTION);
        let columns = ((ui.available_width() + 6.0) / (cell.x + 6.0)).floor().max(1.0) as usize;
        let mut may_read = READ_AT_ONCE;
        if self.pictures.len() > MOST_PICTURES {
            self.pictures.clear();
        }
        ui.spacing_mut().item_spacing = vec2(6.0, 6.0);
        let rows = shown.len().div_ceil(columns);
        egui::ScrollArea::vertical()
            .auto_shrink(false)
            .show_rows(ui, cell.y, rows, |ui, rows| {
                for row in rows {
                    ui.horizontal(|ui| {
                        for variant in shown.iter().skip(row * columns).take(columns) {
                            let path = item.output.join(format!("{variant:06}")).join("thumb.png");
                            let texture = self.picture(ui, path, &mut may_read);
                            let cell = VariantTile {
                                item,
                                variant: *variant,
                                texture,
                                failed: failed(*variant),
                            };
                            asked = cell.ui(ui, cell_size()).or(asked.take());
                        }
                    });
                }
            });
        asked
    }

    /// The small picture of a variant; `None` if it is not there, or not read yet.
    fn picture(&mut self, ui: &Ui, path: PathBuf, may_read: &mut usize) -> Option<egui::TextureId> {
        if let Some(Some(texture)) = self.pictures.get(&path) {
            return Some(texture.id());
        }
        if *may_read == 0 || !path.exists() {
            if *may_read == 0 {
                ui.ctx().request_repaint();
            }
            return None;
        }
        *may_read -= 1;
        let image = image::open(&path).ok()?.to_rgba8();
        let size = [image.width() as usize, image.height() as usize];
        let image = egui::ColorImage::from_rgba_unmultiplied(size, &image);
        let texture = ui.ctx().load_texture("variant", image, TextureOptions::LINEAR);
        let id = texture.id();
        self.pictures.insert(path, Some(texture));
        Some(id)
    }

    /// Forgets the pictures, because another run may have replaced them.
    pub fn forget_pictures(&mut self) {
        self.pictures.clear();
    }
}

fn cell_size() -> egui::Vec2 {
    PICTURE + vec2(0.0, CAPTION)
}

/// The state of a batch as a colour and a text.
fn told(item: &Item, is_next: bool) -> (Color32, String) {
    let of = item.plan.count();
    match &item.state {
        BatchState::Waiting if is_next => (theme::text_weak(), t("is next").into()),
        BatchState::Waiting => (theme::text_weak(), t("waits").into()),
        BatchState::Running => (
            theme::accent(),
            tf!("{done} of {all}", done = item.done, all = of),
        ),
        BatchState::Paused => (
            theme::warn(),
            tf!("paused, {done} of {all}", done = item.done, all = of),
        ),
        BatchState::Done(_) if item.failed.is_empty() => (theme::good(), tf!("{n} ready", n = of)),
        BatchState::Done(_) => (theme::warn(), tf!("{n} failed", n = item.failed.len())),
        BatchState::Failed(_) => (theme::bad(), t("failed").into()),
    }
}

fn header(ui: &mut Ui, queue: &mut Queue, id: u64) {
    let Some(item) = queue.item(id) else {
        return;
    };
    let (state, priority) = (item.state.clone(), item.priority);
    let (done, of) = (item.done, item.plan.count());
    ui.horizontal(|ui| {
        ui.heading(&item.name);
        let path = item.output.display().to_string();
        let folder =
            egui::Label::new(egui::RichText::new(&path).small().color(theme::text_weak())).truncate();
        ui.add(folder).on_hover_text(path);
    });
    ui.horizontal(|ui| {
        let mut chosen = priority;
        ui.label(t("Priority"));
        let names = Priority::ALL.map(|p| (p, t(p.label()), ""));
        if icons::segments(ui, &mut chosen, &names) {
            queue.set_priority(id, chosen);
        }
        let can_be_next = state == BatchState::Waiting && queue.next_up() != Some(id);
        let next = ui.add_enabled(can_be_next, egui::Button::new(t("Run next")));
        if next.on_hover_text(t("before all others that wait")).clicked() {
            queue.run_next(id);
        }
        match &state {
            BatchState::Running | BatchState::Waiting => {
                if ui
                    .button(t("Pause"))
                    .on_hover_text(t("after the variant at hand"))
                    .clicked()
                {
                    queue.pause(id);
                }
            }
            BatchState::Paused => {
                if ui.button(t("Go on")).clicked() {
                    queue.resume(id);
                }
            }
            BatchState::Done(report) if !report.failed.is_empty() => {
                if ui.button(t("Try the failed ones again")).clicked() {
                    queue.resume(id);
                }
            }
            BatchState::Failed(_) => {
                if ui.button(t("Try again")).clicked() {
                    queue.resume(id);
                }
            }
            BatchState::Done(_) => {}
        }
        if ui
            .button(t("Take out of the queue"))
            .on_hover_text(t("its files stay"))
            .clicked()
        {
            queue.remove(id);
        }
    });
    match &state {
        BatchState::Failed(why) => {
            ui.colored_label(theme::bad(), why);
        }
        BatchState::Done(_) => {}
        _ => {
            let text = tf!("{done} of {all}", done = done, all = of);
            let bar = egui::ProgressBar::new(done as f32 / of.max(1) as f32).text(text);
            ui.add(bar.desired_height(16.0));
        }
    }
}

/// One variant in the list.
struct VariantTile<'a> {
    item: &'a Item,
    variant: usize,
    texture: Option<egui::TextureId>,
    failed: Option<&'a str>,
}

impl VariantTile<'_> {
    fn ui(&self, ui: &mut Ui, size: egui::Vec2) -> Option<BatchAction> {
        let (rect, response) = ui.allocate_exact_size(size, Sense::click());
        let (id, variant) = (self.item.id, self.variant);
        let is_starred = self.item.marks.starred.contains(&variant);
        let is_discarded = self.item.marks.discarded.contains(&variant);
        let name = tf!("Variant {n}", n = variant);
        response.widget_info(|| WidgetInfo::labeled(Role::Button, true, &name));
        let picture = Rect::from_min_size(rect.min, PICTURE);
        ui.painter().rect_filled(rect, theme::RADIUS, theme::field());
        let faint = if is_discarded { 60 } else { 255 };
        match (self.texture, self.failed) {
            (Some(texture), _) => {
                let unit = Rect::from_min_max(pos2(0.0, 0.0), pos2(1.0, 1.0));
                ui.painter()
                    .image(texture, picture, unit, Color32::from_white_alpha(faint));
            }
            (None, Some(why)) => label(ui, picture, why, theme::bad()),
            (None, None) => label(ui, picture, t("not made yet"), theme::text_weak()),
        }
        let below = Rect::from_min_max(pos2(rect.left(), picture.bottom()), rect.max);
        let caption = Rect::from_min_max(below.min, pos2(below.right() - 48.0, below.bottom()));
        label(ui, caption, &self.changes(), theme::text());
        let mut asked = None;
        let buttons = [
            (is_starred, t("Star")),
            (is_discarded, t("Discard: marked in the index, the files stay")),
        ];
        for (i, (on, hint)) in buttons.into_iter().enumerate() {
            let at = pos2(below.right() - 36.0 + 24.0 * i as f32, below.center().y);
            let button = Rect::from_center_size(at, vec2(22.0, CAPTION));
            let clicked = ui.interact(button, ui.scope_id().with((id, variant, i)), Sense::click());
            let spoken = match i {
                0 => tf!("Star variant {n}", n = variant),
                _ => tf!("Discard variant {n}", n = variant),
            };
            clicked.widget_info(|| WidgetInfo::selected(Role::CheckBox, true, on, &spoken));
            let color = match (on, i, clicked.hovered()) {
                (true, 0, _) => theme::warn(),
                (true, ..) => theme::bad(),
                (_, _, true) => theme::text_strong(),
                _ => theme::text_weak(),
            };
            match i {
                0 => icons::star(ui, at, color, on),
                _ => {
                    let stroke = egui::Stroke::new(if on { 2.0 } else { 1.2 }, color);
                    for way in [vec2(4.5, 4.5), vec2(4.5, -4.5)] {
                        ui.painter().line_segment([at - way, at + way], stroke);
                    }
                }
            }
            icons::focus_ring(ui, &clicked, button);
            if clicked.on_hover_text(hint).clicked() {
                asked = Some(match i {
                    0 => BatchAction::Star(id, variant),
                    _ => BatchAction::Discard(id, variant),
                });
            }
        }
        icons::focus_ring(ui, &response, rect);
        let changes = self.changes();
        let text = tf!(
            "{name}: {changes}\nDouble-click opens it.",
            name = name,
            changes = changes
        );
        if response.on_hover_text(text).double_clicked() {
            asked = Some(BatchAction::Open(id, variant));
        }
        asked
    }

    /// The variant's number and its changes from the base, short.
    fn changes(&self) -> String {
        use crate::batch::plan::VariantChange;
        let values = self.item.plan.values_of(self.variant);
        let mut parts = vec![format!("{}", self.variant)];
        for (axis, value) in self.item.plan.sweep.iter().zip(values) {
            for change in axis.value(value) {
                parts.push(match change {
                    VariantChange::Seed(seed) => tf!("seed {seed}", seed = seed),
                    VariantChange::Base(_) | VariantChange::Edits(_) => format!("{} {value}", axis.name),
                    VariantChange::Conditions { time, weather } => {
                        let names = [time.map(|time| t(time.name())), weather.map(|w| t(w.name()))];
                        names.into_iter().flatten().collect::<Vec<_>>().join(" ")
                    }
                    VariantChange::Words(words) => words,
                    VariantChange::Offset { by_m, .. } => match by_m.y == 0.0 {
                        true => tf!("{m} m ahead", m = format!("{:+.1}", by_m.x)),
                        false => tf!("{m} m left", m = format!("{:+.1}", by_m.y)),
                    },
                    VariantChange::Count { class, n } => format!("{n} {}", t(&class.label())),
                });
            }
        }
        parts.join(" · ")
    }
}

fn label(ui: &Ui, rect: Rect, text: &str, color: Color32) {
    let font = egui::TextStyle::Small.resolve(ui.style());
    let mut job = egui::text::LayoutJob::simple_singleline(text.to_owned(), font, color);
    job.wrap = egui::text::TextWrapping::truncate_at_width(rect.width() - 8.0);
    let galley = ui.painter().layout_job(job);
    let at = pos2(rect.left() + 4.0, rect.center().y - galley.size().y / 2.0);
    ui.painter().galley(at, galley, color);
}
