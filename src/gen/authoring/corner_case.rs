//! A corner case: one change of a scene, varied step by step until a network of cameras, LiDAR or both misses an object.

use std::ops::ControlFlow;

use anyhow::{Context, Result, bail};
use glam::{DVec2, DVec3};

use editor::{Document, Edit};
use scene::clip::{Path, Speed};
use scene::{BoxId, Camera, Conditions, Motion, Scene, SceneBox, TimeOfDay, Weather};
use sensors::perceive::pictures::{LEAST_PX, MISSED_BELOW, Perceived};
use sensors::perceive::sweep::{self, LEAST_RETURNS};
use sensors::perceive::voxels::{self, LEAST_VOXELS};
use sensors::pictures::appearance::Appearance;

/// Distance of one step, m, and number of steps.
const AWAY_M: (f64, usize) = (1.0, 40);
/// Shift of one step, m, and farthest shift to either side, m.
const ASIDE_M: (f64, f64) = (0.5, 8.0);
/// Factor by which visibility falls at each step, and its lower limit, m.
const FOG: (f64, f64) = (0.8, 8.0);
/// Increase of speed at each step, and upper limit, m/s.
const FASTER_MPS: (f64, f64) = (2.5, 40.0);
/// Visibility at which fog begins, m.
const CLEAR_M: f64 = 250.0;
/// Angle by which cameras with the object at their edge are widened, rad.
const MARGIN_RAD: f64 = 0.2;

/// The property that is varied.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub enum Vary {
    /// The object goes away from the ego vehicle, metre by metre.
    Distance,
    /// The object goes to one side or the other, by half metres.
    Offset,
    /// Fog comes, thicker and thicker.
    Fog,
    /// The time of day.
    Time,
    /// The weather.
    Weather,
    /// How fast the object drives: a sweep takes time, so that it is drawn out or pressed together.
    Speed,
}

impl Vary {
    /// All of them.
    pub const ALL: [Vary; 6] = [
        Vary::Distance,
        Vary::Offset,
        Vary::Fog,
        Vary::Time,
        Vary::Weather,
        Vary::Speed,
    ];

    /// Name of the varied property, for a person.
    pub fn title(self) -> &'static str {
        match self {
            Vary::Distance => "Distance",
            Vary::Offset => "Offset",
            Vary::Fog => "Fog",
            Vary::Time => "Time of day",
            Vary::Weather => "Weather",
            Vary::Speed => "Speed",
        }
    }
}

/// Sensors of the network that is to miss the object.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, clap::ValueEnum)]
pub enum NetworkSensors {
    /// The cameras'.
    #[default]
    Cameras,
    /// The LiDAR's.
    Lidar,
    /// The network that tells voxels from both.
    Both,
}

impl NetworkSensors {
    /// All values, with their names.
    pub const ALL: [(Self, &'static str); 3] = [
        (Self::Cameras, "Cameras"),
        (Self::Lidar, "LiDAR"),
        (Self::Both, "Both"),
    ];

    /// The properties that can be varied: light and air do not affect the LiDAR of the program, and pictures are taken
    /// in a moment.
    pub fn varies(self) -> &'static [Vary] {
        match self {
            Self::Cameras => Vary::ALL.split_at(5).0,
            Self::Lidar => &[Vary::Distance, Vary::Offset, Vary::Speed],
            Self::Both => &Vary::ALL,
        }
    }

    /// Pixels, returns or voxels that an object needs to be judged.
    pub fn least(self) -> usize {
        match self {
            Self::Cameras => LEAST_PX,
            Self::Lidar => LEAST_RETURNS,
            Self::Both => LEAST_VOXELS,
        }
    }
}

/// How well an object is seen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ObjectVisibility {
    /// The sensors.
    pub by: NetworkSensors,
    /// Pixels that show it in the camera that shows most of it, returns on it, or its voxels if a sensor sees it
    /// plainly.
    pub visible: usize,
    /// Share of the pixels that the network takes for a thing, in the camera where that is most; confidence of the box;
    /// or share of the voxels.
    pub share: f64,
}

impl ObjectVisibility {
    /// True if there is enough of it to be judged.
    pub fn is_judged(&self) -> bool {
        self.visible >= self.by.least()
    }

    /// True if it is plainly visible and the network misses it.
    pub fn is_missed(&self) -> bool {
        self.is_judged() && self.share < MISSED_BELOW
    }
}

