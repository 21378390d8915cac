//! `eval near`: surfaces within 25 m that the pictures show, beside the solids of the scene's things on the ground that the
//! scene knows: walls, posts and fences pixel by pixel. Drawn as things, and, for comparison, as if only the voxels were known.

use glam::{DVec3, Vec3};
use rayon::prelude::*;
use serde_json::{Value, json};

use super::near_edits::{scene_of, untouched};
use crate::suite::{Bar, Options, SuiteFigures};
use calibration::MeasurementProgress;
use calibration::held_out::TEST_SEED;
use scene::background::LineKind;
use scene::solid::Solid;
use scene::truth::{self, TruthPixel};
use scene::{Background, Camera, Class, Conditions, Form, Frame, SensorRig, ThingId};
use sensors::pictures::appearance::Appearance;
use sensors::raycast::rays::CameraRays;
use sensors::splat::VIEW_SIZE;
use world::World;
use world::draw::Draw;
use world::draw::hash;
use world::voxelize::{Vertical, complete};

/// Farthest surface that counts, m.
const NEAR_M: f64 = 25.0;
/// Height above the ground up to which pavements hide what stands on them, m.
const FOOT_M: f64 = 0.2;
/// Largest distance of a wall from where it stands, m.
const OFF_M: f64 = 0.15;
/// Largest angle of a wall's normal to the true one, degrees.
const TURNED_DEG: f64 = 10.0;
/// Worlds of which pictures are compared before and after edits, and random edits of each.
const EDITED: usize = 12;
const EDITS: usize = 5;
/// A man-made surface farther than this from anything man-made stands where nothing is, m.
const NOTHING_M: f64 = 0.6;

/// Counts of pixels: how many of how many.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Share(u64, u64);

impl Share {
    pub(super) fn note(&mut self, is_wrong: bool) {
        self.0 += u64::from(is_wrong);
        self.1 += 1;
    }

    pub(super) fn add(&mut self, other: Self) {
        self.0 += other.0;
        self.1 += other.1;
    }

    fn value(self) -> f64 {
        self.0 as f64 / self.1.max(1) as f64
    }

    fn json(self) -> Value {
        json!({ "share": (self.value() * 1e5).round() / 1e5, "wrong": self.0, "pixels": self.1 })
    }
}

/// What is wrong with the pixels of some pictures.
#[derive(Clone, Copy, Debug, Default)]
struct NearPixels {
    /// Walls whose normal is turned.
    turned: Share,
    /// Walls that stand elsewhere.
    off: Share,
    /// Posts that are not there.
    posts: Share,
    /// Fences that are not there.
    fences: Share,
    /// Man-made surfaces where nothing stands.
    nothing: Share,
    /// Walls, posts and fences behind leaves that are drawn where there are none.
    hidden: Share,
}

impl NearPixels {
    fn add(mut self, other: Self) -> Self {
        self.turned.add(other.turned);
        self.off.add(other.off);
        self.posts.add(other.posts);
        self.fences.add(other.fences);
        self.nothing.add(other.nothing);
        self.hidden.add(other.hidden);
        self
    }

    fn json(self) -> Value {
        json!({
            "wall_normal_off_by_10_degrees": self.turned.json(),
            "wall_off_by_15_cm": self.off.json(),
            "posts_missing": self.posts.json(),
            "fences_missing": self.fences.json(),
            "manmade_where_nothing_is": self.nothing.json(),
            "hidden_by_leaves_that_are_not_there": self.hidden.json(),
        })
    }
}

/// The solids of all things of a world on the ground as a scene knows it, without the bumps of the world's own.
struct Things<'a> {
    background: &'a Background,
    /// Each solid with its thing and the radius of a sphere around it, m.
    solids: Vec<(Solid, ThingId, f64)>,
}

impl<'a> Things<'a> {
    fn new(world: &'a World) -> Self {
        let relief = &world.layout.relief;
        let mut solids = Vec::new();
        for thing in world.background.iter() {
            let mut own = Vec::new();
            thing.solids(&|p| relief.height_m(p), &mut own);
            solids.extend(own.into_iter().map(|s| {
                let radius_m = s.reach().length();
                (s, thing.id, radius_m)
            }));
        }
        let background = &world.background;
        Self { background, solids }
    }

