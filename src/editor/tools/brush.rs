//! The brush: strokes, rectangles, lines, outlines, streets and fills of a map layer. In space it draws strokes only.

use glam::DVec2;

use crate::{Edit, Shape, flood};
use language::{t, tf};
use scene::raster::disc_cells;
use scene::{BevLayer, Class, Extent, Frame};

use super::setting::{self, ToolOption, Value};
use super::{
    Act, At, Context, Cursor, DRAW_ORDER, Event, Hand, Hint, Key, PaintShape, Pointer, ReadonlyContext,
    Response, Role, Shortcut, Tool, ToolDef, ToolGroup, ToolId, ToolMark, ViewKind, When, hint_of,
};
use crate::flood::FillBounds;
use crate::roads::Street;

/// Its name.
pub const ID: ToolId = ToolId::BRUSH;

fn shape(hand: &mut Hand, shape: PaintShape) {
    (hand.tool, hand.shape) = (ID, shape);
}

const fn shortcut(id: &'static str, title: &'static str, keys: &'static str, set: fn(&mut Hand)) -> Shortcut {
    Shortcut {
        id,
        title,
        keys,
        when: When::Always,
        set,
    }
}

/// Its row of the table.
pub static DEF: ToolDef = ToolDef {
    id: ID,
    title: "Brush",
    key: "B",
    icon: "brush",
    group: ToolGroup::Scene,
    is_brush: true,
    paints: true,
    shortcuts: &[
        shortcut(ID.0, "Brush", "B", |h| shape(h, PaintShape::Stroke)),
        shortcut("shape_rectangle", "Brush: rectangle", "U", |h| {
            shape(h, PaintShape::Rectangle)
        }),
        shortcut("shape_line", "Brush: line", "L", |h| shape(h, PaintShape::Line)),
        shortcut("shape_polygon", "Brush: polygon; again: street", "P", |h| {
            let again = h.tool == ID && h.shape == PaintShape::Polygon;
            shape(
                h,
                if again {
                    PaintShape::Street
                } else {
                    PaintShape::Polygon
                },
            );
        }),
        shortcut("shape_street", "Brush: street", "", |h| {
            shape(h, PaintShape::Street)
        }),
        shortcut("shape_fill", "Brush: fill", "K", |h| shape(h, PaintShape::Fill)),
        shortcut("shape_pick", "Brush: pick a layer (or Alt+click)", "I", |h| {
            shape(h, PaintShape::Pick)
        }),
        shortcut("toggle_erase", "Paint or erase (or hold Shift)", "E", |h| {
            h.erase = !h.erase;
        }),
    ],
    make: || Box::new(Brush::default()),
};

/// Points of an outline that are nearer than this are one, m.
const APART_M: f64 = 0.05;
/// Points of a stroke are this far apart, m.
const STEP_M: f64 = 0.1;

/// Stroke or shape in progress, while the button is held.
#[derive(Clone, Debug, PartialEq)]
struct BrushDrag {
    what: DragShape,
    /// Points so far; a shape begins at the first. Ego frame, m.
    points_m: Vec<DVec2>,
    layer: BevLayer,
    width_m: f64,
    erase: bool,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum DragShape {
    Stroke,
    Rectangle,
    Line,
}

/// The brush.
#[derive(Clone, Debug, Default)]
pub struct Brush {
    drag: Option<BrushDrag>,
    /// Points of an outline or street that is being drawn, ego frame, m.
    points_m: Vec<DVec2>,
}

impl Tool for Brush {
    fn event(&mut self, cx: &mut Context<'_>, event: &Event) -> Response {
        match event {
            Event::Press(pointer) => self.press(cx, pointer),
            Event::Drag(pointer) => self.drag(cx, pointer),
            Event::Release(_) => match self.drag.take() {
                Some(drag) => Response::act(Act::Commit(drag.step().into())),
                None => Response::none(),
            },
            Event::Cancel => {
                self.drag = None;
                Response::none()
            }
            Event::DoubleClick | Event::Key(Key::Enter, ..) => self.close(cx),
            Event::Key(Key::Escape, ..) => {
                self.points_m.clear();
                Response::taken()
            }
            Event::Key(Key::Backspace, ..) => {
                self.points_m.pop();
                Response::taken()
            }
            Event::Pick(_) | Event::Key(..) | Event::Scroll(_) => Response::none(),
        }
    }

