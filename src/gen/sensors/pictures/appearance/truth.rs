//! Classes, instances, depths, normals and flow of a picture, each from the hit that made the pixel's colour.

use std::collections::BTreeMap;

use glam::{DVec2, DVec3, Vec3};
use rayon::prelude::*;

use super::prepared::{Appearance, SurfaceHit, SurfaceKind};
use super::shade::VisibleSurface;
use super::things::DrawnObject;
use crate::raycast::rays::{CameraRay, CameraRays};
use scene::appearance::TRUNK;
use scene::truth::{self, CameraTruth, SeenBox, TruthClass, TruthPixel};
use scene::{BoxId, Camera, Class, SceneBox};

/// The next moment of a clip, to which optical flow leads.
#[derive(Clone, Debug)]
pub struct NextMoment<'a> {
    /// The camera at that moment, its pose in the same frame as now.
    pub camera: Camera,
    /// The boxes at that moment.
    pub boxes: &'a BTreeMap<BoxId, SceneBox>,
    /// Time until that moment, s.
    pub after_s: f64,
}

/// Most pixels that are tested to find how much of a box is hidden.
const LOOKS: f64 = 40_000.0;

/// Labels the pixels of one camera.
pub(super) struct Teller<'a> {
    appearance: &'a Appearance,
    rays: CameraRays,
    to_camera: glam::Quat,
    next: Option<Next>,
}

/// The next moment, ready for flow.
struct Next {
    rays: CameraRays,
    /// Pose of each thing at that moment: foot and rotation about the vertical; `None` if it is gone.
    things: Vec<Option<(Vec3, glam::Vec2)>>,
}

impl<'a> Teller<'a> {
    pub fn new(
        appearance: &'a Appearance,
        camera: &Camera,
        size: [u32; 2],
        next: Option<&NextMoment<'_>>,
    ) -> Self {
        let next = next.map(|next| Next {
            rays: CameraRays::new(&next.camera, size[0], size[1]),
            things: appearance.things.iter().map(|t| moved(t, next.boxes)).collect(),
        });
        Self {
            appearance,
            rays: CameraRays::new(camera, size[0], size[1]),
            to_camera: camera.ego_from_camera().rotation.as_quat().conjugate(),
            next,
        }
    }

    /// Ground truth of a pixel with its middle at (u, v) that shows `seen`.
    pub fn pixel(&self, seen: &VisibleSurface, ray: &CameraRay, (u, v): (f64, f64)) -> TruthPixel {
        let unit = ray.direction.normalize_or_zero();
        let depth = |t: f32| (f64::from(t) / ray.direction.length()) as f32;
        let flow = |p: Option<DVec2>| match p {
            Some(p) => [(p.x - u) as f32, (p.y - v) as f32],
            None => [f32::NAN; 2],
        };
        let far = |next: &Next, p: DVec3| next.rays.seen_at(p, DVec3::ZERO);
        match seen {
            VisibleSurface::Sky => TruthPixel {
                class: truth::SKY,
                // The sky moves with the camera.
                flow_px: flow(
                    self.next
                        .as_ref()
                        .and_then(|n| far(n, n.rays.origin + unit * 1e6)),
                ),
                ..TruthPixel::default()
            },
            VisibleSurface::Skyline(class, t) => TruthPixel {
                class: truth::of_class(*class),
                depth_m: depth(*t),
                flow_px: flow(
                    self.next
                        .as_ref()
                        .and_then(|n| far(n, ray.origin + unit * f64::from(*t))),
                ),
                ..TruthPixel::default()
            },
            VisibleSurface::Surface(hit, footprint) => {
                let (class, instance) = self.appearance.label(hit, *footprint);
                TruthPixel {
                    class,
                    instance,
                    depth_m: depth(hit.t),
                    normal_in_camera: (self.to_camera * self.appearance.normal(hit)).to_array(),
                    flow_px: flow(
                        self.next
                            .as_ref()
                            .and_then(|n| far(n, n.place(self.appearance, hit))),
                    ),
                }
            }
        }
    }
}

/// Foot and heading of a thing at another moment; `None` if it is gone.
fn moved(thing: &DrawnObject, boxes: &BTreeMap<BoxId, SceneBox>) -> Option<(Vec3, glam::Vec2)> {
    let Some(id) = thing.box_id else {
        return Some((thing.foot, thing.heading));
    };
    let b = boxes.get(&id)?;
    // It stands on the same ground as now: its foot is as high as now, or at the bottom of its box if that is higher.
    let foot = b.center_m.truncate().as_vec2().extend(thing.foot.z);
    let bottom = (b.center_m.z - b.size_m.z / 2.0) as f32;
    Some((foot.truncate().extend(foot.z.max(bottom)), b.heading().as_vec2()))
}

