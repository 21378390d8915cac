//! The legend of a camera picture: the classes in it, or the scale of depths.

use egui::{Color32, Rect, Ui, pos2, vec2};

use language::t;
use scene::Class;
use sensors::cameras::{CameraPicture, DEPTH_M, ViewId, perceived};
use sensors::perceive::pictures::{GHOST, MISSED};
use sensors::pictures::color::ramp;
use widgets::theme;

/// Most classes in the legend.
const MOST: usize = 9;
/// Depths at which the scale has a mark, m.
const MARKS_M: [f32; 5] = [2.0, 5.0, 10.0, 25.0, 60.0];

/// Draws the legend into the lower right corner of a picture. Views without a legend get none.
pub(super) fn draw(ui: &Ui, over: Rect, picture: &CameraPicture, view: ViewId) {
    match picture {
        CameraPicture::Maps(_) if view == ViewId::DEPTH => depths(ui, over),
        CameraPicture::Maps(maps) => classes(ui, over, &shown(&maps.semantic)),
        CameraPicture::Picture(_) if view == perceived::VIEW.id => {
            let rows = [(MISSED, "missed"), (GHOST, "a thing where there is none")];
            let rows = rows.map(|([r, g, b], what)| (Color32::from_rgb(r, g, b), t(what).to_owned()));
            named(ui, over, rows.into());
        }
        _ => {}
    }
}

/// The classes of a picture, the most frequent first. Pixels without a class are left out.
fn shown(labels: &[u8]) -> Vec<Class> {
    let mut counts = [0u32; 256];
    labels.iter().for_each(|l| counts[usize::from(*l)] += 1);
    let mut all: Vec<(u32, Class)> = (0..=255u8)
        .filter_map(|id| Some((counts[usize::from(id)], Class::from_id(id)?)))
        .filter(|(n, class)| *n > 0 && *class != Class::Free && *class != Class::Others)
        .collect();
    all.sort_by_key(|c| std::cmp::Reverse(c.0));
    all.into_iter().take(MOST).map(|c| c.1).collect()
}

fn classes(ui: &Ui, over: Rect, classes: &[Class]) {
    let rows = classes
        .iter()
        .map(|c| (theme::class_color(*c), t(&c.label()).to_owned()));
    named(ui, over, rows.collect());
}

/// Draws colours with their names.
fn named(ui: &Ui, over: Rect, rows: Vec<(Color32, String)>) {
    let font = egui::TextStyle::Small.resolve(ui.style());
    let painter = ui.painter_at(over);
    let layout =
        |text: String| painter.layout_no_wrap(theme::sentence(&text), font.clone(), theme::ON_CANVAS);
    let rows: Vec<_> = rows
        .into_iter()
        .map(|(color, text)| (color, layout(text)))
        .collect();
    let width = rows.iter().map(|r| r.1.size().x).fold(0.0, f32::max) + 28.0;
    let line = font.size + 4.0;
    let size = vec2(width, line * rows.len() as f32 + 6.0);
    let rect = Rect::from_min_size(over.right_bottom() - size - vec2(6.0, 6.0), size);
    painter.rect_filled(rect, 3.0, Color32::from_black_alpha(170));
    for (i, (color, galley)) in rows.into_iter().enumerate() {
        let top = rect.top() + 3.0 + line * i as f32;
        let swatch = Rect::from_min_size(pos2(rect.left() + 6.0, top + 2.0), vec2(10.0, line - 5.0));
        painter.rect_filled(swatch, 2.0, color);
        painter.galley(pos2(swatch.right() + 6.0, top), galley, theme::ON_CANVAS);
    }
}

fn depths(ui: &Ui, over: Rect) {
    const STEPS: usize = 48;
    let font = egui::TextStyle::Small.resolve(ui.style());
    let painter = ui.painter_at(over);
    let size = vec2(190.0f32.min(over.width() - 12.0), font.size + 20.0);
    let rect = Rect::from_min_size(over.right_bottom() - size - vec2(6.0, 6.0), size);
    painter.rect_filled(rect, 3.0, Color32::from_black_alpha(170));
    let bar = Rect::from_min_size(rect.min + vec2(12.0, 5.0), vec2(rect.width() - 30.0, 8.0));
    let (near, far) = (DEPTH_M.0.ln(), DEPTH_M.1.ln());
    let x = |t: f32| bar.left() + bar.width() * t;
    for k in 0..STEPS {
        let (a, b) = (k as f32 / STEPS as f32, (k + 1) as f32 / STEPS as f32);
        let [r, g, b_] = ramp(a);
        let part = Rect::from_min_max(pos2(x(a), bar.top()), pos2(x(b), bar.bottom()));
        painter.rect_filled(part, 0.0, Color32::from_rgb(r, g, b_));
    }
    for m in MARKS_M {
        let at = x((m.ln() - near) / (far - near));
        let text = if m == DEPTH_M.1 {
            format!("{m:.0} m")
        } else {
            format!("{m:.0}")
        };
        painter.text(
            pos2(at, bar.bottom() + 2.0),
            egui::Align2::CENTER_TOP,
            text,
            font.clone(),
            theme::ON_CANVAS,
        );
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_classes_of_most_pixels_come_first() {
        let (car, road) = (Class::Car.id(), Class::DriveableSurface.id());
        let labels = [vec![road; 5], vec![car; 2], vec![Class::FREE; 9], vec![200; 3]].concat();
        assert_eq!(shown(&labels), [Class::DriveableSurface, Class::Car]);
    }
}
