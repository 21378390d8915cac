//! Jobs on maps of another lattice than the networks': done on the same scene in the networks' voxels. What the networks
//! changed there is put back into the map; all else stays as finely as it was.

use std::borrow::Cow;
use std::sync::Arc;

use crate::contract::{GenError, GenParams, GenReport, GenResult, Job, JobCtx, JobUpdate, RegionMode};
use scene::draft::ground_bin;
use scene::grid::{lower, raise};
use scene::{Class, Frame, Lattice, VoxelGrid};

/// A job in the networks' lattice; `None` if it is of that one already.
pub(super) fn in_networks_lattice(job: &Job) -> Option<Job> {
    match job.scene.in_lattice(Lattice::OCC3D) {
        Cow::Borrowed(_) => None,
        Cow::Owned(scene) => Some(Job {
            scene: Arc::new(scene),
            params: job.params.clone(),
        }),
    }
}

/// True if the networks may add to the draft of a column: in a whole scene everywhere, in an edit where it changed the layout
/// or made the map larger. Around a box that comes or goes, walls and plants stay.
fn may_change(fine: &Frame, params: &GenParams, x: usize, y: usize) -> bool {
    params.region == RegionMode::Full
        || params.strength > 0.0
        || fine.layout.cell(x, y) != fine.source.layout.cell(x, y)
        || fine.is_new_ground(x, y)
}

/// True if the networks may add to no column, so that the draft is the result.
fn is_draft_the_result(fine: &Frame, params: &GenParams) -> bool {
    !fine
        .extent()
        .all_columns()
        .any(|[x, y]| may_change(fine, params, x, y))
}