impl Next {
    /// Place of a hit at the next moment; NaN if its thing is gone.
    fn place(&self, appearance: &Appearance, hit: &SurfaceHit) -> DVec3 {
        let still = hit.p.as_dvec3();
        let SurfaceKind::Thing(i, ..) = hit.what else {
            return still;
        };
        let thing = &appearance.things[i as usize];
        let Some((foot, heading)) = self.things[i as usize] else {
            return DVec3::NAN;
        };
        let local = thing.to_local(thing.seen_from(hit.p, hit.after_s));
        let turned = Vec3::new(
            local.x * heading.x - local.y * heading.y,
            local.x * heading.y + local.y * heading.x,
            local.z,
        );
        (foot + turned).as_dvec3()
    }
}

impl Appearance {
    /// Class and instance of a surface as the picture shows it; `footprint` is the width of a pixel on it, m.
    pub(super) fn label(&self, hit: &SurfaceHit, footprint: f32) -> (TruthClass, u32) {
        match hit.what {
            SurfaceKind::Ground => (self.ground_label(hit.p, footprint), 0),
            SurfaceKind::Voxel(TRUNK) => (truth::of_class(Class::Vegetation), 0),
            SurfaceKind::Voxel(label) => (truth::of_class(Class::from_id(label).unwrap_or(Class::Others)), 0),
            SurfaceKind::Thing(i, ..) => {
                let thing = &self.things[i as usize];
                (truth::of_class(thing.class), thing.instance())
            }
        }
    }

    /// The boxes that a camera shows, given what its pixels show.
    pub(super) fn seen_boxes(
        &self,
        boxes: &BTreeMap<BoxId, SceneBox>,
        camera: &Camera,
        rays: &CameraRays,
        (width, height, pixels): (usize, usize, &[TruthPixel]),
    ) -> Vec<SeenBox> {
        let visible = visible(width, pixels);
        let camera_from_ego = camera.ego_from_camera().inverse();
        let one = |thing: &DrawnObject| -> Option<SeenBox> {
            let of = *boxes.get(&thing.box_id?)?;
            let seen = visible.get(&thing.instance()).copied();
            // A thing finer than the spacing of the pixels may still be shown by one.
            let whole = Whole::of(thing, rays, (width, height, pixels)).or(seen.map(Whole::as_seen))?;
            let (visible_px, visible_bounds_px) = (seen.map_or(0, |s| s.0), seen.map(|s| s.1));
            let union =
                |a: [f64; 4], b: [f64; 4]| [a[0].min(b[0]), a[1].min(b[1]), a[2].max(b[2]), a[3].max(b[3])];
            let whole_bounds_px = visible_bounds_px.map_or(whole.bounds_px, |b| union(whole.bounds_px, b));
            let velocity = of.velocity_mps.extend(0.0);
            let corner = |i: usize| {
                let sign = |bit: usize| if i >> bit & 1 == 1 { 0.5 } else { -0.5 };
                let local = DVec3::new(sign(2), sign(1), sign(0)) * of.size_m;
                rays.seen_at(of.to_ego(local), velocity).map(|p| p.to_array())
            };
            let corners_px: [Option<[f64; 2]>; 8] = std::array::from_fn(corner);
            Some(SeenBox {
                center_in_camera_m: camera_from_ego.apply(of.center_m),
                in_picture: in_picture(&corners_px, width as f64, height as f64),
                corners_px,
                visible_px,
                whole_px: whole.pixels.max(visible_px),
                visibility: whole.visibility.clamp(0.0, 1.0),
                visible_bounds_px,
                whole_bounds_px,
                of,
            })
        };
        let mut seen: Vec<SeenBox> = self.things.par_iter().filter_map(one).collect();
        seen.sort_by_key(|b| b.of.id);
        seen
    }

    /// The truth about a picture, from a ray through the middle of each pixel: what [`Self::render_truth`] gives without the
    /// picture, where no pixel mixes surfaces. `boxes` are those of the frame.
    pub fn truth(
        &self,
        camera: &Camera,
        size: [u32; 2],
        boxes: &BTreeMap<BoxId, SceneBox>,
        next: Option<&NextMoment<'_>>,
    ) -> CameraTruth {
        let teller = Teller::new(self, camera, size, next);
        let (w, h) = (size[0] as usize, size[1] as usize);
        let mut pixels = vec![TruthPixel::default(); w * h];
        let pixel_rad = teller.rays.optics().pixel_rad() as f32;
        if !pixels.is_empty() {
            pixels.par_chunks_mut(w).enumerate().for_each(|(y, row)| {
                for (x, out) in row.iter_mut().enumerate() {
                    let (u, v) = (x as f64 + 0.5, y as f64 + 0.5);
                    let ray = teller.rays.at(u, v);
                    if let Some((o, d)) = usable(&ray) {
                        let seen = self.seen_along((o, d), ray.after_s as f32, pixel_rad);
                        *out = teller.pixel(&seen, &ray, (u, v));
                    }
                }
            });
        }
        self.finish_truth(&teller, camera, size, boxes, pixels, next)
    }

