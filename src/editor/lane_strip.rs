//! A street drawn as a line with a width: drivable area, dividers between its lanes, and lane centres.

use glam::DVec2;

use scene::{BevLayer, BevLayout, Polyline, PolylineKind};

use super::junction::{self, Area};
use super::{Edit, Shape};

/// What a street has.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LaneStrip {
    /// Lanes in the direction in which it was drawn, right of the line that parts the directions.
    pub forward: usize,
    /// Lanes against it; 0 makes it one-way.
    pub backward: usize,
    /// Width of a lane, m.
    pub lane_m: f64,
    /// Width of the walkway on either side, m; 0 means none.
    pub walk_m: f64,
}

impl Default for LaneStrip {
    fn default() -> Self {
        Self {
            forward: 1,
            backward: 1,
            lane_m: 3.5,
            walk_m: 0.0,
        }
    }
}

impl LaneStrip {
    /// Most lanes of one direction.
    pub const MAX_LANES: usize = 6;
    /// Limits of the width of a lane, m.
    pub const LANE_M: std::ops::RangeInclusive<f64> = 2.0..=6.0;

    /// Width of the carriageway, m.
    pub fn width_m(&self) -> f64 {
        (self.forward + self.backward) as f64 * self.lane_m
    }

    /// The edits that lay the street along the middle of its carriageway (ego frame, m) on a layout: areas first, then
    /// lines. Where it crosses a road that is there, the two make a junction: no walkway, divider or crossing lies
    /// on it, and lane centres run through. Empty for fewer than two distinct points, or no lane.
    pub fn edits(&self, middle_m: &[DVec2], layout: &BevLayout) -> Vec<Edit> {
        let middle_m = distinct(middle_m);
        let lanes = self.forward + self.backward;
        if middle_m.len() < 2 || lanes == 0 || !(self.lane_m.is_finite() && self.lane_m > 0.0) {
            return Vec::new();
        }
        let half_m = self.width_m() / 2.0;
        let walk_m = self.walk_m.max(0.0);
        // What lies beside the grid is no error of the whole street.
        let band = |from_m: f64, to_m: f64| {
            let mut points_m = offset_line(&middle_m, from_m);
            points_m.extend(offset_line(&middle_m, to_m).iter().rev());
            Shape::Polygon { points_m }
                .cells(layout.extent())
                .unwrap_or_default()
        };
        let junction = junction::crossed(layout, &middle_m, &band(half_m + walk_m, -half_m - walk_m));
        let area = Area::new(layout.extent(), &junction);
        let marked = |layer: BevLayer| {
            let mut cells = junction.clone();
            cells.retain(|[x, y]| layout.has(layer, *x, *y));
            (layer, cells, false)
        };
        let carriageway = band(half_m, -half_m);
        let mut parked = carriageway.clone();
        parked.retain(|[x, y]| layout.has(BevLayer::CarparkArea, *x, *y));
        // Cars drive where people walked, or parked.
        let mut areas = vec![
            (BevLayer::Walkway, carriageway.clone(), false),
            (BevLayer::CarparkArea, parked, false),
            (BevLayer::DrivableArea, carriageway, true),
        ];
        if walk_m > 0.0 {
            for (from_m, to_m) in [(half_m + walk_m, half_m), (-half_m, -half_m - walk_m)] {
                let mut cells = band(from_m, to_m);
                // A walkway ends where it comes to a road.
                let road = BevLayer::DrivableArea.bit() | BevLayer::CarparkArea.bit();
                cells.retain(|[x, y]| !area.holds([*x, *y]) && layout.cell(*x, *y) & road == 0);
                areas.push((BevLayer::Walkway, cells, true));
            }
        }
        areas.push((
            BevLayer::PedCrossing,
            junction::crossings_in(layout, &area),
            false,
        ));
        areas.extend([BevLayer::RoadDivider, BevLayer::LaneDivider, BevLayer::StopLine].map(marked));
        areas.retain(|(_, cells, _)| !cells.is_empty());
        let paint = |(layer, cells, value)| Edit::PaintBev {
            layer,
            shape: Shape::Cells(cells),
            value,
        };
        let mut edits: Vec<Edit> = areas.into_iter().map(paint).collect();
        edits.push(Edit::AddPolylines {
            lines: self.lines(&middle_m, half_m, &Area::around(layout.extent(), &junction)),
        });
        edits
    }

