//! Exporters: the description of a format that is written, and the products that it may ask for.

use std::collections::BTreeMap;
use std::fmt;

use scene::{
    BoxId, CameraMaps, CameraTruth, Extent, GaussianScene, LidarSweep, Pose, RadarScan, Scene, SweepEdits,
};

use crate::recipe::Recipe;
use crate::{FormatError, Holds};

/// A format that is written.
pub struct Exporter {
    /// Name on the command line.
    pub id: &'static str,
    /// Title, for a person: what the format holds.
    pub title: &'static str,
    /// Name of the file where only a folder is given; `None` for formats that fill a folder.
    pub file_name: Option<&'static str>,
    /// Kinds of content in a file.
    pub holds: &'static [Holds],
    /// Parts of that content that do not come back when the format is read again, for a person; empty if all of it
    /// does.
    pub lost: &'static str,
    /// How much of time it holds.
    pub span: ExportSpan,
    /// Products that must be made of the scene first; the dialog shows the options for them.
    pub needs: &'static [Product],
    /// Makes the files. With [`ExportSpan::Moment`] the scene stands still and is in the ego frame; with [`ExportSpan::Clip`] it is
    /// whole and in the world frame. Errors in one line; nothing is written by then.
    pub write: fn(&Scene, &mut dyn Products) -> Result<Vec<OutFile>, FormatError>,
}

impl PartialEq for Exporter {
    fn eq(&self, other: &Self) -> bool {
        self.id == other.id
    }
}

impl fmt::Debug for Exporter {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Exporter({})", self.id)
    }
}

/// How much of time a file holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ExportSpan {
    /// The moment that is shown.
    Moment,
    /// The whole clip; a scene that stands still is a clip of one moment.
    Clip,
}

/// Data that sensors, networks or the graphics card make of a scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Product {
    /// How often sensors see each box.
    Seen,
    /// Which voxels the sensors observed.
    Observed,
    /// A sweep of the first LiDAR.
    Sweep,
    /// The edits of the sweeps that the scene was imported from.
    Recording,
    /// A scan of every radar.
    Radar,
    /// Classes and depths of every camera.
    CameraMaps,
    /// A picture of every camera.
    Pictures,
    /// A picture of every camera with the truth about it.
    Truth,
    /// The scene as Gaussians.
    Gaussians,
    /// A picture of the 3D view.
    View,
}

/// Makes the products of one scene when a format asks for them. Errors in one line: the rig lacks the sensor, a network or a
/// device is missing, or the export was cancelled.
pub trait Products {
    /// Goes to another moment of the clip: products that are made from now on are of that moment, in its ego frame.
    /// Errors once the export was cancelled.
    fn show(&mut self, time_s: f64) -> Result<(), FormatError>;
    /// How often sensors see each box.
    fn seen(&mut self) -> Result<BoxVisibility, FormatError>;
    /// Which voxels the sensors observed.
    fn observed(&mut self) -> Result<ObservationMasks, FormatError>;
    /// A sweep of the rig's first LiDAR.
    fn sweep(&mut self) -> Result<LidarSweep, FormatError>;
    /// What edits change in one of the sweeps that the scene was imported from. Errors if there is none of that number.
    fn sweep_edits(&mut self, sweep: usize) -> Result<SweepEdits, FormatError>;
    /// A scan of each of the rig's radars, in its order, in the ego frame; empty if it has none.
    fn radars(&mut self) -> Result<Vec<RadarScan>, FormatError>;
    /// Classes and depths of every camera, in the order of the rig; each is taken before the next is made.
    fn camera_maps(
        &mut self,
        take: &mut dyn FnMut(CameraMaps) -> Result<(), FormatError>,
    ) -> Result<(), FormatError>;
    /// A picture of every camera, in the order of the rig; each is taken before the next is made.
    fn pictures(
        &mut self,
        take: &mut dyn FnMut(ExportPicture) -> Result<(), FormatError>,
    ) -> Result<(), FormatError>;
    /// A picture of every camera and the truth about it, made of the same hits, in the order of the rig; each is taken
    /// before the next is made. Poses and boxes are in the ego frame. Flow leads to the clip's next frame, if there is
    /// one.
    fn truth(
        &mut self,
        take: &mut dyn FnMut(ExportPicture, CameraTruth) -> Result<(), FormatError>,
    ) -> Result<(), FormatError>;
    /// The scene as coloured Gaussians, in the ego frame.
    fn gaussians(&mut self) -> Result<GaussianScene, FormatError>;
    /// How the files come to be.
    fn recipe(&self) -> &Recipe;
    /// Where the ego vehicle is at the moment that products are made of, in the world frame.
    fn world_from_ego(&self) -> Pose;
    /// A picture of the 3D view.
    fn view(&mut self) -> Result<ExportPicture, FormatError>;
}

/// How often sensors see each box; `None` where there is no sensor of that kind.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct BoxVisibility {
    /// Returns of all LiDARs.
    pub lidar_returns: Option<BTreeMap<BoxId, u32>>,
    /// Pixels of all cameras.
    pub camera_pixels: Option<BTreeMap<BoxId, u32>>,
}

/// Which voxels the rays of sensors passed or ended in, in the ego frame of the moment: per column `[x][y]` of
/// [`ObservationMasks::EXTENT`] one bit per bin, the lowest bin in bit 0. No bit is set where the rig has no sensor of that kind.
#[derive(Clone, Debug, PartialEq)]
pub struct ObservationMasks {
    /// Rays of all LiDARs, one turn each.
    pub lidar: Vec<u16>,
    /// Rays through the pixels of all cameras.
    pub camera: Vec<u16>,
}

impl ObservationMasks {
    /// The columns that are told of.
    pub const EXTENT: Extent = Extent::WINDOW;
}

/// A picture to be written.
#[derive(Clone, Debug, PartialEq)]
pub struct ExportPicture {
    /// The camera of the rig that took it; empty for the 3D view.
    pub camera: String,
    /// Pixels per row.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// sRGB and alpha, four bytes per pixel, row-major, top row first.
    pub rgba: Vec<u8>,
}

/// A file that is ready to be written.
#[derive(Clone, Debug, PartialEq)]
pub struct OutFile {
    /// Its path in a folder: names of letters, digits and `-_.` with `/` between them.
    pub name: String,
    /// Content of the file.
    pub bytes: Vec<u8>,
}

impl OutFile {
    /// Replaces characters of the name that a file may not have: users name cameras.
    pub(crate) fn new(name: &str, bytes: Vec<u8>) -> Self {
        let tidy = |c: char| {
            if c.is_alphanumeric() || "-_.".contains(c) {
                c
            } else {
                '_'
            }
        };
        Self {
            name: name.chars().map(tidy).collect(),
            bytes,
        }
    }

    /// Puts the file into a folder within the export's folder.
    pub(crate) fn within(self, folder: &str) -> Self {
        let tidy = |part: &str| match part {
            "." | ".." => "_".to_owned(),
            part => Self::new(part, Vec::new()).name,
        };
        let parts = folder.split('/').filter(|part| !part.is_empty()).map(tidy);
        let path: Vec<String> = parts.chain([self.name]).collect();
        Self {
            name: path.join("/"),
            bytes: self.bytes,
        }
    }
}
