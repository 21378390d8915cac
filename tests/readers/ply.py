# packages: plyfile==1.1.5 trimesh==5.2.0 numpy
"""Reads lidar.ply by plyfile and by trimesh; both see the same points."""
import importlib.metadata
import json
import sys

import numpy as np
import trimesh
from plyfile import PlyData

vertex = PlyData.read(sys.argv[1])["vertex"]
names = [p.name for p in vertex.properties]
for name in ["x", "y", "z", "intensity", "time_s", "ring", "class"]:
    if name not in names:
        sys.exit(f"no property {name} among {names}")
position = np.stack([vertex["x"], vertex["y"], vertex["z"]], axis=1)
if not np.isin(vertex["class"], np.arange(17)).all():
    sys.exit("a class above 16")
cloud = trimesh.load(sys.argv[1])
if not np.allclose(cloud.vertices, position, atol=1e-5):
    sys.exit("plyfile and trimesh read other points")
print(json.dumps({
    "reader": "plyfile, trimesh",
    "version": ", ".join(importlib.metadata.version(p) for p in ["plyfile", "trimesh"]),
    "accepted": True,
    "read": {"points": len(position), "classes": len(np.unique(vertex["class"]))},
}))
