//! Pictures of a scene for people, of any size: the 3D view, the map, voxels, all cameras on one sheet, LiDAR; with names, legend
//! and scale. And the 3D view turned once around what it looks at.

mod legend;

use anyhow::{Context, bail};

use formats::recipe::Recipe;
use formats::video::{VideoKind, VideoWriter};
use scene::{Camera, Scene};
use sensors::appearance::Quality;
use sensors::cameras::{self, Detail, Ready, RenderOptions, SourceId, ViewId, bounds};
use sensors::rolling;

use crate::camera_views::{camera_input, camera_label};
use crate::picture::{self, Picture, SHEET_COLOR, SHOT_BYTES_PER_PIXEL, ShotOptions, View3d};

/// What is shown.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Subject {
    /// The 3D view.
    #[default]
    View,
    /// The layout from above, with boxes.
    Map,
    /// The voxels from above.
    Occupancy,
    /// All cameras of the rig on one sheet.
    Cameras,
    /// The returns of the LiDARs from above.
    Lidar,
}

impl Subject {
    /// All of them, with the names that the command line takes and what they are called for a person.
    pub const ALL: [(Self, &'static str, &'static str); 5] = [
        (Self::View, "view", "3D view"),
        (Self::Map, "map", "Map"),
        (Self::Occupancy, "occupancy", "Occupancy"),
        (Self::Cameras, "cameras", "Cameras"),
        (Self::Lidar, "lidar", "LiDAR"),
    ];
}

/// How a picture is taken.
#[derive(Clone, Debug)]
pub struct CaptureOptions {
    /// What is shown.
    pub subject: Subject,
    /// The 3D view; its size is also the frame that a map is to fill, pixels.
    pub shot: ShotOptions,
    /// Size of each camera on the sheet, pixels.
    pub camera_size: [u32; 2],
    /// What cameras show.
    pub view: ViewId,
    /// What classes and depths are rendered from.
    pub source: SourceId,
    /// With names, a legend and a scale.
    pub legend: bool,
}

impl Default for CaptureOptions {
    fn default() -> Self {
        Self {
            subject: Subject::default(),
            shot: ShotOptions::default(),
            camera_size: [800, 450],
            view: ViewId::SEMANTIC,
            source: cameras::shapes::ID,
            legend: true,
        }
    }
}

/// Columns of a sheet of cameras.
const COLUMNS: usize = 3;
/// Between the pictures of a sheet, pixels.
const MARGIN: usize = 6;

/// Takes a picture. Errors in one line: of a size that does not fit into memory, or where the 3D view finds no adapter.
pub fn capture(scene: &Scene, options: &CaptureOptions) -> anyhow::Result<Picture> {
    let picture = match options.subject {
        Subject::View => View3d::new()?.shot(scene, &options.shot)?,
        Subject::Cameras => sheet(scene, options)?,
        subject => from_above(scene, subject, options)?,
    };
    match options.legend && !(options.subject == Subject::View && options.shot.transparent) {
        true => legend::under(picture, scene, options),
        false => Ok(picture),
    }
}

/// The bytes of a PNG that also tells how the picture came to be, and holds the scene.
pub fn to_png(scene: &Scene, picture: &Picture) -> anyhow::Result<Vec<u8>> {
    let encode = |notes: &formats::png::Notes<'_>| {
        formats::png::rgba(picture.width, picture.height, &picture.rgba, notes)
    };
    Recipe::of(scene)
        .in_png(true, encode)
        .context("encode the picture")
}

