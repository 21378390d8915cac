//! The shapes of the icons, in points of a square of 16 by 16.

/// `(x, y)`, from the upper left.
pub(crate) type Point = (f32, f32);

/// One stroke of an icon.
pub(crate) enum IconStroke {
    /// A line from point to point.
    Line(&'static [Point]),
    /// A closed line through points.
    Closed(&'static [Point]),
    /// A filled convex shape.
    Solid(&'static [Point]),
    /// An arc: centre, radius, start and end in degrees, clockwise from the right.
    Arc(Point, f32, f32, f32),
    /// The lower (1) or the upper (-1) lid of an eye.
    Lid(f32),
    /// A circle: centre, radius.
    Circle(Point, f32),
    /// A filled circle: centre, radius.
    Dot(Point, f32),
}

pub(crate) const CURSOR: &[IconStroke] = &[IconStroke::Closed(&[
    (4.0, 2.0),
    (4.0, 13.0),
    (7.0, 10.3),
    (11.5, 10.3),
])];
pub(crate) const BRUSH: &[IconStroke] = &[
    IconStroke::Line(&[(13.5, 2.5), (7.5, 8.5)]),
    IconStroke::Closed(&[
        (7.6, 8.4),
        (5.0, 9.2),
        (3.8, 11.2),
        (2.5, 13.5),
        (5.4, 12.9),
        (7.4, 11.6),
        (8.6, 9.5),
    ]),
];
pub(crate) const ADD_BOX: &[IconStroke] = &[
    IconStroke::Closed(&[(2.5, 5.0), (10.5, 5.0), (10.5, 13.0), (2.5, 13.0)]),
    IconStroke::Line(&[(6.5, 7.0), (6.5, 11.0)]),
    IconStroke::Line(&[(4.5, 9.0), (8.5, 9.0)]),
    IconStroke::Line(&[(6.0, 2.5), (13.0, 2.5), (13.0, 9.5)]),
];
pub(crate) const VOXEL: &[IconStroke] = &[
    IconStroke::Closed(&[
        (8.0, 1.8),
        (13.5, 4.8),
        (13.5, 11.2),
        (8.0, 14.2),
        (2.5, 11.2),
        (2.5, 4.8),
    ]),
    IconStroke::Line(&[(2.5, 4.8), (8.0, 7.9), (13.5, 4.8)]),
    IconStroke::Line(&[(8.0, 7.9), (8.0, 14.2)]),
];
pub(crate) const UNDO: &[IconStroke] = &[
    IconStroke::Line(&[(6.2, 2.6), (3.0, 5.8), (6.2, 9.0)]),
    IconStroke::Line(&[(3.0, 5.8), (9.5, 5.8)]),
    IconStroke::Arc((9.5, 9.5), 3.7, -90.0, 90.0),
    IconStroke::Line(&[(9.5, 13.2), (6.0, 13.2)]),
];
pub(crate) const REDO: &[IconStroke] = &[
    IconStroke::Line(&[(9.8, 2.6), (13.0, 5.8), (9.8, 9.0)]),
    IconStroke::Line(&[(13.0, 5.8), (6.5, 5.8)]),
    IconStroke::Arc((6.5, 9.5), 3.7, 90.0, 270.0),
    IconStroke::Line(&[(6.5, 13.2), (10.0, 13.2)]),
];
pub(crate) const PLAY: &[IconStroke] = &[IconStroke::Solid(&[(4.5, 2.5), (13.5, 8.0), (4.5, 13.5)])];
pub(crate) const STOP: &[IconStroke] = &[IconStroke::Solid(&[
    (3.5, 3.5),
    (12.5, 3.5),
    (12.5, 12.5),
    (3.5, 12.5),
])];
pub(crate) const PAUSE: &[IconStroke] = &[
    IconStroke::Solid(&[(4.0, 3.0), (6.8, 3.0), (6.8, 13.0), (4.0, 13.0)]),
    IconStroke::Solid(&[(9.2, 3.0), (12.0, 3.0), (12.0, 13.0), (9.2, 13.0)]),
];
pub(crate) const STEP_BACK: &[IconStroke] = &[
    IconStroke::Solid(&[(9.5, 3.5), (9.5, 12.5), (3.0, 8.0)]),
    IconStroke::Line(&[(12.5, 3.5), (12.5, 12.5)]),
];
pub(crate) const STEP_FORWARD: &[IconStroke] = &[
    IconStroke::Solid(&[(6.5, 3.5), (13.0, 8.0), (6.5, 12.5)]),
    IconStroke::Line(&[(3.5, 3.5), (3.5, 12.5)]),
];
pub(crate) const TO_START: &[IconStroke] = &[
    IconStroke::Line(&[(3.0, 3.0), (3.0, 13.0)]),
    IconStroke::Solid(&[(8.5, 3.5), (8.5, 12.5), (3.8, 8.0)]),
    IconStroke::Solid(&[(13.5, 3.5), (13.5, 12.5), (8.8, 8.0)]),
];
pub(crate) const TO_END: &[IconStroke] = &[
    IconStroke::Line(&[(13.0, 3.0), (13.0, 13.0)]),
    IconStroke::Solid(&[(7.5, 3.5), (12.2, 8.0), (7.5, 12.5)]),
    IconStroke::Solid(&[(2.5, 3.5), (7.2, 8.0), (2.5, 12.5)]),
];
pub(crate) const KEY_BACK: &[IconStroke] = &[
    IconStroke::Closed(&[(11.0, 4.8), (14.2, 8.0), (11.0, 11.2), (7.8, 8.0)]),
    IconStroke::Line(&[(5.5, 4.5), (2.0, 8.0), (5.5, 11.5)]),
];
pub(crate) const KEY_FORWARD: &[IconStroke] = &[
    IconStroke::Closed(&[(5.0, 4.8), (8.2, 8.0), (5.0, 11.2), (1.8, 8.0)]),
    IconStroke::Line(&[(10.5, 4.5), (14.0, 8.0), (10.5, 11.5)]),
];
pub(crate) const CLOCK: &[IconStroke] = &[
    IconStroke::Circle((8.0, 8.0), 5.8),
    IconStroke::Line(&[(8.0, 4.4), (8.0, 8.0), (10.6, 9.6)]),
];
pub(crate) const LIVE: &[IconStroke] = &[IconStroke::Closed(&[
    (9.2, 1.8),
    (3.6, 9.0),
    (7.4, 9.0),
    (6.6, 14.2),
    (12.4, 6.8),
    (8.4, 6.8),
])];
pub(crate) const EYE: &[IconStroke] = &[
    IconStroke::Lid(1.0),
    IconStroke::Lid(-1.0),
    IconStroke::Dot((8.0, 8.0), 2.2),
];
pub(crate) const EYE_OFF: &[IconStroke] = &[
    IconStroke::Lid(1.0),
    IconStroke::Lid(-1.0),
    IconStroke::Line(&[(3.0, 13.2), (13.0, 2.8)]),
];
pub(crate) const TRASH: &[IconStroke] = &[
    IconStroke::Line(&[(2.8, 4.4), (13.2, 4.4)]),
    IconStroke::Line(&[(6.0, 4.2), (6.4, 2.4), (9.6, 2.4), (10.0, 4.2)]),
    IconStroke::Line(&[(4.0, 4.6), (4.8, 13.6), (11.2, 13.6), (12.0, 4.6)]),
    IconStroke::Line(&[(6.8, 7.0), (6.9, 11.2)]),
    IconStroke::Line(&[(9.2, 7.0), (9.1, 11.2)]),
];
pub(crate) const COPY: &[IconStroke] = &[
    IconStroke::Closed(&[(2.5, 5.5), (9.5, 5.5), (9.5, 13.5), (2.5, 13.5)]),
    IconStroke::Line(&[(6.0, 3.6), (6.0, 2.5), (13.5, 2.5), (13.5, 10.5), (11.4, 10.5)]),
];
pub(crate) const FOCUS: &[IconStroke] = &[
    IconStroke::Line(&[(10.6, 13.6), (13.6, 13.6), (13.6, 10.6)]),
    IconStroke::Line(&[(5.4, 13.6), (2.4, 13.6), (2.4, 10.6)]),
    IconStroke::Line(&[(10.6, 2.4), (13.6, 2.4), (13.6, 5.4)]),
    IconStroke::Line(&[(5.4, 2.4), (2.4, 2.4), (2.4, 5.4)]),
    IconStroke::Dot((8.0, 8.0), 1.6),
];
pub(crate) const CLOSE: &[IconStroke] = &[
    IconStroke::Line(&[(4.0, 4.0), (12.0, 12.0)]),
    IconStroke::Line(&[(12.0, 4.0), (4.0, 12.0)]),
];
pub(crate) const CAMERA: &[IconStroke] = &[
    IconStroke::Closed(&[
        (2.0, 5.0),
        (5.0, 5.0),
        (6.2, 3.2),
        (9.8, 3.2),
        (11.0, 5.0),
        (14.0, 5.0),
        (14.0, 12.8),
        (2.0, 12.8),
    ]),
    IconStroke::Circle((8.0, 8.8), 2.4),
];
pub(crate) const MEASURE: &[IconStroke] = &[
    IconStroke::Closed(&[(1.8, 10.6), (10.6, 1.8), (14.2, 5.4), (5.4, 14.2)]),
    IconStroke::Line(&[(4.4, 8.0), (6.0, 9.6)]),
    IconStroke::Line(&[(6.6, 5.8), (8.2, 7.4)]),
    IconStroke::Line(&[(8.8, 3.6), (10.4, 5.2)]),
];
pub(crate) const REGION: &[IconStroke] = &[
    IconStroke::Line(&[(2.0, 5.0), (2.0, 2.0)]),
    IconStroke::Line(&[(11.0, 2.0), (14.0, 2.0)]),
    IconStroke::Line(&[(14.0, 11.0), (14.0, 14.0)]),
    IconStroke::Line(&[(2.0, 2.0), (5.0, 2.0)]),
    IconStroke::Line(&[(14.0, 2.0), (14.0, 5.0)]),
    IconStroke::Line(&[(14.0, 14.0), (11.0, 14.0)]),
    IconStroke::Line(&[(5.0, 14.0), (2.0, 14.0), (2.0, 11.0)]),
    IconStroke::Line(&[(8.0, 4.8), (8.0, 11.2)]),
    IconStroke::Line(&[(4.8, 8.0), (11.2, 8.0)]),
];
pub(crate) const ROAD: &[IconStroke] = &[
    IconStroke::Line(&[(5.6, 2.0), (2.4, 14.0)]),
    IconStroke::Line(&[(10.4, 2.0), (13.6, 14.0)]),
    IconStroke::Line(&[(8.0, 2.4), (8.0, 4.4)]),
    IconStroke::Line(&[(8.0, 6.8), (8.0, 9.2)]),
    IconStroke::Line(&[(8.0, 11.6), (8.0, 14.0)]),
];
pub(crate) const PATH: &[IconStroke] = &[
    IconStroke::Circle((3.6, 12.4), 1.8),
    IconStroke::Line(&[
        (5.4, 12.2),
        (8.4, 11.4),
        (9.4, 8.8),
        (7.6, 6.2),
        (9.0, 3.8),
        (12.4, 3.4),
    ]),
    IconStroke::Line(&[(10.4, 1.4), (12.8, 3.4), (10.8, 5.8)]),
];
pub(crate) const BUILDING: &[IconStroke] = &[
    IconStroke::Closed(&[(2.5, 6.6), (8.0, 2.2), (13.5, 6.6), (13.5, 13.8), (2.5, 13.8)]),
    IconStroke::Line(&[(6.6, 13.8), (6.6, 9.6), (9.4, 9.6), (9.4, 13.8)]),
];
pub(crate) const TREE: &[IconStroke] = &[
    IconStroke::Circle((8.0, 6.0), 4.2),
    IconStroke::Line(&[(8.0, 14.2), (8.0, 7.4)]),
    IconStroke::Line(&[(8.0, 9.6), (9.9, 7.6)]),
];
pub(crate) const FENCE: &[IconStroke] = &[
    IconStroke::Line(&[(3.0, 14.0), (3.0, 3.6)]),
    IconStroke::Line(&[(8.0, 14.0), (8.0, 3.6)]),
    IconStroke::Line(&[(13.0, 14.0), (13.0, 3.6)]),
    IconStroke::Line(&[(1.4, 6.4), (14.6, 6.4)]),
    IconStroke::Line(&[(1.4, 10.6), (14.6, 10.6)]),
];
pub(crate) const SHRUBS: &[IconStroke] = &[
    IconStroke::Arc((4.8, 12.6), 3.2, 180.0, 360.0),
    IconStroke::Arc((11.2, 12.6), 3.2, 180.0, 360.0),
    IconStroke::Arc((8.0, 9.2), 3.4, 190.0, 350.0),
    IconStroke::Line(&[(1.6, 12.6), (14.4, 12.6)]),
];
pub(crate) const LAMP: &[IconStroke] = &[
    IconStroke::Line(&[(5.0, 14.2), (5.0, 2.6), (12.2, 2.6)]),
    IconStroke::Line(&[(10.2, 2.6), (10.2, 5.0), (13.6, 5.0), (13.6, 2.6)]),
    IconStroke::Line(&[(3.2, 14.2), (6.8, 14.2)]),
];
pub(crate) const LOCK: &[IconStroke] = &[
    IconStroke::Closed(&[(3.5, 7.2), (12.5, 7.2), (12.5, 13.6), (3.5, 13.6)]),
    IconStroke::Arc((8.0, 6.8), 3.1, 180.0, 360.0),
];
pub(crate) const MAP: &[IconStroke] = &[
    IconStroke::Closed(&[
        (2.0, 3.5),
        (6.0, 2.2),
        (10.0, 3.8),
        (14.0, 2.5),
        (14.0, 12.5),
        (10.0, 13.8),
        (6.0, 12.2),
        (2.0, 13.5),
    ]),
    IconStroke::Line(&[(6.0, 2.2), (6.0, 12.2)]),
    IconStroke::Line(&[(10.0, 3.8), (10.0, 13.8)]),
];
pub(crate) const SWEEP: &[IconStroke] = &[
    IconStroke::Dot((8.0, 12.6), 1.4),
    IconStroke::Arc((8.0, 12.6), 4.4, 205.0, 335.0),
    IconStroke::Arc((8.0, 12.6), 8.0, 210.0, 330.0),
];
pub(crate) const RADAR: &[IconStroke] = &[
    IconStroke::Closed(&[(2.0, 5.0), (4.5, 5.0), (4.5, 11.0), (2.0, 11.0)]),
    IconStroke::Arc((3.6, 8.0), 4.0, -42.0, 42.0),
    IconStroke::Arc((3.6, 8.0), 7.2, -38.0, 38.0),
    IconStroke::Arc((3.6, 8.0), 10.4, -34.0, 34.0),
];
pub(crate) const SIDES: &[IconStroke] = &[
    IconStroke::Closed(&[(2.0, 2.5), (7.0, 2.5), (7.0, 7.0), (2.0, 7.0)]),
    IconStroke::Closed(&[(9.0, 2.5), (14.0, 2.5), (14.0, 7.0), (9.0, 7.0)]),
    IconStroke::Closed(&[(2.0, 9.0), (7.0, 9.0), (7.0, 13.5), (2.0, 13.5)]),
];
pub(crate) const WORDS: &[IconStroke] = &[
    IconStroke::Closed(&[
        (2.0, 3.0),
        (14.0, 3.0),
        (14.0, 11.0),
        (8.0, 11.0),
        (5.0, 13.8),
        (5.0, 11.0),
        (2.0, 11.0),
    ]),
    IconStroke::Line(&[(4.6, 6.0), (11.4, 6.0)]),
    IconStroke::Line(&[(4.6, 8.4), (9.0, 8.4)]),
];
pub(crate) const STACK: &[IconStroke] = &[
    IconStroke::Closed(&[(8.0, 2.2), (14.0, 5.2), (8.0, 8.2), (2.0, 5.2)]),
    IconStroke::Line(&[(2.0, 8.2), (8.0, 11.2), (14.0, 8.2)]),
    IconStroke::Line(&[(2.0, 11.0), (8.0, 14.0), (14.0, 11.0)]),
];
pub(crate) const LIST: &[IconStroke] = &[
    IconStroke::Dot((3.0, 4.0), 1.1),
    IconStroke::Dot((3.0, 8.0), 1.1),
    IconStroke::Dot((3.0, 12.0), 1.1),
    IconStroke::Line(&[(6.0, 4.0), (14.0, 4.0)]),
    IconStroke::Line(&[(6.0, 8.0), (14.0, 8.0)]),
    IconStroke::Line(&[(6.0, 12.0), (14.0, 12.0)]),
];
pub(crate) const TICK: &[IconStroke] = &[
    IconStroke::Closed(&[(2.5, 2.5), (13.5, 2.5), (13.5, 13.5), (2.5, 13.5)]),
    IconStroke::Line(&[(5.0, 8.2), (7.2, 10.6), (11.2, 5.4)]),
];
pub(crate) const SUN: &[IconStroke] = &[
    IconStroke::Circle((8.0, 8.0), 3.0),
    IconStroke::Line(&[(8.0, 1.2), (8.0, 3.2)]),
    IconStroke::Line(&[(8.0, 12.8), (8.0, 14.8)]),
    IconStroke::Line(&[(1.2, 8.0), (3.2, 8.0)]),
    IconStroke::Line(&[(12.8, 8.0), (14.8, 8.0)]),
    IconStroke::Line(&[(3.2, 3.2), (4.6, 4.6)]),
    IconStroke::Line(&[(11.4, 11.4), (12.8, 12.8)]),
    IconStroke::Line(&[(3.2, 12.8), (4.6, 11.4)]),
    IconStroke::Line(&[(11.4, 4.6), (12.8, 3.2)]),
];
pub(crate) const BARS: &[IconStroke] = &[
    IconStroke::Line(&[(2.2, 13.8), (13.8, 13.8)]),
    IconStroke::Closed(&[(3.0, 8.6), (5.4, 8.6), (5.4, 13.8), (3.0, 13.8)]),
    IconStroke::Closed(&[(6.8, 3.0), (9.2, 3.0), (9.2, 13.8), (6.8, 13.8)]),
    IconStroke::Closed(&[(10.6, 6.0), (13.0, 6.0), (13.0, 13.8), (10.6, 13.8)]),
];
pub(crate) const CIRCLE: &[IconStroke] = &[
    IconStroke::Circle((8.0, 8.0), 6.0),
    IconStroke::Circle((8.0, 8.0), 0.9),
];
