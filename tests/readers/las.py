# packages: laspy[lazrs]==2.7.0 numpy
"""Reads lidar.las or lidar.laz by laspy: version, point format, both classes, extra bytes by name."""
import json
import sys

import laspy
import numpy as np

cloud = laspy.read(sys.argv[1])
header = cloud.header
if (str(header.version), header.point_format.id) != ("1.4", 6):
    sys.exit(f"LAS {header.version}, point format {header.point_format.id}")
extra = list(header.point_format.extra_dimension_names)
if extra != ["occ3d_class", "ring"]:
    sys.exit(f"extra bytes {extra}")
position, occ3d, asprs = cloud.xyz, np.asarray(cloud.occ3d_class), np.asarray(cloud.classification)
if len(position) and not (np.allclose(position.min(axis=0), header.mins) and np.allclose(position.max(axis=0), header.maxs)):
    sys.exit("the bounds of the header are not those of the points")
if not np.isin(occ3d, np.arange(17)).all():
    sys.exit("a class of Occ3D above 16")
for own, standard in [(11, 11), (15, 6), (13, 2), (14, 2), (4, 68)]:
    if not (asprs[occ3d == own] == standard).all():
        sys.exit(f"class {own} of Occ3D is not {standard} of the standard")
if not np.isin(asprs[occ3d == 16], [3, 4, 5]).all() or (np.asarray(cloud.gps_time) > 0).any():
    sys.exit("vegetation is not 3 to 5, or a time after the end of the sweep")
print(json.dumps({
    "reader": "laspy",
    "version": laspy.__version__,
    "accepted": True,
    "read": {"points": len(cloud.points), "compressed": bool(header.are_points_compressed), "classes": len(np.unique(asprs))},
}))
