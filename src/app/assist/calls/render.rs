//! `render`: pictures of what the sensors see.

use std::collections::BTreeMap;

use anyhow::bail;
use image::RgbaImage;
use image::imageops::{self, FilterType};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::names;
use crate::call::Operation;
use crate::desk::Desk;
use crate::folder::FileEntry;
use crate::render::{Rendering, check_what};
use app::camera_views::LidarModel;
use app::picture::RgbaPicture;
use formats::{calibration, png};
use scene::{Scene, TimeOfDay, Weather};
use sensors::cameras::{self, SourceId, ViewId};

/// Longest side of the picture that goes with a receipt, pixels.
const SMALL_SIDE: u32 = 640;
/// Most pixels of all pictures of one call: a minute or so of two cores. Clients do not wait for an answer for long.
const MOST_PIXELS: u64 = 40_000_000;

/// Arguments of `render`.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Render {
    /// Kinds of output: `bev` is the map and the voxels from above, `view` the 3D view (needs a graphics driver),
    /// `lidar` the points of a sweep, `radar` the returns of all radars; the others are what cameras see, `appearance` as a photograph.
    #[schemars(schema_with = "names::what")]
    what: Vec<String>,
    /// Names of cameras, as `state` lists them; all of them if left out.
    #[serde(default)]
    cameras: Vec<String>,
    /// Width and height of camera pictures, pixels; all pictures of a call together have at most 40 million.
    #[serde(default = "usual_size")]
    #[schemars(schema_with = "names::size")]
    size: [u32; 2],
    /// Source that classes and depths are rendered from.
    #[serde(default = "usual_source")]
    #[schemars(schema_with = "names::source")]
    source: String,
    /// Time of day of `appearance`; the scene's if left out.
    #[serde(default)]
    time: Option<TimeOfDay>,
    /// Weather of `appearance`; the scene's if left out.
    #[serde(default)]
    weather: Option<Weather>,
    /// `appearance` several times faster, with rougher edges.
    #[serde(default)]
    preview: bool,
    /// The LiDAR network instead of exact rays.
    #[serde(default)]
    learned_lidar: bool,
    /// Folder in the folder of this session that the files go to.
    #[serde(default = "usual_folder")]
    folder: String,
    /// Write over files that are there.
    #[serde(default)]
    replace: bool,
}

fn usual_size() -> [u32; 2] {
    [480, 270]
}

fn usual_source() -> String {
    "shapes".into()
}

fn usual_folder() -> String {
    "pictures".into()
}

/// Receipt of `render`.
#[derive(Debug, Serialize, JsonSchema)]
pub struct RenderReceipt {
    /// The files.
    files: Vec<FileEntry>,
    /// Rays of the LiDAR and points that came back, if it was asked for.
    lidar: Option<[usize; 2]>,
    /// Returns of all radars, if they were asked for.
    radar: Option<usize>,
    /// Time by kind, s.
    wall_s: BTreeMap<String, f64>,
    /// The moment that they show, s.
    time_s: f64,
    /// Number of the state that they show.
    revision: u64,
    #[serde(skip)]
    #[schemars(skip)]
    picture: Option<Vec<u8>>,
}

impl Render {
    /// Files that are written in any case.
    fn surely(&self) -> Vec<&'static str> {
        let file = |what: &String| match what.as_str() {
            "bev" => "bev.png",
            "view" => "view.png",
            _ => calibration::FILE,
        };
        self.what.iter().map(file).collect()
    }

    /// Errors if the pictures of so many cameras have more pixels than one call renders.
    fn check_pixels(&self, cameras: usize) -> anyhow::Result<()> {
        let kinds = self
            .what
            .iter()
            .filter(|w| !["bev", "view", "lidar", "radar"].contains(&w.as_str()));
        let pictures = (kinds.count() * cameras) as u64;
        let [width, height] = self.size.map(u64::from);
        let pixels = (width * height).saturating_mul(pictures);
        if pixels > MOST_PIXELS {
            bail!(
                "{pictures} pictures of {width}x{height} have {} million pixels, expected at most {} million in one call: fewer cameras \
                 or kinds, or a smaller size",
                pixels / 1_000_000,
                MOST_PIXELS / 1_000_000
            );
        }
        Ok(())
    }

    /// The scene with the cameras that were asked for, in the order of the rig.
    fn with_cameras(&self, scene: &Scene) -> anyhow::Result<Scene> {
        let mut scene = scene.clone();
        if self.cameras.is_empty() {
            return Ok(scene);
        }
        let mut rig = (*scene.rig).clone();
        let known: Vec<String> = rig.cameras.iter().map(|c| c.name.clone()).collect();
        if let Some(unknown) = self.cameras.iter().find(|c| !known.contains(c)) {
            bail!("cameras holds {unknown:?}, expected some of {}", known.join(", "));
        }
        rig.cameras.retain(|c| self.cameras.contains(&c.name));
        scene.rig = rig.into();
        Ok(scene)
    }
}

