//! Lane sections: lane kinds, widths, borders, road marks, and the cross-section at one place of a road.

use std::sync::Arc;

use super::elevation::LaneHeight;
use super::geometry::cubic;
use scene::BevLayer;

/// Widest lane that is believed, m; wider values are cut to it.
const MAX_WIDTH_M: f64 = 1000.0;

/// One cubic that holds from `s_m` on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CubicPiece {
    /// Start of the piece, m.
    pub s_m: f64,
    /// a, b, c, d over the distance from `s_m`.
    pub k: [f64; 4],
}

/// Cubics one after the other, sorted by `s_m`.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Cubics(pub Vec<CubicPiece>);

impl Cubics {
    /// The value at `s_m` by the piece that holds at `held_m`: where one piece ends and the next begins
    /// with another value, either can be asked for. 0 without a piece; before the first one its start value.
    pub fn at(&self, s_m: f64, held_m: f64) -> f64 {
        let after = self.0.partition_point(|p| p.s_m <= held_m);
        match self.0.get(after.max(1) - 1) {
            Some(piece) => cubic(&piece.k, (s_m - piece.s_m).max(0.0)),
            None => 0.0,
        }
    }

    /// The largest magnitude found at four places of each piece, up to `end_m`.
    fn reach(&self, end_m: f64) -> f64 {
        let mut most = 0.0f64;
        for (i, piece) in self.0.iter().enumerate() {
            let until = self.0.get(i + 1).map_or(end_m, |next| next.s_m);
            for quarter in 0..=4 {
                let ds = (until - piece.s_m).max(0.0) * f64::from(quarter) / 4.0;
                most = most.max(cubic(&piece.k, ds).abs());
            }
        }
        most.min(MAX_WIDTH_M)
    }
}

/// Use of a lane; the names of OpenDRIVE 1.4 to 1.8, grouped by what they mean for a layout.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum LaneKind {
    /// driving, entry, exit, onRamp, offRamp, connectingRamp, slipLane, mwyEntry, mwyExit, bus, taxi, HOV.
    Driving,
    /// bidirectional: used both ways, such as a turn lane in the middle.
    Bidirectional,
    /// shoulder: paved, no traffic.
    Shoulder,
    /// stop: for vehicles that have broken down.
    Stop,
    /// restricted, roadWorks: paved, no traffic.
    Paved,
    /// biking.
    Biking,
    /// parking.
    Parking,
    /// sidewalk, walking.
    Sidewalk,
    /// border, curb: the edge of a surface.
    Edge,
    /// median.
    Median,
    /// none, and every unknown type.
    None,
}

impl LaneKind {
    /// From the `type` attribute; `None` for a name that is not known.
    pub fn from_name(name: &str) -> Option<Self> {
        Some(match name {
            "driving" | "entry" | "exit" | "onRamp" | "offRamp" | "connectingRamp" | "slipLane"
            | "mwyEntry" | "mwyExit" | "bus" | "taxi" | "HOV" | "special1" | "special2" | "special3" => {
                Self::Driving
            }
            "bidirectional" => Self::Bidirectional,
            "shoulder" => Self::Shoulder,
            "stop" => Self::Stop,
            "restricted" | "roadWorks" => Self::Paved,
            "biking" => Self::Biking,
            "parking" => Self::Parking,
            "sidewalk" | "walking" => Self::Sidewalk,
            "border" | "curb" => Self::Edge,
            "median" => Self::Median,
            "none" => Self::None,
            _ => return None,
        })
    }

    /// True where motor traffic flows.
    pub fn carries_traffic(self) -> bool {
        matches!(self, Self::Driving | Self::Bidirectional)
    }

    /// Name of a kind that is drivable although no traffic flows on it, such as `shoulder`. `None` for other kinds.
    pub fn beside_traffic(self) -> Option<&'static str> {
        Some(match self {
            Self::Shoulder => "shoulder",
            Self::Stop => "stop",
            Self::Paved => "restricted",
            Self::Biking => "biking",
            _ => return None,
        })
    }

    /// The ground of an area of this kind that belongs to no road; `None` if the kind is in no layer.
    pub fn ground_alone(self) -> Option<LaneGround> {
        match self {
            Self::Parking => Some(LaneGround::Carpark),
            Self::Sidewalk | Self::Biking => Some(LaneGround::Walkway),
            paved if paved.is_paved() => Some(LaneGround::Road),
            _ => None,
        }
    }

    fn is_paved(self) -> bool {
        self.carries_traffic()
            || matches!(
                self,
                Self::Shoulder | Self::Stop | Self::Paved | Self::Biking | Self::Parking
            )
    }
}