    pub(super) fn finish_truth(
        &self,
        teller: &Teller<'_>,
        camera: &Camera,
        size: [u32; 2],
        boxes: &BTreeMap<BoxId, SceneBox>,
        pixels: Vec<TruthPixel>,
        next: Option<&NextMoment<'_>>,
    ) -> CameraTruth {
        let camera = camera.resized(size[0].max(1), size[1].max(1));
        let (width, height) = (size[0] as usize, size[1] as usize);
        let seen = self.seen_boxes(boxes, &camera, &teller.rays, (width, height, &pixels));
        CameraTruth {
            camera,
            width,
            height,
            pixels,
            flow_s: next.map(|n| n.after_s),
            boxes: seen,
        }
    }
}

/// Origin and unit direction of a ray that can be traced.
pub(super) fn usable(ray: &CameraRay) -> Option<(Vec3, Vec3)> {
    let (o, d) = (ray.origin.as_vec3(), ray.direction.as_vec3().normalize_or_zero());
    (d != Vec3::ZERO && d.is_finite() && o.is_finite()).then_some((o, d))
}

/// For each instance how many pixels show it, and their bounds.
fn visible(width: usize, pixels: &[TruthPixel]) -> BTreeMap<u32, (u32, [f64; 4])> {
    let mut out: BTreeMap<u32, (u32, [f64; 4])> = BTreeMap::new();
    for (i, pixel) in pixels.iter().enumerate().filter(|(_, p)| p.instance != 0) {
        let (x, y) = ((i % width) as f64, (i / width) as f64);
        let (count, b) = out.entry(pixel.instance).or_insert((0, [x, y, x + 1.0, y + 1.0]));
        *count += 1;
        *b = [b[0].min(x), b[1].min(y), b[2].max(x + 1.0), b[3].max(y + 1.0)];
    }
    out
}

/// Projection of a thing as if nothing stood in front of it.
struct Whole {
    pixels: u32,
    visibility: f64,
    bounds_px: [f64; 4],
}

impl Whole {
    /// Takes the visible pixels of a thing, with their bounds, as the whole of it.
    fn as_seen((pixels, bounds_px): (u32, [f64; 4])) -> Self {
        Self {
            pixels,
            visibility: 1.0,
            bounds_px,
        }
    }

    /// `None` if the thing is outside the picture, or lies between the middles of all pixels. For large things only
    /// every second, third, … pixel is tested.
    fn of(
        thing: &DrawnObject,
        rays: &CameraRays,
        (width, height, pixels): (usize, usize, &[TruthPixel]),
    ) -> Option<Self> {
        let half = thing.size / 2.0;
        let middle = thing.foot + Vec3::Z * half.z;
        let speed = f64::from(thing.velocity.length());
        let [low, high] = rays.bounds(middle.as_dvec3(), f64::from(half.length()) + 0.1, speed)?;
        let size = DVec2::new(width as f64, height as f64);
        let (low, high) = (
            low.clamp(DVec2::ZERO, size).floor(),
            high.clamp(DVec2::ZERO, size).ceil(),
        );
        let area = (high - low).element_product();
        if area.is_nan() || area <= 0.0 {
            return None;
        }
        let step = (area / LOOKS).sqrt().ceil().max(1.0) as usize;
        let (mut count, mut shown, mut bounds) = (0u32, 0u32, [f64::INFINITY, f64::INFINITY, 0.0, 0.0]);
        for y in (low.y as usize..high.y as usize).step_by(step) {
            for x in (low.x as usize..high.x as usize).step_by(step) {
                let ray = rays.at(x as f64 + 0.5, y as f64 + 0.5);
                let Some((o, d)) = usable(&ray) else { continue };
                if thing
                    .cast(thing.seen_from(o, ray.after_s as f32), d, f32::INFINITY)
                    .is_none()
                {
                    continue;
                }
                count += 1;
                shown += u32::from(pixels[y * width + x].instance == thing.instance());
                let (x, y) = (x as f64, y as f64);
                bounds = [
                    bounds[0].min(x),
                    bounds[1].min(y),
                    bounds[2].max(x + 1.0),
                    bounds[3].max(y + 1.0),
                ];
            }
        }
        (count > 0).then(|| Self {
            pixels: count.saturating_mul((step * step) as u32),
            visibility: f64::from(shown) / f64::from(count),
            bounds_px: bounds,
        })
    }
}

/// Share of the bounds of a box's corners that lies in the picture; 1 where it cannot be determined.
fn in_picture(corners: &[Option<[f64; 2]>; 8], width: f64, height: f64) -> f64 {
    let (mut low, mut high) = (DVec2::INFINITY, DVec2::NEG_INFINITY);
    for corner in corners {
        let Some(p) = corner else { return 1.0 };
        (low, high) = (low.min(DVec2::from_array(*p)), high.max(DVec2::from_array(*p)));
    }
    let size = DVec2::new(width, height);
    let inside = high.clamp(DVec2::ZERO, size) - low.clamp(DVec2::ZERO, size);
    let all = (high - low).max(DVec2::splat(1e-9));
    (inside.element_product() / all.element_product()).clamp(0.0, 1.0)
}
