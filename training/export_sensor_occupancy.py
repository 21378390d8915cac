"""What train_sensor_occupancy.py left -> the shipped f16 weights in assets/weights, with log and card, and in weights/sensor_occupancy held-out figures, a picture, and
the goldens of the parity tests.

python export_sensor_occupancy.py RUNS/sensor_occupancy.safetensors --data DIR --data-command "..." [--frames 64]
The goldens are computed from the f16 values, in f32, as the Rust program will compute: a map of 16 x 16 columns by the shipped network and by a tiny one, which
lies beside it; the input of a few columns; what is painted on voxels from pictures that any language makes alike.
"""
import argparse
import json
from pathlib import Path

import numpy as np
import torch
from PIL import Image
from safetensors.torch import save_file

from export import read, uniform
from export_layout import write_card
from export_perception import SHIPPED, golden_returns, number
from models.lidar_perceiver import PILLAR, pillars
from models.occ_vae import FREE, HEIGHT
from models.segmenter import CLASSES as SHOWN
from models.sensor_occupancy import WAY, SensorOccupancy, SensorOccupancyConfig, load_sensor_occupancy, painted, ways
from sensor_data import ARMS, SensorFrames, heard, load_segmenter
from train_sensor_occupancy import evaluated

OUT = Path(__file__).resolve().parent / "weights" / "sensor_occupancy"
SIDE, MIDDLE = 16, slice(94, 106)
TINY = SensorOccupancyConfig(widths=(8, 12, 16), kernels=((3,), (1, 3), (3,)), paint=2)
NAMES = ("others", "barrier", "bicycle", "bus", "car", "construction vehicle", "motorcycle", "pedestrian", "traffic cone", "trailer", "truck", "drivable", "other flat",
         "sidewalk", "terrain", "manmade", "vegetation")
COLORS = np.array([[0, 0, 0], [255, 120, 50], [255, 192, 203], [255, 255, 0], [0, 150, 245], [0, 255, 255], [200, 180, 0], [255, 0, 0], [255, 240, 150], [135, 60, 0],
                   [160, 32, 240], [120, 90, 120], [139, 137, 137], [75, 0, 75], [150, 240, 80], [200, 200, 210], [0, 120, 0], [20, 20, 20]], np.uint8)


def tiny():
    """A network whose weights are as random as its shape is small."""
    torch.manual_seed(1)
    net = SensorOccupancy(TINY).eval().requires_grad_(False)
    for p in net.parameters():
        torch.nn.init.normal_(p, 0.0, 0.2)
    return net


def classes(shape, stream):
    """Classes from 0 to 22 that any language makes alike."""
    u = uniform(int(np.prod(shape)), stream)
    return ((u + 1.75) / 3.5 * (SHOWN + 1)).floor().clamp(0, SHOWN).to(torch.uint8).view(*shape)


@torch.no_grad()
def golden(net, small):
    """Inputs that any language makes alike, and what is made of them."""
    out = {}
    paint = classes((200, 200, HEIGHT), 5)
    for name, network in (("shipped", net), ("tiny", small)):
        width = PILLAR + WAY + HEIGHT * network.config.paint
        x = uniform(SIDE * SIDE * width, 2).view(1, SIDE, SIDE, width).permute(0, 3, 1, 2)
        logits = network.of_columns(x)
        out[f"{name}_logits"] = logits[0].flatten(2)
        columns = network.columns(pillars(golden_returns())[None], ways()[None], paint[None])
        out[f"{name}_columns"] = columns[0, :, MIDDLE, MIDDLE].permute(1, 2, 0)
    return {k: v.contiguous() for k, v in out.items()}


def golden_paint(frames):
    """What the cameras of a frame paint: their numbers, classes that any language makes alike, and the voxels of a few columns."""
    arrays, i = frames.index[0]
    intrinsic, pose = (torch.from_numpy(np.array(arrays[name][i])) for name in ("intrinsic", "map_from_camera"))
    shown = classes((len(pose), 144, 256), 6).clamp(max=SHOWN - 1)
    out = painted(shown, intrinsic, pose)
    return {"painted": out[::8, ::8].contiguous()}


def top(labels):
    """u8 [200,200,16] -> the colour of the highest voxel of each column, ahead is up."""
    filled = labels != FREE
    high = labels.shape[2] - 1 - filled[..., ::-1].argmax(2)
    label = np.where(filled.any(2), np.take_along_axis(labels, high[..., None], 2)[..., 0], FREE)
    shade = np.where(filled.any(2), 0.55 + 0.45 * high / 15, 1)[..., None]
    return Image.fromarray(np.ascontiguousarray((COLORS[label] * shade).astype(np.uint8)[::-1, ::-1])).resize((400, 400), Image.NEAREST)


