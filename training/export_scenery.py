"""Trained weights of the scenery network -> assets/weights (f16, card) and the golden of its parity test.

python export_scenery.py --weights RUNS/scenery.safetensors --data-command "..."
"""
import argparse
import json
from pathlib import Path

import torch
from safetensors.torch import load_file, save_file

from export import GOLDEN_TIMES, ROOT, golden_columns, golden_layout, read, uniform
from export_layout import write_card
from models.scenery import MAP, SIDE, Scenery, SceneryConfig, layout_of, map_of


@torch.no_grad()
def golden(net):
    """v of a noisy map at three times: cells of a rectangle are drawn, the others hear what stands."""
    bev, columns = golden_layout()[None], golden_columns()[None]
    x, drawn = uniform(SIDE * SIDE * MAP, 4).view(1, SIDE, SIDE, MAP), torch.zeros(1, SIDE, SIDE)
    drawn[:, 20:77, 31:90] = 1
    stands, ground = map_of(columns), columns[:, ::2, ::2, 4].float() / 16
    named = torch.tensor([[0.25, 0.0, 0.75, 1.0, 0.0, 1.0]])
    out = [net(x, torch.tensor([t]), layout_of(bev), ground, drawn, stands * (1 - drawn[..., None]), named) for t in GOLDEN_TIMES]
    return {"t": torch.tensor(GOLDEN_TIMES), "every_fifth_v": torch.stack([v.reshape(-1)[::5] for v in out])}


def main():
    p = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    p.add_argument("--weights", type=Path, required=True)
    p.add_argument("--data-command", required=True, help="how the data were made, for the card")
    p.add_argument("--folder", type=Path, default=ROOT / "assets/weights")
    p.add_argument("--goldens", type=Path, default=ROOT / "tests/reference")
    args = p.parse_args()
    tensors, meta = read(args.weights)
    if meta.get("kind") != "scenery":
        raise SystemExit(f"{args.weights}: expected weights of scenery, found {meta.get('kind')}")
    meta = {k: meta[k] for k in ("kind", "config", "seed", "steps", "samples", "minutes")}
    out = write_card(args.folder, "scenery", args.weights, tensors, meta, args.data_command, f"{float(meta['minutes']) / 60:.2f} h")
    net = Scenery(SceneryConfig(**json.loads(meta["config"]))).eval()
    net.load_state_dict({k: v.float() for k, v in load_file(out).items()})
    save_file(golden(net), args.goldens / "parity_scenery.safetensors")


if __name__ == "__main__":
    main()