    fn lines(&self, middle_m: &[DVec2], half_m: f64, junction: &Area) -> Vec<Polyline> {
        let mut lines = Vec::new();
        let lanes = self.forward + self.backward;
        for i in 1..lanes {
            // Counted from the left edge: lanes against the line come first.
            let kind = match i == self.backward {
                true => PolylineKind::RoadDivider,
                false => PolylineKind::LaneDivider,
            };
            let whole_m = offset_line(middle_m, half_m - i as f64 * self.lane_m);
            let pieces = match junction.touches(&whole_m) {
                true => junction.outside(&whole_m),
                false => vec![whole_m],
            };
            lines.extend(pieces.into_iter().map(|points_m| Polyline { kind, points_m }));
        }
        for i in 0..lanes {
            let mut points_m = offset_line(middle_m, half_m - (i as f64 + 0.5) * self.lane_m);
            if i < self.backward {
                points_m.reverse();
            }
            lines.push(Polyline {
                kind: PolylineKind::LaneCenter,
                points_m,
            });
        }
        lines
    }
}

/// The points that are finite and not where the one before is.
fn distinct(points_m: &[DVec2]) -> Vec<DVec2> {
    let mut out: Vec<DVec2> = Vec::new();
    for p in points_m.iter().filter(|p| p.is_finite()) {
        if out.last().is_none_or(|last| last.distance(*p) > 1e-3) {
            out.push(*p);
        }
    }
    out
}

