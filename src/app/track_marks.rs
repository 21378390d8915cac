//! Marks of moving objects in both large views: their paths, the keyframes of the selection, and its places a second
//! earlier and later.

use egui::{Color32, Painter, Pos2, Shape, Stroke};
use glam::{DVec2, DVec3};

use scene::{BoxId, Motion, Scene, SceneBox};

use crate::screen_map::ScreenMap;
use crate::state::UiState;
use widgets::theme;

/// Time between two points of a drawn path, s.
const STEP_S: f64 = 0.1;
/// Number of tracks above which only the paths of the selection and of the ego vehicle are drawn.
const MANY: usize = 60;

/// Marks of one track.
struct TrackMark {
    points_m: Vec<DVec2>,
    keys_m: Vec<DVec2>,
    ghosts: Vec<SceneBox>,
    color: Color32,
    chosen: bool,
}

fn marks(scene: &Scene, state: &UiState) -> Vec<TrackMark> {
    let (clip, playback) = (scene.clip(), &state.playback);
    if clip.is_still() || !playback.paths {
        return Vec::new();
    }
    let many = clip.tracks.len() > MANY;
    let ids = clip.tracks.keys().copied().map(Some).chain([None]);
    let shown = ids.filter(|id| !many || id.is_none_or(|id| state.is_chosen(id)));
    shown.filter_map(|id| mark(scene, state, id)).collect()
}

fn mark(scene: &Scene, state: &UiState, id: Option<BoxId>) -> Option<TrackMark> {
    let clip = scene.clip();
    let motion = clip.motion(id)?;
    let at = |time_s: f64| match id {
        Some(id) => clip.moving(id, time_s),
        None => clip.ego_moving(time_s),
    };
    let steps = (clip.length_s / STEP_S).ceil() as usize;
    let times = (0..=steps).map(|i| (i as f64 * STEP_S).min(clip.length_s));
    let points_m: Vec<DVec2> = times.filter_map(|t| at(t).map(|m| m.at_m)).collect();
    let chosen = id.is_some_and(|id| state.is_chosen(id));
    let keys_m = match motion {
        Motion::Keys(keys) if chosen => keys.iter().map(|k| k.at_m).collect(),
        _ => Vec::new(),
    };
    let relief = &scene.frame().layout.relief;
    let ghosts = match (id, chosen && state.playback.onion) {
        (Some(id), true) => [-1.0, 1.0]
            .iter()
            .filter_map(|d| clip.box_at(id, scene.time_s() + d, relief))
            .collect(),
        _ => Vec::new(),
    };
    let color = match id {
        Some(id) => theme::class_color(clip.tracks.get(&id)?.made.class),
        None => theme::accent(),
    };
    Some(TrackMark {
        points_m,
        keys_m,
        ghosts,
        color,
        chosen,
    })
}

/// Draws the marks over the bird's-eye view.
pub(crate) fn from_above(painter: &Painter, map: &ScreenMap, scene: &Scene, state: &UiState) {
    let on_screen = |p: DVec2| Some(map.to_screen(p));
    for mut mark in marks(scene, state) {
        // The select tool draws the keyframes as handles.
        mark.keys_m.clear();
        draw(painter, &mark, on_screen);
    }
}

/// Draws the marks over the 3D view.
pub(crate) fn in_3d(
    painter: &Painter,
    project: &dyn Fn(DVec3) -> Option<Pos2>,
    scene: &Scene,
    state: &UiState,
) {
    let relief = &scene.frame().layout.relief;
    let on_screen = |p: DVec2| project(p.extend(relief.height_m(p) + 0.1));
    for mark in marks(scene, state) {
        draw(painter, &mark, on_screen);
    }
}

fn draw(painter: &Painter, mark: &TrackMark, on_screen: impl Fn(DVec2) -> Option<Pos2>) {
    let (width, alpha) = if mark.chosen { (2.0, 0.95) } else { (1.2, 0.5) };
    let stroke = Stroke::new(width, mark.color.gamma_multiply(alpha));
    // Points behind the camera divide the line.
    let places: Vec<Option<Pos2>> = mark.points_m.iter().map(|p| on_screen(*p)).collect();
    for piece in places.split(Option::is_none) {
        let line: Vec<Pos2> = piece.iter().flatten().copied().collect();
        if line.len() >= 2 {
            painter.add(Shape::line(line, stroke));
        }
    }
    for at in mark.keys_m.iter().filter_map(|p| on_screen(*p)) {
        painter.circle(at, 3.5, theme::background(), Stroke::new(1.5, Color32::WHITE));
    }
    for ghost in &mark.ghosts {
        let corners: Option<Vec<Pos2>> = ghost.footprint().iter().map(|p| on_screen(*p)).collect();
        if let Some(corners) = corners {
            let stroke = Stroke::new(1.0, mark.color.gamma_multiply(0.6));
            painter.add(Shape::closed_line(corners, stroke));
        }
    }
}
