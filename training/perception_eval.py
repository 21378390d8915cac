"""How well a LiDAR perceiver does on frames: python perception_eval.py W.safetensors DIR.. [--frames N] [--source 0|1|2] [--sheet P.png] [-o F.json].

IoU of what stands in each column, of those within 1.2 m of a return ("seen") and of all; average precision of boxes by the distance of their centres
(0.5, 1, 2, 4 m) as in the nuScenes detection benchmark (1903.11027, section 3: precision and recall above 0.1 count, a box of no return is not
asked for), errors of what was found at 2 m, and recall by distance from the ego frame.
"""
import argparse
import json
from pathlib import Path

import numpy as np
import torch
from torch.nn import functional as F

from models.lidar_perceiver import GROUPS, STANDS, decode, load_perceiver, pillars
from perception_data import IGNORED, PerceptionFrames, asked_for

NEAR_M = (0.5, 1.0, 2.0, 4.0)
RANGES_M = ((0, 10), (10, 20), (20, 30), (30, 57))
SCORE = 0.3  # from which on a box counts as found where no curve is drawn


class Standing:
    """Counts of what is said against what stands."""

    def __init__(self):
        self.counts = {name: np.zeros((len(STANDS), len(STANDS)), np.int64) for name in ("seen", "all")}

    def add(self, logits, truth, pillar):
        """Logits [9,X,Y], truth u8 [X,Y], pillars [19,X,Y] of a frame."""
        said = logits.argmax(0).numpy()
        seen = F.max_pool2d((pillar[15:16] > 0).float()[None], 7, 1, 3)[0, 0].numpy() > 0
        for name, where in (("seen", seen), ("all", np.ones_like(seen))):
            use = where & (truth != IGNORED)
            pair = truth[use].astype(int) * len(STANDS) + said[use]
            self.counts[name] += np.bincount(pair, minlength=len(STANDS) ** 2).reshape(len(STANDS), -1)

    def figures(self):
        out = {}
        for name, c in self.counts.items():
            union = c.sum(0) + c.sum(1) - np.diag(c)
            iou = {s: float(np.diag(c)[i] / union[i]) for i, s in enumerate(STANDS) if c[i].sum()}
            out[name] = {"miou": float(np.mean(list(iou.values()))) if iou else 0.0} | iou
        return out


def matched(found, truth, near_m):
    """For found boxes in order of their scores [K,2], which true one [M,2] each takes (-1 none): the nearest one that is free."""
    taken, out = np.zeros(len(truth), bool), np.full(len(found), -1)
    for k, place in enumerate(found):
        if len(truth) == 0 or taken.all():
            break
        far = np.where(taken, np.inf, np.hypot(*(truth - place).T))
        if far.min() < near_m:
            out[k] = far.argmin()
            taken[out[k]] = True
    return out


def average_precision(scores, right, asked):
    """Area under precision over recall, both above 0.1, scaled to 0..1; None if nothing was asked for."""
    if asked == 0:
        return None
    order = np.argsort(-scores, kind="stable")
    tp = np.cumsum(right[order])
    precision, recall = tp / np.arange(1, len(tp) + 1), tp / asked
    at = np.interp(np.linspace(0, 1, 101), recall, precision, right=0) if len(tp) else np.zeros(101)
    return float(np.clip(at[11:] - 0.1, 0, None).mean() / 0.9)


