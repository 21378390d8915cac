"""Trains one network: python train.py vae|dit --data DIR --minutes M -o W.safetensors [--resume]. See README.md."""
import argparse
import json
import time
from pathlib import Path

import numpy as np
import torch
from safetensors import safe_open
from safetensors.torch import load_file

import losses
from data import Frames, Places, Streamed, as_tensor, draw_given, draw_masks, leaned, named, prefetch, turned, turned_heading
from latents import LatentCache, latent_space
from loop import Run, pick_device
from models.occ_dit import NAMED, PATCH, DitConfig, OccDit, cell_headings, unshuffle_layout
from models.occ_vae import OccVae, VaeConfig
from schedule import STEPS, alpha_bar, ddim_sample

ZERO_AT_FIRST = ("conv2.weight", "conv2.bias", "named2.weight", "named2.bias", "skip_given.weight", "skip_given.bias")
SAVE_MINUTES, NOTE_MINUTES = 3.0, 5.0
FIRST_OBJECT_LAYER, OBJECT_WEIGHT = 8, 2.0  # the ten object layers follow eight map layers


def load_vae(path, device):
    with safe_open(path, "pt") as f:
        config = VaeConfig(**json.loads(f.metadata()["config"]))
    vae = OccVae(config)
    vae.load_state_dict({k: v.float() for k, v in load_file(path).items()})
    return vae.to(device, memory_format=torch.channels_last).eval().requires_grad_(False)


def begin_with(model, path):
    """Takes over the weights of a smaller network of the same kind: blocks that it lacks begin as nothing (their last
    layer is zero), inputs that it lacks begin unheard (zero columns at the end of each cell's channels)."""
    found = {k: v.float() for k, v in load_file(path).items()}
    state = model.state_dict()
    for name, tensor in state.items():
        old = found.get(name)
        if old is None:
            if name.endswith(ZERO_AT_FIRST):
                tensor.zero_()
        elif old.shape == tensor.shape:
            tensor.copy_(old)
        elif name != "embed_condition.weight" or len(old) != len(tensor):
            raise SystemExit(f"{path}: {name} is {tuple(old.shape)}, expected {tuple(tensor.shape)}")
        else:
            a, b = tensor.view(len(tensor), PATCH * PATCH, -1), old.view(len(old), PATCH * PATCH, -1)
            a.zero_()
            a[..., : b.shape[-1]] = b
    model.load_state_dict(state)


# ---- VAE ----


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
    for kind in ("dense", "labels"):
        confusion, loss = losses.Confusion(), 0.0
        for frame in range(min(count, len(frames))):
            grid = as_tensor([frames.read(frame, kind)]).to(device)
            confusion.add(grid, vae.decode(vae.encode(grid)))
            loss += losses.vae_loss(vae, grid)[0].item()
        out |= {f"{kind}_loss": loss / min(count, len(frames)), f"{kind}_miou": confusion.miou(), f"{kind}_iou": confusion.iou()}
        out_per_class = confusion.per_class()
        print(f"  {kind} per class " + " ".join(f"{x:.2f}" for x in out_per_class.tolist()), flush=True)
    return out


def frames_of(args):
    """(training, held out)."""
    return Streamed(args.stream) if args.stream else Frames(args.data / "train"), Frames(args.data / "val")


