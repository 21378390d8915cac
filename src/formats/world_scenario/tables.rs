//! The tables of a world scenario: places at each time, the cameras, and the map.

use glam::DVec3;
use scene::{Pose, Scene, SceneBox};

use super::map::{Rail, ScenarioMap};
use super::{TABLE_HZ, boxes_at, category, clip_id, ego_at, rig, scenario_from_world, times_s};
use crate::FormatError;
use crate::table::{ColumnValues, ParquetField, to_bytes, vectors};

/// Version of the rows; readers ignore it.
const VERSION: u64 = 1;

/// The tables of a scene by their names, required ones first; of the map only those that have rows.
pub(crate) fn tables(scene: &Scene) -> Result<Vec<(&'static str, Vec<u8>)>, FormatError> {
    if let Some(problem) = scene.rig.problem() {
        return Err(FormatError::new(problem));
    }
    let boxes = scene.canvas().boxes.values();
    if let Some(problem) = boxes.clone().find_map(SceneBox::problem) {
        return Err(FormatError::new(problem));
    }
    let to_scenario = scenario_from_world(scene);
    let id = clip_id(scene);
    let times_us = moments(scene);
    let mut out = vec![
        ("obstacle", obstacle(scene, &to_scenario, &id, &times_us)?),
        ("calibration_estimate", calibration(scene, &id)?),
        (
            "egomotion_estimate",
            egomotion(scene, &to_scenario, &id, &times_us)?,
        ),
    ];
    let map = ScenarioMap::from_scene(scene, &to_scenario);
    let optional = [
        ("lane", map.lanes.len(), lane(&map)),
        ("lane_line", map.lines.len(), lane_line(&map)),
        ("road_boundary", map.boundaries.len(), road_boundary(&map)),
        ("crosswalk", map.crossings.len(), crosswalk(&map)),
        ("wait_line", map.stop_lines.len(), wait_line(&map)),
    ];
    for (name, rows, fields) in optional {
        if rows > 0 {
            let fields = [
                map_key(&id, rows),
                ParquetField::Group(name, fields),
                version(rows),
            ];
            out.push((name, to_bytes(rows, &fields)?));
        }
    }
    Ok(out)
}

/// Moments in seconds and in whole microseconds.
fn moments(scene: &Scene) -> Vec<(f64, i64)> {
    let us = |time_s: f64| (time_s * 1e6).round() as i64;
    times_s(scene, TABLE_HZ).into_iter().map(|t| (t, us(t))).collect()
}

fn version(rows: usize) -> ParquetField {
    ParquetField::Values("version", ColumnValues::Unsigned(vec![VERSION; rows]))
}

fn texts(name: &'static str, text: &str, rows: usize) -> ParquetField {
    ParquetField::Values(name, ColumnValues::Text(vec![text.to_owned(); rows]))
}

fn map_key(id: &str, rows: usize) -> ParquetField {
    ParquetField::Group(
        "key",
        vec![
            texts("clip_id", id, rows),
            texts("label_class_id", "sceneloom", rows),
            texts("map_id", id, rows),
            texts("map_id_version", "1", rows),
        ],
    )
}

fn quaternions(of: &[glam::DQuat]) -> ParquetField {
    let part = |i: usize| ColumnValues::Number(of.iter().map(|q| q.to_array()[i]).collect());
    let names = ["x", "y", "z", "w"].into_iter().enumerate();
    ParquetField::Group(
        "orientation",
        names
            .map(|(i, name)| ParquetField::Values(name, part(i)))
            .collect(),
    )
}

fn obstacle(
    scene: &Scene,
    to_scenario: &Pose,
    id: &str,
    times: &[(f64, i64)],
) -> Result<Vec<u8>, FormatError> {
    let (mut times_us, mut boxes) = (Vec::new(), Vec::new());
    for (time_s, time_us) in times {
        let there = boxes_at(scene, *time_s, to_scenario);
        times_us.extend(std::iter::repeat_n(*time_us, there.len()));
        boxes.extend(there);
    }
    let rows = boxes.len();
    let each = |of: fn(&SceneBox) -> DVec3| boxes.iter().map(of).collect::<Vec<_>>();
    let turn = |b: &SceneBox| glam::DQuat::from_rotation_z(b.yaw_rad.rem_euclid(std::f64::consts::TAU));
    let ids = boxes.iter().map(|b| b.id.0.to_string()).collect();
    let categories = boxes.iter().map(|b| category(b.class).0.to_owned()).collect();
    let fields = [
        ParquetField::Group(
            "key",
            vec![
                texts("clip_id", id, rows),
                ParquetField::Values("timestamp_micros", ColumnValues::Integer(times_us)),
                texts("label_class_id", "sceneloom", rows),
            ],
        ),
        ParquetField::Group(
            "obstacle",
            vec![
                ParquetField::Values("trackline_id", ColumnValues::Text(ids)),
                vectors("center", &each(|b| b.center_m)),
                vectors("size", &each(|b| b.size_m)),
                quaternions(&boxes.iter().map(turn).collect::<Vec<_>>()),
                ParquetField::Values("category", ColumnValues::Text(categories)),
            ],
        ),
        version(rows),
    ];
    to_bytes(rows, &fields)
}

