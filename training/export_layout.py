"""Trained weights of the layout network -> assets/weights (f16, card) and the golden of its parity test.

python export_layout.py --weights RUNS/layout.safetensors --data DIR --data-command "..."
"""
import argparse
import hashlib
import json
from pathlib import Path

import numpy as np
import torch
from safetensors.torch import load_file, save_file

from export import ROOT, halved, last_row, read
from models.layout import Layout, LayoutConfig
from train_layout import Frames, batch_of


def write_card(folder, kind, path, tensors, meta, data_command, time_text):
    """Weights in f16, the training log, and the kind's section of card.json and CARD.md."""
    out = folder / f"{kind}.safetensors"
    save_file(halved(tensors), out, meta)
    log = Path(path).with_suffix(".csv")
    if log.exists():
        (folder / f"{kind}.csv").write_text(log.read_text())
    add_section(folder, kind, tensors, meta, data_command, time_text, last_row(path))
    return out


def add_section(folder, kind, tensors, meta, data_command, time_text, held_out):
    """The section of card.json and CARD.md about the weights of a kind that lie in the folder."""
    card_file, text_file = folder / "card.json", folder / "CARD.md"
    card = json.loads(card_file.read_text()) if card_file.exists() else {}
    text = text_file.read_text() if text_file.exists() else "# Weights\n"
    out = folder / f"{kind}.safetensors"
    c = card[kind] = meta | {"config": json.loads(meta["config"]), "bytes": out.stat().st_size, "data_command": data_command,
                             "sha256": hashlib.sha256(out.read_bytes()).hexdigest(),
                             "parameters": sum(v.numel() for v in tensors.values()), "held_out": held_out}
    lines = [f"## {kind}", "", f"- {c['parameters']:,} parameters, {c['bytes'] / 1e6:.2f} MB; config `{json.dumps(c['config'])}`",
             f"- Data: `{data_command}`; recipe: `training/README.md`",
             f"- seed {c['seed']}, {c['steps']} steps, {c['samples']} samples, {time_text}",
             "- held-out at the end of training: " + (", ".join(f"{k} {v}" for k, v in held_out.items()) or "no log"), ""]
    start = text.find(f"\n## {kind}\n")
    if start >= 0:
        end = text.find("\n## ", start + 4)
        text = text[:start] + (text[end:] if end >= 0 else "\n")
    card_file.write_text(json.dumps(card, indent=1) + "\n")
    text_file.write_text(text.rstrip("\n") + "\n\n" + "\n".join(lines))
    print(f"{out}: {c['bytes'] / 1e6:.2f} MB, {c['parameters']} parameters")


def export_net(doc, kind, net_of, golden, kept=()):
    """The command line of a network that is exported by itself: weights, card and, of the shipped weights, its golden. `net_of(config)` is the
    network, `kept` what its file says beside the usual."""
    p = argparse.ArgumentParser(description=doc, formatter_class=argparse.RawDescriptionHelpFormatter)
    p.add_argument("--weights", type=Path, required=True)
    p.add_argument("--data-command", required=True, help="how the data were made, for the card")
    p.add_argument("--folder", type=Path, default=ROOT / "assets/weights")
    p.add_argument("--goldens", type=Path, default=ROOT / "tests/reference")
    args = p.parse_args()
    tensors, meta = read(args.weights)
    if meta.get("kind") != kind:
        raise SystemExit(f"{args.weights}: expected weights of {kind}, found {meta.get('kind')}")
    meta = {k: meta[k] for k in ("kind", "config", "seed", "steps", "samples", "minutes", *kept)}
    out = write_card(args.folder, kind, args.weights, tensors, meta, args.data_command, f"{float(meta['minutes']) / 60:.2f} h")
    net = net_of(json.loads(meta["config"])).eval()
    net.load_state_dict({k: v.float() for k, v in load_file(out).items()})
    save_file(golden(net), args.goldens / f"parity_{kind}.safetensors")


@torch.no_grad()
def golden(net, frames):
    """Two tasks on held-out frames: objects on a given road (map shown), a road under given objects (no map)."""
    out = {}
    for name, index, task in (("place", 0, 0), ("road", 1, 1)):
        b = batch_of(frames, np.array([index]), None, task)
        gen = torch.Generator().manual_seed(11)
        x = torch.randn(b["x0"].shape, generator=gen) * b["valid"]
        shown = x * ~b["locked"][..., None] + b["given"]
        # Away from the edges of map cells, where rounding would decide which cell is read.
        cell = (shown[..., :2] * 20 + 40) * 1.25
        close = ((cell - cell.round()).abs() < 1e-3).any(-1) & (b["shape"] == 1)
        assert not (close & ~b["locked"]).any(), "choose another seed"
        free = b["valid"] * ~b["locked"][..., None]
        for t in (950, 120):
            out[f"{name}_v{t}"] = (net(shown, torch.tensor([float(t)]), b) * free)[0].contiguous()
        e = torch.stack([b["edges"][1], b["edges"][2], b["edges"][3]], 1).to(torch.int32)
        distance = torch.where(b["distance"][:, 1] > 0, b["distance"][:, 0] * 20, torch.full((len(e),), -1.0))
        raw = frames.arrays["map"][index] if task == 0 else np.zeros(0, np.uint8)
        out |= {f"{name}_x": x[0].contiguous(), f"{name}_edges": e.contiguous(), f"{name}_distance": distance.contiguous(),
                f"{name}_values": b["x0"][0].contiguous(), f"{name}_map": torch.from_numpy(raw.reshape(-1).copy()),
                f"{name}_nodes": torch.stack([b[k][0] for k in ("kind", "state", "size", "shape")] + [b["locked"][0].long()], 1)
                .to(torch.int32).contiguous()}
    return out


def main():
    p = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    p.add_argument("--weights", type=Path, required=True)
    p.add_argument("--data", type=Path, required=True, help="the data set; the golden is of held-out frames")
    p.add_argument("--data-command", required=True, help="how the data were made, for the card")
    p.add_argument("--folder", type=Path, default=ROOT / "assets/weights")
    p.add_argument("--goldens", type=Path, default=ROOT / "tests/reference")
    args = p.parse_args()
    tensors, meta = read(args.weights)
    if meta.get("kind") != "layout":
        raise SystemExit(f"{args.weights}: expected weights of layout, found {meta.get('kind')}")
    meta = {k: meta[k] for k in ("kind", "config", "seed", "steps", "samples", "minutes")}
    out = write_card(args.folder, "layout", args.weights, tensors, meta, args.data_command,
                     f"{float(meta['minutes']) / 60:.2f} h on one busy thread")
    net = Layout(LayoutConfig(**json.loads(meta["config"]))).eval()
    net.load_state_dict({k: v.float() for k, v in load_file(out).items()})
    save_file(golden(net, Frames(args.data / "val")), args.goldens / "parity_layout.safetensors")


if __name__ == "__main__":
    main()
