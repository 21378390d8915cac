//! Checks of moving objects over the course of a clip: too fast, too sudden, backwards, into each other, through walls,
//! off the map.

use std::collections::BTreeMap;

use super::geometry::{area_m2, shared_area_m2, shared_height_m};
use super::locomotion::{Locomotion, locomotion_of};
use super::{Context, Finding, Findings, Fix, Severity, name_of};
use crate::reaching::reaching;
use crate::traffic::gap::ego_box;
use glam::DVec2;
use language::{filled, t, tf};
use scene::grid::NOT_PAINTED;
use scene::raster::box_cells;
use scene::{BoxId, Class, Extent, Motion, Recorded, SceneBox};

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
/// Speed against the heading above which an object moves backwards, m/s.
const BACKWARDS_MPS: f64 = 1.0;
/// Time for which an object may move backwards, s.
const BACKWARDS_S: f64 = 1.0;
/// Share of the smaller footprint that two boxes may have in common: labels are not exact.
const TOLERATED_SHARE: f64 = 0.05;
/// Height that two boxes may have in common, m.
const TOLERATED_HEIGHT_M: f64 = 0.2;
/// Share of the smaller footprint in common; above this share it is an error.
const ERROR_SHARE: f64 = 0.3;

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

/// The boxes of one moving object at all sampled moments; `None` while it is not there. The ego vehicle has no id.
pub(super) struct SampledTrack {
    id: Option<BoxId>,
    at: Vec<Option<SceneBox>>,
    /// The box that carries it, if it does not move by itself.
    attached: Option<BoxId>,
    /// True if it moves as in a recording.
    recorded: bool,
}

/// The sampled moments, and every moving object at each of them.
pub(super) struct OverTime {
    times_s: Vec<f64>,
    tracks: Vec<SampledTrack>,
    /// True if the ego vehicle is where a recording has it.
    ego_recorded: bool,
}

impl OverTime {
    pub(super) fn from_context(context: &Context<'_>) -> Self {
        Self::of_scene(context.scene)
    }

    fn of_scene(scene: &scene::Scene) -> Self {
        let clip = scene.clip();
        if clip.stands() || clip.problem().is_some() {
            return Self {
                times_s: Vec::new(),
                tracks: Vec::new(),
                ego_recorded: false,
            };
        }
        let steps = ((clip.length_s / STEP_S).ceil() as usize).clamp(1, MOST_STEPS);
        let times_s: Vec<f64> = (0..=steps)
            .map(|i| clip.length_s * i as f64 / steps as f64)
            .collect();
        let relief = &scene.canvas().layout.relief;
        let (recorded, ego_recorded) = (Recorded::boxes_in(scene), Recorded::is_ego_in(scene));
        let mut tracks: Vec<SampledTrack> = clip
            .tracks
            .iter()
            .map(|(id, track)| SampledTrack {
                id: Some(*id),
                at: times_s.iter().map(|t| clip.box_at(*id, *t, relief)).collect(),
                attached: match track.motion {
                    Motion::Attached { to, .. } => Some(to),
                    _ => None,
                },
                recorded: recorded.contains(id),
            })
            .collect();
        if clip.ego.is_some() {
            tracks.push(SampledTrack {
                id: None,
                at: times_s.iter().map(|t| Some(ego_box(scene, *t))).collect(),
                attached: None,
                recorded: ego_recorded,
            });
        }
        Self {
            times_s,
            tracks,
            ego_recorded,
        }
    }

    fn moments<'a>(&'a self, track: &'a SampledTrack) -> impl Iterator<Item = (f64, &'a SceneBox)> + 'a {
        let moments = self.times_s.iter().zip(&track.at);
        moments.filter_map(|(t, b)| b.as_ref().map(|b| (*t, b)))
    }
}

fn called(track: &SampledTrack, b: &SceneBox) -> String {
    match track.id {
        Some(_) => name_of(b),
        None => t("the ego vehicle").to_owned(),
    }
}

/// Finding about a box of a track at a moment: [`Severity::Info`] for recorded objects.
fn finding(
    check: &'static str,
    severity: Severity,
    (track, time_s, b): (&SampledTrack, f64, &SceneBox),
    text: String,
) -> Finding {
    Finding {
        check,
        severity: match track.recorded {
            true => Severity::Info,
            false => severity,
        },
        where_m: b.center_m,
        time_s: Some(time_s),
        box_id: track.id,
        cells: Vec::new(),
        text,
        fixes: Vec::new(),
    }
}

