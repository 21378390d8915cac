//! Normal maps: the directions in which the surfaces of the pictures face, in the camera's frame.
//!
//! Red is right, green is up, blue is towards the camera, each `n * 0.5 + 0.5`: a surface that faces the camera is
//! light blue, the road green. The sky is grey (128, 128, 128), which is no direction at all.

use glam::{DQuat, Vec3};
use rayon::prelude::*;

use super::{
    CameraError, CameraInput, CameraPicture, CameraSource, CameraSourceDescription, Card, Needs,
    PreparedCameras, RenderOptions, SourceId, SourceView, ViewId,
};
use crate::pictures::appearance::{Appearance, CameraImage};
use crate::pictures::march::GroundHeight;
use crate::raycast::rays::CameraRays;
use scene::Camera;
use scene::Conditions;

/// The view of normals.
pub const VIEW: SourceView = SourceView::new(
    ViewId::new("normals"),
    "Normals",
    "which way surfaces face: right red, up green, towards the camera blue",
);

/// Colour of the sky.
pub const SKY: [u8; 3] = [128; 3];

/// Name of the source.
const ID: SourceId = SourceId::new("normals");

/// The source.
pub struct Normals;

impl CameraSource for Normals {
    fn about(&self) -> &'static CameraSourceDescription {
        &CameraSourceDescription {
            id: ID,
            title: "Normals",
            hint: "the surfaces of the pictures, without light",
            views: &[VIEW],
            needs: Needs {
                occupancy: true,
                layout: true,
                boxes: true,
                background: true,
                ..Needs::NONE
            },
            ground: GroundHeight::Physical,
            report_key: "normals",
            previews: false,
            bytes_per_pixel: 24,
        }
    }

    fn prepare<'a>(&self, input: &CameraInput<'a>) -> Box<dyn PreparedCameras + 'a> {
        // Surfaces are the same by day and night; the seed shapes leaves and cars.
        let conditions = Conditions {
            seed: input.conditions.seed,
            ..Conditions::default()
        };
        let input = CameraInput { conditions, ..*input };
        Box::new(PreparedNormals(input.appearance()))
    }
}

/// The colour of a normal of the ego frame in the pictures of a camera.
fn color(ego_from_camera: DQuat, normal: Vec3) -> [u8; 3] {
    // Optical axes are right, down, forward.
    let n = ego_from_camera.conjugate() * normal.as_dvec3();
    [n.x, -n.y, -n.z].map(|v| ((v * 0.5 + 0.5).clamp(0.0, 1.0) * 255.0).round() as u8)
}

struct PreparedNormals(Appearance);

impl PreparedCameras for PreparedNormals {
    fn draw(
        &self,
        camera: &Camera,
        options: &RenderOptions,
        _card: Option<&mut dyn Card>,
    ) -> Result<CameraPicture, CameraError> {
        let [width, height] = options.size;
        let rays = CameraRays::new(camera, width, height);
        let rotation = camera.ego_from_camera().rotation;
        let row = width as usize * 4;
        let mut rgba = vec![255; row * height as usize];
        if !rgba.is_empty() {
            rgba.par_chunks_mut(row).enumerate().for_each(|(y, row)| {
                for (x, out) in row.chunks_exact_mut(4).enumerate() {
                    let ray = rays.at(x as f64 + 0.5, y as f64 + 0.5);
                    let normal = self.0.surface_normal(&ray);
                    out[..3].copy_from_slice(&normal.map_or(SKY, |n| color(rotation, n)));
                }
            });
        }
        Ok(CameraPicture::Picture(CameraImage {
            camera: camera.name.clone(),
            width: width as usize,
            height: height as usize,
            rgba,
        }))
    }
}
