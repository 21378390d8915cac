//! A camera picture as a request asks for it.

use std::sync::Arc;

use glam::DVec3;
use tonic::Status;

use crate::encode::{self, Packing};
use crate::lens;
use crate::limits::MOST_PIXELS;
use crate::moment::{self, PlacedObject, TimeSpan};
use crate::poses::{self, Pair};
use crate::renderer::Renderer;
use crate::wire::{CameraSpec, RgbRenderRequest, RgbRenderReturn};
use scene::rig::Carried;
use scene::{Camera, Pose, Scene, SensorRig, Shutter};

/// The size that a request asks for, width and height: its own, or that of its lens where it tells none. Errors if there is none,
/// or the picture would be too large.
pub fn size_of(request: &RgbRenderRequest) -> Result<[u32; 2], Status> {
    let own = [request.resolution_w, request.resolution_h];
    let spec = request.camera_intrinsics.as_ref();
    let [w, h] = match own {
        [0, 0] => spec.map_or(own, |s| [s.resolution_w, s.resolution_h]),
        own => own,
    };
    if w == 0 || h == 0 {
        return Err(Status::invalid_argument(format!(
            "a picture of {w}x{h} pixels, expected at least 1x1"
        )));
    }
    let pixels = u64::from(w) * u64::from(h);
    if pixels > MOST_PIXELS {
        return Err(Status::invalid_argument(format!(
            "a picture of {w}x{h} has {pixels} pixels, expected at most {MOST_PIXELS}"
        )));
    }
    Ok([w, h])
}

/// Renders a picture. Errors in one line.
pub fn render(renderer: &Renderer, request: &RgbRenderRequest) -> Result<RgbRenderReturn, Status> {
    let packing = Packing::from_format(request.image_format, request.image_quality)?;
    let size = size_of(request)?;
    if request.insert_ego_mask {
        return Err(Status::invalid_argument(
            "insert_ego_mask is true, expected false: there are no ego masks",
        ));
    }
    let scene = renderer.scenes.get(&request.scene_id)?;
    let Some(spec) = &request.camera_intrinsics else {
        return Err(Status::invalid_argument("camera_intrinsics is missing"));
    };
    let asked = ParsedRequest {
        span: TimeSpan::read(request.frame_start_us, request.frame_end_us, &scene)?,
        sensor: Pair::read(request.sensor_pose.as_ref(), "sensor_pose")?,
        ego: match &request.ego_pose {
            Some(pair) => Some(Pair::read(Some(pair), "ego_pose")?),
            None => None,
        },
        placed: moment::placed(&scene, &request.dynamic_objects)?,
    };
    let view = asked.view(&scene, spec, size)?;
    let frame = || moment::frame(&scene, &asked.span, view.share, &asked.placed);
    let ready = renderer.appearance(&scene, asked.moment(&view), &view.rig, frame)?;
    let image = ready.render(&view.camera, size[0], size[1], renderer.quality);
    let image_bytes = encode::pack(size, image.rgba, packing)?;
    Ok(RgbRenderReturn { image_bytes })
}

/// A parsed request.
struct ParsedRequest {
    span: TimeSpan,
    sensor: Pair,
    ego: Option<Pair>,
    placed: Vec<PlacedObject>,
}

/// Camera and moment of one picture.
struct RequestedView {
    /// Camera in the world frame.
    camera: Camera,
    /// Rig by which the frame is prepared.
    rig: Arc<SensorRig>,
    /// Share of the frame at which the picture is taken: in the middle with a rolling shutter, else at the start.
    share: f64,
    /// The moment of the scene, s.
    time_s: f64,
}

impl ParsedRequest {
    /// All numbers that decide the frame besides the scene.
    fn moment(&self, view: &RequestedView) -> Vec<f64> {
        let mut numbers = vec![view.time_s];
        if !self.placed.is_empty() {
            numbers.extend([view.share, self.span.length_s]);
        }
        for one in &self.placed {
            numbers.push(f64::from(one.id.0));
            for pose in [&one.at.start, &one.at.end] {
                numbers.extend(pose.rotation.to_array());
                numbers.extend(pose.translation_m.to_array());
            }
        }
        numbers
    }

