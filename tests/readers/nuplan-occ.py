# packages: numpy==2.3.5
"""A list of voxels as Nuplan-Occ's loaders scatter it into a grid: x, y, z, label in cells of 0.25 m around the vehicle."""
import json
import sys

import numpy as np

GRID = np.array([400, 400, 32])


def fail(line):
    print(f"nuplan-occ: {line}", file=sys.stderr)
    sys.exit(1)


def main(path):
    with np.load(path, allow_pickle=False) as arrays:
        rows = arrays[arrays.files[0]]
    if rows.ndim != 2 or rows.shape[1] != 4 or not np.issubdtype(rows.dtype, np.integer):
        fail(f"{rows.dtype} {rows.shape}, expected whole numbers in rows of four")
    cells, labels = rows[:, :3], rows[:, 3]
    if cells.min() < 0 or (cells >= GRID).any():
        fail(f"cells from {cells.min(axis=0)} to {cells.max(axis=0)}, expected below {GRID}")
    dense = np.full(GRID, 255, dtype=np.uint8)
    dense[tuple(cells.T)] = labels
    if np.count_nonzero(dense != 255) != len(rows):
        fail(f"{len(rows)} rows of {np.count_nonzero(dense != 255)} cells, expected a cell once")
    read = {"rows": len(rows), "labels": {int(c): int(n) for c, n in zip(*np.unique(labels, return_counts=True))}}
    print(json.dumps({"reader": "numpy", "version": np.__version__, "accepted": True, "read": read}))


main(sys.argv[1])
