//! Objects as they are drawn: a few convex bodies, wheels and rounded parts, with materials. Boxes are made for the eye here
//! (sensors and worlds use `world::objects`); scenery is made of its solids, see `scenery`.

mod aids;
mod build;
mod gait;
mod part;
mod person;
mod shapes;
mod two_wheeler;
mod voxel_shape;

use glam::{Vec2, Vec3};

pub use gait::Gait;
pub use part::ObjectPart;

use super::noise::hash1;
use build::ObjectBuilder;
use part::rounded;
use scene::clip::OwnShape;
use scene::{BoxId, Class, Lattice, Paint, SceneBox};
use shapes::shape;
use voxel_shape::voxel_shape;

/// Material of a part.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PartMaterial {
    /// A car's lower body; lamps, grille and arches are found by position.
    Body,
    /// A car's cabin: glass with pillars and a roof.
    Cabin,
    /// A bus or a tram: windows in a band.
    Coach,
    /// A box body of a truck or trailer.
    Cargo,
    /// Tyre and rim.
    Wheel,
    /// Chassis, arms, frames.
    Dark,
    /// Bare metal or plastic in this linear colour.
    Plain(Vec3),
    /// Cloth in this linear colour.
    Cloth(Vec3),
    /// Skin or hair.
    Skin,
    /// Red and white, or orange and white, bands across z.
    Bands(Vec3),
    /// Walls of a building: height above its floor, where the rows of windows begin, and their kind.
    Walls(Vec3),
    /// Tiles of this colour; gravel where it is level.
    Roof(Vec3),
    /// Stones or bricks of this colour.
    Masonry(Vec3),
    /// Upright boards of this colour.
    Boards(Vec3),
    /// Concrete of this brightness.
    Concrete(Vec3),
    /// Painted or galvanised metal of this colour.
    Metal(Vec3),
    /// The plate of a traffic sign: height of its middle, half its side.
    SignPlate(Vec3),
    /// The head of traffic lights: height of its middle, half its height, its middle across.
    SignalHead(Vec3),
    /// The arm of a street light; the lamp is below its end.
    Lamp,
    /// Panes of glass in a frame.
    Pane,
}

/// An object ready to be traced.
#[derive(Clone, Debug)]
pub struct DrawnObject {
    /// Class of its box.
    pub class: Class,
    /// Middle of the bottom in the ego frame, m.
    pub foot: Vec3,
    /// Heading on the ground.
    pub heading: Vec2,
    /// Length, width, height, m.
    pub size: Vec3,
    /// Colour of its paint, linear.
    pub paint: Vec3,
    /// Hash that varies details.
    pub id: u32,
    /// Its box; `None` for scenery.
    pub box_id: Option<BoxId>,
    /// Height of its floor above its foot, m: foundations reach below the ground.
    pub floor_m: f32,
    /// Velocity over ground in the ego frame's axes, m/s.
    pub velocity: Vec3,
    /// True if it moves or stands in traffic: its lamps are on at night.
    pub lamps: bool,
    /// Square of the radius of a circle on the ground that holds the thing, m^2.
    circle_m2: f32,
    /// Length, width, height of what holds all parts, m: not below those of the box.
    pub bound: Vec3,
    /// Parts with materials.
    pub parts: Vec<(ObjectPart, PartMaterial)>,
    /// Upright boxes in which it is not drawn: lower and upper corner, frame of the map, m.
    pub cuts: Vec<[Vec3; 2]>,
}

/// Where a ray meets a thing.
#[derive(Clone, Copy, Debug)]
pub struct ThingHit {
    /// Distance, m.
    pub t: f32,
    /// Point in box coordinates.
    pub local: Vec3,
    /// Normal in box coordinates.
    pub normal: Vec3,
    /// Place of the part among the parts.
    pub part: u32,
}

/// sRGB to linear.
pub fn rgb(r: u8, g: u8, b: u8) -> Vec3 {
    Vec3::new(f32::from(r), f32::from(g), f32::from(b)).map(|c| (c / 255.0).powf(2.2))
}

/// Paints as they are met on streets.
fn car_paint(h: u32) -> Vec3 {
    const PAINTS: [[u8; 3]; 14] = [
        [236, 238, 238],
        [228, 230, 232],
        [40, 42, 46],
        [28, 29, 32],
        [152, 156, 160],
        [186, 190, 194],
        [104, 108, 114],
        [148, 30, 32],
        [168, 36, 30],
        [36, 64, 120],
        [58, 96, 148],
        [64, 78, 66],
        [186, 168, 134],
        [196, 120, 32],
    ];
    let [r, g, b] = PAINTS[h as usize % PAINTS.len()];
    rgb(r, g, b)
}

