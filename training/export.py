"""Trained f32 weights -> f16 files that ship, their card, and goldens for tests/parity.rs.

python export.py --vae RUNS/occ_vae.safetensors --dit RUNS/occ_dit.safetensors --data DIR --data-command "..."
The goldens are computed from the f16 values, in f32, as the Rust program computes.
"""
import argparse
import csv
import hashlib
import json
from pathlib import Path

import numpy as np
import torch
from safetensors import safe_open
from safetensors.torch import load_file, save_file

from data import Frames, as_tensor
from models.occ_dit import DitConfig, OccDit, condition_of
from models.occ_vae import OccVae, VaeConfig, latent_space

ROOT = Path(__file__).resolve().parent.parent
GOLDEN_TIMES = (0.0, 437.5, 999.0)
GOLDEN_CELLS = (0, 515, 1275, 2499)


def read(path):
    with safe_open(path, "pt") as f:
        return load_file(path), f.metadata()


def halved(tensors):
    """Matrices in f16; vectors (biases, norms, latent statistics) stay f32: they are few."""
    return {k: (v.half() if v.ndim >= 2 else v.float()).contiguous() for k, v in tensors.items()}


def uniform(count, stream):
    """Numbers in [-1.75, 1.75) that any language makes alike: a multiplicative hash of the index."""
    i = np.arange(count, dtype=np.uint64)
    h = (i * np.uint64(2654435761) + np.uint64(stream * 40503 + 12345)) % np.uint64(2**32)
    h = (h ^ (h >> np.uint64(15))) * np.uint64(2246822519) % np.uint64(2**32)
    return torch.from_numpy((h.astype(np.float64) / 2**32 * 3.5 - 1.75).astype(np.float32))


