//! Projection of a camera's lens: pinhole, OpenCV's distortion, fisheye (Kannala and Brandt), f-theta; and the read-out
//! of its shutter.
//!
//! A point of the optical frame (x right, y down, z forward) meets the image plane at a focal length of 1 at the
//! *distorted* place; focal length and principal point map that to pixels. So a lens is the same at any image size.

use glam::{DMat2, DVec2, DVec3};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::rig::Camera;

/// A model of a lens. Coefficients are those of the field, without unit.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum Lens {
    /// Straight lines stay straight.
    #[default]
    Pinhole,
    /// OpenCV's model: radial k1, k2, k3 over k4, k5, k6 (Brown and Conrady where the last three are 0), tangential p1, p2.
    Distorted {
        /// k1, k2, k3, k4, k5, k6. OpenCV's own lists have p1 and p2 after k2.
        k: [f64; 6],
        /// p1, p2.
        p: [f64; 2],
    },
    /// OpenCV's fisheye (J. Kannala and S. Brandt, 2006): radius = a + k1 a^3 + k2 a^5 + k3 a^7 + k4 a^9 at the angle a, rad,
    /// from the optical axis.
    Fisheye {
        /// k1, k2, k3, k4.
        k: [f64; 4],
        /// Largest angle from the optical axis that is seen, degrees; at most 180.
        max_angle_deg: f64,
    },
    /// f-theta: radius = c1 a + c2 a^2 + … + c6 a^6 at the angle a, rad, from the optical axis.
    FTheta {
        /// c1 to c6; c1 is 1 where the focal length is that of the middle.
        c: [f64; 6],
        /// Largest angle from the optical axis that is seen, degrees; at most 180.
        max_angle_deg: f64,
    },
}

/// In which order a rolling shutter reads the picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum ReadOut {
    /// Row by row, the top one first.
    TopToBottom,
    /// Row by row, the bottom one first.
    BottomToTop,
    /// Column by column, the left one first.
    LeftToRight,
    /// Column by column, the right one first.
    RightToLeft,
}

/// A rolling shutter. The moment of a picture is that of its middle row or column.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Shutter {
    /// From the first row or column to the last, s.
    pub readout_s: f64,
    /// Order.
    pub direction: ReadOut,
}

impl Shutter {
    /// Longest read-out, s.
    pub const MAX_READOUT_S: f64 = 1.0;

    /// Time at which a place of the picture is read, s after the moment of the picture; `part` runs from 0 to 1 from
    /// left to right and from top to bottom.
    pub fn after_s(&self, part: DVec2) -> f64 {
        let part = match self.direction {
            ReadOut::TopToBottom => part.y,
            ReadOut::BottomToTop => 1.0 - part.y,
            ReadOut::LeftToRight => part.x,
            ReadOut::RightToLeft => 1.0 - part.x,
        };
        self.readout_s * (part - 0.5)
    }
}

