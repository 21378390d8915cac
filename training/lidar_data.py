"""Shards of `sceneloom dataset lidar` as training samples: a wedge of a scene, rays in it, positions along them."""
import json
from pathlib import Path

import numpy as np
import torch

from models.lidar import FREE, LOWER_M, SHAPE, VOXEL_M, Sites, lookup_of, physical, surface

NEAR_M, STEP_M, SPACING_M, GROUND_WEIGHT = 1.0, 0.1, 0.2, 0.4
DTYPES = {"U8": np.uint8, "U16": np.uint16, "F32": np.float32}
NAMES = ("dense", "labels", "range", "intensity", "echo", "class", "incidence", "origin", "rotation", "elevations")
VEGETATION = 16


class LidarFrames:
    """All frames of a folder, memory-mapped."""

    def __init__(self, folder):
        self.index = []
        for path in sorted(Path(folder).glob("shard_*.safetensors")):
            with open(path, "rb") as f:
                length = int.from_bytes(f.read(8), "little")
                header = json.loads(f.read(length))
            if any(n not in header for n in NAMES):
                raise SystemExit(f"{path}: expected the arrays of `dataset lidar`: {', '.join(NAMES)}")
            arrays = {n: np.memmap(path, DTYPES[header[n]["dtype"]], "r", 8 + length + header[n]["data_offsets"][0],
                                   tuple(header[n]["shape"])) for n in NAMES}
            self.index += [(arrays, i) for i in range(len(arrays["dense"]))]
        if not self.index:
            raise SystemExit(f"{folder}: no shard_*.safetensors with frames in it")
        self.surfaces = {}

    def surface(self, frame, kind):
        """Surface voxels of a frame and their classes; made once."""
        if (frame, kind) not in self.surfaces:
            arrays, i = self.index[frame]
            coords, classes = surface(physical(np.array(arrays[kind][i])))
            self.surfaces[frame, kind] = coords.astype(np.int16), classes
        coords, classes = self.surfaces[frame, kind]
        return coords.astype(np.int64), classes

    def __len__(self):
        return len(self.index)

    def read(self, frame):
        arrays, i = self.index[frame]
        return {n: np.array(a[i]) for n, a in arrays.items() if n not in ("dense", "labels")}


def directions(frame):
    """Unit directions [beams, columns, 3] in the ego frame."""
    beams, columns = frame["range"].shape
    el, az = np.radians(frame["elevations"].astype(np.float64)), 2 * np.pi * np.arange(columns) / columns
    d = np.stack([np.cos(el)[:, None] * np.cos(az), np.cos(el)[:, None] * np.sin(az), np.repeat(np.sin(el)[:, None], columns, 1)], -1)
    return (d @ frame["rotation"].astype(np.float64).T).astype(np.float32)


def mirrored(coords, origin, d, symmetry):
    """One of the 8 symmetries of the top view, of voxels, origin and directions alike."""
    coords, origin, d = coords.copy(), origin.copy(), d.copy()
    if symmetry & 1:
        coords[:, 0], origin[0], d[..., 0] = SHAPE[0] - 1 - coords[:, 0], -origin[0], -d[..., 0]
    if symmetry & 2:
        coords[:, 1], origin[1], d[..., 1] = SHAPE[1] - 1 - coords[:, 1], -origin[1], -d[..., 1]
    if symmetry & 4:
        coords[:, :2], origin[:2], d[..., :2] = coords[:, 1::-1].copy(), origin[1::-1].copy(), d[..., 1::-1].copy()
    return coords, origin, d


def active_cells(coords, classes):
    """Density of samples in every cell between eight voxel centres, [201,201,17]: 0 where no corner is occupied, less
    where there is only ground."""
    occupied, things = np.zeros([n + 2 for n in SHAPE], bool), np.zeros([n + 2 for n in SHAPE], bool)
    occupied[tuple(coords.T + 1)] = True
    things[tuple(coords[(classes < 11) | (classes > 14)].T + 1)] = True
    some = lambda v: np.any([v[x : x + 201, y : y + 201, z : z + 17] for x in (0, 1) for y in (0, 1) for z in (0, 1)], 0)
    return np.where(some(things), 1.0, np.where(some(occupied), GROUND_WEIGHT, 0.0)).astype(np.float32)


