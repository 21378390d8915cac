//! The files that a rendering writes.

use std::path::{Path, PathBuf};

use anyhow::Context;

use app::picture::{self, RgbaPicture, SHEET_COLOR};
use formats::export::{OutFile, ply};
use formats::npz::{self, Array, NpzValues};
use formats::out_folder::OutFolder;
use formats::recipe::Recipe;
use formats::{calibration, multi_plane, png};
use scene::{
    CameraMaps, Frame, LidarSweep, MultiPlaneImage, PerspectiveMap, Pose, RadarReturn, RadarScan, Scene,
};
use sensors::cameras::{CameraPicture, SourceView, ViewId};
use sensors::pictures::appearance::CameraImage;
use sensors::pictures::color;

/// A folder, and the files written into it.
pub struct Writer {
    folder: OutFolder,
    recipe: Recipe,
    /// Paths of the files.
    pub files: Vec<PathBuf>,
    /// The first picture that was written.
    pub first: Option<RgbaPicture>,
    /// Pictures in colours of the cameras so far.
    sheet: Option<RgbaPicture>,
}

/// Pictures in a row of a sheet, and the space around each, pixels.
const SHEET_COLUMNS: usize = 3;
const SHEET_MARGIN: usize = 6;

/// A sheet for so many pictures of a size.
fn empty_sheet([width, height]: [usize; 2], count: usize) -> RgbaPicture {
    let side = |n: usize, side: usize| n * (side + SHEET_MARGIN) + SHEET_MARGIN;
    let (columns, rows) = (count.min(SHEET_COLUMNS), count.div_ceil(SHEET_COLUMNS));
    RgbaPicture::filled(side(columns, width), side(rows, height), SHEET_COLOR)
}

/// Memory that the sheet of so many pictures of a size takes, bytes.
pub fn sheet_bytes(size: [u32; 2], count: usize) -> u64 {
    let side = |n: usize, side: u32| n as u64 * (u64::from(side) + SHEET_MARGIN as u64) + SHEET_MARGIN as u64;
    let (columns, rows) = (count.min(SHEET_COLUMNS), count.div_ceil(SHEET_COLUMNS));
    4 * side(columns, size[0]) * side(rows, size[1])
}

impl Writer {
    /// Makes the folder; `recipe` goes into the pictures.
    pub fn new(dir: &Path, recipe: Recipe) -> anyhow::Result<Self> {
        Ok(Self {
            folder: OutFolder::make(dir)?,
            recipe,
            files: Vec::new(),
            first: None,
            sheet: None,
        })
    }

    fn bytes(&mut self, name: &str, bytes: &[u8]) -> anyhow::Result<()> {
        self.files.push(self.folder.write(name, bytes)?);
        Ok(())
    }

    /// Files that are ready.
    pub fn out_files(&mut self, files: Vec<OutFile>) -> anyhow::Result<()> {
        files.into_iter().try_for_each(|f| self.bytes(&f.name, &f.bytes))
    }

    /// Recipe of the pictures.
    pub fn recipe(&self) -> &Recipe {
        &self.recipe
    }

    /// Writes the calibration: where the sensors look, and when.
    pub fn calibration(
        &mut self,
        scene: &Scene,
        world_from_ego: &Pose,
        size: [u32; 2],
    ) -> anyhow::Result<()> {
        let bytes = calibration::to_bytes(scene, world_from_ego, Some(size));
        self.bytes(calibration::FILE, &bytes)
    }

    fn png(&mut self, name: &str, width: usize, height: usize, rgba: &[u8]) -> anyhow::Result<()> {
        let encode = |notes: &png::Notes<'_>| png::rgba(width, height, rgba, notes);
        let bytes = self.recipe.in_png(true, encode);
        let bytes = bytes.with_context(|| format!("encode {name}"))?;
        self.first.get_or_insert_with(|| RgbaPicture {
            width,
            height,
            rgba: rgba.to_vec(),
        });
        self.bytes(name, &bytes)
    }

    fn png16(&mut self, name: &str, width: usize, height: usize, values: &[u16]) -> anyhow::Result<()> {
        let bytes = png::grey16(width, height, values, &png::Notes::default())
            .with_context(|| format!("encode {name}"))?;
        self.bytes(name, &bytes)
    }

    /// Any picture.
    pub fn picture(&mut self, name: &str, picture: &RgbaPicture) -> anyhow::Result<()> {
        self.png(name, picture.width, picture.height, &picture.rgba)
    }

