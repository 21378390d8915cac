//! The plot of time against error, in the window and as a picture without one.

use egui::{Align2, RichText, Ui, Vec2, vec2};
use egui_plot::{GridMark, Line, Plot, PlotPoint, PlotPoints, PlotUi, Points, Text, VLine};

use crate::picture::RgbaPicture;
use calibration::figures::{percent, seconds};
use calibration::plan::TradeoffPoint;
use language::t;
use widgets::theme;

/// Published wall times for comparison with ours, s: all on graphics cards.
pub const ANCHORS: [(f64, &str); 1] = [(3.25, "X-Scene, 20 steps\non an A6000: 3.25 s")];
/// Smallest error of the plot; the reference has none, and is drawn here.
const LEAST_ERROR: f64 = 1e-4;

fn log(v: f64) -> f64 {
    v.clamp(LEAST_ERROR, 1e6).log10()
}

/// Grid marks at decades and, within them, at 2 and 5.
fn decades(low: f64, high: f64) -> Vec<GridMark> {
    let mut marks = Vec::new();
    for decade in low.floor() as i32 - 1..=high.ceil() as i32 {
        for (factor, size) in [(1.0, 1.0), (2.0f64, 0.3), (5.0, 0.3)] {
            let value = f64::from(decade) + factor.log10();
            if (low..=high).contains(&value) {
                marks.push(GridMark {
                    value,
                    step_size: size,
                });
            }
        }
    }
    marks
}

/// Least width of the plot at which the names of presets carry their numbers, points.
const ROOM_FOR_NUMBERS: f32 = 520.0;
/// Height of such a name, in decades of the error.
const LABEL_DECADES: f64 = 0.14;

/// Draws the plot. `current` is the preset in use; `last` is the time of the last edit and, if measured, its error.
pub fn front_plot(
    ui: &mut Ui,
    marks: &[TradeoffPoint],
    current: Option<&str>,
    last: Option<(f64, Option<f64>)>,
    size: Vec2,
) {
    let plot = Plot::new("trade")
        .width(size.x)
        .height(size.y)
        .allow_scroll(false)
        .allow_drag(false)
        .allow_zoom(false)
        .allow_boxed_zoom(false)
        .show_crosshair(false)
        .x_grid_spacer(|input| decades(input.bounds.0, input.bounds.1))
        .y_grid_spacer(|input| decades(input.bounds.0, input.bounds.1))
        .x_axis_formatter(|mark, _| seconds(10f64.powf(mark.value)))
        .y_axis_formatter(|mark, _| t(&percent(10f64.powf(mark.value))).to_owned())
        .x_axis_label(RichText::new(t("time of an edit")).small())
        .y_axis_label(RichText::new(t("voxels that differ from the reference")).small())
        .y_axis_min_width(44.0)
        .grid_spacing(6.0..=120.0)
        .grid_color(theme::text_weak().gamma_multiply(0.35))
        .include_x(ANCHORS[0].0.log10() + 0.12)
        .include_x(marks.iter().map(|m| log(m.wall_s[0])).fold(-1.0, f64::min) - 0.45)
        .include_y(LEAST_ERROR.log10())
        .set_margin_fraction(vec2(0.05, 0.09));
    let (weak, accent) = (theme::text_weak(), theme::accent());
    plot.show(ui, |plot| {
        for (s, name) in ANCHORS {
            plot.vline(
                VLine::new(name, log(s))
                    .color(weak.gamma_multiply(0.5))
                    .width(1.0),
            );
            let top = marks
                .iter()
                .map(|m| log(m.error[2]))
                .fold(f64::NEG_INFINITY, f64::max);
            let at = PlotPoint::new(log(s) - 0.02, top);
            plot.text(
                Text::new(name, at, RichText::new(t(name)).small())
                    .color(weak)
                    .anchor(Align2::RIGHT_TOP),
            );
        }
        let right = marks
            .iter()
            .map(|m| log(m.wall_s[0]))
            .fold(ANCHORS[0].0.log10(), f64::max);
        // Names of presets alternate above and below the line.
        let mut nth = 0u32;
        for mark in marks.iter().filter(|m| m.error[0].is_finite()) {
            draw_point(plot, mark, current);
            if let Some(preset) = &mark.preset {
                let here = current == Some(preset.as_str());
                draw_name(plot, mark, preset, here, size.x >= ROOM_FOR_NUMBERS, right, nth);
                nth += 1;
            }
        }
        let mut front: Vec<[f64; 2]> = marks
            .iter()
            .filter(|m| m.preset.is_some())
            .map(|m| [log(m.wall_s[0]), log(m.error[0])])
            .collect();
        front.sort_by(|a, b| a[0].total_cmp(&b[0]));
        plot.line(
            Line::new("front", PlotPoints::from(front))
                .color(accent.gamma_multiply(0.5))
                .width(1.5)
                .allow_hover(false),
        );
        if let Some((s, error)) = last {
            match error {
                Some(e) => plot.points(
                    Points::new(t("last edit"), vec![[log(s), log(e)]])
                        .color(theme::warn())
                        .radius(5.0),
                ),
                None => plot.vline(VLine::new("last edit", log(s)).color(theme::warn()).width(1.5)),
            }
        }
    });
}

