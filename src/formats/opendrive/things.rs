//! The objects of a file that stand beside the road, as things of the background.

use glam::DVec2;

use super::XodrRoad;
use super::layout::MapCut;
use super::objects::{Copy, ObjectKind, Repeat, RoadObject, shoelace_m2};
use super::standing::RoadsideObject;
use super::xml::{Skipped, count};
use scene::background::{Building, Facade, LineKind, Post, PostKind, Roof, SceneryLine, Shrubs, Tree};
use scene::{BevLayer, BevLayout, Form};

/// Things of one window, at most.
const MOST_THINGS: usize = 4000;
/// A thing that begins higher above the road than this hangs or lies on something, m.
const HANGS_M: f64 = 1.0;
/// A signal at a place on the road that begins higher above it than this hangs from something, m.
const OVERHEAD_M: f64 = 2.5;
/// Step along an object that runs with the road, m.
const STEP_M: f64 = 2.0;
/// Posts closer than this are one, m.
const ONE_PLACE_M: f64 = 0.5;
/// Plants per square metre of an area of shrubs.
const SHRUBS_PER_M2: f64 = 0.6;

/// Things while they are collected.
pub(super) struct SceneryCollector<'a> {
    pub window: MapCut,
    pub layout: &'a BevLayout,
    pub forms: Vec<Form>,
    pub budget: usize,
}

impl SceneryCollector<'_> {
    /// Adds the copies of one object that reach into the window; `is_on_ground` tells of a place along the road.
    pub fn object(
        &mut self,
        road: &XodrRoad,
        object: &RoadObject,
        is_on_ground: &dyn Fn(f64) -> bool,
        skipped: &mut Skipped,
    ) {
        let ObjectKind::Standing(standing) = object.kind else {
            return;
        };
        let mut budget = self.budget;
        if let RoadsideObject::Line(_) | RoadsideObject::Shrubs = standing {
            for row in object.repeats.iter().filter(|r| r.distance_m <= 0.0) {
                self.along_road(road, object, row, standing, is_on_ground, &mut budget, skipped);
            }
            if object.repeats.iter().any(|r| r.distance_m <= 0.0) {
                self.budget = budget;
                return;
            }
        }
        object.copies(&mut budget, skipped, |copy, budget, skipped| {
            *budget = budget.saturating_sub(1);
            let at_m = self.window.to_ego(road.reference.at(copy.s_m).offset(copy.t_m));
            let reach_m = copy.size_m[0].hypot(copy.size_m[1]).clamp(5.0, 200.0);
            let outlined = !object.outlines.is_empty();
            // Written so that NaN is left out too. Outlines may reach far from their object's place.
            if !(outlined || self.window.holds(at_m, reach_m)) {
                return;
            }
            let forms = forms(road, object, standing, copy, self.window);
            *budget = budget.saturating_sub(forms.iter().map(|f| f.points_m().len()).sum());
            if forms.is_empty() {
                return count(skipped, format!("{} without a usable size", standing.name()));
            }
            for form in forms {
                if !reaches_in(&self.window, &form) {
                    continue;
                }
                if matches!(standing, RoadsideObject::Signal(_))
                    && copy.lift_m > OVERHEAD_M
                    && self.over_road(at_m)
                {
                    count(skipped, "signal that hangs over the road");
                } else if copy.lift_m > HANGS_M && !matches!(standing, RoadsideObject::Signal(_)) {
                    count(
                        skipped,
                        format!("{} that does not stand on the ground", standing.name()),
                    );
                } else if !is_on_ground(copy.s_m) {
                    count(
                        skipped,
                        format!("{} on a bridge or a road left out", standing.name()),
                    );
                } else {
                    self.add(form, skipped);
                }
            }
        });
        self.budget = budget;
    }

    fn over_road(&self, at_m: DVec2) -> bool {
        self.window
            .extent
            .column_at(at_m.x, at_m.y)
            .is_some_and(|[x, y]| self.layout.has(BevLayer::DrivableArea, x, y))
    }

    /// One thing over a whole row: a line that follows the road.
    #[allow(clippy::too_many_arguments)] // all are needed, none belong together
    fn along_road(
        &mut self,
        road: &XodrRoad,
        object: &RoadObject,
        row: &Repeat,
        standing: RoadsideObject,
        is_on_ground: &dyn Fn(f64) -> bool,
        budget: &mut usize,
        skipped: &mut Skipped,
    ) {
        let kind = match standing {
            RoadsideObject::Line(kind) => kind,
            _ => LineKind::Hedge,
        };
        let from = row.s_m.max(0.0);
        let to = (row.s_m + row.run_m).min(road.length_m());
        let steps = ((to - from) / STEP_M).ceil();
        if !(1.0..1e6).contains(&steps) {
            return count(skipped, format!("{} without a usable size", standing.name()));
        }
        let first = row.along(object, 0.0);
        if first.lift_m > HANGS_M {
            return count(
                skipped,
                format!("{} that does not stand on the ground", standing.name()),
            );
        }
        let mut runs: Vec<Vec<DVec2>> = vec![Vec::new()];
        for i in 0..=steps as usize {
            *budget = budget.saturating_sub(1);
            if *budget == 0 {
                return count(skipped, "object beyond the drawing budget");
            }
            let s_m = from + (to - from) * i as f64 / steps;
            let copy = row.along(object, (s_m - row.s_m) / row.run_m);
            let point = self.window.to_ego(road.reference.at(s_m).offset(copy.t_m));
            match runs.last_mut() {
                Some(run) if is_on_ground(s_m) && point.is_finite() => run.push(point),
                Some(run) if run.is_empty() => {}
                _ => runs.push(Vec::new()),
            }
        }
        let window = self.window;
        for points_m in runs.iter().flat_map(|run| window.clipped(run, 0.0)) {
            let line = line(kind, points_m, first.height_m, first.size_m[1]);
            self.add(Form::Line(line), skipped);
        }
    }

    /// Adds a form unless it is unsound, or there is one already where it stands.
    fn add(&mut self, form: Form, skipped: &mut Skipped) {
        let name = form.name();
        if form.problem().is_some() {
            return count(skipped, format!("{name} without a usable size"));
        }
        if self.forms.len() >= MOST_THINGS {
            return count(skipped, format!("thing beyond {MOST_THINGS}"));
        }
        if let Form::Post(post) = &form
            && let Some(Form::Post(old)) = self.forms.iter_mut().find(|f| shares_place(f, post))
        {
            // A sign has a pole of its own; two signs share one.
            if old.kind == PostKind::Pole {
                *old = post.clone();
            }
            old.height_m = old.height_m.max(post.height_m);
            return;
        }
        self.forms.push(form);
    }
}

