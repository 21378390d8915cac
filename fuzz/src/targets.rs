//! What is fuzzed, one function per parser: any bytes in, and out comes a value that is sound or an error of one line.
//! Shared by the targets of cargo-fuzz (`fuzz_targets/`) and by the suite (`tests/fuzz/`), which runs them on a small
//! corpus and on seeded mutations of valid files.

use std::sync::OnceLock;

use app::dock::Dock;
use app::keymap::{Chord, Keymap};
use app::panes::{self, id::PaneId};
use app::settings::Settings;
use app::{open, text as app_text};
use diffusion::solver::SolverKind;
use editor::{Document, Edit, Shape};
use formats::import::{Content, ImportFile, pcd};
use formats::{box_list, loom, occ3d, opendrive};
use glam::{DVec2, DVec3};
use graph_layout::memory::{Bank, RoadRef};
use job::GenParams;
use nets::fine_vae;
use nets::layout::net::LayoutNet;
use nets::lidar::LidarNet;
use nets::occ_dit::OccDit;
use nets::occ_vae::OccVae;
use nets::text::TextEncoder;
use nn::weights::{WeightFile, WeightsError};
use place::lanes::LaneMap;
use place::rules::place_with;
use place::to_graph::to_graph;
use scene::graph::SceneGraph;
use scene::grid::NOT_PAINTED;
use scene::road_map::RoadMap;
use scene::{
    BevLayer, BevLayout, BoxId, Class, Extent, Frame, Relief, Scene, SensorRig, TimeOfDay, Weather, infer,
};
use sensors::lidar::Rays;
use sensors::splat::project::SplatCamera;
use trade::Presets;
use words::describe::describe;
use words::hear::hear;
use words::reader::Mode;
use world::{template, traffic};

/// A parser under test.
pub type Target = fn(&[u8]);

/// All of them by name.
pub const ALL: [(&str, Target); 18] = [
    ("project", project_file),
    ("occ3d", occ3d_file),
    ("pcd", point_cloud),
    ("opendrive", opendrive_file),
    ("boxes", box_file),
    ("rig", rig_file),
    ("settings", settings_file),
    ("edits", edits_file),
    ("edit_sequence", edit_sequence),
    ("weights", weight_file),
    ("prompt", prompt),
    ("text_edit", text_edit),
    ("memory", memory_bank),
    ("graph", scene_graph),
    ("arguments", arguments),
    ("words", words),
    ("params", params),
    ("presets", presets),
];

/// An error is for people: something, in one line.
fn one_line(error: impl std::fmt::Display) {
    let line = error.to_string();
    assert!(!line.is_empty() && !line.contains('\n'), "{line:?}");
}

/// The scene that ships, read once.
fn start() -> &'static Scene {
    static SCENE: OnceLock<Scene> = OnceLock::new();
    SCENE.get_or_init(|| open::bundled().expect("the bundled scene"))
}

/// What every other room relies on in a frame.
fn frame_is_sound(frame: &Frame) {
    for boxes in [&frame.boxes, &frame.source.boxes] {
        for (id, b) in boxes {
            assert_eq!((b.id, b.problem()), (*id, None));
        }
    }
    for layout in [&frame.layout, &frame.source.layout] {
        assert!(layout.cells().iter().all(|c| c >> BevLayer::MAP.len() == 0));
        let points = layout.polylines.iter().flat_map(|l| &l.points_m);
        assert!(points.into_iter().all(|p| p.is_finite()));
    }
    assert!(frame.occupancy.iter_set().all(|(_, _, _, v)| v < Class::FREE));
    for (x, y, z, v) in frame.painted.iter_set() {
        assert!(v <= Class::FREE && v != NOT_PAINTED);
        assert_eq!(frame.occupancy.get(x, y, z), v);
    }
}

/// `.loom`: what is read can be written and read again, and everything that walks lanes comes to an end.
pub fn project_file(bytes: &[u8]) {
    match loom::from_bytes(bytes) {
        Err(error) => one_line(error),
        Ok(scene) => {
            assert_eq!(scene.rig.problem(), None);
            for frame in [scene.canvas(), scene.frame()] {
                for (id, b) in frame.boxes.iter().chain(&frame.source.boxes) {
                    assert_eq!((b.id, b.problem()), (*id, None));
                }
                RoadMap::new(&frame.layout);
                LaneMap::new(&frame.layout);
                traffic::place(
                    &frame.layout.crop(Extent::WINDOW),
                    1,
                    &traffic::TrafficSpec::NORMAL,
                );
            }
            let again = loom::to_bytes(&scene).expect("what was read can be written");
            let twice = loom::from_bytes(&again).expect("what was written can be read");
            assert_eq!(loom::to_bytes(&twice).expect("sound"), again);
        }
    }
}

