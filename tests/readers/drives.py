#!/usr/bin/env python3
"""Five clips in which the ego vehicle and others move, exported as nuScenes, and the devkit's evaluation of their ground truth against
itself (nuscenes__evaluation.py): prints a line for each clip and the figure over all.

    tests/readers/drives.py [--program target/release/sceneloom] [--envs DIR] [--keep DIR]"""

import argparse
import json
import sys
import tempfile
from pathlib import Path

import run as readers

# Template of the map, seed, and what moves: the id of a box, or none for the ego vehicle, by a manoeuvre at a speed.
CLIPS = [
    ("straight", 3, {"template": "drive", "mps": 9.0}),
    ("t-junction", 3, {"template": "follow", "mps": 6.0}),
    ("intersection", 5, {"template": "turn_left", "mps": 7.0}),
    ("curve", 2, {"template": "drive", "mps": 11.0}),
    ("roundabout", 4, {"template": "stop", "mps": 8.0}),
]
LENGTH_S = 4.0
# Boxes that move too, at most.
OTHERS = 6


def call(program, folder, *calls):
    lines = [json.dumps({"id": i, **c}) for i, c in enumerate(calls)]
    done = readers.run(program, "session", "--folder", folder, input="\n".join(lines))
    if done.returncode:
        raise RuntimeError(done.stderr.strip())
    answers = [json.loads(line) for line in done.stdout.splitlines()]
    return {a["id"]: a for a in answers if "id" in a}


def clip(program, folder, template, seed, move):
    """A scene file in which the ego vehicle moves, and those of its boxes that can."""
    name = f"{template}-{seed}.loom"
    readers.run(program, "new", "--template", template, "--seed", seed, "-o", folder / name, check=True)
    readers.run(program, "export", folder / name, "--format", "boxes", "-o", folder / "boxes.json", check=True)
    things = json.loads((folder / "boxes.json").read_text())["boxes"]
    drives = [b for b in things if b["class"] in ("car", "bus", "truck", "bicycle", "motorcycle")][:OTHERS]
    edits = [{"set_length": {"length_s": LENGTH_S, "rate_hz": 10.0}}, {"let_move": move}]
    calls = [{"call": "open", "args": {"file": name}}, {"call": "apply", "args": {"edits": edits}}]
    # What does not move where it stands is left standing.
    calls += [{"call": "apply", "args": {"edits": [{"let_move": {"id": b["id"], "template": "drive", "mps": 5.0}}]}} for b in drives]
    walkers = [b for b in things if b["class"] == "pedestrian"][:2]
    calls += [{"call": "apply", "args": {"edits": [{"let_move": {"id": b["id"], "template": "cross", "mps": 1.4}}]}} for b in walkers]
    answers = call(program, folder, *calls, {"call": "save", "args": {"file": name, "replace": True}})
    for needed in (0, 1, len(calls)):
        if not answers.get(needed, {}).get("ok"):
            raise RuntimeError(f"{name}: {answers.get(needed)}")
    return folder / name


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--program", type=Path, default=readers.ROOT / "target/release/sceneloom")
    parser.add_argument("--envs", type=Path, default=Path(tempfile.gettempdir()) / "sceneloom-readers")
    parser.add_argument("--keep", type=Path, help="folder for clips and exports; else they are gone afterwards")
    args = parser.parse_args()
    command, cwd = readers.environment(readers.HERE / "nuscenes__evaluation.py", args.envs)
    failed, least, counts = 0, 1.0, [0, 0]
    with tempfile.TemporaryDirectory() as temporary:
        folder = args.keep or Path(temporary)
        folder.mkdir(parents=True, exist_ok=True)
        for template, seed, move in CLIPS:
            scene = clip(args.program, folder, template, seed, move)
            out = scene.with_suffix("")
            readers.run(args.program, "export", scene, "--format", "nuscenes", "--size", "160x90", "-o", f"{out}/", check=True)
            done = readers.run(*command, out, cwd=cwd)
            if done.returncode:
                raise RuntimeError(done.stderr.strip().splitlines()[-1])
            said = json.loads(done.stdout.strip().splitlines()[-1])
            read = said["read"][0]
            failed += not said["accepted"] or read["ego_way_m"] < 2
            least = min([least, *read["ap"].values()])
            counts = [counts[0] + read["wrong_counts"], counts[1] + read["boxes"]]
            print(json.dumps({"clip": scene.stem, **read}), flush=True)
    print(f"AP of the ground truth at least {least:.3f}; {counts[0]} of {counts[1]} counts of points wrong; {failed} of {len(CLIPS)} clips failed")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
