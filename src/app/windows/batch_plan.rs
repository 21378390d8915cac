//! The form for a batch: variants of the open scene, or a plan from a file.

use std::path::{Path, PathBuf};

use egui::{DragValue, Ui};
use glam::DVec2;

use crate::batch::plan::{
    Base, BatchGeneration, BatchPlan, FORMAT, Output, Seeds, VERSION, Value, VariantChange, VariationAxis,
};
use language::{t, tf};
use scene::{BoxId, Scene, TimeOfDay, Weather};
use widgets::{icons, theme};

/// Name of the scene in the batch's folder.
pub const BASE: &str = "base.loom";
/// Most steps of an offset.
const MOST_STEPS: usize = 41;

/// Offsets of the chosen object: from minus to plus `reach_m`, in a number of steps.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Range {
    on: bool,
    reach_m: f64,
    steps: usize,
}

impl Default for Range {
    fn default() -> Self {
        Self {
            on: false,
            reach_m: 2.0,
            steps: 5,
        }
    }
}

impl Range {
    fn values(self, id: BoxId, direction: DVec2) -> Vec<Value> {
        let last = (self.steps.max(2) - 1) as f64;
        let by_m = |i: usize| direction * (self.reach_m * (2.0 * i as f64 / last - 1.0));
        let value = |i| {
            Value::One(VariantChange::Offset {
                id,
                by_m: by_m(i),
                turn_deg: 0.0,
            })
        };
        (0..self.steps.max(2)).map(value).collect()
    }
}

/// Input of the user in the form.
pub struct PlanForm {
    /// True for a plan from a file, false for variants of the open scene.
    pub from_file: bool,
    /// The plan's file.
    pub plan_file: String,
    /// Folder for the variants.
    pub folder: String,
    /// Why the last attempt to add the batch failed.
    pub problem: Option<String>,
    times: Vec<TimeOfDay>,
    weathers: Vec<Weather>,
    ahead: Range,
    aside: Range,
    quality: Option<String>,
    seeds: usize,
    formats: Vec<&'static str>,
    size_px: [u32; 2],
    check: bool,
    frames_hz: f64,
}

impl PlanForm {
    /// A form with a folder beside the scene's file.
    pub fn new(folder: &Path) -> Self {
        Self {
            from_file: false,
            plan_file: String::new(),
            folder: folder.display().to_string(),
            problem: None,
            times: Vec::new(),
            weathers: Vec::new(),
            ahead: Range::default(),
            aside: Range::default(),
            quality: None,
            seeds: 4,
            formats: vec!["pictures", "loom"],
            size_px: [800, 450],
            check: true,
            frames_hz: 2.0,
        }
    }

    /// The folder, without surrounding spaces.
    pub fn output(&self) -> PathBuf {
        PathBuf::from(self.folder.trim())
    }

    /// The plan for variants of a scene that lies in the output folder.
    pub fn plan(&self, scene: &Scene, chosen: Option<BoxId>) -> BatchPlan {
        let mut sweep = Vec::new();
        let mut axis = |name: &str, values: Vec<Value>| {
            if !values.is_empty() {
                sweep.push(VariationAxis {
                    name: name.into(),
                    values,
                    seeds: None,
                });
            }
        };
        let conditions = |time, weather| Value::One(VariantChange::Conditions { time, weather });
        axis(
            "time",
            self.times.iter().map(|t| conditions(Some(*t), None)).collect(),
        );
        axis(
            "weather",
            self.weathers.iter().map(|w| conditions(None, Some(*w))).collect(),
        );
        if let Some(id) = chosen {
            for (name, range, direction) in [("ahead", self.ahead, DVec2::X), ("aside", self.aside, DVec2::Y)]
            {
                if range.on {
                    axis(name, range.values(id, direction));
                }
            }
        }
        if self.quality.is_some() {
            sweep.push(VariationAxis {
                name: "seed".into(),
                values: Vec::new(),
                seeds: Some(Seeds {
                    from: scene.seed,
                    count: self.seeds,
                }),
            });
        }
        let output = |format: &&str| Output {
            format: (*format).into(),
            size: Some(self.size_px),
            learned_lidar: false,
        };
        BatchPlan {
            format: FORMAT.into(),
            version: VERSION,
            base: Base::Scene(BASE.into()),
            seed: scene.seed,
            sweep,
            sample: None,
            generate: self.quality.clone().map(|quality| BatchGeneration {
                quality,
                whole: false,
            }),
            check: self.check,
            write: self.formats.iter().map(output).collect(),
            frames_hz: (scene.clip().length_s > 0.0).then_some(self.frames_hz),
            pack: None,
        }
    }