    /// Those near a camera.
    fn near(&self, place: DVec3) -> Vec<&(Solid, ThingId, f64)> {
        let near =
            |(s, _, radius_m): &&(Solid, ThingId, f64)| (s.center - place).length() < NEAR_M + radius_m;
        self.solids.iter().filter(near).collect()
    }

    /// True if something man-made is within reach of a point; a fence is there where its holes are too.
    fn is_made_near(&self, p: DVec3) -> bool {
        let steps = [-1.0, -0.5, 0.0, 0.5, 1.0];
        let flat = steps.iter().flat_map(|x| steps.iter().map(move |y| (*x, *y)));
        let around = flat.flat_map(|(x, y)| steps.map(|z| DVec3::new(x, y, z)));
        let places: Vec<DVec3> = around
            .filter(|d| d.length_squared() <= 1.0)
            .map(|d| p + d * NOTHING_M)
            .collect();
        let made = self.solids.iter().map(|(s, ..)| s);
        let made = made.filter(|s| matches!(s.class, Class::Manmade | Class::Others));
        let mut near = made.filter(|s| (s.center - p).abs().cmple(s.reach() + NOTHING_M).all());
        near.any(|s| {
            let mut solid = s.clone();
            solid.porosity = 0.0;
            // Thin ones pass between the places; the box around them is as good.
            s.reach().min_element() < NOTHING_M || places.iter().any(|p| solid.contains(*p))
        })
    }
}

/// The first solid along a ray.
fn first<'a>(
    near: &[&'a (Solid, ThingId, f64)],
    origin: DVec3,
    way: DVec3,
) -> Option<(f64, &'a Solid, ThingId)> {
    let mut best: Option<(f64, &Solid, ThingId)> = None;
    for (solid, id, radius_m) in near {
        let to = solid.center - origin;
        let along = to.dot(way);
        let limit = best.map_or(NEAR_M, |b| b.0);
        let beside = to.length_squared() - along * along > radius_m * radius_m;
        if beside || along < -radius_m || along > limit + radius_m {
            continue;
        }
        if let Some(t) = solid.enter(origin, way, limit) {
            best = Some((t, solid, *id));
        }
    }
    best
}

/// Compares a camera's surfaces with those of a world.
fn compare(world: &World, things: &Things<'_>, appearance: &Appearance, camera: &Camera) -> NearPixels {
    let [width, height] = VIEW_SIZE;
    let rays = CameraRays::new(camera, width, height);
    let pixels = appearance.truth(camera, VIEW_SIZE, &world.boxes, None).pixels;
    let to_ego = camera.ego_from_camera().rotation.as_quat();
    let near = things.near(rays.origin);
    let one = |(i, shown): (usize, &TruthPixel)| {
        let mut out = NearPixels::default();
        let (u, v) = (i % width as usize, i / width as usize);
        let ray = rays.at(u as f64 + 0.5, v as f64 + 0.5);
        let way = ray.direction.normalize();
        let shown_m = f64::from(shown.depth_m) * ray.direction.length();
        let is_made = shown.class == Class::Manmade.id() || shown.class == truth::OTHERS;
        if is_made && shown.instance == 0 && shown_m < NEAR_M {
            out.nothing.note(!things.is_made_near(ray.origin + way * shown_m));
        }
        // Objects in front are another question, and so is the foot on the pavement.
        let Some((t, solid, id)) = first(&near, ray.origin, way).filter(|_| shown.instance == 0) else {
            return out;
        };
        let p = ray.origin + way * t;
        let above_m = p.z - world.layout.relief.height_m(p.truncate());
        let Some(thing) = things.background.get(id).filter(|_| above_m > FOOT_M) else {
            return out;
        };
        let is_there = is_made && (shown_m - t).abs() < 0.5;
        let is_hidden = shown.class == Class::Vegetation.id() && shown_m < t;
        let normal = solid.normal_at(p);
        match &thing.form {
            Form::Building(_) | Form::Post(_) | Form::Line(_) if is_hidden => {
                out.hidden.note(solid.class != Class::Vegetation);
            }
            Form::Building(_) if normal.z.abs() < 0.3 => {
                let found = (to_ego * Vec3::from(shown.normal_in_camera)).as_dvec3();
                let cos = found.dot(normal);
                out.turned.note(!(is_made && cos > TURNED_DEG.to_radians().cos()));
                out.off.note(!(is_made && (shown_m - t).abs() < OFF_M));
                out.hidden.note(false);
            }
            Form::Post(_) => {
                out.posts.note(!is_there);
                out.hidden.note(false);
            }
            Form::Line(line) if line.kind == LineKind::Fence => {
                out.fences.note(!is_there);
                out.hidden.note(false);
            }
            _ => {}
        }
        out
    };
    let found = pixels.par_iter().enumerate().map(one);
    found.reduce(NearPixels::default, NearPixels::add)
}

