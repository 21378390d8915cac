"""What helps a picture network, by small ones that lack something or are told otherwise: seeds in pairs, equal steps, intervals.

    sceneloom-worlds --kind pictures --preview --size 128x80 --frames 384 --seed 1 -o DATA/train      # and 48 of --seed 2 to DATA/val
    python ablate_pictures.py run DATA -o OUT [--seeds 3 --steps 600 --batch 8 --only all,mpi_96]      # goes on where it was stopped
    python ablate_pictures.py table OUT                                                                # table.md

All learn on the latents of the shipped VAE, from nothing. Networks of one seed see the same frames with the same noise in the same order. They are judged on held-out frames:
the error of v, and pictures of 128 x 80 px, drawn in 4 DDIM steps with guidance 2, twice as large before the shipped segmenter, which learned from larger ones: its agreement with
what the picture should show, beside that of the renders; how far apart neighbours are where both see one surface, and how far a picture is from the one before, brought to its place.
"""
import argparse
import json
import math
import time
from pathlib import Path

import numpy as np
import torch
from torch.nn import functional as F

import train_pictures
from downstream import interval
from picture_data import shard_arrays, silence
from picture_eval import Agreement, across_views, drawn, moment_of, noise_for, over_time, sample
from train_pictures import SMALL, Learner, Trainer
from models.picture_dit import PictureDit, PictureDitConfig

WEIGHTS = Path(__file__).resolve().parent.parent / "assets" / "weights"
# name: (what the network is, how cells are weighed, frames are drawn by class); in groups, each beside its first.
GROUPS = {
    "What the condition is": {"all": "first surfaces: classes, facings and depths", "semantic": "without depths", "mpi_96": "96 planes, 1x1", "mpi_96_3": "96 planes, 3x3"},
    "How many planes (SyntheOcc: 1x1)": {"mpi_96": "96", "mpi_128": "128", "mpi_256": "256"},
    "What it hears besides": {"all": "neighbours and the frame before", "no_cross_view": "no neighbours", "no_before": "no frame before"},
    "How the loss is weighed": {"all": "objects twice", "plain": "all alike", "depth": "objects by depth", "progress": "objects by progress", "both": "by both", "balanced": "by both, frames of rare classes more often"},
}
NETWORKS = {"semantic": dict(depths=False), "mpi_96": dict(planes=96), "mpi_96_3": dict(planes=96, plane_kernel=3), "mpi_128": dict(planes=128), "mpi_256": dict(planes=256),
            "no_cross_view": dict(across=()), "no_before": dict(before=False)}
HOW = {"plain": "plain", "depth": "depth", "progress": "progress", "both": "both", "balanced": "both"}
NAMES = list(dict.fromkeys(name for group in GROUPS.values() for name in group))
FIGURES = {"v_alone": "error of v", "v_after": "with the frame before", "pixels": "pixels", "miou": "mIoU", "vehicles": "vehicles", "across": "neighbours", "over_time": "over time"}


