"""Occupancy VAE: 200x200x16 labels <-> latent 50x50x8, or 100x100x16 ("fine"). Rust twin: src/gen/model/occ_vae.rs.

Levels in the top view: columns of 0.4 m (all 16 voxels of one place), 0.8 m and, unless it is the fine one, 1.6 m. What a column means does
not depend on where in its latent cell it lies, so columns share their weights: a cone is learnt once, not once for each
of the sixteen places it can have in a cell. The encoder sums one embedding per occupied voxel and looks two cells
(3.2 m) around itself, so its cost follows what is there and an edit changes few latents; the decoder looks three.
"""
import hashlib
import json
from dataclasses import asdict, dataclass
from pathlib import Path

import torch
from safetensors import safe_open
from safetensors.torch import load_file
from torch import nn
from torch.nn import functional as F

FREE = 17
CLASSES = 18
CELLS = 50  # per side
HEIGHT = 16  # voxels of a column
FEATURES = 8  # per voxel, before the class table


@dataclass
class VaeConfig:
    """Widths at 0.4, 0.8 (and 1.6) m; kernels of the residual blocks of each level, in the order they are passed. Each
    level halves the side, so their number says how many columns a latent cell covers."""

    latent: int = 8
    widths: tuple = (48, 96, 192)
    encoder_kernels: tuple = ((1,), (3,), (3, 1, 1))
    decoder_kernels: tuple = ((3, 3, 1), (3,), (1, 1))
    hears: bool = False  # the decoder hears the draft of the layout and which voxels were observed

    @classmethod
    def fine(cls):
        return cls(16, (48, 96), ((1,), (3, 1)), ((3, 3), (1, 1)))

    def as_dict(self):
        return asdict(self)


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
        return x + self.conv2(F.gelu(self.conv1(self.norm(x))))


class Level(nn.Module):
    def __init__(self, width, kernels):
        super().__init__()
        self.blocks = nn.ModuleList(ResBlock(width, k) for k in kernels)

    def forward(self, x):
        for block in self.blocks:
            x = block(x)
        return x


