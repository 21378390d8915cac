"""Trains the picture segmenter alone, from given weights, on shards that `sceneloom-worlds --kind pictures` wrote into a folder.

For when the renderer has changed: the VAE and the transformer stay. The latest weights are written in f16 every minute; `--minutes` is the wall clock.
"""
import argparse
import json
import time
from pathlib import Path

import torch
from safetensors import safe_open
from safetensors.torch import load_file, save_file
from torch.nn import functional as F

from loop import pick_device
from models.segmenter import CLASSES, OUTSIDE, Segmenter, SegmenterConfig
from picture_data import Pool, Streams
from train_pictures import Learner

SAVE_S = 60.0


def pool_of(folder, size, device):
    """All frames of a folder of shards."""
    streams, shards = Streams([folder]), []
    while streams.running:
        if (shard := streams.take(1.0)) is not None:
            shards.append(shard)
    pool = Pool(sum(len(s["rgb"]) for s in shards), size, device)
    for shard in shards:
        pool.add(shard)
    return pool


def loss_of(model, pictures, shown):
    target = shown.long().clamp(max=CLASSES - 1).masked_fill(shown == OUTSIDE, -100)
    return F.cross_entropy(model(pictures).float(), target, ignore_index=-100)


@torch.no_grad()
def judged(model, pool, most=240):
    """Share of pixels that are told rightly, and mean IoU of the classes that occur, over the first pictures of a pool."""
    seen = torch.zeros(CLASSES, CLASSES)
    rgb, shown = pool.arrays["rgb"][: pool.count].flatten(0, 2)[:most], pool.arrays["class"][: pool.count].flatten(0, 2)[:most]
    for i in range(0, len(rgb), 12):
        told = model((rgb[i : i + 12].float() / 127.5 - 1).movedim(-1, -3)).argmax(1)
        known = shown[i : i + 12] < CLASSES
        pairs = shown[i : i + 12][known].long() * CLASSES + told[known]
        seen += torch.bincount(pairs, minlength=CLASSES**2).view(CLASSES, CLASSES).float()
    both = seen.diag()
    either = seen.sum(0) + seen.sum(1) - both
    return {"right": round((both.sum() / seen.sum()).item(), 4), "miou": round((both / either)[seen.sum(1) > 0].mean().item(), 4)}


def main(args):
    device, _ = pick_device(args.threads)
    torch.manual_seed(args.seed)
    with safe_open(args.init, "pt") as f:
        told = f.metadata()
    size = tuple(int(n) for n in args.size.split("x"))
    pool, held = pool_of(args.data, size, device), pool_of(args.held_out, size, device)
    seg = Learner(Segmenter(SegmenterConfig(**json.loads(told["config"]))).to(device, memory_format=torch.channels_last), args.lr, ema=0.99)
    weights = {k: v.float() for k, v in load_file(args.init).items()}
    seg.model.load_state_dict(weights)
    seg.ema.load_state_dict(weights)
    started, saved = time.monotonic(), 0.0
    print(json.dumps({"frames": pool.count, "held_out": held.count, "before": judged(seg.ema, held)}), flush=True)
    while (spent := time.monotonic() - started) < args.minutes * 60:
        seg.before(spent / (args.minutes * 60))
        pictures, shown = pool.pictures(args.pictures)
        loss = loss_of(seg.model, pictures, shown)
        seg.update(loss, {"loss": loss})
        if spent - saved > SAVE_S:
            saved = spent
            save(seg, told, args.output)
            print(json.dumps({"minutes": round(spent / 60, 1), "step": seg.step, **seg.means(), **judged(seg.ema, held)}), flush=True)
    save(seg, told, args.output)
    print(json.dumps({"step": seg.step, "after": judged(seg.ema, held)}), flush=True)


def save(seg, told, path):
    half = {k: v.half().contiguous() for k, v in seg.ema.state_dict().items()}
    save_file(half, path, told)
    Path(path).chmod(0o644)


if __name__ == "__main__":
    p = argparse.ArgumentParser(description=__doc__)
    p.add_argument("--data", required=True, help="folder of training shards")
    p.add_argument("--held-out", required=True, help="folder of held-out shards")
    p.add_argument("--init", required=True, help="weights to go on from")
    p.add_argument("--minutes", type=float, required=True)
    p.add_argument("-o", "--output", required=True, help="file of weights to write")
    p.add_argument("--size", default="256x144")
    p.add_argument("--pictures", type=int, default=12, help="pictures in a step")
    p.add_argument("--lr", type=float, default=8e-4)
    p.add_argument("--seed", type=int, default=0)
    p.add_argument("--threads", type=int, default=1)
    main(p.parse_args())
