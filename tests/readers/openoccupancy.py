# packages: numpy==2.3.5
"""A list of voxels as OpenOccupancy's `LoadOccupancy` takes it: z, y, x, class; 0 is noise, and becomes 255."""
import json
import sys

import numpy as np

GRID = np.array([512, 512, 40])
LOW_M = np.array([-51.2, -51.2, -5.0])


def fail(line):
    print(f"openoccupancy: {line}", file=sys.stderr)
    sys.exit(1)


def main(path):
    pcd = np.load(path, allow_pickle=False)
    if pcd.ndim != 2 or pcd.shape[1] != 4 or not np.issubdtype(pcd.dtype, np.integer):
        fail(f"{pcd.dtype} {pcd.shape}, expected whole numbers in rows of four")
    label = pcd[..., -1:]
    label[label == 0] = 255
    cells = pcd[..., [2, 1, 0]]
    if cells.min() < 0 or (cells >= GRID).any():
        fail(f"cells from {cells.min(axis=0)} to {cells.max(axis=0)}, expected below {GRID}")
    if not np.isin(label, [*range(1, 17), 255]).all():
        fail(f"labels {np.unique(label)}, expected 1 to 16 and noise")
    middle_m = (cells + 0.5) * 0.2 + LOW_M
    dense = np.zeros(GRID, dtype=np.uint8)
    dense[tuple(cells.T)] = label[:, 0]
    if np.count_nonzero(dense) != len(cells):
        fail(f"{len(cells)} rows of {np.count_nonzero(dense)} cells, expected a cell once")
    road = middle_m[label[:, 0] == 11]
    read = {
        "rows": len(cells),
        "classes": {int(c): int(n) for c, n in zip(*np.unique(label, return_counts=True))},
        "middle_in_lidar_m": [round(float(v), 3) for v in middle_m.mean(axis=0)],
        "road_below_lidar_m": round(-float(np.median(road[:, 2])), 3) if len(road) else None,
    }
    print(json.dumps({"reader": "numpy", "version": np.__version__, "accepted": True, "read": read}))


main(sys.argv[1])