impl Lens {
    /// Name in files and menus.
    pub fn name(&self) -> &'static str {
        match self {
            Lens::Pinhole => "pinhole",
            Lens::Distorted { .. } => "distorted",
            Lens::Fisheye { .. } => "fisheye",
            Lens::FTheta { .. } => "f_theta",
        }
    }

    /// True if it can see beyond 90 degrees from its axis. Depths of such a camera are distances from its optical centre;
    /// depths of the others are along the optical axis.
    pub fn is_wide(&self) -> bool {
        matches!(self, Lens::Fisheye { .. } | Lens::FTheta { .. })
    }

    /// The first problem with it; `None` if it is sound.
    pub fn problem(&self) -> Option<String> {
        let (coefficients, angle): (Vec<f64>, f64) = match self {
            Lens::Pinhole => return None,
            Lens::Distorted { k, p } => ([&k[..], p].concat(), 90.0),
            Lens::Fisheye { k, max_angle_deg } => (k.to_vec(), *max_angle_deg),
            Lens::FTheta { c, max_angle_deg } => (c.to_vec(), *max_angle_deg),
        };
        if coefficients.iter().any(|c| c.is_nan() || c.abs() > 1e6) {
            return Some(format!(
                "lens {}: a coefficient is not finite or beyond 1e6",
                self.name()
            ));
        }
        if !(angle > 0.0 && angle <= 180.0) {
            return Some(format!(
                "lens {}: max_angle_deg is {angle}, expected above 0 and at most 180",
                self.name()
            ));
        }
        if let Lens::FTheta { c, .. } = self
            && c[0] <= 0.0
        {
            return Some(format!("lens f_theta: c1 is {}, expected above 0", c[0]));
        }
        None
    }

    /// Radius at an angle and its derivative, for the lenses that are given by a radius.
    fn radius(&self, a: f64) -> (f64, f64) {
        match self {
            Lens::Fisheye {
                k: [k1, k2, k3, k4], ..
            } => {
                let s = a * a;
                let value = a * (1.0 + s * (k1 + s * (k2 + s * (k3 + s * k4))));
                let slope = 1.0 + s * (3.0 * k1 + s * (5.0 * k2 + s * (7.0 * k3 + s * 9.0 * k4)));
                (value, slope)
            }
            Lens::FTheta { c, .. } => {
                let (mut value, mut slope) = (0.0, 0.0);
                for (i, c) in c.iter().enumerate().rev() {
                    value = value * a + c;
                    slope = slope * a + c * (i + 1) as f64;
                }
                (value * a, slope)
            }
            Lens::Pinhole | Lens::Distorted { .. } => (a.tan(), 1.0 + a.tan().powi(2)),
        }
    }

    /// Image place of a point at (x, y, 1), and its derivative by x and y; for the distorted lens.
    fn distort(k: &[f64; 6], p: &[f64; 2], at: DVec2) -> (DVec2, DMat2) {
        let DVec2 { x, y } = at;
        let r2 = at.length_squared();
        let above = 1.0 + r2 * (k[0] + r2 * (k[1] + r2 * k[2]));
        let below = 1.0 + r2 * (k[3] + r2 * (k[4] + r2 * k[5]));
        let radial = above / below;
        let slope_above = k[0] + r2 * (2.0 * k[1] + r2 * 3.0 * k[2]);
        let slope_below = k[3] + r2 * (2.0 * k[4] + r2 * 3.0 * k[5]);
        // Derivative by r2.
        let slope = (slope_above * below - above * slope_below) / (below * below);
        let [p1, p2] = *p;
        let out = at * radial
            + DVec2::new(
                2.0 * p1 * x * y + p2 * (r2 + 2.0 * x * x),
                p1 * (r2 + 2.0 * y * y) + 2.0 * p2 * x * y,
            );
        let cross = 2.0 * x * y * slope + 2.0 * p1 * x + 2.0 * p2 * y;
        let jacobian = DMat2::from_cols(
            DVec2::new(radial + 2.0 * x * x * slope + 2.0 * p1 * y + 6.0 * p2 * x, cross),
            DVec2::new(cross, radial + 2.0 * y * y * slope + 6.0 * p1 * y + 2.0 * p2 * x),
        );
        (out, jacobian)
    }
}

/// A camera's lens prepared for many rays, at the camera's own image size.
#[derive(Clone, Copy, Debug)]
pub struct Optics {
    lens: Lens,
    focal_px: DVec2,
    center_px: DVec2,
    /// Limit up to which the lens is one to one: an angle, rad, of wide lenses; a radius at distance 1 of the others.
    limit: f64,
    /// Distorted radius at the limit.
    limit_radius: f64,
}

/// Number of steps in the search for the limit of a lens.
const STEPS: usize = 2048;
/// Farthest distance from the axis at which a distorted lens is examined, in units of the distance along it: 84
/// degrees.
const FARTHEST: f64 = 10.0;
/// Most Newton steps; each gains about four digits.
const NEWTON: usize = 20;

impl Optics {
    /// The optics of a camera.
    pub fn new(camera: &Camera) -> Optics {
        let lens = camera.lens;
        let limit = match lens {
            Lens::Pinhole => f64::INFINITY,
            Lens::Distorted { k, p } => {
                let radial = |r: f64| Lens::distort(&k, &[0.0; 2], DVec2::new(r, 0.0)).1.x_axis.x;
                let tangential = p.iter().any(|p| *p != 0.0);
                let folds = |r: f64| {
                    let around = [DVec2::X, DVec2::Y, DVec2::NEG_X, DVec2::NEG_Y];
                    tangential
                        && around
                            .iter()
                            .any(|d| Lens::distort(&k, &p, *d * r).1.determinant() <= 0.0)
                };
                end_of(FARTHEST, |r| radial(r) > 0.0 && !folds(r))
            }
            Lens::Fisheye { max_angle_deg, .. } | Lens::FTheta { max_angle_deg, .. } => {
                end_of(max_angle_deg.clamp(0.0, 180.0).to_radians(), |a| {
                    lens.radius(a).1 > 0.0
                })
            }
        };
        let limit_radius = match lens {
            Lens::Pinhole => f64::INFINITY,
            Lens::Distorted { k, .. } => Lens::distort(&k, &[0.0; 2], DVec2::new(limit, 0.0)).0.x,
            _ => lens.radius(limit).0,
        };
        Optics {
            lens,
            focal_px: DVec2::from_array(camera.focal_px),
            center_px: DVec2::from_array(camera.center_px),
            limit,
            limit_radius,
        }
    }

