//! What the thread does: sweeps, radar scans and the pictures of the strip.

use std::sync::Arc;
use std::time::{Duration, Instant};

use super::playing::{self, Playing};
use super::reel::{Reel, moment};
use super::views::{Views, detail};
use super::{Haste, SensingEvent, SensingRequest, others, placed};
use crate::camera_views::{CameraView, LidarModel, PicturesKey, Wanted};
use crate::graphics::Graphics;
use nets::lidar::LidarNet;
use runtime::guard::Panicked;
use runtime::worker::{Ctx, Product};
use scene::resample::shared_in;
use scene::{Lattice, LidarSweep, Scene, SceneRev, SensorRig};
use sensors::cameras::{SourceId, learned};
use sensors::lidar::EgoBox;
use sensors::lidar::caster::Caster;
use sensors::lidar::learned::Drops;
use sensors::lidar::learned_caster::LearnedCaster;
use sensors::lidar::recorded::{self, EditableSweep};
use sensors::lidar::rolling;
use sensors::lidar::shaped::onto_shapes;
use sensors::pictures::appearance::AppearanceCache;
use sensors::pictures::scenery::SceneryShapes;
use sensors::radar;

/// Most rays whose samples are shown; more would cover the map.
const SHOWN_RAYS: usize = 400;

/// Least time between two sweeps, and between two scans of radars, while a clip plays, s.
pub(super) const SWEEPS_EVERY_S: f64 = 0.4;

/// The product of the thread: sweeps and pictures.
pub(super) struct Senses {
    grace: Duration,
    /// True if a newer scene came during the last grace; that scene is then sensed without another grace.
    rested: bool,
    kept: SensorCache,
}

impl Senses {
    /// Sensors that begin after a grace.
    pub fn new(grace: Duration) -> Self {
        Self {
            grace,
            rested: false,
            kept: SensorCache::default(),
        }
    }
}

impl Product for Senses {
    type Request = SensingRequest;
    type Update = SensingEvent;

    fn make(&mut self, request: &SensingRequest, ctx: &Ctx<'_, SensingEvent>) -> SensingEvent {
        let plays = matches!(request.haste, Haste::Play { .. });
        if !plays && !std::mem::replace(&mut self.rested, false) {
            std::thread::sleep(self.grace);
            if ctx.should_stop() {
                self.rested = true;
                return SensingEvent::Ended;
            }
        }
        let mut scene = request.scene.clone();
        if let Some(at_s) = request.at_s {
            Arc::make_mut(&mut scene).show(at_s);
        }
        let request = SensingRequest {
            scene: shared_in(&placed(&scene), Lattice::OCC3D),
            ..request.clone()
        };
        sense(&request, &mut self.kept, ctx);
        SensingEvent::Ended
    }

    fn reset(&mut self) {
        self.kept = SensorCache::default();
    }

    fn given_up() -> SensingEvent {
        SensingEvent::Ended
    }

    fn panicked(panic: Panicked) -> SensingEvent {
        SensingEvent::Failed(panic)
    }

    fn is_terminal(news: &SensingEvent) -> bool {
        matches!(news, SensingEvent::Ended | SensingEvent::Failed(_))
    }

    fn must_arrive(_: &SensingEvent) -> bool {
        true
    }
}

/// Values kept between requests: the exact and the learned sweep with their rigs, the LiDAR network once it is used,
/// and the last full pictures.
#[derive(Default)]
pub(super) struct SensorCache {
    pub(super) lidar: Option<(Arc<SensorRig>, Caster)>,
    pub(super) net: Option<Arc<LidarNet>>,
    /// The recorded sweep that the last scene came from.
    pub(super) recorded: Option<EditableSweep>,
    pub(super) learned: Option<(Arc<SensorRig>, LearnedCaster)>,
    pub(super) views: Option<((SceneRev, PicturesKey), Vec<CameraView>)>,
    /// State of the last full pictures, whatever moment they show.
    pub(super) rested: Option<SceneRev>,
    /// Pictures of other sources: state, source, bit per camera, pictures.
    pub(super) others: Vec<(SceneRev, SourceId, u32, Vec<CameraView>)>,
    pub(super) swept: Option<(SceneRev, LidarModel, bool)>,
    /// State of the last radar scans.
    pub(super) scanned: Option<SceneRev>,
    /// Time of the last sweep or scan.
    pub(super) ranged: Option<Instant>,
    /// What a clip that plays shows, with its state.
    pub(super) playing: Option<(SceneRev, PicturesKey, Playing)>,
    /// Pictures of moments that were played, by state, source and camera.
    pub(super) pictures: Reel<(SceneRev, SourceId), CameraView>,
    /// Sweeps of moments that were played.
    pub(super) sweeps: Reel<(SceneRev, LidarModel, bool), Arc<LidarSweep>>,
    /// Scenery as the last sweep met it.
    pub(super) scenery: Option<SceneryShapes>,
    /// The graphics card, looked for when a source that can use it is requested; `None` inside if there is none.
    pub(super) graphics: Option<Option<Graphics>>,
    /// Parts of pictures that the next moment shares.
    pub(super) appearance: AppearanceCache,
}

