//! Reference-line geometry of OpenDRIVE (ASAM OpenDRIVE 1.7, section 9): line, arc, spiral, poly3, paramPoly3.

use glam::DVec2;

/// Where a curve is at one arc length, and how it runs there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CurvePoint {
    /// Position in the file's frame, m.
    pub position_m: DVec2,
    /// Direction of travel along the curve, rad, counter-clockwise from x, not wrapped.
    pub heading_rad: f64,
    /// Positive where the curve turns left, 1/m.
    pub curvature_per_m: f64,
}

impl CurvePoint {
    /// The point `t_m` to the left.
    pub fn offset(&self, t_m: f64) -> DVec2 {
        self.position_m + DVec2::from_angle(self.heading_rad).perp() * t_m
    }
}

/// The kind of a record and its own numbers.
#[derive(Clone, Debug, PartialEq)]
pub enum CurveShape {
    /// Straight.
    Line,
    /// Constant curvature.
    Arc {
        /// 1/m, left positive.
        curvature_per_m: f64,
    },
    /// Clothoid: curvature changes linearly with arc length.
    Spiral {
        /// Curvature at the start, 1/m.
        start_per_m: f64,
        /// Curvature at the end, 1/m.
        end_per_m: f64,
    },
    /// `v(u)`, a cubic over the local x axis; coefficients from the constant up.
    Poly3 {
        /// a, b, c, d.
        v: [f64; 4],
    },
    /// `u(p)`, `v(p)`, two cubics; coefficients from the constant up.
    ParamPoly3 {
        /// aU, bU, cU, dU.
        u: [f64; 4],
        /// aV, bV, cV, dV.
        v: [f64; 4],
        /// p runs from 0 to 1 over the record if true, from 0 to its length if false.
        normalized: bool,
    },
}

/// One record of a plan view.
#[derive(Clone, Debug, PartialEq)]
pub struct Geometry {
    /// Distance of its start from the start of the road, m.
    pub s_m: f64,
    /// Its length, m.
    pub length_m: f64,
    start_m: DVec2,
    heading_rad: f64,
    shape: CurveShape,
    stretch: f64,
    knots: Knots,
}

/// Values that are computed once, so that a point anywhere on the record takes the same time.
#[derive(Clone, Debug, PartialEq)]
enum Knots {
    None,
    /// Positions of a clothoid that starts at the origin along x, evenly spaced in arc length.
    Spiral(Vec<DVec2>),
    /// Arc length of a poly3 at evenly spaced u, and that spacing in m.
    Poly3(Vec<f64>, f64),
}

/// The longest record or road that is read, m.
pub const MAX_LENGTH_M: f64 = 1e6;
/// The most one record may turn, rad: 32 full turns.
pub const MAX_TURN_RAD: f64 = 200.0;
/// The farthest coordinate that is read, m.
pub const MAX_COORDINATE_M: f64 = 1e9;

impl Geometry {
    /// A record starting at `start_m` along `heading_rad`. Finite numbers are expected; the error is
    /// (what was expected, what was found) for a length or curve beyond what can be sampled.
    pub fn new(
        s_m: f64,
        start_m: DVec2,
        heading_rad: f64,
        length_m: f64,
        shape: CurveShape,
    ) -> Result<Self, (String, String)> {
        if !(length_m > 0.0 && length_m <= MAX_LENGTH_M) {
            return Err((
                format!("a length above 0 and up to {MAX_LENGTH_M:.0} m"),
                format!("{length_m}"),
            ));
        }
        let turn = length_m
            * match shape {
                CurveShape::Arc { curvature_per_m } => curvature_per_m.abs(),
                CurveShape::Spiral {
                    start_per_m,
                    end_per_m,
                } => start_per_m.abs().max(end_per_m.abs()),
                _ => 0.0,
            };
        if turn.is_nan() || turn > MAX_TURN_RAD {
            return Err((
                format!("a turn of at most {MAX_TURN_RAD} rad"),
                format!("{turn:.3e} rad"),
            ));
        }
        let stretch = match &shape {
            CurveShape::ParamPoly3 { u, v, normalized } => {
                let p = if *normalized { 1.0 } else { length_m };
                let rate = |k: &[f64; 4]| k[1].abs() + 2.0 * k[2].abs() * p + 3.0 * k[3].abs() * p * p;
                let per_p = rate(u).hypot(rate(v));
                if *normalized { per_p / length_m } else { per_p }
            }
            _ => 1.0,
        };
        let start_offset = match &shape {
            CurveShape::ParamPoly3 { u, v, .. } => u[0].hypot(v[0]),
            CurveShape::Poly3 { v } => v[0].abs(),
            _ => 0.0,
        };
        let span = stretch * length_m + start_offset;
        if span.is_nan() || span > 10.0 * MAX_LENGTH_M {
            return Err((
                format!("coefficients that stay within {:.0} m", 10.0 * MAX_LENGTH_M),
                format!("{span:.3e} m"),
            ));
        }
        let knots = match shape {
            CurveShape::Spiral {
                start_per_m,
                end_per_m,
            } => spiral_knots(length_m, turn, start_per_m, end_per_m),
            CurveShape::Poly3 { v } => poly3_knots(length_m, v)?,
            _ => Knots::None,
        };
        Ok(Self {
            s_m,
            length_m,
            start_m,
            heading_rad,
            shape,
            stretch,
            knots,
        })
    }

