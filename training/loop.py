"""What all trainings share: device, clock, EMA, checkpoints, CSV."""
import argparse
import copy
import csv
import math
import os
import re
import time
from pathlib import Path

import numpy as np
import torch
from safetensors.torch import save_file

from muon import Muon


def pick_device(threads):
    """(device, autocast dtype or None). bf16 pays on CUDA and on CPUs that multiply it (AMX, AVX512_BF16); elsewhere it is
    several times slower."""
    torch.set_num_threads(threads)
    # Losses that are nearly nil give denormal gradients, which make a CPU's convolutions ten times slower. Threads
    # inherit this setting, so it comes before the first of them.
    torch.set_flush_denormal(True)
    if torch.cuda.is_available():
        return torch.device("cuda"), torch.bfloat16
    multiplies = any(getattr(torch.cpu, f"_is_{what}_supported", lambda: False)() for what in ("amx_tile", "avx512_bf16"))
    return torch.device("cpu"), torch.bfloat16 if multiplies else None


def optimizers(model, kind, lr, betas, weight_decay):
    """Muon for the weights of inner layers and AdamW for tables, first and last layers and vectors, or AdamW for all."""
    inner = {m.weight for name, m in model.named_modules()
             if kind == "muon" and isinstance(m, (torch.nn.Conv2d, torch.nn.Linear)) and re.match(model.INNER, name)}
    rest = [p for p in model.parameters() if p not in inner]
    groups = [{"params": [p for p in rest if p.ndim >= 2], "weight_decay": weight_decay},
              {"params": [p for p in rest if p.ndim < 2], "weight_decay": 0.0}]
    adamw = torch.optim.AdamW(groups, lr=lr, betas=betas, fused=True)
    ordered = [p for p in model.parameters() if p in inner]
    return [adamw, Muon(ordered, lr, weight_decay=weight_decay)] if inner else [adamw]


class Run:
    """A training run measured by a clock, that of the wall if not told: learning rate, EMA, checkpoints, log."""

    def __init__(self, model, args, *, lr, betas, weight_decay, ema, warmup, steady=None, clock=time.monotonic):
        self.steady, self.clock = steady, clock
        self.out, self.minutes, self.lr, self.warmup, self.ema_decay = Path(args.output), args.minutes, lr, warmup, ema
        self.model, self.ema = model, copy.deepcopy(model).requires_grad_(False).eval()
        self.optimizers = optimizers(model, args.optimizer, lr, betas, weight_decay)
        self.step, self.samples, self.spent, self.started = 0, 0, 0.0, clock()
        self.checkpoint = self.out.with_suffix(".checkpoint.pt")
        self.log = self.out.with_suffix(".csv")
        self.out.parent.mkdir(parents=True, exist_ok=True)
        if args.resume and self.checkpoint.exists():
            self.load()
        elif self.log.exists():
            self.log.unlink()
        self.saved_at = self.elapsed()

    def elapsed(self):
        """Minutes of training so far, earlier runs included."""
        return self.spent + (self.clock() - self.started) / 60

    def done(self):
        return self.elapsed() >= self.minutes

    def rate(self):
        """Falls to zero at the end: all the way (half a cosine), or, if a share of the time is `steady`, in a line after that: such
        a run can be made longer while it is steady."""
        done = min(1.0, self.elapsed() / self.minutes)
        fall = 0.5 * (1 + math.cos(math.pi * done)) if self.steady is None else min(1.0, (1 - done) / (1 - self.steady))
        return self.lr * min(1.0, (self.step + 1) / self.warmup) * fall

    def update(self, loss, samples):
        """One optimiser step; a loss that is not finite is skipped and reported."""
        self.step, self.samples = self.step + 1, self.samples + samples
        for optimizer in self.optimizers:
            for group in optimizer.param_groups:
                group["lr"] = self.rate()
            optimizer.zero_grad(set_to_none=True)
        loss.backward()
        norm = torch.nn.utils.clip_grad_norm_(self.model.parameters(), 1.0)
        if not math.isfinite(norm.item()):
            print(f"step {self.step}: gradient not finite, skipped", flush=True)
            return
        for optimizer in self.optimizers:
            optimizer.step()
        decay = min(self.ema_decay, (1 + self.step) / (10 + self.step))
        with torch.no_grad():
            torch._foreach_lerp_(list(self.ema.parameters()), list(self.model.parameters()), 1 - decay)

    def load(self):
        state = torch.load(self.checkpoint, weights_only=True)
        self.model.load_state_dict(state["model"])
        self.ema.load_state_dict(state["ema"])
        for optimizer, kept in zip(self.optimizers, state["optimizers"], strict=True):
            optimizer.load_state_dict(kept)
        self.step, self.samples, self.spent = state["step"], state["samples"], state["minutes"]
        torch.set_rng_state(state["rng"])
        print(f"resumed at step {self.step}, {self.spent:.1f} min", flush=True)

    def save(self, metadata):
        """Checkpoint and f32 weights (EMA), each replaced in one go."""
        state = {"model": self.model.state_dict(), "ema": self.ema.state_dict(), "optimizers": [o.state_dict() for o in self.optimizers], "step": self.step, "samples": self.samples, "minutes": self.elapsed(), "rng": torch.get_rng_state()}
        part = self.checkpoint.with_suffix(".part")
        torch.save(state, part)
        os.replace(part, self.checkpoint)
        metadata = {k: str(v) for k, v in metadata.items()} | {"steps": str(self.step), "samples": str(self.samples),
                                                               "minutes": f"{self.elapsed():.1f}"}
        part = self.out.with_suffix(".part")
        save_file({k: v.contiguous().cpu() for k, v in self.ema.state_dict().items()}, part, metadata)
        os.replace(part, self.out)
        self.saved_at = self.elapsed()

    def note(self, row):
        """One line of the CSV log and of the terminal."""
        row = {"minutes": round(self.elapsed(), 2), "step": self.step, "samples": self.samples, "lr": f"{self.rate():.2e}"} | {
            k: f"{v:.4f}" for k, v in row.items()}
        new = not self.log.exists()
        with open(self.log, "a", newline="") as f:
            writer = csv.DictWriter(f, row.keys())
            if new:
                writer.writeheader()
            writer.writerow(row)
        print("  ".join(f"{k} {v}" for k, v in row.items()), flush=True)


