"""python3 benches/paired.py BEFORE AFTER [ROUNDS]: two built programs on the bundled scene, taking turns.

Prints the median wall time of each command and their ratio, and whether both made the same voxels, pixels and arrays
(needs numpy and pillow)."""
import hashlib
import json
import statistics
import subprocess
import sys
import tempfile
import time
import zipfile
from pathlib import Path

import numpy as np
from PIL import Image

SCENE = Path(__file__).parent.parent / "assets/scenes/first_light.loom"


def commands(edits, out):
    """Name of the job: arguments, and what it writes."""
    return {
        "edit": (["edit", SCENE, "--edits", edits, "-o", out / "e.loom"], "e.loom"),
        "generate": (["generate", SCENE, "--bare", "--seed", "3", "-o", out / "g.loom"], "g.loom"),
        "views": (["render", SCENE, "--what", "semantic,depth", "--size", "400x225", "-o", out / "v"], "v"),
        "large": (["render", SCENE, "--what", "semantic,depth", "--size", "800x450", "-o", out / "w"], "w"),
        "shapes": (["render", SCENE, "--what", "semantic", "--source", "shapes", "--size", "800x450", "-o", out / "s"], "s"),
        "picture": (["render", SCENE, "--what", "appearance", "--preview", "--size", "240x135", "-o", out / "p"], "p"),
        "lidar": (["render", SCENE, "--what", "lidar", "--lidar", "learned", "-o", out / "l"], "l"),
    }


def contents(path):
    """What a file holds, whatever way it is packed."""
    if path.suffix == ".loom":
        file = zipfile.ZipFile(path)
        names = ["canvas/occupancy.u8", "frames/00000/occupancy.u8"]  # since version 5, and before
        held = next(name for name in names if name in file.namelist())
        return hashlib.sha1(file.read(held)).hexdigest()
    if path.suffix == ".png":
        return hashlib.sha1(np.array(Image.open(path)).tobytes()).hexdigest()
    if path.suffix == ".npz":
        arrays = np.load(path)
        return [(k, hashlib.sha1(arrays[k].tobytes()).hexdigest()) for k in sorted(arrays.files)]
    return path.read_bytes()


def main(before, after, rounds=5):
    with tempfile.TemporaryDirectory() as folder:
        folder = Path(folder)
        edits = folder / "edits.json"
        edits.write_text(json.dumps([{"remove_box": {"id": 1}}]))
        sides = {}
        for name, program in (("before", before), ("after", after)):
            (folder / name).mkdir()
            sides[name] = (program, commands(edits, folder / name))
        for job in sides["before"][1]:
            took_s = {name: [] for name in sides}
            for turn in range(rounds + 1):
                for name in sorted(sides, reverse=turn % 2 == 0):
                    program, jobs = sides[name]
                    start = time.perf_counter()
                    subprocess.run([program, *jobs[job][0]], check=True, capture_output=True)
                    took_s[name].append(time.perf_counter() - start)
            # The first turn fills the caches.
            b, a = (statistics.median(took_s[name][1:]) for name in ("before", "after"))
            made = folder / "before" / sides["before"][1][job][1]
            files = sorted(made.iterdir()) if made.is_dir() else [made]
            other = [f.name for f in files
                     if contents(f) != contents(folder / "after" / f.relative_to(folder / "before"))]
            print(f"{job:9} {b:.3f} s {a:.3f} s ratio {a / b:.2f}; {len(files)} files, other contents: {other or 'none'}")


if __name__ == "__main__":
    main(sys.argv[1], sys.argv[2], *(int(n) for n in sys.argv[3:4]))