/// The line `left_m` to the left of another (right if negative), mitred; sharp corners are cut at twice the offset.
fn offset_line(points_m: &[DVec2], left_m: f64) -> Vec<DVec2> {
    let direction = |i: usize| (points_m[i + 1] - points_m[i]).normalize_or_zero();
    let last = points_m.len() - 1;
    (0..=last)
        .map(|i| {
            let before = direction(i.max(1) - 1).perp();
            let after = direction(i.min(last - 1)).perp();
            let middle = (before + after).normalize_or(after);
            points_m[i] + middle * (left_m / middle.dot(after).max(0.5))
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use crate::Apply;
    use std::collections::BTreeMap;
    use std::sync::Arc;

    use super::*;
    use scene::{BevLayout, Extent, Frame, Scene, VoxelGrid};

    #[test]
    fn a_street_has_its_lanes_dividers_and_walkways() {
        let strip = LaneStrip {
            forward: 2,
            backward: 1,
            lane_m: 4.0,
            walk_m: 2.0,
        };
        let middle_m = [
            DVec2::new(-20.0, 0.0),
            DVec2::new(-20.0, 0.0),
            DVec2::new(20.0, 0.0),
        ];
        let edits = strip.edits(&middle_m, &BevLayout::default());
        let frame = Frame::new(BevLayout::default(), BTreeMap::new(), VoxelGrid::new());
        let mut scene = Scene::single("street", frame, Arc::default(), 1);
        for edit in &edits {
            edit.apply(&mut scene).expect("sound");
        }
        let layout = &scene.frame().layout;
        assert_eq!(layout.count(BevLayer::DrivableArea), 100 * 30);
        assert_eq!(layout.count(BevLayer::Walkway), 100 * 10);
        assert!(layout.count(BevLayer::RoadDivider) >= 100 && layout.count(BevLayer::LaneDivider) >= 100);
        let line = |kind, at: usize| {
            let mut all = layout.polylines.iter().filter(|l| l.kind == kind);
            all.nth(at).expect("there").points_m.clone()
        };
        assert_eq!(line(PolylineKind::RoadDivider, 0)[0], DVec2::new(-20.0, 2.0));
        assert_eq!(line(PolylineKind::LaneDivider, 0)[0], DVec2::new(-20.0, -2.0));
        // The lane on the left is driven the other way.
        assert_eq!(line(PolylineKind::LaneCenter, 0)[0], DVec2::new(20.0, 4.0));
        assert_eq!(line(PolylineKind::LaneCenter, 2)[0], DVec2::new(-20.0, -4.0));
    }

    #[test]
    fn a_street_cuts_the_walkway_that_it_crosses() {
        let frame = Frame::new(BevLayout::default(), BTreeMap::new(), VoxelGrid::new());
        let mut scene = Scene::single("street", frame, Arc::default(), 1);
        for y in 0..Extent::WINDOW.ny() {
            scene.change_canvas(|f| f.layout.set(BevLayer::Walkway, 100, y, true));
        }
        let ends = [DVec2::new(-20.0, 0.0), DVec2::new(20.0, 0.0)];
        for edit in &LaneStrip::default().edits(&ends, &scene.frame().layout.clone()) {
            edit.apply(&mut scene).expect("sound");
        }
        let layout = &scene.frame().layout;
        for y in 0..Extent::WINDOW.ny() {
            let road = layout.has(BevLayer::DrivableArea, 100, y);
            assert_ne!(road, layout.has(BevLayer::Walkway, 100, y), "column 100, {y}");
        }
    }

    /// A scene on which streets were laid one after the other.
    fn laid(streets: &[(LaneStrip, [DVec2; 2])]) -> Scene {
        let frame = Frame::new(BevLayout::default(), BTreeMap::new(), VoxelGrid::new());
        let mut scene = Scene::single("street", frame, Arc::default(), 1);
        for (strip, ends) in streets {
            let layout = scene.frame().layout.clone();
            for edit in &strip.edits(ends, &layout) {
                edit.apply(&mut scene).expect("sound");
            }
        }
        scene
    }

    #[test]
    fn streets_that_cross_make_a_junction() {
        let strip = LaneStrip {
            forward: 2,
            walk_m: 2.0,
            ..LaneStrip::default()
        };
        let along = [DVec2::new(-30.0, 1.0), DVec2::new(30.0, 1.0)];
        let across = [DVec2::new(2.0, -30.0), DVec2::new(2.0, 30.0)];
        let scene = laid(&[(strip, along), (strip, across)]);
        let layout = &scene.frame().layout;
        let half_m = strip.width_m() / 2.0;
        let (mut inside, mut marked_beside) = (0, 0);
        for (x, y) in (0..Extent::WINDOW.nx()).flat_map(|x| (0..Extent::WINDOW.ny()).map(move |y| (x, y))) {
            let p = Extent::WINDOW.center(x, y, 0).truncate();
            let on = [
                (p.y - 1.0).abs() < half_m && p.x.abs() < 29.5,
                (p.x - 2.0).abs() < half_m && p.y.abs() < 29.5,
            ];
            let lined = layout.has(BevLayer::RoadDivider, x, y) || layout.has(BevLayer::LaneDivider, x, y);
            if on[0] || on[1] {
                assert!(layout.has(BevLayer::DrivableArea, x, y), "{p} is road");
                assert!(!layout.has(BevLayer::Walkway, x, y), "no kerb at {p}");
            }
            inside += usize::from(on == [true, true]);
            assert!(on != [true, true] || !lined, "no line at {p}");
            marked_beside += usize::from(lined);
        }
        assert!(inside > 500 && marked_beside > 300, "{inside} {marked_beside}");
        // Each of the four dividers in two pieces, none within; the six lanes run through.
        let crossing = |p: &DVec2| (p.x - 2.0).abs() < half_m - 0.5 && (p.y - 1.0).abs() < half_m - 0.5;
        let dividers = layout
            .polylines
            .iter()
            .filter(|l| l.kind != PolylineKind::LaneCenter);
        let dividers: Vec<_> = dividers.map(|l| &l.points_m).collect();
        assert_eq!(dividers.len(), 8);
        assert!(
            dividers.iter().all(|l| l.len() == 2 && !l.iter().any(crossing)),
            "{dividers:?}"
        );
        assert_eq!(layout.polylines.len(), 8 + 6);
    }

    #[test]
    fn crossings_of_a_new_junction_go_and_others_stay() {
        let strip = LaneStrip::default();
        let mut scene = laid(&[(strip, [DVec2::new(-30.0, 0.0), DVec2::new(30.0, 0.0)])]);
        let stripes = |x_m: f64| {
            [(-1.5, -3.0), (1.5, -3.0), (1.5, 3.0), (-1.5, 3.0)]
                .map(|(x, y)| DVec2::new(x_m + x, y))
                .to_vec()
        };
        for points_m in [stripes(3.0), stripes(-20.0)] {
            let shape = Shape::Polygon {
                points_m: points_m.clone(),
            };
            let paint = Edit::PaintBev {
                layer: BevLayer::PedCrossing,
                shape,
                value: true,
            };
            let outline = Polyline {
                kind: PolylineKind::PedCrossing,
                points_m,
            };
            paint.apply(&mut scene).expect("sound");
            Edit::AddPolylines { lines: vec![outline] }
                .apply(&mut scene)
                .expect("sound");
        }
        let across = [DVec2::new(2.0, -30.0), DVec2::new(2.0, 30.0)];
        for edit in &strip.edits(&across, &scene.frame().layout.clone()) {
            edit.apply(&mut scene).expect("sound");
        }
        let layout = &scene.frame().layout;
        let painted = |x: usize| (0..Extent::WINDOW.ny()).any(|y| layout.has(BevLayer::PedCrossing, x, y));
        let painted: Vec<usize> = (0..Extent::WINDOW.nx()).filter(|x| painted(*x)).collect();
        assert!(
            painted.len() > 6 && painted.iter().all(|x| *x < 70),
            "{painted:?}"
        );
        let left: Vec<_> = layout
            .polylines
            .iter()
            .filter(|l| l.kind == PolylineKind::PedCrossing)
            .collect();
        assert!(left.len() == 1 && left[0].points_m[0].x < -10.0, "{left:?}");
    }

    #[test]
    fn a_street_along_an_old_one_keeps_its_lines() {
        let strip = LaneStrip::default();
        let ends = [DVec2::new(-30.0, 0.0), DVec2::new(30.0, 0.0)];
        let wide = LaneStrip {
            forward: 2,
            backward: 2,
            ..strip
        };
        let scene = laid(&[(strip, ends), (wide, ends)]);
        let layout = &scene.frame().layout;
        assert!(layout.count(BevLayer::LaneDivider) >= 2 * 150);
        assert!(layout.polylines.iter().all(|l| l.points_m.len() == 2));
    }

    #[test]
    fn poor_lines_make_nothing_and_bends_keep_their_width() {
        let strip = LaneStrip::default();
        let edits = |points_m: &[DVec2]| strip.edits(points_m, &BevLayout::default());
        assert!(edits(&[DVec2::ONE; 3]).is_empty() && edits(&[]).is_empty());
        assert!(edits(&[DVec2::NAN, DVec2::ONE]).is_empty());
        let bend = [DVec2::ZERO, DVec2::new(10.0, 0.0), DVec2::new(10.0, 10.0)];
        assert_eq!(offset_line(&bend, 1.0)[1].round(), DVec2::new(9.0, 1.0));
        let back = [DVec2::ZERO, DVec2::new(10.0, 0.0), DVec2::ZERO];
        assert!(
            offset_line(&back, 1.0)
                .iter()
                .all(|p| p.is_finite() && p.length() < 13.0)
        );
    }
}