@torch.no_grad()
def sheet(net, frames, which):
    """A row per frame: truth, then what is told by both, by the LiDAR, by the cameras."""
    rows = []
    for frame in which:
        points, _, paint, dense = frames.read(frame)
        row = [top(dense)]
        for sensors in ARMS.values():
            parts = heard(points, paint, *sensors)
            row.append(top(net(*(part[None] for part in parts))[0].argmax(-1).to(torch.uint8).numpy()))
        rows.append(row)
    out = Image.new("RGB", (4 * 406 - 6, len(rows) * 406 - 6), (60, 60, 60))
    for j, row in enumerate(rows):
        for i, one in enumerate(row):
            out.paste(one, (i * 406, j * 406))
    return out


def card(meta, figures, count, data_command):
    line = lambda cells: "| " + " | ".join(cells) + " |"
    arms = list(figures)
    lines = ["# Occupancy from LiDAR and cameras", "", "Trained on this project's own procedural worlds; no frame of a data set and no foreign weights went in.", "",
             f"- Data: `{data_command}`; {meta['frames']} training frames, seed {meta['seed']}, {meta['steps']} steps, {meta['samples']} samples, {meta['minutes']} minutes of one core; log: "
             "`assets/weights/sensor_occupancy.csv`. What cameras show is what the shipped segmenter sees in their pictures.",
             f"- Figures: {count} held-out worlds (seed 2), `export_sensor_occupancy.py`, all in `figures.json`. `sheet.png`: truth, told by both, by the LiDAR, by the cameras.", "",
             "By the sensors that the network hears; in columns within 1.2 m of a return, in brackets in all columns of the window", "",
             line(["", *arms]), "|---" * (1 + len(arms)) + "|"]
    pair = lambda key: [f"{number(figures[a]['near'][key])} ({number(figures[a]['all'][key])})" for a in arms]
    lines += [line(["IoU of what is solid", *pair("iou")]), line(["mIoU", *pair("miou")])]
    for c, name in enumerate(NAMES):
        found = [[figures[a][w]["classes"][c] for w in ("near", "all")] for a in arms]
        if any(v is not None for pair_ in found for v in pair_):
            lines.append(line([name, *(f"{number(n)} ({number(w)})" for n, w in found)]))
    return "\n".join(lines) + "\n"


def main():
    p = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    p.add_argument("weights", type=Path)
    p.add_argument("--data", type=Path, required=True, help="folder with val/")
    p.add_argument("--segmenter", type=Path, default=SHIPPED / "pictures_segmenter.safetensors")
    p.add_argument("--data-command", required=True, help="how the data were made, for the card")
    p.add_argument("--frames", type=int, help="of val/ for the figures; all if left out")
    args = p.parse_args()
    torch.set_num_threads(1)
    tensors, meta = read(args.weights)
    if meta.get("kind") != "sensor_occupancy":
        raise SystemExit(f"{args.weights}: expected weights of sensor_occupancy, found {meta.get('kind')}")
    shipped = write_card(SHIPPED, "sensor_occupancy", args.weights, tensors, meta, args.data_command, f"{float(meta['minutes'])} minutes of one core")
    OUT.mkdir(parents=True, exist_ok=True)
    net, small = load_sensor_occupancy(shipped), tiny()
    frames = SensorFrames(args.data / "val", load_segmenter(args.segmenter), args.frames)
    save_file(golden(net, small) | golden_paint(frames), OUT / "golden.safetensors")
    save_file(small.state_dict(), OUT / "tiny.safetensors", {"kind": "sensor_occupancy", "config": json.dumps(TINY.as_dict())})
    figures = evaluated(net, frames, range(len(frames)))
    (OUT / "figures.json").write_text(json.dumps(figures, indent=1) + "\n")
    (OUT / "CARD.md").write_text(card(meta, figures, len(frames), args.data_command))
    sheet(net, frames, range(min(3, len(frames)))).save(OUT / "sheet.png")
    for path in (shipped, *OUT.iterdir()):
        path.chmod(0o644)
    print({path.name: path.stat().st_size for path in (shipped, *sorted(OUT.iterdir()))})


if __name__ == "__main__":
    main()
