"""Shards written by `sceneloom dataset occupancy`: shard_NNNNN.safetensors with u8 dense, labels, draft
[N,200,200,16], i32 bev and u8 heading [N,200,200], i32 observed [N,200,200] (a bit per voxel that the labelling drive observed, and bit 16
where that is known; all of it 0 in shards of before). Memory-mapped; one frame is read at a time. Or the newest of what
`sceneloom-worlds --stream` writes, which never touch a disk."""
import json
import queue
import shlex
import subprocess
import threading
from pathlib import Path

import numpy as np
import torch

GRIDS = {"dense": (200, 200, 16), "labels": (200, 200, 16), "draft": (200, 200, 16), "bev": (200, 200),
         "heading": (200, 200), "observed": (200, 200)}
DTYPES = {"U8": np.uint8, "I32": np.int32, "U32": np.uint32}


def arrays_of(header, where, array):
    """The arrays of a shard's header; `array` makes one of dtype, first byte after the header, and shape."""
    found = {}
    for name, shape in GRIDS.items():
        entry = header.get(name)
        if entry is None and name == "observed":
            count = header["dense"]["shape"][0] if "dense" in header else 0
            found[name] = np.broadcast_to(np.zeros((), np.int32), (count, *shape))
            continue
        if entry is None or tuple(entry["shape"][1:]) != shape or entry["dtype"] not in DTYPES:
            raise SystemExit(f"{where}: tensor {name}: expected [N, {shape}], found {entry}")
        found[name] = array(DTYPES[entry["dtype"]], entry["data_offsets"][0], tuple(entry["shape"]))
    return found


class Shard:
    """The frames of a file."""

    def __init__(self, path):
        self.path = Path(path)
        with open(path, "rb") as f:
            length = int.from_bytes(f.read(8), "little")
            header = json.loads(f.read(length))
        self.arrays = arrays_of(header, path, lambda dtype, at, shape: np.memmap(path, dtype, "r", 8 + length + at, shape))
        self.frames = len(self.arrays["dense"])


def listen(out, ready, parse):
    """Puts what a command writes into a queue: shards, each after its length (8 little-endian bytes), made into something by `parse`; None at the end."""
    try:
        while len(head := out.read(8)) == 8:
            data = out.read(length := int.from_bytes(head, "little"))
            if len(data) < length:
                break
            ready.put(parse(data))
    finally:
        ready.put(None)


class StreamedShard:
    """The frames of a shard that lies in memory."""

    path = None

    def __init__(self, data):
        length = int.from_bytes(data[:8], "little")

        def array(dtype, at, shape):
            return np.frombuffer(data, dtype, int(np.prod(shape)), 8 + length + at).reshape(shape)

        self.arrays = arrays_of(json.loads(data[8 : 8 + length]), "stream", array)
        self.frames = len(self.arrays["dense"])


class Frames:
    """All frames of a folder."""

    def __init__(self, folder):
        self.folder, self.known, self.index = Path(folder), set(), []
        self.rescan()
        if not self.index:
            raise SystemExit(f"{folder}: no shard_*.safetensors with frames in it")

    def rescan(self):
        """Adds shards that were written since; the numbers of the new frames."""
        before = len(self.index)
        for path in sorted(self.folder.glob("shard_*.safetensors")):
            if path not in self.known:
                shard = Shard(path)
                self.known.add(path)
                self.index += [(shard, i) for i in range(shard.frames)]
        return range(before, len(self.index))

    def __len__(self):
        return len(self.index)

    def at(self, frame):
        """(shard, place in it) of a frame's number. A pair is handed back: streamed frames change under their numbers, and
        who reads twice holds on to the pair."""
        return frame if isinstance(frame, tuple) else self.index[frame]

    def read(self, frame, name, part=()):
        """An array of a frame, or the part of it at two slices; `given` is the draft with the background in it."""
        shard, i = self.at(frame)
        if name == "given":
            return with_background(shard.arrays["draft"][(i, *part)], shard.arrays["dense"][(i, *part)])
        return shard.arrays[name][(i, *part)]


