//! Layout templates: streets with lanes, sidewalks, crossings and junctions, varied by a seed.

use glam::DVec2;

use scene::draw::Draw;
use scene::raster::{draw_polyline, line_cells, polygon_cells};
use scene::{BevLayer, BevLayout, Extent, Polyline, PolylineKind, Window};

/// Names that [`layout`] knows.
pub const TEMPLATES: [&str; 8] = [
    "straight",
    "curve",
    "t-junction",
    "intersection",
    "roundabout",
    "highway",
    "parking",
    "suburb",
];

/// One street: an axis with lanes on both sides.
#[derive(Clone, Debug)]
struct Street {
    axis: Vec<DVec2>,
    forward: usize, // lanes right of the axis, driven along it
    backward: usize,
    lane_m: f64,
    walk_m: f64,     // width of the sidewalks, 0 = none
    parking_m: f64,  // strip between lanes and sidewalk
    shoulder_m: f64, // drivable beyond the lanes
}

impl Street {
    fn right_m(&self) -> f64 {
        self.forward as f64 * self.lane_m + self.shoulder_m
    }
    fn left_m(&self) -> f64 {
        self.backward as f64 * self.lane_m + self.shoulder_m
    }
}

/// Reach of streets from the ego, m.
const FAR_M: f64 = 75.0;

/// Measures that the streets of a layout share.
struct Usual {
    lanes: usize, // each way
    lane_m: f64,
    walk_m: f64,
    parking_m: f64,
}

impl Usual {
    fn street(&self, axis: Vec<DVec2>) -> Street {
        Street {
            axis,
            forward: self.lanes,
            backward: self.lanes,
            lane_m: self.lane_m,
            walk_m: self.walk_m,
            parking_m: self.parking_m,
            shoulder_m: 0.4,
        }
    }
}

/// Streets and areas of a layout before they become cells.
#[derive(Default)]
struct StreetPlan {
    streets: Vec<Street>,
    junctions: Vec<(DVec2, f64)>, // centre and radius without lane lines
    crossings: Vec<Vec<DVec2>>,
    aprons: Vec<Vec<DVec2>>, // drivable polygons
    lots: Vec<Vec<DVec2>>,   // car parks
    islands: Vec<(DVec2, f64)>,
}

/// The polyline shifted to its left by `offset` (negative: right).
pub fn offset_line(points: &[DVec2], offset: f64) -> Vec<DVec2> {
    let n = points.len();
    (0..n)
        .map(|i| {
            let d = (points[(i + 1).min(n - 1)] - points[i.saturating_sub(1)]).normalize_or(DVec2::X);
            points[i] + d.perp() * offset
        })
        .collect()
}

fn straight(from: DVec2, to: DVec2) -> Vec<DVec2> {
    let n = ((to - from).length() / 1.5).ceil().max(1.0);
    (0..=n as usize).map(|i| from.lerp(to, i as f64 / n)).collect()
}

fn arc(center: DVec2, radius: f64, from: f64, to: f64) -> Vec<DVec2> {
    let n = ((to - from).abs() * radius / 1.5).ceil().max(2.0);
    (0..=n as usize)
        .map(|i| center + DVec2::from_angle(from + (to - from) * i as f64 / n) * radius)
        .collect()
}

/// The layout `name` of [`TEMPLATES`] varied by `seed`: widths, lanes, angles, crossings.
/// The ego stands in a right-hand lane at the origin. `None` for an unknown name.
pub fn layout(name: &str, seed: u64) -> Option<BevLayout> {
    layout_with_room(name, seed, 0.0)
}

