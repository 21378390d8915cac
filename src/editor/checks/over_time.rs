//! What moving objects do in the course of a clip: too fast, too sudden, backwards, into each other, through walls, off the
//! map.

use std::collections::BTreeMap;

use super::geometry::{area_m2, shared_area_m2, shared_height_m};
use super::{Context, Finding, Findings, Fix, Severity, name_of};
use crate::reaching::reaching;
use glam::DVec2;
use language::{t, tf};
use scene::raster::box_cells;
use scene::{BoxId, Class, Extent, Motion, SceneBox};

pub const TOO_FAST: &str = "too_fast";
pub const TOO_SUDDEN: &str = "too_sudden";
pub const BACKWARDS: &str = "backwards";
pub const COLLISION: &str = "collision";
pub const THROUGH_WALL: &str = "through_wall";
pub const LEAVES_MAP: &str = "leaves_map";

/// Time between two moments that are looked at, s; longer in a long clip.
const STEP_S: f64 = 0.1;
/// Most moments that are looked at.
const MOST_STEPS: usize = 600;
/// Speed against the heading that is driving backwards, m/s, and for how long, s.
const BACKWARDS_MPS: f64 = 1.0;
const BACKWARDS_S: f64 = 1.0;
/// Boxes may share this part of the smaller footprint for a moment: labels are not exact.
const TOLERATED_SHARE: f64 = 0.05;
const TOLERATED_HEIGHT_M: f64 = 0.2;
/// From here on neither can be where it is.
const WRONG_SHARE: f64 = 0.3;

/// Highest speed of a class, m/s, and its hardest acceleration, m/s².
fn limits(class: Class) -> (f64, f64) {
    match class {
        Class::Pedestrian => (9.0, 6.0),
        Class::Bicycle => (18.0, 6.0),
        Class::Motorcycle => (70.0, 11.0),
        Class::Bus | Class::Truck | Class::Trailer => (36.0, 8.0),
        Class::ConstructionVehicle => (20.0, 5.0),
        Class::Barrier | Class::TrafficCone => (0.5, 1.0),
        _ => (70.0, 11.0),
    }
}

/// Something that moves, at every moment that is looked at; `None` while it is not there. The ego vehicle has no id.
pub(super) struct Trace {
    id: Option<BoxId>,
    at: Vec<Option<SceneBox>>,
    /// It does not move by itself.
    attached: Option<BoxId>,
}

/// The moments that are looked at, and everything that moves at each.
pub(super) struct OverTime {
    times_s: Vec<f64>,
    traces: Vec<Trace>,
}

impl OverTime {
    pub(super) fn of(context: &Context<'_>) -> Self {
        let (scene, clip) = (context.scene, context.scene.clip());
        if clip.stands() || clip.problem().is_some() {
            return Self {
                times_s: Vec::new(),
                traces: Vec::new(),
            };
        }
        let steps = ((clip.length_s / STEP_S).ceil() as usize).clamp(1, MOST_STEPS);
        let times_s: Vec<f64> = (0..=steps)
            .map(|i| clip.length_s * i as f64 / steps as f64)
            .collect();
        let relief = &scene.canvas().layout.relief;
        let mut traces: Vec<Trace> = clip
            .tracks
            .iter()
            .map(|(id, track)| Trace {
                id: Some(*id),
                at: times_s.iter().map(|t| clip.box_at(*id, *t, relief)).collect(),
                attached: match track.motion {
                    Motion::Attached { to, .. } => Some(to),
                    _ => None,
                },
            })
            .collect();
        if clip.ego.is_some() {
            let ego = |t: &f64| {
                let pose = clip.ego_at(*t, &scene.canvas().world_from_ego, relief);
                let moving = clip.ego_moving(*t)?;
                Some(SceneBox {
                    id: BoxId(0),
                    class: Class::Car,
                    center_m: pose.apply(scene.rig.ego_center_m.into()),
                    size_m: scene.rig.ego_size_m.into(),
                    yaw_rad: moving.yaw_rad,
                    velocity_mps: moving.velocity_mps,
                    label: Default::default(),
                })
            };
            traces.push(Trace {
                id: None,
                at: times_s.iter().map(ego).collect(),
                attached: None,
            });
        }
        Self { times_s, traces }
    }

