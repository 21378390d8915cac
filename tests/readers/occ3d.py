# packages: numpy==2.3.5
"""labels.npz as the projects that train on Occ3D load it (`LoadOccGTFromFile`: `np.load(...)['semantics']`)."""
import json
import sys

import numpy as np


def fail(line):
    print(f"occ3d: {line}", file=sys.stderr)
    sys.exit(1)


def main(path):
    with np.load(path, allow_pickle=False) as labels:
        found = {name: labels[name] for name in labels.files}
    recipe = json.loads(found.pop("recipe").tobytes())
    if recipe["software"] != "sceneloom":
        fail(f"recipe of {recipe['software']}, expected sceneloom")
    if sorted(found) != ["mask_camera", "mask_lidar", "semantics"]:
        fail(f"arrays {sorted(found)}, expected semantics, mask_lidar, mask_camera")
    for name, array in found.items():
        if array.dtype != np.uint8 or array.shape != (200, 200, 16) or not array.flags.c_contiguous:
            fail(f"{name}: {array.dtype} {array.shape}, expected uint8 (200, 200, 16) in C order")
    semantics = found["semantics"]
    masks = {name: found[name].astype(bool) for name in ("mask_lidar", "mask_camera")}
    if semantics.max() > 17 or any(found[name].max() > 1 for name in masks):
        fail("a label above 17 or a mask above 1")
    occupied = semantics != 17
    voxels = np.argwhere(occupied)
    middle = (voxels.mean(axis=0) + 0.5) * 0.4 + [-40, -40, -1] if len(voxels) else np.zeros(3)
    read = {
        "occupied": int(occupied.sum()),
        "classes": {int(c): int(n) for c, n in zip(*np.unique(semantics[occupied], return_counts=True))},
        "middle_m": [round(float(v), 3) for v in middle],
        "observed": {name: int(mask.sum()) for name, mask in masks.items()},
        "occupied_and_seen_by_cameras": int((occupied & masks["mask_camera"]).sum()),
    }
    print(json.dumps({"reader": "numpy", "version": np.__version__, "accepted": True, "read": read}))


main(sys.argv[1])