/// Difference of a variation from the scene.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum SceneVariation {
    /// No difference.
    None,
    /// Distance of the object from the ego vehicle, m.
    Away(f64),
    /// Shift of the object to the left, m; to the right if negative.
    Aside(f64),
    /// Visibility, m.
    Visibility(f64),
    /// Another time of day.
    Time(TimeOfDay),
    /// Another weather.
    Weather(Weather),
    /// Speed of the object, m/s.
    Speed(f64),
}

impl std::fmt::Display for SceneVariation {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            SceneVariation::None => write!(f, "as it is"),
            SceneVariation::Away(m) => write!(f, "{m:.1} m from the ego vehicle"),
            SceneVariation::Aside(m) if *m < 0.0 => write!(f, "{:.1} m to the right", -m),
            SceneVariation::Aside(m) => write!(f, "{m:.1} m to the left"),
            SceneVariation::Visibility(m) => write!(f, "visibility {m:.0} m"),
            SceneVariation::Time(time) => write!(f, "{}", time.name()),
            SceneVariation::Weather(weather) => write!(f, "{}", weather.name()),
            SceneVariation::Speed(mps) => write!(f, "{mps:.1} m/s"),
        }
    }
}

/// One variation that was tried.
#[derive(Clone, Copy, Debug)]
pub struct Tried {
    /// Its difference from the scene.
    pub change: SceneVariation,
    /// The sight of the object in it.
    pub sight: ObjectVisibility,
}

/// Result of a search.
#[derive(Debug)]
pub struct Search {
    /// The moment of the scene that was looked at, s.
    pub at_s: f64,
    /// Variations that were tried, in order; the first is the scene as it is.
    pub tried: Vec<Tried>,
    /// Edits that lead to the last variation, if it misses the object; no edits if that is the scene as it is.
    pub found: Option<Vec<Edit>>,
    /// True if the search was ended before everything was tried.
    pub stopped: bool,
}

/// Varies a scene until a network does not see a box that is plainly visible. `watch` is called for each try, with its
/// number and the largest possible number, and may end the search. Errors if there is no such box, every change is
/// refused, or the network fails.
pub fn search(
    scene: &Scene,
    id: BoxId,
    vary: Vary,
    by: NetworkSensors,
    mut watch: impl FnMut(&Tried, [usize; 2]) -> ControlFlow<()>,
) -> Result<Search> {
    let b = scene.frame().boxes.get(&id);
    let b = b.with_context(|| format!("there is no box {}", id.0))?;
    let at_s = match vary {
        Vary::Speed => match speed_problem(scene, id) {
            Some(problem) => bail!(problem),
            None => after_a_sweep(scene),
        },
        _ => scene.time_s(),
    };
    let steps = steps(scene, b, vary);
    let most = steps.len() + 1;
    let mut out = Search {
        at_s,
        tried: Vec::new(),
        found: None,
        stopped: false,
    };
    let mut refused = None;
    let as_it_is = std::iter::once((SceneVariation::None, Vec::new()));
    for (change, edits) in as_it_is.chain(steps) {
        let mut document = Document::new(scene.clone());
        // A place where the box cannot stand is skipped.
        if let Err(error) = document.apply_all("vary", &edits) {
            refused = refused.or(Some(error));
            continue;
        }
        let tried = Tried {
            change,
            sight: sight(&document.scene().at(at_s), id, by)?,
        };
        let (missed, ends) = (
            tried.sight.is_missed(),
            watch(&tried, [out.tried.len() + 1, most]).is_break(),
        );
        out.tried.push(tried);
        if missed {
            out.found = Some(edits);
        }
        // An object too small to be missed does not become larger farther away. One that is too small to be judged as
        // it is needs no search.
        let small = !tried.sight.is_judged();
        let gone = small && (vary == Vary::Distance || out.tried.len() == 1);
        if missed || gone {
            return Ok(out);
        }
        if ends {
            out.stopped = true;
            return Ok(out);
        }
    }
    match refused {
        Some(error) if out.tried.len() == 1 => bail!("no change can be made: {error}"),
        _ => Ok(out),
    }
}

/// How a scene's cameras, its LiDAR or both see a box. Errors if the network fails.
pub fn sight(scene: &Scene, id: BoxId, by: NetworkSensors) -> Result<ObjectVisibility> {
    match by {
        NetworkSensors::Cameras => in_cameras(scene, id),
        NetworkSensors::Lidar => {
            let seen = sweep::sight(scene, id)?;
            Ok(ObjectVisibility {
                by,
                visible: seen.map_or(0, |s| s.returns),
                share: seen.and_then(|s| s.score).map_or(0.0, f64::from),
            })
        }
        NetworkSensors::Both => {
            let seen = voxels::sight(scene, id)?;
            Ok(ObjectVisibility {
                by,
                visible: seen.map_or(0, |s| s.voxels),
                share: seen.map_or(0.0, |s| s.share),
            })
        }
    }
}