    fn moments<'a>(&'a self, trace: &'a Trace) -> impl Iterator<Item = (f64, &'a SceneBox)> + 'a {
        let moments = self.times_s.iter().zip(&trace.at);
        moments.filter_map(|(t, b)| b.as_ref().map(|b| (*t, b)))
    }
}

fn called(trace: &Trace, b: &SceneBox) -> String {
    match trace.id {
        Some(_) => name_of(b),
        None => t("the ego vehicle").to_owned(),
    }
}

fn finding(
    check: &'static str,
    severity: Severity,
    (trace, time_s, b): (&Trace, f64, &SceneBox),
    text: String,
) -> Finding {
    Finding {
        check,
        severity,
        where_m: b.center_m,
        time_s: Some(time_s),
        box_id: trace.id,
        cells: Vec::new(),
        text,
        fixes: Vec::new(),
    }
}

pub fn too_fast(context: &Context<'_>, out: &mut Findings) {
    let over_time = context.over_time();
    for trace in &over_time.traces {
        let speed = |b: &SceneBox| b.velocity_mps.length();
        let fastest = over_time
            .moments(trace)
            .max_by(|a, b| speed(a.1).total_cmp(&speed(b.1)));
        let Some((time_s, b)) = fastest.filter(|(_, b)| speed(b) > limits(b.class).0) else {
            continue;
        };
        let text = tf!(
            "{thing} drives {speed} km/h at {time} s, at most {most} can be",
            thing = called(trace, b),
            speed = format!("{:.0}", speed(b) * 3.6),
            time = format!("{time_s:.1}"),
            most = format!("{:.0}", limits(b.class).0 * 3.6)
        );
        out.push(finding(TOO_FAST, Severity::Error, (trace, time_s, b), text));
    }
}

pub fn too_sudden(context: &Context<'_>, out: &mut Findings) {
    let over_time = context.over_time();
    for trace in over_time.traces.iter().filter(|t| t.attached.is_none()) {
        let moments: Vec<(f64, &SceneBox)> = over_time.moments(trace).collect();
        // Over two steps: a keyframe's own kink is no jerk of the object.
        let change = |w: &[(f64, &SceneBox)]| {
            let (a, b) = (w[0], w[w.len() - 1]);
            (b.1.velocity_mps - a.1.velocity_mps).length() / (b.0 - a.0).max(1e-9)
        };
        let hardest = moments.windows(4).max_by(|a, b| change(a).total_cmp(&change(b)));
        let Some(w) = hardest.filter(|w| change(w) > limits(w[1].1.class).1) else {
            continue;
        };
        let (time_s, b) = w[1];
        let text = tf!(
            "{thing} changes its speed by {change} m/s² at {time} s, at most {most} can be",
            thing = called(trace, b),
            change = format!("{:.0}", change(w)),
            time = format!("{time_s:.1}"),
            most = format!("{:.0}", limits(b.class).1)
        );
        out.push(finding(TOO_SUDDEN, Severity::Warning, (trace, time_s, b), text));
    }
}

pub fn backwards(context: &Context<'_>, out: &mut Findings) {
    let over_time = context.over_time();
    for trace in &over_time.traces {
        let mut since_s = None;
        for (time_s, b) in over_time.moments(trace) {
            let back = b.velocity_mps.dot(b.heading()) < -BACKWARDS_MPS && b.class != Class::Pedestrian;
            if !back {
                since_s = None;
                continue;
            }
            let since = *since_s.get_or_insert(time_s);
            if time_s - since > BACKWARDS_S {
                let text = tf!(
                    "{thing} drives backwards from {time} s on",
                    thing = called(trace, b),
                    time = format!("{since:.1}")
                );
                out.push(finding(BACKWARDS, Severity::Warning, (trace, since, b), text));
                break;
            }
        }
    }
}

