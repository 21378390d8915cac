//! Lines and crossings on the road at sub-voxel precision: distances to the layout's polylines, and
//! whole cells where a user painted a line that has no polyline. A cell whose bit was erased, with all
//! its neighbours, shows no line even if a polyline runs there.

use glam::DVec2;

use scene::appearance::{AppearanceData, AppearanceSection};
use scene::sensor_data::RenderId;
use scene::{BevLayer, BevLayout, Extent, PolylineKind};

use crate::raycast::units::Units;

/// Half the width of a line in the label maps, m: a cell, as in the layout and in the splats.
pub const HALF_LINE_M: f64 = 0.2;
/// Edge of a bin.
const BIN_M: f64 = 2.0;
const BIN_COLUMNS: usize = 5;
/// Segments are listed in every bin within this distance, m.
const REACH_M: f64 = 1.0;

/// A piece of a line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Segment {
    /// Start, ego frame, m.
    pub a: DVec2,
    /// End, ego frame, m.
    pub b: DVec2,
    /// Kind of the line.
    pub kind: PolylineKind,
    /// Length of the line up to `a`, m.
    pub along_m: f64,
}

/// The nearest line of a kind.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Nearest {
    /// Distance, m.
    pub distance_m: f64,
    /// Length of the line up to the foot of the perpendicular, m.
    pub along_m: f64,
}

/// All paint of a layout.
#[derive(Clone, Debug, Default)]
pub struct RoadMarkings {
    extent: Extent,
    units: Units,
    /// Lower corner, m.
    low: DVec2,
    along: [usize; 2],
    bins: Vec<Vec<Segment>>, // [x][y]
    crossings: Vec<Crossing>,
    allowed: Vec<u32>,
    orphans: Vec<u32>,
}

/// A crossing's outline.
#[derive(Clone, Debug)]
pub struct Crossing {
    outline: Vec<DVec2>,
    low: DVec2,
    high: DVec2,
    /// Unit vector along its longer side: the way that people walk, across the road.
    pub along: DVec2,
}

impl Crossing {
    fn new(points: &[DVec2]) -> Option<Self> {
        let outline: Vec<DVec2> = points.iter().copied().filter(|p| p.is_finite()).collect();
        if outline.len() < 3 {
            return None;
        }
        let n = outline.len();
        let edges = (0..n).map(|i| outline[(i + 1) % n] - outline[i]);
        let longest = edges.max_by(|a, b| a.length_squared().total_cmp(&b.length_squared()))?;
        Some(Self {
            low: outline.iter().fold(DVec2::INFINITY, |m, p| m.min(*p)),
            high: outline.iter().fold(DVec2::NEG_INFINITY, |m, p| m.max(*p)),
            along: longest.normalize_or(DVec2::X),
            outline,
        })
    }

    /// True inside the outline (even-odd).
    pub fn contains(&self, p: DVec2) -> bool {
        if !(p.cmpge(self.low).all() && p.cmple(self.high).all()) {
            return false;
        }
        let n = self.outline.len();
        let crosses = |i: usize| {
            let (a, b) = (self.outline[i], self.outline[(i + 1) % n]);
            (a.y > p.y) != (b.y > p.y) && p.x < a.x + (p.y - a.y) / (b.y - a.y) * (b.x - a.x)
        };
        (0..n).filter(|i| crosses(*i)).count() % 2 == 1
    }
}

fn layer_of(kind: PolylineKind) -> Option<BevLayer> {
    match kind {
        PolylineKind::LaneCenter | PolylineKind::SpeedLimit { .. } => None,
        PolylineKind::RoadDivider => Some(BevLayer::RoadDivider),
        PolylineKind::LaneDivider => Some(BevLayer::LaneDivider),
        PolylineKind::StopLine => Some(BevLayer::StopLine),
        PolylineKind::PedCrossing => Some(BevLayer::PedCrossing),
    }
}