    /// Direction of an image point (u, v), px, in the optical frame: 1 along z for lenses that are not wide, else a
    /// unit vector; zero where the lens sees nothing.
    #[inline]
    pub fn direction(&self, u: f64, v: f64) -> DVec3 {
        let at = (DVec2::new(u, v) - self.center_px) / self.focal_px;
        match &self.lens {
            Lens::Pinhole => at.extend(1.0),
            Lens::Distorted { k, p } => self.undistort(k, p, at),
            _ => self.at_angle(at),
        }
    }

    fn undistort(&self, k: &[f64; 6], p: &[f64; 2], at: DVec2) -> DVec3 {
        let mut x = at * (self.limit / at.length().max(1e-12)).min(1.0);
        for _ in 0..NEWTON {
            let (shown, jacobian) = Lens::distort(k, p, x);
            let off = at - shown;
            if off.length_squared() < 1e-26 {
                break;
            }
            let step = jacobian.inverse() * off;
            if !step.is_finite() {
                return DVec3::ZERO;
            }
            x += step.clamp_length_max(0.5);
        }
        let (shown, _) = Lens::distort(k, p, x);
        let found = (shown - at).length_squared() < 1e-16 && x.length() <= self.limit;
        if found { x.extend(1.0) } else { DVec3::ZERO }
    }

    fn at_angle(&self, at: DVec2) -> DVec3 {
        let radius = at.length();
        if radius.is_nan() || radius > self.limit_radius {
            return DVec3::ZERO;
        }
        if radius < 1e-12 {
            return DVec3::Z;
        }
        // Newton steps between bounds that close in: the radius grows with the angle up to the limit.
        let (mut low, mut high) = (0.0, self.limit);
        let mut a = (radius / self.limit_radius * self.limit).clamp(low, high);
        for _ in 0..60 {
            let (value, slope) = self.lens.radius(a);
            let off = value - radius;
            if off.abs() < 1e-14 {
                break;
            }
            if off > 0.0 {
                high = a
            } else {
                low = a
            }
            let next = a - off / slope;
            a = if next > low && next < high {
                next
            } else {
                (low + high) / 2.0
            };
        }
        (at * (a.sin() / radius)).extend(a.cos())
    }

    /// Image point, px, of a point of the optical frame; none where the lens does not see it.
    #[inline]
    pub fn project(&self, p: DVec3) -> Option<DVec2> {
        let at = match &self.lens {
            Lens::Pinhole => (p.z > 0.0).then(|| p.truncate() / p.z)?,
            Lens::Distorted { k, p: tangential } => {
                let at = (p.z > 0.0).then(|| p.truncate() / p.z)?;
                if at.is_nan() || at.length() > self.limit {
                    return None;
                }
                Lens::distort(k, tangential, at).0
            }
            lens => {
                let across = p.truncate().length();
                let a = across.atan2(p.z);
                if a.is_nan() || a > self.limit {
                    return None;
                }
                let radius = lens.radius(a).0;
                if across > 0.0 {
                    p.truncate() * (radius / across)
                } else {
                    DVec2::ZERO
                }
            }
        };
        let px = at * self.focal_px + self.center_px;
        px.is_finite().then_some(px)
    }

    /// Depth of a point of the optical frame, m, as the maps of such a camera give it.
    #[inline]
    pub fn depth_m(&self, p: DVec3) -> f64 {
        if self.lens.is_wide() { p.length() } else { p.z }
    }

    /// Derivative of the image point by a visible point of the optical frame, px/m: rows u and v, by x, y, z.
    pub fn jacobian(&self, p: DVec3) -> [DVec3; 2] {
        let [u, v] = match &self.lens {
            Lens::Pinhole => flat_rows(DMat2::IDENTITY, p),
            Lens::Distorted { k, p: tangential } => {
                flat_rows(Lens::distort(k, tangential, p.truncate() / p.z).1, p)
            }
            lens => {
                let across = p.truncate().length();
                let (radius, slope) = lens.radius(across.atan2(p.z));
                if across < 1e-9 {
                    [
                        DVec3::X * slope / p.z.abs().max(1e-9),
                        DVec3::Y * slope / p.z.abs().max(1e-9),
                    ]
                } else {
                    let e = p.truncate() / across;
                    let length2 = p.length_squared();
                    // Derivative of the angle by the point.
                    let by = (e * p.z).extend(-across) * (slope / length2);
                    let aside = radius / across;
                    [0, 1].map(|i| {
                        let mut own = DVec2::ZERO;
                        own[i] = 1.0;
                        by * e[i] + ((own - e * e[i]) * aside).extend(0.0)
                    })
                }
            }
        };
        [u * self.focal_px.x, v * self.focal_px.y]
    }

