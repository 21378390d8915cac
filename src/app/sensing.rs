//! The thread that keeps LiDAR sweep and camera maps up to date with the scene shown. The newest scene wins; results on
//! screen stay until newer ones come.

mod others;
mod painting;
mod playing;
mod reel;
mod senses;
#[cfg(test)]
mod tests;
mod views;

use std::borrow::Cow;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use super::camera_views::{CameraView, Wanted};
use super::painting::PaintWish;
use language::tf;
use runtime::guard::Panicked;
use runtime::worker::JobId;
use runtime::worker::{Wake, Worker};
use scene::{LidarSweep, Pose, RadarScan, Scene, SceneRev};
use sensors::cameras::{SourceId, learned};
use sensors::lidar::learned_caster::Sampled;

pub use painting::PaintStage;
use painting::Painting;
use reel::{Moment, moment};
use senses::Senses;

/// How much time there is for a scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Haste {
    /// The scene rests: full pictures, after coarse ones where they are slow.
    Rest,
    /// The scene is about to change: small pictures.
    Preview,
    /// A clip plays: small pictures, of as many cameras as there is time for, of moments that are multiples of so many
    /// milliseconds of the clip. Moments that come again are shown at once.
    Play {
        /// Time between two moments, ms.
        every_ms: u32,
    },
}

/// A request to sense a scene.
#[derive(Clone)]
struct SensingRequest {
    scene: Arc<Scene>,
    /// The moment to sense, s; the one that the scene shows if `None`.
    at_s: Option<f64>,
    wanted: Wanted,
    haste: Haste,
}

/// A scene with its rig where the ego vehicle is.
fn placed(scene: &Arc<Scene>) -> Arc<Scene> {
    match scene.with_rig_in_world() {
        Cow::Borrowed(_) => scene.clone(),
        Cow::Owned(placed) => Arc::new(placed),
    }
}

/// News from the thread.
enum SensingEvent {
    Lidar(SceneRev, Pose, Arc<LidarSweep>, Option<Sampled>),
    Radar(SceneRev, Vec<RadarScan>),
    Cameras(SceneRev, Wanted, Vec<CameraView>),
    /// Pictures of another source than the strip's.
    Other(SceneRev, SourceId, Vec<CameraView>),
    /// The scene is done, or a newer one waits.
    Ended,
    Failed(Panicked),
}

/// The newest results of the sensors, and the threads that make them.
pub struct Sensing {
    worker: Worker<SensingRequest, SensingEvent>,
    asked: Option<(SceneRev, Wanted, Haste)>,
    /// State, content and moment that were requested last while a clip played.
    played: Option<(SceneRev, Wanted, Moment)>,
    /// The last job that ended.
    ended: JobId,
    lidar: Option<(SceneRev, Arc<LidarSweep>)>,
    /// Pose of the vehicle at the moment of the sweep.
    swept_at: Pose,
    radar: Option<(SceneRev, Arc<Vec<RadarScan>>)>,
    sampled: Option<Sampled>,
    cameras: Option<(SceneRev, Wanted, Arc<Vec<CameraView>>)>,
    others: Vec<(SceneRev, SourceId, Arc<Vec<CameraView>>)>,
    version: u64,
    /// Last jobs for a forgotten scene, of sensing and of painting: news of them and of earlier jobs is dropped.
    forgotten: [u64; 2],
    problem: Option<String>,
    /// New pictures of the strip since they were asked about, and whether the large one is among them.
    fresh: (usize, bool),
    painting: Worker<painting::PaintingRequest, painting::PaintingEvent>,
    paint: Arc<PaintWish>,
    /// The learned pictures of all cameras, with their state.
    painted: Option<(SceneRev, Arc<Vec<CameraView>>)>,
    stage: Option<PaintStage>,
    stop: Arc<AtomicBool>,
    /// True if the painting was stopped or failed, and no request has come since.
    stopped: bool,
}

impl Drop for Sensing {
    fn drop(&mut self) {
        self.stop_painting();
    }
}

impl Sensing {
    /// Starts the threads `sensing` and `painting`. Sensing begins after a `grace`, so that on a software rasteriser an
    /// edit is shown first. `wake` is called after each piece of news. Errors if the system gives no thread.
    pub fn spawn(grace: Duration, wake: impl Fn() + Send + Sync + 'static) -> std::io::Result<Self> {
        let senses = move || Senses::new(grace);
        let stop = Arc::new(AtomicBool::new(false));
        let (stops, wake): (_, Wake) = (stop.clone(), Arc::new(wake));
        Ok(Self {
            painting: Worker::start("painting", move || Painting::new(stops), wake.clone())?,
            worker: Worker::start("sensing", senses, wake)?,
            asked: None,
            played: None,
            ended: JobId(0),
            lidar: None,
            swept_at: Pose::IDENTITY,
            radar: None,
            sampled: None,
            cameras: None,
            others: Vec::new(),
            version: 0,
            forgotten: [0; 2],
            problem: None,
            fresh: (0, false),
            paint: Arc::default(),
            painted: None,
            stage: None,
            stop,
            stopped: false,
        })
    }

