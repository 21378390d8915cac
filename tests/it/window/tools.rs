//! The tools: several boxes at once, shapes of the brush, measures, voxels, layers that are locked or alone.

use std::collections::BTreeSet;

use app::Command;
use app::tools::ToolCommand;
use editor::Edit;
use editor::rows::{CopyRows, RowAlong};
use editor::tools::voxel::Joins;
use editor::tools::{brush, circle, measure};
use egui::{Key, Modifiers};
use egui_kittest::kittest::Queryable;
use glam::{DVec2, DVec3};
use job::RegionMode;
use scene::{BevLayer, BoxId, Class, PolylineKind, SceneBox, Window};

use super::bench::Bench;

impl Bench {
    fn ask(&mut self, command: ToolCommand) {
        let ctx = self.harness.ctx.clone();
        self.app().execute(Command::Tools(command), &ctx);
        self.steps(2);
    }

    /// Three cars beside the road's own one (id 7): 8, 9 and 10 at x = -20, -10 and 0, y = 20.
    fn more_cars(&mut self) {
        let add = |i: u32| Edit::AddBox {
            class: Class::Car,
            center_m: DVec3::new(-20.0 + 10.0 * f64::from(i), 20.0, 0.85),
            size_m: DVec3::new(4.6, 1.95, 1.7),
            yaw_deg: 0.0,
            velocity_mps: None,
            id: Some(BoxId(8 + i)),
            label: Default::default(),
        };
        let ctx = self.harness.ctx.clone();
        let edits = (0..3).map(add).collect();
        self.app().execute(Command::Apply("Add cars", edits), &ctx);
        self.off();
        self.steps(2);
    }

    fn chosen(&mut self) -> BTreeSet<u32> {
        self.app().state.chosen().iter().map(|id| id.0).collect()
    }

    fn car(&self, id: u32) -> SceneBox {
        self.frame().boxes[&BoxId(id)]
    }

    fn click_at(&mut self, x_m: f64, y_m: f64, modifiers: Modifiers) {
        let at = self.bev(x_m, y_m);
        self.drag(&[at], modifiers);
    }

    fn has(&self, layer: BevLayer, x_m: f64, y_m: f64) -> bool {
        let [x, y] = Window::column_at(x_m, y_m).expect("inside");
        self.frame().layout.has(layer, x, y)
    }
}

#[test]
fn boxes_are_chosen_by_clicks_rectangles_and_lassos_and_moved_together() {
    let mut bench = Bench::new();
    bench.more_cars();
    bench.click_at(-20.0, 20.0, Modifiers::NONE);
    bench.click_at(0.0, 20.0, Modifiers::SHIFT);
    assert_eq!(bench.chosen(), [8, 10].into());
    assert_eq!(bench.app().state.selected, Some(BoxId(10)));
    bench.click_at(-20.0, 20.0, Modifiers::SHIFT);
    assert_eq!(bench.chosen(), [10].into());
    let corners = [bench.bev(-25.0, 25.0), bench.bev(-5.0, 15.0)];
    bench.drag(&corners, Modifiers::NONE);
    assert_eq!(bench.chosen(), [8, 9].into());
    let corners = [bench.bev(5.0, 25.0), bench.bev(-5.0, 15.0)];
    bench.drag(&corners, Modifiers::SHIFT);
    assert_eq!(bench.chosen(), [8, 9, 10].into());
    // One drag moves all of them, as one step.
    let way = [bench.bev(-10.0, 20.0), bench.bev(-8.0, 24.0)];
    bench.drag(&way, Modifiers::NONE);
    assert_eq!(bench.history(), ["Open", "Add cars", "Move boxes"]);
    for (id, x) in [(8, -18.0), (9, -8.0), (10, 2.0)] {
        let at = bench.car(id).center_m.truncate();
        assert!(at.distance(DVec2::new(x, 24.0)) < 0.15, "{id}: {at}");
    }
    assert_eq!(bench.car(7), super::bench::car());
    assert_eq!(bench.chosen(), [8, 9, 10].into(), "still chosen");
    bench.key(Modifiers::NONE, Key::ArrowUp);
    bench.key(Modifiers::NONE, Key::C);
    bench.key(Modifiers::CTRL, Key::D);
    assert_eq!(bench.chosen(), [11, 12, 13].into());
    bench.key(Modifiers::NONE, Key::Delete);
    assert_eq!(bench.chosen(), [].into());
    let history = bench.history();
    assert_eq!(
        history[3..],
        ["Nudge boxes", "Turn boxes", "Duplicate boxes", "Delete boxes"]
    );
    bench.app().document.jump_to(1);
    bench.steps(2);
    bench.ask(ToolCommand::ChooseAll);
    assert_eq!(bench.chosen(), [7, 8, 9, 10].into());
    bench.ask(ToolCommand::Shortcut("lasso"));
    let around = [[-25.0, 14.0], [-25.0, 26.0], [-14.0, 26.0], [-14.0, 14.0]];
    let way = around.map(|[x, y]| bench.bev(x, y));
    bench.drag(&way, Modifiers::NONE);
    assert_eq!(bench.chosen(), [8].into());
    bench.ask(ToolCommand::ChooseOthers);
    assert_eq!(bench.chosen(), [7, 9, 10].into());
    bench.ask(ToolCommand::ChooseNone);
    assert_eq!(bench.chosen(), [].into());
    // The inspector sets what several have.
    bench.ask(ToolCommand::ChooseAll);
    bench.harness.get_by_label("Duplicate boxes");
}