SAVE_MINUTES = 3.0


def diffusion_arguments(doc, batch, held_out):
    """The arguments that trainers of small diffusions share."""
    p = argparse.ArgumentParser(description=doc, formatter_class=argparse.RawDescriptionHelpFormatter)
    p.add_argument("--data", type=Path, required=True, help="folder with train/ and val/ shards")
    p.add_argument("--vae", required=True, help="weights that the data were or will be packed with")
    p.add_argument("--minutes", type=float, required=True, help="wall-clock budget, earlier runs included when resuming")
    p.add_argument("-o", "--output", required=True, help="f32 weights; .checkpoint.pt and .csv are written beside it")
    p.add_argument("--batch", type=int, default=batch)
    p.add_argument("--lr", type=float, default=2e-3)
    p.add_argument("--optimizer", choices=["muon", "adamw"], default="muon")
    p.add_argument("--held-out", type=int, default=held_out)
    p.add_argument("--seed", type=int, default=0)
    p.add_argument("--threads", type=int, default=2)
    p.add_argument("--resume", action="store_true")
    return p


def train_diffusion(model, args, meta, device, dtype, batches, loss_of, figures, note_minutes):
    """Trains a small diffusion until its time is up. `batches(rng)` yields tuples of tensors, `loss_of(model, *batch)` gives a loss and the error
    of v, `figures(ema)` what is noted of the held-out frames."""
    run = Run(model, args, lr=args.lr, betas=(0.9, 0.98), weight_decay=0.01, ema=0.999, warmup=100)
    if run.done():
        return print(f"{args.output} is done")
    mean, noted, since = None, run.elapsed(), (run.samples, time.monotonic())

    def rate():
        return (run.samples - since[0]) / (time.monotonic() - since[1])

    def note():
        run.note(figures(run.ema) | {"train_v": mean, "per_s": rate()})
        run.save(meta)

    for batch in batches(np.random.default_rng([args.seed, run.step])):
        with torch.autocast(device.type, dtype, enabled=dtype is not None):
            loss, v = loss_of(model, *(part.to(device) for part in batch))
        run.update(loss, args.batch)
        mean = v if mean is None else mean * 0.99 + v * 0.01
        if run.step % 100 == 0:
            print(f"step {run.step} {run.elapsed():.1f} min {rate():.1f}/s v {mean:.4f}", flush=True)
        if run.done():
            break
        if run.elapsed() - noted > note_minutes:
            note()
            noted, since = run.elapsed(), (run.samples, time.monotonic())
        elif run.elapsed() - run.saved_at > SAVE_MINUTES:
            run.save(meta)
    note()