    /// Focal lengths, px.
    pub fn focal_px(&self) -> DVec2 {
        self.focal_px
    }

    /// Principal point, px.
    pub fn center_px(&self) -> DVec2 {
        self.center_px
    }

    /// Angle between neighbouring pixels in the middle of the picture, rad.
    pub fn pixel_rad(&self) -> f64 {
        let slope = match &self.lens {
            Lens::FTheta { c, .. } => c[0],
            _ => 1.0,
        };
        1.0 / (self.focal_px.x * slope).max(1e-3)
    }

    /// Distance from the middle at which the lens shows an angle from the optical axis, in focal lengths; used to find
    /// a focal length.
    pub(crate) fn radius_at(&self, angle_rad: f64) -> f64 {
        match &self.lens {
            Lens::Distorted { k, p } => {
                Lens::distort(k, p, DVec2::new(angle_rad.tan().min(self.limit), 0.0))
                    .0
                    .x
            }
            Lens::Pinhole => angle_rad.tan(),
            lens => lens.radius(angle_rad.min(self.limit)).0,
        }
    }
}

/// Rows of the derivative of a place that is seen from distance z, through the distortion there.
fn flat_rows(bend: DMat2, p: DVec3) -> [DVec3; 2] {
    let at = p.truncate() / p.z;
    let [x, y] = [DVec2::X.extend(-at.x), DVec2::Y.extend(-at.y)].map(|row| row / p.z);
    let (a, b) = (bend.x_axis, bend.y_axis);
    [x * a.x + y * b.x, x * a.y + y * b.y]
}

/// The largest value up to which `holds` is true, at most `most`.
fn end_of(most: f64, holds: impl Fn(f64) -> bool) -> f64 {
    let step = most / STEPS as f64;
    let first = (1..=STEPS).find(|i| !holds(*i as f64 * step));
    let Some(first) = first else { return most };
    let (mut low, mut high) = ((first - 1) as f64 * step, first as f64 * step);
    for _ in 0..50 {
        let middle = (low + high) / 2.0;
        if holds(middle) {
            low = middle
        } else {
            high = middle
        }
    }
    low
}

#[cfg(test)]
mod tests {
    use super::*;

    fn camera(lens: Lens) -> Camera {
        Camera {
            lens,
            ..Camera::new("CAM", 90.0)
        }
    }

    fn lenses() -> Vec<Lens> {
        vec![
            Lens::Pinhole,
            // A calibrated wide lens, and a strong barrel with tangential terms.
            Lens::Distorted {
                k: [-0.33, 0.13, -0.02, 0.0, 0.0, 0.0],
                p: [3e-4, -2e-4],
            },
            Lens::Distorted {
                k: [0.9, 0.2, 0.01, 1.25, 0.4, 0.05],
                p: [0.0; 2],
            },
            Lens::Fisheye {
                k: [-0.012, 0.009, -0.007, 0.0015],
                max_angle_deg: 95.0,
            },
            Lens::FTheta {
                c: [1.0, -0.01, 0.02, -0.015, 0.002, 0.0],
                max_angle_deg: 100.0,
            },
        ]
    }

    #[test]
    fn what_a_pixel_looks_at_is_shown_in_that_pixel() {
        for lens in lenses() {
            let optics = Optics::new(&camera(lens));
            let mut seen = 0;
            for (u, v) in
                (0..40).flat_map(|i| (0..23).map(move |j| (i as f64 * 40.0 + 3.0, j as f64 * 40.0 + 7.0)))
            {
                let d = optics.direction(u, v);
                if d == DVec3::ZERO {
                    continue;
                }
                seen += 1;
                let back = optics.project(d * 7.3).expect("seen");
                assert!(
                    back.distance(DVec2::new(u, v)) < 1e-6,
                    "{lens:?}: {u} {v} comes back as {back}"
                );
            }
            assert!(seen > 400, "{lens:?}: {seen} of 920");
        }
    }

