"""Trains the diffusion that draws scenery: python train_scenery.py --data DIR --vae W.safetensors --minutes M -o W.safetensors [--resume]

Of what pack.py makes of a data set only layouts, columns and named numbers are read; the VAE is there to find it.
"""
import argparse
import json
import time
from pathlib import Path

import numpy as np
import torch

from data import draw_masks, prefetch
from loop import Run, pick_device
from models.occ_vae import latent_space
from models.scenery import MAP, NAMED, SIDE, Scenery, layout_of, map_of
from pack import Packed, folder_of, pack
from schedule import alpha_bar, ddim_sample, noised

SAVE_MINUTES, NOTE_MINUTES = 3.0, 10.0
NO_CONDITION, NO_NUMBER = 0.1, 0.3


def read(frames, picks, mirrored):
    """Map, layout, ground of some frames, some of them mirrored left to right; named numbers."""
    def stack(name):
        found = [frames.read(f, name)[:, ::-1] if m else frames.read(f, name) for f, m in zip(picks, mirrored)]
        return torch.from_numpy(np.stack(found))

    columns, named = stack("columns"), torch.from_numpy(np.stack([frames.read(f, "named", 0) for f in picks]))
    return map_of(columns), layout_of(stack("bev")), columns[:, ::2, ::2, 4].float() / 16, named[:, :NAMED]


def draw_batch(frames, rng, batch):
    picks, mirrored = rng.integers(len(frames), size=batch), rng.random(batch) < 0.5
    target, layout, ground, named = read(frames, picks, mirrored)
    mask = torch.from_numpy(draw_masks(rng, batch, whole=0.6)).repeat_interleave(2, 1).repeat_interleave(2, 2)
    heard = torch.from_numpy(rng.random((batch, 1)) >= NO_CONDITION)
    known = (heard & torch.from_numpy(rng.random((batch, NAMED)) >= NO_NUMBER)).float()
    layout, ground = layout * heard[:, :, None, None], ground * heard[:, :, None]
    return target, layout, ground, mask, torch.cat([named * known, known], 1)


def loss_of(model, abar, target, layout, ground, mask, named, generator=None):
    noisy, t, truth, balance = noised(abar, target, generator)
    context = target * (1 - mask[..., None])
    v = model(noisy, t, layout, ground, mask, context, named)
    error = ((v - truth) ** 2).mean(-1)
    weight = mask + 0.1 * (1 - mask)
    error = (error * weight).sum((1, 2)) / weight.sum((1, 2))
    return (error * balance).mean(), error.detach().mean().item()


@torch.no_grad()
def figures(model, abar, held_out, device, count):
    """Held-out error of v, and what a few samples hold beside what their worlds hold: share of cells with each kind of thing, of those
    how many on the road, and how many borders a filled cell has (crumbs have many)."""
    rng, generator = np.random.default_rng(1), torch.Generator().manual_seed(1)
    parts = [p.to(device) for p in draw_batch(held_out, rng, count)]
    out = {"v": float(np.mean([loss_of(model, abar, *parts, generator)[1] for _ in range(4)]))}
    n = min(8, count)
    target, layout, ground, named = (p.to(device) for p in read(held_out, range(n), [False] * n))
    ones, told = torch.ones(n, SIDE, SIDE, device=device), torch.cat([named, torch.ones_like(named)], 1)
    noise = torch.randn(target.shape, generator=generator).to(device)
    made = ddim_sample(lambda x, t: model(x, t, layout, ground, ones, target * 0, told), noise, 20)
    for name, channel in (("built", 0), ("low", 2), ("grown", 4)):
        for whose, found in (("", made), ("_world", target)):
            held = found[..., channel] > 0
            borders = sum((held != held.roll(1, axis)).float().sum() for axis in (1, 2)) / held.sum().clamp(min=1)
            on_road = (held & (layout[..., 0] > 0)).sum() / held.sum().clamp(min=1)
            out |= {f"{name}{whose}": held.float().mean().item(), f"{name}_borders{whose}": borders.item(), f"{name}_on_road{whose}": on_road.item()}
    return out


def main():
    p = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    p.add_argument("--data", type=Path, required=True, help="folder with train/ and val/ shards")
    p.add_argument("--vae", required=True, help="weights that the data were or will be packed with")
    p.add_argument("--minutes", type=float, required=True, help="wall-clock budget, earlier runs included when resuming")
    p.add_argument("-o", "--output", required=True, help="f32 weights; .checkpoint.pt and .csv are written beside it")
    p.add_argument("--batch", type=int, default=8)
    p.add_argument("--lr", type=float, default=2e-3)
    p.add_argument("--optimizer", choices=["muon", "adamw"], default="muon")
    p.add_argument("--held-out", type=int, default=24)
    p.add_argument("--seed", type=int, default=0)
    p.add_argument("--threads", type=int, default=2)
    p.add_argument("--resume", action="store_true")
    args = p.parse_args()
    torch.manual_seed(args.seed)
    device, dtype = pick_device(args.threads)
    pack(args.data, args.vae, device, dtype)
    name = latent_space(args.vae)
    frames, held_out = (Packed(folder_of(args.data, name, part)) for part in ("train", "val"))
    model, abar = Scenery().to(device, memory_format=torch.channels_last), alpha_bar()
    run = Run(model, args, lr=args.lr, betas=(0.9, 0.98), weight_decay=0.01, ema=0.999, warmup=100)
    if run.done():
        return print(f"{args.output} is done")
    rng = np.random.default_rng([args.seed, run.step])
    meta = {"kind": "scenery", "config": json.dumps(model.config.as_dict()), "seed": args.seed, "data": args.data, "frames": len(frames)}
    mean, noted, since = None, run.elapsed(), (run.samples, time.monotonic())

    def note():
        rate = (run.samples - since[0]) / (time.monotonic() - since[1])
        run.note(figures(run.ema, abar, held_out, device, args.held_out) | {"train_v": mean, "per_s": rate})
        run.save(meta)

    for parts in prefetch(lambda: draw_batch(frames, rng, args.batch)):
        with torch.autocast(device.type, dtype, enabled=dtype is not None):
            loss, v = loss_of(model, abar, *(p.to(device) for p in parts))
        run.update(loss, args.batch)
        mean = v if mean is None else mean * 0.99 + v * 0.01
        if run.step % 100 == 0:
            rate = (run.samples - since[0]) / (time.monotonic() - since[1])
            print(f"step {run.step} {run.elapsed():.1f} min {rate:.1f}/s v {mean:.4f}", flush=True)
        if run.done():
            break
        if run.elapsed() - noted > NOTE_MINUTES:
            note()
            noted, since = run.elapsed(), (run.samples, time.monotonic())
        elif run.elapsed() - run.saved_at > SAVE_MINUTES:
            run.save(meta)
    note()


if __name__ == "__main__":
    main()
