# packages: nuscenes-devkit==1.2.0
"""Runs the devkit's detection evaluation on exported folders, their ground truth as the detections: each class that is present must
have AP 1.000 without errors, and each box as many LiDAR points as the devkit counts within it."""
import importlib.metadata
import json
import math
import sys
import tempfile

import numpy as np
from nuscenes.eval.common.config import config_factory
from nuscenes.eval.common.loaders import get_samples_of_custom_split
from nuscenes.eval.detection.evaluate import DetectionEval
from nuscenes.eval.detection.utils import category_to_detection_name
from nuscenes.nuscenes import NuScenes
from nuscenes.utils.data_classes import LidarPointCloud
from nuscenes.utils.geometry_utils import BoxVisibility, points_in_box

SPLIT = "all"
ERRORS = ["trans_err", "scale_err", "orient_err", "vel_err", "attr_err"]


def counted(nusc, sample):
    """Points of the key frame's sweep within each annotation, as the devkit counts them."""
    token = sample["data"]["LIDAR_TOP"]
    path, boxes, _ = nusc.get_sample_data(token, box_vis_level=BoxVisibility.NONE)
    points = LidarPointCloud.from_file(path).points[:3]
    return {box.token: int(points_in_box(box, points).sum()) for box in boxes}


def detection(nusc, row):
    """An annotation as a detector would hand it in."""
    velocity = nusc.box_velocity(row["token"])[:2]
    attributes = [nusc.get("attribute", token)["name"] for token in row["attribute_tokens"]]
    return {
        "sample_token": row["sample_token"],
        "translation": row["translation"],
        "size": row["size"],
        "rotation": row["rotation"],
        "velocity": [0.0 if math.isnan(v) else float(v) for v in velocity],
        "detection_name": category_to_detection_name(row["category_name"]),
        "detection_score": 1.0,
        "attribute_name": (attributes or [""])[0],
    }


def outside(nusc, sample, points_of, shares):
    """Adds, by class, points labelled as it and those of them that are in no box of it."""
    token = sample["data"]["LIDAR_TOP"]
    path, boxes, _ = nusc.get_sample_data(token, box_vis_level=BoxVisibility.NONE)
    points = LidarPointCloud.from_file(path).points[:3]
    labels = np.fromfile(f"{nusc.dataroot}/{nusc.get('lidarseg', token)['filename']}", dtype=np.uint8)
    inside = {}
    for box in boxes:
        name = points_of(box.name)
        inside[name] = inside.get(name, np.zeros(points.shape[1], bool)) | points_in_box(box, points)
    for name, mask in inside.items():
        own = labels == nusc.lidarseg_name2idx_mapping[name]
        out, all_ = shares.get(name, (0, 0))
        shares[name] = (out + int((own & ~mask).sum()), all_ + int(own.sum()))


def of_folder(root):
    nusc = NuScenes(version="v1.0-mini", dataroot=root, verbose=False)
    tokens = get_samples_of_custom_split(SPLIT, nusc)
    results, wrong, boxes, hit, shares = {}, 0, 0, 0, {}
    plain = {"human.pedestrian": "human.pedestrian.adult", "vehicle.bus": "vehicle.bus.rigid"}
    points_of = lambda name: next((to for of, to in plain.items() if name.startswith(of)), name)
    for token in tokens:
        sample = nusc.get("sample", token)
        counts = counted(nusc, sample)
        results[token] = []
        for row in (nusc.get("sample_annotation", t) for t in sample["anns"]):
            boxes += 1
            hit += counts[row["token"]] > 0
            wrong += counts[row["token"]] != row["num_lidar_pts"]
            # What no point is in is no ground truth of the evaluation, and cannot be asked of a detector.
            if counts[row["token"]] and category_to_detection_name(row["category_name"]):
                results[token].append(detection(nusc, row))
        outside(nusc, sample, points_of, shares)
    use = dict.fromkeys(["use_camera", "use_radar", "use_map", "use_external"], False)
    with tempfile.TemporaryDirectory() as folder:
        with open(f"{folder}/results.json", "w") as file:
            json.dump({"meta": {"use_lidar": True, **use}, "results": results}, file)
        config = config_factory("detection_cvpr_2019")
        judged = DetectionEval(nusc, config, f"{folder}/results.json", SPLIT, folder, verbose=False)
        present = sorted({box.detection_name for box in judged.gt_boxes.all})
        metrics, _ = judged.evaluate()
    aps = {name: float(metrics.mean_dist_aps[name]) for name in present}
    errors = {name: [metrics.get_label_tp(name, e) for e in ERRORS] for name in present}
    worst = max((e for of in errors.values() for e in of if not math.isnan(e)), default=0.0)
    return {
        "key_frames": len(tokens),
        "boxes": boxes,
        "boxes_with_points": hit,
        "wrong_counts": wrong,
        "ap": aps,
        "worst_error": worst,
        "ego_way_m": ego_way_m(nusc),
        "outside_share": {name: round(out / n, 4) for name, (out, n) in shares.items() if n},
    }


def ego_way_m(nusc):
    places = [row["translation"] for row in sorted(nusc.ego_pose, key=lambda p: p["timestamp"])]
    return round(float(np.linalg.norm(np.diff(np.array(places), axis=0), axis=1).sum()), 1)


def main():
    read = [of_folder(root) for root in sys.argv[1:]]
    aps = [ap for of in read for ap in of["ap"].values()]
    wrong = sum(of["wrong_counts"] for of in read)
    right = bool(aps) and min(aps) >= 0.9995 and wrong == 0 and all(of["worst_error"] < 1e-6 for of in read)
    figure = f"AP of the ground truth {min(aps, default=0.0):.3f} at least, {len(aps)} classes; {wrong} of {sum(of['boxes'] for of in read)} counts of points wrong"
    print(json.dumps({"reader": "nuscenes-devkit, detection evaluation", "version": importlib.metadata.version("nuscenes-devkit"), "accepted": right, "figure": figure, "read": read}))


main()
