"""Trained weights of the scenery network -> assets/weights (f16, card) and the golden of its parity test.

python export_scenery.py --weights RUNS/scenery.safetensors --data-command "..."
"""
import torch

from export import GOLDEN_TIMES, golden_columns, golden_layout, uniform
from export_layout import export_net
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


if __name__ == "__main__":
    export_net(__doc__, "scenery", lambda config: Scenery(SceneryConfig(**config)), golden)
