//! The state machine of every tool for things: a press, a way and a release, or points one by one, become forms.

use std::fmt::Debug;

use glam::DVec2;

use crate::Edit;
use crate::pick;
use crate::tools::setting::{ToolOption, Value};
use crate::tools::{
    Act, At, CLICK_SLACK, Context, Cursor, Event, Hand, Hint, Key, ReadonlyContext, Response, Role,
    ScreenProjection, Tool, ToolMark, ViewKind, farthest_m, hint_of,
};
use language::tf;
use scene::{Form, Frame, Scene};

use super::{DraftResponse, GroundPointer, Phase, SceneryContext, ThingState};

/// State machine of one scenery tool while it draws.
pub(super) trait Draft: Clone + Debug + Default + Send + 'static {
    /// Takes the pointer.
    fn pointer(
        &mut self,
        p: &GroundPointer,
        site: &SceneryContext<'_>,
        options: &ThingState,
    ) -> DraftResponse;

    /// Finishes a form that is drawn point by point.
    fn finish(&mut self, options: &ThingState) -> DraftResponse {
        let _ = options;
        DraftResponse::Nothing
    }

    /// Points set so far of a form that waits for more of them.
    fn points_m(&self) -> &[DVec2] {
        &[]
    }

    /// Takes the last point back.
    fn drop_point(&mut self) {}

    /// Hint for the mouse buttons; `drawn`: points are set.
    fn hint(drawn: bool) -> Vec<&'static str>;

    /// Hint for Alt in the view from above.
    fn alt() -> Option<&'static str> {
        None
    }

    /// The preview where the pointer is; `drawing`: a form has been begun.
    fn coming(
        &self,
        drawing: bool,
        p: Option<GroundPointer>,
        site: &SceneryContext<'_>,
        options: &ThingState,
    ) -> Coming;

    /// The options of the tool.
    fn options(hand: &Hand) -> Vec<ToolOption>;

    /// The user set one.
    fn set(hand: &mut Hand, id: &str, value: Value);
}

/// Preview of a tool where the pointer is, ego frame, m.
#[derive(Default)]
pub(super) struct Coming {
    /// Forms that would be added.
    pub forms: Vec<Form>,
    /// Line that is being drawn.
    pub way_m: Vec<DVec2>,
    /// Text beside the pointer.
    pub text: Option<String>,
}

/// Lengths of the last piece and of all pieces together, as text; `None` without a piece.
pub(super) fn length(points_m: &[DVec2]) -> Option<String> {
    let pieces: Vec<f64> = points_m.windows(2).map(|p| p[0].distance(p[1])).collect();
    let last = pieces.last()?;
    Some(match pieces.len() {
        1 => format!("{last:.1} m"),
        _ => tf!(
            "{last} m  ·  {all} m in all",
            last = format!("{last:.1}"),
            all = format!("{:.1}", pieces.iter().sum::<f64>())
        ),
    })
}

/// A press that draws.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Press {
    from_m: DVec2,
    at_m: DVec2,
    reach_m: f64,
    free: bool,
    moved: bool,
}

impl Press {
    fn pointer(&self, phase: Phase) -> GroundPointer {
        GroundPointer {
            phase,
            at_m: self.at_m,
            reach_m: self.reach_m,
            free: self.free,
        }
    }
}

/// A tool for things.
#[derive(Clone, Debug, Default)]
pub(super) struct DraftTool<D> {
    draft: Option<D>,
    press: Option<Press>,
}

/// Places of the trees and outlines of the houses, ego frame, m.
fn standing(scene: &Scene) -> (Vec<DVec2>, Vec<Vec<DVec2>>) {
    let (mut trees_m, mut houses_m) = (Vec::new(), Vec::new());
    for thing in scene.background.iter() {
        match &thing.form {
            Form::Tree(tree) => trees_m.push(tree.position_m),
            Form::Building(building) => houses_m.push(building.outline_m.clone()),
            _ => {}
        }
    }
    (trees_m, houses_m)
}

