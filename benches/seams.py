"""python3 benches/seams.py BEFORE.loom AFTER.loom: whether a map that was generated window by window shows where windows meet.

For each line between two rows of columns: the share of voxels that differ from their neighbour across it. Prints the median over
all lines before and after, and the lines that grew most. A seam would stand out there, at a border between windows.

Of what stands (all but ground) the IoU of both sides of a line, voxels of all lines together: where a seam between two windows ends,
and everywhere else."""
import json
import sys
import zipfile

import numpy as np


def occupancy(path):
    with zipfile.ZipFile(path) as file:
        extent = json.loads(file.read("scene.json"))["canvas"].get("extent") or {"columns": [200, 200]}
        labels = np.frombuffer(file.read("canvas/occupancy.u8"), np.uint8)
    return labels.reshape(*extent["columns"], 16)


def across(labels, axis):
    """Share of differing neighbours for each line across an axis."""
    moved = np.moveaxis(labels, axis, 0)
    return (moved[1:] != moved[:-1]).mean(axis=(1, 2))


GROUND = (11, 12, 13, 14)
FREE = 17
SIDE, SEAM, CELL = 50, 4, 4  # of src/gen/job/pipeline/plan.rs: window and half a seam in latent cells, columns of a cell


def seam_ends(path, axis):
    """Lines across an axis at which a seam ends, as `plan.rs` lays windows over a map."""
    with zipfile.ZipFile(path) as file:
        extent = json.loads(file.read("scene.json"))["canvas"].get("extent") or {"from": [-100, -100], "columns": [200, 200]}
    low, size = extent["from"][axis] + 100, extent["columns"][axis]
    first, end = low // CELL, (low + size + CELL - 1) // CELL
    count = -(-(end - first) // SIDE)
    at = [first + (end - first - SIDE) * n // max(count - 1, 1) for n in range(count)]
    borders = [(a + b + SIDE) // 2 for a, b in zip(at, at[1:])]
    return [CELL * (b + side) - low - 1 for b in borders for side in (-SEAM, SEAM)]


def standing_iou(labels, axis, lines):
    """Of the voxels that stand on either side of these lines, the share that stands on both with one class; and of all others."""
    moved = np.moveaxis(labels, axis, 0)
    stands = (moved != FREE) & ~np.isin(moved, GROUND)
    both = (stands[1:] & stands[:-1] & (moved[1:] == moved[:-1])).sum((1, 2))
    either = (stands[1:] | stands[:-1]).sum((1, 2))
    there = np.isin(np.arange(len(both)), lines)
    return [both[part].sum() / max(either[part].sum(), 1) for part in (there, ~there)]


def main(before, after):
    grids = occupancy(before), occupancy(after)
    for axis, name in enumerate("xy"):
        a, b = (across(grid, axis) for grid in grids)
        grown = np.argsort(a - b)[:3]
        lines = ", ".join(f"{i + 1} ({a[i]:.2%} to {b[i]:.2%})" for i in grown)
        if ends := seam_ends(after, axis):
            at_ends, elsewhere = standing_iou(grids[1], axis, ends)
            print(f"across {name}: IoU of what stands {at_ends:.3f} at the ends of {len(ends) // 2} seams, {elsewhere:.3f} elsewhere")
        print(f"across {name}: median {np.median(a):.2%} to {np.median(b):.2%}; most at columns {lines}")


if __name__ == "__main__":
    main(*sys.argv[1:3])