    /// The numbers of OpenCV 5.0 (`cv2.projectPoints`, `cv2.fisheye.projectPoints`) for points (0.3, -0.2, 1) and (-0.9, 0.5, 1.4) with
    /// f = (800, 820), c = (640, 360).
    #[test]
    fn points_are_where_opencv_puts_them() {
        let mut camera = camera(Lens::Pinhole);
        (camera.focal_px, camera.center_px) = ([800.0, 820.0], [640.0, 360.0]);
        let points = [DVec3::new(0.3, -0.2, 1.0), DVec3::new(-0.9, 0.5, 1.4)];
        let reference = [
            (
                Lens::Distorted {
                    k: [-0.33, 0.13, -0.02, 0.0, 0.0, 0.0],
                    p: [3e-4, -2e-4],
                },
                [
                    [870.1423344, 202.75383816],
                    [199.2420179152757, 611.0709506825995],
                ],
            ),
            (
                Lens::Distorted {
                    k: [0.9, 0.2, 0.01, 1.25, 0.4, 0.05],
                    p: [1e-3, -5e-4],
                },
                [
                    [869.7298937825359, 203.0889725819338],
                    [197.3654879365887, 612.3760472605989],
                ],
            ),
            (
                Lens::Fisheye {
                    k: [-0.012, 0.009, -0.007, 0.0015],
                    max_angle_deg: 95.0,
                },
                [
                    [870.0387919348323, 202.8068255111979],
                    [198.24123359442848, 611.5570753142838],
                ],
            ),
        ];
        for (lens, expected) in reference {
            camera.lens = lens;
            let optics = Optics::new(&camera);
            for (p, [u, v]) in points.iter().zip(expected) {
                let px = optics.project(*p).expect("seen");
                assert!(
                    px.distance(DVec2::new(u, v)) < 1e-6,
                    "{lens:?}: {px}, expected {u} {v}"
                );
            }
        }
    }

    #[test]
    fn derivatives_are_those_of_differences() {
        for lens in lenses() {
            let optics = Optics::new(&camera(lens));
            for p in [
                DVec3::new(0.4, -0.3, 2.0),
                DVec3::new(-1.5, 0.6, 2.5),
                DVec3::new(0.0, 0.0, 3.0),
            ] {
                let rows = optics.jacobian(p);
                for axis in 0..3 {
                    let mut h = DVec3::ZERO;
                    h[axis] = 1e-6;
                    let at = |p| optics.project(p).expect("seen");
                    let slope = (at(p + h) - at(p - h)) / 2e-6;
                    let found = DVec2::new(rows[0][axis], rows[1][axis]);
                    assert!(
                        slope.distance(found) < 1e-3 * (1.0 + slope.length()),
                        "{lens:?} {p} {axis}: {found}, expected {slope}"
                    );
                }
            }
        }
    }

    /// A barrel distortion folds back: beyond the fold nothing is seen, and nothing is shown twice.
    #[test]
    fn lenses_end_where_they_would_fold() {
        let lens = Lens::Distorted {
            k: [-0.4, 0.0, 0.0, 0.0, 0.0, 0.0],
            p: [0.0; 2],
        };
        let optics = Optics::new(&camera(lens));
        // r (1 - 0.4 r^2) grows up to r = 0.9129.
        assert!(optics.project(DVec3::new(0.9, 0.0, 1.0)).is_some());
        assert!(optics.project(DVec3::new(0.93, 0.0, 1.0)).is_none());
        assert_eq!(optics.direction(1599.5, 899.5), DVec3::ZERO);
        // A fisheye sees points beside it and a little behind it.
        let optics = Optics::new(&camera(lenses()[3]));
        assert!(optics.project(DVec3::new(1.0, 0.0, -0.05)).is_some());
        assert!(optics.project(DVec3::new(0.1, 0.0, -1.0)).is_none());
        assert!(optics.project(DVec3::new(f64::NAN, 0.0, 1.0)).is_none());
        for lens in lenses() {
            let optics = Optics::new(&camera(lens));
            assert!(
                !optics.direction(f64::NAN, 3.0).is_nan() || lens == Lens::Pinhole,
                "{lens:?}"
            );
        }
    }

    #[test]
    fn a_shutter_reads_row_by_row() {
        let shutter = Shutter {
            readout_s: 0.03,
            direction: ReadOut::BottomToTop,
        };
        assert_eq!(shutter.after_s(DVec2::new(0.2, 0.0)), 0.015);
        assert_eq!(shutter.after_s(DVec2::new(0.9, 1.0)), -0.015);
        assert_eq!(shutter.after_s(DVec2::new(0.9, 0.5)), 0.0);
    }
}
