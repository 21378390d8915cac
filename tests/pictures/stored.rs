//! Pictures in `tests/pictures/stored`, at half of their size, and the comparison with them.

use std::fs::File;
use std::io::BufWriter;
use std::path::{Path, PathBuf};

use image::codecs::png::{CompressionType, FilterType as PngFilter, PngEncoder};
use image::imageops::{FilterType, resize};
use image::{RgbImage, RgbaImage};

/// Least difference of a channel that counts, of 255: drivers round differently.
const COUNTS: u8 = 40;
/// Largest share of pixels that may differ so. Of a picture of 700 x 450 pixels that is 630: about two words.
const MOST: f64 = 0.002;

/// Pictures of one variant.
pub struct Stored {
    folder: PathBuf,
    variant: &'static str,
    compared: usize,
    different: Vec<String>,
}

impl Stored {
    pub fn new(variant: &'static str) -> Self {
        Self {
            folder: Path::new(env!("CARGO_MANIFEST_DIR"))
                .join("tests/pictures/stored")
                .join(variant),
            variant,
            compared: 0,
            different: Vec::new(),
        }
    }

    /// Compares a picture with the stored one; stores it with `UPDATE=1` if it differs.
    pub fn compare(&mut self, name: &str, picture: &RgbaImage) {
        self.compared += 1;
        let half = resize(
            picture,
            picture.width() / 2,
            picture.height() / 2,
            FilterType::Triangle,
        );
        let mut half = image::DynamicImage::ImageRgba8(half).into_rgb8();
        // (32 levels of each channel: files of half the size)
        half.pixels_mut()
            .flat_map(|p| &mut p.0)
            .for_each(|v| *v = *v / 8 * 8 + 4);
        let path = self.folder.join(format!("{name}.png"));
        let share = image::open(&path)
            .ok()
            .map(|stored| difference(&stored.into_rgb8(), &half));
        if share.is_some_and(|share| share <= MOST) {
            return;
        }
        let into = match std::env::var_os("UPDATE").is_some() {
            true => path,
            false => Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("{}_{name}.png", self.variant)),
        };
        std::fs::create_dir_all(into.parent().expect("a folder")).expect("made");
        let file = BufWriter::new(File::create(&into).expect("made"));
        let encoder = PngEncoder::new_with_quality(file, CompressionType::Best, PngFilter::Adaptive);
        half.write_with_encoder(encoder).expect("written");
        self.different.push(match share {
            Some(share) => format!(
                "{}/{name}: {:.2} % of the pixels differ, see {}",
                self.variant,
                100.0 * share,
                into.display()
            ),
            None => format!("{}/{name}: not stored, see {}", self.variant, into.display()),
        });
    }
}

/// Share of pixels that differ visibly; all if the sizes do.
fn difference(a: &RgbImage, b: &RgbImage) -> f64 {
    if a.dimensions() != b.dimensions() {
        return 1.0;
    }
    let differs = |(a, b): &(&image::Rgb<u8>, &image::Rgb<u8>)| {
        a.0.iter().zip(b.0).any(|(a, b)| a.abs_diff(b) >= COUNTS)
    };
    let count = a.pixels().zip(b.pixels()).filter(differs).count();
    count as f64 / f64::from(a.width() * a.height())
}

/// Comparisons of all variants.
#[derive(Default)]
pub struct Summary {
    compared: usize,
    different: Vec<String>,
}

impl Summary {
    pub fn add(&mut self, stored: Stored) {
        self.compared += stored.compared;
        self.different.extend(stored.different);
    }

    /// Panics if a picture differs from the stored one; with `UPDATE=1` it is told which were renewed.
    pub fn judge(self) {
        println!("{} pictures compared", self.compared);
        let told = self.different.join("\n");
        match std::env::var_os("UPDATE").is_some() {
            true => println!("renewed:\n{told}"),
            false => assert!(
                told.is_empty(),
                "UPDATE=1 renews pictures that may look otherwise:\n{told}"
            ),
        }
    }
}

#[test]
fn a_word_is_a_difference_and_rounding_is_none() {
    let plain = RgbImage::from_pixel(700, 450, image::Rgb([30, 30, 30]));
    let mut rounded = plain.clone();
    rounded.pixels_mut().for_each(|p| p.0[0] += 3);
    assert_eq!(difference(&plain, &rounded), 0.0);
    let mut with_button = plain.clone();
    for (x, y) in (100..160).flat_map(|x| (50..62).map(move |y| (x, y))) {
        with_button.put_pixel(x, y, image::Rgb([120, 140, 160]));
    }
    assert!(difference(&plain, &with_button) > MOST);
    assert_eq!(difference(&plain, &RgbImage::new(10, 10)), 1.0);
}