#[test]
fn copies_rows_mirror_images_and_lanes() {
    let mut bench = Bench::new();
    bench.more_cars();
    bench.click_at(-20.0, 20.0, Modifiers::NONE);
    bench.ask(ToolCommand::Copy);
    let at = bench.bev(5.0, -25.0);
    bench.harness.hover_at(at);
    bench.steps(2);
    bench.ask(ToolCommand::Paste);
    let pasted = bench.car(11).center_m.truncate();
    assert!(pasted.distance(DVec2::new(5.0, -25.0)) < 0.15, "{pasted}");
    assert_eq!(bench.chosen(), [11].into());
    bench.ask(ToolCommand::Cut);
    assert!(!bench.frame().boxes.contains_key(&BoxId(11)));
    bench.click_at(14.0, 3.0, Modifiers::NONE);
    bench.ask(ToolCommand::AskRow);
    bench.harness.get_by_label("Add copies").click();
    bench.steps(3);
    // The last of the four would stand beside the map.
    let fit = CopyRows::default().copies - 1;
    assert_eq!(bench.frame().boxes.len(), 4 + fit);
    assert_eq!(bench.chosen().len(), fit);
    bench.click("Undo");
    assert_eq!(bench.chosen().len(), 1, "what was chosen before is chosen again");
    bench.click_at(14.0, 3.0, Modifiers::NONE);
    let row = CopyRows {
        copies: 2,
        spacing_m: -8.0,
        along: RowAlong::Lane,
        ..CopyRows::default()
    };
    bench.ask(ToolCommand::Row(row));
    assert_eq!(bench.frame().boxes.len(), 6);
    // Without it the arrow of the new boxes would lie there.
    bench.ask(ToolCommand::ChooseNone);
    bench.click_at(14.0, 3.0, Modifiers::NONE);
    bench.ask(ToolCommand::Mirror(false));
    let b = bench.car(7);
    assert_eq!(b.center_m.truncate(), DVec2::new(14.0, -3.0));
    assert!((b.yaw_rad.abs() - std::f64::consts::PI).abs() < 1e-9);
    bench.ask(ToolCommand::ToLane);
    let lanes = bench.frame().layout.polylines.clone();
    let lanes = lanes.iter().filter(|l| l.kind == PolylineKind::LaneCenter);
    let at = bench.car(7).center_m.truncate();
    let on_a_lane = lanes.flat_map(|l| l.points_m.windows(2)).any(|p| {
        let along = p[1] - p[0];
        let t = ((at - p[0]).dot(along) / along.length_squared()).clamp(0.0, 1.0);
        at.distance(p[0] + along * t) < 1e-6
    });
    assert!(on_a_lane, "{at}");
}

