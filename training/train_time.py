"""Trains the temporal blocks: python train_time.py --data DIR --vae W.safetensors --dit W.safetensors --minutes M -o OUT.safetensors [--resume]

DIR holds drives (`sceneloom dataset drives`), which are packed first (pack_drives.py). The weights of the single-frame transformer stay. A
sample is a drive of 8 frames, or a window of 16 x 16 of its tokens; of six in ten the first frame or the first two are known, of two in ten any
two, of the rest none: what is known is context, as in inpainting. All frames of a drive have one noise level, each its own noise.
"""
import argparse
import json
import time
from pathlib import Path

import numpy as np
import torch
from safetensors import safe_open
from safetensors.torch import load_file

import losses
from data import draw_given, prefetch
from loop import Run, pick_device
from models.occ_dit import CELLS, NAMED, PATCH, DitConfig, OccDit, condition_of
from models.occ_dit_time import OccDitTime, TimeConfig, warp
from models.occ_vae import latent_space, load_vae
from pack import folder_of
from pack_drives import PackedDrives, pack
from schedule import alpha_bar, ddim_sample
from train_dit import FIRST_OBJECT_LAYER, LAYERS, NO_DRAFT, NO_GROUND, NO_LAYOUT, NO_NUMBER, OBJECT_WEIGHT

SAVE_MINUTES, NOTE_MINUTES = 3.0, 15.0
DENSE, DRAFT, GIVEN = range(3)


def load_dit(path):
    with safe_open(path, "pt") as f:
        config = DitConfig(**json.loads(f.metadata()["config"]))
    model = OccDit(config)
    model.load_state_dict({k: v.float() for k, v in load_file(path).items()})
    return model.requires_grad_(False).eval()


def read_drive(drives, drive, corner, cells, given, known):
    """What is learned from of a drive's frames, and what is heard: target, draft, bev, heading, columns, ground, named (see
    `train_dit.read_batch`), and the vehicle's poses. given [T,cells,cells,2], known [T,3+NAMED]."""
    fine = [slice(PATCH * c * 4, (PATCH * c + cells) * 4) for c in corner]
    coarse = [slice(PATCH * c, PATCH * c + cells) for c in corner]
    latents = torch.from_numpy(drives.array(drive, "latents")[:, :, coarse[0], coarse[1]]).float()
    columns, bev, heading = (torch.from_numpy(np.ascontiguousarray(drives.array(drive, n)[:, fine[0], fine[1]])) for n in ("columns", "bev", "heading"))
    named = torch.from_numpy(np.array(drives.array(drive, "named")))
    with_draft, with_layout, with_ground, numbers = known[:, 0], known[:, 1], known[:, 2], known[:, 3:]
    draft = torch.where(given.prod(-1, keepdim=True) > 0, latents[:, GIVEN], latents[:, DRAFT]) * with_draft[:, None, None, None]
    bev, heading = bev * with_layout[:, None, None].int(), heading * with_layout[:, None, None].to(torch.uint8)
    ground = with_ground[:, None, None].expand(-1, cells, cells)
    return (latents[:, DENSE], draft, bev, heading, columns, ground, torch.cat([named * numbers, numbers, with_draft[:, None]], 1),
            torch.from_numpy(np.array(drives.array(drive, "pose"))))


def draw_known(rng, frames):
    """Which frames are known, [T]."""
    known, u = np.zeros(frames, np.float32), rng.random()
    if u < 0.6:
        known[: rng.integers(1, 3)] = 1
    elif u < 0.8:
        known[rng.choice(frames, 2, replace=False)] = 1
    return known


