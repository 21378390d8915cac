"""Trained temporal decoder -> assets/weights (f16, card) and the golden of its parity test.

python export_time_decoder.py --weights RUNS/time_decoder.safetensors --data-command "..."
The golden is what three frames of latents become, every fiftieth number.
"""
import torch

from export import uniform
from export_layout import export_net
from export_time import POSES
from models.time_decoder import TimeDecoder, TimeDecoderConfig, cell_warp


@torch.no_grad()
def golden(net):
    latents = uniform(60000, 9).view(1, 3, 50, 50, 8)
    return {"every_fiftieth_latent": net(latents, cell_warp(torch.tensor([POSES]))).reshape(-1)[::50].contiguous()}


if __name__ == "__main__":
    export_net(__doc__, "time_decoder", lambda config: TimeDecoder(TimeDecoderConfig(**config)), golden, kept=("vae",))
