"""Trains the LiDAR perceiver: python train_perception.py --data DIR --minutes M -o W.safetensors [--resume]. DIR holds train/ and val/ with shards of
`sceneloom-worlds --kind perception`; shards that come while it runs are taken in. See README.md."""
import argparse
import json
import time
from pathlib import Path

import numpy as np
import torch
import torch.nn.functional as F

from data import prefetch
from loop import SAVE_MINUTES, Run, pick_device
from models.lidar_perceiver import GROUPS, LidarPerceiver, PerceiverConfig
from perception_data import IGNORED, PerceptionFrames, batch
from perception_eval import evaluated

STAND_WEIGHT = (1.0, 1.3, 1.0, 1.0, 1.0, 2.0, 4.0, 5.0, 4.0)  # rare things count more
UNSEEN_WEIGHT = 0.2  # of columns far from any return


def losses(model, x, standing, heat, numbers, weight):
    """What stands in each column, centres (penalty-reduced focal loss, 1904.07850), numbers of boxes near their centres."""
    logits, boxes = model(x)
    logits, boxes = logits.float(), boxes.float()
    known = standing != IGNORED
    seen = F.max_pool2d((x[:, 15:16] > 0).float(), 7, 1, 3)[:, 0]
    per_column = F.cross_entropy(logits, torch.where(known, standing, 0).long(), torch.tensor(STAND_WEIGHT, device=x.device), reduction="none")
    share = known * (UNSEEN_WEIGHT + (1 - UNSEEN_WEIGHT) * seen)
    stand = (per_column * share).sum() / share.sum().clamp(min=1)
    score, target = boxes[:, : len(GROUPS)], heat.clamp(min=0)
    p, asked = torch.sigmoid(score), heat == 1
    miss = -F.logsigmoid(score) * (1 - p).square()
    ghost = -F.logsigmoid(-score) * p.square() * (1 - target).pow(4)
    centre = torch.where(asked, miss, torch.where(heat < 0, 0.0, ghost)).sum() / asked.sum().clamp(min=1)
    off = F.smooth_l1_loss(boxes[:, len(GROUPS) :], numbers, reduction="none", beta=0.1)
    box = (off * weight[:, None]).sum() / weight.sum().clamp(min=1)
    return stand + 0.5 * centre + 0.3 * box, {"stand": stand, "centre": centre, "box": box}


def row(found):
    """A line of the log from figures."""
    boxes, standing = found["boxes"], found["standing"]
    ap = {f"ap_{g}": v["mean_ap"] for g, v in boxes["groups"].items()}
    return {"miou_seen": standing["seen"]["miou"], "miou_all": standing["all"]["miou"], "map": boxes["map"], **{f"ap_{g}": ap.get(f"ap_{g}", 0.0) for g in GROUPS}}


def main():
    p = argparse.ArgumentParser(description=__doc__)
    p.add_argument("--data", type=Path, required=True, help="folder with train/ and val/")
    p.add_argument("--minutes", type=float, required=True, help="budget, earlier runs included when resuming")
    p.add_argument("--busy", action="store_true", help="minutes are of the processor, not of the clock: for a machine that others use")
    p.add_argument("-o", "--output", required=True, help="f32 weights; .checkpoint.pt and .csv are written beside it")
    p.add_argument("--resume", action="store_true")
    p.add_argument("--optimizer", choices=["muon", "adamw"], default="muon")
    p.add_argument("--lr", type=float, default=3e-3)
    p.add_argument("--batch", type=int, default=4)
    p.add_argument("--side", type=int, default=120, help="columns of the squares that are cut out of frames, a multiple of 8: 200 are a whole frame")
    p.add_argument("--seed", type=int, default=0)
    p.add_argument("--threads", type=int, default=1)
    p.add_argument("--frames", type=int, help="of train/, the first ones; all if left out")
    p.add_argument("--held-out", type=int, default=48, help="frames of val/ that are looked at meanwhile")
    p.add_argument("--note-minutes", type=float, default=6.0)
    p.add_argument("--tiny", action="store_true", help="a small network, for tests")
    args = p.parse_args()
    device, dtype = pick_device(args.threads)
    torch.manual_seed(args.seed)
    train, held_out = PerceptionFrames(args.data / "train", limit=args.frames), PerceptionFrames(args.data / "val", limit=args.held_out)
    model = LidarPerceiver(PerceiverConfig(widths=(8, 12, 16)) if args.tiny else None).to(device).to(memory_format=torch.channels_last)
    run = Run(model, args, lr=args.lr, betas=(0.9, 0.98), weight_decay=0.01, ema=0.998, warmup=100,
              clock=time.process_time if args.busy else time.monotonic)
    meta = {"kind": "lidar_perceiver", "config": json.dumps(model.config.as_dict()), "seed": args.seed}
    print(f"{len(train)} frames, {sum(p.numel() for p in model.parameters()) / 1e6:.2f} M parameters", flush=True)
    mean, noted, since = {}, run.elapsed(), (run.samples, time.monotonic())

    def note():
        run.note(row(evaluated(run.ema, held_out, range(len(held_out)), dtype)))
        train.rescan()
        run.save(meta | {"frames": len(train)})

    rng, saved = np.random.default_rng([args.seed, run.step]), time.monotonic()
    for parts in prefetch(lambda: batch(train, rng, args.batch, args.side)):
        if run.done():
            break
        with torch.autocast(device.type, dtype, enabled=dtype is not None):
            loss, found = losses(model, *(part.to(device) for part in parts))
        run.update(loss, args.batch)
        mean = {k: mean.get(k, v.item()) * 0.98 + v.item() * 0.02 for k, v in found.items()}
        if run.step % 50 == 0:
            rate = (run.samples - since[0]) / (time.monotonic() - since[1])
            print(f"step {run.step} {run.elapsed():.1f} min {rate:.2f}/s " + " ".join(f"{k} {v:.4f}" for k, v in mean.items()), flush=True)
        if run.elapsed() - noted > args.note_minutes:
            note()
            noted, since = run.elapsed(), (run.samples, time.monotonic())
        elif time.monotonic() - saved > 60 * SAVE_MINUTES:
            saved = time.monotonic()
            train.rescan()
            run.save(meta | {"frames": len(train)})
    note()


if __name__ == "__main__":
    main()
