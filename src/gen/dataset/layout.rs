//! Frames that the layout network is trained on: the scene graph of a street with its geometry, and the map.

use safetensors::tensor::Dtype;

use super::Shard;
use graph_layout::graph_of::graph_of;
use nets::layout::input::{LayoutInput, MAP_CHANNELS, MAP_SIDE, VALUES, input_of, map_raster};
use scene::road_map::RoadMap;
use scene::{BevLayout, BoxId, SceneBox};
use world::draw::{Draw, hash};
use world::{template, traffic};

/// Number of nodes of a frame; unused ones have kind 0.
pub const NODES: usize = 64;
/// Number of edges of a frame; unused ones are -1.
pub const EDGES: usize = 128;

/// One training frame.
pub struct LayoutFrame {
    /// Nodes and edges in the network's units, every node locked.
    pub input: LayoutInput,
    /// The map, as [`map_raster`] gives it.
    pub map: Vec<u8>,
}

/// Street and traffic of frame `index` of the data set of `seed`, seen from a vehicle in its lane, with the name of the
/// template (`None` for an imported road).
pub fn street(
    seed: u64,
    index: u64,
    roads: impl Fn(u64) -> Option<BevLayout>,
) -> (
    BevLayout,
    std::collections::BTreeMap<BoxId, SceneBox>,
    Option<&'static str>,
) {
    let seed = hash(hash(seed) ^ index);
    let mut draw = Draw::new(seed, "street");
    let name = template::TEMPLATES[draw.below(template::TEMPLATES.len())];
    let bits = draw.bits();
    let (layout, name) = match roads(seed) {
        Some(layout) => (layout, None),
        None => (template::layout(name, bits).unwrap_or_default(), Some(name)),
    };
    let spec = traffic::TrafficSpec {
        vehicles: draw.range(0.1, 1.4),
        people: draw.range(0.1, 1.4),
        works: draw.range(0.0, 1.8),
    };
    let boxes = traffic::place(&layout, seed, &spec);
    (layout, boxes, name)
}

/// Frame `index` of the data set of `seed`; the same arguments give the same frame.
pub fn layout_frame(seed: u64, index: u64, roads: impl Fn(u64) -> Option<BevLayout>) -> LayoutFrame {
    let (layout, boxes, _) = street(seed, index, roads);
    let road = RoadMap::new(&layout);
    let (graph, _) = graph_of(&road, &boxes, hash(seed ^ hash(index)));
    LayoutFrame {
        input: input_of(&graph, None),
        map: map_raster(&road),
    }
}

impl Shard for LayoutFrame {
    const ARRAYS: &'static [&'static str] = &["kind", "state", "size", "shape", "values", "edges", "map"];

    /// u8 `kind`, `state`, `size`, `shape` `[N,64]` as in `NodeInput`; f32 `values` `[N,64,24]` in the network's units; i16
    /// `edges` `[N,128,4]` (from, to, relation, stated distance in decimetres or -1); u8 `map` `[N,100,100,8]`.
    fn arrays(frames: &[Self]) -> Vec<(Dtype, Vec<usize>, Vec<u8>)> {
        let (mut kind, mut state, mut size, mut shape) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
        let (mut values, mut edges) = (Vec::new(), Vec::new());
        for frame in frames {
            for i in 0..NODES {
                let node = frame.input.nodes.get(i);
                kind.push(node.map_or(0, |n| n.kind));
                state.push(node.map_or(0, |n| n.state));
                size.push(node.map_or(0, |n| n.size));
                shape.push(node.map_or(0, |n| n.shape as u8));
                for v in node.map_or([0.0; VALUES], |n| n.values) {
                    values.extend(v.to_le_bytes());
                }
            }
            for i in 0..EDGES {
                let row = frame
                    .input
                    .edges
                    .get(i)
                    .filter(|e| usize::from(e.from.max(e.to)) < NODES);
                let row = row.map_or([-1; 4], |e| {
                    let distance = e.distance_m.map_or(-1, |d| (d * 10.0).round() as i16);
                    [e.from as i16, e.to as i16, i16::from(e.relation), distance]
                });
                row.into_iter().for_each(|v| edges.extend(v.to_le_bytes()));
            }
        }
        let map = frames.iter().flat_map(|f| f.map.iter().copied()).collect();
        vec![
            (Dtype::U8, vec![NODES], kind),
            (Dtype::U8, vec![NODES], state),
            (Dtype::U8, vec![NODES], size),
            (Dtype::U8, vec![NODES], shape),
            (Dtype::F32, vec![NODES, VALUES], values),
            (Dtype::I16, vec![EDGES, 4], edges),
            (Dtype::U8, vec![MAP_SIDE, MAP_SIDE, MAP_CHANNELS], map),
        ]
    }
}

#[cfg(test)]
mod tests {
    use super::super::write;
    use super::*;

    #[test]
    fn shards_are_repeatable() {
        let make = |i: usize| -> std::io::Result<LayoutFrame> { Ok(layout_frame(5, i as u64, |_| None)) };
        let read = || {
            let folder = tempfile::tempdir().expect("a folder");
            write(folder.path(), 3, make, |_| true).expect("written");
            std::fs::read(folder.path().join("shard_00000.safetensors")).expect("a shard")
        };
        assert_eq!(read(), read());
        let frame = layout_frame(5, 1, |_| None);
        assert!(frame.input.nodes.iter().all(|n| n.locked));
        assert_eq!(frame.map.len(), MAP_SIDE * MAP_SIDE * MAP_CHANNELS);
    }
}
