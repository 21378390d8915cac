# packages: plyfile==1.1.5 numpy
# A scene_gaussians.ply through plyfile: the properties that splat viewers read by name, and ours after them.
import json
import sys
from importlib.metadata import version

import numpy as np
from plyfile import PlyData


def fail(line):
    print(f"gaussians-ply: {line}", file=sys.stderr)
    sys.exit(1)


vertices = PlyData.read(sys.argv[1])["vertex"]
names = [p.name for p in vertices.properties]
wanted = "x y z nx ny nz f_dc_0 f_dc_1 f_dc_2 opacity scale_0 scale_1 scale_2 rot_0 rot_1 rot_2 rot_3".split()
if names != wanted + ["class", "instance", "strength"]:
    fail(f"properties {names}")
v = vertices.data
numbers = np.stack([v[name] for name in wanted], axis=1).astype(np.float64)
if not np.isfinite(numbers).all():
    fail("numbers that are not finite")
turns = np.linalg.norm(numbers[:, 13:17], axis=1)
if abs(turns - 1).max() > 1e-3:
    fail(f"a quaternion of length {turns.max()}")
spreads = np.exp(numbers[:, 10:13])
alpha = 1 / (1 + np.exp(-numbers[:, 9]))
color = 0.5 + 0.28209479 * numbers[:, 6:9]
if not ((color > -2).all() and (color < 3).all()):
    fail(f"colours from {color.min()} to {color.max()}")
if v["class"].max() > 21:
    fail(f"class {v['class'].max()}, expected 0 to 21")
# The shortest axis is the normal: the third column of what the quaternion turns, where the third spread is the least.
third = spreads.argmin(axis=1) == 2
w, x, y, z = numbers[third, 13:17].T
axis = np.stack([2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y)], axis=1)
off = np.abs(axis - numbers[third, 3:6]).max(initial=0)
if off > 1e-3:
    fail(f"normals are off by {off}")
on_map = v["class"] != 0
print(
    json.dumps(
        {
            "reader": "plyfile",
            "version": version("plyfile"),
            "accepted": True,
            "read": {
                "gaussians": len(v),
                "classes": len(np.unique(v["class"])),
                "instances": len(np.unique(v["instance"])) - 1,
                "least_spread_m": round(float(spreads.min()), 4),
                "median_spread_m": round(float(np.median(spreads[on_map])), 4),
                "median_alpha": round(float(np.median(alpha)), 3),
            },
        }
    )
)
