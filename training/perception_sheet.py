"""Pictures of what a LiDAR perceiver sees: per frame the sweep, what stands and true boxes, what the network says. Found boxes are white, ghosts yellow,
missed ones red, those of no return grey. Up is ahead (x), left is left (y)."""
import numpy as np
import torch
from PIL import Image, ImageDraw

from models.lidar_perceiver import HALF_M, decode, pillars
from perception_data import IGNORED, asked_for
from perception_eval import SCORE, matched

COLORS = np.array([[84, 88, 100], [178, 166, 186], [176, 182, 150], [60, 110, 80], [214, 212, 220], [0, 114, 178], [230, 159, 0], [213, 94, 0],
                   [190, 120, 40]] + [[0, 0, 0]] * 247, np.uint8)
SIDE, GAP = 400, 6


def panel(columns):
    """[200,200] of what stands or [200,200,3] -> a picture with x up and y to the left."""
    rgb = COLORS[columns] if columns.ndim == 2 else columns
    return Image.fromarray(np.ascontiguousarray(rgb[::-1, ::-1])).resize((SIDE, SIDE), Image.NEAREST)


def outline(draw, box, color):
    """A box (x, y, length, width, yaw) with a line from its centre to its front."""
    x, y, l, w, yaw = box
    c, s = np.cos(yaw), np.sin(yaw)
    at = lambda a, b: tuple((HALF_M - v) / (2 * HALF_M) * SIDE for v in (y + a * s + b * c, x + a * c - b * s))
    corners = [at(a * l / 2, b * w / 2) for a, b in ((1, 1), (-1, 1), (-1, -1), (1, -1), (1, 1))]
    draw.line(corners, color)
    draw.line([at(0, 0), at(l / 2, 0)], color)


@torch.no_grad()
def row(net, frames, frame):
    points, boxes, standing, _ = frames.read(frame)
    x = pillars(torch.from_numpy(points))
    logits, numbers = net(x[None])
    said, found = logits[0].argmax(0).numpy().astype(np.uint8), decode(numbers[0], SCORE).numpy()
    true, groups = asked_for(boxes)
    seen = true[:, 8] > 0
    picked = np.full(len(found), False)
    missed = seen.copy()
    for g in range(5):
        mine, wanted = np.flatnonzero(found[:, 0] == g), np.flatnonzero((groups == g) & seen)
        pick = matched(found[mine, 2:4], true[wanted, :2], 2.0)
        picked[mine] = pick >= 0
        missed[wanted[pick[pick >= 0]]] = False
    height = np.clip((x[12].numpy() * 3 + 1) / 4, 0.15, 1) * (x[15].numpy() > 0)
    panels = [panel((np.stack([height] * 3, -1) * 255).astype(np.uint8)), panel(standing), panel(np.where(standing == IGNORED, IGNORED, said))]
    for box, is_seen, is_missed in zip(true, seen, missed):
        outline(ImageDraw.Draw(panels[1]), box[[0, 1, 3, 4, 6]], (255, 40, 40) if is_missed else (255, 255, 255) if is_seen else (120, 120, 120))
    for box, right in zip(found, picked):
        outline(ImageDraw.Draw(panels[2]), box[[2, 3, 5, 6, 8]], (255, 255, 255) if right else (255, 225, 40))
    return panels


def sheet(net, frames, which):
    """A picture with a row per frame."""
    rows = [row(net, frames, i) for i in which]
    out = Image.new("RGB", (3 * SIDE + 2 * GAP, len(rows) * (SIDE + GAP) - GAP), (20, 20, 20))
    for j, panels in enumerate(rows):
        for i, one in enumerate(panels):
            out.paste(one, (i * (SIDE + GAP), j * (SIDE + GAP)))
    return out
