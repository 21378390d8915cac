"""Trains the temporal decoder: python train_time_decoder.py --data DIR --vae W.safetensors --minutes M -o OUT.safetensors [--resume]

DIR holds drives (`sceneloom dataset drives`), which are packed first (pack_drives.py). The VAE's weights stay. A sample is a window of 16 x 16
cells around one place of the world in all 8 frames of a drive. Its latents are noised as a generator might leave them: each frame by itself,
by up to half of their spread, one frame in five not at all. Losses are those of the VAE. At the end, or by `--figures-only`, held-out figures with
and without it: of encoded latents, of noised ones and, given `--dit` and `--time`, of frames that are generated one by one and together.
"""
import argparse
import csv
import json
import time
from pathlib import Path

import numpy as np
import torch
from safetensors import safe_open
from safetensors.torch import load_file
from torch.nn import functional as F

import losses
from data import prefetch
from loop import Run, pick_device
from models.occ_dit import NAMED
from models.occ_dit_time import OccDitTime, TimeConfig
from models.occ_vae import CELLS, FEATURES, FREE, latent_space, load_vae
from models.time_decoder import CELL_M, HALF_M, TimeDecoder, cell_warp, load_time_decoder, window_pose
from pack import folder_of
from pack_drives import PackedDrives, pack
from schedule import ddim_sample
from train_dit import FIRST_OBJECT_LAYER
from train_time import DENSE, heard_of, load_dit, read_drive

SAVE_MINUTES, NOTE_MINUTES = 3.0, 15.0
MOST_NOISE, UNTOUCHED = 0.5, 0.2  # of the latents' spread; share of frames
TESTED_NOISE = 0.25
KNOWN = 2  # frames of a drive that generated ones go on from


class LabelledDrives(PackedDrives):
    """Packed drives and the labels of their worlds, which are read from the shards."""

    def __init__(self, data, name, part):
        folder = folder_of(data, name, part)
        super().__init__(folder)
        shards = sorted(p.name for p in folder.glob("*") if p.suffix != ".part")
        self.labels = [safe_open(data / part / f"{shard}.safetensors", "np").get_slice("dense") for shard in shards]

    def dense(self, drive, frame=slice(None), x=slice(None), y=slice(None)):
        """u8 labels of a drive, or a part of them."""
        shard, i = self.index[drive]
        return self.labels[shard][i, frame, x, y]


def draw_window(drives, rng, side, anywhere):
    """Around one place of the world, with probability `anywhere` any that some frame sees, else that of an object: latents [T,side,side,8],
    labels u8 [T,4side,4side,16] and the poses [T,3] of the windows."""
    drive = int(rng.integers(len(drives)))
    pose = np.array(drives.array(drive, "pose"), np.float64)
    frame, columns = rng.integers(len(pose)), 4 * CELLS
    objects = np.flatnonzero(drives.array(drive, "bev")[frame] >> FIRST_OBJECT_LAYER)
    column = rng.choice(objects) if len(objects) and rng.random() > anywhere else rng.integers(columns**2)
    turn = np.stack([np.cos(pose[:, 2]), -np.sin(pose[:, 2]), np.sin(pose[:, 2]), np.cos(pose[:, 2])], 1).reshape(-1, 2, 2)
    place = np.array(divmod(column, columns)) * CELL_M / 4 - HALF_M + rng.uniform(-0.25, 0.25, 2) * side * CELL_M
    world = turn[frame] @ place + pose[frame, :2]
    there = np.einsum("tji,tj->ti", turn, world - pose[:, :2])
    corner = np.rint((there + HALF_M) / CELL_M - side / 2).clip(0, CELLS - side).astype(int)
    latents = [drives.array(drive, "latents")[t, DENSE, x : x + side, y : y + side] for t, (x, y) in enumerate(corner)]
    labels = [drives.dense(drive, t, slice(4 * x, 4 * (x + side)), slice(4 * y, 4 * (y + side))) for t, (x, y) in enumerate(corner.tolist())]
    return torch.from_numpy(np.stack(latents)).float(), torch.from_numpy(np.stack(labels)), window_pose(torch.from_numpy(pose), torch.from_numpy(corner), side)


def noised(latents, generator=None):
    """Latents [B,T,...] with noise of one level per drive."""
    b, t = latents.shape[:2]
    level = MOST_NOISE * torch.rand(b, 1, generator=generator) * (torch.rand(b, t, generator=generator) > UNTOUCHED)
    return latents + level.view(b, t, 1, 1, 1).to(latents.device) * torch.randn(latents.shape, generator=generator).to(latents.device)