fn in_cameras(scene: &Scene, id: BoxId) -> Result<ObjectVisibility> {
    let placed = scene.for_sensors();
    let (frame, rig) = (placed.frame(), &placed.rig);
    let mut best = ObjectVisibility {
        by: NetworkSensors::Cameras,
        visible: 0,
        share: 0.0,
    };
    let Some(b) = frame.boxes.get(&id) else {
        return Ok(best);
    };
    let appearance = Appearance::with_things(frame, &placed.background, rig, &placed.conditions);
    for camera in rig.cameras.iter().filter(|c| may_see(c, b)) {
        let seen = Perceived::of(&appearance, frame, camera)?;
        if let Some((visible, share)) = seen.seen(id) {
            best.visible = best.visible.max(visible);
            if visible >= LEAST_PX {
                best.share = best.share.max(share);
            }
        }
    }
    Ok(best)
}

/// False if a box lies well outside a camera's picture.
fn may_see(camera: &Camera, b: &SceneBox) -> bool {
    let p = camera.ego_from_camera().inverse().apply(b.center_m);
    let half_rad = (camera.fov_deg() / 2.0).to_radians() + MARGIN_RAD;
    let reach_rad = (b.size_m.length() / 2.0).atan2(p.length());
    p.angle_between(DVec3::Z) < half_rad + reach_rad
}

/// The variations, mildest first, and the edits that lead there.
fn steps(scene: &Scene, b: &SceneBox, vary: Vary) -> Vec<(SceneVariation, Vec<Edit>)> {
    let ego = scene.frame().world_from_ego.translation_m.truncate();
    let off = b.center_m.truncate() - ego;
    let ahead = off.try_normalize().unwrap_or(DVec2::X);
    let moved = |by: DVec2| {
        vec![Edit::MoveBox {
            id: b.id,
            center_m: Some(b.center_m + by.extend(0.0)),
            yaw_deg: None,
            size_m: None,
        }]
    };
    let lit = |conditions: Conditions| vec![Edit::SetConditions { conditions }];
    let now = scene.conditions;
    match vary {
        Vary::Distance => (1..=AWAY_M.1)
            .map(|k| {
                let by_m = AWAY_M.0 * k as f64;
                (SceneVariation::Away(off.length() + by_m), moved(ahead * by_m))
            })
            .collect(),
        Vary::Offset => (1..=(ASIDE_M.1 / ASIDE_M.0) as usize)
            .flat_map(|k| [1.0, -1.0].map(|side| side * ASIDE_M.0 * k as f64))
            .map(|by_m| (SceneVariation::Aside(by_m), moved(ahead.perp() * by_m)))
            .collect(),
        Vary::Fog => {
            let start = now.visibility_m.min(CLEAR_M);
            let thinner = std::iter::successors(Some(start), |m| Some(m * FOG.0));
            let all = thinner.take_while(|m| *m >= FOG.1);
            all.map(|visibility_m| {
                let conditions = Conditions {
                    visibility_m,
                    ..now.under(Weather::Fog)
                };
                (SceneVariation::Visibility(visibility_m), lit(conditions))
            })
            .collect()
        }
        Vary::Time => TimeOfDay::ALL
            .into_iter()
            .filter(|time| *time != now.time)
            .map(|time| (SceneVariation::Time(time), lit(now.at(time))))
            .collect(),
        Vary::Weather => Weather::ALL
            .into_iter()
            .filter(|weather| *weather != now.weather)
            .map(|weather| (SceneVariation::Weather(weather), lit(now.under(weather))))
            .collect(),
        Vary::Speed => {
            let now_mps = b.velocity_mps.length();
            let faster = (1..).map(|k| now_mps + FASTER_MPS.0 * f64::from(k));
            let faster = faster.take_while(|mps| *mps <= FASTER_MPS.1);
            faster
                .map(|mps| (SceneVariation::Speed(mps), driving(scene, b, mps)))
                .collect()
        }
    }
}

/// Moment at which a scene with varied speeds is looked at, s: once a whole sweep has been measured.
fn after_a_sweep(scene: &Scene) -> f64 {
    let spin_hz = scene.rig.lidars.first().map_or(0.0, |l| l.spin_hz);
    let sweep_s = if spin_hz > 0.0 { 1.0 / spin_hz } else { 0.0 };
    scene.time_s().max(sweep_s)
}

