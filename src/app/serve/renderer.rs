//! State that all requests share: the scenes, the moments prepared last, and the LiDAR network.

use std::path::PathBuf;
use std::sync::Arc;

use anyhow::Context;

use crate::recent::Recent;
use crate::scenes::Scenes;
use nets::lidar::LidarNet;
use scene::{Frame, Scene, SceneRev, SensorRig};
use sensors::pictures::appearance::{Appearance, AppearanceCache, Quality};

/// How sweeps come about.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ServerLidarModel {
    /// By the network: ranges within voxels, intensities, lost echoes.
    #[default]
    Learned,
    /// Every ray to the first voxel; intensities are 0.
    Exact,
}

/// Scenes, and caches of them.
pub struct Renderer {
    /// The scenes.
    pub scenes: Scenes,
    /// The network of sweeps; none where they are exact.
    pub net: Option<Arc<LidarNet>>,
    /// Effort for pictures.
    pub quality: Quality,
    prepared: Recent<Prepared, Arc<Appearance>>,
    /// Parts of the moment prepared last that the next one shares.
    cache: AppearanceCache,
}

/// Key of an appearance: all inputs that it depends on, with numbers by their bits.
#[derive(PartialEq)]
struct Prepared {
    content: SceneRev,
    numbers: Vec<u64>,
}

impl Renderer {
    /// Lists scenes of files and folders; keeps at most so many scenes, and so many prepared moments. Errors in one
    /// line.
    pub fn new(
        paths: &[PathBuf],
        scenes: usize,
        moments: usize,
        (lidar, quality): (ServerLidarModel, Quality),
    ) -> anyhow::Result<Self> {
        let net = match lidar {
            ServerLidarModel::Learned => Some(LidarNet::bundled().context("the LiDAR network")?),
            ServerLidarModel::Exact => None,
        };
        Ok(Self {
            scenes: Scenes::list(paths, scenes)?,
            net,
            quality,
            prepared: Recent::new(moments),
            cache: AppearanceCache::default(),
        })
    }

    /// A frame ready to be looked at, kept for the next camera of the same moment. `moment` is all that decides the frame besides
    /// the scene; the vehicle is that of `rig`.
    pub fn appearance<E>(
        &self,
        scene: &Scene,
        moment: Vec<f64>,
        rig: &SensorRig,
        frame: impl FnOnce() -> Result<Arc<Frame>, E>,
    ) -> Result<Arc<Appearance>, E> {
        let mut numbers = moment;
        numbers.extend(rig.vehicle.rotation.to_array());
        numbers.extend(rig.vehicle.translation_m.to_array());
        // (the longest read-out decides where things that move are looked for)
        let rolls = rig.cameras.iter().filter_map(|c| c.shutter);
        numbers.push(rolls.map(|s| s.readout_s).fold(0.0, f64::max));
        let key = Prepared {
            content: scene.content(),
            numbers: numbers.into_iter().map(f64::to_bits).collect(),
        };
        if let Some(ready) = self.prepared.get(&key) {
            return Ok(ready);
        }
        let ready = Arc::new(Appearance::with_cache(
            &*frame()?,
            &scene.background,
            rig,
            &scene.conditions,
            &self.cache,
        ));
        self.prepared.put(key, ready.clone());
        Ok(ready)
    }
}