    fn hint(&self, hand: &Hand, _: Option<ViewKind>) -> Hint {
        let erase = if hand.erase { "Drag erases" } else { "Drag paints" };
        let mut parts = match hand.shape {
            PaintShape::Stroke => vec![erase, "Shift erases", "Ctrl straight", "Alt picks", "[ ] size"],
            PaintShape::Line => vec![erase, "Shift in steps of 15°", "[ ] size"],
            PaintShape::Rectangle => vec![erase, "Shift erases", "Alt picks"],
            PaintShape::Polygon => vec!["Click sets corners", "Enter closes", "Backspace takes back"],
            PaintShape::Street => vec!["Click sets points", "Enter builds", "Backspace takes back"],
            PaintShape::Fill => vec!["Click fills what is alike", "Shift erases", "Alt picks"],
            PaintShape::Pick => vec!["Click takes the layer"],
        };
        if BevLayer::GROUND.contains(&hand.layer) && parts[0] == "Drag paints" {
            parts[0] = "Drag replaces ground";
        }
        hint_of(&parts)
    }

    fn cursor(&self, sight: &ReadonlyContext<'_>) -> Cursor {
        match () {
            () if !sight.from_above() => Cursor::Crosshair,
            () if sight.hand.is_locked(sight.hand.layer) => Cursor::Forbidden,
            () if sight.hand.shape == PaintShape::Stroke => Cursor::Hidden,
            () => Cursor::Crosshair,
        }
    }

    fn overlay(&self, sight: &ReadonlyContext<'_>) -> Vec<ToolMark> {
        match sight.from_above() {
            true => self.over_map(sight),
            false => tops(sight).into_iter().collect(),
        }
    }

    fn options(&self, hand: &Hand) -> Vec<ToolOption> {
        let mut out = vec![
            ToolOption::title("Brush"),
            ToolOption::segments("shape", hand.shape, &PaintShape::ALL, 3),
        ];
        let street = &hand.street;
        match hand.shape {
            PaintShape::Polygon => out.push(ToolOption::text(
                "Click points. Enter or a double click closes, Backspace takes one back, Esc drops all.",
            )),
            PaintShape::Street => {
                let lanes = [0.0, Street::MAX_LANES as f64];
                let lane_m = [*Street::LANE_M.start(), *Street::LANE_M.end()];
                out.extend([
                    ToolOption::number("forward", "Lanes ahead", street.forward as f64, lanes, 0),
                    ToolOption::number("backward", "Lanes back", street.backward as f64, lanes, 0),
                    ToolOption::number("lane", "Lane, m", street.lane_m, lane_m, 1),
                    ToolOption::number("walk", "Walkway, m", street.walk_m, [0.0, 6.0], 1),
                    ToolOption::text(
                        "Click points along the middle; Enter or a double click lays the street.",
                    ),
                ]);
            }
            PaintShape::Fill => out.push(ToolOption::segments("fill", hand.fill, &FILLS, 2)),
            PaintShape::Pick => out.push(ToolOption::text(
                "Click takes over the layer under the pointer, as Alt+click always does.",
            )),
            _ => {}
        }
        out.push(ToolOption::gap());
        // A street is laid, a layer is picked: neither is erased.
        if !matches!(hand.shape, PaintShape::Street | PaintShape::Pick) {
            out.push(ToolOption::segments("erase", hand.erase, &ERASE, 2));
        }
        if hand.shape.has_width() {
            out.extend([ToolOption::gap(), ToolOption::brush_size(hand.brush_m)]);
        }
        out
    }

    fn set(&mut self, hand: &mut Hand, _: &Frame, id: &str, value: Value) -> Vec<Act> {
        let lanes = value
            .number()
            .map_or(0, |n| n.round() as usize)
            .min(Street::MAX_LANES);
        match id {
            "shape" => {
                setting::take(&mut hand.shape, value, &PaintShape::ALL);
                self.points_m.clear();
            }
            "forward" => hand.street.forward = lanes,
            "backward" => hand.street.backward = lanes,
            "lane" => setting::take_number(&mut hand.street.lane_m, value),
            "walk" => setting::take_number(&mut hand.street.walk_m, value),
            "fill" => setting::take(&mut hand.fill, value, &FILLS),
            "erase" => setting::take(&mut hand.erase, value, &ERASE),
            "size" => setting::take_number(&mut hand.brush_m, value),
            _ => {}
        }
        Vec::new()
    }

