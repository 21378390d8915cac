//! The tools together, driven as a view would drive them, without one.

use glam::DVec2;

use super::testing::{NONE, SHIFT, Table};
use super::*;
use crate::{Edit, Shape};
use scene::{BevLayer, BoxId, Class, Extent, Form};

fn of<'a>(toolbox: &'a mut Toolbox, table: &mut Table, id: ToolId) -> &'a mut dyn Tool {
    toolbox.take(&mut table.hand, id);
    toolbox.tool_mut(id)
}

fn label(act: &Act) -> String {
    match act {
        Act::Commit(label) | Act::Apply(label, _) | Act::AddBoxes(label, ..) => label.to_string(),
        other => format!("{other:?}"),
    }
}

fn with_car(table: &mut Table) {
    let b = table
        .hand
        .new_box(table.scene.frame(), Class::Car, DVec2::ZERO, 0.0)
        .expect("a car");
    table.scene.change_canvas(|f| f.boxes.insert(b.id, b));
}

#[test]
fn a_stroke_is_shown_while_it_is_drawn_and_ends_as_one_step() {
    let (mut table, mut toolbox) = (Table::new(), Toolbox::default());
    let tool = of(&mut toolbox, &mut table, brush::ID);
    assert!(table.press(tool, 0.0, 0.0, NONE).holds);
    table.drag(tool, 0.0, 0.0);
    // Nearer than 0.1 m nothing is new.
    assert_eq!(table.drag(tool, 0.05, 0.0).acts, []);
    let shown = table.drag(tool, 3.0, 0.0);
    let [Act::Preview(edits)] = &shown.acts[..] else {
        panic!("{shown:?}");
    };
    assert!(
        matches!(&edits[..], [Edit::PaintBev { shape: Shape::Line { points_m, .. }, value: true, .. }] if points_m.len() == 2)
    );
    assert_eq!(
        table.release(tool, 3.0, 0.0).acts,
        [Act::Commit("Paint layer".into())]
    );
    table.press(tool, 0.0, 0.0, SHIFT);
    assert_eq!(
        table.release(tool, 0.0, 0.0).acts,
        [Act::Commit("Erase layer".into())]
    );
}

#[test]
fn an_outline_grows_by_clicks_and_the_key_of_another_shape_drops_it() {
    let (mut table, mut toolbox) = (Table::new(), Toolbox::default());
    assert!(toolbox.shortcut(&mut table.hand, "shape_polygon"));
    assert_eq!(
        (table.hand.tool, table.hand.shape),
        (brush::ID, PaintShape::Polygon)
    );
    let tool = toolbox.tool_mut(brush::ID);
    assert_eq!(tool.wants(), Wants::Nothing);
    for (x, y) in [(0.0, 0.0), (8.0, 0.0), (8.0, 6.0), (20.0, 6.0)] {
        assert_eq!(table.click(tool, x, y, NONE).acts, []);
    }
    assert_eq!((tool.points_m().len(), tool.wants()), (4, Wants::Points));
    assert!(table.key(tool, Key::Backspace).taken);
    let closed = table.key(tool, Key::Enter);
    let [Act::Apply(label, edits)] = &closed.acts[..] else {
        panic!("{closed:?}");
    };
    assert_eq!(label, "Paint polygon");
    assert!(
        matches!(&edits[..], [Edit::PaintBev { shape: Shape::Polygon { points_m }, .. }] if points_m.len() == 3)
    );
    table.click(tool, 0.0, 0.0, NONE);
    // The same key again lays streets.
    toolbox.shortcut(&mut table.hand, "shape_polygon");
    assert_eq!(table.hand.shape, PaintShape::Street);
    assert!(toolbox.points_m(brush::ID).is_empty());
    assert!(!toolbox.shortcut(&mut table.hand, "no such action"));
}