    /// Moves the record to another place of its road.
    pub(super) fn at_s(mut self, s_m: f64) -> Self {
        self.s_m = s_m;
        self
    }

    /// The kind of the record.
    pub fn shape(&self) -> &CurveShape {
        &self.shape
    }

    /// An upper bound of metres travelled per metre of `s` (1 except for a paramPoly3).
    pub fn stretch(&self) -> f64 {
        self.stretch
    }

    /// Distance of its end from the start of the road, m.
    pub fn end_s_m(&self) -> f64 {
        self.s_m + self.length_m
    }

    /// The curve `ds_m` after the start of this record; outside of it, its nearer end.
    pub fn at(&self, ds_m: f64) -> CurvePoint {
        let s = ds_m.clamp(0.0, self.length_m);
        let h = self.heading_rad;
        let (local, turned, curvature) = match self.shape {
            CurveShape::Line => (DVec2::new(s, 0.0), 0.0, 0.0),
            CurveShape::Arc { curvature_per_m: k } => {
                // The chord: no division by k, so nothing cancels when the arc is almost straight.
                let half = 0.5 * k * s;
                (DVec2::from_angle(half) * (s * sinc(half)), k * s, k)
            }
            CurveShape::Spiral {
                start_per_m: k0,
                end_per_m: k1,
            } => {
                let rate = (k1 - k0) / self.length_m;
                (
                    self.spiral_local(s, k0, rate),
                    s * (k0 + 0.5 * rate * s),
                    k0 + (k1 - k0) * (s / self.length_m),
                )
            }
            CurveShape::Poly3 { v } => {
                let u = self.poly3_u(s, v);
                let slope = derivative(&v, u);
                let bend = second_derivative(&v, u) / (1.0 + slope * slope).powf(1.5);
                (DVec2::new(u, cubic(&v, u)), slope.atan(), bend)
            }
            CurveShape::ParamPoly3 { u, v, normalized } => {
                let p = if normalized { s / self.length_m } else { s };
                let (du, dv) = (derivative(&u, p), derivative(&v, p));
                let (ddu, ddv) = (second_derivative(&u, p), second_derivative(&v, p));
                let speed_squared = du * du + dv * dv;
                let bend = if speed_squared > 0.0 {
                    (du * ddv - dv * ddu) / speed_squared.powf(1.5)
                } else {
                    0.0
                };
                (DVec2::new(cubic(&u, p), cubic(&v, p)), dv.atan2(du), bend)
            }
        };
        CurvePoint {
            position_m: self.start_m + DVec2::from_angle(h).rotate(local),
            heading_rad: h + turned,
            curvature_per_m: curvature,
        }
    }

    fn spiral_local(&self, s: f64, k0: f64, rate: f64) -> DVec2 {
        let Knots::Spiral(knots) = &self.knots else {
            unreachable!("a spiral is made with its knots");
        };
        let step = self.length_m / (knots.len() - 1) as f64;
        let i = ((s / step) as usize).min(knots.len() - 2);
        knots[i] + spiral_piece(k0, rate, i as f64 * step, s)
    }