/// How far on the ground the pointer may move and still click, m.
fn reach_m(view: &dyn ScreenProjection, at: DVec2, at_m: DVec2) -> f64 {
    if view.kind() == ViewKind::Bev {
        return CLICK_SLACK / view.scale();
    }
    let ground = |p| view.ray(p).and_then(|ray| pick::ray_ground(&ray, 0.0));
    match (ground(at), ground(at + DVec2::X * CLICK_SLACK)) {
        (Some(a), Some(b)) => a.distance(b).clamp(0.1, 2.0),
        _ => (at_m.length() * 0.01).clamp(0.1, 2.0),
    }
}

/// The ground under the pointer, as far as things are drawn, m.
fn near_m(cx: &Context<'_>, at: DVec2) -> Option<DVec2> {
    let (from_above, limit_m) = (cx.from_above(), farthest_m(cx.frame().extent()));
    cx.ground_m(at).filter(|p| from_above || p.length() < limit_m)
}

impl<D: Draft> DraftTool<D> {
    fn press(&mut self, cx: &Context<'_>, pointer: &crate::tools::Pointer) -> Response {
        let Some(at_m) = near_m(cx, pointer.at) else {
            return Response::none();
        };
        let things = &cx.hand.things;
        if !things.is_open() {
            let why = match things.locked {
                true => "Scenery is locked: its lock is in the list of layers",
                false => "Scenery is hidden: its eye is in the list of layers",
            };
            return Response::act(Act::Note(why.to_owned()));
        }
        let press = Press {
            from_m: at_m,
            at_m,
            reach_m: reach_m(cx.view, pointer.at, at_m),
            // In space Alt turns the camera.
            free: pointer.held.alt && cx.from_above(),
            moved: false,
        };
        self.press = Some(press);
        self.draft.get_or_insert_default();
        let mut response = self.tell(cx, press.pointer(Phase::Press));
        response.holds = true;
        response
    }

    fn drag(&mut self, cx: &Context<'_>, pointer: &crate::tools::Pointer) -> Response {
        let (Some(press), Some(at_m)) = (&mut self.press, near_m(cx, pointer.at)) else {
            return Response::none();
        };
        let was = press.at_m;
        (press.at_m, press.free) = (at_m, pointer.held.alt && cx.from_above());
        press.moved |= press.from_m.distance(at_m) > press.reach_m;
        if !press.moved || was == at_m {
            return Response::none();
        }
        let p = press.pointer(Phase::Drag);
        self.tell(cx, p)
    }

    fn tell(&mut self, cx: &Context<'_>, p: GroundPointer) -> Response {
        let (trees_m, houses_m) = standing(cx.settled);
        let site = SceneryContext {
            layout: &cx.frame().layout,
            trees_m: &trees_m,
            houses_m: &houses_m,
            brush_m: cx.hand.brush_m,
        };
        let outcome = match &mut self.draft {
            Some(draft) => draft.pointer(&p, &site, &cx.hand.things),
            // A click that ends outside the ground is not for this tool.
            None => DraftResponse::Nothing,
        };
        self.answer(outcome)
    }

    fn finish(&mut self, cx: &Context<'_>) -> Response {
        let outcome = match &mut self.draft {
            Some(draft) => draft.finish(&cx.hand.things),
            None => DraftResponse::Nothing,
        };
        let mut response = self.answer(outcome);
        response.taken = true;
        response
    }

    /// Shows or adds the drawn forms.
    fn answer(&mut self, outcome: DraftResponse) -> Response {
        match outcome {
            DraftResponse::Nothing => Response::none(),
            DraftResponse::Preview(forms) => Response::act(Act::Try(vec![Edit::AddThings { forms }])),
            DraftResponse::Add(forms) => {
                self.draft = None;
                Response::act(Act::AddThings(forms))
            }
            DraftResponse::Refused(text) => Response::act(Act::Cancel).and(Act::Note(text)),
        }
    }
}

