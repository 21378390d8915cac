//! Commands for a selection that holds things: removed, copied, moved, turned, set to the kerb, together with the
//! chosen boxes, as one undo step.

use glam::DVec2;

use crate::panes::id::PaneId;
use crate::shell::app::SceneloomApp;
use crate::tools::ToolCommand;
use editor::arrange::{self, Added, Clipboard, Ties};
use editor::{Edit, kerb, rows};
use language::{filled, t, tf};
use scene::{BoxId, Form, Scene, ThingId};

use crate::tools::things::words;

/// Farthest distance of a kerb to which an object is set, m.
const KERB_REACH_M: f64 = 12.0;

impl SceneloomApp {
    /// Carries out a command of boxes for the chosen things too. Returns false if no thing is chosen.
    pub(crate) fn carry(&mut self, command: &ToolCommand, ctx: &egui::Context) -> bool {
        let scene = self.document.settled_scene().clone();
        if *command == ToolCommand::Paste && !self.state.tools.things.clipboard.is_empty() {
            self.paste_things(&scene);
            return true;
        }
        let forms: Vec<Form> = self
            .state
            .tools
            .things
            .chosen_in(&scene.background)
            .map(|t| t.form.clone())
            .collect();
        if forms.is_empty() {
            return false;
        }
        let ids: Vec<ThingId> = self.state.tools.things.chosen.iter().copied().collect();
        let (frame, boxes) = (scene.frame(), self.state.chosen());
        let moved = |by_m: DVec2, turn_deg: f64| Edit::MoveThings {
            ids: ids.clone(),
            by_m,
            turn_deg,
        };
        let (label, mut edits, of_things) = match command {
            ToolCommand::Delete => {
                let edit = Edit::RemoveThings { ids: ids.clone() };
                ("Remove {things}", arrange::remove(frame, &boxes), edit)
            }
            ToolCommand::Nudge(step_m) if step_m.z != 0.0 => {
                let edit = Edit::RaiseThings {
                    ids: ids.clone(),
                    by_m: step_m.z,
                };
                ("Raise {things}", arrange::shift(frame, &boxes, *step_m), edit)
            }
            ToolCommand::Nudge(step_m) => {
                let by_m = step_m.truncate();
                (
                    "Nudge {things}",
                    arrange::shift(frame, &boxes, *step_m),
                    moved(by_m, 0.0),
                )
            }
            ToolCommand::Turn(degrees) => {
                let pivot = self.state.tools.pivot;
                let turned = arrange::turn(frame, &boxes, *degrees, pivot);
                ("Turn {things}", turned, moved(DVec2::ZERO, *degrees))
            }
            ToolCommand::ToLane => {
                let Some(by_m) = kerb::way_to_kerb(&frame.layout, &forms, DVec2::ZERO, KERB_REACH_M) else {
                    self.note(t("No kerb is near"));
                    return true;
                };
                (
                    "Set to the kerb: {things}",
                    arrange::to_lane(frame, &boxes),
                    moved(by_m, 0.0),
                )
            }
            ToolCommand::AskRow => {
                self.state.tools.row_open = true;
                return true;
            }
            ToolCommand::Row(row) => {
                let named: Vec<&Form> = forms.iter().collect();
                let added = rows::row(frame, &boxes, row).with(&Ties::from_selection(&scene, &boxes));
                self.add_copies("Row of {things}", rows::row_forms(&scene, &named, row), added);
                return true;
            }
            ToolCommand::Mirror(copies) => {
                let keep = self.state.tools.mirror_keeps_direction;
                let mirrored = |form: &Form| rows::mirrored_form(frame, form, keep);
                if *copies {
                    let forms = forms.iter().map(mirrored).collect();
                    let added =
                        arrange::mirror_copy(frame, &boxes, keep).with(&Ties::from_selection(&scene, &boxes));
                    self.add_copies("Mirrored copies of {things}", forms, added);
                } else {
                    let chosen = self.state.tools.things.chosen_in(&scene.background);
                    let mut edits = arrange::mirror(frame, &boxes, keep);
                    edits.extend(chosen.map(|t| Edit::ChangeThing {
                        id: t.id,
                        form: mirrored(&t.form),
                    }));
                    let named: Vec<&Form> = forms.iter().collect();
                    let things = self.named(&named, &boxes);
                    self.apply(tf!("Mirror {things}", things = things), &edits);
                }
                return true;
            }
            ToolCommand::Duplicate => {
                self.duplicate(&scene, &boxes, &forms);
                return true;
            }
            ToolCommand::Copy | ToolCommand::Cut => {
                self.copy_all(&scene, &boxes, &forms, ctx);
                if *command == ToolCommand::Copy {
                    return true;
                }
                let edit = Edit::RemoveThings { ids: ids.clone() };
                ("Cut {things}", arrange::remove(frame, &boxes), edit)
            }
            _ => return false,
        };
        edits.push(of_things);
        let named: Vec<&Form> = forms.iter().collect();
        let things = self.named(&named, &boxes);
        self.apply(filled(t(label), &[("things", &things)]), &edits);
        true
    }

