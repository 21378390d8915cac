//! Boxes of the key frames, and their attributes and other properties.

use std::collections::BTreeMap;

use scene::{BoxId, Class, Scene, SceneBox, TimeOfDay, Weather};

use super::Writing;
use super::sensors::{Sighted, Visible};
use crate::nuscenes::tables::{Attribute, Instance, SampleAnnotation, Visibility};
use crate::nuscenes::tokens::Tokens;
use crate::nuscenes::{categories, wxyz};

/// A box faster than this moves, m/s.
const MOVES_MPS: f64 = 0.2;

/// The attributes of the data set, with their descriptions.
const ATTRIBUTES: [(&str, &str); 8] = [
    ("vehicle.moving", "Vehicle is moving."),
    (
        "vehicle.stopped",
        "Vehicle, with a driver/rider in/on it, is currently stationary but has an intent to move.",
    ),
    (
        "vehicle.parked",
        "Vehicle is stationary (usually for longer duration) with no immediate intent to move.",
    ),
    (
        "cycle.with_rider",
        "There is a rider on the bicycle or motorcycle.",
    ),
    (
        "cycle.without_rider",
        "There is NO rider on the bicycle or motorcycle.",
    ),
    (
        "pedestrian.sitting_lying_down",
        "The human is sitting or lying down.",
    ),
    ("pedestrian.standing", "The human is standing."),
    ("pedestrian.moving", "The human is moving."),
];

/// Bins of visibility: lower bound and name.
const BINS: [(f64, &str, &str); 4] = [
    (0.0, "v0-40", "visibility of whole object is between 0 and 40%"),
    (0.4, "v40-60", "visibility of whole object is between 40 and 60%"),
    (0.6, "v60-80", "visibility of whole object is between 60 and 80%"),
    (
        0.8,
        "v80-100",
        "visibility of whole object is between 80 and 100%",
    ),
];

/// Boxes by object.
#[derive(Default)]
pub(super) struct Annotations {
    /// Rows of each object, in order, and its category.
    rows: BTreeMap<BoxId, (u8, Vec<usize>)>,
}

impl Annotations {
    /// The boxes of a key frame.
    pub(super) fn key_frame(
        &mut self,
        writing: &mut Writing<'_>,
        key_frame: usize,
        now: &Scene,
        seen: &Sighted,
    ) {
        let frame = now.frame();
        for b in frame.boxes.values() {
            let id = u64::from(b.id.0);
            let (_, rows) = self
                .rows
                .entry(b.id)
                .or_insert_with(|| (categories::of_box(b.class, &b.label.name), Vec::new()));
            rows.push(writing.tables.sample_annotation.len());
            let is_track = now.clip().tracks.get(&b.id).is_some_and(|t| !t.stands());
            let may_move = is_track || now.clip().stands();
            let attributes =
                attribute(b, is_track, may_move).map(|i| writing.tokens.token("attribute", i as u64));
            let row = SampleAnnotation {
                token: writing
                    .tokens
                    .token("sample_annotation", (key_frame as u64) << 32 | id),
                sample_token: writing.sample_token(key_frame),
                instance_token: writing.tokens.token("instance", id),
                visibility_token: (1 + bin(&seen.visible, b.id)).to_string(),
                attribute_tokens: attributes.into_iter().collect(),
                translation: writing.global(b.center_m),
                size: [b.size_m.y, b.size_m.x, b.size_m.z],
                rotation: wxyz(glam::DQuat::from_rotation_z(b.yaw_rad)),
                prev: String::new(),
                next: String::new(),
                num_lidar_pts: seen.returns.get(&b.id).copied().unwrap_or(0),
                num_radar_pts: seen.radar_returns.get(&b.id).copied().unwrap_or(0),
            };
            writing.tables.sample_annotation.push(row);
        }
    }

    /// Chains the boxes of each object, and writes the objects.
    pub(super) fn finish(self, writing: &mut Writing<'_>) {
        let boxes = &mut writing.tables.sample_annotation;
        for (id, (category, rows)) in self.rows {
            for pair in rows.windows(2) {
                boxes[pair[0]].next = boxes[pair[1]].token.clone();
                boxes[pair[1]].prev = boxes[pair[0]].token.clone();
            }
            let token = |row: Option<&usize>| row.map(|i| boxes[*i].token.clone()).unwrap_or_default();
            writing.tables.instance.push(Instance {
                token: writing.tokens.token("instance", id.0.into()),
                category_token: writing.tokens.token("category", category.into()),
                nbr_annotations: rows.len() as u64,
                first_annotation_token: token(rows.first()),
                last_annotation_token: token(rows.last()),
            });
        }
    }
}

