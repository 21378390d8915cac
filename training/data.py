"""Shards written by `sceneloom dataset occupancy`: shard_NNNNN.safetensors with u8 dense, labels, draft
[N,200,200,16], i32 bev and u8 heading [N,200,200]. Memory-mapped; one frame is read at a time."""
import json
import queue
import threading
from pathlib import Path

import numpy as np
import torch

GRIDS = {"dense": (200, 200, 16), "labels": (200, 200, 16), "draft": (200, 200, 16), "bev": (200, 200),
         "heading": (200, 200)}
DTYPES = {"U8": np.uint8, "I32": np.int32, "U32": np.uint32}


class Shard:
    def __init__(self, path):
        self.path = Path(path)
        with open(path, "rb") as f:
            length = int.from_bytes(f.read(8), "little")
            header = json.loads(f.read(length))
        self.arrays = {}
        for name, shape in GRIDS.items():
            entry = header.get(name)
            if entry is None or tuple(entry["shape"][1:]) != shape or entry["dtype"] not in DTYPES:
                raise SystemExit(f"{path}: tensor {name}: expected [N, {shape}], found {entry}")
            self.arrays[name] = np.memmap(path, DTYPES[entry["dtype"]], "r", 8 + length + entry["data_offsets"][0],
                                          tuple(entry["shape"]))
        self.frames = len(self.arrays["dense"])


class Frames:
    """All frames of a folder; `rescan` adds shards that were written since."""

    def __init__(self, folder):
        self.folder, self.shards, self.index = Path(folder), [], []
        self.rescan()
        if not self.index:
            raise SystemExit(f"{folder}: no shard_*.safetensors with frames in it")

    def rescan(self):
        known = {s.path for s in self.shards}
        for path in sorted(self.folder.glob("shard_*.safetensors")):
            if path not in known:
                self.shards.append(Shard(path))
                self.index += [(self.shards[-1], i) for i in range(self.shards[-1].frames)]

    def __len__(self):
        return len(self.index)

    def read(self, frame, name):
        shard, i = self.index[frame]
        return shard.arrays[name][i]


def turned(grid, symmetry):
    """One of the 8 symmetries of the top view: 0..3 quarter turns, then a mirror image for 4..7."""
    grid = np.rot90(grid, symmetry % 4, (0, 1))
    return np.ascontiguousarray(grid[:, ::-1] if symmetry >= 4 else grid)


def turned_heading(heading, symmetry):
    """A grid of headings (0 none, else 1 + 240ths of a turn) in one of the 8 symmetries, its angles turned with it:
    `turned` maps x to rows and y to columns, so a quarter turn of the array is one of the ego frame."""
    turn = heading.astype(np.int64) - 1 + 60 * (symmetry % 4)
    if symmetry >= 4:
        turn = -turn  # columns are y
    return turned(np.where(heading > 0, 1 + turn % 240, 0).astype(np.uint8), symmetry)


FREE, DRIVABLE = 17, 1  # label; bit of the layout
LOW = 8  # man-made things that stay below this bin, 2.2 m above the ground, are clutter
SPREAD = (2.0, 1.6, 6.0)  # so that ordinary worlds fill most of 0 to 1


def named(grid, bev):
    """[vegetation, building, clutter, completeness] of a frame, each 0 to 1. The first three: root of the share of
    columns off the road that hold any, times `SPREAD`; the last: share of columns that hold anything. Rust twin:
    scene/density.rs."""
    off_road = (bev & DRIVABLE) == 0
    n = max(1, int(off_road.sum()))
    high = (grid[:, :, LOW:] == 15).any(-1)
    manmade = (grid == 15).any(-1)
    clutter = (manmade & ~high) | (grid == 0).any(-1)
    shares = [(grid == 16).any(-1), high, clutter]
    return [min(1.0, k * float(np.sqrt((s & off_road).sum() / n))) for k, s in zip(SPREAD, shares)] + [float((grid != FREE).any(-1).mean())]


