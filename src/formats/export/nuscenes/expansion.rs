//! The map expansion (`nuscenes.map_expansion`, version 1.3): areas from the layers of the map, dividers from its
//! lines; lanes, ways through junctions and their connections from its road graph. Road blocks and traffic lights are
//! empty.

use std::collections::BTreeMap;

use glam::DVec2;
use scene::raster::polygon_cells;
use scene::{BevLayer, BevLayout, PolylineKind};
use serde_json::{Map, Value, json};

use super::outline::{PolygonWithHoles, areas};
use crate::FormatError;
use crate::nuscenes::tokens::Tokens;
use crate::opendrive::write::lane_graph::{GraphLane, lane_graph, outline};

/// Layers that the devkit expects to be there.
const EMPTY: [&str; 2] = ["road_block", "traffic_light"];
/// Radius that a straight piece of a path is given, m; no piece is an arc.
const STRAIGHT_M: f64 = 1000.0;

/// The file. `shift_m` leads from the world frame to the global frame.
pub(super) fn to_bytes(layout: &BevLayout, shift_m: DVec2, tokens: &Tokens) -> Result<Vec<u8>, FormatError> {
    let mut out = Expansion {
        tokens,
        shift_m,
        nodes: Vec::new(),
        polygons: Vec::new(),
        lines: Vec::new(),
    };
    let mut file = Map::new();
    file.insert("version".into(), "1.3".into());
    let extent = layout.extent();
    let edge_m = extent.max_m() - extent.min_m();
    file.insert("canvas_edge".into(), json!([edge_m.x, edge_m.y]));
    for layer in EMPTY {
        file.insert(layer.into(), json!([]));
    }
    out.lanes(layout, &mut file);
    let of = |layer: BevLayer| areas(extent, |x, y| layout.has(layer, x, y));
    let drivable: Vec<String> = of(BevLayer::DrivableArea)
        .iter()
        .map(|a| out.polygon(a))
        .collect();
    let rows: Vec<Value> = match drivable.is_empty() {
        true => Vec::new(),
        false => vec![json!({"token": tokens.token("drivable_area", 0), "polygon_tokens": drivable})],
    };
    file.insert("drivable_area".into(), rows.into());
    for (layer, more) in [
        (BevLayer::PedCrossing, json!({"road_segment_token": ""})),
        (BevLayer::Walkway, json!({})),
        (
            BevLayer::StopLine,
            json!({
                "stop_line_type": "STOP_SIGN", "ped_crossing_tokens": [], "traffic_light_tokens": [], "road_block_token": ""
            }),
        ),
        (
            BevLayer::CarparkArea,
            json!({"orientation": 0.0, "road_block_token": ""}),
        ),
    ] {
        let row = |(i, area): (usize, &PolygonWithHoles)| {
            let mut row = more.clone();
            row["token"] = tokens.token(layer.name(), i as u64).into();
            row["polygon_token"] = out.polygon(area).into();
            row
        };
        let rows: Vec<Value> = of(layer).iter().enumerate().map(row).collect();
        file.insert(layer.name().into(), rows.into());
    }
    for (kind, layer) in [
        (PolylineKind::RoadDivider, "road_divider"),
        (PolylineKind::LaneDivider, "lane_divider"),
    ] {
        let lines = layout
            .polylines
            .iter()
            .filter(|l| l.kind == kind && l.points_m.len() > 1);
        let rows = lines
            .enumerate()
            .map(|(i, line)| out.divider(layer, i, &line.points_m));
        let rows: Vec<Value> = rows.collect();
        file.insert(layer.into(), rows.into());
    }
    file.insert("node".into(), out.nodes.into());
    file.insert("polygon".into(), out.polygons.into());
    file.insert("line".into(), out.lines.into());
    serde_json::to_vec(&file).map_err(FormatError::new)
}

/// Geometry so far.
struct Expansion<'a> {
    tokens: &'a Tokens,
    shift_m: DVec2,
    nodes: Vec<Value>,
    polygons: Vec<Value>,
    lines: Vec<Value>,
}

