"""What train_perception.py left -> the shipped f16 weights in assets/weights, with log and card, and in weights/perception held-out figures, a picture, and the
golden of the parity tests.

python export_perception.py RUNS/perceiver.safetensors --data DIR --data-command "..." [--frames 256]
The golden is computed from the f16 values, in f32, as the Rust program will compute: maps of 32 x 32 columns by the shipped network and by a tiny one, which
lies beside it; pillars of a few returns; boxes of a map of numbers.
"""
import argparse
import json
from pathlib import Path

import torch
from safetensors.torch import save_file

from export import read, uniform
from export_layout import write_card
from models.lidar_perceiver import BOX, GROUPS, PILLAR, STANDS, LidarPerceiver, PerceiverConfig, decode, load_perceiver, pillars
from perception_data import PerceptionFrames
from perception_eval import evaluated_by
from perception_sheet import sheet

OUT = Path(__file__).resolve().parent / "weights" / "perception"
SHIPPED = Path(__file__).resolve().parent.parent / "assets" / "weights"
SIDE, RETURNS, MIDDLE, CELLS = 32, 400, slice(94, 106), 16
TINY = PerceiverConfig(widths=(8, 12, 16), kernels=((3,), (1, 3), (3,)))


def golden_returns():
    """Returns [P,4] around the origin that any language makes alike; two are outside the window, two are not finite."""
    u = uniform(RETURNS * 4, 1).view(RETURNS, 4)
    points = u * torch.tensor([1.25, 1.25, 3.0, 64.0]) + torch.tensor([0.0, 0.0, 1.0, 120.0])
    points[0, 0], points[1, 1], points[2, 2], points[3, 3] = 40.0, -41.0, float("nan"), float("inf")
    return points


def tiny():
    """A network whose weights are as random as its shape is small."""
    torch.manual_seed(1)
    net = LidarPerceiver(TINY).eval().requires_grad_(False)
    for p in net.parameters():
        torch.nn.init.normal_(p, 0.0, 0.2)
    return net


@torch.no_grad()
def golden(net, small):
    """Inputs that any language makes alike, and what is made of them."""
    x = uniform(SIDE * SIDE * PILLAR, 2).view(1, SIDE, SIDE, PILLAR).permute(0, 3, 1, 2)
    out = {"pillars": pillars(golden_returns())[:, MIDDLE, MIDDLE].permute(1, 2, 0)}
    for name, network in (("shipped", net), ("tiny", small)):
        stands, boxes = network(x)
        out |= {f"{name}_stands": stands[0].permute(1, 2, 0), f"{name}_boxes": boxes[0].permute(1, 2, 0)}
    width = len(GROUPS) + BOX
    out["decoded"] = decode(uniform(CELLS * CELLS * width, 3).view(CELLS, CELLS, width).permute(2, 0, 1), 0.6)
    return {k: v.contiguous() for k, v in out.items()}


def number(value):
    return "–" if value is None else f"{value:.3f}".lstrip("0") if abs(value) < 1 else f"{value:.2f}"


def card(meta, figures, data_command):
    """What stands in CARD.md: how the weights came about, and tables of the held-out figures by the LiDAR that made the sweep."""
    kinds = list(figures)
    line = lambda cells: "| " + " | ".join(cells) + " |"
    head = lambda first, names: [line([first, *names]), "|---" * (1 + len(names)) + "|"]
    frames = ", ".join(f"{k} {figures[k]['frames']}" for k in kinds)
    lines = ["# LiDAR perceiver", "", "Trained on this project's own procedural worlds; no frame of a data set and no foreign weights went in.", "",
             f"- Data: `{data_command}`; {meta['frames']} training frames, seed {meta['seed']}, {meta['steps']} steps, {meta['samples']} samples, {meta['minutes']} minutes of one core; log: "
             "`assets/weights/lidar_perceiver.csv`.", f"- Figures: held-out worlds (seed 2), by what made the sweep ({frames}); `export_perception.py`, all in `figures.json`. `sheet.png`: sweep, truth, prediction.", "",
             "IoU of what stands in columns within 1.2 m of a return (of all columns in the last row)", "", *head("", kinds)]
    names = ["miou", *(n for n in STANDS)]
    lines += [line([n, *(number(figures[k]["standing"]["seen"].get(n)) for k in kinds)]) for n in names]
    lines += [line(["miou, all", *(number(figures[k]["standing"]["all"]["miou"]) for k in kinds)]), "",
              "Average precision of boxes: mean over 0.5, 1, 2 and 4 m, in brackets at 2 m", "", *head("", kinds),
              line(["mAP", *(number(figures[k]["boxes"]["map"]) for k in kinds)])]
    of = {k: figures[k]["boxes"]["groups"] for k in kinds}
    lines += [line([g, *(f"{number(of[k][g]['mean_ap'])} ({number(of[k][g]['ap']['2.0'])})" if g in of[k] else "–" for k in kinds)]) for g in GROUPS]
    lines += [line([what, *(number(figures[k]["boxes"][key]) for k in kinds)]) for what, key in (("ghosts a frame, score .3 on", "ghosts_per_frame"), ("precision there", "precision"))]
    ranges = list(next(iter(of["all"].values()))["recall"]) if of["all"] else []
    lines += ["", "Recall at score .3 and 2 m by distance, all sweeps (of how many)", "", *head("", ranges)]
    lines += [line([g, *(f"{number(v[0])} ({v[1]})" for v in found["recall"].values())]) for g, found in of["all"].items()]
    return "\n".join(lines) + "\n"


def main():
    p = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    p.add_argument("weights", type=Path)
    p.add_argument("--data", type=Path, required=True, help="folder with val/")
    p.add_argument("--data-command", required=True, help="how the data were made, for the card")
    p.add_argument("--frames", type=int, help="of val/ for the figures; all if left out")
    args = p.parse_args()
    torch.set_num_threads(1)
    tensors, meta = read(args.weights)
    if meta.get("kind") != "lidar_perceiver":
        raise SystemExit(f"{args.weights}: expected weights of lidar_perceiver, found {meta.get('kind')}")
    shipped = write_card(SHIPPED, "lidar_perceiver", args.weights, tensors, meta, args.data_command, f"{float(meta['minutes'])} minutes of one core")
    OUT.mkdir(parents=True, exist_ok=True)
    net, small = load_perceiver(shipped), tiny()
    save_file(golden(net, small), OUT / "golden.safetensors")
    save_file(small.state_dict(), OUT / "tiny.safetensors", {"kind": "lidar_perceiver", "config": json.dumps(TINY.as_dict())})
    frames = PerceptionFrames(args.data / "val", limit=args.frames)
    sources = [int(a["source"][i]) for a, i in frames.index]
    kinds = {"all": set(range(len(frames)))} | {name: {i for i, s in enumerate(sources) if s == k} for k, name in enumerate(("surfaces", "learned", "voxels"))}
    figures = evaluated_by(net, frames, {name: which for name, which in kinds.items() if which})
    (OUT / "figures.json").write_text(json.dumps(figures, indent=1) + "\n")
    (OUT / "CARD.md").write_text(card(meta, figures, args.data_command))
    sheet(net, frames, range(min(3, len(frames)))).save(OUT / "sheet.png")
    for path in (shipped, *OUT.iterdir()):
        path.chmod(0o644)
    print({path.name: path.stat().st_size for path in (shipped, *sorted(OUT.iterdir()))})


if __name__ == "__main__":
    main()