fn shares_place(form: &Form, post: &Post) -> bool {
    match form {
        Form::Post(old) => {
            let joins = |kind| matches!(kind, PostKind::Pole | PostKind::Sign | PostKind::TrafficLight);
            joins(old.kind) && joins(post.kind) && old.position_m.distance(post.position_m) < ONE_PLACE_M
        }
        _ => false,
    }
}

/// A line of these sizes; a size that is not given is the usual one of its kind. A barrier too high or wide for a rail
/// is a wall.
fn line(kind: LineKind, points_m: Vec<DVec2>, height_m: f64, width_m: f64) -> SceneryLine {
    let kind = match kind {
        LineKind::GuardRail if height_m > 1.3 || width_m > 0.8 => LineKind::Wall,
        kind => kind,
    };
    let usual = SceneryLine::typical(kind, points_m);
    SceneryLine {
        height_m: if height_m > 0.0 { height_m } else { usual.height_m },
        width_m: if width_m > 0.0 { width_m } else { usual.width_m },
        ..usual
    }
}

/// The forms of one copy in the ego frame; none if it has no usable size.
fn forms(
    road: &XodrRoad,
    object: &RoadObject,
    standing: RoadsideObject,
    copy: &Copy,
    window: MapCut,
) -> Vec<Form> {
    let base = road.reference.at(copy.s_m);
    let position_m = window.to_ego(base.offset(copy.t_m));
    let heading_rad = window.heading_to_ego(base.heading_rad);
    let given = |height_m: f64, usual_m: f64| if height_m > 0.0 { height_m } else { usual_m };
    let areas = || -> Vec<Vec<DVec2>> {
        let areas = match (object.outlines.is_empty(), object.radius_m > 0.0) {
            (true, true) => {
                let base_m = base.offset(copy.t_m);
                let corner = |i: u32| DVec2::from_angle(f64::from(i) * std::f64::consts::FRAC_PI_4);
                vec![(0..8).map(|i| base_m + corner(i) * object.radius_m).collect()]
            }
            _ => object.areas_m(&road.reference, copy),
        };
        let in_ego = areas.into_iter().map(|area| {
            let mut area: Vec<DVec2> = area.into_iter().map(|p| window.to_ego(p)).collect();
            area.dedup_by(|a, b| a.distance(*b) < 0.01);
            // A closed outline may repeat its first corner.
            if area.len() > 3 && area[0].distance(area[area.len() - 1]) < 0.01 {
                area.pop();
            }
            area
        });
        in_ego
            .filter(|a| a.len() >= 3 && shoelace_m2(a).abs() > 0.25)
            .collect()
    };
    let buildings = |height_m: f64| -> Vec<Form> {
        let building = |outline_m| {
            Form::Building(Building {
                outline_m,
                height_m,
                roof: Roof::Flat,
                facade: Facade::Plain,
            })
        };
        areas().into_iter().map(building).collect()
    };
    match standing {
        // A building of unknown height says too little.
        RoadsideObject::Building if copy.height_m > 0.0 => buildings(copy.height_m),
        RoadsideObject::Building => Vec::new(),
        RoadsideObject::Tree(kind) => {
            let height_m = given(copy.height_m + copy.lift_m.min(0.0), 7.0);
            let across_m = copy.size_m[0].min(copy.size_m[1]);
            // A radius below half a metre is the trunk's.
            let crown_radius_m = match (object.radius_m, across_m) {
                (r, _) if r >= 0.5 => r,
                (_, across_m) if across_m >= 1.0 => across_m / 2.0,
                _ => 0.28 * height_m,
            };
            vec![Form::Tree(Tree {
                position_m,
                height_m,
                crown_radius_m,
                kind,
            })]
        }
        RoadsideObject::Shrubs => {
            let height_m = given(copy.height_m, 1.2);
            let shrubs = |outline_m| {
                Form::Shrubs(Shrubs {
                    outline_m,
                    height_m,
                    per_m2: SHRUBS_PER_M2,
                })
            };
            areas().into_iter().map(shrubs).collect()
        }
        RoadsideObject::Line(kind) => lines(road, object, kind, copy, window),
        RoadsideObject::Obstacle => match buildings(given(copy.height_m, 1.0)) {
            none if none.is_empty() => {
                let height_m = given(copy.height_m, PostKind::Bin.typical_height_m());
                vec![Form::Post(Post {
                    kind: PostKind::Bin,
                    position_m,
                    yaw_rad: 0.0,
                    height_m,
                })]
            }
            some => some,
        },
        RoadsideObject::Post(kind) => {
            // Most files give no heading: then it faces the road.
            let to_road_rad = heading_rad - copy.t_m.signum() * std::f64::consts::FRAC_PI_2;
            let yaw_rad = match object.heading_rad {
                0.0 => to_road_rad,
                turn => heading_rad + turn,
            };
            vec![Form::Post(Post {
                kind,
                position_m,
                yaw_rad,
                height_m: given(copy.height_m + copy.lift_m.min(0.0), kind.typical_height_m()),
            })]
        }
        RoadsideObject::Signal(kind) => {
            let top_m = copy.lift_m + copy.height_m;
            vec![Form::Post(Post {
                kind,
                position_m,
                yaw_rad: heading_rad + object.heading_rad,
                height_m: if top_m > 0.8 {
                    top_m
                } else {
                    kind.typical_height_m()
                },
            })]
        }
    }
}

