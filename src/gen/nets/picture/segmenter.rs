//! A small network that predicts the class of each pixel of a picture. Twin of `training/models/segmenter.py`.

use std::sync::{Arc, OnceLock};

use rayon::prelude::*;

use super::{CELL, PictureSegmenterConfig, check_kind, check_sides};
use crate::encoder::PIECE;
use crate::unet::UNet;
use crate::{ModelError, check_finite, check_length};
use nn::map::FeatureMap;
use nn::weights::{WeightFile, WeightsError};
use nn::{Cpu, Ops};

/// Red, green, blue.
const COLOURS: usize = 3;
/// Side of a window of features, cells of 8 px.
const WINDOW: usize = 8;
/// Number of classes that a pixel may show: those of `scene::truth`, 0 for sky.
pub const SHOWN: usize = 22;

/// The network with its weights, on a backend.
pub struct PictureSegmenter<B: Ops = Cpu> {
    ops: B,
    net: UNet<B>,
    norm: B::Norm,
    head: B::Linear,
}

impl PictureSegmenter {
    /// The weights that ship with the program, learned from its own renderer; unpacked once.
    pub fn bundled() -> Result<Arc<Self>, WeightsError> {
        static NET: OnceLock<Arc<PictureSegmenter>> = OnceLock::new();
        if let Some(net) = NET.get() {
            return Ok(net.clone());
        }
        let file = WeightFile::parse(
            "pictures_segmenter.safetensors",
            assets::weights::PICTURES_SEGMENTER,
        )?;
        let net = Self::on(Cpu, file)?;
        Ok(NET.get_or_init(|| Arc::new(net)).clone())
    }
}

impl<B: Ops> PictureSegmenter<B> {
    /// Takes all tensors of a file; refuses one that is missing, misshapen, not finite or unknown.
    pub fn on(ops: B, mut file: WeightFile<'_>) -> Result<Self, WeightsError> {
        check_kind(&file, "picture_segmenter")?;
        let config: PictureSegmenterConfig = file.config("config")?;
        config
            .check()
            .map_err(|reason| file.config_error("config", reason))?;
        let (w, fine) = (&mut file, config.widths[0]);
        let net = Self {
            net: UNet::new(&ops, w, COLOURS, config.widths, &config.kernels)?,
            norm: ops.load_norm(w, "norm", fine)?,
            head: ops.linear(w, "head", [fine, 4 * SHOWN], &[1, 1])?,
            ops,
        };
        file.finish()?;
        Ok(net)
    }

    /// Logits `[n][height][width][22]` of each pixel's classes in pictures `[n][height][width][3]`, sRGB from -1 to 1.
    /// Height and width are multiples of 8 px. Errors if the sizes do not fit or a number is not finite.
    pub fn logits(
        &self,
        pictures: &[f32],
        sides @ [height, width]: [usize; 2],
    ) -> Result<Vec<f32>, ModelError> {
        check_sides(sides, CELL, "a multiple of 8 px up to 8192")?;
        let size = height * width * COLOURS;
        check_length(
            "pictures",
            pictures.len(),
            pictures.len().next_multiple_of(size).max(size),
        )?;
        check_finite("picture", pictures)?;
        let each = pictures.par_chunks(size).map(|picture| {
            let logits = self.of_one(FeatureMap {
                data: picture.to_vec(),
                rows: height,
                columns: width,
                width: COLOURS,
            })?;
            check_finite("logits", &logits)?;
            Ok(logits)
        });
        Ok(each.collect::<Result<Vec<_>, ModelError>>()?.concat())
    }

    /// The likeliest class of each pixel, `[n][height][width]`; errors as [`logits`](Self::logits).
    pub fn classes(&self, pictures: &[f32], sides: [usize; 2]) -> Result<Vec<u8>, ModelError> {
        let logits = self.logits(pictures, sides)?;
        let likeliest = |pixel: &[f32]| {
            let best = pixel.iter().enumerate().max_by(|a, b| a.1.total_cmp(b.1));
            best.map_or(0, |(class, _)| class as u8)
        };
        Ok(logits.chunks_exact(SHOWN).map(likeliest).collect())
    }

    /// Features of one picture: the means of each channel of the coarsest map in windows of about 8 cells (of 8 px) a
    /// side, row by row. Input and errors as of [`logits`](Self::logits).
    pub fn features(
        &self,
        picture: &[f32],
        sides @ [height, width]: [usize; 2],
    ) -> Result<Vec<Vec<f64>>, ModelError> {
        check_sides(sides, CELL, "a multiple of 8 px up to 8192")?;
        check_length("picture", picture.len(), height * width * COLOURS)?;
        check_finite("picture", picture)?;
        let picture = FeatureMap {
            data: picture.to_vec(),
            rows: height,
            columns: width,
            width: COLOURS,
        };
        let [.., coarse] = self.net.seen(&self.ops, picture)?;
        let map = self.ops.download(coarse)?;
        check_finite("features", &map.data)?;
        let parts = [map.rows, map.columns].map(|n| (n / WINDOW).max(1));
        let mean = |[row, column]: [usize; 2]| {
            let span = |part: usize, parts: usize, n: usize| part * n / parts..(part + 1) * n / parts;
            let (rows, columns) = (span(row, parts[0], map.rows), span(column, parts[1], map.columns));
            let count = (rows.len() * columns.len()) as f64;
            let mut sums = vec![0.0; map.width];
            for cell in rows.flat_map(|r| columns.clone().map(move |c| r * map.columns + c)) {
                let channels = &map.data[cell * map.width..][..map.width];
                sums.iter_mut()
                    .zip(channels)
                    .for_each(|(sum, v)| *sum += f64::from(*v));
            }
            sums.iter().map(|sum| sum / count).collect()
        };
        let windows = (0..parts[0]).flat_map(|row| (0..parts[1]).map(move |column| [row, column]));
        Ok(windows.map(mean).collect())
    }

    fn of_one(&self, picture: FeatureMap) -> Result<Vec<f32>, ModelError> {
        let ops = &self.ops;
        let map = self.net.apply(ops, picture)?;
        let logits = ops.apply(&self.head, &ops.norm(&self.norm, map)?, PIECE)?;
        Ok(ops.download(ops.unfold(&logits)?)?.data)
    }
}
