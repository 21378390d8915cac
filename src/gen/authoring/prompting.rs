//! From a description to a scene: with which placer, with or without memory, on which road, around which objects. The
//! window, the command line and the evaluation share it.

mod diffused;
mod filling;

use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::Arc;
use std::time::Instant;

use serde::Serialize;

use diffused::diffuse_and_mend;
pub use filling::{Remembered, recall};
use filling::{fill_in, memory};

use super::memory::layout_of;
use graph_layout::diffuse::{self, PlacementReport};
use graph_layout::memory::RoadRef;
use nets::layout::net::LayoutNet;
use place::description::Description;
use place::road::{self, Chosen};
use place::rules::{Placement, place_with};
use place::to_graph::{Graphed, node_of, to_graph};
use scene::graph::{LaneRole, Locked, NodeKind};
use scene::{BevLayout, BoxId, SceneBox};

/// Method that places the objects.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, clap::ValueEnum)]
#[serde(rename_all = "snake_case")]
pub enum PlacementMethod {
    /// Rules: every object takes the best free place that what was said allows.
    #[default]
    Rules,
    /// The layout network: boxes by diffusion under the scene graph, then the projection; what that leaves out or breaks is
    /// placed by rules.
    Diffusion,
}

/// Parts of an open scene that stay.
#[derive(Clone, Debug, Default, PartialEq)]
pub enum Keep {
    /// No part.
    #[default]
    Nothing,
    /// The road: objects are placed on it.
    Road(Arc<BevLayout>),
    /// The objects: a road is laid under them.
    Objects(Arc<BTreeMap<BoxId, SceneBox>>),
}

/// Options for making a layout from a description.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct How {
    /// Method that places the objects.
    pub placer: PlacementMethod,
    /// True if open parts of a prompt are filled in from remembered scenes.
    pub memory: bool,
    /// A folder of the user's own scenes, which are remembered too.
    pub own_scenes: Option<PathBuf>,
    /// A folder with other weights of the layout network.
    pub weights: Option<PathBuf>,
    /// Parts that stay.
    pub keep: Keep,
    /// Boxes of nodes that stay where they are.
    pub locked: BTreeMap<u32, SceneBox>,
    /// Boxes that belong to no node and are kept clear of (by rules only).
    pub others: Vec<SceneBox>,
}

impl How {
    /// Errors in one line if weights were named that are missing or damaged, and that place the objects: weights that
    /// were asked for by name are not replaced by others.
    pub fn check(&self) -> anyhow::Result<()> {
        match (self.placer, &self.weights) {
            (PlacementMethod::Diffusion, Some(_)) => network(self).map(drop),
            _ => Ok(()),
        }
    }
}

/// A request for a scene.
#[derive(Clone, Debug, PartialEq)]
pub struct Ask {
    /// The words.
    pub prompt: String,
    /// The description from them, possibly changed by hand.
    pub description: Description,
    /// The graph, if it was edited by hand.
    pub graphed: Option<Graphed>,
    /// Fixes every random draw.
    pub seed: u64,
    /// Options.
    pub how: How,
}

impl Ask {
    /// Its layout.
    pub fn lay_out(&self) -> Laid {
        lay_out_graph(
            &self.prompt,
            &self.description,
            self.graphed.as_ref(),
            self.seed,
            &self.how,
        )
    }
}

/// Report on the diffusion.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Diffused {
    /// Steps, times, and moves of the projection.
    pub report: PlacementReport,
    /// Mean distance that the projection moved an object, m.
    pub mean_move_m: f64,
    /// Largest distance that the projection moved an object, m.
    pub most_move_m: f64,
    /// Objects that rules placed in the end, because the projection found no place or a statement did not hold.
    pub by_rules: usize,
}

