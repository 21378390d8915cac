//! Maps of another extent than the networks' window: the frame is cut to the window around the ego vehicle before a job,
//! and what the networks made of it is put back into the map after it.

use std::borrow::Cow;
use std::sync::Arc;

use crate::contract::{GenError, GenResult, Job, JobCtx, JobUpdate, RegionMode};
use scene::{Extent, VoxelGrid};

/// The same job with its frame cut to the window; `None` if the frame is the window.
pub(super) fn cut(job: &Job) -> Option<Job> {
    match job.scene.in_window() {
        Cow::Borrowed(_) => None,
        Cow::Owned(scene) => Some(Job {
            scene: Arc::new(scene),
            params: job.params.clone(),
        }),
    }
}

/// Why nothing can be generated on a map.
pub const BESIDE_THE_MAP: &str =
    "the networks generate 80 m around the ego vehicle, and none of that lies on this map";

/// Puts a result back: the map around the window stays as the frame shows it.
fn put_back(map: &VoxelGrid, result: &GenResult) -> GenResult {
    let mut occupancy = map.clone();
    occupancy.paste(&result.occupancy);
    GenResult {
        occupancy,
        ..result.clone()
    }
}

/// Runs a job on what stands still (and what moves and is a draft), in the window, previews and result put back into the map.
pub(super) fn in_window(
    job: &Job,
    ctx: &JobCtx<'_>,
    run: impl FnOnce(&Job, &JobCtx<'_>) -> Result<GenResult, GenError>,
) -> Result<GenResult, GenError> {
    let standing;
    let job = match job.scene.for_generation() {
        Cow::Borrowed(_) => job,
        Cow::Owned(scene) => {
            standing = Job {
                scene: Arc::new(scene),
                params: job.params.clone(),
            };
            &standing
        }
    };
    let Some(cut) = cut(job) else {
        return run(job, ctx);
    };
    let map = &job.scene.frame().occupancy;
    if job.params.region == RegionMode::Full && map.extent().overlap(&Extent::WINDOW).is_none() {
        return Err(GenError::failed(BESIDE_THE_MAP));
    }
    let report = |update: JobUpdate| match update {
        JobUpdate::Preview(result) => ctx.preview(put_back(map, &result)),
        other => ctx.report(other),
    };
    let stop = || ctx.check().is_err();
    let inner = JobCtx::new(&stop, &report);
    let inner = match ctx.previews() {
        true => inner.with_previews(),
        false => inner,
    };
    let mut result = put_back(map, &run(&cut, &inner)?);
    let beyond = job.params.inpaint.count_beyond_window();
    if beyond > 0 {
        result.report.notes.push(format!(
            "{beyond} of the cells to inpaint lie beyond the networks' window of 80 m and stay as they are"
        ));
    }
    Ok(result)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::contract::{GenParams, GenReport};
    use scene::{BevLayout, Class, Frame, Scene, SensorRig};

    #[test]
    fn the_window_changes_and_the_map_around_it_stays() {
        let extent = Extent::new([-150, -110], [480, 320]).expect("sound");
        let mut occupancy = VoxelGrid::over(extent);
        occupancy.set(400, 160, 3, Class::Manmade.id()); // 100 m ahead
        occupancy.set(150, 110, 0, Class::DriveableSurface.id()); // below the ego vehicle
        let frame = Frame::new(BevLayout::over(extent), Default::default(), occupancy.clone());
        let scene = Arc::new(Scene::single("map", frame, Arc::new(SensorRig::default()), 1));
        let params = GenParams::default();
        let job = Job { scene, params };
        let run = |job: &Job, ctx: &JobCtx<'_>| {
            let mut grid = job.scene.frame().occupancy.clone();
            assert_eq!((grid.extent(), grid.count_set()), (Extent::WINDOW, 1));
            grid.set(100, 100, 1, Class::Car.id());
            let result = GenResult {
                key: job.key(),
                occupancy: grid,
                report: GenReport::default(),
            };
            ctx.preview(result.clone());
            Ok(result)
        };
        let previews = std::sync::Mutex::new(Vec::new());
        let report = |update| {
            if let JobUpdate::Preview(result) = update {
                previews.lock().expect("not poisoned").push(result);
            }
        };
        let result = in_window(&job, &JobCtx::new(&|| false, &report), run).expect("runs");
        assert_eq!(
            (result.key.clone(), result.occupancy.count_different(&occupancy)),
            (job.key(), 1)
        );
        assert_eq!(result.occupancy.get(150, 110, 1), Class::Car.id());
        let previews = previews.into_inner().expect("not poisoned");
        assert_eq!(previews.len(), 1);
        assert_eq!(previews[0].occupancy, result.occupancy);
    }

    #[test]
    fn a_map_beside_the_window_is_not_generated() {
        let extent = Extent::new([300, 300], [40, 40]).expect("sound");
        let frame = Frame::new(
            BevLayout::over(extent),
            Default::default(),
            VoxelGrid::over(extent),
        );
        let scene = Arc::new(Scene::single("away", frame, Arc::new(SensorRig::default()), 1));
        let job = Job {
            scene,
            params: GenParams::whole_scene(),
        };
        let run = |_: &Job, _: &JobCtx<'_>| panic!("no network is asked");
        let error = in_window(&job, &JobCtx::detached(), run).expect_err("beside");
        assert_eq!(error.to_string(), BESIDE_THE_MAP);
    }
}
