# packages: pyarrow==26.0.1 polars==2.1.0 pandas==3.1.1 scipy==1.17.1
"""Reads the tables of a world scenario as docs/world_scenario_parquet.md of Cosmos-Transfer 2.5 has them: columns, types, rows, one box
and one camera by numbers."""

import json
import sys
from pathlib import Path

import numpy as np
import pandas as pd
import polars as pl
import pyarrow as pa
import pyarrow.parquet as pq
from scipy.spatial.transform import Rotation

XYZ = {"x": "double", "y": "double", "z": "double"}
XYZW = XYZ | {"w": "double"}
KEY = {"clip_id": "string", "label_class_id": "string", "map_id": "string", "map_id_version": "string"}
TABLES = {
    "obstacle": (
        {"clip_id": "string", "timestamp_micros": "int64", "label_class_id": "string"},
        {"trackline_id": "string", "center": XYZ, "size": XYZ, "orientation": XYZW, "category": "string"},
    ),
    "calibration_estimate": (
        {"clip_id": "string", "timestamp_micros": "int64"},
        {"name": "string", "rig_json": "string"},
    ),
    "egomotion_estimate": (
        {"clip_id": "string", "timestamp_micros": "int64"},
        {"name": "string", "location": XYZ, "orientation": XYZW},
    ),
    "lane": (
        KEY,
        {
            "left_rail": [XYZ],
            "left_edge_styles": ["string"],
            "left_edge_colors": ["string"],
            "right_rail": [XYZ],
            "right_edge_styles": ["string"],
            "right_edge_colors": ["string"],
            "lane_direction": "string",
            "speed_limit": "double",
            "vehicle_types": ["string"],
        },
    ),
    "lane_line": (
        KEY,
        {
            "line_rail": [XYZ],
            "styles": ["string"],
            "colors": ["string"],
            "left_driving_direction": "string",
            "right_driving_direction": "string",
        },
    ),
    "road_boundary": (KEY, {"category": "string", "location": [XYZ]}),
    "crosswalk": (KEY, {"category": "string", "location": [XYZ]}),
    "wait_line": (
        KEY,
        {"category": "string", "location": [XYZ], "is_implicit": "bool", "intersection_subtype": "string"},
    ),
}
CATEGORIES = {"automobile", "heavy_truck", "bus", "trailer", "rider", "person", "protruding_object"}


def plain(kind):
    """A type as nested dicts, lists and names."""
    if pa.types.is_struct(kind):
        return {field.name: plain(field.type) for field in kind}
    if pa.types.is_list(kind):
        return [plain(kind.value_type)]
    return str(kind)


def points(value):
    return np.array([[p["x"], p["y"], p["z"]] for p in value], dtype=float).reshape(-1, 3)


