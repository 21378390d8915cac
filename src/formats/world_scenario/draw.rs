//! A picture that is drawn on the processor: triangles and lines with depth, four samples for each pixel.

use glam::{DVec2, DVec3};

/// Samples along each side of a pixel.
pub(crate) const SAMPLES: usize = 2;
/// Straight parts of the round end of a line.
const ROUND: usize = 10;

/// A point of the picture.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Corner {
    /// Pixels.
    pub(crate) at: DVec2,
    /// Distance from the camera, m: nearer corners are in front.
    pub(crate) distance_m: f64,
    /// sRGB, each 0 to 255.
    pub(crate) color: DVec3,
}

/// The picture in the making.
pub(crate) struct MultisamplePicture {
    width: usize,
    height: usize,
    /// Samples, row by row.
    color: Vec<[u8; 3]>,
    distance_m: Vec<f32>,
}

impl MultisamplePicture {
    /// A black picture of this size in pixels.
    pub(crate) fn new(width: u32, height: u32) -> Self {
        let (width, height) = (width as usize * SAMPLES, height as usize * SAMPLES);
        Self {
            width,
            height,
            color: vec![[0; 3]; width * height],
            distance_m: vec![f32::INFINITY; width * height],
        }
    }

    /// Makes the picture black, with a new size in pixels.
    pub(crate) fn begin(&mut self, width: u32, height: u32) {
        (self.width, self.height) = (width as usize * SAMPLES, height as usize * SAMPLES);
        let samples = self.width * self.height;
        self.color.clear();
        self.color.resize(samples, [0; 3]);
        self.distance_m.clear();
        self.distance_m.resize(samples, f32::INFINITY);
    }

    /// A triangle, whichever way round; colour and distance run evenly over it.
    pub(crate) fn triangle(&mut self, corners: &[Corner; 3]) {
        let [a, b, c] = corners.map(|corner| corner.at * SAMPLES as f64);
        let area = (b - a).perp_dot(c - a);
        // Written so that NaN fails too.
        if !(area.abs() > 1e-9 && area.is_finite()) {
            return;
        }
        let (low, high) = (a.min(b).min(c), a.max(b).max(c));
        let range = |low: f64, high: f64, n: usize| {
            let from = (low - 0.5).ceil().max(0.0);
            let to = (high - 0.5).floor().min(n as f64 - 1.0);
            (from <= to).then_some((from as usize, to as usize))
        };
        let (Some((u0, u1)), Some((v0, v1))) = (
            range(low.x, high.x, self.width),
            range(low.y, high.y, self.height),
        ) else {
            return;
        };
        let distances = corners.map(|corner| corner.distance_m);
        for v in v0..=v1 {
            for u in u0..=u1 {
                let p = DVec2::new(u as f64 + 0.5, v as f64 + 0.5);
                let (wa, wb) = ((c - b).perp_dot(p - b) / area, (a - c).perp_dot(p - c) / area);
                let wc = 1.0 - wa - wb;
                if wa < 0.0 || wb < 0.0 || wc < -1e-12 {
                    continue;
                }
                let distance_m = (wa * distances[0] + wb * distances[1] + wc * distances[2]) as f32;
                let at = v * self.width + u;
                if distance_m < self.distance_m[at] {
                    self.distance_m[at] = distance_m;
                    let color = wa * corners[0].color + wb * corners[1].color + wc * corners[2].color;
                    self.color[at] = color.round().to_array().map(|c| c.clamp(0.0, 255.0) as u8);
                }
            }
        }
    }

    /// A line with round ends, `width_px` wide where it runs upright. A line that runs level is thinner, by the ratio
    /// of the picture's height to its width, as in the documents' own pictures.
    pub(crate) fn line(&mut self, ends: &[Corner; 2], width_px: f64) {
        let squeeze = DVec2::new(1.0, self.width as f64 / self.height as f64);
        let [a, b] = ends.map(|end| end.at * squeeze);
        let along = (b - a).try_normalize().unwrap_or(DVec2::X);
        let half = width_px / 2.0;
        let moved = |end: &Corner, by: DVec2| Corner {
            at: end.at + by / squeeze,
            ..*end
        };
        let aside = along.perp() * half;
        let [a, b] = ends;
        let sides = [
            moved(a, aside),
            moved(a, -aside),
            moved(b, aside),
            moved(b, -aside),
        ];
        self.triangle(&[sides[0], sides[1], sides[2]]);
        self.triangle(&[sides[1], sides[3], sides[2]]);
        for (end, outward) in [(a, -along), (b, along)] {
            let rim = |i: usize| {
                let turn = DVec2::from_angle((i as f64 / ROUND as f64 - 0.5) * std::f64::consts::PI);
                moved(end, turn.rotate(outward) * half)
            };
            for i in 0..ROUND {
                self.triangle(&[*end, rim(i), rim(i + 1)]);
            }
        }
    }

