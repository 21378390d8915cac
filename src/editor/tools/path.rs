//! The path tool: clicks say where the chosen object goes, point by point; without one, where the ego vehicle goes.

use std::borrow::Cow;

use glam::DVec2;

use scene::clip::{Path, Speed};
use scene::roads::curve;
use scene::{BoxId, Edit, Motion, Scene, Template};

use crate::traffic::shown;

use super::setting::ToolOption;
use super::{
    Act, At, Context, Cursor, Event, Hand, Hint, Key, ReadonlyContext, Response, Role, Shortcut, Tool,
    ToolDef, ToolGroup, ToolId, ToolMark, ViewKind, When,
};

/// Its name.
pub const ID: ToolId = ToolId("path_tool");

/// Its row of the table.
pub static DEF: ToolDef = ToolDef {
    id: ID,
    title: "Path",
    key: "Shift+M",
    icon: "path",
    group: ToolGroup::Scene,
    is_brush: false,
    paints: false,
    shortcuts: &[Shortcut {
        id: ID.0,
        title: "Path of the chosen object",
        keys: "Shift+M",
        when: When::Always,
        set: |hand| hand.tool = ID,
    }],
    make: || Box::new(Course::default()),
};

/// A scene that lasts no time becomes so long, or as long as the path takes; s.
const USUAL_LENGTH_S: f64 = 8.0;
/// Slower than this it stands, and a path gets the usual speed of its class, m/s.
const STANDS_MPS: f64 = 0.3;

/// The path tool.
#[derive(Clone, Debug, Default)]
pub struct Course {
    /// Points of the path, m, without the start, which is the current position.
    points_m: Vec<DVec2>,
}

/// The path's line, m: a smooth one from where it is through the points.
fn line(scene: &Scene, id: Option<BoxId>, points_m: &[DVec2]) -> Vec<DVec2> {
    let Some(from) = shown(scene, id) else {
        return Vec::new();
    };
    let behind = from.at_m - DVec2::from_angle(from.yaw_rad);
    let all: Vec<DVec2> = std::iter::once(from.at_m)
        .chain(points_m.iter().copied())
        .collect();
    curve::through(Some(behind), &all, None)
}

/// Edits that let an object, or the ego vehicle, go through points (m) from the moment shown on. `None` if the path has no length.
fn edits(scene: &Scene, id: Option<BoxId>, points_m: &[DVec2]) -> Option<Vec<Edit>> {
    let from = shown(scene, id)?;
    let points_m = line(scene, id, points_m);
    let length_m = curve::length_m(&points_m);
    let class = id.and_then(|id| scene.frame().boxes.get(&id)).map(|b| b.class);
    let own_mps = from.velocity_mps.length();
    let mps = if own_mps > STANDS_MPS {
        own_mps
    } else {
        Template::usual_mps(class)
    };
    if length_m < 0.5 {
        return None;
    }
    let clip = scene.clip();
    let mut out = Vec::new();
    let end_s = scene.time_s() + length_m / mps;
    if clip.length_s == 0.0 {
        let length_s = end_s.clamp(USUAL_LENGTH_S, scene::Clip::MAX_LENGTH_S).ceil();
        out.push(Edit::SetLength {
            length_s,
            rate_hz: None,
        });
    }
    let there_s = id
        .and_then(|id| clip.tracks.get(&id))
        .map_or([None; 2], |t| t.there_s);
    out.push(Edit::SetMotion {
        id,
        motion: Some(Motion::Path(Path {
            points_m,
            start_m: 0.0,
            speeds: vec![Speed {
                time_s: scene.time_s(),
                mps,
            }],
            rear_first: false,
        })),
        from_s: there_s[0],
        to_s: there_s[1],
    });
    Some(out)
}

impl Course {
    fn close(&mut self, cx: &Context<'_>) -> Response {
        let points_m = std::mem::take(&mut self.points_m);
        match edits(cx.settled, cx.hand.selected, &points_m) {
            Some(edits) => Response::taken().and(Act::Apply("Draw path".into(), edits)),
            None => Response::taken(),
        }
    }
}

impl Tool for Course {
    fn event(&mut self, cx: &mut Context<'_>, event: &Event) -> Response {
        match event {
            Event::Press(pointer) => {
                // The second press of a double click is at the same place.
                if let Some(at_m) = cx.ground_m(pointer.at)
                    && self.points_m.last().is_none_or(|last| last.distance(at_m) > 0.1)
                {
                    self.points_m.push(at_m);
                }
                Response::none()
            }
            Event::DoubleClick | Event::Key(Key::Enter, ..) => self.close(cx),
            Event::Key(Key::Escape, ..) => {
                self.points_m.clear();
                Response::taken()
            }
            Event::Key(Key::Backspace, ..) => {
                self.points_m.pop();
                Response::taken()
            }
            _ => Response::none(),
        }
    }

