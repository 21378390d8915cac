"""Diffusion in two dimensions that draws what stands beside the roads, as a map of 100x100 cells of 0.8 m. Rust twin:
src/gen/model/scenery.rs, which extrudes the map and reads things off it.

A cell of the map has seven numbers, -1 to 1: whether a building stands there and the height of its top, the same of low man-made things,
whether a plant stands there, the height of its top and of its underside; heights above the ground in `HEIGHTS` bins, -1 where nothing
stands. It hears the layout (eight map layers, whether an object stands there), the height of the ground, which cells are to be drawn,
what stands in the others, and three numbers by name (vegetation, building, clutter), each with a flag. A U-net of residual blocks as in the
VAE; the timestep and the named numbers are added at the start of every level. Predicts v (2202.00512).
"""
from dataclasses import asdict, dataclass

import torch
from torch import nn
from torch.nn import functional as F

from models.occ_dit import timestep_embedding
from models.occ_vae import ChannelNorm, Level, fold, unfold

SIDE = 100  # cells
MAP = 7  # numbers of a cell
LAYERS = 8 + 1  # map layers, and any object
HEIGHTS = 14
LOW = 8  # man-made things whose top stays below this bin are low; `data.LOW`
NAMED = 3
CONDITION = LAYERS + 1 + 1 + MAP  # layout, ground, mask, context


@dataclass
class SceneryConfig:
    widths: tuple = (48, 96, 192)
    kernels: tuple = ((3, 3), (3, 3), (3, 3, 3, 3))  # of each level, finest first; the coarsest is passed once, the others down and up
    frequencies: int = 128

    def as_dict(self):
        return asdict(self)


def by_cell(columns):
    """[B,200,200,...] -> [B,100,100,4,...]."""
    b, x, y, *rest = columns.shape
    cells = columns.view(b, x // 2, 2, y // 2, 2, *rest).transpose(2, 3)
    return cells.reshape(b, x // 2, y // 2, 4, *rest)


def map_of(columns):
    """u8 columns [B,200,200,5] (`models.occ_dit.COLUMN`) -> map [B,100,100,7]. A building or a plant fills a cell if it fills two of its
    columns, low things if they touch it: they are thin."""
    cells = by_cell(columns.float())
    ground = cells[..., 4].amax(3)
    out = []
    for group, high, least in ((0, True, 2), (0, False, 1), (1, None, 2)):
        base, top = cells[..., 2 * group], cells[..., 2 * group + 1]
        held = (top > 0) if high is None else (top > 0) & ((top > LOW) == high)
        stands = held.sum(3) >= least
        height = lambda z: torch.where(stands, (2 * (z - ground) / HEIGHTS - 1).clamp(-1, 1), -1.0)
        top = torch.where(held, top, 0.0).amax(3)
        out += [stands.float() * 2 - 1, height(top)]
        if high is None:
            out.append(height(torch.where(held, base - 1, 99.0).amin(3)))
    return torch.stack(out, -1)


def layout_of(bev):
    """i32 bits [B,200,200] -> [B,100,100,9]: is a layer in any of a cell's columns?"""
    cells = by_cell(bev)
    layers = [((cells >> layer) & 1).amax(3) for layer in range(8)] + [(cells >> 8 != 0).to(bev.dtype).amax(3)]
    return torch.stack(layers, -1).float()


class Scenery(nn.Module):
    INNER = r"(enter|leave|middle|down|up)\."  # layers whose weights Muon trains

    def __init__(self, config=None):
        super().__init__()
        c = self.config = config or SceneryConfig()
        steps = list(zip(c.widths, c.widths[1:]))
        self.stem = nn.Conv2d(MAP + CONDITION, c.widths[0], 1)
        self.time1, self.time2 = nn.Linear(c.frequencies, c.widths[-1]), nn.Linear(c.widths[-1], c.widths[-1])
        self.named = nn.Linear(2 * NAMED, c.widths[-1])
        self.tell = nn.ModuleList(nn.Linear(c.widths[-1], w) for w in (*c.widths, *c.widths[-2::-1]))  # enter, middle, leave
        self.enter = nn.ModuleList(Level(w, k) for w, k in zip(c.widths[:-1], c.kernels))
        self.down = nn.ModuleList(nn.Conv2d(4 * a, b, 1) for a, b in steps)
        self.middle = Level(c.widths[-1], c.kernels[-1])
        self.up = nn.ModuleList(nn.Conv2d(b, 4 * a, 1) for a, b in steps[::-1])
        self.leave = nn.ModuleList(Level(w, k) for w, k in zip(c.widths[-2::-1], c.kernels[-2::-1]))
        self.norm = ChannelNorm(c.widths[0])
        self.head = nn.Conv2d(c.widths[0], MAP, 1)
        nn.init.zeros_(self.head.weight)
        nn.init.zeros_(self.head.bias)

    def forward(self, x, t, layout, ground, mask, context, named):
        """x and context [B,100,100,7], t [B] in 0..=999, layout [B,100,100,9], ground and mask [B,100,100], named [B,6] -> v."""
        h = torch.cat([x, layout, ground[..., None], mask[..., None], context], -1).permute(0, 3, 1, 2)
        h = self.stem(h.contiguous(memory_format=torch.channels_last))
        c = F.silu(self.time2(F.silu(self.time1(timestep_embedding(t, self.config.frequencies)))) + self.named(named))
        tell = iter(self.tell)
        told = lambda x: x + next(tell)(c)[:, :, None, None]
        kept = []
        for level, down in zip(self.enter, self.down):
            h = level(told(h))
            kept.append(h)
            h = down(fold(h))
        h = self.middle(told(h))
        for up, level in zip(self.up, self.leave):
            h = level(told(unfold(up(h)) + kept.pop()))
        return self.head(self.norm(h)).permute(0, 2, 3, 1).float()
