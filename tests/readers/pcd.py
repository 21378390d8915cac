# packages: pypcd4==1.5.1 numpy
"""Reads lidar.pcd by pypcd4: every field by name, classes of Occ3D, the ground where the vehicle stands on it."""
import importlib.metadata
import json
import sys

import numpy as np
from pypcd4 import PointCloud

cloud = PointCloud.from_path(sys.argv[1])
fields = list(cloud.fields)
if fields != ["x", "y", "z", "intensity", "ring", "label", "time"]:
    sys.exit(f"fields {fields}")
points = cloud.numpy()
position, label, ring = points[:, :3], points[:, 5].astype(int), points[:, 4]
if not np.isfinite(points).all() or not np.isin(label, np.arange(17)).all():
    sys.exit("a number is not finite, or a label above 16")
road = position[(label == 11) & (np.linalg.norm(position[:, :2], axis=1) < 20)]
if len(road) and abs(np.median(road[:, 2])) > 0.3:
    sys.exit(f"the road lies at z = {np.median(road[:, 2]):.2f} m")
print(json.dumps({
    "reader": "pypcd4",
    "version": importlib.metadata.version("pypcd4"),
    "accepted": True,
    "read": {"points": cloud.points, "rings": int(ring.max()) + 1 if len(ring) else 0, "classes": len(np.unique(label))},
}))
