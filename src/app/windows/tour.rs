//! The tour in three steps for the first minutes: paint, place, look. A step ends when the user does it or skips it.

use egui::{Align2, Area, Id, Order, Rect, Ui, vec2};

use editor::Document;
use language::{t, tf};
use scene::Conditions;
use widgets::theme;

/// Progress on the tour.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tour {
    step: usize,
    /// Position in the history when the present step of the tour began.
    from: usize,
    /// Conditions at that time.
    conditions: Conditions,
}

/// Title and instructions of each step.
const STEPS: [(&str, &str); 3] = [
    (
        "Paint the map",
        "Press B, and drag over the bird's-eye view. Which layer is painted is chosen on the left, under Map layers. Ctrl+Z takes anything back.",
    ),
    (
        "Put something on the road",
        "Press A, choose what in the list on the left, and click on the road. Press V and drag it by its arrows or its knob.",
    ),
    (
        "See what the sensors see",
        "Type “make it night, rain” under Prompt and press Enter: the cameras show it as pictures. Above them you choose classes, depth and more.",
    ),
];

impl Tour {
    /// The beginning of the tour.
    pub fn begin(document: &Document) -> Self {
        Self {
            step: 0,
            from: document.position(),
            conditions: document.scene().conditions,
        }
    }

    fn next(&mut self, document: &Document) {
        *self = Self {
            step: self.step + 1,
            ..Self::begin(document)
        };
    }

    /// True if the task of the step was done since it began.
    fn is_done(&self, document: &Document) -> bool {
        let began = |words: &str| {
            let new = document.history().skip(self.from + 1);
            new.take(document.position().saturating_sub(self.from))
                .any(|label| label.starts_with(words))
        };
        match self.step {
            0 => began("Paint") || began("Lay street"),
            1 => began("Add"),
            2 => document.scene().conditions != self.conditions,
            _ => false,
        }
    }
}

/// Draws the tour over the lower edge of `over` while it is running.
pub fn tour_ui(ui: &Ui, over: Rect, tour: &mut Option<Tour>, document: &Document) {
    let Some(at) = tour else { return };
    // The history may be shorter: another scene is open, or steps were undone.
    at.from = at.from.min(document.position());
    if at.is_done(document) && !document.is_dragging() {
        at.next(document);
    }
    let mut ends = false;
    Area::new(Id::unique("tour"))
        .order(Order::Foreground)
        .pivot(Align2::CENTER_BOTTOM)
        .fixed_pos(over.center_bottom() - vec2(0.0, 14.0))
        .show(ui.ctx(), |ui| {
            theme::dialog_frame(ui.style()).show(ui, |ui| {
                ui.set_width(380.0);
                match STEPS.get(at.step) {
                    Some((title, text)) => {
                        let n = STEPS.len();
                        let title = t(title);
                        ui.heading(tf!(
                            "{step} of {all}: {title}",
                            step = at.step + 1,
                            all = n,
                            title = title
                        ));
                        ui.label(t(text));
                        ui.add_space(theme::GAP / 2.0);
                        ui.horizontal(|ui| {
                            if ui.button(t("Skip")).clicked() {
                                at.next(document);
                            }
                            ends |= ui.button(t("End the tour")).clicked();
                        });
                    }
                    None => {
                        ui.heading(t("That was the tour"));
                        ui.label(t(
                            "Ctrl+K finds every command, setting and object. ? shows the keys.",
                        ));
                        ui.add_space(theme::GAP / 2.0);
                        ends |= ui.button(t("Good")).clicked();
                    }
                }
            });
        });
    if ends {
        *tour = None;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use editor::Edit;
    use scene::{BevLayer, BevLayout, Extent, Frame, Scene, Shape, VoxelGrid};

    #[test]
    fn a_step_is_done_by_doing_it() {
        let frame = Frame::new(
            BevLayout::over(Extent::WINDOW),
            Default::default(),
            VoxelGrid::new(),
        );
        let mut document = Document::new(Scene::single("a", frame, Default::default(), 0));
        let mut tour = Tour::begin(&document);
        assert!(!tour.is_done(&document));
        let edit = Edit::PaintBev {
            layer: BevLayer::Walkway,
            shape: Shape::Cells(vec![[1, 1]]),
            value: true,
        };
        document.apply("Paint layer", &edit).expect("inside");
        assert!(tour.is_done(&document));
        tour.next(&document);
        assert!(!tour.is_done(&document), "painting places nothing");
        tour.next(&document);
        assert!(!tour.is_done(&document));
        let conditions = document.scene().conditions.at(scene::TimeOfDay::Night);
        document
            .apply("Change weather", &Edit::SetConditions { conditions })
            .expect("sound");
        assert!(tour.is_done(&document));
        tour.step = STEPS.len();
        assert!(!tour.is_done(&document));
    }
}
