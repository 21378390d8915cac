//! The kerb: where roadway or walkway ends, and which way the road runs. Things beside the road are set along it.

use glam::DVec2;

use scene::{BevLayer, BevLayout, Form};

use super::lanes::nearest_lane;

/// A point on the kerb.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct KerbPoint {
    /// Position, ego frame, m.
    pub at_m: DVec2,
    /// Unit vector along it.
    pub along: DVec2,
    /// Unit vector across it, from roadway to walkway to open ground.
    pub away: DVec2,
    /// Distance from the point that was asked for, m.
    pub distance_m: f64,
}

/// A straight piece is fitted to this much of the kerb around its nearest cell, m: cells alone make it a staircase.
const FIT_M: f64 = 2.4;
/// Lanes farther away than this say nothing about a direction, m.
const LANE_M: f64 = 60.0;

/// 2 for roadway, 1 for walkway, 0 for open ground.
fn rank(layout: &BevLayout, x: usize, y: usize) -> u8 {
    match () {
        () if layout.has(BevLayer::DrivableArea, x, y) => 2,
        () if layout.has(BevLayer::Walkway, x, y) => 1,
        () => 0,
    }
}

/// The side of a cell at which the ground changes: its middle, the way to lower rank, both ranks.
struct KerbEdge {
    middle_m: DVec2,
    away: DVec2,
    ranks: (u8, u8),
}

fn sides(layout: &BevLayout, p_m: DVec2, reach_m: f64) -> Vec<KerbEdge> {
    let (extent, min_m) = (layout.extent(), layout.extent().min_m());
    let cell = |v: f64, axis: usize, count: usize| {
        let at = (v - min_m[axis]) / extent.voxel_m();
        at.floor().clamp(0.0, count as f64 - 1.0) as usize
    };
    let (x0, x1) = (
        cell(p_m.x - reach_m, 0, extent.nx()),
        cell(p_m.x + reach_m, 0, extent.nx()),
    );
    let (y0, y1) = (
        cell(p_m.y - reach_m, 1, extent.ny()),
        cell(p_m.y + reach_m, 1, extent.ny()),
    );
    let mut out = Vec::new();
    for x in x0..=x1 {
        for y in y0..=y1 {
            for (nx, ny, step) in [(x + 1, y, DVec2::X), (x, y + 1, DVec2::Y)] {
                if !extent.holds(nx, ny) {
                    continue;
                }
                let (a, b) = (rank(layout, x, y), rank(layout, nx, ny));
                if a != b {
                    out.push(KerbEdge {
                        middle_m: extent.center(x, y, 0).truncate() + step * (extent.voxel_m() / 2.0),
                        away: if a > b { step } else { -step },
                        ranks: (a.max(b), a.min(b)),
                    });
                }
            }
        }
    }
    out
}

/// The nearest point of the kerb within `reach_m` of a point of the ego frame.
pub fn nearest_kerb(layout: &BevLayout, p_m: DVec2, reach_m: f64) -> Option<KerbPoint> {
    if !p_m.is_finite() {
        return None;
    }
    let all = sides(layout, p_m, reach_m + FIT_M);
    let nearest = all
        .iter()
        .min_by(|a, b| a.middle_m.distance(p_m).total_cmp(&b.middle_m.distance(p_m)))?;
    let near = |s: &&KerbEdge| s.ranks == nearest.ranks && s.middle_m.distance(nearest.middle_m) <= FIT_M;
    let piece: Vec<&KerbEdge> = all.iter().filter(near).collect();
    let middle = piece.iter().map(|s| s.middle_m).sum::<DVec2>() / piece.len() as f64;
    let lower = piece.iter().map(|s| s.away).sum::<DVec2>();
    // The direction in which the middles spread most.
    let (mut xx, mut xy, mut yy) = (0.0, 0.0, 0.0);
    for side in &piece {
        let d = side.middle_m - middle;
        (xx, xy, yy) = (xx + d.x * d.x, xy + d.x * d.y, yy + d.y * d.y);
    }
    let along = match piece.len() > 1 {
        true => DVec2::from_angle((2.0 * xy).atan2(xx - yy) / 2.0),
        false => nearest.away.perp(),
    };
    let across = along.perp();
    let away = if across.dot(lower) >= 0.0 { across } else { -across };
    let at_m = middle + along * (p_m - middle).dot(along);
    let distance_m = at_m.distance(p_m);
    (distance_m <= reach_m).then_some(KerbPoint {
        at_m,
        along,
        away,
        distance_m,
    })
}

/// Unit vector along the road nearest to a point: that of a lane, else of the kerb, else ahead.
pub fn road_direction(layout: &BevLayout, p_m: DVec2) -> DVec2 {
    let lane = nearest_lane(layout, p_m, LANE_M).map(|lane| DVec2::from_angle(lane.yaw_rad));
    let kerb = || nearest_kerb(layout, p_m, 12.0).map(|k| k.along);
    lane.or_else(kerb).unwrap_or(DVec2::X)
}

