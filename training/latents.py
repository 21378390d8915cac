"""Latents of every frame under a few symmetries, encoded when first asked for and kept on disk in f16."""
import hashlib
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


KINDS = ("dense", "draft", "labels")


class LatentCache:
    """Per shard one sparse file [frames, 8 symmetries, kinds, 2500*8] f16, and one of a byte each: filled or not."""

    def __init__(self, frames, vae, folder, device):
        self.frames, self.vae, self.device, self.maps = frames, vae, device, {}
        self.folder = folder
        folder.mkdir(parents=True, exist_ok=True)

    def _map(self, shard):
        if shard.path not in self.maps:
            made, count = [], (shard.frames, 8, len(KINDS))
            stamp = f"{shard.path.stem}-{shard.path.stat().st_mtime_ns:x}-{'-'.join(KINDS)}"  # of these very frames
            for suffix, dtype, shape in ((".f16", np.float16, (*count, 20000)), (".done", np.uint8, count)):
                path = self.folder / (stamp + suffix)
                made.append(np.memmap(path, dtype, "r+" if path.exists() else "w+", shape=shape))
            self.maps[shard.path] = made
        return self.maps[shard.path]

    def one(self, frame, symmetry, kinds):
        """f16 [len(kinds), 20000]: latents of a frame's grids, turned."""
        shard, i = self.frames.index[frame]
        latents, done = self._map(shard)
        at = [KINDS.index(kind) for kind in kinds]
        missing = [k for k in at if not done[i, symmetry, k]]
        if missing:
            grids = as_tensor([turned(self.frames.read(frame, KINDS[k]), symmetry) for k in missing])
            with torch.no_grad():
                latent = self.vae.encode(grids.to(self.device))
            latents[i, symmetry, missing] = latent.reshape(len(missing), -1).clamp(-60000, 60000).half().cpu().numpy()
            done[i, symmetry, missing] = 1
        return latents[i, symmetry, at]

    def batch(self, frames, symmetries, targets):
        """Two tensors [B,50,50,8] f32: latents of the targets ("dense" or "labels" each) and of the drafts."""
        both = np.stack([self.one(f, s, (k, "draft")) for f, s, k in zip(frames, symmetries, targets)]).astype(np.float32)
        both = torch.from_numpy(both).view(-1, 2, 50, 50, 8).to(self.device)
        return both[:, 0], both[:, 1]
