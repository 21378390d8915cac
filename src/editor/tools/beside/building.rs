//! The building tool: a drag makes a rectangle along the road, clicks make an outline.

use glam::DVec2;

use crate::kerb;
use language::tf;
use scene::Form;
use scene::background::{Building, Facade, Roof, STOREY_M, crossing_edges};

use super::{Coming, Draft, DraftResponse, DraftTool, GroundPointer, Phase, SceneryContext, ThingState};
use crate::tools::beside::drawing::length;
use crate::tools::setting::{self, Control, ToolOption, Value};
use crate::tools::{Hand, Shortcut, ToolDef, ToolGroup, ToolId, When};

/// Its name.
pub const ID: ToolId = ToolId("building_tool");

/// Its row of the table.
pub static DEF: ToolDef = ToolDef {
    id: ID,
    title: "Building",
    key: "Shift+B",
    icon: "building",
    group: ToolGroup::Beside,
    is_brush: false,
    paints: false,
    shortcuts: &[Shortcut {
        id: ID.0,
        title: "Building",
        keys: "Shift+B",
        when: When::Always,
        set: |hand| hand.tool = ID,
    }],
    make: || Box::new(DraftTool::<BuildingDraft>::default()),
};

/// Names of roofs.
pub const ROOFS: [(Roof, &str, &str); 3] = [
    (Roof::Flat, "Flat", ""),
    (Roof::Gabled, "Gabled", "four corners only"),
    (Roof::Hipped, "Hipped", "four corners only"),
];
/// Names of facades.
pub const FACADES: [(Facade, &str, &str); 5] = [
    (Facade::Plain, "Plain", ""),
    (Facade::Balconies, "Balconies", ""),
    (Facade::Bays, "Bays", ""),
    (
        Facade::Arcade,
        "Arcade",
        "a ground floor behind columns; four corners only",
    ),
    (Facade::Glass, "Glass", "mirrors a LiDAR's pulses at a slant"),
];

/// Smaller sides than this make no building, m.
const LEAST_M: f64 = 1.0;

/// A building that is being drawn.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct BuildingDraft {
    /// Corners of an outline so far, ego frame, m.
    pub corners_m: Vec<DVec2>,
    pressed_m: Option<DVec2>,
}

impl BuildingDraft {
    /// Sets a corner, or closes the outline at its first one.
    fn corner(&mut self, p: &GroundPointer, options: &ThingState) -> DraftResponse {
        let near = |q: Option<&DVec2>| q.is_some_and(|q| q.distance(p.at_m) <= p.reach_m);
        if self.corners_m.len() >= 3 && near(self.corners_m.first()) {
            return self.finish(options);
        }
        // The second click of a double click.
        if near(self.corners_m.last()) {
            return DraftResponse::Nothing;
        }
        if crosses(&self.corners_m, p.at_m) {
            return DraftResponse::Refused("That wall would cross another one".to_owned());
        }
        self.corners_m.push(p.at_m);
        DraftResponse::Nothing
    }
}

impl Draft for BuildingDraft {
    fn pointer(
        &mut self,
        p: &GroundPointer,
        site: &SceneryContext<'_>,
        options: &ThingState,
    ) -> DraftResponse {
        match p.phase {
            Phase::Press => {
                self.pressed_m = Some(p.at_m);
                DraftResponse::Nothing
            }
            Phase::Drag => match self.pressed_m.filter(|_| self.corners_m.is_empty()) {
                Some(from_m) => match rectangle(from_m, p, site, options) {
                    Ok(building) => DraftResponse::Preview(vec![Form::Building(building)]),
                    Err(_) => DraftResponse::Preview(Vec::new()),
                },
                None => DraftResponse::Nothing,
            },
            Phase::Release { clicked } => match self.pressed_m.take() {
                // A hand that shakes while it clicks drags a little.
                Some(from_m)
                    if !clicked && self.corners_m.is_empty() && from_m.distance(p.at_m) > LEAST_M =>
                {
                    match rectangle(from_m, p, site, options) {
                        Ok(building) => DraftResponse::Add(vec![Form::Building(building)]),
                        Err(problem) => DraftResponse::Refused(problem),
                    }
                }
                Some(_) => self.corner(p, options),
                None => DraftResponse::Nothing,
            },
        }
    }

    fn finish(&mut self, options: &ThingState) -> DraftResponse {
        if self.corners_m.len() < 3 {
            return DraftResponse::Refused("A building needs three corners or more".to_owned());
        }
        if crossing_edges(&self.corners_m).is_some() {
            return DraftResponse::Refused(
                "The outline crosses itself: Backspace takes the last corner back".to_owned(),
            );
        }
        let form = Form::Building(with_options(self.corners_m.clone(), options));
        match form.problem() {
            Some(problem) => DraftResponse::Refused(problem),
            None => DraftResponse::Add(vec![form]),
        }
    }

