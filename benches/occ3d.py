"""Reading and writing a frame of Occ3D labels with both masks: ours beside NumPy (`np.load`, `np.savez_compressed`), in turns
in one run. Needs numpy, and `cargo bench -p sceneloom-formats --bench occ3d --no-run` before it. Ends with 1 if ours takes more
than one and a half times as long."""
import glob
import json
import os
import random
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np

ROOT = Path(__file__).resolve().parents[1]
MOST = 1.5
NAMES = ("semantics", "mask_lidar", "mask_camera")


def binary():
    target = Path(os.environ.get("CARGO_TARGET_DIR", ROOT / "target"))
    built = [p for p in glob.glob(str(target / "release/deps/occ3d-*")) if "." not in Path(p).name]
    if not built:
        sys.exit("no binary: cargo bench -p sceneloom-formats --bench occ3d --no-run")
    return max(built, key=os.path.getmtime)


def main(runs=41, warm=5):
    with tempfile.TemporaryDirectory() as folder:
        ours = subprocess.Popen([binary(), folder], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
        if ours.stdout.readline().strip() != "ready":
            sys.exit("ours did not start")
        path, theirs_path = Path(folder) / "labels.npz", Path(folder) / "theirs.npz"
        arrays = {name: np.load(path)[name] for name in NAMES}

        def ask(job):
            ours.stdin.write(job + "\n")
            ours.stdin.flush()
            return float(ours.stdout.readline().split()[0])

        def read():
            file = np.load(path)
            for name in NAMES:
                if file[name].shape != (200, 200, 16):
                    sys.exit(f"{name} has another shape")

        def timed(run):
            begun = time.perf_counter()
            run()
            return (time.perf_counter() - begun) * 1e3

        report, within = {"numpy": np.__version__, "load": round(os.getloadavg()[0], 1)}, True
        peers = {"read": read, "write": lambda: np.savez_compressed(theirs_path, **arrays)}
        for job, theirs in peers.items():
            times = {"ours": [], "numpy": []}
            for turn in range(runs + warm):
                for side in random.sample(["ours", "numpy"], 2):
                    ms = ask(job) if side == "ours" else timed(theirs)
                    if turn >= warm:
                        times[side].append(ms)
            medians = {side: statistics.median(ms) for side, ms in times.items()}
            ratio = medians["ours"] / medians["numpy"]
            within &= ratio <= MOST
            report[job] = {f"{side}_ms": round(ms, 3) for side, ms in medians.items()} | {"ratio": round(ratio, 3)}
        report["bytes"] = {p.stem: p.stat().st_size for p in (Path(folder) / "ours.npz", theirs_path)}
        report["import_with_inference_ms"] = round(statistics.median(ask("import") for _ in range(9)), 2)
        print(json.dumps(report))
        return 0 if within else 1


sys.exit(main())
