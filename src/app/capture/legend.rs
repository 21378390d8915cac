//! Annotations of a picture: names of cameras, legend of colours, scale bar.

use std::collections::BTreeSet;

use egui::{Align2, Color32, FontId, Pos2, Rect, Stroke, Ui, pos2, vec2};

use language::t;
use scene::{BevLayer, Class, Scene};
use sensors::cameras::{DEPTH_M, ViewId};
use sensors::pictures::color::ramp;
use widgets::{fonts, theme};

use super::{BEHIND, CaptureOptions, Subject, above};
use crate::paint;
use crate::picture::RgbaPicture;

/// Height of a line, points.
const LINE: f32 = 20.0;
/// Margin around the legend, points.
const EDGE: f32 = 10.0;
/// Widest picture with one pixel per point. A wider one has more, so that letters keep their share of it.
const WIDE_PX: f32 = 1200.0;
const LETTERS: f32 = 13.0;
const DIM: Color32 = Color32::from_rgb(170, 176, 186);

/// A colour and what it means.
type LegendEntry = (Color32, String);

/// Pixels per point on a picture of a width, pixels.
fn pixels_per_point(width: usize) -> f32 {
    (width as f32 / WIDE_PX).max(1.0)
}

/// A picture drawn by egui: `show` on `size` points, with `pixels_per_point`.
fn drawn(size: [f32; 2], pixels_per_point: f32, show: impl FnMut(&mut Ui)) -> RgbaPicture {
    let ctx = egui::Context::default();
    theme::apply(&ctx, theme::Theme::Dark);
    fonts::apply(&ctx, language::chosen().map_or("", |l| &l.code));
    paint::picture(&ctx, size, pixels_per_point, show)
}

/// Writes a name into the upper left corner.
pub(super) fn name(picture: &mut RgbaPicture, name: &str) {
    let scale = pixels_per_point(picture.width);
    let wide = (name.chars().count() as f32 * LETTERS + 14.0).min(picture.width as f32 / scale);
    let mut right = 0.0f32;
    let label = drawn([wide, LINE], scale, |ui| {
        let [r, g, b] = BEHIND;
        ui.painter()
            .rect_filled(ui.ctx().content_rect(), 0.0, Color32::from_rgb(r, g, b));
        let font = FontId::proportional(LETTERS);
        let at = pos2(7.0, LINE / 2.0);
        let text = ui
            .painter()
            .text(at, Align2::LEFT_CENTER, name, font, Color32::WHITE);
        right = text.right() + 7.0;
    });
    let width = ((right * scale).ceil() as usize)
        .min(label.width)
        .min(picture.width);
    for row in 0..label.height.min(picture.height) {
        let from = row * label.width * 4;
        let to = row * picture.width * 4;
        picture.rgba[to..to + width * 4].copy_from_slice(&label.rgba[from..from + width * 4]);
    }
}

/// The legend below a picture of a width, pixels. `per_m` is the number of pixels per metre of a map.
pub(super) fn below(
    width: usize,
    per_m: Option<f32>,
    scene: &Scene,
    options: &CaptureOptions,
) -> RgbaPicture {
    let (pixels, scale) = (width, pixels_per_point(width));
    let width = pixels as f32 / scale;
    let per_m = per_m.map(|per_m| per_m / scale);
    let depths = options.subject == Subject::Cameras && options.view == ViewId::DEPTH;
    let entries = entries(scene, options);
    let mut height = LINE + 2.0 * EDGE;
    // The first pass measures the height, the second draws.
    let mut below = drawn([width, height], scale, |_| {});
    for _ in 0..2 {
        below = drawn([width, height], scale, |ui| {
            let [r, g, b] = BEHIND;
            ui.painter()
                .rect_filled(ui.ctx().content_rect(), 0.0, Color32::from_rgb(r, g, b));
            let mut at = pos2(EDGE, EDGE);
            at = caption(ui, at, scene);
            if let Some(per_m) = per_m {
                at = scale_bar(ui, at, per_m, width);
            }
            if depths {
                at = depth_bar(ui, at, width);
            }
            for entry in &entries {
                at = swatch(ui, at, entry, width);
            }
            height = at.y + LINE + EDGE;
        });
    }
    below
}

/// The entries of the legend: each colour and its meaning.
fn entries(scene: &Scene, options: &CaptureOptions) -> Vec<LegendEntry> {
    let frame = scene.frame();
    let of_class = |c: Class| (theme::class_color(c), theme::sentence(t(&c.label())));
    match options.subject {
        Subject::Lidar => Vec::new(),
        Subject::Cameras if options.view != ViewId::SEMANTIC => Vec::new(),
        Subject::Map => {
            let layers = BevLayer::MAP
                .into_iter()
                .filter(|l| frame.layout.count(*l) > 0)
                .map(|l| (theme::rgb(l.color()), theme::sentence(t(&l.label()))));
            let classes: BTreeSet<usize> = frame
                .boxes
                .values()
                .filter_map(|b| Class::OBJECTS.iter().position(|c| *c == b.class))
                .collect();
            let boxes = classes.into_iter().map(|i| of_class(Class::OBJECTS[i]));
            let ego = (
                theme::rgb(above::EGO_COLOR),
                theme::sentence(t("the ego vehicle")),
            );
            let beside = above::sceneries(scene).into_iter();
            let beside = beside.map(|c| {
                (
                    theme::rgb(above::scenery_color(c)),
                    theme::sentence(t(&c.label())),
                )
            });
            std::iter::once(ego)
                .chain(layers)
                .chain(boxes)
                .chain(beside)
                .collect()
        }
        _ => {
            let grid = &frame.occupancy;
            let [nx, ny, _] = grid.extent().shape();
            let mut seen = [false; 256];
            for (x, y) in (0..nx).flat_map(|x| (0..ny).map(move |y| (x, y))) {
                grid.column(x, y)
                    .iter()
                    .for_each(|v| seen[usize::from(*v)] = true);
            }
            let classes = (0..=255u8)
                .filter(|id| seen[usize::from(*id)])
                .filter_map(Class::from_id);
            classes.filter(|c| *c != Class::Free).map(of_class).collect()
        }
    }
}