fn calibration(scene: &Scene, id: &str) -> Result<Vec<u8>, FormatError> {
    let fields = [
        ParquetField::Group(
            "key",
            vec![
                texts("clip_id", id, 1),
                ParquetField::Values("timestamp_micros", ColumnValues::Integer(vec![-1])),
            ],
        ),
        ParquetField::Group(
            "calibration_estimate",
            vec![
                texts("name", &scene.rig.name, 1),
                texts("rig_json", &rig::to_json(&scene.rig), 1),
            ],
        ),
        version(1),
    ];
    to_bytes(1, &fields)
}

fn egomotion(
    scene: &Scene,
    to_scenario: &Pose,
    id: &str,
    times: &[(f64, i64)],
) -> Result<Vec<u8>, FormatError> {
    let poses: Vec<Pose> = times
        .iter()
        .map(|(t, _)| *to_scenario * ego_at(scene, *t))
        .collect();
    let rows = poses.len();
    let fields = [
        ParquetField::Group(
            "key",
            vec![
                texts("clip_id", id, rows),
                ParquetField::Values(
                    "timestamp_micros",
                    ColumnValues::Integer(times.iter().map(|t| t.1).collect()),
                ),
            ],
        ),
        ParquetField::Group(
            "egomotion_estimate",
            vec![
                texts("name", "sceneloom", rows),
                vectors(
                    "location",
                    &poses.iter().map(|p| p.translation_m).collect::<Vec<_>>(),
                ),
                quaternions(&poses.iter().map(|p| p.rotation.normalize()).collect::<Vec<_>>()),
            ],
        ),
        version(rows),
    ];
    to_bytes(rows, &fields)
}

fn lane(map: &ScenarioMap) -> Vec<ParquetField> {
    let rows = map.lanes.len();
    let mut out = Vec::new();
    for (side, [rail, styles, colors]) in [
        ["left_rail", "left_edge_styles", "left_edge_colors"],
        ["right_rail", "right_edge_styles", "right_edge_colors"],
    ]
    .into_iter()
    .enumerate()
    {
        let rails: Vec<&Rail> = map.lanes.iter().map(|lane| &lane[side]).collect();
        let names = |of: fn((&'static str, &'static str)) -> &'static str| {
            let each = |rail: &&Rail| rail.edges.iter().map(|e| of(e.names()).to_owned()).collect();
            ColumnValues::Texts(rails.iter().map(each).collect())
        };
        let points = rails.iter().map(|rail| rail.points_m.clone()).collect();
        out.push(ParquetField::Values(rail, ColumnValues::Points(points)));
        out.push(ParquetField::Values(styles, names(|(_, style)| style)));
        out.push(ParquetField::Values(colors, names(|(color, _)| color)));
    }
    out.extend([
        ParquetField::Values("lane_direction", ColumnValues::UnknownText(rows)),
        ParquetField::Values("speed_limit", ColumnValues::UnknownNumber(rows)),
        ParquetField::Values("vehicle_types", ColumnValues::Texts(vec![Vec::new(); rows])),
    ]);
    out
}

fn lane_line(map: &ScenarioMap) -> Vec<ParquetField> {
    let rows = map.lines.len();
    let each = |of: fn((&'static str, &'static str)) -> &'static str| {
        let lists = map
            .lines
            .iter()
            .map(|(marking, points)| vec![of(marking.names()).to_owned(); points.len()]);
        ColumnValues::Texts(lists.collect())
    };
    vec![
        ParquetField::Values(
            "line_rail",
            ColumnValues::Points(map.lines.iter().map(|(_, points)| points.clone()).collect()),
        ),
        ParquetField::Values("styles", each(|(_, style)| style)),
        ParquetField::Values("colors", each(|(color, _)| color)),
        ParquetField::Values("left_driving_direction", ColumnValues::UnknownText(rows)),
        ParquetField::Values("right_driving_direction", ColumnValues::UnknownText(rows)),
    ]
}

fn road_boundary(map: &ScenarioMap) -> Vec<ParquetField> {
    vec![
        texts("category", "road_boundary", map.boundaries.len()),
        ParquetField::Values("location", ColumnValues::Points(map.boundaries.clone())),
    ]
}

fn crosswalk(map: &ScenarioMap) -> Vec<ParquetField> {
    vec![
        texts("category", "PEDESTRIAN", map.crossings.len()),
        ParquetField::Values("location", ColumnValues::Points(map.crossings.clone())),
    ]
}

fn wait_line(map: &ScenarioMap) -> Vec<ParquetField> {
    let rows = map.stop_lines.len();
    vec![
        texts("category", "STOP", rows),
        ParquetField::Values("location", ColumnValues::Points(map.stop_lines.clone())),
        ParquetField::Values("is_implicit", ColumnValues::Flag(vec![false; rows])),
        ParquetField::Values("intersection_subtype", ColumnValues::UnknownText(rows)),
    ]
}
