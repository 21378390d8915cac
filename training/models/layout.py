"""The layout network: a graph network over nodes and typed relations, then a denoiser of boxes and lane points whose
attention knows the relations and the map. Twin of src/gen/model/layout/. X-Scene section 3.1 (graph, boxes, lanes);
attention bias by relation as in Graphormer (2106.05234), one modulation for all blocks as in PixArt-alpha (2310.00426).
"""
import dataclasses
import math

import torch
import torch.nn.functional as F
from torch import nn

BOX, VALUES, KINDS, RELATIONS = 8, 24, 27, 19
MAP_SIDE, MAP_CHANNELS, PATCH, SUB = 100, 8, 20, 10  # a map token is 20 x 20 cells, seen as 10 x 10 means
LOCAL = MAP_CHANNELS + 3  # the cell under a box, the place within it, whether there is a map


@dataclasses.dataclass
class LayoutConfig:
    width: int = 96
    depth: int = 4
    heads: int = 4
    rounds: int = 2
    hidden: int = 192
    frequencies: int = 64

    def as_dict(self):
        return dataclasses.asdict(self)


def norm(x):
    return F.layer_norm(x, x.shape[-1:], eps=1e-6)


def timestep_embedding(t, n):
    """[B] -> [B,n]: cosines, then sines."""
    f = torch.exp(-math.log(10000) * torch.arange(n // 2, dtype=torch.float32, device=t.device) / (n // 2))
    a = t[:, None].float() * f[None]
    return torch.cat([a.cos(), a.sin()], 1)


class Round(nn.Module):
    """One round of messages along the edges: mean over a node's messages, residual."""

    def __init__(self, c):
        super().__init__()
        w = c.width
        self.source, self.target = nn.Linear(w, w), nn.Linear(w, w, bias=False)
        self.relation = nn.Embedding(2 * RELATIONS, w)
        self.distance = nn.Linear(2, w, bias=False)
        self.out = nn.Linear(w, w)

    def forward(self, h, src, dst, rel, dist):
        """h [M,w] of all graphs; src, dst, rel [E]; dist [E,2] (stated distance / 20 m, whether there is one)."""
        n = norm(h)
        m = F.gelu(self.source(n)[src] + self.target(n)[dst] + self.relation(rel) + self.distance(dist))
        total = torch.zeros_like(h, dtype=m.dtype).index_add_(0, dst, m)
        count = torch.zeros(len(h), dtype=m.dtype, device=h.device).index_add_(0, dst, torch.ones_like(dst, dtype=m.dtype))
        return h + self.out(total / count.clamp(min=1)[:, None])


class Block(nn.Module):
    def __init__(self, c):
        super().__init__()
        w = c.width
        self.heads = c.heads
        self.qkv, self.map_kv, self.proj = nn.Linear(w, 3 * w), nn.Linear(w, 2 * w), nn.Linear(w, w)
        self.fc1, self.fc2 = nn.Linear(w, c.hidden), nn.Linear(c.hidden, w)
        self.shift = nn.Parameter(torch.zeros(6, w))
        self.bias = nn.Embedding(2 * RELATIONS + 1, c.heads)  # the last for pairs about which nothing was said
        nn.init.zeros_(self.bias.weight)

    def forward(self, x, mod, tokens, hidden, pairs):
        """x [B,N,w]; mod [B,6,w]; tokens [B,T,w]; hidden [B,1,1,N+T]: -1e4 on what must not be seen; pairs: bias indices."""
        b, n, w = x.shape
        t = tokens.shape[1]
        split = lambda a: a.unflatten(-1, (self.heads, -1)).transpose(1, 2)
        m = (mod + self.shift[None]).unsqueeze(2)  # [B,6,1,w]
        y = norm(x) * (1 + m[:, 1]) + m[:, 0]
        q, k, v = self.qkv(y).chunk(3, -1)
        mk, mv = self.map_kv(tokens).chunk(2, -1)
        k, v = torch.cat([k, mk], 1), torch.cat([v, mv], 1)
        scores = split(q) @ split(k).transpose(-1, -2) * (w // self.heads) ** -0.5
        scores = scores + F.pad(self.relation_bias(pairs, b, n), (0, t)) + hidden
        a = scores.softmax(-1).to(v.dtype) @ split(v)
        x = x + m[:, 2] * self.proj(a.transpose(1, 2).flatten(2))
        y = norm(x) * (1 + m[:, 4]) + m[:, 3]
        return x + m[:, 5] * self.fc2(F.gelu(self.fc1(y)))

    def relation_bias(self, pairs, b, n):
        """pairs (graph, query, key, relation) [4,E]: sums of the table's rows for each pair of nodes."""
        flat = (pairs[0] * n + pairs[1]) * n + pairs[2]
        out = torch.zeros(b * n * n, self.heads, device=flat.device)
        out = out.index_add(0, flat, self.bias(pairs[3]).float())
        return out.view(b, n, n, self.heads).permute(0, 3, 1, 2)


class Layout(nn.Module):
    INNER = r"(blocks\..*\.(qkv|map_kv|proj|fc1|fc2)|rounds\..*\.(source|target|out))$"

    def __init__(self, config=LayoutConfig()):
        super().__init__()
        self.config = c = config
        w = c.width
        self.kind, self.state, self.size = nn.Embedding(KINDS, w), nn.Embedding(4, w), nn.Embedding(3, w)
        self.given = nn.Linear(VALUES + 1, w)  # locked geometry, and whether it is
        self.rounds = nn.ModuleList(Round(c) for _ in range(c.rounds))
        self.node = nn.Linear(w, w)
        self.enter = nn.Linear(VALUES + LOCAL, w)
        self.patch = nn.Linear(SUB * SUB * MAP_CHANNELS, w)
        self.place = nn.Parameter(torch.randn((MAP_SIDE // PATCH) ** 2, w) * 0.02)
        self.time1, self.time2 = nn.Linear(c.frequencies, w), nn.Linear(w, w)
        self.modulation = nn.Linear(w, 6 * w)
        self.blocks = nn.ModuleList(Block(c) for _ in range(c.depth))
        self.last = nn.Linear(w, 2 * w)
        self.leave = nn.Linear(w, VALUES)
        for layer in (self.modulation, self.last, self.leave):
            nn.init.zeros_(layer.weight)
            nn.init.zeros_(layer.bias)
        with torch.no_grad():  # gates start at a tenth, so that the first gradients reach everything
            self.modulation.bias.view(6, w)[2] = 0.1
            self.modulation.bias.view(6, w)[5] = 0.1

    def embed(self, b):
        """Nodes through the graph network [B,N,w] and map tokens [B,T,w]: what does not change while sampling."""
        kind = b["kind"]
        h = self.kind(kind) + self.state(b["state"]) + self.size(b["size"])
        h = h + self.given(torch.cat([b["given"], b["locked"][..., None].float()], -1))
        n = kind.shape[1]
        src, dst, rel = b["edges"][0] * n + b["edges"][1], b["edges"][0] * n + b["edges"][2], b["edges"][3]
        both = torch.cat([src, dst]), torch.cat([dst, src]), torch.cat([rel, rel + RELATIONS])
        dist = torch.cat([b["distance"], b["distance"]])
        flat = h.flatten(0, 1)
        for r in self.rounds:
            flat = r(flat, *both, dist)
        p, s = MAP_SIDE // PATCH, PATCH // SUB
        m = b["map"]  # [B,100,100,8] floats
        m = m.view(len(m), p, SUB, s, p, SUB, s, MAP_CHANNELS).mean((3, 6)).permute(0, 1, 3, 2, 4, 5)
        tokens = self.patch(m.reshape(len(m), p * p, -1)) + self.place
        return self.node(norm(flat)).view(h.shape), norm(F.gelu(tokens))

    def local(self, x, b):
        """The map's cell under every box [B,N,11]; zeros for other nodes and without a map."""
        at = (x[..., :2].detach().clamp(-2, 2) * 20 + 40) * 1.25
        cell = at.floor().clamp(0, MAP_SIDE - 1)
        index = (cell[..., 0] * MAP_SIDE + cell[..., 1]).long()
        m = b["map"].flatten(1, 2)
        found = torch.gather(m, 1, index[..., None].expand(-1, -1, MAP_CHANNELS))
        known = ((b["shape"] == 1) & b["has_map"][:, None])[..., None].float()
        return torch.cat([found, at - cell - 0.5, torch.ones_like(known)], -1) * known

    def forward(self, x, t, b, embedded=None):
        """x [B,N,24] noisy, locked nodes clean; t [B]; b: a batch of train_layout.py. Answers v [B,N,24]."""
        nodes, tokens = embedded if embedded is not None else self.embed(b)
        h = self.enter(torch.cat([x, self.local(x, b)], -1)) + nodes
        c = F.silu(self.time2(F.silu(self.time1(timestep_embedding(t, self.config.frequencies)))))
        mod = self.modulation(c).unflatten(-1, (6, -1))
        e, n = b["edges"], x.shape[1]
        pairs = torch.cat([e, torch.stack([e[0], e[2], e[1], e[3] + RELATIONS])], 1)
        no_map = ~b["has_map"][:, None].expand(-1, tokens.shape[1])
        hidden = torch.cat([b["kind"] == 0, no_map], 1)[:, None, None].float() * -1e4
        for block in self.blocks:
            h = block(h, mod, tokens, hidden, pairs)
        shift, scale = self.last(c)[:, None].chunk(2, -1)
        return self.leave(norm(h) * (1 + scale) + shift)
