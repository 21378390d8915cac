"""Six cameras of a street's Gaussians: ours beside the same renderer written with PyTorch operations (projection of all
Gaussians at once, tiles of 16 x 16 px, cumulative products along depth)."""
from common import Ours, arguments, beside, needs

needs("torch", "numpy", "safetensors")
import json
import sys
from pathlib import Path

import numpy as np
import torch

TILE, IDS = 16, 20
NEAR, FAR, LOW_PASS, CLAMP = 0.2, 200.0, 0.3, 1.3
ALPHA_MIN, ALPHA_MAX, STD_M = 1 / 255, 0.99, 0.2


def rotation(w, x, y, z):
    n = np.sqrt(w * w + x * x + y * y + z * z)
    w, x, y, z = w / n, x / n, y / n, z / n
    return np.array([[1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
                     [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
                     [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)]])


def render(camera, points, ids, width, height):
    """-> coverage f32 [H, W], sum of weight times depth, label i64 (-1: nothing)."""
    r = torch.from_numpy(rotation(*camera["rotation_wxyz"]))
    scale = torch.tensor([width / camera["width"], height / camera["height"]], dtype=torch.float64)
    focal = torch.tensor(camera["focal_px"], dtype=torch.float64) * scale
    center = torch.tensor(camera["center_px"], dtype=torch.float64) * scale
    p = (points.double() - torch.tensor(camera["translation_m"], dtype=torch.float64)) @ r
    seen = (p[:, 2] > NEAR) & (p[:, 2] <= FAR)
    p, ids = p[seen], ids[seen]
    order = torch.argsort(p[:, 2].float(), stable=True)
    p, ids = p[order], ids[order]
    z = p[:, 2:]
    uv = p[:, :2] / z
    mean = focal * uv + center
    limit = CLAMP * 0.5 * torch.tensor([width, height], dtype=torch.float64) / focal
    u, v = torch.maximum(torch.minimum(uv, limit), -limit).T
    s = (STD_M / z[:, 0]) ** 2
    xx, xy, yy = s * focal[0] ** 2 * (1 + u * u), s * focal[0] * focal[1] * u * v, s * focal[1] ** 2 * (1 + v * v)
    before = (xx * yy - xy * xy).clamp(min=0)
    det = (before + LOW_PASS * (xx + yy + LOW_PASS)).clamp(min=1e-12)
    xx, yy = xx + LOW_PASS, yy + LOW_PASS
    reach = np.sqrt(-2 * np.log(ALPHA_MIN)) + 1e-3
    half = reach * torch.stack([xx, yy], 1).sqrt()
    low, high = mean - half, mean + half
    conic = torch.stack([yy / det, -xy / det, xx / det], 1).float()
    mean, depth = mean.float(), z[:, 0].float()
    coverage, expected = torch.zeros(height, width), torch.zeros(height, width)
    label = torch.full((height, width), -1)
    for y0 in range(0, height, TILE):
        for x0 in range(0, width, TILE):
            x1, y1 = min(x0 + TILE, width), min(y0 + TILE, height)
            touch = (high[:, 0] >= x0) & (low[:, 0] <= x1) & (high[:, 1] >= y0) & (low[:, 1] <= y1)
            own = touch.nonzero().squeeze(1)
            if len(own) == 0:
                continue
            y, x = torch.meshgrid(torch.arange(y0, y1) + 0.5, torch.arange(x0, x1) + 0.5, indexing="ij")
            d = torch.stack([x.reshape(-1), y.reshape(-1)], 1)[:, None] - mean[own]
            a, b, c = conic[own].T
            power = -0.5 * (a * d[..., 0] ** 2 + c * d[..., 1] ** 2) - b * d[..., 0] * d[..., 1]
            alpha = power.exp().clamp(max=ALPHA_MAX)
            alpha = torch.where(alpha >= ALPHA_MIN, alpha, 0.0)  # [pixel, Gaussian]
            light = torch.cumprod(1 - alpha, 1)
            light = torch.cat([torch.ones_like(light[:, :1]), light[:, :-1]], 1)
            weight = alpha * light * (light >= 1e-4)
            of_id = torch.zeros(len(d), IDS).index_add_(1, ids[own].long(), weight)
            shape = (y1 - y0, x1 - x0)
            total = weight.sum(1)
            coverage[y0:y1, x0:x1] = total.view(shape)
            expected[y0:y1, x0:x1] = (weight @ depth[own]).view(shape)
            label[y0:y1, x0:x1] = torch.where(total > 0, of_id.argmax(1), -1).view(shape)
    return coverage, expected, label


def main():
    args = arguments()
    torch.set_num_threads(args.threads)
    ours = Ours(args.threads)
    x = ours.arrays("pt")
    rig = json.loads((Path(ours.folder.name) / "rig.json").read_text())
    cameras, height, width = x["coverage"].shape

    def all_cameras():
        return [render(c, x["gaussians"], x["ids"], width, height) for c in rig["cameras"]]

    with torch.inference_mode():
        maps = all_cameras()
        coverage, expected, label = (torch.stack(m) for m in zip(*maps))
        other = (label != x["label"]).float().mean().item()
        gap = (coverage - x["coverage"]).abs()
        print(f"{len(x['ids'])} Gaussians, {cameras} cameras of {width} x {height}: labels that differ {100 * other:.3f} % (allowed 0.1), "
              f"coverage differs by {gap.mean():.1e} on average, {100 * (gap > 1e-3).float().mean():.3f} % of the pixels by more than 0.001")
        if other > 1e-3:
            sys.exit("the two sides draw different things")
        beside("splats, six cameras", lambda: ours("splats"), all_cameras, min(args.runs, 5), f"torch {torch.__version__}", warm=1)


main()