pub fn too_fast(context: &Context<'_>, out: &mut Findings) {
    let over_time = context.over_time();
    for track in &over_time.tracks {
        let speed = |b: &SceneBox| b.velocity_mps.length();
        let fastest = over_time
            .moments(track)
            .max_by(|a, b| speed(a.1).total_cmp(&speed(b.1)));
        let Some((time_s, b)) = fastest.filter(|(_, b)| speed(b) > limits(b.class).0) else {
            continue;
        };
        let says = match locomotion_of(b.class) {
            Locomotion::Drives => t("{thing} drives {speed} km/h at {time} s, at most {most} can be"),
            _ => t("{thing} moves at {speed} km/h at {time} s, at most {most} can be"),
        };
        let text = filled(
            says,
            &[
                ("thing", &called(track, b)),
                ("speed", &format!("{:.0}", speed(b) * 3.6)),
                ("time", &format!("{time_s:.1}")),
                ("most", &format!("{:.0}", limits(b.class).0 * 3.6)),
            ],
        );
        out.push(finding(TOO_FAST, Severity::Error, (track, time_s, b), text));
    }
}

pub fn too_sudden(context: &Context<'_>, out: &mut Findings) {
    let over_time = context.over_time();
    for track in over_time.tracks.iter().filter(|t| t.attached.is_none()) {
        let moments: Vec<(f64, &SceneBox)> = over_time.moments(track).collect();
        // Over three steps: the sudden change of speed at a keyframe is no fault of the object.
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
            thing = called(track, b),
            change = format!("{:.0}", change(w)),
            time = format!("{time_s:.1}"),
            most = format!("{:.0}", limits(b.class).1)
        );
        out.push(finding(TOO_SUDDEN, Severity::Warning, (track, time_s, b), text));
    }
}

pub fn backwards(context: &Context<'_>, out: &mut Findings) {
    let over_time = context.over_time();
    for track in &over_time.tracks {
        let mut since_s = None;
        for (time_s, b) in over_time.moments(track) {
            let back = b.velocity_mps.dot(b.heading()) < -BACKWARDS_MPS && b.class != Class::Pedestrian;
            if !back {
                since_s = None;
                continue;
            }
            let since = *since_s.get_or_insert(time_s);
            if time_s - since > BACKWARDS_S {
                let says = match locomotion_of(b.class) {
                    Locomotion::Drives => t("{thing} drives backwards from {time} s on"),
                    _ => t("{thing} moves backwards from {time} s on"),
                };
                let time = format!("{since:.1}");
                let text = filled(says, &[("thing", &called(track, b)), ("time", &time)]);
                out.push(finding(BACKWARDS, Severity::Warning, (track, since, b), text));
                break;
            }
        }
    }
}

/// Other side of a collision.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum CollisionPartner {
    /// Another object, moving or standing.
    Box(BoxId),
    /// The ego vehicle.
    Ego,
    /// Voxels of this class: a wall, a plant or a barrier.
    Wall(Class),
}

/// A collision: a moving object, and the box or wall that it meets in the course of a clip.
pub(crate) struct Collision {
    /// Index of its sampled track.
    track: usize,
    /// Box that moves; `None` for the ego vehicle.
    pub(crate) id: Option<BoxId>,
    /// Other side.
    pub(crate) other: CollisionPartner,
    /// Sentence for the user: `car 1 and car 2 meet at 2.6 s`.
    pub(crate) text: String,
    /// Index of the first moment.
    at: usize,
    /// The largest share of the smaller footprint that two boxes have in common; 1 for a wall: always an error.
    share: f64,
    /// True if the voxels of the wall were painted by a user.
    painted: bool,
}

/// All collisions in the course of a clip: first those of moving boxes with any other boxes, then those of boxes with
/// walls.
pub(crate) fn collisions(scene: &scene::Scene) -> Vec<Collision> {
    let over_time = OverTime::of_scene(scene);
    let mut out = box_collisions(scene, &over_time);
    out.extend(wall_collisions(scene, &over_time));
    out
}

fn box_collisions(scene: &scene::Scene, over_time: &OverTime) -> Vec<Collision> {
    let mut still_boxes: Vec<(Option<BoxId>, SceneBox)> = scene
        .canvas()
        .boxes
        .iter()
        .map(|(id, b)| (Some(*id), *b))
        .collect();
    if scene.clip().ego.is_none() {
        still_boxes.push((None, ego_box(scene, 0.0)));
    }
    let mut out = Vec::new();
    for (i, track) in over_time.tracks.iter().enumerate() {
        // The first collision with each other box (`None`: the ego vehicle), with the largest share of all moments.
        let mut by_partner: BTreeMap<Option<BoxId>, Collision> = BTreeMap::new();
        for (at, time_s) in over_time.times_s.iter().enumerate() {
            let Some(b) = &track.at[at] else { continue };
            let moving = over_time.tracks[i + 1..].iter().filter_map(|other| {
                let tied = other.attached == track.id && other.attached.is_some()
                    || track.attached == other.id && track.attached.is_some();
                (!tied).then_some((other.id, other.at[at].as_ref()?))
            });
            let others = moving.chain(still_boxes.iter().map(|(id, s)| (*id, s)));
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
                let collision = by_partner.entry(other_id).or_insert_with(|| Collision {
                    track: i,
                    id: track.id,
                    other: other_id.map_or(CollisionPartner::Ego, CollisionPartner::Box),
                    text: tf!(
                        "{first} and {second} meet at {time} s",
                        first = called(track, b),
                        second = other_id.map_or_else(|| t("the ego vehicle").to_owned(), |_| name_of(other)),
                        time = format!("{time_s:.1}")
                    ),
                    at,
                    share,
                    painted: false,
                });
                collision.share = collision.share.max(share);
            }
        }
        out.extend(by_partner.into_values());
    }
    out
}