#[test]
fn picking_takes_the_layer_and_filling_what_is_alike() {
    let (mut table, mut toolbox) = (Table::new(), Toolbox::default());
    for x in 90..110 {
        for y in 90..110 {
            table
                .scene
                .change_canvas(|f| f.layout.set(BevLayer::Walkway, x, y, true));
        }
    }
    let tool = of(&mut toolbox, &mut table, brush::ID);
    table.hand.shape = PaintShape::Pick;
    assert_eq!(table.click(tool, 1.0, 1.0, NONE), Response::none());
    assert_eq!(
        (table.hand.layer, table.hand.shape),
        (BevLayer::Walkway, PaintShape::Stroke)
    );
    table.hand.shape = PaintShape::Fill;
    let filled = table.click(tool, 1.0, 1.0, SHIFT);
    let [Act::Apply(label, edits)] = &filled.acts[..] else {
        panic!("{filled:?}");
    };
    assert_eq!(label, "Fill: erase");
    assert!(
        matches!(&edits[..], [Edit::PaintBev { shape: Shape::Cells(cells), value: false, .. }] if cells.len() == 400)
    );
}

#[test]
fn boxes_are_placed_chosen_and_moved_by_what_is_typed() {
    let (mut table, mut toolbox) = (Table::new(), Toolbox::default());
    let tool = of(&mut toolbox, &mut table, add_box::ID);
    let placed = table.click(tool, 5.0, 6.0, NONE);
    assert!(
        matches!(&placed.acts[..], [Act::AddBoxes(label, edits, ids)] if label == "Add box" && edits.len() == 1 && *ids == [BoxId(1)])
    );
    with_car(&mut table);
    let tool = of(&mut toolbox, &mut table, select::ID);
    table.click(tool, 1.0, 0.0, NONE);
    assert_eq!(table.hand.selected, Some(BoxId(1)));
    table.click(tool, 30.0, 30.0, NONE);
    assert_eq!(table.hand.selected, None);
    // A drag along x, typed to 7 m, ended by Enter while the button is still down.
    table.press(tool, 0.5, 0.0, NONE);
    assert_eq!(tool.wants(), Wants::Drag);
    table.drag(tool, 2.5, 0.3);
    assert!(table.key(tool, Key::Axis(0)).taken);
    let shown = table.key(tool, Key::Digit('7'));
    let [Act::Preview(edits)] = &shown.acts[..] else {
        panic!("{shown:?}");
    };
    assert!(
        matches!(&edits[..], [Edit::MoveBox { center_m: Some(c), .. }] if (c.x - 7.0).abs() < 1e-9 && c.y == 0.0),
        "{edits:?}"
    );
    let ended = table.key(tool, Key::Enter);
    assert!(ended.done && ended.acts.last().map(label).as_deref() == Some("Move box"));
    assert_eq!(table.release(tool, 2.5, 0.3), Response::none());
    // A marquee.
    table.hand.choose(&[], Choose::Only);
    table.press(tool, -10.0, -10.0, NONE);
    table.drag(tool, 10.0, 10.0);
    assert_eq!(table.hand.chosen(), []);
    table.release(tool, 10.0, 10.0);
    assert_eq!(table.hand.chosen(), [BoxId(1)]);
}

