//! Voxels that the network of LiDAR and cameras tells, in worlds and in scenes generated from their layouts: from the
//! two sensors together and from either alone; from the cameras alone in other light and weather; and from the cameras
//! alone on learned pictures.

use std::sync::Arc;

use serde_json::{Map, Value, json};

use crate::suite::with_interval;
use crate::suites::pictures::go_on;
use nets::picture::PictureNets;
use scene::{Conditions, Scene, TimeOfDay, Weather};
use sensors::perceive::voxels::{Hears, PerceptionInput, VoxelReport, report, report_of};
use sensors::pictures::appearance::CameraImage;
use sensors::pictures::painter::{PaintInput, PaintOptions, Painter};

/// Sensors that the network gets, by name.
const ARMS: [(&str, Hears); 3] = [
    ("both", Hears::Both),
    ("lidar", Hears::Lidar),
    ("cameras", Hears::Cameras),
];
/// Light and weather that cameras are judged in, by name; the others are compared with the first.
const AIR: [(&str, TimeOfDay, Weather); 7] = [
    ("clear", TimeOfDay::Day, Weather::Clear),
    ("rain", TimeOfDay::Day, Weather::Rain),
    ("snow", TimeOfDay::Day, Weather::Snow),
    ("fog", TimeOfDay::Day, Weather::Fog),
    ("sandstorm", TimeOfDay::Day, Weather::Sandstorm),
    ("dusk", TimeOfDay::Dusk, Weather::Clear),
    ("night", TimeOfDay::Night, Weather::Clear),
];

/// Figures of some scenes, a value per scene: IoU where the LiDAR sees, share of voxels told rightly, share of boxes
/// found.
#[derive(Default)]
struct VoxelScores([Vec<f64>; 3]);

const NAMES: [&str; 3] = ["iou", "classes_right", "boxes_found"];

impl VoxelScores {
    fn add(&mut self, report: &VoxelReport) {
        let boxes = report.boxes.len();
        let found = report.boxes.iter().filter(|b| !b.is_missed()).count();
        // A scene without boxes to find has missed none.
        let found = if boxes == 0 {
            1.0
        } else {
            found as f64 / boxes as f64
        };
        let values = self.0.iter_mut().zip([report.iou, report.right, found]);
        values.for_each(|(list, value)| list.push(value));
    }

    fn report(&self) -> Value {
        let pairs = NAMES.iter().zip(&self.0);
        pairs
            .map(|(name, values)| ((*name).to_owned(), with_interval(values)))
            .collect()
    }

    /// Difference from `other`, scene by scene.
    fn more_than(&self, other: &Self) -> Value {
        let pairs = NAMES.iter().zip(self.0.iter().zip(&other.0));
        let more = pairs.map(|(name, (a, b))| {
            let each: Vec<f64> = a.iter().zip(b).map(|(a, b)| a - b).collect();
            ((*name).to_owned(), with_interval(&each))
        });
        more.collect()
    }
}

/// Figures of worlds and of generated scenes.
#[derive(Default)]
pub(super) struct VoxelFigures {
    worlds: [VoxelScores; 3],
    generated: [VoxelScores; 3],
    air: [VoxelScores; AIR.len()],
    /// Figures from the cameras alone, on learned pictures of worlds and of generated scenes.
    learned: [VoxelScores; 2],
    /// Share of the pixels that the segmenter classifies rightly: in rendered pictures of worlds and of generated
    /// scenes, then in learned pictures of each.
    pixels_right: [[Vec<f64>; 2]; 2],
}

/// Pictures of a scene by the shipped picture network, in the order of its rig.
fn learned_pictures(scene: &Scene) -> anyhow::Result<Vec<Arc<CameraImage>>> {
    let placed = scene.for_sensors();
    let input = PaintInput {
        frame: placed.frame(),
        rig: &placed.rig,
        background: &placed.background,
        conditions: placed.conditions,
    };
    let mut painter = Painter::new(PictureNets::bundled()?, PaintOptions::default());
    Ok(painter.paint(&input, &mut go_on)?)
}

impl VoxelFigures {
    /// Judges a world, also under other light and weather, and the scene generated from its layout.
    pub fn add(&mut self, world: &Scene, generated: &Scene) -> anyhow::Result<()> {
        let scenes = [(world, &mut self.worlds), (generated, &mut self.generated)];
        for (which, (scene, told)) in scenes.into_iter().enumerate() {
            let heard = PerceptionInput::from_scene(scene)?;
            let learned = PerceptionInput::of_pictures(scene, &learned_pictures(scene)?)?;
            self.learned[which].add(&report_of(scene, &learned, Hears::Cameras)?);
            for (right, heard) in self.pixels_right.iter_mut().zip([&heard, &learned]) {
                right[which].push(heard.pixels_right);
            }
            for ((_, hears), told) in ARMS.iter().zip(told) {
                told.add(&report_of(scene, &heard, *hears)?);
            }
        }
        for ((_, time, weather), told) in AIR.iter().zip(&mut self.air) {
            let mut scene = world.clone();
            scene.conditions = Conditions::usual(*time, *weather, scene.seed);
            told.add(&report(&scene, Hears::Cameras)?);
        }
        Ok(())
    }

    pub fn report(&self) -> Value {
        let arms = |told: &[VoxelScores; 3]| -> Map<String, Value> {
            let each = ARMS.iter().zip(told);
            each.map(|((name, _), told)| ((*name).to_owned(), told.report()))
                .collect()
        };
        let more = ARMS.iter().zip(self.generated.iter().zip(&self.worlds));
        let more: Map<String, Value> = more
            .map(|((name, _), (generated, world))| ((*name).to_owned(), generated.more_than(world)))
            .collect();
        let air = AIR.iter().zip(&self.air);
        let air: Map<String, Value> = air
            .map(|((name, ..), told)| {
                let report =
                    json!({ "told": told.report(), "more_than_clear": told.more_than(&self.air[0]) });
                ((*name).to_owned(), report)
            })
            .collect();
        let cameras = [&self.worlds[2], &self.generated[2]];
        let names = ["worlds", "generated"];
        let learned: Map<String, Value> = (0..2)
            .map(|i| {
                let report = json!({
                    "told": self.learned[i].report(),
                    "more_than_rendered": self.learned[i].more_than(cameras[i]),
                    "pixels_right": with_interval(&self.pixels_right[1][i]),
                    "pixels_right_rendered": with_interval(&self.pixels_right[0][i]),
                });
                (names[i].to_owned(), report)
            })
            .collect();
        json!({
            "learned_pictures": learned,
            "worlds": arms(&self.worlds),
            "generated": arms(&self.generated),
            "generated_more_than_worlds": more,
            "cameras_by_weather": air,
        })
    }
}
