//! Takes a scene to files of other programs: what the command line and the window share.

use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

use anyhow::{Context, anyhow, bail};
use serde_json::json;

use super::camera_views::march;
use super::checking;
use super::picture::{ShotOptions, View3d};
use super::state::{CameraSource, LidarModel};
use formats::{atomic, box_list, occ3d, png, point_cloud};
use nets::lidar::LidarNet;
use scene::sensor_data::{RENDER_IDS, RenderId};
use scene::{CameraMaps, Class, LidarSweep, Scene, SensorRig};
use sensors::appearance::{Quality, RayMarched, SynthesisInput, ViewSynthesizer};
use sensors::learned::{self, Drops};
use sensors::splat::{self, GaussianCloud, SplatOptions};
use sensors::{color, lidar};
use viewport::{ViewCamera, ViewPreset};

/// What can be exported.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Format {
    /// Occupancy as Occ3D labels.
    Occ3d,
    /// LiDAR sweep as nuScenes keeps it.
    NuscenesLidar,
    /// LiDAR sweep for viewers.
    Ply,
    /// Classes that the cameras see.
    Semantic,
    /// Depths that the cameras see.
    Depth,
    /// Pictures that the cameras take.
    Pictures,
    /// Boxes with their numbers.
    Boxes,
    /// Picture of the 3D view.
    View,
}

impl Format {
    /// Every format, in the order of lists.
    pub const ALL: [Format; 8] = [
        Format::Occ3d,
        Format::Boxes,
        Format::NuscenesLidar,
        Format::Ply,
        Format::Semantic,
        Format::Depth,
        Format::Pictures,
        Format::View,
    ];

    /// Name on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Format::Occ3d => "occ3d",
            Format::NuscenesLidar => "nuscenes-lidar",
            Format::Ply => "ply",
            Format::Semantic => "semantic",
            Format::Depth => "depth",
            Format::Pictures => "pictures",
            Format::Boxes => "boxes",
            Format::View => "view",
        }
    }

    /// The format of that name.
    pub fn from_name(name: &str) -> Option<Format> {
        Self::ALL.into_iter().find(|f| f.name() == name)
    }

    /// What it holds, for a person.
    pub fn what(self) -> &'static str {
        match self {
            Format::Occ3d => "Occupancy: Occ3D labels.npz, 200 x 200 x 16 class labels",
            Format::NuscenesLidar => "LiDAR: nuScenes .pcd.bin, sensor frame (x, y, z, intensity, ring)",
            Format::Ply => "LiDAR: PLY for viewers, ego frame, with class, intensity, ring",
            Format::Semantic => "Cameras: class maps, PNG with palette, and classes.json",
            Format::Depth => "Cameras: depth in millimetres, 16-bit PNG",
            Format::Pictures => "Cameras: pictures in the prompt's weather, PNG",
            Format::Boxes => "Boxes: JSON with centre, size, heading, velocity, LiDAR points",
            Format::View => "3D view: PNG of any size, supersampled",
        }
    }

    /// Name of the file where only a folder is given; `None` for formats that fill a folder.
    pub fn file_name(self) -> Option<&'static str> {
        match self {
            Format::Occ3d => Some("labels.npz"),
            Format::NuscenesLidar => Some("LIDAR_TOP.pcd.bin"),
            Format::Ply => Some("lidar.ply"),
            Format::Boxes => Some("boxes.json"),
            Format::View => Some("view.png"),
            Format::Semantic | Format::Depth | Format::Pictures => None,
        }
    }
}

/// How to export.
#[derive(Clone, Debug)]
pub struct ExportOptions {
    /// Size of camera pictures and maps in pixels.
    pub camera_size: [u32; 2],
    /// What classes and depths are rendered from.
    pub source: CameraSource,
    /// How the LiDAR sweep comes about.
    pub lidar: LidarModel,
    /// How the picture of the 3D view is taken.
    pub shot: ShotOptions,
}

impl Default for ExportOptions {
    fn default() -> Self {
        Self {
            camera_size: [800, 450],
            source: CameraSource::default(),
            lidar: LidarModel::default(),
            shot: ShotOptions::default(),
        }
    }
}