/// Which way traffic runs on a lane, seen along the reference line.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Travel {
    /// With growing `s`.
    Forward,
    /// Against it.
    Backward,
    /// Either way.
    Both,
}

/// How a lane's outer edge is given.
#[derive(Clone, Debug, PartialEq)]
pub enum Extent {
    /// Width over the inner neighbour, m.
    Width(Cubics),
    /// Distance of the outer edge from the lane reference line, m (either sign).
    Border(Cubics),
}

/// A road mark that holds from `s_m` (from the section's start) on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RoadMark {
    /// Start, m.
    pub s_m: f64,
    /// The paint.
    pub style: MarkStyle,
    /// True if yellow; any other colour counts as white.
    pub yellow: bool,
}

/// The paint of a road mark.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MarkStyle {
    /// No paint: the types none, curb and grass.
    None,
    /// One or two unbroken lines.
    Solid,
    /// Dashes or dots.
    Broken,
    /// One line of each.
    SolidAndBroken,
}

/// A lane of one section.
#[derive(Clone, Debug, PartialEq)]
pub struct Lane {
    /// Positive left of the centre, negative right.
    pub id: i32,
    /// Its use.
    pub kind: LaneKind,
    /// Direction of its traffic, if its kind has any.
    pub travel: Travel,
    /// Its outer edge.
    pub extent: Extent,
    /// Its height above the surface of the road; empty if it lies on it.
    pub heights: Vec<LaneHeight>,
    /// Marks on its outer edge; empty if the file gives none.
    pub marks: Vec<RoadMark>,
}

/// The lanes on one side of the centre line, from the centre outward.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SideLanes {
    /// Start of the section the lanes were declared in, m: their records count from there.
    pub origin_s_m: f64,
    /// From the centre outward.
    pub lanes: Vec<Lane>,
}

/// A stretch of road with a fixed set of lanes.
#[derive(Clone, Debug, PartialEq)]
pub struct LaneSection {
    /// Start, m.
    pub start_s_m: f64,
    /// End, m.
    pub end_s_m: f64,
    /// Lanes with positive ids.
    pub left: Arc<SideLanes>,
    /// Lanes with negative ids.
    pub right: Arc<SideLanes>,
    /// Marks on the centre line.
    pub center_marks: Vec<RoadMark>,
}

/// Ground of a lane in a layout.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LaneGround {
    /// Drivable area.
    Road,
    /// Drivable and car park.
    Carpark,
    /// Walkway.
    Walkway,
    /// Neither, and the file says so (median, border, none).
    Other,
}

impl LaneGround {
    /// The layers of a map that it sets.
    pub(super) fn layers(self) -> &'static [BevLayer] {
        match self {
            Self::Road => &[BevLayer::DrivableArea],
            Self::Carpark => &[BevLayer::DrivableArea, BevLayer::CarparkArea],
            Self::Walkway => &[BevLayer::Walkway],
            Self::Other => &[],
        }
    }
}

impl LaneSection {
    /// Number of lanes, the centre line not counted.
    pub fn lane_count(&self) -> usize {
        self.left.lanes.len() + self.right.lanes.len()
    }

    /// Lanes from the leftmost to the rightmost.
    pub fn lanes_left_to_right(&self) -> impl Iterator<Item = &Lane> {
        self.left.lanes.iter().rev().chain(&self.right.lanes)
    }

    /// Index of the centre line among the borders of [`Self::borders_m`].
    pub fn center_index(&self) -> usize {
        self.left.lanes.len()
    }

    /// Writes the lateral positions (t, left positive, m) of all lane edges at `s_m` of the road, by the
    /// records that hold at `held_m`, from the leftmost to the rightmost: one more than there are lanes.
    /// Never increasing.
    pub fn borders_m(&self, lane_offset_m: f64, s_m: f64, held_m: f64, out: &mut Vec<f64>) {
        out.clear();
        let outward = |side: &SideLanes, sign: f64, out: &mut Vec<f64>| {
            let (ds, held) = (s_m - side.origin_s_m, held_m - side.origin_s_m);
            let mut reach = 0.0f64;
            for lane in &side.lanes {
                let edge = match &lane.extent {
                    Extent::Width(width) => reach + believable(width.at(ds, held)),
                    Extent::Border(border) => believable(border.at(ds, held).abs()),
                };
                reach = reach.max(edge);
                out.push(lane_offset_m + sign * reach);
            }
        };
        outward(&self.left, 1.0, out);
        out.reverse();
        out.push(lane_offset_m);
        outward(&self.right, -1.0, out);
    }