class Ablation(Trainer):
    """A trainer whose pool is filled from a folder."""

    def __init__(self, data, threads):
        shards = {part: sorted((data / part).glob("shard_*.safetensors")) for part in ("train", "val")}
        first = shard_arrays(shards["val"][0].read_bytes())
        h, w = first["rgb"].shape[3:5]
        counts = {part: sum(len(shard_arrays(path.read_bytes())["conditions"]) for path in paths) for part, paths in shards.items()}
        args = train_pictures.arguments().parse_args(
            ["--stream", "", "--held-stream", "", "--minutes", "0", "-o", str(data / "run"), "--size", f"{w}x{h}", "--room", str(counts["train"]), "--held-out", str(counts["val"]),
             "--threads", str(threads), "--ablate", "planes_1", "--init-vae", str(WEIGHTS / "pictures_vae.safetensors"), "--init-seg", str(WEIGHTS / "pictures_segmenter.safetensors")])
        super().__init__(args)
        for part, pool in (("train", self.pool), ("val", self.held)):
            for path in shards[part]:
                pool.add(shard_arrays(path.read_bytes()))
            pool.encode(self.vae.ema, self.amp, 10**6)
        self.rare = self.by_class()

    def by_class(self):
        """How likely each frame is to be drawn, so that every class is as likely: the sum over its classes of one by the number of frames that show it."""
        classes = self.pool.arrays["told_class"][: self.pool.count].flatten(1)
        shows = torch.stack([(classes == c).sum(1) > 20 for c in range(1, 11)], 1).double()
        weights = (shows / shows.sum(0).clamp(min=1)).sum(1)
        return weights + 0.2 * weights.mean()

    def train(self, name, seed, steps, batch):
        torch.manual_seed(seed)
        model = self.on_device(PictureDit(PictureDitConfig(**{**SMALL, **NETWORKS.get(name, {})})))
        learner = Learner(model, self.args.lr, ema=0.995, warmup=50)
        torch.manual_seed(10**4 + seed)
        for step in range(steps):
            done = step / steps
            learner.before(done)
            even = self.pool.random_frames(batch, encoded=True)
            frames = torch.multinomial(self.rare, batch, replacement=True) if name == "balanced" else even
            mirrored = bool(torch.rand(()) < 0.5) and not model.config.planes
            part = self.pool.moments(frames, torch.randint(2, (batch,)), mirrored)
            told, after = (torch.rand(batch) for _ in range(2))
            told = told >= self.args.silent
            silence(part, told)
            noise = torch.Generator().manual_seed(seed * 10**6 + step)
            loss, v = self.v_loss(model, part, noise, before=(after < self.args.before) & told, how=HOW.get(name, "objects"), done=done)
            learner.update(loss, {"v": v})
        return learner

    @torch.no_grad()
    def judge(self, learner, frames, batch=8):
        """Figures of a network; the shipped judge sees pictures twice as large."""
        self.args.batch = batch
        out = self.held_v(learner.ema) | {"v_train": learner.means()["v"]}
        self.dit = learner
        agreement, gaps = Agreement(self.device), {"across": 0, "over_time": 0}
        for begin in range(0, frames, batch):
            some = list(range(begin, min(frames, begin + batch)))
            first, _, _ = moment_of(self, some, 0)
            part, _, shown = moment_of(self, some, 1)
            noise = noise_for(self, part["latent"].shape, begin)
            start = sample(self, first, noise)
            pictures = drawn(self, sample(self, part, noise))
            later = drawn(self, sample(self, part, noise, start))
            self.agree(agreement, pictures, shown)
            gaps["across"] += across_views(part, pictures)
            gaps["over_time"] += over_time(part, later, drawn(self, start))
        return out | agreement.figures() | {name: round((v[0] / v[1].clamp(min=1)).item(), 4) for name, v in gaps.items()}

    def agree(self, agreement, pictures, shown):
        large = F.interpolate(pictures.flatten(0, 1), scale_factor=2, mode="bilinear", align_corners=False)
        agreement.add(self, large.unflatten(0, pictures.shape[:2]), shown.repeat_interleave(2, -1).repeat_interleave(2, -2))

    @torch.no_grad()
    def floor(self, frames):
        """The same of the renders, and of the renders encoded and decoded."""
        out = {}
        for name in ("rendered", "decoded"):
            agreement, gaps = Agreement(self.device), {"across": 0, "over_time": 0}
            for begin in range(0, frames, 8):
                some = list(range(begin, min(frames, begin + 8)))
                first, before, _ = moment_of(self, some, 0)
                part, true, shown = moment_of(self, some, 1)
                if name == "decoded":
                    true, before = drawn(self, part["latent"]), drawn(self, first["latent"])
                self.agree(agreement, true, shown)
                gaps["across"] += across_views(part, true)
                gaps["over_time"] += over_time(part, true, before)
            out[name] = agreement.figures() | {key: round((v[0] / v[1].clamp(min=1)).item(), 4) for key, v in gaps.items()}
        return out


def rows_of(path):
    return [json.loads(line) for line in path.read_text().splitlines()] if path.exists() else []


