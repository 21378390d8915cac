//! A frame prepared to be looked at: voxels as a field, ground, things, lamps; and the rays through it.

use std::sync::Arc;

use glam::{Quat, Vec2, Vec3};

use super::field::OccupancyField;
use super::ground::SmoothGround;
use super::sky::Air;
use super::still::AppearanceCache;
use super::things::{DrawnObject, PartMaterial};
use crate::pictures::march::paint::RoadMarkings;
use crate::raycast::rays::CameraRay;
use scene::appearance::{BLOCK_M, FAR_M};
use scene::{Background, Conditions, Extent, Frame, Lattice, Pose, SensorRig};

/// Most lamps.
const MOST_LAMPS: usize = 96;
/// Distance around a thing within which it is listed, m, for its contact shadow.
const NEAR_M: f32 = 0.6;

/// Distance of a street light's lamp from the end of its arm, m.
const LAMP_END_M: f32 = 0.3;

/// A lamp.
#[derive(Clone, Copy, Debug)]
pub struct Lamp {
    /// Place, ego frame, m.
    pub at: Vec3,
    /// Axis of its beam, a unit vector.
    pub axis: Vec3,
    /// Light at 1 m on the axis.
    pub color: Vec3,
    /// Kind of beam.
    pub beam: Beam,
    /// Range beyond which it gives no light, m.
    pub range_m: f32,
}

/// How a lamp spreads its light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Beam {
    /// All around below it.
    Street,
    /// Low beam: wide, cut off above.
    Head,
    /// A weak glow.
    Glow,
}

/// Kind of surface that a ray met.
#[derive(Clone, Copy, Debug)]
pub enum SurfaceKind {
    /// Ground.
    Ground,
    /// Voxels of a class.
    Voxel(u8),
    /// A part of a thing: number of the thing, local point, number of the part.
    Thing(u32, Vec3, u32),
}

/// Where a ray met something.
#[derive(Clone, Copy, Debug)]
pub struct SurfaceHit {
    /// Distance, m.
    pub t: f32,
    /// Place, ego frame, m.
    pub p: Vec3,
    /// Normal, ego frame; for the ground and voxels filled in by [`Appearance::normal`].
    pub normal: Vec3,
    /// Kind of surface.
    pub what: SurfaceKind,
    /// Time at which it is seen, s after the moment of the picture: a rolling shutter reads row by row.
    pub after_s: f32,
}

/// A frame under certain conditions, ready for any camera.
pub struct Appearance {
    pub(super) field: Arc<OccupancyField>,
    pub(super) ground: Arc<SmoothGround>,
    pub(super) things: Vec<DrawnObject>,
    /// Things near each block. A thing is listed in a rectangle of blocks, so the blocks on a ray that list it follow
    /// one another: a thing that the block before lists too has been tested already.
    lists: Vec<Vec<u32>>,
    pub(super) paint: Arc<RoadMarkings>,
    pub(super) lamps: Vec<Lamp>,
    pub(super) air: Air,
    pub(super) seed: u32,
    /// Rotation from the ego frame to the frame in which textures are anchored.
    turn: Quat,
    shift: Vec3,
    /// Position of the vehicle, m: rain and snow fall around it.
    pub(super) vehicle: Vec2,
    /// Height above which nothing stands, m.
    highest: f32,
    /// Height below which nothing is, m.
    lowest: f32,
}

impl Appearance {
    /// Prepares a frame whose scenery is not known; see [`Self::with_things`].
    pub fn new(frame: &Frame, rig: &SensorRig, conditions: &Conditions) -> Self {
        Self::with_things(frame, &Background::default(), rig, conditions)
    }

    /// Prepares a frame; takes some 40 ms for a window. Voxels that belong to a thing of the background look as that
    /// thing does, whatever is edited elsewhere. Parts of a map that cannot be seen from the ego vehicle are left out.
    pub fn with_things(
        frame: &Frame,
        background: &Background,
        rig: &SensorRig,
        conditions: &Conditions,
    ) -> Self {
        Self::with_cache(frame, background, rig, conditions, &AppearanceCache::default())
    }

