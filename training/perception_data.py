"""Frames of `sceneloom-worlds --kind perception` as training samples: pillars of a sweep, what stands in each column, centres and numbers of boxes.

Arrays of a shard: source u8 [N] (0 exact surfaces, 1 learned LiDAR, 2 exact over voxels), returns i32 [N], points i16 [N,P,3] (5 mm), intensity u8
[N,P], box_count i32 [N], boxes f32 [N,128,9] (centre, sizes, yaw, class, returns on it), standing u8 [N,200,200] (label, 17 unknown).
"""
import json
from pathlib import Path

import numpy as np
import torch

from models.lidar_perceiver import BOX, CELL_M, COLUMN_M, COLUMNS, GROUPS, HALF_M, pillars

DTYPES = {"U8": np.uint8, "U16": np.uint16, "I16": np.int16, "I32": np.int32, "F32": np.float32}
NAMES = ("source", "returns", "points", "intensity", "box_count", "boxes", "standing")
POINT_M = 0.005
IGNORED = 255
#              others, barrier, bicycle, bus, car, construction, motorcycle, pedestrian, cone, trailer, truck, drivable, flat, sidewalk, terrain, ...
STAND_OF = np.array([4, 8, 6, 5, 5, 5, 6, 7, 8, 5, 5, 0, 2, 1, 2, 4, 3, IGNORED], np.uint8)
GROUP_OF = np.array([-1, 4, 3, 1, 0, 1, 3, 2, 4, 1, 1] + [-1] * 7)
CELLS = COLUMNS // 2


def mapped(path, names=NAMES, kind="perception"):
    """The arrays of a shard by name, memory-mapped."""
    with open(path, "rb") as f:
        length = int.from_bytes(f.read(8), "little")
        header = json.loads(f.read(length))
    if any(n not in header for n in names):
        raise SystemExit(f"{path}: expected the arrays of `sceneloom-worlds --kind {kind}`: {', '.join(names)}")
    return {n: np.memmap(path, DTYPES[header[n]["dtype"]], "r", 8 + length + header[n]["data_offsets"][0], tuple(header[n]["shape"]))
            for n in names}


class PerceptionFrames:
    """All frames of some folders, memory-mapped; `limit` takes the first ones."""

    def __init__(self, *folders, limit=None):
        self.folders, self.limit, self.known, self.index = [Path(f) for f in folders], limit, set(), []
        self.rescan()
        if not self.index:
            raise SystemExit(f"{', '.join(map(str, folders))}: no shard_*.safetensors with frames in it")

    def rescan(self):
        """Adds shards that were written since."""
        for path in (p for folder in self.folders for p in sorted(folder.glob("shard_*.safetensors"))):
            if path in self.known or len(self.index) == self.limit:
                continue
            self.known.add(path)
            arrays = mapped(path)
            self.index += [(arrays, i) for i in range(len(arrays["source"]))]
            self.index = self.index[: self.limit]

    def __len__(self):
        return len(self.index)

    def pick(self, rng):
        """A random frame."""
        return int(rng.integers(len(self)))

    def read(self, frame):
        """points f32 [P,4] (m, echo strength), boxes f32 [K,9], what stands u8 [200,200] (255 unknown), source."""
        arrays, i = self.index[frame]
        n, k = int(arrays["returns"][i]), int(arrays["box_count"][i])
        points = np.empty((n, 4), np.float32)
        points[:, :3] = arrays["points"][i, :n] * np.float32(POINT_M)
        points[:, 3] = arrays["intensity"][i, :n]
        return points, np.array(arrays["boxes"][i, :k]), STAND_OF[arrays["standing"][i]], int(arrays["source"][i])


class Mixed(PerceptionFrames):
    """Several sets of frames, each as likely as the others however large it is."""

    def __init__(self, parts):
        self.index, self.starts = [], [0]
        for part in parts:
            self.index += part.index
            self.starts.append(len(self.index))

    def pick(self, rng):
        part = rng.integers(len(self.starts) - 1)
        return int(rng.integers(self.starts[part], self.starts[part + 1]))


def mirrored(points, boxes, standing, symmetry):
    """One of the 8 symmetries of the top view, of all alike."""
    points, boxes = points.copy(), boxes.copy()
    if symmetry & 1:
        points[:, 0], boxes[:, 0], boxes[:, 6], standing = -points[:, 0], -boxes[:, 0], np.pi - boxes[:, 6], standing[::-1]
    if symmetry & 2:
        points[:, 1], boxes[:, 1], boxes[:, 6], standing = -points[:, 1], -boxes[:, 1], -boxes[:, 6], standing[:, ::-1]
    if symmetry & 4:
        points[:, :2], boxes[:, :2], boxes[:, 6] = points[:, 1::-1].copy(), boxes[:, 1::-1].copy(), np.pi / 2 - boxes[:, 6]
        standing = standing.T
    return points, boxes, np.ascontiguousarray(standing)