def draw_batch(drives, rng, batch, cells):
    """A batch at random places, drive after drive: corner [B,2] in tokens, mask [B*T,cells,cells], given, what `read_drive` gives; poses [B,T,3]."""
    out = []
    for _ in range(batch):
        drive = int(rng.integers(len(drives)))
        frames = len(drives.array(drive, "named"))
        corner = rng.integers(0, (CELLS - cells) // PATCH + 1, 2)
        mask = torch.from_numpy(1 - draw_known(rng, frames))[:, None, None].expand(-1, cells, cells)
        window = [slice(PATCH * c, PATCH * c + cells) for c in corner]
        # Whether the background is given is a matter of the place; most often it is not.
        flags = draw_given(rng, 1)[0][window[0], window[1]] * (rng.random() < 0.5)
        given = torch.from_numpy(flags.astype(np.float32)).expand(frames, -1, -1, -1)
        known = torch.from_numpy((rng.random((1, 3 + NAMED)) >= [NO_DRAFT, NO_LAYOUT, NO_GROUND] + [NO_NUMBER] * NAMED).astype(np.float32))
        out.append((torch.from_numpy(corner), mask, given, *read_drive(drives, drive, corner, cells, given, known.expand(frames, -1))))
    corner, *parts, pose = zip(*out)
    return (torch.stack(corner), *(torch.cat(p) for p in parts), torch.stack(pose))


def noised_drives(abar, target, frames, generator=None):
    """`schedule.noised` with one time for all frames of a drive."""
    b = len(target) // frames
    u = (torch.arange(b) + torch.rand(b, generator=generator)) / b
    t = (u * len(abar)).long().clamp(max=len(abar) - 1).repeat_interleave(frames).to(target.device)
    a = abar.to(target.device)[t]
    alpha, sigma = (v.float().view(-1, 1, 1, 1) for v in (a.sqrt(), (1 - a).sqrt()))
    noise = torch.randn(target.shape, generator=generator).to(target.device)
    snr1 = 1 / (1 - a)
    return alpha * target + sigma * noise, t.float(), alpha * noise - sigma * target, (snr1.clamp(max=5.0) / snr1).float()


def heard_of(model, corner, mask, given, target, draft, bev, heading, columns, ground, named, pose):
    """Condition of the frames and the warp between them."""
    frames = pose.shape[1]
    cells = condition_of(mask, target * (1 - mask[..., None]), draft, bev, heading, given, columns, ground)
    side = mask.shape[1] // PATCH
    warped = [v.to(mask.device) for v in warp(pose.cpu(), None if corner is None else corner.cpu(), side, same_cell=model.config.same_cell)]
    return model.base.condition(cells, named, None if corner is None else corner.repeat_interleave(frames, 0)), warped


def time_loss(model, abar, corner, mask, given, target, draft, bev, heading, columns, ground, named, pose, generator=None):
    """As `dit_loss`; returns the loss and the mean square error of v where frames are not known."""
    noisy, t, truth, balance = noised_drives(abar, target, pose.shape[1], generator)
    condition, warped = heard_of(model, corner, mask, given, target, draft, bev, heading, columns, ground, named, pose)
    error = ((model(noisy, t, condition, warped) - truth) ** 2).mean(-1)
    objects = (bev >> FIRST_OBJECT_LAYER) & ((1 << (LAYERS - FIRST_OBJECT_LAYER)) - 1)
    objects = torch.nn.functional.max_pool2d((objects != 0).float()[:, None], 4)[:, 0]
    weight = (mask + 0.1 * (1 - mask)) * (1 + OBJECT_WEIGHT * objects)
    plain = (error * mask).sum() / mask.sum().clamp(min=1)
    error = (error * weight).sum((1, 2)) / weight.sum((1, 2))
    return (error * balance).mean(), plain.item()


@torch.no_grad()
def figures(model, vae, abar, drives, count, sample, steps=12):
    """Held-out error of v with the first two frames known and no background given, with the blocks and (`_still`) without them; agreement of
    forecast frames with the truth at 1, 2 and 3 s, both ways."""
    out, blocks = {}, model.blocks
    for ending, kept in (("", blocks), ("_still", blocks[:0])):
        model.blocks, errors = kept, []
        for drive in range(min(count, len(drives))):
            frames = len(drives.array(drive, "named"))
            mask = torch.ones(frames, CELLS, CELLS)
            mask[:2] = 0
            given, known = torch.zeros(frames, CELLS, CELLS, 2), torch.ones(frames, 3 + NAMED)
            *parts, pose = read_drive(drives, drive, (0, 0), CELLS, given, known)
            for k in range(2):
                generator = torch.Generator().manual_seed(1 + 100 * k + drive)
                errors.append(time_loss(model, abar, None, mask, given, *parts, pose[None], generator)[1])
            if drive < sample:
                condition, warped = heard_of(model, None, mask, given, *parts, pose[None])
                noise = torch.randn(parts[0].shape, generator=torch.Generator().manual_seed(drive))
                found = vae.decode(ddim_sample(lambda x, t: model(x, t, condition, warped), noise, steps))
                truth = vae.decode(parts[0])
                for at, frame in ((1, 3), (2, 5), (3, 7)):
                    for kind, of in (("miou", True), ("iou", False)):
                        made = losses.Confusion()
                        made.add(truth[frame : frame + 1], found[frame : frame + 1])
                        key = f"{kind}_{at}s{ending}"
                        out.setdefault(key, []).append(made.miou() if of else made.iou())
        out[f"v{ending}"] = [float(np.mean(errors))]
    model.blocks = blocks
    return {k: float(np.mean(v)) for k, v in out.items()}


def train(args, device, dtype):
    pack(args.data, args.vae, device, dtype)
    name, abar, vae = latent_space(args.vae), alpha_bar(), load_vae(args.vae, device)
    drives, held_out = (PackedDrives(folder_of(args.data, name, part)) for part in ("train", "val"))
    base = load_dit(args.dit).to(device)
    config = TimeConfig(width=base.config.width, heads=base.config.heads, blocks=base.config.depth // 2, same_cell=args.same_cell)
    model = OccDitTime(base, config).to(device)
    if args.init:
        model.load_state_dict({k: v.float() for k, v in load_file(args.init).items()})
    run = Run(model, args, lr=args.lr, betas=(0.9, 0.98), weight_decay=0.01, ema=0.999, warmup=100)
    if run.done():
        return print(f"{args.output} is done")
    rng = np.random.default_rng([args.seed, run.step])
    meta = {"kind": "occ_dit_time", "config": json.dumps(config.as_dict()), "seed": args.seed, "vae": name, "drives": len(drives)}
    mean, noted, samples, since = None, run.elapsed(), 0, time.monotonic()

    def note(sample):
        run.note(figures(run.ema, vae, abar, held_out, args.held_out, sample) | {"train_v": mean or 0.0, "per_s": samples / (time.monotonic() - since)})
        run.save(meta)

    for whole, batch, cells in ((False, args.batch, 2 * args.window), (True, max(1, args.batch // 2), CELLS)):
        def over():
            return run.done() or (not whole and run.elapsed() >= args.minutes * (1 - args.whole))

        if over():
            continue
        for parts in prefetch(lambda: draw_batch(drives, rng, batch, cells)):
            with torch.autocast(device.type, dtype, enabled=dtype is not None):
                loss, error = time_loss(model, abar, *(p.to(device) for p in parts))
            run.update(loss, batch)
            samples += batch
            mean = error if mean is None else mean * 0.99 + error * 0.01
            if run.step % 50 == 0:
                print(f"step {run.step} {run.elapsed():.1f} min {samples / (time.monotonic() - since):.2f}/s v {mean:.4f}", flush=True)
            if over():
                break
            if run.elapsed() - noted > NOTE_MINUTES:
                note(args.sample)
                noted, samples, since = run.elapsed(), 0, time.monotonic()
            elif run.elapsed() - run.saved_at > SAVE_MINUTES:
                run.save(meta)
    note(args.sample)


def main():
    p = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    p.add_argument("--data", type=Path, required=True, help="folder with train/ and val/ drives")
    p.add_argument("--vae", required=True)
    p.add_argument("--dit", required=True, help="weights of the single-frame transformer")
    p.add_argument("--minutes", type=float, required=True, help="wall-clock budget, earlier runs included when resuming")
    p.add_argument("-o", "--output", required=True)
    p.add_argument("--init", help="temporal weights to begin with")
    p.add_argument("--same-cell", action="store_true", help="keys from the same cell of each frame, as UniScene does")
    p.add_argument("--batch", type=int, default=4, help="windows of a step; whole frames are half as many")
    p.add_argument("--window", type=int, default=16, help="tokens of a window's side")
    p.add_argument("--whole", type=float, default=0.3)
    p.add_argument("--lr", type=float, default=1e-3)
    p.add_argument("--optimizer", choices=["muon", "adamw"], default="muon")
    p.add_argument("--held-out", type=int, default=12)
    p.add_argument("--sample", type=int, default=3)
    p.add_argument("--seed", type=int, default=0)
    p.add_argument("--threads", type=int, default=2)
    p.add_argument("--resume", action="store_true")
    args = p.parse_args()
    torch.manual_seed(args.seed)
    train(args, *pick_device(args.threads))


if __name__ == "__main__":
    main()
