//! Things beside the road: drawn, chosen, raised, moved, deleted and listed, and all of it undone.

use std::sync::Arc;

use app::Command;
use app::tools::ToolCommand;
use app::tools::things::ThingCommand;
use editor::Edit;
use editor::tools::beside;
use egui::{Key, Modifiers};
use egui_kittest::kittest::Queryable;
use glam::{DVec2, DVec3};
use scene::background::{Building, LineKind, SceneryLine, Tree, TreeKind};
use scene::{Background, Class, Form, ThingId, Window};

use super::bench::Bench;

impl Bench {
    fn background(&self) -> Arc<Background> {
        self.harness.state().document.scene().background.clone()
    }

    fn click_ground(&mut self, x_m: f64, y_m: f64, modifiers: Modifiers) {
        let at = self.bev(x_m, y_m);
        self.drag(&[at], modifiers);
        // Two clicks in short succession would be a double one.
        self.steps(30);
    }

    fn things_chosen(&mut self) -> Vec<u32> {
        let chosen = &self.app().state.tools.things.chosen;
        chosen.iter().map(|id| id.0).collect()
    }

    /// Trees 1 to 3 at x = -20, -12 and -4, y = 22.
    fn tree_row(&mut self) {
        let tree = |i: u32| {
            Form::Tree(Tree {
                position_m: DVec2::new(-28.0 + 8.0 * f64::from(i), 22.0),
                height_m: 6.0,
                crown_radius_m: 2.0,
                kind: TreeKind::Broadleaf,
            })
        };
        let forms = (1..=3).map(tree).collect();
        let ctx = self.harness.ctx.clone();
        let plant = Command::Apply("Plant", vec![Edit::AddThings { forms }]);
        self.app().execute(plant, &ctx);
        self.off();
        self.steps(2);
    }

    fn count(&self, class: Class) -> usize {
        self.frame().occupancy.class_counts()[class as usize]
    }
}

#[test]
fn a_building_is_drawn_and_raised_a_row_deleted_a_hedge_drawn_and_all_undone() {
    let mut bench = Bench::new();
    bench.tree_row();
    let (before, frame) = (bench.background(), bench.frame());
    bench.click("Building");
    assert_eq!(bench.app().state.tool, beside::building::ID);
    let way = [bench.bev(5.0, 18.0), bench.bev(17.0, 26.0)];
    bench.press_and_move(&way, Modifiers::NONE);
    assert!(bench.app().document.is_dragging(), "shown while it is drawn");
    bench.button(way[1], false, Modifiers::NONE);
    bench.steps(2);
    let id = ThingId(4);
    let height = |b: &Bench| b.background().get(id).map(|t| t.form.height_m());
    assert_eq!(height(&bench), Some(12.0));
    assert_eq!(bench.things_chosen(), [4]);
    let [x, y] = Window::column_at(6.0, 20.0).expect("inside");
    assert_eq!(bench.frame().occupancy.get(x, y, 5), Class::Manmade.id());
    assert_eq!(
        bench.frame().occupancy,
        bench.frame().source.occupancy,
        "nothing waits"
    );
    // Two storeys more by the inspector, one less by its key.
    bench.click("One storey more");
    bench.click("One storey more");
    assert_eq!(height(&bench), Some(18.0));
    bench.key(Modifiers::NONE, Key::OpenBracket);
    assert_eq!(height(&bench), Some(15.0));
    bench.key(Modifiers::NONE, Key::CloseBracket);
    assert_eq!(
        bench.history()[2..],
        [
            "Add building",
            "Raise building",
            "Raise building",
            "Lower building",
            "Raise building"
        ]
    );

    // The row of trees, by a marquee.
    bench.key(Modifiers::NONE, Key::V);
    let corners = [bench.bev(-25.0, 26.0), bench.bev(0.0, 18.0)];
    bench.drag(&corners, Modifiers::NONE);
    assert_eq!(bench.things_chosen(), [1, 2, 3]);
    let green = bench.count(Class::Vegetation);
    bench.key(Modifiers::NONE, Key::Delete);
    assert!(bench.count(Class::Vegetation) < green);
    assert_eq!(bench.background().len(), 1);

    bench.key(Modifiers::SHIFT, Key::L);
    assert_eq!(bench.app().state.tool, beside::line::ID);
    for [x, y] in [[-20.0, 22.0], [-10.0, 22.0], [-10.0, 30.0]] {
        bench.click_ground(x, y, Modifiers::NONE);
    }
    // One point too many is taken back.
    bench.click_ground(0.0, 30.0, Modifiers::NONE);
    bench.key(Modifiers::NONE, Key::Backspace);
    bench.key(Modifiers::NONE, Key::Enter);
    let hedge = bench.background().get(ThingId(5)).expect("a hedge").form.clone();
    assert!(
        matches!(&hedge, Form::Line(l) if l.kind == LineKind::Hedge && l.points_m.len() == 3),
        "{hedge:?}"
    );
    assert_eq!(bench.history()[7..], ["Remove 3 trees", "Add hedge"]);
    let after = bench.background();

    while bench.app().document.position() > 1 {
        bench.key(Modifiers::CTRL, Key::Z);
    }
    assert_eq!((bench.background(), bench.frame()), (before, frame));
    while bench.app().document.can_redo() {
        bench.key(Modifiers::CTRL, Key::Y);
    }
    assert_eq!(bench.background(), after);
}