/// `labels.npz`, and with it npy.
pub fn occ3d_file(bytes: &[u8]) {
    match occ3d::read(bytes) {
        Err(error) => one_line(error),
        Ok(frame) => {
            assert!(frame.labels.iter_set().all(|(_, _, _, v)| v < Class::FREE));
            let boxes = infer::boxes(&frame.labels);
            assert!(boxes.values().all(|b| b.problem().is_none()));
            infer::layout(&frame.labels);
        }
    }
}

/// A point cloud; what was read is a sound scene.
pub fn point_cloud(bytes: &[u8]) {
    match (pcd::IMPORTER.read)(&ImportFile {
        bytes,
        name: "cloud",
        path: None,
        options: Default::default(),
    }) {
        Err(error) => one_line(error),
        Ok(Content::Scene(loaded)) => frame_is_sound(loaded.scene.frame()),
        Ok(_) => panic!("a cloud is a scene"),
    }
}

/// OpenDRIVE; what was read is drawn, too.
pub fn opendrive_file(bytes: &[u8]) {
    match opendrive::read(bytes) {
        Err(error) => one_line(error),
        Ok(network) => {
            let (at, heading) = network.suggest_pose();
            let import = network.to_layout(at, heading);
            let points = import.layout.polylines.iter().flat_map(|l| &l.points_m);
            assert!(points.into_iter().all(|p| p.is_finite()));
            assert_eq!(import.background.problem(), None);
            let heights = import.layout.relief.heights_m().unwrap_or_default();
            assert!(heights.iter().all(|h| h.abs() <= Relief::LIMIT_M));
            network.pose_on_lane_near(DVec2::new(3.0, 4.0));
        }
    }
}

/// Boxes as JSON.
pub fn box_file(bytes: &[u8]) {
    match box_list::read(bytes) {
        Err(error) => one_line(error),
        Ok((boxes, _)) => assert!(boxes.iter().all(|b| b.problem().is_none())),
    }
}

/// Sensor rigs: those without a problem have rays and a projection.
pub fn rig_file(bytes: &[u8]) {
    let rig: SensorRig = match serde_json::from_slice(bytes) {
        Err(error) => return one_line(error),
        Ok(rig) => rig,
    };
    if let Some(problem) = rig.problem() {
        return one_line(problem);
    }
    for pattern in &rig.lidars {
        let rays = pattern.rays();
        assert!(rays <= SensorRig::MOST_RAYS);
        if rays <= 100_000 {
            let rays = Rays::new(pattern, rig.velocity_mps());
            let unit = |d: &DVec3| (d.length() - 1.0).abs() < 1e-6;
            assert!(rays.directions.iter().all(unit), "{pattern:?}");
        }
    }
    for camera in &rig.cameras {
        let view = SplatCamera::new(camera, 16, 9, 1.3);
        for p in [DVec3::X, -DVec3::X, DVec3::new(20.0, 3.0, -1.0), DVec3::ZERO] {
            if let Some(f) = view.project(p, 0.2, 0.2, 200.0) {
                assert!(f.depth_m >= 0.2);
            }
        }
    }
    let text = serde_json::to_string(&rig).expect("plain numbers");
    assert_eq!(serde_json::from_str::<SensorRig>(&text).expect("its own"), rig);
}

/// Settings with keys and panes.
pub fn settings_file(bytes: &[u8]) {
    let settings = match Settings::read(&String::from_utf8_lossy(bytes)) {
        Err(error) => return one_line(error),
        Ok(settings) => settings,
    };
    let map = Keymap::new(&settings.key_preset, settings.keys.clone());
    map.conflicts();
    let Some(mut dock) = settings.dock.clone().and_then(Dock::from_kept) else {
        return;
    };
    for pane in panes::infos().iter().map(|p| p.id) {
        dock.is_shown(pane);
        dock.swap(pane, PaneId::BEV);
        dock.open(pane);
        if let Some(tile) = dock.find(pane) {
            dock.toggle_maximized(tile);
            dock.toggle_maximized(tile);
            dock.close(tile);
        }
    }
}

