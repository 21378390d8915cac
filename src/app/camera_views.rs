//! Settings of the sensors in the window: camera source, view and hidden cameras; LiDAR model and colours.

use std::collections::BTreeMap;
use std::sync::Arc;

use egui::{Color32, ColorImage};

use language::t;
use scene::{RadarReturn, Scene};
use sensors::cameras::{self, CameraInput, CameraSource, Detail, SourceId, SourceView, ViewId};
use sensors::lidar::recorded;
use sensors::pictures::march::MarchScene;
use sensors::pictures::painter::PaintInput;
use viewport::LidarColorMode;
use widgets::theme;

pub use sensors::cameras::CameraPicture;

/// Size of the enlarged picture.
pub const LARGE_SIZE: [u32; 2] = [800, 450];

/// Settings of the camera pictures.
#[derive(Clone, Debug)]
pub struct CamerasShown {
    /// View that the camera strip shows.
    pub view: ViewId,
    /// Source that the view is rendered from, if several sources give it.
    pub source: SourceId,
    /// Depth of the plane that is shown, m.
    pub plane_m: f64,
    /// Bit per camera that is not rendered.
    pub hidden: u32,
    /// The enlarged camera.
    pub enlarged: Option<usize>,
    /// Settings of panes of single cameras, by the index of the pane.
    pub own: BTreeMap<u8, OwnCamera>,
    /// True if learned pictures are offered among the views.
    pub offers_learned: bool,
}

/// The views that menus offer, with or without learned pictures, and always the `chosen` one.
pub fn offered_views(learned: bool, chosen: ViewId) -> Vec<SourceView> {
    let mut views = cameras::views();
    views.retain(|view| learned || view.id == chosen || view.id != cameras::learned::VIEW.id);
    views
}

/// Settings of the pane of one camera, where they differ from the strip's.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct OwnCamera {
    /// Offset added to the pane's index to get the camera.
    pub on_by: u8,
    /// The view; the strip's view if `None`.
    pub view: Option<ViewId>,
    /// True if the legend of the colours is shown.
    pub legend: bool,
    /// Frames for which the pane still counts as drawn; 0: it is not on screen.
    pub drawn: u8,
    /// True if the pane is so large that its picture is rendered large.
    pub large: bool,
}

impl Default for CamerasShown {
    fn default() -> Self {
        Self {
            view: ViewId::SEMANTIC,
            source: SourceId::default(),
            plane_m: 12.0,
            hidden: 0,
            enlarged: None,
            own: BTreeMap::new(),
            offers_learned: false,
        }
    }
}

impl CamerasShown {
    /// True if a camera of the rig is not rendered.
    pub fn is_hidden(&self, camera: usize) -> bool {
        camera < 32 && self.hidden >> camera & 1 == 1
    }

    /// The source of the view that the camera strip shows.
    pub fn shown_source(&self) -> &'static dyn CameraSource {
        cameras::source_of(self.view, self.source)
    }

    /// The camera and the view that the pane of an index shows, in a rig of `cameras` cameras.
    pub fn of_pane(&self, pane: u8, cameras: usize) -> (usize, ViewId) {
        let own = self.own.get(&pane).copied().unwrap_or_default();
        let camera = (usize::from(pane) + usize::from(own.on_by)) % cameras.max(1);
        (camera, own.view.unwrap_or(self.view))
    }

    /// Notes the end of a frame: panes that are not drawn again are soon not rendered any more.
    pub fn frame_ended(&mut self) {
        self.own
            .values_mut()
            .for_each(|own| own.drawn = own.drawn.saturating_sub(1));
    }

    /// Bit per camera that a pane shows from the strip's source, whether the strip shows it or not.
    fn in_panes(&self, cameras: usize) -> u32 {
        let drawn = self.own.iter().filter(|(_, own)| own.drawn > 0);
        let shown = drawn.map(|(pane, _)| self.of_pane(*pane, cameras));
        let own =
            shown.filter(|(_, view)| cameras::source_of(*view, self.source).id() == self.shown_source().id());
        own.map(|(camera, _)| 1u32.checked_shl(camera as u32).unwrap_or(0))
            .fold(0, |a, b| a | b)
    }

    /// Sources other than the strip's that panes show, with their cameras.
    fn others(&self, cameras: usize) -> Others {
        let mut out = Others::default();
        for pane in self
            .own
            .iter()
            .filter(|(_, own)| own.drawn > 0)
            .map(|(pane, _)| *pane)
        {
            let (camera, view) = self.of_pane(pane, cameras);
            let source = cameras::source_of(view, self.source).id();
            if source != self.shown_source().id() {
                out.add(source, camera);
            }
        }
        out
    }

    /// Source and camera that are rendered large: the enlarged camera, else that of a large pane.
    fn large(&self, count: usize) -> Option<(SourceId, usize)> {
        let of_pane = || {
            let mut large = self.own.iter().filter(|(_, own)| own.drawn > 0 && own.large);
            large.next().map(|(pane, _)| self.of_pane(*pane, count))
        };
        let enlarged = self.enlarged.map(|camera| (camera, self.view));
        let (camera, view) = enlarged.or_else(of_pane)?;
        Some((cameras::source_of(view, self.source).id(), camera))
    }

    /// Removes a camera: the flags of those behind it move up.
    pub fn forget(&mut self, camera: usize) {
        let below = (1u32 << camera.min(31)) - 1;
        self.hidden = (self.hidden & below) | (self.hidden >> 1 & !below);
        self.enlarged = None;
    }
}