    fn points_m(&self) -> &[DVec2] {
        &self.points_m
    }

    fn restart(&mut self) {
        self.points_m.clear();
    }
}

/// Borders of a fill, each with name and hint.
const FILLS: [(FillBounds, &str, &str); 2] = [
    (
        FillBounds::AnyLayer,
        "To any layer",
        "stops where any map layer changes",
    ),
    (
        FillBounds::OwnLayer,
        "To its own",
        "stops where the painted layer changes",
    ),
];

/// Choices between painting and erasing, for every brush.
pub(super) const ERASE: [(bool, &str, &str); 2] = [(false, "Paint", ""), (true, "Erase", "E, or hold Shift")];

impl BrushDrag {
    /// The shape with the pointer at a point.
    fn shape(&self, at_m: DVec2, shift: bool) -> Shape {
        let from_m = self.points_m.first().copied().unwrap_or(at_m);
        match self.what {
            DragShape::Stroke => Shape::Line {
                points_m: self.points_m.clone(),
                width_m: self.width_m,
            },
            DragShape::Rectangle => Shape::Rect {
                min_m: from_m.min(at_m),
                max_m: from_m.max(at_m),
            },
            DragShape::Line => Shape::Line {
                points_m: vec![from_m, straightened(from_m, at_m, shift && !self.erase)],
                width_m: self.width_m,
            },
        }
    }

    /// The name of the undo step.
    fn step(&self) -> &'static str {
        match (self.what, self.erase) {
            (DragShape::Stroke, false) => "Paint layer",
            (DragShape::Stroke, true) => "Erase layer",
            (DragShape::Rectangle, false) => "Paint rectangle",
            (DragShape::Rectangle, true) => "Erase rectangle",
            (DragShape::Line, false) => "Paint line",
            (DragShape::Line, true) => "Erase line",
        }
    }
}

/// The note that a layer is locked.
pub(super) fn locked(layer: BevLayer) -> Response {
    let text = tf!(
        "Layer \"{layer}\" is locked: its lock is in the list of layers",
        layer = t(&layer.label())
    );
    Response::act(Act::Note(text))
}

/// Shows the painted shape. A shape beside the map paints nothing and shows no error. Locked ground is left out.
pub(super) fn show(cx: &Context<'_>, layer: BevLayer, shape: Shape, value: bool) -> Response {
    let layout = &cx.settled.frame().layout;
    let Ok(mut cells) = shape.cells(layout.extent()) else {
        return Response::none();
    };
    let mut edit = Edit::PaintBev { layer, shape, value };
    if cx
        .hand
        .locked_layer(layout, std::slice::from_ref(&edit))
        .is_some()
    {
        let locked = layer.replaces().iter().filter(|other| cx.hand.is_locked(**other));
        let bits = locked.fold(0, |bits, other| bits | other.bit());
        cells.retain(|[x, y]| layout.cell(*x, *y) & bits == 0);
        if cells.is_empty() {
            return Response::none();
        }
        let shape = Shape::Cells(cells);
        edit = Edit::PaintBev { layer, shape, value };
    }
    Response::act(Act::Preview(vec![edit]))
}

/// With `snap` the point at the nearest multiple of 15 degrees.
fn straightened(from_m: DVec2, to_m: DVec2, snap: bool) -> DVec2 {
    let d = to_m - from_m;
    if !snap || d.length() == 0.0 {
        return to_m;
    }
    let step = 15f64.to_radians();
    from_m + DVec2::from_angle((d.to_angle() / step).round() * step) * d.length()
}

/// The uppermost shown map layer under a point.
fn layer_at(frame: &Frame, hand: &Hand, at_m: DVec2) -> Option<BevLayer> {
    let [x, y] = frame.extent().column_at(at_m.x, at_m.y)?;
    let there = |l: &&BevLayer| hand.shows(**l) && frame.layout.has(**l, x, y);
    DRAW_ORDER.iter().rev().find(there).copied()
}