class Boxes:
    """Found boxes against true ones, by group."""

    def __init__(self):
        self.asked = np.zeros(len(GROUPS), int)
        self.rows = {near: [[] for _ in GROUPS] for near in NEAR_M}  # (score, right)
        self.recall = [[[0, 0] for _ in RANGES_M] for _ in GROUPS]  # found, asked
        self.ghosts, self.kept, self.frames, self.errors = 0, 0, 0, [[] for _ in GROUPS]

    def add(self, found, boxes):
        """Found boxes [K,9] of `decode`, true ones [M,9] of a frame."""
        found, (true, groups) = found.numpy(), asked_for(boxes)
        self.frames += 1
        true, groups = true[true[:, 8] > 0], groups[true[:, 8] > 0]
        for g in range(len(GROUPS)):
            mine, wanted = found[found[:, 0] == g], true[groups == g]
            self.asked[g] += len(wanted)
            for near in NEAR_M:
                pick = matched(mine[:, 2:4], wanted[:, :2], near)
                self.rows[near][g] += list(zip(mine[:, 1], pick >= 0))
                if near == 2.0:
                    for box, p in zip(mine, pick):
                        if p >= 0 and box[1] >= SCORE:
                            self.errors[g].append(errors(box, wanted[p]))
            sure = mine[mine[:, 1] >= SCORE]
            pick = matched(sure[:, 2:4], wanted[:, :2], 2.0)
            self.ghosts, self.kept = self.ghosts + int((pick < 0).sum()), self.kept + len(sure)
            away = np.hypot(*wanted[:, :2].T)
            for r, (low, high) in enumerate(RANGES_M):
                here = np.flatnonzero((away >= low) & (away < high))
                self.recall[g][r][0] += int(np.isin(here, pick).sum())
                self.recall[g][r][1] += len(here)

    def figures(self):
        out = {}
        for g, name in enumerate(GROUPS):
            ap = {}
            for near in NEAR_M:
                rows = np.array(self.rows[near][g], float).reshape(-1, 2)
                ap[str(near)] = average_precision(rows[:, 0], rows[:, 1], self.asked[g])
            if self.asked[g]:
                off = np.array(self.errors[g]).reshape(-1, 4)
                out[name] = {"asked": int(self.asked[g]), "ap": ap, "mean_ap": float(np.mean(list(ap.values()))),
                             "recall": {f"{a}-{b} m": [n / m if m else None, m] for (a, b), (n, m) in zip(RANGES_M, self.recall[g])}}
                if len(off):
                    out[name]["errors"] = dict(zip(("place_m", "size", "axis_rad", "heading_wrong"), map(float, off.mean(0))))
        return {"map": float(np.mean([v["mean_ap"] for v in out.values()])) if out else 0.0,
                "ghosts_per_frame": self.ghosts / max(1, self.frames), "precision": 1 - self.ghosts / max(1, self.kept), "groups": out}


def errors(box, true):
    """Distance of centres (m), 1 - IoU of aligned sizes, angle between the axes (rad), 1 if the heading is the other way."""
    sizes = np.stack([box[5:8], true[3:6]])
    inside = sizes.min(0).prod()
    turn = (box[8] - true[6] + np.pi) % (2 * np.pi) - np.pi
    axis = abs((turn + np.pi / 2) % np.pi - np.pi / 2)
    return np.hypot(*(box[2:4] - true[:2])), 1 - inside / (sizes.prod(1).sum() - inside), axis, float(abs(turn) > np.pi / 2)


@torch.no_grad()
def evaluated_by(net, frames, kinds, dtype=None):
    """Figures of some sets of frames by their names, each frame looked at once. Decoded from a score of 0.05 on."""
    counts = {name: (Standing(), Boxes()) for name in kinds}
    for i in sorted(set().union(*kinds.values())):
        points, true, truth, _ = frames.read(i)
        x = pillars(torch.from_numpy(points))
        with torch.autocast("cpu", dtype, enabled=dtype is not None):
            logits, numbers = net(x[None])
        logits, found = logits[0].float(), decode(numbers[0], 0.05)
        for standing, boxes in (counts[name] for name, which in kinds.items() if i in which):
            standing.add(logits, truth, x)
            boxes.add(found, true)
    return {name: {"frames": len(kinds[name]), "standing": standing.figures(), "boxes": boxes.figures()} for name, (standing, boxes) in counts.items()}


def evaluated(net, frames, which, dtype=None):
    """The same of one set."""
    return evaluated_by(net, frames, {"": set(which)}, dtype)[""]


def main():
    p = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    p.add_argument("weights")
    p.add_argument("folders", nargs="+")
    p.add_argument("--frames", type=int, help="the first ones; all if left out")
    p.add_argument("--source", type=int, choices=(0, 1, 2), help="sweeps of one kind alone")
    p.add_argument("--sheet", help="a picture of a few frames, truth beside what is said")
    p.add_argument("-o", "--output", help="JSON; standard output if left out")
    args = p.parse_args()
    torch.set_num_threads(1)
    net, frames = load_perceiver(args.weights), PerceptionFrames(*args.folders, limit=args.frames)
    which = [i for i in range(len(frames)) if args.source is None or frames.index[i][0]["source"][frames.index[i][1]] == args.source]
    text = json.dumps(evaluated(net, frames, which), indent=1)
    Path(args.output).write_text(text + "\n") if args.output else print(text)
    if args.sheet:
        from perception_sheet import sheet
        sheet(net, frames, which[:4]).save(args.sheet)


if __name__ == "__main__":
    main()
