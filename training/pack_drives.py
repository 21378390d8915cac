"""Drives as the temporal training reads them: python pack_drives.py --data DIR --vae W.safetensors

Per shard of `sceneloom dataset drives` in DIR/train and DIR/val one folder in DIR/packed-NAME with mapped arrays: `latents` f16
[N,8,3,50,50,8] of `KINDS`, `columns` u8 [N,8,200,200,5], `bev` i32 and `heading` u8 [N,8,200,200], `named` f32 [N,8,4] and `pose` f32
[N,8,3] (x and y in m, heading in rad, of the ego vehicle on the ground of the first frame). What is packed is not packed again.
"""
import argparse
import os
from pathlib import Path

import numpy as np
import torch
from safetensors.numpy import load_file

from data import as_tensor, named, with_background
from loop import pick_device
from models.occ_vae import latent_space, load_vae
from pack import columns_of, folder_of

KINDS = ("dense", "draft", "given")
ARRAYS = ("latents", "columns", "bev", "heading", "named", "pose")


@torch.no_grad()
def packed(shard, vae, device, dtype):
    """The arrays of a shard's drives."""
    count, frames = shard["dense"].shape[:2]
    out = {"latents": np.zeros((count, frames, len(KINDS), 50, 50, 8), np.float16),
           "columns": np.zeros((count, frames, 200, 200, 5), np.uint8), "bev": shard["bev"], "heading": shard["heading"],
           "named": np.zeros((count, frames, 4), np.float32), "pose": shard["pose"]}
    for i in range(count):
        for t in range(frames):
            dense, draft = shard["dense"][i, t], shard["draft"][i, t]
            given = with_background(draft, dense)
            with torch.autocast(device.type, dtype, enabled=dtype is not None):
                latents = vae.encode(as_tensor([dense, draft, given]).to(device)).float()
            out["latents"][i, t] = latents.clamp(-60000, 60000).half().cpu().numpy()
            out["columns"][i, t] = columns_of(draft, given)
            out["named"][i, t] = named(dense, shard["bev"][i, t])
    return out


def pack(data, vae_path, device, dtype):
    """Packs what is not yet packed."""
    vae, name = load_vae(vae_path, device), latent_space(vae_path)
    for part in ("val", "train"):
        for path in sorted((Path(data) / part).glob("shard_*.safetensors")):
            folder = folder_of(data, name, part) / path.stem
            if folder.exists():
                continue
            part_folder = folder.with_suffix(".part")
            part_folder.mkdir(parents=True, exist_ok=True)
            for key, array in packed(load_file(path), vae, device, dtype).items():
                np.save(part_folder / f"{key}.npy", array)
            os.replace(part_folder, folder)
            print(f"{part}: {path.name}", flush=True)


class PackedDrives:
    """All packed drives of a folder; arrays are mapped, not read."""

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

    def array(self, drive, name):
        """An array of a drive, its frames first."""
        shard, i = self.index[drive]
        return self.arrays[shard][name][i]


def main():
    p = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    p.add_argument("--data", type=Path, required=True)
    p.add_argument("--vae", required=True)
    p.add_argument("--threads", type=int, default=2)
    args = p.parse_args()
    pack(args.data, args.vae, *pick_device(args.threads))


if __name__ == "__main__":
    main()
