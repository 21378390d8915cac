"""Latent diffusion transformer for occupancy. Rust twin: src/gen/model/occ_dit.rs.

Inputs per 50x50 cell: noisy latent 8 | edit mask 1 (1 = generate), clean context latent 8 (0 where the mask is 1),
draft latent 8 (the VAE's encoding of the layout extruded naively), 18 layout layers of the cell's 4x4 columns (288),
mean cosine and sine of the headings of its objects (2), whether its background is given (1): then the draft holds all that
stands beside the road, and nothing else stands there; where it is not given, the network invents it. Four numbers are given by name beside the timestep, each with a
flag that says whether it is given: vegetation, building, clutter, completeness (`data.named`).
A token is 2x2 cells: 625 tokens. Predicts v = alpha eps - sigma x0 (Salimans and Ho, 2202.00512).
Blocks: adaLN-Zero (Peebles and Xie, 2212.09748). The draft is close to the answer nearly everywhere, and the best linear
guess of v from the noisy latent and the draft depends on the timestep alone: a gate per channel gives that guess, so the
blocks only learn what is different. Where the background is given the draft says more, so cells have a second gate there.
"""
import math
from dataclasses import asdict, dataclass

import torch
from torch import nn
from torch.nn import functional as F

CELLS = 50
PATCH = 2
TOKENS = (CELLS // PATCH) ** 2
LAYERS = 18
HEADINGS = 240  # a heading h > 0 is the yaw (h - 1) / 240 of a turn
NAMED = 4


@dataclass
class DitConfig:
    latent: int = 8
    width: int = 256
    depth: int = 8
    heads: int = 4
    frequencies: int = 256  # of the timestep embedding
    given: bool = False  # hears whether the background is given

    def as_dict(self):
        return asdict(self)


def positions(width):
    """Fixed sin-cos of the 25x25 token grid: first half of the channels the column (y), second half the row (x)."""
    side = CELLS // PATCH
    omega = 1.0 / 10000 ** (torch.arange(width // 4, dtype=torch.float64) / (width / 4))
    angle = torch.arange(side, dtype=torch.float64)[:, None] * omega
    axis = torch.cat([angle.sin(), angle.cos()], 1)  # [25, width/2]
    return torch.cat([axis.repeat(side, 1), axis.repeat_interleave(side, 0)], 1).float()


def timestep_embedding(t, dim):
    """[cos | sin] of t * 10000^(-i/half), t in 0..=999, fractions allowed."""
    half = dim // 2
    freq = torch.exp(-math.log(10000) * torch.arange(half, dtype=torch.float64) / half).to(t.device)
    args = t.double()[:, None] * freq
    return torch.cat([args.cos(), args.sin()], 1).float()


def unshuffle_layout(bev):
    """i32 bits [B,200,200] -> 0/1 floats [B,50,50,288], channel (dx*4 + dy)*18 + layer."""
    b = bev.shape[0]
    cells = bev.view(b, CELLS, 4, CELLS, 4).permute(0, 1, 3, 2, 4).reshape(b, CELLS, CELLS, 16, 1)
    bits = (cells >> torch.arange(LAYERS, dtype=bev.dtype, device=bev.device)) & 1
    return bits.reshape(b, CELLS, CELLS, 16 * LAYERS).float()


def cell_headings(heading):
    """u8 [B,200,200] -> [B,50,50,2]: sums of cosines and sines over a cell's columns, / 16."""
    b = heading.shape[0]
    angle = (heading.float() - 1) * (2 * math.pi / HEADINGS)
    both = torch.stack([angle.cos(), angle.sin()], -1) * (heading > 0)[..., None]
    return both.view(b, CELLS, 4, CELLS, 4, 2).mean((2, 4))


def patchify(x):
    """[B,50,50,C] -> tokens [B,625,4*C], order (row in patch, column in patch, channel)."""
    b, c, s = x.shape[0], x.shape[-1], CELLS // PATCH
    return x.view(b, s, PATCH, s, PATCH, c).permute(0, 1, 3, 2, 4, 5).reshape(b, TOKENS, PATCH * PATCH * c)


def unpatchify(x, c):
    """The inverse of patchify."""
    b, s = x.shape[0], CELLS // PATCH
    return x.view(b, s, s, PATCH, PATCH, c).permute(0, 1, 3, 2, 4, 5).reshape(b, CELLS, CELLS, c)


def modulate(x, shift, scale):
    return torch.addcmul(shift[:, None], F.layer_norm(x, x.shape[-1:], eps=1e-6), 1 + scale[:, None])


class Block(nn.Module):
    def __init__(self, width, heads):
        super().__init__()
        self.heads = heads
        self.ada = nn.Linear(width, 6 * width)
        self.qkv = nn.Linear(width, 3 * width)
        self.proj = nn.Linear(width, width)
        self.fc1 = nn.Linear(width, 4 * width)
        self.fc2 = nn.Linear(4 * width, width)
        for layer in (self.qkv, self.proj, self.fc1, self.fc2):
            nn.init.xavier_uniform_(layer.weight)
            nn.init.zeros_(layer.bias)
        nn.init.zeros_(self.ada.weight)
        nn.init.zeros_(self.ada.bias)

    def forward(self, x, c):
        shift1, scale1, gate1, shift2, scale2, gate2 = self.ada(c).chunk(6, 1)
        b, n, w = x.shape
        q, k, v = self.qkv(modulate(x, shift1, scale1)).view(b, n, 3, self.heads, w // self.heads).permute(2, 0, 3, 1, 4)
        a = F.scaled_dot_product_attention(q, k, v).transpose(1, 2).reshape(b, n, w)
        x = torch.addcmul(x, gate1[:, None], self.proj(a))
        return torch.addcmul(x, gate2[:, None], self.fc2(F.gelu(self.fc1(modulate(x, shift2, scale2)))))


class OccDit(nn.Module):
    INNER = r"blocks\.\d+\.(qkv|proj|fc1|fc2)"  # layers whose weights Muon trains

    def __init__(self, config=None):
        super().__init__()
        c = self.config = config or DitConfig()
        patch = PATCH * PATCH
        self.embed_x = nn.Linear(patch * c.latent, c.width)
        # mask, context, draft, layout, heading: does not depend on x or t, so computed once per job in Rust.
        self.embed_condition = nn.Linear(patch * (1 + 2 * c.latent + 16 * LAYERS + 2 + c.given), c.width, bias=False)
        self.time1 = nn.Linear(c.frequencies, c.width)
        self.time2 = nn.Linear(c.width, c.width)
        self.named1 = nn.Linear(2 * NAMED, c.width)
        self.named2 = nn.Linear(c.width, c.width)
        self.blocks = nn.ModuleList(Block(c.width, c.heads) for _ in range(c.depth))
        self.final_ada = nn.Linear(c.width, 2 * c.width)
        self.final = nn.Linear(c.width, patch * c.latent)
        self.skip = nn.Linear(c.width, 2 * c.latent)  # gates of the noisy latent and of the draft
        if c.given:
            self.skip_given = nn.Linear(c.width, 2 * c.latent)  # what is added to them where the background is given
            nn.init.zeros_(self.skip_given.weight)
            nn.init.zeros_(self.skip_given.bias)
        self.register_buffer("positions", positions(c.width), persistent=False)
        nn.init.normal_(self.embed_x.weight, std=0.1)
        # Sparse 0/1 inputs: many channels, few of them set at once.
        nn.init.normal_(self.embed_condition.weight, std=0.04)
        for layer in (self.time1, self.time2):
            nn.init.normal_(layer.weight, std=0.02)
        for layer in (self.named2, self.final_ada, self.final, self.skip):
            nn.init.zeros_(layer.weight)
            nn.init.zeros_(layer.bias)

    def condition(self, mask, context, draft, layout, heading, named, given):
        """mask [B,50,50], context, draft [B,50,50,8], layout [B,50,50,288], heading [B,50,50,2], named [B,8] (values, 0
        where not given, then flags), given [B,50,50,1] (is the background?) -> tokens [B,625,width], the draft, what is
        added to the embedded time, given."""
        parts = [mask[..., None], context, draft, layout, heading] + [given] * self.config.given
        tokens = self.embed_condition(patchify(torch.cat(parts, -1)))
        return tokens + self.positions, draft, self.named2(F.silu(self.named1(named))), given

    def forward(self, x, t, condition):
        """x [B,50,50,8], t [B] in 0..=999, condition from above -> v [B,50,50,8]."""
        tokens, draft, named, given = condition
        time = self.time2(F.silu(self.time1(timestep_embedding(t, self.config.frequencies))))
        c = F.silu(time + named)
        h = self.embed_x(patchify(x)) + tokens
        for block in self.blocks:
            h = block(h, c)
        shift, scale = self.final_ada(c).chunk(2, 1)
        v = unpatchify(self.final(modulate(h, shift, scale)).float(), self.config.latent)
        gates = self.skip(c).float()[:, None, None]
        if self.config.given:
            gates = gates + given * self.skip_given(c).float()[:, None, None]
        of_x, of_draft = gates.chunk(2, -1)
        return v + of_x * x + of_draft * draft