/// A wall, fence or rail: along the longer side of a slim outline, around a wide one; without an outline along its
/// heading, as long as it is.
fn lines(road: &XodrRoad, object: &RoadObject, kind: LineKind, copy: &Copy, window: MapCut) -> Vec<Form> {
    let mut out = Vec::new();
    for area in object.areas_m(&road.reference, copy) {
        let area: Vec<DVec2> = area.into_iter().map(|p| window.to_ego(p)).collect();
        let side = |i: usize| area[i].distance(area[(i + 1) % area.len()]);
        let middle = |i: usize| 0.5 * (area[i] + area[(i + 1) % area.len()]);
        let slim = match area.len() {
            4 if side(0) + side(2) > 3.0 * (side(1) + side(3)) => Some((1, side(1))),
            4 if side(1) + side(3) > 3.0 * (side(0) + side(2)) => Some((0, side(0))),
            _ => None,
        };
        let (points_m, width_m) = match slim {
            Some((end, width_m)) => (vec![middle(end), middle(end + 2)], width_m),
            None => (area.iter().chain(area.first()).copied().collect(), 0.0),
        };
        for points_m in window.clipped(&points_m, 20.0) {
            out.push(Form::Line(line(kind, points_m, copy.height_m, width_m)));
        }
    }
    out
}

/// True if a form reaches into the map.
fn reaches_in(window: &MapCut, form: &Form) -> bool {
    let (min, max) = form.bounds_m();
    window.meets(min, max)
}