/// A list of edits as JSON, applied and undone.
pub fn edits_file(bytes: &[u8]) {
    let edits: Vec<Edit> = match serde_json::from_slice(bytes) {
        Err(error) => return one_line(error),
        Ok(edits) => edits,
    };
    let mut document = Document::new(start().clone());
    let before = document.scene().rev;
    match document.apply_all("Edit", &edits) {
        Err(error) => {
            one_line(error);
            assert_eq!(document.scene().rev, before, "refused, yet changed");
        }
        Ok(()) => {
            frame_is_sound(document.scene().frame());
            assert_eq!(document.scene().rig.problem(), None);
            while document.undo().is_some() {}
            assert_eq!(document.scene().rev, before);
        }
    }
}

/// Bytes as a stream of choices.
struct Choices<'a>(&'a [u8]);

impl Choices<'_> {
    fn byte(&mut self) -> u8 {
        let Some((first, rest)) = self.0.split_first() else {
            return 0;
        };
        self.0 = rest;
        *first
    }
    fn below(&mut self, n: usize) -> usize {
        (usize::from(self.byte()) << 8 | usize::from(self.byte())) % n
    }
    /// Mostly a place in the scene, sometimes a number that no user could type.
    fn number(&mut self) -> f64 {
        const ODD: [f64; 12] = [
            0.0,
            -0.0,
            40.0,
            -40.0,
            1e-300,
            1e9,
            -1e300,
            f64::MAX,
            f64::INFINITY,
            f64::NEG_INFINITY,
            f64::NAN,
            5e-324,
        ];
        match self.byte() {
            b @ 0..12 => ODD[usize::from(b)],
            b => (f64::from(b) - 128.0) * 0.35 + f64::from(self.byte()) * 1e-3,
        }
    }
    fn point(&mut self) -> DVec2 {
        DVec2::new(self.number(), self.number())
    }
    fn point3(&mut self) -> DVec3 {
        DVec3::new(self.number(), self.number(), self.number() * 0.1)
    }
    fn id(&mut self) -> BoxId {
        let ids: Vec<BoxId> = start().frame().boxes.keys().copied().collect();
        match self.byte() {
            0 => BoxId(u32::MAX),
            1 => BoxId(0),
            b => ids[usize::from(b) % ids.len().max(1)],
        }
    }
    fn points(&mut self) -> Vec<DVec2> {
        (0..self.below(9)).map(|_| self.point()).collect()
    }
    fn cells(&mut self) -> Vec<[usize; 3]> {
        let n = self.below(12);
        (0..n)
            .map(|_| [self.below(202), self.below(202), self.below(17)])
            .collect()
    }
    fn size(&mut self) -> DVec3 {
        DVec3::new(self.number(), self.number(), self.number()).abs() * 0.3
    }
    fn edit(&mut self) -> Edit {
        match self.below(14) {
            0 => Edit::RemoveBox { id: self.id() },
            1 => Edit::AddBox {
                class: Class::ALL[self.below(Class::ALL.len())],
                center_m: self.point3(),
                size_m: self.size(),
                yaw_deg: self.number() * 20.0,
                velocity_mps: (self.byte() > 128).then(|| self.point()),
                id: (self.byte() > 200).then(|| self.id()),
                label: Default::default(),
            },
            2 => Edit::MoveBox {
                id: self.id(),
                center_m: (self.byte() > 60).then(|| self.point3()),
                yaw_deg: (self.byte() > 128).then(|| self.number()),
                size_m: (self.byte() > 128).then(|| self.size()),
            },
            3 => Edit::SetBoxClass {
                id: self.id(),
                class: Class::ALL[self.below(Class::ALL.len())],
            },
            4..=6 => Edit::PaintBev {
                layer: BevLayer::MAP[self.below(BevLayer::MAP.len())],
                shape: match self.below(5) {
                    0 => Shape::Disc {
                        center_m: self.point(),
                        radius_m: self.number() * 0.2,
                    },
                    1 => Shape::Rect {
                        min_m: self.point(),
                        max_m: self.point(),
                    },
                    2 => Shape::Polygon {
                        points_m: self.points(),
                    },
                    3 => Shape::Line {
                        points_m: self.points(),
                        width_m: self.number().abs() * 0.2,
                    },
                    _ => Shape::Cells(
                        (0..self.below(9))
                            .map(|_| [self.below(202), self.below(202)])
                            .collect(),
                    ),
                },
                value: self.byte() > 100,
            },
            7 => Edit::AddPolylines {
                lines: (0..self.below(4))
                    .map(|_| scene::Polyline {
                        kind: scene::PolylineKind::LaneCenter,
                        points_m: self.points(),
                    })
                    .collect(),
            },
            8 => Edit::PaintVoxels {
                cells: self.cells(),
                class: Class::ALL[self.below(Class::ALL.len())],
            },
            9 => Edit::UnlockVoxels { cells: self.cells() },
            10 => Edit::ClearPaint {},
            11 => Edit::Correct {
                edit: Box::new(self.edit()),
            },
            12 => {
                let mut rig = SensorRig::default();
                rig.lidars[0].spin_hz = self.number();
                rig.lidars[0].sector_deg = self.number() * 10.0;
                rig.lidars[0].columns = [0, 1, 1084, 65_535, u32::MAX][self.below(5)];
                rig.cameras[0].focal_px[0] = self.number();
                rig.ego_speed_mps = self.number();
                Edit::SetRig { rig: Box::new(rig) }
            }
            _ => Edit::SetPrompt {
                prompt: String::from_utf8_lossy(&self.0[..self.0.len().min(9)]).into_owned(),
            },
        }
    }
}