#[test]
fn keys_steer_a_drag() {
    let mut bench = Bench::new();
    bench.more_cars();
    bench.click_at(-20.0, 20.0, Modifiers::NONE);
    let start = bench.car(8).center_m;
    let way = [bench.bev(-20.0, 20.0), bench.bev(-16.0, 23.0)];
    bench.press_and_move(&way, Modifiers::NONE);
    bench.key(Modifiers::NONE, Key::X);
    let at = bench.car(8).center_m;
    assert!(
        (at.y - start.y).abs() < 1e-9 && (at.x - start.x - 4.0).abs() < 0.15,
        "{at}"
    );
    for key in [Key::Minus, Key::Num2, Key::Period, Key::Num5] {
        bench.key(Modifiers::NONE, key);
    }
    assert_eq!(bench.car(8).center_m, start - DVec3::X * 2.5);
    bench.key(Modifiers::NONE, Key::Enter);
    assert!(!bench.app().document.is_dragging());
    bench.button(way[1], false, Modifiers::NONE);
    bench.steps(2);
    assert_eq!(bench.car(8).center_m, start - DVec3::X * 2.5);
    assert_eq!(
        bench.history(),
        ["Open", "Add cars", "Move box"],
        "no other key was heard"
    );
    // Ctrl puts the box on the grid.
    bench.app().state.tools.grid_m = 1.0;
    let way = [bench.bev(-22.5, 20.0), bench.bev(-18.2, 17.3)];
    bench.drag(&way, Modifiers::CTRL);
    let at = bench.car(8).center_m;
    assert_eq!(at.truncate(), at.truncate().round(), "{at}");
    // An arrow keeps to its axis; scaling by it changes the length alone.
    bench.ask(ToolCommand::Shortcut("gizmo_scale"));
    let map = bench.app().views.canvas.map.expect("drawn");
    let arm_m = 45.0 / map.scale;
    let (x, y) = (at.x, at.y);
    let way = [bench.bev(x + arm_m, y), bench.bev(x + 2.0 * arm_m, y + 1.0)];
    bench.drag(&way, Modifiers::NONE);
    let b = bench.car(8);
    assert!((b.size_m.x - 9.2).abs() < 0.3 && b.size_m.y == 1.95, "{b:?}");
    assert_eq!(bench.history().last().map(String::as_str), Some("Resize box"));
}

#[test]
fn the_brush_draws_rectangles_lines_outlines_streets_and_fills() {
    let mut bench = Bench::new();
    bench.off();
    bench.click("Paint carpark area");
    let before = bench.frame().layout.count(BevLayer::CarparkArea);
    bench.ask(ToolCommand::Shortcut("shape_rectangle"));
    let corners = [bench.bev(-20.0, 20.0), bench.bev(-12.0, 30.0)];
    bench.press_and_move(&corners, Modifiers::NONE);
    assert!(bench.app().document.is_dragging(), "shown while drawing");
    bench.button(corners[1], false, Modifiers::NONE);
    bench.steps(2);
    let count = bench.frame().layout.count(BevLayer::CarparkArea) - before;
    assert!((450..=560).contains(&count), "{count}");
    bench.ask(ToolCommand::Shortcut("brush_tool"));
    let ends = [
        bench.bev(-30.0, 30.0),
        bench.bev(-30.0, 36.0),
        bench.bev(-22.0, 30.0),
    ];
    bench.drag(&ends, Modifiers::CTRL);
    assert!(bench.has(BevLayer::CarparkArea, -26.0, 30.0) && !bench.has(BevLayer::CarparkArea, -28.0, 34.0));

    bench.ask(ToolCommand::Shortcut("shape_polygon"));
    for [x, y] in [[10.0, 20.0], [10.0, 30.0], [20.0, 30.0]] {
        bench.click_at(x, y, Modifiers::NONE);
        bench.steps(30);
    }
    bench.click_at(30.0, 30.0, Modifiers::NONE);
    assert_eq!(bench.app().state.tools.toolbox.points_m(brush::ID).len(), 4);
    bench.key(Modifiers::NONE, Key::Backspace);
    assert_eq!(bench.app().state.tools.toolbox.points_m(brush::ID).len(), 3);
    bench.key(Modifiers::NONE, Key::Enter);
    assert!(bench.has(BevLayer::CarparkArea, 12.0, 28.0) && !bench.has(BevLayer::CarparkArea, 18.0, 22.0));
    bench.click_at(0.0, 25.0, Modifiers::NONE);
    bench.key(Modifiers::NONE, Key::Escape);
    assert!(bench.app().state.tools.toolbox.points_m(brush::ID).is_empty());
    assert_eq!(bench.app().state.tool, brush::ID);

    let lines = bench.frame().layout.polylines.len();
    bench.ask(ToolCommand::Shortcut("shape_street"));
    for [x, y] in [[-35.0, -30.0], [35.0, -30.0]] {
        bench.click_at(x, y, Modifiers::NONE);
        bench.steps(30);
    }
    bench.key(Modifiers::NONE, Key::Enter);
    assert!(bench.has(BevLayer::DrivableArea, 0.0, -32.0));
    assert!(
        [-30.2, -29.8]
            .iter()
            .any(|y| bench.has(BevLayer::RoadDivider, 0.0, *y))
    );
    assert_eq!(bench.frame().layout.polylines.len(), lines + 3);

    bench.click("Paint walkway");
    bench.ask(ToolCommand::Shortcut("shape_fill"));
    bench.click_at(11.0, 29.0, Modifiers::NONE);
    assert!(bench.has(BevLayer::Walkway, 12.0, 28.0) && !bench.has(BevLayer::Walkway, 0.0, 25.0));
    let pick = Modifiers::ALT;
    bench.click_at(-16.0, 25.0, pick);
    assert_eq!(bench.app().state.layer, BevLayer::CarparkArea);
    assert_eq!(
        bench.history(),
        [
            "Open",
            "Paint rectangle",
            "Paint line",
            "Paint polygon",
            "Lay street",
            "Fill"
        ]
    );
}

