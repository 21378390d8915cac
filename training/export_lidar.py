"""Trained weights of the learned LiDAR -> assets/weights (f16, card) and the golden of tests/parity.rs.

python export_lidar.py --weights RUNS/lidar.safetensors --data DIR --data-command "..." [--flat RUNS/lidar_flat.safetensors]
"""
import argparse
import hashlib
import json
from pathlib import Path

import numpy as np
import torch
from safetensors.torch import load_file, save_file

from export import ROOT, halved, last_row, read
from lidar_data import LidarFrames, directions
from models.lidar import SHAPE, Lidar, LidarConfig, Sites, lookup_of
from train_lidar import sdf_at


@torch.no_grad()
def golden(net, frames):
    """Voxels of a part of a frame, and for some of its rays: samples, their distances, and what the rays meet."""
    coords, classes = frames.surface(0, "labels")
    use = (np.abs(coords[:, :2] - 100) < 36).all(1)
    coords, classes = coords[use], classes[use]
    data = frames.read(0)
    d = torch.from_numpy(np.ascontiguousarray(directions(data).reshape(-1, 3)[::701]))
    sites = Sites(coords, classes)
    t = torch.linspace(1.0, 14.0, 66).repeat(len(d), 1) * torch.linspace(0.6, 1.0, len(d))[:, None]
    origin = torch.from_numpy(data["origin"]).expand(len(d), 3)
    b = {"t": t, "valid": torch.ones_like(t, dtype=torch.bool), "origin": origin, "d": d, "lookup": lookup_of(sites.volume)}
    geometry, appearance = net.features(sites)
    f = sdf_at(net, geometry, b)
    depth, log_pass, strength, drop, _, _ = net.render(appearance, b["lookup"], origin, d, t, f)
    keys = np.ravel_multi_index(coords.T, SHAPE).astype(np.int32)
    return {"keys": torch.from_numpy(keys), "classes": torch.from_numpy(classes), "origin": origin[0].contiguous(), "directions": d,
            "t": t, "sdf": f, "depth": depth, "log_pass": log_pass.clamp(min=-30), "strength": strength.clone(), "drop": drop.clone(),
            "every_97th_geometry": geometry.reshape(-1)[::97].contiguous(), "every_97th_appearance": appearance.reshape(-1)[::97].contiguous()}


def main():
    p = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    p.add_argument("--weights", type=Path, required=True)
    p.add_argument("--flat", type=Path, help="weights of the ablation without the UNet")
    p.add_argument("--data", type=Path, required=True, help="the data set; the golden is a held-out frame")
    p.add_argument("--data-command", required=True, help="how the data were made, for the card")
    p.add_argument("--folder", type=Path, default=ROOT / "assets/weights")
    p.add_argument("--goldens", type=Path, default=ROOT / "tests/reference")
    args = p.parse_args()
    card_file, text_file = args.folder / "card.json", args.folder / "CARD.md"
    card = json.loads(card_file.read_text()) if card_file.exists() else {}
    text = text_file.read_text() if text_file.exists() else "# Weights\n"
    for kind, path in [("lidar", args.weights)] + ([("lidar_flat", args.flat)] if args.flat else []):
        tensors, meta = read(path)
        if meta.get("kind") != "lidar":
            raise SystemExit(f"{path}: expected weights of lidar, found {meta.get('kind')}")
        meta = {k: meta[k] for k in ("kind", "config", "seed", "steps", "samples", "minutes")}
        out = args.folder / f"{kind}.safetensors"
        save_file(halved(tensors), out, meta)
        log = Path(path).with_suffix(".csv")
        if log.exists():
            (args.folder / f"{kind}.csv").write_text(log.read_text())
        held_out = last_row(path)
        card[kind] = meta | {"config": json.loads(meta["config"]), "bytes": out.stat().st_size, "data_command": args.data_command,
                             "sha256": hashlib.sha256(out.read_bytes()).hexdigest(),
                             "parameters": sum(v.numel() for v in tensors.values()), "held_out": held_out}
        c, what = card[kind], "" if kind == "lidar" else " (the ablation without UNet, for `eval lidar`)"
        lines = [f"## {kind}{what}", "", f"- {c['parameters']:,} parameters, {c['bytes'] / 1e6:.2f} MB; config `{json.dumps(c['config'])}`",
                 f"- Data: `{args.data_command}`; recipe: `training/README.md`",
                 f"- seed {c['seed']}, {c['steps']} steps, {float(c['minutes']) / 60:.2f} h on one busy thread",
                 "- held-out at the end of training: " + (", ".join(f"{k} {v}" for k, v in held_out.items()) or "no log"), ""]
        start = text.find(f"\n## {kind}{what}\n")
        if start >= 0:
            end = text.find("\n## ", start + 4)
            text = text[:start] + (text[end:] if end >= 0 else "\n")
        text = text.rstrip("\n") + "\n\n" + "\n".join(lines)
        print(f"{out}: {c['bytes'] / 1e6:.2f} MB, {c['parameters']} parameters")
        if kind == "lidar":
            net = Lidar(LidarConfig(**c["config"])).eval()
            net.load_state_dict({k: v.float() for k, v in load_file(out).items()})
            save_file(golden(net, LidarFrames(args.data / "val")), args.goldens / "parity_lidar.safetensors")
    card_file.write_text(json.dumps(card, indent=1) + "\n")
    text_file.write_text(text)


if __name__ == "__main__":
    main()