/// A small copy as PNG.
fn small(picture: RgbaPicture) -> Option<Vec<u8>> {
    let [width, height] = [picture.width, picture.height].map(|side| u32::try_from(side).ok());
    let (width, height) = (width?, height?);
    let shrink = f64::from(SMALL_SIDE) / f64::from(width.max(height).max(1));
    let full = RgbaImage::from_raw(width, height, picture.rgba)?;
    let image = match shrink < 1.0 {
        true => {
            let side = |s: u32| ((f64::from(s) * shrink).round() as u32).max(1);
            imageops::resize(&full, side(width), side(height), FilterType::Triangle)
        }
        false => full,
    };
    let [w, h] = [image.width() as usize, image.height() as usize];
    png::rgba(w, h, image.as_raw(), &png::Notes::default()).ok()
}

impl Operation for Render {
    const NAME: &'static str = "render";
    const ABOUT: &'static str = "Renders what cameras, LiDAR and radars of the ego vehicle see at the moment that is shown, or the map from above, and writes PNG pictures and data into a folder. Over MCP the first picture comes with the answer, at most 640 pixels wide. Look at bev to see where things are. Files that are there are written over only with replace: call again with it, or name another folder.";
    const EXAMPLE: &'static str = r#"{"what": ["bev", "semantic"], "cameras": ["CAM_FRONT"], "size": [480, 270], "folder": "pictures", "replace": true}"#;
    const CHANGES: bool = false;
    type Receipt = RenderReceipt;

    fn run(self, desk: &mut Desk) -> anyhow::Result<RenderReceipt> {
        check_what(&self.what, "what")?;
        names::check_size(self.size)?;
        names::check("source", &self.source, &names::sources())?;
        // (the error comes before anything is rendered; the other files are looked at once they are there)
        for file in self.surely() {
            let file = format!("{}/{file}", self.folder);
            desk.folder.may_write(&file, self.replace)?;
        }
        let scene = desk.scene()?;
        let source = cameras::sources_of(ViewId::SEMANTIC)
            .into_iter()
            .map(|s| s.id())
            .find(|id| id.name() == self.source)
            .unwrap_or(SourceId::default());
        let rendering = Rendering {
            what: self.what.clone(),
            size: self.size,
            source,
            weather: self.weather,
            time: self.time,
            preview: self.preview,
            lidar: match self.learned_lidar {
                true => LidarModel::Learned,
                false => LidarModel::Recorded,
            },
            paint: None,
        };
        let shown = self.with_cameras(&scene)?;
        self.check_pixels(shown.rig.cameras.len())?;
        let staging = desk.folder.staging()?;
        let stop = desk.stop.clone();
        let mut listen = |_| match stop() {
            true => bail!("stopped: nobody waits for it any more"),
            false => Ok(()),
        };
        let made = rendering.write(&shown, staging.path(), &mut listen)?;
        let wall_s = made.wall_s.iter().map(|(kind, s)| ((*kind).to_owned(), *s));
        Ok(RenderReceipt {
            files: desk
                .folder
                .publish(staging.path(), (&self.folder, None), self.replace)?,
            lidar: made.lidar,
            radar: made.radar,
            wall_s: wall_s.collect(),
            time_s: scene.time_s(),
            revision: desk.number(scene.content()),
            picture: made.first.and_then(small),
        })
    }

    fn picture(receipt: &mut RenderReceipt) -> Option<Vec<u8>> {
        receipt.picture.take()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn more_pixels_than_a_call_renders_are_refused_beforehand() {
        let of = |what: &[&str], size: [u32; 2]| -> Render {
            serde_json::from_value(serde_json::json!({ "what": what, "size": size })).expect("arguments")
        };
        let line = of(&["bev", "appearance"], [4096, 4096])
            .check_pixels(6)
            .expect_err("100 million")
            .to_string();
        assert!(
            line.starts_with("6 pictures of 4096x4096 have 100 million pixels, expected at most 40 million"),
            "{line}"
        );
        assert!(of(&["appearance"], [4096, 4096]).check_pixels(2).is_ok());
        assert!(
            of(&["appearance", "truth"], [4096, 4096])
                .check_pixels(2)
                .is_err()
        );
        assert!(
            of(&["bev", "view", "lidar", "radar"], [8192, 8192])
                .check_pixels(6)
                .is_ok()
        );
        assert!(
            of(&["semantic", "depth", "appearance"], [1920, 1080])
                .check_pixels(6)
                .is_ok()
        );
    }
}
