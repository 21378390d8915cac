"""Two VAEs beside each other: python compare_vae.py --data DIR A.safetensors B.safetensors

Of held-out worlds: mIoU and IoU after encoding and decoding, seconds of either, and what an edit touches. The edit clears the 8 x 8 m in which most
stands, down to the ground. `touched` is the share of the latent that changes at all, `moved` what changes by more than a tenth of its spread;
`elsewhere` the number of voxels more than 8 m from the edit whose decoded label changes, per edit.
"""
import argparse
import time
from pathlib import Path

import torch
from torch.nn import functional as F

import losses
from data import FREE, Frames, as_tensor
from models.occ_vae import load_vae

SIDE, FAR = 20, 20  # columns of the edit, and how far beside it they count as elsewhere
GROUND = 2  # bins that stay


def place_of(grid):
    """First column of the square in which most stands."""
    stands = (grid[..., GROUND:] != FREE).sum(-1)[0].float()
    sums = F.avg_pool2d(stands[None, None], SIDE, SIDE)[0, 0]
    return [SIDE * i for i in divmod(sums.argmax().item(), sums.shape[1])]


def cleared(grid, x, y):
    """Labels [1,200,200,16] without what stands in a square."""
    grid = grid.clone()
    grid[:, x : x + SIDE, y : y + SIDE, GROUND:] = FREE
    return grid


@torch.no_grad()
def figures(vae, grids):
    confusion, touched, moved, changed, encode_s, decode_s = losses.Confusion(), [], [], [], [], []
    for grid in grids:
        start = time.monotonic()
        latent = vae.encode(grid)
        encode_s.append(time.monotonic() - start)
        start = time.monotonic()
        found = vae.decode(latent)
        decode_s.append(time.monotonic() - start)
        confusion.add(grid, found)
        x, y = place_of(grid)
        edited = vae.encode(cleared(grid, x, y))
        by = (edited - latent).abs()
        touched.append((by > 1e-6).double().mean().item())
        moved.append((by > 0.1).double().mean().item())
        elsewhere = torch.ones_like(found, dtype=torch.bool)
        elsewhere[:, max(x - FAR, 0) : x + SIDE + FAR, max(y - FAR, 0) : y + SIDE + FAR] = False
        changed.append(((vae.decode(edited) != found) & elsewhere).sum().item())
    mean, median = lambda v: sum(v) / len(v), lambda v: sorted(v)[len(v) // 2]
    return {"miou": confusion.miou(), "iou": confusion.iou(), "encode_s": median(encode_s), "decode_s": median(decode_s),
            "touched": mean(touched), "moved": mean(moved), "elsewhere": mean(changed)}


def main():
    p = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    p.add_argument("weights", nargs="+")
    p.add_argument("--data", type=Path, required=True, help="folder with val/")
    p.add_argument("--frames", type=int, default=24)
    p.add_argument("--threads", type=int, default=2)
    args = p.parse_args()
    torch.set_num_threads(args.threads)
    frames = Frames(args.data / "val")
    grids = [as_tensor([frames.read(i, "dense")]) for i in range(min(args.frames, len(frames)))]
    for path in args.weights:
        row = figures(load_vae(path, torch.device("cpu")), grids)
        print(f"{Path(path).stem:16} " + "  ".join(f"{k} {v:.4g}" for k, v in row.items()), flush=True)


if __name__ == "__main__":
    main()