fn wall_collisions(scene: &scene::Scene, over_time: &OverTime) -> Vec<Collision> {
    let canvas = scene.canvas();
    let (extent, relief) = (canvas.extent(), &canvas.layout.relief);
    let hits = |b: &SceneBox| {
        // The box at 80 % of its size, so that a grazing touch is no hit.
        let core = SceneBox {
            size_m: b.size_m * 0.8,
            ..*b
        };
        let mut wall = None;
        box_cells(extent, &core, 0.0, |x, y| {
            let ground_m = relief.column_m(x, y);
            // Only voxels 0.9 and 1.3 m above the ground count, so branches and signs overhead do not.
            for up in [0.9, 1.3] {
                let p = extent.center(x, y, 0).with_z(ground_m + up);
                let Some([x, y, z]) = extent.voxel_at(p) else {
                    continue;
                };
                let class = Class::from_id(canvas.occupancy.get(x, y, z));
                let solid = |c: &Class| matches!(c, Class::Manmade | Class::Vegetation | Class::Barrier);
                let painted = || canvas.painted.get(x, y, z) != NOT_PAINTED;
                wall = wall.or_else(|| class.filter(solid).map(|class| (class, painted())));
            }
        });
        wall
    };
    let first_wall = |(i, track): (usize, &SampledTrack)| {
        let mut moments = track.at.iter().enumerate();
        let (at, b, (class, painted)) = moments.find_map(|(at, b)| {
            let b = b.as_ref()?;
            Some((at, b, hits(b)?))
        })?;
        Some(Collision {
            track: i,
            id: track.id,
            other: CollisionPartner::Wall(class),
            text: filled(
                match locomotion_of(b.class) {
                    Locomotion::Drives => t("{thing} drives through {class} at {time} s"),
                    Locomotion::Walks => t("{thing} walks through {class} at {time} s"),
                    Locomotion::Moves => t("{thing} moves through {class} at {time} s"),
                },
                &[
                    ("thing", &called(track, b)),
                    ("class", &t(&class.label())),
                    ("time", &format!("{:.1}", over_time.times_s[at])),
                ],
            ),
            at,
            share: 1.0,
            painted,
        })
    };
    over_time
        .tracks
        .iter()
        .enumerate()
        .filter_map(first_wall)
        .collect()
}

fn report(check: &'static str, over_time: &OverTime, collisions: Vec<Collision>, out: &mut Findings) {
    for collision in collisions {
        let track = &over_time.tracks[collision.track];
        let Some(b) = &track.at[collision.at] else {
            continue;
        };
        let severity = match collision.share > ERROR_SHARE {
            true => Severity::Error,
            false => Severity::Warning,
        };
        let found = finding(
            check,
            severity,
            (track, over_time.times_s[collision.at], b),
            collision.text,
        );
        let other_recorded = match collision.other {
            CollisionPartner::Box(id) => out.is_recorded(id),
            CollisionPartner::Ego => over_time.ego_recorded,
            CollisionPartner::Wall(_) => !collision.painted,
        };
        // Against something the user made, the full severity stands.
        match other_recorded {
            true => out.push(found),
            false => out.push_made(Finding { severity, ..found }),
        }
    }
}

pub fn collision(context: &Context<'_>, out: &mut Findings) {
    let over_time = context.over_time();
    report(
        COLLISION,
        over_time,
        box_collisions(context.scene, over_time),
        out,
    );
}

pub fn through_wall(context: &Context<'_>, out: &mut Findings) {
    let over_time = context.over_time();
    report(
        THROUGH_WALL,
        over_time,
        wall_collisions(context.scene, over_time),
        out,
    );
}

pub fn leaves_map(context: &Context<'_>, out: &mut Findings) {
    let over_time = context.over_time();
    let extent: Extent = context.scene.canvas().extent();
    for track in &over_time.tracks {
        let off = |b: &SceneBox| extent.column_at(b.center_m.x, b.center_m.y).is_none();
        let mut moments = over_time.moments(track);
        if let Some((time_s, b)) = moments.find(|(_, b)| off(b)) {
            let text = tf!(
                "{thing} leaves the map at {time} s",
                thing = called(track, b),
                time = format!("{time_s:.1}")
            );
            let places = over_time.moments(track).map(|(_, b)| b.center_m.truncate());
            out.push(Finding {
                fixes: vec![Fix {
                    label: "Extend the map",
                    edits: reaching(extent, places, [DVec2::ZERO; 2]).into_iter().collect(),
                }],
                ..finding(LEAVES_MAP, Severity::Warning, (track, time_s, b), text)
            });
        }
    }
}

#[cfg(test)]
#[path = "tests_over_time.rs"]
mod tests;