/// Heading from a point to the road, rad: to a lane, else to the kerb; 0 where there is neither.
pub fn toward_road(layout: &BevLayout, p_m: DVec2) -> f64 {
    let lane = nearest_lane(layout, p_m, LANE_M).map(|lane| lane.at_m - p_m);
    let kerb = || nearest_kerb(layout, p_m, 12.0).map(|k| -k.away);
    let to_road = lane.or_else(kerb).unwrap_or(DVec2::X);
    to_road.try_normalize().unwrap_or(DVec2::X).to_angle()
}

/// True if vehicles drive there.
pub fn is_roadway(layout: &BevLayout, p_m: DVec2) -> bool {
    let cell = layout.extent().column_at(p_m.x, p_m.y);
    cell.is_some_and(|[x, y]| rank(layout, x, y) == 2)
}

/// Points of one thing that are asked where the kerb is, at most.
const MOST_POINTS: usize = 64;

/// The shortest way that sets one of the points of forms (ego frame, m), moved by `moved_m` already, to the kerb; its
/// length is at most `reach_m`.
pub fn way_to_kerb(layout: &BevLayout, forms: &[Form], moved_m: DVec2, reach_m: f64) -> Option<DVec2> {
    let ways = forms.iter().flat_map(|form| {
        let clear_m = match form {
            Form::Line(l) => l.width_m / 2.0,
            Form::Bridge(b) => b.width_m / 2.0,
            Form::Building(_) => 0.2,
            _ => 0.4,
        };
        let points = form.points_m().into_iter().take(MOST_POINTS);
        points.filter_map(move |p| {
            let kerb = nearest_kerb(layout, p + moved_m, reach_m + clear_m)?;
            Some(kerb.at_m + kerb.away * clear_m - (p + moved_m))
        })
    });
    let shortest = ways.min_by(|a, b| a.length().total_cmp(&b.length()))?;
    (shortest.length() <= reach_m).then_some(shortest)
}

#[cfg(test)]
mod tests {
    use super::*;
    use scene::Extent;

    /// Roadway below a line through (0, `y0`) of that slope, a walkway of 2 m above it.
    fn road(y0: f64, slope: f64) -> BevLayout {
        let mut layout = BevLayout::default();
        for x in 0..Extent::WINDOW.nx() {
            for y in 0..Extent::WINDOW.ny() {
                let p = Extent::WINDOW.center(x, y, 0);
                let over = p.y - y0 - slope * p.x;
                layout.set(BevLayer::DrivableArea, x, y, over < 0.0);
                layout.set(BevLayer::Walkway, x, y, (0.0..2.0).contains(&over));
            }
        }
        layout
    }

    #[test]
    fn the_kerb_is_straight_where_the_cells_are_a_staircase() {
        for slope in [0.0, 0.2, 1.0] {
            let layout = road(4.0, slope);
            let line = DVec2::new(1.0, slope).normalize();
            for x in [-10.3, 0.0, 7.7] {
                let p = DVec2::new(x, 4.0 + slope * x) + line.perp() * 0.5;
                let kerb = nearest_kerb(&layout, p, 1.0).expect("near");
                assert!(kerb.along.dot(line).abs() > 0.99, "{slope} {x}: {kerb:?}");
                assert!(kerb.away.dot(line.perp()) > 0.99, "{kerb:?}");
                let off = (kerb.at_m - DVec2::new(0.0, 4.0)).perp_dot(line).abs();
                assert!(off < 0.3, "{slope} {x}: {off}");
                assert!((kerb.distance_m - 0.5).abs() < 0.3);
            }
        }
        let layout = road(4.0, 0.0);
        // The far side of the walkway is a kerb too; away from both there is none.
        let far = nearest_kerb(&layout, DVec2::new(0.0, 6.3), 1.0).expect("near");
        assert!((far.at_m.y - 6.0).abs() < 0.3 && far.away.y > 0.99, "{far:?}");
        assert_eq!(nearest_kerb(&layout, DVec2::new(0.0, 12.0), 1.0), None);
        assert_eq!(nearest_kerb(&layout, DVec2::NAN, 1.0), None);
        assert!(is_roadway(&layout, DVec2::ZERO) && !is_roadway(&layout, DVec2::new(0.0, 5.0)));
    }

    #[test]
    fn the_shortest_way_to_the_kerb_sets_a_wall_beside_it() {
        use scene::background::{LineKind, SceneryLine};
        let layout = road(4.0, 0.0);
        let points = vec![DVec2::new(0.0, 9.0), DVec2::new(5.0, 7.0)];
        let wall = [Form::Line(SceneryLine::typical(LineKind::Wall, points))];
        let way = way_to_kerb(&layout, &wall, DVec2::ZERO, 3.0).expect("near");
        assert!(way.x.abs() < 0.05 && (way.y + 0.85).abs() < 0.25, "{way}");
        assert_eq!(way_to_kerb(&layout, &wall, DVec2::Y * 5.0, 3.0), None);
    }

    #[test]
    fn without_lanes_the_kerb_says_where_the_road_is() {
        let layout = road(4.0, 0.0);
        let yaw = toward_road(&layout, DVec2::new(3.0, 8.0));
        assert!((yaw + std::f64::consts::FRAC_PI_2).abs() < 0.05, "{yaw}");
        let along = road_direction(&layout, DVec2::new(3.0, 8.0));
        assert!(along.x.abs() > 0.99);
        assert_eq!(road_direction(&BevLayout::default(), DVec2::ZERO), DVec2::X);
    }
}
