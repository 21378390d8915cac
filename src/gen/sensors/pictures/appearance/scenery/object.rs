//! A thing of the scenery as objects to trace: its parts as convex bodies with materials, in groups that rays can pass by.

use glam::{DVec2, DVec3, Vec3, Vec4};

use super::super::noise::hash1;
use super::super::things::{DrawnObject, ObjectPart, PartMaterial, rgb};
use scene::background::{Building, Facade, GroundM, LineKind, PartRole, Roof, STOREY_M, ThingPart};
use scene::solid::{Solid, SolidShape};
use scene::{Form, Thing};

/// Longest stretch of a wall or fence in one object, in parts.
const PIECES: usize = 6;

/// The objects of a thing.
pub(super) fn objects(thing: &Thing, ground_m: GroundM<'_>, seed: u32) -> Vec<DrawnObject> {
    let parts = thing.parts(ground_m);
    let id = hash1(thing.look, seed);
    let floor_m = ground_m(thing.form.middle_m());
    let build = |parts: &[ThingPart]| object(thing, parts, floor_m, id);
    match &thing.form {
        Form::Building(_) => {
            // The attachments of each wall follow those of the wall before.
            let body = parts
                .iter()
                .position(|p| is_attached(p.role))
                .unwrap_or(parts.len());
            let walls = parts[body..].chunk_by(|a, b| heading(&a.solid) == heading(&b.solid));
            std::iter::once(&parts[..body])
                .chain(walls)
                .filter_map(build)
                .collect()
        }
        Form::Line(_) => parts.chunks(PIECES).filter_map(build).collect(),
        // The arm does not shade the ground below it.
        Form::Post(_) => {
            let arm = parts.iter().position(|p| p.role == PartRole::LampArm);
            let (upright, arm) = parts.split_at(arm.unwrap_or(parts.len()));
            [upright, arm].into_iter().filter_map(build).collect()
        }
        _ => build(&parts).into_iter().collect(),
    }
}

fn is_attached(role: PartRole) -> bool {
    matches!(
        role,
        PartRole::BalconyFloor | PartRole::BalconyRail | PartRole::Bay
    )
}

/// Heading of a solid's length; x where it has none.
fn heading(solid: &Solid) -> DVec2 {
    match &solid.shape {
        SolidShape::Hull { heading, .. } => *heading,
        SolidShape::Prism { outline, .. } => {
            let edges = outline
                .iter()
                .zip(outline.iter().cycle().skip(1))
                .map(|(a, b)| *b - *a);
            let longest = edges.max_by(|a, b| a.length_squared().total_cmp(&b.length_squared()));
            longest.unwrap_or(DVec2::X).normalize_or(DVec2::X)
        }
        SolidShape::Frustum { .. } | SolidShape::Ellipsoid { .. } => DVec2::X,
    }
}

/// One object of some parts; `None` without parts.
fn object(thing: &Thing, parts: &[ThingPart], floor_m: f64, id: u32) -> Option<DrawnObject> {
    let first = parts.first()?;
    // The parts with a heading agree on it, but for pieces of a line around a corner.
    let turned = parts
        .iter()
        .find(|p| !matches!(p.solid.shape, SolidShape::Frustum { .. }));
    let heading = heading(&turned.unwrap_or(first).solid);
    let (mut low, mut high) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
    for part in parts {
        for corner in corners(&part.solid) {
            let p = turn(corner, heading);
            (low, high) = (low.min(p), high.max(p));
        }
    }
    let middle = (low + high) / 2.0;
    let foot = turn_back(middle.truncate().extend(low.z), heading);
    let place = Place { foot, heading };
    let look = Look::new(&thing.form, id);
    let size = (high - low).as_vec3();
    let mut made: Vec<(ObjectPart, PartMaterial)> = Vec::with_capacity(parts.len());
    for part in parts {
        let material = look.material(part, &place);
        let own = convex(&part.solid, &place)
            .into_iter()
            .map(|body| (body, material));
        made.extend(own);
    }
    Some(DrawnObject::from_scenery(
        first.solid.class,
        [foot.as_vec3(), size],
        heading.as_vec2(),
        id,
        (floor_m - foot.z) as f32,
        made,
    ))
}

