"""A student of the DiT that makes in 4 steps what its teacher makes in 12 (progressive distillation, 2202.00512).

python distill.py --data DIR --vae RUNS/occ_vae.safetensors --teacher RUNS/occ_dit.safetensors --minutes M -o RUNS/occ_dit_fast.safetensors

A sample is a clean latent with noise at one of the student's four levels. The teacher takes three DDIM steps from there
to the student's next level; the student learns the v whose one DDIM step ends at the same place.
"""
import argparse
import json
import time
from pathlib import Path

import numpy as np
import torch
from safetensors import safe_open
from safetensors.torch import load_file

from data import Frames, draw_given, draw_masks, prefetch
from latents import LatentCache, latent_space
from loop import Run, pick_device
from models.occ_dit import NAMED, DitConfig, OccDit
from schedule import alpha_bar, ddim_timesteps
from train import FIRST_OBJECT_LAYER, NOTE_MINUTES, OBJECT_WEIGHT, SAVE_MINUTES, conditions, load_vae


def levels(steps):
    """(t, alpha_bar) of every DDIM step of a run of `steps`, the clean end (t none) last."""
    abar = alpha_bar()
    return [(t, abar[t].item()) for t in ddim_timesteps(steps)] + [(None, 1.0)]


def columns(values, like):
    return torch.tensor(values, dtype=torch.float32, device=like.device).view(-1, 1, 1, 1)


def ddim_step(x, v, a, b):
    """From signal a to signal b (both alpha_bar, [B,1,1,1])."""
    x0, eps = a.sqrt() * x - (1 - a).sqrt() * v, (1 - a).sqrt() * x + a.sqrt() * v
    return b.sqrt() * x0 + (1 - b).sqrt() * eps


def v_between(x, y, a, b):
    """The v whose DDIM step takes x at signal a to y at signal b < 1 of noise: y = x (root ab + root (1-a)(1-b)) + v (...)."""
    cos = (a * b).sqrt() + ((1 - a) * (1 - b)).sqrt()
    sin = ((1 - b) * a).sqrt() - ((1 - a) * b).sqrt()
    return (y - cos * x) / sin


def distill_loss(student, teacher, target, parts, mask, steps, substeps, generator):
    """Mean squared error of v, kept cells a tenth, objects more (as in training), and the same relative to its size."""
    coarse, fine = levels(steps), levels(steps * substeps)
    k = torch.randint(steps, (len(target),), generator=generator).tolist()
    a = columns([coarse[i][1] for i in k], target)
    noise = torch.randn(target.shape, generator=generator).to(target.device)
    x = a.sqrt() * target + (1 - a).sqrt() * noise
    with torch.no_grad():
        y, condition = x, teacher.condition(mask, *parts)
        for j in range(substeps):
            here, there = [fine[i * substeps + j] for i in k], [fine[i * substeps + j + 1] for i in k]
            t = torch.tensor([float(h[0]) for h in here], device=target.device)
            y = ddim_step(y, teacher(y, t, condition), columns([h[1] for h in here], y), columns([h[1] for h in there], y))
        wanted = v_between(x, y, a, columns([coarse[i + 1][1] for i in k], x))
    t = torch.tensor([float(coarse[i][0]) for i in k], device=target.device)
    error = ((student(x, t, student.condition(mask, *parts)) - wanted) ** 2).mean(-1)
    objects = parts[2].view(len(target), 50, 50, 16, 18)[..., FIRST_OBJECT_LAYER:].amax((3, 4))
    cell = (mask + 0.1 * (1 - mask)) * (1 + OBJECT_WEIGHT * objects)
    loss = ((error * cell).sum((1, 2)) / cell.sum((1, 2))).mean()
    return loss, (error.detach().mean() / (wanted**2).mean()).item()


def load_dit(path):
    with safe_open(path, "pt") as f:
        meta = f.metadata()
    dit = OccDit(DitConfig(**json.loads(meta["config"])))
    dit.load_state_dict({k: v.float() for k, v in load_file(path).items()})
    return dit, meta