/// How the LiDAR sweep is computed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum LidarModel {
    /// The sweep that the scene was imported from, with its edits; exact for a scene of no recording.
    #[default]
    Recorded,
    /// Every ray ends at the first voxel.
    Exact,
    /// The network: ranges within voxels, intensity, lost echoes.
    Learned,
}

impl LidarModel {
    /// The model by which the sweep of a scene is computed.
    pub fn of_scene(self, scene: &Scene) -> Self {
        match self == Self::Recorded && recorded::recording_of(scene).is_none() {
            true => Self::Exact,
            false => self,
        }
    }
}

/// Settings of the LiDAR sweep.
#[derive(Clone, Debug)]
pub struct LidarShown {
    /// How the sweep is computed.
    pub model: LidarModel,
    /// Colour of the returns.
    pub colors: LidarColorMode,
}

impl Default for LidarShown {
    fn default() -> Self {
        Self {
            model: LidarModel::default(),
            colors: LidarColorMode::Range,
        }
    }
}

/// Colour of radar returns.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum RadarColors {
    /// By the speed over the ground along the ray.
    #[default]
    Speed,
    /// By the cross-section.
    Strength,
    /// By the class.
    Class,
}

/// Settings of the radar scans.
#[derive(Clone, Debug)]
pub struct RadarShown {
    /// Colour of the returns.
    pub colors: RadarColors,
    /// Distance from the middle of the picture to its nearest edge, m.
    pub reach_m: f64,
    /// Frames for which the pane still counts as drawn; 0: it is not on screen, and no scan is made.
    pub drawn: u8,
}

impl RadarShown {
    /// Frames for which a pane counts as drawn after it was.
    pub const DRAWN: u8 = 3;

    /// Notes the end of a frame.
    pub fn frame_ended(&mut self) {
        self.drawn = self.drawn.saturating_sub(1);
    }
}

impl Default for RadarShown {
    fn default() -> Self {
        Self {
            colors: RadarColors::default(),
            reach_m: 60.0,
            drawn: 0,
        }
    }
}

/// Speed over the ground from which a radar's target counts as moving, and of the strongest colour, m/s.
pub const MOVES_MPS: f32 = 0.3;
/// See [`MOVES_MPS`].
pub const FAST_MPS: f32 = 15.0;
/// Cross-sections of the first and the last colour, dB above 1 m².
pub const RCS_DBSM: [f32; 2] = [-10.0, 25.0];

/// Colour of a radar return. Speed: blue comes towards the vehicle, red goes away, grey stands. Strength: dark to bright.
pub fn radar_color(one: &RadarReturn, colors: RadarColors) -> Color32 {
    let rgb = |from: [f32; 3], to: [f32; 3], share: f32| {
        let [r, g, b] = [0, 1, 2].map(|i| (from[i] + (to[i] - from[i]) * share) as u8);
        Color32::from_rgb(r, g, b)
    };
    match colors {
        RadarColors::Class => {
            let [r, g, b] = one.class.color();
            Color32::from_rgb(r, g, b)
        }
        RadarColors::Strength => {
            let [low, high] = RCS_DBSM;
            let share = ((one.rcs_dbsm - low) / (high - low)).clamp(0.0, 1.0);
            rgb([70.0, 60.0, 130.0], [255.0, 225.0, 110.0], share)
        }
        RadarColors::Speed => {
            let grey = [158.0, 164.0, 172.0];
            let speed = one.speed_over_ground_mps;
            let share = (speed.abs() / FAST_MPS).sqrt().min(1.0);
            match speed {
                v if v.abs() < MOVES_MPS => rgb(grey, grey, 0.0),
                v if v < 0.0 => rgb(grey, [60.0, 140.0, 255.0], share),
                _ => rgb(grey, [255.0, 80.0, 60.0], share),
            }
        }
    }
}