/// Paint by which a thing of this name is known; used unless another paint was chosen. `None` for other names.
fn usual_paint(name: &str) -> Option<Paint> {
    match name {
        "taxi" | "cab" | "school bus" => Some(Paint::Yellow),
        "fire engine" | "fire truck" => Some(Paint::Red),
        "ambulance" => Some(Paint::White),
        _ => None,
    }
}

impl DrawnObject {
    /// A box as a thing to be drawn, by the shape of its class or by its own; `None` if the box has a problem. `covered_m` is the
    /// way that it has gone, if it moves in a clip.
    pub fn from_box(b: &SceneBox, own: Option<&OwnShape>, covered_m: Option<f64>, seed: u32) -> Option<Self> {
        if b.problem().is_some() {
            return None;
        }
        let id = hash1(b.id.0, seed);
        let size = b.size_m.as_vec3();
        let mut build = ObjectBuilder {
            parts: Vec::new(),
            s: size,
        };
        let paint = match b.class {
            _ if let Some(paint) = b.label.paint.or_else(|| usual_paint(b.label.name.as_str())) => {
                let [r, g, b] = paint.srgb();
                rgb(r, g, b)
            }
            Class::Bus => [
                rgb(200, 60, 40),
                rgb(40, 90, 160),
                rgb(230, 230, 225),
                rgb(50, 120, 80),
            ][id as usize % 4],
            Class::Truck | Class::Trailer => [
                rgb(226, 228, 230),
                rgb(200, 204, 208),
                rgb(150, 40, 36),
                rgb(60, 90, 140),
            ][id as usize % 4],
            Class::ConstructionVehicle => rgb(232, 168, 20),
            _ => car_paint(id),
        };
        let gait = Gait {
            covered_m: covered_m.unwrap_or_default() as f32,
            speed_mps: b.velocity_mps.dot(b.heading()).abs() as f32,
            moves: covered_m.is_some() || b.velocity_mps.length() > 0.3,
        };
        match own {
            None => shape(&mut build, b.class, id, b.label.name.as_str(), gait),
            // Three voxels across tell a shape; fewer do not.
            Some(_) if b.size_m.truncate().min_element() < 3.0 * Lattice::OCC3D.voxel_m() => {
                shape(&mut build, b.class, id, b.label.name.as_str(), gait)
            }
            Some(own) => voxel_shape(&mut build, b, own, PartMaterial::Plain(paint)),
        }
        // Steps may reach beyond the box.
        let bound = build.parts.iter().fold(size, |bound, (part, _)| {
            bound.max(part.reach() * Vec3::new(2.0, 2.0, 1.0))
        });
        let bottom = b.center_m.z - b.size_m.z / 2.0;
        Some(Self {
            class: b.class,
            foot: b.center_m.truncate().extend(bottom).as_vec3(),
            heading: b.heading().as_vec2(),
            size,
            paint,
            id,
            box_id: Some(b.id),
            floor_m: 0.0,
            velocity: b.velocity_mps.as_vec2().extend(0.0),
            lamps: b.class.is_vehicle() && (b.velocity_mps.length() > 0.3 || id.is_multiple_of(3)),
            circle_m2: (bound.truncate() / 2.0 + 0.05).length_squared(),
            bound,
            parts: build.parts,
            cuts: Vec::new(),
        })
    }

    /// Scenery of some parts in its own coordinates; `floor_m` is the height of its floor above its foot.
    pub fn from_scenery(
        class: Class,
        [foot, size]: [Vec3; 2],
        heading: Vec2,
        id: u32,
        floor_m: f32,
        parts: Vec<(ObjectPart, PartMaterial)>,
    ) -> Self {
        Self {
            class,
            foot,
            heading,
            size,
            paint: Vec3::ZERO,
            id,
            box_id: None,
            floor_m,
            velocity: Vec3::ZERO,
            lamps: false,
            circle_m2: (size.truncate() / 2.0 + 0.05).length_squared(),
            bound: size,
            parts,
            cuts: Vec::new(),
        }
    }

    /// Leaves out what lies in some boxes: lower and upper corner, frame of the map, m.
    pub fn with_cuts(mut self, cuts: &[[Vec3; 2]]) -> Self {
        self.cuts = cuts.to_vec();
        self
    }