/// The layout of [`layout`] with at least `room_m` of the ego's street before a roundabout begins.
pub fn layout_with_room(name: &str, seed: u64, room_m: f64) -> Option<BevLayout> {
    let mut draw = Draw::new(seed, name);
    let mut plan = StreetPlan::default();
    let lane_m = draw.range(3.1, 3.8);
    let walk_m = if draw.chance(0.85) {
        draw.range(1.6, 4.0)
    } else {
        0.0
    };
    let parking_m = if draw.chance(0.4) {
        draw.range(2.1, 2.6)
    } else {
        0.0
    };
    let lanes = 1 + draw.weighted(&[0.6, 0.4]);
    let usual = Usual {
        lanes,
        lane_m,
        walk_m,
        parking_m,
    };
    let street = |axis: Vec<DVec2>| usual.street(axis);
    // The ego drives in the innermost or outermost right-hand lane.
    let ego_lane = draw.below(lanes) as f64 + 0.5;
    let y = ego_lane * lane_m;
    let far = FAR_M;
    let here = DVec2::new(-far, y);
    match name {
        "straight" | "suburb" => {
            let mut s = street(straight(here, DVec2::new(far, y)));
            if name == "suburb" {
                suburb(&mut plan, &mut draw, &mut s, lane_m);
            }
            if draw.chance(0.5) {
                crossing(&mut plan, &s, draw.range(8.0, 25.0), draw.range(2.5, 4.0));
            }
            plan.streets.push(s);
        }
        "curve" => curve(&mut plan, &mut draw, &usual, y),
        "t-junction" | "intersection" => {
            let x = draw.range(10.0, 26.0);
            let center = DVec2::new(x, y);
            let tilt = draw.range(-0.25, 0.25);
            let across = DVec2::from_angle(std::f64::consts::FRAC_PI_2 + tilt);
            plan.streets.push(street(straight(here, DVec2::new(far, y))));
            let both = name == "intersection";
            let side = if both || draw.chance(0.5) { 1.0 } else { -1.0 };
            let mut other = street(straight(
                if both { center - across * far } else { center },
                center + across * (far * side),
            ));
            if draw.chance(0.5) {
                (other.forward, other.backward) = (1, 1);
            }
            plan.streets.push(other);
            junction(&mut plan, &mut draw, center, both, side, across);
        }
        "roundabout" => roundabout(&mut plan, &mut draw, &usual, y, room_m),
        "highway" => highway(&mut plan, &mut draw, lane_m),
        "parking" => parking(&mut plan, &mut draw, &usual, y),
        _ => return None,
    }
    Some(plan.draw())
}

/// One lane each way, and driveways.
fn suburb(plan: &mut StreetPlan, draw: &mut Draw, s: &mut Street, lane_m: f64) {
    let far = FAR_M;
    (s.forward, s.backward, s.parking_m) = (1, 1, 0.0);
    s.axis = straight(DVec2::new(-far, lane_m / 2.0), DVec2::new(far, lane_m / 2.0));
    for _ in 0..4 {
        // Driveways.
        let (x, side) = (draw.range(-35.0, 35.0), if draw.chance(0.5) { 1.0 } else { -1.0 });
        let (w, edge) = (draw.range(2.8, 4.0), lane_m / 2.0 + side * lane_m);
        let end = edge + side * draw.range(9.0, 14.0);
        plan.aprons.push(vec![
            DVec2::new(x, edge - side),
            DVec2::new(x + w, edge - side),
            DVec2::new(x + w, end),
            DVec2::new(x, end),
        ]);
    }
}

/// A bend to the left or the right.
fn curve(plan: &mut StreetPlan, draw: &mut Draw, usual: &Usual, y: f64) {
    let (here, street) = (DVec2::new(-FAR_M, y), |axis| usual.street(axis));
    let radius = draw.range(25.0, 90.0) * if draw.chance(0.5) { 1.0 } else { -1.0 };
    let start = draw.range(-15.0, 10.0);
    let center = DVec2::new(start, y + radius);
    let quarter = -std::f64::consts::FRAC_PI_2 * radius.signum();
    let sweep = (1.35f64).min(90.0 / radius.abs()) * radius.signum();
    let mut axis = straight(here, DVec2::new(start, y));
    let bend = arc(center, radius.abs(), quarter, quarter + sweep);
    let end = bend[bend.len() - 1];
    let away = (end - bend[bend.len() - 2]).normalize_or(DVec2::X);
    axis.extend(&bend[1..]);
    axis.extend(&straight(end, end + away * 80.0)[1..]);
    plan.streets.push(street(axis));
}

