"""python3 benches/mcap.py PROGRAM [--size WxH] [--seconds S] [--every N]: MCAP of a clip against the sweeps and pictures that it holds.

A junction at which the ego vehicle and six others drive, at 10 Hz. The clip is exported as MCAP; then the sweep and the six
pictures of every N-th moment are rendered alone (`render`, as its report tells their time). Prints both, and their quotient: at
most 2, else the exit status is 1."""
import argparse
import json
import subprocess
import sys
import tempfile
from pathlib import Path

RATE_HZ = 10.0
OTHERS = 6
BAR = 2.0


def run(program, *arguments, **more):
    done = subprocess.run([program, *map(str, arguments)], capture_output=True, text=True, check=False, **more)
    if done.returncode != 0:
        sys.exit(done.stderr.strip() or f"exit {done.returncode}")
    return done.stdout


def clip(program, folder, seconds):
    """The file of a clip."""
    scene = folder / "clip.loom"
    run(program, "new", "--template", "intersection", "--seed", 5, "-o", scene)
    run(program, "export", scene, "--format", "boxes", "-o", folder / "boxes.json")
    boxes = json.loads((folder / "boxes.json").read_text())["boxes"]
    others = [b["id"] for b in boxes if b["class"] in ("car", "bus", "truck", "bicycle", "motorcycle")][:OTHERS]
    begin = [{"set_length": {"length_s": seconds, "rate_hz": RATE_HZ}}, {"let_move": {"template": "drive", "mps": 8.0}}]
    # What cannot drive where it stands is left standing.
    edits = [begin, *[[{"let_move": {"id": number, "template": "drive", "mps": 5.0}}] for number in others]]
    calls = [{"call": "open", "args": {"file": scene.name}}, *[{"call": "apply", "args": {"edits": e}} for e in edits]]
    calls.append({"call": "save", "args": {"file": scene.name, "replace": True}})
    lines = "\n".join(json.dumps({"id": i, **call}) for i, call in enumerate(calls))
    answers = [json.loads(line) for line in run(program, "session", "--folder", folder, input=lines).splitlines()]
    for needed in (0, 1, len(calls) - 1):
        if not any(a.get("id") == needed and a.get("ok") for a in answers):
            sys.exit(f"call {needed}: {answers}")
    return scene


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("program")
    parser.add_argument("--size", default="320x180")
    parser.add_argument("--seconds", type=float, default=8.0)
    parser.add_argument("--every", type=int, default=8)
    args = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        folder = Path(folder)
        scene = clip(args.program, folder, args.seconds)
        said = json.loads(run(args.program, "export", scene, "--format", "mcap", "--size", args.size, "-o", folder / "a.mcap", "--json"))
        moments = int(args.seconds * RATE_HZ + 1e-6) + 1
        spent = {"lidar": [], "appearance": []}
        for i in range(0, moments, args.every):
            options = ["--what", "appearance,lidar", "--size", args.size, "--at", i / RATE_HZ, "-o", folder / "one", "--json"]
            told = json.loads(run(args.program, "render", scene, *options))["wall_s"]
            for kind, seconds in spent.items():
                seconds.append(told[kind])
        sweeps, pictures = (moments * sum(spent[kind]) / len(spent[kind]) for kind in ("lidar", "appearance"))
        quotient = said["wall_s"] / (sweeps + pictures)
        print(f"MCAP of {args.seconds:g} s, {moments} moments, pictures of {args.size}: {said['wall_s']:.1f} s, {said['bytes'] / 1e6:.0f} MB")
        print(f"its sweeps and pictures alone: {sweeps:.1f} s + {pictures:.1f} s (of {len(spent['lidar'])} moments)")
        print(f"quotient {quotient:.2f}, bar {BAR:g}")
        sys.exit(quotient > BAR)


main()