#[test]
fn regions_are_marked_and_points_measured() {
    let (mut table, mut toolbox) = (Table::new(), Toolbox::default());
    let tool = of(&mut toolbox, &mut table, region::ID);
    table.press(tool, 0.0, 0.0, SHIFT);
    table.drag(tool, 4.0, -2.0);
    let marked = table.release(tool, 4.0, -2.0);
    let corners = InpaintArea::Rect(DVec2::new(-0.2, -2.2), DVec2::new(4.2, 0.2));
    assert_eq!(marked.acts, [Act::Mark(corners.clone(), false)]);
    // Ctrl takes away here, too.
    let ctrl = Modifiers { ctrl: true, ..NONE };
    table.press(tool, 0.0, 0.0, ctrl);
    table.drag(tool, 4.0, -2.0);
    assert_eq!(table.release(tool, 4.0, -2.0).acts, [Act::Mark(corners, false)]);
    table.hand.region_shape = RegionShape::Brush;
    table.press(tool, 0.0, 0.0, NONE);
    let on_its_way = table.drag(tool, 1.0, 0.0);
    assert_eq!(
        on_its_way.acts,
        [Act::Mark(InpaintArea::Stroke(DVec2::ZERO, DVec2::X, 3.2), true)]
    );
    assert_eq!(table.release(tool, 1.0, 0.0), Response::none());

    let tool = of(&mut toolbox, &mut table, measure::ID);
    table.click(tool, 0.0, 0.0, NONE);
    table.click(tool, 3.0, 4.0, NONE);
    assert_eq!((tool.points_m().len(), tool.wants()), (2, Wants::Escape));
    let said =
        |s: &ToolOption| matches!(&s.control, setting::Control::Result(text) if text.starts_with("5.00 m"));
    assert!(tool.options(&table.hand).iter().any(said));
    assert!(table.key(tool, Key::Escape).taken && tool.points_m().is_empty());
}

/// Cars of the ids 1 to 3 at x = 0, 10 and 20 m.
fn with_cars(table: &mut Table) {
    for x in [0.0, 10.0, 20.0] {
        let b = table
            .hand
            .new_box(table.scene.frame(), Class::Car, DVec2::new(x, 0.0), 0.0)
            .expect("a car");
        table.scene.change_canvas(|f| f.boxes.insert(b.id, b));
    }
}

#[test]
fn ctrl_takes_what_a_rectangle_or_lasso_goes_around_out_of_the_selection() {
    let (mut table, mut toolbox) = (Table::new(), Toolbox::default());
    with_cars(&mut table);
    let tool = of(&mut toolbox, &mut table, select::ID);
    let ctrl = Modifiers { ctrl: true, ..NONE };
    table.hand.choose(&[1, 2, 3].map(BoxId), Choose::Only);
    table.press(tool, 6.0, -8.0, ctrl);
    table.drag(tool, 14.0, 8.0);
    table.release(tool, 14.0, 8.0);
    assert_eq!(table.hand.chosen(), [BoxId(3), BoxId(1)]);
    table.hand.choose_by = ChooseBy::Lasso;
    // It may begin on a box.
    table.press(tool, 20.0, 0.0, ctrl);
    for (x, y) in [(15.0, -5.0), (25.0, -5.0), (25.0, 5.0), (15.0, 5.0)] {
        table.drag(tool, x, y);
    }
    table.release(tool, 15.0, 5.0);
    assert_eq!(table.hand.chosen(), [BoxId(1)]);
    // A click with Ctrl chooses nothing.
    table.click(tool, 10.0, 0.0, ctrl);
    assert_eq!(table.hand.chosen(), [BoxId(1)]);
    table.click(tool, 0.0, 0.0, ctrl);
    assert_eq!(table.hand.chosen(), []);
}