STEEPEST = 0.08  # of the planes that `leaned` puts frames on
LOWERED, RAISED = -1.5, 3.5  # bins


def leaned(rng, grid):
    """The same labels on other ground: whole columns moved up or down to a plane. Worlds have relief of their own, but real
    vehicles pitch, roll and stand higher or lower than a grid supposes."""
    nx, ny, height = grid.shape
    grade = rng.uniform(-STEEPEST, STEEPEST, 2)  # bins per column: voxels are cubes
    x, y = np.ogrid[:nx, :ny]
    plane = grade[0] * (x - rng.integers(nx)) + grade[1] * (y - rng.integers(ny)) + rng.uniform(LOWERED, RAISED)
    source = np.arange(height) - np.rint(plane).astype(np.int64)[..., None]
    inside = (source >= 0) & (source < height)
    moved = np.take_along_axis(grid, source.clip(0, height - 1), 2)
    return np.where(inside, moved, np.uint8(FREE))


class Places:
    """Where objects stand, so that crops can be drawn around them as often as around anything else."""

    PER_FRAME = 12  # columns that are kept per frame and class
    OBJECTS = 11  # `others` and the ten object classes

    def __init__(self, frames):
        self.frames, self.read = frames, 0
        self.found = [[] for _ in range(self.OBJECTS)]  # per class: (frame, x, y)
        self.rescan()

    def rescan(self):
        """Adds frames that were written since."""
        rng = np.random.default_rng(self.read)
        for frame in range(self.read, len(self.frames)):
            grid = self.frames.read(frame, "dense")
            at = np.flatnonzero(grid < self.OBJECTS)
            label = grid.reshape(-1)[at]
            for c in np.unique(label):
                columns = np.unique(at[label == c] // 16)
                for column in rng.choice(columns, min(len(columns), self.PER_FRAME), replace=False):
                    self.found[c].append((frame, column // 200, column % 200))
        self.read = len(self.frames)

    def crop(self, rng, kind, side, anywhere):
        """u8 [side,side,16] from a random frame: with probability `anywhere` at a random place, else around a voxel of
        a random object class. Its corner lies anywhere, not on the latent's cells: more variety for nothing."""
        classes = [f for f in self.found if f]
        if rng.random() < anywhere or not classes:
            frame, x, y = rng.integers(len(self.frames)), rng.integers(200), rng.integers(200)
        else:
            places = classes[rng.integers(len(classes))]
            frame, x, y = places[rng.integers(len(places))]
        x, y = (int(np.clip(v - rng.integers(side // 8, side - side // 8), 0, 200 - side)) for v in (x, y))
        return self.frames.read(frame, kind)[x : x + side, y : y + side]


def as_tensor(grids):
    """Frames to one batch; u32 bits become i32, which torch can shift."""
    batch = np.stack(grids)
    return torch.from_numpy(batch.view(np.int32) if batch.dtype == np.uint32 else batch)


def prefetch(make, depth=3):
    """Endless batches made by one background thread."""
    ready = queue.Queue(depth)

    def work():
        try:
            while True:
                ready.put(make())
        except BaseException as error:  # hand it to the consumer, who would wait forever otherwise
            ready.put(error)

    threading.Thread(target=work, daemon=True).start()
    while True:
        batch = ready.get()
        if isinstance(batch, BaseException):
            raise batch
        yield batch


def draw_masks(rng, batch):
    """Edit masks [B,50,50]: 40 % all ones, else one to four rectangles, as small as a box or as large as a block."""
    masks = np.zeros((batch, 50, 50), np.float32)
    for mask in masks:
        if rng.random() < 0.4:
            mask[:] = 1
            continue
        for _ in range(rng.integers(1, 5)):
            size = np.exp(rng.uniform(np.log(2), np.log(30), 2)).astype(int)
            at = [rng.integers(0, 50 - s + 1) for s in size]
            mask[at[0] : at[0] + size[0], at[1] : at[1] + size[1]] = 1
    return masks