    /// The u at which the curve has run `s` metres.
    fn poly3_u(&self, s: f64, v: [f64; 4]) -> f64 {
        let Knots::Poly3(lengths, step) = &self.knots else {
            unreachable!("a poly3 is made with its knots");
        };
        let i = (lengths.partition_point(|l| *l <= s).max(1) - 1).min(lengths.len() - 2);
        let (mut lo, mut hi) = (i as f64 * step, (i + 1) as f64 * step);
        let from = lo;
        let target = s - lengths[i];
        let mut u = lo + (target / (lengths[i + 1] - lengths[i])).clamp(0.0, 1.0) * step;
        // Newton, kept inside a shrinking bracket; the integrand is at least 1, so the step is safe.
        for _ in 0..40 {
            let miss = arc_length(&v, from, u) - target;
            if miss > 0.0 {
                hi = u
            } else {
                lo = u
            }
            let next = u - miss / 1f64.hypot(derivative(&v, u));
            let next = if next >= lo && next <= hi {
                next
            } else {
                0.5 * (lo + hi)
            };
            if (next - u).abs() <= 1e-13 * (1.0 + u.abs()) {
                return next;
            }
            u = next;
        }
        u
    }
}

/// Consecutive records of one road.
#[derive(Clone, Debug, PartialEq)]
pub struct ReferenceLine {
    records: Vec<Geometry>,
}

impl ReferenceLine {
    /// From records sorted by `s`; `None` if there are none.
    pub fn new(records: Vec<Geometry>) -> Option<Self> {
        (!records.is_empty()).then_some(Self { records })
    }

    /// The records in order; at least one.
    pub fn records(&self) -> &[Geometry] {
        &self.records
    }

    /// Where the last record ends, m.
    pub fn end_s_m(&self) -> f64 {
        self.records[self.records.len() - 1].end_s_m()
    }

    /// The record that holds `s_m`; the first or last outside.
    pub fn record_at(&self, s_m: f64) -> &Geometry {
        let after = self.records.partition_point(|g| g.s_m <= s_m);
        &self.records[after.max(1) - 1]
    }

    /// The line at `s_m`; outside of the road its nearer end.
    pub fn at(&self, s_m: f64) -> CurvePoint {
        let record = self.record_at(s_m);
        record.at(s_m - record.s_m)
    }
}

/// Value of a cubic, coefficients from the constant up.
pub(super) fn cubic(k: &[f64; 4], p: f64) -> f64 {
    k[0] + p * (k[1] + p * (k[2] + p * k[3]))
}

fn derivative(k: &[f64; 4], p: f64) -> f64 {
    k[1] + p * (2.0 * k[2] + p * 3.0 * k[3])
}

fn second_derivative(k: &[f64; 4], p: f64) -> f64 {
    2.0 * k[2] + 6.0 * p * k[3]
}

/// sin(x) / x without the 0 / 0.
fn sinc(x: f64) -> f64 {
    let squared = x * x;
    if squared < 1e-4 {
        1.0 - squared / 6.0 * (1.0 - squared / 20.0 * (1.0 - squared / 42.0))
    } else {
        x.sin() / x
    }
}

/// Nodes above 0 and weights of 16-point Gauss-Legendre quadrature on [-1, 1].
const GAUSS_16: [(f64, f64); 8] = [
    (0.095_012_509_837_637_44, 0.189_450_610_455_068_5),
    (0.281_603_550_779_258_9, 0.182_603_415_044_923_6),
    (0.458_016_777_657_227_4, 0.169_156_519_395_002_5),
    (0.617_876_244_402_643_7, 0.149_595_988_816_576_73),
    (0.755_404_408_355_003, 0.124_628_971_255_533_88),
    (0.865_631_202_387_831_8, 0.095_158_511_682_492_78),
    (0.944_575_023_073_232_6, 0.062_253_523_938_647_89),
    (0.989_400_934_991_649_9, 0.027_152_459_411_754_095),
];

/// Integral of `f` from `a` to `b`; exact to rounding while `f` turns by about one radian.
fn integrate<T>(a: f64, b: f64, zero: T, f: impl Fn(f64) -> T) -> T
where
    T: std::ops::Add<Output = T> + std::ops::Mul<f64, Output = T>,
{
    let (half, middle) = (0.5 * (b - a), 0.5 * (a + b));
    let sum = GAUSS_16.iter().fold(zero, |sum, &(node, weight)| {
        sum + (f(middle - half * node) + f(middle + half * node)) * weight
    });
    sum * half
}

fn spiral_piece(k0: f64, rate: f64, from: f64, to: f64) -> DVec2 {
    integrate(from, to, DVec2::ZERO, |s| {
        DVec2::from_angle(s * (k0 + 0.5 * rate * s))
    })
}

