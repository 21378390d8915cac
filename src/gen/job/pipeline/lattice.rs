//! Jobs on maps of another lattice than the networks': done on the same scene in the networks' voxels. What the networks
//! changed there is put back into the map; all else stays as finely as it was.

use std::borrow::Cow;
use std::sync::Arc;

use crate::contract::{GenError, GenResult, Job, JobCtx, JobUpdate};
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

/// Runs a job in the networks' lattice and gives its previews and its result in the lattice of the map.
pub(super) fn resampled(
    job: &Job,
    inner: &Job,
    ctx: &JobCtx<'_>,
    run: impl FnOnce(&Job, &JobCtx<'_>) -> Result<GenResult, GenError>,
) -> Result<GenResult, GenError> {
    let (fine, coarse) = (job.scene.for_generation(), inner.scene.for_generation());
    let back = |result: &GenResult| GenResult {
        key: job.key(),
        occupancy: put_back(fine.frame(), coarse.frame(), &result.occupancy),
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
    let source = &fine.frame().source.occupancy;
    out.report.voxels_changed = source.count_different(&out.occupancy);
    out.report.notes.push(format!(
        "the networks worked in voxels of {} m on this map of {}; what they changed is as coarse as theirs",
        Lattice::OCC3D.voxel_m(),
        fine.frame().extent().lattice()
    ));
    Ok(out)
}

/// The labels of a map after a result in the networks' lattice. Where that equals the draft or the source in its own voxels,
/// the map's draft or source stays; elsewhere a voxel has the label at its middle. Painted voxels stay.
fn put_back(fine: &Frame, coarse: &Frame, result: &VoxelGrid) -> VoxelGrid {
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
        if column == coarse.occupancy.column(i, j) {
            continue;
        }
        if column == coarse.source.occupancy.column(i, j) {
            if draft.column(x, y) != source.column(x, y) {
                out.column_mut(x, y).copy_from_slice(source.column(x, y));
            }
            continue;
        }
        raise(of_lattice, column, &mut new);
        raise(of_lattice, coarse.occupancy.column(i, j), &mut was_draft);
        raise(of_lattice, coarse.source.occupancy.column(i, j), &mut was_source);
        raise(lattice, draft.column(x, y), &mut drafted);
        raise(lattice, source.column(x, y), &mut kept);
        for (z, bin) in bins.iter().enumerate() {
            kept[z] = match *bin {
                Some(bin) if new[bin] == was_draft[bin] => drafted[z],
                Some(bin) if new[bin] != was_source[bin] => new[bin],
                Some(_) => kept[z],
                None => drafted[z],
            };
        }
        lower(lattice, &mut kept);
        out.column_mut(x, y).copy_from_slice(&kept[..extent.nz()]);
    }
    for (x, y, z, class) in fine.painted.iter_set() {
        out.set(x, y, z, class);
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use scene::{BevLayout, Extent, Scene};

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

    #[test]
    fn what_the_networks_leave_stays_as_fine_as_it_was() {
        let scene = fine();
        let coarse = scene.in_lattice(Lattice::OCC3D);
        let (before, of) = (scene.frame(), coarse.frame());
        assert_eq!(put_back(before, of, &of.occupancy), before.occupancy);
        // Ground of Occ3D is in bin 0 of its labels, and a voxel above it is a voxel of 0.4 m.
        let mut result = of.occupancy.clone();
        let [i, j] = result.extent().column_at(10.1, 10.1).expect("inside");
        assert_eq!(result.get(i, j, 0), Class::DriveableSurface.id());
        (1..=4).for_each(|z| result.set(i, j, z, Class::Car.id()));
        let after = put_back(before, of, &result);
        let differ = before.occupancy.count_different(&after);
        // Two voxels of a metre and a half at true heights: bins 3 and 4 of 0.4 m, four columns of 0.2 m in each.
        let cars = after.class_counts()[usize::from(Class::Car.id())];
        assert_eq!((cars, differ), (16, 16));
        let low = after
            .iter_set()
            .filter(|(.., l)| *l == Class::Car.id())
            .map(|(_, _, z, _)| z);
        assert_eq!(low.min(), Some(17));
    }
}