/// The highest voxel of each column in a disc: the voxels that a brush on the ground would cover.
fn tops_in_disc(frame: &Frame, center_m: DVec2, radius_m: f64) -> Vec<[usize; 3]> {
    let mut cells = Vec::new();
    disc_cells(frame.extent(), center_m, radius_m, |x, y| {
        let column = frame.occupancy.column(x, y);
        cells.push([x, y, column.iter().rposition(|v| *v != Class::FREE).unwrap_or(0)]);
    });
    cells
}

/// The voxels under the brush in space.
fn tops(sight: &ReadonlyContext<'_>) -> Option<ToolMark> {
    let at_m = sight.ground_m()?;
    let color = match sight.hand.erase {
        true => super::voxel::REMOVED,
        false => sight.hand.layer.color(),
    };
    let cells = tops_in_disc(sight.scene.frame(), at_m, sight.hand.brush_m / 2.0);
    Some(ToolMark::Voxels(cells, color))
}

impl Brush {
    fn press(&mut self, cx: &mut Context<'_>, pointer: &Pointer) -> Response {
        let layer = cx.hand.layer;
        let erase = cx.hand.erase || pointer.held.shift;
        if !cx.from_above() {
            // There are strokes only in space, and Alt turns the camera.
            return match cx.hand.is_locked(layer) {
                true => Response::none(),
                false => self.begin(cx.hand, DragShape::Stroke, Vec::new(), erase),
            };
        }
        let Some(at_m) = cx.ground_m(pointer.at) else {
            return Response::none();
        };
        let shape = cx.hand.shape;
        if pointer.held.alt || shape == PaintShape::Pick {
            if let Some(layer) = layer_at(cx.frame(), cx.hand, at_m) {
                cx.hand.layer = layer;
                // Picking is done once, then one paints.
                if shape == PaintShape::Pick {
                    cx.hand.shape = PaintShape::Stroke;
                }
            }
            return Response::none();
        }
        if shape != PaintShape::Street && cx.hand.is_locked(layer) {
            return locked(layer);
        }
        let what = match shape {
            PaintShape::Stroke if pointer.held.ctrl => DragShape::Line,
            PaintShape::Stroke | PaintShape::Pick => {
                return self.begin(cx.hand, DragShape::Stroke, Vec::new(), erase);
            }
            PaintShape::Rectangle => DragShape::Rectangle,
            PaintShape::Line => DragShape::Line,
            PaintShape::Polygon | PaintShape::Street => {
                if self.points_m.last().is_none_or(|p| p.distance(at_m) > APART_M) {
                    self.points_m.push(at_m);
                }
                return Response::none();
            }
            PaintShape::Fill => return fill(cx, layer, at_m, erase),
        };
        self.begin(cx.hand, what, vec![at_m], erase)
    }

    fn begin(&mut self, hand: &Hand, what: DragShape, points_m: Vec<DVec2>, erase: bool) -> Response {
        self.drag = Some(BrushDrag {
            what,
            points_m,
            layer: hand.layer,
            width_m: hand.brush_m,
            erase,
        });
        Response::hold()
    }

    fn drag(&mut self, cx: &Context<'_>, pointer: &Pointer) -> Response {
        let (Some(drag), Some(at_m)) = (&mut self.drag, cx.ground_m(pointer.at)) else {
            return Response::none();
        };
        if drag.what == DragShape::Stroke {
            if drag
                .points_m
                .last()
                .is_some_and(|last| last.distance(at_m) <= STEP_M)
            {
                return Response::none();
            }
            drag.points_m.push(at_m);
        }
        show(cx, drag.layer, drag.shape(at_m, pointer.held.shift), !drag.erase)
    }

    /// Paints the outline or lays the street that was drawn.
    fn close(&mut self, cx: &Context<'_>) -> Response {
        if cx.hand.shape == PaintShape::Street {
            let change = cx.hand.street.along(&self.points_m);
            let edits: Vec<Edit> = change
                .map(|change| Edit::ChangeRoads { change })
                .into_iter()
                .collect();
            // The drawing stays until the layer is unlocked.
            if cx.hand.locked_layer(&cx.frame().layout, &edits).is_none() {
                self.points_m.clear();
            }
            return match edits.is_empty() {
                true => Response::taken(),
                false => Response::taken().and(Act::Apply("Lay street".into(), edits)),
            };
        }
        let points_m = std::mem::take(&mut self.points_m);
        if points_m.len() < 3 {
            return Response::taken();
        }
        let (layer, value) = (cx.hand.layer, !cx.hand.erase);
        let shape = Shape::Polygon { points_m };
        let label = if value { "Paint polygon" } else { "Erase polygon" };
        let edit = Edit::PaintBev { layer, shape, value };
        Response::taken().and(Act::Apply(label.into(), vec![edit]))
    }