    /// Sets how learned pictures are painted. If the settings change, the pictures are painted again with the next
    /// request.
    pub fn paint_with(&mut self, settings: &PaintWish) {
        if *self.paint != *settings {
            self.paint = Arc::new(settings.clone());
            (self.asked, self.played) = (None, None);
            // Existing pictures were painted with other settings.
            if let Some((rev, _)) = &mut self.painted {
                *rev = SceneRev::fresh();
            }
        }
    }

    /// Forgets all results, and those that are still to come, because another scene is shown.
    pub fn forget(&mut self) {
        self.stop_painting();
        self.worker.cancel();
        self.painting.cancel();
        self.forgotten = [self.worker.newest().0, self.painting.newest().0];
        (self.asked, self.played, self.lidar, self.radar, self.sampled) = (None, None, None, None, None);
        (self.cameras, self.painted, self.stage) = (None, None, None);
        self.others.clear();
        self.version += 1;
    }

    /// Progress of the pictures that are being painted.
    pub fn paint_stage(&self) -> Option<PaintStage> {
        let ends = self.stop.load(Ordering::Relaxed);
        self.stage
            .map(|stage| if ends { PaintStage::Stopping } else { stage })
    }

    /// Stops the painting after its current step. The pictures stay as they are until a new request.
    pub fn stop_painting(&self) {
        self.stop.store(true, Ordering::Relaxed);
    }

    /// Stops a painting that is not shown; it begins again when it is requested.
    pub fn rest(&mut self) {
        if self.stage.is_some() {
            self.stop_painting();
            (self.asked, self.played) = (None, None);
        }
    }

    /// True if the painting was stopped or failed, and no request has come since.
    pub fn is_stopped(&self) -> bool {
        self.stopped
    }

    /// Lets the painting start again with the next request.
    pub fn paint_again(&mut self) {
        (self.asked, self.played) = (None, None);
    }

    /// True if nothing is being sensed.
    pub fn is_idle(&self) -> bool {
        self.ended == self.worker.newest()
    }

    /// Requests the sensors of a scene, unless the same was requested already.
    pub fn ask(&mut self, scene: &Arc<Scene>, wanted: Wanted, haste: Haste) {
        let known = |(rev, was, before): (SceneRev, Wanted, Haste)| {
            let played = |haste| matches!(haste, Haste::Play { .. });
            let is_enough = before == Haste::Rest || haste != Haste::Rest && played(before) == played(haste);
            rev == scene.rev && was == wanted && is_enough
        };
        if self.asked.is_some_and(known) {
            return;
        }
        self.asked = Some((scene.rev, wanted, haste));
        let mut moment_s = None;
        if let Haste::Play { every_ms } = haste {
            let every_s = f64::from(every_ms.max(1)) / 1000.0;
            let at_s = (scene.time_s() / every_s).round() * every_s;
            let played = Some((scene.content(), wanted, moment(at_s)));
            if std::mem::replace(&mut self.played, played) == played {
                return;
            }
            moment_s = Some(at_s);
        } else {
            self.played = None;
        }
        let mut sources = wanted.others.iter().map(|(source, _)| source);
        if wanted.source == learned::ID || sources.any(|source| source == learned::ID) {
            self.paint(placed(scene), wanted, haste != Haste::Rest);
        }
        self.worker.submit(SensingRequest {
            scene: scene.clone(),
            at_s: moment_s,
            wanted,
            haste,
        });
    }