    /// The picture: sRGB and alpha, four bytes for each pixel, row by row.
    pub(crate) fn rgba(&self) -> Vec<u8> {
        let (width, height) = (self.width / SAMPLES, self.height / SAMPLES);
        let mut out = Vec::with_capacity(width * height * 4);
        let count = (SAMPLES * SAMPLES) as u32;
        for v in 0..height {
            for u in 0..width {
                let mut sum = [count / 2; 3];
                for row in 0..SAMPLES {
                    let at = (v * SAMPLES + row) * self.width + u * SAMPLES;
                    for sample in &self.color[at..at + SAMPLES] {
                        sum.iter_mut()
                            .zip(sample)
                            .for_each(|(sum, c)| *sum += u32::from(*c));
                    }
                }
                out.extend(sum.map(|sum| (sum / count) as u8));
                out.push(255);
            }
        }
        out
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn corner(x: f64, y: f64, distance_m: f64, red: f64) -> Corner {
        Corner {
            at: DVec2::new(x, y),
            distance_m,
            color: DVec3::new(red, 0.0, 0.0),
        }
    }

    fn red(canvas: &MultisamplePicture, u: usize, v: usize) -> u8 {
        canvas.rgba()[(v * canvas.width / SAMPLES + u) * 4]
    }

    #[test]
    fn nearer_triangles_hide_farther_ones_in_any_order() {
        let near = [
            corner(2.0, 2.0, 1.0, 200.0),
            corner(18.0, 2.0, 1.0, 200.0),
            corner(2.0, 18.0, 1.0, 200.0),
        ];
        let far = [
            corner(0.0, 0.0, 5.0, 90.0),
            corner(40.0, 0.0, 5.0, 90.0),
            corner(0.0, 40.0, 5.0, 90.0),
        ];
        for order in [[&near, &far], [&far, &near]] {
            let mut canvas = MultisamplePicture::new(20, 20);
            order.into_iter().for_each(|t| canvas.triangle(t));
            assert_eq!(
                (red(&canvas, 4, 4), red(&canvas, 17, 17), red(&canvas, 0, 0)),
                (200, 90, 90)
            );
            canvas.begin(10, 10);
            assert!(canvas.rgba().chunks(4).all(|p| p == [0, 0, 0, 255]));
        }
    }

    #[test]
    fn colour_runs_evenly_and_edges_are_smooth() {
        let mut canvas = MultisamplePicture::new(30, 10);
        let [a, b, c, d] = [
            corner(0.0, 0.0, 1.0, 0.0),
            corner(30.0, 0.0, 1.0, 240.0),
            corner(0.0, 5.5, 1.0, 0.0),
            corner(30.0, 5.5, 1.0, 240.0),
        ];
        canvas.triangle(&[a, b, c]);
        canvas.triangle(&[b, d, c]);
        assert!(red(&canvas, 15, 2).abs_diff(124) <= 2, "{}", red(&canvas, 15, 2));
        // Half a row is covered.
        assert!(red(&canvas, 15, 5).abs_diff(62) <= 2 && red(&canvas, 15, 6) == 0);
    }

    #[test]
    fn a_line_is_as_wide_as_asked_upright_and_thinner_level() {
        let mut canvas = MultisamplePicture::new(80, 40);
        let line =
            |x0: f64, y0: f64, x1: f64, y1: f64| [corner(x0, y0, 1.0, 255.0), corner(x1, y1, 1.0, 255.0)];
        canvas.line(&line(20.0, 10.0, 20.0, 30.0), 8.0);
        canvas.line(&line(40.0, 20.0, 70.0, 20.0), 8.0);
        let count = |range: &mut dyn Iterator<Item = (usize, usize)>| {
            range.filter(|(u, v)| red(&canvas, *u, *v) > 0).count()
        };
        assert_eq!(count(&mut (0..35).map(|u| (u, 20))), 8);
        assert_eq!(count(&mut (0..40).map(|v| (55, v))), 4);
        // Round ends: beyond the end in the middle, not at the corner.
        assert!(red(&canvas, 20, 8) > 0 && red(&canvas, 16, 8) == 0);
        // What reaches far beyond the picture costs no more than the picture.
        canvas.line(&line(-1e9, 5.0, 1e9, 6.0), 8.0);
        canvas.triangle(&[
            corner(f64::NAN, 0.0, 1.0, 9.0),
            corner(9.0, 0.0, 1.0, 9.0),
            corner(0.0, 9.0, 1.0, 9.0),
        ]);
    }
}
