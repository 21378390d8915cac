//! Takes a scene to files of other programs: what the command line and the window share. Which formats there are, and what
//! they write, is in `formats::export`; here is what has to be made of the scene for them.

use std::borrow::Cow;
use std::cell::OnceCell;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

use anyhow::{Context, anyhow, bail};

use super::camera_views::LidarModel;
use super::camera_views::camera_input;
use super::picture::{ShotOptions, View3d};
use crate::findings;
use crate::truth;
use formats::export::{Exporter, Observed, OutFile, Picture, Product, Products, Seen, Span};
use formats::out_folder::OutFolder;
use formats::recipe::Recipe;
use formats::{FormatError, atomic};
use nets::lidar::LidarNet;
use scene::plain_name;
use scene::{CameraMaps, CameraTruth, GaussianScene, LidarSweep, Pose, Scene, SensorRig};
use sensors::appearance::Quality;
use sensors::bake::{self, BakeOptions};
use sensors::cameras::{
    self, CameraPicture, Detail, Ready, RenderContext, RenderOptions, SourceId, ViewId, bounds, pictures,
};
use sensors::learned::Drops;
use sensors::observed;
use sensors::rolling;
use viewport::{ViewCamera, ViewPreset};

/// A format that is written, a line of the table [`formats::export::all`].
pub type Format = &'static Exporter;