/// A ring of one lane with two to four arms.
fn roundabout(plan: &mut StreetPlan, draw: &mut Draw, usual: &Usual, y: f64, room_m: f64) {
    let (far, walk_m, street) = (FAR_M, usual.walk_m, |axis| usual.street(axis));
    let radius = draw.range(9.0, 14.0);
    let mut center = DVec2::new(draw.range(18.0, 26.0), y);
    let ring_width = draw.range(5.5, 7.5);
    if room_m > 0.0 {
        center.x = center.x.max(room_m + radius + ring_width / 2.0);
    }
    let arms = [0.0, 1.0, 2.0, 3.0].map(|k: f64| k * std::f64::consts::FRAC_PI_2 + std::f64::consts::PI);
    for (k, angle) in arms.into_iter().enumerate() {
        if k > 0 && draw.chance(0.15) {
            continue;
        }
        let jitter = if k == 0 { 0.0 } else { draw.range(-0.2, 0.2) };
        let d = DVec2::from_angle(angle + jitter);
        let mut arm = street(straight(center + d * far, center + d * (radius + 2.0)));
        arm.parking_m = 0.0;
        plan.streets.push(arm);
    }
    let ring = arc(center, radius, 0.0, std::f64::consts::TAU);
    plan.streets.push(Street {
        // Counter-clockwise traffic: lanes right of a counter-clockwise axis.
        axis: offset_line(&ring, ring_width / 2.0),
        forward: 1,
        backward: 0,
        lane_m: ring_width,
        walk_m,
        parking_m: 0.0,
        shoulder_m: 0.2,
    });
    plan.junctions.push((center, radius + ring_width / 2.0 + 5.0));
    plan.islands.push((center, radius - ring_width / 2.0));
}

/// Two carriageways with a strip between them.
fn highway(plan: &mut StreetPlan, draw: &mut Draw, lane_m: f64) {
    let far = FAR_M;
    let n = 2 + draw.below(3);
    let own = draw.below(n) as f64 + 0.5;
    let gap = draw.range(1.5, 5.0);
    let (a, b) = (own * lane_m + gap / 2.0, DVec2::new(far, 0.0));
    let bend = draw.range(-0.15, 0.15);
    let line = |offset: f64| -> Vec<DVec2> {
        straight(-b, b)
            .into_iter()
            .map(|p| DVec2::new(p.x, offset + bend * p.x * p.x / 160.0))
            .collect()
    };
    let lanes = |axis, forward, backward| Street {
        axis,
        forward,
        backward,
        lane_m,
        walk_m: 0.0,
        parking_m: 0.0,
        shoulder_m: 2.2,
    };
    let mut right = lanes(line(a - gap / 2.0), n, 0);
    let mut left = lanes(line(a + gap / 2.0), 0, n);
    right.shoulder_m = draw.range(0.8, 3.0);
    left.shoulder_m = right.shoulder_m;
    plan.streets.extend([right, left]);
}

/// A car park beside the street, with a gate.
fn parking(plan: &mut StreetPlan, draw: &mut Draw, usual: &Usual, y: f64) {
    let Usual {
        lanes,
        lane_m,
        walk_m,
        parking_m,
    } = *usual;
    let far = FAR_M;
    let here = DVec2::new(-far, y);
    let street = |axis| usual.street(axis);
    let s = street(straight(here, DVec2::new(far, y)));
    let side = if draw.chance(0.5) { 1.0 } else { -1.0 };
    let edge = y + side * (lanes as f64 * lane_m + parking_m + walk_m + 0.4);
    let (x0, x1) = (draw.range(-34.0, -15.0), draw.range(12.0, 34.0));
    let deep = draw.range(16.0, 24.0);
    let corner = |x, depth: f64| DVec2::new(x, edge + side * depth);
    plan.lots.push(vec![
        corner(x0, 0.0),
        corner(x1, 0.0),
        corner(x1, deep),
        corner(x0, deep),
    ]);
    let gate = draw.range(x0 + 4.0, x1 - 8.0);
    let inner = y + side * (lanes as f64 * lane_m - 0.5);
    plan.aprons.push(vec![
        DVec2::new(gate, inner),
        DVec2::new(gate + 6.0, inner),
        corner(gate + 6.0, 1.0),
        corner(gate, 1.0),
    ]);
    plan.streets.push(s);
}

/// A template of any kind, turned and shifted, for training on roads at every angle.
pub fn any_layout(seed: u64) -> BevLayout {
    let mut draw = Draw::new(seed, "any layout");
    let name = TEMPLATES[draw.below(TEMPLATES.len())];
    let plain = layout(name, draw.bits()).expect("a listed template");
    if draw.chance(0.3) {
        return plain;
    }
    transform(
        &plain,
        draw.range(-12.0, 12.0),
        draw.range(-6.0, 6.0),
        draw.range(-3.2, 3.2),
    )
}

