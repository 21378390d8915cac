//! The measure tool: points on the ground or, in the 3D view, on the surface under the pointer; the distances between
//! them and the angle at the middle one.

use glam::{DVec2, DVec3};

use crate::measure::{Measure, snapped};
use crate::pick;
use scene::Frame;

use super::setting::{Control, ToolOption};
use super::{
    At, Context, Cursor, Event, HANDLE_REACH, Hand, Hint, Key, ReadonlyContext, Response, Role,
    ScreenProjection, Shortcut, Tool, ToolDef, ToolGroup, ToolId, ToolMark, ViewKind, Wants, When, hint_of,
    point_of,
};

/// Its name.
pub const ID: ToolId = ToolId("measure_tool");

/// Its row of the table.
pub static DEF: ToolDef = ToolDef {
    id: ID,
    title: "Measure",
    key: "M",
    icon: "measure",
    group: ToolGroup::Scene,
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

/// The point under a point of the screen: in the view from above on the ground, snapped to the boxes near it; in the 3D
/// view on the surface that is hit.
fn point(frame: &Frame, view: &dyn ScreenProjection, at: DVec2) -> Option<DVec3> {
    let ray = view.ray(at)?;
    match view.kind() {
        ViewKind::Bev => {
            let at_m = ray.origin_in_ego.truncate();
            Some(snapped(frame, at_m, HANDLE_REACH / view.scale()).extend(0.0))
        }
        ViewKind::Space => Some(point_of(&pick::pick(frame, &ray)?, &ray)),
    }
}

impl Tool for Ruler {
    fn event(&mut self, cx: &mut Context<'_>, event: &Event) -> Response {
        match event {
            Event::Press(pointer) => {
                if let Some(p_m) = point(cx.frame(), cx.view, pointer.at) {
                    self.measure.add(p_m);
                }
                Response::none()
            }
            Event::Key(Key::Escape, ..) => {
                self.measure.clear();
                Response::taken()
            }
            _ => Response::none(),
        }
    }

    fn hint(&self, _: &Hand, _: Option<ViewKind>) -> Hint {
        hint_of(&["Click sets a point", "Esc clears"])
    }

    fn cursor(&self, _: &ReadonlyContext<'_>) -> Cursor {
        Cursor::Crosshair
    }

    fn overlay(&self, sight: &ReadonlyContext<'_>) -> Vec<ToolMark> {
        let under = sight.pointer.map(|p| p.at);
        let next_m = under.and_then(|at| point(sight.scene.frame(), sight.view, at));
        let points_m = self.measure.with(next_m);
        let line: Vec<At> = points_m.iter().map(|p| At::Ego(*p)).collect();
        let mut out = vec![ToolMark::Line(line.clone(), Role::Measure)];
        for pair in points_m.windows(2) {
            let text = format!("{:.2} m", pair[0].distance(pair[1]));
            out.push(ToolMark::Label(At::Ego((pair[0] + pair[1]) / 2.0), text));
        }
        out.extend(line.iter().map(|p| ToolMark::Dot(*p, Role::Measure)));
        if let (Some(text), Some(last)) = (self.measure.text(next_m), line.last()) {
            out.push(ToolMark::Tag(*last, text));
        }
        out
    }

    fn options(&self, _: &Hand) -> Vec<ToolOption> {
        let mut out = vec![
            ToolOption::title("Measure"),
            ToolOption::text(
                "Click points: two give a distance, a third the angle. From above box corners catch them, in the 3D view they lie on what is under the pointer. Esc clears.",
            ),
        ];
        let text = self.measure.text(None);
        out.extend(text.map(|text| ToolOption::new("", Control::Result(text))));
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
