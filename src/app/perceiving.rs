//! Predictions of small networks from the scene's cameras, its LiDAR and both, and searches for changes after which
//! they miss a box, on a thread of its own.

use std::ops::ControlFlow;
use std::sync::Arc;

use authoring::corner_case::{self, NetworkSensors, SceneVariation, Search, Tried, Vary};
use runtime::guard::Panicked;
use runtime::worker::JobId;
use runtime::worker::{Ctx, Event, Product, Wake, Worker};
use scene::{BoxId, Scene, SceneRev};
use sensors::perceive::pictures::{self, CameraReport};
use sensors::perceive::sweep::{self, SweepReport};
use sensors::perceive::voxels::{self, Hears, VoxelReport};

/// A request to the thread.
enum PerceptionRequest {
    Look(Arc<Scene>, NetworkSensors),
    Search(Arc<Scene>, BoxId, Vary, NetworkSensors),
}

enum PerceptionEvent {
    Looked(SceneRev, CameraReport),
    Swept(SceneRev, SweepReport),
    Told(SceneRev, VoxelReport),
    Tried(Tried, [usize; 2]),
    Searched(FinishedSearch),
    Failed(String),
    GivenUp,
}

/// A finished search.
#[derive(Debug)]
pub struct FinishedSearch {
    /// The state that was varied.
    pub of: SceneRev,
    /// The box that the network should miss.
    pub id: BoxId,
    /// Result of the search.
    pub search: Search,
    /// True if the user kept it as a version.
    pub kept: bool,
}

impl FinishedSearch {
    /// The sensor whose network was used.
    pub fn by(&self) -> NetworkSensors {
        self.search
            .tried
            .first()
            .map_or(NetworkSensors::Cameras, |t| t.sight.by)
    }
}

struct Perceiver;

impl Product for Perceiver {
    type Request = PerceptionRequest;
    type Update = PerceptionEvent;

    fn make(&mut self, request: &PerceptionRequest, ctx: &Ctx<'_, PerceptionEvent>) -> PerceptionEvent {
        match request {
            PerceptionRequest::Look(scene, NetworkSensors::Lidar) => match sweep::report(scene) {
                Ok(report) => PerceptionEvent::Swept(scene.rev, report),
                Err(error) => PerceptionEvent::Failed(error.to_string()),
            },
            PerceptionRequest::Look(scene, NetworkSensors::Both) => {
                match voxels::report(scene, Hears::Both) {
                    Ok(report) => PerceptionEvent::Told(scene.rev, report),
                    Err(error) => PerceptionEvent::Failed(error.to_string()),
                }
            }
            PerceptionRequest::Look(scene, NetworkSensors::Cameras) => {
                let placed = scene.for_sensors();
                match pictures::report(&placed) {
                    Ok(report) => PerceptionEvent::Looked(scene.rev, report),
                    Err(error) => PerceptionEvent::Failed(error.to_string()),
                }
            }
            PerceptionRequest::Search(scene, id, vary, by) => {
                let watch = |tried: &Tried, at| {
                    ctx.tell(PerceptionEvent::Tried(*tried, at));
                    match ctx.should_stop() {
                        true => ControlFlow::Break(()),
                        false => ControlFlow::Continue(()),
                    }
                };
                match corner_case::search(scene, *id, *vary, *by, watch) {
                    Ok(search) => PerceptionEvent::Searched(FinishedSearch {
                        of: scene.rev,
                        id: *id,
                        search,
                        kept: false,
                    }),
                    Err(error) => PerceptionEvent::Failed(format!("{error:#}")),
                }
            }
        }
    }

    fn reset(&mut self) {}

    fn given_up() -> PerceptionEvent {
        PerceptionEvent::GivenUp
    }

    fn panicked(panic: Panicked) -> PerceptionEvent {
        PerceptionEvent::Failed(panic.to_string())
    }

    fn is_terminal(news: &PerceptionEvent) -> bool {
        !matches!(news, PerceptionEvent::Tried(..))
    }
}

