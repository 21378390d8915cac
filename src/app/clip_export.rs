//! A clip as moving pictures: the 3D view, the bird's-eye view or the cameras, frame by frame.

use std::ops::ControlFlow;

use anyhow::{Context, bail};

use formats::video::{VideoKind, VideoWriter};
use scene::Scene;
use sensors::cameras::{
    self, CameraInput, CameraPicture, Detail, PreparedSource, RenderContext, RenderOptions, SourceId, ViewId,
    bounds, learned,
};
use sensors::pictures::appearance::{AppearanceCache, Quality};
use sensors::pictures::painter::{CameraPainter, PaintWith};
use viewport::ViewCamera;

use crate::camera_views::{camera_input, paint_input};
use crate::capture::{CaptureOptions, Subject, capture};
use crate::look::Look;
use crate::painting::PaintWish;
use crate::picture::{self, RgbaPicture, SHOT_BYTES_PER_PIXEL, ShotOptions, View3d};

/// Subject of a clip.
#[derive(Clone, Debug, PartialEq)]
pub enum ClipView {
    /// The 3D view from a viewpoint at the first moment.
    View3d {
        /// The viewpoint.
        camera: Box<ViewCamera>,
        /// True: the camera moves along with the ego vehicle.
        follow: bool,
        /// True: with boxes.
        boxes: bool,
        /// What it shows the scene as.
        look: Look,
    },
    /// The layout from above with boxes; each cell is a whole number of pixels.
    Bev,
    /// The map from above, as large as fits the size.
    Map,
    /// One camera of the rig by index, or all of them in two rows.
    Cameras {
        /// The view.
        view: ViewId,
        /// The source.
        source: SourceId,
        /// The camera; all of them if `None`.
        camera: Option<usize>,
    },
}

/// Options of a clip.
#[derive(Clone, Debug, PartialEq)]
pub struct ClipOptions {
    /// The subject.
    pub view: ClipView,
    /// Width and height of the 3D view and the map, or of each camera, pixels.
    pub size: [u32; 2],
    /// First and last moment, s.
    pub span_s: [f64; 2],
    /// Frames per second.
    pub rate_hz: f64,
    /// Weights that paint learned pictures; the bundled weights if `None`.
    pub paint: Option<PaintWith>,
}

impl ClipOptions {
    /// True if networks paint the pictures.
    pub fn paints(&self) -> bool {
        match self.view {
            ClipView::Cameras { view, source, .. } => cameras::source_of(view, source).id() == learned::ID,
            _ => false,
        }
    }

    /// The moments of the frames, s.
    fn times_s(&self) -> Vec<f64> {
        let [from, to] = self.span_s;
        let frames = ((to - from) * self.rate_hz + 1e-6).max(0.0) as usize + 1;
        (0..frames).map(|i| from + i as f64 / self.rate_hz).collect()
    }
}

/// The file of a clip. `go_on` is told the number of finished frames and of all frames, and returns whether to go on.
/// Errors in one line, also when `go_on` stops it.
pub fn clip(
    scene: &Scene,
    options: &ClipOptions,
    kind: VideoKind,
    go_on: &dyn Fn(usize, usize) -> bool,
) -> anyhow::Result<Vec<u8>> {
    let [from, to] = options.span_s;
    let length_s = scene.clip().length_s;
    // Written so that NaN fails too.
    if !(from >= 0.0 && to >= from && to <= length_s + 1e-9) {
        bail!("a clip from {from} to {to} s, expected moments of 0 to {length_s} s");
    }
    let times_s = options.times_s();
    let frames = u32::try_from(times_s.len()).unwrap_or(u32::MAX);
    if frames > VideoWriter::MAX_FRAMES {
        bail!(
            "a clip of {frames} frames, expected at most {}",
            VideoWriter::MAX_FRAMES
        );
    }
    let mut drawer = ClipRenderer::new(scene, options)?;
    let mut writer = None;
    for (i, time_s) in times_s.iter().enumerate() {
        if !go_on(i, times_s.len()) {
            bail!("cancelled");
        }
        let picture = drawer.draw(&scene.at(*time_s))?;
        let picture = even(picture);
        let size = [picture.width as u32, picture.height as u32];
        let writer = match &mut writer {
            Some(writer) => writer,
            none => none.insert(VideoWriter::new(kind, size, frames, options.rate_hz)?),
        };
        writer.frame(&picture.rgba)?;
    }
    let writer = writer.context("a clip has at least one frame")?;
    Ok(writer.finish()?)
}

