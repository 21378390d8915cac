//! Lines cut where they pass through columns.

use glam::DVec2;

use scene::{BevLayer, BevLayout, Extent, Polyline, PolylineKind, raster};

/// Lines are looked at in steps of this length, m: a quarter of a cell.
const STEP_M: f64 = 0.1;

/// Cells as a set that is asked often.
pub(super) struct CellSet {
    extent: Extent,
    covered: Vec<bool>,
}

impl CellSet {
    pub(super) fn new(extent: Extent, cells: &[[usize; 2]]) -> Self {
        let mut covered = vec![false; extent.columns()];
        for &[x, y] in cells {
            covered[extent.index(x, y)] = true;
        }
        Self { extent, covered }
    }

    pub(super) fn holds(&self, [x, y]: [usize; 2]) -> bool {
        self.covered[self.extent.index(x, y)]
    }

    /// True within; `None` beyond the map.
    pub(super) fn at(&self, p_m: DVec2) -> Option<bool> {
        let cell = self.extent.column_at(p_m.x, p_m.y)?;
        Some(self.holds(cell))
    }

    fn has(&self, p_m: DVec2) -> bool {
        let cell = self.extent.column_at(p_m.x, p_m.y);
        cell.is_some_and(|cell| self.holds(cell))
    }

    /// True if a line passes through.
    pub(super) fn touches(&self, points_m: &[DVec2]) -> bool {
        points_m.windows(2).any(|pair| {
            let n = steps(pair);
            (0..=n).any(|i| self.has(pair[0].lerp(pair[1], i as f64 / n as f64)))
        })
    }

    /// The pieces of a line outside the area, in their order.
    pub(super) fn outside(&self, points_m: &[DVec2]) -> Vec<Vec<DVec2>> {
        let mut pieces: Vec<Vec<DVec2>> = Vec::new();
        let mut piece: Vec<DVec2> = Vec::new();
        // Within a straight stretch only its ends are kept.
        let mut replaceable = false;
        for (k, pair) in points_m.windows(2).enumerate() {
            let n = steps(pair);
            for i in usize::from(k > 0)..=n {
                let p_m = pair[0].lerp(pair[1], i as f64 / n as f64);
                if self.has(p_m) {
                    pieces.push(std::mem::take(&mut piece));
                    replaceable = false;
                    continue;
                }
                if replaceable {
                    piece.pop();
                }
                replaceable = !piece.is_empty() && i < n;
                piece.push(p_m);
            }
        }
        pieces.push(piece);
        pieces.retain(|p| p.len() > 1 && p.windows(2).any(|w| w[0].distance(w[1]) > 2.0 * STEP_M));
        pieces
    }
}

fn steps(pair: &[DVec2]) -> usize {
    // Points lie within 10 km; a length that is not finite counts as one step.
    ((pair[0].distance(pair[1]) / STEP_M).ceil().min(1e5) as usize).max(1)
}

/// Takes the lines of a layer away where they pass through the cells, and the outlines of crossings most of which lies there.
pub(super) fn cut_lines(layout: &mut BevLayout, layer: BevLayer, cells: &[[usize; 2]]) {
    if layer == BevLayer::PedCrossing {
        return drop_outlines(layout, &CellSet::new(layout.extent(), cells));
    }
    let kind = match layer {
        BevLayer::RoadDivider => PolylineKind::RoadDivider,
        BevLayer::LaneDivider => PolylineKind::LaneDivider,
        BevLayer::StopLine => PolylineKind::StopLine,
        _ => return,
    };
    let area = CellSet::new(layout.extent(), cells);
    let is_cut = |l: &Polyline| l.kind == kind && area.touches(&l.points_m);
    if !layout.polylines.iter().any(is_cut) {
        return;
    }
    let mut kept = Vec::new();
    for line in layout.polylines.iter() {
        if is_cut(line) {
            let pieces = area.outside(&line.points_m).into_iter();
            kept.extend(pieces.map(|points_m| Polyline { kind, points_m }));
        } else {
            kept.push(line.clone());
        }
    }
    layout.polylines = kept.into();
}

fn drop_outlines(layout: &mut BevLayout, area: &CellSet) {
    let is_gone = |l: &Polyline| {
        let (mut all, mut within) = (0, 0);
        if l.kind == PolylineKind::PedCrossing {
            raster::polygon_cells(area.extent, &l.points_m, |x, y| {
                all += 1;
                within += usize::from(area.holds([x, y]));
            });
        }
        2 * within > all
    };
    if layout.polylines.iter().any(is_gone) {
        let kept = layout.polylines.iter().filter(|l| !is_gone(l)).cloned();
        layout.polylines = kept.collect::<Vec<_>>().into();
    }
}
