"""Figures and sheets of held-out frames: what the pictures show against what was asked for, between neighbours and from one moment to the next."""
import colorsys

import numpy as np
import torch
from torch.nn import functional as F

from models.picture_dit import seen_then
from models.segmenter import CLASSES, OUTSIDE
from picture_data import as_bytes, as_pictures
from schedule import alpha_bar, ddim_timesteps

PIECE = 8  # frames that are drawn at once


@torch.no_grad()
def sample(trainer, part, noise, before=None):
    """DDIM, eta 0, from noise [B,6,h,w,C] -> latents; `before` are the latents of the frame before, if any. With guidance w the network is asked once
    more, told nothing of pixels and of the frame before, and goes w times as far from that answer to the other."""
    model, n, guidance = trainer.dit.ema, trainer.args.sampling, trainer.args.guidance
    abar, steps, x = alpha_bar(), ddim_timesteps(n), noise
    with trainer.amp():
        told = trainer.condition(model, part)
        silent = trainer.condition(model, part, hears=False) if guidance != 1 else None
        heard = None if before is None else trainer.warped(part, before)
        for i, t in enumerate(steps):
            a = abar[t].item()
            b = abar[steps[i + 1]].item() if i + 1 < n else 1.0
            times = torch.full((len(x),), float(t), device=x.device)
            v = model(x, times, told, heard)
            if silent is not None:
                v = v.lerp(model(x, times, silent, None), 1 - guidance)
            x0, eps = a**0.5 * x - (1 - a) ** 0.5 * v, (1 - a) ** 0.5 * x + a**0.5 * v
            x = b**0.5 * x0 + (1 - b) ** 0.5 * eps
    return x


@torch.no_grad()
def drawn(trainer, latent):
    """[B,6,h,w,C] -> pictures [B,6,3,8h,8w]."""
    with trainer.amp():
        return trainer.vae.ema.decode(latent.flatten(0, 1)).view(*latent.shape[:2], 3, latent.shape[2] * 8, latent.shape[3] * 8)


def psnr(a, b):
    """Of pictures -1 to 1, mean over pictures, dB."""
    return (-10 * ((a - b) / 2).square().flatten(-3).mean(-1).clamp(min=1e-9).log10()).mean().item()


class Agreement:
    """What the segmenter sees in pictures against what they should show."""

    def __init__(self, device):
        self.table = torch.zeros(CLASSES, CLASSES, device=device, dtype=torch.float64)

    def add(self, trainer, pictures, shown):
        """pictures [B,6,3,h,w], shown u8 [B,6,h,w]."""
        with torch.no_grad(), trainer.amp():
            found = trainer.seg.ema(pictures.flatten(0, 1)).argmax(1)
        wanted = shown.flatten(0, 1).long()
        valid = wanted != OUTSIDE
        index = wanted[valid] * CLASSES + found[valid]
        self.table += torch.bincount(index, minlength=CLASSES**2).view(CLASSES, CLASSES)

    def figures(self):
        hit, wanted, found = self.table.diagonal(), self.table.sum(1), self.table.sum(0)
        there = wanted > 0
        iou = hit / (wanted + found - hit).clamp(min=1)
        vehicle = [3, 4, 5, 9, 10]
        inside = self.table[vehicle][:, vehicle].sum()
        union = wanted[vehicle].sum() + found[vehicle].sum() - inside
        return {"pixels": round((hit.sum() / wanted.sum()).item(), 4), "miou": round(iou[there].mean().item(), 4), "classes": int(there.sum()),
                "vehicles": round((inside / union.clamp(min=1)).item(), 4), "lane_divider": round(iou[19].item(), 4)}


def pixel_warp(pictures, depth_m, depth_other_m, intrinsic, intrinsic_other, way):
    """Pictures [N,3,h,w] of other cameras (or moments) as seen from these, and where they can be compared [N,h,w]."""
    n, _, h, w = pictures.shape
    scaled = torch.linalg.inv(intrinsic)
    v, u = torch.meshgrid(torch.arange(h, device=depth_m.device) + 0.5, torch.arange(w, device=depth_m.device) + 0.5, indexing="ij")
    rays = torch.stack([u, v, torch.ones_like(u)], -1) @ scaled[:, None].transpose(-1, -2)
    p = rays * depth_m[..., None] @ way[:, None, :3, :3].transpose(-1, -2) + way[:, None, None, :3, 3]
    z = p[..., 2].clamp(min=0.1)
    q = p @ intrinsic_other[:, None].transpose(-1, -2)
    grid = torch.stack([q[..., 0] / z / w * 2 - 1, q[..., 1] / z / h * 2 - 1], -1)
    moved = F.grid_sample(pictures, grid, align_corners=False)
    depth_there = F.grid_sample(depth_other_m[:, None], grid, mode="nearest", align_corners=False)[:, 0]
    near = (depth_there / z - 1).abs() < 0.05
    return moved, (grid.abs() < 1).all(-1) & (depth_m > 0) & near & (p[..., 2] > 0.1)


