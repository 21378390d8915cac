"""Scenes that were written out -> shards as `sceneloom-worlds --kind perception` makes them, for training and judging a LiDAR perceiver.

python pack_perception.py batch FOLDER -o DIR       # what `sceneloom batch` wrote in the formats ply, boxes and occ3d
python pack_perception.py nuscenes FOLDER -o DIR    # tables of nuScenes (v1.0-*/, samples/), real or written by `sceneloom export --format nuscenes`
A frame needs a sweep (f*.ply; LIDAR_TOP), its boxes and what stands (labels.npz; of nuScenes gts/SCENE/SAMPLE/labels.npz where it is, else nothing is
known of the ground). A folder of Occ3D labels alone becomes scenes by `sceneloom import LABELS -o S.loom`, and those a batch.
"""
import argparse
import json
from pathlib import Path

import numpy as np
import torch
from safetensors.torch import save_file

CATEGORIES = {"movable_object.barrier": 1, "vehicle.bicycle": 2, "vehicle.bus": 3, "vehicle.car": 4, "vehicle.emergency": 4, "vehicle.construction": 5,
              "vehicle.motorcycle": 6, "human.pedestrian": 7, "movable_object.trafficcone": 8, "vehicle.trailer": 9, "vehicle.truck": 10}
NO_CLASS = ("human.pedestrian.stroller", "human.pedestrian.wheelchair", "human.pedestrian.personal_mobility")
TYPES = {"char": "i1", "int8": "i1", "uchar": "u1", "uint8": "u1", "short": "<i2", "int16": "<i2", "ushort": "<u2", "uint16": "<u2", "int": "<i4", "int32": "<i4",
         "uint": "<u4", "uint32": "<u4", "float": "<f4", "float32": "<f4", "double": "<f8", "float64": "<f8"}
HALF_M, POINT_M, BOXES, MARGIN_M, FREE, LOOK, PER_SHARD = 40.0, 0.005, 128, 0.3, 17, 5, 32
RANK = np.array([3, 4, 4, 4, 4, 4, 4, 4, 4, 4, 4, 1, 1, 1, 1, 3, 2, 0])  # what counts in a column; Rust twin: nets/perceiver/stands.rs
LEARNED = 1  # the source of such frames


def standing(labels):
    """u8 [200,200,16] -> of each column the label of what stands on its ground up to 2 m; 17 without any."""
    low = (labels != FREE).argmax(2)
    reach = np.minimum(low[..., None] + np.arange(LOOK + 1), labels.shape[2] - 1)
    near = np.take_along_axis(labels, reach, 2)
    best = RANK[near] * 10 + np.arange(LOOK + 1)  # of equals the highest
    return np.take_along_axis(near, best.argmax(2)[..., None], 2)[..., 0]


def read_ply(path):
    """Vertices of a binary little-endian PLY as a record array."""
    data = Path(path).read_bytes()
    end = data.index(b"end_header\n") + len(b"end_header\n")
    count, fields = 0, []
    for line in data[:end].decode().splitlines():
        words = line.split()
        if words[:2] == ["element", "vertex"]:
            count = int(words[2])
        elif words[:1] == ["element"] or words[:2] == ["property", "list"]:
            raise SystemExit(f"{path}: expected vertices alone, found {line}")
        elif words[:1] == ["property"]:
            fields.append((words[2], TYPES[words[1]]))
    return np.frombuffer(data, np.dtype(fields), count, end)


def window(points):
    """Of returns [P,4] those in the window."""
    return points[np.isfinite(points).all(1) & (np.abs(points[:, :2]) < HALF_M).all(1)]


def returns_on(box, points, classes):
    """How many returns of its class lie in or beside the footprint of a box (centre, sizes, yaw, class)."""
    d = points[classes == box[7], :2] - box[:2]
    c, s = np.cos(box[6]), np.sin(box[6])
    local = np.abs(np.stack([d[:, 0] * c + d[:, 1] * s, d[:, 1] * c - d[:, 0] * s], 1))
    return int((local <= box[3:5] / 2 + MARGIN_M).all(1).sum())


def labels_of(path):
    with np.load(path) as file:
        return standing(file["semantics"])


def of_batch(folder):
    """Frames (points [P,4], boxes [K,9], standing [200,200]) of every folder below that has a sweep, boxes and labels."""
    for ply in sorted(Path(folder).rglob("*.ply")):
        root = ply.parent.parent
        boxes, labels = next(root.rglob("boxes*.json"), None), next(root.rglob("labels.npz"), None)
        if boxes is None or labels is None:
            raise SystemExit(f"{ply}: expected the formats boxes and occ3d beside it in {root}")
        v = read_ply(ply)
        points = np.stack([v["x"], v["y"], v["z"], v["intensity"]], 1).astype(np.float32)
        rows = []
        for b in json.loads(boxes.read_text())["boxes"]:
            row = np.array([*b["center_m"], *b["size_m"], b["yaw_rad"], b["class_id"], 0], np.float32)
            row[8] = returns_on(row, points, v["class"])
            rows.append(row)
        yield points, np.array(rows, np.float32).reshape(-1, 9), labels_of(labels)