#[test]
fn things_are_chosen_moved_copied_turned_and_set_to_the_kerb() {
    let mut bench = Bench::new();
    bench.tree_row();
    bench.key(Modifiers::NONE, Key::V);
    bench.click_ground(-20.0, 22.5, Modifiers::NONE);
    assert_eq!(bench.things_chosen(), [1]);
    bench.click_ground(-4.0, 22.0, Modifiers::SHIFT);
    assert_eq!(bench.things_chosen(), [1, 3]);
    // Boxes join by Shift, and go along.
    bench.click_ground(14.0, 3.0, Modifiers::SHIFT);
    let way = [bench.bev(-20.0, 22.0), bench.bev(-18.0, 25.0)];
    bench.drag(&way, Modifiers::NONE);
    let at = |b: &Bench, id: u32| b.background().get(ThingId(id)).expect("there").form.middle_m();
    assert!(
        at(&bench, 1).distance(DVec2::new(-18.0, 25.0)) < 0.15,
        "{}",
        at(&bench, 1)
    );
    assert!(at(&bench, 3).distance(DVec2::new(-2.0, 25.0)) < 0.15);
    assert_eq!(at(&bench, 2), DVec2::new(-12.0, 22.0));
    let car = bench.frame().boxes[&scene::BoxId(7)].center_m.truncate();
    assert!(car.distance(DVec2::new(16.0, 6.0)) < 0.15, "{car}");
    assert_eq!(bench.history()[2..], ["Move 3 boxes and things"]);
    // An empty place drops all of it; a drag over what is not chosen moves nothing.
    bench.click_ground(-30.0, -30.0, Modifiers::NONE);
    assert!(!bench.app().state.any_chosen());
    let way = [bench.bev(-12.0, 22.0), bench.bev(-12.0, 27.0)];
    bench.drag(&way, Modifiers::NONE);
    assert_eq!(at(&bench, 2), DVec2::new(-12.0, 22.0));
    bench.click("All trees");
    assert_eq!(bench.things_chosen(), [1, 2, 3]);
    bench.key(Modifiers::CTRL, Key::D);
    assert_eq!(bench.things_chosen(), [4, 5, 6]);
    bench.key(Modifiers::NONE, Key::ArrowLeft);
    bench.key(Modifiers::NONE, Key::C);
    let history = bench.history();
    assert_eq!(
        history[3..],
        ["Duplicate 3 trees", "Nudge 3 trees", "Turn 3 trees"]
    );
    bench.click("List trees");
    bench.click("Thing 2 tree");
    bench.key(Modifiers::NONE, Key::D);
    let layout = bench.frame().layout.clone();
    let kerb = editor::kerb::nearest_kerb(&layout, at(&bench, 2), 2.0).expect("at the kerb");
    assert!(kerb.distance_m < 0.8, "{kerb:?}");
    assert!(
        bench
            .history()
            .last()
            .is_some_and(|l| l == "Set to the kerb: tree")
    );
}

#[test]
fn locked_and_hidden_things_stay_as_they_are() {
    let mut bench = Bench::new();
    bench.tree_row();
    bench.click("All trees");
    bench.click("Lock scenery");
    assert!(bench.things_chosen().is_empty(), "what is locked is not chosen");
    let before = bench.background();
    bench.click_ground(-20.0, 22.0, Modifiers::NONE);
    assert!(bench.things_chosen().is_empty());
    bench.key(Modifiers::SHIFT, Key::T);
    bench.click_ground(10.0, 22.0, Modifiers::NONE);
    let ctx = bench.harness.ctx.clone();
    let remove = Edit::RemoveThings {
        ids: vec![ThingId(1)],
    };
    bench.app().execute(Command::Apply("Remove", vec![remove]), &ctx);
    assert_eq!(bench.background(), before);
    bench.click("Lock scenery");
    bench.click_ground(10.0, 22.0, Modifiers::NONE);
    assert_eq!(bench.background().len(), 4, "open again");
    bench.key(Modifiers::NONE, Key::V);
    bench.click("Show scenery");
    bench.click_ground(-20.0, 22.0, Modifiers::NONE);
    assert!(bench.things_chosen().is_empty());
}

