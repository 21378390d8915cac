"""Are learned pictures worth training on? Small segmenters, by seeds and at equal steps, judged on rendered pictures of held-out worlds, also by light and
weather.

    sceneloom-worlds --kind pictures --preview --frames 24 --seed 11 -o DATA/few      # and 72 of --seed 12 to DATA/other, 48 of --seed 2 to DATA/val
    python downstream_pictures.py run DATA -o OUT [--seeds 5 --steps 500 --batch 12]  # each network's figures are kept; an interrupted run goes on
    python downstream_pictures.py table OUT                                           # table.md

*few* learns from rendered pictures of few worlds. The others learn, in half of each batch, from: what the shipped networks paint of the same scenes in another
weather; what they paint of other scenes; rendered pictures of these, the most that could be gained. *painted alone* sees no rendered picture at all. Labels are
what the pictures should show. A picture is painted from noise in 4 DDIM steps with guidance 2.
"""
import argparse
import json
from pathlib import Path

import numpy as np
import torch
from torch.nn import functional as F

import train_pictures
from ablate_pictures import WEIGHTS, rows_of
from downstream import interval
from models.segmenter import OUTSIDE, Segmenter, SegmenterConfig
from picture_data import MOMENTS, VIEWS, Pool, as_bytes, as_pictures, shard_arrays
from picture_eval import Agreement, drawn, noise_for, sample
from train_pictures import Learner, Trainer

SMALL = SegmenterConfig(widths=(16, 32, 48))
# What fills each half of a batch: pictures of a set of scenes, as they are rendered or painted.
ARMS = {
    "few": (("few", "rendered"), ("few", "rendered")),
    "few + painted again": (("few", "rendered"), ("few", "painted")),
    "few + others painted": (("few", "rendered"), ("other", "painted")),
    "few + others rendered": (("few", "rendered"), ("other", "rendered")),
    "painted alone": (("few", "painted"), ("other", "painted")),
}
SHOWN = ("pixels", "miou", "vehicles")
DAWN, DAY, DUSK, NIGHT = range(4)
AIR = {"clear day": lambda t, w: (t == DAY) & (w < 2), "dawn and dusk": lambda t, w: (t == DAWN) | (t == DUSK), "night": lambda t, w: t == NIGHT,
       "rain": lambda t, w: w == 2, "snow": lambda t, w: w == 3, "fog": lambda t, w: w == 4, "sandstorm": lambda t, w: w == 5}


