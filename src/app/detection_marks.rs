//! Marks over the large views for the predictions of the LiDAR network and the network of both sensors: predicted
//! boxes, missed boxes of the scene, and the predicted kind of each column.

use std::collections::BTreeSet;
use std::sync::Arc;

use egui::epaint::{Mesh, Vertex};
use egui::{Color32, Painter, Pos2, Shape, Stroke, TextureHandle, pos2};
use glam::{DVec2, DVec3};

use super::canvas::ScreenMap;
use super::state::UiState;
use language::t;
use nets::perceiver::stands::Stands;
use scene::{BoxId, Extent, Frame, Pose, Scene, SceneBox, SceneRev};
use sensors::perceive::pictures::{GHOST, MISSED};
use widgets::theme;

/// Colour of a predicted box that matches one of the scene.
const SEEN: Color32 = Color32::from_rgb(80, 230, 230);
/// Opacity of the predicted kinds of columns over the map, of 255.
const STANDS: u8 = 150;

/// The marks of one sweep.
#[derive(Clone)]
pub struct DetectionMarks {
    /// The state that the network was given.
    pub of: SceneRev,
    /// Predicted boxes on the map, each with true if it matches no box of the scene.
    pub detections: Vec<(SceneBox, bool)>,
    /// Boxes of the scene that are missed.
    pub missed: Vec<BoxId>,
    /// Picture of the predicted kind of each column in the window around the vehicle, from above, ahead is up; with the
    /// set of kinds in it.
    pub stands: Option<(TextureHandle, BTreeSet<Stands>)>,
    /// The scene with the predicted voxels in place of its own.
    pub told: Option<Arc<Scene>>,
    /// Transform from the vehicle's frame to the map.
    pub map_from_vehicle: Pose,
    /// Extent of those columns, in the frame of the vehicle.
    pub window: Extent,
}

fn color([r, g, b]: [u8; 3]) -> Color32 {
    Color32::from_rgb(r, g, b)
}

impl std::fmt::Debug for DetectionMarks {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(
            f,
            "{} detections, {} missed",
            self.detections.len(),
            self.missed.len()
        )
    }
}

impl DetectionMarks {
    /// The legend of the map: each colour and its meaning.
    pub(crate) fn map_legend(&self, now: SceneRev) -> Vec<(Color32, String)> {
        let standing = self.stands.iter().flat_map(|(_, standing)| standing);
        let named = standing.map(|s| (theme::class_color(s.class()), t(&s.label()).to_owned()));
        self.legend(now).into_iter().chain(named).collect()
    }

    /// The legend of the boxes: each colour and its meaning. `now` is the state on screen.
    pub(crate) fn legend(&self, now: SceneRev) -> Vec<(Color32, String)> {
        let mut entries = vec![
            (SEEN, t("seen by the network").to_owned()),
            (color(MISSED), t("missed: crossed").to_owned()),
            (color(GHOST), t("a thing where there is none: dashed").to_owned()),
        ];
        if self.of != now {
            let text = t("of the state before: the network is looking");
            entries.push((Color32::GRAY, text.to_owned()));
        }
        entries
    }

    /// The legend where the predicted voxels are shown in place of the scene's.
    pub(crate) fn told_legend(&self, now: SceneRev) -> Vec<(Color32, String)> {
        let text = match self.of == now {
            true => t("the network's voxels, to look at alone"),
            false => t("of the state before: the network is looking"),
        };
        let all = self.legend(self.of);
        let first = (Color32::WHITE, text.to_owned());
        std::iter::once(first).chain(all).collect()
    }

