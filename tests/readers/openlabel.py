# packages: vcd==6.0.3
"""Validates an exported file against the OpenLABEL 1.0.0 schema in Vicomtech's package, loads it and asks for transforms."""
import json
import sys
import warnings
from importlib.metadata import version

import numpy as np
from vcd import core, scl


def expect(holds, what):
    if not holds:
        sys.exit(f"vcd: {what}")


def main():
    warnings.simplefilter("ignore")
    labels = core.OpenLABEL()
    labels.load_from_file(sys.argv[1], validation=True)
    root = labels.data["openlabel"]
    scene = scl.Scene(labels)
    read = {"objects": len(root["objects"]), "frames": len(root["frames"]), "cuboids": 0, "cameras": 0}
    for number in labels.get_frame_intervals().get()[0]:
        expect(number in root["frames"], f"frame {number} is missing")
    for number, frame in root["frames"].items():
        listed = frame["frame_properties"]["transforms"]["vehicle-iso8855_to_odom"]["transform_src_to_dst"]["matrix4x4"]
        odom_from_vehicle, is_static = scene.get_transform("vehicle-iso8855", "odom", number)
        expect(np.allclose(odom_from_vehicle, np.array(listed).reshape(4, 4)), f"frame {number}: another transform")
        expect(abs(np.linalg.det(odom_from_vehicle[:3, :3]) - 1) < 1e-9, f"frame {number}: no rotation")
        for uid in frame.get("objects", {}):
            values = labels.get_object_data(uid, "shape", number)["val"]
            expect(len(values) == 10 and abs(np.linalg.norm(values[3:7]) - 1) < 1e-9, f"object {uid}: {values}")
            expect(min(values[7:]) > 0, f"object {uid}: size {values[7:]}")
            read["cuboids"] += 1
            inside = any(i["frame_start"] <= number <= i["frame_end"] for i in root["objects"][uid]["frame_intervals"])
            expect(inside, f"object {uid}: in frame {number}, but not in its intervals")
    for name, stream in root["streams"].items():
        if stream["type"] == "camera":
            # Vicomtech's own camera class asks for keys that are in its schema under other names.
            matrix = np.array(stream["stream_properties"]["intrinsics_pinhole"]["camera_matrix"]).reshape(3, 4)
            in_camera, _ = scene.get_transform("vehicle-iso8855", name, 0)
            read["cameras"] += 1
            if name == "CAM_FRONT":
                u, v, depth = matrix @ in_camera @ np.array([20.0, 0.0, 1.0, 1.0])
                expect(depth > 0, f"{name}: 20 m ahead is behind it")
                read["point_ahead_px"] = [round(u / depth, 1), round(v / depth, 1)]
    first = min(root["objects"], key=int)
    start = root["objects"][first]["frame_intervals"][0]["frame_start"]
    read["first_object"] = [round(v, 6) for v in root["frames"][start]["objects"][first]["object_data"]["cuboid"][0]["val"]]
    print(json.dumps({"reader": "vcd", "version": version("vcd"), "accepted": True, "read": read}))


main()