    /// Classes and depths of a camera as pictures, and all of it as arrays.
    fn maps(&mut self, m: &CameraMaps, semantic: bool, depth: bool) -> anyhow::Result<()> {
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
            values: NpzValues::F32(values.to_vec()),
        };
        let labels = Array {
            name: "semantic",
            shape: &shape,
            values: NpzValues::U8(m.semantic.clone()),
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

    /// Writes the files of one camera's picture in these views. `place` is the camera's number and the number of
    /// cameras.
    pub fn camera(
        &mut self,
        picture: CameraPicture,
        views: &[SourceView],
        place: (usize, usize),
    ) -> anyhow::Result<()> {
        let wants = |id: ViewId| views.iter().any(|v| v.id == id);
        match picture {
            CameraPicture::Maps(maps) => self.maps(&maps, wants(ViewId::SEMANTIC), wants(ViewId::DEPTH)),
            CameraPicture::Planes(image) => self.planes(&image),
            CameraPicture::Layout(map) => self.perspective(&map),
            CameraPicture::Picture(image) => match views.first() {
                Some(view) => self.image(image, view.id, place),
                None => Ok(()),
            },
        }
    }

    /// A picture in colours; it is kept in the sheet of all cameras too.
    fn image(&mut self, image: CameraImage, view: ViewId, place: (usize, usize)) -> anyhow::Result<()> {
        let picture = RgbaPicture {
            width: image.width,
            height: image.height,
            rgba: image.rgba,
        };
        self.picture(&format!("{}_{}.png", image.camera, view.name()), &picture)?;
        let (number, count) = place;
        let size = [picture.width, picture.height];
        let sheet = self.sheet.get_or_insert_with(|| empty_sheet(size, count));
        let (column, row) = (number % SHEET_COLUMNS, number / SHEET_COLUMNS);
        let at = |i: usize, side: usize| SHEET_MARGIN + i * (side + SHEET_MARGIN);
        sheet.put(&picture, at(column, size[0]), at(row, size[1]));
        Ok(())
    }

    /// Writes the sheet of all cameras, where pictures in colours were written.
    pub fn finish_sheet(&mut self, views: &[SourceView]) -> anyhow::Result<()> {
        match (self.sheet.take(), views.first()) {
            (Some(sheet), Some(view)) => self.picture(&format!("{}.png", view.id.name()), &sheet),
            _ => Ok(()),
        }
    }

    /// Boxes and lanes: a picture, and the channels as bits.
    fn perspective(&mut self, map: &PerspectiveMap) -> anyhow::Result<()> {
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
    fn planes(&mut self, image: &MultiPlaneImage) -> anyhow::Result<()> {
        self.bytes(&format!("{}_mpi.npz", image.camera), &multi_plane::sparse(image))?;
        self.picture(&format!("{}_mpi.png", image.camera), &picture::plane_sheet(image))
    }

    /// Points in the ego frame, and a picture of the map from above.
    pub fn lidar(&mut self, frame: &Frame, sweep: &LidarSweep) -> anyhow::Result<()> {
        let mut placed = sweep.clone();
        placed.place(&frame.world_from_ego.inverse());
        self.bytes("lidar.ply", &ply::to_bytes(&placed))?;
        self.picture("lidar.png", &picture::lidar_top(frame.extent(), sweep, 4))
    }

    /// Returns of all radars as arrays, places in the ego frame, and a picture of the map from above.
    pub fn radar(&mut self, frame: &Frame, scans: &[RadarScan]) -> anyhow::Result<()> {
        let mut placed = scans.to_vec();
        let ego_from_world = frame.world_from_ego.inverse();
        placed.iter_mut().for_each(|scan| scan.place(&ego_from_world));
        let of_radar = |(i, scan): (usize, &RadarScan)| std::iter::repeat_n(i as u8, scan.returns.len());
        let radars: Vec<u8> = placed.iter().enumerate().flat_map(of_radar).collect();
        let returns: Vec<&RadarReturn> = placed.iter().flat_map(|scan| &scan.returns).collect();
        let (rows, places) = ([returns.len()], [returns.len(), 3]);
        let floats = |name, of: fn(&RadarReturn) -> f32| Array {
            name,
            shape: &rows,
            values: NpzValues::F32(returns.iter().map(|one| of(one)).collect()),
        };
        let bytes = |name, values| Array {
            name,
            shape: &rows,
            values: NpzValues::U8(values),
        };
        let arrays = [
            bytes("radar", radars),
            bytes("class", returns.iter().map(|one| one.class.id()).collect()),
            Array {
                name: "position_m",
                shape: &places,
                values: NpzValues::F32(returns.iter().flat_map(|one| one.position_m).collect()),
            },
            floats("range_m", |one| one.range_m),
            floats("azimuth_rad", |one| one.azimuth_rad),
            floats("elevation_rad", |one| one.elevation_rad.unwrap_or(f32::NAN)),
            floats("speed_mps", |one| one.speed_mps),
            floats("speed_over_ground_mps", |one| one.speed_over_ground_mps),
            floats("rcs_dbsm", |one| one.rcs_dbsm),
            floats("snr_db", |one| one.snr_db),
        ];
        self.bytes("radar.npz", &npz::to_bytes(&arrays)?)?;
        self.picture("radar.png", &picture::radar_top(frame, scans, 4))
    }
}