/// A session read from the bytes: edits, drags, undo, redo, results that come late. The scene stays sound after each.
pub fn edit_sequence(bytes: &[u8]) {
    let mut choices = Choices(bytes);
    let mut document = Document::new(start().clone());
    let initial = document.scene().rev;
    while !choices.0.is_empty() {
        let before = document.settled_scene().rev;
        match choices.below(8) {
            0..=3 => {
                let edits: Vec<Edit> = (0..=choices.below(3)).map(|_| choices.edit()).collect();
                if let Err(error) = document.apply_all("Edit", &edits) {
                    one_line(error);
                    assert_eq!(document.settled_scene().rev, before);
                }
            }
            4 | 5 => {
                for _ in 0..=choices.below(3) {
                    let _ = document.preview(&choices.edit());
                    assert_eq!(document.settled_scene().rev, before);
                }
                match choices.byte() > 128 {
                    true => document.commit_drag("Drag"),
                    false => document.cancel_drag(),
                }
            }
            6 => {
                document.undo();
            }
            _ => {
                document.redo();
            }
        }
        frame_is_sound(document.scene().frame());
        assert_eq!(document.scene().rig.problem(), None);
    }
    while document.undo().is_some() {}
    assert_eq!(document.scene().rev, initial);
}

/// Safetensors, and every network that could be made of it.
pub fn weight_file(bytes: &[u8]) {
    let parse = || WeightFile::parse("w", bytes);
    if let Err(error) = parse() {
        return one_line(error);
    }
    let networks: [fn(WeightFile<'_>) -> Result<(), WeightsError>; 5] = [
        |w| OccVae::new(w).map(drop),
        |w| OccDit::new(w).map(drop),
        |w| LidarNet::new(w).map(drop),
        |w| LayoutNet::new(w).map(drop),
        |w| TextEncoder::new(w).map(drop),
    ];
    for network in networks {
        if let Err(error) = network(parse().expect("as before")) {
            one_line(error);
        }
    }
    if let Ok(vae) = OccVae::new(parse().expect("as before")) {
        // Sound weights encode: the sizes of the shipped fine network are as good as any.
        assert!(vae.config().side() > 0 && fine_vae().is_ok());
    }
}

/// Words that become a scene.
pub fn prompt(bytes: &[u8]) {
    let text = String::from_utf8_lossy(bytes);
    let heard = hear(&text, Mode::Prompt).expect("the shipped weights");
    let acts = heard.reading.acts.iter().filter_map(|a| a.span);
    let words = heard
        .missing
        .iter()
        .map(|m| m.span)
        .chain(heard.mended.iter().map(|m| m.span));
    for span in acts.chain(words) {
        assert!(span.start <= span.end && span.end <= text.len());
        assert!(
            text.get(span.start..span.end).is_some(),
            "{span:?} parts a letter"
        );
    }
    let graphed = to_graph(&describe(&heard.reading).description, 1);
    assert_eq!(graphed.graph.problem(), None);
    if let Err(error) = app_text::read(&text) {
        one_line(error);
    }
    if bytes.len().is_multiple_of(4) {
        let placement = place_with(&graphed.graph, street(), 1, &graphed.sizes_m, &[]);
        assert!(placement.boxes.iter().all(|b| b.problem().is_none()));
    }
}

fn street() -> &'static BevLayout {
    static LAYOUT: OnceLock<BevLayout> = OnceLock::new();
    LAYOUT.get_or_init(|| template::layout("intersection", 4).expect("a template"))
}