@torch.no_grad()
def vae_golden(vae, frames, side):
    """The front right quarter of a frame: occupied voxels, its latent of `side` cells each way, logits of a few cells; these again
    where the decoder hears the very grid as a draft, and what was observed."""
    grid = np.full((200, 200, 16), 17, np.uint8)
    grid[100:160, 70:130] = frames.read(0, "labels")[100:160, 70:130]
    where = np.flatnonzero(grid.reshape(-1) != 17)
    latent = vae.encode(as_tensor([grid]))
    x, y = np.meshgrid(np.arange(200), np.arange(200), indexing="ij")
    observed = np.where((3 * x + 5 * y) % 7 < 4, 1 << 16 | (x * y & 0xFFFF), 0).astype(np.int32)
    wide = 200 // side
    picked = [c // 50 * side // 50 * side + c % 50 * side // 50 for c in GOLDEN_CELLS]
    at = [(c // side * wide, c % side * wide) for c in picked]

    def logits(heard):
        features = vae.features((latent * vae.latent_std + vae.latent_mean).permute(0, 3, 1, 2), heard)[0]
        return vae.logits(torch.stack([features[x:, y:][:wide, :wide].reshape(wide * wide * 16, -1) for x, y in at]))

    return {
        "voxels": torch.from_numpy(where.astype(np.int32)),
        "labels": torch.from_numpy(grid.reshape(-1)[where]),
        "latent": latent.reshape(-1),
        "cells": torch.tensor(picked, dtype=torch.int32),
        "logits": logits(None),
        "logits_told": logits((as_tensor([grid]), as_tensor([observed])) if vae.config.hears else None),
    }


def golden_layout():
    """Layout bits, i32 [200,200], that any language can make alike."""
    x, y = torch.meshgrid(torch.arange(200), torch.arange(200), indexing="ij")
    bev = torch.zeros(200, 200, dtype=torch.int32)
    for layer in range(18):
        bev |= (((x * 3 + y * 5 + layer * 37) % 97 < 11).int() << layer)
    return bev


def golden_columns():
    """Background and ground, u8 [200,200,5], made so too."""
    x, y = torch.meshgrid(torch.arange(200), torch.arange(200), indexing="ij")
    built, grown = (x + y) % 3 == 0, (x // 2 + y) % 5 == 0
    columns = torch.stack([(x % 4 + 1) * built, (x % 4 + 1 + y % 3) * built, 2 * grown, 9 * grown, (x + 2 * y) % 6], -1)
    return columns.to(torch.uint8)


def golden_condition():
    """Mask, context, draft, layout bits, headings, named numbers, background and ground: any language can make them alike."""
    mask = torch.zeros(50, 50)
    mask[10:31, 17:40] = 1
    context = uniform(20000, 2).view(50, 50, 8) * (1 - mask[..., None])
    x, y = torch.meshgrid(torch.arange(200), torch.arange(200), indexing="ij")
    heading = torch.where((x // 8 + y // 4) % 5 == 0, 1 + (x * 7 + y * 3) % 240, 0)
    named = torch.tensor([[0.25, 0.0, 0.75, 0.5, 1.0, 0.0, 1.0, 1.0, 1.0]])
    given = torch.zeros(1, 50, 50, 2)
    given[:, 20:, 5:33, 0] = 1
    given[:, :, :30, 1] = 1
    cells = condition_of(mask[None], context[None], uniform(20000, 3).view(1, 50, 50, 8), golden_layout()[None], heading[None], given,
                         golden_columns()[None], torch.ones(1, 50, 50))
    return cells, named


@torch.no_grad()
def dit_golden(dit):
    condition = dit.condition(*golden_condition())
    x = uniform(20000, 1).view(1, 50, 50, 8)
    out = [dit(x, torch.tensor([t]), condition).reshape(-1)[::5] for t in GOLDEN_TIMES]
    return {"t": torch.tensor(GOLDEN_TIMES), "every_fifth_v": torch.stack(out)}


def last_row(weights):
    log = Path(weights).with_suffix(".csv")
    if not log.exists():
        return {}
    with open(log) as f:
        last = list(csv.DictReader(f))[-1]
    return {k: v for k, v in last.items() if v != "0.0000"}  # 0: not sampled


def main():
    p = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    p.add_argument("--vae", type=Path, required=True)
    p.add_argument("--dit", type=Path, required=True)
    p.add_argument("--fine", type=Path, help="weights of the fine VAE; those that are there stay without it")
    p.add_argument("--data", type=Path, required=True, help="the data set; the VAE's golden is a held-out frame")
    p.add_argument("--data-command", required=True, help="how the data were made, for the card")
    p.add_argument("--weights", type=Path, default=ROOT / "assets/weights")
    p.add_argument("--goldens", type=Path, default=ROOT / "tests/reference")
    args = p.parse_args()
    args.weights.mkdir(parents=True, exist_ok=True)
    args.goldens.mkdir(parents=True, exist_ok=True)

    name = latent_space(args.vae)
    old = args.weights / "card.json"
    kept = json.loads(old.read_text()) if old.exists() else {}
    card = {"data_command": args.data_command, "precision": "matrices f16, vectors f32"}
    networks = [("occ_vae", args.vae), ("occ_dit", args.dit)] + ([("occ_vae_fine", args.fine)] if args.fine else [])
    for kind, path in networks:
        tensors, meta = read(path)
        if meta.get("kind") != kind.removesuffix("_fine"):
            raise SystemExit(f"{path}: expected weights of {kind}, found {meta.get('kind')}")
        if kind.startswith("occ_dit") and meta["vae"] != name:
            raise SystemExit(f"{path}: trained on the latents of VAE {meta['vae']}, not of {args.vae} ({name})")
        keep = ("kind", "config", "seed", "steps", "samples", "minutes", "vae", "calibrated")
        meta = {k: meta[k] for k in keep if k in meta} | ({} if kind == "occ_dit" else {"name": latent_space(path)})
        out = args.weights / f"{kind}.safetensors"
        save_file(halved(tensors), out, meta)
        log = Path(path).with_suffix(".csv")
        if log.exists():
            (args.weights / f"{kind}.csv").write_text(log.read_text())
        card[kind] = meta | {"config": json.loads(meta["config"]), "bytes": out.stat().st_size,
                             "sha256": hashlib.sha256(out.read_bytes()).hexdigest(),
                             "parameters": sum(v.numel() for v in tensors.values()), "held_out": last_row(path)}
        shipped = {k: v.float() for k, v in load_file(out).items()}
        if kind.startswith("occ_vae"):
            net = OccVae(VaeConfig(**json.loads(meta["config"])))
            golden = (lambda: vae_golden(net, Frames(args.data / "val"), 200 >> (len(net.config.widths) - 1)))
        else:
            net = OccDit(DitConfig(**json.loads(meta["config"])))
            golden = (lambda: dit_golden(net))
        net.load_state_dict(shipped)
        net.eval()
        save_file(golden(), args.goldens / f"parity_{kind.removeprefix('occ_')}.safetensors")
        print(f"{out}: {card[kind]['bytes'] / 1e6:.1f} MB, {card[kind]['parameters']} parameters")

    kinds = [kind for kind, _ in networks]
    if not args.fine and "occ_vae_fine" in kept:
        card["occ_vae_fine"] = kept["occ_vae_fine"]
        kinds.append("occ_vae_fine")
    elsewhere = [kind for kind, of in kept.items() if isinstance(of, dict) and kind not in kinds]  # the other export scripts write these
    card |= {kind: kept[kind] for kind in elsewhere}
    (args.weights / "card.json").write_text(json.dumps(card, indent=1) + "\n")
    lines = ["# Weights", "", "Trained on this project's own procedural worlds; no frame of a data set went in. With `--roads` a third of the",
             "layouts are places on public OpenDRIVE files (MIT, MPL-2.0), which are not part of this repository.", "",
             f"- Data: `{args.data_command}`", "- Recipe: `training/README.md`, which says what each network began with; logs: the CSV files beside this card.",
             "- `f3d.safetensors`: the encoder of `occ_vae` of commit 5750f81, fixed for good: the features of F3D, KID and MMD",
             "  (`src/gen/metrics/extractor.rs`).", ""]
    for kind in kinds:
        c = card[kind]
        lines += [f"## {kind}", "", f"- {c['parameters']:,} parameters, {c['bytes'] / 1e6:.1f} MB; config `{json.dumps(c['config'])}`",
                  f"- seed {c['seed']}, {c['steps']} steps, {c['samples']} samples, {float(c['minutes']) / 60:.2f} h",
                  *([f"- class biases moved by `calibrate.py`: {c['calibrated']}; the figures below are of before"] if "calibrated" in c else []),
                  "- held-out at the end of training: " + (", ".join(f"{k} {v}" for k, v in c["held_out"].items()) or "no log"), ""]
    old_text = (args.weights / "CARD.md").read_text().split("\n## ") if elsewhere else []
    sections = ["## " + part.strip() + "\n" for part in old_text if part.split()[0] in elsewhere]
    (args.weights / "CARD.md").write_text("\n".join(lines + sections))


if __name__ == "__main__":
    main()
