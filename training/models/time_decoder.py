"""Temporal decoder: what the shipped decoder of the VAE is given of T frames of a drive, so that they do not flicker. After UniScene's decoder
(2412.05435), whose layers attend over time.

Every cell (1.6 m) hears the cells of all frames that lie at its place of the world (`cell_warp`): one key per frame; frames in which the place is
out of sight are left out. Another frame's cells lie somewhere between one's own, so the lift looks one cell around itself, and what is heard is
weighed, channel by channel, by where in its cell the place lies (`OFFSETS` numbers per pair of cells, as in the temporal transformer): that
is how neighbours are interpolated. The result is added to the latents; the head begins at zero, so the decoder begins as the shipped one.
"""
import json
from dataclasses import asdict, dataclass

import torch
from safetensors import safe_open
from safetensors.torch import load_file
from torch import nn
from torch.nn import functional as F

from models.occ_dit_time import HALF_M, OFFSETS, TOKEN_M, warp
from models.occ_vae import CELLS

CELL_M = 1.6


@dataclass
class TimeDecoderConfig:
    latent: int = 8
    width: int = 64
    heads: int = 4
    blocks: int = 2

    def as_dict(self):
        return asdict(self)


def cell_warp(pose, side=CELLS, cell_m=CELL_M):
    """`warp` between squares of `cell_m` instead of tokens, `side` x `side` of them around each vehicle: tokens of a world that much larger."""
    pose = torch.cat([pose[..., :2] * (TOKEN_M / cell_m), pose[..., 2:]], -1)
    return warp(pose, pose.new_full((len(pose), 2), HALF_M / TOKEN_M - side / 2), side)


def window_pose(pose, corner, side):
    """A window of `side` cells is what a vehicle in its middle would see: the poses [B,T,3] of such vehicles, corner [B,T,2] in cells of each frame."""
    x, y = ((corner + side / 2) * CELL_M - HALF_M).to(pose.dtype).unbind(-1)
    cos, sin = pose[..., 2].cos(), pose[..., 2].sin()
    return torch.stack([pose[..., 0] + cos * x - sin * y, pose[..., 1] + sin * x + cos * y, pose[..., 2]], -1)


class CellBlock(nn.Module):
    """Attention of each cell over the frames, then an MLP."""

    def __init__(self, width, heads):
        super().__init__()
        self.heads = heads
        self.norm1, self.norm2 = nn.LayerNorm(width, eps=1e-6), nn.LayerNorm(width, eps=1e-6)
        self.q = nn.Linear(width, width)
        self.kv = nn.Linear(width, 2 * width)
        self.q_offset = nn.Linear(width, heads * OFFSETS)
        self.kv_offset = nn.Linear(OFFSETS, 2 * width, bias=False)
        self.proj = nn.Linear(width, width)
        self.fc1 = nn.Linear(width, 2 * width)
        self.fc2 = nn.Linear(2 * width, width)
        for layer in (self.q_offset, self.kv_offset):
            nn.init.zeros_(layer.weight)
        nn.init.zeros_(self.q_offset.bias)

    def forward(self, x, index, seen, offset):
        """x [B,T,N,width], the rest of `cell_warp`."""
        b, t, s, n = index.shape
        width, heads = x.shape[-1], self.heads
        d = width // heads
        y = self.norm1(x)
        flat = (index + (torch.arange(s, device=x.device) * n)[:, None]).reshape(b, -1, 1).expand(-1, -1, 2 * width)
        there = self.kv(y).view(b, s * n, 2 * width).gather(1, flat).view(b, t, s, n, 2 * width) * (1 + self.kv_offset(offset))
        k, v = there.view(b, t, s, n, 2, heads, d).unbind(4)
        at = self.q_offset(y).view(b, t, 1, n, heads, OFFSETS)
        score = (self.q(y).view(b, t, 1, n, heads, d) * k).sum(-1) * d**-0.5 + (at * offset[..., None, :].to(at.dtype)).sum(-1)
        a = score.float().masked_fill(~seen[..., None], -1e9).softmax(2)
        x = x + self.proj((a[..., None].to(v.dtype) * v).sum(2).reshape(x.shape))
        return x + self.fc2(F.gelu(self.fc1(self.norm2(x))))


class TimeDecoder(nn.Module):
    INNER = r"blocks\.\d+\.(q|kv|proj|fc1|fc2)"  # layers whose weights Muon trains

    def __init__(self, config=None):
        super().__init__()
        c = self.config = config or TimeDecoderConfig()
        self.lift = nn.Conv2d(c.latent, c.width, 3, padding=1)
        self.blocks = nn.ModuleList(CellBlock(c.width, c.heads) for _ in range(c.blocks))
        self.head = nn.Linear(c.width, c.latent)
        nn.init.zeros_(self.head.weight)
        nn.init.zeros_(self.head.bias)

    def forward(self, latents, warped):
        """Normalised latents [B,T,x,y,8], warped of `cell_warp` -> latents for the decoder."""
        b, t, h, w, _ = latents.shape
        x = self.lift(latents.flatten(0, 1).permute(0, 3, 1, 2)).permute(0, 2, 3, 1).reshape(b, t, h * w, -1)
        for block in self.blocks:
            x = block(x, *warped)
        return latents + self.head(x).float().view(latents.shape)


def load_time_decoder(path, device):
    """The network of a file of weights, which learns no more."""
    with safe_open(path, "pt") as f:
        net = TimeDecoder(TimeDecoderConfig(**json.loads(f.metadata()["config"])))
    net.load_state_dict({k: v.float() for k, v in load_file(path).items()})
    return net.to(device).eval().requires_grad_(False)
