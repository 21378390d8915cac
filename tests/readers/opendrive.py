# packages: asam-qc-opendrive==1.0.0 carla==0.9.16 eclipse-sumo==1.28.0 sumo-data==1.28.0
"""Reads an exported map.xodr with the ASAM quality checker (no error is allowed), the map reader of CARLA and SUMO's netconvert."""
import json
import logging
import os
import subprocess
import sys
import tempfile
import xml.etree.ElementTree as ET
from importlib.metadata import version

logging.disable(logging.CRITICAL)
from qc_baselib import Configuration, IssueSeverity, Result  # noqa: E402
from qc_opendrive import constants  # noqa: E402
from qc_opendrive import main as checker  # noqa: E402


def checked(path):
    """Errors and warnings of the ASAM checker, by rule; and how many rules were looked at."""
    config = Configuration()
    config.set_config_param("InputFile", path)
    config.register_checker_bundle(constants.BUNDLE_NAME)
    result = Result()
    result.register_checker_bundle(
        name=constants.BUNDLE_NAME, description="", version=constants.BUNDLE_VERSION, summary=""
    )
    result.set_result_version(version=constants.BUNDLE_VERSION)
    checker.run_checks(config, result)
    errors, warnings, rules = {}, {}, 0
    for rule in result.get_checker_results(constants.BUNDLE_NAME):
        status = str(rule.status).lower()
        rules += "completed" in status
        if "error" in status:
            errors[rule.checker_id] = rule.summary
        for issue in rule.issues:
            kind = errors if issue.level == IssueSeverity.ERROR else warnings
            kind[rule.checker_id] = issue.description
    return errors, warnings, rules


def main(path):
    if os.path.isdir(path):
        path = os.path.join(path, "map.xodr")
    errors, warnings, rules = checked(path)
    if errors or rules < 15:
        sys.exit(f"ASAM checker: {rules} rules, errors {errors}")
    root = ET.parse(path).getroot()
    roads = root.findall("road")
    driving = [r for r in roads if r.find(".//lane[@type='driving']") is not None]

    import carla

    with open(path, encoding="utf-8") as file:
        road_map = carla.Map("map", file.read())
    waypoints = road_map.generate_waypoints(2.0)
    found = {w.road_id for w in waypoints}
    missing = [r.get("id") for r in driving if int(r.get("id")) not in found and float(r.get("length")) > 4.0]
    if missing:
        sys.exit(f"CARLA: no waypoint on roads {missing[:5]}")
    # A waypoint lies where the reference line of its road says: y is to the right in CARLA.
    for road in driving:
        first = road.find("planView/geometry")
        near = [w for w in waypoints if w.road_id == int(road.get("id")) and w.s < 2.5]
        if near and len(road.findall("planView/geometry")) == 1:
            at = near[0].transform.location
            away = ((at.x - float(first.get("x"))) ** 2 + (-at.y - float(first.get("y"))) ** 2) ** 0.5
            if away > 30.0:
                sys.exit(f"CARLA: road {road.get('id')} begins {away:.1f} m away")
    crossings = len(root.findall(".//object[@type='crosswalk']"))
    corners = len(road_map.get_crosswalks())
    if crossings and not corners:
        sys.exit(f"CARLA: no corner of {crossings} crossings")

    edges = connections = 0
    if driving:
        import sumo

        with tempfile.TemporaryDirectory() as folder:
            net = os.path.join(folder, "net.xml")
            command = [os.path.join(sumo.SUMO_HOME, "bin", "netconvert"), "--opendrive-files", path, "-o", net]
            done = subprocess.run(command, capture_output=True, text=True)
            if done.returncode or "Error" in done.stderr:
                sys.exit(f"netconvert: {done.stderr.strip().splitlines()[-1:]}")
            net = ET.parse(net).getroot()
            edges = len([e for e in net.findall("edge") if e.get("function") != "internal"])
            connections = len([c for c in net.findall("connection") if not c.get("from", "").startswith(":")])
    versions = {name: version(name) for name in ("asam-qc-opendrive", "carla", "eclipse-sumo")}
    read = {
        "rules": rules,
        "errors": 0,
        "warnings": len(warnings),
        "roads": len(roads),
        "junctions": len(root.findall("junction")),
        "carla_waypoints": len(waypoints),
        "carla_crosswalk_corners": corners,
        "sumo_edges": edges,
        "sumo_connections": connections,
    }
    name = " + ".join(versions)
    print(json.dumps({"reader": name, "version": " + ".join(versions.values()), "accepted": True, "read": read}))


if __name__ == "__main__":
    main(sys.argv[1])
