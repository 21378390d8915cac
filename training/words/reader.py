"""The reader: an encoder-decoder with a copy mechanism. Twin of src/gen/words/reader.rs.

Vaswani et al. 2017 (arXiv 1706.03762), relative position bias of Raffel et al. 2020 (arXiv 1910.10683), copying of See et al. 2017
(arXiv 1704.04368). [B, T] tokens of a text; [B, S] symbols of a reading.
"""

import torch
from torch import nn
from torch.nn import functional as F

import symbols

NEAR = 24  # positions whose bias differs


def drop(x, share, training):
    """Dropout by random bytes: on a processor drawing them costs less than the draw of F.dropout."""
    if not training or share == 0.0:
        return x
    cut = round(share * 256)
    bytes_ = torch.empty((x.numel() + 7) // 8, dtype=torch.int64).random_(-(2**63), None).view(torch.uint8)
    return x * bytes_[: x.numel()].view(x.shape).ge(cut).to(x.dtype) * (256 / (256 - cut))


class Config:
    def __init__(self, words, width=224, heads=4, inner=672, encoder=4, decoder=3):
        self.words, self.width, self.heads, self.inner, self.encoder, self.decoder = words, width, heads, inner, encoder, decoder


class Attention(nn.Module):
    def __init__(self, c, cross=False):
        super().__init__()
        self.heads = c.heads
        self.q, self.k, self.v, self.o = (nn.Linear(c.width, c.width, bias=False) for _ in range(4))
        self.bias = None if cross else nn.Parameter(torch.zeros(c.heads, 2 * NEAR + 1))

    def forward(self, x, y, mask):
        b, t, w = x.shape
        s = y.shape[1]
        split = lambda z, n: z.view(b, n, self.heads, w // self.heads).transpose(1, 2)
        q, k, v = split(self.q(x), t), split(self.k(y), s), split(self.v(y), s)
        score = mask
        if self.bias is not None:
            d = (torch.arange(s)[None] - torch.arange(t)[:, None]).clamp(-NEAR, NEAR) + NEAR
            score = score + self.bias[:, d][None]
        # (plain matmuls: at these lengths they train faster on a processor than scaled_dot_product_attention)
        z = (q @ k.transpose(-1, -2) * (w // self.heads) ** -0.5 + score).softmax(-1) @ v
        return self.o(z.transpose(1, 2).reshape(b, t, w))


class Layer(nn.Module):
    def __init__(self, c, cross):
        super().__init__()
        self.norm = nn.LayerNorm(c.width)
        self.attention = Attention(c)
        if cross:
            self.cross_norm = nn.LayerNorm(c.width)
            self.cross = Attention(c, cross=True)
        self.inner_norm = nn.LayerNorm(c.width)
        self.up, self.down = nn.Linear(c.width, c.inner), nn.Linear(c.inner, c.width)

    def forward(self, x, mask, memory=None, memory_mask=None, share=0.0):
        y = self.norm(x)
        x = x + drop(self.attention(y, y, mask), share, self.training)
        if memory is not None:
            x = x + drop(self.cross(self.cross_norm(x), memory, memory_mask), share, self.training)
        return x + drop(self.down(F.gelu(self.up(self.inner_norm(x)), approximate="tanh")), share, self.training)


class Reader(nn.Module):
    def __init__(self, c):
        super().__init__()
        self.c = c
        v = len(symbols.SYMBOLS)
        self.word = nn.Embedding(c.words, c.width)
        self.gram = nn.EmbeddingBag(symbols.GRAMS, c.width, mode="mean", padding_idx=0)
        self.sense = nn.EmbeddingBag(len(symbols.SENSES) + 1, c.width, mode="sum", padding_idx=0)
        self.value = nn.Embedding(34, c.width)
        self.pointer = nn.Embedding(symbols.MOST_NUMBERS + 1, c.width)
        self.encoder = nn.ModuleList(Layer(c, False) for _ in range(c.encoder))
        self.encoder_norm = nn.LayerNorm(c.width)
        self.symbol = nn.Embedding(v + 1, c.width)  # the last one begins a reading
        self.decoder = nn.ModuleList(Layer(c, True) for _ in range(c.decoder))
        self.decoder_norm = nn.LayerNorm(c.width)
        self.say = nn.Linear(c.width, v)
        self.copy_sense = nn.Linear(c.width, c.width, bias=False)
        self.copy_number = nn.Linear(c.width, c.width, bias=False)
        for e in (self.word, self.gram, self.sense, self.value, self.pointer, self.symbol):
            nn.init.normal_(e.weight, std=0.5 / c.width**0.5 * 4)
            if getattr(e, "padding_idx", None) == 0:
                e.weight.data[0] = 0

    def encode(self, x):
        """Memory [B, T, W] and its mask [B, 1, 1, T]."""
        b, t = x["word"].shape
        e = self.word(x["word"]) + self.value(x["value"]) + self.pointer(x["pointer"])
        e = e + self.gram(x["gram"].view(b * t, -1)).view(b, t, -1) + self.sense(x["sense"].view(b * t, -1)).view(b, t, -1)
        mask = torch.zeros(b, 1, 1, t).masked_fill(x["empty"][:, None, None], float("-inf"))
        for layer in self.encoder:
            e = layer(e, mask, share=0.1)
        return self.encoder_norm(e), mask

    def decode(self, said, memory, mask, x):
        """Log probabilities [B, S, V] of the next symbol after each."""
        s = said.shape[1]
        causal = torch.full((s, s), float("-inf")).triu(1)[None, None]
        h = self.symbol(said)
        for layer in self.decoder:
            h = layer(h, causal, memory, mask, share=0.1)
        h = self.decoder_norm(h)
        gen = self.say(h)  # [B, S, V]
        scale = self.c.width**-0.5
        by_sense = (self.copy_sense(h) @ memory.transpose(1, 2)) * scale
        by_number = (self.copy_number(h) @ memory.transpose(1, 2)) * scale
        closed = float("-inf")
        by_sense = by_sense.masked_fill((x["copy_sense"] < 0)[:, None], closed)
        by_number = by_number.masked_fill((x["copy_number"] < 0)[:, None], closed)
        p = torch.cat([gen, by_sense, by_number], -1).softmax(-1)
        v, t = gen.shape[-1], memory.shape[1]
        out = p[..., :v].clone()
        for at, ids in ((v, x["copy_sense"]), (v + t, x["copy_number"])):
            out = out.scatter_add(2, ids.clamp(min=0)[:, None].expand(-1, s, -1), p[..., at : at + t])
        return (out + 1e-9).log()

    def forward(self, x, said):
        memory, mask = self.encode(x)
        return self.decode(said, memory, mask, x)
