"""python3 benches/seams.py BEFORE.loom AFTER.loom: whether a map that was generated window by window shows where windows meet.

For each line between two rows of columns: the share of voxels that differ from their neighbour across it. Prints the median over
all lines before and after, and the lines that grew most. A seam would stand out there, at a border between windows."""
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


def main(before, after):
    grids = occupancy(before), occupancy(after)
    for axis, name in enumerate("xy"):
        a, b = (across(grid, axis) for grid in grids)
        grown = np.argsort(a - b)[:3]
        lines = ", ".join(f"{i + 1} ({a[i]:.2%} to {b[i]:.2%})" for i in grown)
        print(f"across {name}: median {np.median(a):.2%} to {np.median(b):.2%}; most at columns {lines}")


if __name__ == "__main__":
    main(*sys.argv[1:3])