pub fn collision(context: &Context<'_>, out: &mut Findings) {
    let over_time = context.over_time();
    let standing: Vec<SceneBox> = context.scene.canvas().boxes.values().copied().collect();
    for (i, trace) in over_time.traces.iter().enumerate() {
        // When each other one is met first, and the largest share of area while they do.
        let mut met: BTreeMap<Option<BoxId>, (Finding, f64)> = BTreeMap::new();
        for (at, time_s) in over_time.times_s.iter().enumerate() {
            let Some(b) = &trace.at[at] else { continue };
            let moving = over_time.traces[i + 1..].iter().filter_map(|other| {
                let tied = other.attached == trace.id && other.attached.is_some()
                    || trace.attached == other.id && trace.attached.is_some();
                (!tied).then_some((other.id, other.at[at].as_ref()?))
            });
            let others = moving.chain(standing.iter().map(|s| (Some(s.id), s)));
            for (other_id, other) in others {
                let reach = (b.size_m.truncate().length() + other.size_m.truncate().length()) / 2.0;
                let (pa, pb) = (b.center_m.truncate(), other.center_m.truncate());
                if pa.distance_squared(pb) >= reach * reach || shared_height_m(b, other) <= TOLERATED_HEIGHT_M
                {
                    continue;
                }
                let share = shared_area_m2(b, other) / area_m2(b).min(area_m2(other));
                if share <= TOLERATED_SHARE {
                    continue;
                }
                let (first, most) = met.entry(other_id).or_insert_with(|| {
                    let other_name =
                        other_id.map_or_else(|| t("the ego vehicle").to_owned(), |_| name_of(other));
                    let text = tf!(
                        "{first} and {second} meet at {time} s",
                        first = called(trace, b),
                        second = other_name,
                        time = format!("{time_s:.1}")
                    );
                    let here = (trace, *time_s, b);
                    (finding(COLLISION, Severity::Warning, here, text), share)
                });
                *most = most.max(share);
                if *most > WRONG_SHARE {
                    first.severity = Severity::Error;
                }
            }
        }
        met.into_values().for_each(|(first, _)| out.push(first));
    }
}

pub fn through_wall(context: &Context<'_>, out: &mut Findings) {
    let over_time = context.over_time();
    let canvas = context.scene.canvas();
    let (extent, relief) = (canvas.extent(), &canvas.layout.relief);
    for trace in &over_time.traces {
        let hits = |b: &SceneBox| {
            let core = SceneBox {
                size_m: b.size_m * 0.8,
                ..*b
            };
            let mut met = None;
            box_cells(extent, &core, 0.0, |x, y| {
                let ground_m = relief.column_m(x, y);
                // What a bumper meets, and not what hangs over the road.
                for up in [0.9, 1.3] {
                    let p = extent.center(x, y, 0).with_z(ground_m + up);
                    let label = extent.voxel_at(p).map(|[x, y, z]| canvas.occupancy.get(x, y, z));
                    let class = label.and_then(Class::from_id);
                    let solid = |c: &Class| matches!(c, Class::Manmade | Class::Vegetation | Class::Barrier);
                    met = met.or(class.filter(solid));
                }
            });
            met
        };
        let mut moments = over_time.moments(trace);
        let met = moments.find_map(|(t, b)| hits(b).map(|class| (t, *b, class)));
        if let Some((time_s, b, class)) = met {
            let text = tf!(
                "{thing} drives through {class} at {time} s",
                thing = called(trace, &b),
                class = t(&class.label()),
                time = format!("{time_s:.1}")
            );
            out.push(finding(THROUGH_WALL, Severity::Error, (trace, time_s, &b), text));
        }
    }
}

