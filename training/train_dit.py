"""Trains the latent diffusion transformer: python train_dit.py --data DIR --vae W.safetensors --minutes M -o OUT.safetensors [--resume]

Latents are packed first (pack.py). The checkpoint at the end of the windows is kept (.checkpoint.steady.pt): put in the place of the last
one, it lets a longer run go on where this one began to end. Most steps see windows of 12x12 tokens, the last share of the time whole frames of 25x25: a window
teaches as much per token, and attention costs it a quarter. See README.md.
"""
import argparse
import json
import shutil
import time
from pathlib import Path

import numpy as np
import torch
from safetensors import safe_open
from safetensors.torch import load_file

import losses
from data import Frames, as_tensor, draw_given, draw_masks, prefetch
from loop import Run, pick_device
from models.occ_dit import CELLS, LAYERS, NAMED, PATCH, DitConfig, OccDit, condition_of
from models.occ_vae import latent_space, load_vae
from pack import KINDS, Packed, folder_of, pack
from schedule import alpha_bar, ddim_sample, noised

SAVE_MINUTES, NOTE_MINUTES, SAMPLE_MINUTES = 3.0, 10.0, 30.0
FIRST_OBJECT_LAYER, OBJECT_WEIGHT = 8, 2.0  # the ten object layers follow eight map layers
DENSE, LABELS, DRAFT, GIVEN = range(len(KINDS))
# How often a group of conditions is left out: all of them (guidance needs it), the draft, the layout, the ground's height, a number.
NO_CONDITION, NO_DRAFT, NO_LAYOUT, NO_GROUND, NO_NUMBER = 0.07, 0.2, 0.04, 0.3, 0.3


def read_batch(frames, picks, given, known, cells=CELLS):
    """What the network learns from, and what it hears, of (frame, corner, kind) each. given [B,cells,cells,2]; known [B,3+NAMED]: draft,
    layout, ground, numbers. Returns target, draft, bev, heading, columns, ground, named of `condition_of` and `OccDit.condition`."""
    def stack(name, kind=None):
        return torch.from_numpy(np.stack([frames.read(f, name, kind, c, cells) for f, c, _ in picks]))

    target = torch.from_numpy(np.stack([frames.read(f, "latents", k, c, cells) for f, c, k in picks])).float()
    draft = torch.where(given.prod(-1, keepdim=True) > 0, stack("latents", GIVEN), stack("latents", DRAFT)).float()
    named = torch.from_numpy(np.stack([frames.read(f, "named", k) for f, _, k in picks]))
    with_draft, with_layout, with_ground, numbers = known[:, 0], known[:, 1], known[:, 2], known[:, 3:]
    draft = draft * with_draft[:, None, None, None]
    bev, heading = (stack(name) * with_layout.to(dtype)[:, None, None] for name, dtype in (("bev", torch.int32), ("heading", torch.uint8)))
    ground = with_ground[:, None, None].expand(-1, cells, cells)
    return target, draft, bev, heading, stack("columns"), ground, torch.cat([named * numbers, numbers, with_draft[:, None]], 1)


