"""Trains the text encoder and writes its weights, card section and golden: python train_text.py --data DIR --minutes M
-o W.safetensors --export "DATA COMMAND". See README.md."""
import argparse
import json
import time
from pathlib import Path

import numpy as np
import torch
import torch.nn.functional as F
from safetensors.numpy import load_file
from safetensors.torch import load_file as load_tensors
from safetensors.torch import save_file

from export import ROOT, read
from export_layout import write_card
from loop import Run, pick_device
from models.text import BUCKETS, WIDTH, Facts, Text


class Both(torch.nn.Module):
    INNER = r"$^"

    def __init__(self, inputs):
        super().__init__()
        self.text, self.facts = Text(), Facts(inputs)
        self.log_scale = torch.nn.Parameter(torch.tensor(2.5))


class Sentences:
    def __init__(self, folder):
        shards = [load_file(f) for f in sorted(Path(folder).glob("shard_*.safetensors"))]
        self.ids = torch.from_numpy(np.concatenate([s["ids"] for s in shards])).long()
        self.features = torch.from_numpy(np.concatenate([s["features"] for s in shards]))
        self.text = np.concatenate([s["text"] for s in shards])


def contrast(a, b, scale):
    """InfoNCE both ways: row i of a belongs to row i of b."""
    scores, target = a @ b.T * scale, torch.arange(len(a))
    return (F.cross_entropy(scores, target) + F.cross_entropy(scores.T, target)) / 2


def losses(model, ids, features, rng):
    which = rng.permutation(4)[:2]
    a, b = model.text(ids[:, which[0]]), model.text(ids[:, which[1]])
    f, scale = model.facts(features), model.log_scale.clamp(max=4).exp()
    return contrast(a, b, scale) + 0.5 * (contrast(a, f, scale) + contrast(b, f, scale))


@torch.no_grad()
def figures(model, data):
    """Of held-out scenes: how often a short or a half sentence finds its scene's full one first, or among the first five;
    how often the best of the other scenes has the same kind of road (8 kinds; by chance 1 in 8)."""
    full, half, short = (model.text(data.ids[:, i]) for i in (0, 1, 2))
    out = {}
    for name, query in (("half", half), ("short", short)):
        scores = query @ full.T
        order = scores.argsort(1, descending=True)
        rank = (order == torch.arange(len(full))[:, None]).int().argmax(1)
        out |= {f"{name}_first": (rank == 0).float().mean().item(), f"{name}_of_5": (rank < 5).float().mean().item()}
        other = scores.masked_fill(torch.eye(len(full), dtype=torch.bool), -2).argmax(1)
        road = data.features[:, :8].argmax(1)
        out[f"{name}_road"] = (road[other] == road).float().mean().item()
    return out


def main():
    p = argparse.ArgumentParser(description=__doc__)
    p.add_argument("--data", type=Path, required=True, help="folder with train/ and val/ shards of `dataset text`")
    p.add_argument("--minutes", type=float, required=True)
    p.add_argument("-o", "--output", required=True)
    p.add_argument("--export", metavar="DATA_COMMAND", help="write assets/weights and tests/reference too")
    p.add_argument("--seed", type=int, default=0)
    p.add_argument("--threads", type=int, default=1)
    p.add_argument("--resume", action="store_true")
    p.add_argument("--optimizer", choices=["adamw"], default="adamw")
    args = p.parse_args()
    pick_device(args.threads)
    torch.manual_seed(args.seed)
    train, held_out = Sentences(args.data / "train"), Sentences(args.data / "val")
    model = Both(train.features.shape[1])
    run = Run(model, args, lr=3e-3, betas=(0.9, 0.98), weight_decay=0.02, ema=0.99, warmup=30)
    rng = np.random.default_rng(args.seed)
    while not run.done():
        index = rng.choice(len(train.ids), 128, replace=False)
        loss = losses(model, train.ids[index], train.features[index], rng)
        run.update(loss, 128)
        if run.step % 50 == 0:
            print(f"step {run.step} {run.elapsed():.2f} min loss {loss.item():.3f}", flush=True)
    config = json.dumps({"width": WIDTH, "buckets": BUCKETS})
    run.note(figures(run.ema, held_out) | {"train_loss": loss.item()})
    run.save({"kind": "text", "config": config, "seed": args.seed, "data": args.data})
    if args.export:
        tensors, meta = read(args.output)
        tensors = {k.removeprefix("text."): v for k, v in tensors.items() if k.startswith("text.")}
        meta = {k: meta[k] for k in ("kind", "config", "seed", "steps", "samples", "minutes")}
        folder = ROOT / "assets/weights"
        out = write_card(folder, "text", args.output, tensors, meta, args.export, f"{float(meta['minutes']):.1f} minutes on one busy thread")
        net = Text()
        net.load_state_dict({k: v.float() for k, v in load_tensors(out).items()})
        with torch.no_grad():
            golden = {"text": torch.from_numpy(held_out.text[:6, :3]).contiguous(), "vectors": net(held_out.ids[:6, :3].reshape(18, -1)),
                      "ids": held_out.ids[:6, :3].to(torch.int32).contiguous()}
        save_file(golden, ROOT / "tests/reference/parity_text.safetensors")


if __name__ == "__main__":
    main()
