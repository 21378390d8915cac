"""Frames as the DiT's training reads them, so that a step of it waits for nothing: python pack.py --data DIR --vae W.safetensors

Per shard of DIR/train and DIR/val one folder in DIR/packed-NAME (NAME: the VAE's latent space) with arrays that are read through the
page cache: `latents` f16 [N,4,50,50,8] of `KINDS`, `columns` u8 [N,200,200,5] (background and ground, `models.occ_dit.COLUMN`), `bev` i32 and
`heading` u8 [N,200,200], `named` f32 [N,2,4] of the complete world and of its labels. A shard that is packed is not packed again.
"""
import argparse
import os
import time
from pathlib import Path

import numpy as np
import torch

from data import BACKGROUND, FIRST_GROUND, Frames, as_tensor, named
from loop import pick_device
from models.occ_vae import latent_space, load_vae

KINDS = ("dense", "labels", "draft", "given")
ARRAYS = ("latents", "columns", "bev", "heading", "named")
GROUND = (11, 14)  # classes of the ground, first and last


def columns_of(draft, given):
    """u8 [X,Y,5]: base and top (in bins, 1 more than the bin, 0 = nothing) of what is man-made and of what is grown in `given`, then
    the top of the ground in `draft`. Rust twin: gen/model/column_heights.rs."""
    bins = np.arange(1, draft.shape[2] + 1, dtype=np.uint8)
    out = np.zeros((*draft.shape[:2], 5), np.uint8)
    for group, label in enumerate(BACKGROUND):
        held = given == label
        top = (held * bins).max(-1)
        base = np.where(held, bins, 255).min(-1)
        out[..., 2 * group], out[..., 2 * group + 1] = np.where(top > 0, base, 0), top
    out[..., 4] = (((draft >= GROUND[0]) & (draft <= GROUND[1])) * bins).max(-1)
    return out


@torch.no_grad()
def packed(frames, vae, device, dtype):
    """The arrays of a shard's frames."""
    count = len(frames)
    out = {"latents": np.zeros((count, len(KINDS), 50, 50, 8), np.float16), "columns": np.zeros((count, 200, 200, 5), np.uint8),
           "bev": np.zeros((count, 200, 200), np.int32), "heading": np.zeros((count, 200, 200), np.uint8), "named": np.zeros((count, 2, 4), np.float32)}
    for i, frame in enumerate(frames):
        grids = [frame[kind] for kind in KINDS]
        with torch.autocast(device.type, dtype, enabled=dtype is not None):
            latents = vae.encode(as_tensor(grids).to(device)).float()
        out["latents"][i] = latents.clamp(-60000, 60000).half().cpu().numpy()
        out["columns"][i] = columns_of(frame["draft"], frame["given"])
        out["bev"][i], out["heading"][i] = frame["bev"].view(np.int32), frame["heading"]
        out["named"][i] = [named(frame[kind], frame["bev"]) for kind in ("dense", "labels")]
    return out


def folder_of(data, name, part):
    return Path(data) / f"packed-{name}" / part


def pack(data, vae_path, device, dtype):
    """Packs what is not yet packed; the number of frames that are."""
    vae, name, total = load_vae(vae_path, device), latent_space(vae_path), 0
    for part in ("val", "train"):
        source, began, done = Frames(Path(data) / part), time.monotonic(), 0
        for shard in dict.fromkeys(s for s, _ in source.index):
            total += shard.frames
            folder = folder_of(data, name, part) / f"{shard.path.stem}-{shard.path.stat().st_mtime_ns:x}"
            if folder.exists():
                continue
            names = ("dense", "labels", "draft", "given", "bev", "heading")
            arrays = packed([{n: source.read((shard, i), n) for n in names} for i in range(shard.frames)], vae, device, dtype)
            draft_folder = folder.with_suffix(".part")
            draft_folder.mkdir(parents=True, exist_ok=True)
            for key, array in arrays.items():
                np.save(draft_folder / f"{key}.npy", array)
            os.replace(draft_folder, folder)
            done += shard.frames
            print(f"{part}: {shard.path.name}, {done / (time.monotonic() - began):.1f} frames/s", flush=True)
    return total


class Packed:
    """All packed frames of a folder; arrays are mapped, not read."""

    def __init__(self, folder):
        self.arrays, self.index = [], []
        for shard in sorted(p for p in Path(folder).glob("*") if p.suffix != ".part"):
            arrays = {name: np.load(shard / f"{name}.npy", mmap_mode="r") for name in ARRAYS}
            self.index += [(len(self.arrays), i) for i in range(len(arrays["named"]))]
            self.arrays.append(arrays)
        if not self.index:
            raise SystemExit(f"{folder}: nothing packed")

    def __len__(self):
        return len(self.index)

    def read(self, frame, name, kind=None, corner=(0, 0), cells=50):
        """Part of an array of a frame: a square of `cells` latent cells at `corner`."""
        shard, i = self.index[frame]
        array = self.arrays[shard][name]
        if name == "named":
            return array[i, kind]
        scale = 1 if name == "latents" else 4
        x, y = (slice(c * scale, (c + cells) * scale) for c in corner)
        return array[i, kind, x, y] if kind is not None else array[i, x, y]


def main():
    p = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    p.add_argument("--data", type=Path, required=True)
    p.add_argument("--vae", required=True)
    p.add_argument("--threads", type=int, default=2)
    args = p.parse_args()
    print(pack(args.data, args.vae, *pick_device(args.threads)), "frames are packed")


if __name__ == "__main__":
    main()