def train_vae(args, device, dtype):
    train, held_out = frames_of(args)
    config = VaeConfig.fine() if args.fine else VaeConfig()
    if args.kernels:
        config.encoder_kernels, config.decoder_kernels = json.loads(args.kernels)
    model = OccVae(config).to(device, memory_format=torch.channels_last)
    if args.init:
        begin_with(model, args.init)
    anchor = load_vae(args.anchor, device) if args.anchor else None
    if args.decoder_of:
        model.load_state_dict(load_vae(args.decoder_of, device).state_dict())
        for part in (model.embed, model.encoder, model.encoder_norm, model.encoder_head):
            part.requires_grad_(False)
    run = Run(model, args, lr=args.lr or 2e-3, betas=(0.9, 0.98), weight_decay=0.01, ema=0.998, warmup=100)
    rng = np.random.default_rng([args.seed, run.step])
    kinds, places = ("dense", "labels", "draft"), Places(train)

    def make():
        kind = [kinds[k] for k in rng.choice(3, args.batch, p=args.mix)]
        crops = [turned(places.crop(rng, k, args.crop, args.anywhere), rng.integers(8)) for k in kind]
        return as_tensor([leaned(rng, c) if rng.random() < args.leaned else c for c in crops])

    meta = {"kind": "occ_vae", "config": json.dumps(model.config.as_dict()), "seed": args.seed, "data": args.data}
    if args.decoder_of:
        meta["latents"] = latent_space(args.decoder_of)
    mean, noted, since = {}, time.monotonic(), (run.samples, time.monotonic())

    def note():
        if not args.decoder_of:
            measure_latents(run.ema, train, device)
        rate = (run.samples - since[0]) / (time.monotonic() - since[1])
        run.note(vae_figures(run.ema, held_out, device, args.held_out) | mean | {"per_s": rate})
        run.save(meta)

    for grid in prefetch(make):
        model.train()
        with torch.autocast(device.type, dtype, enabled=dtype is not None):
            loss, parts = losses.vae_loss(model, grid.to(device), latent_noise=args.latent_noise, anchor=anchor)
        run.update(loss, len(grid))
        mean = {k: mean.get(k, v) * 0.95 + v * 0.05 for k, v in parts.items()}
        if run.step % 50 == 0:
            places.add(train.rescan())
            rate = (run.samples - since[0]) / (time.monotonic() - since[1])
            print(f"step {run.step} {run.elapsed():.1f} min {rate:.2f}/s " + " ".join(f"{k} {v:.4f}" for k, v in mean.items()), flush=True)
        if run.done():
            break
        if time.monotonic() - noted > 60 * NOTE_MINUTES:
            note()
            noted, since = time.monotonic(), (run.samples, time.monotonic())
        elif run.elapsed() - run.saved_at > SAVE_MINUTES:
            if not args.decoder_of:
                measure_latents(run.ema, train, device)
            run.save(meta)
    note()


# ---- DiT ----


def dit_loss(model, abar, target, condition_parts, mask, generator):
    """v-prediction, weight min(SNR + 1, 5) in x0 space (2303.09556, finite at SNR 0); generated cells count fully, those
    with objects more (they are few, and what a user looks at), kept cells a tenth: at inference they are replayed."""
    b = len(target)
    # Stratified over the batch: less noise in the loss than independent draws.
    u = (torch.arange(b) + torch.rand(b, generator=generator)) / b
    t = (u * STEPS).long().clamp(max=STEPS - 1).to(target.device)
    a = abar[t].to(target.device)
    alpha, sigma = a.sqrt().float().view(b, 1, 1, 1), (1 - a).sqrt().float().view(b, 1, 1, 1)
    noise = torch.randn(target.shape, generator=generator).to(target.device)
    v = model(alpha * target + sigma * noise, t.float(), model.condition(mask, *condition_parts))
    error = ((v - (alpha * noise - sigma * target)) ** 2).mean(-1)
    layers = condition_parts[2].view(b, 50, 50, 16, 18)
    objects = layers[..., FIRST_OBJECT_LAYER:].amax((3, 4))
    cell = (mask + 0.1 * (1 - mask)) * (1 + OBJECT_WEIGHT * objects)
    error = (error * cell).sum((1, 2)) / cell.sum((1, 2))
    snr1 = 1 / (1 - a)  # SNR + 1
    return (error * (snr1.clamp(max=5.0) / snr1).float()).mean(), error.detach().mean().item()


def conditions(frames, picks):
    """Layout [B,50,50,288], headings [B,50,50,2] and named numbers [B,8] of (frame, symmetry, target) each."""
    bev = as_tensor([turned(frames.read(i, "bev"), s) for i, s, _ in picks])
    heading = as_tensor([turned_heading(frames.read(i, "heading"), s) for i, s, _ in picks])
    values = torch.tensor([named(frames.read(i, kind), frames.read(i, "bev")) for i, _, kind in picks])
    return unshuffle_layout(bev), cell_headings(heading), torch.cat([values, torch.ones_like(values)], 1)