/// The newest predictions, and the thread that makes them.
pub struct Perceiving {
    worker: Worker<PerceptionRequest, PerceptionEvent>,
    asked: Option<(SceneRev, NetworkSensors)>,
    /// Last job for a forgotten scene: news of it and of earlier jobs is dropped.
    forgotten: u64,
    /// The newest job of each kind; news of others is outdated.
    look: Option<JobId>,
    search: Option<JobId>,
    /// Prediction from the cameras, with its state.
    pub seen: Option<(SceneRev, CameraReport)>,
    /// Prediction from the LiDAR sweep, with its state.
    pub swept: Option<(SceneRev, Arc<SweepReport>)>,
    /// Voxels predicted from both sensors, with their state.
    pub told: Option<(SceneRev, Arc<VoxelReport>)>,
    /// A running search: the last change tried, its number, and the number of tries at most.
    pub searching: Option<(SceneVariation, [usize; 2])>,
    /// The last search; after it, the last search before that found a change.
    pub found: Vec<FinishedSearch>,
    /// The reason why there is no prediction.
    pub problem: Option<String>,
}

impl Perceiving {
    /// Starts the thread `perception`; `wake` is called when there is news. Errors if the system gives no thread.
    pub fn spawn(wake: Wake) -> std::io::Result<Self> {
        Ok(Self {
            worker: Worker::start("perception", || Perceiver, wake)?,
            asked: None,
            forgotten: 0,
            look: None,
            search: None,
            seen: None,
            swept: None,
            told: None,
            searching: None,
            found: Vec::new(),
            problem: None,
        })
    }

    /// Takes in the news. Requests a prediction for a scene and a sensor if there is none yet, unless a search runs.
    pub fn update(&mut self, scene: &Arc<Scene>, by: NetworkSensors) {
        let news: Vec<_> = self.worker.updates().try_iter().collect();
        let forgotten = self.forgotten;
        for Event { id, update } in news.into_iter().filter(|e| e.id.0 > forgotten) {
            let (of_look, of_search) = (self.look == Some(id), self.search == Some(id));
            match update {
                PerceptionEvent::Looked(rev, report) => {
                    (self.seen, self.problem) = (Some((rev, report)), None)
                }
                PerceptionEvent::Swept(rev, report) => {
                    (self.swept, self.problem) = (Some((rev, Arc::new(report))), None)
                }
                PerceptionEvent::Told(rev, report) => {
                    (self.told, self.problem) = (Some((rev, Arc::new(report))), None)
                }
                // A search for a forgotten scene may still send news.
                PerceptionEvent::Tried(..) | PerceptionEvent::Searched(_) if !of_search => {}
                PerceptionEvent::Tried(tried, at) => self.searching = Some((tried.change, at)),
                PerceptionEvent::Searched(found) => {
                    self.end_search();
                    self.found.retain(|f| f.search.found.is_some());
                    self.found.insert(0, found);
                    self.found.truncate(2);
                }
                PerceptionEvent::Failed(problem) if of_look => self.problem = Some(problem),
                PerceptionEvent::Failed(problem) if of_search => {
                    self.end_search();
                    self.problem = Some(problem);
                }
                // A search replaced the prediction; it is requested again afterwards.
                PerceptionEvent::GivenUp if of_look => self.asked = None,
                PerceptionEvent::GivenUp if of_search => self.end_search(),
                PerceptionEvent::Failed(_) | PerceptionEvent::GivenUp => {}
            }
        }
        let wanted = Some((scene.rev, by));
        if self.searching.is_none() && self.asked != wanted && self.is_stale(scene.rev, by) {
            self.asked = wanted;
            self.look = Some(self.worker.submit(PerceptionRequest::Look(scene.clone(), by)));
        }
    }

    fn end_search(&mut self) {
        (self.searching, self.search) = (None, None);
    }

    /// Forgets predictions and searches, because another scene was opened.
    pub fn forget(&mut self) {
        (self.seen, self.swept, self.told) = (None, None, None);
        self.found.clear();
        (self.asked, self.problem) = (None, None);
        self.look = None;
        self.end_search();
        self.stop();
        self.forgotten = self.worker.newest().0;
    }

    /// Starts a search for a change of a scene after which a box is missed. Earlier results stay until it ends.
    pub fn search(&mut self, scene: &Arc<Scene>, id: BoxId, vary: Vary, by: NetworkSensors) {
        self.searching = Some((SceneVariation::None, [0, 1]));
        self.search = Some(
            self.worker
                .submit(PerceptionRequest::Search(scene.clone(), id, vary, by)),
        );
    }

    /// Ends a search after its current try.
    pub fn stop(&mut self) {
        self.worker.cancel();
    }