#[test]
fn the_circle_brush_paints_and_erases_discs() {
    let mut bench = Bench::new();
    bench.off();
    bench.click("Paint carpark area");
    bench.click("Circle brush");
    assert_eq!(bench.app().state.tool, circle::ID);
    let before = bench.frame();
    // Escape lets go of it.
    let way = [bench.bev(-20.0, 25.0), bench.bev(-15.0, 25.0)];
    bench.press_and_move(&way, Modifiers::NONE);
    assert!(bench.app().document.is_dragging(), "shown while drawing");
    assert!(
        bench
            .harness
            .query_by_label_contains("Paints a disc of 5.0 m radius")
            .is_some(),
        "the hint says how large"
    );
    bench.key(Modifiers::NONE, Key::Escape);
    bench.button(way[1], false, Modifiers::NONE);
    bench.steps(2);
    assert_eq!((bench.frame(), bench.history().len()), (before, 1));
    // By its key: 5 m about the middle, then a hole of 2 m in it.
    bench.key(Modifiers::SHIFT, Key::U);
    bench.drag(&way, Modifiers::NONE);
    let hole = [bench.bev(-20.0, 25.0), bench.bev(-18.0, 25.0)];
    bench.drag(&hole, Modifiers::SHIFT);
    for (x, y, painted) in [
        (-20.0, 25.0, false),
        (-21.6, 25.0, false),
        (-20.0, 28.0, true),
        (-16.0, 27.0, true),
        (-16.0, 29.0, false),
        (-14.6, 25.0, false),
    ] {
        assert_eq!(bench.has(BevLayer::CarparkArea, x, y), painted, "{x} {y}");
    }
    assert_eq!(bench.history(), ["Open", "Paint circle", "Erase circle"]);
}

#[test]
fn a_street_across_a_street_makes_a_junction_in_one_step() {
    let mut bench = Bench::new();
    bench.off();
    let before = bench.frame();
    bench.key(Modifiers::NONE, Key::B);
    bench.ask(ToolCommand::Shortcut("shape_street"));
    bench.app().state.tools.street.walk_m = 2.0;
    for [x, y] in [[10.0, -35.0], [10.0, 35.0]] {
        bench.click_at(x, y, Modifiers::NONE);
        bench.steps(30);
    }
    bench.key(Modifiers::NONE, Key::Enter);
    assert_eq!(bench.history(), ["Open", "Lay street"]);
    let laid = bench.frame();
    let (mut crossed, mut markings) = (0, 0);
    for x in 0..200 {
        for y in 0..200 {
            let was_road = before.layout.has(BevLayer::DrivableArea, x, y);
            let p = scene::Window::center(x, y, 0);
            if !was_road {
                continue;
            }
            if (p.x - 10.0).abs() < 5.4 {
                assert!(!laid.layout.has(BevLayer::Walkway, x, y), "a kerb at {p}");
            }
            if (p.x - 10.0).abs() < 3.4 {
                crossed += 1;
                let lined = [BevLayer::RoadDivider, BevLayer::LaneDivider];
                assert!(!lined.iter().any(|l| laid.layout.has(*l, x, y)), "a line at {p}");
                markings += usize::from(before.layout.has(BevLayer::RoadDivider, x, y));
            }
        }
    }
    assert!(crossed > 200 && markings > 10, "{crossed} {markings}");
    bench.key(Modifiers::CTRL, Key::Z);
    assert_eq!(bench.frame(), before);
}

