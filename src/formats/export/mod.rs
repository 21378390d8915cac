//! Formats that can be written: one file here and one line of the table each. The window's dialog and the command line both
//! use this table.

pub mod boxes;
pub mod depth;
pub mod loom;
pub mod mcap;
pub mod nuscenes;
pub mod nuscenes_lidar;
pub mod occ3d;
pub mod openlabel;
pub mod pictures;
pub mod ply;
pub mod semantic;
pub mod truth;
pub mod view;

use std::collections::BTreeMap;
use std::fmt;

use scene::{BoxId, CameraMaps, CameraTruth, LidarSweep, Pose, Scene};

use super::recipe::Recipe;
use super::{FormatError, Holds};

/// Every format for other programs, in the order of lists. The program's own, [`loom::EXPORTER`], is what saving writes.
const TABLE: [&Exporter; 12] = [
    &occ3d::EXPORTER,
    &boxes::EXPORTER,
    &nuscenes_lidar::EXPORTER,
    &ply::EXPORTER,
    &semantic::EXPORTER,
    &depth::EXPORTER,
    &pictures::EXPORTER,
    &truth::EXPORTER,
    &view::EXPORTER,
    &nuscenes::EXPORTER,
    &mcap::EXPORTER,
    &openlabel::EXPORTER,
];

/// A format that is written.
pub struct Exporter {
    /// Name on the command line.
    pub id: &'static str,
    /// What it holds, for a person.
    pub title: &'static str,
    /// Name of the file where only a folder is given; `None` for formats that fill a folder.
    pub file_name: Option<&'static str>,
    /// What a file holds.
    pub holds: &'static [Holds],
    /// What of that does not come back when the format is read again, for a person; empty if all of it does.
    pub lost: &'static str,
    /// How much of time it holds.
    pub span: Span,
    /// What must be made of the scene first; the dialog shows the options for it.
    pub needs: &'static [Product],
    /// The files. Of a moment: the scene stands still and is in the ego frame. Of a clip: the scene is whole and in the world
    /// frame. Errors in one line; nothing is written by then.
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

/// Every format for other programs, in the order of lists.
pub fn all() -> &'static [&'static Exporter] {
    &TABLE
}

/// The format of that name.
pub fn from_id(id: &str) -> Option<&'static Exporter> {
    all().iter().find(|e| e.id == id).copied()
}

/// How much of time a file holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Span {
    /// The moment that is shown.
    Moment,
    /// The whole clip; a scene that stands still is a clip of one moment.
    Clip,
}

/// What sensors, networks or the graphics card make of a scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Product {
    /// How often sensors see each box.
    Seen,
    /// A sweep of the first LiDAR.
    Sweep,
    /// Classes and depths of every camera.
    CameraMaps,
    /// A picture of every camera.
    Pictures,
    /// A picture of every camera with the truth about it.
    Truth,
    /// A picture of the 3D view.
    View,
}

/// Makes the products of one scene when a format asks for them. Errors in one line: the rig lacks the sensor, a network or a
/// device is missing, or the export was cancelled.
pub trait Products {
    /// Another moment of the clip: what is made from now on is of that one, in its ego frame. Errors once the export was
    /// cancelled.
    fn show(&mut self, time_s: f64) -> Result<(), FormatError>;
    /// How often sensors see each box.
    fn seen(&mut self) -> Result<Seen, FormatError>;
    /// A sweep of the rig's first LiDAR.
    fn sweep(&mut self) -> Result<LidarSweep, FormatError>;
    /// Classes and depths of every camera, in the order of the rig; each is taken before the next is made.
    fn camera_maps(
        &mut self,
        take: &mut dyn FnMut(CameraMaps) -> Result<(), FormatError>,
    ) -> Result<(), FormatError>;
    /// A picture of every camera, in the order of the rig; each is taken before the next is made.
    fn pictures(
        &mut self,
        take: &mut dyn FnMut(Picture) -> Result<(), FormatError>,
    ) -> Result<(), FormatError>;
    /// A picture of every camera and the truth about it, made of the same hits, in the order of the rig; each is taken before the
    /// next is made. Poses and boxes are in the ego frame. Flow leads to the clip's next frame, if there is one.
    fn truth(
        &mut self,
        take: &mut dyn FnMut(Picture, CameraTruth) -> Result<(), FormatError>,
    ) -> Result<(), FormatError>;
    /// How the files come to be.
    fn recipe(&self) -> &Recipe;
    /// Where the ego vehicle is at the moment that products are made of, in the world frame.
    fn world_from_ego(&self) -> Pose;
    /// A picture of the 3D view.
    fn view(&mut self) -> Result<Picture, FormatError>;
}

/// How often sensors see each box; `None` where there is no sensor of that kind.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Seen {
    /// Returns of all LiDARs.
    pub lidar_returns: Option<BTreeMap<BoxId, u32>>,
    /// Pixels of all cameras.
    pub camera_pixels: Option<BTreeMap<BoxId, u32>>,
}

/// A picture to be written.
#[derive(Clone, Debug, PartialEq)]
pub struct Picture {
    /// Who took it: a camera of the rig; empty for the 3D view.
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
    /// What goes into it.
    pub bytes: Vec<u8>,
}

impl OutFile {
    /// Replaces characters of the name that a file may not have: users name cameras.
    fn new(name: &str, bytes: Vec<u8>) -> Self {
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

    /// The same in a folder of the export's folder.
    fn within(self, folder: &str) -> Self {
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_tidy() {
        assert_eq!(
            OutFile::new("../CAM FRONT_ä.png", Vec::new()).name,
            ".._CAM_FRONT_ä.png"
        );
        let deep = OutFile::new("a b", Vec::new()).within("/sweeps/../LIDAR TOP/");
        assert_eq!(deep.name, "sweeps/_/LIDAR_TOP/a_b");
        assert_eq!(from_id("ply").map(|e| e.file_name), Some(Some("lidar.ply")));
        assert!(from_id("loom").is_none() && from_id("fbx").is_none());
    }
}