/// How far an export has come, and whether it is still wanted. Shared between the one who writes and the one who waits.
#[derive(Debug, Default)]
pub struct ExportProgress {
    done: AtomicUsize,
    of: AtomicUsize,
    cancelled: AtomicBool,
}

impl ExportProgress {
    /// Begins to count what these formats take.
    fn begin(&self, formats: &[Format], rig: &SensorRig) {
        let of_cameras = |f: &&Format| matches!(f, Format::Semantic | Format::Depth | Format::Pictures);
        let pictures = formats.iter().filter(of_cameras).count() * rig.cameras.len();
        self.done.store(0, Ordering::Relaxed);
        self.of.store(pictures, Ordering::Relaxed);
    }

    /// Asks the export to stop; it does before its next picture, and writes nothing.
    pub fn cancel(&self) {
        self.cancelled.store(true, Ordering::Relaxed);
    }

    /// True once it was asked to stop.
    pub fn is_cancelled(&self) -> bool {
        self.cancelled.load(Ordering::Relaxed)
    }

    /// Pictures that are ready, of how many; none while there is nothing to count.
    pub fn pictures(&self) -> Option<(usize, usize)> {
        let of = self.of.load(Ordering::Relaxed);
        (of > 0).then(|| (self.done.load(Ordering::Relaxed), of))
    }

    fn go_on(&self) -> anyhow::Result<()> {
        match self.is_cancelled() {
            true => bail!("cancelled"),
            false => Ok(()),
        }
    }

    /// Makes something for each camera of a rig, in their order; asks before each whether to go on.
    fn each_camera<T>(
        &self,
        rig: &SensorRig,
        mut make: impl FnMut(&SensorRig) -> anyhow::Result<Vec<T>>,
    ) -> anyhow::Result<Vec<T>> {
        if rig.cameras.is_empty() {
            bail!("the rig {:?} has no camera", rig.name);
        }
        let mut all = Vec::new();
        for camera in &rig.cameras {
            self.go_on()?;
            all.extend(make(&SensorRig {
                cameras: vec![camera.clone()],
                ..rig.clone()
            })?);
            self.done.fetch_add(1, Ordering::Relaxed);
        }
        Ok(all)
    }
}

/// A viewpoint by name: `perspective`, `top`, `front`, `side`, `ego`, or a camera of the scene's rig.
pub fn view_camera(scene: &Scene, name: &str) -> anyhow::Result<ViewCamera> {
    let of_rig = || {
        scene
            .rig
            .cameras
            .iter()
            .find(|c| c.name == name)
            .map(ViewCamera::through)
    };
    ViewPreset::from_name(name)
        .map(ViewCamera::preset)
        .or_else(of_rig)
        .ok_or_else(|| {
            let cameras: Vec<&str> = scene.rig.cameras.iter().map(|c| c.name.as_str()).collect();
            anyhow!(
                "--view is {name:?}, expected perspective, top, front, side, ego or one of {}",
                cameras.join(", ")
            )
        })
}

/// Writes the current frame. One format goes to `path`: the file, or a folder for the format's usual name; formats that
/// fill a folder make it. More go into the folder `path`. Returns the files and their sizes in bytes. Errors in one line;
/// each file is written whole or not at all, and none before all are ready: an export that is cancelled leaves nothing
/// behind.
pub fn export_all(
    scene: &Scene,
    formats: &[Format],
    options: &ExportOptions,
    path: &Path,
    progress: &ExportProgress,
) -> anyhow::Result<Vec<(PathBuf, u64)>> {
    let mut out = Files {
        scene,
        path,
        fills_a_folder: formats.len() > 1,
        ready: Vec::new(),
    };
    progress.begin(formats, &scene.rig);
    for format in formats {
        make_ready(&mut out, scene, *format, options, progress)?;
    }
    progress.go_on()?;
    out.write()
}

