//! Lens and shutter of a camera, as rows of the window *Sensors*.

use egui::Ui;

use crate::command::Command;
use crate::fields::{caption, field, number, short, typed};
use editor::Edit;
use language::{t, tf};
use scene::{Camera, Lens, ReadOut, Shutter};
use widgets::theme;

/// A kind of lens, with the values to begin with.
struct LensPreset {
    title: &'static str,
    hint: &'static str,
    lens: Lens,
}

const KINDS: [LensPreset; 4] = [
    LensPreset {
        title: "Pinhole",
        hint: "Straight lines stay straight",
        lens: Lens::Pinhole,
    },
    LensPreset {
        title: "Distorted",
        hint: "OpenCV's model: radial k1 to k6, tangential p1, p2",
        lens: Lens::Distorted {
            k: [-0.30, 0.09, 0.0, 0.0, 0.0, 0.0],
            p: [0.0; 2],
        },
    },
    LensPreset {
        title: "Fisheye",
        hint: "Kannala and Brandt, as OpenCV's fisheye: k1 to k4. Depths are distances",
        lens: Lens::Fisheye {
            k: [-0.01, 0.0, 0.0, 0.0],
            max_angle_deg: 95.0,
        },
    },
    LensPreset {
        title: "f-theta",
        hint: "Radius as a polynomial of the angle: c1 to c6. Depths are distances",
        lens: Lens::FTheta {
            c: [1.0, 0.0, -0.02, 0.0, 0.0, 0.0],
            max_angle_deg: 95.0,
        },
    },
];

const READ_OUTS: [(ReadOut, &str); 4] = [
    (ReadOut::TopToBottom, "from the top"),
    (ReadOut::BottomToTop, "from the bottom"),
    (ReadOut::LeftToRight, "from the left"),
    (ReadOut::RightToLeft, "from the right"),
];

/// Draws the rows. A change becomes an edit of the rig by `set`.
pub fn rows(ui: &mut Ui, camera: &Camera, set: &dyn Fn(Camera) -> Edit, commands: &mut Vec<Command>) {
    let of = |lens: &Lens| {
        KINDS
            .iter()
            .position(|k| k.lens.name() == lens.name())
            .unwrap_or(0)
    };
    let now = of(&camera.lens);
    ui.horizontal(|ui| {
        caption(ui, t("Lens"));
        ui.menu_button(t(KINDS[now].title), |ui| {
            for kind in &KINDS {
                if ui.button(t(kind.title)).on_hover_text(t(kind.hint)).clicked() {
                    let mut new = camera.clone();
                    let fov_deg = new.fov_deg();
                    new.lens = kind.lens;
                    // The field of view stays as it was.
                    new.set_fov_deg(fov_deg);
                    commands.push(Command::Apply("Change lens", vec![set(new)]));
                    ui.close();
                }
            }
        });
    });
    let mut new = camera.clone();
    let changed = match &mut new.lens {
        Lens::Pinhole => None,
        Lens::Distorted { k, p } => {
            let radial = coefficients(ui, "k", k);
            Some(radial.union(coefficients(ui, "p", p)))
        }
        Lens::Fisheye { k, max_angle_deg } => Some(coefficients(ui, "k", k).union(widest(ui, max_angle_deg))),
        Lens::FTheta { c, max_angle_deg } => Some(coefficients(ui, "c", c).union(widest(ui, max_angle_deg))),
    };
    if let Some(changed) = changed
        && new.lens.problem().is_none()
    {
        field(&changed, "Change lens", set(new), commands);
    }
    shutter(ui, camera, set, commands);
}

fn widest(ui: &mut Ui, max_angle_deg: &mut f64) -> egui::Response {
    number(
        ui,
        t("Sees to"),
        t("Largest angle from the axis"),
        max_angle_deg,
        10.0..=180.0,
        "°",
        0,
    )
}

/// Coefficients of a polynomial, three in a row.
fn coefficients(ui: &mut Ui, name: &str, values: &mut [f64]) -> egui::Response {
    let mut all: Option<egui::Response> = None;
    for (row, values) in values.chunks_mut(3).enumerate() {
        ui.horizontal(|ui| {
            ui.spacing_mut().item_spacing.x = 3.0;
            let first = row * 3 + 1;
            let last = first + values.len() - 1;
            let text = match first == last {
                true => format!("{name}{first}"),
                false => tf!(
                    "{first} to {last}",
                    first = format!("{name}{first}"),
                    last = format!("{name}{last}")
                ),
            };
            caption(ui, &text);
            for (i, value) in values.iter_mut().enumerate() {
                let drag = typed(value, |v| short(v, 6))
                    .speed(0.001)
                    .range(-100.0..=100.0)
                    .max_decimals(6);
                let named = format!("{name}{}", first + i);
                let drag = ui.add_sized([64.0, theme::ROW], drag).accessible_name(named);
                all = Some(match all.take() {
                    Some(all) => all.union(drag),
                    None => drag,
                });
            }
        });
    }
    all.unwrap_or_else(|| ui.label(""))
}

fn shutter(ui: &mut Ui, camera: &Camera, set: &dyn Fn(Camera) -> Edit, commands: &mut Vec<Command>) {
    let mut new = camera.clone();
    let mut rolls = camera.shutter.is_some();
    let toggled = ui.checkbox(&mut rolls, t("Rolling shutter")).on_hover_text(t(
        "Rows are read one after another, while the vehicle and what it sees move on",
    ));
    if toggled.changed() {
        new.shutter = rolls.then_some(Shutter {
            readout_s: 0.03,
            direction: ReadOut::TopToBottom,
        });
        commands.push(Command::Apply("Change shutter", vec![set(new.clone())]));
    }
    let Some(shutter) = &mut new.shutter else { return };
    let mut readout_ms = shutter.readout_s * 1e3;
    let changed = number(
        ui,
        t("Read-out"),
        t("Read-out time"),
        &mut readout_ms,
        0.0..=1000.0,
        " ms",
        1,
    );
    shutter.readout_s = readout_ms / 1e3;
    field(&changed, "Change shutter", set(new.clone()), commands);
    ui.horizontal(|ui| {
        caption(ui, t("Read"));
        let now = new.shutter.map(|s| s.direction);
        let title = READ_OUTS
            .iter()
            .find(|(d, _)| Some(*d) == now)
            .map_or("", |r| t(r.1));
        ui.menu_button(title, |ui| {
            for (direction, title) in READ_OUTS {
                if ui.button(t(title)).clicked() {
                    let mut new = new.clone();
                    if let Some(shutter) = &mut new.shutter {
                        shutter.direction = direction;
                    }
                    commands.push(Command::Apply("Change shutter", vec![set(new)]));
                    ui.close();
                }
            }
        });
    });
}
