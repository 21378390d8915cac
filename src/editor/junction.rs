//! Where a new street crosses an old one: the columns that belong to both, and lines cut where they pass through them.

use glam::DVec2;

use scene::distance::nearest_source;
use scene::{BevLayer, BevLayout, Extent, Polyline, PolylineKind, raster};

/// From this angle between two streets on they cross; below it one is drawn along the other, to widen or renew it.
const CROSSES_RAD: f64 = 0.44;
/// How far from its lines a carriageway reaches at most, m. Without lines nearby nobody knows which way it runs.
const REACH_M: f64 = 8.0;
/// Share of a crossing from which on it is one of the junction's.
const CROSSING_WITHIN: f64 = 0.3;
/// Lines are looked at in steps of this length, m: a quarter of a cell.
const STEP_M: f64 = 0.1;

/// The columns `[x, y]` among `band` that are road already, of a road that runs another way than the line `middle_m`.
pub(super) fn crossed(layout: &BevLayout, middle_m: &[DVec2], band: &[[usize; 2]]) -> Vec<[usize; 2]> {
    let mut cells = band.to_vec();
    // Parking strips belong to the street that they line.
    let road = BevLayer::DrivableArea.bit() | BevLayer::CarparkArea.bit();
    cells.retain(|[x, y]| layout.cell(*x, *y) & road != 0);
    if cells.is_empty() {
        return cells;
    }
    let lengthwise = |l: &&Polyline| {
        matches!(
            l.kind,
            PolylineKind::LaneCenter | PolylineKind::RoadDivider | PolylineKind::LaneDivider
        )
    };
    let old = layout.polylines.iter().filter(lengthwise);
    let (Some(old), Some(new)) = (
        Ways::of(layout.extent(), old.map(|l| &l.points_m[..])),
        Ways::of(layout.extent(), std::iter::once(middle_m)),
    ) else {
        return Vec::new();
    };
    cells.retain(|&[x, y]| {
        let [old, new] = [old.at(x, y), new.at(x, y)];
        let near = old.0 <= REACH_M;
        near && old.1.dot(new.1).abs() < CROSSES_RAD.cos()
    });
    cells
}

/// For every column the direction of the nearest of some lines.
struct Ways {
    extent: Extent,
    directions: Vec<DVec2>,
    nearest: Vec<u32>,
}

impl Ways {
    /// `None` if no line touches the grid.
    fn of<'a>(extent: Extent, lines: impl Iterator<Item = &'a [DVec2]>) -> Option<Self> {
        let mut directions = vec![DVec2::ZERO; extent.columns()];
        for pair in lines.flat_map(|l| l.windows(2)) {
            let direction = (pair[1] - pair[0]).normalize_or_zero();
            raster::line_cells(extent, pair, Extent::VOXEL_M, |x, y| {
                directions[extent.index(x, y)] = direction;
            });
        }
        let nearest = nearest_source(extent, |c| directions[c] != DVec2::ZERO)?;
        Some(Self {
            extent,
            directions,
            nearest,
        })
    }

    /// Distance to the nearest line, m, and its direction there.
    fn at(&self, x: usize, y: usize) -> (f64, DVec2) {
        let extent = self.extent;
        let nearest = self.nearest[extent.index(x, y)] as usize;
        let [i, j] = extent.column(nearest);
        let apart = extent.center(x, y, 0).distance(extent.center(i, j, 0));
        (apart, self.directions[nearest])
    }
}

/// The painted crossings that lie in an area by more than [`CROSSING_WITHIN`], whole: nobody crosses within a junction.
pub(super) fn crossings_in(layout: &BevLayout, area: &Area) -> Vec<[usize; 2]> {
    let painted = |[x, y]: [usize; 2]| layout.has(BevLayer::PedCrossing, x, y);
    let extent = layout.extent();
    let (mut seen, mut found) = (vec![false; extent.columns()], Vec::new());
    for start in extent.all_columns().filter(|at| painted(*at) && area.holds(*at)) {
        let (mut crossing, mut open) = (Vec::new(), vec![start]);
        while let Some(at) = open.pop() {
            if !painted(at) || std::mem::replace(&mut seen[extent.index(at[0], at[1])], true) {
                continue;
            }
            crossing.push(at);
            let [x, y] = at;
            open.extend([[x.saturating_sub(1), y], [(x + 1).min(extent.nx() - 1), y]]);
            open.extend([[x, y.saturating_sub(1)], [x, (y + 1).min(extent.ny() - 1)]]);
        }
        let within = crossing.iter().filter(|at| area.holds(**at)).count();
        if within as f64 > CROSSING_WITHIN * crossing.len() as f64 {
            found.extend(crossing);
        }
    }
    found
}

/// Cells as a set that is asked often.
pub(super) struct Area {
    extent: Extent,
    covered: Vec<bool>,
}

impl Area {
    pub(super) fn new(extent: Extent, cells: &[[usize; 2]]) -> Self {
        let mut covered = vec![false; extent.columns()];
        for &[x, y] in cells {
            covered[extent.index(x, y)] = true;
        }
        Self { extent, covered }
    }

    /// The cells and those that touch them: lines that end here do not reach in with their width.
    pub(super) fn around(extent: Extent, cells: &[[usize; 2]]) -> Self {
        let mut grown = Vec::new();
        for &[x, y] in cells {
            for i in x.saturating_sub(1)..=(x + 1).min(extent.nx() - 1) {
                grown.extend((y.saturating_sub(1)..=(y + 1).min(extent.ny() - 1)).map(|j| [i, j]));
            }
        }
        Self::new(extent, &grown)
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

    /// What of a line lies outside, in its order.
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
    // Points lie within 10 km; what is not finite counts as one step.
    ((pair[0].distance(pair[1]) / STEP_M).ceil().min(1e5) as usize).max(1)
}

/// Takes the lines of a layer away where they pass through the cells, and the outlines of crossings most of which lies there.
pub(super) fn cut_lines(layout: &mut BevLayout, layer: BevLayer, cells: &[[usize; 2]]) {
    if layer == BevLayer::PedCrossing {
        return drop_outlines(layout, &Area::new(layout.extent(), cells));
    }
    let kind = match layer {
        BevLayer::RoadDivider => PolylineKind::RoadDivider,
        BevLayer::LaneDivider => PolylineKind::LaneDivider,
        BevLayer::StopLine => PolylineKind::StopLine,
        _ => return,
    };
    let area = Area::new(layout.extent(), cells);
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

fn drop_outlines(layout: &mut BevLayout, area: &Area) {
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
