"""What the refiner learns from, packed once: per shard of DIR/train and DIR/val a folder in DIR/refiner-NAME with fine latents f16
[N,2,100,100,16] of the truth (`fine`), of what the noised coarse latent decodes to (`rough`) and of the draft that its decoder was told
(`told`), and that latent, `coarse` f16 [N,2,50,50,8]; complete worlds, then labels. Coarse latents are taken from what pack.py made.
"""
import hashlib
import os
import time
from pathlib import Path

import numpy as np
import torch

from data import Frames, as_tensor, draw_masks
from models.occ_vae import latent_space, load_vae
from pack import folder_of

KINDS = ("dense", "labels")
ARRAYS = ("fine", "rough", "told", "coarse")
# Most that a coarse latent is noised by, in its spread, as generated ones are not exact either: everywhere, and in rectangles of six frames in
# ten, where it may have lost what was asked for.
NOISE, LOST, PATCHED = 0.3, 1.2, 0.6
GIVEN = 0.7  # share of frames whose decoder is told the background


def name_of(vae_path, fine_path):
    """Names a coarse decoder with a fine latent space."""
    return latent_space(fine_path) + hashlib.sha256(Path(vae_path).read_bytes()).hexdigest()[:6]


def noised(rng, latents):
    """Coarse latents [N,50,50,8] as a generator might have made them."""
    patches = draw_masks(rng, len(latents), whole=0) * (rng.random((len(latents), 1, 1)) < PATCHED)
    level = np.where(patches > 0, rng.uniform(NOISE, LOST, (len(latents), 1, 1)), rng.uniform(0, NOISE, (len(latents), 1, 1)))
    return torch.from_numpy((latents + level[..., None] * rng.standard_normal(latents.shape)).astype(np.float32))


@torch.no_grad()
def packed(source, shard, latents, vae, fine, rng, device, dtype):
    """The arrays of a shard's frames; `latents` are their coarse ones [N,4,50,50,8] (`pack.KINDS`)."""
    out = {name: np.zeros((shard.frames, 2, side, side, n), np.float16) for name, side, n in (*((name, 100, 16) for name in ARRAYS[:3]), ("coarse", 50, 8))}
    for i in range(shard.frames):
        coarse = noised(rng, latents[i, :2].astype(np.float32))
        draft = as_tensor([source.read((shard, i), "given" if rng.random() < GIVEN else "draft")]).expand(2, -1, -1, -1)
        with torch.autocast(device.type, dtype, enabled=dtype is not None):
            heard = [draft.to(device), torch.zeros(draft.shape[:3], dtype=torch.int32, device=device)] if vae.config.hears else None
            truth = as_tensor([source.read((shard, i), kind) for kind in KINDS]).to(device)
            grids = torch.cat([truth, vae.decode(coarse.to(device), heard), draft[:1].to(device)])
            found = fine.encode(grids).float().clamp(-60000, 60000).half().cpu().numpy()
        out["fine"][i], out["rough"][i], out["told"][i], out["coarse"][i] = found[:2], found[2:4], found[4:], coarse.half().numpy()
    return out


def pack_refiner(data, vae_path, fine_path, most, device, dtype):
    """Packs what is not yet packed of the held-out shards and of `most` frames for training; the folders of both."""
    vae, fine, name = load_vae(vae_path, device), load_vae(fine_path, device), name_of(vae_path, fine_path)
    folders = {}
    for part in ("val", "train"):
        source, began, done, total = Frames(Path(data) / part), time.monotonic(), 0, 0
        folders[part] = Path(data) / f"refiner-{name}" / part
        for shard in dict.fromkeys(s for s, _ in source.index):
            if part == "train" and total >= most:
                break
            total += shard.frames
            stem = f"{shard.path.stem}-{shard.path.stat().st_mtime_ns:x}"
            folder = folders[part] / stem
            if folder.exists():
                continue
            latents = np.load(folder_of(data, latent_space(vae_path), part) / stem / "latents.npy", mmap_mode="r")
            arrays = packed(source, shard, latents, vae, fine, np.random.default_rng([len(part), total]), device, dtype)
            unfinished = folder.with_suffix(".part")
            unfinished.mkdir(parents=True, exist_ok=True)
            for key, array in arrays.items():
                np.save(unfinished / f"{key}.npy", array)
            os.replace(unfinished, folder)
            done += shard.frames
            print(f"{part}: {shard.path.name}, {done / (time.monotonic() - began):.1f} frames/s", flush=True)
    return folders


class PackedPairs:
    """All packed frames of a folder; arrays are mapped, not read."""

    def __init__(self, folder):
        shards = sorted(p for p in Path(folder).glob("*") if p.suffix != ".part")
        self.arrays = [{name: np.load(s / f"{name}.npy", mmap_mode="r") for name in ARRAYS} for s in shards]
        self.index = [(s, i, kind) for s, arrays in enumerate(self.arrays) for i in range(len(arrays["fine"])) for kind in range(2)]
        if not self.index:
            raise SystemExit(f"{folder}: nothing packed")

    def __len__(self):
        return len(self.index)

    def read(self, at, corner=(0, 0), cells=50):
        """The latents of a square of `cells` coarse cells."""
        shard, i, kind = self.index[at]
        parts = [tuple(slice(c * k, (c + cells) * k) for c in corner) for k in (2, 2, 2, 1)]
        return tuple(self.arrays[shard][name][(i, kind, *part)] for name, part in zip(ARRAYS, parts))
