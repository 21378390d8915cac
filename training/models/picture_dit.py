"""Latent diffusion of six camera pictures at once, told what the voxels tell of every pixel.

A frame is a ring of cameras, each a latent of 18x32 cells of 8x8 px. Each cell hears the noisy latent, what an encoder of its own makes of the pixels'
classes, depths and facings (`Told`), and the latents of the frame before around the place where its surface was seen then (`warp`). Residual blocks work on
cells; transformer blocks on tokens of 2x2 cells: attention in the picture, attention to the pictures of both neighbours in the ring (SyntheOcc,
2410.00337, Eq. 5, here one softmax over both), MLP. One table of shifts, scales and gates made of time, light and weather serves all blocks,
with an offset for each (adaLN-single, PixArt, 2310.00426). Predicts v = alpha eps - sigma x0 (2202.00512).
"""
import functools
import math
from dataclasses import asdict, dataclass

import torch
from torch import nn
from torch.nn import functional as F

from models.occ_dit import attention
from models.occ_vae import ChannelNorm, Level, fold, unfold
from models.picture_vae import CELL

CLASSES = 20  # render ids: 0 nothing, 1 to 16 classes, 17 to 19 paint
FACINGS = 17  # 0 none, else 1 + sixteenths of a turn
EDGE = 0x80  # flag of a facing where another box begins
DEPTHS = 4  # numbers that tell a depth
TIMES, WEATHERS = 4, 6
SCENE = 7  # numbers of a camera: where the light comes from (3), which way is up (3), focal length / width
FAR_M = 1000.0  # depth of what has none
HIDDEN = 0.75  # a surface was hidden if something nearer than this share of its depth was seen there
BEFORE = 4  # latents of the frame before that a cell hears, and two numbers and a flag


@dataclass
class PictureDitConfig:
    latent: int = 8
    told: tuple = (12, 48, 96)  # widths of the encoder of the condition at 1, 2 and 4 px
    cells: int = 128
    width: int = 224
    depth: int = 6
    heads: int = 7
    across: tuple = (1, 3, 5)  # blocks that hear the neighbours
    frequencies: int = 128
    kernels: tuple = (3, 3)
    planes: int = 0  # classes of that many planes instead of first surfaces
    plane_kernel: int = 1
    depths: bool = True  # hears depths
    before: bool = True  # hears the frame before

    def as_dict(self):
        return asdict(self)