    /// True if the prediction from a sensor is of another state.
    pub fn is_stale(&self, rev: SceneRev, by: NetworkSensors) -> bool {
        match by {
            NetworkSensors::Cameras => self.seen.as_ref().is_none_or(|(of, _)| *of != rev),
            NetworkSensors::Lidar => self.swept.as_ref().is_none_or(|(of, _)| *of != rev),
            NetworkSensors::Both => self.told.as_ref().is_none_or(|(of, _)| *of != rev),
        }
    }
}

#[cfg(test)]
mod tests {
    use std::time::{Duration, Instant};

    use super::*;
    use crate::open;

    fn wait(
        perceiving: &mut Perceiving,
        (scene, by): (&Arc<Scene>, NetworkSensors),
        until: impl Fn(&Perceiving) -> bool,
    ) {
        let start = Instant::now();
        while !until(perceiving) {
            assert!(start.elapsed() < Duration::from_secs(120), "no news");
            std::thread::sleep(Duration::from_millis(5));
            perceiving.update(scene, by);
        }
    }

    #[test]
    fn a_scene_is_looked_at_and_searched() {
        let scene = Arc::new(open::from_template("t-junction", 1).expect("a template"));
        let mut perceiving = Perceiving::spawn(Arc::new(|| {})).expect("a thread");
        let by = (&scene, NetworkSensors::Cameras);
        assert!(perceiving.is_stale(scene.rev, NetworkSensors::Cameras));
        wait(&mut perceiving, by, |p| {
            !p.is_stale(scene.rev, NetworkSensors::Cameras)
        });
        let by_lidar = (&scene, NetworkSensors::Lidar);
        wait(&mut perceiving, by_lidar, |p| {
            !p.is_stale(scene.rev, NetworkSensors::Lidar)
        });
        let (_, swept) = perceiving.swept.as_ref().expect("a report");
        assert!(!swept.detections.is_empty());
        wait(&mut perceiving, (&scene, NetworkSensors::Both), |p| {
            !p.is_stale(scene.rev, NetworkSensors::Both)
        });
        let (_, told) = perceiving.told.as_ref().expect("a report");
        assert!(told.voxels.count_set() > 1000);
        let (_, report) = perceiving.seen.as_ref().expect("a report");
        assert!(!report.boxes.is_empty() && report.right > 0.5);
        let id = report.boxes.last().expect("a box").thing.id;
        perceiving.search(&scene, id, Vary::Time, NetworkSensors::Cameras);
        wait(&mut perceiving, by, |p| !p.found.is_empty());
        let found = perceiving.found.pop().expect("a search");
        assert_eq!((found.id, found.of), (id, scene.rev));
        assert!(perceiving.searching.is_none() && !found.search.tried.is_empty());
        // Forgetting a scene also drops its search, and the scene gets a new prediction.
        perceiving.search(&scene, id, Vary::Distance, NetworkSensors::Cameras);
        wait(&mut perceiving, by, |p| {
            p.searching.is_some_and(|(_, [tried, _])| tried > 0)
        });
        perceiving.forget();
        assert!(perceiving.seen.is_none() && perceiving.searching.is_none());
        wait(&mut perceiving, by, |p| {
            !p.is_stale(scene.rev, NetworkSensors::Cameras)
        });
        assert!(perceiving.found.is_empty() && perceiving.searching.is_none());
        // A search replaces a waiting prediction; that is made afterwards, and both results are there.
        let mut other = (*scene).clone();
        other.rev = SceneRev::fresh();
        let other = Arc::new(other);
        perceiving.update(&scene, NetworkSensors::Both);
        perceiving.update(&other, NetworkSensors::Both);
        perceiving.search(&other, id, Vary::Time, NetworkSensors::Cameras);
        wait(&mut perceiving, (&other, NetworkSensors::Both), |p| {
            !p.found.is_empty()
        });
        assert_eq!(perceiving.found[0].of, other.rev);
        wait(&mut perceiving, (&other, NetworkSensors::Both), |p| {
            !p.is_stale(other.rev, NetworkSensors::Both)
        });
        // A box that does not exist is reported, and the thread goes on.
        perceiving.search(&scene, BoxId(9999), Vary::Fog, NetworkSensors::Cameras);
        wait(&mut perceiving, by, |p| p.problem.is_some());
        assert_eq!(perceiving.problem.as_deref(), Some("there is no box 9999"));
    }
}