/// A layout from words.
pub struct Laid {
    /// The description, filled in if memory was used.
    pub description: Description,
    /// Nodes and relations.
    pub graphed: Graphed,
    /// The road.
    pub road: Chosen,
    /// Places of the objects.
    pub placement: Placement,
    /// Contributions of memory.
    pub remembered: Option<Remembered>,
    /// Report on the diffusion.
    pub diffused: Option<Diffused>,
    /// Other notes, one line each.
    pub notes: Vec<String>,
    /// Time in all, s.
    pub wall_s: f64,
}

/// Lays out a description; `prompt` is the query for memory.
pub fn lay_out(prompt: &str, description: &Description, seed: u64, how: &How) -> Laid {
    lay_out_graph(prompt, description, None, seed, how)
}

/// Lays out a description with a graph that was edited by hand.
pub fn lay_out_graph(
    prompt: &str,
    description: &Description,
    graphed: Option<&Graphed>,
    seed: u64,
    how: &How,
) -> Laid {
    let started = Instant::now();
    let mut description = description.clone();
    let mut notes = Vec::new();
    let mut remembered = None;
    let mut proposed = None;
    if how.memory && graphed.is_none() {
        let asked = memory(how).and_then(|(memory, problems)| {
            let found = fill_in(&memory, prompt, &mut description, seed)?;
            Ok((found, problems))
        });
        match asked {
            Ok((found, problems)) => {
                notes.extend(problems);
                (remembered, proposed) = found.unzip();
            }
            Err(error) => notes.push(format!("memory is not used: {error:#}")),
        }
    }
    let mut graphed = graphed.cloned().unwrap_or_else(|| to_graph(&description, seed));
    for node in &mut graphed.graph.nodes {
        if let (Some(b), NodeKind::Object(_)) = (how.locked.get(&node.id), &node.kind) {
            node.locked = Some(Locked::Box(*b));
        }
    }
    let net = match how.placer {
        PlacementMethod::Rules => None,
        PlacementMethod::Diffusion => match network(how) {
            Ok(net) => Some(net),
            Err(error) => {
                notes.push(format!("placed by rules: {error:#}"));
                None
            }
        },
    };
    let mut road = road_for(
        &description,
        &mut graphed,
        how,
        proposed.as_ref(),
        net.as_deref(),
        seed,
        &mut notes,
    );
    if let Some(found) = &mut remembered {
        found.road = road.template == REMEMBERED;
    }
    let (mut placement, mut diffused) = match net {
        None => (
            place_with(&graphed.graph, &road.layout, seed, &graphed.sizes_m, &how.others),
            None,
        ),
        Some(net) => match diffuse_and_mend(&net, &graphed, &road.layout, &how.others, seed) {
            Ok((placement, diffused)) => (placement, Some(diffused)),
            Err(error) => {
                notes.push(format!("placed by rules: {error}"));
                (
                    place_with(&graphed.graph, &road.layout, seed, &graphed.sizes_m, &how.others),
                    None,
                )
            }
        },
    };
    // (a crowd that overfills one road overfills the next too, and takes longest to place)
    let few = placement.boxes.len() <= FEW_BOXES;
    if matches!(how.keep, Keep::Nothing)
        && road.template != REMEMBERED
        && few
        && !placement.left_out.is_empty()
    {
        let other = better_road(&description, &graphed, &how.others, &road, &placement, seed);
        if let Some((other, found)) = other {
            (road, placement, diffused) = (other, found, None);
        }
    }
    Laid {
        description,
        graphed,
        road,
        placement,
        remembered,
        diffused,
        notes,
        wall_s: started.elapsed().as_secs_f64(),
    }
}

