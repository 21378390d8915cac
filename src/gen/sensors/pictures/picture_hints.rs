//! Hints of voxels and boxes for each pixel of a camera: the condition of the network that draws pictures.

use glam::DVec3;

use crate::pictures::march::{GroundHeight, MarchOptions, MarchScene};
use scene::{Camera, Frame, SceneBox};

/// Number of directions in which a box may face, as seen along a ray.
const FACINGS: f64 = 16.0;
/// Largest distance of a box's voxel from the box, m.
const MARGIN_M: f64 = 0.35;
/// Flag of a pixel whose left or upper neighbour shows another box.
pub const EDGE: u8 = 0x80;

/// Hints for a picture from the voxels and the boxes around them; planes are row-major, `height * width` values each.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PictureHints {
    /// Render id of the surface on the ray through a pixel's middle; 0 where there is none.
    pub class: Vec<u8>,
    /// Its depth along the optical axis, m; 0 where there is none.
    pub depth_m: Vec<f32>,
    /// Heading at a box's voxels: 1 + the box's heading against the ray in sixteenths of a turn, and [`EDGE`]. 0
    /// elsewhere.
    pub facing: Vec<u8>,
}

/// A frame made ready to give hints for a rig's cameras.
pub struct HintedFrame<'a> {
    scene: MarchScene,
    boxes: Vec<&'a SceneBox>,
}

impl<'a> HintedFrame<'a> {
    /// Makes a frame ready: voxels with the ground at its physical height, paint on the road, boxes for their headings.
    pub fn new(frame: &'a Frame) -> Self {
        let options = MarchOptions {
            ground: GroundHeight::Physical,
            boxes: false,
            lines: true,
            seed: 0,
        };
        Self {
            scene: MarchScene::new(&frame.occupancy, &frame.layout, &frame.boxes, &options),
            boxes: frame.boxes.values().collect(),
        }
    }

    /// Hints for each pixel of a camera at a size in px.
    pub fn of(&self, camera: &Camera, [width, height]: [u32; 2]) -> PictureHints {
        let (w, maps) = (width as usize, self.scene.render(camera, width, height));
        let sized = camera.resized(width, height);
        let (pose, [fx, fy], [cx, cy]) = (sized.ego_from_camera(), sized.focal_px, sized.center_px);
        let mut told = PictureHints::default();
        let mut owners: Vec<Option<usize>> = Vec::with_capacity(maps.hits.len());
        for (i, hit) in maps.hits.iter().enumerate() {
            told.class.push(hit.as_ref().map_or(0, |h| h.id));
            told.depth_m.push(hit.as_ref().map_or(0.0, |h| h.t as f32));
            let (u, v) = ((i % w) as f64 + 0.5, (i / w) as f64 + 0.5);
            let way = pose.rotation * DVec3::new((u - cx) / fx, (v - cy) / fy, 1.0);
            let owner = hit.as_ref().filter(|h| (1..11).contains(&h.id)).and_then(|h| {
                let p = pose.translation_m + way * h.t;
                self.boxes
                    .iter()
                    .position(|b| b.class.id() == h.id && is_in(b, p))
            });
            let other = |back: usize, inside: bool| inside && owners[i - back] != owner;
            let facing = owner.map_or(0, |o| {
                let turn = (self.boxes[o].yaw_rad - way.y.atan2(way.x)) / std::f64::consts::TAU;
                let edge = other(1, i % w > 0) || other(w, i >= w);
                let sector = (turn * FACINGS).round().rem_euclid(FACINGS) as u8;
                1 + sector + if edge { EDGE } else { 0 }
            });
            told.facing.push(facing);
            owners.push(owner);
        }
        told
    }
}

/// True for a point in a box or close to it.
fn is_in(b: &SceneBox, p: DVec3) -> bool {
    let (ahead, off) = (b.heading(), p - b.center_m);
    let local = DVec3::new(off.truncate().dot(ahead), off.truncate().dot(ahead.perp()), off.z);
    local.abs().cmple(b.size_m / 2.0 + MARGIN_M).all()
}
