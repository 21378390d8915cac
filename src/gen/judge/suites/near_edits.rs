//! Random edits, and the pixels that change although neither the edit nor its shadow or mirror image touches them.

use glam::{DVec2, DVec3};
use rayon::prelude::*;

use super::near::Share;
use scene::{
    BevLayer, BoxId, Camera, Class, Conditions, Edit, Extent, Form, Frame, Scene, SensorRig, Shape, ThingId,
};
use sensors::pictures::appearance::{Appearance, Quality, light_direction};
use sensors::raycast::rays::CameraRays;
use sensors::splat::VIEW_SIZE;
use world::World;
use world::draw::Draw;
use world::voxelize::{Vertical, complete};

/// Distance within which voxels, kerbs and contact shadows of an edit reach, m.
const REACH_M: f64 = 3.5;
/// Distance within which a ray passes what was edited, m.
const PASSES_M: f64 = 1.5;
/// Length of shadow and mirrored rays, m.
const FAR_M: f64 = 80.0;
/// Step along rays, m.
const STEP_M: f64 = 0.2;
/// Farthest edit, m.
const NEAR_M: f64 = 30.0;

/// A scene of a world, with its things.
pub(super) fn scene_of(world: &World) -> Scene {
    let grid = complete(world, Vertical::Occ3d);
    let frame = Frame::new(world.layout.clone(), world.boxes.clone(), grid);
    let mut scene = Scene::single("world", frame, std::sync::Arc::default(), 1);
    scene.background = std::sync::Arc::new(world.background.clone());
    scene.touch();
    scene
}

/// Compares pictures before and after a random edit; `None` if the edit could not be made or changed nothing.
pub(super) fn untouched(before: &Scene, draw: &mut Draw) -> Option<Share> {
    let mut after = before.clone();
    editor::apply_all(&[random_edit(before, draw)?], &mut after).ok()?;
    let touched = Touched::new(before, &after)?;
    let (rig, conditions) = (SensorRig::default(), Conditions::default());
    let appearance = |s: &Scene| Appearance::with_things(s.frame(), &s.background, &rig, &conditions);
    let both = [before, &after].map(appearance);
    let to_sun = light_direction(&conditions).as_dvec3();
    let of_camera = |camera: &Camera| compare(&both, &touched, camera, to_sun);
    Some(
        rig.cameras
            .iter()
            .map(of_camera)
            .fold(Share::default(), |mut all, share| {
                all.add(share);
                all
            }),
    )
}

/// An edit within sight of the cameras.
fn random_edit(scene: &Scene, draw: &mut Draw) -> Option<Edit> {
    let near = |p: DVec2| p.length() < NEAR_M;
    let things: Vec<ThingId> = scene
        .background
        .iter()
        .filter(|t| near(t.form.middle_m()))
        .map(|t| t.id)
        .collect();
    let boxes: Vec<BoxId> = scene
        .frame()
        .boxes
        .values()
        .filter(|b| near(b.center_m.truncate()))
        .map(|b| b.id)
        .collect();
    let thing = |draw: &mut Draw| (!things.is_empty()).then(|| things[draw.below(things.len())]);
    let object = |draw: &mut Draw| (!boxes.is_empty()).then(|| boxes[draw.below(boxes.len())]);
    let place = |draw: &mut Draw| DVec2::new(draw.range(-25.0, 25.0), draw.range(-25.0, 25.0));
    Some(match draw.below(7) {
        0 => Edit::RemoveThings {
            ids: vec![thing(draw)?],
        },
        1 => Edit::MoveThings {
            ids: vec![thing(draw)?],
            by_m: DVec2::new(draw.range(-4.0, 4.0), draw.range(-4.0, 4.0)),
            turn_deg: draw.range(-40.0, 40.0),
        },
        2 => {
            let all = scene.background.iter();
            let built = all.filter(|t| matches!(t.form, Form::Building(_)) && near(t.form.middle_m()));
            let built: Vec<ThingId> = built.map(|t| t.id).collect();
            Edit::RaiseThings {
                ids: vec![*built.get(draw.below(built.len().max(1)))?],
                by_m: 3.0,
            }
        }
        3 => Edit::RemoveBox { id: object(draw)? },
        4 => {
            let id = object(draw)?;
            let center_m = scene.frame().boxes[&id].center_m + place(draw).extend(0.0) * 0.1;
            Edit::MoveBox {
                id,
                center_m: Some(center_m),
                yaw_deg: None,
                size_m: None,
            }
        }
        5 => Edit::PaintBev {
            layer: BevLayer::Walkway,
            shape: Shape::Disc {
                center_m: place(draw),
                radius_m: draw.range(1.0, 4.0),
            },
            value: true,
        },
        _ => {
            let extent = scene.frame().extent();
            let at = place(draw);
            let [x, y] = extent.column_at(at.x, at.y)?;
            let cells = (0..5).flat_map(|i| (0..4).flat_map(move |j| (2..8).map(move |z| [x + i, y + j, z])));
            Edit::PaintVoxels {
                cells: cells.filter(|[x, y, _]| extent.holds(*x, *y)).collect(),
                class: [Class::Manmade, Class::Vegetation, Class::Free][draw.below(3)],
            }
        }
    })
}

