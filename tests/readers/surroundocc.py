# packages: numpy==2.3.5
"""A list of voxels as SurroundOcc's `LoadOccupancy` takes it: x, y, z, class as f32; 0 is ignored, and becomes 255. Its
evaluation turns indices into points of the LiDAR's frame (`voxel_to_vertices`: index * 0.5 + 0.25 + lower corner)."""
import json
import sys

import numpy as np

GRID = np.array([200, 200, 16])
LOW_M = np.array([-50.0, -50.0, -5.0])


def fail(line):
    print(f"surroundocc: {line}", file=sys.stderr)
    sys.exit(1)


def main(path):
    occ = np.load(path, allow_pickle=False)
    if occ.ndim != 2 or occ.shape[1] != 4:
        fail(f"shape {occ.shape}, expected rows of four")
    occ = occ.astype(np.float32)
    occ[..., 3][occ[..., 3] == 0] = 255
    cells, label = occ[:, :3].astype(np.int64), occ[:, 3].astype(np.int64)
    if cells.min() < 0 or (cells >= GRID).any():
        fail(f"cells from {cells.min(axis=0)} to {cells.max(axis=0)}, expected below {GRID}")
    if not np.isin(label, [*range(1, 17), 255]).all():
        fail(f"labels {np.unique(label)}, expected 1 to 16 and what is ignored")
    if len(np.unique(cells, axis=0)) != len(cells):
        fail("a cell twice")
    middle_m = cells * 0.5 + 0.25 + LOW_M
    road = middle_m[label == 11]
    read = {
        "rows": len(cells),
        "classes": {int(c): int(n) for c, n in zip(*np.unique(label, return_counts=True))},
        "middle_in_lidar_m": [round(float(v), 3) for v in middle_m.mean(axis=0)],
        "road_below_lidar_m": round(-float(np.median(road[:, 2])), 3) if len(road) else None,
    }
    print(json.dumps({"reader": "numpy", "version": np.__version__, "accepted": True, "read": read}))


main(sys.argv[1])