#[test]
fn locked_layers_are_not_painted_and_one_can_be_shown_alone() {
    let mut bench = Bench::new();
    bench.off();
    bench.click("Paint carpark area");
    bench.click("Lock carpark area");
    let before = bench.frame();
    for shape in ["brush_tool", "shape_rectangle", "shape_fill", "circle_tool"] {
        bench.ask(ToolCommand::Shortcut(shape));
        let way = [bench.bev(-20.0, 25.0), bench.bev(0.0, 28.0)];
        bench.drag(&way, Modifiers::NONE);
    }
    assert_eq!(bench.frame(), before);
    bench.click("Lock carpark area");
    bench.ask(ToolCommand::Shortcut("brush_tool"));
    let way = [bench.bev(-20.0, 25.0), bench.bev(0.0, 28.0)];
    bench.drag(&way, Modifiers::NONE);
    assert_ne!(bench.frame(), before);
    let shown = bench.app().state.layers_shown;
    for expected in [BevLayer::Walkway.bit(), shown] {
        let eye = bench.harness.get_by_label("Show walkway").rect().center();
        bench.harness.hover_at(eye);
        bench.steps(1);
        bench.button(eye, true, Modifiers::ALT);
        bench.button(eye, false, Modifiers::ALT);
        bench.steps(2);
        assert_eq!(bench.app().state.layers_shown, expected);
    }
}

#[test]
fn a_layer_is_merged_into_another_as_one_step() {
    let mut bench = Bench::new();
    bench.off();
    let before = bench.frame().layout.clone();
    let walkway = before.count(BevLayer::Walkway);
    assert!(walkway > 0);
    bench.harness.get_by_label("Paint walkway").click_secondary();
    bench.steps(3);
    bench.click("Carpark area");
    let after = bench.frame().layout.clone();
    assert_eq!(after.count(BevLayer::Walkway), 0);
    assert_eq!(
        after.count(BevLayer::CarparkArea),
        before.count(BevLayer::CarparkArea) + walkway
    );
    assert_eq!(bench.history(), ["Open", "Merge layers"]);
    bench.key(Modifiers::COMMAND, Key::Z);
    assert!(bench.frame().layout == before);
}

#[test]
fn distances_are_measured_and_stay() {
    let mut bench = Bench::new();
    bench.off();
    bench.click("Measure");
    bench.click_at(-20.0, 20.0, Modifiers::NONE);
    bench.click_at(-10.0, 20.0, Modifiers::NONE);
    let points = bench.app().state.tools.toolbox.points_m(measure::ID).to_vec();
    assert!((points[0].distance(points[1]) - 10.0).abs() < 0.1);
    // A corner of the car catches the third.
    let corner = bench.car(7).footprint()[0];
    bench.click_at(corner.x + 0.2, corner.y + 0.2, Modifiers::NONE);
    assert_eq!(bench.app().state.tools.toolbox.points_m(measure::ID)[2], corner);
    bench.key(Modifiers::NONE, Key::Escape);
    assert!(bench.app().state.tools.toolbox.points_m(measure::ID).is_empty());
    assert_eq!(bench.app().state.tool, measure::ID);
    assert_eq!(bench.history(), ["Open"]);
}

#[test]
fn boxes_of_real_sizes_are_placed() {
    let mut bench = Bench::new();
    bench.off();
    bench.key(Modifiers::NONE, Key::A);
    bench.click("Add bus");
    bench.app().state.tools.variants.insert(Class::Bus, 2);
    bench.click_at(-15.0, 2.0, Modifiers::NONE);
    let b = bench.car(8);
    assert_eq!(b.size_m, DVec3::new(18.0, 2.55, 3.1));
    assert_eq!(b.center_m.z, 1.55);
}