impl SensorCache {
    fn sweep(&mut self, scene: &Scene, wanted: &Wanted) -> LidarSweep {
        if wanted.lidar == LidarModel::Recorded
            && let Some(recording) = recorded::recording_of(scene)
        {
            let known = self
                .recorded
                .take()
                .filter(|known| Arc::ptr_eq(known.recording(), recording));
            let sweep = known.unwrap_or_else(|| EditableSweep::new(recording.clone(), &scene.kept.sweeps));
            let made = sweep.sweep(&sweep.edits(scene), scene);
            self.recorded = Some(sweep);
            return made;
        }
        if rolling::is_rolling(scene) {
            return self.rolling(scene, wanted);
        }
        if wanted.lidar == LidarModel::Learned
            && let Some(mut sweep) = self.learned(scene, wanted.lost_echoes)
        {
            onto_shapes(&mut sweep, scene.frame(), &scene.rig, scene.seed, None);
            return sweep;
        }
        let (frame, rig) = (scene.frame(), &scene.rig);
        match &mut self.lidar {
            Some((of, caster)) if of == rig => caster.update(&frame.occupancy),
            lidar => {
                let ego = Some(EgoBox::of_rig(rig));
                let cast = |pattern| Caster::new(&frame.occupancy, pattern, rig.velocity_mps(), ego);
                *lidar = rig.lidars.first().map(|pattern| (rig.clone(), cast(pattern)));
            }
        }
        self.scenery = SceneryShapes::of_lidars(scene, self.scenery.as_ref());
        self.lidar
            .as_ref()
            .map(|(_, caster)| caster.shaped(frame, rig, scene.seed, self.scenery.as_ref()))
            .unwrap_or_default()
    }

    /// The sweep of a LiDAR that spins while the scene moves. It is not kept.
    fn rolling(&mut self, scene: &Scene, wanted: &Wanted) -> LidarSweep {
        let net = match wanted.lidar {
            LidarModel::Learned => self.net(),
            LidarModel::Recorded | LidarModel::Exact => None,
        };
        let learned = net.and_then(|net| rolling::learned(&net, scene, drops(wanted.lost_echoes)).ok());
        learned.unwrap_or_else(|| {
            self.scenery = SceneryShapes::of_lidars(scene, self.scenery.as_ref());
            rolling::exact_with(scene, self.scenery.as_ref())
        })
    }

    fn net(&mut self) -> Option<Arc<LidarNet>> {
        if self.net.is_none() {
            self.net = LidarNet::bundled().ok();
        }
        self.net.clone()
    }

    /// The learned sweep. `None` if the network cannot be opened; the caller then uses the exact sweep.
    fn learned(&mut self, scene: &Scene, lost_echoes: bool) -> Option<LidarSweep> {
        let (grid, rig) = (&scene.frame().occupancy, &scene.rig);
        let net = self.net()?;
        match &mut self.learned {
            Some((of, caster)) if of == rig => caster.update(grid).ok()?,
            kept => {
                let caster = LearnedCaster::of_rig(net, grid, rig).ok()?;
                *kept = caster.map(|caster| (rig.clone(), caster));
            }
        }
        let sweep = self
            .learned
            .as_ref()
            .map(|(_, caster)| caster.sweep(drops(lost_echoes)));
        Some(sweep.unwrap_or_default())
    }
}

/// Treatment of echoes that a sensor may lose: kept and marked if `shown`, else dropped.
fn drops(shown: bool) -> Drops {
    if shown { Drops::Keep } else { Drops::Likely }
}