/// How to export.
#[derive(Clone, Debug)]
pub struct ExportOptions {
    /// Size of camera pictures and maps in pixels.
    pub camera_size: [u32; 2],
    /// What classes and depths are rendered from.
    pub source: SourceId,
    /// How the LiDAR sweep comes about.
    pub lidar: LidarModel,
    /// How the picture of the 3D view is taken.
    pub shot: ShotOptions,
    /// What the scene was made with, for the recipe that files carry; null if that is not known.
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
        let of_cameras = |f: &&Format| {
            let pictures = [Product::CameraMaps, Product::Pictures, Product::Truth];
            f.needs.iter().any(|product| pictures.contains(product))
        };
        let pictures = formats.iter().filter(of_cameras).count() * rig.cameras.len();
        self.done.store(0, Ordering::Relaxed);
        self.of.store(pictures, Ordering::Relaxed);
    }

    /// Says how many pictures are ready, of how many.
    pub fn count(&self, done: usize, of: usize) {
        self.done.store(done, Ordering::Relaxed);
        self.of.store(of, Ordering::Relaxed);
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

    /// Renders a view for each camera, in the rig's order, and hands each picture on before the next is made; asks before
    /// each whether to go on.
    fn each_camera(
        &self,
        scene: &Scene,
        (view, options): (ViewId, &ExportOptions),
        mut take: impl FnMut(CameraPicture) -> anyhow::Result<()>,
    ) -> anyhow::Result<()> {
        let rig = &scene.rig;
        if rig.cameras.is_empty() {
            bail!("the rig {:?} has no camera", rig.name);
        }
        let source = cameras::source_of(view, options.source);
        bounds::check(options.camera_size, source.about().bytes_per_pixel, 0)?;
        let ready = Ready::new(source, &camera_input(scene, Detail::Full));
        let options = RenderOptions {
            size: options.camera_size,
            quality: Quality::Full,
        };
        for camera in &rig.cameras {
            self.go_on()?;
            let context = RenderContext {
                cancelled: &|| self.is_cancelled(),
                ..RenderContext::processor()
            };
            take(ready.render(camera, &options, context)?)?;
            self.done.fetch_add(1, Ordering::Relaxed);
        }
        Ok(())
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
/// fill a folder make it. More go into the folder `path`. Returns the files and their sizes in bytes. Errors in one line;
/// each file is written whole or not at all, and none before all are ready: an export that is cancelled leaves nothing
/// behind. In a folder nothing outside it is written, and no file of a format over another of its own.
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
    // Files of a moment speak of the ego frame; sensors see the scene where it is.
    for format in formats {
        let of_file = match format.span {
            Span::Moment => scene.in_ego(),
            Span::Clip => Cow::Borrowed(scene),
        };
        let mut making = Making {
            whole: scene,
            recipe: &recipe,
            gaussians: &gaussians,
            scene: scene.with_rig_in_world(),
            options,
            progress,
        };
        let files = (format.write)(&of_file, &mut making)?;
        progress.go_on()?;
        ready.push(files);
    }
    progress.go_on()?;
    match fills_a_folder(formats, path) {
        true => write_into(path, &ready),
        false => write_one(path, &ready),
    }
}

/// True unless there is one format of one file, and the path is no folder.
fn fills_a_folder(formats: &[Format], path: &Path) -> bool {
    match formats {
        [format] if format.file_name.is_some() => {
            path.is_dir() || path.as_os_str().to_string_lossy().ends_with(['/', '\\'])
        }
        _ => true,
    }
}

/// Writes the file of a format; no folder is made.
fn write_one(path: &Path, ready: &[Vec<OutFile>]) -> anyhow::Result<Vec<(PathBuf, u64)>> {
    let one = |file: &OutFile| {
        atomic::write(path, &file.bytes).with_context(|| format!("write {}", path.display()))?;
        Ok((path.to_path_buf(), file.bytes.len() as u64))
    };
    ready.iter().flatten().map(one).collect()
}

/// Writes the files of each format into a folder, which is made; none before it is known that all of them may be written.
fn write_into(path: &Path, ready: &[Vec<OutFile>]) -> anyhow::Result<Vec<(PathBuf, u64)>> {
    for files in ready {
        let mut known: BTreeMap<String, &OutFile> = BTreeMap::new();
        for file in files {
            let first = known.entry(plain_name::folded(&file.name)).or_insert(file);
            if first.bytes != file.bytes {
                bail!(
                    "{}: two different files would be called {}, expected sensors of less like names",
                    path.display(),
                    file.name
                );
            }
        }
    }
    let mut written = Vec::new();
    let folder = OutFolder::make(path)?;
    let mut all = ready.iter().flatten();
    all.try_for_each(|file| folder.check(&file.name))?;
    // (formats that share a file, as the calibration, share it: the last one's stays)
    for files in ready {
        let mut folder = OutFolder::make(path)?;
        for file in files {
            written.push((folder.write(&file.name, &file.bytes)?, file.bytes.len() as u64));
        }
    }
    Ok(written)
}

/// Makes the products of a scene for the formats that ask for them.
struct Making<'a> {
    /// The clip.
    whole: &'a Scene,
    /// Made when the first file asks for it: it takes the scene as a file.
    recipe: &'a OnceCell<Recipe>,
    /// Baked when the first file asks for them, and of which moment.
    gaussians: &'a OnceCell<(f64, GaussianScene)>,
    /// The moment that products are made of, with the sensors where the ego vehicle is.
    scene: Cow<'a, Scene>,
    options: &'a ExportOptions,
    progress: &'a ExportProgress,
}