/// The road of a new scene: the one that is kept, one under the objects that are kept (which join the graph), the
/// remembered one if it meets all requirements, else one of the templates.
fn road_for(
    description: &Description,
    graphed: &mut Graphed,
    how: &How,
    proposed: Option<&RoadRef>,
    net: Option<&LayoutNet>,
    seed: u64,
    notes: &mut Vec<String>,
) -> Chosen {
    match &how.keep {
        Keep::Road(layout) => Chosen {
            template: "kept",
            layout: (**layout).clone(),
            missing: road::lacks(description, &graphed.graph, layout),
        },
        Keep::Objects(boxes) => {
            let first = graphed.graph.nodes.iter().map(|n| n.id + 1).max().unwrap_or(1);
            for (k, b) in boxes.values().enumerate() {
                graphed.graph.nodes.push(scene::graph::GraphNode {
                    id: first + k as u32,
                    kind: node_of(b.class),
                    locked: Some(Locked::Box(*b)),
                });
            }
            road_under(description, graphed, boxes, seed, net, notes)
        }
        Keep::Nothing => {
            let fits = |r: &RoadRef| {
                let layout = layout_of(r).ok()?;
                road::lacks(description, &graphed.graph, &layout)
                    .is_empty()
                    .then_some(layout)
            };
            match proposed
                .filter(|_| description.road.kind.is_none())
                .and_then(fits)
            {
                Some(layout) => Chosen {
                    template: REMEMBERED,
                    layout,
                    missing: Vec::new(),
                },
                None => road::choose(description, &graphed.graph, seed),
            }
        }
    }
}

/// Name of a road from memory.
const REMEMBERED: &str = "remembered";
/// Number of other variations of the road that are tried if an object finds no place.
const OTHER_ROADS: u64 = 1;
/// Most boxes for which they are tried.
const FEW_BOXES: usize = 24;

/// Another variation of the road on which more statements can hold, placed by rules; `None` if there is none.
fn better_road(
    description: &Description,
    graphed: &Graphed,
    others: &[SceneBox],
    road: &Chosen,
    placement: &Placement,
    seed: u64,
) -> Option<(Chosen, Placement)> {
    let mut least = placement.cost();
    let mut best = None;
    for k in 1..=OTHER_ROADS {
        if least == 0 {
            break;
        }
        let seed = seed ^ (k << 32);
        let other = road::choose(description, &graphed.graph, seed);
        if other.missing.len() > road.missing.len() {
            continue;
        }
        let found = place_with(&graphed.graph, &other.layout, seed, &graphed.sizes_m, others);
        if found.cost() < least {
            least = found.cost();
            best = Some((other, found));
        }
    }
    best
}

fn network(how: &How) -> anyhow::Result<Arc<LayoutNet>> {
    Ok(match &how.weights {
        Some(folder) => LayoutNet::from_dir(folder)?,
        None => LayoutNet::bundled()?,
    })
}

