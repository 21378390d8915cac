"""Trained temporal blocks -> assets/weights (f16, card) and the golden of their parity test.

python export_time.py --weights RUNS/time.safetensors --data-command "..."
The golden is v of three frames with the shipped transformer, every fiftieth number.
"""
from pathlib import Path

import torch

from export import golden_condition, uniform
from export_layout import export_net
from models.occ_dit_time import OccDitTime, TimeConfig, warp
from train_time import load_dit

POSES = [[0.0, 0.0, 0.0], [3.1, 0.4, 0.05], [12.9, 1.2, 0.4]]
TIMES = (999.0, 250.0)


@torch.no_grad()
def golden(net):
    cells, named = golden_condition()
    three = lambda v: v.expand(3, *v.shape[1:])
    condition = net.base.condition(three(cells), three(named))
    warped = warp(torch.tensor([POSES]), same_cell=net.config.same_cell)
    x = uniform(60000, 9).view(3, 50, 50, 8)
    v = [net(x, torch.full((3,), t), condition, warped).reshape(-1)[::50] for t in TIMES]
    return {"t": torch.tensor(TIMES), "every_fiftieth_v": torch.stack(v)}


if __name__ == "__main__":
    dit = Path(__file__).resolve().parent.parent / "assets/weights/occ_dit.safetensors"
    export_net(__doc__, "occ_dit_time", lambda config: OccDitTime(load_dit(dit), TimeConfig(**config)), golden, kept=("vae",))
