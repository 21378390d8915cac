//! Pictures with the truth about them.

use std::time::Instant;

use super::Rendering;
use super::write::Writer;
use app::truth;
use formats::export::truth as files;
use formats::export::{ExportPicture, OutFile};
use formats::sensor_names;
use scene::Scene;
use sensors::cameras::ViewId;
use sensors::pictures::appearance::Quality;

/// A folder for the files of the truth where `depth` has files of the same names beside them.
const FOLDER: &str = "truth";

impl Rendering {
    /// Renders and writes every camera of a scene whose sensors are in the world; `made` is called for each. Returns the seconds
    /// that rendering took.
    pub fn truth(
        &self,
        scene: &Scene,
        writer: &mut Writer,
        made: &mut dyn FnMut() -> anyhow::Result<()>,
    ) -> anyhow::Result<f64> {
        let quality = if self.preview {
            Quality::Preview
        } else {
            Quality::Full
        };
        let beside_depth = self.what.iter().any(|w| w == ViewId::DEPTH.name());
        let placed = |file: OutFile| match beside_depth {
            true => OutFile {
                name: format!("{FOLDER}/{}", file.name),
                ..file
            },
            false => file,
        };
        let place = |files: Vec<OutFile>| files.into_iter().map(placed).collect();
        let ego_from_world = scene.frame().world_from_ego.inverse();
        let (mut time_s, mut boxes) = (0.0, Vec::new());
        let mut start = Instant::now();
        truth::each_camera(
            scene,
            &self.input(scene),
            self.size,
            quality,
            |image, mut truth| {
                time_s += start.elapsed().as_secs_f64();
                truth::place(&mut truth, &ego_from_world);
                let picture = ExportPicture {
                    camera: image.camera,
                    width: image.width,
                    height: image.height,
                    rgba: image.rgba,
                };
                let name = sensor_names::of_file(&scene.rig, &truth.camera.name);
                let files = files::of_camera(writer.recipe(), &name, &picture, &truth)?;
                writer.out_files(place(files))?;
                boxes.push(files::boxes(&truth));
                made()?;
                start = Instant::now();
                Ok(())
            },
        )?;
        let summary = files::summary(writer.recipe(), boxes)?;
        writer.out_files(place(vec![summary]))?;
        Ok(time_s)
    }
}