    /// Prepares a frame as [`Self::with_things`] does, but makes anew only what the frame does not share with the one that was
    /// prepared with the same cache before: some 5 ms for another moment of a clip on a map that is seen whole.
    pub fn with_cache(
        frame: &Frame,
        background: &Background,
        rig: &SensorRig,
        conditions: &Conditions,
        cache: &AppearanceCache,
    ) -> Self {
        let seed = (conditions.seed ^ conditions.seed >> 32) as u32;
        let still = cache.parts(frame, background, in_sight(frame.extent(), &rig.vehicle), seed);
        let (field, ground) = (&still.field, &still.ground);
        let mut things: Vec<DrawnObject> = frame
            .boxes
            .values()
            .filter_map(|b| {
                let covered_m = frame.covered_m.get(&b.id).copied();
                DrawnObject::from_box(b, frame.own_shapes.get(&b.id), covered_m, seed)
            })
            .chain(still.scenery.objects().cloned())
            .collect();
        let ([blocks_x, blocks_y], from) = (field.shape().blocks, field.shape().blocks_from_m);
        let mut lists = vec![Vec::new(); blocks_x * blocks_y];
        // Largest time between the moment of the picture and the reading of a row, s.
        let rolls = rig.cameras.iter().filter_map(|c| c.shutter);
        let rolls_s = rolls.map(|s| s.readout_s / 2.0).fold(0.0, f64::max) as f32;
        for (i, thing) in things.iter_mut().enumerate() {
            // A thing does not stand in the pavement.
            let p = thing.foot.truncate();
            let height = ground.at(p, p).height_m;
            if thing.foot.z > ground.base_m(p) - 0.3 && !thing.is_scenery() {
                thing.foot.z = thing.foot.z.max(height);
            }
            let drift = thing.velocity.truncate().length() * rolls_s;
            let reach = thing.reach_on_ground() + NEAR_M + drift;
            let (lo, hi) = ((p - reach - from) / BLOCK_M, (p + reach - from) / BLOCK_M);
            for x in within(lo.x, hi.x, blocks_x) {
                for y in within(lo.y, hi.y, blocks_y) {
                    lists[x * blocks_y + y].push(i as u32);
                }
            }
        }
        let tallest = things.iter().map(|t| t.foot.z + t.bound.z).fold(0.3, f32::max);
        let air = Air::new(conditions);
        let lamps = lamps(&air, field, &things, rig);
        Self {
            highest: field.highest_m().max(tallest) + 0.1,
            lowest: ground.lowest_m() - 0.4,
            field: field.clone(),
            ground: ground.clone(),
            things,
            lists,
            paint: still.paint.clone(),
            lamps,
            air,
            seed,
            turn: Quat::IDENTITY,
            shift: Vec3::ZERO,
            vehicle: rig.vehicle.translation_m.truncate().as_vec2(),
        }
    }

    /// A point in the frame in which textures are anchored.
    #[inline]
    pub(super) fn anchor(&self, p: Vec3) -> Vec3 {
        self.turn * p + self.shift
    }

    /// Rotation and shift of [`Self::anchor`].
    pub(super) fn anchoring(&self) -> (Quat, Vec3) {
        (self.turn, self.shift)
    }

    /// Things near each block.
    pub(super) fn lists(&self) -> impl Iterator<Item = &[u32]> {
        self.lists.iter().map(Vec::as_slice)
    }

    /// Height below which nothing is, m.
    pub(super) fn lowest_m(&self) -> f32 {
        self.lowest
    }

    /// Height above which nothing stands, m.
    pub(super) fn highest_m(&self) -> f32 {
        self.highest
    }

    /// A direction in the frame in which textures are anchored.
    #[inline]
    pub(super) fn anchor_dir(&self, d: Vec3) -> Vec3 {
        self.turn * d
    }

    /// Direction to the sun in the ego frame.
    pub(super) fn to_sun(&self) -> Vec3 {
        self.turn.conjugate() * self.air.to_sun
    }

    /// Things near a point of the ground.
    pub(super) fn things_near(&self, p: Vec2) -> &[u32] {
        let shape = self.field.shape();
        let [x, y] = shape.blocks;
        let c = ((p - shape.blocks_from_m) / BLOCK_M).floor();
        if c.cmpge(Vec2::ZERO).all() && c.cmplt(Vec2::new(x as f32, y as f32)).all() {
            &self.lists[c.x as usize * y + c.y as usize]
        } else {
            &[]
        }
    }

    /// The first surface along a ray whose direction is a unit vector, `after_s` after the moment of the frame: boxes that move
    /// are where they are by then. The normal of voxels and ground is left for
    /// [`Self::normal`].
    pub(super) fn trace(
        &self,
        (o, d): (Vec3, Vec3),
        after_s: f32,
        limit: f32,
        coarse: bool,
    ) -> Option<SurfaceHit> {
        if !(o.is_finite() && d.is_finite()) {
            return None;
        }
        let anchor = |p: Vec3| self.anchor(p);
        let ground = self.ground.cast(o, d, limit, &anchor);
        let mut best = ground.unwrap_or(limit);
        let mut hit = ground.map(|t| (Vec3::Z, SurfaceKind::Ground, t));
        let mut before: &[u32] = &[];
        self.walk(o, d, best, |index, t_in, t_out| {
            let listed = std::mem::replace(&mut before, &self.lists[index]);
            for &i in before {
                let thing = &self.things[i as usize];
                let from = thing.seen_from(o, after_s);
                if thing.is_passed(from, d) || listed.contains(&i) {
                    continue;
                }
                if let Some(h) = thing.cast(from, d, best) {
                    best = h.t;
                    let what = SurfaceKind::Thing(i, h.local, h.part);
                    hit = Some((thing.turn_back(h.normal), what, h.t));
                }
            }
            if self.field.block(index) && t_in < best {
                let step = if coarse {
                    0.17
                } else {
                    (0.1 + t_in * 0.002).min(0.15)
                };
                // Leaves beyond 45 m are finer than a pixel.
                let leaves = !coarse || t_in < 12.0;
                if let Some(h) =
                    self.field
                        .cast_block(index, (o, d), (t_in, t_out.min(best)), step, leaves, &anchor)
                    && h.t < best
                {
                    best = h.t;
                    hit = Some((Vec3::ZERO, SurfaceKind::Voxel(h.label), h.t));
                }
            }
            best <= t_out
        });
        hit.map(|(normal, what, t)| SurfaceHit {
            t,
            p: o + d * t,
            normal,
            what,
            after_s,
        })
    }

