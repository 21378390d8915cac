//! The tree tool: a click stamps a tree, a drag scatters some along the way.

use glam::DVec2;

use crate::choose::is_inside;
use crate::kerb;
use scene::Form;
use scene::background::{Tree, TreeKind};
use scene::draw::{Draw, hash};

use super::{Coming, Draft, DraftResponse, DraftTool, GroundPointer, Phase, SceneryContext, ThingState};
use crate::tools::setting::{self, ToolOption, Value};
use crate::tools::{Hand, Shortcut, ToolDef, ToolGroup, ToolId, When};

/// Its name.
pub const ID: ToolId = ToolId("tree_tool");

/// Its row of the table.
pub static DEF: ToolDef = ToolDef {
    id: ID,
    title: "Trees",
    key: "Shift+T",
    icon: "tree",
    group: ToolGroup::Beside,
    is_brush: false,
    paints: false,
    shortcuts: &[Shortcut {
        id: ID.0,
        title: "Trees",
        keys: "Shift+T",
        when: When::Always,
        set: |hand| hand.tool = ID,
    }],
    make: || Box::new(DraftTool::<TreeStroke>::default()),
};

/// Names of trees.
pub const TREES: [(TreeKind, &str, &str); 4] = [
    (TreeKind::Broadleaf, "Broadleaf", ""),
    (TreeKind::Conifer, "Conifer", ""),
    (TreeKind::Columnar, "Columnar", ""),
    (TreeKind::Bare, "Bare", "without leaves"),
];

/// Trees stay this part of the spacing apart.
const APART: f64 = 0.6;
/// Most trees of one stroke.
const MOST: usize = 500;

/// Trees that are being scattered.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TreeStroke {
    placed: Vec<Tree>,
    last_m: Option<DVec2>,
    drawn: u64,
}

impl Draft for TreeStroke {
    fn pointer(
        &mut self,
        p: &GroundPointer,
        site: &SceneryContext<'_>,
        options: &ThingState,
    ) -> DraftResponse {
        match p.phase {
            Phase::Press => {
                *self = Self::default();
                self.place(p.at_m, 0.0, options);
                self.last_m = Some(p.at_m);
                self.preview()
            }
            Phase::Drag => {
                let before = self.placed.len();
                while let Some(from_m) = self.last_m {
                    let way = p.at_m - from_m;
                    let far = options.spacing_m.max(0.5);
                    if way.length() < far || self.drawn as usize >= 4 * MOST {
                        break;
                    }
                    let next_m = from_m + way.normalize() * far;
                    self.last_m = Some(next_m);
                    self.scatter(next_m, way.normalize().perp(), site, options);
                }
                match self.placed.len() > before {
                    true => self.preview(),
                    false => DraftResponse::Nothing,
                }
            }
            Phase::Release { .. } => match self.placed.is_empty() {
                true => DraftResponse::Nothing,
                false => DraftResponse::Add(
                    std::mem::take(&mut self.placed)
                        .into_iter()
                        .map(Form::Tree)
                        .collect(),
                ),
            },
        }
    }

    fn hint(_: bool) -> Vec<&'static str> {
        vec!["Click stamps a tree", "drag scatters"]
    }

    fn coming(
        &self,
        drawing: bool,
        p: Option<GroundPointer>,
        _: &SceneryContext<'_>,
        options: &ThingState,
    ) -> Coming {
        let tree = p.filter(|_| !drawing).map(|p| Tree {
            position_m: p.at_m,
            height_m: options.tree_m,
            crown_radius_m: ThingState::crown_m(options.tree, options.tree_m),
            kind: options.tree,
        });
        Coming {
            forms: tree.map(Form::Tree).into_iter().collect(),
            ..Coming::default()
        }
    }

    fn options(hand: &Hand) -> Vec<ToolOption> {
        let things = &hand.things;
        vec![
            ToolOption::title("Tree"),
            ToolOption::text("Click stamps one, a drag scatters them beside the road."),
            ToolOption::segments("kind", things.tree, &TREES, 2),
            ToolOption::number("height", "Height, m", things.tree_m, [1.0, 25.0], 1),
            ToolOption::number("spacing", "Spacing, m", things.spacing_m, [1.5, 20.0], 1),
        ]
    }

    fn set(hand: &mut Hand, id: &str, value: Value) {
        let things = &mut hand.things;
        match id {
            "kind" => setting::take(&mut things.tree, value, &TREES),
            "height" => setting::take_number(&mut things.tree_m, value),
            "spacing" => setting::take_number(&mut things.spacing_m, value),
            _ => {}
        }
    }
}

