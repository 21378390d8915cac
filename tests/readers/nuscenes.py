# packages: nuscenes-devkit==1.2.0
"""Opens an exported folder with the devkit: tables, every file of every sensor, boxes, labels, map mask, map expansion."""
import json
import os
import sys
from importlib.metadata import version

del sys.path[0]  # this file is called like the package

import matplotlib
import numpy as np

matplotlib.use("Agg")
import descartes.patch
from nuscenes.map_expansion.map_api import NuScenesMap
from nuscenes.nuscenes import NuScenes
from nuscenes.utils.data_classes import LidarPointCloud, RadarPointCloud
from nuscenes.utils.geometry_utils import BoxVisibility, points_in_box
from PIL import Image

# descartes, which the devkit draws maps with, does not know rings of shapely 2.
descartes.patch.asarray = lambda ring: np.asarray(getattr(ring, "coords", ring))


def expect(holds, what):
    if not holds:
        sys.exit(f"nuscenes-devkit: {what}")


def walk(nusc, scene):
    """Samples of a scene, by their chain."""
    token = scene["first_sample_token"]
    while token:
        sample = nusc.get("sample", token)
        yield sample
        token = sample["next"]


def check_lidar(nusc, token, read):
    path, boxes, _ = nusc.get_sample_data(token, box_vis_level=BoxVisibility.NONE)
    cloud = LidarPointCloud.from_file(path)
    expect(np.isfinite(cloud.points).all(), f"{path}: a point is not finite")
    read["points"] += cloud.nbr_points()
    read["points_in_boxes"] += sum(int(points_in_box(box, cloud.points[:3]).sum()) for box in boxes)
    if nusc.get("sample_data", token)["is_key_frame"]:
        labels = nusc.get("lidarseg", token)
        labels = np.fromfile(os.path.join(nusc.dataroot, labels["filename"]), dtype=np.uint8)
        expect(len(labels) == cloud.nbr_points(), f"{path}: {len(labels)} labels")
        expect(set(labels.tolist()) <= set(nusc.lidarseg_idx2name_mapping), f"{path}: a label is no category")
        read["lidarseg"] = sorted(set(read["lidarseg"]) | {nusc.lidarseg_idx2name_mapping[i] for i in labels.tolist()})
        ego = np.array(nusc.get("calibrated_sensor", nusc.get("sample_data", token)["calibrated_sensor_token"])["translation"])
        ground = cloud.points[2, labels == nusc.lidarseg_name2idx_mapping["flat.driveable_surface"]] + ego[2]
        if len(ground):
            read["ground_z_m"] = round(float(np.median(ground)), 3)


def check_radar(nusc, token, read):
    path, _, _ = nusc.get_sample_data(token, box_vis_level=BoxVisibility.NONE)
    cloud = RadarPointCloud.from_file(path)
    expect(np.isfinite(cloud.points).all(), f"{path}: a number is not finite")
    read["radar_returns"] += cloud.nbr_points()


def check_sample(nusc, sample, read):
    read["samples"] += 1
    for channel, token in sample["data"].items():
        data = nusc.get("sample_data", token)
        if data["sensor_modality"] == "lidar":
            check_lidar(nusc, token, read)
            while data["prev"] and not nusc.get("sample_data", data["prev"])["is_key_frame"]:
                data = nusc.get("sample_data", data["prev"])
                check_lidar(nusc, data["token"], read)
                read["sweeps"] += 1
        elif data["sensor_modality"] == "radar":
            check_radar(nusc, token, read)
        else:
            path, boxes, intrinsic = nusc.get_sample_data(token)
            with Image.open(path) as image:
                expect(image.size == (data["width"], data["height"]), f"{path}: {image.size}")
            expect(intrinsic.shape == (3, 3) and intrinsic[2, 2] == 1, f"{channel}: intrinsics {intrinsic}")
            read["pictures"] += 1
            read["boxes_in_pictures"] += len(boxes)
    for token in sample["anns"]:
        row = nusc.get("sample_annotation", token)
        nusc.get("visibility", row["visibility_token"])
        speed = float(np.linalg.norm(nusc.box_velocity(token)[:2]))
        read["fastest_mps"] = max(read["fastest_mps"], 0 if np.isnan(speed) else round(speed, 3))
        moves = [nusc.get("attribute", t)["name"] for t in row["attribute_tokens"]]
        read["moving"] += any(name.endswith((".moving", "with_rider")) for name in moves)
    read["boxes"] += len(sample["anns"])


