//! Files of any format, read with what the networks add: objects in sweeps without labels.

use std::path::Path;
use std::sync::Arc;

use formats::FormatError;
use formats::import::{self, Content, ImportOptions, ImportedScene, Importer, MomentGround};
use glam::DVec3;
use nets::ModelError;
use nets::perceiver::LidarPerceiver;
use nets::perceiver::detection::Detection;
use nets::perceiver::stands::Stands;
use rayon::prelude::*;
use scene::{BoxId, Scene, SensorRig, Window};
use sensors::lidar::recorded::EditableSweep;

use super::tracks::{self, Find};

/// Reads a file as [`import::read_with`] does; in a sweep without labels objects are found, each a guess. The file of a
/// sweep is kept with the scene, whose LiDAR gets the beams of the sweep.
pub fn file_with(path: &Path, options: ImportOptions) -> Result<(&'static Importer, Content), FormatError> {
    let (importer, content) = import::read_with(path, options)?;
    Ok(match content {
        Content::Scene(loaded) => {
            let is_sweep = loaded.sweep.is_some();
            let mut loaded = with_tracked(*loaded).with_recording();
            let pattern = is_sweep.then(|| take_pattern(&mut loaded.scene)).flatten();
            if let Some([beams, columns]) = pattern {
                let note =
                    format!("the LiDAR has {beams} beams and {columns} columns a turn, as the sweep shows");
                loaded.notes.push(note);
            }
            (importer, Content::Scene(Box::new(loaded)))
        }
        other => (importer, other),
    })
}

/// Gives the first LiDAR of a scene the beams of the sweep that it was imported from; their number, and the columns of a turn.
fn take_pattern(scene: &mut Scene) -> Option<[usize; 2]> {
    let first = scene.kept.sweeps.first()?.clone();
    let pattern = EditableSweep::new(first.clone(), &[]).pattern(scene.rig.lidars.first()?)?;
    let told = [pattern.elevations_deg.len(), pattern.columns as usize];
    let mut rig = SensorRig::clone(&scene.rig);
    rig.lidars[0] = pattern;
    if rig.problem().is_some() {
        return None;
    }
    scene.rig = Arc::new(rig);
    let mut before = Scene::clone(&first.before);
    before.rig = scene.rig.clone();
    let before = Arc::new(before);
    for sweep in &mut Arc::make_mut(&mut scene.kept).sweeps {
        Arc::make_mut(sweep).before = before.clone();
    }
    Some(told)
}

/// Moments of a drive that are looked at many times.
const FEW: usize = 6;
/// Share of the usual scores from which objects of these are followed.
const FEW_SHARE: f32 = 0.6;

/// What the network sees at a moment of a drive.
struct SeenMoment {
    time_s: f64,
    /// Objects, in the world frame.
    finds: Vec<Find>,
    ground: MomentGround,
}

/// The scene of a sweep or drive with the objects that the network finds in the sweeps and that are followed through them, and with the
/// ground as it sees it; the scene as it is if it has no sweeps without labels.
fn with_tracked(mut loaded: ImportedScene) -> ImportedScene {
    if loaded.moments() == 0 {
        return loaded;
    }
    let net = LidarPerceiver::bundled().map_err(|e| e.to_string());
    let seen = net.and_then(|net| {
        let moments = (0..loaded.moments()).into_par_iter();
        let seen = moments.filter_map(|number| seen(&loaded, &net, number).transpose());
        seen.collect::<Result<Vec<SeenMoment>, ModelError>>()
            .map_err(|e| e.to_string())
    });
    let seen = match seen {
        Ok(seen) => seen,
        Err(problem) => {
            loaded
                .notes
                .push(format!("no objects were looked for: {problem}"));
            return loaded;
        }
    };
    let times_s: Vec<f64> = seen.iter().map(|moment| moment.time_s).collect();
    let (finds, ground): (Vec<Vec<Find>>, Vec<MomentGround>) = seen
        .into_iter()
        .map(|moment| (moment.finds, moment.ground))
        .unzip();
    if loaded.knows_objects() {
        return loaded.with_ground(&ground);
    }
    let objects = tracks::objects(&finds, &times_s);
    if loaded.moments() > 1 {
        let moving = objects.iter().filter(|object| object.places.len() > 1).count();
        loaded.notes.push(format!(
            "objects found: {} that stand and {moving} that move, each a guess",
            objects.len() - moving
        ));
    }
    loaded.with_tracked(&objects, &ground)
}

/// What the network sees at a moment; `None` beyond the last.
fn seen(
    loaded: &ImportedScene,
    net: &LidarPerceiver,
    number: usize,
) -> Result<Option<SeenMoment>, ModelError> {
    let Some(moment) = loaded.moment(number) else {
        return Ok(None);
    };
    let seen = net.glance(&moment.returns, moment.sensor_m, number)?;
    // Few moments are looked at more closely.
    let objects = match loaded.moments() <= FEW && !loaded.knows_objects() {
        true if loaded.moments() == 1 => net.objects_of_sweep(&moment.returns, moment.sensor_m)?,
        true => net.objects_from(&moment.returns, moment.sensor_m, FEW_SHARE)?,
        false => seen.detections,
    };
    let ahead = (moment.world_from_vehicle.rotation * DVec3::X).truncate();
    let find = |d: &Detection| {
        let object = d.to_box(BoxId(0));
        Find {
            group: d.group,
            score: f64::from(d.score),
            at_m: moment.world_from_vehicle.apply(object.center_m).truncate(),
            size_m: object.size_m,
            yaw_rad: object.yaw_rad + ahead.to_angle(),
        }
    };
    let near = near(&moment.returns);
    let class = |(stands, near): (&Stands, bool)| {
        let class = stands.class();
        (near && class.is_ground()).then_some(class)
    };
    Ok(Some(SeenMoment {
        time_s: moment.time_s,
        finds: objects.iter().map(find).collect(),
        ground: seen.stands.iter().zip(near).map(class).collect(),
    }))
}

/// Columns of the window, `[x][y]`, that have a return within 1.2 m: the network guesses the others.
fn near(returns: &[[f32; 4]]) -> Vec<bool> {
    const REACH: usize = 3;
    let mut near = vec![false; Window::COLUMNS];
    for [x, y, ..] in returns {
        if let Some([x, y]) = Window::column_at(f64::from(*x), f64::from(*y)) {
            for x in x.saturating_sub(REACH)..(x + REACH + 1).min(Window::NX) {
                let ys = y.saturating_sub(REACH)..(y + REACH + 1).min(Window::NY);
                near[x * Window::NY..][ys].fill(true);
            }
        }
    }
    near
}

#[cfg(test)]
#[path = "drive_tests.rs"]
mod drive_tests;
#[cfg(test)]
#[path = "recorded_tests.rs"]
mod recorded_tests;
#[cfg(test)]
#[path = "read_tests.rs"]
mod tests;
