"""Trained weights of the refiner -> assets/weights (f16, card) and the golden of its parity test.

python export_refiner.py --weights RUNS/refiner.safetensors --data-command "..."
"""
import torch

from export import GOLDEN_TIMES, uniform
from export_layout import export_net
from models.refiner import Refiner, RefinerConfig

ROWS, COLUMNS = 14, 22  # fine cells of the golden's window


@torch.no_grad()
def golden(net):
    """v of a window at three times."""
    x, rough, told = (uniform(ROWS * COLUMNS * 16, stream).view(1, ROWS, COLUMNS, 16) for stream in (5, 6, 8))
    coarse = uniform(ROWS * COLUMNS // 4 * 8, 7).view(1, ROWS // 2, COLUMNS // 2, 8)
    return {"t": torch.tensor(GOLDEN_TIMES), "v": torch.stack([net(x, torch.tensor([t]), rough, told, coarse).reshape(-1) for t in GOLDEN_TIMES])}


if __name__ == "__main__":
    export_net(__doc__, "refiner", lambda config: Refiner(RefinerConfig(**config)), golden, kept=("vaes", "fine"))