/// The layout seen from a pose inside it: shifted by metres, then turned by rad. Cells that come
/// from outside continue the border, which keeps roads running to the edge.
fn transform(layout: &BevLayout, dx: f64, dy: f64, yaw: f64) -> BevLayout {
    let turn = DVec2::from_angle(yaw);
    let shift = DVec2::new(dx, dy);
    let mut cells = vec![0; Window::COLUMNS];
    for x in 0..Window::NX {
        for y in 0..Window::NY {
            let p = turn.rotate(Window::center(x, y, 0).truncate()) + shift;
            let p = p.clamp(DVec2::splat(-39.9), DVec2::splat(39.9));
            let [sx, sy] = Window::column_at(p.x, p.y).expect("clamped into the grid");
            cells[x * Window::NY + y] = layout.cell(sx, sy);
        }
    }
    let back = DVec2::new(turn.x, -turn.y);
    let polylines = layout
        .polylines
        .iter()
        .map(|line| Polyline {
            kind: line.kind,
            points_m: line.points_m.iter().map(|p| back.rotate(*p - shift)).collect(),
        })
        .collect();
    BevLayout::from_cells(cells, polylines).expect("40,000 cells")
}

/// A crossing over a street at distance `at` along x from the ego.
fn crossing(plan: &mut StreetPlan, s: &Street, at: f64, width: f64) {
    let Some(i) = s.axis.iter().position(|p| p.x > at) else {
        return;
    };
    let d = (s.axis[(i + 1).min(s.axis.len() - 1)] - s.axis[i - 1]).normalize_or(DVec2::X);
    let (l, r) = (
        s.axis[i] + d.perp() * s.left_m(),
        s.axis[i] - d.perp() * s.right_m(),
    );
    plan.crossings.push(vec![l, r, r + d * width, l + d * width]);
}

/// Adds a junction: rounds its corners, clears the lane lines and puts crossings on its arms.
fn junction(plan: &mut StreetPlan, draw: &mut Draw, center: DVec2, both: bool, side: f64, across: DVec2) {
    let widest = plan
        .streets
        .iter()
        .map(|s| s.left_m().max(s.right_m()))
        .fold(0.0, f64::max);
    let parking = plan.streets[0].parking_m;
    let radius = widest + parking + 3.5;
    plan.junctions.push((center, radius));
    let mut corner_arms = vec![DVec2::X, across * side, -DVec2::X];
    if both {
        corner_arms.push(-across * side);
        corner_arms.push(DVec2::X);
    }
    for pair in corner_arms.windows(2) {
        // A triangle between neighbouring arms, rounding the corner.
        let reach = widest + 3.5;
        plan.aprons
            .push(vec![center, center + pair[0] * reach, center + pair[1] * reach]);
    }
    let with_crossings = draw.chance(0.75);
    let arms: Vec<(DVec2, usize)> = [
        (DVec2::X, 0),
        (-DVec2::X, 0),
        (across * side, 1),
        (-across * side, 1),
    ]
    .into_iter()
    .take(if both { 4 } else { 3 })
    .collect();
    for (d, street) in arms {
        if with_crossings && draw.chance(0.85) {
            let s = &plan.streets[street];
            let half = s.left_m().max(s.right_m());
            let start = center + d * (radius - 0.5);
            let n = d.perp() * half;
            plan.crossings.push(vec![
                start + n,
                start - n,
                start - n + d * 3.0,
                start + n + d * 3.0,
            ]);
        }
    }
}

/// Calls back with every cell of a shape.
type Visitor<'a> = &'a dyn Fn(&mut dyn FnMut(usize, usize));