/// Writes a text and returns its rectangle.
fn write(ui: &Ui, at: Pos2, text: &str, color: Color32) -> Rect {
    let font = FontId::proportional(LETTERS);
    ui.painter()
        .text(at + vec2(0.0, LINE / 2.0), Align2::LEFT_CENTER, text, font, color)
}

/// Writes the name of the scene and the moment. Returns where the next entry begins.
fn caption(ui: &Ui, at: Pos2, scene: &Scene) -> Pos2 {
    let text = match scene.clip().length_s > 0.0 {
        true => format!("{}   {:.1} s", scene.name, scene.time_s()),
        false => scene.name.to_string(),
    };
    pos2(write(ui, at, &text, Color32::WHITE).right() + 24.0, at.y)
}

/// The place of an entry of a width: on this line, or on the next.
fn fit(at: Pos2, wide: f32, width: f32) -> Pos2 {
    match at.x + wide > width - EDGE && at.x > EDGE {
        true => pos2(EDGE, at.y + LINE),
        false => at,
    }
}

fn swatch(ui: &Ui, at: Pos2, (color, name): &LegendEntry, width: f32) -> Pos2 {
    let font = FontId::proportional(LETTERS);
    let text = ui.painter().layout_no_wrap(name.clone(), font, DIM).size().x;
    let at = fit(at, text + 18.0, width);
    let square = Rect::from_min_size(at + vec2(0.0, 4.0), vec2(12.0, 12.0));
    ui.painter().rect_filled(square, 2.0, *color);
    pos2(write(ui, at + vec2(18.0, 0.0), name, DIM).right() + 16.0, at.y)
}

fn scale_bar(ui: &Ui, at: Pos2, per_m: f32, width: f32) -> Pos2 {
    let fits = |m: &f32| m * per_m <= (width / 5.0).min(160.0);
    let length_m = [1.0f32, 2.0, 5.0, 10.0, 20.0, 50.0, 100.0]
        .into_iter()
        .rfind(fits)
        .unwrap_or(1.0);
    let long = length_m * per_m;
    let at = fit(at, long + 60.0, width);
    let y = at.y + LINE / 2.0;
    let stroke = Stroke::new(2.0, Color32::WHITE);
    ui.painter().hline(at.x..=at.x + long, y, stroke);
    for x in [at.x, at.x + long] {
        ui.painter().vline(x, y - 4.0..=y + 4.0, stroke);
    }
    let text = write(ui, at + vec2(long + 8.0, 0.0), &format!("{length_m} m"), DIM);
    pos2(text.right() + 24.0, at.y)
}

fn depth_bar(ui: &Ui, at: Pos2, width: f32) -> Pos2 {
    const STEPS: usize = 64;
    const LONG: f32 = 192.0;
    let near = write(ui, fit(at, LONG + 110.0, width), &format!("{} m", DEPTH_M.0), DIM);
    let left = near.right() + 8.0;
    for i in 0..STEPS {
        let [r, g, b] = ramp(i as f32 / STEPS as f32);
        let step = LONG / STEPS as f32;
        let part = Rect::from_min_size(pos2(left + i as f32 * step, at.y + 5.0), vec2(step, 10.0));
        ui.painter().rect_filled(part, 0.0, Color32::from_rgb(r, g, b));
    }
    let far = write(
        ui,
        pos2(left + LONG + 8.0, at.y),
        &format!("{} m", DEPTH_M.1),
        DIM,
    );
    pos2(far.right() + 24.0, at.y)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::open;

    /// Rows of the first line of letters, pixels.
    fn letters_px(width: usize) -> usize {
        let scene = open::from_template("straight", 3).expect("a template");
        let options = CaptureOptions {
            subject: Subject::Map,
            ..CaptureOptions::default()
        };
        let legend = below(width, Some(10.0), &scene, &options);
        assert_eq!(legend.width, width);
        let rows = legend.rgba.chunks_exact(width * 4);
        let bright = |row: &[u8]| row.chunks_exact(4).any(|p| p[..3].iter().all(|v| *v > 220));
        rows.skip_while(|row| !bright(row))
            .take_while(|row| bright(row))
            .count()
    }

    #[test]
    fn letters_grow_with_the_picture() {
        let (small, large) = (letters_px(900), letters_px(3508));
        assert!((6..=20).contains(&small), "{small}");
        assert!(
            large * 10 >= small * 25 && large * 10 <= small * 35,
            "{small} {large}"
        );
    }
}
