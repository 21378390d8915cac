//! The chosen things beside the road in numbers. A property that all of them have can be set for all of them.

use egui::{Response, Ui};

use crate::command::{Command, ViewCommand};
use crate::fields::{caption, number};
use crate::tools::ToolCommand;
use crate::tools::option_rows::list;
use crate::tools::things::building::{FACADES, ROOFS};
use crate::tools::things::tree::TREES;
use crate::tools::things::{ThingCommand, words};
use editor::Edit;
use language::{t, tf};
use scene::background::{LineKind, PostKind, STOREY_M};
use scene::{Background, Form, Thing};
use widgets::icons::{self, Icon};
use widgets::theme;

fn send(command: ThingCommand, commands: &mut Vec<Command>) {
    commands.push(Command::Tools(ToolCommand::Thing(command)));
}

/// The chosen things: as shown, a drag in progress included, and as they were before the drag.
#[derive(Clone, Copy)]
struct Chosen<'a> {
    shown: &'a [&'a Thing],
    settled: &'a [&'a Thing],
}

/// Edits that make the same change to every thing. Things that the change leaves as they are get no edit.
fn changes(settled: &[&Thing], change: impl Fn(&mut Form)) -> Vec<Edit> {
    let changed = settled.iter().filter_map(|t| {
        let mut form = t.form.clone();
        change(&mut form);
        (form != t.form).then_some(Edit::ChangeThing { id: t.id, form })
    });
    changed.collect()
}

/// Turns the response of a field into commands: dragging previews, releasing commits, typing applies.
fn field(response: &Response, label: String, edits: Vec<Edit>, commands: &mut Vec<Command>) {
    if response.dragged() {
        if response.changed() {
            commands.push(match edits.is_empty() {
                true => Command::CancelDrag,
                false => Command::Preview(edits),
            });
        }
    } else if response.drag_stopped() {
        send(ThingCommand::Commit(label), commands);
    } else if response.changed() && !edits.is_empty() {
        send(ThingCommand::Apply(label, edits), commands);
    }
}

/// Draws the inspector of the chosen things, of which there is at least one.
pub fn inspector(ui: &mut Ui, things: &[&Thing], settled: &Background, commands: &mut Vec<Command>) {
    let before: Vec<&Thing> = things.iter().filter_map(|t| settled.get(t.id)).collect();
    let (Some(first), Some(first_before)) = (things.first(), before.first()) else {
        return;
    };
    let chosen = Chosen {
        shown: things,
        settled: &before,
    };
    let forms: Vec<&Form> = things.iter().map(|t| &t.form).collect();
    let what = words::count(&forms);
    header(ui, things, &what, commands);
    kinds(ui, things, &what, commands);
    let mut height = first.form.height_m();
    let response = number(ui, t("Height"), t("Height"), &mut height, 0.1..=300.0, " m", 1);
    let lower = height < first_before.form.height_m();
    let label = match lower {
        true => tf!("Lower {things}", things = what),
        false => tf!("Raise {things}", things = what),
    };
    let edits = changes(&before, |form| set_height(form, height));
    field(&response, label, edits, commands);
    if forms.iter().all(|f| matches!(f, Form::Building(_))) {
        building(ui, things, &what, commands);
    }
    numbers(ui, chosen, &what, commands);
}

fn header(ui: &mut Ui, things: &[&Thing], what: &str, commands: &mut Vec<Command>) {
    ui.horizontal(|ui| {
        let name = match things {
            [one] => format!("{} #{}", theme::sentence(t(one.form.name())), one.id.0),
            _ => tf!("{things} chosen", things = what),
        };
        ui.label(egui::RichText::new(name).color(theme::text_strong()));
        ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
            ui.spacing_mut().item_spacing.x = 0.0;
            if icons::button(ui, Icon::Trash, t("Delete things"), "Del", false, true).clicked() {
                commands.push(Command::Tools(ToolCommand::Delete));
            }
            if icons::button(ui, Icon::Copy, t("Duplicate things"), "Ctrl+D", false, true).clicked() {
                commands.push(Command::Tools(ToolCommand::Duplicate));
            }
            if icons::button(ui, Icon::Focus, t("Frame things"), "F", false, true).clicked() {
                commands.push(Command::View(ViewCommand::FrameSelection));
            }
        });
    });
}

/// Choices with their texts in the language of the interface.
fn shown<T, const N: usize>(
    choices: [(T, &'static str, &'static str); N],
) -> [(T, &'static str, &'static str); N] {
    choices.map(|(value, name, hint)| (value, t(name), t(hint)))
}