    fn is_cut(&self, p: Vec3) -> bool {
        let holds = |[low, high]: &[Vec3; 2]| p.cmpge(*low).all() && p.cmple(*high).all();
        self.cuts.iter().any(holds)
    }

    /// Its instance in the truth of a picture: the number of its box; 0 for scenery.
    pub fn instance(&self) -> u32 {
        self.box_id.map_or(0, |id| id.0)
    }

    /// True for scenery, which has no box.
    pub fn is_scenery(&self) -> bool {
        self.box_id.is_none()
    }

    /// Square of the radius of a circle on the ground that holds it, m^2.
    pub fn circle_m2(&self) -> f32 {
        self.circle_m2
    }

    /// Radius on the ground and height that hold it, m.
    pub fn reach(&self) -> Vec3 {
        let r = self.bound.truncate().length() / 2.0;
        Vec3::new(r, r, self.bound.z)
    }

    /// Half extents of the upright rectangle along the map's axes that holds it on the ground, m.
    pub fn reach_on_ground(&self) -> Vec2 {
        match self.is_scenery() {
            false => self.reach().truncate(),
            true => {
                let (half, h) = (self.size.truncate() / 2.0, self.heading.abs());
                Vec2::new(half.x * h.x + half.y * h.y, half.x * h.y + half.y * h.x)
            }
        }
    }

    /// Origin of a ray for the thing as it stands at the moment of the frame, if the ray is seen `after_s` later: moved
    /// back by the way that the thing covers meanwhile. The same takes any point of that time to the frame's moment.
    #[inline]
    pub fn seen_from(&self, p: Vec3, after_s: f32) -> Vec3 {
        match after_s == 0.0 {
            true => p,
            false => p - self.velocity * after_s,
        }
    }

    /// A point of the ego frame in box coordinates.
    pub fn to_local(&self, p: Vec3) -> Vec3 {
        self.turn(p - self.foot)
    }

    /// A direction of the ego frame in box coordinates.
    #[inline]
    pub fn turn(&self, d: Vec3) -> Vec3 {
        let h = self.heading;
        Vec3::new(d.x * h.x + d.y * h.y, d.y * h.x - d.x * h.y, d.z)
    }

    /// A direction in box coordinates in the ego frame.
    #[inline]
    pub fn turn_back(&self, d: Vec3) -> Vec3 {
        let h = self.heading;
        Vec3::new(d.x * h.x - d.y * h.y, d.x * h.y + d.y * h.x, d.z)
    }

    /// True if a ray passes beside the circle around it on the ground.
    #[inline]
    pub fn is_passed(&self, origin: Vec3, dir: Vec3) -> bool {
        let (to, flat) = ((self.foot - origin).truncate(), dir.truncate());
        to.perp_dot(flat).powi(2) > self.circle_m2 * flat.length_squared()
    }

    /// The first surface nearer than `limit` m.
    pub fn cast(&self, origin: Vec3, dir: Vec3, limit: f32) -> Option<ThingHit> {
        if self.is_passed(origin, dir) {
            return None;
        }
        let (o, d) = (self.to_local(origin), self.turn(dir));
        // What holds all parts, a little grown, as a first test.
        let (lo, hi) = (
            Vec3::new(-self.bound.x, -self.bound.y, -0.2) / 2.0 - 0.02,
            Vec3::new(self.bound.x / 2.0, self.bound.y / 2.0, self.bound.z) + 0.02,
        );
        let inv = d.recip();
        let (a, b) = ((lo - o) * inv, (hi - o) * inv);
        let (near, far) = (a.min(b).max_element(), a.max(b).min_element());
        // Written so that NaN (a ray within a face) is tested further.
        if near > far || far < 0.0 || near > limit {
            return None;
        }
        let mut best: Option<(ThingHit, &ObjectPart)> = None;
        for (i, (part, _)) in self.parts.iter().enumerate() {
            let limit = best.map_or(limit, |(b, _)| b.t);
            if let Some((t, normal)) = part.cast(o, d, limit)
                && !self.is_cut(origin + dir * t)
            {
                let hit = ThingHit {
                    t,
                    local: o + d * t,
                    normal,
                    part: i as u32,
                };
                best = Some((hit, part));
            }
        }
        best.map(|(mut hit, part)| {
            if let (ObjectPart::Convex(planes), false) = (part, self.is_scenery()) {
                hit.normal = rounded(
                    planes,
                    hit.local,
                    hit.normal,
                    0.028 * self.size.z.max(self.size.x * 0.5),
                );
            }
            hit
        })
    }
}
