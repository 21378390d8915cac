//! Exports a scene to files of other programs, for the command line and the window. `formats::export` defines the
//! formats and writes their files; this module makes the products of the scene that they need.

mod files;
mod progress;

use std::borrow::Cow;
use std::cell::OnceCell;
use std::path::{Path, PathBuf};

use anyhow::{Context, anyhow, bail};

use super::camera_views::LidarModel;
use super::camera_views::camera_input;
use super::picture::{ShotOptions, View3d};
use crate::findings;
use crate::truth;
use formats::FormatError;
use formats::export::{BoxVisibility, ExportPicture, ExportSpan, Exporter, ObservationMasks, Products};
use formats::recipe::Recipe;
use nets::lidar::LidarNet;
use scene::{
    CameraMaps, CameraTruth, GaussianScene, Lattice, LidarSweep, Pose, RadarScan, Scene, SweepEdits,
};
use sensors::bake::{self, BakeOptions};
use sensors::cameras::{
    self, CameraPicture, Detail, PreparedSource, RenderContext, RenderOptions, SourceId, ViewId, bounds,
    pictures,
};
use sensors::lidar::learned::Drops;
use sensors::lidar::observed;
use sensors::lidar::recorded::{self, EditableSweep};
use sensors::lidar::rolling;
use sensors::pictures::appearance::Quality;
use sensors::radar;
use viewport::{ViewCamera, ViewPreset};

pub use progress::ExportProgress;
use progress::takes_pictures;

/// A format that is written, a line of the table [`formats::export::all`].
pub type Format = &'static Exporter;

/// Options of an export.
#[derive(Clone, Debug)]
pub struct ExportOptions {
    /// Size of camera pictures and maps in pixels.
    pub camera_size: [u32; 2],
    /// Source that classes and depths are rendered from.
    pub source: SourceId,
    /// How the LiDAR sweep is computed.
    pub lidar: LidarModel,
    /// Options for the picture of the 3D view.
    pub shot: ShotOptions,
    /// Parameters that the scene was made with, for the recipe in the files; null if they are not known.
    pub parameters: serde_json::Value,
}

impl Default for ExportOptions {
    fn default() -> Self {
        Self {
            camera_size: [800, 450],
            source: cameras::told::ID,
            lidar: LidarModel::default(),
            shot: ShotOptions::default(),
            parameters: serde_json::Value::Null,
        }
    }
}

/// A viewpoint by name: `perspective`, `top`, `front`, `side`, `ego`, or a camera of the scene's rig.
pub fn view_camera(scene: &Scene, name: &str) -> anyhow::Result<ViewCamera> {
    let of_rig = || {
        scene
            .with_rig_in_world()
            .rig
            .cameras
            .iter()
            .find(|c| c.name == name)
            .map(ViewCamera::through)
    };
    ViewPreset::from_name(name)
        .map(|preset| {
            let mut camera = ViewCamera::preset_over(preset, scene.frame().extent());
            if preset != ViewPreset::Top {
                camera.go_along(&scene::Pose::IDENTITY, &scene.frame().world_from_ego);
            }
            camera
        })
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
/// fill a folder make it. Several formats go into the folder `path`. Returns the files and their sizes in bytes. Errors
/// in one line. Each file is written whole or not at all, and none before all are ready, so a cancelled export leaves
/// no file behind. In a folder, no file is written outside it and no file over another: a format that would give other
/// contents to a file of an earlier one gets a folder of its own there, named after the format.
pub fn export_all(
    scene: &Scene,
    formats: &[Format],
    options: &ExportOptions,
    path: &Path,
    progress: &ExportProgress,
) -> anyhow::Result<Vec<(PathBuf, u64)>> {
    let mut ready = Vec::new();
    progress.begin(formats, &scene.rig);
    let (recipe, gaussians) = (OnceCell::new(), OnceCell::new());
    // Files of a moment are in the ego frame; sensors are computed in the world frame.
    for format in formats {
        let of_file = match format.span {
            ExportSpan::Moment if formats::export::keeps_lattice(format, scene) => scene.in_ego(),
            ExportSpan::Clip if formats::export::keeps_lattice(format, scene) => Cow::Borrowed(scene),
            ExportSpan::Moment => Cow::Owned(scene.in_lattice(Lattice::OCC3D).in_ego().into_owned()),
            ExportSpan::Clip => scene.in_lattice(Lattice::OCC3D),
        };
        let mut making = Making {
            whole: scene,
            recipe: &recipe,
            gaussians: &gaussians,
            began: Began::new(format),
            scene: scene.for_sensors(),
            options,
            progress,
        };
        let files = (format.write)(&of_file, &mut making)?;
        progress.go_on()?;
        ready.push(files);
    }
    progress.go_on()?;
    spare_recordings(formats, &ready, path)?;
    files::write(formats, &ready, path)
}

/// Errors if the sweeps that a scene was imported from would replace files that no export wrote: the recording itself.
fn spare_recordings(
    formats: &[Format],
    ready: &[Vec<formats::export::OutFile>],
    path: &Path,
) -> anyhow::Result<()> {
    let of_recordings = formats
        .iter()
        .zip(ready)
        .filter(|(f, _)| f.id == formats::export::recording::EXPORTER.id);
    for pair in of_recordings.flat_map(|(_, files)| files.chunks(2)) {
        let [sweep, origins] = pair else { continue };
        let there = path.join(&sweep.name);
        if there.exists() && !path.join(&origins.name).exists() {
            bail!(
                "{}: is there and no export of a recording: name another folder",
                there.display()
            );
        }
    }
    Ok(())
}

/// Makes the products of a scene for the formats that ask for them.
struct Making<'a> {
    /// The clip.
    whole: &'a Scene,
    /// Made when the first file asks for it, because it needs the scene as a file.
    recipe: &'a OnceCell<Recipe>,
    /// The Gaussians with their moment, s. Baked when the first file asks for them.
    gaussians: &'a OnceCell<(f64, GaussianScene)>,
    began: Began,
    /// The scene at the moment of the products, with the sensors where the ego vehicle is.
    scene: Cow<'a, Scene>,
    options: &'a ExportOptions,
    progress: &'a ExportProgress,
}

