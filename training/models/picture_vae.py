"""Picture VAE: 256x144 sRGB <-> latent 32x18x8, of any size that eight divides.

Levels of 2, 4 and 8 px: a picture is folded into squares of 2x2 px before anything is computed, so no layer sees single pixels, and the last
layer unfolds them. Blocks as in the occupancy VAE: norms look at one place only, so a picture can be encoded and decoded in pieces.
"""
import json
from dataclasses import asdict, dataclass

import torch
from safetensors import safe_open
from safetensors.torch import load_file
from torch import nn

from models.occ_vae import ChannelNorm, Level, fold, unfold

CHANNELS = 3
CELL = 8  # px of a latent cell along a side


@dataclass
class PictureVaeConfig:
    """Widths at 2, 4 and 8 px; kernels of the residual blocks of each level, in the order they are passed."""

    latent: int = 8
    widths: tuple = (64, 96, 144)
    encoder_kernels: tuple = ((3,), (3, 3), (3, 3))
    decoder_kernels: tuple = ((3, 3, 3), (3, 3, 3), (3, 3, 3))

    def as_dict(self):
        return asdict(self)


class PictureVae(nn.Module):
    """Pictures are [B,3,h,w], -1 to 1."""

    INNER = r"(encoder|decoder|down|up)\."  # layers whose weights Muon trains

    def __init__(self, config=None):
        super().__init__()
        c = self.config = config or PictureVaeConfig()
        fine, coarse = c.widths[0], c.widths[-1]
        steps = list(zip(c.widths, c.widths[1:]))
        self.stem = nn.Conv2d(4 * CHANNELS, fine, 1)
        self.encoder = nn.ModuleList(Level(w, k) for w, k in zip(c.widths, c.encoder_kernels))
        self.down = nn.ModuleList(nn.Conv2d(4 * a, b, 1) for a, b in steps)
        self.encoder_norm = ChannelNorm(coarse)
        self.encoder_head = nn.Conv2d(coarse, 2 * c.latent, 1)
        self.decoder_stem = nn.Conv2d(c.latent, coarse, 1)
        self.decoder = nn.ModuleList(Level(w, k) for w, k in zip(c.widths[::-1], c.decoder_kernels))
        self.up = nn.ModuleList(nn.Conv2d(b, 4 * a, 1) for a, b in steps[::-1])
        self.decoder_norm = ChannelNorm(fine)
        self.decoder_head = nn.Conv2d(fine, 4 * CHANNELS, 1)
        # Statistics of the encoder's mean over the training set: latents leave and enter normalised.
        self.register_buffer("latent_mean", torch.zeros(c.latent))
        self.register_buffer("latent_std", torch.ones(c.latent))

    def moments(self, pictures):
        """[B,3,h,w] -> mean, log variance [B,C,h/8,w/8], not normalised."""
        x = self.encoder[0](self.stem(fold(pictures)))
        for down, level in zip(self.down, self.encoder[1:]):
            x = level(down(fold(x)))
        with torch.autocast(x.device.type, enabled=False):  # bf16 would round off what latents are to carry
            mean, logvar = self.encoder_head(self.encoder_norm(x.float())).chunk(2, 1)
        return mean, logvar.clamp(-30.0, 20.0)

    def features(self, latent):
        """Latent [B,C,h/8,w/8], not normalised -> what the last layer hears [B,W,h/2,w/2]."""
        with torch.autocast(latent.device.type, enabled=False):
            x = self.decoder_stem(latent.contiguous(memory_format=torch.channels_last))
        x = self.decoder[0](x)
        for up, level in zip(self.up, self.decoder[1:]):
            x = level(unfold(up(x)))
        return self.decoder_norm(x)

    def draw(self, latent):
        """Latent [B,C,h/8,w/8], not normalised -> picture [B,3,h,w]; not clamped."""
        return unfold(self.decoder_head(self.features(latent))).float()

    def encode(self, pictures):
        """[B,3,h,w] -> normalised mean latent [B,h/8,w/8,C]."""
        mean, _ = self.moments(pictures)
        return (mean.permute(0, 2, 3, 1) - self.latent_mean) / self.latent_std

    def decode(self, latent):
        """Normalised latent [B,h/8,w/8,C] -> picture [B,3,h,w], clamped to -1 to 1."""
        return self.draw((latent * self.latent_std + self.latent_mean).permute(0, 3, 1, 2)).clamp(-1, 1)


class Critic(nn.Module):
    """Tells drawn pictures from true ones, patch by patch of 22 px: used in training alone."""

    def __init__(self, width=48):
        super().__init__()
        layers, inputs = [], CHANNELS
        for i in range(3):
            outputs = width << i
            layers += [nn.Conv2d(inputs, outputs, 4, 2 if i < 2 else 1, 1), nn.LeakyReLU(0.2)]
            inputs = outputs
        self.layers = nn.Sequential(*layers, nn.Conv2d(inputs, 1, 3, 1, 1))

    def forward(self, pictures):
        """[B,3,h,w] -> a number per patch [B,1,...]: positive for what looks true."""
        return self.layers(pictures).float()


def load_picture_vae(path, device):
    """The network of a file of weights, which learns no more."""
    with safe_open(path, "pt") as f:
        config = json.loads(f.metadata()["config"])
    vae = PictureVae(PictureVaeConfig(**config))
    vae.load_state_dict({k: v.float() for k, v in load_file(path).items()})
    return vae.to(device, memory_format=torch.channels_last).eval().requires_grad_(False)
