//! The shrub tool: a stroke of a brush becomes the outline of an area.

use glam::DVec2;

use crate::outline;
use scene::Form;
use scene::background::Shrubs;

use super::{Coming, Draft, DraftResponse, DraftTool, GroundPointer, Phase, SceneryContext, ThingState};
use crate::tools::setting::{self, ToolOption, Value};
use crate::tools::{Hand, Shortcut, ToolDef, ToolGroup, ToolId, When};

/// Its name.
pub const ID: ToolId = ToolId("shrub_tool");

/// Its row of the table.
pub static DEF: ToolDef = ToolDef {
    id: ID,
    title: "Shrubs",
    key: "Shift+S",
    icon: "shrubs",
    group: ToolGroup::Beside,
    is_brush: true,
    paints: false,
    shortcuts: &[Shortcut {
        id: ID.0,
        title: "Shrubs",
        keys: "Shift+S",
        when: When::Always,
        set: |hand| hand.tool = ID,
    }],
    make: || Box::new(DraftTool::<ShrubStroke>::default()),
};

/// Plants per square metre.
const PER_M2: f64 = 0.5;
/// Points of a stroke are this far apart, m.
const STEP_M: f64 = 0.3;

/// A stroke that is being drawn.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ShrubStroke {
    points_m: Vec<DVec2>,
}

impl Draft for ShrubStroke {
    fn pointer(
        &mut self,
        p: &GroundPointer,
        site: &SceneryContext<'_>,
        options: &ThingState,
    ) -> DraftResponse {
        if p.phase == Phase::Press {
            self.points_m.clear();
        }
        if self.points_m.last().is_none_or(|q| q.distance(p.at_m) >= STEP_M) {
            self.points_m.push(p.at_m);
        } else if p.phase == Phase::Drag {
            return DraftResponse::Nothing;
        }
        let outline_m = outline::of_stroke(site.layout.extent(), &self.points_m, site.brush_m);
        let shrubs = outline_m.map(|o| area(o, options));
        match (p.phase, shrubs.filter(|form| form.problem().is_none())) {
            (Phase::Release { .. }, Some(form)) => DraftResponse::Add(vec![form]),
            (Phase::Release { .. }, None) => {
                DraftResponse::Refused("The stroke lies outside the map".to_owned())
            }
            (_, form) => DraftResponse::Preview(form.into_iter().collect()),
        }
    }

    fn hint(_: bool) -> Vec<&'static str> {
        vec!["Drag paints an area of shrubs", "[ ] size"]
    }

    fn coming(
        &self,
        drawing: bool,
        p: Option<GroundPointer>,
        site: &SceneryContext<'_>,
        options: &ThingState,
    ) -> Coming {
        let at_m = p.filter(|_| !drawing).map(|p| p.at_m);
        let outline_m = at_m.and_then(|p| outline::of_stroke(site.layout.extent(), &[p], site.brush_m));
        Coming {
            forms: outline_m.map(|o| area(o, options)).into_iter().collect(),
            ..Coming::default()
        }
    }

    fn options(hand: &Hand) -> Vec<ToolOption> {
        let brush_m = [*Hand::BRUSH_M.start(), *Hand::BRUSH_M.end()];
        vec![
            ToolOption::title("Shrubs"),
            ToolOption::text("A stroke becomes an area of shrubs."),
            ToolOption::number("height", "Height, m", hand.things.shrubs_m, [0.3, 4.0], 1),
            ToolOption::number("size", "Brush, m", hand.brush_m, brush_m, 1),
        ]
    }

    fn set(hand: &mut Hand, id: &str, value: Value) {
        match id {
            "height" => setting::take_number(&mut hand.things.shrubs_m, value),
            "size" => setting::take_number(&mut hand.brush_m, value),
            _ => {}
        }
    }
}

fn area(outline_m: Vec<DVec2>, options: &ThingState) -> Form {
    Form::Shrubs(Shrubs {
        outline_m,
        height_m: options.shrubs_m,
        per_m2: PER_M2,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::choose::is_inside;

    #[test]
    fn a_stroke_becomes_an_area() {
        let (mut draft, options) = (ShrubStroke::default(), ThingState::default());
        let at = |phase, x, y| GroundPointer {
            phase,
            at_m: DVec2::new(x, y),
            reach_m: 0.4,
            free: false,
        };
        let site = SceneryContext {
            layout: &Default::default(),
            trees_m: &[],
            houses_m: &[],
            brush_m: 3.2,
        };
        draft.pointer(&at(Phase::Press, 0.0, 8.0), &site, &options);
        for i in 1..=20 {
            draft.pointer(&at(Phase::Drag, f64::from(i) * 0.5, 8.0), &site, &options);
        }
        let DraftResponse::Add(forms) =
            draft.pointer(&at(Phase::Release { clicked: false }, 10.0, 8.0), &site, &options)
        else {
            panic!("an area");
        };
        assert_eq!(forms[0].problem(), None);
        let outline = forms[0].points_m();
        assert!(is_inside(&outline, DVec2::new(5.0, 9.2)) && !is_inside(&outline, DVec2::new(5.0, 10.4)));
        draft.pointer(&at(Phase::Press, 200.0, 8.0), &site, &options);
        let outside = draft.pointer(&at(Phase::Release { clicked: true }, 200.0, 8.0), &site, &options);
        assert!(matches!(outside, DraftResponse::Refused(_)));
    }
}