/// A map that fills the frame: its cells are drawn at a whole number of pixels, then made smaller.
fn from_above(scene: &Scene, subject: Subject, options: &CaptureOptions) -> anyhow::Result<Picture> {
    const BYTES_PER_PIXEL: u64 = 16;
    bounds::check(options.shot.size, BYTES_PER_PIXEL, 0)?;
    let scene = &*scene.with_rig_in_world();
    let frame = scene.frame();
    let extent = frame.extent();
    // From above, ahead is up.
    let [width, height] = options.shot.size.map(f64::from);
    let wanted = (width / extent.ny() as f64).min(height / extent.nx() as f64);
    let scale = wanted.ceil().max(1.0) as usize;
    let drawn = match subject {
        Subject::Occupancy => picture::occupancy_top(&frame.occupancy, scale),
        Subject::Lidar => picture::lidar_top(extent, &rolling::exact(scene), scale),
        _ => picture::layout_top(frame, scale),
    };
    let size = [extent.ny(), extent.nx()].map(|n| ((n as f64 * wanted) as u32).max(1));
    if size == [drawn.width as u32, drawn.height as u32] {
        return Ok(drawn);
    }
    let whole = image::RgbaImage::from_raw(drawn.width as u32, drawn.height as u32, drawn.rgba);
    let whole = whole.context("a picture has four bytes per pixel")?;
    let small = image::imageops::resize(&whole, size[0], size[1], image::imageops::FilterType::Triangle);
    Ok(Picture {
        width: size[0] as usize,
        height: size[1] as usize,
        rgba: small.into_raw(),
    })
}

/// All cameras of the rig, three in a row.
fn sheet(scene: &Scene, options: &CaptureOptions) -> anyhow::Result<Picture> {
    let source = cameras::source_of(options.view, options.source);
    let scene = &*scene.with_rig_in_world();
    let all = &scene.rig.cameras;
    if all.is_empty() {
        bail!("the rig {:?} has no cameras", scene.rig.name);
    }
    let [w, h] = options.camera_size;
    let rows = all.len().div_ceil(COLUMNS) as u32;
    bounds::check(options.camera_size, source.bytes_per_pixel(), 0)?;
    bounds::check([w.saturating_mul(COLUMNS as u32), h.saturating_mul(rows)], 16, 0)?;
    let ready = Ready::new(source, &camera_input(scene, Detail::Full));
    let render = RenderOptions {
        size: options.camera_size,
        quality: Quality::Full,
    };
    let mut pictures = Vec::with_capacity(all.len());
    for group in all.chunks(ready.side_by_side(&render)) {
        for (camera, picture) in group.iter().zip(ready.render_all(group, &render, None)?) {
            let ([width, height], rgba) = picture.rgba(options.view, 0.0);
            let mut picture = Picture { width, height, rgba };
            if options.legend {
                legend::name(&mut picture, &title(camera));
            }
            pictures.push(picture);
        }
    }
    let rows: Vec<Vec<Picture>> = pictures.chunks(COLUMNS).map(<[Picture]>::to_vec).collect();
    Ok(Picture::sheet(&rows, MARGIN))
}

fn title(camera: &Camera) -> String {
    camera_label(&camera.name)
}

/// A turn around what the 3D view looks at.
#[derive(Clone, Debug)]
pub struct Turntable {
    /// The 3D view; its camera is where the turn begins.
    pub shot: ShotOptions,
    /// How long one turn takes, s.
    pub seconds: f64,
    /// Frames per second.
    pub rate_hz: f64,
}

impl Turntable {
    /// Longest turn, s.
    pub const MAX_S: f64 = 60.0;

    /// How many frames a turn has.
    pub fn frames(&self) -> u32 {
        (self.seconds * self.rate_hz)
            .round()
            .clamp(1.0, f64::from(VideoWriter::MAX_FRAMES)) as u32
    }
}

