"""Moves a VAE's class biases to where IoU is highest: python calibrate.py --vae W.safetensors --data DIR -o OUT.safetensors

Training draws rare classes and weighs them more, so that they are learnt; their bias is then too high for the voxels as
they are, and some are seen where none is. Eighteen numbers are searched on training frames, complete and labels, each by
steps that grow smaller, for mIoU and half of IoU. Held-out figures are printed before and after.
"""
import argparse
import json
import shutil
from pathlib import Path

import numpy as np
import torch
from safetensors import safe_open
from safetensors.torch import load_file, save_file

import losses
from data import Frames, as_tensor
from models.occ_vae import CLASSES, latent_space, load_vae

KINDS = ("dense", "labels")
# What a decoder that listens is told of each: the draft, and what was observed.
TOLD = {"dense": ("given",), "labels": ("draft", "observed")}
MARGIN = 5.0  # logits: voxels whose best two classes are further apart keep their class, whatever the biases
STEPS = (0.4, 0.2, 0.1)
FURTHEST = 2.0  # of a bias: beyond, a few voxels of the rarest class would decide
IOU_WEIGHT = 0.5


@torch.no_grad()
def voxels(vae, frames, count):
    """Per kind: logits and truth of the voxels that are in doubt, and the confusion of the others."""
    out = {}
    for kind in KINDS:
        logits, truth, sure = [], [], losses.Confusion()
        for frame in np.linspace(0, len(frames) - 1, min(count, len(frames))).astype(int):
            grid = as_tensor([frames.read(frame, kind)])
            latent = vae.encode(grid) * vae.latent_std + vae.latent_mean
            told = [as_tensor([frames.read(frame, name)]) for name in TOLD[kind]]
            told += [torch.zeros(1, *grid.shape[1:3], dtype=torch.int32)][: 2 - len(told)]
            heard = told if vae.config.hears else None
            found = vae.logits(vae.features(latent.permute(0, 3, 1, 2), heard)).reshape(-1, CLASSES)
            label, top = grid.reshape(-1), found.topk(2, 1).values
            doubt = top[:, 0] - top[:, 1] < MARGIN
            sure.add(label[~doubt], found[~doubt].argmax(1))
            logits.append(found[doubt])
            truth.append(label[doubt])
        out[kind] = torch.cat(logits), torch.cat(truth), sure.counts
    return out


def figures(known, shift):
    """mIoU and IoU of each kind if the biases were shifted so."""
    out = []
    for logits, truth, sure in known.values():
        confusion = losses.Confusion()
        confusion.add(truth, (logits + shift).argmax(1))
        confusion.counts += sure
        out += [confusion.miou(), confusion.iou()]
    return np.array(out)


def search(known):
    """The shift of each bias, by coordinates."""
    weights = np.array([1, IOU_WEIGHT] * len(known))
    shift = torch.zeros(CLASSES)
    best = figures(known, shift) @ weights
    for step in STEPS:
        for c in range(CLASSES):
            for by in (step, -step):
                while True:
                    tried = shift.clone()
                    tried[c] += by
                    score = figures(known, tried) @ weights
                    if score <= best + 1e-6 or abs(tried[c]) > FURTHEST:
                        break
                    shift, best = tried, score
    return shift


def main():
    p = argparse.ArgumentParser(description=__doc__)
    p.add_argument("--vae", required=True)
    p.add_argument("--data", type=Path, required=True)
    p.add_argument("-o", "--output", required=True)
    p.add_argument("--frames", type=int, default=48, help="training frames that are searched on")
    p.add_argument("--threads", type=int, default=2)
    args = p.parse_args()
    torch.set_num_threads(args.threads)
    vae = load_vae(args.vae, torch.device("cpu"))
    held_out = voxels(vae, Frames(args.data / "val"), 64)
    shift = search(voxels(vae, Frames(args.data / "train"), args.frames))
    for name, by in (("as trained", torch.zeros(CLASSES)), ("calibrated", shift)):
        print(f"{name}: held out, complete mIoU/IoU, labels mIoU/IoU", figures(held_out, by).round(4))
    print("shift", [round(x, 2) for x in shift.tolist()])
    with safe_open(args.vae, "pt") as f:
        meta = f.metadata()
    tensors = load_file(args.vae)
    tensors["class_bias"] = tensors["class_bias"].float() + shift
    meta["latents"] = latent_space(args.vae)  # the encoder is the same
    meta["calibrated"] = json.dumps([round(x, 3) for x in shift.tolist()])
    save_file(tensors, args.output, meta)
    log = Path(args.vae).with_suffix(".csv")
    if log.exists():
        shutil.copy(log, Path(args.output).with_suffix(".csv"))


if __name__ == "__main__":
    main()