/// Bin of the share of a box that cameras see; the first if they see none of it.
fn bin(visible: &Visible, id: BoxId) -> usize {
    let share = visible.get(&id).copied().unwrap_or(0.0);
    BINS.iter().rposition(|(from, ..)| share >= *from).unwrap_or(0)
}

/// Place of a box's attribute in [`ATTRIBUTES`]. A box that stands still is parked, or stopped if it has a track. In a
/// clip a box without a track stays where it is, whatever velocity it has.
fn attribute(b: &SceneBox, is_track: bool, may_move: bool) -> Option<usize> {
    let moves = may_move && b.velocity_mps.length() > MOVES_MPS;
    let name = match b.class {
        Class::Barrier | Class::TrafficCone => return None,
        Class::Bicycle | Class::Motorcycle if moves => "cycle.with_rider",
        Class::Bicycle | Class::Motorcycle => "cycle.without_rider",
        Class::Pedestrian if moves => "pedestrian.moving",
        Class::Pedestrian => "pedestrian.standing",
        _ if moves => "vehicle.moving",
        _ if is_track => "vehicle.stopped",
        _ => "vehicle.parked",
    };
    ATTRIBUTES.iter().position(|(known, _)| *known == name)
}

/// The table of attributes.
pub(super) fn attributes(tokens: &Tokens) -> Vec<Attribute> {
    let row = |(i, (name, description)): (usize, &(&str, &str))| Attribute {
        token: tokens.token("attribute", i as u64),
        name: (*name).into(),
        description: (*description).into(),
    };
    ATTRIBUTES.iter().enumerate().map(row).collect()
}

/// The table of visibility; its tokens are 1 to 4.
pub(super) fn visibilities() -> Vec<Visibility> {
    let row = |(i, (_, level, description)): (usize, &(f64, &str, &str))| Visibility {
        token: (i + 1).to_string(),
        level: (*level).into(),
        description: (*description).into(),
    };
    BINS.iter().enumerate().map(row).collect()
}

/// Description of a scene: its prompt, and time of day and weather where the prompt does not name them (day and clear
/// weather are never added). The devkit and many of its users look for `night` and `rain`.
pub(super) fn description(scene: &Scene) -> String {
    let conditions = &scene.conditions;
    let time = Some(conditions.time)
        .filter(|t| *t != TimeOfDay::Day)
        .map(TimeOfDay::name);
    let weather = Some(conditions.weather)
        .filter(|w| *w != Weather::Clear)
        .map(Weather::name);
    let mut out = scene.prompt.to_string();
    for word in [time, weather].into_iter().flatten() {
        if !out.to_lowercase().contains(word) {
            out = if out.is_empty() {
                word.to_owned()
            } else {
                format!("{out}, {word}")
            };
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use scene::Conditions;

    #[test]
    fn shares_fall_into_bins() {
        let of = |share: f64| bin(&[(BoxId(1), share)].into(), BoxId(1));
        let bins = [0.0, 0.39, 0.4, 0.6, 0.79, 0.8, 1.0].map(of);
        assert_eq!(bins, [0, 0, 1, 2, 2, 3, 3]);
        assert_eq!(bin(&[(BoxId(1), 1.0)].into(), BoxId(2)), 0, "not seen at all");
    }

    #[test]
    fn attributes_tell_what_moves() {
        let mut b = crate::table_tests::scene().frame().boxes[&BoxId(4)];
        let mut named = |class, mps: f64, is_track, may_move| {
            b.class = class;
            b.velocity_mps = glam::DVec2::new(0.0, mps);
            attribute(&b, is_track, may_move).map(|i| ATTRIBUTES[i].0)
        };
        assert_eq!(named(Class::Car, 3.0, false, false), Some("vehicle.parked"));
        let mut name = |class, mps, is_track| named(class, mps, is_track, true);
        assert_eq!(name(Class::Car, 3.0, true), Some("vehicle.moving"));
        assert_eq!(name(Class::Bus, 0.0, true), Some("vehicle.stopped"));
        assert_eq!(name(Class::Trailer, 0.1, false), Some("vehicle.parked"));
        assert_eq!(name(Class::Motorcycle, 3.0, true), Some("cycle.with_rider"));
        assert_eq!(name(Class::Pedestrian, 1.0, true), Some("pedestrian.moving"));
        assert_eq!(name(Class::TrafficCone, 3.0, true), None);
    }

    #[test]
    fn light_and_weather_are_in_the_words() {
        let mut scene = crate::table_tests::scene();
        scene.prompt = "a Night out".into();
        scene.conditions = Conditions::usual(TimeOfDay::Night, Weather::Rain, 0);
        assert_eq!(description(&scene), "a Night out, rain");
        scene.conditions = Conditions::default();
        assert_eq!(description(&scene), "a Night out");
        scene.prompt = "".into();
        scene.conditions.weather = Weather::Fog;
        assert_eq!(description(&scene), "fog");
    }
}
