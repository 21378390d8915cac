"""A network that tells voxels from one LiDAR sweep and six pictures, or from either alone. Rust twin: src/gen/nets/sensor_occupancy.

What the segmenter of pictures sees is put on voxels: each hears the class of the pixel at which its middle lies, of the camera that sees it nearest to its
axis (`painted`). How far away a pixel's surface is nobody says: that the network tells from the returns, and from where rays cross the ground.
Blocks and levels as in the perceiver; all 16 voxels of a column at once, as in the occupancy VAE.
"""
import json
from dataclasses import asdict, dataclass

import torch
from safetensors import safe_open
from safetensors.torch import load_file
from torch import nn

from models.lidar_perceiver import COLUMN_M, COLUMNS, HALF_M, PILLAR
from models.occ_vae import CLASSES, HEIGHT, ChannelNorm, Level, fold, unfold
from models.segmenter import CLASSES as SHOWN

UNSEEN = SHOWN  # painted on a voxel that no camera sees
LOW_M = -1.0  # where the lowest voxels begin
NEAR_M = 0.5  # of a camera: what is nearer along its axis it does not see
WAY = 2  # numbers that tell a column where rays come from


@dataclass
class SensorOccupancyConfig:
    widths: tuple = (48, 96, 160)  # at 0.8, 1.6 and 3.2 m
    kernels: tuple = ((3,), (3, 3), (3, 3))
    paint: int = 4  # numbers of a painted class

    def as_dict(self):
        return asdict(self)


class SensorOccupancy(nn.Module):
    INNER = r"(enter|leave|down|up)\."  # layers whose weights Muon trains

    def __init__(self, config=None):
        super().__init__()
        c = self.config = config or SensorOccupancyConfig()
        fine, steps = c.widths[0], list(zip(c.widths, c.widths[1:]))
        self.paint = nn.Embedding(SHOWN + 1, c.paint)
        self.stem = nn.Conv2d(4 * (PILLAR + WAY + HEIGHT * c.paint), fine, 1)
        self.enter = nn.ModuleList(Level(w, k) for w, k in zip(c.widths, c.kernels))
        self.down = nn.ModuleList(nn.Conv2d(4 * a, b, 1) for a, b in steps)
        self.leave = nn.ModuleList(Level(w, (3,)) for w in c.widths[-2::-1])
        self.up = nn.ModuleList(nn.Conv2d(b, 4 * a, 1) for a, b in steps[::-1])
        self.norm, self.head = ChannelNorm(fine), nn.Conv2d(fine, 4 * HEIGHT * CLASSES, 1)
        nn.init.normal_(self.paint.weight, std=0.5)
        nn.init.normal_(self.head.weight, std=0.02)
        nn.init.zeros_(self.head.bias)

    def forward(self, pillars, way, painted):
        """Pillars f32 [B,19,X,Y], ways f32 [B,2,X,Y], painted classes u8 [B,X,Y,16], sides a multiple of 8 columns -> logits f32 [B,X,Y,16,18]."""
        return self.of_columns(self.columns(pillars, way, painted))

    def columns(self, pillars, way, painted):
        """All that is known of each column [B,W,X,Y]."""
        painted = self.paint(painted.int()).flatten(3).permute(0, 3, 1, 2)
        return torch.cat([pillars, way, painted], 1)

    def of_columns(self, columns):
        """-> logits f32 [B,X,Y,16,18]."""
        seen = [self.enter[0](self.stem(fold(columns)))]
        for down, level in zip(self.down, self.enter[1:]):
            seen.append(level(down(fold(seen[-1]))))
        *kept, z = seen
        for up, level, before in zip(self.up, self.leave, kept[::-1]):
            z = level(unfold(up(z)) + before)
        return unfold(self.head(self.norm(z))).permute(0, 2, 3, 1).unflatten(-1, (HEIGHT, CLASSES))


def ways():
    """f32 [2,200,200]: from the origin to the middle of each column, as a unit vector."""
    middle = (torch.arange(COLUMNS) + 0.5) * COLUMN_M - HALF_M
    way = torch.stack([middle[:, None].expand(-1, COLUMNS), middle.expand(COLUMNS, -1)])
    return way / way.norm(dim=0)


def painted(shown, intrinsic, vehicle_from_camera):
    """What cameras show at the middle of each voxel of the window: classes u8 [V,h,w], intrinsics [V,3,3] (px), poses [V,4,4] of cameras in the vehicle's frame -> u8
    [200,200,16]. In double precision, so that Rust paints alike; of two cameras that see a voxel equally near their axes the first one counts."""
    views, h, w = shown.shape
    middle = (torch.arange(COLUMNS, dtype=torch.float64) + 0.5) * COLUMN_M - HALF_M
    up = (torch.arange(HEIGHT, dtype=torch.float64) + 0.5) * COLUMN_M + LOW_M
    place = torch.stack(torch.meshgrid(middle, middle, up, indexing="ij"), -1).view(-1, 3)
    out = torch.full((len(place),), UNSEEN, dtype=torch.uint8)
    best = torch.zeros(len(place), dtype=torch.float64)
    for view in range(views):
        pose, k = vehicle_from_camera[view].double(), intrinsic[view].double()
        p = (place - pose[:3, 3]) @ pose[:3, :3]
        u, v = (torch.floor(k[i, i] * p[:, i] / p[:, 2] + k[i, 2]) for i in (0, 1))
        straight = p[:, 2] / p.norm(dim=1)
        take = (p[:, 2] > NEAR_M) & (u >= 0) & (u < w) & (v >= 0) & (v < h) & (straight > best)
        index = (v[take] * w + u[take]).long()
        out[take] = shown[view].reshape(-1)[index]
        best[take] = straight[take]
    return out.view(COLUMNS, COLUMNS, HEIGHT)


def load_sensor_occupancy(path):
    """A network of a file of weights, f16 or f32."""
    with safe_open(path, "pt") as f:
        config = json.loads(f.metadata()["config"])
    net = SensorOccupancy(SensorOccupancyConfig(**config))
    net.load_state_dict({k: v.float() for k, v in load_file(path).items()})
    return net.eval().requires_grad_(False)
