"""The occupancy VAE with three planes for a latent, an option to compare with the top view alone (occ_vae.py).

After X-Scene (2506.13558): features are projected on the planes xy, xz and yz, and each place of the volume gathers from all three by deformable
attention (2010.04159), four points a plane. The planes hold as many numbers as the latent of 50x50x8 does: 50x50x7, 50x4x6 twice, 19,900 in all.
Encoder and decoder at 0.4 and 0.8 m are those of occ_vae.py. An edit touches its whole row and column: the side planes are means across the map.
"""
import torch
from torch import nn
from torch.nn import functional as F

from models.occ_vae import CELLS, OccVae

TOP, SIDE_PLANE, LEVELS = 7, 6, 4  # channels of xy, of xz and yz; places along z
WIDE, POINTS = 32, 4  # channels of a place of the volume; points that it gathers from each plane


def numbers(side):
    """Of a latent over `side` cells each way."""
    return side * side * TOP + 2 * side * LEVELS * SIDE_PLANE


def side_of(n):
    """The inverse of `numbers`."""
    return next(s for s in range(1, 4 * CELLS) if numbers(s) == n)


class TriplaneVae(OccVae):
    """Latents are [B,1,N,1], the planes one after another; elsewhere it is used as an `OccVae`."""

    def __init__(self, config=None):
        super().__init__(config)
        coarse = self.config.widths[-1]
        del self.encoder_head, self.decoder_stem
        self.top_head = nn.Conv2d(coarse, 2 * TOP, 1)
        self.lift = nn.Conv2d(coarse, LEVELS * WIDE, 1)
        self.side_heads = nn.ModuleList(nn.Linear(WIDE, 2 * SIDE_PLANE) for _ in range(2))
        self.plane_in = nn.ModuleList([nn.Linear(TOP, WIDE), nn.Linear(SIDE_PLANE, WIDE), nn.Linear(SIDE_PLANE, WIDE)])
        self.height = nn.Parameter(torch.randn(LEVELS, WIDE) * 0.02)
        self.offsets = nn.Linear(WIDE, 3 * POINTS * 2)
        self.weights = nn.Linear(WIDE, 3 * POINTS)
        self.gathered = nn.Linear(WIDE, WIDE)
        self.decoder_stem = nn.Conv2d(LEVELS * WIDE, coarse, 1)
        nn.init.zeros_(self.offsets.weight)
        nn.init.uniform_(self.offsets.bias, -1.5, 1.5)  # cells
        self.latent_mean, self.latent_std = torch.zeros(1), torch.ones(1)

    def moments(self, labels):
        """Labels u8 [B,X,Y,16] -> mean, log variance [B,1,N,1]; X = Y."""
        from models.occ_vae import fold, sum_of_voxels

        x = self.encoder[0](sum_of_voxels(self.embed, labels))
        for down, level in zip(self.down, self.encoder[1:]):
            x = level(down(fold(x)))
        with torch.autocast(x.device.type, enabled=False):
            x = self.encoder_norm(x.float())
            b, _, nx, ny = x.shape
            volume = self.lift(x).view(b, LEVELS, WIDE, nx, ny)
            sides = [head(volume.mean(axis).permute(0, 3, 1, 2)) for head, axis in zip(self.side_heads, (4, 3))]  # [B,x|y,LEVELS,2C]
            parts = [self.top_head(x).permute(0, 2, 3, 1), *sides]
            mean, logvar = (torch.cat([p.chunk(2, -1)[i].reshape(b, -1) for p in parts], 1) for i in range(2))
        return mean[:, None, :, None], logvar[:, None, :, None].clamp(-30.0, 20.0)

    def planes(self, latent):
        """[B,1,N,1] -> xy [B,WIDE,x,y], xz [B,WIDE,x,LEVELS], yz [B,WIDE,y,LEVELS]."""
        b, n = len(latent), latent.shape[2]
        s = side_of(n)
        flat = latent.reshape(b, n)
        cut = [s * s * TOP, s * LEVELS * SIDE_PLANE, s * LEVELS * SIDE_PLANE]
        shapes = [(s, s, TOP), (s, LEVELS, SIDE_PLANE), (s, LEVELS, SIDE_PLANE)]
        return [into(part.view(b, *shape)).permute(0, 3, 1, 2) for into, part, shape in zip(self.plane_in, flat.split(cut, 1), shapes)]

    def features(self, latent, heard=None):
        """As `OccVae.features`, of a latent [B,1,N,1]."""
        with torch.autocast(latent.device.type, enabled=False):
            planes = self.planes(latent.float())
            b, _, s, _ = planes[0].shape
            xy, xz, yz = planes
            query = xy[..., None] + xz[:, :, :, None] + yz[:, :, None] + self.height.t()[:, None, None]  # [B,WIDE,x,y,LEVELS]
            query = query.permute(0, 2, 3, 4, 1)  # [B,x,y,LEVELS,WIDE]
            at = torch.stack(torch.meshgrid(torch.arange(s), torch.arange(s), torch.arange(LEVELS), indexing="ij"), -1).to(query)
            offset = self.offsets(query).view(b, s, s, LEVELS, 3, POINTS, 2)
            weight = self.weights(query).softmax(-1).view(b, s, s, LEVELS, 3, POINTS)
            out = 0
            for p, (plane, axes) in enumerate(zip(planes, ((0, 1), (0, 2), (1, 2)))):
                size = torch.tensor(plane.shape[2:], dtype=query.dtype, device=query.device)
                place = at[..., axes][None, :, :, :, None] + offset[..., p, :, :]
                grid = ((place + 0.5) / size * 2 - 1).flip(-1).view(b, -1, POINTS, 2)
                found = F.grid_sample(plane, grid, padding_mode="border", align_corners=False).view(b, WIDE, s, s, LEVELS, POINTS)
                out = out + (found.permute(0, 2, 3, 4, 5, 1) * weight[..., p, :, None]).sum(-2)
            volume = query + self.gathered(out)
            x = self.decoder_stem(volume.reshape(b, s, s, LEVELS * WIDE).permute(0, 3, 1, 2).contiguous(memory_format=torch.channels_last))
        return self.trunk(x, heard)

    def encode(self, labels):
        """u8 [B,200,200,16] -> normalised mean latent [B,1,N,1]."""
        return (self.moments(labels)[0] - self.latent_mean) / self.latent_std

    def decode(self, latent, heard=None):
        """The likeliest class of each voxel, u8 [B,200,200,16]."""
        return self.logits(self.features(latent * self.latent_std + self.latent_mean, heard)).argmax(-1).to(torch.uint8)