/// The file of a turn. `go_on` is told how many of how many frames are done, and says whether to go on. Errors in one line, also
/// where it was told not to.
pub fn turntable(
    scene: &Scene,
    turn: &Turntable,
    kind: VideoKind,
    go_on: &dyn Fn(usize, usize) -> bool,
) -> anyhow::Result<Vec<u8>> {
    let is_within = |v: f64, most: f64| v > 0.0 && v <= most;
    if !is_within(turn.seconds, Turntable::MAX_S) || !is_within(turn.rate_hz, 60.0) {
        bail!(
            "a turn of {} s at {} frames per second, expected up to {} s and up to 60 frames",
            turn.seconds,
            turn.rate_hz,
            Turntable::MAX_S
        );
    }
    let frames = turn.frames();
    let mut view = View3d::new()?;
    // MP4 wants even sides.
    let size = turn.shot.size.map(|s| s.next_multiple_of(2));
    bounds::check(size, SHOT_BYTES_PER_PIXEL, 0)?;
    let mut writer = VideoWriter::new(kind, size, frames, turn.rate_hz)?;
    for i in 0..frames {
        if !go_on(i as usize, frames as usize) {
            bail!("cancelled");
        }
        let mut shot = turn.shot.clone();
        (shot.size, shot.transparent) = (size, false);
        shot.camera.yaw_rad += std::f64::consts::TAU * f64::from(i) / f64::from(frames);
        writer.frame(&view.shot(scene, &shot)?.rgba)?;
    }
    Ok(writer.finish()?)
}

/// Behind names and legends.
const BEHIND: [u8; 3] = SHEET_COLOR;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::open;

    fn options(subject: Subject) -> CaptureOptions {
        CaptureOptions {
            subject,
            shot: ShotOptions {
                size: [300, 300],
                ..ShotOptions::default()
            },
            camera_size: [96, 54],
            ..CaptureOptions::default()
        }
    }

    #[test]
    fn maps_fill_the_frame_and_a_legend_lies_below() {
        let scene = open::from_template("straight", 3).expect("a template");
        for subject in [Subject::Map, Subject::Occupancy, Subject::Lidar] {
            let mut bare = options(subject);
            bare.legend = false;
            let picture = capture(&scene, &bare).expect("small");
            assert_eq!([picture.width, picture.height], [300, 300]);
            let with = capture(&scene, &options(subject)).expect("small");
            assert_eq!(with.width, 300);
            assert!(with.height > 300, "{subject:?}: {}", with.height);
            assert_eq!(with.rgba[..300 * 300 * 4], picture.rgba[..], "{subject:?}");
            // Letters are there, and all is opaque.
            let below = &with.rgba[300 * 300 * 4..];
            assert!(below.chunks_exact(4).any(|p| p[0] > 150) && below.chunks_exact(4).all(|p| p[3] == 255));
        }
    }

    #[test]
    fn cameras_come_on_one_sheet_with_their_names() {
        let scene = open::from_template("straight", 3).expect("a template");
        let mut plain = options(Subject::Cameras);
        plain.legend = false;
        let bare = capture(&scene, &plain).expect("small");
        assert_eq!(
            [bare.width, bare.height],
            [3 * 96 + 4 * MARGIN, 2 * 54 + 3 * MARGIN]
        );
        let named = capture(&scene, &options(Subject::Cameras)).expect("small");
        let row = |p: &Picture, y: usize| p.rgba[y * p.width * 4..][..p.width * 4].to_vec();
        assert_ne!(row(&bare, MARGIN + 8), row(&named, MARGIN + 8));
        let png = to_png(&scene, &named).expect("encoded");
        let inside = formats::png::notes_inside(&png).expect("sound");
        assert!(inside.scene.is_some() && !inside.text.is_empty());
    }

    #[test]
    fn what_is_too_large_or_takes_too_long_is_one_line() {
        let scene = open::from_template("straight", 3).expect("a template");
        let mut huge = options(Subject::Map);
        huge.shot.size = [u32::MAX, u32::MAX];
        assert!(
            !capture(&scene, &huge)
                .expect_err("refused")
                .to_string()
                .contains('\n')
        );
        let mut sheet = options(Subject::Cameras);
        sheet.camera_size = [u32::MAX, 3];
        assert!(capture(&scene, &sheet).is_err());
        for (seconds, rate_hz) in [(f64::NAN, 10.0), (0.0, 10.0), (1e9, 10.0), (3.0, f64::INFINITY)] {
            let turn = Turntable {
                shot: ShotOptions::default(),
                seconds,
                rate_hz,
            };
            let error = turntable(&scene, &turn, VideoKind::Gif, &|_, _| true).expect_err("refused");
            assert!(error.to_string().contains("expected up to 60 s"), "{error}");
        }
    }
}
