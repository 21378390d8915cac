"""Both sides in one run: our binary (`cargo bench --bench peers --no-run`) is started once and asked for one job at a time,
between the peer's runs. Medians, least, ratio."""
import argparse
import glob
import importlib.util
import os
import random
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]


def needs(*names):
    """Ends the script with one line if a package is missing."""
    missing = [n for n in names if importlib.util.find_spec(n) is None]
    if missing:
        print(f"{Path(sys.argv[0]).stem}: not compared, this Python lacks {', '.join(missing)} (benches/peers/setup.sh)")
        sys.exit(3)


def arguments():
    p = argparse.ArgumentParser()
    p.add_argument("--runs", type=int, default=21, help="timed runs of each side, after three to warm up")
    p.add_argument("--threads", type=int, default=len(os.sched_getaffinity(0)), help="of both sides")
    return p.parse_args()


class Ours:
    """Our side: a process that does one job when told."""

    def __init__(self, threads):
        found = os.environ.get("SCENELOOM_PEERS")
        built = [p for p in glob.glob(str(ROOT / "target/release/deps/peers-*")) if "." not in Path(p).name]
        if not found and not built:
            sys.exit("no binary: cargo bench --bench peers --no-run")
        binary = found or max(built, key=os.path.getmtime)
        self.folder = tempfile.TemporaryDirectory()
        env = os.environ | {"RAYON_NUM_THREADS": str(threads)}
        self.process = subprocess.Popen([binary, self.folder.name], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True, env=env)
        answer = self.process.stdout.readline().split()
        if not answer or answer[0] != "ready":
            sys.exit(f"{binary} did not start")
        self.threads = int(answer[1])

    def arrays(self, framework="np"):
        from safetensors import safe_open
        with safe_open(Path(self.folder.name) / "ours.safetensors", framework) as f:
            return {k: f.get_tensor(k) for k in f.keys()}

    def __call__(self, job):
        """Milliseconds of one job."""
        self.process.stdin.write(job + "\n")
        self.process.stdin.flush()
        return float(self.process.stdout.readline().split()[0])


def load():
    return f"load {os.getloadavg()[0]:.1f} on {len(os.sched_getaffinity(0))} cores"


def beside(what, ours, theirs, runs, peer, warm=3):
    """Times `ours` (milliseconds come back) and `theirs` (is timed here) in random turns; prints one line."""
    times = {"ours": [], "theirs": []}
    order = ["ours", "theirs"] * (runs + warm)
    pairs = [order[i:i + 2] for i in range(0, len(order), 2)]
    for i, pair in enumerate(pairs):
        random.shuffle(pair)
        for side in pair:
            if side == "ours":
                ms = ours()
            else:
                begun = time.perf_counter()
                theirs()
                ms = (time.perf_counter() - begun) * 1e3
            if i >= warm:
                times[side].append(ms)
    a, b = times["ours"], times["theirs"]
    ma, mb = statistics.median(a), statistics.median(b)
    print(f"{what:<26} ours {ma:9.2f} ms (least {min(a):.2f})   {peer} {mb:9.2f} ms (least {min(b):.2f})   "
          f"ours takes {ma / mb:.2f} of its time   n {runs}, {load()}")
    return ma, mb


def agrees(what, found, truth, tolerance):
    """The largest difference relative to the largest value; ends the script if it is too large."""
    import numpy as np
    found, truth = np.asarray(found, np.float64), np.asarray(truth, np.float64)
    gap = np.abs(found - truth).max() / max(np.abs(truth).max(), 1e-300)
    print(f"{what:<26} agree within {gap:.1e} of the largest value (allowed {tolerance:g})")
    if not gap <= tolerance:
        sys.exit(f"{what}: the two sides compute different things")