    /// Takes in the news of the threads.
    pub fn drain(&mut self) {
        self.drain_painting();
        let events: Vec<_> = self.worker.updates().try_iter().collect();
        let forgotten = self.forgotten[0];
        for event in &events {
            if matches!(event.update, SensingEvent::Ended | SensingEvent::Failed(_)) {
                self.ended = event.id;
            }
        }
        for news in events
            .into_iter()
            .filter(|e| e.id.0 > forgotten)
            .map(|e| e.update)
        {
            match news {
                SensingEvent::Lidar(rev, pose, sweep, sampled) => {
                    self.lidar = Some((rev, sweep));
                    self.swept_at = pose;
                    self.sampled = sampled;
                    self.version += 1;
                }
                SensingEvent::Radar(rev, scans) => {
                    self.radar = Some((rev, Arc::new(scans)));
                    self.version += 1;
                }
                // Another source was requested since.
                SensingEvent::Cameras(_, of, _)
                    if self.asked.is_some_and(|(_, now, _)| now.source != of.source) => {}
                SensingEvent::Cameras(rev, wanted, views) => {
                    let before = self.cameras.take().map(|(.., views)| views).unwrap_or_default();
                    let is_new =
                        |v: &&CameraView| !before.iter().any(|b| Arc::ptr_eq(&b.picture, &v.picture));
                    for view in views.iter().filter(is_new) {
                        let is_large = wanted.large.is_some_and(|(_, camera)| camera == view.camera);
                        self.fresh = (self.fresh.0 + 1, self.fresh.1 || is_large);
                    }
                    self.cameras = Some((rev, wanted, Arc::new(views)));
                    self.version += 1;
                }
                SensingEvent::Other(rev, source, views) => {
                    self.others.retain(|(_, of, _)| *of != source);
                    self.others.push((rev, source, Arc::new(views)));
                    self.version += 1;
                }
                SensingEvent::Ended => {}
                SensingEvent::Failed(panic) => {
                    let problem = tf!("The sensors show an older scene: {problem}", problem = panic);
                    self.problem = Some(problem);
                }
            }
        }
    }

    /// The reason why a scene could not be sensed; returned once. Later scenes are sensed again.
    pub fn take_problem(&mut self) -> Option<String> {
        self.problem.take()
    }

    /// How many new pictures the strip got since the last call, and whether that of the large camera is among them.
    pub fn take_fresh(&mut self) -> (usize, bool) {
        std::mem::take(&mut self.fresh)
    }

    /// The newest sweep.
    pub fn lidar(&self) -> Option<&Arc<LidarSweep>> {
        self.lidar.as_ref().map(|(_, sweep)| sweep)
    }

    /// Pose of the vehicle, world frame, at the moment of the newest sweep: while a clip plays, sweeps are older than the scene.
    pub fn swept_at(&self) -> &Pose {
        &self.swept_at
    }

    /// The newest radar scans.
    pub fn radar(&self) -> Option<&Arc<Vec<RadarScan>>> {
        self.radar.as_ref().map(|(_, scans)| scans)
    }

    /// True if the radar scans are not those of this state.
    pub fn radar_stale(&self, rev: SceneRev) -> bool {
        self.radar.as_ref().is_none_or(|(of, _)| *of != rev)
    }

    /// The places where rays of the newest sweep were sampled after the last change; `None` if the sweep is not
    /// learned.
    pub fn sampled(&self) -> Option<&Sampled> {
        self.sampled.as_ref()
    }

    /// The newest pictures of the cameras that are rendered, in the rig's order.
    pub fn cameras(&self) -> Option<&Arc<Vec<CameraView>>> {
        self.cameras.as_ref().map(|(_, _, views)| views)
    }

    /// The newest pictures of a source, from the strip or from a pane.
    pub fn pictures_of(&self, source: SourceId) -> Option<&Arc<Vec<CameraView>>> {
        let of_strip = self
            .cameras
            .as_ref()
            .filter(|(_, wanted, _)| wanted.source == source);
        let other = || {
            self.others
                .iter()
                .find(|(_, of, _)| *of == source)
                .map(|(.., views)| views)
        };
        of_strip.map(|(.., views)| views).or_else(other)
    }

    /// True if the pictures of a source are not those of this state.
    pub fn is_stale(&self, source: SourceId, rev: SceneRev) -> bool {
        match self.asked {
            Some((_, wanted, _)) if wanted.source == source => self.cameras_stale(rev),
            _ => !self.others.iter().any(|(at, of, _)| *of == source && *at == rev),
        }
    }

    /// True if the pictures are of another state, or of other cameras or another source than requested last.
    pub fn cameras_stale(&self, rev: SceneRev) -> bool {
        let wanted = self.asked.map(|(_, wanted, _)| wanted.pictures());
        let current = |(of, shown, _): &(SceneRev, Wanted, _)| *of == rev && Some(shown.pictures()) == wanted;
        !self.cameras.as_ref().is_some_and(current)
    }

    /// True if the sweep is not that of this state.
    pub fn lidar_stale(&self, rev: SceneRev) -> bool {
        self.lidar.as_ref().is_none_or(|(of, _)| *of != rev)
    }

    /// Counter of the news: values derived from the results are current as long as it is unchanged.
    pub fn version(&self) -> u64 {
        self.version
    }
}