    fn points_m(&self) -> &[DVec2] {
        &self.corners_m
    }

    fn drop_point(&mut self) {
        self.corners_m.pop();
    }

    fn hint(drawn: bool) -> Vec<&'static str> {
        match drawn {
            true => vec!["Click sets a corner", "Enter closes", "Backspace takes back"],
            false => vec!["Drag draws a rectangle", "click begins an outline"],
        }
    }

    fn alt() -> Option<&'static str> {
        Some("Alt ignores the road")
    }

    fn coming(
        &self,
        _: bool,
        p: Option<GroundPointer>,
        _: &SceneryContext<'_>,
        options: &ThingState,
    ) -> Coming {
        let at_m = p.map(|p| p.at_m);
        let corners: Vec<DVec2> = self.corners_m.iter().copied().chain(at_m).collect();
        let mut out = Coming::default();
        if !self.corners_m.is_empty() {
            if corners.len() >= 3 {
                out.forms.push(Form::Building(Building {
                    outline_m: corners.clone(),
                    height_m: STOREY_M,
                    roof: options.roof,
                    facade: options.facade,
                }));
            }
            out.text = length(&corners);
        }
        out.way_m = corners;
        out
    }

    fn options(hand: &Hand) -> Vec<ToolOption> {
        let things = &hand.things;
        vec![
            ToolOption::title("Building"),
            ToolOption::text(
                "Drag a rectangle along the road, or click corners: Enter or a double click closes.",
            ),
            ToolOption::number("storeys", "Storeys", f64::from(things.storeys), [1.0, 25.0], 0),
            ToolOption::gap(),
            ToolOption::segments("roof", things.roof, &ROOFS, 3),
            ToolOption::gap(),
            ToolOption::new(
                "facade",
                Control::List {
                    title: "Facade",
                    label: "Facade",
                    chosen: setting::index_in(things.facade, &FACADES),
                    choices: FACADES.iter().map(|f| (f.1.to_owned(), f.2)).collect(),
                },
            ),
        ]
    }

    fn set(hand: &mut Hand, id: &str, value: Value) {
        let things = &mut hand.things;
        match id {
            "storeys" => {
                if let Some(storeys) = value.number() {
                    things.storeys = storeys.round().clamp(1.0, 25.0) as u32;
                }
            }
            "roof" => setting::take(&mut things.roof, value, &ROOFS),
            "facade" => setting::take(&mut things.facade, value, &FACADES),
            _ => {}
        }
    }
}

fn with_options(outline_m: Vec<DVec2>, options: &ThingState) -> Building {
    Building {
        roof: match outline_m.len() {
            4 => options.roof,
            _ => Roof::Flat,
        },
        facade: options.facade,
        height_m: f64::from(options.storeys) * STOREY_M,
        outline_m,
    }
}

/// The rectangle between two corners whose sides run along and across the nearest road.
fn rectangle(
    from_m: DVec2,
    p: &GroundPointer,
    site: &SceneryContext<'_>,
    options: &ThingState,
) -> Result<Building, String> {
    let along = match p.free {
        true => DVec2::X,
        false => kerb::road_direction(site.layout, (from_m + p.at_m) / 2.0),
    };
    let d = p.at_m - from_m;
    let sides = DVec2::new(d.dot(along), d.dot(along.perp())).abs();
    if sides.min_element() < LEAST_M {
        return Err(tf!(
            "The building would be {length} × {width} m, expected at least {least} m",
            length = format!("{:.1}", sides.x),
            width = format!("{:.1}", sides.y),
            least = LEAST_M
        ));
    }
    let outline = Building::rectangle((from_m + p.at_m) / 2.0, sides / 2.0, along, STOREY_M).outline_m;
    Ok(with_options(outline, options))
}

