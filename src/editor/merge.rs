//! One layer of the map becomes part of another.

use scene::{BevLayer, BevLayout, Edit, Polyline, PolylineKind, Shape};

/// Edits that make a layer part of another, as one step: its cells are painted with the other layer and its lines
/// become lines of that kind. Empty if the layer has no cells, if both layers are the same, or if one of the two comes
/// from boxes.
pub fn merge(layout: &BevLayout, from: BevLayer, into: BevLayer) -> Vec<Edit> {
    let cells: Vec<[usize; 2]> = layout
        .extent()
        .all_columns()
        .filter(|[x, y]| layout.has(from, *x, *y))
        .collect();
    if cells.is_empty() || from == into || from.is_object() || into.is_object() {
        return Vec::new();
    }
    let paint = |layer, value| Edit::PaintBev {
        layer,
        shape: Shape::Cells(cells.clone()),
        value,
    };
    let mut edits = vec![paint(from, false), paint(into, true)];
    if let (Some(old), Some(kind)) = (line_of(from), line_of(into)) {
        let lines = layout.polylines.iter().filter(|line| line.kind == old);
        let lines: Vec<Polyline> = lines
            .map(|line| Polyline {
                kind,
                points_m: line.points_m.clone(),
            })
            .collect();
        if !lines.is_empty() {
            edits.push(Edit::AddPolylines { lines });
        }
    }
    edits
}

/// The open lines that draw a layer.
fn line_of(layer: BevLayer) -> Option<PolylineKind> {
    match layer {
        BevLayer::RoadDivider => Some(PolylineKind::RoadDivider),
        BevLayer::LaneDivider => Some(PolylineKind::LaneDivider),
        BevLayer::StopLine => Some(PolylineKind::StopLine),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Document;
    use scene::{Frame, Scene, VoxelGrid};
    use std::sync::Arc;

    fn document() -> Document {
        let mut layout = BevLayout::default();
        for x in 40..60 {
            for y in 80..90 {
                layout.set(BevLayer::Walkway, x, y, true);
            }
            layout.set(BevLayer::LaneDivider, x, 100, true);
        }
        let start_m = layout.extent().center(40, 100, 0).truncate();
        let end_m = layout.extent().center(59, 100, 0).truncate();
        layout.polylines = Arc::new(vec![Polyline {
            kind: PolylineKind::LaneDivider,
            points_m: vec![start_m, end_m],
        }]);
        let frame = Frame::new(layout, Default::default(), VoxelGrid::new());
        Document::new(Scene::single("s", frame, Arc::default(), 0))
    }

    #[test]
    fn a_layer_becomes_part_of_another_in_one_step() {
        let mut document = document();
        let before = document.scene().frame().clone();
        let edits = merge(&before.layout, BevLayer::Walkway, BevLayer::CarparkArea);
        document
            .apply_all("Merge layers", &edits)
            .expect("both are painted");
        let layout = &document.scene().frame().layout;
        assert_eq!(layout.count(BevLayer::Walkway), 0);
        assert_eq!(layout.count(BevLayer::CarparkArea), 200);
        assert_eq!(document.history().len(), 2);
        document.undo();
        assert!(document.scene().frame().layout == before.layout);
    }

    #[test]
    fn lines_become_lines_of_the_other_kind() {
        let mut document = document();
        let layout = document.scene().frame().layout.clone();
        let edits = merge(&layout, BevLayer::LaneDivider, BevLayer::RoadDivider);
        document
            .apply_all("Merge layers", &edits)
            .expect("both are painted");
        let layout = &document.scene().frame().layout;
        let kinds: Vec<_> = layout.polylines.iter().map(|line| line.kind).collect();
        assert_eq!(kinds, [PolylineKind::RoadDivider]);
        assert_eq!(layout.count(BevLayer::LaneDivider), 0);
        assert!(layout.count(BevLayer::RoadDivider) >= 20);
    }

    #[test]
    fn what_cannot_be_merged_makes_no_edit() {
        let layout = document().scene().frame().layout.clone();
        for (from, into) in [
            (BevLayer::StopLine, BevLayer::Walkway),
            (BevLayer::Walkway, BevLayer::Walkway),
            (BevLayer::Walkway, BevLayer::Car),
        ] {
            assert!(merge(&layout, from, into).is_empty(), "{from:?} into {into:?}");
        }
    }
}