@torch.no_grad()
def dit_figures(model, vae, abar, cache, frames, device, count, sample):
    """Held-out v error, and agreement of a few samples with their worlds, without and with the background given."""
    count = min(count, len(frames))
    masks = torch.from_numpy(draw_masks(np.random.default_rng(1), count))
    layout, heading, told = (x.to(device) for x in conditions(frames, [(i, 0, "dense") for i in range(count)]))
    out = {}
    for ending, flag in (("", 0.0), ("_given", 1.0)):
        given, generator, total = torch.full((count, 50, 50, 1), flag), torch.Generator().manual_seed(1), 0.0
        target, draft = cache.batch(range(count), [0] * count, ["dense"] * count, given)
        given = given.to(device)
        for part in torch.arange(count).split(8):
            mask = masks[part].to(device)
            parts = (target[part] * (1 - mask[..., None]), draft[part], layout[part], heading[part], told[part], given[part])
            # Four passes over the noise levels: one has too much noise of its own.
            total += sum(dit_loss(model, abar, target[part], parts, mask, generator)[1] for _ in range(4)) / 4 * len(part)
        out |= {f"held_out_v{ending}": total / count, f"miou{ending}": 0.0, f"iou{ending}": 0.0}
        if sample:
            n = min(sample, count)
            ones, zeros = torch.ones(n, 50, 50, device=device), torch.zeros_like(target[:n])
            condition = model.condition(ones, zeros, draft[:n], layout[:n], heading[:n], told[:n], given[:n])
            noise = torch.randn(target[:n].shape, generator=generator).to(device)
            found = vae.decode(ddim_sample(lambda x, t: model(x, t, condition), noise, 20))
            truth, made = as_tensor([frames.read(i, "dense") for i in range(n)]), losses.Confusion()
            made.add(truth, found.cpu())
            out |= {f"miou{ending}": made.miou(), f"iou{ending}": made.iou()}
            print(f"  generated{ending} per class " + " ".join(f"{x:.2f}" for x in made.per_class().tolist()), flush=True)
    return out


def train_dit(args, device, dtype):
    train, held_out = frames_of(args)
    vae, abar = load_vae(args.vae, device), alpha_bar()
    name = latent_space(args.vae)
    cache, held_cache = (LatentCache(f, vae, args.data / f"latents-{name}", device, dtype) for f in (train, held_out))
    model = OccDit(DitConfig(width=args.width, depth=args.depth, given=True)).to(device)
    if args.init:
        begin_with(model, args.init)
    run = Run(model, args, lr=args.lr or 1e-3, betas=(0.9, 0.98), weight_decay=0.01, ema=0.9995, warmup=100)
    rng = np.random.default_rng([args.seed, run.step])

    def make():
        kinds = np.where(rng.random(args.batch) < args.labels, "labels", "dense")
        pick = [(train.at(int(rng.integers(len(train)))), int(rng.choice(args.symmetries)), str(k)) for k in kinds]
        layout, heading, told = conditions(train, pick)
        # Guidance needs samples without any condition; a designer may name some numbers and not others.
        drop = torch.from_numpy(rng.random(args.batch) < 0.1)
        known = torch.from_numpy(rng.random((args.batch, NAMED)) < 0.7) & ~drop[:, None]
        told = told * torch.cat([known, known], 1)
        given = torch.from_numpy(draw_given(rng, args.batch)) * ~drop[:, None, None, None]
        return pick, layout, heading, told, given, torch.from_numpy(draw_masks(rng, args.batch)), drop

    meta = {"kind": "occ_dit", "config": json.dumps(model.config.as_dict()), "seed": args.seed, "data": args.data, "vae": name}
    mean, noted, since = 0.0, time.monotonic(), (run.samples, time.monotonic())
    sampled = time.monotonic()

    def note(last=False):
        nonlocal sampled
        sample = 8 if last else 4 if time.monotonic() - sampled > 60 * 15 else 0
        sampled = time.monotonic() if sample else sampled
        rate = (run.samples - since[0]) / (time.monotonic() - since[1])
        figures = dit_figures(run.ema, vae, abar, held_cache, held_out, device, args.held_out, sample)
        run.note(figures | {"train_v": mean, "per_s": rate})
        run.save(meta)

    for pick, layout, heading, told, given, mask, drop in prefetch(make):
        target, draft = cache.batch(*zip(*pick), given)
        layout, heading, told, given, mask = (x.to(device) for x in (layout, heading, told, given, mask))
        keep = (~drop).to(device).float().view(-1, 1, 1, 1)
        parts = (target * (1 - mask[..., None]), draft * keep, layout * keep, heading * keep, told, given)
        with torch.autocast(device.type, dtype, enabled=dtype is not None):
            loss, v = dit_loss(model, abar, target, parts, mask, None)
        run.update(loss, len(pick))
        mean = mean * 0.98 + v * 0.02 if mean else v
        if run.step % 50 == 0:
            train.rescan()
            rate = (run.samples - since[0]) / (time.monotonic() - since[1])
            print(f"step {run.step} {run.elapsed():.1f} min {rate:.2f}/s v {mean:.4f}", flush=True)
        if run.done():
            break
        if time.monotonic() - noted > 60 * NOTE_MINUTES:
            note()
            noted, since = time.monotonic(), (run.samples, time.monotonic())
        elif run.elapsed() - run.saved_at > SAVE_MINUTES:
            run.save(meta)
    note(last=True)