impl RoadMarkings {
    /// The paint of a layout. Vertices that are not finite and segments without length are skipped.
    pub fn new(layout: &BevLayout) -> Self {
        let extent = layout.extent();
        let along = Self::bins_along(extent);
        let mut paint = Self {
            extent,
            units: Units::from_extent(extent),
            low: extent.min_m().truncate(),
            along,
            bins: vec![Vec::new(); along[0] * along[1]],
            ..Self::default()
        };
        for line in layout.polylines.iter() {
            if line.kind == PolylineKind::PedCrossing {
                paint.crossings.extend(Crossing::new(&line.points_m));
            } else if layer_of(line.kind).is_some() {
                let mut along_m = 0.0;
                for pair in line.points_m.windows(2) {
                    let (a, b, kind) = (pair[0], pair[1], line.kind);
                    let length = a.distance(b);
                    if length > 0.0 && length.is_finite() {
                        paint.insert(Segment { a, b, kind, along_m });
                        along_m += length;
                    }
                }
            }
        }
        paint.compare_with_cells(layout);
        paint
    }

    /// Bins of lines along x and y; they begin at the lower corner.
    pub fn bins_along(extent: Extent) -> [usize; 2] {
        [extent.nx(), extent.ny()].map(|n| n.div_ceil(BIN_COLUMNS))
    }

    fn insert(&mut self, s: Segment) {
        let (low, high) = (s.a.min(s.b) - REACH_M, s.a.max(s.b) + REACH_M);
        let bins = |axis: usize| {
            let n = self.along[axis] as f64;
            let bin = |p: DVec2| ((p[axis] - self.low[axis]) / BIN_M).floor().clamp(-1.0, n);
            bin(low).max(0.0) as usize..(bin(high) + 1.0).min(n) as usize
        };
        let (along_x, along_y) = (bins(0), bins(1));
        for x in along_x {
            for y in along_y.clone() {
                self.bins[x * self.along[1] + y].push(s);
            }
        }
    }

    fn compare_with_cells(&mut self, layout: &BevLayout) {
        let (extent, cells) = (self.extent, layout.cells());
        let at = |x: usize, y: usize| match extent.holds(x, y) {
            true => cells[extent.index(x, y)],
            false => 0,
        };
        let kinds = [
            PolylineKind::RoadDivider,
            PolylineKind::LaneDivider,
            PolylineKind::StopLine,
        ];
        self.allowed = vec![0; cells.len()];
        self.orphans = vec![0; cells.len()];
        let bits = kinds
            .iter()
            .filter_map(|k| layer_of(*k))
            .fold(BevLayer::PedCrossing.bit(), |b, l| b | l.bit());
        for (i, &cell) in cells.iter().enumerate() {
            let [x, y] = extent.column(i);
            let around = (0..9).map(|k| at((x + k / 3).wrapping_sub(1), (y + k % 3).wrapping_sub(1)));
            self.allowed[i] = around.fold(0, |a, b| a | b) & bits;
            if cell & bits == 0 {
                continue;
            }
            let p = extent.center(x, y, 0).truncate();
            for kind in kinds {
                let bit = layer_of(kind).map_or(0, BevLayer::bit);
                let near = || self.nearest(kind, p).is_some_and(|n| n.distance_m < 0.5);
                if cell & bit != 0 && !near() {
                    self.orphans[i] |= bit;
                }
            }
            let corners = || {
                [-0.25, 0.25]
                    .map(|dx| [-0.25, 0.25].map(|dy| self.crossing_at(p + DVec2::new(dx, dy)).is_some()))
            };
            let bit = BevLayer::PedCrossing.bit();
            if cell & bit != 0 && !corners().as_flattened().contains(&true) {
                self.orphans[i] |= bit;
            }
        }
    }