/// Frame of an object: its foot, and its heading on the ground.
struct Place {
    foot: DVec3,
    heading: DVec2,
}

impl Place {
    fn local(&self, p: DVec3) -> Vec3 {
        turn(p - self.foot, self.heading).as_vec3()
    }

    fn direction(&self, d: DVec3) -> Vec3 {
        turn(d, self.heading).as_vec3()
    }
}

fn turn(d: DVec3, h: DVec2) -> DVec3 {
    DVec3::new(d.x * h.x + d.y * h.y, d.y * h.x - d.x * h.y, d.z)
}

fn turn_back(d: DVec3, h: DVec2) -> DVec3 {
    DVec3::new(d.x * h.x - d.y * h.y, d.x * h.y + d.y * h.x, d.z)
}

/// Points whose hull holds a solid.
fn corners(solid: &Solid) -> Vec<DVec3> {
    let c = solid.center;
    let levels = |half_z: f64, points: Vec<DVec2>| {
        let at = move |z: f64| points.clone().into_iter().map(move |p| c + p.extend(z));
        at(-half_z).chain(at(half_z)).collect()
    };
    match &solid.shape {
        &SolidShape::Hull { half, top, heading } => {
            let wide = half.truncate().max(top);
            let corner = |x: f64, y: f64| heading * (x * wide.x) + heading.perp() * (y * wide.y);
            levels(
                half.z,
                vec![
                    corner(-1.0, -1.0),
                    corner(1.0, -1.0),
                    corner(1.0, 1.0),
                    corner(-1.0, 1.0),
                ],
            )
        }
        SolidShape::Prism { outline, half } => levels(half.z, outline.to_vec()),
        &SolidShape::Frustum {
            bottom,
            top,
            half_height,
        } => {
            let r = bottom.max(top);
            // A square around the circle that holds it whichever way it is turned.
            let r = r * std::f64::consts::SQRT_2;
            let ways = [DVec2::X, DVec2::Y, -DVec2::X, -DVec2::Y];
            levels(half_height, ways.map(|w| w * r).to_vec())
        }
        SolidShape::Ellipsoid { radii } => {
            let r = radii.x.max(radii.y) * std::f64::consts::SQRT_2;
            let ways = [DVec2::X, DVec2::Y, -DVec2::X, -DVec2::Y];
            levels(radii.z, ways.map(|w| w * r).to_vec())
        }
    }
}

/// A solid as bodies that rays can meet, in box coordinates: convex ones, if it is not convex.
fn convex(solid: &Solid, place: &Place) -> Vec<ObjectPart> {
    let half_space = |n: DVec3, point: DVec3| -> Vec4 {
        let n = place.direction(n).normalize_or(Vec3::Z);
        n.extend(n.dot(place.local(point)))
    };
    let c = solid.center;
    match &solid.shape {
        &SolidShape::Hull { half, top, heading } => {
            let mut planes = vec![
                half_space(DVec3::Z, c + DVec3::Z * half.z),
                half_space(-DVec3::Z, c - DVec3::Z * half.z),
            ];
            for (axis, way) in [heading, heading.perp()].into_iter().enumerate() {
                let slope = (top[axis] - half[axis]) / (2.0 * half.z).max(1e-9);
                for sign in [1.0, -1.0] {
                    let out = way * sign;
                    let foot = c + (out * half[axis]).extend(-half.z);
                    planes.push(half_space(out.extend(-slope), foot));
                }
            }
            vec![ObjectPart::Convex(planes)]
        }
        SolidShape::Prism { outline, half } => {
            let body = |corners: &[DVec2]| {
                let mut planes = vec![
                    half_space(DVec3::Z, c + DVec3::Z * half.z),
                    half_space(-DVec3::Z, c - DVec3::Z * half.z),
                ];
                for (i, a) in corners.iter().enumerate() {
                    let b = corners[(i + 1) % corners.len()];
                    // Counter-clockwise: the outside is on the right.
                    let out = -(b - *a).perp();
                    if out.length_squared() > 1e-12 {
                        planes.push(half_space(out.extend(0.0), c + a.extend(0.0)));
                    }
                }
                ObjectPart::Convex(planes)
            };
            convex_pieces(outline).iter().map(|piece| body(piece)).collect()
        }
        &SolidShape::Frustum {
            bottom,
            top,
            half_height,
        } => {
            let foot = place.local(c - DVec3::Z * half_height);
            vec![ObjectPart::Cone(
                foot,
                2.0 * half_height as f32,
                bottom as f32,
                top as f32,
            )]
        }
        SolidShape::Ellipsoid { radii } => vec![ObjectPart::Round(place.local(c), radii.as_vec3())],
    }
}