/// Draws one setting: its median and its intervals, with a ring if it is the preset in use.
fn draw_point(plot: &mut PlotUi<'_>, mark: &TradeoffPoint, current: Option<&str>) {
    let color = if mark.on_front {
        theme::accent()
    } else {
        theme::text_weak().gamma_multiply(0.6)
    };
    let [s, s_low, s_high] = mark.wall_s.map(log);
    let [e, e_low, e_high] = mark.error.map(log);
    let faint = color.gamma_multiply(0.5);
    for ends in [[[s_low, e], [s_high, e]], [[s, e_low], [s, e_high]]] {
        plot.line(
            Line::new("interval", PlotPoints::from(ends.to_vec()))
                .color(faint)
                .width(1.0)
                .allow_hover(false),
        );
    }
    let radius = if mark.preset.is_some() { 5.0 } else { 2.5 };
    plot.points(
        Points::new(t(&mark.name), vec![[s, e]])
            .color(color)
            .radius(radius),
    );
    if let Some(preset) = mark
        .preset
        .as_ref()
        .filter(|preset| current == Some(preset.as_str()))
    {
        let ring = Points::new(t(preset), vec![[s, e]])
            .filled(false)
            .color(theme::text_strong())
            .radius(8.0);
        plot.points(ring);
    }
}

/// Draws the name of a preset beside its point, with its numbers if they fit; the list of presets shows them too.
fn draw_name(
    plot: &mut PlotUi<'_>,
    mark: &TradeoffPoint,
    preset: &str,
    here: bool,
    with_numbers: bool,
    right: f64,
    nth: u32,
) {
    let (s, e) = (log(mark.wall_s[0]), log(mark.error[0]));
    let text = RichText::new(match with_numbers {
        false => t(preset).to_owned(),
        true => format!(
            "{}\n{}, {}",
            t(preset),
            seconds(mark.wall_s[0]),
            t(&percent(mark.error[0]))
        ),
    });
    let text = if here { text.small().strong() } else { text.small() };
    // The names of the last points stand to their left, where there is room.
    let late = s > right - 0.35;
    // The second of two names below the line stands one line lower.
    let (below, lower) = (nth % 2 == 1, f64::from(nth / 2) * LABEL_DECADES);
    let (dx, dy, anchor) = match (late, below) {
        (true, _) => (-0.03, 0.02, Align2::RIGHT_BOTTOM),
        (_, true) => (-0.03, -0.02 - lower, Align2::RIGHT_TOP),
        _ => (0.03, 0.02, Align2::LEFT_BOTTOM),
    };
    let color = if here { theme::text_strong() } else { theme::text() };
    let at = PlotPoint::new(s + dx, e + dy);
    plot.text(Text::new(preset.to_owned(), at, text).color(color).anchor(anchor));
}

/// The plot as a picture of `points` size, with two pixels per point.
pub fn picture(marks: &[TradeoffPoint], points: [f32; 2]) -> RgbaPicture {
    let ctx = egui::Context::default();
    theme::apply(&ctx, theme::Theme::Light);
    crate::paint::picture(&ctx, points, 2.0, |ui| {
        let frame = egui::Frame::new().fill(theme::panel()).inner_margin(10.0);
        frame.show(ui, |ui| {
            let size = vec2(points[0] - 20.0, points[1] - 20.0);
            front_plot(ui, marks, None, None, size);
        });
    })
}