pub fn leaves_map(context: &Context<'_>, out: &mut Findings) {
    let over_time = context.over_time();
    let extent: Extent = context.scene.canvas().extent();
    for trace in &over_time.traces {
        let off = |b: &SceneBox| extent.column_at(b.center_m.x, b.center_m.y).is_none();
        let mut moments = over_time.moments(trace);
        if let Some((time_s, b)) = moments.find(|(_, b)| off(b)) {
            let text = tf!(
                "{thing} leaves the map at {time} s",
                thing = called(trace, b),
                time = format!("{time_s:.1}")
            );
            let places = over_time.moments(trace).map(|(_, b)| b.center_m.truncate());
            out.push(Finding {
                fixes: vec![Fix {
                    label: "Extend the map",
                    edits: reaching(extent, places, [DVec2::ZERO; 2]).into_iter().collect(),
                }],
                ..finding(LEAVES_MAP, Severity::Warning, (trace, time_s, b), text)
            });
        }
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;
    use std::sync::Arc;

    use glam::{DVec2, DVec3};
    use scene::clip::{Path, Speed};
    use scene::{BevLayout, Frame, Key, Scene, SensorRig, VoxelGrid};

    use super::*;
    use crate::Apply;
    use crate::Edit;
    use crate::checks::run_checks;

    /// Cars 1 (moving as given) and 2 (standing 30 m ahead), a wall 50 m ahead.
    fn found(motion: Motion, ego: bool) -> BTreeMap<&'static str, (String, f64)> {
        let extent = Extent::new([-50, -50], [300, 100]).expect("sound");
        let car = |id: u32, x: f64| SceneBox {
            id: BoxId(id),
            class: Class::Car,
            center_m: DVec3::new(x, 0.0, 0.8),
            size_m: DVec3::new(4.5, 1.9, 1.6),
            yaw_rad: 0.0,
            velocity_mps: DVec2::ZERO,
            label: Default::default(),
        };
        let mut grid = VoxelGrid::over(extent);
        let [x, _] = extent.column_at(50.0, 0.0).expect("inside");
        (0..100).for_each(|y| (0..9).for_each(|z| grid.set(x, y, z, Class::Manmade.id())));
        let boxes = [car(1, 0.0), car(2, 30.0)].map(|b| (b.id, b));
        let frame = Frame::new(BevLayout::over(extent), boxes.into(), grid);
        let mut scene = Scene::single("clip", frame, Arc::new(SensorRig::default()), 1);
        let set = Edit::SetMotion {
            id: (!ego).then_some(BoxId(1)),
            motion: Some(motion),
            from_s: None,
            to_s: None,
        };
        set.apply(&mut scene).expect("sound");
        let of_time = |f: Finding| f.time_s.map(|t| (f.check, (f.text, t)));
        run_checks(&scene, None).into_iter().filter_map(of_time).collect()
    }

    fn path(to: [f64; 2], speeds: &[(f64, f64)], rear_first: bool) -> Motion {
        Motion::Path(Path {
            points_m: vec![DVec2::ZERO, to.into()],
            start_m: 0.0,
            speeds: speeds
                .iter()
                .map(|&(time_s, mps)| Speed { time_s, mps })
                .collect(),
            rear_first,
        })
    }

    #[test]
    fn what_a_motion_does_wrong_is_found_with_its_time() {
        // Gently, past the standing car.
        let fine = found(path([0.0, 15.0], &[(0.0, 0.0), (3.0, 5.0)], false), false);
        assert_eq!(fine, BTreeMap::new());
        let ahead = found(path([90.0, 0.0], &[(0.0, 10.0), (8.0, 10.0)], false), false);
        let (text, time_s) = &ahead[COLLISION];
        assert!(
            text.contains("car 1 and car 2 meet at 2.6 s") && (2.5..2.7).contains(time_s),
            "{text}"
        );
        assert!(
            ahead[THROUGH_WALL].0.contains("drives through manmade at 4.9 s"),
            "{:?}",
            ahead[THROUGH_WALL]
        );
        let fast = found(path([90.0, 0.0], &[(0.0, 90.0), (0.5, 90.0)], false), false);
        assert!(fast[TOO_FAST].0.contains("324 km/h"), "{fast:?}");
        let sudden = found(
            path(
                [20.0, 12.0],
                &[(0.0, 20.0), (0.5, 20.0), (0.7, 0.0), (2.0, 0.0)],
                false,
            ),
            false,
        );
        assert!(
            sudden[TOO_SUDDEN].0.contains("car 1 changes its speed by"),
            "{sudden:?}"
        );
        let back = found(path([-15.0, 4.0], &[(0.0, 2.0), (5.0, 2.0)], true), false);
        assert!(back[BACKWARDS].0.contains("backwards from 0.0 s on"), "{back:?}");
        let key = |time_s: f64, x: f64| Key {
            time_s,
            at_m: DVec2::new(x, 12.0),
            yaw_deg: 0.0,
        };
        let off = found(Motion::Keys(vec![key(0.0, 0.0), key(6.0, -60.0)]), true);
        assert!(
            off[LEAVES_MAP].0.contains("the ego vehicle leaves the map at"),
            "{off:?}"
        );
    }
}
