"""Latents of every frame under a few symmetries, encoded when first asked for and kept on disk in f16."""
import hashlib
import weakref
from pathlib import Path

import numpy as np
import torch
from safetensors import safe_open

from data import as_tensor, turned


def latent_space(vae_path):
    """Names the latents of a VAE: its file's hash, or, where only the decoder was trained on, that of the file it came
    from. A DiT belongs to a latent space."""
    with safe_open(vae_path, "pt") as f:
        name = (f.metadata() or {}).get("latents")
    return name or hashlib.sha256(Path(vae_path).read_bytes()).hexdigest()[:12]


KINDS = ("dense", "draft", "labels", "given")


class LatentCache:
    """Per shard one sparse file [frames, 8 symmetries, kinds, 2500*8] f16, and one of a byte each: filled or not. Those of
    streamed shards stay in memory and go with them. Encoded in `dtype` where it is given: bf16 takes half the time and is
    wrong by .007 of the latents' spread."""

    def __init__(self, frames, vae, folder, device, dtype=None):
        self.frames, self.vae, self.device, self.dtype = frames, vae, device, dtype
        self.maps = weakref.WeakKeyDictionary()
        self.folder = folder

    def _map(self, shard):
        if shard not in self.maps:
            made, count = [], (shard.frames, 8, len(KINDS))
            if shard.path is None:
                self.maps[shard] = np.zeros((*count, 20000), np.float16), np.zeros(count, np.uint8)
                return self.maps[shard]
            folder = self.folder / shard.path.parent.name
            folder.mkdir(parents=True, exist_ok=True)
            stamp = f"{shard.path.stem}-{shard.path.stat().st_mtime_ns:x}-{'-'.join(KINDS)}"  # of these very frames
            for suffix, dtype, shape in ((".f16", np.float16, (*count, 20000)), (".done", np.uint8, count)):
                path = folder / (stamp + suffix)
                made.append(np.memmap(path, dtype, "r+" if path.exists() else "w+", shape=shape))
            self.maps[shard] = made
        return self.maps[shard]

    def one(self, frame, symmetry, kinds):
        """f16 [len(kinds), 20000]: latents of a frame's grids, turned."""
        shard, i = self.frames.at(frame)
        latents, done = self._map(shard)
        at = [KINDS.index(kind) for kind in kinds]
        missing = [k for k in at if not done[i, symmetry, k]]
        if missing:
            grids = as_tensor([turned(self.frames.read(frame, KINDS[k]), symmetry) for k in missing])
            with torch.no_grad(), torch.autocast(self.device.type, self.dtype, enabled=self.dtype is not None):
                latent = self.vae.encode(grids.to(self.device)).float()
            latents[i, symmetry, missing] = latent.reshape(len(missing), -1).clamp(-60000, 60000).half().cpu().numpy()
            done[i, symmetry, missing] = 1
        return latents[i, symmetry, at]

    def batch(self, frames, symmetries, targets, given):
        """Two tensors [B,50,50,8] f32: latents of the targets ("dense" or "labels" each) and of the drafts, which hold the
        background where `given` [B,50,50,1] is 1."""
        made = []
        for frame, symmetry, target, flags in zip(frames, symmetries, targets, given):
            drafts = [k for k, wanted in (("draft", flags.min() < 1), ("given", flags.max() > 0)) if wanted]
            made.append(self.one(frame, symmetry, (target, drafts[0], drafts[-1])))
        made = torch.from_numpy(np.stack(made).astype(np.float32)).view(-1, 3, 50, 50, 8)
        target, bare, full = (part.to(self.device) for part in made.unbind(1))
        return target, torch.where(given.to(self.device) > 0, full, bare)
