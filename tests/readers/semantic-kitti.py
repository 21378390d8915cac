# packages: numpy==2.3.5
"""A folder of voxels as `SSCDataset` of semantic-kitti-api reads it: bits unpacked with the highest first, labels as u16, all
of 256 x 256 x 32; then the learning map of its configuration, which knows every id that may occur."""
import json
import sys
from pathlib import Path

import numpy as np

DIMS = (256, 256, 32)
LEARNING_MAP = {
    0: 0, 1: 0, 10: 1, 11: 2, 13: 5, 15: 3, 16: 5, 18: 4, 20: 5, 30: 6, 31: 7, 32: 8, 40: 9, 44: 10, 48: 11, 49: 12, 50: 13,
    51: 14, 52: 0, 60: 9, 70: 15, 71: 16, 72: 17, 80: 18, 81: 19, 99: 0, 252: 1, 253: 7, 254: 6, 255: 8, 256: 5, 257: 5, 258: 4,
    259: 5,
}


def fail(line):
    print(f"semantic-kitti: {line}", file=sys.stderr)
    sys.exit(1)


def unpack(path):
    packed = np.fromfile(path, dtype=np.uint8)
    bits = np.zeros(packed.shape[0] * 8, dtype=np.uint8)
    for i in range(8):
        bits[i::8] = packed >> (7 - i) & 1
    if not np.array_equal(bits, np.unpackbits(packed)):
        fail("unpacked otherwise than numpy does")
    return bits.reshape(DIMS).astype(bool)


def main(folder):
    voxels = Path(folder) / "sequences" / "00" / "voxels"
    names = sorted(p.name for p in voxels.iterdir())
    if names != [f"000000.{e}" for e in ("bin", "invalid", "label", "occluded")]:
        fail(f"files {names}, expected four of one frame")
    label = np.fromfile(voxels / "000000.label", dtype=np.uint16).reshape(DIMS)
    scan, invalid, occluded = (unpack(voxels / f"000000.{e}") for e in ("bin", "invalid", "occluded"))
    ids = np.unique(label)
    if not set(ids.tolist()) <= set(LEARNING_MAP):
        fail(f"ids {ids}, expected those of the configuration")
    train = np.vectorize(LEARNING_MAP.get)(ids)
    occupied = label != 0
    if (invalid & occupied).any():
        fail("a cell that is labelled and invalid")
    road = np.argwhere(label == 40)
    read = {
        "occupied": int(occupied.sum()),
        "ids": {int(i): int((label == i).sum()) for i in ids if i},
        "learning_classes": sorted({int(t) for t in train}),
        "scan": int(scan.sum()),
        "scan_in_labels": int((scan & occupied).sum()),
        "invalid": int(invalid.sum()),
        "occluded": int(occluded.sum()),
        "road_below_lidar_m": round(2.0 - 0.2 * (float(np.median(road[:, 2])) + 0.5), 3) if len(road) else None,
    }
    print(json.dumps({"reader": "numpy", "version": np.__version__, "accepted": True, "read": read}))


main(sys.argv[1])
