//! Pictures of a scene for people, of any size: the 3D view, the map, voxels, all cameras on one sheet, LiDAR; with
//! names, legend and scale. Also a turntable: the 3D view turned once around its target.

mod above;
mod legend;

use anyhow::{Context, bail};

use formats::recipe::Recipe;
use formats::video::{VideoKind, VideoWriter};
use scene::{Camera, Scene};
use sensors::cameras::{self, Detail, PreparedSource, RenderOptions, SourceId, ViewId, bounds};
use sensors::pictures::appearance::Quality;

use crate::camera_views::{camera_input, camera_label};
use crate::picture::{RgbaPicture, SHEET_COLOR, SHOT_BYTES_PER_PIXEL, ShotOptions, View3d};

/// Subject of a picture.
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
    /// All subjects, with the name on the command line and the label for the user.
    pub const ALL: [(Self, &'static str, &'static str); 5] = [
        (Self::View, "view", "3D view"),
        (Self::Map, "map", "Map"),
        (Self::Occupancy, "occupancy", "Occupancy"),
        (Self::Cameras, "cameras", "Cameras"),
        (Self::Lidar, "lidar", "LiDAR"),
    ];
}

/// Options of a picture.
#[derive(Clone, Debug)]
pub struct CaptureOptions {
    /// The subject.
    pub subject: Subject,
    /// The 3D view. Its size is also the frame that a map fills, pixels.
    pub shot: ShotOptions,
    /// Size of each camera on the sheet, pixels.
    pub camera_size: [u32; 2],
    /// View of the cameras.
    pub view: ViewId,
    /// Source that classes and depths are rendered from.
    pub source: SourceId,
    /// True: with names, a legend and a scale.
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
/// Gap between the pictures of a sheet, pixels.
const MARGIN: usize = 6;

/// Takes a picture. Errors in one line if the size does not fit into memory, or if the 3D view finds no adapter.
pub fn capture(scene: &Scene, options: &CaptureOptions) -> anyhow::Result<RgbaPicture> {
    const BYTES_PER_PIXEL: u64 = 16;
    let legend = options.legend && !(options.subject == Subject::View && options.shot.transparent);
    if options.subject == Subject::Cameras {
        let sheet = sheet(scene, options)?;
        let below = legend.then(|| legend::below(sheet.width, None, scene, options));
        return Ok(stacked(sheet, below));
    }
    bounds::check(options.shot.size, BYTES_PER_PIXEL, 0)?;
    let [width, height] = options.shot.size;
    let below = legend.then(|| below(scene, options));
    // The legend lies within the requested size, if there is room for it.
    let left = height.saturating_sub(below.as_ref().map_or(0, |b| b.height as u32));
    let size = [width, if left < height / 2 { height } else { left }];
    let picture = match options.subject {
        Subject::View => {
            let mut shot = options.shot.clone();
            shot.size = size;
            View3d::new(shot.look)?.shot(scene, &shot)?
        }
        subject => above::picture(scene, subject, size)?,
    };
    Ok(stacked(picture, below))
}

/// The legend below a picture of the requested size. The scale bar depends on the height left for the picture, and that
/// height on the lines of the legend; the number of lines hardly ever changes by it.
fn below(scene: &Scene, options: &CaptureOptions) -> RgbaPicture {
    let [width, height] = options.shot.size;
    let drawn = |left: u32| {
        let per_m = (options.subject != Subject::View).then(|| above::per_m(scene, [width, left]) as f32);
        legend::below(width as usize, per_m, scene, options)
    };
    let lines = drawn(height).height as u32;
    let left = height.saturating_sub(lines);
    drawn(if left < height / 2 { height } else { left })
}

fn stacked(picture: RgbaPicture, below: Option<RgbaPicture>) -> RgbaPicture {
    let Some(below) = below else {
        return picture;
    };
    let mut out = RgbaPicture::filled(picture.width, picture.height + below.height, BEHIND);
    out.put(&picture, 0, 0);
    out.put(&below, 0, picture.height);
    out
}

/// The bytes of a PNG that also holds the recipe of the picture and the scene.
pub fn to_png(scene: &Scene, picture: &RgbaPicture) -> anyhow::Result<Vec<u8>> {
    to_png_made_with(scene, picture, serde_json::Value::Null)
}

/// The bytes of a PNG, as from [`to_png`], with the parameters that the scene was made with.
pub fn to_png_made_with(
    scene: &Scene,
    picture: &RgbaPicture,
    parameters: serde_json::Value,
) -> anyhow::Result<Vec<u8>> {
    let encode = |notes: &formats::png::Notes<'_>| {
        formats::png::rgba(picture.width, picture.height, &picture.rgba, notes)
    };
    let recipe = Recipe {
        parameters,
        ..Recipe::of(scene)
    };
    recipe.in_png(true, encode).context("encode the picture")
}