#[test]
fn strokes_posts_corners_and_fields() {
    let mut bench = Bench::new();
    bench.off();
    bench.key(Modifiers::SHIFT, Key::S);
    let way = [
        bench.bev(-20.0, 24.0),
        bench.bev(-8.0, 24.0),
        bench.bev(-8.0, 30.0),
    ];
    bench.drag(&way, Modifiers::NONE);
    bench.key(Modifiers::SHIFT, Key::T);
    let way = [bench.bev(0.0, 28.0), bench.bev(30.0, 28.0)];
    bench.drag(&way, Modifiers::NONE);
    let trees = bench.background().len() - 1;
    assert!((3..=6).contains(&trees), "{trees}");
    bench.key(Modifiers::SHIFT, Key::P);
    bench.click("Place bus stop");
    bench.click_ground(5.0, 14.0, Modifiers::NONE);
    let history = bench.history();
    assert_eq!(
        history[1..],
        [
            "Add shrubs".to_owned(),
            format!("Add {trees} trees"),
            "Add bus stop".into()
        ]
    );
    // A wall drawn elsewhere, one corner of it pulled.
    let points_m = vec![DVec2::new(-20.0, -24.0), DVec2::new(-10.0, -24.0)];
    let wall = Form::Line(SceneryLine::typical(LineKind::Wall, points_m));
    let ctx = bench.harness.ctx.clone();
    bench.app().execute(
        Command::Apply("Add wall", vec![Edit::AddThings { forms: vec![wall] }]),
        &ctx,
    );
    bench.key(Modifiers::NONE, Key::V);
    bench.click_ground(-15.0, -24.0, Modifiers::NONE);
    let way = [bench.bev(-10.0, -24.0), bench.bev(-10.0, -30.0)];
    bench.drag(&way, Modifiers::NONE);
    let id = ThingId(trees as u32 + 3);
    let corner = bench.background().get(id).expect("the wall").form.points_m()[1];
    assert!(corner.distance(DVec2::new(-10.0, -30.0)) < 0.15, "{corner}");
    // Its height by a drag of the field: one step.
    let at = bench.harness.get_by_label("Height").rect().center();
    bench.drag(&[at, at + egui::vec2(40.0, 0.0)], Modifiers::NONE);
    let height = bench.background().get(id).expect("the wall").form.height_m();
    assert!(height > 1.7, "{height}");
    let history = bench.history();
    assert_eq!(history[4..], ["Add wall", "Reshape wall", "Raise wall"]);
    // Escape drops an outline that was begun; the tool stays.
    bench.key(Modifiers::SHIFT, Key::B);
    bench.click_ground(20.0, -20.0, Modifiers::NONE);
    bench.click_ground(30.0, -20.0, Modifiers::NONE);
    assert_eq!(
        bench
            .app()
            .state
            .tools
            .toolbox
            .points_m(beside::building::ID)
            .len(),
        2
    );
    bench.key(Modifiers::NONE, Key::Escape);
    assert!(
        bench
            .app()
            .state
            .tools
            .toolbox
            .points_m(beside::building::ID)
            .is_empty()
    );
    assert_eq!(bench.app().state.tool, beside::building::ID);
    let raise = ToolCommand::Thing(ThingCommand::Raise(1));
    bench.app().execute(Command::Tools(raise), &ctx);
    assert_eq!(bench.history().len(), 8, "the wall is chosen still");
}

