//! The measure tool: points on the ground, the distances between them and the angle at the middle one.

use glam::DVec2;

use crate::measure::{Measure, snapped};
use scene::Frame;

use super::setting::{Control, Setting};
use super::{
    At, Context, Cursor, Event, Group, HANDLE_REACH, Hand, Hint, Key, Mark, Response, Role, Shortcut, Sight,
    Tool, ToolDef, ToolId, ViewKind, Wants, When, hint_of,
};

/// Its name.
pub const ID: ToolId = ToolId("measure_tool");

/// Its row of the table.
pub static DEF: ToolDef = ToolDef {
    id: ID,
    title: "Measure",
    key: "M",
    icon: "measure",
    group: Group::Scene,
    is_brush: false,
    paints: false,
    shortcuts: &[Shortcut {
        id: ID.0,
        title: "Measure",
        keys: "M",
        when: When::Always,
        set: |hand| hand.tool = ID,
    }],
    make: || Box::new(Ruler::default()),
};

/// The measure tool.
#[derive(Clone, Debug, Default)]
pub struct Ruler {
    measure: Measure,
}

fn caught(frame: &Frame, at_m: DVec2, scale: f64) -> DVec2 {
    snapped(frame, at_m, HANDLE_REACH / scale)
}

impl Tool for Ruler {
    fn event(&mut self, cx: &mut Context<'_>, event: &Event) -> Response {
        match event {
            Event::Press(pointer) if cx.from_above() => {
                if let Some(at_m) = cx.ground_m(pointer.at) {
                    self.measure.add(caught(cx.frame(), at_m, cx.view.scale()));
                }
                Response::none()
            }
            Event::Key(Key::Escape, ..) => {
                self.measure.points_m.clear();
                Response::taken()
            }
            _ => Response::none(),
        }
    }

    fn hint(&self, _: &Hand, view: Option<ViewKind>) -> Hint {
        match view {
            Some(ViewKind::Space) => hint_of(&["Measures in the bird's-eye view"]),
            _ => hint_of(&["Click sets a point", "Esc clears"]),
        }
    }

    fn cursor(&self, sight: &Sight<'_>) -> Cursor {
        match sight.from_above() {
            true => Cursor::Crosshair,
            false => Cursor::Forbidden,
        }
    }

    fn overlay(&self, sight: &Sight<'_>) -> Vec<Mark> {
        if !sight.from_above() {
            return Vec::new();
        }
        let (frame, scale) = (sight.scene.frame(), sight.view.scale());
        let next_m = sight.ground_m().map(|p| caught(frame, p, scale));
        let open = self.measure.points_m.len() < 3;
        let set = self.measure.points_m.iter().copied();
        let points_m: Vec<DVec2> = set.chain(next_m.filter(|_| open)).collect();
        let line: Vec<At> = points_m.iter().map(|p| (*p).into()).collect();
        let mut out = vec![Mark::Line(line.clone(), Role::Measure)];
        for pair in points_m.windows(2) {
            let text = format!("{:.2} m", pair[0].distance(pair[1]));
            out.push(Mark::Label(((pair[0] + pair[1]) / 2.0).into(), text));
        }
        out.extend(line.iter().map(|p| Mark::Dot(*p, Role::Measure)));
        if let (Some(text), Some(last)) = (self.measure.text(next_m), line.last()) {
            out.push(Mark::Tag(*last, text));
        }
        out
    }

    fn options(&self, _: &Hand) -> Vec<Setting> {
        let mut out = vec![
            Setting::title("Measure"),
            Setting::text(
                "Click points in the bird's-eye view: two give a distance, a third the angle. Box corners catch them, Esc clears.",
            ),
        ];
        let text = self.measure.text(None);
        out.extend(text.map(|text| Setting::new("", Control::Result(text))));
        out
    }

    fn points_m(&self) -> &[DVec2] {
        &self.measure.points_m
    }

    fn wants(&self) -> Wants {
        match self.measure.points_m.is_empty() {
            true => Wants::Nothing,
            false => Wants::Escape,
        }
    }
}