def fold(x):
    """[B,C,H,W] -> [B,4C,H/2,W/2], channel order (dx, dy, c); channels_last."""
    b, c, h, w = x.shape
    x = x.permute(0, 2, 3, 1).reshape(b, h // 2, 2, w // 2, 2, c).permute(0, 1, 3, 2, 4, 5)
    return x.reshape(b, h // 2, w // 2, 4 * c).permute(0, 3, 1, 2)


def unfold(x):
    """The inverse of fold."""
    b, c, h, w = x.shape
    x = x.permute(0, 2, 3, 1).reshape(b, h, w, 2, 2, c // 4).permute(0, 1, 3, 2, 4, 5)
    return x.reshape(b, 2 * h, 2 * w, c // 4).permute(0, 3, 1, 2)


def sum_of_voxels(table, labels):
    """u8 [B,X,Y,16] -> [B,W,X,Y]: per column the sum of the table's rows of its occupied voxels (bin * 17 + label)."""
    columns = labels.reshape(-1, HEIGHT)
    occupied = columns != FREE
    where = occupied.view(-1).nonzero().squeeze(1)  # flat index: column * 16 + z
    codes = (where % HEIGHT) * FREE + columns.reshape(-1)[where]
    offsets = torch.zeros(len(columns), dtype=torch.long, device=labels.device)
    torch.cumsum(occupied.sum(1)[:-1], 0, out=offsets[1:])
    # [B,X,Y,W] seen as [B,W,X,Y] is channels_last already.
    return table(codes, offsets).view(*labels.shape[:3], -1).permute(0, 3, 1, 2)


class OccVae(nn.Module):
    """Works on maps of any size that four divides: training crops, frames."""

    INNER = r"(encoder|decoder|down|up)\."  # layers whose weights Muon trains

    def __init__(self, config=None):
        super().__init__()
        c = self.config = config or VaeConfig()
        fine, coarse = c.widths[0], c.widths[-1]
        steps = list(zip(c.widths, c.widths[1:]))
        self.embed = nn.EmbeddingBag(HEIGHT * FREE, fine, mode="sum")
        nn.init.normal_(self.embed.weight, std=0.3)
        self.encoder = nn.ModuleList(Level(w, k) for w, k in zip(c.widths, c.encoder_kernels))
        self.down = nn.ModuleList(nn.Conv2d(4 * a, b, 1) for a, b in steps)
        self.encoder_norm = ChannelNorm(coarse)
        self.encoder_head = nn.Conv2d(coarse, 2 * c.latent, 1)
        self.decoder_stem = nn.Conv2d(c.latent, coarse, 1)
        self.decoder = nn.ModuleList(Level(w, k) for w, k in zip(c.widths[::-1], c.decoder_kernels))
        self.up = nn.ModuleList(nn.Conv2d(b, 4 * a, 1) for a, b in steps[::-1])
        if c.hears:
            self.drafted = nn.EmbeddingBag(HEIGHT * FREE, fine, mode="sum")
            self.observed = nn.Linear(HEIGHT + 1, fine, bias=False)  # bits of a column; are they known?
            nn.init.zeros_(self.drafted.weight)
            nn.init.zeros_(self.observed.weight)
        self.decoder_norm = ChannelNorm(fine)
        self.decoder_head = nn.Conv2d(fine, HEIGHT * FEATURES, 1)
        self.class_table = nn.Parameter(torch.randn(CLASSES, FEATURES))
        self.class_bias = nn.Parameter(torch.zeros(CLASSES))
        # Statistics of the encoder's mean over the training set: latents leave and enter normalised.
        self.register_buffer("latent_mean", torch.zeros(c.latent))
        self.register_buffer("latent_std", torch.ones(c.latent))

    def moments(self, labels):
        """Labels u8 [B,X,Y,16] -> mean, log variance [B,C,X/f,Y/f], not normalised; f columns a cell."""
        x = self.encoder[0](sum_of_voxels(self.embed, labels))
        for down, level in zip(self.down, self.encoder[1:]):
            x = level(down(fold(x)))
        with torch.autocast(x.device.type, enabled=False):  # bf16 would round off what latents are to carry
            mean, logvar = self.encoder_head(self.encoder_norm(x.float())).chunk(2, 1)
        return mean, logvar.clamp(-30.0, 20.0)

    def features(self, latent, heard=None):
        """Latent [B,C,x,y], not normalised, and what is `heard`: a draft u8 [B,f x,f y,16], all free where there is none, and what was
        observed i32 [B,f x,f y] (a bit per voxel, and bit 16 where that is known) -> voxel features [B,f x,f y,16,8]."""
        with torch.autocast(latent.device.type, enabled=False):
            x = self.decoder_stem(latent.contiguous(memory_format=torch.channels_last))
        return self.trunk(x, heard)

    def trunk(self, x, heard):
        """What `features` does once the latent is as wide as the coarsest level."""
        x = self.decoder[0](x)
        for i, (up, level) in enumerate(zip(self.up, self.decoder[1:])):
            x = unfold(up(x))
            if heard is not None and i + 1 == len(self.up):
                draft, observed = heard
                bits = (observed[..., None] >> torch.arange(HEIGHT + 1, device=x.device)) & 1
                x = x + sum_of_voxels(self.drafted, draft) + self.observed(bits.to(x.dtype)).permute(0, 3, 1, 2)
            x = level(x)
        x = self.decoder_head(self.decoder_norm(x)).permute(0, 2, 3, 1)
        return x.reshape(*x.shape[:3], HEIGHT, FEATURES)

    def logits(self, features):
        """Voxel features [..., 8] -> class logits [..., 18]: a dot product with the class table."""
        with torch.autocast(features.device.type, enabled=False):
            return features.float() @ self.class_table.t() + self.class_bias

    def encode(self, labels):
        """u8 [B,200,200,16] -> normalised mean latent [B,50,50,8]."""
        mean, _ = self.moments(labels)
        return (mean.permute(0, 2, 3, 1) - self.latent_mean) / self.latent_std

    def decode(self, latent, heard=None):
        """Normalised latent [B,50,50,8] and what the decoder hears (`features`) -> u8 [B,200,200,16], the likeliest class of each voxel."""
        features = self.features((latent * self.latent_std + self.latent_mean).permute(0, 3, 1, 2), heard)
        return self.logits(features).argmax(-1).to(torch.uint8)


def load_vae(path, device):
    """The network of a file of weights, which learns no more."""
    from models.triplane_vae import TriplaneVae

    with safe_open(path, "pt") as f:
        meta = f.metadata()
    vae = (TriplaneVae if meta.get("kind") == "triplane_vae" else OccVae)(VaeConfig(**json.loads(meta["config"])))
    vae.load_state_dict({k: v.float() for k, v in load_file(path).items()})
    return vae.to(device, memory_format=torch.channels_last).eval().requires_grad_(False)


def latent_space(path):
    """Names the latents of a VAE: its file's hash, or, where only the decoder was trained on, that of the file it came
    from, or the name that shipped weights bear. A DiT belongs to a latent space."""
    with safe_open(path, "pt") as f:
        meta = f.metadata() or {}
    name = meta.get("latents") or meta.get("name")
    return name or hashlib.sha256(Path(path).read_bytes()).hexdigest()[:12]
