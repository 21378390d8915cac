//! The line tool: points of a hedge, wall, fence or rail, beside the kerb where one is near.

use glam::DVec2;

use language::{t, tf};
use scene::Form;
use scene::background::{LineKind, Tree};

use super::{Coming, Draft, DraftResponse, DraftTool, GroundPointer, Phase, SceneryContext, ThingState};
use crate::tools::beside::drawing::length;
use crate::tools::setting::{self, Control, ToolOption, Value};
use crate::tools::{Hand, Shortcut, ToolDef, ToolGroup, ToolId, When};

/// Its name.
pub const ID: ToolId = ToolId("line_tool");

/// Its row of the table.
pub static DEF: ToolDef = ToolDef {
    id: ID,
    title: "Hedge, wall, fence",
    key: "Shift+L",
    icon: "fence",
    group: ToolGroup::Beside,
    is_brush: false,
    paints: false,
    shortcuts: &[Shortcut {
        id: ID.0,
        title: "Hedge, wall, fence, guard rail",
        keys: "Shift+L",
        when: When::Always,
        set: |hand| hand.tool = ID,
    }],
    make: || Box::new(DraftTool::<LineDraft>::default()),
};

/// A line that is being drawn.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct LineDraft {
    /// Points so far, ego frame, m.
    pub points_m: Vec<DVec2>,
    pressed: bool,
}

impl LineDraft {
    fn set_point(&mut self, p: &GroundPointer, site: &SceneryContext<'_>, options: &ThingState) {
        let at_m = snapped(p, site, options);
        // The second click of a double click sets none.
        if self.points_m.last().is_none_or(|q| q.distance(at_m) > p.reach_m) {
            self.points_m.push(at_m);
        }
    }
}

impl Draft for LineDraft {
    /// Each click sets a point, a drag sets two.
    fn pointer(
        &mut self,
        p: &GroundPointer,
        site: &SceneryContext<'_>,
        options: &ThingState,
    ) -> DraftResponse {
        match p.phase {
            Phase::Press => {
                self.pressed = true;
                self.set_point(p, site, options);
            }
            Phase::Release { clicked: false } if self.pressed => self.set_point(p, site, options),
            _ => {}
        }
        if matches!(p.phase, Phase::Release { .. }) {
            self.pressed = false;
        }
        DraftResponse::Nothing
    }

    fn finish(&mut self, options: &ThingState) -> DraftResponse {
        if self.points_m.len() < 2 {
            return DraftResponse::Refused(tf!(
                "A {kind} needs two points or more",
                kind = t(options.line.name())
            ));
        }
        let form = Form::Line(options.line_of(self.points_m.clone()));
        match form.problem() {
            Some(problem) => DraftResponse::Refused(problem),
            None => DraftResponse::Add(vec![form]),
        }
    }

    fn points_m(&self) -> &[DVec2] {
        &self.points_m
    }

    fn drop_point(&mut self) {
        self.points_m.pop();
    }

    fn hint(_: bool) -> Vec<&'static str> {
        vec!["Click sets a point", "Enter ends", "Backspace takes back"]
    }

    fn alt() -> Option<&'static str> {
        Some("Alt ignores the kerb")
    }

    fn coming(
        &self,
        _: bool,
        p: Option<GroundPointer>,
        site: &SceneryContext<'_>,
        options: &ThingState,
    ) -> Coming {
        let end = p.map(|p| snapped(&p, site, options));
        let points: Vec<DVec2> = self.points_m.iter().copied().chain(end).collect();
        let text = length(&points);
        let forms = match points.len() {
            0 | 1 => end.map(dot).into_iter().collect(),
            _ => vec![Form::Line(options.line_of(points))],
        };
        Coming {
            forms,
            way_m: Vec::new(),
            text,
        }
    }

    fn options(hand: &Hand) -> Vec<ToolOption> {
        let things = &hand.things;
        vec![
            ToolOption::title("Line"),
            ToolOption::text(
                "Click points; Enter or a double click ends. Points near a kerb come to lie beside it, with Alt they do not.",
            ),
            ToolOption::new(
                "kind",
                Control::Rows {
                    chosen: LineKind::ALL.iter().position(|k| *k == things.line).unwrap_or(0),
                    names: LineKind::ALL.map(LineKind::name).to_vec(),
                    verb: "Draw",
                },
            ),
            ToolOption::number("height", "Height, m", things.line_m, [0.3, 8.0], 1),
        ]
    }

    fn set(hand: &mut Hand, id: &str, value: Value) {
        match id {
            "kind" => {
                if let Some(kind) = value.index().and_then(|i| LineKind::ALL.get(i)) {
                    hand.things.take_line(*kind);
                }
            }
            "height" => setting::take_number(&mut hand.things.line_m, value),
            _ => {}
        }
    }
}

/// Mark of the first point of a line.
fn dot(at_m: DVec2) -> Form {
    Form::Tree(Tree {
        position_m: at_m,
        height_m: 1.0,
        crown_radius_m: 0.4,
        kind: Default::default(),
    })
}

/// Snapped place of a point: clear of the kerb by half the width of the line.
fn snapped(p: &GroundPointer, site: &SceneryContext<'_>, options: &ThingState) -> DVec2 {
    match p.free {
        true => p.at_m,
        false => site.beside_kerb(p.at_m, options.line.typical_m().1 / 2.0),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use scene::{BevLayer, BevLayout, Extent};

    #[test]
    fn points_lie_beside_the_kerb_unless_alt_is_held() {
        let mut layout = BevLayout::default();
        for x in 0..Extent::WINDOW.nx() {
            (0..110).for_each(|y| layout.set(BevLayer::DrivableArea, x, y, true)); // up to y = 4
        }
        let site = SceneryContext {
            layout: &layout,
            trees_m: &[],
            houses_m: &[],
            brush_m: 3.2,
        };
        let mut options = ThingState::default();
        options.take_line(LineKind::Wall);
        let mut draft = LineDraft::default();
        let mut click = |x, y, free| {
            let p = |phase| GroundPointer {
                phase,
                at_m: DVec2::new(x, y),
                reach_m: 0.3,
                free,
            };
            draft.pointer(&p(Phase::Press), &site, &options);
            draft.pointer(&p(Phase::Release { clicked: true }), &site, &options);
        };
        for (x, y, free) in [
            (0.0, 4.7, false),
            (8.0, 3.6, false),
            (8.1, 3.6, false),
            (16.0, 4.6, true),
            (20.0, 9.0, false),
        ] {
            click(x, y, free);
        }
        let DraftResponse::Add(forms) = draft.finish(&options) else {
            panic!("a wall");
        };
        let expected = [(0.0, 4.15), (8.0, 4.15), (16.0, 4.6), (20.0, 9.0)];
        let points = forms[0].points_m();
        assert_eq!(points.len(), 4, "a double click sets one");
        for (p, (x, y)) in points.iter().zip(expected) {
            assert!(p.distance(DVec2::new(x, y)) < 1e-6, "{p}");
        }
        assert!(matches!(&forms[0], Form::Line(l) if l.kind == LineKind::Wall && l.height_m == 1.6));
        let short = LineDraft::default().finish(&options);
        assert_eq!(
            short,
            DraftResponse::Refused("A wall needs two points or more".into())
        );
    }
}
