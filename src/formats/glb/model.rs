//! A thing of its own, such as a car, as one box: which class it is, how large, and which end is its front.

use std::cmp::Ordering;

use glam::{DAffine3, DVec2, DVec3};
use scene::{BoxId, Class, SceneBox};

/// Directions in a quarter turn that a thing's box is looked for in.
const DIRECTIONS: usize = 45;
/// A turned box is taken where one along the node's axes would cover this much more ground.
const LOOSE: f64 = 1.1;
/// How many times longer than usual a thing of a class may be.
const LONGEST: f64 = 2.5;
/// A thing may always be so long, m.
const SHORT_M: f64 = 3.0;
/// A class is told by the size if no side is longer than its usual one times this, or shorter than its usual one
/// divided by this.
const ALIKE: f64 = 1.6;

/// Points of a thing, as far as its box needs them.
pub(crate) struct ModelExtents {
    /// The first one is the side's.
    directions: [DVec2; DIRECTIONS],
    /// Least and greatest way along each direction, and across it, m.
    along: [[f64; 2]; DIRECTIONS],
    across: [[f64; 2]; DIRECTIONS],
    height: [f64; 2],
    /// The front of a thing by the standard (+z), and by habit of some programs (+x), as it lies on the ground.
    front: DVec2,
    side: DVec2,
}

impl ModelExtents {
    /// The outline of a thing whose node lies as `world_from_node` says; without points yet.
    pub(crate) fn new(world_from_node: &DAffine3) -> Self {
        let linear = world_from_node.matrix3;
        let level = |axis: DVec3| axis.truncate().try_normalize();
        // A node that lies on its side has an axis left that is level.
        let side = level(linear.x_axis).or(level(linear.y_axis)).unwrap_or(DVec2::X);
        let front = level(linear.z_axis).unwrap_or(-side.perp());
        let step = std::f64::consts::FRAC_PI_2 / DIRECTIONS as f64;
        let first_rad = side.to_angle();
        Self {
            directions: std::array::from_fn(|i| DVec2::from_angle(first_rad + i as f64 * step)),
            along: [[f64::INFINITY, f64::NEG_INFINITY]; DIRECTIONS],
            across: [[f64::INFINITY, f64::NEG_INFINITY]; DIRECTIONS],
            height: [f64::INFINITY, f64::NEG_INFINITY],
            front,
            side,
        }
    }

    /// A point of the thing, m.
    pub(crate) fn add(&mut self, p: DVec3) {
        let widen = |range: &mut [f64; 2], v: f64| *range = [range[0].min(v), range[1].max(v)];
        let at = p.truncate();
        for i in 0..DIRECTIONS {
            let direction = self.directions[i];
            widen(&mut self.along[i], direction.dot(at));
            widen(&mut self.across[i], direction.perp_dot(at));
        }
        widen(&mut self.height, p.z);
    }

    /// The box around the points; `None` if there were none.
    pub(crate) fn to_box(&self, id: BoxId, class: Class) -> Option<SceneBox> {
        let long = |range: [f64; 2]| range[1] - range[0];
        let middle = |range: [f64; 2]| (range[0] + range[1]) / 2.0;
        let area = |i: usize| long(self.along[i]) * long(self.across[i]);
        let tightest = (0..DIRECTIONS).min_by(|a, b| area(*a).total_cmp(&area(*b)))?;
        let chosen = match area(0) <= LOOSE * area(tightest) {
            true => 0,
            false => tightest,
        };
        let direction = self.directions[chosen];
        let center = direction * middle(self.along[chosen]) + direction.perp() * middle(self.across[chosen]);
        let sides = [
            (direction, long(self.along[chosen])),
            (direction.perp(), long(self.across[chosen])),
        ];
        // The side that the standard calls the front, and the one beside it.
        let faces_front = |(side, _): (DVec2, f64)| side.dot(self.front).abs();
        let [front, beside] = match faces_front(sides[0]) > faces_front(sides[1]) {
            true => sides,
            false => [sides[1], sides[0]],
        };
        // Whether the longer or the shorter side is the length. A class that is usually as long as wide keeps the front
        // of the standard.
        let swap = class
            .typical_size_m()
            .is_some_and(|[length, width, _]| match length.total_cmp(&width) {
                Ordering::Greater => front.1 < 0.98 * beside.1,
                Ordering::Less => front.1 > 1.02 * beside.1,
                Ordering::Equal => false,
            });
        let [ahead, left] = if swap { [beside, front] } else { [front, beside] };
        let wanted = if swap { self.side } else { self.front };
        let heading = if ahead.0.dot(wanted) < 0.0 {
            -ahead.0
        } else {
            ahead.0
        };
        let size_m = DVec3::new(ahead.1, left.1, long(self.height)).max(DVec3::splat(0.01));
        Some(SceneBox {
            id,
            class,
            center_m: center.extend(middle(self.height)),
            size_m,
            yaw_rad: heading.to_angle(),
            velocity_mps: DVec2::ZERO,
            label: Default::default(),
        })
        .filter(|b| b.problem().is_none())
    }
}