    /// Visits the blocks along a ray until `visit` says that it has its hit.
    #[inline]
    fn walk(&self, o: Vec3, d: Vec3, limit: f32, mut visit: impl FnMut(usize, f32, f32) -> bool) {
        let (blocks, from) = (self.field.shape().blocks, self.field.shape().blocks_from_m);
        let size = blocks.map(|n| n as f32 * BLOCK_M);
        let (mut t0, mut t1) = (0.0f32, limit);
        let bounds = [
            (from.x, from.x + size[0]),
            (from.y, from.y + size[1]),
            (self.lowest, self.highest),
        ];
        for (axis, (lo, hi)) in bounds.into_iter().enumerate() {
            if d[axis].abs() < 1e-9 {
                if !(lo..=hi).contains(&o[axis]) {
                    return;
                }
                continue;
            }
            let (a, b) = ((lo - o[axis]) / d[axis], (hi - o[axis]) / d[axis]);
            (t0, t1) = (t0.max(a.min(b)), t1.min(a.max(b)));
        }
        // Written so that NaN ends here too.
        let inside = t0 < t1;
        if !inside {
            return;
        }
        let q = (o.truncate() - from) / BLOCK_M;
        let qd = d.truncate() / BLOCK_M;
        let start = |a: usize| ((q[a] + qd[a] * (t0 + 1e-4)).max(0.0) as usize).min(blocks[a] - 1);
        let mut cell = [start(0), start(1)];
        let mut t = t0;
        for _ in 0..blocks[0] + blocks[1] + 2 {
            let next = |a: usize| {
                if qd[a].abs() < 1e-9 {
                    return f32::INFINITY;
                }
                ((cell[a] + usize::from(qd[a] > 0.0)) as f32 - q[a]) / qd[a]
            };
            let (tx, ty) = (next(0), next(1));
            let t_out = tx.min(ty).min(t1);
            if visit(cell[0] * blocks[1] + cell[1], t, t_out) || t_out >= t1 {
                return;
            }
            let axis = usize::from(ty < tx);
            let moved = cell[axis].wrapping_add_signed(if qd[axis] > 0.0 { 1 } else { -1 });
            if moved >= blocks[axis] {
                return;
            }
            cell[axis] = moved;
            t = t_out;
        }
    }

    /// True if a thing or a voxel lies between a point and the light in direction `d`; voxels are sampled every `step`
    /// m.
    pub(super) fn occluded(&self, (o, d): (Vec3, Vec3), after_s: f32, limit: f32, step: f32) -> bool {
        let anchor = |p: Vec3| self.anchor(p);
        let (mut dark, mut before) = (false, &[] as &[u32]);
        self.walk(o, d, limit, |index, t_in, t_out| {
            let listed = std::mem::replace(&mut before, &self.lists[index]);
            dark = before.iter().any(|i| {
                let thing = &self.things[*i as usize];
                let from = thing.seen_from(o, after_s);
                !thing.is_passed(from, d) && !listed.contains(i) && thing.cast(from, d, limit).is_some()
            }) || self.field.block(index)
                && self
                    .field
                    .cast_block(index, (o, d), (t_in.max(0.05), t_out), step, true, &anchor)
                    .is_some();
            dark
        });
        dark
    }

    /// The outward normal of the first surface along a ray of the ego frame, a unit vector of that frame. `None` for
    /// the sky, for a zero direction and for numbers that are not finite.
    pub fn surface_normal(&self, ray: &CameraRay) -> Option<Vec3> {
        let d = ray.direction.as_vec3().try_normalize()?;
        let hit = self.trace((ray.origin.as_vec3(), d), ray.after_s as f32, FAR_M, false)?;
        Some(self.normal(&hit)).filter(|n| n.is_finite())
    }

