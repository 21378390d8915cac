"""Trains the diffusion that draws scenery: python train_scenery.py --data DIR --vae W.safetensors --minutes M -o W.safetensors [--resume]

Of what pack.py makes of a data set only layouts, columns and named numbers are read; the VAE is there to find it.
"""
import json

import numpy as np
import torch

from data import draw_masks, prefetch
from loop import diffusion_arguments, pick_device, train_diffusion
from models.occ_vae import latent_space
from models.scenery import MAP, NAMED, SIDE, Scenery, layout_of, map_of
from pack import Packed, folder_of, pack
from schedule import alpha_bar, ddim_sample, noised

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
    args = diffusion_arguments(__doc__, batch=8, held_out=24).parse_args()
    torch.manual_seed(args.seed)
    device, dtype = pick_device(args.threads)
    pack(args.data, args.vae, device, dtype)
    name = latent_space(args.vae)
    frames, held_out = (Packed(folder_of(args.data, name, part)) for part in ("train", "val"))
    model, abar = Scenery().to(device, memory_format=torch.channels_last), alpha_bar()
    meta = {"kind": "scenery", "config": json.dumps(model.config.as_dict()), "seed": args.seed, "data": args.data, "frames": len(frames)}
    train_diffusion(model, args, meta, device, dtype, note_minutes=10.0,
                    batches=lambda rng: prefetch(lambda: draw_batch(frames, rng, args.batch)),
                    loss_of=lambda model, *batch: loss_of(model, abar, *batch),
                    figures=lambda ema: figures(ema, abar, held_out, device, args.held_out))


if __name__ == "__main__":
    main()