    /// True if the edge with this index carries a painted mark at `s_m`; `None` if the file gives no mark.
    pub fn painted(&self, border: usize, s_m: f64) -> Option<bool> {
        let center = self.center_index();
        let (marks, origin) = match border.cmp(&center) {
            std::cmp::Ordering::Less => (&self.left.lanes[center - border - 1].marks, self.left.origin_s_m),
            std::cmp::Ordering::Equal => (&self.center_marks, self.start_s_m),
            std::cmp::Ordering::Greater => (
                &self.right.lanes[border - center - 1].marks,
                self.right.origin_s_m,
            ),
        };
        let after = marks.partition_point(|m| m.s_m <= s_m - origin);
        marks.get(after.max(1) - 1).map(|m| m.style != MarkStyle::None)
    }

    /// An upper estimate of how far the lanes reach from the lane reference line, m.
    pub fn reach_m(&self) -> f64 {
        let of = |side: &SideLanes| {
            let mut reach = 0.0f64;
            for lane in &side.lanes {
                reach = match &lane.extent {
                    Extent::Width(width) => reach + width.reach(self.end_s_m - side.origin_s_m),
                    Extent::Border(border) => reach.max(border.reach(self.end_s_m - side.origin_s_m)),
                };
            }
            reach
        };
        of(&self.left).max(of(&self.right))
    }

    /// Every `s_m` inside the section where a record of a lane begins, sorted, with both ends.
    pub fn breaks_m(&self) -> Vec<f64> {
        let mut all = vec![self.start_s_m, self.end_s_m];
        for side in [&self.left, &self.right] {
            for lane in &side.lanes {
                let (Extent::Width(cubics) | Extent::Border(cubics)) = &lane.extent;
                all.extend(cubics.0.iter().map(|p| side.origin_s_m + p.s_m));
                all.extend(lane.marks.iter().map(|m| side.origin_s_m + m.s_m));
            }
        }
        all.extend(self.center_marks.iter().map(|m| self.start_s_m + m.s_m));
        all.retain(|s| *s >= self.start_s_m && *s <= self.end_s_m);
        all.sort_by(f64::total_cmp);
        all.dedup();
        all
    }

    /// The ground of each lane, left to right, in the sense of the nuScenes map: all paved lanes that are connected to
    /// a traffic lane are drivable. A bicycle lane behind a kerb belongs to the walkway, a shoulder behind a kerb to no
    /// layer. A narrow edge strip that touches a walkway is part of it.
    pub fn grounds(&self) -> Vec<LaneGround> {
        let lanes: Vec<&Lane> = self.lanes_left_to_right().collect();
        let widths: Vec<f64> = self
            .left
            .lanes
            .iter()
            .rev()
            .map(|l| (l, self.left.origin_s_m))
            .chain(self.right.lanes.iter().map(|l| (l, self.right.origin_s_m)))
            .map(|(lane, origin)| match &lane.extent {
                Extent::Width(width) => width.reach(self.end_s_m - origin),
                Extent::Border(_) => f64::INFINITY,
            })
            .collect();
        let seen: Vec<usize> = (0..lanes.len()).filter(|i| widths[*i] > 0.05).collect();
        let mut grounds = vec![LaneGround::Other; lanes.len()];
        let mut rest = &seen[..];
        while let Some(first) = rest.first() {
            let run = if lanes[*first].kind.is_paved() {
                rest.iter().take_while(|i| lanes[**i].kind.is_paved()).count()
            } else {
                1
            };
            let connected = rest[..run].iter().any(|i| lanes[*i].kind.carries_traffic());
            for i in &rest[..run] {
                grounds[*i] = match lanes[*i].kind {
                    LaneKind::Driving | LaneKind::Bidirectional => LaneGround::Road,
                    LaneKind::Parking => LaneGround::Carpark,
                    LaneKind::Sidewalk => LaneGround::Walkway,
                    LaneKind::Biking | LaneKind::Shoulder | LaneKind::Stop | LaneKind::Paved if connected => {
                        LaneGround::Road
                    }
                    LaneKind::Biking => LaneGround::Walkway,
                    _ => LaneGround::Other,
                };
            }
            rest = &rest[run..];
        }
        const KERB_M: f64 = 0.6;
        for (n, i) in seen.iter().enumerate() {
            let walks = |j: Option<&usize>| j.is_some_and(|j| lanes[*j].kind == LaneKind::Sidewalk);
            if lanes[*i].kind == LaneKind::Edge
                && widths[*i] <= KERB_M
                && (walks(seen.get(n + 1)) || n > 0 && walks(seen.get(n - 1)))
            {
                grounds[*i] = LaneGround::Walkway;
            }
        }
        grounds
    }
}