    /// The normal at a hit.
    pub(super) fn normal(&self, hit: &SurfaceHit) -> Vec3 {
        let anchor = |p: Vec3| self.anchor(p);
        match hit.what {
            SurfaceKind::Ground if hit.t < 60.0 => self.ground.normal(hit.p, &anchor),
            SurfaceKind::Voxel(label) => self.field.normal(hit.p, label, &anchor),
            _ => hit.normal,
        }
    }
}

/// Blocks `0..n` along an axis between two places, in blocks.
fn within(from: f32, to: f32, n: usize) -> std::ops::Range<usize> {
    let block = |v: f32| v.floor().clamp(-1.0, n as f32);
    block(from).max(0.0) as usize..(block(to) + 1.0).min(n as f32) as usize
}

/// The part of a map that can be seen from near the ego vehicle; a single column if none can.
fn in_sight(map: Extent, vehicle: &Pose) -> Extent {
    let columns = (f64::from(FAR_M) / Lattice::OCC3D.voxel_m()).ceil() as usize;
    let middle = [vehicle.translation_m.x, vehicle.translation_m.y]
        .map(|v| (v * Lattice::OCC3D.per_m()).round() as i32);
    let far = Extent::new(middle.map(|c| c.saturating_sub(columns as i32)), [2 * columns; 2]);
    let seen = far.ok().and_then(|far| far.overlap(&map).map(|part| (far, part)));
    let corner = |from: [i32; 2], at: [usize; 2]| [0, 1].map(|i| from[i] + at[i] as i32);
    let seen = match seen {
        Some((far, part)) => Extent::new(corner(far.from(), part.here), part.size),
        None => Extent::new(map.from(), [1; 2]),
    };
    seen.unwrap_or(map)
}

fn lamps(air: &Air, field: &OccupancyField, things: &[DrawnObject], rig: &SensorRig) -> Vec<Lamp> {
    let mut out = Vec::new();
    if air.lamps <= 0.0 {
        return out;
    }
    let warm = Vec3::new(1.0, 0.70, 0.38);
    let arms = things
        .iter()
        .filter(|t| matches!(t.parts.first(), Some((_, PartMaterial::Lamp))));
    for arm in arms {
        let end = arm.foot + arm.turn_back(Vec3::new(arm.size.x / 2.0 - LAMP_END_M, 0.0, -0.05));
        out.push(Lamp {
            at: end,
            axis: -Vec3::Z,
            color: warm * 15.0 * air.lamps,
            beam: Beam::Street,
            range_m: 26.0,
        });
    }
    for s in field.structures.iter().filter(|s| s.thin && s.height_m > 3.9) {
        out.push(Lamp {
            at: s.top.extend(s.height_m - 0.25),
            axis: -Vec3::Z,
            color: warm * 15.0 * air.lamps,
            beam: Beam::Street,
            range_m: 26.0,
        });
    }
    let mut beams = |foot: Vec3, turn: &dyn Fn(Vec3) -> Vec3, size: Vec3, strength: f32| {
        for side in [1.0, -1.0] {
            let place = |x: f32, z: f32| foot + turn(Vec3::new(x * size.x, side * 0.36 * size.y, z));
            out.push(Lamp {
                at: place(0.51, 0.62),
                axis: turn(Vec3::new(1.0, 0.0, -0.035).normalize()),
                color: Vec3::new(1.0, 0.93, 0.80) * strength,
                beam: Beam::Head,
                range_m: 60.0,
            });
            out.push(Lamp {
                at: place(-0.52, 0.75),
                axis: turn(-Vec3::X),
                color: Vec3::new(1.0, 0.06, 0.03) * 0.35,
                beam: Beam::Glow,
                range_m: 6.0,
            });
        }
    };
    let size = Vec3::from(rig.ego_size_m.map(|v| v as f32));
    let mut foot = glam::DVec3::from(rig.ego_center_m);
    foot.z = 0.0;
    let foot = rig.vehicle.apply(foot).as_vec3();
    // The vehicle of the rig has its own, also where it is a box of the frame.
    let is_own = |t: &&DrawnObject| t.foot.truncate().distance(foot.truncate()) < 0.1;
    for t in things.iter().filter(|t| t.lamps && !is_own(t)) {
        beams(t.foot, &|p| t.turn_back(p), t.size, 42.0 * air.lamps);
    }
    let turn = rig.vehicle.rotation.as_quat();
    beams(foot, &|p| turn * p, size, 75.0 * air.lamps);
    out.retain(|l| l.at.is_finite());
    if out.len() > MOST_LAMPS {
        // The lamps nearest to the vehicle are kept, so that a lamp put up far away displaces none of them.
        out.sort_by(|a, b| {
            a.at.distance_squared(foot)
                .total_cmp(&b.at.distance_squared(foot))
        });
        out.truncate(MOST_LAMPS);
    }
    out
}
