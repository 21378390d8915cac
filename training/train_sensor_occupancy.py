"""Trains the network that tells voxels from a LiDAR and cameras: python train_sensor_occupancy.py --data DIR --segmenter S --minutes M -o W.safetensors [--resume].
DIR holds train/ and val/ with shards of `sceneloom-worlds --kind sensors`. See README.md."""
import argparse
import json
import time
from pathlib import Path

import numpy as np
import torch
from torch.nn import functional as F

from data import prefetch
from loop import SAVE_MINUTES, Run, pick_device
from losses import lovasz_softmax, sample_voxels
from models.occ_vae import CLASSES, FREE
from models.sensor_occupancy import SensorOccupancy, SensorOccupancyConfig
from sensor_data import ARMS, SensorFrames, batch, heard, load_segmenter

SHIPPED_SEGMENTER = Path(__file__).resolve().parent.parent / "assets" / "weights" / "pictures_segmenter.safetensors"
NEAR = 7  # columns around a return: within 1.2 m of one


def loss_of(logits, dense, voxels_per_cell):
    """Cross-entropy and half a Lovasz-softmax on sampled voxels."""
    index, label, weight = sample_voxels(dense, voxels_per_cell * dense[..., 0].numel() // 16)
    picked = logits.reshape(-1, CLASSES)[index].float()
    entropy = (F.cross_entropy(picked, label, reduction="none") * weight).sum() / weight.sum()
    few = torch.randperm(len(label))[:12_000]
    return entropy + 0.5 * lovasz_softmax(picked[few].softmax(1), label[few]), entropy.detach()


class Agreement:
    """Counts of what is said against what is there, of all columns and of those near a return."""

    def __init__(self):
        self.tables = {name: np.zeros((CLASSES, CLASSES), np.int64) for name in ("near", "all")}

    def add(self, said, dense, near):
        """u8 [200,200,16] twice, bool [200,200]."""
        for name, where in (("near", near), ("all", np.ones_like(near))):
            pair = dense[where].astype(int) * CLASSES + said[where]
            self.tables[name] += np.bincount(pair.ravel(), minlength=CLASSES**2).reshape(CLASSES, -1)

    def figures(self):
        out = {}
        for name, table in self.tables.items():
            hit, union = np.diag(table), table.sum(0) + table.sum(1) - np.diag(table)
            there = table.sum(1) > 0
            there[FREE] = False
            solid = table[:FREE, :FREE].sum()
            out[name] = {"iou": float(solid / max(1, table.sum() - table[FREE, FREE])), "miou": float((hit / np.maximum(1, union))[there].mean()),
                         "classes": [float(h / u) if t else None for h, u, t in zip(hit[:FREE], np.maximum(1, union)[:FREE], table.sum(1)[:FREE] > 0)]}
        return out


@torch.no_grad()
def evaluated(net, frames, which, dtype=None):
    """Figures of frames, by the sensors that are heard."""
    found = {arm: Agreement() for arm in ARMS}
    for frame in which:
        points, _, paint, dense = frames.read(frame)
        for arm, sensors in ARMS.items():
            parts = heard(points, paint, *sensors)
            if arm == "both":
                near = F.max_pool2d((parts[0][15:16] > 0).float()[None], NEAR, 1, NEAR // 2)[0, 0].numpy() > 0
            with torch.autocast("cpu", dtype, enabled=dtype is not None):
                said = net(*(part[None] for part in parts))[0].argmax(-1)
            found[arm].add(said.to(torch.uint8).numpy(), dense, near)
    return {arm: table.figures() for arm, table in found.items()}


def main():
    p = argparse.ArgumentParser(description=__doc__)
    p.add_argument("--data", type=Path, required=True, help="folder with train/ and val/")
    p.add_argument("--segmenter", type=Path, default=SHIPPED_SEGMENTER, help="weights of the segmenter of pictures")
    p.add_argument("--minutes", type=float, required=True, help="budget, earlier runs included when resuming")
    p.add_argument("--busy", action="store_true", help="minutes are of the processor, not of the clock: for a machine that others use")
    p.add_argument("-o", "--output", required=True, help="f32 weights; .checkpoint.pt and .csv are written beside it")
    p.add_argument("--resume", action="store_true")
    p.add_argument("--optimizer", choices=["muon", "adamw"], default="muon")
    p.add_argument("--lr", type=float, default=3e-3)
    p.add_argument("--batch", type=int, default=4)
    p.add_argument("--side", type=int, default=96, help="columns of the squares that are cut out of frames, a multiple of 8")
    p.add_argument("--alone", type=float, default=0.4, help="share of samples of which one sensor alone is heard")
    p.add_argument("--voxels-per-cell", type=int, default=4)
    p.add_argument("--seed", type=int, default=0)
    p.add_argument("--threads", type=int, default=1)
    p.add_argument("--held-out", type=int, default=16, help="frames of val/ that are looked at meanwhile")
    p.add_argument("--note-minutes", type=float, default=8.0)
    p.add_argument("--tiny", action="store_true", help="a small network, for tests")
    args = p.parse_args()
    device, dtype = pick_device(args.threads)
    torch.manual_seed(args.seed)
    segmenter = load_segmenter(args.segmenter)
    train, held_out = SensorFrames(args.data / "train", segmenter), SensorFrames(args.data / "val", segmenter, args.held_out)
    model = SensorOccupancy(SensorOccupancyConfig(widths=(8, 12, 16)) if args.tiny else None).to(device).to(memory_format=torch.channels_last)
    run = Run(model, args, lr=args.lr, betas=(0.9, 0.98), weight_decay=0.01, ema=0.998, warmup=100,
              clock=time.process_time if args.busy else time.monotonic)
    meta = {"kind": "sensor_occupancy", "config": json.dumps(model.config.as_dict()), "seed": args.seed}
    print(f"{len(train)} frames, {sum(p.numel() for p in model.parameters()) / 1e6:.2f} M parameters", flush=True)
    mean, noted, since = None, run.elapsed(), (run.samples, time.monotonic())

    def note():
        found = evaluated(run.ema, held_out, range(len(held_out)), dtype)
        run.note({f"{arm}_{what}": v["all"][what] for arm, v in found.items() for what in ("iou", "miou")})
        train.rescan()
        run.save(meta | {"frames": len(train)})

    rng, saved = np.random.default_rng([args.seed, run.step]), time.monotonic()
    for *parts, dense in prefetch(lambda: batch(train, rng, args.batch, args.side, args.alone)):
        if run.done():
            break
        with torch.autocast(device.type, dtype, enabled=dtype is not None):
            logits = model(*(part.to(device) for part in parts))
        loss, entropy = loss_of(logits, dense.to(device), args.voxels_per_cell)
        run.update(loss, args.batch)
        mean = entropy.item() if mean is None else mean * 0.98 + entropy.item() * 0.02
        if run.step % 50 == 0:
            rate = (run.samples - since[0]) / (time.monotonic() - since[1])
            print(f"step {run.step} {run.elapsed():.1f} min {rate:.2f}/s entropy {mean:.4f}", flush=True)
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
