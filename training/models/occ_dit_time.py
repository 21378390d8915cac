"""Temporal blocks for the occupancy transformer. Rust twin: src/gen/nets/occ_dit/time.rs.

T frames of a drive go through the blocks of the single-frame transformer (occ_dit.py); after every `every`-th of them a temporal block lets each
token hear the tokens of all frames that lie at its place of the world (`warp`): one key per frame, that of the token whose square holds the
place; frames in which the place is out of sight are left out. `same_cell` takes the same token of each frame instead, as UniScene does (2412.05435).
What the squares do not say (where in its square the place lies, how the vehicle has turned, how much time lies between) is `OFFSETS` numbers per
pair of tokens, which the queries weigh and the values carry. Gates begin at zero: the network begins as the single-frame one.
"""
import math
from dataclasses import asdict, dataclass

import torch
from torch import nn
from torch.nn import functional as F

from models.occ_dit import SIDE, OccDit, modulate, patchify, timestep_embedding, unpatchify

TOKEN_M, HALF_M = 3.2, 40.0
OFFSETS = 8


@dataclass
class TimeConfig:
    width: int = 192
    heads: int = 3
    blocks: int = 4
    every: int = 2
    same_cell: bool = False

    def as_dict(self):
        return asdict(self)


def warp(pose, corner=None, side=SIDE, step_s=0.5, same_cell=False):
    """Which token of frame s lies where token n of frame t does. pose f32 [B,T,3] (x and y in m, heading in rad); corner i64 [B,2] of a window
    of `side` tokens. Returns index i64 [B,T,S,N] into the window's tokens, seen bool of the same shape, offset f32 [B,T,S,N,OFFSETS]."""
    b, t, _ = pose.shape
    corner = torch.zeros(b, 2, dtype=torch.long) if corner is None else corner
    at = torch.arange(side, dtype=torch.float64)
    grid = torch.stack(torch.meshgrid(at, at, indexing="ij"), -1).view(1, -1, 2) + corner[:, None].double()  # tokens
    p = (grid + 0.5) * TOKEN_M - HALF_M  # [B,N,2] m
    pose = pose.double()
    yaw = pose[..., 2]
    turn = torch.stack([yaw.cos(), -yaw.sin(), yaw.sin(), yaw.cos()], -1).view(b, t, 2, 2)
    world = torch.einsum("btij,bnj->btni", turn, p) + pose[:, :, None, :2]
    from_s = world[:, :, None] - pose[:, None, :, None, :2]  # [B,T,S,N,2]
    q = torch.einsum("bsji,btsnj->btsni", turn, from_s)
    place = (q + HALF_M) / TOKEN_M - corner[:, None, None, None].double()
    cell = place.floor()
    if same_cell:
        cell = (grid - corner[:, None].double())[:, None, None].expand_as(place)
    seen = ((cell >= 0) & (cell < side)).all(-1)
    index = (cell[..., 0] * side + cell[..., 1]).clamp(0, side * side - 1).long()
    aside = (place - cell - 0.5).clamp(-1, 1)
    dyaw = (yaw[:, :, None] - yaw[:, None])[..., None]  # [B,T,S,1]
    apart = ((torch.arange(t)[:, None] - torch.arange(t)[None]) * step_s).double()[None, :, :, None]
    offset = torch.stack([aside[..., 0], aside[..., 1], *(v.expand_as(aside[..., 0]) for v in (
        dyaw.cos(), dyaw.sin(), apart / 2, apart.abs() / 2, (apart == 0).double(), torch.ones_like(apart)))], -1)
    return index, seen, offset.float()


class TimeBlock(nn.Module):
    def __init__(self, width, heads):
        super().__init__()
        self.heads = heads
        self.ada = nn.Linear(width, 6 * width)
        self.qkv = nn.Linear(width, 3 * width)
        self.q_offset = nn.Linear(width, heads * OFFSETS)
        self.v_offset = nn.Linear(heads * OFFSETS, width, bias=False)
        self.proj = nn.Linear(width, width)
        self.fc1 = nn.Linear(width, 2 * width)
        self.fc2 = nn.Linear(2 * width, width)
        for layer in (self.qkv, self.proj, self.fc1, self.fc2):
            nn.init.xavier_uniform_(layer.weight)
            nn.init.zeros_(layer.bias)
        for layer in (self.q_offset, self.ada):
            nn.init.zeros_(layer.weight)
            nn.init.zeros_(layer.bias)

    def forward(self, x, c, index, seen, offset):
        """x [B*T,h,w,width], c [B*T,width], the rest of `warp`."""
        b, t, s, n = index.shape
        width, heads = x.shape[-1], self.heads
        d = width // heads
        shift1, scale1, gate1, shift2, scale2, gate2 = self.ada(c).view(b * t, 6, 1, 1, width).unbind(1)
        y = modulate(x, shift1, scale1)
        q, k, v = self.qkv(y).view(b, t, n, 3, width).unbind(3)
        flat = (index + (torch.arange(s, device=x.device) * n)[:, None]).reshape(b, -1, 1).expand(-1, -1, width)

        def there(of):
            return of.reshape(b, s * n, width).gather(1, flat).view(b, t, s, n, heads, d)

        at = self.q_offset(y).view(b, t, 1, n, heads, OFFSETS)
        score = (q.view(b, t, 1, n, heads, d) * there(k)).sum(-1) * d**-0.5 + (at * offset[..., None, :].to(at.dtype)).sum(-1)
        score = score.float().masked_fill(~seen[..., None], -1e9)
        a = score.softmax(2)
        out = (a[..., None].to(v.dtype) * there(v)).sum(2).reshape(x.shape)
        where = (a[..., None] * offset[..., None, :]).sum(2).reshape(*x.shape[:3], heads * OFFSETS)
        out = self.proj(out + self.v_offset(where.to(out.dtype)))
        x = torch.addcmul(x, gate1, out)
        return torch.addcmul(x, gate2, self.fc2(F.gelu(self.fc1(modulate(x, shift2, scale2)))))


class OccDitTime(nn.Module):
    """The single-frame transformer, whose weights stay, with temporal blocks between its own."""

    INNER = r"blocks\.\d+\.(qkv|proj|fc1|fc2)"

    def __init__(self, base: OccDit, config=None):
        super().__init__()
        self.config = config or TimeConfig(width=base.config.width, heads=base.config.heads, blocks=base.config.depth // 2)
        object.__setattr__(self, "base", base)  # not a part of it: neither saved nor trained
        self.blocks = nn.ModuleList(TimeBlock(self.config.width, self.config.heads) for _ in range(self.config.blocks))

    def forward(self, x, t, condition, warped):
        """x [B*T,x,y,8], t [B*T], condition of `OccDit.condition` for B*T frames, warped of `warp` -> v."""
        base = self.base
        tokens, draft, named, given = condition
        c = F.silu(base.time2(F.silu(base.time1(timestep_embedding(t, base.config.frequencies)))) + named)
        h = base.embed_x(patchify(x)) + tokens
        for i, block in enumerate(base.blocks):
            h = block(h, c)
            if (i + 1) % self.config.every == 0 and (place := (i + 1) // self.config.every - 1) < len(self.blocks):
                h = self.blocks[place](h, c, *warped)
        shift, scale = base.final_ada(c).view(len(c), 2, 1, 1, -1).unbind(1)
        v = unpatchify(base.final(modulate(h, shift, scale)).float())
        gates = base.skip(c).float()[:, None, None] + given * base.skip_given(c).float()[:, None, None]
        of_x, of_draft = gates.chunk(2, -1)
        return v + of_x * x + of_draft * draft
