# packages: pykitti==0.3.1 opencv-python-headless numpy
"""Reads a sequence of KITTI: scans, calibration and poses by pykitti; labels as semantic-kitti-api does
(auxiliary/laserscan.py, SemLaserScan); objects as the object development kit does (readLabels.m, computeBox3D.m), each
compared with the labelled points in its box."""
import importlib.metadata
import json
import pathlib
import sys
import tempfile

import numpy as np
import pykitti

folder = pathlib.Path(sys.argv[1]).resolve()
# Numbers of config/semantic-kitti.yaml.
KNOWN = [0, 1, 10, 11, 13, 15, 16, 18, 20, 30, 31, 32, 40, 44, 48, 49, 50, 51, 52, 60, 70, 71, 72, 80, 81, 99, *range(252, 260)]

with tempfile.TemporaryDirectory() as base:
    base = pathlib.Path(base)
    (base / "sequences").mkdir()
    (base / "sequences/00").symlink_to(folder)
    (base / "poses").mkdir()
    (base / "poses/00.txt").symlink_to(folder / "poses.txt")
    data = pykitti.odometry(str(base), "00")
    scans = [data.get_velo(i) for i in range(len(data))]
calibration, poses = data.calib, data.poses
if len(poses) != len(data.timestamps) or not np.allclose(poses[0], np.eye(4)):
    sys.exit("poses and times do not belong together, or the first pose is another")
if len(scans) != len(list((folder / "velodyne").glob("*.bin"))):
    sys.exit("scans and times do not belong together")

objects = points_in_objects = 0
for i, scan in enumerate(scans):
    label = np.fromfile(folder / f"labels/{i:06d}.label", dtype=np.uint32).reshape(-1)
    if label.shape[0] != scan.shape[0]:
        sys.exit(f"scan {i}: {label.shape[0]} labels for {scan.shape[0]} points")
    semantic, instance = label & 0xFFFF, label >> 16
    if not ((semantic + (instance << 16)) == label).all() or not np.isin(semantic, KNOWN).all():
        sys.exit(f"scan {i}: labels {np.unique(semantic)}")
    if not ((scan[:, 3] >= 0) & (scan[:, 3] <= 1)).all():
        sys.exit(f"scan {i}: remission beyond 0 to 1")
    path = folder / f"label_2/{i:06d}.txt"
    if not path.exists():
        continue
    # The object development kit: P2 * R0_rect * Tr_velo_to_cam * point.
    lines = dict(line.split(":", 1) for line in (folder / f"calib/{i:06d}.txt").read_text().splitlines())
    matrix = {key: np.array(value.split(), dtype=float) for key, value in lines.items()}
    rect_from_velo = matrix["Tr_velo_to_cam"].reshape(3, 4)
    if not np.allclose(rect_from_velo, calibration.T_cam0_velo[:3]) or not np.allclose(matrix["P2"].reshape(3, 4), calibration.P_rect_20):
        sys.exit("calib.txt and calib/ do not agree")
    in_rect = scan[:, :3] @ rect_from_velo[:, :3].T + rect_from_velo[:, 3]
    for line in path.read_text().splitlines():
        words = line.split()
        truncated, occluded, alpha, *rectangle = map(float, words[1:8])
        h, w, l, x, y, z, rotation_y = map(float, words[8:])
        if len(words) != 15 or not -np.pi <= rotation_y <= np.pi or occluded not in (0, 1, 2) or not 0 <= truncated <= 1:
            sys.exit(f"scan {i}: {line}")
        c, s = np.cos(rotation_y), np.sin(rotation_y)
        turn = np.array([[c, 0, s], [0, 1, 0], [-s, 0, c]])
        corners = turn @ np.array([
            [l / 2, l / 2, -l / 2, -l / 2, l / 2, l / 2, -l / 2, -l / 2],
            [0, 0, 0, 0, -h, -h, -h, -h],
            [w / 2, -w / 2, -w / 2, w / 2, w / 2, -w / 2, -w / 2, w / 2],
        ]) + np.array([[x], [y], [z]])
        pixels = matrix["P2"].reshape(3, 4) @ np.vstack([corners, np.ones(8)])
        if (pixels[2] > 0.1).all() and truncated == 0:
            pixels = pixels[:2] / pixels[2]
            found = [*pixels.min(axis=1), *pixels.max(axis=1)]
            if not np.allclose(found, rectangle, atol=1.5):
                sys.exit(f"scan {i}: rectangle {rectangle}, projected {found}")
        local = (in_rect - [x, y, z]) @ turn
        inside = (abs(local[:, 0]) < l / 2 + 0.3) & (abs(local[:, 2]) < w / 2 + 0.3) & (local[:, 1] < -0.3) & (local[:, 1] > -h - 0.3)
        if inside.sum() >= 20:
            numbers = {"Car": [10, 252], "Truck": [18, 258], "Pedestrian": [30, 254], "Cyclist": [11, 253],
                       "Misc": [13, 15, 20, 255, 257, 259]}[words[0]]
            share = np.isin(semantic[inside], numbers).mean()
            if share < 0.5:
                sys.exit(f"scan {i}: {share:.2f} of the points in a {words[0]} have its label")
        objects += 1
        points_in_objects += int(inside.sum())
print(json.dumps({
    "reader": "pykitti, and as semantic-kitti-api and the object devkit read",
    "version": importlib.metadata.version("pykitti"),
    "accepted": True,
    "read": {"scans": len(scans), "points": sum(len(s) for s in scans), "objects": objects, "points_in_objects": points_in_objects},
}))
