"""Trains the occupancy VAE: python train_vae.py --data DIR --minutes M -o W.safetensors [--resume]. See README.md."""
import argparse
import json
import time
from pathlib import Path

import numpy as np
import torch
from safetensors.torch import load_file

import losses
from data import FREE, Frames, Places, Streamed, as_tensor, leaned, prefetch, turned
from loop import Run, pick_device
from models.occ_vae import OccVae, VaeConfig, latent_space, load_vae
from models.triplane_vae import TriplaneVae

ZERO_AT_FIRST = ("conv2.weight", "conv2.bias", "observed.weight", "drafted.weight")
SAVE_MINUTES, NOTE_MINUTES = 3.0, 5.0
# Shares of the crops whose decoder hears a draft, of those with the background in it, of label crops where it hears what was observed.
DRAFTED, GIVEN, MASKED = 0.75, 0.6, 0.5


def begin_with(model, path):
    """Takes over the weights of a smaller network: parts that it lacks begin as nothing (their last layer is zero)."""
    found = {k: v.float() for k, v in load_file(path).items()}
    state = model.state_dict()
    for name, tensor in state.items():
        old = found.get(name)
        if old is None:
            if name.endswith(ZERO_AT_FIRST):
                tensor.zero_()
        elif old.shape == tensor.shape:
            tensor.copy_(old)
        else:
            raise SystemExit(f"{path}: {name} is {tuple(old.shape)}, expected {tuple(tensor.shape)}")
    model.load_state_dict(state)


@torch.no_grad()
def measure_latents(vae, frames, device, count=48):
    """Sets the mean and spread of each latent channel over `count` frames (complete, labels, drafts)."""
    total, square, n = 0.0, 0.0, 0
    pick = np.linspace(0, len(frames) - 1, min(count, len(frames))).astype(int)
    for i, frame in enumerate(pick):
        grid = as_tensor([frames.read(frame, ("dense", "dense", "labels", "draft")[i % 4])]).to(device)
        mean = vae.moments(grid)[0].double().cpu()
        total, square, n = total + mean.sum((0, 2, 3)), square + (mean**2).sum((0, 2, 3)), n + mean[:, 0].numel()
    mean = total / n
    vae.latent_mean.copy_(mean)
    vae.latent_std.copy_((square / n - mean**2).clamp(min=1e-8).sqrt())


@torch.no_grad()
def vae_figures(vae, frames, device, count):
    out = {}
    for name, kind in [(k + e, k) for e in ("", "_told")[: 1 + vae.config.hears] for k in ("dense", "labels")]:
        confusion = losses.Confusion()
        for frame in range(min(count, len(frames))):
            grid, *told = (as_tensor([frames.read(frame, n)]).to(device) for n in (kind, "given", "observed"))
            if kind != "labels":
                told[1] = torch.zeros_like(told[1])
            confusion.add(grid, vae.decode(vae.encode(grid), told if name.endswith("_told") else None))
        out |= {f"{name}_miou": confusion.miou(), f"{name}_iou": confusion.iou()}
        out_per_class = confusion.per_class()
        print(f"  {name} per class " + " ".join(f"{x:.2f}" for x in out_per_class.tolist()), flush=True)
    return out


def frames_of(args):
    """(training, held out)."""
    return Streamed(args.stream) if args.stream else Frames(args.data / "train"), Frames(args.data / "val")