class Streamed(Frames):
    """The newest `keep` frames of a command that writes shards to its output, each after its length (8 little-endian
    bytes). It is read ahead by a few shards and waits meanwhile; when it ends, what is there stays."""

    AHEAD = 16  # shards

    def __init__(self, command, keep=768):
        self.keep, self.index, self.oldest = keep, [], 0
        self.ready = queue.Queue(self.AHEAD)
        process = subprocess.Popen(shlex.split(command), stdout=subprocess.PIPE)
        threading.Thread(target=listen, args=(process.stdout, self.ready, StreamedShard), daemon=True).start()
        first = self.ready.get()
        if first is None:
            raise SystemExit(f"{command}: ended with code {process.wait()} before its first shard")
        self._take(first)

    def _take(self, shard):
        """Adds the frames of a shard; once there are enough of them, in place of the oldest."""
        taken = []
        for i in range(shard.frames):
            if len(self.index) < self.keep:
                taken.append(len(self.index))
                self.index.append((shard, i))
            else:
                taken.append(self.oldest)
                self.index[self.oldest] = (shard, i)
                self.oldest = (self.oldest + 1) % self.keep
        return taken

    def rescan(self):
        """Takes in what has come since; the numbers of the new frames."""
        taken = []
        for _ in range(self.ready.qsize()):
            shard = self.ready.get()
            if shard is None:
                self.ready.put(None)  # it has ended, and stays so
                break
            taken += self._take(shard)
        return taken


BACKGROUND = (15, 16)  # manmade, vegetation
FIRST_GROUND = 11  # classes below are objects


def with_background(draft, dense):
    """A draft with what stands beside the road, but for what its objects hide."""
    stands = ((dense == BACKGROUND[0]) | (dense == BACKGROUND[1])) & (draft >= FIRST_GROUND)
    return np.where(stands, dense, draft)


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
        self.frames = frames
        self.found = [[] for _ in range(self.OBJECTS)]  # per class: (frame, x, y)
        self.add(range(len(frames)))

    def add(self, new):
        """Looks at frames that are new, or others than before under the same number."""
        known = set(new)
        found = [[p for p in places if p[0] not in known] for places in self.found]
        for frame in new:
            rng = np.random.default_rng(frame)
            grid = self.frames.read(frame, "dense")
            at = np.flatnonzero(grid < self.OBJECTS)
            label = grid.reshape(-1)[at]
            for c in np.unique(label):
                columns = np.unique(at[label == c] // 16)
                for column in rng.choice(columns, min(len(columns), self.PER_FRAME), replace=False):
                    found[c].append((frame, column // 200, column % 200))
        self.found = found

    def crop(self, rng, names, side, anywhere):
        """The same square [side,side] of several arrays of a random frame: with probability `anywhere` at a random place, else around a voxel of
        a random object class. Its corner lies anywhere, not on the latent's cells: more variety for nothing."""
        classes = [f for f in self.found if f]
        if rng.random() < anywhere or not classes:
            frame, x, y = rng.integers(len(self.frames)), rng.integers(200), rng.integers(200)
        else:
            places = classes[rng.integers(len(classes))]
            frame, x, y = places[rng.integers(len(places))]
        x, y = (int(np.clip(v - rng.integers(side // 8, side - side // 8), 0, 200 - side)) for v in (x, y))
        return tuple(self.frames.read(frame, name, (slice(x, x + side), slice(y, y + side))) for name in names)


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


def draw_masks(rng, batch, whole=0.4):
    """Edit masks [B,50,50]: a share of them all ones, else one to four rectangles, as small as a box or as large as a block."""
    masks = np.zeros((batch, 50, 50), np.float32)
    for mask in masks:
        if rng.random() < whole:
            mask[:] = 1
            continue
        for _ in range(rng.integers(1, 5)):
            size = np.exp(rng.uniform(np.log(2), np.log(30), 2)).astype(int)
            at = [rng.integers(0, 50 - s + 1) for s in size]
            mask[at[0] : at[0] + size[0], at[1] : at[1] + size[1]] = 1
    return masks


def draw_given(rng, batch):
    """Where the two groups of the background are given [B,50,50,2]: both everywhere for four frames in ten, none for two; of the others
    each group everywhere, nowhere, or in or outside of some rectangles."""
    flags = np.zeros((batch, 50, 50, 2), np.float32)
    for flag in flags:
        u = rng.random()
        if u < 0.4:
            flag[:] = 1
        elif u > 0.6:
            mask = draw_masks(rng, 1, whole=0)[0]
            for group in range(2):
                flag[..., group] = (0, 1, mask, 1 - mask)[rng.integers(4)]
    return flags
