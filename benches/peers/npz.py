"""Reading a frame of Occ3D labels from a compressed npz: ours (checked, and put into bricks) beside NumPy (checked)."""
from common import Ours, arguments, beside, needs

needs("numpy", "safetensors")
import sys
from pathlib import Path

import numpy as np


def main():
    args = arguments()
    ours = Ours(args.threads)
    path = Path(ours.folder.name) / "labels.npz"

    def read():
        labels = np.load(path)["semantics"]
        if labels.shape != (200, 200, 16) or labels.max() > 17:
            raise ValueError("not a frame")
        return labels

    if not np.array_equal(read(), ours.arrays()["labels"]):
        sys.exit("the two sides read different things")
    beside("npz, one frame", lambda: ours("npz"), read, 5 * args.runs, f"NumPy {np.__version__}")


main()