impl Products for Making<'_> {
    fn show(&mut self, time_s: f64) -> Result<(), FormatError> {
        self.progress.go_on().map_err(FormatError::new)?;
        if time_s != self.scene.time_s() {
            let moment = self.whole.at(time_s);
            self.scene = Cow::Owned(moment.with_rig_in_world().into_owned());
        }
        Ok(())
    }

    fn seen(&mut self) -> Result<Seen, FormatError> {
        let seen = findings::seen(&self.scene);
        Ok(Seen {
            lidar_returns: seen.lidar_returns,
            camera_pixels: seen.camera_pixels,
        })
    }

    fn observed(&mut self) -> Result<Observed, FormatError> {
        let moment = self.whole.at(self.scene.time_s());
        let ego = moment.in_ego();
        if let Some(problem) = ego.rig.problem() {
            return Err(FormatError::new(problem));
        }
        let grid = ego.frame().occupancy.crop(Observed::EXTENT);
        let seen = observed::observed(&grid, &ego.rig);
        Ok(Observed {
            lidar: seen.lidar,
            camera: seen.camera,
        })
    }

    fn sweep(&mut self) -> Result<LidarSweep, FormatError> {
        let mut sweep = sweep(&self.scene, self.options.lidar).map_err(FormatError::new)?;
        sweep.place(&self.scene.rig.vehicle.inverse());
        Ok(sweep)
    }

    fn camera_maps(
        &mut self,
        take: &mut dyn FnMut(CameraMaps) -> Result<(), FormatError>,
    ) -> Result<(), FormatError> {
        let view = (ViewId::SEMANTIC, self.options);
        let each = self
            .progress
            .each_camera(&self.scene, view, |picture| match picture {
                CameraPicture::Maps(maps) => Ok(take(maps)?),
                _ => bail!("the source of classes and depths gives something else"),
            });
        each.map_err(FormatError::new)
    }

    fn pictures(
        &mut self,
        take: &mut dyn FnMut(Picture) -> Result<(), FormatError>,
    ) -> Result<(), FormatError> {
        let view = (pictures::VIEW.id, self.options);
        let each = self
            .progress
            .each_camera(&self.scene, view, |picture| match picture {
                CameraPicture::Picture(image) => Ok(take(Picture {
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
        take: &mut dyn FnMut(Picture, CameraTruth) -> Result<(), FormatError>,
    ) -> Result<(), FormatError> {
        let (progress, ego_from_world) = (self.progress, self.world_from_ego().inverse());
        let told = truth::each_camera(
            &self.scene,
            &camera_input(&self.scene, Detail::Full),
            self.options.camera_size,
            Quality::Full,
            |image, mut truth| {
                progress.go_on()?;
                truth::place(&mut truth, &ego_from_world);
                let picture = Picture {
                    camera: image.camera,
                    width: image.width,
                    height: image.height,
                    rgba: image.rgba,
                };
                take(picture, truth)?;
                progress.done.fetch_add(1, Ordering::Relaxed);
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
        let go_on = |_| !self.progress.is_cancelled();
        let baked = bake::bake_scene(&self.scene, &BakeOptions::default(), &go_on)
            .ok_or_else(|| FormatError::new("cancelled"))?;
        // (of a second moment nothing is kept)
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

    fn view(&mut self) -> Result<Picture, FormatError> {
        let shot = View3d::new().and_then(|mut view| view.shot(&self.scene, &self.options.shot));
        let shot = shot.map_err(FormatError::new)?;
        Ok(Picture {
            camera: String::new(),
            width: shot.width,
            height: shot.height,
            rgba: shot.rgba,
        })
    }
}

fn sweep(scene: &Scene, model: LidarModel) -> anyhow::Result<LidarSweep> {
    if scene.rig.lidars.is_empty() {
        bail!("the rig {:?} has no LiDAR", scene.rig.name);
    }
    match model {
        LidarModel::Exact => Ok(rolling::exact(scene)),
        LidarModel::Learned => {
            let net = LidarNet::bundled().context("the LiDAR network")?;
            rolling::learned(&net, scene, Drops::Likely).context("the LiDAR network")
        }
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
        let needs_no_device = |f: &Format| !f.needs.contains(&Product::View);
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
                // The first pictures are ready; those of every format are counted.
                while progress.pictures().is_none_or(|(done, _)| done == 0) {
                    std::thread::yield_now();
                }
                progress.cancel();
            });
            export_all(&scene, &formats, &options, &path, &progress)
        });
        assert!(written.is_err() && !path.exists(), "{written:?}");
        let of_cameras = |f: &&Format| {
            let pictures = [Product::CameraMaps, Product::Pictures, Product::Truth];
            f.needs.iter().any(|product| pictures.contains(product))
        };
        let counted = formats.iter().filter(of_cameras).count();
        assert!(counted >= 3, "{formats:?}");
        assert_eq!(
            progress.pictures().map(|p| p.1),
            Some(counted * scene.rig.cameras.len())
        );
    }
}