impl Expansion<'_> {
    /// Tokens of points, which become nodes.
    fn points(&mut self, points_m: &[DVec2]) -> Vec<String> {
        let mut one = |p: &DVec2| {
            let token = self.tokens.token("node", self.nodes.len() as u64);
            let at = *p + self.shift_m;
            self.nodes.push(json!({"token": token, "x": at.x, "y": at.y}));
            token
        };
        points_m.iter().map(&mut one).collect()
    }

    fn polygon(&mut self, area: &PolygonWithHoles) -> String {
        let token = self.tokens.token("polygon", self.polygons.len() as u64);
        let outside = self.points(&area.outside);
        let hole = |ring: &Vec<DVec2>| json!({"node_tokens": self.points(ring)});
        let holes: Vec<Value> = area.holes.iter().map(hole).collect();
        let row = json!({"token": token, "exterior_node_tokens": outside, "holes": holes});
        self.polygons.push(row);
        token
    }

    /// Lanes, ways through junctions, their paths and their connections; roads and junctions as segments.
    fn lanes(&mut self, layout: &BevLayout, file: &mut Map<String, Value>) {
        let lanes = lane_graph(layout);
        let token = |(i, lane): (usize, &GraphLane)| self.tokens.token(layer_of(lane), i as u64);
        let tokens: Vec<String> = lanes.iter().enumerate().map(token).collect();
        let named = |places: &[usize]| -> Vec<&String> { places.iter().map(|i| &tokens[*i]).collect() };
        let (mut paths, mut connectivity) = (Map::new(), Map::new());
        let (mut rows, mut connectors) = (Vec::new(), Vec::new());
        for (lane, token) in lanes.iter().zip(&tokens) {
            paths.insert(token.clone(), path(&lane.middle_m, self.shift_m));
            let leads = json!({"incoming": named(&lane.incoming), "outgoing": named(&lane.outgoing)});
            connectivity.insert(token.clone(), leads);
            let polygon = self.polygon(&PolygonWithHoles {
                outside: outline(&lane.sides_m),
                holes: Vec::new(),
            });
            if lane.junction.is_some() {
                connectors.push(json!({"token": token, "polygon_token": polygon}));
                continue;
            }
            let [left, right] = &lane.sides_m;
            let edges = [
                (left[0], right[0]),
                (left[left.len() - 1], right[right.len() - 1]),
            ];
            let [from, to] = edges.map(|(a, b)| self.line(&[a, b]).0);
            let [left, right] = [left, right].map(|side| segments(&self.points(side)));
            rows.push(json!({
                "token": token, "polygon_token": polygon, "lane_type": "CAR", "from_edge_line_token": from,
                "to_edge_line_token": to, "left_lane_divider_segments": left, "right_lane_divider_segments": right
            }));
        }
        file.insert("lane".into(), rows.into());
        file.insert("lane_connector".into(), connectors.into());
        file.insert("arcline_path_3".into(), paths.into());
        file.insert("connectivity".into(), connectivity.into());
        let segments = self.road_segments(layout, &lanes);
        file.insert("road_segment".into(), segments.into());
    }

    /// A segment for each road and each junction: the paved cells that its lanes cover.
    fn road_segments(&mut self, layout: &BevLayout, lanes: &[GraphLane]) -> Vec<Value> {
        let extent = layout.extent();
        let mut covered: BTreeMap<(bool, u32), Vec<usize>> = BTreeMap::new();
        for lane in lanes {
            let of = lane
                .junction
                .map_or((false, lane.road), |junction| (true, junction));
            let cells = covered.entry(of).or_default();
            polygon_cells(extent, &outline(&lane.sides_m), |x, y| {
                if layout.has(BevLayer::DrivableArea, x, y) {
                    cells.push(extent.index(x, y));
                }
            });
        }
        let drivable = self.tokens.token("drivable_area", 0);
        let mut rows = Vec::new();
        for ((is_intersection, _), cells) in covered {
            let mut covers = vec![false; extent.columns()];
            cells.into_iter().for_each(|at| covers[at] = true);
            for area in areas(extent, |x, y| covers[extent.index(x, y)]) {
                rows.push(json!({
                    "token": self.tokens.token("road_segment", rows.len() as u64),
                    "polygon_token": self.polygon(&area), "is_intersection": is_intersection,
                    "drivable_area_token": drivable
                }));
            }
        }
        rows
    }

    /// A line, and its nodes.
    fn line(&mut self, points_m: &[DVec2]) -> (String, Vec<String>) {
        let nodes = self.points(points_m);
        let line = self.tokens.token("line", self.lines.len() as u64);
        self.lines.push(json!({"token": line, "node_tokens": nodes}));
        (line, nodes)
    }

    fn divider(&mut self, layer: &str, index: usize, points_m: &[DVec2]) -> Value {
        let (line, nodes) = self.line(points_m);
        let mut row = json!({"token": self.tokens.token(layer, index as u64), "line_token": line});
        match layer {
            "road_divider" => row["road_segment_token"] = "".into(),
            _ => row["lane_divider_segments"] = segments(&nodes),
        }
        row
    }
}

fn layer_of(lane: &GraphLane) -> &'static str {
    match lane.junction {
        Some(_) => "lane_connector",
        None => "lane",
    }
}

