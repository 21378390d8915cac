//! A voxel patch as bytes: map, bricks, then the numbers of all voxels, their labels before, their labels after.

use scene::grid::{BrickPatch, VoxelPatch};
use scene::{Extent, Lattice};

/// Bit of the number of columns along x: a lattice follows the sizes. Without it the lattice is that of Occ3D.
const OF_LATTICE: u32 = 1 << 31;

/// Little-endian bytes of a patch. Numbers of voxels are differences to the one before in the brick.
pub(super) fn patch_to_bytes(patch: &VoxelPatch) -> Vec<u8> {
    let (extent, bricks) = (patch.extent(), patch.bricks());
    let mut out = Vec::with_capacity(24 + 6 * bricks.len() + 4 * patch.voxels());
    let [x, y] = extent.from();
    let lattice = extent.lattice();
    let marked = if lattice == Lattice::OCC3D { 0 } else { OF_LATTICE };
    let sizes = [extent.nx() as u32 | marked, extent.ny() as u32];
    out.extend([x, y].iter().flat_map(|v| v.to_le_bytes()));
    out.extend(sizes.iter().flat_map(|v| v.to_le_bytes()));
    if marked != 0 {
        out.extend(lattice.voxel_m().to_le_bytes());
        out.extend(lattice.bottom_m().to_le_bytes());
        let bins = [lattice.bins() as u32, lattice.lowered() as u32];
        out.extend(bins.iter().flat_map(|v| v.to_le_bytes()));
    }
    out.extend((bricks.len() as u32).to_le_bytes());
    for brick in bricks {
        out.extend(brick.brick.to_le_bytes());
        out.extend((brick.voxels.len() as u16).to_le_bytes());
    }
    for brick in bricks {
        let mut last = 0;
        for voxel in &brick.voxels {
            out.extend((voxel - last).to_le_bytes());
            last = *voxel;
        }
    }
    bricks.iter().for_each(|brick| out.extend(&brick.before));
    bricks.iter().for_each(|brick| out.extend(&brick.after));
    out
}

/// The patch in bytes of [`patch_to_bytes`]. Errors in one line.
pub(super) fn patch_from_bytes(bytes: &[u8]) -> Result<VoxelPatch, String> {
    let mut left = Left(bytes);
    let from = [left.u32()? as i32, left.u32()? as i32];
    let [nx, ny] = [left.u32()?, left.u32()?];
    let lattice = match nx & OF_LATTICE {
        0 => Lattice::OCC3D,
        _ => {
            let (voxel_m, bottom_m) = (left.f64()?, left.f64()?);
            let (bins, lowered) = (left.u32()? as usize, left.u32()? as usize);
            Lattice::new(voxel_m, bins, bottom_m)?.lowered_by(lowered)?
        }
    };
    let size = [(nx & !OF_LATTICE) as usize, ny as usize];
    let extent = Extent::over(lattice, from, size)?;
    let count = left.u32()? as usize;
    let heads = left.take(count, 6)?;
    let mut bricks: Vec<BrickPatch> = Vec::with_capacity(count);
    let mut sizes = Vec::with_capacity(count);
    for head in heads.as_chunks::<6>().0 {
        let [a, b, c, d, e, f] = *head;
        bricks.push(BrickPatch {
            brick: u32::from_le_bytes([a, b, c, d]),
            ..BrickPatch::default()
        });
        sizes.push(usize::from(u16::from_le_bytes([e, f])));
    }
    for (brick, size) in bricks.iter_mut().zip(&sizes) {
        let mut last = 0u16;
        for step in left.take(*size, 2)?.as_chunks::<2>().0 {
            let voxel = last.checked_add(u16::from_le_bytes(*step));
            last = voxel.ok_or("a voxel beyond its brick")?;
            brick.voxels.push(last);
        }
    }
    for (brick, size) in bricks.iter_mut().zip(&sizes) {
        brick.before = left.take(*size, 1)?.to_vec();
    }
    for (brick, size) in bricks.iter_mut().zip(&sizes) {
        brick.after = left.take(*size, 1)?.to_vec();
    }
    match left.0.is_empty() {
        true => VoxelPatch::new(extent, bricks),
        false => Err("more bytes than its bricks need".into()),
    }
}

/// Bytes that were not read yet.
struct Left<'a>(&'a [u8]);

impl<'a> Left<'a> {
    fn take(&mut self, count: usize, unit_bytes: usize) -> Result<&'a [u8], String> {
        let bytes = count.checked_mul(unit_bytes);
        let split = bytes.and_then(|bytes| self.0.split_at_checked(bytes));
        let (taken, left) = split.ok_or("cut short")?;
        self.0 = left;
        Ok(taken)
    }

    fn u32(&mut self) -> Result<u32, String> {
        let bytes = self.take(1, 4)?;
        Ok(u32::from_le_bytes([bytes[0], bytes[1], bytes[2], bytes[3]]))
    }

    fn f64(&mut self) -> Result<f64, String> {
        let bytes = self.take(1, 8)?.as_chunks::<8>().0;
        Ok(f64::from_le_bytes(bytes[0]))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use scene::VoxelGrid;

    #[test]
    fn a_patch_comes_back_and_no_cut_one_does() {
        comes_back(Lattice::OCC3D);
        comes_back(Lattice::new(0.125, 64, -3.16).expect("sound"));
    }

    fn comes_back(lattice: Lattice) {
        let extent = Extent::over(lattice, [-7, 3], [40, 20]).expect("sound");
        let before = VoxelGrid::over(extent);
        let mut after = before.clone();
        for (x, y, z, class) in [(0, 0, 0, 4), (0, 0, 7, 11), (39, 19, 15, 16), (17, 3, 2, 0)] {
            after.set(x, y, z, class);
        }
        let patch = VoxelPatch::between(&before, &after).expect("one map");
        let bytes = patch_to_bytes(&patch);
        assert_eq!(patch_from_bytes(&bytes), Ok(patch));
        for end in 0..bytes.len() {
            let problem = patch_from_bytes(&bytes[..end]).expect_err("cut");
            assert!(!problem.contains('\n'), "{problem}");
        }
        let mut longer = bytes.clone();
        longer.push(0);
        patch_from_bytes(&longer).expect_err("a byte too many");
        // Any byte may be another one: an error or another patch, never more than that.
        for at in 0..bytes.len() {
            for value in [0, 1, 127, 255] {
                let mut other = bytes.clone();
                other[at] = value;
                drop(patch_from_bytes(&other));
            }
        }
    }
}