    fn hint(&self, hand: &Hand, _: Option<ViewKind>) -> Hint {
        let first = match hand.selected {
            Some(_) => "Click: where the chosen object goes",
            None => "Click: where we go",
        };
        let rest = ["Enter or double-click ends", "Backspace takes a point back"];
        std::iter::once(first).chain(rest).map(Cow::Borrowed).collect()
    }

    fn cursor(&self, _: &ReadonlyContext<'_>) -> Cursor {
        Cursor::Crosshair
    }

    fn overlay(&self, sight: &ReadonlyContext<'_>) -> Vec<ToolMark> {
        let set = self.points_m.iter().copied();
        let points_m: Vec<DVec2> = set.chain(sight.ground_m()).collect();
        let line: Vec<At> = line(sight.settled, sight.hand.selected, &points_m)
            .into_iter()
            .map(At::from)
            .collect();
        let mut out = vec![ToolMark::Line(line, Role::Hand)];
        out.extend(
            self.points_m
                .iter()
                .map(|p| ToolMark::Dot((*p).into(), Role::Hand)),
        );
        out
    }

    fn options(&self, hand: &Hand) -> Vec<ToolOption> {
        vec![
            ToolOption::title("Path"),
            ToolOption::text(match hand.selected {
                Some(_) => {
                    "Click where the chosen object goes from this moment on, Enter ends. It keeps its speed, or gets the usual one of its class."
                }
                None => {
                    "Nothing is chosen: the path is the ego vehicle's. Choose an object first to draw its path."
                }
            }),
        ]
    }

    fn points_m(&self) -> &[DVec2] {
        &self.points_m
    }

    fn put_down(&mut self) {
        self.points_m.clear();
    }

    fn restart(&mut self) {
        self.points_m.clear();
    }
}

#[cfg(test)]
mod tests {
    use super::super::testing::{NONE, Table};
    use super::*;
    use crate::Apply;
    use scene::Class;

    #[test]
    fn clicks_make_a_path_from_where_the_object_is() {
        let mut table = Table::new();
        let car = table
            .hand
            .new_box(table.scene.frame(), Class::Car, DVec2::new(2.0, 1.0), 0.0)
            .expect("an object");
        let add = Edit::AddBox {
            id: Some(car.id),
            class: car.class,
            center_m: car.center_m,
            size_m: car.size_m,
            yaw_deg: 0.0,
            velocity_mps: None,
            label: Default::default(),
        };
        add.apply(&mut table.scene).expect("added");
        table.hand.selected = Some(car.id);
        let mut tool = Course::default();
        table.click(&mut tool, 12.0, 1.0, NONE);
        table.click(&mut tool, 20.0, 9.0, NONE);
        table.click(&mut tool, 20.0, 9.0, NONE);
        assert_eq!(tool.points_m.len(), 2, "a double click is one point");
        table.key(&mut tool, Key::Backspace);
        table.click(&mut tool, 22.0, 11.0, NONE);
        assert!(table.sight(24.0, 11.0).ground_m().is_some());
        assert!(!tool.overlay(&table.sight(24.0, 11.0)).is_empty());
        let response = table.key(&mut tool, Key::Enter);
        let [Act::Apply(_, edits)] = response.acts.as_slice() else {
            panic!("{response:?}");
        };
        for edit in edits {
            edit.apply(&mut table.scene).expect("a sound path");
        }
        let clip = table.scene.clip();
        assert!(clip.length_s >= USUAL_LENGTH_S);
        let at = |t: f64| clip.moving(car.id, t).expect("there");
        assert!(at(0.0).at_m.distance(DVec2::new(2.0, 1.0)) < 1e-9);
        assert!(at(clip.length_s).at_m.distance(DVec2::new(22.0, 11.0)) < 1e-6);
        let speed = at(1.0).velocity_mps.length();
        assert!(
            (speed - Template::usual_mps(Some(Class::Car))).abs() < 1e-9,
            "{speed}"
        );
        assert!(tool.points_m.is_empty());
    }

    #[test]
    fn a_path_without_length_is_none() {
        let mut table = Table::new();
        let mut tool = Course::default();
        assert_eq!(table.key(&mut tool, Key::Enter).acts, []);
        // Of the ego vehicle, who has no box.
        table.click(&mut tool, 0.1, 0.0, NONE);
        assert_eq!(table.key(&mut tool, Key::Enter).acts, []);
        table.click(&mut tool, 10.0, 0.0, NONE);
        table.key(&mut tool, Key::Escape);
        assert_eq!(table.key(&mut tool, Key::Enter).acts, []);
        table.click(&mut tool, 10.0, 0.0, NONE);
        assert_eq!(table.key(&mut tool, Key::Enter).acts.len(), 1);
    }
}