/// Points of a divider of unknown paint.
fn segments(nodes: &[String]) -> Value {
    let segment = |node: &String| json!({"node_token": node, "segment_type": "NIL"});
    nodes.iter().map(segment).collect()
}

/// A line as pieces of the devkit's paths, each of three arcs of which the middle one alone has a length, and is straight.
fn path(points_m: &[DVec2], shift_m: DVec2) -> Value {
    let piece = |pair: &[DVec2]| {
        let [from, to] = [pair[0] + shift_m, pair[1] + shift_m];
        let yaw_rad = (to - from).to_angle();
        json!({
            "start_pose": [from.x, from.y, yaw_rad], "end_pose": [to.x, to.y, yaw_rad], "shape": "LSL",
            "radius": STRAIGHT_M, "segment_length": [0.0, from.distance(to), 0.0]
        })
    };
    points_m.windows(2).map(piece).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::clip_tests::clip_scene;

    #[test]
    fn areas_and_lines_lie_where_the_map_has_them() {
        let scene = clip_scene(1);
        let layout = &scene.canvas().layout;
        let bytes = to_bytes(layout, DVec2::new(40.0, 40.0), &Tokens::from_scene(&scene)).expect("finite");
        let file: Value = serde_json::from_slice(&bytes).expect("JSON");
        assert_eq!(file["canvas_edge"], json!([80.0, 80.0]));
        let node = |token: &Value| {
            let nodes = file["node"].as_array().expect("nodes");
            let node = nodes.iter().find(|n| n["token"] == *token).expect("there");
            [&node["x"], &node["y"]].map(|v| v.as_f64().expect("a number"))
        };
        let lines = file["line"].as_array().expect("lines").iter();
        let line = lines
            .clone()
            .find(|l| l["token"] == file["lane_divider"][0]["line_token"]);
        let line = line.expect("there");
        assert_eq!(node(&line["node_tokens"][0]), [10.0, 41.5]);
        assert_eq!(node(&line["node_tokens"][1]), [70.0, 41.5]);
        let drivable = file["drivable_area"][0]["polygon_tokens"]
            .as_array()
            .expect("areas");
        let road = areas(layout.extent(), |x, y| layout.has(BevLayer::DrivableArea, x, y));
        assert_eq!(drivable.len(), road.len());
        let first = file["polygon"].as_array().expect("polygons").iter();
        let first = first.clone().find(|p| p["token"] == drivable[0]).expect("there");
        let corner = road[0].outside[0] + 40.0;
        assert_eq!(node(&first["exterior_node_tokens"][0]), corner.to_array());
        for layer in EMPTY {
            assert_eq!(file[layer], json!([]));
        }
    }

    #[test]
    fn lanes_of_the_road_graph_are_lanes_with_paths_that_go_on_in_each_other() {
        let layout = crate::opendrive::write::lane_graph::star(&[[-45.0, 0.0], [45.0, 3.0], [4.0, 45.0]]);
        let tokens = Tokens::from_scene(&clip_scene(1));
        let bytes = to_bytes(&layout, DVec2::new(40.0, 40.0), &tokens).expect("finite");
        let file: Value = serde_json::from_slice(&bytes).expect("JSON");
        let list = |layer: &str| file[layer].as_array().expect("rows").clone();
        assert!(list("lane").len() >= 6);
        assert!(list("lane_connector").len() >= 4);
        let polygons: Vec<Value> = list("polygon").iter().map(|p| p["token"].clone()).collect();
        let point = |pose: &Value| [0, 1].map(|i| pose[i].as_f64().expect("a number"));
        let mut led = 0;
        for row in list("lane").iter().chain(&list("lane_connector")) {
            let token = row["token"].as_str().expect("a token");
            assert!(polygons.contains(&row["polygon_token"]));
            let path = file["arcline_path_3"][token].as_array().expect("a path");
            for pair in path.windows(2) {
                assert_eq!(point(&pair[0]["end_pose"]), point(&pair[1]["start_pose"]));
            }
            let end = point(&path[path.len() - 1]["end_pose"]);
            for next in file["connectivity"][token]["outgoing"]
                .as_array()
                .expect("tokens")
            {
                let next = next.as_str().expect("a token");
                let start = point(&file["arcline_path_3"][next][0]["start_pose"]);
                assert!(
                    (end[0] - start[0]).hypot(end[1] - start[1]) < 1.0,
                    "{end:?} {start:?}"
                );
                led += 1;
            }
        }
        assert!(led >= 8, "{led}");
        let segments = list("road_segment");
        let crossing = segments.iter().filter(|s| s["is_intersection"] == true).count();
        assert!(crossing >= 1 && segments.len() >= crossing + 3, "{segments:?}");
    }
}
