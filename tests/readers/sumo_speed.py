# packages: eclipse-sumo==1.28.0 sumo-data==1.28.0
"""Drives the same traffic over two OpenDRIVE files with SUMO and compares its mean speeds: an exported map and the one it came from.

    python tests/readers/sumo_speed.py ORIGINAL.xodr EXPORTED.xodr

Random trips of one seed, light traffic, ten minutes. Prints one JSON object; exit 1 if the mean speeds differ by more than 5 %."""
import json
import os
import subprocess
import sys
import tempfile
import xml.etree.ElementTree as ET

import sumo

BIN = os.path.join(sumo.SUMO_HOME, "bin")
MOST_OFF = 0.05


def run(*command):
    done = subprocess.run([str(c) for c in command], capture_output=True, text=True)
    if done.returncode:
        sys.exit(f"{os.path.basename(str(command[0]))}: {done.stderr.strip().splitlines()[-1:]}")


def driven(path, folder, name):
    """Mean speed in m/s of all trips (metres over seconds), what the lanes allow on average, and how many trips ended."""
    net, trips, out = (os.path.join(folder, f"{name}.{end}") for end in ("net.xml", "trips.xml", "info.xml"))
    run(os.path.join(BIN, "netconvert"), "--opendrive-files", path, "-o", net)
    root = ET.parse(net).getroot()
    lanes = [
        lane
        for edge in root.findall("edge")
        if edge.get("function") != "internal"
        for lane in edge.findall("lane")
        if "passenger" not in lane.get("disallow", "").split() and lane.get("allow") in (None, "all")
    ]
    metres = sum(float(lane.get("length")) for lane in lanes)
    allowed = sum(float(lane.get("length")) * float(lane.get("speed")) for lane in lanes) / metres
    tools = os.path.join(sumo.SUMO_HOME, "tools", "randomTrips.py")
    routes = os.path.join(folder, f"{name}.rou.xml")
    run(sys.executable, tools, "-n", net, "-o", trips, "-r", routes, "--seed", 7, "-e", 600, "-p", 4, "--fringe-factor", 5, "--validate", "--min-distance", 60)
    run(os.path.join(BIN, "sumo"), "-n", net, "-r", routes, "--seed", 7, "--end", 1800, "--tripinfo-output", out, "--no-step-log")
    infos = ET.parse(out).getroot().findall("tripinfo")
    length = sum(float(t.get("routeLength")) for t in infos)
    seconds = sum(float(t.get("duration")) for t in infos)
    return {"mean_mps": round(length / seconds, 3), "allowed_mps": round(allowed, 3), "lane_m": round(metres), "trips": len(infos)}


def main(original, exported):
    with tempfile.TemporaryDirectory() as folder:
        found = {name: driven(path, folder, name) for name, path in (("original", original), ("exported", exported))}
    off = found["exported"]["mean_mps"] / found["original"]["mean_mps"] - 1
    print(json.dumps(found | {"off": round(off, 4), "bar": MOST_OFF}))
    sys.exit(abs(off) > MOST_OFF)


if __name__ == "__main__":
    main(*sys.argv[1:])