def march(density, origin, d, rng, count):
    """Up to `count` sample positions along each ray, [R,count] rising and a mask: where a run of active cells begins,
    and at equal mass of the density inside it (the prior's PDF; the walk in Rust is exact, this one has steps of 0.1 m)."""
    steps = np.arange(NEAR_M, 62.0, STEP_M, dtype=np.float32)
    t = steps + (rng.random((len(d), 1)).astype(np.float32) - 0.5) * STEP_M
    q = ((origin - np.array(LOWER_M, np.float32)) / VOXEL_M + 0.5 + d[:, None] * (t[..., None] / VOXEL_M))
    at = np.floor(q).astype(np.int32)
    inside = ((at >= 0) & (at < density.shape)).all(-1)
    at = np.where(inside[..., None], at, 0)
    weight = density[at[..., 0], at[..., 1], at[..., 2]] * inside
    mass = np.floor(np.cumsum(weight, 1) * (STEP_M / SPACING_M) + rng.random((len(d), 1)))
    start = (weight > 0) & (np.pad(weight, ((0, 0), (1, 0)))[:, :-1] == 0)
    emit = (weight > 0) & ((np.diff(mass, axis=1, prepend=mass[:, :1]) > 0) | start)
    rank = np.cumsum(emit, 1) - 1
    keep = emit & (rank < count)
    out, valid = np.zeros((len(d), count), np.float32), np.zeros((len(d), count), bool)
    ray, step = np.nonzero(keep)
    out[ray, rank[ray, step]] = t[ray, step]
    valid[ray, rank[ray, step]] = True
    return out, valid, weight, t


def sample(frames, rng, wedge_deg=100.0, rays=900, count=36, near=6, kind=None, symmetry=None, frame=None):
    """A wedge of a frame as a dictionary of tensors."""
    frame = int(rng.integers(len(frames))) if frame is None else frame
    data = frames.read(frame)
    kind = kind or ("dense" if rng.random() < 0.5 else "labels")
    coords, classes = frames.surface(frame, kind)
    d = directions(data)
    symmetry = int(rng.integers(8)) if symmetry is None else symmetry
    coords, origin, d = mirrored(coords, data["origin"].astype(np.float32), d, symmetry)
    middle = rng.random() * 2 * np.pi
    turn = lambda x, y: np.abs((np.arctan2(y, x) - middle + np.pi) % (2 * np.pi) - np.pi)
    at = (coords + 0.5) * VOXEL_M + np.array(LOWER_M)
    rel = at[:, :2] - origin[:2]
    half = np.radians(wedge_deg) / 2
    reach = np.hypot(rel[:, 0], rel[:, 1])
    # Voxels beside the wedge's edge are what its rays' voxels see: 3 m of margin.
    use = (turn(rel[:, 0], rel[:, 1]) < half + 3.0 / np.maximum(reach, 1e-3)) | (reach < 4)
    order = np.flatnonzero(use)
    coords, classes = coords[order], classes[order]
    order = np.lexsort(coords.T[::-1])
    coords, classes = coords[order], classes[order]
    flat = lambda name: data[name].reshape(-1)
    d = d.reshape(-1, 3)
    inside = turn(d[:, 0], d[:, 1]) < half
    label = flat("class")
    chance = np.where(inside, np.where(label <= 10, 2.0, 1.0), 0.0)
    pick = rng.choice(len(d), size=min(rays, int(inside.sum())), replace=False, p=chance / chance.sum())
    d = d[pick]
    density = active_cells(coords, classes)
    t, valid, weight, fine = march(density, origin, d, rng, count)
    r = flat("range")[pick].astype(np.float32) * 0.002
    p = origin + d * r[:, None]
    within = (r > NEAR_M) & (np.abs(p[:, :2]) < 40).all(1) & (p[:, 2] < 5.4)
    # Can this surface be found at all? It must lie where there are features, and within the samples.
    cell = np.clip(np.round((r - fine[:, 0]) / STEP_M).astype(int), 0, fine.shape[1] - 1)
    supported = within & (weight[np.arange(len(d)), cell] > 0) & (r < np.where(valid.all(1), t[:, -1], 1e9))
    # Samples around the surface, wherever there are features.
    extra = r[:, None] + rng.normal(0, 0.25, (len(d), near)).astype(np.float32)
    cell = np.clip(np.round((extra - fine[:, :1]) / STEP_M).astype(int), 0, fine.shape[1] - 1)
    good = supported[:, None] & (extra > NEAR_M) & (np.take_along_axis(weight, cell, 1) > 0)
    t, valid = np.concatenate([t, extra], 1), np.concatenate([valid, good], 1)
    t = np.where(valid, t, 1e4)
    order = np.argsort(t, 1)
    t, valid = np.take_along_axis(t, order, 1), np.take_along_axis(valid, order, 1)
    cosine = flat("incidence")[pick].astype(np.float32) / 255
    cosine = np.where(label[pick] == VEGETATION, 0.7, np.maximum(cosine, 0.02))
    tensor = lambda a: torch.from_numpy(np.ascontiguousarray(a))
    sites = Sites(coords, classes)
    return {"sites": sites, "lookup": lookup_of(sites.volume), "origin": tensor(origin).expand(len(d), 3), "d": tensor(d), "t": tensor(t),
            "valid": tensor(valid), "r": tensor(r), "hit": tensor(supported), "empty": tensor(~within),
            "cos": tensor(cosine), "class": tensor(label[pick].astype(np.int64)), "echo": tensor(flat("echo")[pick].astype(np.int64)),
            "strength": tensor(np.sqrt(flat("intensity")[pick].astype(np.float32) / 255))}
