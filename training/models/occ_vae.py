"""Occupancy VAE: 200x200x16 labels <-> latent 50x50x8. Rust twin: src/gen/model/occ_vae.rs.

A cell is 4x4x16 voxels; voxel p = (dx*4 + dy)*16 + z of a cell. The encoder sums one embedding per occupied
voxel of a cell, so its cost follows what is there. It looks only two cells (3.2 m) around itself, so an edit changes
few latents; the decoder, which has to invent what the 8 numbers leave out, looks further.
"""
from dataclasses import asdict, dataclass

import torch
from torch import nn

FREE = 17
CLASSES = 18
CELLS = 50  # per side
VOXELS = 256  # per cell
FEATURES = 8  # per voxel, before the class table


@dataclass
class VaeConfig:
    latent: int = 8
    encoder_width: int = 128
    encoder_kernels: tuple = (3, 1, 3)
    decoder_width: int = 128
    decoder_kernels: tuple = (3, 3, 3, 3, 3)

    def as_dict(self):
        return {k: list(v) if isinstance(v, tuple) else v for k, v in asdict(self).items()}


class ChannelNorm(nn.LayerNorm):
    """Layer norm over the channels of each cell. Unlike a group norm it does not look at the rest of the map, so
    encoding and decoding stay local: an edit cannot change a label that is out of reach of the convolutions."""

    def __init__(self, width):
        super().__init__(width, eps=1e-6)

    def forward(self, x):
        return super().forward(x.permute(0, 2, 3, 1)).permute(0, 3, 1, 2)


class ResBlock(nn.Module):
    """x + W2 gelu(W1 norm(x)); W1 is k x k, W2 1x1."""

    def __init__(self, width, kernel):
        super().__init__()
        self.norm = ChannelNorm(width)
        self.conv1 = nn.Conv2d(width, width, kernel, padding=kernel // 2)
        self.conv2 = nn.Conv2d(width, width, 1)
        nn.init.normal_(self.conv2.weight, std=0.3 * width**-0.5)
        nn.init.zeros_(self.conv2.bias)

    def forward(self, x):
        return x + self.conv2(nn.functional.gelu(self.conv1(self.norm(x))))


def to_cells(labels):
    """u8 labels [B,200,200,16] -> [B*2500, 256], cells in x-major order."""
    b = labels.shape[0]
    return labels.view(b, CELLS, 4, CELLS, 4, 16).permute(0, 1, 3, 2, 4, 5).reshape(b * CELLS * CELLS, VOXELS)


def from_cells(cells):
    """The inverse of to_cells."""
    b = cells.shape[0] // (CELLS * CELLS)
    return cells.view(b, CELLS, CELLS, 4, 4, 16).permute(0, 1, 3, 2, 4, 5).reshape(b, 200, 200, 16)


class OccVae(nn.Module):
    def __init__(self, config=None):
        super().__init__()
        c = self.config = config or VaeConfig()
        self.embed = nn.EmbeddingBag(VOXELS * FREE, c.encoder_width, mode="sum")
        nn.init.normal_(self.embed.weight, std=0.1)
        self.encoder = nn.ModuleList(ResBlock(c.encoder_width, k) for k in c.encoder_kernels)
        self.encoder_norm = ChannelNorm(c.encoder_width)
        self.encoder_head = nn.Conv2d(c.encoder_width, 2 * c.latent, 1)
        self.decoder_stem = nn.Conv2d(c.latent, c.decoder_width, 1)
        self.decoder = nn.ModuleList(ResBlock(c.decoder_width, k) for k in c.decoder_kernels)
        self.decoder_norm = ChannelNorm(c.decoder_width)
        self.decoder_head = nn.Conv2d(c.decoder_width, VOXELS * FEATURES, 1)
        self.class_table = nn.Parameter(torch.randn(CLASSES, FEATURES))
        self.class_bias = nn.Parameter(torch.zeros(CLASSES))
        # Statistics of the encoder's mean over the training set: latents leave and enter normalised.
        self.register_buffer("latent_mean", torch.zeros(c.latent))
        self.register_buffer("latent_std", torch.ones(c.latent))

    def moments(self, cells):
        """Cells u8 [B*2500,256] -> mean, log variance [B,8,50,50], not normalised."""
        occupied = cells != FREE
        where = occupied.view(-1).nonzero().squeeze(1)  # flat index: cell * 256 + voxel
        codes = (where % VOXELS) * FREE + cells.reshape(-1)[where]
        offsets = torch.zeros(cells.shape[0], dtype=torch.long, device=cells.device)
        torch.cumsum(occupied.sum(1)[:-1], 0, out=offsets[1:])
        x = self.embed(codes, offsets)
        # [B,50,50,W] seen as [B,W,50,50] is channels_last already.
        x = x.view(-1, CELLS, CELLS, self.config.encoder_width).permute(0, 3, 1, 2)
        for block in self.encoder:
            x = block(x)
        mean, logvar = self.encoder_head(self.encoder_norm(x)).float().chunk(2, 1)
        return mean, logvar.clamp(-30.0, 20.0)

    def features(self, latent):
        """Latent [B,8,50,50], not normalised -> voxel features [B*2500,256,8]."""
        x = self.decoder_stem(latent.contiguous(memory_format=torch.channels_last))
        for block in self.decoder:
            x = block(x)
        x = self.decoder_head(self.decoder_norm(x))
        return x.permute(0, 2, 3, 1).reshape(-1, VOXELS, FEATURES)

    def logits(self, features):
        """Voxel features [..., 8] -> class logits [..., 18]: a dot product with the class table."""
        return features.float() @ self.class_table.t() + self.class_bias

    def encode(self, labels):
        """u8 [B,200,200,16] -> normalised mean latent [B,50,50,8]."""
        mean, _ = self.moments(to_cells(labels))
        return (mean.permute(0, 2, 3, 1) - self.latent_mean) / self.latent_std

    def decode(self, latent):
        """Normalised latent [B,50,50,8] -> u8 [B,200,200,16], the likeliest class of each voxel."""
        features = self.features((latent * self.latent_std + self.latent_mean).permute(0, 3, 1, 2))
        return from_cells(self.logits(features).argmax(-1).to(torch.uint8))