def decoder_loss(net, vae, latents, labels, warped, voxels_per_cell=5, lovasz_voxels=24_000):
    """Cross-entropy and Lovasz of `losses.vae_loss` on voxels of all frames; latents [B,T,x,y,8], labels u8 [B,T,4x,4y,16]. Returns the loss and its parts."""
    found = (net(latents, warped) * vae.latent_std + vae.latent_mean).flatten(0, 1).permute(0, 3, 1, 2)
    index, label, weight = losses.sample_voxels(labels.flatten(0, 1), voxels_per_cell * latents[..., 0].numel())
    logits = vae.logits(vae.features(found).reshape(-1, FEATURES)[index])
    ce = (F.cross_entropy(logits, label, reduction="none") * weight).sum() / weight.sum()
    pick = torch.randint(len(label), (min(lovasz_voxels, len(label)),), device=label.device)
    lovasz = losses.lovasz_softmax(logits[pick].softmax(-1), label[pick])
    return ce + 0.5 * lovasz, {"ce": ce.item(), "lovasz": lovasz.item()}


class Tally:
    """Agreement with the truth, and how labels change from frame to frame."""

    def __init__(self):
        self.confusion, self.changed, self.seen, self.held = losses.Confusion(), 0, 0, 0

    def add(self, truth, found, pose, first=0):
        """u8 [T,200,200,16] each, pose [T,3]; frames before `first` are known."""
        self.confusion.add(truth[first:], found[first:])
        side = found.shape[1]
        for t in range(max(1, first), len(found)):
            index, seen, _ = cell_warp(pose[None, t - 1 : t + 1], side, 2 * HALF_M / side)
            index, seen = index[0, 1, 0], seen[0, 1, 0]
            now, before = found[t].flatten(0, 1)[seen], found[t - 1].flatten(0, 1)[index[seen]]
            self.changed += (now != before).sum().item()
            self.held += ((now != FREE) | (before != FREE)).sum().item()
            self.seen += now.numel()

    def row(self):
        """`flicker`: of the voxels that two frames, one after the other, have in their grids, the share whose label differs; `flicker_held`:
        of those that hold something in either."""
        return {"miou": self.confusion.miou(), "iou": self.confusion.iou(), "flicker": self.changed / self.seen, "flicker_held": self.changed / self.held}


def generated(model, drives, drive, steps=12):
    """Latents [T,50,50,8] of a drive as a transformer draws them from its layout, the first frames being known."""
    frames = len(drives.array(drive, "named"))
    mask = torch.ones(frames, CELLS, CELLS)
    mask[:KNOWN] = 0
    given, known = torch.zeros(frames, CELLS, CELLS, 2), torch.ones(frames, 3 + NAMED)
    *parts, pose = read_drive(drives, drive, (0, 0), CELLS, given, known)
    condition, warped = heard_of(model, None, mask, given, *parts, pose[None])
    noise = torch.randn(parts[0].shape, generator=torch.Generator().manual_seed(drive))
    found = ddim_sample(lambda x, t: model(x, t, condition, warped), noise, steps)
    found[:KNOWN] = parts[0][:KNOWN]
    return found


@torch.no_grad()
def figures(net, vae, drives, count, model=None, sample=0):
    """Rows of `Tally` by name, held out: `encoded` and `noised` latents of `count` drives, of `sample` of them frames drawn one by one (`single`) and
    together (`temporal`) by `model`; each as it is and (`_time`) with the temporal decoder; `truth` is the worlds themselves."""
    tallies = {}

    def add(name, *what):
        tallies.setdefault(name, Tally()).add(*what)

    for drive in range(min(count, len(drives))):
        truth, pose = torch.from_numpy(drives.dense(drive)), torch.from_numpy(np.array(drives.array(drive, "pose")))
        warped = cell_warp(pose[None])
        encoded = torch.from_numpy(np.array(drives.array(drive, "latents")[:, DENSE])).float()
        noise = torch.randn(encoded.shape, generator=torch.Generator().manual_seed(drive))
        kinds = {"encoded": (encoded, 0), "noised": (encoded + TESTED_NOISE * noise, 0)}
        add("truth", truth, truth, pose)
        if model and drive < sample:
            blocks = model.blocks
            for kind, kept in (("single", blocks[:0]), ("temporal", blocks)):
                model.blocks = kept
                kinds[kind] = generated(model, drives, drive), KNOWN
            model.blocks = blocks
            add("truth_generated", truth, truth, pose, KNOWN)
        for kind, (latents, first) in kinds.items():
            for ending, given in (("", latents), ("_time", net(latents[None], warped)[0])):
                add(kind + ending, truth, torch.cat([vae.decode(frame[None]) for frame in given]), pose, first)
    return {name: tally.row() for name, tally in tallies.items()}