#[test]
fn a_polygon_chooses_boxes_and_marks_regions_corner_by_corner() {
    let (mut table, mut toolbox) = (Table::new(), Toolbox::default());
    with_cars(&mut table);
    for by in [ChooseBy::Lasso, ChooseBy::Polygon] {
        toolbox.shortcut(&mut table.hand, "lasso");
        assert_eq!((table.hand.tool, table.hand.choose_by), (select::ID, by));
    }
    let corners = [(-5.0, -5.0), (14.0, -5.0), (14.0, 5.0), (-5.0, 5.0)];
    let tool = toolbox.tool_mut(select::ID);
    for (x, y) in corners {
        table.click(tool, x, y, NONE);
    }
    // The second press of a double click is no corner, and one that is taken back is none.
    table.click(tool, -5.0, 5.0, NONE);
    table.click(tool, 40.0, 40.0, NONE);
    assert!(table.key(tool, Key::Backspace).taken);
    assert_eq!(
        (tool.wants(), tool.draws_in()),
        (Wants::Points, Some(ViewKind::Bev))
    );
    assert!(
        tool.overlay(&table.sight(0.0, 0.0))
            .iter()
            .any(|m| matches!(m, ToolMark::Dashed(p, _) if p.len() == 6))
    );
    assert_eq!(table.hand.chosen(), []);
    assert!(table.tell(tool, Event::DoubleClick).taken);
    assert_eq!(table.hand.chosen(), [BoxId(2), BoxId(1)]);
    assert_eq!(tool.wants(), Wants::Nothing);
    // What is held at the first corner counts.
    let ctrl = Modifiers { ctrl: true, ..NONE };
    for ((x, y), held) in [
        ((-5.0, -5.0), ctrl),
        ((5.0, -5.0), NONE),
        ((5.0, 5.0), NONE),
        ((-5.0, 5.0), NONE),
    ] {
        table.click(tool, x, y, held);
    }
    table.key(tool, Key::Enter);
    assert_eq!(table.hand.chosen(), [BoxId(2)]);
    // A click on the first corner closes it, too; each corner is marked.
    for (x, y) in [(-5.0, -5.0), (14.0, -5.0), (14.0, 5.0), (-5.0, 5.0)] {
        table.click(tool, x, y, NONE);
    }
    let dots = tool.overlay(&table.sight(0.0, 0.0));
    assert_eq!(dots.iter().filter(|m| matches!(m, ToolMark::Dot(..))).count(), 4);
    table.click(tool, -5.1, -5.0, NONE);
    assert_eq!(tool.wants(), Wants::Nothing);
    assert_eq!(table.hand.chosen(), [BoxId(2), BoxId(1)]);
    table.hand.choose(&[BoxId(2)], Choose::Only);
    // Fewer than three corners are no outline.
    table.click(tool, 1.0, 9.0, NONE);
    assert!(table.key(tool, Key::Enter).taken);
    assert_eq!(table.hand.chosen(), [BoxId(2)]);

    let tool = of(&mut toolbox, &mut table, region::ID);
    table.hand.region_shape = RegionShape::Polygon;
    for (x, y) in [(0.0, 0.0), (4.0, 0.0), (4.0, 4.0)] {
        assert_eq!(table.click(tool, x, y, SHIFT).acts, []);
    }
    let marked = table.key(tool, Key::Enter);
    let outline = [[0.0, 0.0], [4.0, 0.0], [4.0, 4.0]].map(DVec2::from_array);
    assert_eq!(
        marked.acts,
        [Act::Mark(InpaintArea::Outline(outline.to_vec()), false)]
    );
    table.click(tool, 1.0, 1.0, NONE);
    toolbox.take(&mut table.hand, select::ID);
    assert_eq!(toolbox.tool(region::ID).wants(), Wants::Nothing);
}

#[test]
fn things_are_drawn_and_another_tool_drops_what_is_half_drawn() {
    let (mut table, mut toolbox) = (Table::new(), Toolbox::default());
    let tool = of(&mut toolbox, &mut table, beside::tree::ID);
    let stamped = table.click(tool, 5.0, 5.0, NONE);
    assert!(
        matches!(&stamped.acts[..], [Act::Try(_), Act::AddThings(forms)] if matches!(&forms[..], [Form::Tree(_)])),
        "{stamped:?}"
    );
    let tool = of(&mut toolbox, &mut table, beside::line::ID);
    table.click(tool, 0.0, 0.0, NONE);
    let short = table.key(tool, Key::Enter);
    assert!(matches!(&short.acts[..], [Act::Cancel, Act::Note(text)] if text.contains("two points")));
    assert_eq!(tool.points_m().len(), 1);
    of(&mut toolbox, &mut table, select::ID);
    assert!(toolbox.points_m(beside::line::ID).is_empty());
    table.hand.things.locked = true;
    let tool = of(&mut toolbox, &mut table, beside::post::ID);
    let refused = table.press(tool, 0.0, 0.0, NONE);
    assert!(!refused.holds && matches!(&refused.acts[..], [Act::Note(_)]));
}

