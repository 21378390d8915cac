//! Predictions of small networks from the scene's cameras, its LiDAR and both, and searches for changes after which
//! they miss a box, on a thread of its own.

use std::ops::ControlFlow;
use std::sync::Arc;

use authoring::corner_case::{self, Change, Search, Sensor, Tried, Vary};
use job::JobId;
use job::guard::Panicked;
use job::product::{Ctx, Event, Product, Wake, Worker};
use scene::{BoxId, Scene, SceneRev};
use sensors::perceived::{self, Report};
use sensors::perceived_sweep::{self, SweepReport};
use sensors::perceived_voxels::{self, Hears, VoxelReport};

/// A request to the thread.
enum Request {
    Look(Arc<Scene>, Sensor),
    Search(Arc<Scene>, BoxId, Vary, Sensor),
}

enum News {
    Looked(SceneRev, Report),
    Swept(SceneRev, SweepReport),
    Told(SceneRev, VoxelReport),
    Tried(Tried, [usize; 2]),
    Searched(Found),
    Failed(String),
    GivenUp,
}

/// A finished search.
#[derive(Debug)]
pub struct Found {
    /// The state that was varied.
    pub of: SceneRev,
    /// The box that the network should miss.
    pub id: BoxId,
    /// Result of the search.
    pub search: Search,
    /// True if the user kept it as a version.
    pub kept: bool,
}

impl Found {
    /// The sensor whose network was used.
    pub fn by(&self) -> Sensor {
        self.search.tried.first().map_or(Sensor::Cameras, |t| t.sight.by)
    }
}

struct Perceiver;

impl Product for Perceiver {
    type Request = Request;
    type Update = News;

    fn make(&mut self, request: &Request, ctx: &Ctx<'_, News>) -> News {
        match request {
            Request::Look(scene, Sensor::Lidar) => match perceived_sweep::report(scene) {
                Ok(report) => News::Swept(scene.rev, report),
                Err(error) => News::Failed(error.to_string()),
            },
            Request::Look(scene, Sensor::Both) => match perceived_voxels::report(scene, Hears::Both) {
                Ok(report) => News::Told(scene.rev, report),
                Err(error) => News::Failed(error.to_string()),
            },
            Request::Look(scene, Sensor::Cameras) => {
                let placed = scene.with_rig_in_world();
                match perceived::report(&placed) {
                    Ok(report) => News::Looked(scene.rev, report),
                    Err(error) => News::Failed(error.to_string()),
                }
            }
            Request::Search(scene, id, vary, by) => {
                let watch = |tried: &Tried, at| {
                    ctx.tell(News::Tried(*tried, at));
                    match ctx.should_stop() {
                        true => ControlFlow::Break(()),
                        false => ControlFlow::Continue(()),
                    }
                };
                match corner_case::search(scene, *id, *vary, *by, watch) {
                    Ok(search) => News::Searched(Found {
                        of: scene.rev,
                        id: *id,
                        search,
                        kept: false,
                    }),
                    Err(error) => News::Failed(format!("{error:#}")),
                }
            }
        }
    }

    fn reset(&mut self) {}

    fn given_up() -> News {
        News::GivenUp
    }

    fn panicked(panic: Panicked) -> News {
        News::Failed(panic.to_string())
    }

    fn is_terminal(news: &News) -> bool {
        !matches!(news, News::Tried(..))
    }
}

