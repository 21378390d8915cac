"""Trains the layout network: python train_layout.py --data DIR --minutes M -o W.safetensors [--resume]. See README.md."""
import argparse
import json
import time
from pathlib import Path

import numpy as np
import torch
from safetensors.torch import load_file as load_weights
from safetensors.numpy import load_file

from loop import Run, pick_device
from models.layout import BOX, VALUES, Layout, LayoutConfig
from schedule import STEPS, alpha_bar, ddim_sample

NAMES = ("kind", "state", "size", "shape", "values", "edges", "map")


class Frames:
    """All shards of a folder in memory."""

    def __init__(self, folder):
        shards = [load_file(f) for f in sorted(Path(folder).glob("shard_*.safetensors"))]
        if not shards:
            raise SystemExit(f"{folder}: expected shards of `sceneloom dataset layout`, found none")
        self.arrays = {k: np.concatenate([s[k] for s in shards]) for k in NAMES}

    def __len__(self):
        return len(self.arrays["kind"])


CHANNELS = np.zeros((3, VALUES), np.float32)
CHANNELS[1, :BOX] = 1
CHANNELS[2, BOX:] = 1


def batch_of(frames, index, rng, mode=None):
    """A batch with a task for each frame: objects on a given road, a road under given objects, or everything, and some
    objects given besides; some attributes and edges unsaid. Without `rng`, everything is said and `mode` is the task."""
    a = {k: v[index] for k, v in frames.arrays.items()}
    n = int((a["kind"] > 0).sum(1).max())
    for k in ("kind", "state", "size", "shape", "values"):
        a[k] = a[k][:, :n]
    count = len(index)
    object_ = (a["kind"] >= 2) & (a["kind"] <= 11)
    road = (a["shape"] > 0) & ~object_
    task = np.full(count, mode or 0) if rng is None else rng.choice(3, count, p=[0.74, 0.13, 0.13])
    locked = a["shape"] == 0
    locked |= road & (task == 0)[:, None]
    locked |= object_ & (task == 1)[:, None]
    edges_at, said = a["edges"][..., 0] >= 0, 1.0
    if rng is not None:
        share = rng.choice([0.0, 0.0, 0.3, 0.8], (count, 1))
        locked |= object_ & (rng.random(object_.shape) < share)
        for k in ("state", "size"):
            a[k] = np.where(rng.random(a[k].shape) < rng.choice([0.3, 0.8], (count, 1)), a[k], 0)
        said = rng.choice([0.0, 0.3, 0.7, 1.0], (count, 1))
        edges_at &= rng.random(edges_at.shape) < said
    g, e = np.nonzero(edges_at)
    rows = a["edges"][g, e].astype(np.int64)
    keep = (rows[:, 0] < n) & (rows[:, 1] < n)
    g, rows = g[keep], rows[keep]
    has_map = task == 0
    map_ = (a["map"].astype(np.float32) - 128) / 127 * has_map[:, None, None, None]
    valid = CHANNELS[a["shape"]]
    x0 = torch.from_numpy(a["values"] * valid)
    locked = torch.from_numpy(locked)
    long = lambda v: torch.from_numpy(np.asarray(v, np.int64))
    stated = rows[:, 3] >= 0
    distance = np.stack([np.where(stated, rows[:, 3] / 200, 0), stated], 1).astype(np.float32)
    return {"kind": long(a["kind"]), "state": long(a["state"]), "size": long(a["size"]), "shape": long(a["shape"]),
            "x0": x0, "locked": locked, "given": x0 * locked[..., None], "valid": torch.from_numpy(valid),
            "edges": torch.stack([long(g), long(rows[:, 0]), long(rows[:, 1]), long(rows[:, 2])]),
            "distance": torch.from_numpy(distance), "map": torch.from_numpy(map_), "has_map": torch.from_numpy(has_map)}


def to(b, device):
    return {k: v.to(device) for k, v in b.items()}


ABAR = alpha_bar().float()


def noised(b, t, eps):
    a, s = ABAR[t].sqrt()[:, None, None].to(eps), (1 - ABAR[t]).sqrt()[:, None, None].to(eps)
    free = b["valid"] * ~b["locked"][..., None]
    x = (a * b["x0"] + s * eps) * free + b["given"]
    return x, a * eps - s * b["x0"], free


def v_loss(model, b, t, eps, amp):
    x, v, free = noised(b, t, eps)
    with torch.autocast(x.device.type, torch.bfloat16, enabled=amp is not None):
        found = model(x, t, b)
    # Where a box is counts more than how large it is.
    weight = torch.ones(VALUES, device=x.device)
    weight[:2], weight[2:6] = 2.0, 0.5
    w = free * weight
    return ((found.float() - v) ** 2 * w).sum() / w.sum().clamp(min=1)