def draw_batch(frames, rng, batch, cells, labels):
    """A batch at random places."""
    corner = PATCH * rng.integers(0, (CELLS - cells) // PATCH + 1, (batch, 2))
    kinds = np.where(rng.random(batch) < labels, LABELS, DENSE)
    picks = [(int(rng.integers(len(frames))), tuple(int(v) for v in c), int(k)) for c, k in zip(corner, kinds)]
    windows = [(slice(x, x + cells), slice(y, y + cells)) for x, y in corner]
    mask = torch.from_numpy(np.stack([m[w] for m, w in zip(draw_masks(rng, batch), windows)]))
    mask[mask.amax((1, 2)) == 0] = 1  # a window that no rectangle touches would teach nothing
    given = torch.from_numpy(np.stack([g[w] for g, w in zip(draw_given(rng, batch), windows)]))
    heard = rng.random((batch, 1)) >= NO_CONDITION
    known = heard & (rng.random((batch, 3 + NAMED)) >= [NO_DRAFT, NO_LAYOUT, NO_GROUND] + [NO_NUMBER] * NAMED)
    given *= torch.from_numpy(heard.astype(np.float32))[..., None, None]
    return torch.from_numpy(corner // PATCH), mask, given, *read_batch(frames, picks, given, torch.from_numpy(known.astype(np.float32)), cells)


def dit_loss(model, abar, corner, mask, given, target, draft, bev, heading, columns, ground, named, generator=None):
    """v-prediction (`schedule.noised`); generated cells count fully, those
    with objects more (they are few, and what a user looks at), kept cells a tenth: at inference they are replayed.
    Returns the loss and the mean square error of v per sample."""
    noisy, t, truth, balance = noised(abar, target, generator)
    cells = condition_of(mask, target * (1 - mask[..., None]), draft, bev, heading, given, columns, ground)
    v = model(noisy, t, model.condition(cells, named, corner))
    error = ((v - truth) ** 2).mean(-1)
    objects = (bev >> FIRST_OBJECT_LAYER) & ((1 << (LAYERS - FIRST_OBJECT_LAYER)) - 1)
    objects = torch.nn.functional.max_pool2d((objects != 0).float()[:, None], 4)[:, 0]
    weight = (mask + 0.1 * (1 - mask)) * (1 + OBJECT_WEIGHT * objects)
    error = (error * weight).sum((1, 2)) / weight.sum((1, 2))
    return (error * balance).mean(), error.detach()


HELD_OUT = {"": (1, 0, 0), "_given": (1, 1, 1), "_bare": (0, 0, 0), "_built": (1, 1, 0)}  # is there a draft, are the groups given?


@torch.no_grad()
def figures(model, vae, abar, packed, worlds, device, count, sample):
    """Held-out error of v on whole frames, and agreement of `sample` generated ones with their worlds: nothing of the background
    given, all of it, no draft, what is man-made alone."""
    out, count = {}, min(count, len(packed))
    for ending, (draft, *groups) in HELD_OUT.items():
        rng, generator, errors = np.random.default_rng(1), torch.Generator().manual_seed(1), []
        known = torch.tensor([[draft, 1, 1, 1, 1, 1, 1]]).float()
        for frame in range(count):
            given = torch.tensor(groups).float().expand(1, CELLS, CELLS, 2)
            parts = [p.to(device) for p in read_batch(packed, [(frame, (0, 0), DENSE)], given, known)]
            mask = torch.from_numpy(draw_masks(rng, 1)).to(device)
            four = [p.expand(4, *p.shape[1:]) for p in (mask, given.to(device), *parts)]
            errors.append(dit_loss(model, abar, None, *four, generator)[1].mean().item())
        out |= {f"v{ending}": float(np.mean(errors)), f"miou{ending}": 0.0, f"iou{ending}": 0.0}  # 0: not sampled
        if sample:
            given = torch.tensor(groups).float().expand(sample, CELLS, CELLS, 2)
            target, *parts = (p.to(device) for p in read_batch(packed, [(i, (0, 0), DENSE) for i in range(sample)], given, known.expand(sample, -1)))
            *parts, named = parts
            ones = torch.ones(sample, CELLS, CELLS, device=device)
            cells = condition_of(ones, target * 0, *parts[:3], given.to(device), *parts[3:])
            heard = model.condition(cells, named)
            found = vae.decode(ddim_sample(lambda x, t: model(x, t, heard), torch.randn(target.shape, generator=generator).to(device), 20))
            made = losses.Confusion()
            made.add(as_tensor([worlds.read(i, "dense") for i in range(sample)]), found.cpu())
            out |= {f"miou{ending}": made.miou(), f"iou{ending}": made.iou()}
            print(f"  generated{ending} per class " + " ".join(f"{x:.2f}" for x in made.per_class().tolist()), flush=True)
    return out


def model_of(args, device):
    config = DitConfig(width=args.width, depth=args.depth, heads=args.width // 64, local=not args.no_local)
    state = None
    if args.init:
        with safe_open(args.init, "pt") as f:
            config = DitConfig(**json.loads(f.metadata()["config"]))
        state = {k: v.float() for k, v in load_file(args.init).items()}
    model = OccDit(config)
    if state:
        model.load_state_dict(state)
    return model.to(device)


def train(args, device, dtype):
    pack(args.data, args.vae, device, dtype)
    name, abar, vae = latent_space(args.vae), alpha_bar(), load_vae(args.vae, device)
    frames, held_out = (Packed(folder_of(args.data, name, part)) for part in ("train", "val"))
    worlds = Frames(args.data / "val")
    model = model_of(args, device)
    run = Run(model, args, lr=args.lr, betas=(0.9, 0.98), weight_decay=0.01, ema=0.9995, warmup=200, steady=1 - args.whole if args.whole > 0 else None)
    if run.done():
        return print(f"{args.output} is done")
    rng = np.random.default_rng([args.seed, run.step])
    meta = {"kind": "occ_dit", "config": json.dumps(model.config.as_dict()), "seed": args.seed, "data": args.data, "vae": name,
            "frames": len(frames)}
    mean, noted, sampled = {}, run.elapsed(), run.elapsed()
    tokens, since = 0, time.monotonic()

    def note(sample):
        found = figures(run.ema, vae, abar, held_out, worlds, device, args.held_out, sample)
        run.note(found | {f"train_{k}": mean.get(k, 0.0) for k in ("v", "v_whole")} | {"tokens_per_s": tokens / (time.monotonic() - since)})
        run.save(meta)

    stages = [(False, args.batch, args.window), (True, max(1, args.batch // 4), CELLS)]
    for whole, batch, cells in stages:
        if not whole and run.elapsed() >= args.minutes * (1 - args.whole):
            continue
        for parts in prefetch(lambda: draw_batch(frames, rng, batch, cells, args.labels)):
            parts = [p.to(device, non_blocking=True) for p in parts]
            with torch.autocast(device.type, dtype, enabled=dtype is not None):
                loss, errors = dit_loss(model, abar, *parts)
            run.update(loss, batch)
            tokens += batch * (cells // PATCH) ** 2
            key = "v_whole" if whole else "v"
            mean[key] = mean.get(key, errors.mean().item()) * 0.99 + errors.mean().item() * 0.01
            if run.step % 100 == 0:
                print(f"step {run.step} {run.elapsed():.1f} min {tokens / (time.monotonic() - since):.0f} tokens/s {key} {mean[key]:.4f}", flush=True)
            if run.done() or (not whole and run.elapsed() >= args.minutes * (1 - args.whole)):
                break
            if run.elapsed() - noted > NOTE_MINUTES:
                sample = args.sample if run.elapsed() - sampled > SAMPLE_MINUTES else 0
                sampled = run.elapsed() if sample else sampled
                note(sample)
                noted, tokens, since = run.elapsed(), 0, time.monotonic()
            elif run.elapsed() - run.saved_at > SAVE_MINUTES:
                run.save(meta)
        if not whole:
            run.save(meta)
            shutil.copy(run.checkpoint, run.checkpoint.with_suffix(".steady.pt"))
    note(args.sample)


def main():
    p = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    p.add_argument("--data", type=Path, required=True, help="folder with train/ and val/ shards")
    p.add_argument("--vae", required=True, help="weights of the VAE whose latents it lives in")
    p.add_argument("--minutes", type=float, required=True, help="wall-clock budget, earlier runs included when resuming")
    p.add_argument("-o", "--output", required=True, help="f32 weights; .checkpoint.pt and .csv are written beside it")
    p.add_argument("--init", help="weights to begin with")
    p.add_argument("--width", type=int, default=192)
    p.add_argument("--depth", type=int, default=8)
    p.add_argument("--no-local", action="store_true", help="without the convolution over values")
    p.add_argument("--batch", type=int, default=32, help="windows of a step; whole frames are a quarter as many")
    p.add_argument("--window", type=int, default=24, help="latent cells of a window's side, an even number")
    p.add_argument("--whole", type=float, default=0.3, help="share of the time, at its end, on whole frames")
    p.add_argument("--labels", type=float, default=0.35, help="share of samples whose target is labels")
    p.add_argument("--lr", type=float, default=2e-3)
    p.add_argument("--optimizer", choices=["muon", "adamw"], default="muon")
    p.add_argument("--held-out", type=int, default=16, help="held-out frames of the error")
    p.add_argument("--sample", type=int, default=4, help="held-out frames that are generated, every half an hour and at the end")
    p.add_argument("--seed", type=int, default=0)
    p.add_argument("--threads", type=int, default=2)
    p.add_argument("--resume", action="store_true")
    args = p.parse_args()
    torch.manual_seed(args.seed)
    train(args, *pick_device(args.threads))


if __name__ == "__main__":
    main()
