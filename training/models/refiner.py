"""Diffusion that refines: from what the coarse latent decodes to, the fine latent (100x100x16) of what it may have been. Rust twin:
src/gen/model/refiner.rs.

It sees the noisy fine latent, the fine latents of the coarse result's labels and of the draft that was asked for (all 0 where that is not
told), and the coarse latent itself, and predicts v (2202.00512). Its
blocks see a few metres and no more, so an edit is refined where it is. Blocks as in the VAE; the timestep is added at the start of every level.
"""
from dataclasses import asdict, dataclass

import torch
from torch import nn
from torch.nn import functional as F

from models.occ_dit import timestep_embedding
from models.occ_vae import ChannelNorm, Level, fold, unfold


@dataclass
class RefinerConfig:
    latent: int = 16
    coarse: int = 8
    widths: tuple = (64, 128)
    kernels: tuple = ((3, 1), (3, 3, 1))  # of each level, finest first; the coarsest is passed once, the other on the way in and out
    frequencies: int = 64

    def as_dict(self):
        return asdict(self)


class Refiner(nn.Module):
    INNER = r"(enter|leave|middle|down|up)\."  # layers whose weights Muon trains

    def __init__(self, config=None):
        super().__init__()
        c = self.config = config or RefinerConfig()
        fine, wide = c.widths
        self.stem = nn.Conv2d(3 * c.latent, fine, 1)
        self.hint = nn.Conv2d(c.coarse, wide, 1)
        self.time1, self.time2 = nn.Linear(c.frequencies, wide), nn.Linear(wide, wide)
        self.tell = nn.ModuleList(nn.Linear(wide, w) for w in (fine, wide, fine))  # enter, middle, leave
        self.enter, self.middle, self.leave = (Level(c.widths[i], c.kernels[i]) for i in (0, 1, 0))
        self.down, self.up = nn.Conv2d(4 * fine, wide, 1), nn.Conv2d(wide, 4 * fine, 1)
        self.norm = ChannelNorm(fine)
        self.head = nn.Conv2d(fine, c.latent, 1)
        nn.init.zeros_(self.head.weight)
        nn.init.zeros_(self.head.bias)

    def forward(self, x, t, rough, told, coarse):
        """x, rough and told [B,X,Y,16], t [B] in 0..=999, coarse [B,X/2,Y/2,8] -> v [B,X,Y,16]."""
        h = torch.cat([x, rough, told], -1).permute(0, 3, 1, 2)
        h = self.stem(h.contiguous(memory_format=torch.channels_last))
        c = F.silu(self.time2(F.silu(self.time1(timestep_embedding(t, self.config.frequencies)))))
        enter, middle, leave = (tell(c)[:, :, None, None] for tell in self.tell)
        kept = self.enter(h + enter)
        hint = self.hint(coarse.permute(0, 3, 1, 2).contiguous(memory_format=torch.channels_last))
        h = self.middle(self.down(fold(kept)) + hint + middle)
        h = self.leave(unfold(self.up(h)) + kept + leave)
        return self.head(self.norm(h)).permute(0, 2, 3, 1).float()