impl<D: Draft> Tool for DraftTool<D> {
    fn event(&mut self, cx: &mut Context<'_>, event: &Event) -> Response {
        match event {
            Event::Press(pointer) => self.press(cx, pointer),
            Event::Drag(pointer) => self.drag(cx, pointer),
            Event::Release(_) => match self.press.take() {
                Some(press) => self.tell(
                    cx,
                    press.pointer(Phase::Release {
                        clicked: !press.moved,
                    }),
                ),
                None => Response::none(),
            },
            Event::Cancel => {
                self.press = None;
                if self.points_m().is_empty() {
                    self.draft = None;
                }
                Response::none()
            }
            Event::DoubleClick | Event::Key(Key::Enter, ..) => self.finish(cx),
            Event::Key(Key::Escape, ..) => {
                self.draft = None;
                Response::taken()
            }
            Event::Key(Key::Backspace, ..) => {
                if let Some(draft) = &mut self.draft {
                    draft.drop_point();
                }
                Response::taken()
            }
            Event::Pick(_) | Event::Key(..) | Event::Scroll(_) => Response::none(),
        }
    }

    fn hint(&self, hand: &Hand, view: Option<ViewKind>) -> Hint {
        if !hand.things.is_open() {
            return hint_of(&["Scenery is locked or hidden: see the list of layers"]);
        }
        let mut parts = D::hint(!self.points_m().is_empty());
        parts.extend(D::alt().filter(|_| view != Some(ViewKind::Space)));
        hint_of(&parts)
    }

    fn cursor(&self, sight: &ReadonlyContext<'_>) -> Cursor {
        match sight.hand.things.is_open() {
            true => Cursor::Crosshair,
            false => Cursor::Forbidden,
        }
    }

    fn overlay(&self, sight: &ReadonlyContext<'_>) -> Vec<ToolMark> {
        let from_above = sight.from_above();
        let layout = &sight.scene.frame().layout;
        let site = SceneryContext {
            layout,
            trees_m: &[],
            houses_m: &[],
            brush_m: sight.hand.brush_m,
        };
        let free = from_above && sight.pointer.is_some_and(|p| p.held.alt);
        let limit_m = farthest_m(sight.settled.frame().extent());
        let at_m = sight.ground_m().filter(|p| from_above || p.length() < limit_m);
        let pointer = at_m.map(|at_m| GroundPointer {
            phase: Phase::Press,
            at_m,
            reach_m: 0.0,
            free,
        });
        let none = D::default();
        let draft = self.draft.as_ref().unwrap_or(&none);
        let coming = draft.coming(self.draft.is_some(), pointer, &site, &sight.hand.things);
        let floor = |p: &DVec2| At::Ego(p.extend(layout.relief.height_m(*p) + 0.1));
        let mut out: Vec<ToolMark> = coming.forms.into_iter().map(ToolMark::Coming).collect();
        out.push(ToolMark::Line(
            coming.way_m.iter().map(floor).collect(),
            Role::Hand,
        ));
        if from_above {
            out.extend(
                self.points_m()
                    .iter()
                    .map(|p| ToolMark::Dot(floor(p), Role::Choose)),
            );
        }
        if let (Some(pointer), Some(text)) = (sight.pointer, coming.text) {
            out.push(ToolMark::Tag(At::Screen(pointer.at), text));
        }
        out
    }

    fn options(&self, hand: &Hand) -> Vec<ToolOption> {
        D::options(hand)
    }

    fn set(&mut self, hand: &mut Hand, _: &Frame, id: &str, value: Value) -> Vec<Act> {
        D::set(hand, id, value);
        Vec::new()
    }

    fn points_m(&self) -> &[DVec2] {
        self.draft.as_ref().map_or(&[], D::points_m)
    }

    fn put_down(&mut self) {
        self.draft = None;
    }

    fn restart(&mut self) {
        self.draft = None;
    }
}
