//! Outline that is set corner by corner, to choose the objects in it.

use glam::DVec2;

use super::{
    At, CLICK_SLACK, Context, Event, Key, Modifiers, Pointer, ReadonlyContext, Role, ToolMark, ViewKind,
};

/// A click so near to the first corner closes the outline, points of the screen.
const CORNER: f64 = 8.0;

/// The corners set so far.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct PolygonDraft {
    /// Points of the ego frame, m, in the view from above; points of the screen in the 3D view.
    points: Vec<DVec2>,
    /// The view in which they were set.
    view: Option<ViewKind>,
    /// Modifier keys held when the first corner was set.
    held: Modifiers,
}

/// Effect of an event on the corners.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Set {
    /// None: the event is not for the outline.
    Not,
    /// A corner was added or removed.
    Taken,
    /// The outline is closed; the modifier keys are those held when it was begun.
    Closed(Vec<DVec2>, Modifiers),
}

impl PolygonDraft {
    pub(super) fn is_empty(&self) -> bool {
        self.points.is_empty()
    }

    pub(super) fn clear(&mut self) {
        self.points.clear();
    }

    /// The view in which they were set; none if there are none.
    pub(super) fn view(&self) -> Option<ViewKind> {
        self.view.filter(|_| !self.is_empty())
    }

    /// A click sets a corner; one in another view begins anew, and one on the first corner closes the outline.
    pub(super) fn add(&mut self, cx: &Context<'_>, pointer: &Pointer) -> Set {
        let from_above = cx.from_above();
        let Some(at) = (match from_above {
            true => cx.ground_m(pointer.at),
            false => Some(pointer.at),
        }) else {
            return Set::Not;
        };
        if self.view != Some(cx.view.kind()) {
            self.clear();
        }
        if self.is_empty() {
            (self.view, self.held) = (Some(cx.view.kind()), pointer.held);
        }
        // The second half of a double click is no corner.
        let per_point = if from_above { cx.view.scale() } else { 1.0 };
        let (near, on_it) = (CLICK_SLACK / per_point, CORNER / per_point);
        if self.points.len() >= 3 && self.points[0].distance(at) <= on_it {
            return self.close();
        }
        if self.points.last().is_none_or(|last| last.distance(at) > near) {
            self.points.push(at);
        }
        Set::Taken
    }

    fn close(&mut self) -> Set {
        let points = std::mem::take(&mut self.points);
        match points.len() {
            0..3 => Set::Taken,
            _ => Set::Closed(points, self.held),
        }
    }

    /// Enter and a double click close the outline, Backspace takes a corner back, Escape all of them.
    pub(super) fn event(&mut self, event: &Event) -> Set {
        if self.is_empty() {
            return Set::Not;
        }
        match event {
            Event::DoubleClick | Event::Key(Key::Enter, ..) => self.close(),
            Event::Key(Key::Escape, ..) => {
                self.clear();
                Set::Taken
            }
            Event::Key(Key::Backspace, ..) => {
                self.points.pop();
                Set::Taken
            }
            _ => Set::Not,
        }
    }

    /// The outline with the pointer as its next corner, and its corners, in the view in which it was begun.
    pub(super) fn marks(&self, sight: &ReadonlyContext<'_>) -> Vec<ToolMark> {
        let from_above = sight.from_above();
        if self.view() != Some(sight.view.kind()) {
            return Vec::new();
        }
        let next = match from_above {
            true => sight.ground_m(),
            false => sight.pointer.map(|p| p.at),
        };
        let corners = self.points.iter().copied().chain(next);
        let closed = corners.chain(self.points.first().copied());
        let at = |p: DVec2| match from_above {
            true => At::from(p),
            false => At::Screen(p),
        };
        let mut out = vec![ToolMark::Dashed(closed.map(at).collect(), Role::Choose)];
        out.extend(self.points.iter().map(|p| ToolMark::Dot(at(*p), Role::Choose)));
        out
    }
}
