//! Semantic multi-plane images as SyntheOcc's encoder takes them. Li et al. 2024, arXiv 2410.00337, equations 1 to 3.
//!
//! SyntheOcc's code puts plane l at 0.2 (l + 1) m and has 256 planes. A pixel is a latent cell. Each plane holds the
//! class id of the voxel that it cuts, as a plain number, 0 if there is none. Channel 257 holds the first visible id.

use crate::{StableError, wrong};

/// The class of driveable surface.
const DRIVEABLE: u8 = 11;
/// Largest class id. Larger ids are lines on the road, which SyntheOcc's data does not have.
const LAST_CLASS: u8 = 16;
/// First id of a line on the road.
const LINES_FIRST: u8 = LAST_CLASS + 1;
/// Last id of a line on the road.
const LAST_LINE: u8 = 19;

/// Planes `first` to `end` (not included) of a latent cell that show `id`: 1 to 16 are classes of Occ3D, 17 to 19 lines
/// on the road, 0 is empty.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PlaneSpan {
    /// The cell: picture * rows * columns + row * columns + column.
    pub cell: usize,
    /// First plane.
    pub first: usize,
    /// The plane behind the last.
    pub end: usize,
    /// Id that is seen there.
    pub id: u8,
}

/// The numbers `[picture][channel][row][column]` for [`SemanticPlanes`](crate::SemanticPlanes), of pictures of `cells` latent cells
/// each. `channels` is [`Pipeline::plane_channels`](crate::Pipeline::plane_channels), one more than there are planes.
/// Lines on the road become driveable surface. Errors if a run lies outside or its id is too large.
pub fn of_runs(
    pictures: usize,
    cells: usize,
    channels: usize,
    runs: impl IntoIterator<Item = PlaneSpan>,
) -> Result<Vec<f32>, StableError> {
    let planes = channels.saturating_sub(1);
    if planes == 0 {
        return Err(wrong("channels of planes", channels, "2 or more"));
    }
    let mut out = vec![0.0; pictures * channels * cells];
    let mut nearest = vec![planes; pictures * cells];
    for run in runs {
        let PlaneSpan { cell, first, end, id } = run;
        if cell >= nearest.len() || first > end || end > planes {
            let expected = format!("{} cells and {planes} planes", nearest.len());
            return Err(wrong("run of planes", format!("{run:?}"), expected));
        }
        let id = match id {
            0..=LAST_CLASS => id,
            LINES_FIRST..=LAST_LINE => DRIVEABLE,
            _ => return Err(wrong("id of a run of planes", id, format!("0 to {LAST_LINE}"))),
        };
        if id == 0 || first == end {
            continue;
        }
        let (picture, at) = (cell / cells * channels, cell % cells);
        for plane in first..end {
            out[(picture + plane) * cells + at] = f32::from(id);
        }
        if first < nearest[cell] {
            nearest[cell] = first;
            out[(picture + planes) * cells + at] = f32::from(id);
        }
    }
    Ok(out)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn runs_fill_their_planes_and_the_nearest_is_seen_first() {
        let run = |cell, first, end, id| PlaneSpan { cell, first, end, id };
        let runs = [
            run(0, 2, 4, 15),
            run(0, 0, 1, 4),
            run(3, 1, 2, 18),
            run(2, 0, 4, 0),
            run(1, 3, 3, 5),
        ];
        // Two pictures of two cells, four planes.
        let ids = of_runs(2, 2, 5, runs).expect("ids");
        let first = [4.0, 0.0, 0.0, 0.0, 15.0, 0.0, 15.0, 0.0, 4.0, 0.0];
        let second = [0.0, 0.0, 0.0, 11.0, 0.0, 0.0, 0.0, 0.0, 0.0, 11.0];
        assert_eq!(ids, [first, second].concat());
        for wrong in [
            run(4, 0, 1, 1),
            run(0, 0, 5, 1),
            run(0, 2, 1, 1),
            run(0, 0, 1, 20),
        ] {
            assert!(of_runs(2, 2, 5, [wrong]).is_err(), "{wrong:?}");
        }
        assert!(of_runs(1, 1, 1, []).is_err());
    }
}