/// Fields of a building: buttons for storeys, roof and facade.
fn building(ui: &mut Ui, things: &[&Thing], what: &str, commands: &mut Vec<Command>) {
    let of = |t: &Thing| match &t.form {
        Form::Building(b) => Some(b.clone()),
        _ => None,
    };
    let Some(first) = things.first().and_then(|t| of(t)) else {
        return;
    };
    let ids = || things.iter().map(|t| t.id).collect();
    let lowest = things.iter().map(|t| t.form.height_m()).fold(f64::MAX, f64::min);
    ui.horizontal(|ui| {
        caption(ui, t("Storeys"));
        let small = egui::vec2(theme::ROW, theme::ROW);
        let step = |ui: &mut Ui, sign: &str, name: &str, enabled: bool| {
            let button = ui.add_enabled(enabled, egui::Button::new(sign).min_size(small));
            button.widget_info(|| {
                egui::WidgetInfo::labeled(egui::accesskit::Role::Button, enabled, name.to_owned())
            });
            button.on_hover_text(name).clicked()
        };
        let mut raise = |label: String, by_m: f64| {
            let edits = vec![Edit::RaiseThings { ids: ids(), by_m }];
            send(ThingCommand::Apply(label, edits), commands);
        };
        if step(ui, "−", t("One storey less"), lowest > STOREY_M + 0.5) {
            raise(tf!("Lower {things}", things = what), -STOREY_M);
        }
        let same = things
            .iter()
            .all(|t| of(t).is_some_and(|b| b.storeys() == first.storeys()));
        let text = if same {
            first.storeys().to_string()
        } else {
            t("several").to_owned()
        };
        ui.label(egui::RichText::new(text).color(theme::text_strong()));
        if step(ui, "+", t("One storey more"), true) {
            raise(tf!("Raise {things}", things = what), STOREY_M);
        }
    });
    let mut roof = first.roof;
    ui.horizontal(|ui| {
        caption(ui, t("Roof"));
        if icons::segments(ui, &mut roof, &shown(ROOFS)) {
            let edits = changes(things, |form| {
                if let Form::Building(b) = form {
                    b.roof = roof;
                }
            });
            send(
                ThingCommand::Apply(tf!("Change roof of {things}", things = what), edits),
                commands,
            );
        }
    });
    if first.outline_m.len() != 4 && first.roof != Default::default() {
        ui.label(
            egui::RichText::new(t("Only four corners carry a ridge: the roof is flat"))
                .small()
                .color(theme::text_weak()),
        );
    }
    let mut facade = first.facade;
    if list(ui, t("Facade"), &mut facade, &shown(FACADES)) {
        let edits = changes(things, |form| {
            if let Form::Building(b) = form {
                b.facade = facade;
            }
        });
        send(
            ThingCommand::Apply(tf!("Change facade of {things}", things = what), edits),
            commands,
        );
    }
}

/// Lists of kinds for things that are all trees, all lines or all posts.
fn kinds(ui: &mut Ui, things: &[&Thing], what: &str, commands: &mut Vec<Command>) {
    let mut apply = |edits| {
        send(
            ThingCommand::Apply(tf!("Change kind of {things}", things = what), edits),
            commands,
        )
    };
    let lines = LineKind::ALL.map(|kind| (kind, theme::sentence(t(kind.name()))));
    let posts = PostKind::ALL.map(|kind| (kind, theme::sentence(t(kind.name()))));
    let all = |of: fn(&Form) -> bool| things.iter().all(|t| of(&t.form));
    match &things[0].form {
        Form::Tree(tree) if all(|f| matches!(f, Form::Tree(_))) => {
            let mut kind = tree.kind;
            if list(ui, t("Kind"), &mut kind, &shown(TREES)) {
                apply(changes(things, |form| {
                    if let Form::Tree(t) = form {
                        t.kind = kind;
                    }
                }));
            }
        }
        Form::Line(line) if all(|f| matches!(f, Form::Line(_))) => {
            let mut kind = line.kind;
            let named = lines.each_ref().map(|(kind, name)| (*kind, &name[..], ""));
            if list(ui, t("Kind"), &mut kind, &named) {
                apply(changes(things, |form| {
                    if let Form::Line(l) = form {
                        (l.kind, l.width_m) = (kind, kind.typical_m().1);
                    }
                }));
            }
        }
        Form::Post(post) if all(|f| matches!(f, Form::Post(_))) => {
            let mut kind = post.kind;
            let named = posts.each_ref().map(|(kind, name)| (*kind, &name[..], ""));
            if list(ui, t("Kind"), &mut kind, &named) {
                apply(changes(things, |form| {
                    if let Form::Post(p) = form {
                        (p.kind, p.height_m) = (kind, kind.typical_height_m());
                    }
                }));
            }
        }
        _ => {}
    }
}

/// A number field that some forms have.
struct NumberField {
    title: &'static str,
    name: &'static str,
    suffix: &'static str,
    range: std::ops::RangeInclusive<f64>,
    get: fn(&Form) -> Option<f64>,
    set: fn(&mut Form, f64),
}

