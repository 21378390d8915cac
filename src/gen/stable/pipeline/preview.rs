//! Previews of latents without the decoder: colours as a linear map of the latents of a cell, fitted to the picture
//! that a run starts from. A decoder of the real size takes seconds a picture, this almost no time.

use numeric::linear::solve;

use crate::StableError;
use crate::noise::LatentSize;
use crate::pictures::PictureBatch;

/// Ridge that keeps the fit of a picture of one colour finite, as a share of its cells.
const RIDGE: f64 = 1e-3;
const COLOURS: usize = 3;

/// Colours of a cell, -1 to 1, as a linear map of its latents and the constant 1.
pub(super) struct Colours {
    /// `[colour][channel]`; the constant comes last.
    map: [Vec<f64>; COLOURS],
}

impl Colours {
    /// Fits the map from latents to the mean colours of their cells by least squares. `None` if there is no solution.
    pub fn fit(latents: &[f32], size: LatentSize, pictures: &PictureBatch) -> Option<Self> {
        let [count, channels, rows, columns] = size;
        let [height, width] = pictures.size();
        if rows * columns == 0 || pictures.count() != count || latents.len() != crate::noise::count(size) {
            return None;
        }
        let [tall, wide] = [height / rows, width / columns];
        let cells = count * rows * columns;
        let mut normal = vec![vec![0.0; channels + 1 + COLOURS]; channels + 1];
        for i in 0..cells {
            let (picture, row, column) = (i / (rows * columns), i / columns % rows, i % columns);
            let mut told: Vec<f64> = of_cell(latents, size, i).collect();
            let mut colour = [0.0; COLOURS];
            for y in row * tall..(row + 1) * tall {
                let from = ((picture * height + y) * width + column * wide) * COLOURS;
                for pixel in pictures.rgb()[from..][..wide * COLOURS].chunks_exact(COLOURS) {
                    colour
                        .iter_mut()
                        .zip(pixel)
                        .for_each(|(sum, v)| *sum += f64::from(*v));
                }
            }
            told.extend(colour.map(|sum| sum / (tall * wide).max(1) as f64));
            for k in 0..=channels {
                let share = told[k];
                normal[k]
                    .iter_mut()
                    .zip(&told)
                    .for_each(|(to, v)| *to += share * v);
            }
        }
        for (k, row) in normal.iter_mut().enumerate() {
            row[k] += RIDGE * cells as f64;
        }
        let of_colour = |colour: usize| {
            let one = |row: &Vec<f64>| [&row[..=channels], &[row[channels + 1 + colour]]].concat();
            solve(normal.iter().map(one).collect())
        };
        Some(Self {
            map: [of_colour(0)?, of_colour(1)?, of_colour(2)?],
        })
    }

    /// Pictures of latents, one pixel a cell. Errors if the latents are not of that size.
    pub fn of(&self, latents: &[f32], size: LatentSize) -> Result<PictureBatch, StableError> {
        crate::check_length("latents", latents.len(), crate::noise::count(size))?;
        let [count, _, rows, columns] = size;
        let mut rgb = Vec::with_capacity(count * rows * columns * COLOURS);
        for i in 0..count * rows * columns {
            for map in &self.map {
                let value: f64 = of_cell(latents, size, i).zip(map).map(|(v, k)| v * k).sum();
                rgb.push(value.clamp(-1.0, 1.0) as f32);
            }
        }
        PictureBatch::new(count, [rows, columns], rgb)
    }
}

/// The latents of a cell, then 1.
fn of_cell(latents: &[f32], [_, channels, rows, columns]: LatentSize, i: usize) -> impl Iterator<Item = f64> {
    let plane = rows * columns;
    let first = i / plane * channels * plane + i % plane;
    let all = (0..channels).map(move |c| f64::from(latents[first + c * plane]));
    all.chain([1.0])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn colours_that_are_a_map_of_latents_are_found() {
        let size @ [count, channels, rows, columns] = [2, 4, 3, 5];
        let hash = |i: usize| ((i * 2_654_435_761) % 1000) as f32 / 500.0 - 1.0;
        let latents: Vec<f32> = (0..crate::noise::count(size)).map(hash).collect();
        let colour = |i: usize, colour: usize| {
            let told: Vec<f64> = of_cell(&latents, size, i).collect();
            (0.3 * told[colour] - 0.2 * told[3] + 0.1 * told[channels]) as f32
        };
        // Two pixels a cell to each side, which differ about the mean.
        let mut rgb = Vec::new();
        for (picture, y) in (0..count).flat_map(|p| (0..2 * rows).map(move |y| (p, y))) {
            for x in 0..2 * columns {
                let i = (picture * rows + y / 2) * columns + x / 2;
                let off = if (x + y) % 2 == 0 { 0.05 } else { -0.05 };
                rgb.extend((0..COLOURS).map(|c| colour(i, c) + off));
            }
        }
        let pictures = PictureBatch::new(count, [2 * rows, 2 * columns], rgb).expect("pictures");
        let colours = Colours::fit(&latents, size, &pictures).expect("a fit");
        let seen = colours.of(&latents, size).expect("pictures");
        assert_eq!((seen.count(), seen.size()), (count, [rows, columns]));
        for (i, rgb) in seen.rgb().chunks_exact(COLOURS).enumerate() {
            for (c, v) in rgb.iter().enumerate() {
                assert!((v - colour(i, c)).abs() < 0.02, "{i} {c}: {v} {}", colour(i, c));
            }
        }
        // Grey latents of a grey picture: finite.
        let grey = PictureBatch::new(1, [2, 2], vec![0.5; 12]).expect("a picture");
        let flat = Colours::fit(&[0.0; 4], [1, 4, 1, 1], &grey).expect("a fit");
        let seen = flat.of(&[0.0; 4], [1, 4, 1, 1]).expect("a picture");
        assert!(seen.rgb().iter().all(|v| (v - 0.5).abs() < 0.01));
        assert!(Colours::fit(&[0.0; 4], [1, 4, 0, 0], &grey).is_none());
    }
}
