//! Boxes that the perceiver detects.

use glam::{DVec2, DVec3};

use nn::map::FeatureMap;
use scene::{BoxId, BoxLabel, Class, SceneBox, Window};

/// Numbers of a box: offset of its centre from the middle of the cell along x and y (cells), height of the centre (m), logs of length,
/// width and height (m), cosine and sine of twice the yaw, which tell the axis, and of the yaw, which tell the heading.
pub const BOX: usize = 10;
/// Side of a cell, m.
const CELL_M: f32 = 2.0 * Window::VOXEL_M as f32;
/// Most boxes of a sweep.
pub const MOST: usize = 200;
/// Range of the logs of sizes; values beyond count as its ends.
const LOG_SIZES: [f32; 2] = [-3.0, 4.0];

/// Kinds of things for which boxes are predicted.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum DetectionGroup {
    /// A car.
    Car,
    /// A truck, bus, trailer or construction vehicle.
    Large,
    /// A person on foot.
    Person,
    /// A bicycle or a motorcycle.
    Cycle,
    /// A barrier or a traffic cone.
    Barrier,
}

impl DetectionGroup {
    /// All, in the order of the network's outputs.
    pub const ALL: [Self; 5] = [Self::Car, Self::Large, Self::Person, Self::Cycle, Self::Barrier];

    /// The group of a class; `None` if it is no object.
    pub fn from_class(class: Class) -> Option<Self> {
        Some(match class {
            Class::Car => Self::Car,
            Class::Truck | Class::Bus | Class::Trailer | Class::ConstructionVehicle => Self::Large,
            Class::Pedestrian => Self::Person,
            Class::Bicycle | Class::Motorcycle => Self::Cycle,
            Class::Barrier | Class::TrafficCone => Self::Barrier,
            _ => return None,
        })
    }

    /// Class whose colour stands for the group.
    pub fn class(self) -> Class {
        match self {
            Self::Car => Class::Car,
            Self::Large => Class::Truck,
            Self::Person => Class::Pedestrian,
            Self::Cycle => Class::Bicycle,
            Self::Barrier => Class::Barrier,
        }
    }

    /// Name as in reports.
    pub fn name(self) -> &'static str {
        match self {
            Self::Car => "car",
            Self::Large => "large",
            Self::Person => "person",
            Self::Cycle => "cycle",
            Self::Barrier => "barrier",
        }
    }

    /// Distance below which the less sure one of two boxes of the group is removed, m.
    fn apart_m(self) -> f32 {
        match self {
            Self::Car => 1.2,
            Self::Large => 2.0,
            Self::Person | Self::Barrier => 0.3,
            Self::Cycle => 0.5,
        }
    }
}

/// A box that the network detects.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Detection {
    /// Predicted group.
    pub group: DetectionGroup,
    /// Score, 0 to 1.
    pub score: f32,
    /// Centre in the frame of the returns, m.
    pub center_m: [f32; 3],
    /// Length, width, height, m.
    pub size_m: [f32; 3],
    /// Heading, rad, counter-clockwise from x.
    pub yaw_rad: f32,
}

impl Detection {
    /// Converts it to a box of a scene, to be drawn.
    pub fn to_box(&self, id: BoxId) -> SceneBox {
        SceneBox {
            id,
            class: self.group.class(),
            center_m: DVec3::from(self.center_m.map(f64::from)),
            size_m: DVec3::from(self.size_m.map(f64::from)),
            yaw_rad: f64::from(self.yaw_rad),
            velocity_mps: DVec2::ZERO,
            label: BoxLabel::default(),
        }
    }
}

/// Boxes of a map `[x][y][15]` (see [`super::PerceiverOutput`]) whose score is `least` or more, the surest first. They come from
/// cells of which no neighbour is surer of the same group; boxes too near a surer one are left out.
pub fn decode(map: &FeatureMap, least: f32) -> Vec<Detection> {
    let (rows, columns) = (map.rows, map.columns);
    let heat = |group: usize, x: usize, y: usize| map.data[(x * columns + y) * map.width + group];
    let mut found = Vec::new();
    for (g, group) in DetectionGroup::ALL.into_iter().enumerate() {
        for at in 0..rows * columns {
            let (x, y) = (at / columns, at % columns);
            let score = 1.0 / (1.0 + (-heat(g, x, y)).exp());
            if score.is_nan() || score < least {
                continue;
            }
            let mut around = (x.saturating_sub(1)..(x + 2).min(rows))
                .flat_map(|i| (y.saturating_sub(1)..(y + 2).min(columns)).map(move |j| (i, j)));
            if around.all(|(i, j)| heat(g, i, j) <= heat(g, x, y)) {
                let from = at * map.width + DetectionGroup::ALL.len();
                let numbers = &map.data[from..from + BOX];
                found.push(of_cell(group, score, [x, y], [rows, columns], numbers));
            }
        }
    }
    found.sort_by(|a, b| b.score.total_cmp(&a.score));
    let mut kept: Vec<Detection> = Vec::new();
    for one in found {
        let near = |other: &Detection| {
            let [dx, dy] = [0, 1].map(|axis| other.center_m[axis] - one.center_m[axis]);
            other.group == one.group && dx.hypot(dy) < one.group.apart_m()
        };
        if kept.len() < MOST && !kept.iter().any(near) {
            kept.push(one);
        }
    }
    kept
}

fn of_cell(
    group: DetectionGroup,
    score: f32,
    cell: [usize; 2],
    sides: [usize; 2],
    numbers: &[f32],
) -> Detection {
    let place =
        |axis: usize| (cell[axis] as f32 + 0.5 + numbers[axis]) * CELL_M - CELL_M * sides[axis] as f32 / 2.0;
    let size = |i: usize| numbers[3 + i].clamp(LOG_SIZES[0], LOG_SIZES[1]).exp();
    let axis = numbers[7].atan2(numbers[6]) / 2.0;
    let ahead = numbers[8] * axis.cos() + numbers[9] * axis.sin();
    Detection {
        group,
        score,
        center_m: [place(0), place(1), numbers[2]],
        size_m: [size(0), size(1), size(2)],
        yaw_rad: if ahead < 0.0 {
            axis + std::f32::consts::PI
        } else {
            axis
        },
    }
}