    /// Each marked box with its mark.
    fn boxes<'a>(&'a self, frame: &'a Frame) -> impl Iterator<Item = (&'a SceneBox, DetectionOutcome)> {
        let detections = self.detections.iter();
        let detections = detections.map(|(b, ghost)| {
            (
                b,
                if *ghost {
                    DetectionOutcome::Ghost
                } else {
                    DetectionOutcome::Seen
                },
            )
        });
        let missed = self.missed.iter().filter_map(|id| frame.boxes.get(id));
        detections
            .chain(missed.map(|b| (b, DetectionOutcome::Missed)))
            .filter(|(b, _)| b.problem().is_none())
    }

    /// Draws the marks on the bird's-eye view.
    pub(super) fn on_map(&self, painter: &Painter, map: &ScreenMap, frame: &Frame) {
        if let Some((texture, _)) = &self.stands {
            let (min, max) = (self.window.min_m().truncate(), self.window.max_m().truncate());
            let on_map = |p: DVec2| map.to_screen(self.map_from_vehicle.apply(p.extend(0.0)).truncate());
            // Ahead is up and left is left: the picture's upper left corner is the window's farthest left one.
            let corners = [
                (on_map(max), pos2(0.0, 0.0)),
                (on_map(DVec2::new(max.x, min.y)), pos2(1.0, 0.0)),
                (on_map(min), pos2(1.0, 1.0)),
                (on_map(DVec2::new(min.x, max.y)), pos2(0.0, 1.0)),
            ];
            painter.add(Shape::mesh(quad(texture, corners)));
        }
        for (b, mark) in self.boxes(frame) {
            // No mark of the front: the network does not know which end of a vehicle is its front.
            let corners = b.footprint().map(|p| map.to_screen(p));
            let [first, second, third, fourth] = corners;
            mark.stroke(painter, &[first, second, third, fourth, first]);
            if mark == DetectionOutcome::Missed {
                mark.stroke(painter, &[first, third]);
                mark.stroke(painter, &[second, fourth]);
            }
        }
    }

    fn in_3d(&self, painter: &Painter, project: &dyn Fn(DVec3) -> Option<Pos2>, frame: &Frame) {
        for (b, mark) in self.boxes(frame) {
            let half = b.size_m.z / 2.0;
            let ring = |z: f64| b.footprint().map(|p| project(p.extend(b.center_m.z + z)));
            let (low, high) = (ring(-half), ring(half));
            let sides = (0..4).flat_map(|i| {
                let next = (i + 1) % 4;
                [(low[i], low[next]), (high[i], high[next]), (low[i], high[i])]
            });
            let cross = [(high[0], high[2]), (high[1], high[3])];
            let cross = cross.into_iter().filter(|_| mark == DetectionOutcome::Missed);
            for edge in sides.chain(cross) {
                if let (Some(a), Some(b)) = edge {
                    mark.stroke(painter, &[a, b]);
                }
            }
        }
    }
}

/// Draws the marks that are shown on the 3D view; `project` gives the screen position of a point.
pub(super) fn in_3d(
    painter: &Painter,
    project: &dyn Fn(DVec3) -> Option<Pos2>,
    scene: &Scene,
    state: &UiState,
) {
    if let Some(marks) = &state.shown.detection_marks {
        marks.in_3d(painter, project, scene.frame());
    }
}

/// How a box was predicted. Marks differ in more than colour, because classes have colours too.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum DetectionOutcome {
    Seen,
    Missed,
    Ghost,
}

impl DetectionOutcome {
    fn color(self) -> Color32 {
        match self {
            Self::Seen => SEEN,
            Self::Missed => color(MISSED),
            Self::Ghost => color(GHOST),
        }
    }

    /// Draws a line that is visible on bright and on dark; dashed for a false detection.
    fn stroke(self, painter: &Painter, line: &[Pos2]) {
        for (width, color) in [(3.5, Color32::from_black_alpha(130)), (1.8, self.color())] {
            let stroke = Stroke::new(width, color);
            match self {
                Self::Ghost => painter.extend(Shape::dashed_line(line, stroke, 5.0, 4.0)),
                _ => drop(painter.line(line.to_vec(), stroke)),
            }
        }
    }
}

/// A textured quad: four corners, each with its texture coordinates.
fn quad(texture: &TextureHandle, corners: [(Pos2, Pos2); 4]) -> Mesh {
    let mut mesh = Mesh::with_texture(texture.id());
    let color = Color32::from_white_alpha(STANDS);
    mesh.vertices = corners.map(|(pos, uv)| Vertex { pos, uv, color }).into();
    mesh.indices = vec![0, 1, 2, 0, 2, 3];
    mesh
}

#[cfg(test)]
mod tests {
    use super::*;
    use scene::Class;

    #[test]
    fn every_box_is_marked_by_what_became_of_it() {
        let mut frame = Frame::new(Default::default(), Default::default(), Default::default());
        let b = |id: u32| SceneBox {
            id: BoxId(id),
            class: Class::Car,
            center_m: DVec3::new(f64::from(id), 0.0, 0.5),
            size_m: DVec3::new(4.0, 2.0, 1.5),
            yaw_rad: 0.0,
            velocity_mps: DVec2::ZERO,
            label: Default::default(),
        };
        frame.boxes.insert(BoxId(1), b(1));
        let marks = DetectionMarks {
            of: SceneRev::fresh(),
            detections: vec![(b(5), false), (b(6), true)],
            // One of the missed boxes no longer exists.
            missed: vec![BoxId(1), BoxId(2)],
            told: None,
            stands: None,
            map_from_vehicle: Pose::IDENTITY,
            window: Extent::WINDOW,
        };
        let found: Vec<DetectionOutcome> = marks.boxes(&frame).map(|(_, mark)| mark).collect();
        assert_eq!(
            found,
            [
                DetectionOutcome::Seen,
                DetectionOutcome::Ghost,
                DetectionOutcome::Missed
            ]
        );
    }
}