def gap_where(a, b, where):
    """Sum of absolute differences and their number: [N,3,h,w] twice, bool [N,h,w]."""
    return torch.stack([((a - b).abs().mean(1) * where).sum() / 2, where.sum()]).double()


def over_time(part, now, before):
    """Differences between pictures [B,6,3,h,w] and those of the moment before, brought to the same places."""
    flat = [x.flatten(0, 1) for x in (part["depth_m"], part["depth_before_m"], part["intrinsic"], part["intrinsic"], part["way"])]
    moved, where = pixel_warp(before.flatten(0, 1), *flat)
    return gap_where(now.flatten(0, 1), moved, where)


def across_views(part, pictures):
    """Differences between neighbours in the ring where both see the same surface."""
    pose = part["pose"].double()
    way = (torch.linalg.inv(pose.roll(-1, 1)) @ pose).float()
    flat = [x.flatten(0, 1) for x in (part["depth_m"], part["depth_m"].roll(-1, 1), part["intrinsic"], part["intrinsic"].roll(-1, 1), way)]
    moved, where = pixel_warp(pictures.roll(-1, 1).flatten(0, 1), *flat)
    return gap_where(pictures.flatten(0, 1), moved, where)


def kernel_distance(a, b):
    """KID's unbiased estimate with the kernel (x.y / d + 1)^3 of two sets of features [N,D], [M,D]."""
    a, b = a.double(), b.double()
    spread = b.std(0).clamp(min=1e-6)
    a, b = a / spread, b / spread
    k = [(x @ y.T / x.shape[1] + 1) ** 3 for x, y in ((a, a), (b, b), (a, b))]
    n, m = len(a), len(b)
    return ((k[0].sum() - k[0].trace()) / (n * (n - 1)) + (k[1].sum() - k[1].trace()) / (m * (m - 1)) - 2 * k[2].mean()).item()


def noise_for(trainer, shape, seed):
    return torch.randn(shape, device=trainer.device, generator=torch.Generator(trainer.device).manual_seed(seed))


def moment_of(trainer, frames, moment):
    held = trainer.held
    at = torch.tensor(frames, device=trainer.device)
    part = held.moments(at, torch.full_like(at, moment), False)
    a = held.arrays
    return part, as_pictures(a["rgb"][at, moment]), a["class"][at, moment]


def figures_of(trainer):
    """All figures of the held-out frames."""
    judges = {name: Agreement(trainer.device) for name in ("rendered", "decoded", "drawn", "drawn_after", "drawn_again")}
    time_gaps, view_gaps, features, quality = {}, {}, {}, {}

    def put(table, name, value):
        table[name] = table.get(name, 0) + value

    frames = list(range(trainer.held.count))
    for begin in range(0, len(frames), PIECE):
        some = frames[begin : begin + PIECE]
        first, true_first, _ = moment_of(trainer, some, 0)
        part, true, shown = moment_of(trainer, some, 1)
        shape = part["latent"].shape
        noise0, noise1 = noise_for(trainer, shape, begin), noise_for(trainer, shape, 10**6 + begin)
        start = sample(trainer, first, noise0)
        latents = {"decoded": part["latent"], "drawn": sample(trainer, part, noise0), "drawn_other_noise": sample(trainer, part, noise1),
                   "drawn_after": sample(trainer, part, noise1, part["before"]),  # after the render of the moment before
                   "drawn_again": sample(trainer, part, noise1, start)}  # after what was drawn of it
        pictures = {"rendered": true} | {name: drawn(trainer, latent) for name, latent in latents.items()}
        start_pictures = drawn(trainer, start)
        for name, judge in judges.items():
            judge.add(trainer, pictures[name], shown)
        for name in ("decoded", "drawn", "drawn_after"):
            put(quality, f"psnr_{name}", psnr(pictures[name], true) * len(some))
            put(quality, f"l1_{name}", (pictures[name] - true).abs().mean().item() / 2 * len(some))
        for name, before in (("rendered", true_first), ("drawn", start_pictures), ("drawn_other_noise", start_pictures), ("drawn_again", start_pictures),
                             ("drawn_after", true_first)):
            put(time_gaps, name, over_time(part, pictures[name], before))
        for name in ("rendered", "decoded", "drawn", "drawn_after", "drawn_again"):
            put(view_gaps, name, across_views(part, pictures[name]))
        with torch.no_grad(), trainer.amp():
            for name, values in (("rendered", true), ("rendered_before", true_first), ("drawn", pictures["drawn"]), ("drawn_again", pictures["drawn_again"])):
                features.setdefault(name, []).append(trainer.seg.ema.pooled(values.flatten(0, 1)))
    features = {name: torch.cat(values) for name, values in features.items()}
    half = len(features["rendered"]) // 2
    return {
        "held_out": len(frames),
        "sampling_steps": trainer.args.sampling,
        "guidance": trainer.args.guidance,
        "quality": {name: round(value / len(frames), 4) for name, value in quality.items()},
        "agreement": {name: judge.figures() for name, judge in judges.items()},
        "warp_error": {name: round((v[0] / v[1].clamp(min=1)).item(), 4) for name, v in time_gaps.items()},
        "neighbour_error": {name: round((v[0] / v[1].clamp(min=1)).item(), 4) for name, v in view_gaps.items()},
        "kernel_distance": {"drawn": round(kernel_distance(features["drawn"], features["rendered"]), 4),
                            "drawn_again": round(kernel_distance(features["drawn_again"], features["rendered"]), 4),
                            "rendered_other_worlds": round(kernel_distance(features["rendered"][:half], features["rendered"][half:]), 4)},
    }