/// True if a thing so long (m, the longer side seen from above) may be a single thing of a class.
pub(crate) fn may_be_one(class: Class, long_m: f64) -> bool {
    let usual = class.typical_size_m().map(|[length, width, _]| length.max(width));
    usual.is_some_and(|usual| long_m <= (LONGEST * usual).max(SHORT_M))
}

/// The class of objects whose usual size is nearest to one (m, in any order of length and width), if any is alike.
pub(crate) fn class_by_size(size_m: DVec3) -> Option<Class> {
    let unlike = |class: Class| {
        let [length, width, height] = class.typical_size_m()?;
        let usual = DVec3::new(length.max(width), length.min(width), height);
        let found = DVec3::new(size_m.x.max(size_m.y), size_m.x.min(size_m.y), size_m.z);
        Some(
            ((found / usual).to_array())
                .map(|r| r.ln().abs())
                .into_iter()
                .fold(0.0, f64::max),
        )
    };
    let each = Class::OBJECTS
        .into_iter()
        .filter_map(|class| Some((unlike(class)?, class)));
    let (least, class) = each.min_by(|a, b| a.0.total_cmp(&b.0))?;
    (least <= ALIKE.ln()).then_some(class)
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::{DMat3, DQuat};

    /// Corners of a block in the node's own axes (glTF: y up), seen in ours after a turn about the vertical.
    fn outline(size: DVec3, yaw_deg: f64, node_turns: bool) -> ModelExtents {
        let up = DAffine3::from_mat3(crate::glb::z_up_from_y_up());
        let turn = DAffine3::from_quat(DQuat::from_rotation_z(yaw_deg.to_radians()));
        let node = if node_turns { turn * up } else { up };
        let mut out = ModelExtents::new(&node);
        for i in 0..8 {
            let sign = |bit: usize| if i >> bit & 1 == 0 { -0.5 } else { 0.5 };
            let p = DVec3::new(sign(0), sign(1), sign(2)) * size;
            out.add((turn * up).transform_point3(p) + DVec3::new(3.0, -2.0, 1.0));
        }
        out
    }

    #[test]
    fn the_front_is_along_z_and_a_long_side_is_the_length() {
        // 1.9 m along x, 1.5 m high, 4.4 m along z: as the standard has it.
        let b = outline(DVec3::new(1.9, 1.5, 4.4), 0.0, true)
            .to_box(BoxId(3), Class::Car)
            .expect("a box");
        assert!((b.size_m - DVec3::new(4.4, 1.9, 1.5)).length() < 1e-9);
        assert!((b.center_m - DVec3::new(3.0, -2.0, 1.0)).length() < 1e-9);
        assert!(
            (b.heading() - DVec2::NEG_Y).length() < 1e-9,
            "+z of glTF is our -y: {}",
            b.heading()
        );
        // A model that is long along x.
        let b = outline(DVec3::new(4.4, 1.5, 1.9), 30.0, true)
            .to_box(BoxId(3), Class::Car)
            .expect("a box");
        assert!((b.size_m - DVec3::new(4.4, 1.9, 1.5)).length() < 1e-9);
        assert!((b.yaw_rad.to_degrees() - 30.0).abs() < 1e-6);
        // A barrier is wider than long.
        let b = outline(DVec3::new(0.5, 1.0, 2.5), 0.0, true)
            .to_box(BoxId(3), Class::Barrier)
            .expect("a box");
        assert!((b.size_m - DVec3::new(0.5, 2.5, 1.0)).length() < 1e-9);
    }

    #[test]
    fn a_mesh_that_was_turned_without_its_node_gets_a_tight_box() {
        let b = outline(DVec3::new(1.9, 1.5, 4.4), 40.0, false)
            .to_box(BoxId(1), Class::Car)
            .expect("a box");
        assert!(
            (b.size_m - DVec3::new(4.4, 1.9, 1.5)).abs().max_element() < 1e-9,
            "{}",
            b.size_m
        );
        assert!((b.heading() - DVec2::from_angle(-50f64.to_radians())).length() < 1e-9);
        assert_eq!(
            ModelExtents::new(&DAffine3::from_mat3(DMat3::ZERO)).to_box(BoxId(1), Class::Car),
            None
        );
    }

    #[test]
    fn sizes_tell_classes() {
        assert_eq!(class_by_size(DVec3::new(1.8, 4.3, 1.5)), Some(Class::Car));
        assert_eq!(class_by_size(DVec3::new(12.0, 2.5, 3.2)), Some(Class::Bus));
        assert_eq!(class_by_size(DVec3::new(0.6, 0.5, 1.8)), Some(Class::Pedestrian));
        assert_eq!(
            class_by_size(DVec3::new(0.35, 0.35, 0.9)),
            Some(Class::TrafficCone)
        );
        assert_eq!(class_by_size(DVec3::new(9.0, 9.0, 6.0)), None);
        assert!(
            may_be_one(Class::Car, 6.0) && !may_be_one(Class::Car, 30.0) && !may_be_one(Class::Manmade, 1.0)
        );
    }
}
