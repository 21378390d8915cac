# packages: nuscenes-devkit==1.2.0
"""Reads the scans of all radars by nuscenes-devkit, with its usual filters; every return passes them."""
import importlib.metadata
import json
import sys
from pathlib import Path

import numpy as np
from nuscenes.utils.data_classes import RadarPointCloud

read = {}
for path in sorted(Path(sys.argv[1]).glob("*.pcd")):
    cloud = RadarPointCloud.from_file(str(path))
    header = path.read_bytes().split(b"DATA binary\n")[0].decode()
    count = int(header.split("POINTS ")[1].split()[0])
    x, y, z, moves, _, rcs, vx, vy, vx_comp, vy_comp = cloud.points[:10]
    if count != cloud.nbr_points() and not (count == 1 and cloud.nbr_points() == 0):
        sys.exit(f"{path.name}: the devkit keeps {cloud.nbr_points()} of {count} returns")
    if not np.isfinite(cloud.points).all():
        sys.exit(f"{path.name}: a number is not finite")
    # Speeds are along the ray.
    across = (x * vy - y * vx) / np.maximum(np.hypot(x, y), 1e-6)
    if len(x) and np.abs(across).max() > 0.05 * max(1.0, np.abs(np.hypot(vx, vy)).max()):
        sys.exit(f"{path.name}: a speed of {np.abs(across).max():.2f} m/s across the ray")
    read[path.stem] = {
        "returns": cloud.nbr_points(),
        "farthest_m": round(float(np.hypot(x, y).max(initial=0.0)), 1),
        "rcs_dbsm": [round(float(v), 1) for v in (rcs.min(initial=99.0), rcs.max(initial=-99.0))],
        "moving": int(np.isin(moves, [0, 2]).sum()),
    }
if not read or not any(radar["returns"] for radar in read.values()):
    sys.exit("no returns")
total = sum(radar["returns"] for radar in read.values())
print(json.dumps({
    "reader": "nuscenes-devkit",
    "version": importlib.metadata.version("nuscenes-devkit"),
    "accepted": True,
    "figure": f"{total} returns of {len(read)} radars",
    "read": read,
}))
