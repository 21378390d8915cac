//! The thread that keeps LiDAR sweep and camera maps up to date with the scene shown. Newest scene
//! wins; what is on screen stays until something newer is there.

use std::sync::Arc;
use std::thread::JoinHandle;

use crossbeam_channel::{Receiver, Sender, unbounded};

use crate::generation::sensors::caster::Caster;
use crate::generation::sensors::lidar::EgoBox;
use crate::generation::sensors::splat::{self, GaussianCloud, PREVIEW_SIZE, SplatOptions, VIEW_SIZE};
use crate::scene::{CameraMaps, LidarSweep, Scene, SceneRev, SensorRig};

/// Voxels below the surface that still count for a picture; see [`GaussianCloud::from_grid_shell`].
const SHELL_LAYERS: usize = 2;

/// A scene to sense.
struct Request {
    scene: Arc<Scene>,
    preview: bool,
}

/// News from the thread.
enum News {
    Lidar(SceneRev, LidarSweep),
    Cameras(SceneRev, Vec<CameraMaps>),
}

/// The newest of what was sensed, and the thread that senses.
pub struct Sensing {
    requests: Option<Sender<Request>>, // None only while dropping
    news: Receiver<News>,
    thread: Option<JoinHandle<()>>,
    asked: Option<(SceneRev, bool)>,
    lidar: Option<(SceneRev, Arc<LidarSweep>)>,
    cameras: Option<(SceneRev, Arc<Vec<CameraMaps>>)>,
    version: u64,
}

impl Sensing {
    /// Starts the thread `sensing`. `wake` is called after each piece of news. Errors if the system
    /// gives no thread.
    pub fn spawn(wake: impl Fn() + Send + 'static) -> std::io::Result<Self> {
        let (requests, requests_in) = unbounded();
        let (news_out, news) = unbounded();
        let thread = std::thread::Builder::new()
            .name("sensing".into())
            .spawn(move || sense_all(&requests_in, &news_out, &wake))?;
        Ok(Self {
            requests: Some(requests),
            news,
            thread: Some(thread),
            asked: None,
            lidar: None,
            cameras: None,
            version: 0,
        })
    }

    /// Asks for a scene, unless it was asked for already. A preview has smaller pictures.
    pub fn ask(&mut self, scene: &Arc<Scene>, preview: bool) {
        if self
            .asked
            .is_some_and(|(rev, was_preview)| rev == scene.rev && (!was_preview || preview))
        {
            return;
        }
        self.asked = Some((scene.rev, preview));
        if let Some(requests) = &self.requests {
            let scene = scene.clone();
            // The thread ends only when this sender is gone.
            let _ = requests.send(Request { scene, preview });
        }
    }

    /// Takes in what has arrived.
    pub fn drain(&mut self) {
        for news in self.news.try_iter() {
            self.version += 1;
            match news {
                News::Lidar(rev, sweep) => self.lidar = Some((rev, Arc::new(sweep))),
                News::Cameras(rev, maps) => self.cameras = Some((rev, Arc::new(maps))),
            }
        }
    }

    /// The newest sweep.
    pub fn lidar(&self) -> Option<&Arc<LidarSweep>> {
        self.lidar.as_ref().map(|(_, sweep)| sweep)
    }

    /// The newest maps of all cameras, in the rig's order.
    pub fn cameras(&self) -> Option<&Arc<Vec<CameraMaps>>> {
        self.cameras.as_ref().map(|(_, maps)| maps)
    }

    /// True if the pictures are not those of this state.
    pub fn cameras_stale(&self, rev: SceneRev) -> bool {
        self.cameras.as_ref().is_none_or(|(of, _)| *of != rev)
    }

    /// True if the sweep is not that of this state.
    pub fn lidar_stale(&self, rev: SceneRev) -> bool {
        self.lidar.as_ref().is_none_or(|(of, _)| *of != rev)
    }

