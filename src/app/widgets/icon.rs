//! Icons drawn as lines, each in a square of 16 points. `icon_shapes.rs` holds their shapes.

use egui::{Color32, Rect, Shape, Stroke, Ui, Vec2, vec2};

use super::icon_shapes::{self as shapes, IconStroke, Point};

/// An icon on a button.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Icon {
    /// Arrow of the select tool.
    Cursor,
    /// Brush.
    Brush,
    /// Box with a plus.
    AddBox,
    /// Cube.
    Voxel,
    /// Arrow turning back.
    Undo,
    /// Arrow turning forward.
    Redo,
    /// Triangle: run.
    Play,
    /// Two bars: pause.
    Pause,
    /// Triangle to the left with a bar.
    StepBack,
    /// Triangle to the right with a bar.
    StepForward,
    /// To the first moment.
    ToStart,
    /// To the last moment.
    ToEnd,
    /// Arrow to the keyframe before.
    KeyBack,
    /// Arrow to the next keyframe.
    KeyForward,
    /// Clock.
    Clock,
    /// Square: stop.
    Stop,
    /// Flash: live.
    Live,
    /// Open eye.
    Eye,
    /// Eye struck through.
    EyeOff,
    /// Bin.
    Trash,
    /// Two sheets.
    Copy,
    /// Frame with corners.
    Focus,
    /// Cross.
    Close,
    /// Camera.
    Camera,
    /// Ruler.
    Measure,
    /// Closed lock.
    Lock,
    /// Dashed square with a spark.
    Region,
    /// House.
    Building,
    /// Tree.
    Tree,
    /// Fence.
    Fence,
    /// Low bushes.
    Shrubs,
    /// Lamp with an arm.
    Lamp,
    /// Folded map.
    Map,
    /// Waves from a point.
    Sweep,
    /// Dot and waves to the right.
    Radar,
    /// Three small views.
    Sides,
    /// Speech bubble.
    Words,
    /// Sheets one over the other.
    Stack,
    /// Lines with dots.
    List,
    /// Ticked box.
    Tick,
    /// Sun with rays.
    Sun,
    /// Bars of a chart.
    Bars,
    /// Circle with its middle.
    Circle,
    /// Road to the horizon.
    Road,
    /// Way from point to point, with its end marked.
    Path,
}

impl Icon {
    /// The icon of a name that a tool gives; an arrow for an unknown name.
    pub fn named(name: &str) -> Self {
        match name {
            "brush" => Self::Brush,
            "circle" => Self::Circle,
            "add_box" => Self::AddBox,
            "voxel" => Self::Voxel,
            "measure" => Self::Measure,
            "region" => Self::Region,
            "road" => Self::Road,
            "path" => Self::Path,
            "building" => Self::Building,
            "tree" => Self::Tree,
            "fence" => Self::Fence,
            "shrubs" => Self::Shrubs,
            "lamp" => Self::Lamp,
            _ => Self::Cursor,
        }
    }

    fn parts(self) -> &'static [IconStroke] {
        match self {
            Icon::Cursor => shapes::CURSOR,
            Icon::Brush => shapes::BRUSH,
            Icon::AddBox => shapes::ADD_BOX,
            Icon::Voxel => shapes::VOXEL,
            Icon::Undo => shapes::UNDO,
            Icon::Redo => shapes::REDO,
            Icon::Play => shapes::PLAY,
            Icon::Pause => shapes::PAUSE,
            Icon::StepBack => shapes::STEP_BACK,
            Icon::StepForward => shapes::STEP_FORWARD,
            Icon::ToStart => shapes::TO_START,
            Icon::ToEnd => shapes::TO_END,
            Icon::KeyBack => shapes::KEY_BACK,
            Icon::KeyForward => shapes::KEY_FORWARD,
            Icon::Clock => shapes::CLOCK,
            Icon::Stop => shapes::STOP,
            Icon::Live => shapes::LIVE,
            Icon::Eye => shapes::EYE,
            Icon::EyeOff => shapes::EYE_OFF,
            Icon::Trash => shapes::TRASH,
            Icon::Copy => shapes::COPY,
            Icon::Focus => shapes::FOCUS,
            Icon::Close => shapes::CLOSE,
            Icon::Camera => shapes::CAMERA,
            Icon::Measure => shapes::MEASURE,
            Icon::Region => shapes::REGION,
            Icon::Building => shapes::BUILDING,
            Icon::Tree => shapes::TREE,
            Icon::Fence => shapes::FENCE,
            Icon::Shrubs => shapes::SHRUBS,
            Icon::Lamp => shapes::LAMP,
            Icon::Lock => shapes::LOCK,
            Icon::Map => shapes::MAP,
            Icon::Sweep => shapes::SWEEP,
            Icon::Radar => shapes::RADAR,
            Icon::Sides => shapes::SIDES,
            Icon::Words => shapes::WORDS,
            Icon::Stack => shapes::STACK,
            Icon::List => shapes::LIST,
            Icon::Tick => shapes::TICK,
            Icon::Sun => shapes::SUN,
            Icon::Bars => shapes::BARS,
            Icon::Circle => shapes::CIRCLE,
            Icon::Road => shapes::ROAD,
            Icon::Path => shapes::PATH,
        }
    }

    /// Draws the icon into the middle of `rect`.
    pub fn paint(self, ui: &Ui, rect: Rect, color: Color32) {
        let scale = (rect.width().min(rect.height()) / 16.0).min(1.25);
        let origin = rect.center() - Vec2::splat(8.0 * scale);
        let at = |(x, y): Point| origin + vec2(x, y) * scale;
        let all = |points: &[Point]| points.iter().map(|p| at(*p)).collect();
        let stroke = Stroke::new(1.4, color);
        for part in self.parts() {
            ui.painter().add(match *part {
                IconStroke::Line(points) => Shape::line(all(points), stroke),
                IconStroke::Closed(points) => Shape::closed_line(all(points), stroke),
                IconStroke::Solid(points) => Shape::convex_polygon(all(points), color, Stroke::NONE),
                IconStroke::Arc((x, y), radius, from, to) => {
                    let steps = 14;
                    let points = (0..=steps).map(|i| {
                        let a = (from + (to - from) * i as f32 / steps as f32).to_radians();
                        at((x + radius * a.cos(), y + radius * a.sin()))
                    });
                    Shape::line(points.collect(), stroke)
                }
                IconStroke::Lid(sign) => {
                    let points = (0..=10).map(|i| {
                        let t = i as f32 / 10.0;
                        let bow = (std::f32::consts::PI * t).sin();
                        at((1.8 + 12.4 * t, 8.0 + sign * 4.6 * bow))
                    });
                    Shape::line(points.collect(), stroke)
                }
                IconStroke::Circle(center, radius) => {
                    Shape::circle_stroke(at(center), radius * scale, stroke)
                }
                IconStroke::Dot(center, radius) => Shape::circle_filled(at(center), radius * scale, color),
            });
        }
    }
}