    /// The objects of an edit in words, for the name of the undo step.
    fn named(&self, forms: &[&Form], boxes: &[BoxId]) -> String {
        match boxes.is_empty() {
            true => words::count(forms),
            false => tf!("{n} boxes and things", n = boxes.len() + forms.len()),
        }
    }

    /// Copies the selection beside the originals.
    fn duplicate(&mut self, scene: &Scene, boxes: &[BoxId], forms: &[Form]) {
        let by_m = beside_m(forms);
        let copies = forms.iter().map(|f| shifted(f, by_m)).collect();
        let added = arrange::duplicate(scene.frame(), boxes).with(&Ties::from_selection(scene, boxes));
        self.add_copies("Duplicate {things}", copies, added);
    }

    /// Adds things and boxes as one undo step, and chooses them.
    fn add_copies(&mut self, label: &str, forms: Vec<Form>, added: Added) {
        if forms.is_empty() && added.ids.is_empty() {
            return self.note(t("All of them would lie outside the map"));
        }
        if forms.is_empty() {
            // The things would lie outside the map, the boxes do not.
            return self.add_boxes("Row of boxes", added);
        }
        self.add_things(label, forms, added.edits);
        self.state.choose(&added.ids, crate::tools::Choose::Add);
    }

    fn copy_all(&mut self, scene: &Scene, boxes: &[BoxId], forms: &[Form], ctx: &egui::Context) {
        let clipboard = Clipboard::from_selection(scene, boxes);
        let mut edits: Vec<Edit> = clipboard.boxes.iter().map(arrange::adding).collect();
        edits.push(Edit::AddThings {
            forms: forms.to_vec(),
        });
        // Without a text on the clipboard the window system would not report the chord that pastes.
        ctx.copy_text(serde_json::to_string(&edits).unwrap_or_default());
        self.state.tools.clipboard = clipboard;
        self.state.tools.things.clipboard = forms.to_vec();
    }

    /// Pastes things at the pointer over the bird's-eye view, else beside the originals. Boxes come along.
    fn paste_things(&mut self, scene: &Scene) {
        let frame = scene.frame();
        let over_bev = self.state.pointed.pane == Some(PaneId::BEV);
        let at_m = self.state.tools.pointer_m.filter(|_| over_bev);
        let forms = self.state.tools.things.clipboard.clone();
        let middle = forms.iter().map(Form::middle_m).sum::<DVec2>() / forms.len() as f64;
        let by_m = match at_m {
            Some(at_m) => at_m - middle,
            None => beside_m(&forms),
        };
        // Boxes and things keep their relative places.
        let mut boxes = self.state.tools.clipboard.clone();
        for b in &mut boxes.boxes {
            b.center_m += by_m.extend(0.0);
        }
        let box_at_m = arrange::middle_m(&boxes.boxes).map(|m| m.truncate());
        let added = arrange::paste(frame, &boxes, box_at_m);
        let copies = forms.iter().map(|f| shifted(f, by_m)).collect();
        self.add_copies("Paste {things}", copies, added);
    }
}

fn shifted(form: &Form, by_m: DVec2) -> Form {
    let mut out = form.clone();
    out.map_points(|p| p + by_m, 0.0);
    out
}

/// The offset to a free place beside the forms, across their longer extent, m.
fn beside_m(forms: &[Form]) -> DVec2 {
    const GAP_M: f64 = 1.0;
    const MOST_M: f64 = 20.0;
    let (min, max) = forms
        .iter()
        .map(Form::bounds_m)
        .reduce(|a, b| (a.0.min(b.0), a.1.max(b.1)))
        .unwrap_or_default();
    let size = (max - min + GAP_M).min(DVec2::splat(MOST_M));
    match size.y <= size.x {
        true => DVec2::new(0.0, -size.y),
        false => DVec2::new(size.x, 0.0),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use scene::background::Building;

    #[test]
    fn copies_come_beside_and_do_not_overlap() {
        let house = Form::Building(Building::rectangle(
            DVec2::new(10.0, 10.0),
            DVec2::new(6.0, 3.0),
            DVec2::X,
            6.0,
        ));
        let by_m = beside_m(std::slice::from_ref(&house));
        assert_eq!(by_m, DVec2::new(0.0, -7.0));
        let copy = shifted(&house, by_m);
        assert!(copy.bounds_m().1.y < house.bounds_m().0.y);
    }
}