const NUMBERS: [NumberField; 5] = [
    NumberField {
        title: "Crown",
        name: "crown radius",
        suffix: " m",
        range: 0.1..=20.0,
        get: |form| match form {
            Form::Tree(t) => Some(t.crown_radius_m),
            _ => None,
        },
        set: |form, v| {
            if let Form::Tree(t) = form {
                t.crown_radius_m = v;
            }
        },
    },
    NumberField {
        title: "Width",
        name: "width",
        suffix: " m",
        range: 0.02..=30.0,
        get: |form| match form {
            Form::Line(l) => Some(l.width_m),
            Form::Bridge(b) => Some(b.width_m),
            _ => None,
        },
        set: |form, v| match form {
            Form::Line(l) => l.width_m = v,
            Form::Bridge(b) => b.width_m = v.max(0.5),
            _ => {}
        },
    },
    NumberField {
        title: "Plants",
        name: "plants per square metre",
        suffix: " per m²",
        range: 0.0..=2.0,
        get: |form| match form {
            Form::Shrubs(s) => Some(s.per_m2),
            _ => None,
        },
        set: |form, v| {
            if let Form::Shrubs(s) = form {
                s.per_m2 = v;
            }
        },
    },
    NumberField {
        title: "Deck",
        name: "thickness of the deck",
        suffix: " m",
        range: 0.3..=5.0,
        get: |form| match form {
            Form::Bridge(b) => Some(b.thickness_m),
            _ => None,
        },
        set: |form, v| {
            if let Form::Bridge(b) = form {
                b.thickness_m = v.min(b.height_m);
            }
        },
    },
    NumberField {
        title: "Heading",
        name: "heading in the world",
        suffix: "°",
        range: -360.0..=360.0,
        get: |form| match form {
            Form::Post(p) => Some((p.yaw_rad.to_degrees() + 180.0).rem_euclid(360.0) - 180.0),
            _ => None,
        },
        set: |form, v| {
            if let Form::Post(p) = form {
                p.yaw_rad = v.to_radians();
            }
        },
    },
];

/// Fields for the numbers that all of the things have.
fn numbers(ui: &mut Ui, chosen: Chosen<'_>, what: &str, commands: &mut Vec<Command>) {
    let things = chosen.shown;
    for of in &NUMBERS {
        let Some(mut value) = (of.get)(&things[0].form) else {
            continue;
        };
        if things.iter().any(|t| (of.get)(&t.form).is_none()) {
            continue;
        }
        let decimals = if of.suffix == "°" { 0 } else { 2 };
        let response = number(
            ui,
            t(of.title),
            t(of.title),
            &mut value,
            of.range.clone(),
            t(of.suffix),
            decimals,
        );
        let response = response.on_hover_text(theme::sentence(t(of.name)));
        let edits = changes(chosen.settled, |form| (of.set)(form, value));
        field(
            &response,
            tf!(
                "Change {what} of {things}",
                what = t(of.title).to_lowercase(),
                things = what
            ),
            edits,
            commands,
        );
    }
}

/// Sets the height; a height that is too low for the form becomes its least height.
fn set_height(form: &mut Form, height_m: f64) {
    match form {
        Form::Building(b) => b.height_m = height_m.max(0.5),
        Form::Tree(t) => t.height_m = height_m.max(0.3),
        Form::Shrubs(s) => s.height_m = height_m,
        Form::Line(l) => l.height_m = height_m,
        Form::Post(p) => p.height_m = height_m,
        Form::Bridge(b) => b.height_m = height_m.max(b.thickness_m),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec2;
    use scene::ThingId;
    use scene::background::{SceneryLine, Tree};

    #[test]
    fn what_is_alike_makes_no_edit() {
        let thing = |i: u32, form| Thing {
            id: ThingId(i),
            look: 0,
            placed: false,
            form,
        };
        let tree = thing(
            1,
            Form::Tree(Tree {
                position_m: DVec2::ZERO,
                height_m: 5.0,
                crown_radius_m: 2.0,
                kind: Default::default(),
            }),
        );
        let hedge = thing(
            2,
            Form::Line(SceneryLine::typical(LineKind::Hedge, vec![DVec2::ZERO, DVec2::X])),
        );
        let edits = changes(&[&tree, &hedge], |form| set_height(form, 5.0));
        assert_eq!(edits.len(), 1);
        assert!(
            matches!(&edits[0], Edit::ChangeThing { id, form } if *id == hedge.id && form.height_m() == 5.0)
        );
        // Every field sets the value that it reads.
        for of in &NUMBERS {
            for t in [&tree, &hedge] {
                if (of.get)(&t.form).is_some() {
                    let mut form = t.form.clone();
                    (of.set)(&mut form, 1.25);
                    assert_eq!((of.get)(&form), Some(1.25), "{}", of.name);
                    assert_eq!(form.problem(), None);
                }
            }
        }
    }
}