/// Words that change a scene.
pub fn text_edit(bytes: &[u8]) {
    let text = String::from_utf8_lossy(bytes);
    let edits: Vec<Edit> = app_text::read_edit(&text, start(), 1)
        .expect("the shipped weights")
        .edits();
    let mut document = Document::new(start().clone());
    if let Err(error) = document.apply_all("Words", &edits) {
        one_line(error);
    }
    frame_is_sound(document.scene().frame());
}

/// A memory of scenes.
pub fn memory_bank(bytes: &[u8]) {
    let bank = match Bank::parse(&String::from_utf8_lossy(bytes)) {
        Err(error) => return one_line(error),
        Ok(bank) => bank,
    };
    for entry in bank.entries.iter().take(2) {
        assert!(entry.boxes().values().all(|b| b.problem().is_none()));
        if let RoadRef::Template { .. } = entry.road
            && let Some(layout) = entry.road.layout()
        {
            assert_eq!(entry.graph(&layout).problem(), None);
        }
    }
}

/// A scene graph, placed on a street.
pub fn scene_graph(bytes: &[u8]) {
    let graph: SceneGraph = match serde_json::from_slice(bytes) {
        Err(error) => return one_line(error),
        Ok(graph) => graph,
    };
    if let Some(problem) = graph.problem() {
        return one_line(problem);
    }
    if graph.nodes.len() <= 40 {
        let placement = place_with(&graph, street(), 1, &Default::default(), &[]);
        assert!(placement.boxes.iter().all(|b| b.problem().is_none()));
    }
}

/// A command line, one argument per line.
pub fn arguments(bytes: &[u8]) {
    let text = String::from_utf8_lossy(bytes);
    let arguments = std::iter::once("sceneloom").chain(text.lines()).map(Into::into);
    if let Err(message) = cli::accepts(arguments) {
        assert!(!message.is_empty());
    }
}

/// Names, chords and lists of keys.
pub fn words(bytes: &[u8]) {
    let text = String::from_utf8_lossy(bytes);
    for line in text.lines() {
        if let Ok(chord) = line.parse::<Chord>() {
            assert_eq!(chord.to_string().parse::<Chord>(), Ok(chord));
        }
        for error in [
            line.parse::<SolverKind>().err(),
            line.parse::<TimeOfDay>().err().map(|e| e.to_string()),
            line.parse::<Weather>().err().map(|e| e.to_string()),
        ]
        .into_iter()
        .flatten()
        {
            one_line(error);
        }
        let encoder = TextEncoder::bundled().expect("the shipped weights");
        let vector = encoder.encode(line).expect("the processor never fails");
        assert!(vector.iter().all(|v| v.is_finite()));
    }
}

/// Parameters of a generation.
pub fn params(bytes: &[u8]) {
    match serde_json::from_slice::<GenParams>(bytes) {
        Err(error) => one_line(error),
        Ok(params) => {
            if let Err(error) = params.check() {
                one_line(error);
            }
            if let Ok(text) = serde_json::to_string(&params) {
                assert_eq!(serde_json::from_str::<GenParams>(&text).expect("its own"), params);
            }
        }
    }
}

/// Measured presets of the quality slider.
pub fn presets(bytes: &[u8]) {
    let weights = Presets::bundled().weights;
    match Presets::parse(&String::from_utf8_lossy(bytes), weights) {
        Err(error) => one_line(error),
        Ok(presets) => {
            for preset in &presets.all {
                let params = preset.knobs.on(GenParams::default());
                assert_eq!(params.check(), Ok(()));
                assert!(presets.index_of(&params).is_some());
                for tokens in [0.0, 1.0, 625.0] {
                    assert!(preset.cost.wall_s(tokens) >= 0.0);
                }
            }
        }
    }
}