def disturbed(points, rng):
    """What differs from one vehicle to the next: echo strength (or none), how it stands, and echoes that are lost."""
    points = points.copy()
    points[:, 3] = 0 if rng.random() < 0.1 else np.clip(points[:, 3] * rng.uniform(0.7, 1.4), 0, 255)
    points[:, 2] += rng.normal(0, 0.05) + rng.normal(0, 0.004, 2) @ points[:, :2].T
    if rng.random() < 0.5:
        points = points[rng.random(len(points)) > rng.uniform(0, 0.4)]
    return points


def asked_for(boxes):
    """Boxes whose class has a group and whose centre lies in the window: [K,9] and their groups; those without a return are not asked for."""
    group = GROUP_OF[boxes[:, 7].astype(int)]
    keep = (group >= 0) & (np.abs(boxes[:, :2]) < HALF_M).all(1)
    return boxes[keep], group[keep]


def targets(boxes):
    """Boxes [K,9] -> heat f32 [5,100,100] (1 at a centre; less than 0 where a box without a return would be: not asked for), numbers
    [10,100,100], and their weights [100,100]."""
    heat, numbers, weight = np.zeros((len(GROUPS), CELLS, CELLS), np.float32), np.zeros((BOX, CELLS, CELLS), np.float32), np.zeros((CELLS, CELLS), np.float32)
    boxes, groups = asked_for(boxes)
    order = np.argsort(boxes[:, 8] > 0, kind="stable")
    for (cx, cy, cz, l, w, h, yaw, _, returns), group in zip(boxes[order], groups[order]):
        at = np.array([cx, cy]) / CELL_M + CELLS / 2
        x, y = np.floor(at).astype(int)
        spread = np.clip(0.25 * np.sqrt(l * w) / CELL_M, 0.6, 1.6)
        reach = int(np.ceil(3 * spread))
        xs, ys = (np.arange(max(0, c - reach), min(CELLS, c + reach + 1)) for c in (x, y))
        part = np.ix_(xs, ys)
        hill = np.exp(-((xs[:, None] - x) ** 2 + (ys - y) ** 2) / (2 * spread**2)).astype(np.float32)
        if returns == 0:
            heat[group][part] = np.where(hill > 0.2, -1, heat[group][part])
            continue
        heat[group][part] = np.where(heat[group][part] < 0, hill, np.maximum(heat[group][part], hill))
        for i in range(max(0, x - 1), min(CELLS, x + 2)):
            for j in range(max(0, y - 1), min(CELLS, y + 2)):
                near = float(np.exp(-((i - x) ** 2 + (j - y) ** 2) / (2 * spread**2)))
                if near > weight[i, j]:
                    weight[i, j] = near
                    numbers[:, i, j] = (at[0] - i - 0.5, at[1] - j - 0.5, cz, np.log(l), np.log(w), np.log(h),
                                        np.cos(2 * yaw), np.sin(2 * yaw), np.cos(yaw), np.sin(yaw))
    return heat, numbers, weight


def cut(rng, boxes, side):
    """Corner (columns, even) of a square of `side` columns: three of four times around a box of a random group that has returns."""
    boxes, groups = asked_for(boxes)
    boxes, groups = boxes[boxes[:, 8] > 0], groups[boxes[:, 8] > 0]
    if len(boxes) and rng.random() < 0.75:
        box = boxes[rng.choice(np.flatnonzero(groups == rng.choice(np.unique(groups))))]
        corner = (box[:2] + HALF_M) / COLUMN_M - rng.uniform(0.15, 0.85, 2) * side
    else:
        corner = rng.uniform(0, COLUMNS - side, 2)
    return np.clip(corner, 0, COLUMNS - side).astype(int) // 2 * 2


def sample(frames, rng, frame=None, side=COLUMNS):
    """A frame as tensors: pillars [19,200,200], what stands [200,200], heat, numbers, weights. Without `frame` a random one, disturbed, and of it a
    square of `side` columns."""
    points, boxes, standing, _ = frames.read(frames.pick(rng) if frame is None else frame)
    if frame is None:
        points, boxes, standing = mirrored(disturbed(points, rng), boxes, standing, int(rng.integers(8)))
    x, y = cut(rng, boxes, side) if side < COLUMNS else (0, 0)
    if side < COLUMNS:
        low = np.array([x, y]) * COLUMN_M - HALF_M
        points = points[((points[:, :2] > low - 0.01) & (points[:, :2] < low + side * COLUMN_M + 0.01)).all(1)]
    fine = (..., slice(x, x + side), slice(y, y + side))
    cells = (..., slice(x // 2, (x + side) // 2), slice(y // 2, (y + side) // 2))
    return (pillars(torch.from_numpy(points))[fine], torch.from_numpy(standing)[fine[1:]],
            *(torch.from_numpy(part)[cells if part.ndim == 3 else cells[1:]] for part in targets(boxes)))


def batch(frames, rng, size, side=COLUMNS):
    return tuple(torch.stack(parts) for parts in zip(*(sample(frames, rng, side=side) for _ in range(size))))