/// The picture with even sides, which MP4 needs: a row or column is added where a side is odd.
fn even(picture: RgbaPicture) -> RgbaPicture {
    let (width, height) = (
        picture.width.next_multiple_of(2),
        picture.height.next_multiple_of(2),
    );
    if (width, height) == (picture.width, picture.height) {
        return picture;
    }
    let mut out = RgbaPicture::filled(width, height, picture::SHEET_COLOR);
    out.put(&picture, 0, 0);
    out
}

/// Draws one frame after the other.
enum ClipRenderer {
    View3d {
        view: Box<View3d>,
        camera: ViewCamera,
        follow: bool,
        last: scene::Pose,
        size: [u32; 2],
        boxes: bool,
        look: Look,
    },
    Bev,
    Map([u32; 2]),
    Cameras(ClipOptions, Option<Box<dyn CameraPainter>>, AppearanceCache),
}

/// Approximate height of the bird's-eye picture, px; it decides the pixels per cell.
const BEV_PIXELS: usize = 720;

impl ClipRenderer {
    fn new(scene: &Scene, options: &ClipOptions) -> anyhow::Result<Self> {
        Ok(match &options.view {
            ClipView::View3d {
                camera,
                follow,
                boxes,
                look,
            } => {
                bounds::check(options.size, SHOT_BYTES_PER_PIXEL, 0)?;
                Self::View3d {
                    view: Box::new(View3d::new(*look)?),
                    camera: **camera,
                    follow: *follow,
                    last: scene.at(options.span_s[0]).frame().world_from_ego,
                    size: options.size,
                    boxes: *boxes,
                    look: *look,
                }
            }
            ClipView::Bev => Self::Bev,
            ClipView::Map => Self::Map(options.size),
            ClipView::Cameras { view, source, camera } => {
                let found = scene.rig.cameras.len();
                if camera.map_or(0, |i| i + 1).max(1) > found {
                    bail!("the rig {:?} has {found} cameras", scene.rig.name);
                }
                bounds::check(
                    options.size,
                    cameras::source_of(*view, *source).about().bytes_per_pixel,
                    0,
                )?;
                // Painted pictures continue from those of the frame before.
                let with = || match &options.paint {
                    Some(with) => Ok(with.clone()),
                    None => PaintWish::default().open(),
                };
                let with: Option<PaintWith> = options.paints().then(with).transpose()?;
                Self::Cameras(
                    options.clone(),
                    with.map(|with| with.painter(false)),
                    AppearanceCache::default(),
                )
            }
        })
    }

    fn draw(&mut self, scene: &Scene) -> anyhow::Result<RgbaPicture> {
        match self {
            Self::View3d {
                view,
                camera,
                follow,
                last,
                size,
                boxes,
                look,
            } => {
                let now = scene.frame().world_from_ego;
                if *follow {
                    camera.go_along(last, &now);
                }
                *last = now;
                view.shot(
                    scene,
                    &ShotOptions {
                        camera: *camera,
                        size: *size,
                        supersample: 1,
                        transparent: false,
                        lidar: false,
                        boxes: *boxes,
                        look: *look,
                    },
                )
            }
            Self::Bev => {
                let extent = scene.frame().extent();
                let scale = (BEV_PIXELS / extent.nx().max(extent.ny())).clamp(1, 8);
                Ok(picture::layout_top(scene.frame(), scale))
            }
            Self::Map(size) => capture(
                scene,
                &CaptureOptions {
                    subject: Subject::Map,
                    shot: ShotOptions {
                        size: *size,
                        ..ShotOptions::default()
                    },
                    legend: false,
                    ..CaptureOptions::default()
                },
            ),
            Self::Cameras(options, painter, cache) => pictures(scene, options, painter.as_deref_mut(), cache),
        }
    }
}