/// A counter-clockwise outline as convex pieces: itself, or triangles cut off ear by ear. What cannot be cut is left out.
fn convex_pieces(outline: &[DVec2]) -> Vec<Vec<DVec2>> {
    let turns_left = |a: DVec2, b: DVec2, c: DVec2| (b - a).perp_dot(c - b) > -1e-9;
    let n = outline.len();
    if (0..n).all(|i| turns_left(outline[i], outline[(i + 1) % n], outline[(i + 2) % n])) {
        return vec![outline.to_vec()];
    }
    let (mut rest, mut out) = (outline.to_vec(), Vec::new());
    while rest.len() > 3 {
        let n = rest.len();
        let is_ear = |i: usize| {
            let [a, b, c] = [rest[(i + n - 1) % n], rest[i], rest[(i + 1) % n]];
            let inside = |p: DVec2| {
                let side = |a: DVec2, b: DVec2| (b - a).perp_dot(p - a);
                p != a && p != b && p != c && side(a, b) >= 0.0 && side(b, c) >= 0.0 && side(c, a) >= 0.0
            };
            (b - a).perp_dot(c - b) > 1e-12 && !rest.iter().any(|p| inside(*p))
        };
        let Some(ear) = (0..n).find(|i| is_ear(*i)) else {
            return out;
        };
        out.push(vec![rest[(ear + n - 1) % n], rest[ear], rest[(ear + 1) % n]]);
        rest.remove(ear);
    }
    out.push(rest);
    out
}

/// Colours and materials of a thing. They depend on its kind and its number alone.
struct Look<'a> {
    form: &'a Form,
    id: u32,
}

impl<'a> Look<'a> {
    fn new(form: &'a Form, id: u32) -> Self {
        Self { form, id }
    }

    /// One of some colours.
    fn pick(&self, salt: u32, colors: &[[u8; 3]]) -> Vec3 {
        let [r, g, b] = colors[hash1(self.id, salt) as usize % colors.len()];
        rgb(r, g, b)
    }