/// The newest predictions, and the thread that makes them.
pub struct Perceiving {
    worker: Worker<Request, News>,
    asked: Option<(SceneRev, Sensor)>,
    /// Last job for a forgotten scene: news of it and of earlier jobs is dropped.
    forgotten: u64,
    /// The newest job of each kind; news of others is outdated.
    look: Option<JobId>,
    search: Option<JobId>,
    /// Prediction from the cameras, with its state.
    pub seen: Option<(SceneRev, Report)>,
    /// Prediction from the LiDAR sweep, with its state.
    pub swept: Option<(SceneRev, Arc<SweepReport>)>,
    /// Voxels predicted from both sensors, with their state.
    pub told: Option<(SceneRev, Arc<VoxelReport>)>,
    /// A running search: the last change tried, its number, and the number of tries at most.
    pub searching: Option<(Change, [usize; 2])>,
    /// The last search; after it, the last search before that found a change.
    pub found: Vec<Found>,
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
    pub fn update(&mut self, scene: &Arc<Scene>, by: Sensor) {
        let news: Vec<_> = self.worker.updates().try_iter().collect();
        let forgotten = self.forgotten;
        for Event { id, update } in news.into_iter().filter(|e| e.id.0 > forgotten) {
            let (of_look, of_search) = (self.look == Some(id), self.search == Some(id));
            match update {
                News::Looked(rev, report) => (self.seen, self.problem) = (Some((rev, report)), None),
                News::Swept(rev, report) => {
                    (self.swept, self.problem) = (Some((rev, Arc::new(report))), None)
                }
                News::Told(rev, report) => (self.told, self.problem) = (Some((rev, Arc::new(report))), None),
                // A search for a forgotten scene may still send news.
                News::Tried(..) | News::Searched(_) if !of_search => {}
                News::Tried(tried, at) => self.searching = Some((tried.change, at)),
                News::Searched(found) => {
                    self.end_search();
                    self.found.retain(|f| f.search.found.is_some());
                    self.found.insert(0, found);
                    self.found.truncate(2);
                }
                News::Failed(problem) if of_look => self.problem = Some(problem),
                News::Failed(problem) if of_search => {
                    self.end_search();
                    self.problem = Some(problem);
                }
                // A search replaced the prediction; it is requested again afterwards.
                News::GivenUp if of_look => self.asked = None,
                News::GivenUp if of_search => self.end_search(),
                News::Failed(_) | News::GivenUp => {}
            }
        }
        let wanted = Some((scene.rev, by));
        if self.searching.is_none() && self.asked != wanted && self.is_stale(scene.rev, by) {
            self.asked = wanted;
            self.look = Some(self.worker.submit(Request::Look(scene.clone(), by)));
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
    pub fn search(&mut self, scene: &Arc<Scene>, id: BoxId, vary: Vary, by: Sensor) {
        self.searching = Some((Change::None, [0, 1]));
        self.search = Some(self.worker.submit(Request::Search(scene.clone(), id, vary, by)));
    }

    /// Ends a search after its current try.
    pub fn stop(&mut self) {
        self.worker.cancel();
    }

    /// True if the prediction from a sensor is of another state.
    pub fn is_stale(&self, rev: SceneRev, by: Sensor) -> bool {
        match by {
            Sensor::Cameras => self.seen.as_ref().is_none_or(|(of, _)| *of != rev),
            Sensor::Lidar => self.swept.as_ref().is_none_or(|(of, _)| *of != rev),
            Sensor::Both => self.told.as_ref().is_none_or(|(of, _)| *of != rev),
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
        (scene, by): (&Arc<Scene>, Sensor),
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
        let by = (&scene, Sensor::Cameras);
        assert!(perceiving.is_stale(scene.rev, Sensor::Cameras));
        wait(&mut perceiving, by, |p| !p.is_stale(scene.rev, Sensor::Cameras));
        let by_lidar = (&scene, Sensor::Lidar);
        wait(&mut perceiving, by_lidar, |p| {
            !p.is_stale(scene.rev, Sensor::Lidar)
        });
        let (_, swept) = perceiving.swept.as_ref().expect("a report");
        assert!(!swept.detections.is_empty());
        wait(&mut perceiving, (&scene, Sensor::Both), |p| {
            !p.is_stale(scene.rev, Sensor::Both)
        });
        let (_, told) = perceiving.told.as_ref().expect("a report");
        assert!(told.voxels.count_set() > 1000);
        let (_, report) = perceiving.seen.as_ref().expect("a report");
        assert!(!report.boxes.is_empty() && report.right > 0.5);
        let id = report.boxes.last().expect("a box").thing.id;
        perceiving.search(&scene, id, Vary::Time, Sensor::Cameras);
        wait(&mut perceiving, by, |p| !p.found.is_empty());
        let found = perceiving.found.pop().expect("a search");
        assert_eq!((found.id, found.of), (id, scene.rev));
        assert!(perceiving.searching.is_none() && !found.search.tried.is_empty());
        // Forgetting a scene also drops its search, and the scene gets a new prediction.
        perceiving.search(&scene, id, Vary::Distance, Sensor::Cameras);
        wait(&mut perceiving, by, |p| {
            p.searching.is_some_and(|(_, [tried, _])| tried > 0)
        });
        perceiving.forget();
        assert!(perceiving.seen.is_none() && perceiving.searching.is_none());
        wait(&mut perceiving, by, |p| !p.is_stale(scene.rev, Sensor::Cameras));
        assert!(perceiving.found.is_empty() && perceiving.searching.is_none());
        // A search replaces a waiting prediction; that is made afterwards, and both results are there.
        let mut other = (*scene).clone();
        other.rev = SceneRev::fresh();
        let other = Arc::new(other);
        perceiving.update(&scene, Sensor::Both);
        perceiving.update(&other, Sensor::Both);
        perceiving.search(&other, id, Vary::Time, Sensor::Cameras);
        wait(&mut perceiving, (&other, Sensor::Both), |p| !p.found.is_empty());
        assert_eq!(perceiving.found[0].of, other.rev);
        wait(&mut perceiving, (&other, Sensor::Both), |p| {
            !p.is_stale(other.rev, Sensor::Both)
        });
        // A box that does not exist is reported, and the thread goes on.
        perceiving.search(&scene, BoxId(9999), Vary::Fog, Sensor::Cameras);
        wait(&mut perceiving, by, |p| p.problem.is_some());
        assert_eq!(perceiving.problem.as_deref(), Some("there is no box 9999"));
    }
}