#[test]
fn voxels_are_drawn_chosen_and_pulled_in_the_3d_view() {
    let mut bench = Bench::with(true);
    bench.off();
    bench.steps(4);
    bench
        .app()
        .views
        .view3d
        .preset(viewport::ViewPreset::Top, scene::Extent::WINDOW);
    bench.steps(4);
    let pane = bench.pane("3D view");
    let at = |x: f32, y: f32| pane.center() + egui::vec2(x, y);
    bench.app().state.voxel_class = Class::Manmade;
    bench.ask(ToolCommand::Shortcut("voxel_block"));
    bench.app().state.tools.voxel_height = 2;
    let before = bench.frame();
    bench.press_and_move(&[at(-100.0, -120.0), at(-60.0, -90.0)], Modifiers::NONE);
    bench.harness.event(egui::Event::MouseWheel {
        unit: egui::MouseWheelUnit::Line,
        delta: egui::vec2(0.0, 1.0),
        modifiers: Modifiers::NONE,
        phase: egui::TouchPhase::Move,
        source: egui::MouseWheelSource::Unknown,
    });
    bench.steps(2);
    bench.button(at(-60.0, -90.0), false, Modifiers::NONE);
    bench.steps(2);
    let block = bench.frame().painted.count_set();
    assert!(
        block > 30 && block.is_multiple_of(3),
        "{block} voxels, three layers"
    );
    assert_eq!(bench.history(), ["Open", "Attach voxels"]);
    // The wand takes the block, whose voxels are then another class, then none.
    bench.ask(ToolCommand::Shortcut("voxel_wand"));
    bench.drag(&[at(-80.0, -105.0)], Modifiers::NONE);
    assert_eq!(bench.app().state.tools.voxels.len(), block);
    bench.app().state.voxel_class = Class::Vegetation;
    bench.steps(2);
    bench.click("Recolour them");
    let count = |bench: &Bench, class: Class| bench.frame().occupancy.class_counts()[class as usize];
    let vegetation = count(&bench, Class::Vegetation);
    assert!(vegetation >= block);
    // Pulled up from above nothing moves along the ray; seen from the side it does.
    bench
        .app()
        .views
        .view3d
        .preset(viewport::ViewPreset::Perspective, scene::Extent::WINDOW);
    bench.steps(4);
    bench.ask(ToolCommand::Shortcut("symmetry"));
    bench.ask(ToolCommand::Shortcut("voxel_fill"));
    bench.app().state.verb = app::tools::VoxelVerb::Remove;
    bench.app().state.choose_voxels(vec![[1, 2, 3]], Joins::Replace);
    bench.ask(ToolCommand::Delete);
    assert!(bench.app().state.tools.voxels.is_empty());
    while bench.app().document.can_undo() {
        bench.key(Modifiers::CTRL, Key::Z);
    }
    assert_eq!(bench.frame(), before);
}

#[test]
fn a_region_is_marked_and_asked_for_though_nothing_was_edited() {
    let mut bench = Bench::new();
    bench.off();
    bench.click("Region");
    let corners = [bench.bev(-20.0, 20.0), bench.bev(-12.0, 28.0)];
    bench.drag(&corners, Modifiers::NONE);
    let marked = bench.app().state.tools.region.count();
    assert!((25..=49).contains(&marked), "{marked}");
    let corner = [bench.bev(-20.0, 20.0), bench.bev(-17.0, 23.0)];
    bench.drag(&corner, Modifiers::SHIFT);
    assert!(bench.app().state.tools.region.count() < marked);
    assert_eq!(bench.history(), ["Open"]);
    bench.click("Inpaint");
    let params = bench
        .app()
        .generation
        .live
        .running
        .as_ref()
        .expect("asked for")
        .key
        .params
        .clone();
    assert_eq!(params.inpaint, bench.app().state.tools.region);
    assert!(params.strength > 0.0);
    assert_eq!(
        bench.started.recv_timeout(super::bench::PATIENCE),
        Ok(RegionMode::Auto)
    );
    bench
        .orders
        .send(super::bench::Do::Finish)
        .expect("the pipeline listens");
    bench.wait_until("the end", |b| b.app().generation.live.running.is_none());
    assert!(
        bench.app().generation.receipt.is_some(),
        "a result, not a warm-up"
    );
    bench.click("Clear region");
    assert!(bench.app().state.tools.region.is_empty());
}
