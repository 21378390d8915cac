//! Viewpoint of the 3D view: by a name, or anywhere.

use anyhow::{Context, bail};
use glam::DVec3;

use app::export::view_camera;
use app::look::Look;
use scene::{Pose, Scene};
use viewport::ViewCamera;

/// Arguments of commands that draw the 3D view.
#[derive(clap::Args)]
pub(super) struct Viewpoint {
    /// Viewpoint of the 3D view: perspective, top, front, back, side, left, ego, or a camera of the rig (CAM_FRONT).
    #[arg(long, value_name = "NAME", default_value = "perspective")]
    view: String,
    /// Seen from here instead, ego frame (x ahead, y left, z up), m: needs --look.
    #[arg(long, value_name = "X,Y,Z", value_parser = point, requires = "look", conflicts_with = "view", allow_hyphen_values = true)]
    eye: Option<[f64; 3]>,
    /// The place in the middle of the picture, ego frame, m.
    #[arg(long, value_name = "X,Y,Z", value_parser = point, requires = "eye", allow_hyphen_values = true)]
    look: Option<[f64; 3]>,
    /// Vertical field of view of --eye, degrees.
    #[arg(long, value_name = "DEG", requires = "eye", value_parser = degrees)]
    fov: Option<f64>,
    /// Orthographic: parallel lines stay parallel, and sizes do not depend on the distance.
    #[arg(long)]
    orthographic: bool,
    /// Without boxes.
    #[arg(long)]
    no_boxes: bool,
    /// What the 3D view shows the scene as: voxels, or pictures as a camera would take them there.
    #[arg(long = "as", value_name = "LOOK", value_parser = ["voxels", "pictures"], default_value = "voxels")]
    look_as: String,
}

impl Viewpoint {
    /// The camera for the moment that a scene shows. Errors if there is no viewpoint of that name, or if eye and look
    /// are less than 0.2 m apart.
    pub(super) fn camera(&self, scene: &Scene) -> anyhow::Result<ViewCamera> {
        let mut camera = match (self.eye, self.look) {
            (Some(eye), Some(look)) => {
                let [eye_m, look_m] = [eye, look].map(DVec3::from_array);
                if eye_m.distance(look_m) < 0.2 {
                    bail!("--eye and --look are less than 0.2 m apart");
                }
                let mut camera = ViewCamera::from_to(eye_m, look_m);
                camera.fov_y_rad = self.fov.map_or(camera.fov_y_rad, f64::to_radians);
                camera.go_along(&Pose::IDENTITY, &scene.frame().world_from_ego);
                camera
            }
            _ => view_camera(scene, &self.view)?,
        };
        camera.ortho |= self.orthographic;
        Ok(camera)
    }

    /// Errors if `--eye` or `--as pictures` is given and the output is no 3D view.
    pub(super) fn is_for(&self, view_3d: bool, what: &str) -> anyhow::Result<()> {
        match self.eye {
            Some(_) if !view_3d => bail!("--eye is of the 3D view alone, but --what is {what}"),
            _ if !view_3d && self.look() == Look::Pictures => {
                bail!("--as is of the 3D view alone, but --what is {what}")
            }
            _ => Ok(()),
        }
    }

    /// What the scene is shown as.
    pub(super) fn look(&self) -> Look {
        match self.look_as.as_str() {
            "pictures" => Look::Pictures,
            _ => Look::Voxels,
        }
    }

    /// True if boxes are drawn.
    pub(super) fn boxes(&self) -> bool {
        !self.no_boxes
    }

    /// Name of the viewpoint.
    pub(super) fn name(&self) -> &str {
        if self.eye.is_some() { "view" } else { &self.view }
    }
}

/// Reads a place such as `12,-3.5,2`.
fn point(text: &str) -> anyhow::Result<[f64; 3]> {
    const LIMIT_M: f64 = 5000.0;
    let expected = || format!("{text:?}, expected three numbers in metres such as 12,-3.5,2");
    let parts: Vec<&str> = text.split(',').collect();
    let [x, y, z] = parts[..] else {
        bail!(expected());
    };
    let number = |part: &str| part.trim().parse::<f64>().with_context(expected);
    let place = [number(x)?, number(y)?, number(z)?];
    match place.iter().all(|v| v.abs() <= LIMIT_M) {
        true => Ok(place),
        false => bail!("{text:?}, expected at most {LIMIT_M} m"),
    }
}

/// Reads an opening angle of a view.
fn degrees(text: &str) -> anyhow::Result<f64> {
    let value = text.parse::<f64>().ok().filter(|v| (3.0..=140.0).contains(v));
    value.with_context(|| format!("{text:?}, expected 3 to 140 degrees"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn places_are_read_and_what_is_none_is_said() {
        assert_eq!(point("12,-3.5, 2").expect("a place"), [12.0, -3.5, 2.0]);
        for bad in ["", "1,2", "1,2,3,4", "a,b,c", "nan,0,0", "inf,0,0", "1e9,0,0"] {
            let error = point(bad).expect_err(bad).to_string();
            assert!(error.contains("expected"), "{error}");
        }
        assert!(degrees("nan").is_err() && degrees("200").is_err() && degrees("60").is_ok());
    }
}