/// True if the wall from the last corner to a new one crosses one that is there.
fn crosses(corners_m: &[DVec2], to_m: DVec2) -> bool {
    let Some(&from_m) = corners_m.last() else {
        return false;
    };
    let side = |p: DVec2, q: DVec2, r: DVec2| (q - p).perp_dot(r - p);
    let walls = corners_m.windows(2).take(corners_m.len().saturating_sub(2));
    walls.into_iter().any(|w| {
        let apart = side(from_m, to_m, w[0]) * side(from_m, to_m, w[1]) > 0.0;
        let beside = side(w[0], w[1], from_m) * side(w[0], w[1], to_m) > 0.0;
        !apart && !beside
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use scene::{BevLayout, Polyline, PolylineKind};

    fn v(x: f64, y: f64) -> DVec2 {
        DVec2::new(x, y)
    }

    fn at(phase: Phase, x: f64, y: f64) -> GroundPointer {
        GroundPointer {
            phase,
            at_m: v(x, y),
            reach_m: 0.4,
            free: false,
        }
    }

    /// A lane that runs diagonally.
    fn layout() -> BevLayout {
        let lane = Polyline {
            kind: PolylineKind::LaneCenter,
            points_m: vec![v(-30.0, -30.0), v(30.0, 30.0)],
        };
        BevLayout::from_cells(vec![0; 40_000], vec![lane]).expect("the right size")
    }

    struct Builder {
        draft: BuildingDraft,
        layout: BevLayout,
        options: ThingState,
    }

    impl Builder {
        fn new() -> Self {
            Self {
                draft: BuildingDraft::default(),
                layout: layout(),
                options: ThingState::default(),
            }
        }

        fn does(&mut self, p: GroundPointer) -> DraftResponse {
            let site = SceneryContext {
                layout: &self.layout,
                trees_m: &[],
                houses_m: &[],
                brush_m: 3.2,
            };
            let outcome = self.draft.pointer(&p, &site, &self.options);
            if matches!(outcome, DraftResponse::Add(_)) {
                self.draft = BuildingDraft::default();
            }
            outcome
        }

        fn click(&mut self, x: f64, y: f64) -> DraftResponse {
            self.does(at(Phase::Press, x, y));
            self.does(at(Phase::Release { clicked: true }, x, y))
        }
    }

    #[test]
    fn a_drag_makes_a_rectangle_along_the_road() {
        let mut hand = Builder::new();
        assert_eq!(hand.does(at(Phase::Press, 10.0, 0.0)), DraftResponse::Nothing);
        let preview = hand.does(at(Phase::Drag, 20.0, 0.0));
        assert!(matches!(preview, DraftResponse::Preview(forms) if forms.len() == 1));
        let DraftResponse::Add(forms) = hand.does(at(Phase::Release { clicked: false }, 20.0, 0.0)) else {
            panic!("a building");
        };
        let Form::Building(building) = &forms[0] else {
            panic!("a building");
        };
        assert_eq!(building.height_m, 12.0);
        let side = (building.outline_m[1] - building.outline_m[0]).normalize();
        assert!(
            (side.dot(v(1.0, 1.0).normalize()).abs() - 1.0).abs() < 1e-9,
            "{side}"
        );
        // Both corners of the drag are corners.
        for p in [v(10.0, 0.0), v(20.0, 0.0)] {
            assert!(building.outline_m.iter().any(|q| q.distance(p) < 1e-9), "{p}");
        }
        assert_eq!(hand.draft, BuildingDraft::default(), "done");
        // A sliver is refused, and with Alt the sides are those of the ego frame.
        hand.does(at(Phase::Press, 0.0, 0.0));
        let thin = hand.does(at(Phase::Release { clicked: false }, 7.0, 7.1));
        assert!(matches!(thin, DraftResponse::Refused(text) if text.contains("expected at least 1 m")));
        hand.does(at(Phase::Press, 0.0, 0.0));
        let free = GroundPointer {
            free: true,
            ..at(Phase::Release { clicked: false }, 8.0, 5.0)
        };
        let DraftResponse::Add(forms) = hand.does(free) else {
            panic!("a building");
        };
        assert!(forms[0].points_m().contains(&v(8.0, 0.0)));
    }

    #[test]
    fn clicks_make_an_outline_that_does_not_cross() {
        let mut hand = Builder::new();
        for [x, y] in [[0.0, 0.0], [10.0, 0.0], [10.0, 8.0]] {
            assert_eq!(hand.click(x, y), DraftResponse::Nothing);
        }
        let crossing = hand.click(5.0, -3.0);
        assert_eq!(
            crossing,
            DraftResponse::Refused("That wall would cross another one".into())
        );
        assert_eq!(hand.draft.points_m().len(), 3, "it was not taken");
        assert_eq!(hand.click(10.1, 8.1), DraftResponse::Nothing, "a double click");
        assert_eq!(hand.draft.points_m().len(), 3);
        assert_eq!(hand.click(4.0, 8.0), DraftResponse::Nothing);
        // A click on the first corner closes it.
        let DraftResponse::Add(forms) = hand.click(0.2, 0.1) else {
            panic!("a building");
        };
        assert_eq!(forms[0].points_m().len(), 4);
        assert_eq!(forms[0].problem(), None);
        // The closing wall may cross: that is said, and the corners stay.
        for [x, y] in [
            [0.0, 0.0],
            [10.0, 0.0],
            [10.0, 10.0],
            [3.0, 10.0],
            [3.0, 0.5],
            [6.0, 5.0],
        ] {
            assert_eq!(hand.click(x, y), DraftResponse::Nothing);
        }
        assert!(
            matches!(hand.draft.finish(&hand.options), DraftResponse::Refused(text) if text.contains("crosses itself"))
        );
        assert_eq!(hand.draft.points_m().len(), 6);
        hand.draft.drop_point();
        assert!(matches!(hand.draft.finish(&hand.options), DraftResponse::Add(_)));
    }
}