/// Request to the sensors, besides the scene.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Wanted {
    /// Source of the camera pictures.
    pub source: SourceId,
    /// Bit per camera that is not rendered.
    pub hidden: u32,
    /// The camera that is also rendered large, and the source of its picture.
    pub large: Option<(SourceId, usize)>,
    /// How the LiDAR sweep is computed.
    pub lidar: LidarModel,
    /// True if the learned sweep keeps echoes that a real sensor would probably lose.
    pub lost_echoes: bool,
    /// True if the radars scan.
    pub radar: bool,
    /// Sources that panes of single cameras show besides the strip's.
    pub others: Others,
}

/// Most sources besides that of the strip.
const MOST_OTHERS: usize = 8;

/// Sources besides that of the strip, each with a bit per camera that is rendered.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Others([Option<(SourceId, u32)>; MOST_OTHERS]);

impl Others {
    fn add(&mut self, source: SourceId, camera: usize) {
        let bit = 1u32.checked_shl(camera as u32).unwrap_or(0);
        let free = |slot: &&mut Option<(SourceId, u32)>| slot.is_none_or(|(of, _)| of == source);
        if let Some(slot) = self.0.iter_mut().find(free) {
            *slot = Some((source, slot.map_or(0, |(_, mask)| mask) | bit));
        }
    }

    /// Each source and its cameras.
    pub fn iter(&self) -> impl Iterator<Item = (SourceId, u32)> {
        self.0.iter().copied().flatten()
    }
}

/// Key of the strip's pictures: the source, and a bit per camera that is not rendered. One rendering holds all views of
/// a source.
pub type PicturesKey = (SourceId, u32);

impl Wanted {
    /// The request for the settings of the window, in a rig of `count` cameras.
    pub fn from_settings(
        cameras: &CamerasShown,
        lidar: &LidarShown,
        radar: &RadarShown,
        count: usize,
    ) -> Self {
        Self {
            source: cameras.shown_source().id(),
            hidden: cameras.hidden & !cameras.in_panes(count),
            large: cameras.large(count),
            lidar: lidar.model,
            lost_echoes: lidar.colors == LidarColorMode::Drop,
            radar: radar.drawn > 0,
            others: cameras.others(count),
        }
    }

    /// The camera whose picture of that source is rendered large.
    pub fn large_of(&self, source: SourceId) -> Option<usize> {
        self.large
            .filter(|(of, _)| *of == source)
            .map(|(_, camera)| camera)
    }

    /// The key of the strip's pictures.
    pub fn pictures(self) -> PicturesKey {
        (self.source, self.hidden)
    }

    /// The source in the table.
    pub fn camera_source(self) -> &'static dyn CameraSource {
        cameras::source(self.source).unwrap_or(&cameras::shapes::ShapeMaps)
    }
}

/// The current frame of a scene as camera sources take it.
pub fn camera_input(scene: &Scene, detail: Detail) -> CameraInput<'_> {
    CameraInput {
        frame: scene.frame(),
        rig: &scene.rig,
        background: &scene.background,
        conditions: scene.conditions,
        detail,
        paint: None,
        cache: None,
    }
}

/// The current frame as the picture networks take it.
pub fn paint_input(scene: &Scene) -> PaintInput<'_> {
    PaintInput {
        frame: scene.frame(),
        rig: &scene.rig,
        background: &scene.background,
        conditions: scene.conditions,
    }
}

/// The current frame for exact rays; see [`cameras::march_scene`].
pub fn march(scene: &Scene, shapes: bool) -> MarchScene {
    cameras::march_scene(scene.frame(), &scene.background, shapes, scene.seed)
}

/// The picture of one camera.
#[derive(Clone, Debug)]
pub struct CameraView {
    /// Index of the camera in the rig.
    pub camera: usize,
    /// The picture.
    pub picture: Arc<CameraPicture>,
    /// The picture in the colours of a view, made beforehand so that the window need not.
    shown: Option<(ViewId, Arc<ColorImage>)>,
}

impl CameraView {
    /// The picture of one camera of the rig.
    pub fn new(camera: usize, picture: CameraPicture) -> Self {
        Self {
            camera,
            picture: Arc::new(picture),
            shown: None,
        }
    }

    /// Makes the colours of the source's first view now, unless a setting of the window decides them.
    pub fn colored(mut self, source: &dyn CameraSource) -> Self {
        if let Some(view) = source.views().first().filter(|v| v.knob.is_none()) {
            self.shown = Some((view.id, Arc::new(colors(&self.picture, view.id, 0.0))));
        }
        self
    }