fn pictures(
    scene: &Scene,
    options: &ClipOptions,
    painter: Option<&mut (dyn CameraPainter + 'static)>,
    cache: &AppearanceCache,
) -> anyhow::Result<RgbaPicture> {
    let ClipView::Cameras { view, source, camera } = &options.view else {
        bail!("no view of cameras");
    };
    let scene = scene.for_sensors();
    if let Some(painter) = painter {
        let painted = painter.paint(&paint_input(&scene), &mut |_| ControlFlow::Continue(()))?;
        let shown = painted
            .iter()
            .enumerate()
            .filter(|(i, _)| camera.is_none_or(|c| c == *i));
        let row = shown.map(|(_, image)| {
            let image = learned::sized(image, options.size);
            RgbaPicture {
                width: image.width,
                height: image.height,
                rgba: image.rgba,
            }
        });
        return sheet(row.collect());
    }
    let source = cameras::source_of(*view, *source);
    let input = CameraInput {
        cache: Some(cache),
        ..camera_input(&scene, Detail::Full)
    };
    let ready = PreparedSource::new(source, &input);
    let render = RenderOptions {
        size: options.size,
        quality: Quality::Full,
    };
    let shown: Vec<&scene::Camera> = match camera {
        Some(index) => scene.rig.cameras.iter().skip(*index).take(1).collect(),
        None => scene.rig.cameras.iter().collect(),
    };
    let mut row = Vec::new();
    for camera in shown {
        let picture: CameraPicture = ready.render(camera, &render, RenderContext::processor())?;
        let ([width, height], rgba) = picture.rgba(*view, 0.0);
        row.push(RgbaPicture { width, height, rgba });
    }
    sheet(row)
}

/// One picture, or all of them in two rows.
fn sheet(mut row: Vec<RgbaPicture>) -> anyhow::Result<RgbaPicture> {
    match row.len() {
        1 => row.pop().context("a picture"),
        n => {
            let rows: Vec<Vec<RgbaPicture>> =
                row.chunks(n.div_ceil(2)).map(<[RgbaPicture]>::to_vec).collect();
            Ok(RgbaPicture::sheet(&rows, 4))
        }
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec2;
    use scene::{Key, Motion};

    use super::*;
    use crate::open;

    #[test]
    fn a_clip_of_the_map_and_of_a_camera_has_as_many_frames_as_it_lasts() {
        let mut scene = open::from_template("straight", 3).expect("a template");
        let key = |time_s: f64, x: f64| Key {
            time_s,
            at_m: DVec2::new(x, 0.0),
            yaw_deg: 0.0,
        };
        scene.change_clip(|clip| {
            clip.length_s = 0.5;
            clip.ego = Some(Motion::Keys(vec![key(0.0, 0.0), key(0.5, 4.0)]));
        });
        let options = |view| ClipOptions {
            view,
            size: [96, 54],
            span_s: [0.0, 0.5],
            rate_hz: 10.0,
            paint: None,
        };
        let camera = ClipView::Cameras {
            view: ViewId::SEMANTIC,
            source: cameras::shapes::ID,
            camera: Some(1),
        };
        let learned = ClipView::Cameras {
            view: learned::VIEW.id,
            source: learned::ID,
            camera: None,
        };
        for view in [ClipView::Bev, ClipView::Map, camera, learned] {
            let seen = std::cell::RefCell::new(Vec::new());
            let go_on = |done, all| {
                seen.borrow_mut().push((done, all));
                true
            };
            let is_map = view == ClipView::Map;
            let bytes = clip(&scene, &options(view), VideoKind::Gif, &go_on).expect("small");
            assert!(bytes.starts_with(b"GIF89a"));
            if is_map {
                let size = [6, 8].map(|at| u16::from_le_bytes([bytes[at], bytes[at + 1]]));
                assert_eq!(size, [96, 54], "the size that was asked for");
            }
            assert_eq!(seen.into_inner().last(), Some(&(5, 6)));
        }
        let error =
            clip(&scene, &options(ClipView::Bev), VideoKind::Gif, &|_, _| false).expect_err("stopped");
        assert_eq!(error.to_string(), "cancelled");
        let beyond = ClipOptions {
            span_s: [0.0, 3.0],
            ..options(ClipView::Bev)
        };
        let error = clip(&scene, &beyond, VideoKind::Gif, &|_, _| true)
            .expect_err("too long")
            .to_string();
        assert!(error.contains("expected moments of 0 to 0.5 s"), "{error}");
    }
}