    /// Draws the form; returns true if a batch is to be added. `qualities` are the names of presets.
    pub fn ui(&mut self, ui: &mut Ui, scene: &Scene, chosen: Option<BoxId>, qualities: &[String]) -> bool {
        let kinds = [
            (
                false,
                t("Variants of this scene"),
                t("every combination of what is ticked below"),
            ),
            (true, t("A plan from a file"), t("JSON, see docs/batches.md")),
        ];
        let mut changed = icons::segments(ui, &mut self.from_file, &kinds);
        ui.add_space(theme::GAP);
        if self.from_file {
            changed |= path_row(ui, t("Plan"), &mut self.plan_file, "plan.json");
        } else {
            self.scene_ui(ui, scene, chosen, qualities);
        }
        let hint = t("a new folder, or one that holds a part of this batch");
        if path_row(ui, t("Folder"), &mut self.folder, hint) || changed {
            self.problem = None;
        }
        if let Some(problem) = &self.problem {
            ui.colored_label(theme::bad(), problem);
        }
        let mut add = false;
        ui.horizontal(|ui| {
            let ready = !self.folder.trim().is_empty()
                && match self.from_file {
                    true => !self.plan_file.trim().is_empty(),
                    false => !self.formats.is_empty(),
                };
            let button = egui::Button::new(t("Add to the queue")).fill(ui.visuals().selection.bg_fill);
            add = ui.add_enabled(ready, button).clicked();
            if !self.from_file {
                let n = self.plan(scene, chosen).count();
                let text = match n {
                    1 => tf!("{n} variant", n = n),
                    _ => tf!("{n} variants", n = n),
                };
                ui.label(egui::RichText::new(text).color(theme::text_weak()));
            }
        });
        add
    }

    fn scene_ui(&mut self, ui: &mut Ui, scene: &Scene, chosen: Option<BoxId>, qualities: &[String]) {
        let grid = egui::Grid::new("batch plan").num_columns(2).spacing([12.0, 6.0]);
        grid.show(ui, |ui| {
            ui.label(t("Time of day"));
            ui.horizontal_wrapped(|ui| {
                for time in TimeOfDay::ALL {
                    tick(ui, &mut self.times, time, &theme::sentence(t(time.name())));
                }
            });
            ui.end_row();
            ui.label(t("Weather"));
            ui.horizontal_wrapped(|ui| {
                for weather in Weather::ALL {
                    tick(
                        ui,
                        &mut self.weathers,
                        weather,
                        &theme::sentence(t(weather.name())),
                    );
                }
            });
            ui.end_row();
            ui.label(t("Chosen object"));
            match chosen {
                None => {
                    let text = t("choose one in the scene to vary where it is");
                    ui.label(egui::RichText::new(text).color(theme::text_weak()));
                }
                Some(_) => {
                    ui.vertical(|ui| {
                        range_ui(ui, t("ahead and back"), &mut self.ahead);
                        range_ui(ui, t("left and right"), &mut self.aside);
                    });
                }
            }
            ui.end_row();
            ui.label(t("Occupancy"));
            ui.horizontal(|ui| {
                let generated = |quality: &str| tf!("generated: {quality}", quality = t(quality));
                let text = self
                    .quality
                    .as_deref()
                    .map_or_else(|| t("as drafted").into(), generated);
                egui::ComboBox::from_id_salt("batch quality")
                    .selected_text(text)
                    .show_ui(ui, |ui| {
                        ui.selectable_value(&mut self.quality, None, t("as drafted"));
                        for quality in qualities {
                            let value = Some(quality.clone());
                            ui.selectable_value(&mut self.quality, value, generated(quality));
                        }
                    });
                if self.quality.is_some() {
                    ui.add(DragValue::new(&mut self.seeds).range(1..=1000));
                    ui.label(t("times, from other noise"));
                }
            });
            ui.end_row();
            ui.label(t("Files"));
            ui.horizontal(|ui| {
                let text = match self.formats.len() {
                    0 => t("none").to_owned(),
                    1..=3 => self.formats.join(", "),
                    n => tf!("{n} formats", n = n),
                };
                ui.menu_button(format!("{text}…"), |ui| {
                    egui::ScrollArea::vertical().max_height(320.0).show(ui, |ui| {
                        tick(ui, &mut self.formats, "loom", t("loom: the scene itself"));
                        for format in formats::export::all() {
                            tick(ui, &mut self.formats, format.id, t(format.title));
                        }
                    });
                });
                let [width, height] = &mut self.size_px;
                ui.label(t("pictures"));
                ui.add(DragValue::new(width).range(16..=4096));
                ui.label("×");
                ui.add(DragValue::new(height).range(16..=4096));
            });
            ui.end_row();
            if scene.clip().length_s > 0.0 {
                ui.label(t("Moments"));
                ui.add(
                    DragValue::new(&mut self.frames_hz)
                        .range(0.1..=30.0)
                        .suffix(t(" per second")),
                );
                ui.end_row();
            }
            ui.label(t("Checks"));
            ui.checkbox(&mut self.check, t("count what the quality checks find"));
            ui.end_row();
        });
    }
}