/// A road on which given objects stand well: by the network if it may be used, else the variation of the templates on
/// which most of them are well placed.
fn road_under(
    d: &Description,
    graphed: &Graphed,
    boxes: &BTreeMap<BoxId, SceneBox>,
    seed: u64,
    net: Option<&LayoutNet>,
    notes: &mut Vec<String>,
) -> Chosen {
    let given: Vec<SceneBox> = boxes.values().copied().collect();
    let by_rules = road::under(d, &graphed.graph, &given, seed);
    let Some(net) = net else {
        return by_rules;
    };
    let mut graph = graphed.graph.clone();
    for role in [LaneRole::Ego, LaneRole::Oncoming] {
        let there = graph
            .nodes
            .iter()
            .any(|n| matches!(n.kind, NodeKind::Lane { role: r, .. } if r == role));
        if !there {
            graph.add(NodeKind::Lane { role, polyline: None });
        }
    }
    match diffuse::lay_out_with(net, &graph, seed) {
        Ok((layout, ..)) => {
            let (a, b) = (
                road::misplaced(&layout, &given),
                road::misplaced(&by_rules.layout, &given),
            );
            if a > b {
                notes.push(format!(
                    "the network's road leaves {a} of the kept objects beside it, a template {b}: the template is used"
                ));
                return by_rules;
            }
            Chosen {
                template: "diffusion",
                layout,
                missing: Vec::new(),
            }
        }
        Err(error) => {
            notes.push(format!("the road was not laid by the network: {error}"));
            by_rules
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use scene::Class;
    use scene::TimeOfDay;
    use words::describe::described;

    #[test]
    fn a_kept_road_stays_and_objects_are_placed_on_it() {
        let first = lay_out("", &described("road highway").expect("valid"), 3, &How::default());
        let how = How {
            keep: Keep::Road(Arc::new(first.road.layout.clone())),
            ..How::default()
        };
        let again = lay_out("", &described("add 2 car ( ahead ego )").expect("valid"), 4, &how);
        assert_eq!(again.road.layout, first.road.layout);
        assert_eq!(again.placement.boxes.len(), 2);
    }

    #[test]
    fn kept_objects_stay_and_a_road_is_laid_under_them() {
        let first = lay_out(
            "",
            &described("add 3 car ( ahead ego ) and 1 bus ( oncoming ego )").expect("valid"),
            3,
            &How::default(),
        );
        let boxes: BTreeMap<BoxId, SceneBox> = first.placement.boxes.iter().map(|b| (b.id, *b)).collect();
        let how = How {
            keep: Keep::Objects(Arc::new(boxes.clone())),
            ..How::default()
        };
        let again = lay_out("", &described("road straight").expect("valid"), 9, &how);
        for b in boxes.values() {
            assert!(
                again
                    .placement
                    .boxes
                    .iter()
                    .any(|x| x.center_m == b.center_m && x.class == b.class),
                "{b:?}"
            );
        }
        assert!(road::misplaced(&again.road.layout, &first.placement.boxes) <= 1);
    }

    #[test]
    fn memory_adds_only_what_was_left_open() {
        let said = described("add 2 parked car ; no person ; time night").expect("valid");
        let how = How {
            memory: true,
            ..How::default()
        };
        let laid = lay_out("two parked cars, no people, at night", &said, 5, &how);
        let count = |c: Class| laid.placement.boxes.iter().filter(|b| b.class == c).count();
        assert_eq!((count(Class::Car), count(Class::Pedestrian)), (2, 0));
        assert_eq!(laid.description.time_of_day, Some(TimeOfDay::Night));
        let found = laid.remembered.expect("memory was used");
        assert!(!found.scenes.is_empty());
        let added = laid.description.foreground.len() > said.foreground.len();
        assert_eq!(added, found.filled.iter().any(|f| f.contains(" x ")));
    }

    #[test]
    fn the_network_places_what_was_said() {
        let how = How {
            placer: PlacementMethod::Diffusion,
            ..How::default()
        };
        let said = described("add 3 car ( ahead ego ) and 1 bus ( behind ego )").expect("valid");
        let laid = lay_out("", &said, 2, &how);
        assert_eq!(laid.placement.boxes.len(), 4, "{:?}", laid.notes);
        let diffused = laid.diffused.expect("by diffusion");
        assert_eq!(diffused.report.steps, diffuse::STEPS);
        let again = lay_out("", &said, 2, &how);
        assert_eq!(laid.placement, again.placement);
    }

    #[test]
    fn names_and_colours_survive_the_network() {
        let prompt = "add 3 parked red car ( on left_roadside ) and 2 parked white van ( on right_roadside ) and 1 school_bus ( ahead ego )";
        let names = |placer| {
            let how = How {
                placer,
                ..How::default()
            };
            let laid = lay_out(prompt, &described(prompt).expect("valid"), 2, &how);
            let mut labels: Vec<String> = laid
                .placement
                .boxes
                .iter()
                .map(|b| format!("{:?} {:?}", b.class, b.label))
                .collect();
            labels.sort();
            labels
        };
        assert_eq!(names(PlacementMethod::Diffusion), names(PlacementMethod::Rules));
    }
}