#[test]
fn things_are_chosen_raised_and_drawn_in_the_3d_view() {
    let mut bench = Bench::with(true);
    bench.tree_row();
    let house = Building::rectangle(DVec2::new(10.0, 22.0), DVec2::new(6.0, 4.0), DVec2::X, 6.0);
    let ctx = bench.harness.ctx.clone();
    let add = Edit::AddThings {
        forms: vec![Form::Building(house)],
    };
    bench.app().execute(Command::Apply("Add", vec![add]), &ctx);
    bench.steps(6);
    let pane = bench.pane("3D view");
    let camera = bench.app().views.view3d.camera;
    let on_screen = |p_m: DVec3| {
        let size = [pane.width().round() as u32, pane.height().round() as u32];
        let pixel = camera.project(p_m, size).expect("in front");
        pane.min + egui::vec2(pixel.x as f32, pixel.y as f32)
    };
    let roof = on_screen(DVec3::new(7.0, 20.0, 6.0));
    assert!(pane.contains(roof), "{roof} in {pane}");
    bench.drag(&[roof], Modifiers::NONE);
    assert_eq!(bench.things_chosen(), [4]);
    // The knob over its middle raises it.
    let knob = on_screen(DVec3::new(10.0, 22.0, 6.6));
    let higher = on_screen(DVec3::new(10.0, 22.0, 9.6));
    bench.drag(&[knob, higher], Modifiers::NONE);
    let height = |b: &Bench| b.background().get(ThingId(4)).expect("the house").form.height_m();
    assert!((height(&bench) - 9.0).abs() < 0.4, "{}", height(&bench));
    assert_eq!(bench.history().last().map(String::as_str), Some("Raise building"));
    // A drag of it moves it on the ground; its voxels end with the grid, at 5.4 m.
    let way = [7.0, 4.0].map(|x| on_screen(DVec3::new(x, 20.0, 5.4)));
    bench.drag(&way, Modifiers::NONE);
    let middle = bench
        .background()
        .get(ThingId(4))
        .expect("the house")
        .form
        .middle_m();
    assert!(middle.distance(DVec2::new(7.0, 22.0)) < 0.6, "{middle}");
    // Two clicks in short succession would be a double one.
    bench.steps(30);
    bench.key(Modifiers::SHIFT, Key::T);
    let place = DVec2::new(14.0, -13.0);
    let stamp = on_screen(place.extend(0.0));
    assert!(pane.contains(stamp), "{stamp} in {pane}");
    bench.drag(&[stamp], Modifiers::NONE);
    bench.steps(30);
    let tree = bench
        .background()
        .get(ThingId(5))
        .expect("a tree")
        .form
        .middle_m();
    assert!(tree.distance(place) < 1.5, "{tree}");
}

#[test]
fn things_are_put_in_rows_and_mirrored_with_boxes() {
    let mut bench = Bench::new();
    bench.tree_row();
    bench.key(Modifiers::NONE, Key::V);
    bench.click_ground(-20.0, 22.0, Modifiers::NONE);
    assert_eq!(bench.things_chosen(), [1]);
    bench.key(Modifiers::CTRL | Modifiers::SHIFT, Key::D);
    assert!(bench.harness.query_by_label("4 copies come").is_some());
    bench.click("Add copies");
    assert_eq!(bench.things_chosen(), [4, 5, 6, 7]);
    let at = |b: &Bench, id: u32| b.background().get(ThingId(id)).expect("there").form.middle_m();
    let step = at(&bench, 5) - at(&bench, 4);
    assert_eq!(step, DVec2::new(editor::rows::CopyRows::default().spacing_m, 0.0));
    bench.key(Modifiers::CTRL, Key::Z);
    assert_eq!(bench.background().len(), 3);

    // A tree and the car change sides in one step.
    bench.click_ground(-20.0, 22.0, Modifiers::NONE);
    bench.click_ground(14.0, 3.0, Modifiers::SHIFT);
    bench.key(Modifiers::CTRL, Key::M);
    let car = bench.frame().boxes[&scene::BoxId(7)].center_m;
    assert_eq!(car.truncate(), DVec2::new(14.0, -3.0));
    assert_eq!(bench.things_chosen(), [1], "what is chosen stays chosen");
    assert_eq!(at(&bench, 1), DVec2::new(-20.0, -22.0));
    assert_eq!(bench.background().len(), 3);
    assert_eq!(bench.history()[2..], ["Mirror 2 boxes and things"]);
    bench.key(Modifiers::CTRL, Key::Z);
    assert_eq!(at(&bench, 1), DVec2::new(-20.0, 22.0));

    // One that is locked stays, and is not doubled.
    bench.click_ground(-20.0, 22.0, Modifiers::NONE);
    let ctx = bench.harness.ctx.clone();
    let how = scene::Arrangement::Lock;
    let lock = Edit::Arrange {
        boxes: Vec::new(),
        things: vec![ThingId(1)],
        how,
    };
    bench.app().execute(Command::Apply("Lock", vec![lock]), &ctx);
    bench
        .app()
        .state
        .choose_things(&[ThingId(1)], app::tools::Choose::Only);
    bench
        .app()
        .execute(Command::Tools(ToolCommand::Mirror(false)), &ctx);
    assert_eq!(bench.background().len(), 3);
    assert_eq!(at(&bench, 1), DVec2::new(-20.0, 22.0));
}
