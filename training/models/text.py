"""The text encoder: mean of hashed n-gram embeddings through one residual layer to a unit vector, and, for training only,
an encoder of scene facts into the same space. Twin of src/gen/model/text.rs, which also makes the n-grams."""
import torch
import torch.nn.functional as F
from torch import nn

BUCKETS, WIDTH = 4096, 64


class Text(nn.Module):
    INNER = r"$^"

    def __init__(self, width=WIDTH):
        super().__init__()
        self.table = nn.Embedding(BUCKETS, width)
        nn.init.normal_(self.table.weight, std=0.1)
        self.first, self.second = nn.Linear(width, width), nn.Linear(width, width)

    def forward(self, ids):
        """ids [B,T], -1 is padding -> [B,width]."""
        known = (ids >= 0).float()
        x = (self.table(ids.clamp(min=0)) * known[..., None]).sum(1) / known.sum(1, keepdim=True).clamp(min=1).sqrt()
        return F.normalize(self.second(torch.tanh(self.first(x))) + x, dim=-1)


class Facts(nn.Module):
    def __init__(self, inputs, width=WIDTH):
        super().__init__()
        self.layers = nn.Sequential(nn.Linear(inputs, 128), nn.GELU(), nn.Linear(128, width))

    def forward(self, x):
        return F.normalize(self.layers(x), dim=-1)
