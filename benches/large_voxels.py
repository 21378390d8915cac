#!/usr/bin/env python3
"""Opens a map of 512 x 512 x 40 voxels of 0.2 m and paints on it, through a session: times and memory.

    python3 benches/large_voxels.py [--program target/release/sceneloom] [--strokes 200]

Prints one JSON object: seconds to open (from the start of the program until the state is answered), milliseconds of a stroke of voxels and of one of the road
(median, 95th percentile), peak memory of the program. A stroke is 40 voxels, or a disc of 2 m radius."""

import argparse
import array
import itertools
import json
import math
import struct
import subprocess
import tempfile
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent


def street():
    """Rows z, y, x, class as OpenOccupancy keeps them: a road with a sidewalk and houses, 512 x 512 columns, as an .npy file."""
    rows = []
    for x in range(512):
        for y in range(512):
            label = 11 if abs(y - 256) < 25 else 13 if abs(y - 256) < 40 else 14
            rows.append((15, y, x, label))
            if 44 <= abs(y - 256) < 60 and x % 100 < 80:
                rows.extend((z, y, x, 15) for z in range(16, 40) if x % 100 in (0, 79) or abs(y - 256) in (44, 59))
    header = f"{{'descr': '<i8', 'fortran_order': False, 'shape': ({len(rows)}, 4), }}"
    header += " " * (-(len(header) + 11) % 64) + "\n"
    return b"\x93NUMPY\x01\x00" + struct.pack("<H", len(header)) + header.encode() + array.array("q", itertools.chain.from_iterable(rows)).tobytes()


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--program", type=Path, default=ROOT / "target/release/sceneloom")
    parser.add_argument("--strokes", type=int, default=200)
    args = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        labels, scene = Path(folder) / "labels.npy", Path(folder) / "large.loom"
        labels.write_bytes(street())
        subprocess.run([args.program, "import", labels, "-o", scene], check=True, capture_output=True)
        began = time.perf_counter()
        session = subprocess.Popen([args.program, "session", scene, "--folder", folder], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
        number = 0

        def call(name, arguments):
            nonlocal number
            number += 1
            session.stdin.write(json.dumps({"id": number, "call": name, "args": arguments}) + "\n")
            session.stdin.flush()
            answer = json.loads(session.stdout.readline())
            if not answer.get("ok"):
                raise SystemExit(f"{name}: {answer}")
            return answer["receipt"]

        state = call("state", {})
        opened_s = time.perf_counter() - began
        times_ms = {"voxels": [], "road": []}
        for i in range(args.strokes):
            x, y = 300 + i % 100, 100 + i * 7 % 200
            cells = [[x + j % 8, y + j // 8, 8 + j % 3] for j in range(40)]
            strokes = {
                "voxels": {"paint_voxels": {"cells": cells, "class": "manmade"}},
                "road": {"paint_bev": {"layer": "drivable_area", "shape": {"disc": {"center_m": [20 + i % 20, i % 37 - 18], "radius_m": 2.0}}, "value": i % 2 == 0}},
            }
            for kind, edit in strokes.items():
                begun = time.perf_counter()
                call("apply", {"edits": [edit]})
                times_ms[kind].append((time.perf_counter() - begun) * 1e3)
        peak_kb = int(next(line.split()[1] for line in Path(f"/proc/{session.pid}/status").read_text().splitlines() if line.startswith("VmHWM")))
        session.stdin.close()
        session.wait()

    def told(values):
        values = sorted(values)
        return {"median_ms": round(values[len(values) // 2], 2), "p95_ms": round(values[math.ceil(0.95 * len(values)) - 1], 2)}

    print(json.dumps({"cells": state["map"]["cells"], "opened_s": round(opened_s, 3), **{kind: told(v) for kind, v in times_ms.items()}, "peak_mb": round(peak_kb / 1024, 1)}))


if __name__ == "__main__":
    main()