/// State of counting the moments of a clip. The moments of a format with pictures are evenly spaced, so the first two
/// give their number.
enum Began {
    /// No moments are left to count: they are counted, or the format is not a clip of pictures.
    Counted,
    /// A clip is to be counted; with its first moment, s, once that is known.
    At(Option<f64>),
}

impl Began {
    fn new(format: Format) -> Self {
        match format.span == ExportSpan::Clip && takes_pictures(format) {
            true => Self::At(None),
            false => Self::Counted,
        }
    }

    /// The number of moments after the first, in a clip of `length_s` seconds. It is known when the second moment
    /// comes, and returned then only.
    fn more(&mut self, time_s: f64, length_s: f64) -> Option<usize> {
        match *self {
            Self::At(Some(first_s)) if time_s > first_s => {
                *self = Self::Counted;
                Some(((length_s - first_s) / (time_s - first_s) + 1e-6) as usize)
            }
            Self::At(None) => {
                *self = Self::At(Some(time_s));
                None
            }
            _ => None,
        }
    }
}

impl Making<'_> {
    /// Counts the pictures of the moments to come when pictures of the second moment are asked for.
    fn count_moments(&mut self) {
        if let Some(moments) = self.began.more(self.scene.time_s(), self.whole.clip().length_s) {
            self.progress.more(moments * self.whole.rig.cameras.len());
        }
    }

    /// Renders a view for each camera, in the rig's order, and hands each picture on before the next is made. Checks
    /// before each picture whether to go on.
    fn each_camera(
        &self,
        view: ViewId,
        mut take: impl FnMut(CameraPicture) -> anyhow::Result<()>,
    ) -> anyhow::Result<()> {
        let (rig, options, progress) = (&self.scene.rig, self.options, self.progress);
        if rig.cameras.is_empty() {
            bail!("the rig {:?} has no camera", rig.name);
        }
        let source = cameras::source_of(view, options.source);
        bounds::check(options.camera_size, source.about().bytes_per_pixel, 0)?;
        let ready = PreparedSource::new(source, &camera_input(&self.scene, Detail::Full));
        let options = RenderOptions {
            size: options.camera_size,
            quality: Quality::Full,
        };
        for camera in &rig.cameras {
            progress.go_on()?;
            let context = RenderContext {
                cancelled: &|| progress.is_cancelled(),
                ..RenderContext::processor()
            };
            take(ready.render(camera, &options, context)?)?;
            progress.made();
        }
        Ok(())
    }

    /// A sweep of the rig's first LiDAR, in the world.
    fn swept(&self) -> anyhow::Result<LidarSweep> {
        let scene = &*self.scene;
        if scene.rig.lidars.is_empty() {
            bail!("the rig {:?} has no LiDAR", scene.rig.name);
        }
        match self.options.lidar.of_scene(scene) {
            LidarModel::Recorded => return Ok(recorded::sweep_of(scene).unwrap_or_default()),
            LidarModel::Exact => return Ok(rolling::exact(scene)),
            LidarModel::Learned => {}
        }
        let net = LidarNet::bundled().context("the LiDAR network")?;
        rolling::learned(&net, scene, Drops::Likely).context("the LiDAR network")
    }
}

