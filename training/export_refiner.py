"""Trained weights of the refiner -> assets/weights (f16, card) and the golden of its parity test.

python export_refiner.py --weights RUNS/refiner.safetensors --data-command "..."
"""
import argparse
import json
from pathlib import Path

import torch
from safetensors.torch import load_file, save_file

from export import GOLDEN_TIMES, ROOT, read, uniform
from export_layout import write_card
from models.refiner import Refiner, RefinerConfig

ROWS, COLUMNS = 14, 22  # fine cells of the golden's window


@torch.no_grad()
def golden(net):
    """v of a window at three times."""
    x, rough, told = (uniform(ROWS * COLUMNS * 16, stream).view(1, ROWS, COLUMNS, 16) for stream in (5, 6, 8))
    coarse = uniform(ROWS * COLUMNS // 4 * 8, 7).view(1, ROWS // 2, COLUMNS // 2, 8)
    return {"t": torch.tensor(GOLDEN_TIMES), "v": torch.stack([net(x, torch.tensor([t]), rough, told, coarse).reshape(-1) for t in GOLDEN_TIMES])}


def main():
    p = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    p.add_argument("--weights", type=Path, required=True)
    p.add_argument("--data-command", required=True, help="how the data were made, for the card")
    p.add_argument("--folder", type=Path, default=ROOT / "assets/weights")
    p.add_argument("--goldens", type=Path, default=ROOT / "tests/reference")
    args = p.parse_args()
    tensors, meta = read(args.weights)
    if meta.get("kind") != "refiner":
        raise SystemExit(f"{args.weights}: expected weights of refiner, found {meta.get('kind')}")
    meta = {k: meta[k] for k in ("kind", "config", "seed", "steps", "samples", "minutes", "vaes", "fine")}
    out = write_card(args.folder, "refiner", args.weights, tensors, meta, args.data_command, f"{float(meta['minutes']) / 60:.2f} h")
    net = Refiner(RefinerConfig(**json.loads(meta["config"]))).eval()
    net.load_state_dict({k: v.float() for k, v in load_file(out).items()})
    save_file(golden(net), args.goldens / "parity_refiner.safetensors")


if __name__ == "__main__":
    main()
