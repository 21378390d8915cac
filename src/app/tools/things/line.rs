//! The line tool: points of a hedge, wall, fence or rail, beside the kerb where one is near.

use glam::DVec2;

use scene::Form;

use super::{Outcome, Phase, Pointer, Site, ThingState};

/// A line that is being drawn.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct LineDraft {
    /// Points so far, ego frame, m.
    pub points_m: Vec<DVec2>,
    pressed: bool,
}

impl LineDraft {
    /// Takes the pointer: each click sets a point, a drag sets two.
    pub fn pointer(&mut self, p: &Pointer, site: &Site<'_>, options: &ThingState) -> Outcome {
        match p.phase {
            Phase::Press => {
                self.pressed = true;
                self.set(p, site, options);
            }
            Phase::Release { clicked: false } if self.pressed => self.set(p, site, options),
            _ => {}
        }
        if matches!(p.phase, Phase::Release { .. }) {
            self.pressed = false;
        }
        Outcome::Nothing
    }

    fn set(&mut self, p: &Pointer, site: &Site<'_>, options: &ThingState) {
        let at_m = snapped(p, site, options);
        // The second click of a double click sets none.
        if self.points_m.last().is_none_or(|q| q.distance(at_m) > p.reach_m) {
            self.points_m.push(at_m);
        }
    }

    /// Ends the line.
    pub fn finish(&mut self, options: &ThingState) -> Outcome {
        if self.points_m.len() < 2 {
            return Outcome::Refused(format!("A {} needs two points or more", options.line.name()));
        }
        let form = Form::Line(options.line_of(self.points_m.clone()));
        match form.problem() {
            Some(problem) => Outcome::Refused(problem),
            None => Outcome::Add(vec![form]),
        }
    }
}

/// Where a point comes to lie: clear of the kerb by half the width of the line.
pub fn snapped(p: &Pointer, site: &Site<'_>, options: &ThingState) -> DVec2 {
    match p.free {
        true => p.at_m,
        false => site.beside_kerb(p.at_m, options.line.typical_m().1 / 2.0),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use scene::background::LineKind;
    use scene::{BevLayer, BevLayout, GridSpec};

    #[test]
    fn points_lie_beside_the_kerb_unless_alt_is_held() {
        let mut layout = BevLayout::default();
        for x in 0..GridSpec::NX {
            (0..110).for_each(|y| layout.set(BevLayer::DrivableArea, x, y, true)); // up to y = 4
        }
        let site = Site {
            layout: &layout,
            trees_m: &[],
            houses_m: &[],
            brush_m: 3.2,
        };
        let mut options = ThingState::default();
        options.take_line(LineKind::Wall);
        let mut draft = LineDraft::default();
        let mut click = |x, y, free| {
            let p = |phase| Pointer {
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
        let Outcome::Add(forms) = draft.finish(&options) else {
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
        assert_eq!(short, Outcome::Refused("A wall needs two points or more".into()));
    }
}