/// Runs a job in the networks' lattice and gives its previews and its result in the lattice of the map. The networks run only
/// if they may change something.
pub(super) fn resampled(
    job: &Job,
    inner: &Job,
    ctx: &JobCtx<'_>,
    run: impl FnOnce(&Job, &JobCtx<'_>) -> Result<GenResult, GenError>,
) -> Result<GenResult, GenError> {
    let (fine, coarse) = (job.scene.for_generation(), inner.scene.for_generation());
    let source = &fine.frame().source.occupancy;
    if is_draft_the_result(fine.frame(), &job.params) {
        let occupancy = fine.frame().occupancy.clone();
        let report = GenReport {
            voxels_changed: source.count_different(&occupancy),
            ..GenReport::default()
        };
        return Ok(GenResult {
            key: job.key(),
            occupancy,
            report,
        });
    }
    let back = |result: &GenResult| GenResult {
        key: job.key(),
        occupancy: put_back(fine.frame(), coarse.frame(), &result.occupancy, &job.params),
        report: result.report.clone(),
    };
    let report = |update: JobUpdate| {
        ctx.report(match update {
            JobUpdate::Preview(result) => JobUpdate::Preview(Arc::new(back(&result))),
            other => other,
        });
    };
    let stop = || ctx.check().is_err();
    let with = JobCtx::new(&stop, &report);
    let with = if ctx.previews() {
        with.with_previews()
    } else {
        with
    };
    let result = run(inner, &with)?;
    let mut out = back(&result);
    out.report.voxels_changed = source.count_different(&out.occupancy);
    let coarse = fine.frame().occupancy.count_different(&out.occupancy);
    if coarse > 0 {
        out.report.notes.push(format!(
            "{coarse} voxels that the networks changed are as coarse as theirs of {} m, on this map of {}",
            Lattice::OCC3D.voxel_m(),
            fine.frame().extent().lattice()
        ));
    }
    Ok(out)
}

/// The labels of a map after a result in the networks' lattice. Where that equals the draft or the source in its own voxels,
/// the map's draft or source stays; elsewhere a voxel has the label at its middle. Painted voxels stay, and so do objects and
/// ground, which the draft has as finely as the map: of the result's ground only that in columns without any is taken. Columns
/// that the networks may not change ([`may_change`]) stay whole.
fn put_back(fine: &Frame, coarse: &Frame, result: &VoxelGrid, params: &GenParams) -> VoxelGrid {
    let (extent, of) = (fine.extent(), result.extent());
    let (lattice, of_lattice) = (extent.lattice(), of.lattice());
    let (draft, source) = (&fine.occupancy, &fine.source.occupancy);
    let mut out = draft.clone();
    // The bin of the networks that holds the middle of each bin of the map, both at true heights.
    let bin = |z: usize| {
        let height_m = lattice.bottom_m() + (z as f64 + 0.5) * lattice.voxel_m();
        let bin = ((height_m - of_lattice.bottom_m()) * of_lattice.per_m()).floor();
        (bin >= 0.0 && bin < of_lattice.true_bins() as f64).then_some(bin as usize)
    };
    let bins: Vec<Option<usize>> = (0..lattice.true_bins()).map(bin).collect();
    let [mut new, mut was_draft, mut was_source] =
        [(); 3].map(|()| vec![Class::FREE; of_lattice.true_bins()]);
    let [mut drafted, mut kept] = [(); 2].map(|()| vec![Class::FREE; lattice.true_bins()]);
    for [x, y] in extent.all_columns() {
        let p = extent.center(x, y, 0);
        let Some([i, j]) = of.column_at(p.x, p.y) else {
            continue;
        };
        let column = result.column(i, j);
        if column == coarse.occupancy.column(i, j) || !may_change(fine, params, x, y) {
            continue;
        }
        raise(of_lattice, column, &mut new);
        raise(of_lattice, coarse.occupancy.column(i, j), &mut was_draft);
        raise(of_lattice, coarse.source.occupancy.column(i, j), &mut was_source);
        raise(lattice, draft.column(x, y), &mut drafted);
        raise(lattice, source.column(x, y), &mut kept);
        for (z, bin) in bins.iter().enumerate() {
            let now = match *bin {
                Some(bin) if new[bin] == was_draft[bin] => drafted[z],
                Some(bin) if new[bin] != was_source[bin] => new[bin],
                Some(_) => kept[z],
                None => drafted[z],
            };
            kept[z] = if is_exact(now) || is_exact(drafted[z]) {
                drafted[z]
            } else {
                now
            };
        }
        if let Some(label) = new.iter().copied().find(|label| is_ground(*label))
            && !drafted.iter().any(|label| is_ground(*label))
        {
            let bin = ground_bin(&fine.layout, x, y) + lattice.lowered();
            if kept[bin] == Class::FREE {
                kept[bin] = label;
            }
        }
        lower(lattice, &mut kept);
        out.column_mut(x, y).copy_from_slice(&kept[..extent.nz()]);
    }
    for (x, y, z, class) in fine.painted.iter_set() {
        out.set(x, y, z, class);
    }
    out
}

fn is_ground(label: u8) -> bool {
    Class::from_id(label).is_some_and(Class::is_ground)
}

/// True for what a draft has as it is: objects and ground.
fn is_exact(label: u8) -> bool {
    Class::from_id(label).is_some_and(|class| class.is_ground() || class.is_object())
}

#[cfg(test)]
mod tests {
    use super::*;
    use scene::{BevLayer, BevLayout, Extent, Scene};

    /// A street in voxels of 0.2 m with a wall of one voxel, which 0.4 m cannot hold.
    fn fine() -> Scene {
        let lattice = Lattice::new(0.2, 40, -3.2).expect("sound");
        let extent = Extent::over(lattice, [-100, -100], [200, 200]).expect("sound");
        let mut grid = VoxelGrid::over(extent);
        for [x, y] in extent.all_columns() {
            grid.set(x, y, 16, Class::DriveableSurface.id());
        }
        (17..25).for_each(|z| grid.set(30, 40, z, Class::Manmade.id()));
        let frame = Frame::new(BevLayout::over(extent), Default::default(), grid);
        Scene::single("fine", frame, Arc::default(), 1)
    }

    /// Parameters of a whole scene, in which the networks may change all.
    fn anew() -> GenParams {
        GenParams::whole_scene()
    }

    #[test]
    fn what_the_networks_leave_stays_as_fine_as_it_was() {
        let scene = fine();
        let coarse = scene.in_lattice(Lattice::OCC3D);
        let (before, of) = (scene.frame(), coarse.frame());
        assert_eq!(put_back(before, of, &of.occupancy, &anew()), before.occupancy);
        // Ground of Occ3D is in bin 0 of its labels, and a voxel above it is a voxel of 0.4 m.
        let mut result = of.occupancy.clone();
        let [i, j] = result.extent().column_at(10.1, 10.1).expect("inside");
        assert_eq!(result.get(i, j, 0), Class::DriveableSurface.id());
        (1..=4).for_each(|z| result.set(i, j, z, Class::Vegetation.id()));
        let after = put_back(before, of, &result, &anew());
        let differ = before.occupancy.count_different(&after);
        // Two voxels of a metre and a half at true heights: bins 3 and 4 of 0.4 m, four columns of 0.2 m in each.
        let plants = after.class_counts()[usize::from(Class::Vegetation.id())];
        assert_eq!((plants, differ), (16, 16));
        // An edit that leaves the layout as it is adds no plants.
        let edited = put_back(before, of, &result, &GenParams::default());
        assert_eq!(edited, before.occupancy);
        let low = after
            .iter_set()
            .filter(|(.., l)| *l == Class::Vegetation.id())
            .map(|(_, _, z, _)| z);
        assert_eq!(low.min(), Some(17));
    }

    #[test]
    fn an_edit_of_boxes_asks_no_network_and_one_of_the_layout_does() {
        let mut scene = fine();
        scene.change_canvas(|frame| frame.occupancy.set(30, 60, 17, Class::Car.id()));
        let asked = |scene: Scene, params: GenParams| {
            let job = Job {
                scene: Arc::new(scene),
                params,
            };
            let inner = in_networks_lattice(&job).expect("of another lattice");
            let mut asked = false;
            let result = resampled(&job, &inner, &JobCtx::detached(), |inner, _| {
                asked = true;
                Ok(GenResult {
                    key: inner.key(),
                    occupancy: inner.scene.frame().occupancy.clone(),
                    report: GenReport::default(),
                })
            });
            let result = result.expect("runs");
            assert_eq!(result.occupancy, job.scene.frame().occupancy);
            (asked, result.report.voxels_changed)
        };
        assert_eq!(asked(scene.clone(), GenParams::default()), (false, 1));
        assert_eq!(asked(scene.clone(), anew()), (true, 1));
        let stronger = GenParams {
            strength: 0.5,
            ..GenParams::default()
        };
        assert_eq!(asked(scene.clone(), stronger), (true, 1));
        scene.change_canvas(|frame| frame.layout.set(BevLayer::Walkway, 50, 50, true));
        assert_eq!(asked(scene, GenParams::default()), (true, 1));
    }

    #[test]
    fn objects_and_ground_stay_as_the_draft_has_them() {
        let scene = fine();
        let coarse = scene.in_lattice(Lattice::OCC3D);
        let (before, of) = (scene.frame(), coarse.frame());
        let mut result = of.occupancy.clone();
        let [i, j] = result.extent().column_at(10.1, 10.1).expect("inside");
        // A car that no box stands for, and a hole in the road.
        (1..=4).for_each(|z| result.set(i, j, z, Class::Car.id()));
        result.set(i, j + 1, 0, Class::FREE);
        assert_eq!(put_back(before, of, &result, &anew()), before.occupancy);
        // A hole of the map is closed by one voxel where the result has ground.
        let mut open = (**before).clone();
        let [x, y] = open.extent().column_at(10.1, 10.1).expect("inside");
        open.occupancy.set(x, y, 16, Class::FREE);
        let mut raised = of.occupancy.clone();
        raised.set(i, j, 1, Class::DriveableSurface.id());
        let after = put_back(&open, of, &raised, &anew());
        assert_eq!(after, before.occupancy);
    }
}