/// All cameras of the rig, three in a row.
fn sheet(scene: &Scene, options: &CaptureOptions) -> anyhow::Result<RgbaPicture> {
    let source = cameras::source_of(options.view, options.source);
    let scene = &*scene.for_sensors();
    let all = &scene.rig.cameras;
    if all.is_empty() {
        bail!("the rig {:?} has no cameras", scene.rig.name);
    }
    let [w, h] = options.camera_size;
    let rows = all.len().div_ceil(COLUMNS) as u32;
    bounds::check(options.camera_size, source.about().bytes_per_pixel, 0)?;
    bounds::check([w.saturating_mul(COLUMNS as u32), h.saturating_mul(rows)], 16, 0)?;
    let ready = PreparedSource::new(source, &camera_input(scene, Detail::Full));
    let render = RenderOptions {
        size: options.camera_size,
        quality: Quality::Full,
    };
    let mut pictures = Vec::with_capacity(all.len());
    for group in all.chunks(ready.side_by_side(&render)) {
        for (camera, picture) in group.iter().zip(ready.render_all(group, &render, None)?) {
            let ([width, height], rgba) = picture.rgba(options.view, 0.0);
            let mut picture = RgbaPicture { width, height, rgba };
            if options.legend {
                legend::name(&mut picture, &title(camera));
            }
            pictures.push(picture);
        }
    }
    let rows: Vec<Vec<RgbaPicture>> = pictures.chunks(COLUMNS).map(<[RgbaPicture]>::to_vec).collect();
    Ok(RgbaPicture::sheet(&rows, MARGIN))
}

fn title(camera: &Camera) -> String {
    camera_label(&camera.name)
}

/// A turn of the 3D view around its target.
#[derive(Clone, Debug)]
pub struct Turntable {
    /// The 3D view; the turn begins at its camera.
    pub shot: ShotOptions,
    /// Duration of the turn, s.
    pub seconds: f64,
    /// Frames per second.
    pub rate_hz: f64,
}

impl Turntable {
    /// Longest turn, s.
    pub const MAX_S: f64 = 60.0;

    /// Number of frames of the turn.
    pub fn frames(&self) -> u32 {
        (self.seconds * self.rate_hz)
            .round()
            .clamp(1.0, f64::from(VideoWriter::MAX_FRAMES)) as u32
    }
}

/// The file of a turn. `go_on` is told the number of finished frames and of all frames, and returns whether to go on.
/// Errors in one line, also when `go_on` stops it.
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
    let mut view = View3d::new(turn.shot.look)?;
    // MP4 needs even sides.
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

/// Background colour of names and legends.
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
    fn maps_have_the_size_that_is_asked_for_and_the_legend_is_within_it() {
        let scene = open::from_template("straight", 3).expect("a template");
        for subject in [Subject::Map, Subject::Occupancy, Subject::Lidar] {
            let mut asked = options(subject);
            asked.shot.size = [500, 400];
            let with = capture(&scene, &asked).expect("small");
            assert_eq!([with.width, with.height], [500, 400], "{subject:?}");
            // There are letters, and every pixel is opaque.
            let last = &with.rgba[360 * 500 * 4..];
            assert!(last.chunks_exact(4).any(|p| p[0] > 150) && last.chunks_exact(4).all(|p| p[3] == 255));
            asked.legend = false;
            let bare = capture(&scene, &asked).expect("small");
            assert_eq!([bare.width, bare.height], [500, 400]);
            // The map is square and centred.
            let color = |x: usize| bare.rgba[(200 * 500 + x) * 4..][..3].to_vec();
            assert!(color(20) == BEHIND && color(480) == BEHIND && color(250) != BEHIND);
        }
        // A picture too low for its legend becomes higher by the legend.
        let mut low = options(Subject::Map);
        low.shot.size = [300, 30];
        assert!(capture(&scene, &low).expect("small").height > 30);
    }

    #[test]
    fn a_map_shows_the_ego_vehicle_and_what_stands_beside_the_road() {
        let scene = open::from_template("straight", 3).expect("a template");
        let mut asked = options(Subject::Map);
        (asked.shot.size, asked.legend) = ([800, 800], false);
        let map = capture(&scene, &asked).expect("small");
        let has = |wanted: [u8; 3]| map.rgba.chunks_exact(4).any(|p| p[..3] == wanted);
        assert_eq!(map.rgba[(400 * 800 + 400) * 4..][..3], [235, 238, 242]);
        let tree = scene::Class::Vegetation
            .color()
            .map(|c| (u16::from(c) * 150 / 255) as u8);
        assert!(has(tree), "no tree");
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
        let row = |p: &RgbaPicture, y: usize| p.rgba[y * p.width * 4..][..p.width * 4].to_vec();
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
