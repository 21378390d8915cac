"""Latent diffusion transformer for occupancy. Rust twin: src/gen/model/occ_dit.rs.

Each 50x50 cell hears the noisy latent (8), and as its condition, `CONDITION` numbers in this order: edit mask (1 = generate), clean
context latent (8, 0 where the mask is 1), draft latent (8: the VAE's encoding of the layout extruded naively), 18 layout layers of its
4x4 columns (288), mean cosine and sine of the headings of its objects (2), whether its man-made and its grown background is given (2),
mask, base and top of both in each column (96), whether the height of its ground is given (1) and that height in each column (16).
Where both kinds of background are given, the draft holds them. Four numbers are given by name beside the timestep, each with a flag
that says whether it is given (vegetation, building, clutter, completeness: `data.named`), and a flag that says whether there is a draft.

A token is 2x2 cells: 625 tokens, or a window of them in training. Predicts v = alpha eps - sigma x0 (Salimans and Ho, 2202.00512).
Blocks: adaLN-Zero (Peebles and Xie, 2212.09748); a depthwise 3x3 convolution over the values is added to what attention finds
(LePE, 2107.00652), so neighbours are heard by place. The draft is close to the answer nearly everywhere, and the best linear
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
SIDE = CELLS // PATCH  # tokens
LAYERS = 18
HEADINGS = 240  # a heading h > 0 is the yaw (h - 1) / 240 of a turn
NAMED = 4
GROUPS = 2  # of the background: man-made, grown
COLUMN = 2 * GROUPS + 1  # bytes of a column: base and top of each group, ground; each in bins, 1 more than the bin, 0 = nothing
HEIGHT = 16
CONDITION = 1 + 8 + 8 + 16 * LAYERS + 2 + GROUPS + 16 * 3 * GROUPS + 1 + 16


@dataclass
class DitConfig:
    latent: int = 8
    width: int = 192
    depth: int = 8
    heads: int = 3
    frequencies: int = 256  # of the timestep embedding
    local: bool = True  # blocks convolve their values

    def as_dict(self):
        return asdict(self)


def positions(width):
    """Fixed sin-cos of the 25x25 token grid [25,25,width]: first half of the channels the column (y), second half the row (x)."""
    omega = 1.0 / 10000 ** (torch.arange(width // 4, dtype=torch.float64) / (width / 4))
    angle = torch.arange(SIDE, dtype=torch.float64)[:, None] * omega
    axis = torch.cat([angle.sin(), angle.cos()], 1)  # [25, width/2]
    return torch.cat([axis.expand(SIDE, -1, -1), axis[:, None].expand(-1, SIDE, -1)], 2).float()


def timestep_embedding(t, dim):
    """[cos | sin] of t * 10000^(-i/half), t in 0..=999, fractions allowed."""
    half = dim // 2
    freq = torch.exp(-math.log(10000) * torch.arange(half, dtype=torch.float64) / half).to(t.device)
    args = t.double()[:, None] * freq
    return torch.cat([args.cos(), args.sin()], 1).float()


def by_cell(columns):
    """[B,4x,4y,...] -> [B,x,y,16,...], column dx * 4 + dy of each cell."""
    b, x, y, *rest = columns.shape
    cells = columns.view(b, x // 4, 4, y // 4, 4, *rest).transpose(2, 3)
    return cells.reshape(b, x // 4, y // 4, 16, *rest)


def layout_of(bev):
    """i32 bits [B,4x,4y] -> 0/1 floats [B,x,y,288], channel (dx*4 + dy)*18 + layer."""
    bits = (by_cell(bev)[..., None] >> torch.arange(LAYERS, dtype=bev.dtype, device=bev.device)) & 1
    return bits.flatten(3).float()


def heading_of(heading):
    """u8 [B,4x,4y] -> [B,x,y,2]: sums of cosines and sines over a cell's columns, / 16."""
    angle = (heading.float() - 1) * (2 * math.pi / HEADINGS)
    both = torch.stack([angle.cos(), angle.sin()], -1) * (heading > 0)[..., None]
    return by_cell(both).mean(3)


def condition_of(mask, context, draft, bev, heading, given, columns, ground):
    """The numbers of each cell [B,x,y,CONDITION]. mask [B,x,y], context and draft [B,x,y,8], bev i32 and heading u8 [B,4x,4y], given
    [B,x,y,2] (are the two groups of the background?), columns u8 [B,4x,4y,5] (see COLUMN), ground [B,x,y] (is its height given?)."""
    columns = by_cell(columns).float()
    parts = []
    for group in range(GROUPS):
        base, top = columns[..., 2 * group], columns[..., 2 * group + 1]
        held = (top > 0).float()
        parts.append(torch.cat([held, (base - held) / HEIGHT, top / HEIGHT], -1) * given[..., group : group + 1])
    ground = ground[..., None]
    return torch.cat([mask[..., None], context, draft, layout_of(bev), heading_of(heading), given, *parts, ground,
                      columns[..., -1] / HEIGHT * ground], -1)