    fn material(&self, part: &ThingPart, place: &Place) -> PartMaterial {
        let gray = Vec3::splat;
        let local = place.local(part.solid.center);
        let half_z = part.solid.reach().z as f32;
        match part.role {
            PartRole::Walls => self.walls(0.0),
            PartRole::UpperWalls => self.walls(STOREY_M as f32),
            PartRole::Bay => self.walls(0.0),
            PartRole::PitchedRoof => PartMaterial::Roof(self.pick(
                11,
                &[
                    [112, 62, 48],
                    [96, 54, 46],
                    [74, 70, 70],
                    [58, 60, 66],
                    [126, 84, 62],
                    [84, 78, 72],
                ],
            )),
            PartRole::RoofUnit => PartMaterial::Metal(gray(0.32)),
            PartRole::Column | PartRole::BalconyFloor => PartMaterial::Concrete(gray(0.34)),
            PartRole::BalconyRail => match hash1(self.id, 12) % 3 {
                0 => PartMaterial::Pane,
                1 => PartMaterial::Metal(gray(0.07)),
                _ => PartMaterial::Concrete(gray(0.42)),
            },
            PartRole::Masonry => match &self.form {
                Form::Line(line) if line.kind == LineKind::RetainingWall => {
                    PartMaterial::Concrete(gray(0.22))
                }
                _ => PartMaterial::Masonry(self.pick(
                    13,
                    &[[150, 138, 122], [142, 92, 72], [168, 160, 148], [120, 112, 104]],
                )),
            },
            PartRole::FencePanel => PartMaterial::Boards(self.pick(
                14,
                &[
                    [124, 98, 74],
                    [98, 84, 68],
                    [150, 140, 126],
                    [66, 74, 60],
                    [88, 60, 42],
                ],
            )),
            PartRole::LinePost => match &self.form {
                Form::Line(line) if line.kind == LineKind::Fence => PartMaterial::Boards(rgb(96, 78, 60)),
                _ => PartMaterial::Metal(gray(0.26)),
            },
            PartRole::RailBeam => PartMaterial::Metal(gray(0.36)),
            PartRole::Pole => PartMaterial::Metal(match &self.form {
                Form::Post(post) if post.height_m > 4.0 => gray(0.15),
                _ => gray(0.28),
            }),
            PartRole::LampArm => PartMaterial::Lamp,
            PartRole::SignPlate => PartMaterial::SignPlate(Vec3::new(local.z, half_z, 0.0)),
            PartRole::SignalHead => PartMaterial::SignalHead(Vec3::new(local.z, half_z, local.y)),
            PartRole::ShelterWall => PartMaterial::Pane,
            PartRole::ShelterRoof => PartMaterial::Metal(gray(0.10)),
            PartRole::Seat => PartMaterial::Boards(rgb(118, 84, 54)),
            PartRole::Bin => {
                PartMaterial::Plain(self.pick(15, &[[46, 62, 50], [58, 60, 62], [52, 66, 92], [92, 66, 46]]))
            }
            PartRole::Bollard => PartMaterial::Metal(gray(0.12)),
            PartRole::Step | PartRole::BridgeBody => PartMaterial::Concrete(gray(0.30)),
            PartRole::Deck => PartMaterial::Concrete(gray(0.08)),
            PartRole::Trunk => PartMaterial::Boards(rgb(84, 72, 60)),
            PartRole::Crown | PartRole::Hedge | PartRole::Bush => PartMaterial::Plain(rgb(70, 92, 44)),
        }
    }

    /// Walls whose rows of windows begin `from_m` above the floor.
    fn walls(&self, from_m: f32) -> PartMaterial {
        let Form::Building(b) = self.form else {
            return PartMaterial::Concrete(Vec3::splat(0.3));
        };
        PartMaterial::Walls(Vec3::new(
            b.height_m as f32,
            from_m,
            f32::from(wall_kind(b) as u8),
        ))
    }
}

/// Kinds of walls, as numbers that the renderers share.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum WallKind {
    /// Windows in a wall.
    Windows = 0,
    /// Mostly glass.
    Glass = 1,
    /// Corrugated sheets with gates.
    Hall = 2,
}

/// Halls are wide and low, with a flat roof.
fn wall_kind(b: &Building) -> WallKind {
    let (low, high) = b
        .outline_m
        .iter()
        .fold((DVec2::INFINITY, DVec2::NEG_INFINITY), |(a, c), p| {
            (a.min(*p), c.max(*p))
        });
    match b.facade {
        Facade::Glass => WallKind::Glass,
        Facade::Plain if b.roof == Roof::Flat && b.height_m < 12.0 && (high - low).min_element() > 15.0 => {
            WallKind::Hall
        }
        _ => WallKind::Windows,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn area_m2(outline: &[DVec2]) -> f64 {
        let edges = outline.iter().zip(outline.iter().cycle().skip(1));
        edges.map(|(a, b)| a.perp_dot(*b)).sum::<f64>() / 2.0
    }

    /// Files of roads and buildings give corners on straight walls.
    #[test]
    fn pieces_of_an_outline_cover_it() {
        let corners = [
            [0, 0],
            [4, 0],
            [8, 0],
            [8, 6],
            [6, 6],
            [6, 2],
            [4, 2],
            [2, 2],
            [2, 4],
            [2, 6],
            [0, 6],
            [0, 3],
        ];
        for n in [12, 10, 8, 4] {
            let outline: Vec<DVec2> = corners[..n]
                .iter()
                .map(|c| DVec2::new(c[0].into(), c[1].into()))
                .collect();
            let pieces = convex_pieces(&outline);
            let all: f64 = pieces.iter().map(|p| area_m2(p)).sum();
            assert!(
                (all - area_m2(&outline)).abs() < 1e-9,
                "{n} corners: {all} of {}",
                area_m2(&outline)
            );
        }
    }
}
