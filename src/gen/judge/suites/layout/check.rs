//! An independent judge of placements: measures on the map what a reader of the prompt would. Shares no code with the
//! placer; its lanes are the layout's polylines as they are.

use glam::DVec2;

use scene::{BevLayer, BevLayout, Class, Paint, PolylineKind, SceneBox, Window};

/// A layout and the boxes on it.
pub struct Judge<'a> {
    pub layout: &'a BevLayout,
    pub boxes: &'a [SceneBox],
}

/// Target of a relation.
enum To {
    Point(DVec2, DVec2, f64), // centre, direction, half length
    Place(String),
}

impl Judge<'_> {
    fn at(&self, p: DVec2, layers: &[BevLayer]) -> bool {
        Window::column_at(p.x, p.y).is_some_and(|[x, y]| layers.iter().any(|l| self.layout.has(*l, x, y)))
    }

    /// Nearest point of all lane centres: distance, direction, and signed offset of the point from it (left positive).
    fn lane(&self, p: DVec2) -> Option<(f64, DVec2, DVec2)> {
        let mut best: Option<(f64, DVec2, DVec2)> = None;
        for line in self
            .layout
            .polylines
            .iter()
            .filter(|l| l.kind == PolylineKind::LaneCenter)
        {
            for w in line.points_m.windows(2) {
                let d = w[1] - w[0];
                if d.length() < 1e-6 {
                    continue;
                }
                let t = ((p - w[0]).dot(d) / d.length_squared()).clamp(0.0, 1.0);
                let q = w[0] + d * t;
                let far = q.distance(p);
                if best.as_ref().is_none_or(|b| far < b.0) {
                    best = Some((far, d.normalize(), q));
                }
            }
        }
        best
    }

    /// The polyline that the ego vehicle drives on.
    fn ego_lane(&self) -> Option<&[DVec2]> {
        let near = |l: &[DVec2]| {
            l.windows(2)
                .map(|w| {
                    let d = w[1] - w[0];
                    let t = (-w[0].dot(d) / d.length_squared().max(1e-9)).clamp(0.0, 1.0);
                    (w[0] + d * t).length() + if d.x > 0.0 { 0.0 } else { 100.0 }
                })
                .fold(f64::INFINITY, f64::min)
        };
        self.layout
            .polylines
            .iter()
            .filter(|l| l.kind == PolylineKind::LaneCenter)
            .map(|l| l.points_m.as_slice())
            .min_by(|a, b| near(a).total_cmp(&near(b)))
    }

    /// Offset to the left of the ego's lane, m.
    fn beside_ego(&self, p: DVec2) -> f64 {
        let Some(lane) = self.ego_lane() else {
            return p.y;
        };
        let mut best = (f64::INFINITY, p.y);
        for w in lane.windows(2) {
            let d = w[1] - w[0];
            let t = ((p - w[0]).dot(d) / d.length_squared().max(1e-9)).clamp(0.0, 1.0);
            let q = w[0] + d * t;
            if q.distance(p) < best.0 {
                best = (q.distance(p), d.normalize_or_zero().perp_dot(p - q));
            }
        }
        best.1
    }

    fn outlines(&self) -> impl Iterator<Item = &[DVec2]> {
        self.layout
            .polylines
            .iter()
            .filter(|l| l.kind == PolylineKind::PedCrossing)
            .map(|l| l.points_m.as_slice())
    }

    fn to_crossing(&self, p: DVec2) -> f64 {
        if self.at(p, &[BevLayer::PedCrossing]) {
            return 0.0;
        }
        let sides = self
            .outlines()
            .flat_map(|o| (0..o.len()).map(move |i| (o[i], o[(i + 1) % o.len()])));
        sides
            .map(|(a, b)| {
                let t = ((p - a).dot(b - a) / (b - a).length_squared().max(1e-9)).clamp(0.0, 1.0);
                (a + (b - a) * t).distance(p)
            })
            .fold(f64::INFINITY, f64::min)
    }

    /// Distance to the nearest place where lanes of different directions meet, m. At a roundabout the ego's lane ends a
    /// few metres before the ring.
    fn to_junction(&self, p: DVec2) -> f64 {
        [4.0, 8.0]
            .into_iter()
            .map(|gap_m| self.to_meeting(p, gap_m))
            .find(|d| d.is_finite())
            .unwrap_or(f64::INFINITY)
    }

    fn to_meeting(&self, p: DVec2, gap_m: f64) -> f64 {
        let Some(own) = self.ego_lane() else {
            return f64::INFINITY;
        };
        let mut best = f64::INFINITY;
        for line in self
            .layout
            .polylines
            .iter()
            .filter(|l| l.kind == PolylineKind::LaneCenter)
        {
            for w in line.points_m.windows(2) {
                let d = (w[1] - w[0]).normalize_or_zero();
                for v in own.windows(2) {
                    let e = (v[1] - v[0]).normalize_or_zero();
                    if d.dot(e).abs() < 0.8 && w[0].distance(v[0]) < gap_m {
                        best = best.min(w[0].distance(p));
                    }
                }
            }
        }
        best
    }

    fn is(class: &str, b: &SceneBox) -> bool {
        match class {
            "vehicle" => b.class.is_vehicle() || b.class == Class::Motorcycle,
            name => b.class.name() == name || Self::is_called(name, b),
        }
    }

    /// True if a box fits a name: a label such as "taxi", or paint with a class or label such as "red car" or "white
    /// garbage truck".
    fn is_called(name: &str, b: &SceneBox) -> bool {
        let paint = Paint::ALL.into_iter().find_map(|p| {
            let rest = name.strip_prefix(p.name())?.strip_prefix(' ')?;
            Some((p, rest))
        });
        match paint {
            Some((p, rest)) => {
                b.label.paint == Some(p) && (b.class.name() == rest || b.label.name.as_str() == rest)
            }
            None => b.label.name.as_str() == name,
        }
    }

    /// Number of boxes of a class.
    pub fn count(&self, class: &str) -> usize {
        self.boxes.iter().filter(|b| Self::is(class, b)).count()
    }

    /// True if at least `n` boxes of class `a` (all, if `None`) are in `relation` to `b` (and `c`). With `metres`, they
    /// must be at that distance, to 15 % or 2 m.
    pub fn holds(
        &self,
        a: &str,
        relation: &str,
        b: &str,
        c: Option<&str>,
        n: Option<usize>,
        metres: Option<f64>,
    ) -> bool {
        let all: Vec<&SceneBox> = self.boxes.iter().filter(|x| Self::is(a, x)).collect();
        let wanted = n.unwrap_or(all.len().max(1));
        let found = all.iter().filter(|x| self.one(x, relation, b, c, metres)).count();
        found >= wanted
    }

    fn targets(&self, name: &str, not: &SceneBox) -> Vec<To> {
        if name == "ego" {
            return vec![To::Point(DVec2::ZERO, DVec2::X, 2.0)];
        }
        let places = [
            "crossing",
            "sidewalk",
            "left_sidewalk",
            "right_sidewalk",
            "ego_lane",
            "left_lane",
            "right_lane",
            "oncoming_lane",
            "road",
            "roadside",
            "left_roadside",
            "right_roadside",
            "carpark",
            "junction",
            "cross_street",
        ];
        if places.contains(&name) {
            return vec![To::Place(name.to_string())];
        }
        self.boxes
            .iter()
            .filter(|x| Self::is(name, x) && x.id != not.id)
            .map(|x| {
                let course = if matches!(x.class, Class::Pedestrian | Class::TrafficCone | Class::Barrier) {
                    DVec2::X
                } else {
                    x.heading()
                };
                To::Point(x.center_m.truncate(), course, x.size_m.x / 2.0)
            })
            .collect()
    }

    fn one(&self, x: &SceneBox, relation: &str, b: &str, c: Option<&str>, metres: Option<f64>) -> bool {
        self.targets(b, x).iter().any(|to| match to {
            To::Point(at, course, half) => {
                let seconds: Vec<DVec2> = c
                    .map(|name| {
                        let list = self.targets(name, x);
                        list.iter()
                            .filter_map(|t| if let To::Point(p, ..) = t { Some(*p) } else { None })
                            .collect()
                    })
                    .unwrap_or_default();
                self.to_point(x, relation, *at, *course, *half, &seconds, metres)
            }
            To::Place(name) => self.to_place(x, relation, name),
        })
    }

    #[expect(
        clippy::too_many_arguments,
        reason = "what a relation says of one point: all of it is needed, once"
    )]
    fn to_point(
        &self,
        x: &SceneBox,
        relation: &str,
        at: DVec2,
        course: DVec2,
        half: f64,
        seconds: &[DVec2],
        metres: Option<f64>,
    ) -> bool {
        let p = x.center_m.truncate();
        let d = p - at;
        let (fwd, lat) = (course.dot(d), course.perp_dot(d));
        let own = x.size_m.x.max(x.size_m.y) / 2.0;
        let (held, far) = match relation {
            "ahead" => (fwd > half * 0.8 && lat.abs() < fwd.abs().max(4.0), fwd),
            "behind" => (fwd < -half * 0.8 && lat.abs() < fwd.abs().max(4.0), -fwd),
            "left" => (lat > 0.8, lat),
            "right" => (lat < -0.8, -lat),
            "near" => (d.length() < 9.0 + half + own, d.length()),
            "next_to" => (d.length() < 5.0 + half + own, d.length()),
            "far" => (d.length() > 18.0, d.length()),
            "at" => (true, d.length()),
            "facing" => (x.heading().dot(-d.normalize_or_zero()) > 0.6, d.length()),
            "away" => (x.heading().dot(-d.normalize_or_zero()) < -0.6, d.length()),
            "following" => (
                fwd < -half * 0.8 && lat.abs() < 2.5 && x.heading().dot(course) > 0.9,
                -fwd,
            ),
            "oncoming" => (x.heading().dot(course) < -0.85, d.length()),
            "same_direction" => (x.heading().dot(course) > 0.85, d.length()),
            "between" => {
                let held = seconds.iter().any(|q| {
                    let line = *q - at;
                    let t = d.dot(line) / line.length_squared().max(1e-9);
                    t > 0.05
                        && t < 0.95
                        && (line.normalize_or_zero().perp_dot(d)).abs() < (0.4 * line.length()).max(2.5)
                });
                (held, d.length())
            }
            "across" => ((self.beside_ego(p) - self.beside_ego(at)).abs() > 4.0, d.length()),
            _ => (false, 0.0),
        };
        held && metres.is_none_or(|m| (far - m).abs() <= (0.15 * m).max(2.0))
    }

    fn to_place(&self, x: &SceneBox, relation: &str, place: &str) -> bool {
        let p = x.center_m.truncate();
        let stands = x.velocity_mps.length() < 0.5;
        let side = self.beside_ego(p);
        let lane = self.lane(p);
        let lane_kind = |want: &str| {
            lane.as_ref().is_some_and(|(far, dir, _)| {
                let same = dir.dot(DVec2::X) > 0.0;
                let beside = side.abs() < 2.0;
                *far < 2.0
                    && match want {
                        "ego_lane" => beside,
                        "left_lane" => side > 2.0 && side < 6.0 && same,
                        "right_lane" => side < -2.0 && side > -6.0 && same,
                        "oncoming_lane" => !beside && !same,
                        _ => true,
                    }
            })
        };
        let edge = || {
            let near_edge = (0..24).any(|k| {
                let d = DVec2::from_angle(f64::from(k) * std::f64::consts::TAU / 24.0) * 3.2;
                !self.at(p + d, &[BevLayer::DrivableArea])
            });
            near_edge || self.at(p, &[BevLayer::CarparkArea])
        };
        let inside = match place {
            "crossing" => self.to_crossing(p) < 0.6,
            "sidewalk" => self.at(p, &[BevLayer::Walkway]),
            "left_sidewalk" => self.at(p, &[BevLayer::Walkway]) && side > 0.0,
            "right_sidewalk" => self.at(p, &[BevLayer::Walkway]) && side < 0.0,
            "carpark" => self.at(p, &[BevLayer::CarparkArea]),
            "road" => self.at(p, &[BevLayer::DrivableArea]),
            "roadside" => edge(),
            "left_roadside" => edge() && side > 0.0,
            "right_roadside" => edge() && side < 0.0,
            "junction" => self.to_junction(p) < 14.0,
            "cross_street" => lane
                .as_ref()
                .is_some_and(|(far, dir, _)| *far < 2.5 && dir.x.abs() < 0.75),
            lane => lane_kind(lane),
        };
        match relation {
            "on" => inside,
            "parked_on" => inside && stands,
            "near" => match place {
                "crossing" => self.to_crossing(p) < 9.0,
                "junction" => self.to_junction(p) < 20.0,
                _ => inside || lane.as_ref().is_some_and(|l| l.0 < 9.0),
            },
            "waiting" => {
                stands
                    && match place {
                        "crossing" => self.to_crossing(p) < 9.0 + x.size_m.x / 2.0,
                        "junction" => self.to_junction(p) < 22.0 + x.size_m.x / 2.0,
                        _ => inside,
                    }
            }
            "blocking" => {
                stands
                    && match place {
                        "ego_lane" => side.abs() < 1.75 + x.size_m.y.max(x.size_m.x) / 2.0 && p.x.abs() > 2.0,
                        _ => self.at(p, &[BevLayer::DrivableArea]),
                    }
            }
            "crossing" => {
                let turned = lane.as_ref().is_some_and(|l| l.1.dot(x.heading()).abs() < 0.75);
                self.at(
                    p,
                    &[
                        BevLayer::DrivableArea,
                        BevLayer::PedCrossing,
                        BevLayer::CarparkArea,
                    ],
                ) && turned
            }
            _ => false,
        }
    }

    /// Number of pairs of boxes whose footprints overlap, and of all pairs.
    pub fn overlaps(&self) -> (usize, usize) {
        let mut hits = 0;
        let n = self.boxes.len();
        for (i, a) in self.boxes.iter().enumerate() {
            for b in &self.boxes[i + 1..] {
                hits += usize::from(share_ground(a, b));
            }
        }
        (hits, n * n.saturating_sub(1) / 2)
    }

    /// Number of vehicles whose whole footprint is on road or car park, and of all vehicles.
    pub fn on_drivable(&self) -> (usize, usize) {
        let mut on = 0;
        let mut n = 0;
        for b in self
            .boxes
            .iter()
            .filter(|b| b.class.is_vehicle() || b.class == Class::Motorcycle)
        {
            n += 1;
            let inner = SceneBox {
                size_m: b.size_m - glam::DVec3::new(0.4, 0.4, 0.0),
                ..*b
            };
            let good = inner
                .footprint()
                .iter()
                .chain([&b.center_m.truncate()])
                .all(|p| self.at(*p, &[BevLayer::DrivableArea, BevLayer::CarparkArea]));
            on += usize::from(good);
        }
        (on, n)
    }

    /// Counts moving vehicles and two-wheelers off walkways: those on a lane and within 15 degrees of its heading, then
    /// all of them.
    pub fn headings(&self) -> (usize, usize) {
        let (mut good, mut n) = (0, 0);
        let limit = 15f64.to_radians().cos();
        for b in self
            .boxes
            .iter()
            .filter(|b| b.class.is_vehicle() || matches!(b.class, Class::Motorcycle | Class::Bicycle))
        {
            if b.velocity_mps.length() < 0.5 || self.at(b.center_m.truncate(), &[BevLayer::Walkway]) {
                continue;
            }
            n += 1;
            let p = b.center_m.truncate();
            // In a junction lanes lie over one another: any lane within 2.5 m counts.
            let ok = self
                .layout
                .polylines
                .iter()
                .filter(|l| l.kind == PolylineKind::LaneCenter)
                .any(|l| {
                    l.points_m.windows(2).any(|w| {
                        let d = (w[1] - w[0]).normalize_or_zero();
                        let t = (p - w[0]).dot(w[1] - w[0]) / (w[1] - w[0]).length_squared().max(1e-9);
                        let q = w[0] + (w[1] - w[0]) * t.clamp(0.0, 1.0);
                        q.distance(p) < 2.5 && d.dot(b.heading()) > limit
                    })
                });
            good += usize::from(ok);
        }
        (good, n)
    }
}

/// True if two footprints overlap: a corner or the centre of one in the other, sampled at the corners, edges and middle.
fn share_ground(a: &SceneBox, b: &SceneBox) -> bool {
    let far = (a.center_m - b.center_m).truncate().length();
    if far > (a.size_m.truncate().length() + b.size_m.truncate().length()) / 2.0 {
        return false;
    }
    let grid = |x: &SceneBox| -> Vec<DVec2> {
        let (n, m) = ((x.size_m.x / 0.1).ceil() as i32, (x.size_m.y / 0.1).ceil() as i32);
        (0..=n)
            .flat_map(|i| (0..=m).map(move |j| (i, j)))
            .map(|(i, j)| {
                let local = glam::DVec3::new(
                    x.size_m.x * (f64::from(i) / f64::from(n) - 0.5),
                    x.size_m.y * (f64::from(j) / f64::from(m) - 0.5),
                    0.0,
                );
                x.to_ego(local).truncate()
            })
            .collect()
    };
    let small = if a.size_m.x < b.size_m.x { (a, b) } else { (b, a) };
    grid(small.0)
        .into_iter()
        .any(|p| small.1.contains(p.extend(small.1.center_m.z), -1e-6))
}
