#!/usr/bin/env python3
"""Exports a scene and a clip in every format, opens each with the format's own public reader, and writes the table docs/readers.md.

    tests/readers/run.py [--program target/release/sceneloom] [--envs DIR] [NAME …]

Each script beside this one names its packages in its first line; they are installed into an environment of their own below DIR
(PyPI by venv and pip, npm by npm). Names choose some of the scripts."""

import argparse
import json
import re
import subprocess
import sys
import tempfile
from pathlib import Path

HERE = Path(__file__).resolve().parent
ROOT = HERE.parent.parent
# Scripts that are no format: this one, and the clients of `mcp` and `serve`.
OTHERS = {"run", "mcp_client", "serve", "sumo_speed", "drives"}
CLIPS = {"nuscenes", "openlabel", "mcap", "openscenario", "world-scenario", "control-video", "kitti"}


def run(*command, **more):
    return subprocess.run([str(c) for c in command], capture_output=True, text=True, **more)


def format_of(script):
    # A second reader of a format is named FORMAT__READER.
    return script.stem.split("__")[0].replace("_", "-")


def packages(script):
    first = script.read_text().splitlines()[0]
    return re.split(r"\s+", first.split("packages:")[1].strip())


def environment(script, envs):
    """The command that runs a script in its own environment."""
    env = envs / script.name.replace(".", "-")
    ready = env / "ready"
    if script.suffix == ".py":
        python = env / "bin" / "python"
        if not ready.exists():
            run(sys.executable, "-m", "venv", env, check=True)
            done = run(python, "-m", "pip", "-q", "install", *packages(script))
            if done.returncode:
                raise RuntimeError(done.stderr.strip().splitlines()[-1])
            ready.touch()
        # -P: a script named as a package is not that package.
        return [python, "-P", script], ROOT
    env.mkdir(parents=True, exist_ok=True)
    if not ready.exists():
        done = run("npm", "install", "--silent", "--prefix", env, *packages(script))
        if done.returncode:
            raise RuntimeError((done.stderr.strip().splitlines() or ["npm failed"])[-1])
        ready.touch()
    return ["node", script], env


def exported(program, scenes, name, folder):
    """Path of what a reader opens: the file of a format of one file, else the folder."""
    out = folder / name
    out.mkdir()
    scene = scenes["clip" if name in CLIPS else "still"]
    size = ["--size", "320x180"]
    done = run(program, "export", scene, "--format", name, *size, "-o", f"{out}/", "--json")
    if done.returncode:
        raise RuntimeError(done.stderr.strip())
    files = json.loads(done.stdout)["files"]
    return Path(files[0]) if len(files) == 1 else out


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--program", type=Path, default=ROOT / "target/release/sceneloom")
    parser.add_argument("--envs", type=Path, default=Path(tempfile.gettempdir()) / "sceneloom-readers")
    parser.add_argument("--table", type=Path, default=ROOT / "docs/readers.md")
    parser.add_argument("names", nargs="*")
    args = parser.parse_args()
    scripts = sorted(s for s in HERE.iterdir() if s.suffix in (".py", ".mjs") and s.stem not in OTHERS)
    lost = {f["name"]: f["lost"] or ("nothing of what it holds" if f["read"] else "not read") for f in json.loads(run(args.program, "export", "--format", "list", "--json").stdout)["formats"]}
    rows, failed = [], 0
    with tempfile.TemporaryDirectory() as temporary:
        folder = Path(temporary)
        scenes = {"still": folder / "still.loom", "clip": folder / "clip.loom"}
        run(args.program, "new", "--template", "t-junction", "--seed", 3, "-o", scenes["still"], check=True)
        edits = folder / "edits.json"
        edits.write_text('[{"set_length": {"length_s": 2.0, "rate_hz": 5.0}}, {"let_move": {"template": "follow", "mps": 6.0}}]')
        run(args.program, "session", scenes["still"], "--folder", folder, check=True, input="\n".join([
            json.dumps({"id": 1, "call": "apply", "args": {"edits": json.loads(edits.read_text())}}),
            json.dumps({"id": 2, "call": "save", "args": {"file": "clip.loom"}}),
        ]))
        made = {}
        for script in scripts:
            name = format_of(script)
            if args.names and name not in args.names:
                continue
            try:
                command, cwd = environment(script, args.envs)
                if name not in made:
                    made[name] = exported(args.program, scenes, name, folder)
                done = run(*command, made[name], cwd=cwd, timeout=600)
                if done.returncode:
                    raise RuntimeError((done.stderr.strip().splitlines() or ["no reason"])[-1])
                said = json.loads(done.stdout.strip().splitlines()[-1])
                reader = f"{said['reader']} {said.get('version', '')}".strip()
                rows.append((name, reader, "yes" if said["accepted"] else "no", said.get("figure", ""), lost.get(name, "")))
                failed += not said["accepted"]
            except (RuntimeError, subprocess.SubprocessError, OSError, ValueError, KeyError) as error:
                failed += 1
                rows.append((name, script.name, f"no: {error}", "", lost.get(name, "")))
            print(*rows[-1][:4], sep=" | ", flush=True)
    if not args.names:
        lines = ["# Formats and their own readers", "", "Made by `tests/readers/run.py`.", "",
                 "| format | reader | accepted | figure of what it is for | lost when Sceneloom reads it again |", "|---|---|---|---|---|"]
        lines += [f"| {' | '.join(str(c).replace('|', '/') for c in row)} |" for row in rows]
        args.table.write_text("\n".join(lines) + "\n")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