def patchify(x):
    """[B,2h,2w,C] -> tokens [B,h,w,4*C], order (row in patch, column in patch, channel)."""
    b, h, w, c = x.shape
    return x.view(b, h // PATCH, PATCH, w // PATCH, PATCH, c).transpose(2, 3).reshape(b, h // PATCH, w // PATCH, PATCH * PATCH * c)


def unpatchify(x):
    """The inverse of patchify."""
    b, h, w, c = x.shape
    return x.view(b, h, w, PATCH, PATCH, -1).transpose(2, 3).reshape(b, h * PATCH, w * PATCH, -1)


def modulate(x, shift, scale):
    return torch.addcmul(shift, F.layer_norm(x, x.shape[-1:], eps=1e-6), 1 + scale)


def attention(q, k, v):
    """Plain products: at these sizes four times as fast in bf16 on a CPU as torch's fused one."""
    if q.is_cuda:
        return F.scaled_dot_product_attention(q, k, v)
    return ((q * q.shape[-1] ** -0.5) @ k.transpose(-1, -2)).softmax(-1) @ v


class Block(nn.Module):
    def __init__(self, width, heads, local):
        super().__init__()
        self.heads = heads
        self.ada = nn.Linear(width, 6 * width)
        self.qkv = nn.Linear(width, 3 * width)
        self.proj = nn.Linear(width, width)
        self.fc1 = nn.Linear(width, 4 * width)
        self.fc2 = nn.Linear(4 * width, width)
        self.local = nn.Conv2d(width, width, 3, padding=1, groups=width) if local else None
        for layer in (self.qkv, self.proj, self.fc1, self.fc2):
            nn.init.xavier_uniform_(layer.weight)
            nn.init.zeros_(layer.bias)
        nn.init.zeros_(self.ada.weight)
        nn.init.zeros_(self.ada.bias)

    def forward(self, x, c):
        """x [B,h,w,width], c [B,width]."""
        b, h, w, width = x.shape
        shift1, scale1, gate1, shift2, scale2, gate2 = self.ada(c).view(b, 6, 1, 1, width).unbind(1)
        qkv = self.qkv(modulate(x, shift1, scale1))
        q, k, v = qkv.view(b, h * w, 3, self.heads, width // self.heads).permute(2, 0, 3, 1, 4)
        a = attention(q, k, v).transpose(1, 2).reshape(x.shape)
        if self.local is not None:
            a = a + self.local(qkv[..., 2 * width :].permute(0, 3, 1, 2)).permute(0, 2, 3, 1)
        x = torch.addcmul(x, gate1, self.proj(a))
        return torch.addcmul(x, gate2, self.fc2(F.gelu(self.fc1(modulate(x, shift2, scale2)))))


class OccDit(nn.Module):
    INNER = r"blocks\.\d+\.(qkv|proj|fc1|fc2)"  # layers whose weights Muon trains

    def __init__(self, config=None):
        super().__init__()
        c = self.config = config or DitConfig()
        patch = PATCH * PATCH
        self.embed_x = nn.Linear(patch * c.latent, c.width)
        self.embed_condition = nn.Linear(patch * CONDITION, c.width, bias=False)  # depends on neither x nor t: once per job in Rust
        self.time1 = nn.Linear(c.frequencies, c.width)
        self.time2 = nn.Linear(c.width, c.width)
        self.named1 = nn.Linear(2 * NAMED + 1, c.width)
        self.named2 = nn.Linear(c.width, c.width)
        self.blocks = nn.ModuleList(Block(c.width, c.heads, c.local) for _ in range(c.depth))
        self.final_ada = nn.Linear(c.width, 2 * c.width)
        self.final = nn.Linear(c.width, patch * c.latent)
        self.skip = nn.Linear(c.width, 2 * c.latent)  # gates of the noisy latent and of the draft
        self.skip_given = nn.Linear(c.width, 2 * c.latent)  # what is added to them where the background is given
        self.register_buffer("positions", positions(c.width), persistent=False)
        nn.init.normal_(self.embed_x.weight, std=0.1)
        nn.init.normal_(self.embed_condition.weight, std=0.04)  # sparse 0/1 inputs: many channels, few of them set at once
        for layer in (self.time1, self.time2):
            nn.init.normal_(layer.weight, std=0.02)
        for layer in (self.named2, self.final_ada, self.final, self.skip, self.skip_given):
            nn.init.zeros_(layer.weight)
            nn.init.zeros_(layer.bias)

    def condition(self, cells, named, corner=None):
        """cells [B,x,y,CONDITION] of `condition_of`, named [B,9] (values, 0 where not given; their flags; is there a draft?), corner i64
        [B,2] of a window in tokens -> tokens [B,h,w,width], the draft, what is added to the embedded time, is all background given?"""
        tokens = self.embed_condition(patchify(cells))
        b, h, w, _ = tokens.shape
        if corner is None:
            place = self.positions[:h, :w]
        else:
            rows, columns = (corner[:, i, None] + torch.arange(n, device=corner.device) for i, n in ((0, h), (1, w)))
            place = self.positions[rows[:, :, None], columns[:, None]]
        given = 1 + 16 + 16 * LAYERS + 2
        return (tokens + place, cells[..., 9:17], self.named2(F.silu(self.named1(named))),
                cells[..., given : given + GROUPS].prod(-1, keepdim=True))

    def forward(self, x, t, condition):
        """x [B,x,y,8], t [B] in 0..=999, condition from above -> v [B,x,y,8]."""
        tokens, draft, named, given = condition
        c = F.silu(self.time2(F.silu(self.time1(timestep_embedding(t, self.config.frequencies)))) + named)
        h = self.embed_x(patchify(x)) + tokens
        for block in self.blocks:
            h = block(h, c)
        shift, scale = self.final_ada(c).view(len(c), 2, 1, 1, -1).unbind(1)
        v = unpatchify(self.final(modulate(h, shift, scale)).float())
        gates = self.skip(c).float()[:, None, None] + given * self.skip_given(c).float()[:, None, None]
        of_x, of_draft = gates.chunk(2, -1)
        return v + of_x * x + of_draft * draft
