//! Plan of one rendering, checked before anything is written.

use std::sync::Arc;

use anyhow::{Context, bail};

use super::Rendering;
use super::write::sheet_bytes;
use app::camera_views;
use app::look::Look;
use app::picture::View3d;
use nets::lidar::LidarNet;
use scene::{LidarSweep, Scene};
use sensors::cameras::{self, CameraSource, SourceView, bounds};
use sensors::lidar::learned::Drops;
use sensors::lidar::{recorded, rolling};

/// Pictures of one source.
pub struct Cameras {
    /// Source of the pictures.
    pub source: &'static dyn CameraSource,
    /// Views that are written of each camera.
    pub views: Vec<SourceView>,
}

/// How the LiDAR sweep is made.
pub enum LoadedLidarModel {
    /// The sweep that the scene was imported from, with its edits.
    Recorded,
    /// Every ray to the first voxel.
    Exact,
    /// By the network.
    Learned(Arc<LidarNet>),
}

/// Plan of a rendering: all outputs, ready to be made.
pub struct RenderPlan {
    /// Camera pictures, in the order of the table.
    pub cameras: Vec<Cameras>,
    /// The sweep.
    pub lidar: Option<LoadedLidarModel>,
    /// The scans of all radars.
    pub radar: bool,
    /// Pictures with the truth about them.
    pub truth: bool,
    /// Pictures from above.
    pub bev: bool,
    /// The 3D view, on its device.
    pub view: Option<View3d>,
}

impl RenderPlan {
    /// Plans what the arguments ask for. Errors in one line if the rig lacks a sensor for it, pictures are too large,
    /// the network or a graphics adapter is missing.
    pub fn new(wanted: &Rendering, scene: &Scene) -> anyhow::Result<Self> {
        let wants = |kind: &str| wanted.what.iter().any(|w| w == kind);
        let mut cameras: Vec<Cameras> = Vec::new();
        for view in cameras::views().into_iter().filter(|v| wants(v.id.name())) {
            let source = cameras::source_of(view.id, wanted.source);
            match cameras.iter_mut().find(|c| c.source.id() == source.id()) {
                Some(of) => of.views.push(view),
                None => cameras.push(Cameras {
                    source,
                    views: vec![view],
                }),
            }
        }
        let count = scene.rig.cameras.len();
        let truth = wants("truth");
        if (truth || !cameras.is_empty()) && count == 0 {
            bail!("the rig {:?} has no camera", scene.rig.name);
        }
        for of in &cameras {
            let sheet = sheet_bytes(wanted.size, count);
            bounds::check(wanted.size, of.source.about().bytes_per_pixel, sheet).context("--size")?;
        }
        if truth {
            bounds::check(wanted.size, app::truth::BYTES_PER_PIXEL, 0).context("--size")?;
        }
        let lidar = wants("lidar")
            .then(|| LoadedLidarModel::from_request(wanted, scene))
            .transpose()?;
        if wants("radar") && scene.rig.radars.is_empty() {
            bail!("the rig {:?} has no radar", scene.rig.name);
        }
        Ok(Self {
            cameras,
            lidar,
            radar: wants("radar"),
            truth,
            bev: wants("bev"),
            view: wants("view").then(|| View3d::new(Look::Voxels)).transpose()?,
        })
    }
}

impl LoadedLidarModel {
    fn from_request(wanted: &Rendering, scene: &Scene) -> anyhow::Result<Self> {
        if scene.rig.lidars.is_empty() {
            bail!("the rig {:?} has no lidar", scene.rig.name);
        }
        match wanted.lidar.of_scene(scene) {
            camera_views::LidarModel::Recorded => Ok(Self::Recorded),
            camera_views::LidarModel::Exact => Ok(Self::Exact),
            camera_views::LidarModel::Learned => {
                Ok(Self::Learned(LidarNet::bundled().context("the LiDAR network")?))
            }
        }
    }

    /// The sweep of a scene.
    pub fn sweep(&self, scene: &Scene) -> anyhow::Result<LidarSweep> {
        match self {
            Self::Recorded => {
                recorded::sweep_of(scene).context("the vehicle was not there when the sweep was recorded")
            }
            Self::Exact => Ok(rolling::exact(scene)),
            Self::Learned(net) => rolling::learned(net, scene, Drops::Likely).context("the LiDAR network"),
        }
    }
}
