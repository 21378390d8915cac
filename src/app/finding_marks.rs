//! Marks a finding of the checks in the large views: its voxels, its box or its place, while it is hovered or chosen in
//! the list.

use egui::{Color32, Painter, Pos2, Rect, Shape, Stroke, StrokeKind};
use glam::{DVec2, DVec3};

use super::canvas::ScreenMap;
use editor::apply_all;
use editor::checks::Finding;
use scene::{BoxId, Frame, Scene, SceneBox};
use viewport::MarkedVoxels;

/// Colour of the marks in both views; no class and no layer has this colour.
const COLOR: [u8; 3] = [255, 70, 255];
/// Colour of the boxes as a repair leaves them.
const REPAIRED: Color32 = Color32::from_rgb(90, 230, 120);
/// Smallest size of a mark, points. A smaller one would be overlooked.
const LEAST: f32 = 9.0;

/// The marks of one finding.
#[derive(Clone, Debug, PartialEq)]
pub struct FindingMarks {
    /// Marked voxels.
    pub cells: Vec<[usize; 3]>,
    /// Marked box.
    pub box_id: Option<BoxId>,
    /// Centre of the finding, ego frame, m.
    pub where_m: DVec3,
    /// Boxes as the first repair leaves them.
    pub becomes: Vec<SceneBox>,
}

/// The boxes that the first repair of a finding changes or adds, as it leaves them.
fn repaired(finding: &Finding, scene: &Scene) -> Vec<SceneBox> {
    let of_boxes = |fix: &&editor::checks::Fix| fix.edits.iter().any(|e| e.is_of_a_box());
    let Some(fix) = finding.fixes.first().filter(of_boxes) else {
        return Vec::new();
    };
    let mut after = scene.clone();
    if apply_all(&fix.edits, &mut after).is_err() {
        return Vec::new();
    }
    let before = &scene.frame().boxes;
    let new = after
        .frame()
        .boxes
        .values()
        .filter(|b| before.get(&b.id) != Some(b));
    new.filter(|b| b.problem().is_none()).copied().collect()
}

impl FindingMarks {
    /// The marks of a finding in a scene.
    pub fn by(finding: &Finding, scene: &Scene) -> Self {
        Self {
            becomes: repaired(finding, scene),
            cells: finding.cells.clone(),
            box_id: finding.box_id,
            where_m: finding.where_m,
        }
    }

    /// The marked voxels, for the 3D view.
    pub(super) fn brush(&self) -> MarkedVoxels<'_> {
        MarkedVoxels {
            voxels: &self.cells,
            color: COLOR,
        }
    }

    /// Draws the marks on the bird's-eye view: filled columns, and a frame around all of them that is never too small
    /// to be seen.
    pub(super) fn draw(&self, painter: &Painter, map: &ScreenMap, frame: &Frame) {
        let color = Color32::from_rgb(COLOR[0], COLOR[1], COLOR[2]);
        let mut around = Rect::NOTHING;
        let mut columns: Vec<[usize; 2]> = self.cells.iter().map(|[x, y, _]| [*x, *y]).collect();
        columns.sort_unstable();
        columns.dedup();
        let half = DVec2::splat(frame.extent().voxel_m() / 2.0);
        for [x, y] in columns {
            let middle = frame.extent().center(x, y, 0).truncate();
            let cell = map.rect_of(middle - half, middle + half);
            painter.rect_filled(cell, 0.0, color.gamma_multiply(0.8));
            around = around.union(cell);
        }
        if let Some(b) = self
            .box_id
            .and_then(|id| frame.boxes.get(&id))
            .filter(|b| b.problem().is_none())
        {
            let corners: Vec<Pos2> = b.footprint().iter().map(|p| map.to_screen(*p)).collect();
            corners.iter().for_each(|p| around.extend_with(*p));
            painter.add(Shape::convex_polygon(
                corners,
                color.gamma_multiply(0.35),
                Stroke::new(2.0, color),
            ));
        }
        for b in &self.becomes {
            let mut outline: Vec<Pos2> = b.footprint().iter().map(|p| map.to_screen(*p)).collect();
            outline.push(outline[0]);
            let ahead = b.center_m.truncate() + b.heading() * (b.size_m.x / 2.0);
            let nose = [b.center_m.truncate(), ahead].map(|p| map.to_screen(p));
            for line in [&outline[..], &nose[..]] {
                painter.extend(Shape::dashed_line(line, Stroke::new(2.0, REPAIRED), 5.0, 3.0));
            }
        }
        if !around.is_positive() {
            around = Rect::from_center_size(map.to_screen(self.where_m.truncate()), egui::Vec2::splat(2.0));
        }
        let grown = egui::Vec2::splat(LEAST).max(around.size() / 2.0 + egui::Vec2::splat(5.0));
        let ring = Rect::from_center_size(around.center(), 2.0 * grown);
        // A dark line below, or the frame would vanish on bright layers.
        painter.rect_stroke(
            ring,
            3.0,
            Stroke::new(4.0, Color32::from_black_alpha(130)),
            StrokeKind::Middle,
        );
        painter.rect_stroke(ring, 3.0, Stroke::new(2.0, color), StrokeKind::Middle);
    }
}
