//! The shrub tool: a stroke of a brush becomes the outline of an area.

use glam::DVec2;

use editor::outline;
use scene::Form;
use scene::background::Shrubs;

use super::{Outcome, Phase, Pointer, Site, ThingState};

/// Plants per square metre.
const PER_M2: f64 = 0.5;
/// Points of a stroke are this far apart, m.
const STEP_M: f64 = 0.3;

/// A stroke that is being drawn.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ShrubStroke {
    points_m: Vec<DVec2>,
}

impl ShrubStroke {
    /// Takes the pointer.
    pub fn pointer(&mut self, p: &Pointer, site: &Site<'_>, options: &ThingState) -> Outcome {
        if p.phase == Phase::Press {
            self.points_m.clear();
        }
        if self.points_m.last().is_none_or(|q| q.distance(p.at_m) >= STEP_M) {
            self.points_m.push(p.at_m);
        } else if p.phase == Phase::Drag {
            return Outcome::Nothing;
        }
        let area = outline::of_stroke(&self.points_m, site.brush_m).map(|outline_m| {
            Form::Shrubs(Shrubs {
                outline_m,
                height_m: options.shrubs_m,
                per_m2: PER_M2,
            })
        });
        let area = area.filter(|form| form.problem().is_none());
        match (p.phase, area) {
            (Phase::Release { .. }, Some(form)) => Outcome::Add(vec![form]),
            (Phase::Release { .. }, None) => Outcome::Refused("The stroke lies outside the map".to_owned()),
            (_, form) => Outcome::Preview(form.into_iter().collect()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use editor::choose::is_inside;

    #[test]
    fn a_stroke_becomes_an_area() {
        let (mut draft, options) = (ShrubStroke::default(), ThingState::default());
        let at = |phase, x, y| Pointer {
            phase,
            at_m: DVec2::new(x, y),
            reach_m: 0.4,
            free: false,
        };
        let site = Site {
            layout: &Default::default(),
            trees_m: &[],
            houses_m: &[],
            brush_m: 3.2,
        };
        draft.pointer(&at(Phase::Press, 0.0, 8.0), &site, &options);
        for i in 1..=20 {
            draft.pointer(&at(Phase::Drag, f64::from(i) * 0.5, 8.0), &site, &options);
        }
        let Outcome::Add(forms) =
            draft.pointer(&at(Phase::Release { clicked: false }, 10.0, 8.0), &site, &options)
        else {
            panic!("an area");
        };
        assert_eq!(forms[0].problem(), None);
        let outline = forms[0].points_m();
        assert!(is_inside(&outline, DVec2::new(5.0, 9.2)) && !is_inside(&outline, DVec2::new(5.0, 10.4)));
        draft.pointer(&at(Phase::Press, 200.0, 8.0), &site, &options);
        let outside = draft.pointer(&at(Phase::Release { clicked: true }, 200.0, 8.0), &site, &options);
        assert!(matches!(outside, Outcome::Refused(_)));
    }
}