def check_lanes(expansion, poses, read):
    """Every lane has an area and a path, leads into lanes that begin where it ends, and one is under the vehicle."""
    lanes = expansion.lane + expansion.lane_connector
    gaps = [0.0]
    for lane in lanes:
        token = lane["token"]
        expect(expansion.extract_polygon(lane["polygon_token"]).is_valid, f"lane {token}: its area is not valid")
        path = expansion.discretize_lanes([token], 1.0)[token]
        expect(len(path) > 0, f"lane {token} has no path")
        end = expansion.get_arcline_path(token)[-1]["end_pose"]
        for other in expansion.get_outgoing_lane_ids(token):
            expect(token in expansion.get_incoming_lane_ids(other), f"lane {other} does not know {token}")
            start = expansion.get_arcline_path(other)[0]["start_pose"]
            gaps.append(float(np.hypot(end[0] - start[0], end[1] - start[1])))
    expect(max(gaps) < 1.0, f"{max(gaps)} m between a lane and the next")
    near = [bool(expansion.get_closest_lane(x, y, radius=3)) for x, y in poses[:, :2]]
    read["lanes"], read["lane_connectors"] = len(expansion.lane), len(expansion.lane_connector)
    read["lane_links"], read["poses_near_a_lane"] = len(gaps) - 1, round(float(np.mean(near)), 3)


def check_map(nusc, read):
    log = nusc.get("log", nusc.scene[0]["log_token"])
    record = nusc.get("map", log["map_token"])
    mask = record["mask"].mask()
    expect(set(np.unique(mask).tolist()) <= {0, 255}, "map mask: neither 0 nor 255")
    poses = np.array([p["translation"] for p in nusc.ego_pose])
    on_mask = record["mask"].is_on_mask(poses[:, 0], poses[:, 1])
    read["poses_on_mask"] = round(float(on_mask.mean()), 3)
    expansion = NuScenesMap(dataroot=nusc.dataroot, map_name=log["location"])
    read["map"] = {name: len(getattr(expansion, name)) for name in expansion.non_geometric_layers if getattr(expansion, name)}
    for row in expansion.polygon:
        expect(expansion.extract_polygon(row["token"]).is_valid, f"polygon {row['token']} is not valid")
    width, height = expansion.canvas_edge
    for row in expansion.road_divider + expansion.lane_divider:
        expect(expansion.extract_line(row["line_token"]).length > 0, f"divider {row['token']} has no length")
    # Masks of lines fail in this devkit with shapely 2, whatever the map.
    layers = ["drivable_area", "walkway", "ped_crossing"]
    masks = expansion.get_map_mask((width / 2, height / 2, height, width), 0, layers, (int(height * 2), int(width * 2)))
    read["map_mask_share"] = {name: round(float(m.mean()), 3) for name, m in zip(layers, masks)}
    check_lanes(expansion, poses, read)
    # The picture of the map with the poses on it: it makes a number of the scene's name.
    expansion.render_egoposes_on_fancy_map(nusc, scene_tokens=[nusc.scene[0]["token"]], verbose=False)
    x, y = poses[0, :2]
    read["layers_under_ego"] = sorted(name for name, token in expansion.layers_on_point(x, y).items() if token)


def main():
    root = sys.argv[1]
    nusc = NuScenes(version="v1.0-mini", dataroot=root, verbose=False)
    read = dict.fromkeys(["samples", "sweeps", "points", "points_in_boxes", "radar_returns", "pictures", "boxes", "boxes_in_pictures", "moving", "fastest_mps"], 0)
    read["lidarseg"] = []
    for scene in nusc.scene:
        samples = list(walk(nusc, scene))
        expect(len(samples) == scene["nbr_samples"], f"{scene['name']}: {len(samples)} samples in the chain")
        expect(samples[-1]["token"] == scene["last_sample_token"], f"{scene['name']}: ends elsewhere")
        for sample in samples:
            check_sample(nusc, sample, read)
    for instance in nusc.instance:
        count = len(nusc.field2token("sample_annotation", "instance_token", instance["token"]))
        expect(count == instance["nbr_annotations"], f"instance {instance['token']}: {count} boxes")
    check_map(nusc, read)
    print(json.dumps({"reader": "nuscenes-devkit", "version": version("nuscenes-devkit"), "accepted": True, "figure": f"{read['lanes']} lanes, {read['lane_links']} links, {read['poses_near_a_lane']:.0%} of the poses on one", "read": read}))


main()