    /// Counts the news: what was made from it is up to date as long as this is the same.
    pub fn version(&self) -> u64 {
        self.version
    }
}

impl Drop for Sensing {
    fn drop(&mut self) {
        self.requests = None;
        if let Some(thread) = self.thread.take() {
            // An error would be a panic in the thread; there is nobody left to tell.
            let _ = thread.join();
        }
    }
}

fn sense_all(requests: &Receiver<Request>, news: &Sender<News>, wake: &dyn Fn()) {
    let mut lidar = None;
    while let Ok(first) = requests.recv() {
        let newest = requests.try_iter().last().unwrap_or(first);
        sense(&newest, requests, &mut lidar, |piece| {
            // The receiver lives as long as the thread, except at the very end.
            let _ = news.send(piece);
            wake();
        });
    }
}

/// The sweep that is kept between requests, and the rig that it belongs to.
type KeptLidar = Option<(Arc<SensorRig>, Caster)>;

fn sense(request: &Request, requests: &Receiver<Request>, lidar: &mut KeptLidar, tell: impl Fn(News)) {
    let Request { scene, preview } = request;
    let (frame, rig) = (scene.frame(), &scene.rig);
    match lidar {
        Some((of, caster)) if of == rig => caster.update(&frame.occupancy),
        _ => {
            let caster = |pattern| {
                let ego = Some(EgoBox::of_rig(rig));
                Caster::new(&frame.occupancy, pattern, rig.ego_speed_mps, ego)
            };
            *lidar = rig.lidars.first().map(|pattern| (rig.clone(), caster(pattern)));
        }
    }
    let sweep = lidar.as_ref().map(|(_, caster)| caster.sweep());
    tell(News::Lidar(scene.rev, sweep.unwrap_or_default()));
    let [width, height] = if *preview { PREVIEW_SIZE } else { VIEW_SIZE };
    let cloud = GaussianCloud::from_grid_shell(&frame.occupancy, frame.layout.cells(), SHELL_LAYERS);
    let options = SplatOptions::default();
    let mut maps = Vec::with_capacity(rig.cameras.len());
    for camera in &rig.cameras {
        // Full pictures give way to a newer scene; previews are quick, and giving way would leave
        // the strip without any news for as long as the user drags.
        if !preview && !requests.is_empty() {
            return;
        }
        maps.push(splat::render(&cloud, camera, width, height, &options));
    }
    tell(News::Cameras(scene.rev, maps));
}

#[cfg(test)]
mod tests {
    use std::time::{Duration, Instant};

    use super::*;
    use crate::generation::world::World;
    use crate::scene::{Frame, draft};

    #[test]
    fn the_newest_scene_is_sensed_in_the_end() {
        let world = World::random(3);
        let occupancy = draft::draft(&world.layout, world.boxes.values());
        let frame = Frame::new(world.layout.clone(), world.boxes.clone(), occupancy);
        let mut scene = Scene::single("test", frame, Arc::default(), 3);
        let mut sensing = Sensing::spawn(|| {}).expect("a thread");
        for _ in 0..20 {
            scene.rev = SceneRev::fresh();
            sensing.ask(&Arc::new(scene.clone()), true);
        }
        let start = Instant::now();
        while sensing.cameras_stale(scene.rev) || sensing.lidar_stale(scene.rev) {
            assert!(start.elapsed() < Duration::from_secs(120), "no news");
            std::thread::sleep(Duration::from_millis(5));
            sensing.drain();
        }
        assert_eq!(sensing.cameras().map(|c| c.len()), Some(6));
        assert!(sensing.lidar().is_some_and(|l| l.points.len() > 1000));
        // Asked for already: nothing new comes.
        let version = sensing.version();
        sensing.ask(&Arc::new(scene.clone()), true);
        std::thread::sleep(Duration::from_millis(50));
        sensing.drain();
        assert_eq!(sensing.version(), version);
    }
}