class Downstream(Trainer):
    """The shipped networks, and pools of three sets of scenes with what is painted of two of them."""

    def __init__(self, data, threads):
        shards = {part: [shard_arrays(p.read_bytes()) for p in sorted((data / part).glob("shard_*.safetensors"))] for part in ("few", "other", "val")}
        h, w = shards["val"][0]["rgb"].shape[3:5]
        args = train_pictures.arguments().parse_args(
            ["--stream", "", "--held-stream", "", "--minutes", "0", "-o", str(data / "run"), "--size", f"{w}x{h}", "--room", "1", "--held-out", "1",
             "--threads", str(threads), "--init-vae", str(WEIGHTS / "pictures_vae.safetensors"), "--init-dit", str(WEIGHTS / "pictures_dit.safetensors"),
             "--init-seg", str(WEIGHTS / "pictures_segmenter.safetensors")])
        super().__init__(args)
        self.pools = {}
        for part, all_of in shards.items():
            pool = self.pools[part] = Pool(sum(len(s["conditions"]) for s in all_of), (w, h), self.device)
            for shard in all_of:
                pool.add(shard)
        self.painted = {part: self.paint(data, part) for part in ("few", "other")}

    @torch.no_grad()
    def paint(self, data, part, piece=4):
        """Pictures of both moments of a set, u8 [N,2,6,h,w,3]; those of few worlds in the weather of the next scene. Kept in a file."""
        pool, path = self.pools[part], data / f"painted_{part}.pt"
        if path.exists():
            return torch.load(path)
        out = torch.empty_like(pool.arrays["rgb"][: pool.count])
        weather = pool.arrays["conditions"][: pool.count, 1]
        if part == "few":
            weather = weather.roll(1, 0)
        w, h = pool.size
        shape = (VIEWS, h // 8, w // 8, self.vae.ema.config.latent)
        for begin in range(0, pool.count, piece):
            frames = torch.arange(begin, min(pool.count, begin + piece))
            for moment in range(MOMENTS):
                told = pool.moments(frames, torch.full_like(frames, moment), False) | {"weather": weather[frames].long()}
                noise = noise_for(self, (len(frames), *shape), 2 * begin + moment)
                out[frames, moment] = as_bytes(drawn(self, sample(self, told, noise)))
            print(f"{part}: {begin + len(frames)} of {pool.count} painted", flush=True)
        torch.save(out, path)
        return out

    def some(self, part, how, n):
        """Random pictures [n,3,h,w] and what they should show u8 [n,h,w]; half of them in a mirror."""
        pool = self.pools[part]
        at = (torch.randint(pool.count, (n,)), torch.randint(MOMENTS, (n,)), torch.randint(VIEWS, (n,)))
        rgb = as_pictures((self.painted[part] if how == "painted" else pool.arrays["rgb"])[at])
        flip = torch.rand(n) < 0.5
        shown = pool.arrays["class"][at]
        return torch.where(flip.view(-1, 1, 1, 1), rgb.flip(-1), rgb), torch.where(flip.view(-1, 1, 1), shown.flip(-1), shown)

    def learn(self, arm, seed, steps, batch):
        torch.manual_seed(seed)
        learner = Learner(self.on_device(Segmenter(SMALL)), 2e-3, ema=0.99, warmup=50)
        for step in range(steps):
            learner.before(step / steps)
            halves = [self.some(*half, batch // 2) for half in ARMS[arm]]
            pictures, shown = (torch.cat(parts) for parts in zip(*halves))
            with self.amp():
                logits = learner.model(pictures)
            target = shown.long()
            loss = F.cross_entropy(logits.float(), target.clamp(max=logits.shape[1] - 1).masked_fill(target == OUTSIDE, -100), ignore_index=-100)
            learner.update(loss, {"loss": loss})
        return learner

    def judge(self, learner):
        """Figures of a segmenter on rendered pictures of held-out worlds: of all, and pixels by light and weather."""
        self.seg, val = learner, self.pools["val"]
        whole, tables = Agreement(self.device), []
        for frame in range(val.count):
            one = Agreement(self.device)
            one.add(self, as_pictures(val.arrays["rgb"][frame]), val.arrays["class"][frame])
            tables.append(one.table)
            whole.table += one.table
        time, weather = val.arrays["conditions"][: val.count].long().T
        air = {}
        for name, which in AIR.items():
            chosen = which(time, weather)
            if chosen.any():
                air[name] = Agreement(self.device)
                air[name].table = sum(t for t, c in zip(tables, chosen.tolist()) if c)
        return whole.figures() | {"air": {name: table.figures() | {"frames": int(AIR[name](time, weather).sum())} for name, table in air.items()}}


def run(args):
    out = Path(args.output)
    out.mkdir(parents=True, exist_ok=True)
    path, job = out / "rows.jsonl", Downstream(Path(args.data), args.threads)
    for seed in range(args.first_seed, args.first_seed + args.seeds):
        for arm in ARMS:
            if any((r["arm"], r["seed"], r["steps"]) == (arm, seed, args.steps) for r in rows_of(path)):
                continue
            learner = job.learn(arm, seed, args.steps, args.batch)
            row = {"arm": arm, "seed": seed, "steps": args.steps, "batch": args.batch, "loss": learner.means()["loss"]} | job.judge(learner)
            with open(path, "a") as f:
                f.write(json.dumps(row) + "\n")
            print(json.dumps({k: v for k, v in row.items() if k != "air"}), flush=True)


def table(args):
    """All arms beside `few` of the same seed."""
    rows = rows_of(Path(args.output) / "rows.jsonl")
    steps = max(r["steps"] for r in rows)
    of = {(r["arm"], r["seed"]): r for r in rows if r["steps"] == steps}
    seeds = sorted({seed for _, seed in of if all((arm, seed) in of for arm in ARMS)})
    if not seeds:
        raise SystemExit(f"{args.output}/rows.jsonl: expected every arm by one seed at least")
    pm = lambda values, sign="": "{:{}.3f} ± {:.3f}".format(interval(values)[0], sign, interval(values)[1])
    lines = [f"{len(seeds)} seeds, {steps} steps of {rows[0]['batch']} pictures each; mean ± 95 % interval over seeds; gains are over `few` of the same seed.", "",
             "| trained on | " + " | ".join(f"{k} | gain" for k in SHOWN) + " |", "|---" * (1 + 2 * len(SHOWN)) + "|"]
    for arm in ARMS:
        values = {k: np.array([of[arm, s][k] for s in seeds]) for k in SHOWN}
        gains = {k: values[k] - np.array([of["few", s][k] for s in seeds]) for k in SHOWN}
        lines.append(f"| {arm} | " + " | ".join(f"{pm(values[k])} | {'' if arm == 'few' else pm(gains[k], '+')}" for k in SHOWN) + " |")
    air = of["few", seeds[0]]["air"]
    lines += ["", "mIoU by light and weather (frames): `few`, and what the others gain", "",
              "| trained on | " + " | ".join(f"{name} ({one['frames']})" for name, one in air.items()) + " |", "|---" * (1 + len(air)) + "|"]
    for arm in ARMS:
        values = {name: np.array([of[arm, s]["air"][name]["miou"] for s in seeds]) for name in air}
        gains = {name: values[name] - np.array([of["few", s]["air"][name]["miou"] for s in seeds]) for name in air}
        lines.append(f"| {arm} | " + " | ".join(pm(values[n]) if arm == "few" else pm(gains[n], "+") for n in air) + " |")
    text = "\n".join(lines) + "\n"
    (Path(args.output) / "table.md").write_text(text)
    print(text)


def main():
    p = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    commands = p.add_subparsers(required=True)
    r = commands.add_parser("run")
    r.add_argument("data", help="folder with few/, other/ and val/")
    r.add_argument("-o", "--output", required=True)
    r.add_argument("--seeds", type=int, default=5)
    r.add_argument("--first-seed", type=int, default=1)
    r.add_argument("--steps", type=int, default=500)
    r.add_argument("--batch", type=int, default=12, help="pictures, an even number")
    r.add_argument("--threads", type=int, default=1)
    r.set_defaults(do=run)
    t = commands.add_parser("table")
    t.add_argument("output")
    t.set_defaults(do=table)
    args = p.parse_args()
    args.do(args)


if __name__ == "__main__":
    main()
