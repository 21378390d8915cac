"""Trains the diffusion that refines: python train_refiner.py --data DIR --vae W.safetensors --fine W.safetensors --minutes M -o W.safetensors [--resume]"""
import json

import numpy as np
import torch

import losses
from data import Frames, as_tensor, prefetch
from loop import diffusion_arguments, pick_device, train_diffusion
from models.occ_vae import latent_space, load_vae
from models.refiner import Refiner
from pack import pack
from pack_refiner import KINDS, PackedPairs, name_of, pack_refiner
from schedule import alpha_bar, ddim_sample, noised

NOT_TOLD = 0.2  # share of samples that do not hear the draft


def draw_batch(pairs, rng, batch, cells):
    found = [pairs.read(rng.integers(len(pairs)), rng.integers(0, 51 - cells, 2), cells) for _ in range(batch)]
    fine, rough, told, coarse = (torch.from_numpy(np.stack(parts)).float() for parts in zip(*found))
    return fine, rough, told * torch.from_numpy(rng.random((batch, 1, 1, 1)) >= NOT_TOLD), coarse


def loss_of(model, abar, fine, rough, told, coarse, generator=None):
    noisy, t, truth, balance = noised(abar, fine, generator)
    error = ((model(noisy, t, rough, told, coarse) - truth) ** 2).mean((1, 2, 3))
    return (error * balance).mean(), error.detach().mean().item()


@torch.no_grad()
def figures(model, vae, abar, pairs, frames, device, count, steps=4):
    """Held-out error of v, and agreement with the truth of what is refined beside that of what it was refined from."""
    generator, out = torch.Generator().manual_seed(1), {"v": []}
    confusion = {f"{kind}_{what}": losses.Confusion() for kind in KINDS for what in ("rough", "refined")}
    for at in range(min(2 * count, len(pairs))):
        fine, *seen = (torch.from_numpy(np.array(part)[None]).float().to(device) for part in pairs.read(at))
        out["v"] += [loss_of(model, abar, fine, *seen, generator)[1] for _ in range(4)]
        made = ddim_sample(lambda x, t: model(x, t, *seen), torch.randn(fine.shape, generator=generator).to(device), steps)
        truth = as_tensor([frames.read(at // 2, KINDS[at % 2])])
        for what, latent in (("rough", seen[0]), ("refined", made)):
            confusion[f"{KINDS[at % 2]}_{what}"].add(truth.to(device), vae.decode(latent))
    out["v"] = float(np.mean(out["v"]))
    return out | {f"{name}_{what}": getattr(c, what)() for name, c in confusion.items() for what in ("miou", "iou")}


def main():
    p = diffusion_arguments(__doc__, batch=16, held_out=8)
    p.add_argument("--fine", required=True, help="fine VAE; of the coarse one, its decoder counts too: take them as they ship")
    p.add_argument("--frames", type=int, default=1200, help="frames that are packed for it, 1.6 MB each")
    p.add_argument("--cells", type=int, default=20, help="coarse cells along a side of what a step sees")
    args = p.parse_args()
    torch.manual_seed(args.seed)
    device, dtype = pick_device(args.threads)
    pack(args.data, args.vae, device, dtype)
    folders = pack_refiner(args.data, args.vae, args.fine, args.frames, device, dtype)
    pairs, held_out, frames = PackedPairs(folders["train"]), PackedPairs(folders["val"]), Frames(args.data / "val")
    vae = load_vae(args.fine, device)
    model, abar = Refiner().to(device, memory_format=torch.channels_last), alpha_bar()
    meta = {"kind": "refiner", "config": json.dumps(model.config.as_dict()), "seed": args.seed, "data": args.data, "frames": len(pairs) // 2,
            "vaes": name_of(args.vae, args.fine), "fine": latent_space(args.fine)}
    train_diffusion(model, args, meta, device, dtype, note_minutes=8.0,
                    batches=lambda rng: prefetch(lambda: draw_batch(pairs, rng, args.batch, args.cells)),
                    loss_of=lambda model, *batch: loss_of(model, abar, *batch),
                    figures=lambda ema: figures(ema, vae, abar, held_out, frames, device, args.held_out))


if __name__ == "__main__":
    main()