/// True if the LiDAR of a scene turns while it measures, so that moving objects are stretched or compressed.
pub fn speed_matters(scene: &Scene) -> bool {
    scene.rig.lidars.first().is_some_and(|l| l.spin_hz > 0.0)
}

/// The reason why the speed of a box cannot be varied; `None` if it can.
fn speed_problem(scene: &Scene, id: BoxId) -> Option<String> {
    if !speed_matters(scene) {
        return Some(
            "the LiDAR measures everything at one moment (spin_hz is 0 in the rig): speed changes nothing"
                .to_owned(),
        );
    }
    let follows = scene.clip().motion(Some(id)).is_some();
    follows.then(|| format!("box {} follows a motion: its speed is set there", id.0))
}

/// Edits that make a box drive at a speed, m/s: it is at its present place [`after_a_sweep`], and drives on for as
/// long.
fn driving(scene: &Scene, b: &SceneBox, mps: f64) -> Vec<Edit> {
    let at_s = after_a_sweep(scene);
    let (here, way) = (b.center_m.truncate(), b.heading() * mps * at_s);
    let path = Path {
        points_m: vec![here - way, here + way],
        start_m: 0.0,
        speeds: vec![Speed { time_s: 0.0, mps }],
        rear_first: false,
    };
    let drives = Edit::SetMotion {
        id: Some(b.id),
        motion: Some(Motion::Path(path)),
        from_s: None,
        to_s: None,
    };
    let longer = Edit::SetLength {
        length_s: 2.0 * at_s,
        rate_hz: None,
    };
    match scene.clip().length_s {
        length_s if length_s > 0.0 && length_s >= at_s => vec![drives],
        _ => vec![longer, drives],
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::open;

    /// A box that a camera sees plainly, the nearest one.
    fn seen_box(scene: &Scene) -> BoxId {
        let near = |b: &&SceneBox| b.center_m.truncate().length();
        let mut boxes: Vec<&SceneBox> = scene.frame().boxes.values().collect();
        boxes.sort_by(|a, b| near(a).total_cmp(&near(b)));
        let seen = boxes.into_iter().find(|b| {
            let sight = sight(scene, b.id, NetworkSensors::Cameras).expect("the shipped network");
            sight.visible > 200 && !sight.is_missed()
        });
        seen.expect("a box that is seen").id
    }

    #[test]
    fn a_search_ends_where_the_object_is_missed() {
        let scene = open::from_template("t-junction", 1).expect("a template");
        let id = seen_box(&scene);
        let mut heard = 0;
        let found = search(
            &scene,
            id,
            Vary::Fog,
            NetworkSensors::Cameras,
            |tried, [k, most]| {
                heard += 1;
                assert!(k == heard && k <= most && (k == 1) == (tried.change == SceneVariation::None));
                ControlFlow::Continue(())
            },
        );
        let found = found.expect("the shipped network");
        let (last, before) = found.tried.split_last().expect("tries");
        assert!(before.iter().all(|t| !t.sight.is_missed()));
        assert_eq!(found.found.is_some(), last.sight.is_missed());
        // In the thickest fog nothing is seen.
        let edits = found.found.expect("fog hides everything in the end");
        let mut document = Document::new(scene.clone());
        document.apply_all("vary", &edits).expect("edits of the search");
        assert_eq!(
            sight(document.scene(), id, NetworkSensors::Cameras).expect("a sight"),
            last.sight
        );
        // The search can be ended, and an unknown box is named in the error.
        let ended = search(&scene, id, Vary::Offset, NetworkSensors::Cameras, |_, _| {
            ControlFlow::Break(())
        });
        let ended = ended.expect("the shipped network");
        assert!(ended.tried.len() == 1 && ended.found.is_none() && ended.stopped);
        // A locked box cannot be moved: the search reports that, and not that the box is always seen.
        let mut document = Document::new(scene.clone());
        let lock = Edit::Arrange {
            boxes: vec![id],
            things: Vec::new(),
            how: scene::Arrangement::Lock,
        };
        document.apply("lock", &lock).expect("a box");
        let go_on = |_: &Tried, _: [usize; 2]| ControlFlow::Continue(());
        let error = search(
            document.scene(),
            id,
            Vary::Distance,
            NetworkSensors::Cameras,
            go_on,
        );
        let error = error.expect_err("locked").to_string();
        assert!(
            error.starts_with("no change can be made: ") && error.contains("locked"),
            "{error}"
        );
        let error = search(
            &scene,
            BoxId(9999),
            Vary::Time,
            NetworkSensors::Cameras,
            |_, _| ControlFlow::Continue(()),
        );
        assert_eq!(error.expect_err("no box").to_string(), "there is no box 9999");
    }

    #[test]
    fn a_lidar_loses_what_goes_away() {
        let scene = open::from_template("t-junction", 1).expect("a template");
        let seen = |b: &&SceneBox| {
            let sight = sight(&scene, b.id, NetworkSensors::Lidar).expect("the shipped network");
            sight.is_judged() && !sight.is_missed()
        };
        let b = scene
            .frame()
            .boxes
            .values()
            .find(seen)
            .expect("a box that the LiDAR sees");
        let found = search(&scene, b.id, Vary::Distance, NetworkSensors::Lidar, |_, _| {
            ControlFlow::Continue(())
        });
        let found = found.expect("the shipped network");
        let last = found.tried.last().expect("tries").sight;
        // In the end it is missed, has too few returns to be judged, or was moved as far as the search goes.
        assert!(last.is_missed() || !last.is_judged() || found.tried.len() > 30);
        assert!(found.tried[0].sight.visible > last.visible && last.by == NetworkSensors::Lidar);
        assert!(!NetworkSensors::Lidar.varies().contains(&Vary::Fog));
    }

    #[test]
    fn steps_are_mildest_first_and_go_where_they_say() {
        let scene = open::from_template("t-junction", 1).expect("a template");
        let b = scene.frame().boxes.values().next().expect("a box");
        let ego = scene.frame().world_from_ego.translation_m;
        let away: Vec<f64> = steps(&scene, b, Vary::Distance)
            .into_iter()
            .map(|(_, edits)| match &edits[..] {
                [
                    Edit::MoveBox {
                        center_m: Some(p), ..
                    },
                ] => (*p - ego).truncate().length(),
                other => panic!("{other:?}"),
            })
            .collect();
        assert_eq!(away.len(), AWAY_M.1);
        assert!(away.is_sorted() && away[0] > (b.center_m - ego).truncate().length());
        assert_eq!(steps(&scene, b, Vary::Time).len(), 3);
        assert_eq!(steps(&scene, b, Vary::Weather).len(), Weather::ALL.len() - 1);
        assert!(steps(&scene, b, Vary::Offset)[1].0.to_string() == "0.5 m to the right");
        let go_on = |_: &Tried, _| ControlFlow::Continue(());
        let error = search(&scene, b.id, Vary::Speed, NetworkSensors::Lidar, go_on).expect_err("it stands");
        assert!(error.to_string().contains("spin_hz is 0"), "{error}");
        let mut scene = scene.clone();
        let mut rig = (*scene.rig).clone();
        rig.lidars[0].spin_hz = 10.0;
        scene.rig = rig.into();
        let speed = steps(&scene, b, Vary::Speed);
        // A clip that is long enough keeps its length.
        let sets_length = |edits: &[Edit]| edits.iter().any(|e| matches!(e, Edit::SetLength { .. }));
        let mut long = Document::new(scene.clone());
        let edit = Edit::SetLength {
            length_s: 20.0,
            rate_hz: None,
        };
        long.apply("length", &edit).expect("a length");
        assert!(sets_length(&speed[0].1));
        assert!(!sets_length(&steps(&long.scene().at(15.0), b, Vary::Speed)[0].1));
        assert!(speed.len() > 5 && speed.windows(2).all(|p| p[0].0 != p[1].0));
        let mut document = Document::new(scene.clone());
        let (change, edits) = speed.last().expect("faster");
        document.apply_all("vary", edits).expect("it can drive");
        let then = document.scene().at(after_a_sweep(&scene));
        let after = then.frame().boxes[&b.id];
        assert!(after.center_m.distance(b.center_m) < 0.05, "{}", after.center_m);
        // The box moves while the LiDAR turns, so the sweep differs.
        let sweep = |scene: &Scene| {
            sensors::lidar::rolling::of_voxels(&scene.for_sensors())
                .points
                .len()
        };
        assert!(sensors::lidar::rolling::is_rolling(&then) && sweep(&then) != sweep(&scene));
        let error = search(&then, b.id, Vary::Speed, NetworkSensors::Lidar, go_on).expect_err("it follows");
        assert!(error.to_string().contains("follows a motion"), "{error}");
        let driven = |change: SceneVariation| matches!(change, SceneVariation::Speed(mps) if (mps - after.velocity_mps.length()).abs() < 1e-6);
        assert!(driven(*change), "{change:?}");
        assert_eq!((after.center_m, after.label), (b.center_m, b.label));
        let fog = steps(&scene, b, Vary::Fog);
        assert!(fog.len() > 10 && fog[0].0.to_string() == "visibility 250 m");
    }
}