impl TreeStroke {
    fn preview(&self) -> DraftResponse {
        DraftResponse::Preview(self.placed.iter().cloned().map(Form::Tree).collect())
    }

    /// Puts one beside the way, where there is room, no roadway and no building.
    fn scatter(&mut self, at_m: DVec2, across: DVec2, site: &SceneryContext<'_>, options: &ThingState) {
        self.drawn += 1;
        let mut draw = Draw::new(hash(self.drawn), "scattered tree");
        let jitter_m = options.spacing_m * 0.35;
        let at_m = at_m
            + across * draw.range(-jitter_m, jitter_m)
            + across.perp() * draw.range(-0.3 * jitter_m, 0.3 * jitter_m);
        let least_m = options.spacing_m * APART;
        let near = |q: &DVec2| q.distance(at_m) < least_m;
        let taken = site.trees_m.iter().any(near) || self.placed.iter().any(|t| near(&t.position_m));
        let built = site.houses_m.iter().any(|outline| is_inside(outline, at_m));
        if !taken && !built && !kerb::is_roadway(site.layout, at_m) && self.placed.len() < MOST {
            self.place(at_m, draw.range(-0.2, 0.2), options);
        }
    }

    fn place(&mut self, position_m: DVec2, taller: f64, options: &ThingState) {
        let height_m = options.tree_m * (1.0 + taller);
        self.placed.push(Tree {
            position_m,
            height_m,
            crown_radius_m: ThingState::crown_m(options.tree, height_m),
            kind: options.tree,
        });
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use scene::{BevLayer, BevLayout, Extent};

    fn stroke(to_m: DVec2, layout: &BevLayout, trees_m: &[DVec2]) -> Vec<Form> {
        stroke_by(to_m, layout, trees_m, &[])
    }

    fn stroke_by(to_m: DVec2, layout: &BevLayout, trees_m: &[DVec2], houses_m: &[Vec<DVec2>]) -> Vec<Form> {
        let options = ThingState::default();
        let site = SceneryContext {
            layout,
            trees_m,
            houses_m,
            brush_m: 3.2,
        };
        let mut draft = TreeStroke::default();
        let at = |phase, at_m| GroundPointer {
            phase,
            at_m,
            reach_m: 0.4,
            free: false,
        };
        draft.pointer(&at(Phase::Press, DVec2::ZERO), &site, &options);
        for i in 1..=10 {
            draft.pointer(&at(Phase::Drag, to_m * f64::from(i) / 10.0), &site, &options);
        }
        match draft.pointer(
            &at(
                Phase::Release {
                    clicked: to_m == DVec2::ZERO,
                },
                to_m,
            ),
            &site,
            &options,
        ) {
            DraftResponse::Add(forms) => forms,
            other => panic!("{other:?}"),
        }
    }

    #[test]
    fn a_drag_scatters_and_a_click_stamps() {
        let mut layout = BevLayout::default();
        let one = stroke(DVec2::ZERO, &layout, &[]);
        assert_eq!(one.len(), 1);
        assert_eq!(one[0].points_m(), [DVec2::ZERO]);
        let row = stroke(DVec2::X * 36.0, &layout, &[]);
        assert!((5..=7).contains(&row.len()), "{}", row.len());
        assert_eq!(row, stroke(DVec2::X * 36.0, &layout, &[]), "the same each time");
        for (i, a) in row.iter().enumerate() {
            assert_eq!(a.problem(), None);
            for b in &row[..i] {
                let apart = a.middle_m().distance(b.middle_m());
                assert!(apart >= 3.6, "{apart}");
            }
        }
        let house = [[10.0, -9.0], [50.0, -9.0], [50.0, 9.0], [10.0, 9.0]].map(DVec2::from_array);
        let before_it = stroke_by(DVec2::X * 36.0, &layout, &[], &[house.to_vec()]);
        assert!(before_it.len() < row.len() && before_it.iter().all(|f| f.middle_m().x < 10.0));
        // Not where trees stand, and not on the roadway beyond x = 20.
        let taken: Vec<DVec2> = row.iter().skip(1).take(2).map(Form::middle_m).collect();
        assert_eq!(stroke(DVec2::X * 36.0, &layout, &taken).len(), row.len() - 2);
        for x in 150..Extent::WINDOW.nx() {
            (0..Extent::WINDOW.ny()).for_each(|y| layout.set(BevLayer::DrivableArea, x, y, true));
        }
        let beside = stroke(DVec2::X * 36.0, &layout, &[]);
        assert!(!beside.is_empty() && beside.iter().all(|f| f.middle_m().x < 20.0));
    }
}
