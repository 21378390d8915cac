//! The control video of a world scenario: boxes, lanes and crossings as the public renderer draws them, an MP4 for each
//! camera, drawn on the processor.

use scene::{Pose, Scene};

use super::{ExportSpan, Exporter, OutFile, Products};
use crate::video::{VideoKind, VideoWriter};
use crate::world_scenario::draw::MultisamplePicture;
use crate::world_scenario::draw_scene::{ColoredMap, Shot};
use crate::world_scenario::ftheta::FTheta;
use crate::world_scenario::map::ScenarioMap;
use crate::world_scenario::{VIDEO_HZ, boxes_at, clip_id, ego_at, length_s, rig, scenario_from_world};
use crate::{FormatError, Holds};

/// Largest picture, pixels: that of the models.
const LARGEST: [u32; 2] = [1280, 720];

/// See the module.
pub const EXPORTER: Exporter = Exporter {
    id: "control-video",
    title: "Control video: MP4 for each camera with boxes, lanes and crossings as Cosmos-Transfer takes them",
    file_name: None,
    holds: &[Holds::Pictures],
    lost: "",
    span: ExportSpan::Clip,
    needs: &[],
    write,
};

/// A camera with the film that is being made of it.
struct Filmed {
    name: String,
    model: FTheta,
    ego_from_camera: Pose,
    writer: VideoWriter,
}

fn write(scene: &Scene, products: &mut dyn Products) -> Result<Vec<OutFile>, FormatError> {
    if let Some(problem) = scene.rig.problem() {
        return Err(FormatError::new(problem));
    }
    if scene.rig.cameras.is_empty() {
        return Err(FormatError::new("no cameras in the rig, expected one at least"));
    }
    let frames = (length_s(scene) * VIDEO_HZ + 1e-6) as u32 + 1;
    let mut filmed = Vec::new();
    for named in rig::named(&scene.rig) {
        let [width, height] = size_of(&named.model);
        filmed.push(Filmed {
            name: named.file_name(),
            model: named.model.resized(width, height),
            ego_from_camera: named.camera.ego_from_camera(),
            writer: VideoWriter::new(VideoKind::Mp4, [width, height], frames, VIDEO_HZ)?,
        });
    }
    let to_scenario = scenario_from_world(scene);
    let painted = ColoredMap::from_map(&ScenarioMap::from_scene(scene, &to_scenario));
    let threads = std::thread::available_parallelism()
        .map_or(1, usize::from)
        .min(filmed.len());
    let share = filmed.len().div_ceil(threads);
    let mut canvases: Vec<MultisamplePicture> = (0..threads).map(|_| MultisamplePicture::new(2, 2)).collect();
    for frame in 0..frames {
        let time_s = f64::from(frame) / VIDEO_HZ;
        products.show(time_s.min(scene.clip().length_s))?;
        let ego = to_scenario * ego_at(scene, time_s);
        let boxes = boxes_at(scene, time_s, &to_scenario);
        let film = |(filmed, canvas): (&mut [Filmed], &mut MultisamplePicture)| {
            filmed.iter_mut().try_for_each(|camera| {
                let mut shot = Shot {
                    canvas: &mut *canvas,
                    model: &camera.model,
                    scenario_from_camera: ego * camera.ego_from_camera,
                };
                shot.draw(&painted, &boxes);
                camera.writer.frame(&canvas.rgba())
            })
        };
        std::thread::scope(|scope| {
            let parts = filmed.chunks_mut(share).zip(&mut canvases);
            let running: Vec<_> = parts.map(|part| scope.spawn(move || film(part))).collect();
            running.into_iter().try_for_each(|thread| match thread.join() {
                Ok(done) => done,
                Err(panic) => std::panic::resume_unwind(panic),
            })
        })?;
    }
    let id = clip_id(scene);
    let file = |camera: Filmed| {
        let bytes = camera.writer.finish()?;
        Ok(OutFile::new(&format!("{id}.{}.mp4", camera.name), bytes))
    };
    filmed.into_iter().map(file).collect()
}

/// The size of a camera's picture that fits into the largest, with even sides.
fn size_of(model: &FTheta) -> [u32; 2] {
    let [width, height] = [model.width, model.height].map(f64::from);
    let scale = (f64::from(LARGEST[0]) / width)
        .min(f64::from(LARGEST[1]) / height)
        .min(1.0);
    [width, height].map(|side| ((side * scale / 2.0).round() as u32 * 2).max(2))
}
