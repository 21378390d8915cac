# packages: nuscenes-devkit==1.2.0
"""Reads LIDAR_TOP.pcd.bin by nuscenes-devkit; it takes x, y, z and intensity of the five columns."""
import importlib.metadata
import json
import shutil
import sys
import tempfile

import numpy as np
from nuscenes.utils.data_classes import LidarPointCloud

# The devkit goes by the ending of the name.
with tempfile.TemporaryDirectory() as folder:
    path = shutil.copy(sys.argv[1], f"{folder}/scan.pcd.bin")
    cloud = LidarPointCloud.from_file(path)
columns = np.fromfile(sys.argv[1], dtype=np.float32).reshape(-1, 5)
if not np.array_equal(cloud.points, columns[:, :4].T):
    sys.exit("the devkit reads other points")
ring = columns[:, 4]
if not np.isfinite(columns).all() or (ring != ring.round()).any() or (ring < 0).any():
    sys.exit("a number is not finite, or a ring not whole")
print(json.dumps({
    "reader": "nuscenes-devkit",
    "version": importlib.metadata.version("nuscenes-devkit"),
    "accepted": True,
    "read": {"points": cloud.nbr_points(), "rings": len(np.unique(ring))},
}))
