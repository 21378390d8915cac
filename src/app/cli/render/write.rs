//! The files that `render` writes.

use std::path::{Path, PathBuf};

use anyhow::Context;

use crate::cli::output;
use crate::picture::{self, Picture};
use formats::export::ply;
use formats::multi_plane;
use formats::npz::{self, Array, Values};
use scene::{CameraMaps, LidarSweep, MultiPlaneImage, PerspectiveMap};
use sensors::appearance::CameraImage;
use sensors::color;

/// A folder, and what was written into it.
pub struct Writer {
    dir: PathBuf,
    /// Paths of the files.
    pub files: Vec<PathBuf>,
}

impl Writer {
    /// Makes the folder.
    pub fn new(dir: &Path) -> anyhow::Result<Self> {
        std::fs::create_dir_all(dir).with_context(|| format!("create {}", dir.display()))?;
        Ok(Self {
            dir: dir.into(),
            files: Vec::new(),
        })
    }

    fn bytes(&mut self, name: &str, bytes: &[u8]) -> anyhow::Result<()> {
        let path = self.dir.join(name);
        output::write_file(&path, bytes)?;
        self.files.push(path);
        Ok(())
    }

    fn png(&mut self, name: &str, width: usize, height: usize, rgba: &[u8]) -> anyhow::Result<()> {
        let path = self.dir.join(name);
        output::write_png(&path, width, height, rgba)?;
        self.files.push(path);
        Ok(())
    }

    fn png16(&mut self, name: &str, width: usize, height: usize, values: &[u16]) -> anyhow::Result<()> {
        let path = self.dir.join(name);
        output::write_png16(&path, width, height, values)?;
        self.files.push(path);
        Ok(())
    }

    /// Any picture.
    pub fn picture(&mut self, name: &str, picture: &Picture) -> anyhow::Result<()> {
        self.png(name, picture.width, picture.height, &picture.rgba)
    }

    /// Classes and depths of a camera as pictures, and all of it as arrays.
    pub fn maps(&mut self, m: &CameraMaps, semantic: bool, depth: bool) -> anyhow::Result<()> {
        let (name, w, h) = (&m.camera, m.width, m.height);
        if semantic {
            self.png(
                &format!("{name}_semantic.png"),
                w,
                h,
                &color::semantic_rgba(m, true),
            )?;
        }
        if depth {
            self.png(
                &format!("{name}_depth.png"),
                w,
                h,
                &color::depth_rgba(&m.depth_m, 1.0, 60.0),
            )?;
            self.png16(
                &format!("{name}_depth_mm.png"),
                w,
                h,
                &color::depth_mm(&m.depth_m),
            )?;
        }
        let shape = [h, w];
        let floats = |name, values: &[f32]| Array {
            name,
            shape: &shape,
            values: Values::F32(values.to_vec()),
        };
        let labels = Array {
            name: "semantic",
            shape: &shape,
            values: Values::U8(m.semantic.clone()),
        };
        let arrays = [
            labels,
            floats("depth_m", &m.depth_m),
            floats("expected_depth_m", &m.expected_m),
            floats("median_depth_m", &m.median_m),
            floats("coverage", &m.coverage),
        ];
        self.bytes(&format!("{name}_maps.npz"), &npz::to_bytes(&arrays)?)
    }

    /// Pictures as the cameras would take them, and a sheet of all, three to a row.
    pub fn appearance(&mut self, images: Vec<CameraImage>) -> anyhow::Result<()> {
        let mut pictures = Vec::new();
        for image in images {
            let picture = Picture {
                width: image.width,
                height: image.height,
                rgba: image.rgba,
            };
            self.picture(&format!("{}_appearance.png", image.camera), &picture)?;
            pictures.push(picture);
        }
        let rows: Vec<Vec<Picture>> = pictures.chunks(3).map(<[Picture]>::to_vec).collect();
        self.picture("appearance.png", &Picture::sheet(&rows, 6))
    }

    /// Boxes and lanes: a picture, and the channels as bits.
    pub fn perspective(&mut self, map: &PerspectiveMap) -> anyhow::Result<()> {
        let (name, w, h) = (&map.camera, map.width, map.height);
        self.png(
            &format!("{name}_perspective.png"),
            w,
            h,
            &color::perspective_rgba(map),
        )?;
        self.png16(&format!("{name}_perspective_bits.png"), w, h, &map.channels)
    }

    /// A multi-plane image: its runs, and nine planes to look at.
    pub fn planes(&mut self, image: &MultiPlaneImage) -> anyhow::Result<()> {
        self.bytes(&format!("{}_mpi.npz", image.camera), &multi_plane::sparse(image))?;
        self.picture(&format!("{}_mpi.png", image.camera), &picture::plane_sheet(image))
    }

    /// Points, and a picture from above.
    pub fn lidar(&mut self, sweep: &LidarSweep) -> anyhow::Result<()> {
        self.bytes("lidar.ply", &ply::to_bytes(sweep))?;
        self.picture("lidar.png", &picture::lidar_top(sweep, 4))
    }
}