/// Makes the files of a format.
fn make_ready(
    out: &mut Files<'_>,
    scene: &Scene,
    format: Format,
    options: &ExportOptions,
    progress: &ExportProgress,
) -> anyhow::Result<()> {
    let frame = scene.frame();
    match format {
        Format::Occ3d => {
            if let Some((x, y, z, label)) = frame.occupancy.iter_set().find(|(.., l)| *l > Class::FREE) {
                bail!(
                    "voxel {x}, {y}, {z} holds label {label}, expected 0 to {}",
                    Class::FREE
                );
            }
            out.file(format, occ3d::to_bytes(&frame.occupancy));
        }
        Format::Boxes => {
            let seen = checking::seen(scene);
            let (lidar, camera) = (seen.lidar_returns.as_ref(), seen.camera_pixels.as_ref());
            let bytes = box_list::to_bytes(&scene.name, frame, lidar, camera).map_err(|e| anyhow!(e))?;
            out.file(format, bytes);
        }
        Format::NuscenesLidar => {
            let sweep = sweep(scene, options.lidar)?;
            // The sweep is of the first one, and there is one.
            let pattern = scene.rig.lidars.first().context("the rig has no LiDAR")?;
            out.file(format, point_cloud::nuscenes(&sweep, pattern));
        }
        Format::Ply => out.file(format, point_cloud::ply(&sweep(scene, options.lidar)?)),
        Format::Semantic => {
            for m in camera_maps(scene, options, progress)? {
                let labels = labels(&m);
                out.picture(
                    &format!("{}_semantic.png", m.camera),
                    png::indexed(m.width, m.height, &labels, &palette())?,
                );
            }
            let classes: Vec<_> = (0..=RENDER_IDS as u8)
                .map(|id| json!({ "index": id, "name": label_name(id), "rgb": palette()[usize::from(id)] }))
                .collect();
            let text = serde_json::to_string_pretty(&json!({ "classes": classes }))?;
            out.beside("classes.json", text.into_bytes());
        }
        Format::Depth => {
            for m in camera_maps(scene, options, progress)? {
                let mm = color::depth_mm(&m.depth_m);
                out.picture(
                    &format!("{}_depth_mm.png", m.camera),
                    png::grey16(m.width, m.height, &mm)?,
                );
            }
        }
        Format::Pictures => {
            let images = progress.each_camera(&scene.rig, |rig| {
                Ok(RayMarched.synthesize(&SynthesisInput {
                    frame,
                    rig,
                    size: options.camera_size,
                    prompt: &scene.prompt,
                    conditions: scene.conditions,
                    quality: Quality::Full,
                })?)
            })?;
            for image in images {
                out.picture(
                    &format!("{}.png", image.camera),
                    png::rgba(image.width, image.height, &image.rgba)?,
                );
            }
        }
        Format::View => {
            let shot = View3d::new()?.shot(scene, &options.shot)?;
            let mut bytes = png::rgba(shot.width, shot.height, &shot.rgba)?;
            tell(scene, &mut bytes);
            out.file(format, bytes);
        }
    }
    progress.go_on()
}

struct Files<'a> {
    scene: &'a Scene,
    path: &'a Path,
    fills_a_folder: bool,
    ready: Vec<(PathBuf, Vec<u8>)>,
}

impl Files<'_> {
    /// The one file of a format.
    fn file(&mut self, format: Format, bytes: Vec<u8>) {
        let is_folder = self.fills_a_folder
            || self.path.is_dir()
            || self.path.as_os_str().to_string_lossy().ends_with(['/', '\\']);
        let path = match format.file_name().filter(|_| is_folder) {
            Some(name) => self.path.join(name),
            None => self.path.to_path_buf(),
        };
        self.ready.push((path, bytes));
    }

    /// One of several in the folder.
    fn beside(&mut self, name: &str, bytes: Vec<u8>) {
        // Cameras are named by users.
        let tidy: String = name
            .chars()
            .map(|c| {
                if c.is_alphanumeric() || "-_.".contains(c) {
                    c
                } else {
                    '_'
                }
            })
            .collect();
        self.ready.push((self.path.join(tidy), bytes));
    }

    fn picture(&mut self, name: &str, mut bytes: Vec<u8>) {
        tell(self.scene, &mut bytes);
        self.beside(name, bytes);
    }

    /// Writes what is ready; makes the folder where it is missing, but no folder above the one that was named.
    fn write(self) -> anyhow::Result<Vec<(PathBuf, u64)>> {
        let mut written = Vec::new();
        for (path, bytes) in self.ready {
            if path != self.path {
                std::fs::create_dir_all(self.path)
                    .with_context(|| format!("create {}", self.path.display()))?;
            }
            atomic::write(&path, &bytes).with_context(|| format!("write {}", path.display()))?;
            written.push((path, bytes.len() as u64));
        }
        Ok(written)
    }
}