def main():
    p = argparse.ArgumentParser(description=__doc__)
    p.add_argument("kind", choices=["vae", "dit"])
    p.add_argument("--data", type=Path, required=True, help="folder with train/ and val/ shards")
    p.add_argument("--stream", help="command that writes training frames to its output, such as `sceneloom-worlds --frames 65536 --stream`, instead of DIR/train")
    p.add_argument("--minutes", type=float, required=True, help="wall-clock budget, earlier runs included when resuming")
    p.add_argument("-o", "--output", required=True, help="f32 weights; .checkpoint.pt and .csv are written beside it")
    p.add_argument("--vae", help="weights of the VAE (dit only)")
    p.add_argument("--init", help="weights of a network of the same kind to begin with; it may lack blocks and inputs")
    p.add_argument("--fine", action="store_true", help="latents of 100x100x16 instead of 50x50x8 (vae only)")
    p.add_argument("--latent-noise", type=float, default=0.01, help="noise on latents in training, in their spread (vae only)")
    p.add_argument("--kernels", help="JSON: kernels of the encoder's and the decoder's blocks, level by level, as in VaeConfig (vae only)")
    p.add_argument("--anchor", help="weights of a VAE near whose latents these stay, so that its DiT needs little training on them (vae only)")
    p.add_argument("--decoder-of", help="weights of a VAE whose decoder alone is trained on: its latents stay (vae only)")
    p.add_argument("--mix", type=float, nargs=3, default=(0.6, 0.25, 0.15), help="shares of complete worlds, labels, drafts (vae only)")
    p.add_argument("--resume", action="store_true")
    p.add_argument("--seed", type=int, default=0)
    p.add_argument("--threads", type=int, default=2)
    p.add_argument("--batch", type=int, help="crops (vae, 16) or frames (dit, 8) per step")
    p.add_argument("--crop", type=int, default=64, help="voxels along a side of a crop (vae only)")
    p.add_argument("--anywhere", type=float, default=0.35, help="share of crops that are not drawn around objects (vae only)")
    p.add_argument("--leaned", type=float, default=0.25, help="share of crops that are put on other ground (vae only)")
    p.add_argument("--lr", type=float)
    p.add_argument("--optimizer", choices=["muon", "adamw"], default="muon")
    p.add_argument("--width", type=int, help="channels of a token (dit only)")
    p.add_argument("--depth", type=int, default=8)
    p.add_argument("--held-out", type=int, help="frames of the held-out figures")
    p.add_argument("--labels", type=float, default=0.25, help="share of samples whose target is labels, not a complete world (dit only)")
    p.add_argument("--symmetries", type=int, nargs="+", default=[0, 2], help="of the 8, those whose latents are cached (dit only)")
    args = p.parse_args()
    torch.manual_seed(args.seed)
    device, dtype = pick_device(args.threads)
    print(f"device {device}, {'f32' if dtype is None else dtype}, {args.threads} threads", flush=True)
    if args.kind == "vae":
        args.held_out, args.batch = args.held_out or 8, args.batch or 16
        train_vae(args, device, dtype)
    else:
        if not args.vae:
            p.error("dit needs --vae")
        args.width, args.held_out, args.batch = args.width or 256, args.held_out or 24, args.batch or 8
        train_dit(args, device, dtype)


if __name__ == "__main__":
    main()