def pose(record):
    """4 x 4 matrix of a record with a rotation (w, x, y, z) and a translation."""
    w, x, y, z = record["rotation"]
    out = np.eye(4)
    out[:3, :3] = [[1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)], [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
                   [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)]]
    out[:3, 3] = record["translation"]
    return out


def class_of(category):
    """Label of a category of nuScenes; None without a class."""
    found = [c for name, c in CATEGORIES.items() if category.startswith(name)]
    return found[0] if found and not category.startswith(NO_CLASS) else None


def of_nuscenes(folder):
    """The same of the key frames of tables of nuScenes, in the ego frame at the moment of the sweep."""
    folder = Path(folder)
    tables = next(iter(sorted(folder.glob("v1.0-*"))), folder)
    root = tables.parent
    table = lambda name: json.loads((tables / f"{name}.json").read_text())
    by = {name: {r["token"]: r for r in table(name)} for name in ("sample", "calibrated_sensor", "ego_pose", "instance", "category", "scene")}
    notes = {}
    for a in table("sample_annotation"):
        notes.setdefault(a["sample_token"], []).append(a)
    for data in table("sample_data"):
        if not data["is_key_frame"] or "/LIDAR_TOP/" not in data["filename"]:
            continue
        raw = np.fromfile(root / data["filename"], "<f4").reshape(-1, 5)
        sensor, ego = by["calibrated_sensor"][data["calibrated_sensor_token"]], pose(by["ego_pose"][data["ego_pose_token"]])
        place = pose(sensor)
        points = np.concatenate([raw[:, :3] @ place[:3, :3].T + place[:3, 3], raw[:, 3:4]], 1).astype(np.float32)
        rows = []
        for a in notes.get(data["sample_token"], ()):
            label = class_of(by["category"][by["instance"][a["instance_token"]]["category_token"]]["name"])
            if label is None:
                continue
            there = np.linalg.inv(ego) @ pose(a)
            w, l, h = a["size"]
            rows.append([*there[:3, 3], l, w, h, np.arctan2(there[1, 0], there[0, 0]), label, a["num_lidar_pts"]])
        scene = by["scene"][by["sample"][data["sample_token"]]["scene_token"]]["name"]
        labels = root / "gts" / scene / data["sample_token"] / "labels.npz"
        known = labels_of(labels) if labels.exists() else np.full((200, 200), FREE, np.uint8)
        yield points, np.array(rows, np.float32).reshape(-1, 9), known


def shard(frames):
    """Frames as the arrays of a shard."""
    frames = [(window(p), b[(np.abs(b[:, :2]) < HALF_M).all(1)][:BOXES], s) for p, b, s in frames]
    most = max(len(p) for p, _, _ in frames)
    n = len(frames)
    points, strength, boxes = np.zeros((n, most, 3), np.int16), np.zeros((n, most), np.uint8), np.zeros((n, BOXES, 9), np.float32)
    for i, (p, b, _) in enumerate(frames):
        points[i, : len(p)] = np.clip(np.rint(p[:, :3] / POINT_M), -32767, 32767)
        strength[i, : len(p)] = np.clip(np.rint(p[:, 3]), 0, 255)
        boxes[i, : len(b)] = b
    count = lambda at: torch.tensor([len(f[at]) for f in frames], dtype=torch.int32)
    return {"source": torch.full((n,), LEARNED, dtype=torch.uint8), "returns": count(0), "points": torch.from_numpy(points),
            "intensity": torch.from_numpy(strength), "box_count": count(1), "boxes": torch.from_numpy(boxes),
            "standing": torch.from_numpy(np.stack([f[2] for f in frames]))}


def pack(frames, out):
    """Writes shards; how many frames."""
    out = Path(out)
    out.mkdir(parents=True, exist_ok=True)
    made, waiting = 0, []
    for frame in frames:
        waiting.append(frame)
        if len(waiting) == PER_SHARD:
            save_file(shard(waiting), out / f"shard_{made // PER_SHARD:05}.safetensors")
            made, waiting = made + PER_SHARD, []
    if waiting:
        save_file(shard(waiting), out / f"shard_{made // PER_SHARD:05}.safetensors")
    return made + len(waiting)


def main():
    p = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    p.add_argument("kind", choices=("batch", "nuscenes"))
    p.add_argument("folder", type=Path)
    p.add_argument("-o", "--output", type=Path, required=True)
    args = p.parse_args()
    made = pack({"batch": of_batch, "nuscenes": of_nuscenes}[args.kind](args.folder), args.output)
    if made == 0:
        raise SystemExit(f"{args.folder}: expected frames with a sweep, boxes and labels, found none")
    print(f"{args.output}: {made} frames")


if __name__ == "__main__":
    main()