/// One knot per radian turned.
fn spiral_knots(length_m: f64, turn: f64, k0: f64, k1: f64) -> Knots {
    let pieces = turn.ceil().clamp(1.0, MAX_TURN_RAD) as usize;
    let rate = (k1 - k0) / length_m;
    let step = length_m / pieces as f64;
    let mut knots = vec![DVec2::ZERO];
    for i in 0..pieces {
        let from = i as f64 * step;
        knots.push(knots[i] + spiral_piece(k0, rate, from, from + step));
    }
    Knots::Spiral(knots)
}

fn arc_length(v: &[f64; 4], from: f64, to: f64) -> f64 {
    integrate(from, to, 0.0, |u| 1f64.hypot(derivative(v, u)))
}

/// Knots up to the u where the curve is `length_m` long, `length_m / 64` apart: u never exceeds s.
fn poly3_knots(length_m: f64, v: [f64; 4]) -> Result<Knots, (String, String)> {
    const PIECES: usize = 64;
    const STEEPEST: f64 = 1e6;
    let steepest = v[1].abs() + length_m * (2.0 * v[2].abs() + length_m * 3.0 * v[3].abs());
    if steepest.is_nan() || steepest > STEEPEST {
        return Err((
            format!("a slope of at most {STEEPEST:e}"),
            format!("{steepest:.3e}"),
        ));
    }
    let step = length_m / PIECES as f64;
    let mut lengths = vec![0.0];
    let mut total = 0.0;
    for i in 0..PIECES {
        total += arc_length(&v, i as f64 * step, (i + 1) as f64 * step);
        lengths.push(total);
        if total > length_m {
            break;
        }
    }
    Ok(Knots::Poly3(lengths, step))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn gauss_nodes_integrate_polynomials_of_degree_31() {
        let weights: f64 = GAUSS_16.iter().map(|(_, w)| 2.0 * w).sum();
        assert!((weights - 2.0).abs() < 1e-15);
        for degree in [2, 10, 30] {
            let got = integrate(0.0, 1.0, 0.0, |x: f64| x.powi(degree));
            assert!(
                (got - 1.0 / f64::from(degree + 1)).abs() < 1e-15,
                "degree {degree}"
            );
        }
    }

    /// No reference vectors exist for poly3: arc length, heading and curvature are checked against
    /// fine differences of the curve itself.
    #[test]
    fn poly3_is_parametrised_by_arc_length() {
        let v = [0.5, 0.2, 0.03, -0.0008];
        let g =
            Geometry::new(0.0, DVec2::new(3.0, -2.0), 0.7, 40.0, CurveShape::Poly3 { v }).expect("a curve");
        let (n, mut walked) = (40_000, 0.0);
        let step = 40.0 / f64::from(n);
        let mut before = g.at(0.0);
        assert!(
            (before.position_m - (DVec2::new(3.0, -2.0) + DVec2::from_angle(0.7).perp() * 0.5)).length()
                < 1e-12
        );
        for i in 1..=n {
            let here = g.at(f64::from(i) * step);
            let chord = here.position_m - before.position_m;
            walked += chord.length();
            if i % 1000 == 0 {
                let middle = 0.5 * (here.heading_rad + before.heading_rad);
                assert!((chord.to_angle() - middle).abs() < 1e-8);
                let turned = (here.heading_rad - before.heading_rad) / step;
                assert!((turned - here.curvature_per_m).abs() < 1e-4);
            }
            before = here;
        }
        assert!((walked - 40.0).abs() < 1e-6, "{walked}");
    }

    #[test]
    fn hopeless_records_are_refused() {
        let make = |length, shape| Geometry::new(0.0, DVec2::ZERO, 0.0, length, shape);
        for length in [0.0, -1.0, 1e12, f64::NAN] {
            assert!(make(length, CurveShape::Line).is_err(), "{length}");
        }
        assert!(make(100.0, CurveShape::Arc { curvature_per_m: 1e6 }).is_err());
        let wild = [0.0, 1e300, 1e300, 1e300];
        assert!(make(10.0, CurveShape::Poly3 { v: wild }).is_err());
        for normalized in [false, true] {
            assert!(
                make(
                    10.0,
                    CurveShape::ParamPoly3 {
                        u: wild,
                        v: wild,
                        normalized
                    }
                )
                .is_err()
            );
        }
    }
}