/// Places that an edit changed.
struct Touched {
    extent: Extent,
    /// True for columns within [`PASSES_M`] and within [`REACH_M`].
    near: [Vec<bool>; 2],
    /// Highest thing among them, m.
    top_m: f64,
}

impl Touched {
    fn new(before: &Scene, after: &Scene) -> Option<Self> {
        let (a, b) = (before.frame(), after.frame());
        let extent = a.extent();
        if b.extent() != extent {
            return None;
        }
        let mut changed = vec![false; extent.columns()];
        let mut top_m: f64 = 8.0;
        for [x, y] in extent.all_columns() {
            let i = extent.index(x, y);
            changed[i] = a.occupancy.column(x, y) != b.occupancy.column(x, y)
                || a.layout.cells()[i] != b.layout.cells()[i]
                || a.layout.relief.column_m(x, y) != b.layout.relief.column_m(x, y);
        }
        let mut cover = |low: DVec2, high: DVec2| {
            for [x, y] in extent.all_columns() {
                let p = extent.center(x, y, 0).truncate();
                changed[extent.index(x, y)] |= p.cmpge(low - 0.4).all() && p.cmple(high + 0.4).all();
            }
        };
        for [one, other] in [[before, after], [after, before]] {
            for thing in one
                .background
                .iter()
                .filter(|t| other.background.get(t.id) != Some(t))
            {
                let (low, high) = thing.form.bounds_m();
                cover(low, high);
                let mut solids = Vec::new();
                thing.solids(&|p| one.frame().layout.relief.height_m(p), &mut solids);
                top_m = solids
                    .iter()
                    .map(|s| s.center.z + s.reach().z)
                    .fold(top_m, f64::max);
            }
            let theirs = &other.frame().boxes;
            for b in one
                .frame()
                .boxes
                .values()
                .filter(|b| theirs.get(&b.id) != Some(b))
            {
                let half = DVec2::splat(b.size_m.truncate().length() / 2.0);
                cover(b.center_m.truncate() - half, b.center_m.truncate() + half);
            }
        }
        if !changed.contains(&true) {
            return None;
        }
        let grown = |by_m: f64| {
            let n = (by_m / extent.voxel_m()).ceil() as usize;
            let mut near = vec![false; changed.len()];
            for [x, y] in extent
                .all_columns()
                .filter(|[x, y]| changed[extent.index(*x, *y)])
            {
                for x in x.saturating_sub(n)..=(x + n).min(extent.nx() - 1) {
                    for y in y.saturating_sub(n)..=(y + n).min(extent.ny() - 1) {
                        near[extent.index(x, y)] = true;
                    }
                }
            }
            near
        };
        Some(Self {
            extent,
            near: [grown(PASSES_M), grown(REACH_M)],
            top_m: top_m + REACH_M,
        })
    }

    /// True if a point lies near what was changed; `wide` widens it.
    fn holds(&self, p: DVec3, wide: bool) -> bool {
        let column = self.extent.column_at(p.x, p.y);
        p.z < self.top_m && column.is_some_and(|[x, y]| self.near[usize::from(wide)][self.extent.index(x, y)])
    }

    /// True if a ray passes what was changed.
    fn meets(&self, from: DVec3, way: DVec3, far_m: f64, wide: bool) -> bool {
        let steps = (far_m.min(FAR_M) / STEP_M).ceil() as usize;
        (0..=steps).any(|i| self.holds(from + way * (i as f64 * STEP_M), wide))
    }
}

/// Pixels of a camera that nothing of the edit touches, and those of them that changed.
fn compare(both: &[Appearance; 2], touched: &Touched, camera: &Camera, to_sun: DVec3) -> Share {
    let [width, height] = VIEW_SIZE;
    let rays = CameraRays::new(camera, width, height);
    let pictures = both
        .each_ref()
        .map(|a| a.render_plain(camera, VIEW_SIZE, Quality::Preview));
    let truths = both
        .each_ref()
        .map(|a| a.truth(camera, VIEW_SIZE, &Default::default(), None));
    let to_ego = camera.ego_from_camera().rotation;
    let one = |i: usize| {
        let mut share = Share::default();
        let ray = rays.at(
            f64::from(i as u32 % width) + 0.5,
            f64::from(i as u32 / width) + 0.5,
        );
        let way = ray.direction.normalize();
        let far = truths
            .each_ref()
            .map(|t| f64::from(t.pixels[i].depth_m) * ray.direction.length());
        let far = far.map(|m| if m.is_finite() && m >= 0.0 { m } else { FAR_M });
        if touched.meets(ray.origin, way, far[0].max(far[1]), false) {
            return share;
        }
        let p = ray.origin + way * far[0];
        let normal = to_ego * glam::Vec3::from(truths[0].pixels[i].normal_in_camera).as_dvec3();
        let mirrored = way - normal * (2.0 * way.dot(normal));
        let is_touched = far[0] < FAR_M
            && (touched.holds(p, true)
                || touched.meets(p, to_sun, FAR_M, false)
                || touched.meets(p, mirrored, FAR_M, true));
        if !is_touched {
            share.note(pictures[0][i] != pictures[1][i]);
        }
        share
    };
    let all = (0..pictures[0].len()).into_par_iter().map(one);
    all.reduce(Share::default, |mut a, b| {
        a.add(b);
        a
    })
}
