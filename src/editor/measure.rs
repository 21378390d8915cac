//! Distances and angles between points: on the ground, or on surfaces that were hit in space.

use glam::{DVec2, DVec3};

use numeric::decimal::decimal;
use scene::Frame;

/// Points that the user measures between, ego frame, m: none, one, two (a distance) or three (an angle too).
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Measure {
    /// In the order clicked.
    pub points_m: Vec<DVec2>,
    /// Height of each point, m; 0 for points clicked from above.
    heights_m: Vec<f64>,
}

impl Measure {
    /// Takes a point; the fourth begins anew. Points that are not finite are not taken.
    pub fn add(&mut self, p_m: DVec3) {
        if !p_m.is_finite() {
            return;
        }
        if self.points_m.len() >= 3 {
            self.clear();
        }
        self.points_m.push(p_m.truncate());
        self.heights_m.push(p_m.z);
    }

    /// Drops all points.
    pub fn clear(&mut self) {
        self.points_m.clear();
        self.heights_m.clear();
    }

    /// The points, with `next_m` as one more unless there are three.
    pub fn with(&self, next_m: Option<DVec3>) -> Vec<DVec3> {
        let set = self
            .points_m
            .iter()
            .zip(&self.heights_m)
            .map(|(p, z)| p.extend(*z));
        set.chain(next_m.filter(|_| self.points_m.len() < 3)).collect()
    }

    /// Distances between the points, with `next_m` as one more, and their direction (two points) or angle (three);
    /// `None` for fewer than two.
    pub fn text(&self, next_m: Option<DVec3>) -> Option<String> {
        let points = self.with(next_m);
        let (first, last) = (points.first()?, points.last()?);
        if points.len() < 2 {
            return None;
        }
        let legs = points.windows(2).map(|p| p[0].distance(p[1]));
        let lengths: Vec<f64> = legs.collect();
        let list: Vec<String> = lengths.iter().map(|l| format!("{l:.2} m")).collect();
        let mut text = list.join(" + ");
        if points.len() == 2 {
            let d = *last - *first;
            text += &format!(
                "  ·  {}°  ·  x {}  y {}",
                decimal(d.truncate().to_angle().to_degrees(), 1),
                decimal(d.x, 2),
                decimal(d.y, 2)
            );
            if d.z != 0.0 {
                text += &format!("  z {}", decimal(d.z, 2));
            }
        } else {
            text += &format!(" = {:.2} m", lengths.iter().sum::<f64>());
            if let Some(angle_deg) = angle_deg(points[0], points[1], points[2]) {
                text += &format!("  ·  {angle_deg:.1}°");
            }
        }
        Some(text)
    }
}

/// Angle at `corner` between the ways to `a` and to `b`, 0 to 180 degrees; `None` if one of them has no length.
pub fn angle_deg(a: DVec3, corner: DVec3, b: DVec3) -> Option<f64> {
    let (u, v) = ((a - corner).try_normalize()?, (b - corner).try_normalize()?);
    Some(u.cross(v).length().atan2(u.dot(v)).to_degrees())
}

/// The nearest corner or centre of a box's footprint within `reach_m`, else the point itself.
pub fn snapped(frame: &Frame, p_m: DVec2, reach_m: f64) -> DVec2 {
    let marks = frame
        .boxes
        .values()
        .flat_map(|b| b.footprint().into_iter().chain([b.center_m.truncate()]));
    marks
        .filter(|m| m.distance(p_m) <= reach_m)
        .min_by(|a, b| a.distance(p_m).total_cmp(&b.distance(p_m)))
        .unwrap_or(p_m)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn two_points_say_a_distance_and_three_an_angle() {
        let mut m = Measure::default();
        m.add(DVec3::ZERO);
        m.add(DVec3::NAN);
        assert_eq!(m.text(None), None);
        assert_eq!(
            m.text(Some(DVec3::new(3.0, 4.0, 0.0))).as_deref(),
            Some("5.00 m  ·  53.1°  ·  x 3.00  y 4.00")
        );
        m.add(DVec3::new(3.0, 0.0, 0.0));
        m.add(DVec3::new(3.0, 2.0, 0.0));
        assert_eq!(
            m.text(Some(DVec3::ONE)).as_deref(),
            Some("3.00 m + 2.00 m = 5.00 m  ·  90.0°")
        );
        m.add(DVec3::ONE);
        assert_eq!(m.points_m, [DVec2::ONE]);
        // From the street to the eaves of a house beside it.
        assert_eq!(
            m.text(Some(DVec3::new(4.0, 5.0, 13.0))).as_deref(),
            Some("13.00 m  ·  53.1°  ·  x 3.00  y 4.00  z 12.00")
        );
        // A little to the other side of an axis is no zero with a sign.
        assert_eq!(
            m.text(Some(DVec3::new(4.0, 0.998, 1.0))).as_deref(),
            Some("3.00 m  ·  0.0°  ·  x 3.00  y 0.00")
        );
        assert_eq!(angle_deg(DVec3::ONE, DVec3::ONE, DVec3::X), None);
        let straight = angle_deg(DVec3::NEG_X, DVec3::ZERO, DVec3::X).expect("two ways");
        assert!((straight - 180.0).abs() < 1e-9);
    }
}
