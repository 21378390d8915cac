//! The post tool: a press puts a pole, sign, light, stop, bench or bin down, facing the road; a drag turns it.

use glam::DVec2;

use crate::kerb;
use scene::Form;
use scene::background::{Post, PostKind};

use super::{Coming, Draft, DraftResponse, DraftTool, GroundPointer, Phase, SceneryContext, ThingState};
use crate::tools::setting::{Control, ToolOption, Value};
use crate::tools::{Hand, Shortcut, ToolDef, ToolGroup, ToolId, When};

/// Its name.
pub const ID: ToolId = ToolId("post_tool");

/// Its row of the table.
pub static DEF: ToolDef = ToolDef {
    id: ID,
    title: "Pole, sign, light",
    key: "Shift+P; also stops, benches, bins",
    icon: "lamp",
    group: ToolGroup::Beside,
    is_brush: false,
    paints: false,
    shortcuts: &[Shortcut {
        id: ID.0,
        title: "Pole, sign, light, bus stop, bench, bin",
        keys: "Shift+P",
        when: When::Always,
        set: |hand| hand.tool = ID,
    }],
    make: || Box::new(DraftTool::<PostDraft>::default()),
};

/// Shorter drags than this turn nothing, m.
const TURN_M: f64 = 1.5;

/// A post that is being put down.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PostDraft {
    post: Option<Post>,
}

impl Draft for PostDraft {
    fn pointer(
        &mut self,
        p: &GroundPointer,
        site: &SceneryContext<'_>,
        options: &ThingState,
    ) -> DraftResponse {
        if p.phase == Phase::Press {
            self.post = Some(placed(p, site, options));
        }
        let Some(mut post) = self.post.clone() else {
            return DraftResponse::Nothing;
        };
        let way = p.at_m - post.position_m;
        if !matches!(p.phase, Phase::Press | Phase::Release { clicked: true }) && way.length() > TURN_M {
            post.yaw_rad = way.to_angle();
        }
        match p.phase {
            Phase::Release { .. } => DraftResponse::Add(vec![Form::Post(post)]),
            _ => DraftResponse::Preview(vec![Form::Post(post)]),
        }
    }

    fn hint(_: bool) -> Vec<&'static str> {
        vec!["Click puts it down facing the road", "drag turns it"]
    }

    fn alt() -> Option<&'static str> {
        Some("Alt ignores the kerb")
    }

    fn coming(
        &self,
        drawing: bool,
        p: Option<GroundPointer>,
        site: &SceneryContext<'_>,
        options: &ThingState,
    ) -> Coming {
        let post = p.filter(|_| !drawing).map(|p| placed(&p, site, options));
        Coming {
            forms: post.map(Form::Post).into_iter().collect(),
            ..Coming::default()
        }
    }

    fn options(hand: &Hand) -> Vec<ToolOption> {
        let chosen = PostKind::ALL.iter().position(|k| *k == hand.things.post);
        vec![
            ToolOption::title("Post"),
            ToolOption::text("Click puts one down facing the road, a drag turns it."),
            ToolOption::new(
                "kind",
                Control::Rows {
                    chosen: chosen.unwrap_or(0),
                    names: PostKind::ALL.map(PostKind::name).to_vec(),
                    verb: "Place",
                },
            ),
        ]
    }

    fn set(hand: &mut Hand, id: &str, value: Value) {
        if let ("kind", Some(kind)) = (id, value.index().and_then(|i| PostKind::ALL.get(i))) {
            hand.things.post = *kind;
        }
    }
}

/// A post at the pointer, clear of the kerb if one is near, facing the road.
fn placed(p: &GroundPointer, site: &SceneryContext<'_>, options: &ThingState) -> Post {
    let kind = options.post;
    let position_m = match p.free {
        true => p.at_m,
        false => site.beside_kerb(p.at_m, clear_m(kind)),
    };
    Post {
        kind,
        position_m,
        yaw_rad: facing(site, position_m),
        height_m: kind.typical_height_m(),
    }
}

/// The heading from a place to the road, rad.
fn facing(site: &SceneryContext<'_>, at_m: DVec2) -> f64 {
    kerb::toward_road(site.layout, at_m)
}

/// How far from the kerb a post of that kind stands, m.
fn clear_m(kind: PostKind) -> f64 {
    match kind {
        PostKind::BusStop => 1.4,
        PostKind::Bench | PostKind::Stairs => 0.8,
        _ => 0.4,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use scene::{BevLayer, BevLayout, Extent};

    #[test]
    fn posts_stand_clear_of_the_kerb_and_face_the_road() {
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
        let options = ThingState::default();
        let at = |phase, y: f64| GroundPointer {
            phase,
            at_m: DVec2::new(3.0, y),
            reach_m: 0.4,
            free: false,
        };
        let mut draft = PostDraft::default();
        draft.pointer(&at(Phase::Press, 3.7), &site, &options);
        let DraftResponse::Add(forms) =
            draft.pointer(&at(Phase::Release { clicked: true }, 3.7), &site, &options)
        else {
            panic!("a post");
        };
        let Form::Post(post) = &forms[0] else {
            panic!("a post");
        };
        assert!(post.position_m.distance(DVec2::new(3.0, 4.4)) < 1e-6, "{post:?}");
        assert!(
            (post.yaw_rad + std::f64::consts::FRAC_PI_2).abs() < 1e-6,
            "{post:?}"
        );
        // A drag turns it: here away from the road.
        draft.pointer(&at(Phase::Press, 9.0), &site, &options);
        let turned = draft.pointer(&at(Phase::Release { clicked: false }, 14.0), &site, &options);
        let DraftResponse::Add(forms) = turned else {
            panic!("a post");
        };
        assert!(matches!(&forms[0], Form::Post(p) if (p.yaw_rad - std::f64::consts::FRAC_PI_2).abs() < 1e-6));
    }
}