#[test]
fn every_option_that_is_listed_can_be_set() {
    let mut toolbox = Toolbox::default();
    let table = Table::new();
    for def in all() {
        let mut hand = Hand::default();
        let tool = toolbox.tool_mut(def.id);
        let mut settings = tool.options(&hand);
        assert!(
            matches!(settings[0].control, setting::Control::Title(_)),
            "{}",
            def.title
        );
        while let Some(setting) = settings.pop() {
            use setting::Control;
            let value = match setting.control {
                Control::Row(inner) | Control::Line(inner) => {
                    settings.extend(inner);
                    continue;
                }
                Control::Number(number) => {
                    let [low, high] = number.range;
                    Value::Number(if number.value == high { low } else { high })
                }
                Control::Segments { chosen, choices, .. } => Value::Index((chosen + 1) % choices.len()),
                Control::Toggle { on, .. } => Value::On(!on),
                Control::Rows { chosen, names, .. } => Value::Index((chosen + 1) % names.len()),
                Control::List { chosen, choices, .. } => Value::Index((chosen + 1) % choices.len()),
                _ => continue,
            };
            let before = tool.options(&hand);
            tool.set(&mut hand, table.scene.frame(), setting.id, value);
            assert_ne!(tool.options(&hand), before, "{}: {}", def.title, setting.id);
        }
    }
}

#[test]
fn names_are_there_once_and_every_tool_says_what_it_does() {
    let mut ids: Vec<&str> = all().iter().map(|t| t.id.0).collect();
    ids.sort_unstable();
    ids.dedup();
    assert_eq!(ids.len(), all().len());
    let mut names: Vec<&str> = all().iter().flat_map(|t| t.shortcuts).map(|s| s.id).collect();
    let count = names.len();
    names.sort_unstable();
    names.dedup();
    assert_eq!(names.len(), count, "an action twice");
    for tool in all() {
        assert!(
            shortcut(tool.id.0).is_some(),
            "{} cannot be taken by a key",
            tool.title
        );
        assert!(std::ptr::eq(tool.id.def(), *tool));
        let (hand, made) = (Hand::default(), (tool.make)());
        for view in [ViewKind::Bev, ViewKind::Space] {
            assert!(!made.hint(&hand, Some(view)).is_empty(), "{}", tool.title);
        }
        assert!(made.points_m().is_empty());
    }
}

#[test]
fn brushes_fills_and_drawn_things_reach_beyond_the_window() {
    let extent = Extent::new([-150, -110], [480, 320]).expect("sound");
    let (mut table, mut toolbox) = (Table::over(extent), Toolbox::default());
    let is_shown = |shown: &Response| {
        let [Act::Preview(edits) | Act::Try(edits)] = &shown.acts[..] else {
            return false;
        };
        !matches!(&edits[..], [Edit::AddThings { forms }] if forms.is_empty())
    };
    for id in [brush::ID, circle::ID, beside::shrubs::ID] {
        let tool = of(&mut toolbox, &mut table, id);
        table.press(tool, 100.0, 60.0, NONE);
        let shown = table.drag(tool, 104.0, 60.0);
        assert!(is_shown(&shown), "{id:?}: {shown:?}");
        let done = table.release(tool, 104.0, 60.0);
        assert!(!done.acts.is_empty(), "{id:?}");
        // Beside the map nothing is painted.
        table.press(tool, 300.0, 60.0, NONE);
        let shown = table.drag(tool, 304.0, 60.0);
        assert!(!is_shown(&shown), "{id:?}: {shown:?}");
        table.tell(tool, Event::Cancel);
    }
    table.hand.shape = PaintShape::Fill;
    let tool = of(&mut toolbox, &mut table, brush::ID);
    let filled = table.click(tool, 100.0, 60.0, NONE);
    let [Act::Apply(_, edits)] = &filled.acts[..] else {
        panic!("{filled:?}");
    };
    assert!(
        matches!(&edits[..], [Edit::PaintBev { shape: Shape::Cells(cells), .. }] if cells.len() == extent.columns())
    );
}