/// World `i` of the suite, level or not.
fn world_of(i: u64, level: bool) -> World {
    let seeds = (0..).map(|k| hash(hash(TEST_SEED) ^ (i << 8 | k)));
    match level {
        true => World::random_level(hash(hash(TEST_SEED) ^ i)),
        false => seeds
            .map(World::random)
            .find(|world| !world.layout.relief.is_flat())
            .unwrap_or_else(|| World::random_level(i)),
    }
}

impl Options {
    /// Judges walls, posts and fences near the cameras.
    pub(crate) fn near(&self, progress: &dyn MeasurementProgress) -> anyhow::Result<SuiteFigures> {
        let rig = SensorRig::default();
        let (mut report, mut bars): (Value, Vec<Bar>) =
            (json!({ "near_m": NEAR_M, "pictures_px": VIEW_SIZE }), Vec::new());
        for (name, level) in [("level", true), ("slopes", false)] {
            let mut found = [NearPixels::default(); 2];
            for i in 0..self.frames {
                progress.at("near", i + if level { 0 } else { self.frames }, 2 * self.frames);
                let world = world_of(i as u64, level);
                let grid = complete(&world, Vertical::Occ3d);
                let frame = Frame::new(world.layout.clone(), world.boxes.clone(), grid);
                let (unknown, things) = (Background::default(), Things::new(&world));
                for (found, background) in found.iter_mut().zip([&world.background, &unknown]) {
                    let conditions = Conditions::default();
                    let appearance = Appearance::with_things(&frame, background, &rig, &conditions);
                    let compare = |camera| compare(&world, &things, &appearance, camera);
                    let cameras = rig.cameras.iter().map(compare);
                    *found = cameras.fold(*found, NearPixels::add);
                }
            }
            let [things, voxels] = found;
            report[name] = json!({ "things": things.json(), "voxels": voxels.json() });
            if level {
                bars.extend([
                    ("walls whose normal is right", 1.0 - things.turned.value(), 0.98),
                    ("walls where they stand", 1.0 - things.off.value(), 0.97),
                    ("posts that are there", 1.0 - things.posts.value(), 0.98),
                    ("fences that are there", 1.0 - things.fences.value(), 0.98),
                    (
                        "man-made surfaces where something is",
                        1.0 - things.nothing.value(),
                        0.99,
                    ),
                ]);
            }
        }
        let mut draw = Draw::new(TEST_SEED, "edits of pictures");
        let (mut changed, mut made, mut worst) = (Share::default(), 0, 0.0f64);
        for i in 0..EDITED {
            let scene = scene_of(&world_of(hash(i as u64), i % 2 == 0));
            for k in 0..EDITS {
                progress.at("edits", i * EDITS + k, EDITED * EDITS);
                let Some(share) = untouched(&scene, &mut draw) else {
                    continue;
                };
                made += 1;
                worst = worst.max(share.value());
                changed.add(share);
            }
        }
        report["untouched_by_edits"] = json!({ "edits": made, "changed": changed.json(), "worst": worst });
        let is_whole = made * 2 > EDITED * EDITS && changed.value() == 0.0;
        bars.push((
            "pixels that an edit does not touch stay",
            f64::from(u8::from(is_whole)),
            1.0,
        ));
        Ok((report, bars))
    }
}