fn sense(request: &SensingRequest, kept: &mut SensorCache, ctx: &Ctx<'_, SensingEvent>) {
    let SensingRequest {
        scene, wanted, haste, ..
    } = request;
    let swept = (scene.rev, wanted.lidar, wanted.lost_echoes);
    let lately = |at: Instant| at.elapsed().as_secs_f64() < SWEEPS_EVERY_S;
    let plays = matches!(haste, Haste::Play { .. });
    let (at, of) = (
        moment(scene.time_s()),
        (scene.content(), wanted.lidar, wanted.lost_echoes),
    );
    // Where the network sampled its rays is told of a scene at rest.
    let again = plays || wanted.lidar != LidarModel::Learned;
    let again = again && kept.swept != Some(swept);
    if let Some(sweep) = kept.sweeps.get(&of, at, 0).filter(|_| again).cloned() {
        let pose = scene.frame().world_from_ego;
        ctx.tell(SensingEvent::Lidar(scene.rev, pose, sweep, None));
        kept.swept = Some(swept);
    }
    // Sweeps that were made before cost no time, so that those between them are made the next time round.
    let ranges = !plays || !kept.ranged.is_some_and(lately);
    if ranges && kept.swept != Some(swept) {
        kept.ranged = Some(Instant::now());
        let sweep = Arc::new(kept.sweep(scene, wanted));
        if plays {
            kept.sweeps.put(of, (at, 0), sweep.clone(), sweep.bytes());
        }
        let learned = kept
            .learned
            .as_ref()
            .filter(|_| wanted.lidar == LidarModel::Learned);
        let sampled = learned.map(|(_, caster)| caster.sampled(SHOWN_RAYS));
        let pose = scene.frame().world_from_ego;
        ctx.tell(SensingEvent::Lidar(scene.rev, pose, sweep, sampled));
        kept.swept = Some(swept);
    }
    if ranges && wanted.radar && kept.scanned != Some(scene.rev) {
        kept.ranged = Some(Instant::now());
        ctx.tell(SensingEvent::Radar(scene.rev, radar::scans(scene)));
        kept.scanned = Some(scene.rev);
    }
    // Learned pictures are painted on a thread of their own.
    let painted = wanted.camera_source().id() == learned::ID;
    let goes_on = match haste {
        _ if painted => true,
        Haste::Play { .. } => {
            playing::play(request, kept, ctx);
            true
        }
        _ => strip(request, kept, ctx),
    };
    if goes_on {
        others::other_sources(request, kept, ctx);
    }
}

/// Renders the pictures of the strip; false if the work should stop.
fn strip(request: &SensingRequest, kept: &mut SensorCache, ctx: &Ctx<'_, SensingEvent>) -> bool {
    let SensingRequest {
        scene, wanted, haste, ..
    } = request;
    let preview = *haste != Haste::Rest;
    let rig = &scene.rig;
    let key = (scene.rev, wanted.pictures());
    let source = wanted.camera_source();
    let mut of_scene = Views::new(source, scene, &mut kept.graphics, &kept.appearance);
    let (at, of) = (moment(scene.time_s()), (scene.content(), source.id()));
    let shown = |i: &usize| *i >= 32 || wanted.hidden >> i & 1 == 0;
    let mut render = |quick: bool| -> Option<Vec<CameraView>> {
        let (size, quality) = detail(quick);
        let mut views = Vec::with_capacity(rig.cameras.len());
        for i in (0..rig.cameras.len()).filter(shown) {
            // Full pictures give way to a newer scene. Previews do not: they are quick, and otherwise the strip would
            // get no pictures while the user drags.
            if !quick && ctx.should_stop() {
                return None;
            }
            let played = kept.pictures.get(&of, at, i).filter(|_| quick).cloned();
            views.push(match played {
                Some(view) => view.colored(source),
                None => of_scene.view(i, size, quality)?,
            });
        }
        Some(views)
    };
    // Existing pictures are not rendered again when another camera is enlarged.
    let kept_views = kept.views.as_ref().filter(|(of, _)| *of == key);
    let views = match kept_views.map(|(_, views)| views.clone()) {
        Some(views) => views,
        None => {
            // Camera pictures are slow, so a coarse one comes first.
            if (preview || source.about().previews)
                && let Some(views) = render(true)
            {
                ctx.tell(SensingEvent::Cameras(scene.rev, *wanted, views));
            }
            if preview {
                return true;
            }
            let Some(views) = render(false) else { return false };
            kept.views = Some((key, views.clone()));
            kept.rested = Some(scene.content());
            views
        }
    };
    ctx.tell(SensingEvent::Cameras(scene.rev, *wanted, views.clone()));
    if let Some(camera) = wanted.large_of(source.id()).filter(shown)
        && let Some(views) = of_scene.with_large(&views, camera, ctx)
    {
        ctx.tell(SensingEvent::Cameras(scene.rev, *wanted, views));
    }
    true
}