    /// True if the picture is at least so many pixels wide.
    pub fn is_wide(&self, width: u32) -> bool {
        match &*self.picture {
            CameraPicture::Maps(maps) => maps.width >= width as usize,
            CameraPicture::Planes(image) => image.width >= width as usize,
            CameraPicture::Layout(map) => map.width >= width as usize,
            CameraPicture::Picture(image) => image.width >= width as usize,
        }
    }

    /// Memory that it takes, bytes; `None` for pictures that take too much to be kept.
    pub fn bytes(&self) -> Option<usize> {
        const SHOWN: usize = size_of::<Color32>();
        match &*self.picture {
            // A class, and four planes of distances and shares.
            CameraPicture::Maps(maps) => Some(maps.width * maps.height * (1 + 4 * 4 + SHOWN)),
            CameraPicture::Picture(image) => Some(image.rgba.len() + image.width * image.height * SHOWN),
            CameraPicture::Planes(_) | CameraPicture::Layout(_) => None,
        }
    }

    /// The picture in the colours of a view; `plane_m` is the depth of the plane that is shown.
    pub fn colors(&self, view: ViewId, plane_m: f64) -> Arc<ColorImage> {
        match &self.shown {
            Some((of, image)) if *of == view => image.clone(),
            _ => Arc::new(colors(&self.picture, view, plane_m)),
        }
    }
}

/// A picture as egui takes it.
fn colors(picture: &CameraPicture, view: ViewId, plane_m: f64) -> ColorImage {
    let (size, rgba) = picture.rgba(view, plane_m);
    ColorImage::from_rgba_unmultiplied(size, &rgba)
}

/// The name of a camera for the user: `CAM_FRONT_LEFT` in words.
pub fn camera_label(name: &str) -> String {
    theme::sentence(t(&name
        .trim_start_matches("CAM_")
        .replace('_', " ")
        .to_lowercase()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn panes_ask_for_other_sources_than_the_strip() {
        use sensors::cameras::pictures;
        let mut shown = CamerasShown::default();
        let own = |view, on_by, drawn| OwnCamera {
            view,
            on_by,
            drawn: u8::from(drawn),
            ..OwnCamera::default()
        };
        shown.own.insert(0, own(Some(pictures::VIEW.id), 0, true));
        shown.own.insert(4, own(Some(pictures::VIEW.id), 3, true));
        shown.own.insert(2, own(Some(ViewId::DEPTH), 0, true));
        shown.own.insert(3, own(Some(pictures::VIEW.id), 0, false));
        assert_eq!(shown.of_pane(4, 6), (1, pictures::VIEW.id));
        let wanted = Wanted::from_settings(&shown, &LidarShown::default(), &RadarShown::default(), 6);
        // Depth comes with the classes of the strip; a pane that is not drawn requests no picture.
        let others: Vec<_> = wanted.others.iter().collect();
        assert_eq!(
            others,
            [(cameras::source_of(pictures::VIEW.id, shown.source).id(), 0b11)]
        );
    }

    #[test]
    fn a_large_pane_asks_for_a_large_picture_while_it_is_drawn() {
        use sensors::cameras::pictures;
        let mut shown = CamerasShown::default();
        let large = OwnCamera {
            view: Some(pictures::VIEW.id),
            on_by: 2,
            drawn: 1,
            large: true,
            ..OwnCamera::default()
        };
        shown.own.insert(1, large);
        let wanted = |shown: &CamerasShown| {
            Wanted::from_settings(shown, &LidarShown::default(), &RadarShown::default(), 6)
        };
        let source = cameras::source_of(pictures::VIEW.id, shown.source).id();
        assert_eq!(wanted(&shown).large, Some((source, 3)));
        assert_eq!(wanted(&shown).large_of(source), Some(3));
        assert_eq!(wanted(&shown).large_of(shown.shown_source().id()), None);
        // The enlarged camera comes first; it shows what the strip shows.
        shown.enlarged = Some(0);
        assert_eq!(wanted(&shown).large, Some((shown.shown_source().id(), 0)));
        shown.enlarged = None;
        shown.frame_ended();
        assert_eq!(wanted(&shown).large, None);
    }

    #[test]
    fn hidden_cameras_stay_hidden_when_another_goes() {
        let mut shown = CamerasShown {
            hidden: 0b10_1001,
            ..CamerasShown::default()
        };
        assert!(shown.is_hidden(3) && !shown.is_hidden(4) && !shown.is_hidden(40));
        shown.forget(2);
        assert_eq!(shown.hidden, 0b1_0101);
        shown.forget(0);
        assert_eq!(shown.hidden, 0b1010);
    }
}