PALETTE = np.array([[int(255 * c) for c in colorsys.hsv_to_rgb(i * 0.37 % 1, 0.65, 0.9)] for i in range(256)], np.uint8)
PALETTE[0] = 0


def strip(pictures):
    """u8 [6,h,w,3] -> [h,6w,3]."""
    return np.concatenate(list(pictures), 1)


def write_sheets(trainer, folder, per_sheet=2, sheets=3):
    """JPEG sheets of held-out frames, six views wide: what was asked for, the render, drawn from noise alone, and drawn after that a moment later
    (with the render of that moment above it)."""
    chosen = spread(trainer, per_sheet * (sheets - 1))
    groups = [chosen[i : i + per_sheet] for i in range(0, len(chosen), per_sheet)]
    for number, some in enumerate(groups):
        first, true_first, _ = moment_of(trainer, some, 0)
        part, true, _ = moment_of(trainer, some, 1)
        noise = noise_for(trainer, part["latent"].shape, 99 + number)
        start = sample(trainer, first, noise)
        later = sample(trainer, part, noise, start)
        rows = []
        for i in range(len(some)):
            rows.append(strip(PALETTE[first["classes"][i].cpu().numpy()]))
            for pictures in (true_first, drawn(trainer, start), true, drawn(trainer, later)):
                rows.append(strip(as_bytes(pictures[i]).cpu().numpy()))
        save_jpeg(np.concatenate(rows), folder / f"sheet_{number}.jpg")
    write_weathers(trainer, folder / f"sheet_{sheets - 1}.jpg")


def write_weathers(trainer, path):
    """One held-out frame under six pairs of light and weather, from one noise."""
    part, true, _ = moment_of(trainer, [0] * 6, 0)
    part["time"] = torch.tensor([1, 1, 1, 2, 3, 0], device=trainer.device)
    part["weather"] = torch.tensor([0, 2, 3, 0, 0, 4], device=trainer.device)
    noise = noise_for(trainer, part["latent"].shape, 5)
    noise = noise[:1].expand_as(noise).contiguous()
    pictures = drawn(trainer, sample(trainer, part, noise))
    rows = [strip(PALETTE[part["classes"][0].cpu().numpy()]), strip(as_bytes(true[0]).cpu().numpy())]
    rows += [strip(as_bytes(p).cpu().numpy()) for p in pictures]
    save_jpeg(np.concatenate(rows), path)


def spread(trainer, n):
    """Held-out frames of different light and weather."""
    conditions = trainer.held.arrays["conditions"][: trainer.held.count].tolist()
    kinds, found = set(), []
    for i, kind in enumerate(conditions):
        if tuple(kind) not in kinds:
            kinds.add(tuple(kind))
            found.append(i)
    rest = [i for i in range(len(conditions)) if i not in found]
    return (found + rest)[:n]


def save_jpeg(rows, path, most=290_000):
    from PIL import Image  # needed for nothing else

    for quality in (88, 80, 70, 60, 50):
        Image.fromarray(rows).save(path, quality=quality)
        if path.stat().st_size <= most:
            return
