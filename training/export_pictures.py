"""What train_pictures.py left in a folder -> the shipped f16 weights in assets/weights, and in weights/pictures
the log, figures, sheets, and the golden of a parity test.

python export_pictures.py RUNS/pictures
The golden is computed from the f16 values, in f32, as the Rust program will compute: a ring of six pictures of 64x32 px.
"""
import json
import shutil
import sys
from pathlib import Path

import torch
from safetensors import safe_open
from safetensors.torch import load_file, save_file

from export import uniform
from models.picture_dit import PictureDit, PictureDitConfig, cell_depth, warp
from models.picture_vae import CELL, load_picture_vae
from models.segmenter import Segmenter, SegmenterConfig
from schedule import ddim_sample

OUT = Path(__file__).resolve().parent / "weights" / "pictures"
SHIPPED = Path(__file__).resolve().parent.parent / "assets" / "weights"
WIDTH, HEIGHT, VIEWS = 64, 32, 6
KEPT = ("log.jsonl", "figures.json", "sheet_0.jpg", "sheet_1.jpg", "sheet_2.jpg")


def load_dit(path):
    with safe_open(path, "pt") as f:
        config = json.loads(f.metadata()["config"])
    dit = PictureDit(PictureDitConfig(**config))
    dit.load_state_dict({k: v.float() for k, v in load_file(path).items()})
    return dit.eval().requires_grad_(False)


def load_segmenter(path):
    with safe_open(path, "pt") as f:
        config = json.loads(f.metadata()["config"])
    net = Segmenter(SegmenterConfig(**config))
    net.load_state_dict({k: v.float() for k, v in load_file(path).items()})
    return net.eval().requires_grad_(False)


@torch.no_grad()
def golden(folder):
    """Inputs that any language makes alike, and what the networks make of them."""
    vae, dit = load_picture_vae(folder / "vae.safetensors", torch.device("cpu")), load_dit(folder / "dit.safetensors")
    c, pixels, cells = dit.config.latent, VIEWS * HEIGHT * WIDTH, VIEWS * HEIGHT * WIDTH // CELL**2
    shape = (1, VIEWS, HEIGHT // CELL, WIDTH // CELL, c)
    index = torch.arange(pixels).view(1, VIEWS, HEIGHT, WIDTH)
    classes, depth_m = (index * 7 // 13 % 20).to(torch.uint8), (index * 11 % 997).float() * 0.05
    facing = torch.where((classes > 0) & (classes < 11), 1 + index % 16 + 128 * (index % 5 == 0), 0).to(torch.uint8)
    x, cameras = uniform(cells * c, 1).view(shape), uniform(VIEWS * 7, 2).view(1, VIEWS, 7)
    pictures = (uniform(pixels * 3, 3) / 1.75).view(VIEWS, HEIGHT, WIDTH, 3)
    told = dit.condition(classes, depth_m, facing, torch.tensor([2]), torch.tensor([3]), cameras)
    # The frame before: the camera stood 0.8 m behind and 0.1 m to the right.
    intrinsic = torch.tensor([[5.0, 0, 4.2], [0, 5.0, 1.9], [0, 0, 1]]).expand(VIEWS, 3, 3)
    way = torch.eye(4)
    way[:3, 3] = torch.tensor([-0.1, 0.0, 0.8])
    deep, deep_before = cell_depth(depth_m)[0], cell_depth(depth_m.flip(-1))[0]
    before = warp(uniform(cells * c, 4).view(shape)[0], deep, deep_before, intrinsic, way.expand(VIEWS, 4, 4))[None]

    nothing = torch.zeros_like(classes)
    silent = dit.condition(nothing, torch.zeros_like(depth_m), nothing, torch.tensor([2]), torch.tensor([3]), cameras)

    def v(t, heard):
        return dit(x, torch.tensor([t]), told, heard)

    def guided(y, t):
        return dit(y, t, told, before).lerp(dit(y, t, silent, None), -1.0)  # guidance 2

    return {
        "latent": vae.encode(pictures.permute(0, 3, 1, 2)), "picture": vae.decode(x[0]).permute(0, 2, 3, 1), "told": told[0].permute(0, 2, 3, 1),
        "before": before, "v_alone": torch.stack([v(t, None) for t in (0.0, 437.5, 999.0)]), "v_after": torch.stack([v(t, before) for t in (0.0, 437.5, 999.0)]),
        "v_silent": dit(x, torch.tensor([437.5]), silent, None),
        "segmented": load_segmenter(folder / "segmenter.safetensors")(pictures[:1].permute(0, 3, 1, 2)).permute(0, 2, 3, 1),
        "sampled": ddim_sample(lambda y, t: dit(y, t, told, before), x, 8), "sampled_guided": ddim_sample(guided, x, 4),
    }


def main(folder):
    OUT.mkdir(parents=True, exist_ok=True)
    for name in KEPT:
        shutil.copy(folder / name, OUT / name)
    for name in ("vae", "dit", "segmenter"):
        shutil.copy(folder / f"{name}.safetensors", SHIPPED / f"pictures_{name}.safetensors")
    save_file({k: v.contiguous() for k, v in golden(folder).items()}, OUT / "golden.safetensors")
    for path in OUT.iterdir():
        path.chmod(0o644)
    print({p.name: p.stat().st_size for p in OUT.iterdir()})


if __name__ == "__main__":
    main(Path(sys.argv[1]))
