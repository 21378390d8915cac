# packages: numpy==2.3.5
"""A frame of Occ3D-Waymo as its loaders take it: `voxel_label` with 23 for free."""
import json
import sys

import numpy as np


def fail(line):
    print(f"occ3d-waymo: {line}", file=sys.stderr)
    sys.exit(1)


def main(path):
    with np.load(path, allow_pickle=False) as arrays:
        labels = arrays["voxel_label"]
    if labels.dtype != np.uint8 or labels.shape != (200, 200, 16):
        fail(f"voxel_label: {labels.dtype} {labels.shape}, expected uint8 (200, 200, 16)")
    if not np.isin(labels, [*range(15), 23]).all():
        fail(f"labels {np.unique(labels)}, expected 0 to 14 and 23")
    read = {"occupied": int((labels != 23).sum()), "labels": {int(c): int(n) for c, n in zip(*np.unique(labels, return_counts=True))}}
    print(json.dumps({"reader": "numpy", "version": np.__version__, "accepted": True, "read": read}))


main(sys.argv[1])
