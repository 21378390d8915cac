"""The learned LiDAR: sparse 3-D UNet over occupied voxels, signed distance along rays, NeuS weights, echo strength and
lost echoes (UniScene, section 3.3; NeuS, 2106.10689). Rust twin: src/gen/model/lidar/. Everything the UNet sees is the
scene: its features stay when the sensor moves."""
from dataclasses import asdict, dataclass

import numpy as np
import torch
import torch.nn.functional as F
from torch import nn

SHAPE, VOXEL_M, LOWER_M = (200, 200, 16), 0.4, (-40.0, -40.0, -1.0)
FREE, CLASSES, RAISE = 17, 17, 2  # the ground lies two bins low in labels, everything else is smeared two bins down
HIDDEN, APPEARANCE = 16, 16
FREE_SDF_M, LEAST_SUPPORT = 0.4, 0.05
LEAST_WEIGHT = 0.01  # of an interval, to be looked at for its appearance


@dataclass
class LidarConfig:
    widths: tuple = (32, 48, 64)
    unet: bool = True

    def as_dict(self):
        return asdict(self)


# ---- Sites: which voxels, and who is whose neighbour ----


def physical(grid):
    """Labels with the vertical convention of Occ3D undone: the ground two bins up, of every vertical run of other
    things the lowest two voxels gone (all but the top, if it has no more)."""
    ground = (grid >= 11) & (grid <= 14)
    solid = (grid != FREE) & ~ground
    out, below = np.full_like(grid, FREE), np.zeros(grid.shape[:2], np.int8)
    for z in range(SHAPE[2]):
        here = solid[..., z]
        top = here & ~solid[..., z + 1] if z + 1 < SHAPE[2] else here
        keep = here & ((below >= RAISE) | top)
        out[..., z][keep] = grid[..., z][keep]
        below = np.where(here, below + 1, 0)
    for z in range(SHAPE[2]):
        to = min(z + RAISE, SHAPE[2] - 1)
        lift = ground[..., z] & (out[..., to] == FREE)
        out[..., to][lift] = grid[..., z][lift]
    return out


def surface(grid):
    """Coordinates [N,3] in rising order of voxels with a free neighbour (of six; below only above bin 3: nothing looks
    at a building from underground), and their classes."""
    full = np.pad(grid != FREE, 1)
    full[:, :, 0] = True
    inner = full[1:-1, 1:-1, 1:-1]
    hidden = full[2:, 1:-1, 1:-1] & full[:-2, 1:-1, 1:-1] & full[1:-1, 2:, 1:-1] & full[1:-1, :-2, 1:-1] & full[1:-1, 1:-1, 2:]
    under = full[1:-1, 1:-1, :-2].copy()
    under[..., : RAISE + 2] = True
    at = np.argwhere(inner & ~(hidden & under))
    return at, grid[tuple(at.T)]


def index_volume(coords, shape):
    """Number of the site of every voxel, with one voxel around; len(coords) where there is none."""
    volume = np.full([n + 2 for n in shape], len(coords), np.int64)
    volume[tuple(coords.T + 1)] = np.arange(len(coords))
    return volume


def neighbours(coords, volume):
    """[N,27] sites around each site, tap (dx, dy, dz) with dz fastest."""
    taps = [(dx, dy, dz) for dx in (0, 1, 2) for dy in (0, 1, 2) for dz in (0, 1, 2)]
    return np.stack([volume[tuple((coords + t).T)] for t in taps], 1)


