//! The map expansion (`nuscenes.map_expansion`, version 1.3): areas from the layers of the map, dividers from its lines.
//! Lanes, road blocks and traffic lights are empty: the scene has none.

use glam::DVec2;
use scene::{BevLayer, BevLayout, PolylineKind};
use serde_json::{Map, Value, json};

use super::outline::{Area, areas};
use crate::FormatError;
use crate::nuscenes::tokens::Tokens;

/// Layers that the devkit expects to be there.
const EMPTY: [&str; 5] = [
    "road_segment",
    "road_block",
    "lane",
    "lane_connector",
    "traffic_light",
];

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
    // Paths and connections of lanes.
    file.insert("arcline_path_3".into(), json!({}));
    file.insert("connectivity".into(), json!({}));

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
        let row = |(i, area): (usize, &Area)| {
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

    fn polygon(&mut self, area: &Area) -> String {
        let token = self.tokens.token("polygon", self.polygons.len() as u64);
        let outside = self.points(&area.outside);
        let hole = |ring: &Vec<DVec2>| json!({"node_tokens": self.points(ring)});
        let holes: Vec<Value> = area.holes.iter().map(hole).collect();
        let row = json!({"token": token, "exterior_node_tokens": outside, "holes": holes});
        self.polygons.push(row);
        token
    }

    fn divider(&mut self, layer: &str, index: usize, points_m: &[DVec2]) -> Value {
        let nodes = self.points(points_m);
        let line = self.tokens.token("line", self.lines.len() as u64);
        let segment = |node: &String| json!({"node_token": node, "segment_type": "NIL"});
        let segments: Vec<Value> = nodes.iter().map(segment).collect();
        self.lines.push(json!({"token": line, "node_tokens": nodes}));
        let mut row = json!({"token": self.tokens.token(layer, index as u64), "line_token": line});
        match layer {
            "road_divider" => row["road_segment_token"] = "".into(),
            _ => row["lane_divider_segments"] = segments.into(),
        }
        row
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::clip_tests::clip_scene;

    #[test]
    fn areas_and_lines_lie_where_the_map_has_them() {
        let scene = clip_scene(1);
        let layout = &scene.canvas().layout;
        let bytes = to_bytes(layout, DVec2::new(40.0, 40.0), &Tokens::of(&scene)).expect("finite");
        let file: Value = serde_json::from_slice(&bytes).expect("JSON");
        assert_eq!(file["canvas_edge"], json!([80.0, 80.0]));
        let node = |token: &Value| {
            let nodes = file["node"].as_array().expect("nodes");
            let node = nodes.iter().find(|n| n["token"] == *token).expect("there");
            [&node["x"], &node["y"]].map(|v| v.as_f64().expect("a number"))
        };
        let line = &file["line"][1];
        assert_eq!(file["lane_divider"][0]["line_token"], line["token"]);
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
}