@torch.no_grad()
def figures(model, frames, count, device):
    """Held-out v loss, and of 20-step samples on given roads: how many vehicles that move or wait stand within 1 m of a
    lane's middle, heading along it within 15 degrees, and how many vehicles stand on road or car park (all by the map)."""
    rng, total = np.random.default_rng(7), 0.0
    gen = torch.Generator().manual_seed(7)
    size = 32
    for i in range(0, count, size):
        b = to(batch_of(frames, np.arange(i, min(i + size, count)), rng), device)
        t = torch.randint(0, STEPS, (len(b["x0"]),), generator=gen).to(device)
        eps = torch.randn(b["x0"].shape, generator=gen).to(device)
        total += v_loss(model, b, t, eps, None).item() * len(b["x0"]) / count
    b = to(batch_of(frames, np.arange(min(count, 64)), None, 0), device)
    x = sample(model, b, 20, gen)
    m = torch.gather(b["map"].flatten(1, 2), 1, cell_of(x)[..., None].expand(-1, -1, 8))
    vehicle = (b["kind"] >= 2) & (b["kind"] <= 6)
    driving = vehicle & ((b["state"] == 1) | (b["state"] == 3))
    ok_lane = m[..., 4:6].norm(dim=-1) * 6.35 < 1.0
    ok_yaw = (torch.nn.functional.normalize(x[..., [7, 6]], dim=-1) * m[..., 6:8]).sum(-1) > 0.9659
    ok_ground = (m[..., 0] < 0) | (m[..., 1] < 0)
    share = lambda ok, of: (ok & of).sum().item() / max(1, of.sum().item())
    return {"held_out_v": total, "in_lane": share(ok_lane, driving), "along_lane": share(ok_yaw, driving),
            "on_road": share(ok_ground, vehicle)}


def cell_of(x):
    cell = ((x[..., :2].clamp(-2, 2) * 20 + 40) * 1.25).floor().clamp(0, 99).long()
    return cell[..., 0] * 100 + cell[..., 1]


@torch.no_grad()
def sample(model, b, steps, generator):
    """DDIM from pure noise; locked nodes are put back before every call."""
    free = b["valid"] * ~b["locked"][..., None]
    embedded = model.embed(b)
    noise = torch.randn(b["x0"].shape, generator=generator).to(b["x0"])
    predict = lambda x, t: model(x * free + b["given"], t, b, embedded) * free
    return ddim_sample(predict, noise * free, steps) * free + b["given"]


def main():
    p = argparse.ArgumentParser(description=__doc__)
    p.add_argument("--data", type=Path, required=True, help="folder with train/ and val/ shards of `dataset layout`")
    p.add_argument("--minutes", type=float, required=True, help="wall-clock budget, earlier runs included when resuming")
    p.add_argument("-o", "--output", required=True, help="f32 weights; .checkpoint.pt and .csv are written beside it")
    p.add_argument("--init", help="weights of a network of the same kind to begin with")
    p.add_argument("--resume", action="store_true")
    p.add_argument("--seed", type=int, default=0)
    p.add_argument("--optimizer", choices=["adamw", "muon"], default="muon")
    p.add_argument("--threads", type=int, default=1)
    p.add_argument("--lr", type=float, default=2e-3)
    p.add_argument("--batch", type=int, default=32)
    p.add_argument("--held-out", type=int, default=64)
    p.add_argument("--note-minutes", type=float, default=6.0)
    args = p.parse_args()
    device, amp = pick_device(args.threads)
    torch.manual_seed(args.seed)
    train, held_out = Frames(args.data / "train"), Frames(args.data / "val")
    model = Layout(LayoutConfig()).to(device)
    if args.init:
        model.load_state_dict({k: v.float() for k, v in load_weights(args.init).items()})
    print(f"{sum(v.numel() for v in model.parameters())} parameters, {len(train)} frames, {device}, {amp}", flush=True)
    run = Run(model, args, lr=args.lr, betas=(0.9, 0.98), weight_decay=0.01, ema=0.999, warmup=100)
    rng = np.random.default_rng([args.seed, run.step])
    meta = {"kind": "layout", "config": json.dumps(model.config.as_dict()), "seed": args.seed, "data": args.data}
    mean, noted, since = 1.0, time.monotonic(), (run.samples, time.monotonic())

    def note():
        rate = (run.samples - since[0]) / (time.monotonic() - since[1])
        run.note(figures(run.ema, held_out, min(args.held_out, len(held_out)), device) | {"train_v": mean, "per_s": rate})
        run.save(meta)

    while not run.done():
        b = to(batch_of(train, rng.choice(len(train), args.batch, replace=False), rng), device)
        t = torch.randint(0, STEPS, (args.batch,)).to(device)
        loss = v_loss(model, b, t, torch.randn_like(b["x0"]), amp)
        run.update(loss, args.batch)
        mean += 0.01 * (loss.item() - mean)
        if run.step % 100 == 0:
            rate = (run.samples - since[0]) / (time.monotonic() - since[1])
            print(f"step {run.step} {run.elapsed():.1f} min {rate:.1f}/s loss {mean:.4f}", flush=True)
        if time.monotonic() - noted > 60 * args.note_minutes:
            note()
            noted, since = time.monotonic(), (run.samples, time.monotonic())
        elif run.elapsed() - run.saved_at > 3:
            run.save(meta)
    note()


if __name__ == "__main__":
    main()
