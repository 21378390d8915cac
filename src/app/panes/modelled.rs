//! Draws over the bird's-eye view the parts that were computed for the last edit: tokens of the network, inpainted
//! columns, changed bricks, and sampled pieces of LiDAR rays. The rest was not computed.

use egui::{Color32, Painter, Rect, Stroke, StrokeKind, pos2};
use glam::dvec2;

use super::compare::tag;
use crate::canvas::ScreenMap;
use crate::shell::tuning::LastEdit;
use language::tf;
use scene::Window;
use scene::grid::{BRICK, bricks_along};
use sensors::lidar::learned_caster::Sampled;

/// Tokens along a side of the map.
const TOKENS: usize = 25;

/// Draws these parts, and a line with their numbers.
pub fn draw(ui: &egui::Ui, area: Rect, map: &ScreenMap, last: &LastEdit, sampled: Option<&Sampled>) {
    let painter: Painter = ui.painter_at(area);
    let squares = |x: usize, y: usize, columns: usize| {
        let corner = |x: usize, y: usize| {
            let at = |i: usize| Window::MIN_M[0] + i as f64 * Window::VOXEL_M;
            map.to_screen(dvec2(at(x), at(y)))
        };
        Rect::from_two_pos(
            corner(x * columns, y * columns),
            corner((x + 1) * columns, (y + 1) * columns),
        )
    };
    let blue = Color32::from_rgb(70, 150, 255);
    let side = Window::NX / TOKENS;
    for token in &last.tokens {
        let rect = squares(token / TOKENS, token % TOKENS, side);
        painter.rect(
            rect,
            0.0,
            blue.gamma_multiply(0.16),
            Stroke::new(1.0, blue.gamma_multiply(0.6)),
            StrokeKind::Inside,
        );
    }
    let yellow = Color32::from_rgb(255, 200, 40).gamma_multiply(0.35);
    for (i, _) in last.region.columns.iter().enumerate().filter(|(_, c)| **c) {
        painter.rect_filled(squares(i / Window::NY, i % Window::NY, 1), 0.0, yellow);
    }
    let bricks = bricks_along(scene::Extent::WINDOW);
    let green = Stroke::new(1.5, Color32::from_rgb(60, 220, 120));
    for brick in &last.bricks {
        painter.rect_stroke(
            squares(brick / bricks[1], brick % bricks[1], BRICK),
            0.0,
            green,
            StrokeKind::Inside,
        );
    }
    let orange = Stroke::new(1.0, Color32::from_rgb(255, 130, 40).gamma_multiply(0.7));
    for segment in sampled.iter().flat_map(|s| &s.segments) {
        painter.line_segment(segment.map(|p| map.to_screen(p.truncate())), orange);
    }
    let text = tf!(
        "{tokens} of {all_tokens} tokens (blue)  ·  {columns} columns (yellow)  ·  {bricks} of {all_bricks} bricks (green)",
        tokens = last.tokens.len(),
        all_tokens = TOKENS * TOKENS,
        columns = last.report.region_columns,
        bricks = last.bricks.len(),
        all_bricks = bricks[0] * bricks[1],
    );
    if let Some(s) = sampled {
        let text = tf!(
            "{rays} of {all} LiDAR rays shot, sampled on {percent} % of their way (orange)",
            rays = s.rays,
            all = s.of,
            percent = format!("{:.0}", 100.0 * s.share)
        );
        tag(ui, pos2(area.left() + 8.0, area.top() + 32.0), &text, false);
    }
    tag(ui, pos2(area.left() + 8.0, area.top() + 8.0), &text, false);
}
