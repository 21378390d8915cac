"""A small segmenter of pictures, trained on the program's own renders. It judges whether drawn pictures show what was asked for, and its
features serve as a measure of likeness. Blocks and levels as in the picture VAE, with what each level saw handed across.
"""
from dataclasses import asdict, dataclass

import torch
from torch import nn

from models.occ_vae import ChannelNorm, Level, fold, unfold

CLASSES = 22  # of src/scene/truth.rs; 255 is outside the lens
OUTSIDE = 255


@dataclass
class SegmenterConfig:
    widths: tuple = (32, 64, 96)  # at 2, 4 and 8 px
    kernels: tuple = ((3,), (3, 3), (3, 3, 3))

    def as_dict(self):
        return asdict(self)


class Segmenter(nn.Module):
    INNER = r"(enter|leave|down|up)\."  # layers whose weights Muon trains

    def __init__(self, config=None):
        super().__init__()
        c = self.config = config or SegmenterConfig()
        steps = list(zip(c.widths, c.widths[1:]))
        self.stem = nn.Conv2d(12, c.widths[0], 1)
        self.enter = nn.ModuleList(Level(w, k) for w, k in zip(c.widths, c.kernels))
        self.down = nn.ModuleList(nn.Conv2d(4 * a, b, 1) for a, b in steps)
        self.leave = nn.ModuleList(Level(w, (3,)) for w in c.widths[-2::-1])
        self.up = nn.ModuleList(nn.Conv2d(b, 4 * a, 1) for a, b in steps[::-1])
        self.norm = ChannelNorm(c.widths[0])
        self.head = nn.Conv2d(c.widths[0], 4 * CLASSES, 1)

    def seen(self, pictures):
        """[B,3,h,w], -1 to 1 -> what each level saw, finest first: [B,W,h/2,w/2] and so on."""
        levels = [self.enter[0](self.stem(fold(pictures)))]
        for down, level in zip(self.down, self.enter[1:]):
            levels.append(level(down(fold(levels[-1]))))
        return levels

    def forward(self, pictures):
        """[B,3,h,w], -1 to 1 -> logits [B,22,h,w]."""
        *kept, x = self.seen(pictures)
        for up, level, before in zip(self.up, self.leave, kept[::-1]):
            x = level(unfold(up(x)) + before)
        return unfold(self.head(self.norm(x)))

    def likeness(self, pictures, truth):
        """How far two sets of pictures are apart as the segmenter sees them: mean squares of differences of normalised features."""
        total = 0.0
        with torch.no_grad():
            wanted = self.seen(truth)
        for a, b in zip(self.seen(pictures), wanted):
            a, b = (x.float() * (x.float().square().mean(1, keepdim=True) + 1e-6).rsqrt() for x in (a, b))
            total = total + (a - b).square().mean()
        return total

    def pooled(self, pictures):
        """[B,3,h,w] -> means of the coarsest level [B,W], for distances between sets of pictures."""
        return self.seen(pictures)[-1].float().mean((2, 3))