impl Products for Making<'_> {
    fn show(&mut self, time_s: f64) -> Result<(), FormatError> {
        self.progress.go_on().map_err(FormatError::new)?;
        if time_s != self.scene.time_s() {
            let moment = self.whole.at(time_s);
            self.scene = Cow::Owned(moment.for_sensors().into_owned());
        }
        Ok(())
    }

    fn seen(&mut self) -> Result<BoxVisibility, FormatError> {
        let seen = findings::seen(&self.scene);
        Ok(BoxVisibility {
            lidar_returns: seen.lidar_returns,
            camera_pixels: seen.camera_pixels,
        })
    }

    fn observed(&mut self) -> Result<ObservationMasks, FormatError> {
        let moment = self.whole.at(self.scene.time_s());
        let moment = moment.in_lattice(Lattice::OCC3D);
        let ego = moment.in_ego();
        if let Some(problem) = ego.rig.problem() {
            return Err(FormatError::new(problem));
        }
        let grid = ego.frame().occupancy.crop(ObservationMasks::EXTENT);
        let seen = observed::observed(&grid, &ego.rig);
        Ok(ObservationMasks {
            lidar: seen.lidar,
            camera: seen.camera,
        })
    }

    fn sweep(&mut self) -> Result<LidarSweep, FormatError> {
        let mut sweep = self.swept().map_err(FormatError::new)?;
        sweep.place(&self.scene.rig.vehicle.inverse());
        Ok(sweep)
    }

    fn sweep_edits(&mut self, sweep: usize) -> Result<SweepEdits, FormatError> {
        let sweeps = &self.whole.kept.sweeps;
        let recording = sweeps
            .get(sweep)
            .ok_or_else(|| FormatError::new("there is no such sweep"))?;
        let then = self.whole.at(recording.time_s);
        Ok(EditableSweep::new(recording.clone(), sweeps).edits(&then.for_sensors()))
    }

    fn radars(&mut self) -> Result<Vec<RadarScan>, FormatError> {
        self.progress.go_on().map_err(FormatError::new)?;
        let mut scans = radar::scans(&self.scene);
        let ego_from_world = self.scene.rig.vehicle.inverse();
        scans.iter_mut().for_each(|scan| scan.place(&ego_from_world));
        Ok(scans)
    }

    fn camera_maps(
        &mut self,
        take: &mut dyn FnMut(CameraMaps) -> Result<(), FormatError>,
    ) -> Result<(), FormatError> {
        self.count_moments();
        let each = self.each_camera(ViewId::SEMANTIC, |picture| match picture {
            CameraPicture::Maps(maps) => Ok(take(maps)?),
            _ => bail!("the source of classes and depths gives something else"),
        });
        each.map_err(FormatError::new)
    }

    fn pictures(
        &mut self,
        take: &mut dyn FnMut(ExportPicture) -> Result<(), FormatError>,
    ) -> Result<(), FormatError> {
        self.count_moments();
        let each = self.each_camera(pictures::VIEW.id, |picture| match picture {
            CameraPicture::Picture(image) => Ok(take(ExportPicture {
                camera: image.camera,
                width: image.width,
                height: image.height,
                rgba: image.rgba,
            })?),
            _ => bail!("the source of pictures gives something else"),
        });
        each.map_err(FormatError::new)
    }

    fn truth(
        &mut self,
        take: &mut dyn FnMut(ExportPicture, CameraTruth) -> Result<(), FormatError>,
    ) -> Result<(), FormatError> {
        self.count_moments();
        let (progress, ego_from_world) = (self.progress, self.world_from_ego().inverse());
        let told = truth::each_camera(
            &self.scene,
            &camera_input(&self.scene, Detail::Full),
            self.options.camera_size,
            Quality::Full,
            |image, mut truth| {
                progress.go_on()?;
                truth::place(&mut truth, &ego_from_world);
                let picture = ExportPicture {
                    camera: image.camera,
                    width: image.width,
                    height: image.height,
                    rgba: image.rgba,
                };
                take(picture, truth)?;
                progress.made();
                Ok(())
            },
        );
        told.map_err(FormatError::new)
    }

    fn gaussians(&mut self) -> Result<GaussianScene, FormatError> {
        let time_s = self.scene.time_s();
        if let Some((of_s, baked)) = self.gaussians.get()
            && *of_s == time_s
        {
            return Ok(baked.clone());
        }
        let go_on = |share| self.progress.baking(share);
        let baked = bake::bake_scene(&self.scene, &BakeOptions::default(), &go_on);
        self.progress.baked();
        let baked = baked.ok_or_else(|| FormatError::new("cancelled"))?;
        // (the Gaussians of a second moment are not kept)
        let _ = self.gaussians.set((time_s, baked.clone()));
        Ok(baked)
    }

    fn recipe(&self) -> &Recipe {
        self.recipe.get_or_init(|| Recipe {
            parameters: self.options.parameters.clone(),
            ..Recipe::of(self.whole)
        })
    }

    fn world_from_ego(&self) -> Pose {
        self.scene.frame().world_from_ego
    }

    fn view(&mut self) -> Result<ExportPicture, FormatError> {
        let shot = View3d::new(self.options.shot.look)
            .and_then(|mut view| view.shot(&self.scene, &self.options.shot));
        let shot = shot.map_err(FormatError::new)?;
        Ok(ExportPicture {
            camera: String::new(),
            width: shot.width,
            height: shot.height,
            rgba: shot.rgba,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::open;
    use formats::export::Product;

    #[test]
    fn everything_that_is_cancelled_leaves_nothing_behind() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("out");
        let scene = open::from_template("straight", 3).expect("a template");
        let needs = |f: &Format, what| f.needs.contains(&what);
        let needs_no_device = |f: &Format| !needs(f, Product::View) && !needs(f, Product::Recording);
        let formats: Vec<Format> = formats::export::all()
            .iter()
            .copied()
            .filter(needs_no_device)
            .collect();
        let progress = ExportProgress::default();
        let options = ExportOptions {
            camera_size: [320, 180],
            ..ExportOptions::default()
        };
        let written = std::thread::scope(|threads| {
            threads.spawn(|| {
                // The first pictures are ready; pictures of every format are counted.
                while progress.pictures().is_none_or(|(done, _)| done == 0) {
                    std::thread::yield_now();
                }
                progress.cancel();
            });
            export_all(&scene, &formats, &options, &path, &progress)
        });
        assert!(written.is_err() && !path.exists(), "{written:?}");
        let counted = formats.iter().filter(|f| takes_pictures(f)).count();
        assert!(counted >= 3, "{formats:?}");
        assert_eq!(
            progress.pictures().map(|p| p.1),
            Some(counted * scene.rig.cameras.len())
        );
    }

    #[test]
    fn every_picture_of_a_clip_is_counted() {
        let folder = tempfile::tempdir().expect("a folder");
        let mut scene = open::from_template("straight", 3).expect("a template");
        let key = |time_s: f64, x: f64| scene::Key {
            time_s,
            at_m: glam::DVec2::new(x, 0.0),
            yaw_deg: 0.0,
        };
        scene.change_clip(|clip| {
            (clip.length_s, clip.rate_hz) = (1.0, 10.0);
            clip.ego = Some(scene::Motion::Keys(vec![key(0.0, 0.0), key(1.0, 4.0)]));
        });
        let options = ExportOptions {
            camera_size: [16, 9],
            ..ExportOptions::default()
        };
        let cameras = scene.rig.cameras.len();
        // A format with ten moments a second, one with two, and both together.
        for (ids, moments) in [
            (vec!["mcap"], 11),
            (vec!["nuscenes"], 3),
            (vec!["pictures", "mcap", "nuscenes"], 15),
        ] {
            let formats: Vec<Format> = ids
                .iter()
                .map(|id| formats::export::from_id(id).expect("a format"))
                .collect();
            let progress = ExportProgress::default();
            let path = folder.path().join(ids.join("-"));
            std::fs::create_dir(&path).expect("writable");
            export_all(&scene, &formats, &options, &path, &progress).expect("written");
            let all = moments * cameras;
            assert_eq!(progress.pictures(), Some((all, all)), "{ids:?}");
        }
    }
}