def run(args):
    out = Path(args.output)
    out.mkdir(parents=True, exist_ok=True)
    path, names = out / "rows.jsonl", args.only.split(",") if args.only else NAMES
    trainer = Ablation(Path(args.data), args.threads)
    (out / "floor.json").write_text(json.dumps(trainer.floor(args.frames)) + "\n")
    for seed in range(args.first_seed, args.first_seed + args.seeds):
        for name in names:
            if any(r["name"] == name and r["seed"] == seed and r["steps"] == args.steps for r in rows_of(path)):
                continue
            begin = time.process_time()
            learner = trainer.train(name, seed, args.steps, args.batch)
            seconds = time.process_time() - begin
            row = {"name": name, "seed": seed, "steps": args.steps, "batch": args.batch, "seconds": round(seconds), "frames": trainer.pool.count,
                   "parameters": sum(p.numel() for p in learner.model.parameters())} | trainer.judge(learner, args.frames)
            with open(path, "a") as f:
                f.write(json.dumps(row) + "\n")
            print(json.dumps(row), flush=True)


def cell(values):
    if not values:
        return "–"
    mean, half = interval(values)
    return f"{mean:+.3f}" + (f" ± {half:.3f}" if math.isfinite(half) else "")


def table(args):
    """Tables of a folder: of each group the first row as it is, the others by their differences from it, seed by seed."""
    rows = rows_of(Path(args.output) / "rows.jsonl")
    steps = max(r["steps"] for r in rows)
    of = {(r["name"], r["seed"]): r for r in rows if r["steps"] == steps}
    seeds = sorted({seed for _, seed in of})
    floor = json.loads((Path(args.output) / "floor.json").read_text())
    one = rows[0]
    lines = [f"{steps} steps of {one['batch']} frames, {one['frames']} training frames; differences from the first row of each table, mean ± 95 % interval over seeds ({len(seeds)} at most).", ""]
    head = "| | " + " | ".join(["seeds", *FIGURES.values()]) + " |"
    for title, group in GROUPS.items():
        first = next(iter(group))
        lines += [f"**{title}**", "", head, "|---" * (2 + len(FIGURES)) + "|"]
        for name, what in group.items():
            mine = [s for s in seeds if (name, s) in of and (first, s) in of]
            if name == first:
                values = [f"{np.mean([of[first, s][f] for s in mine]):.3f}" if mine else "–" for f in FIGURES]
            else:
                values = [cell([of[name, s][f] - of[first, s][f] for s in mine]) for f in FIGURES]
            lines.append(f"| {what} | {len(mine)} | " + " | ".join(values) + " |")
        lines.append("")
    known = [f for f in FIGURES if f in floor["rendered"]]
    lines += ["**The renders, and the renders encoded and decoded**", "", "| | " + " | ".join(FIGURES[f] for f in known) + " |", "|---" * (1 + len(known)) + "|"]
    lines += [f"| {name} | " + " | ".join(f"{floor[name][f]:.3f}" for f in known) + " |" for name in floor]
    text = "\n".join(lines) + "\n"
    (Path(args.output) / "table.md").write_text(text)
    print(text)


def main():
    p = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    commands = p.add_subparsers(required=True)
    r = commands.add_parser("run")
    r.add_argument("data", help="folder with train/ and val/")
    r.add_argument("-o", "--output", required=True)
    r.add_argument("--seeds", type=int, default=3)
    r.add_argument("--first-seed", type=int, default=1)
    r.add_argument("--steps", type=int, default=600)
    r.add_argument("--batch", type=int, default=8)
    r.add_argument("--frames", type=int, default=32, help="held-out frames whose pictures are judged")
    r.add_argument("--only", help=f"some of {', '.join(NAMES)}")
    r.add_argument("--threads", type=int, default=1)
    r.set_defaults(do=run)
    t = commands.add_parser("table")
    t.add_argument("output")
    t.set_defaults(do=table)
    args = p.parse_args()
    args.do(args)


if __name__ == "__main__":
    main()
