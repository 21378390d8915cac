"""VAE encode and decode and a step of the transformer: ours beside PyTorch in f32, same weights, same inputs."""
from common import ROOT, Ours, agrees, arguments, beside, needs

needs("torch", "numpy", "safetensors")
import json
import sys

import numpy as np
import torch
from safetensors import safe_open

sys.path.insert(0, str(ROOT / "training"))
from models.occ_dit import COLUMN, GROUPS, NAMED, DitConfig, OccDit, condition_of
from models.occ_vae import OccVae, VaeConfig


def network(kind, make, config):
    with safe_open(ROOT / f"assets/weights/{kind}.safetensors", "pt") as f:
        net = make(config(**json.loads(f.metadata()["config"])))
        net.load_state_dict({k: f.get_tensor(k).float() for k in f.keys()})
    return net.eval()


def condition(dit, bev, heading, draft):
    """What the transformer is told in benches/peers.rs: layout i32 [200,200], headings u8 [200,200] and the draft's latent [50,50,8];
    everything is to be generated, no background, no ground and no number by name is given."""
    cells, columns = draft.shape[:2], bev.shape
    told = condition_of(mask=torch.ones(1, *cells), context=torch.zeros(1, *draft.shape), draft=draft[None], bev=bev[None],
                        heading=heading[None], given=torch.zeros(1, *cells, GROUPS),
                        columns=torch.zeros(1, *columns, COLUMN, dtype=torch.uint8), ground=torch.zeros(1, *cells))
    named = torch.zeros(1, 2 * NAMED + 1)
    named[0, -1] = (draft != 0).any()
    return dit.condition(told, named)


def main():
    args = arguments()
    torch.set_num_threads(args.threads)
    ours = Ours(args.threads)
    x = ours.arrays("pt")
    vae, dit = network("occ_vae", OccVae, VaeConfig), network("occ_dit", OccDit, DitConfig)
    labels, latent = x["labels"][None], x["latent"][None]
    with torch.inference_mode():
        agrees("encode", x["latent"], vae.encode(labels)[0], 1e-4)
        decoded = vae.decode(latent)[0]
        other = (decoded != x["decoded"]).float().mean().item()
        print(f"decode                     {100 * other:.4f} % of the voxels differ (allowed 0.01)")
        if other > 1e-4:
            sys.exit("decode: the two sides compute different things")
        told = condition(dit, x["bev"], x["heading"], x["draft"])
        t = torch.tensor([500.0])
        agrees("DiT step", x["v"], dit(latent, t, told)[0], 1e-4)
        peer = f"torch {torch.__version__} f32"
        beside("VAE encode", lambda: ours("encode"), lambda: vae.encode(labels), args.runs, peer)
        beside("VAE decode", lambda: ours("decode"), lambda: vae.decode(latent), args.runs, peer)
        beside("DiT step", lambda: ours("dit"), lambda: dit(latent, t, told), args.runs, peer)
        block, c = dit.blocks[0], torch.randn(1, dit.config.width)
        tokens = torch.randn(1, 25, 25, dit.config.width)
        beside("DiT block (ours: step / 8)", lambda: ours("dit") / len(dit.blocks), lambda: block(tokens, c), args.runs, peer)


if __name__ == "__main__":
    main()