/// A width from 0 to the widest believed; 0 for NaN.
fn believable(width_m: f64) -> f64 {
    if width_m > 0.0 {
        width_m.min(MAX_WIDTH_M)
    } else {
        0.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn lane(id: i32, kind: LaneKind, width: f64) -> Lane {
        Lane {
            id,
            kind,
            travel: if id < 0 { Travel::Forward } else { Travel::Backward },
            extent: Extent::Width(Cubics(vec![CubicPiece {
                s_m: 0.0,
                k: [width, 0.0, 0.0, 0.0],
            }])),
            heights: Vec::new(),
            marks: vec![RoadMark {
                s_m: 0.0,
                style: if id % 2 == 0 {
                    MarkStyle::Broken
                } else {
                    MarkStyle::None
                },
                yellow: false,
            }],
        }
    }

    fn section(left: Vec<Lane>, right: Vec<Lane>) -> LaneSection {
        let side = |lanes| {
            Arc::new(SideLanes {
                origin_s_m: 10.0,
                lanes,
            })
        };
        LaneSection {
            start_s_m: 10.0,
            end_s_m: 60.0,
            left: side(left),
            right: side(right),
            center_marks: Vec::new(),
        }
    }

    #[test]
    fn borders_run_from_left_to_right() {
        let s = section(
            vec![lane(1, LaneKind::Driving, 3.0), lane(2, LaneKind::Sidewalk, 2.0)],
            vec![lane(-1, LaneKind::Driving, 3.5)],
        );
        let mut t = Vec::new();
        s.borders_m(0.5, 20.0, 20.0, &mut t);
        assert_eq!(t, [5.5, 3.5, 0.5, -3.0]);
        assert_eq!(s.center_index(), 2);
        assert_eq!(s.painted(0, 20.0), Some(true));
        assert_eq!(s.painted(1, 20.0), Some(false));
        assert_eq!(s.painted(2, 20.0), None);
        assert_eq!(s.painted(3, 20.0), Some(false));
        assert_eq!(s.reach_m(), 5.0);
    }

    #[test]
    fn kerbs_decide_what_is_drivable() {
        use LaneGround::{Carpark, Other, Road, Walkway};
        use LaneKind::{Biking, Driving, Edge, Median, None, Shoulder, Sidewalk, Stop};
        let s = section(
            vec![
                lane(1, Median, 2.0),
                lane(2, Stop, 0.5),
                lane(3, None, 0.0),
                lane(4, Driving, 3.0),
                lane(5, Biking, 1.5),
                lane(6, LaneKind::Parking, 2.0),
                lane(7, Edge, 0.3),
                lane(8, Sidewalk, 2.0),
            ],
            vec![
                lane(-1, Driving, 3.0),
                lane(-2, Edge, 0.3),
                lane(-3, Shoulder, 2.0),
                lane(-4, Edge, 0.2),
                lane(-5, Biking, 1.6),
                lane(-6, Sidewalk, 2.0),
                lane(-7, Edge, 7.0),
            ],
        );
        let expected = [
            Walkway, Walkway, Carpark, Road, Road, Other, Road, Other, // left, from outside
            Road, Other, Other, Other, Walkway, Walkway, Other,
        ];
        assert_eq!(s.grounds(), expected);
    }

    #[test]
    fn wild_widths_stay_finite() {
        let mut wild = lane(-1, LaneKind::Driving, 0.0);
        wild.extent = Extent::Width(Cubics(vec![CubicPiece {
            s_m: 0.0,
            k: [f64::MAX, -f64::MAX, f64::MAX, f64::MAX],
        }]));
        let s = section(Vec::new(), vec![wild]);
        let mut t = Vec::new();
        s.borders_m(0.0, 50.0, 50.0, &mut t);
        assert!(t.iter().all(|t| t.is_finite()));
        assert!(s.reach_m().is_finite());
    }
}