def main():
    p = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    p.add_argument("--data", type=Path, required=True)
    p.add_argument("--vae", required=True)
    p.add_argument("--teacher", required=True)
    p.add_argument("--minutes", type=float, required=True)
    p.add_argument("-o", "--output", required=True)
    p.add_argument("--steps", type=int, default=4)
    p.add_argument("--substeps", type=int, default=3)
    p.add_argument("--lr", type=float, default=2e-4)
    p.add_argument("--batch", type=int, default=4)
    p.add_argument("--threads", type=int, default=1)
    p.add_argument("--seed", type=int, default=0)
    p.add_argument("--held-out", type=int, default=16)
    p.add_argument("--optimizer", choices=["muon", "adamw"], default="adamw")
    p.add_argument("--resume", action="store_true")
    args = p.parse_args()
    torch.manual_seed(args.seed)
    device, _ = pick_device(args.threads)
    train, held_out = Frames(args.data / "train"), Frames(args.data / "val")
    vae, name = load_vae(args.vae, device), latent_space(args.vae)
    caches = [LatentCache(f, vae, args.data / f"latents-{name}", device) for f in (train, held_out)]
    (teacher, meta), (student, _) = load_dit(args.teacher), load_dit(args.teacher)
    teacher, student = teacher.to(device).eval().requires_grad_(False), student.to(device)
    run = Run(student, args, lr=args.lr, betas=(0.9, 0.98), weight_decay=0.0, ema=0.995, warmup=50)
    meta = {"kind": "occ_dit", "config": meta["config"], "seed": args.seed, "data": args.data, "vae": name,
            "distilled_steps": args.steps, "teacher_steps": args.steps * args.substeps}

    def pass_of(model, frames, cache, picks, drop_names, given, mask, generator):
        target, draft = cache.batch(*zip(*picks), given)
        layout, heading, told = (x.to(device) for x in conditions(frames, picks))
        told = told * torch.cat([drop_names, drop_names], 1).to(device)
        mask, given = mask.to(device), given.to(device)
        parts = (target * (1 - mask[..., None]), draft, layout, heading, told, given)
        return distill_loss(model, teacher, target, parts, mask, args.steps, args.substeps, generator)

    rng = np.random.default_rng([args.seed, run.step])

    def make():
        kinds = np.where(rng.random(args.batch) < 0.2, "labels", "dense")
        picks = [(int(rng.integers(len(train))), int(rng.choice([0, 2])), str(k)) for k in kinds]
        return picks, torch.from_numpy(rng.random((args.batch, NAMED)) < 0.7), *(torch.from_numpy(draw(rng, args.batch)) for draw in (draw_given, draw_masks))

    @torch.no_grad()
    def note():
        generator, errors = torch.Generator().manual_seed(1), []
        fixed = np.random.default_rng(1)
        for first in range(0, args.held_out, 4):
            picks = [(i, 0, "dense") for i in range(first, first + 4)]
            given, masks = (torch.from_numpy(draw(fixed, 4)) for draw in (draw_given, draw_masks))
            errors += [pass_of(run.ema, held_out, caches[1], picks, torch.ones(4, NAMED), given, masks, generator)[1] for _ in range(3)]
        run.note({"held_out_rel": sum(errors) / len(errors), "train_rel": mean})
        run.save(meta)

    mean = 0.0
    note()
    noted = time.monotonic()
    for picks, told, given, mask in prefetch(make):
        loss, rel = pass_of(student, train, caches[0], picks, told.float(), given, mask, None)
        run.update(loss, len(picks))
        mean = mean * 0.95 + rel * 0.05 if mean else rel
        if run.step % 25 == 0:
            print(f"step {run.step} {run.elapsed():.1f} min rel {mean:.4f}", flush=True)
        if run.done():
            break
        if time.monotonic() - noted > 60 * NOTE_MINUTES * 2:
            note()
            noted = time.monotonic()
        elif run.elapsed() - run.saved_at > SAVE_MINUTES:
            run.save(meta)
    note()


if __name__ == "__main__":
    main()