@functools.lru_cache
def positions(down, along, width, device):
    """Fixed sin-cos of a grid of tokens [down,along,width]: first half of the channels the column, second half the row."""
    omega = 1.0 / 1000 ** (torch.arange(width // 4, dtype=torch.float64) / (width / 4))

    def axis(n):
        angle = torch.arange(n, dtype=torch.float64)[:, None] * omega
        return torch.cat([angle.sin(), angle.cos()], 1)

    return torch.cat([axis(along).expand(down, -1, -1), axis(down)[:, None].expand(-1, along, -1)], 2).float().to(device)


@functools.lru_cache
def frequencies(half, device):
    """10000^(-i/half), as in `occ_dit.timestep_embedding`; kept on the device, so that a step can be recorded."""
    return torch.exp(-math.log(10000) * torch.arange(half, dtype=torch.float64) / half).to(device)


def timestep_embedding(t, dim):
    """[cos | sin] of t * 10000^(-i/half), t in 0..=999, fractions allowed."""
    args = t.double()[:, None] * frequencies(dim // 2, t.device)
    return torch.cat([args.cos(), args.sin()], 1).float()


def depth_numbers(depth_m):
    """Metres, 0 where there is nothing [B,h,w] -> [B,h,w,4]: is there something, log, 1 / (1 + d/4), and saw teeth of a metre."""
    seen = (depth_m > 0).float()
    log = (depth_m.clamp(min=0.3).log() - 2) * seen
    return torch.stack([seen, log, seen / (1 + depth_m / 4), seen * (depth_m * (2 * math.pi)).sin() / (1 + depth_m / 8)], -1)


class Told(nn.Module):
    """Encoder of what is told of each pixel; it depends on neither noise nor time, so it is asked once."""

    def __init__(self, c):
        super().__init__()
        self.config = c
        pixel, two, four = c.told
        self.classes = nn.Embedding(CLASSES, pixel)
        self.facings = nn.Embedding(FACINGS, pixel)
        self.edge = nn.Parameter(torch.randn(pixel) * 0.3)
        self.depth = nn.Linear(DEPTHS, pixel, bias=False)
        if c.planes:  # SyntheOcc's encoder: two convolutions over all planes at once
            self.planes = nn.Sequential(nn.Conv2d(c.planes * 4, two, c.plane_kernel, padding=c.plane_kernel // 2), nn.GELU(),
                                        nn.Conv2d(two, two, 1))
            self.plane_table = nn.Embedding(18, 4)
        self.down = nn.ModuleList(nn.Conv2d(4 * a, b, 1) for a, b in ((pixel, two), (two, four), (four, c.cells)))
        self.levels = nn.ModuleList([Level(two, (3,)), Level(four, (3, 3)), Level(c.cells, (3,))])
        nn.init.normal_(self.classes.weight, std=0.5)
        nn.init.normal_(self.facings.weight, std=0.5)

    def of_planes(self, planes):
        """The first convolution over embedded labels u8 [B,P,h,w] -> [B,two,h,w]. On a processor as sums of rows of one table: a row for each plane, label and
        place of the kernel; most planes hold nothing there, which is counted once for all."""
        first = self.planes[0]
        if planes.is_cuda:
            return first(rows(planes, self.plane_table.weight).permute(0, 1, 4, 2, 3).flatten(1, 2))
        b, count, h, w = planes.shape
        weight = first.weight.unflatten(1, (count, 4))  # [two,P,4,k,k]
        table = torch.einsum("oprij,lr->ijplo", weight, self.plane_table.weight)
        empty = table[:, :, :, NOTHING]
        # At the rim the kernel sees fewer places, and those outside are 0.
        inside = F.conv2d(torch.ones(1, 1, h, w), torch.eye(empty.shape[0] ** 2).view(-1, 1, *empty.shape[:2]), padding=empty.shape[0] // 2)
        out = torch.einsum("knhw,kpo->nohw", inside.transpose(0, 1).reshape(-1, 1, h, w), empty.flatten(0, 1)) + first.bias[:, None, None]
        table = (table - empty[:, :, :, None]).flatten(2, 3)
        reach = empty.shape[0] // 2
        total = 0.0
        for i in range(-reach, reach + 1):
            for j in range(-reach, reach + 1):
                moved = (shifted(planes, i, j) if reach else planes).permute(0, 2, 3, 1).reshape(-1, count)
                filled = moved != NOTHING
                where = filled.view(-1).nonzero().squeeze(1)
                codes = where % count * 18 + moved.reshape(-1)[where].long()
                offsets = torch.zeros(len(moved), dtype=torch.long)
                torch.cumsum(filled.sum(1)[:-1], 0, out=offsets[1:])
                total = total + F.embedding_bag(codes, table[i + reach, j + reach], offsets, mode="sum")
        return out + total.view(b, h, w, -1).permute(0, 3, 1, 2)

    def forward(self, classes, depth_m, facing, planes=None):
        """u8 [B,h,w], f32 [B,h,w], u8 [B,h,w]; planes u8 [B,P,h/2,w/2] where a network hears those -> [B,W,h/8,w/8]."""
        if self.config.planes:
            x = self.planes[2](self.planes[1](self.of_planes(planes)))
        else:
            x = rows(classes, self.classes.weight) + rows(facing & (EDGE - 1), self.facings.weight)
            x = x + (facing >= EDGE)[..., None].to(x.dtype) * self.edge.to(x.dtype)
            if self.config.depths:
                x = x + self.depth(depth_numbers(depth_m)).to(x.dtype)
            x = self.down[0](fold(x.permute(0, 3, 1, 2)))
        x = self.levels[0](x)
        for down, level in zip(self.down[1:], self.levels[1:]):
            x = level(down(fold(x)))
        return x


NOTHING = 17  # label of a plane where nothing is


def shifted(labels, dy, dx):
    """What lies so far below and to the right u8 [...,h,w]; nothing from outside."""
    h, w = labels.shape[-2:]
    return F.pad(labels, (1, 1, 1, 1), value=NOTHING)[..., 1 + dy : 1 + dy + h, 1 + dx : 1 + dx + w]


def rows(index, table):
    """Rows of a short table by a product with ones and zeros: on a card the gradient of a look-up of millions in a few rows takes far longer."""
    kind = index.device.type
    dtype = torch.get_autocast_dtype(kind) if torch.is_autocast_enabled(kind) else table.dtype
    hot = (index[..., None] == torch.arange(len(table), device=index.device, dtype=index.dtype)).to(dtype)
    return hot @ table


def cell_depth(depth_m):
    """Depth of each cell: that of the pixel right below its middle [B,h,w] -> [B,h/8,w/8]."""
    return depth_m[..., CELL // 2 :: CELL, CELL // 2 :: CELL]


def warp(latent, depth_m, depth_before_m, intrinsic, way):
    """Latents of the frame before as cells of this one see them. latent [B,h,w,C]; depths of cells now and then [B,h,w], m; intrinsic [B,3,3] in cells;
    way [B,4,4] from the camera now to the camera then -> [B,h,w,4C+3]: the four latents around the place, how far it is between them (row,
    column; 0 to 1), and 1 where that surface was seen; all 0 where it was outside or hidden."""
    b, h, w, channels = latent.shape
    at_u, at_v, z = (x.nan_to_num() for x in seen_then(depth_m, intrinsic, way))
    inside = (at_u > -0.5) & (at_u < w - 0.5) & (at_v > -0.5) & (at_v < h - 0.5) & (z > 0.1)
    low_u, low_v = at_u.floor(), at_v.floor()

    def read(values, dv, du):
        index = ((low_v + dv).clamp(0, h - 1) * w + (low_u + du).clamp(0, w - 1)).long().view(b, -1, 1)
        return values.gather(1, index.expand(-1, -1, values.shape[-1])).view(b, h, w, -1)

    near = far_where_none(depth_before_m).reshape(b, h * w, 1)
    seen = inside & (read(near, (at_v - low_v).round(), (at_u - low_u).round())[..., 0] > HIDDEN * z)
    flat = latent.reshape(b, h * w, channels)
    four = [read(flat, dv, du) for dv in (0, 1) for du in (0, 1)]
    flag = seen[..., None].float()
    return torch.cat([torch.cat([*four, (at_v - low_v)[..., None], (at_u - low_u)[..., None]], -1) * flag, flag], -1)


def far_where_none(depth_m):
    return depth_m.masked_fill(depth_m <= 0, FAR_M)


def seen_then(depth_m, intrinsic, way):
    """Where what is seen now was seen then: column and row in places [B,h,w] (0 is the middle of the first), and its depth then, m."""
    b, h, w = depth_m.shape
    device = depth_m.device
    v, u = torch.meshgrid(torch.arange(h, device=device) + 0.5, torch.arange(w, device=device) + 0.5, indexing="ij")
    fx, fy, cx, cy = (intrinsic[:, i, j, None, None] for i, j in ((0, 0), (1, 1), (0, 2), (1, 2)))
    deep = far_where_none(depth_m)
    ray = ((u - cx) / fx * deep, (v - cy) / fy * deep, deep)
    # Not as a product of matrices: autocast would make that one of bf16.
    x, y, z = (sum(way[:, i, j, None, None] * ray[j] for j in range(3)) + way[:, i, 3, None, None] for i in range(3))
    ahead = z.clamp(min=0.1)
    return x / ahead * fx + cx - 0.5, y / ahead * fy + cy - 0.5, z


def modulated(x, shift, scale):
    return torch.addcmul(shift, F.layer_norm(x, x.shape[-1:], eps=1e-6), 1 + scale)


class RingBlock(nn.Module):
    """Attention in a picture, attention to its neighbours in the ring, MLP."""

    def __init__(self, width, heads, across):
        super().__init__()
        self.heads = heads
        self.offset = nn.Parameter(torch.zeros(6, width))
        self.qkv, self.proj = nn.Linear(width, 3 * width), nn.Linear(width, width)
        self.local = nn.Conv2d(width, width, 3, padding=1, groups=width)
        self.fc1, self.fc2 = nn.Linear(width, 4 * width), nn.Linear(4 * width, width)
        layers = [self.qkv, self.proj, self.fc1, self.fc2]
        self.across = across
        if across:
            self.norm = nn.LayerNorm(width, eps=1e-6)
            self.side = nn.Parameter(torch.randn(2, width) * 0.02)  # of the keys: from the left, from the right
            self.ring_qkv, self.ring_proj = nn.Linear(width, 3 * width), nn.Linear(width, width)
            layers += [self.ring_qkv]
            nn.init.zeros_(self.ring_proj.weight)
            nn.init.zeros_(self.ring_proj.bias)
        for layer in layers:
            nn.init.xavier_uniform_(layer.weight)
            nn.init.zeros_(layer.bias)

    def split(self, x):
        """[...,n,width] -> [...,heads,n,width / heads]."""
        return x.unflatten(-1, (self.heads, -1)).transpose(-2, -3)

    def ring(self, x):
        """x [B,V,n,width]: what each picture hears of the two beside it."""
        b, views, n, width = x.shape
        q, k, v = self.ring_qkv(self.norm(x)).split(width, -1)
        k = torch.cat([k.roll(1, 1) + self.side[0], k.roll(-1, 1) + self.side[1]], 2)
        v = torch.cat([v.roll(1, 1), v.roll(-1, 1)], 2)
        q, k, v = (self.split(part).flatten(0, 1) for part in (q, k, v))
        heard = attention(q, k, v).transpose(1, 2).reshape(b, views, n, width)
        return self.ring_proj(heard)

    def forward(self, x, views, told):
        """x [B*V,h,w,width], told [B*V,6,width]."""
        n, h, w, width = x.shape
        shift1, scale1, gate1, shift2, scale2, gate2 = (told + self.offset).view(n, 6, 1, 1, width).unbind(1)
        qkv = self.qkv(modulated(x, shift1, scale1))
        q, k, v = (self.split(part) for part in qkv.view(n, h * w, 3 * width).split(width, -1))
        a = attention(q, k, v).transpose(1, 2).reshape(x.shape)
        a = a + self.local(qkv[..., 2 * width :].permute(0, 3, 1, 2)).permute(0, 2, 3, 1)
        x = torch.addcmul(x, gate1, self.proj(a))
        if self.across:
            x = x + self.ring(x.view(-1, views, h * w, width)).view(x.shape)
        return torch.addcmul(x, gate2, self.fc2(F.gelu(self.fc1(modulated(x, shift2, scale2)))))


class PictureDit(nn.Module):
    INNER = r"(told\.(levels|down)|blocks\.\d+\.(qkv|proj|fc1|fc2|ring_qkv|ring_proj)|enter|leave|down|up)"  # layers whose weights Muon trains

    def __init__(self, config=None):
        super().__init__()
        c = self.config = config or PictureDitConfig()
        self.told = Told(c)
        self.stem = nn.Linear(c.latent, c.cells)
        if c.before:
            self.stem_before = nn.Linear(BEFORE * c.latent + 3, c.cells)
        self.time1, self.time2 = nn.Linear(c.frequencies, c.width), nn.Linear(c.width, c.width)
        self.times, self.weathers = nn.Embedding(TIMES + 1, c.width), nn.Embedding(WEATHERS + 1, c.width)  # the last: not told
        self.camera = nn.Linear(SCENE, c.width)
        self.ada = nn.Linear(c.width, 6 * c.width)
        self.tell = nn.ModuleList(nn.Linear(c.width, c.cells) for _ in range(2))
        self.enter, self.leave = Level(c.cells, c.kernels), Level(c.cells, c.kernels)
        self.down, self.up = nn.Conv2d(4 * c.cells, c.width, 1), nn.Conv2d(c.width, 4 * c.cells, 1)
        self.blocks = nn.ModuleList(RingBlock(c.width, c.heads, i in c.across) for i in range(c.depth))
        self.norm = ChannelNorm(c.cells)
        self.head = nn.Conv2d(c.cells, c.latent, 1)
        for layer in (self.time1, self.time2, self.times, self.weathers, self.camera):
            nn.init.normal_(layer.weight, std=0.02 if isinstance(layer, nn.Linear) else 0.1)
        for layer in (self.ada, self.head):
            nn.init.zeros_(layer.weight)
            nn.init.zeros_(layer.bias)

    def condition(self, classes, depth_m, facing, time, weather, cameras, planes=None):
        """Of frames [B,V,...]: classes, depths (m) and facings [B,V,h,w], time and weather i64 [B] (4 and 6: not told), cameras f32 [B,V,7] ->
        what the network hears of them: cells [B*V,W,h/8,w/8] and vectors [B*V,W]."""
        flat = (part.flatten(0, 1) if part is not None else None for part in (classes, depth_m, facing, planes))
        views = cameras.shape[1]
        light = self.times(time) + self.weathers(weather)
        return self.told(*flat), (light[:, None] + self.camera(cameras)).flatten(0, 1), views

    def forward(self, x, t, condition, before=None):
        """x [B,V,h,w,8], t [B] in 0..=999, what `condition` made, before [B,V,h,w,35] of `warp` (zeros where there is no frame before) -> v [B,V,h,w,8]."""
        cells, light, views = condition
        c = self.config
        b, _, h, w, _ = x.shape
        with torch.autocast(x.device.type, enabled=False):
            y = self.stem(x.flatten(0, 1))
            if c.before and before is not None:
                y = y + self.stem_before(before.flatten(0, 1))
        time = self.time2(F.silu(self.time1(timestep_embedding(t, c.frequencies))))
        told = F.silu(time.repeat_interleave(views, 0) + light)
        enter, leave = (tell(told)[:, :, None, None] for tell in self.tell)
        kept = self.enter(y.permute(0, 3, 1, 2) + cells + enter)
        tokens = self.down(fold(kept)).permute(0, 2, 3, 1)
        tokens = tokens + positions(tokens.shape[1], tokens.shape[2], c.width, tokens.device)
        ada = self.ada(told).view(-1, 6, c.width)
        for block in self.blocks:
            tokens = block(tokens, views, ada)
        y = unfold(self.up(tokens.permute(0, 3, 1, 2)))
        y = self.leave(y + kept + leave)
        with torch.autocast(x.device.type, enabled=False):
            v = self.head(self.norm(y.float()))
        return v.permute(0, 2, 3, 1).reshape(x.shape).float()