    fn over_map(&self, sight: &ReadonlyContext<'_>) -> Vec<ToolMark> {
        let (hand, at_m) = (sight.hand, sight.ground_m());
        let mut out = Vec::new();
        if let (true, Some(pointer), Some(at_m)) = (hand.shape.has_width(), sight.pointer, at_m) {
            let stroke = self.drag.as_ref().filter(|d| d.what == DragShape::Stroke);
            let erase = stroke.map_or(hand.erase || pointer.held.shift, |d| d.erase);
            out.push(ToolMark::Disc(at_m, hand.brush_m / 2.0, role(hand.layer, erase)));
        }
        if let (Some(drag), Some(at_m)) = (&self.drag, at_m)
            && drag.what != DragShape::Stroke
        {
            let d = at_m - drag.points_m.first().copied().unwrap_or(at_m);
            let text = format!("{:.1} × {:.1} m", d.x.abs(), d.y.abs());
            out.push(ToolMark::Tag(at_m.into(), text));
        }
        out.extend(self.outline(sight.settled.frame().extent(), hand, at_m));
        out
    }

    /// The outline or street that is being drawn, on to the pointer.
    fn outline(&self, extent: Extent, hand: &Hand, at_m: Option<DVec2>) -> Vec<ToolMark> {
        if self.points_m.is_empty() {
            return Vec::new();
        }
        let points_m: Vec<DVec2> = self.points_m.iter().copied().chain(at_m).collect();
        let line: Vec<At> = points_m.iter().map(|p| (*p).into()).collect();
        let role = role(hand.layer, hand.erase);
        let mut out = Vec::new();
        if hand.shape == PaintShape::Street {
            out.push(ToolMark::Ribbon(points_m, hand.street.width_m(), role));
        } else if points_m.len() >= 3 {
            let area = Shape::Polygon { points_m };
            out.push(ToolMark::Columns(area.cells(extent).unwrap_or_default(), role));
            let closed = line.iter().copied().chain([line[0]]);
            out.push(ToolMark::Dashed(closed.collect(), role));
        }
        out.push(ToolMark::Line(line.clone(), Role::Hand));
        out.extend(
            line[..self.points_m.len()]
                .iter()
                .map(|p| ToolMark::Dot(*p, role)),
        );
        out
    }
}

fn role(layer: BevLayer, erase: bool) -> Role {
    if erase { Role::Erase } else { Role::Paint(layer) }
}

fn fill(cx: &Context<'_>, layer: BevLayer, at_m: DVec2, erase: bool) -> Response {
    let Some(start) = cx.frame().extent().column_at(at_m.x, at_m.y) else {
        return Response::none();
    };
    let cells = flood::flood(&cx.frame().layout, layer, start, cx.hand.fill);
    let label = if erase { "Fill: erase" } else { "Fill" };
    let edit = Edit::PaintBev {
        layer,
        shape: Shape::Cells(cells),
        value: !erase,
    };
    Response::act(Act::Apply(label.into(), vec![edit]))
}

#[cfg(test)]
mod tests {
    use super::*;
    use scene::{BevLayout, VoxelGrid};

    #[test]
    fn shift_keeps_to_steps() {
        let at = straightened(DVec2::ZERO, DVec2::new(3.0, 1.0), true);
        assert!((at.to_angle().to_degrees() - 15.0).abs() < 1e-9);
    }

    #[test]
    fn the_ground_brush_covers_tops() {
        let mut grid = VoxelGrid::new();
        for x in 90..110 {
            for y in 90..110 {
                grid.set(x, y, 0, Class::Terrain.id());
            }
        }
        grid.set(100, 100, 1, Class::Manmade.id());
        let frame = Frame::new(BevLayout::default(), Default::default(), grid);
        let cells = tops_in_disc(&frame, Extent::WINDOW.center(100, 100, 0).truncate(), 0.6);
        assert!(cells.contains(&[100, 100, 1]) && cells.contains(&[101, 100, 0]));
    }
}