/// What a picture shows goes into the picture.
fn tell(scene: &Scene, png: &mut Vec<u8>) {
    png::add_text(png, "Prompt", &scene.prompt);
    png::add_text(png, "Seed", &scene.seed.to_string());
    png::add_text(png, "Scene", &scene.name);
    png::add_text(png, "Software", concat!("sceneloom ", env!("CARGO_PKG_VERSION")));
}

fn sweep(scene: &Scene, model: LidarModel) -> anyhow::Result<LidarSweep> {
    let (occupancy, rig) = (&scene.frame().occupancy, &scene.rig);
    let none = || anyhow!("the rig {:?} has no LiDAR", rig.name);
    match model {
        LidarModel::Exact => lidar::rig_sweep(occupancy, rig).ok_or_else(none),
        LidarModel::Learned if rig.lidars.is_empty() => Err(none()),
        LidarModel::Learned => {
            let net = LidarNet::bundled().context("the LiDAR network")?;
            learned::rig_sweep(&net, occupancy, rig, Drops::Likely).context("the LiDAR network")
        }
    }
}

fn camera_maps(
    scene: &Scene,
    options: &ExportOptions,
    progress: &ExportProgress,
) -> anyhow::Result<Vec<CameraMaps>> {
    let [width, height] = options.camera_size;
    let frame = scene.frame();
    match options.source {
        CameraSource::Splats => {
            let cloud = GaussianCloud::from_grid(&frame.occupancy, &frame.bev_channels());
            let splats = SplatOptions::default();
            progress.each_camera(&scene.rig, |rig| {
                Ok(splat::render_rig(&cloud, rig, width, height, &splats))
            })
        }
        source => {
            let world = march(scene, source == CameraSource::Shapes);
            progress.each_camera(&scene.rig, |rig| Ok(world.render_rig(rig, width, height)))
        }
    }
}

/// Label of the class "others", which shares render id 0 with nothing at all.
const OTHERS: u8 = RENDER_IDS as u8;

/// Labels of a map: render ids, and [`OTHERS`] where a surface of that class is.
fn labels(maps: &CameraMaps) -> Vec<u8> {
    let others = |at: usize| maps.coverage[at] > 0.5 && maps.depth_m[at] > 0.0;
    let of = |(at, id): (usize, &RenderId)| if *id == 0 && others(at) { OTHERS } else { *id };
    maps.semantic.iter().enumerate().map(of).collect()
}

fn palette() -> Vec<[u8; 3]> {
    let ids = (0..RENDER_IDS as u8).map(color::render_id_color);
    ids.chain([Class::Others.color()]).collect()
}

fn label_name(label: u8) -> &'static str {
    match label {
        0 => "nothing",
        17 => "ped_crossing",
        18 => "road_divider",
        19 => "lane_divider",
        OTHERS => "others",
        class => Class::from_id(class).map_or("unknown", Class::name),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::open;

    #[test]
    fn everything_that_is_cancelled_leaves_nothing_behind() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("out");
        let scene = open::from_template("straight", 3).expect("a template");
        let formats: Vec<Format> = Format::ALL.into_iter().filter(|f| *f != Format::View).collect();
        let progress = ExportProgress::default();
        let options = ExportOptions {
            camera_size: [320, 180],
            ..ExportOptions::default()
        };
        let written = std::thread::scope(|threads| {
            threads.spawn(|| {
                // The first pictures are ready: of three formats, all counted.
                while progress.pictures().is_none_or(|(done, _)| done == 0) {
                    std::thread::yield_now();
                }
                progress.cancel();
            });
            export_all(&scene, &formats, &options, &path, &progress)
        });
        assert!(written.is_err() && !path.exists(), "{written:?}");
        assert_eq!(
            progress.pictures().map(|p| p.1),
            Some(3 * scene.rig.cameras.len())
        );
    }
}