impl StreetPlan {
    fn draw(self) -> BevLayout {
        let mut out = BevLayout::default();
        let mut paint = |layer: BevLayer, visit: Visitor<'_>| {
            let mut cells = Vec::new();
            visit(&mut |x, y| cells.push((x, y)));
            for (x, y) in cells {
                out.set(layer, x, y, true);
            }
        };
        for s in &self.streets {
            let middle = (s.left_m() - s.right_m()) / 2.0;
            let half = (s.left_m() + s.right_m()) / 2.0;
            let line = offset_line(&s.axis, middle);
            if s.walk_m > 0.0 {
                let reach = half + s.parking_m + s.walk_m;
                paint(BevLayer::Walkway, &|f| {
                    line_cells(Extent::WINDOW, &line, reach, f)
                });
            }
            if s.parking_m > 0.0 {
                paint(BevLayer::CarparkArea, &|f| {
                    line_cells(Extent::WINDOW, &line, half + s.parking_m, f)
                });
            }
            paint(BevLayer::DrivableArea, &|f| {
                line_cells(Extent::WINDOW, &line, half, f)
            });
        }
        for apron in &self.aprons {
            paint(BevLayer::DrivableArea, &|f| {
                polygon_cells(Extent::WINDOW, apron, f)
            });
        }
        for lot in &self.lots {
            paint(BevLayer::CarparkArea, &|f| polygon_cells(Extent::WINDOW, lot, f));
        }
        // One surface per cell: road over car park over sidewalk; islands have no surface.
        for x in 0..Window::NX {
            for y in 0..Window::NY {
                let p = Window::center(x, y, 0).truncate();
                if self.islands.iter().any(|(c, r)| p.distance(*c) < *r) {
                    for layer in [BevLayer::DrivableArea, BevLayer::Walkway, BevLayer::CarparkArea] {
                        out.set(layer, x, y, false);
                    }
                }
                if out.has(BevLayer::DrivableArea, x, y) {
                    out.set(BevLayer::CarparkArea, x, y, false);
                    out.set(BevLayer::Walkway, x, y, false);
                } else if out.has(BevLayer::CarparkArea, x, y) {
                    out.set(BevLayer::Walkway, x, y, false);
                }
            }
        }
        let lines = self.lines();
        for line in &lines {
            draw_polyline(&mut out, line);
        }
        BevLayout::from_cells(out.cells().to_vec(), lines).expect("40,000 cells")
    }

    fn lines(&self) -> Vec<Polyline> {
        let mut lines = Vec::new();
        let clear = |p: &DVec2| self.junctions.iter().all(|(c, r)| p.distance(*c) > *r);
        let mut push = |kind, points: Vec<DVec2>, clip: bool| {
            // Parts outside junctions and inside the grid (with a margin) become lines of their own.
            let keep = |p: &DVec2| p.abs().max_element() < 45.0 && (!clip || clear(p));
            for run in points.split(|p| !keep(p)) {
                if run.len() > 1 {
                    lines.push(Polyline {
                        kind,
                        points_m: run.to_vec(),
                    });
                }
            }
        };
        for s in &self.streets {
            if s.forward > 0 && s.backward > 0 {
                push(PolylineKind::RoadDivider, s.axis.clone(), true);
            }
            for (lanes, side) in [(s.forward, -1.0), (s.backward, 1.0)] {
                for i in 0..lanes {
                    if i > 0 {
                        let at = side * i as f64 * s.lane_m;
                        push(PolylineKind::LaneDivider, offset_line(&s.axis, at), true);
                    }
                    let mut center = offset_line(&s.axis, side * (i as f64 + 0.5) * s.lane_m);
                    if side > 0.0 {
                        center.reverse();
                    }
                    push(PolylineKind::LaneCenter, center, false);
                }
            }
        }
        for points_m in &self.crossings {
            lines.push(Polyline {
                kind: PolylineKind::PedCrossing,
                points_m: points_m.clone(),
            });
        }
        lines
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_template_puts_the_ego_on_a_road() {
        for name in TEMPLATES {
            for seed in 0..20 {
                let l = layout(name, seed).expect("listed");
                assert!(l.has(BevLayer::DrivableArea, 100, 100), "{name} {seed}");
                assert!(l.count(BevLayer::DrivableArea) > 2500, "{name} {seed}");
                assert!(l.polylines.iter().any(|p| p.kind == PolylineKind::LaneCenter));
                for c in l.cells() {
                    let surfaces = [BevLayer::DrivableArea, BevLayer::Walkway, BevLayer::CarparkArea];
                    assert!(surfaces.iter().filter(|s| c & s.bit() != 0).count() <= 1);
                }
            }
            assert_eq!(layout(name, 7), layout(name, 7));
        }
        assert!(layout("nowhere", 0).is_none());
    }
}
