"""Trains the learned LiDAR: python train_lidar.py --data DIR --minutes M -o W.safetensors [--resume]. See README.md."""
import argparse
import json
import time
from pathlib import Path

import numpy as np
import torch
import torch.nn.functional as F

from data import prefetch
from lidar_data import LidarFrames, sample
from loop import Run, pick_device
from models.lidar import FREE_SDF_M, Lidar, LidarConfig

BEHIND_M, FRONT_M, CLEAR_M = 0.15, 0.6, 0.08


def sdf_at(model, geometry, b):
    """Signed distances [R,S] at the samples; free beyond the last."""
    t, valid = b["t"], b["valid"]
    ray, at = valid.nonzero(as_tuple=True)
    p = b["origin"][ray] + b["d"][ray] * t[ray, at][:, None]
    corners, share, offset = b["lookup"](p)
    f = model.sdf(geometry, corners, share, offset)
    return torch.full_like(t, FREE_SDF_M).index_put((ray, at), f)


def losses(model, b):
    """Distance to the surface along its normal near it, free space before it, NeuS depth, hit or not, strength, drops."""
    geometry, appearance = model.features(b["sites"])
    f = sdf_at(model, geometry, b)
    valid, hit, r = b["valid"], b["hit"], b["r"]
    gap = r[:, None] - b["t"]
    target = (gap * b["cos"][:, None]).clamp(-FREE_SDF_M, FREE_SDF_M)
    close = valid & hit[:, None] & (gap * b["cos"][:, None] < FRONT_M) & (gap * b["cos"][:, None] > -BEHIND_M) & (gap < 12)
    free = valid & (((gap > 0.5) & ~close) | b["empty"][:, None])
    # A miss of a centimetre at a grazing angle is a decimetre along the ray: such rays ask for exactness.
    sdf = F.smooth_l1_loss(f[close], target[close], beta=0.02) if close.any() else f.sum() * 0
    clear = F.relu(CLEAR_M - f[free]).mean() if free.any() else f.sum() * 0
    depth, log_pass, strength, drop, weight, _ = model.render(appearance, b["lookup"], b["origin"], b["d"], b["t"].clamp(max=100), f)
    off = (depth - r).abs()
    solid = hit & (log_pass.exp() < 0.9)
    scale = 1 / (0.3 + 0.05 * r)  # a share of the range counts, as it does for what uses the points
    l_depth = (off.clamp(max=4.0) * scale)[solid].mean() if solid.any() else f.sum() * 0
    passes = log_pass.clamp(-15, -1e-6)
    l_hit = torch.where(hit, -torch.log(-torch.expm1(passes)), -passes)[hit | b["empty"]].clamp(max=8).mean()
    echoed, told = solid & (b["echo"] == 0), solid & (b["echo"] < 2)
    l_strength = F.mse_loss(strength[echoed], b["strength"][echoed]) if echoed.any() else f.sum() * 0
    l_drop = F.binary_cross_entropy_with_logits(drop[told], (b["echo"][told] == 1).float()) if told.any() else f.sum() * 0
    total = 4 * sdf + 2 * clear + 0.5 * l_depth + 0.1 * l_hit + 5 * l_strength + 0.3 * l_drop
    parts = {"sdf": sdf, "clear": clear, "depth": l_depth, "hit": l_hit, "strength": l_strength, "drop": l_drop}
    return total, {k: v.item() for k, v in parts.items()}, (depth, log_pass, drop, off)


@torch.no_grad()
def figures(model, frames, count):
    """Held-out losses, range errors (m) of found surfaces, and how often hit or miss agree."""
    rng, sums, offs, agree = np.random.default_rng(7), {}, [], []
    for i in range(count):
        b = sample(frames, rng, frame=i % len(frames), kind=("dense", "labels")[i % 2], symmetry=0)
        _, parts, (_, log_pass, _, off) = losses(model, b)
        sums = {k: sums.get(k, 0) + v / count for k, v in parts.items()}
        found = log_pass.exp() < 0.5
        offs.append(off[b["hit"] & found])
        agree.append((found == b["hit"])[b["hit"] | b["empty"]].float())
    off = torch.cat(offs)
    return sums | {"off_p50": off.median().item(), "off_mean": off.mean().item(), "off_p95": off.quantile(0.95).item(),
                   "agree": torch.cat(agree).mean().item()}


def main():
    p = argparse.ArgumentParser(description=__doc__)
    p.add_argument("--data", type=Path, required=True, help="folder with train/ and val/ shards of `dataset lidar`")
    p.add_argument("--minutes", type=float, required=True, help="wall-clock budget, earlier runs included when resuming")
    p.add_argument("-o", "--output", required=True, help="f32 weights; .checkpoint.pt and .csv are written beside it")
    p.add_argument("--resume", action="store_true")
    p.add_argument("--no-unet", action="store_true", help="the ablation: features of a voxel know only its class and height")
    p.add_argument("--seed", type=int, default=0)
    p.add_argument("--optimizer", choices=["adamw"], default="adamw")
    p.add_argument("--threads", type=int, default=1)
    p.add_argument("--lr", type=float, default=3e-3)
    p.add_argument("--wedge", type=float, default=100.0, help="degrees of a sweep per step")
    p.add_argument("--rays", type=int, default=900)
    p.add_argument("--held-out", type=int, default=16, help="wedges of the held-out figures")
    p.add_argument("--note-minutes", type=float, default=5.0)
    args = p.parse_args()
    pick_device(args.threads)
    torch.manual_seed(args.seed)
    train, held_out = LidarFrames(args.data / "train"), LidarFrames(args.data / "val")
    model = Lidar(LidarConfig(unet=not args.no_unet))
    run = Run(model, args, lr=args.lr, betas=(0.9, 0.98), weight_decay=0.01, ema=0.995, warmup=50)
    rng = np.random.default_rng([args.seed, run.step])
    meta = {"kind": "lidar", "config": json.dumps(model.config.as_dict()), "seed": args.seed, "data": args.data}
    mean, noted, since = {}, time.monotonic(), (run.samples, time.monotonic())

    def note():
        rate = (run.samples - since[0]) / (time.monotonic() - since[1])
        run.note(figures(run.ema, held_out, args.held_out) | {"per_s": rate})
        run.save(meta)

    for b in prefetch(lambda: sample(train, rng, args.wedge, args.rays)):
        loss, parts, _ = losses(model, b)
        run.update(loss, 1)
        mean = {k: mean.get(k, v) * 0.97 + v * 0.03 for k, v in parts.items()}
        if run.step % 50 == 0:
            rate = (run.samples - since[0]) / (time.monotonic() - since[1])
            s = model.log_s.exp().item()
            print(f"step {run.step} {run.elapsed():.1f} min {rate:.2f}/s s {s:.0f} " + " ".join(f"{k} {v:.4f}" for k, v in mean.items()), flush=True)
        if run.done():
            break
        if time.monotonic() - noted > 60 * args.note_minutes:
            note()
            noted, since = time.monotonic(), (run.samples, time.monotonic())
        elif run.elapsed() - run.saved_at > 3:
            run.save(meta)
    note()


if __name__ == "__main__":
    main()
