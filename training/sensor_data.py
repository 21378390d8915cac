"""Frames of `sceneloom-worlds --kind sensors` as training samples: pillars of a sweep, what the segmenter sees in six pictures put on voxels, and all voxels.

Arrays of a shard: those of `perception_data.py`, rgb u8 [N,6,h,w,3], intrinsic f32 [N,6,3,3] (px), map_from_camera f32 [N,6,4,4], dense u8 [N,200,200,16].
"""
import json

import numpy as np
import torch

from models.lidar_perceiver import COLUMN_M, COLUMNS, HALF_M, pillars
from models.segmenter import Segmenter, SegmenterConfig
from models.sensor_occupancy import UNSEEN, painted, ways
from perception_data import NAMES, POINT_M, asked_for, disturbed, mapped
from picture_data import as_pictures
from safetensors import safe_open
from safetensors.torch import load_file

MORE = ("rgb", "intrinsic", "map_from_camera", "dense")
ARMS = {"both": (True, True), "LiDAR": (True, False), "cameras": (False, True)}  # which sensors are heard


def load_segmenter(path):
    """The judge of pictures, f16 or f32."""
    with safe_open(path, "pt") as f:
        config = json.loads(f.metadata()["config"])
    net = Segmenter(SegmenterConfig(**{k: tuple(tuple(x) if isinstance(x, list) else x for x in v) for k, v in config.items()}))
    net.load_state_dict({k: v.float() for k, v in load_file(path).items()})
    return net.eval().requires_grad_(False)


class SensorFrames:
    """All frames of a folder. What the segmenter sees is painted once, and kept beside each shard."""

    def __init__(self, folder, segmenter, limit=None):
        self.folder, self.segmenter, self.limit, self.known, self.index = folder, segmenter, limit, set(), []
        self.rescan()
        if not self.index:
            raise SystemExit(f"{folder}: no shard_*.safetensors with frames in it")

    def rescan(self):
        """Adds shards that were written since."""
        for path in sorted(self.folder.glob("shard_*.safetensors")):
            if path in self.known or len(self.index) == self.limit:
                continue
            self.known.add(path)
            arrays = mapped(path, (*NAMES, *MORE), "sensors")
            kept = path.with_suffix(".painted.npy")
            if not kept.exists():
                part = kept.with_suffix(".part.npy")
                np.save(part, self.paint(arrays))
                part.rename(kept)
            arrays["painted"] = np.load(kept, mmap_mode="r")
            self.index += [(arrays, i) for i in range(len(arrays["source"]))]
            self.index = self.index[: self.limit]

    @torch.no_grad()
    def paint(self, arrays):
        """u8 [N,200,200,16]."""
        out = []
        for rgb, intrinsic, pose in zip(arrays["rgb"], arrays["intrinsic"], arrays["map_from_camera"]):
            shown = self.segmenter(as_pictures(torch.from_numpy(np.array(rgb)))).argmax(1).to(torch.uint8)
            out.append(painted(shown, torch.from_numpy(np.array(intrinsic)), torch.from_numpy(np.array(pose))).numpy())
        return np.stack(out)

    def __len__(self):
        return len(self.index)

    def read(self, frame):
        """points f32 [P,4], boxes f32 [K,9], painted u8 [200,200,16], dense u8 [200,200,16]."""
        arrays, i = self.index[frame]
        n, k = int(arrays["returns"][i]), int(arrays["box_count"][i])
        points = np.empty((n, 4), np.float32)
        points[:, :3] = arrays["points"][i, :n] * np.float32(POINT_M)
        points[:, 3] = arrays["intensity"][i, :n]
        return points, np.array(arrays["boxes"][i, :k]), np.array(arrays["painted"][i]), np.array(arrays["dense"][i])


def mirrored(points, centres, grids, symmetry):
    """One of the 8 symmetries of the top view, of all alike."""
    points, centres = points.copy(), centres.copy()
    if symmetry & 1:
        points[:, 0], centres[:, 0], grids = -points[:, 0], -centres[:, 0], [g[::-1] for g in grids]
    if symmetry & 2:
        points[:, 1], centres[:, 1], grids = -points[:, 1], -centres[:, 1], [g[:, ::-1] for g in grids]
    if symmetry & 4:
        points[:, :2], centres[:, :2], grids = points[:, 1::-1].copy(), centres[:, 1::-1].copy(), [g.transpose(1, 0, 2) for g in grids]
    return points, centres, grids


def corner(rng, centres, side):
    """Corner (columns, even) of a square of `side` columns: three of four times around an object, as likely anywhere else."""
    at = rng.uniform(0, COLUMNS - side, 2)
    if len(centres) and rng.random() < 0.75:
        at = (centres[rng.integers(len(centres))] + HALF_M) / COLUMN_M - rng.uniform(0.15, 0.85, 2) * side
    return np.clip(at, 0, COLUMNS - side).astype(int) // 2 * 2


def sample(frames, rng, side, alone):
    """A square of a random frame, disturbed: pillars [19,s,s], ways [2,s,s], painted u8 [s,s,16], dense u8 [s,s,16]. With a likelihood of `alone` only one of
    the sensors is heard."""
    points, boxes, *grids = frames.read(int(rng.integers(len(frames))))
    boxes, _ = asked_for(boxes)
    points, centres, (paint, dense) = mirrored(disturbed(points, rng), boxes[:, :2], grids, int(rng.integers(8)))
    lidar, cameras = ARMS["both"] if rng.random() >= alone else list(ARMS.values())[rng.integers(1, 3)]
    x, y = corner(rng, centres, side)
    cut = (slice(x, x + side), slice(y, y + side))
    return heard(points, paint, lidar, cameras, cut) + (torch.from_numpy(dense[cut].copy()),)


def heard(points, paint, lidar, cameras, cut=(slice(None), slice(None))):
    """Pillars, ways and painted classes of a frame, silent where a sensor is."""
    low = np.array([part.start or 0 for part in cut]) * COLUMN_M - HALF_M
    if cut[0].start is not None:
        points = points[((points[:, :2] > low - 0.01) & (points[:, :2] < low + (cut[0].stop - cut[0].start) * COLUMN_M + 0.01)).all(1)]
    pillar = pillars(torch.from_numpy(points if lidar else points[:0]))
    paint = torch.from_numpy(paint[cut].copy())
    return pillar[(slice(None), *cut)], ways()[(slice(None), *cut)], paint if cameras else torch.full_like(paint, UNSEEN)


def batch(frames, rng, size, side, alone):
    return tuple(torch.stack(parts) for parts in zip(*(sample(frames, rng, side, alone) for _ in range(size))))