def final_figures(net, vae, drives, args):
    """The whole table, printed and written beside the weights."""
    model = None
    if args.time:
        with safe_open(args.time, "pt") as f:
            config = TimeConfig(**json.loads(f.metadata()["config"]))
        model = OccDitTime(load_dit(args.dit), config)
        model.load_state_dict({k: v.float() for k, v in load_file(args.time).items()})
        model.eval().requires_grad_(False)
    with open(Path(args.output).with_suffix(".figures.csv"), "w", newline="") as f:
        writer = csv.writer(f)
        for i, (name, row) in enumerate(figures(net, vae, drives, args.held_out, model, args.sample).items()):
            if i == 0:
                writer.writerow(["of", *row])
            writer.writerow([name, *(f"{v:.4f}" for v in row.values())])
            print(f"{name:16} " + "  ".join(f"{k} {v:.4f}" for k, v in row.items()), flush=True)


def train(args, device, dtype):
    pack(args.data, args.vae, device, dtype)
    name, vae = latent_space(args.vae), load_vae(args.vae, device)
    drives, held_out = (LabelledDrives(args.data, name, part) for part in ("train", "val"))
    if args.figures_only:
        return final_figures(load_time_decoder(args.output, device), vae, held_out, args)
    net = TimeDecoder().to(device)
    run = Run(net, args, lr=args.lr, betas=(0.9, 0.98), weight_decay=0.01, ema=0.998, warmup=100)
    if run.done():
        return print(f"{args.output} is done")
    rng = np.random.default_rng([args.seed, run.step])
    meta = {"kind": "time_decoder", "config": json.dumps(net.config.as_dict()), "seed": args.seed, "vae": name, "drives": len(drives)}
    mean, noted, since = {}, run.elapsed(), (run.samples, time.monotonic())

    def make():
        latents, labels, pose = zip(*(draw_window(drives, rng, args.window, args.anywhere) for _ in range(args.batch)))
        return torch.stack(latents), torch.stack(labels), *cell_warp(torch.stack(pose), args.window)

    def note():
        rows = figures(run.ema, vae, held_out, args.noted)
        row = {f"{kind}_{what}": rows[kind][what] for kind in ("noised", "noised_time", "encoded", "encoded_time") for what in ("miou", "iou", "flicker")}
        run.note(row | mean | {"per_s": (run.samples - since[0]) / (time.monotonic() - since[1])})
        run.save(meta)

    for latents, labels, *warped in prefetch(make):
        latents, labels, *warped = (part.to(device) for part in (latents, labels, *warped))
        with torch.autocast(device.type, dtype, enabled=dtype is not None):
            loss, parts = decoder_loss(net, vae, noised(latents), labels, warped)
        run.update(loss, args.batch)
        mean = {k: mean.get(k, v) * 0.98 + v * 0.02 for k, v in parts.items()}
        if run.step % 50 == 0:
            rate = (run.samples - since[0]) / (time.monotonic() - since[1])
            print(f"step {run.step} {run.elapsed():.1f} min {rate:.2f}/s " + " ".join(f"{k} {v:.4f}" for k, v in mean.items()), flush=True)
        if run.done():
            break
        if run.elapsed() - noted > NOTE_MINUTES:
            note()
            noted, since = run.elapsed(), (run.samples, time.monotonic())
        elif run.elapsed() - run.saved_at > SAVE_MINUTES:
            run.save(meta)
    note()
    final_figures(run.ema, vae, held_out, args)


def main():
    p = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    p.add_argument("--data", type=Path, required=True, help="folder with train/ and val/ drives")
    p.add_argument("--vae", required=True)
    p.add_argument("--dit", help="weights of the single-frame transformer, for the figures of generated frames")
    p.add_argument("--time", help="weights of its temporal blocks, for these too")
    p.add_argument("--minutes", type=float, default=60, help="wall-clock budget, earlier runs included when resuming")
    p.add_argument("-o", "--output", required=True, help="f32 weights; .checkpoint.pt, .csv and .figures.csv are written beside it")
    p.add_argument("--figures-only", action="store_true", help="of the weights that are there")
    p.add_argument("--batch", type=int, default=2, help="windows of a step, 8 frames each")
    p.add_argument("--window", type=int, default=16, help="cells of a window's side")
    p.add_argument("--anywhere", type=float, default=0.5, help="share of windows that are not drawn around objects")
    p.add_argument("--lr", type=float, default=2e-3)
    p.add_argument("--optimizer", choices=["muon", "adamw"], default="muon")
    p.add_argument("--held-out", type=int, default=12, help="drives of the figures at the end")
    p.add_argument("--noted", type=int, default=2, help="drives of those in between")
    p.add_argument("--sample", type=int, default=3, help="drives that are generated at the end")
    p.add_argument("--seed", type=int, default=0)
    p.add_argument("--threads", type=int, default=2)
    p.add_argument("--resume", action="store_true")
    args = p.parse_args()
    torch.manual_seed(args.seed)
    train(args, *pick_device(args.threads))


if __name__ == "__main__":
    main()