fn path_row(ui: &mut Ui, label: &str, path: &mut String, hint: &str) -> bool {
    let row = ui.horizontal(|ui| {
        ui.add_sized([52.0, 20.0], egui::Label::new(label).selectable(false));
        let field = egui::TextEdit::singleline(path)
            .desired_width(f32::INFINITY)
            .hint_text(hint);
        let field = ui.add(field);
        let changed = field.changed();
        field.accessible_name(tf!("{label} of the batch", label = label));
        changed
    });
    row.inner
}

fn tick<T: PartialEq + Copy>(ui: &mut Ui, list: &mut Vec<T>, value: T, text: &str) {
    let mut on = list.contains(&value);
    if ui.checkbox(&mut on, text).changed() {
        match on {
            true => list.push(value),
            false => list.retain(|v| *v != value),
        }
    }
}

fn range_ui(ui: &mut Ui, text: &str, range: &mut Range) {
    ui.horizontal(|ui| {
        ui.checkbox(&mut range.on, text);
        ui.add_enabled_ui(range.on, |ui| {
            ui.label("±");
            ui.add(
                DragValue::new(&mut range.reach_m)
                    .range(0.1..=50.0)
                    .speed(0.1)
                    .suffix(" m"),
            );
            ui.label(t("in"));
            ui.add(DragValue::new(&mut range.steps).range(2..=MOST_STEPS));
            ui.label(t("steps"));
        });
    });
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::open;

    #[test]
    fn what_is_ticked_is_combined() {
        let scene = open::bundled().expect("bundled");
        let id = *scene.frame().boxes.keys().next().expect("a box");
        let mut form = PlanForm::new(Path::new("/tmp/x"));
        assert_eq!(form.plan(&scene, Some(id)).count(), 1);
        assert_eq!(form.plan(&scene, None).problem(), None);
        form.times = vec![TimeOfDay::Day, TimeOfDay::Night];
        form.weathers = vec![Weather::Rain];
        (form.ahead.on, form.ahead.steps) = (true, 3);
        let plan = form.plan(&scene, Some(id));
        assert_eq!((plan.count(), plan.problem()), (6, None));
        let offsets: Vec<f64> = (0..3)
            .map(|i| match &plan.sweep[2].value(i)[0] {
                VariantChange::Offset { by_m, .. } => by_m.x,
                other => panic!("{other:?}"),
            })
            .collect();
        assert_eq!(offsets, [-2.0, 0.0, 2.0]);
        // Without an object there are no offsets; with networks there are seeds.
        form.quality = Some("draft".into());
        assert_eq!(form.plan(&scene, None).count(), 8);
    }
}