    fn view(&self, scene: &Scene, spec: &CameraSpec, size: [u32; 2]) -> Result<RequestedView, Status> {
        let direction = lens::direction_of(spec.shutter_type)?;
        let shutter = direction
            .filter(|_| self.span.length_s > 0.0)
            .map(|direction| Shutter {
                readout_s: self.span.length_s,
                direction,
            });
        let share = if shutter.is_some() { 0.5 } else { 0.0 };
        let place = scene.rig.cameras.iter().position(|c| c.name == spec.logical_id);
        let shown = scene.at(self.span.at(share));
        let shown = shown.for_sensors();
        let own_vehicle = shown.frame().world_from_ego;
        let given = self.ego.map(|pair| pair.at(share));
        let vehicle = match given {
            Some(given) if !poses::is_near(&given, &own_vehicle) => Some(given),
            _ => None,
        };
        if let Some(i) = place
            && vehicle.is_none()
            && self.is_own(scene, &scene.rig.cameras[i], spec, shutter)
        {
            // The very camera of the rig: the numbers of the scene are finer than those of the protocol.
            return Ok(RequestedView {
                camera: shown.rig.cameras[i].clone(),
                rig: shown.rig.clone(),
                share,
                time_s: shown.time_s(),
            });
        }
        let mut camera = lens::camera_of(spec, size)?;
        // (the name that a client gives is not used)
        camera.name = "CAM".into();
        let pose = self.sensor.at(share);
        let q = pose.rotation;
        camera.rotation_wxyz = [q.w, q.x, q.y, q.z];
        camera.translation_m = pose.translation_m.to_array();
        camera.shutter = shutter;
        if shutter.is_some() {
            camera.carried = self.carried(&pose);
        }
        let mount = place.map(|i| scene.rig.cameras[i].ego_from_camera());
        let under_camera = mount
            .map(|mount| pose * mount.inverse())
            .filter(|_| given.is_none());
        let rig = SensorRig {
            vehicle: vehicle.or(under_camera).unwrap_or(own_vehicle),
            cameras: vec![camera.clone()],
            ..(*scene.rig).clone()
        };
        match rig.problem() {
            Some(problem) => Err(Status::invalid_argument(format!("camera_intrinsics: {problem}"))),
            None => Ok(RequestedView {
                camera,
                rig: Arc::new(rig),
                share,
                time_s: shown.time_s(),
            }),
        }
    }

    /// True if the request is for a camera of the rig, where the scene has it.
    fn is_own(&self, scene: &Scene, own: &Camera, spec: &CameraSpec, shutter: Option<Shutter>) -> bool {
        let same_shutter = match (own.shutter, shutter) {
            (None, None) => true,
            (Some(a), Some(b)) => a.direction == b.direction && (a.readout_s - b.readout_s).abs() < 2e-6,
            _ => false,
        };
        let (clip, canvas) = (scene.clip(), scene.canvas());
        let ego_at = |share: f64| {
            let time_s = self.span.at(share).min(clip.length_s);
            clip.ego_at(time_s, &canvas.world_from_ego, &canvas.layout.relief)
        };
        let expected = Pair {
            start: ego_at(0.0),
            end: ego_at(1.0),
        };
        let expected = expected.then(&own.ego_from_camera());
        let there = match shutter {
            Some(_) => self.sensor.is_near(&expected),
            None => poses::is_near(&self.sensor.start, &expected.start),
        };
        same_shutter && there && lens::spec_of(own) == *spec
    }

    /// How the camera moves while its shutter reads: along a line, and round the vertical.
    fn carried(&self, pose: &Pose) -> Carried {
        let turned = self.sensor.end.rotation * self.sensor.start.rotation.conjugate();
        let turned = if turned.w < 0.0 { -turned } else { turned };
        let way_m: DVec3 = self.sensor.end.translation_m - self.sensor.start.translation_m;
        Carried {
            velocity_mps: way_m / self.span.length_s,
            yaw_rate_rps: turned.to_scaled_axis().z / self.span.length_s,
            origin_m: pose.translation_m,
        }
    }
}