class Sites:
    """Sites of the three levels of the UNet and their tables."""

    def __init__(self, coords, classes):
        self.coords, self.classes = coords, torch.from_numpy(classes.astype(np.int64))
        self.height = torch.from_numpy(coords[:, 2].astype(np.int64))
        self.volume = index_volume(coords, SHAPE)
        self.around, self.parent, self.child, self.count = [], [], [], []
        shape = SHAPE
        for level in range(3):
            volume = self.volume if level == 0 else index_volume(coords, shape)
            self.around.append(torch.from_numpy(neighbours(coords, volume)))
            self.count.append(len(coords))
            if level < 2:
                shape = tuple(n // 2 for n in shape)
                keys = np.ravel_multi_index((coords // 2).T, shape) if len(coords) else np.zeros(0, np.int64)
                unique, parent = np.unique(keys, return_inverse=True)
                child = (coords % 2) @ np.array([4, 2, 1])
                self.parent.append(torch.from_numpy(parent.reshape(-1)))
                self.child.append(torch.from_numpy(child))
                coords = np.stack(np.unravel_index(unique, shape), 1)


# ---- UNet ----


class Gathered(torch.autograd.Function):
    """Submanifold convolution: x [N,I], weight [27 I, O], around [N,27]. Its transpose is itself with the taps turned
    round, so the way back gathers too."""

    @staticmethod
    def forward(ctx, x, weight, around):
        rows = torch.cat([x, x.new_zeros(1, x.shape[1])]).index_select(0, around.reshape(-1)).view(len(around), -1)
        ctx.save_for_backward(rows, weight, around)
        return rows @ weight

    @staticmethod
    def backward(ctx, grad):
        rows, weight, around = ctx.saved_tensors
        turned = weight.view(27, -1, weight.shape[1]).flip(0).transpose(1, 2).reshape(-1, weight.shape[0] // 27)
        back = torch.cat([grad, grad.new_zeros(1, grad.shape[1])]).index_select(0, around.reshape(-1))
        return back.view(len(around), -1) @ turned, rows.T @ grad, None


class Submanifold(nn.Module):
    def __init__(self, inputs, outputs):
        super().__init__()
        self.weight = nn.Parameter(torch.randn(27 * inputs, outputs) * (2 / (12 * inputs)) ** 0.5)
        self.bias = nn.Parameter(torch.zeros(outputs))

    def forward(self, x, around):
        return Gathered.apply(x, self.weight, around) + self.bias


class Block(nn.Module):
    """x + W relu(conv(norm(x)))."""

    def __init__(self, width):
        super().__init__()
        self.norm, self.conv, self.linear = nn.LayerNorm(width, eps=1e-6), Submanifold(width, width), nn.Linear(width, width)
        with torch.no_grad():
            self.linear.weight.mul_(0.3)

    def forward(self, x, around):
        return x + self.linear(F.relu(self.conv(self.norm(x), around)))


class Down(nn.Module):
    """Kernel 2, stride 2: a coarse site sums its children, each through the matrix of its corner."""

    def __init__(self, inputs, outputs):
        super().__init__()
        self.weight = nn.Parameter(torch.randn(8, inputs, outputs) * (1 / (3 * inputs)) ** 0.5)
        self.bias = nn.Parameter(torch.zeros(outputs))

    def forward(self, x, parent, child, count):
        rows = x.new_zeros(count * 8, x.shape[1]).index_copy(0, parent * 8 + child, x)
        return rows.view(count, -1) @ self.weight.flatten(0, 1) + self.bias


class Up(nn.Module):
    """The transpose: every fine site gets its parent through the matrix of its corner."""

    def __init__(self, inputs, outputs):
        super().__init__()
        self.weight = nn.Parameter(torch.randn(8, inputs, outputs) * (1 / inputs) ** 0.5 * 0.5)
        self.bias = nn.Parameter(torch.zeros(outputs))

    def forward(self, x, parent, child):
        wide = x @ self.weight.transpose(0, 1).flatten(1)
        return wide.view(-1, self.bias.numel()).index_select(0, parent * 8 + child) + self.bias


class Lidar(nn.Module):
    def __init__(self, config=LidarConfig()):
        super().__init__()
        self.config = config
        w0, w1, w2 = config.widths
        self.class_table = nn.Parameter(torch.randn(CLASSES, w0) * 0.5)
        self.height_table = nn.Parameter(torch.randn(SHAPE[2], w0) * 0.3)
        if config.unet:
            self.enter0, self.enter1, self.middle0, self.middle1 = Block(w0), Block(w1), Block(w2), Block(w2)
            self.leave1, self.leave0 = Block(w1), Block(w0)
            self.down0, self.down1, self.up1, self.up0 = Down(w0, w1), Down(w1, w2), Up(w2, w1), Up(w1, w0)
        self.norm = nn.LayerNorm(w0, eps=1e-6)
        self.geometry = nn.Linear(w0, HIDDEN + 4)  # hidden numbers; a plane: offset (m) and slope (m per voxel)
        self.appearance = nn.Linear(w0, APPEARANCE)
        self.support = nn.Parameter(torch.randn(HIDDEN) * 0.1)
        self.sdf1 = nn.Linear(HIDDEN, HIDDEN)
        self.sdf2 = nn.Linear(HIDDEN, 1)
        self.log_s = nn.Parameter(torch.tensor([3.0]))
        self.ray0, self.ray1, self.ray2 = nn.Linear(APPEARANCE + 4, 32), nn.Linear(32, 32), nn.Linear(32, 2)
        with torch.no_grad():
            self.sdf2.weight.mul_(0.1)
            self.sdf2.bias.zero_()
            self.geometry.weight[HIDDEN:].mul_(0.2)
            self.geometry.bias[HIDDEN:].zero_()
            self.ray2.weight.mul_(0.3)
            self.ray2.bias.copy_(torch.tensor([0.25, -2.2]))  # root of the echo strength; drops are one in ten

    def features(self, sites):
        """Per voxel: geometry [N,20] and appearance [N,16]."""
        x = self.class_table[sites.classes] + self.height_table[sites.height]
        if self.config.unet:
            a, p, c, n = sites.around, sites.parent, sites.child, sites.count
            x0 = self.enter0(x, a[0])
            x1 = self.enter1(self.down0(x0, p[0], c[0], n[1]), a[1])
            x2 = self.middle1(self.middle0(self.down1(x1, p[1], c[1], n[2]), a[2]), a[2])
            x1 = self.leave1(x1 + self.up1(x2, p[1], c[1]), a[1])
            x = self.leave0(x0 + self.up0(x1, p[0], c[0]), a[0])
        x = self.norm(x)
        return self.geometry(x), self.appearance(x)

    def sdf(self, geometry, corners, share, offset):
        """Signed distance [M] (m) at points between eight voxel centres: corners [M,8] sites, len(geometry) where there
        is none; share [M,8] trilinear weights; offset [M,8,3] from each centre, in voxels. Each voxel has a plane, the
        planes are blended (a partition of unity), a small network of blended numbers corrects the blend."""
        padded = torch.cat([geometry, geometry.new_zeros(1, geometry.shape[1])])
        bag = lambda table, weight: F.embedding_bag(corners, table, mode="sum", per_sample_weights=weight)
        there = (share * (corners < len(geometry))).sum(1)
        blended = bag(padded[:, : HIDDEN + 1], share)
        plane = blended[:, HIDDEN]
        for axis in range(3):
            plane = plane + bag(padded[:, HIDDEN + 1 + axis : HIDDEN + 2 + axis], share * offset[..., axis])[:, 0]
        hidden = F.relu(blended[:, :HIDDEN] + there[:, None] * self.support)
        rest = self.sdf2(F.relu(self.sdf1(hidden)))[:, 0]
        value = plane / there.clamp(min=LEAST_SUPPORT) + rest
        return torch.where(there > 0, value, torch.full_like(value, FREE_SDF_M))

    def render(self, appearance, lookup, origin, direction, t, f):
        """Samples t [R,S] rising, f [R,S] their signed distances. Returns depth (m, normalised), log of what passes,
        strength (root of 0..1) and drop logit, weights [R,S-1] and where each interval is crossed."""
        weight, log_pass = neus_weights(f, self.log_s.exp())
        f0, f1, t0, t1 = f[:, :-1], f[:, 1:], t[:, :-1], t[:, 1:]
        crosses = (f0 > 0) & (f1 <= 0)
        fraction = torch.where(crosses, f0 / torch.where(crosses, f0 - f1, 1.0), 0.5)
        at = t0 + (t1 - t0) * fraction
        total = weight.sum(1)
        depth = (weight * at).sum(1) / total.clamp(min=1e-6)
        seen = weight.detach() > LEAST_WEIGHT
        ray, interval = seen.nonzero(as_tuple=True)
        there = at.detach()[ray, interval]
        corners, share, _ = lookup(origin[ray] + direction[ray] * there[:, None])
        padded = torch.cat([appearance, appearance.new_zeros(1, APPEARANCE)])
        looks = F.embedding_bag(corners, padded, mode="sum", per_sample_weights=share)
        slope = ((f0 - f1) / (t1 - t0).clamp(min=1e-3)).clamp(-2, 2).detach()[ray, interval]
        w = weight.detach()[ray, interval][:, None]
        summed = torch.zeros(len(t), APPEARANCE + 1).index_add(0, ray, torch.cat([looks, slope[:, None]], 1) * w)
        d = depth.detach()
        facts = torch.stack([d / 40, 1 / (1 + d / 5), direction[:, 2] * 2], 1)
        out = self.ray2(F.relu(self.ray1(F.relu(self.ray0(torch.cat([summed, facts], 1))))))
        return depth, log_pass, out[:, 0], out[:, 1], weight, at


def neus_weights(f, s):
    """NeuS weights of the intervals of sorted samples, in log space, and the logarithm of what passes all of them."""
    change = (F.logsigmoid(s * f[:, 1:]) - F.logsigmoid(s * f[:, :-1])).clamp(max=0)
    passed = torch.cumsum(change, 1)
    before = torch.cat([torch.zeros_like(passed[:, :1]), passed[:, :-1]], 1)
    return -torch.expm1(change) * before.exp(), passed[:, -1]


def lookup_of(volume):
    """Points of the ego frame (m) to (corners [M,8], share [M,8], offset [M,8,3]) of the voxel centres around them."""
    volume = torch.from_numpy(volume) if isinstance(volume, np.ndarray) else volume
    shape = torch.tensor(volume.shape)
    steps = torch.tensor([[i >> 2, i >> 1 & 1, i & 1] for i in range(8)])
    lower = torch.tensor(LOWER_M)

    def lookup(p):
        q = (p - lower) / VOXEL_M - 0.5
        base = torch.floor(q)
        offset = (q - base)[:, None, :] - steps
        at = base.long()[:, None, :] + steps + 1
        at = torch.minimum(at.clamp(min=0), shape - 1)
        corners = volume.view(-1)[(at[..., 0] * shape[1] + at[..., 1]) * shape[2] + at[..., 2]]
        return corners, (1 - offset.abs()).prod(-1), offset

    return lookup