def main(folder):
    folder = Path(folder)
    (first,) = folder.glob("*.calibration_estimate.parquet")
    clip = first.name.removesuffix(".calibration_estimate.parquet")
    rows, tables = {}, {}
    for name, (key, body) in TABLES.items():
        path = folder / f"{clip}.{name}.parquet"
        if not path.exists():
            assert name not in ("obstacle", "calibration_estimate", "egomotion_estimate"), f"{path} is missing"
            continue
        schema = pq.read_schema(path)
        found = {field.name: plain(field.type) for field in schema}
        assert found == {"key": key, name: body, "version": "uint64"}, f"{name}: {found}"
        tables[name] = pd.read_parquet(path)
        rows[name] = len(tables[name])
        assert pl.read_parquet(path).height == rows[name], name
        assert rows[name] > 0 or name == "obstacle", name

    ego = tables["egomotion_estimate"]
    times = np.array([k["timestamp_micros"] for k in ego["key"]])
    assert len(times) >= 2 and times[0] == 0 and (np.diff(times) > 0).all(), times
    place = points([e["location"] for e in ego["egomotion_estimate"]])
    turn = np.array([[e["orientation"][a] for a in "xyzw"] for e in ego["egomotion_estimate"]])
    assert np.allclose(place[0], 0, atol=1e-9) and np.allclose(np.linalg.norm(turn, axis=1), 1), "ego"
    # The origin looks where the vehicle looks first, and is level.
    assert abs(Rotation.from_quat(turn[0]).apply([1, 0, 0])[1]) < 1e-9

    tracks = {}
    for key, body in zip(tables["obstacle"]["key"], tables["obstacle"]["obstacle"]):
        assert body["category"] in CATEGORIES, body
        assert min(body["size"].values()) > 0, body
        tracks.setdefault(body["trackline_id"], []).append((key["timestamp_micros"], body))
    for track in tracks.values():
        seen = [t for t, _ in track]
        assert seen == sorted(seen) and set(seen) <= set(times.tolist()), seen
    boxes = {}
    for name, track in sorted(tracks.items())[:1]:
        body = track[0][1]
        rotation = Rotation.from_quat([body["orientation"][a] for a in "xyzw"])
        assert abs(rotation.apply([0, 0, 1])[2] - 1) < 1e-9, "boxes are upright"
        front = rotation.apply([body["size"]["x"] / 2, 0, 0]) + points([body["center"]])[0]
        boxes[name] = {"category": body["category"], "front_m": np.round(front, 3).tolist()}

    rig = json.loads(tables["calibration_estimate"].iloc[0]["calibration_estimate"]["rig_json"])
    cameras = {}
    for sensor in rig["rig"]["sensors"]:
        properties, pose = sensor["properties"], sensor["nominalSensor2Rig_FLU"]
        assert sensor["name"].startswith("camera:") and properties["Model"] == "ftheta", sensor
        polynomial = [float(k) for k in properties["polynomial"].split()]
        assert len(polynomial) in (5, 6) and polynomial[0] == 0, polynomial
        width, height = int(properties["width"]), int(properties["height"])
        # The angle must grow up to the corners, or the model cannot be turned round.
        radii = np.linspace(0, np.hypot(width, height) / 2, 500)
        angles = sum(k * radii**i for i, k in enumerate(polynomial))
        assert (np.diff(angles) > 0).all() and len(pose["t"]) == 3, sensor["name"]
        body = Rotation.from_euler("xyz", np.radians(pose["roll-pitch-yaw"]))
        cameras[sensor["name"]] = np.round(body.apply([1, 0, 0]), 3).tolist()
    assert cameras, "no cameras"
    for name, view in cameras.items():
        if ":front:" in name:
            assert view[0] > 0.6, (name, view)
        if ":left:" in name or ":right:" in name:
            assert view[1] * (1 if ":left:" in name else -1) > 0.3, (name, view)

    for name, field in [("lane_line", "line_rail"), ("road_boundary", "location"), ("crosswalk", "location")]:
        for body in tables.get(name, pd.DataFrame({name: []}))[name]:
            line = points(body[field])
            assert len(line) >= 2 and np.isfinite(line).all(), (name, line)
            if name == "lane_line":
                assert len(body["styles"]) == len(body["colors"]) == len(line)
    for body in tables.get("lane", pd.DataFrame({"lane": []}))["lane"]:
        for side in ("left", "right"):
            assert len(body[f"{side}_edge_styles"]) == len(body[f"{side}_rail"]) - 1
    return {"rows": rows, "tracks": len(tracks), "box": boxes, "cameras": cameras}


if __name__ == "__main__":
    try:
        found = main(sys.argv[1])
    except Exception as error:  # one line for whoever runs all readers
        sys.exit(f"{type(error).__name__}: {error}".replace("\n", " ")[:300])
    version = f"{pa.__version__}, polars {pl.__version__}, pandas {pd.__version__}"
    print(json.dumps({"reader": "pyarrow", "version": version, "accepted": True, "read": found}))