def train(args, device, dtype):
    frames, held_out = frames_of(args)
    config = VaeConfig.fine() if args.fine else VaeConfig()
    config.hears = args.hears
    if args.kernels:
        config.encoder_kernels, config.decoder_kernels = json.loads(args.kernels)
    model = (TriplaneVae if args.triplane else OccVae)(config).to(device, memory_format=torch.channels_last)
    if args.init:
        begin_with(model, args.init)
    anchor = load_vae(args.anchor, device) if args.anchor else None
    if args.decoder_of:
        begin_with(model, args.decoder_of)
        for part in (model.embed, model.encoder, model.down, model.encoder_norm, model.encoder_head):
            part.requires_grad_(False)
    run = Run(model, args, lr=args.lr or 2e-3, betas=(0.9, 0.98), weight_decay=0.01, ema=0.998, warmup=100)
    if run.done():
        return print(f"{args.output} is done")
    rng = np.random.default_rng([args.seed, run.step])
    kinds, places = ("dense", "labels", "draft"), Places(frames)

    def make():
        crops = []
        for k in rng.choice(3, args.batch, p=args.mix):
            kind, symmetry, lean = kinds[k], rng.integers(8), rng.random() < args.leaned
            told = args.hears and kind != "draft" and not lean
            drafted, masked = told and rng.random() < DRAFTED, told and kind == "labels" and rng.random() < MASKED
            draft = "given" if rng.random() < GIVEN else "draft"
            crop = places.crop(rng, (kind, draft, "observed") if told else (kind,), args.crop, args.anywhere)
            grid, *heard = (turned(part, symmetry) for part in crop)
            heard = [heard[0] if drafted else np.full_like(grid, FREE), heard[1] if masked else np.zeros(grid.shape[:2], np.int32)]
            crops.append((leaned(rng, grid) if lean else grid, *heard))
        return tuple(as_tensor(list(part)) for part in zip(*crops))

    meta = {"kind": "triplane_vae" if args.triplane else "occ_vae", "config": json.dumps(model.config.as_dict()), "seed": args.seed, "data": args.data}
    if args.decoder_of:
        meta["latents"] = latent_space(args.decoder_of)
    mean, noted, since = {}, time.monotonic(), (run.samples, time.monotonic())

    def note():
        if not args.decoder_of:
            measure_latents(run.ema, frames, device)
        rate = (run.samples - since[0]) / (time.monotonic() - since[1])
        run.note(vae_figures(run.ema, held_out, device, args.held_out) | mean | {"per_s": rate})
        run.save(meta)

    for grid, *heard in prefetch(make):
        model.train()
        with torch.autocast(device.type, dtype, enabled=dtype is not None):
            loss, parts = losses.vae_loss(model, grid.to(device), [h.to(device) for h in heard] if args.hears else None, latent_noise=args.latent_noise, anchor=anchor)
        run.update(loss, len(grid))
        mean = {k: mean.get(k, v) * 0.95 + v * 0.05 for k, v in parts.items()}
        if run.step % 50 == 0:
            places.add(frames.rescan())
            rate = (run.samples - since[0]) / (time.monotonic() - since[1])
            print(f"step {run.step} {run.elapsed():.1f} min {rate:.2f}/s " + " ".join(f"{k} {v:.4f}" for k, v in mean.items()), flush=True)
        if run.done():
            break
        if time.monotonic() - noted > 60 * NOTE_MINUTES:
            note()
            noted, since = time.monotonic(), (run.samples, time.monotonic())
        elif run.elapsed() - run.saved_at > SAVE_MINUTES:
            if not args.decoder_of:
                measure_latents(run.ema, frames, device)
            run.save(meta)
    note()


def main():
    p = argparse.ArgumentParser(description=__doc__)
    p.add_argument("--data", type=Path, required=True, help="folder with train/ and val/ shards")
    p.add_argument("--stream", help="command that writes training frames to its output, such as `sceneloom-worlds --frames 65536 --stream`, instead of DIR/train")
    p.add_argument("--minutes", type=float, required=True, help="wall-clock budget, earlier runs included when resuming")
    p.add_argument("-o", "--output", required=True, help="f32 weights; .checkpoint.pt and .csv are written beside it")
    p.add_argument("--init", help="weights of a network of the same kind to begin with; it may lack blocks and inputs")
    p.add_argument("--fine", action="store_true", help="latents of 100x100x16 instead of 50x50x8")
    p.add_argument("--triplane", action="store_true", help="three planes for a latent, to compare (models/triplane_vae.py); crops of whole frames")
    p.add_argument("--latent-noise", type=float, default=0.01, help="mean of the noise on latents in training, in their spread")
    p.add_argument("--kernels", help="JSON: kernels of the encoder's and the decoder's blocks, level by level, as in VaeConfig")
    p.add_argument("--anchor", help="weights of a VAE near whose latents these stay, so that its DiT needs little training on them")
    p.add_argument("--decoder-of", help="weights of a VAE whose decoder alone is trained on: its latents stay")
    p.add_argument("--mix", type=float, nargs=3, default=(0.6, 0.25, 0.15), help="shares of complete worlds, labels, drafts")
    p.add_argument("--resume", action="store_true")
    p.add_argument("--seed", type=int, default=0)
    p.add_argument("--threads", type=int, default=2)
    p.add_argument("--batch", type=int, default=16, help="crops per step")
    p.add_argument("--crop", type=int, default=64, help="voxels along a side of a crop")
    p.add_argument("--anywhere", type=float, default=0.35, help="share of crops that are not drawn around objects")
    p.add_argument("--leaned", type=float, default=0.25, help="share of crops that are put on other ground")
    p.add_argument("--lr", type=float)
    p.add_argument("--optimizer", choices=["muon", "adamw"], default="muon")
    p.add_argument("--held-out", type=int, default=8, help="frames of the held-out figures")
    p.add_argument("--hears", action="store_true", help="the decoder hears the draft of the layout, and which voxels of labels were observed")
    args = p.parse_args()
    torch.manual_seed(args.seed)
    device, dtype = pick_device(args.threads)
    print(f"device {device}, {'f32' if dtype is None else dtype}, {args.threads} threads", flush=True)
    train(args, device, dtype)


if __name__ == "__main__":
    main()