    /// Packs the paint for the graphics card.
    pub fn pack(&self, out: &mut AppearanceData) {
        let bits = |v: f64| (v as f32).to_bits();
        let mut starts = vec![0];
        let mut segments = Vec::new();
        for bin in &self.bins {
            for s in bin {
                let [ax, ay, bx, by] = [s.a.x, s.a.y, s.b.x, s.b.y].map(bits);
                segments.extend([ax, ay, bx, by, s.kind.drawn_as(), bits(s.along_m)]);
            }
            starts.push((segments.len() / 6) as u32);
        }
        starts.resize(self.bins.len() + 1, (segments.len() / 6) as u32);
        out.push(AppearanceSection::BinStarts, starts);
        out.push(AppearanceSection::Segments, segments);
        let (mut crossings, mut outlines) = (Vec::new(), Vec::new());
        for c in &self.crossings {
            crossings.extend([(outlines.len() / 2) as u32, c.outline.len() as u32]);
            crossings.extend(
                [c.low, c.high, c.along]
                    .iter()
                    .flat_map(|p| [bits(p.x), bits(p.y)]),
            );
            outlines.extend(c.outline.iter().flat_map(|p| [bits(p.x), bits(p.y)]));
        }
        out.push(AppearanceSection::Crossings, crossings);
        out.push(AppearanceSection::Outlines, outlines);
        out.at[AppearanceSection::CrossingCount as usize] = self.crossings.len() as u32;
        for (section, of) in [
            (AppearanceSection::Allowed, &self.allowed),
            (AppearanceSection::Orphans, &self.orphans),
        ] {
            let mut cells = of.clone();
            cells.resize(self.extent.columns(), 0);
            out.push(section, cells);
        }
    }

    /// The nearest line of `kind` to a point of the ego frame, if one is within 1 m.
    pub fn nearest(&self, kind: PolylineKind, p: DVec2) -> Option<Nearest> {
        let at = ((p - self.low) / BIN_M).floor();
        let [along_x, along_y] = self.along;
        let inside = (0.0..along_x as f64).contains(&at.x) && (0.0..along_y as f64).contains(&at.y);
        let list = match inside {
            true => &self.bins[at.x as usize * along_y + at.y as usize],
            false => return None,
        };
        let mut best: Option<Nearest> = None;
        for s in list.iter().filter(|s| s.kind == kind) {
            let d = s.b - s.a;
            let t = ((p - s.a).dot(d) / d.length_squared()).clamp(0.0, 1.0);
            let distance_m = p.distance(s.a + d * t);
            if distance_m <= REACH_M && best.is_none_or(|b| distance_m < b.distance_m) {
                let along_m = s.along_m + t * d.length();
                best = Some(Nearest { distance_m, along_m });
            }
        }
        best
    }

    /// The crossing whose outline holds a point.
    pub fn crossing_at(&self, p: DVec2) -> Option<&Crossing> {
        self.crossings.iter().find(|c| c.contains(p))
    }

    /// True if the layout allows `layer` at a point: its bit is set in the cell or beside it.
    pub fn allows(&self, layer: BevLayer, p: DVec2) -> bool {
        self.bits(&self.allowed, p) & layer.bit() != 0
    }

    /// True if the cell under a point was painted with `layer` where no polyline runs.
    pub fn is_orphan(&self, layer: BevLayer, p: DVec2) -> bool {
        self.bits(&self.orphans, p) & layer.bit() != 0
    }

    fn bits(&self, of: &[u32], p: DVec2) -> u32 {
        let at = self.units.index_at(p).and_then(|i| of.get(i));
        at.copied().unwrap_or(0)
    }

    /// Render id of the paint at a point of the road: 17 crossing, 18 road divider, 19 lane divider,
    /// later ones win, as in the splats.
    pub fn render_id(&self, p: DVec2) -> Option<RenderId> {
        if self.bits(&self.allowed, p) == 0 {
            return None;
        }
        let line = |kind: PolylineKind, layer: BevLayer| {
            self.is_orphan(layer, p)
                || self.allows(layer, p) && self.nearest(kind, p).is_some_and(|n| n.distance_m <= HALF_LINE_M)
        };
        let crossing = BevLayer::PedCrossing;
        if line(PolylineKind::LaneDivider, BevLayer::LaneDivider) {
            Some(19)
        } else if line(PolylineKind::RoadDivider, BevLayer::RoadDivider) {
            Some(18)
        } else if self.is_orphan(crossing, p) || self.allows(crossing, p) && self.crossing_at(p).is_some() {
            Some(17)
        } else {
            None
        }
    }
}
