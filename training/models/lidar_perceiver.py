"""A small network that perceives a scene from one LiDAR sweep: what stands in each column of the window, and boxes of things by their centres.
Rust twin: src/gen/nets/perceiver. Blocks and levels as in the segmenter of pictures; boxes as in CenterPoint (2006.11275).
"""
import json
from dataclasses import asdict, dataclass

import torch
from safetensors import safe_open
from safetensors.torch import load_file
from torch import nn
from torch.nn import functional as F

from models.occ_vae import ChannelNorm, Level, fold, unfold

COLUMNS, COLUMN_M, HALF_M = 200, 0.4, 40.0
CELL_M = 2 * COLUMN_M  # of the map of centres
BINS, BIN_LOW_M, BIN_M = 12, -1.2, 0.4
PILLAR = BINS + 7  # numbers of a column
STANDS = ("drivable", "walkway", "other_ground", "vegetation", "structure", "vehicle", "cycle", "person", "barrier")
GROUPS = ("car", "large", "person", "cycle", "barrier")
BOX = 10  # numbers of a box: offset x and y (cells), height of its centre (m), logs of its sizes (m), cos and sin of twice the yaw, of the yaw
APART_M = (1.2, 2.0, 0.3, 0.5, 0.3)  # of two boxes of a group nearer than this the lower score goes
MOST = 200  # boxes of a sweep


@dataclass
class PerceiverConfig:
    widths: tuple = (32, 64, 128)  # at 0.8, 1.6 and 3.2 m
    kernels: tuple = ((3,), (3, 3), (3, 3))

    def as_dict(self):
        return asdict(self)


class LidarPerceiver(nn.Module):
    INNER = r"(enter|leave|down|up|boxes)\."  # layers whose weights Muon trains

    def __init__(self, config=None):
        super().__init__()
        c = self.config = config or PerceiverConfig()
        fine, steps = c.widths[0], list(zip(c.widths, c.widths[1:]))
        self.stem = nn.Conv2d(4 * PILLAR, fine, 1)
        self.enter = nn.ModuleList(Level(w, k) for w, k in zip(c.widths, c.kernels))
        self.down = nn.ModuleList(nn.Conv2d(4 * a, b, 1) for a, b in steps)
        self.leave = nn.ModuleList(Level(w, (3,)) for w in c.widths[-2::-1])
        self.up = nn.ModuleList(nn.Conv2d(b, 4 * a, 1) for a, b in steps[::-1])
        self.norm, self.head = ChannelNorm(fine), nn.Conv2d(fine, 4 * len(STANDS), 1)
        self.boxes = Level(fine, (3,))
        self.box_norm, self.box_head = ChannelNorm(fine), nn.Conv2d(fine, len(GROUPS) + BOX, 1)
        nn.init.normal_(self.box_head.weight, std=0.01)
        nn.init.zeros_(self.box_head.bias)
        nn.init.constant_(self.box_head.bias[: len(GROUPS)], -4.0)  # centres are rare

    def forward(self, pillars):
        """[B,19,X,Y], sides a multiple of 8 columns -> logits of what stands [B,9,X,Y], logits of centres and numbers of boxes [B,15,X/2,Y/2]."""
        seen = [self.enter[0](self.stem(fold(pillars)))]
        for down, level in zip(self.down, self.enter[1:]):
            seen.append(level(down(fold(seen[-1]))))
        *kept, x = seen
        for up, level, before in zip(self.up, self.leave, kept[::-1]):
            x = level(unfold(up(x)) + before)
        return unfold(self.head(self.norm(x))), self.box_head(self.box_norm(self.boxes(x)))


def pillars(points, rim=HALF_M):
    """Returns [P,4] (x, y, z in m in the ego frame, echo strength 0 to 255) -> f32 [19,200,200], x before y. Of each column: log counts of
    twelve bins of 0.4 m from 1.2 m below the ego frame's origin on (lower and higher ones go to the last), then highest and lowest (3 m), mean strength
    (255), log count, mean place in the column (-0.5 to 0.5), and how far away the column is (40 m): the only one that an empty one has. Points that
    are not finite or outside the window are left out."""
    points = points[torch.isfinite(points).all(1)]
    at = torch.floor((points[:, :2] + rim) / COLUMN_M)
    inside = ((at >= 0) & (at < COLUMNS)).all(1)
    points, at = points[inside], at[inside]
    column = (at[:, 0] * COLUMNS + at[:, 1]).long()
    z = points[:, 2].clamp(-3, 6)
    height = torch.floor((z - BIN_LOW_M) / BIN_M).clamp(0, BINS - 1).long()
    n = COLUMNS * COLUMNS
    counts = torch.bincount(height * n + column, minlength=BINS * n).view(BINS, n).float()
    total = counts.sum(0)

    def mean(values):
        return torch.zeros(n).index_add_(0, column, values) / total.clamp(min=1)

    def edge(which):
        return torch.zeros(n).scatter_reduce_(0, column, z, which, include_self=False) / 3

    offset = (points[:, :2] + rim) / COLUMN_M - at - 0.5
    middle = (torch.arange(COLUMNS) + 0.5) * COLUMN_M - rim
    away = (middle[:, None].square() + middle.square()).sqrt() / HALF_M
    parts = [torch.log1p(counts) / 4, edge("amax")[None], edge("amin")[None], mean(points[:, 3] / 255)[None], torch.log1p(total)[None] / 4,
             mean(offset[:, 0])[None], mean(offset[:, 1])[None], away.view(1, n)]
    return torch.cat(parts).view(PILLAR, COLUMNS, COLUMNS)


def decode(boxes, threshold=0.1):
    """Numbers of one sweep [15,X,Y] -> found boxes [K,9], the best first: group, score, centre, length, width, height (m), yaw (rad)."""
    heat, numbers = torch.sigmoid(boxes[: len(GROUPS)].float()), boxes[len(GROUPS) :].float()
    peak = (F.max_pool2d(heat[None], 3, 1, 1)[0] == heat) & (heat >= threshold)
    group, x, y = peak.nonzero(as_tuple=True)
    score, v = heat[group, x, y], numbers[:, x, y]
    place = [(at + 0.5 + off) * CELL_M - CELL_M * boxes.shape[1] / 2 for at, off in ((x, v[0]), (y, v[1]))]
    yaw = torch.atan2(v[7], v[6]) / 2
    yaw = torch.where(v[8] * torch.cos(yaw) + v[9] * torch.sin(yaw) < 0, yaw + torch.pi, yaw)
    found = torch.stack([group.float(), score, *place, v[2], *v[3:6].clamp(-3, 4).exp(), yaw], 1)
    found = found[score.argsort(descending=True, stable=True)]
    near = (found[:, None, 2:4] - found[:, 2:4]).norm(dim=2) < torch.tensor(APART_M)[found[:, 0].long()]
    near = (near & (found[:, :1] == found[:, 0])).numpy()
    kept = []
    for i in range(len(found)):
        if len(kept) < MOST and not near[i, kept].any():
            kept.append(i)
    return found[kept]


def load_perceiver(path):
    """A network of a file of weights, f16 or f32."""
    with safe_open(path, "pt") as f:
        config = json.loads(f.metadata()["config"])
    net = LidarPerceiver(PerceiverConfig(**config))
    net.load_state_dict({k: v.float() for k, v in load_file(path).items()})
    return net.eval().requires_grad_(False)
