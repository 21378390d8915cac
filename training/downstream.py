"""Do generated and edited scenes help, and are they like worlds, as small LiDAR perceivers judge? Two experiments, by seeds and at equal steps.

*Aug*: a network is trained on few worlds; others, for as many steps, on the same worlds with what the program makes of them: generated anew from their layouts,
edited, or both; one, the most that could be reached, on as many worlds as all of those are scenes. They are judged on held-out worlds, swept as all are, on exact surfaces,
and on any folder of shards (--judge NAME=DIR): real data become shards by `pack_perception.py`.
*Gen*: what was trained on many worlds (the last of those arms) is judged on scenes generated from the layouts of held-out worlds, beside those worlds themselves:
what it loses is what generation gets wrong where a LiDAR looks.

    python downstream.py make FOLDER --sceneloom target/release/sceneloom --worlds target/release/sceneloom-worlds [--few 32 --variants 3 --held-out 64]
    python downstream.py run FOLDER [--seeds 5 --steps 3000 --batch 4] [--judge NAME=DIR]     # each network's figures are kept; an interrupted run goes on
    python downstream.py table FOLDER                                                          # table.md and table.json

What is made: `sceneloom batch` writes each scene's learned sweep (ply), boxes and labels (occ3d), plan by plan, into FOLDER/batch; packed to shards in FOLDER/data.
Few worlds are the eight templates by seeds from 6 on, held-out ones by seeds from 5000 on. A pair of arms shares seeds: order of samples and first weights.
On one free core a scene takes 1 to 3 s to make and a step of four squares 0.2 s; 5 seeds of 5 arms of 3000 steps take some four hours.
"""
import argparse
import json
import math
import subprocess
import sys
from pathlib import Path

import numpy as np
import torch

from loop import optimizers, pick_device
from models.lidar_perceiver import LidarPerceiver, PerceiverConfig
from pack_perception import of_batch, pack
from perception_data import Mixed, PerceptionFrames, batch
from perception_eval import evaluated
from train_perception import losses, row

TEMPLATES = ("straight", "curve", "t-junction", "intersection", "roundabout", "highway", "parking", "suburb")
ARMS = {"few": ("few",), "few + generated": ("few", "generated"), "few + edited": ("few", "edited"),
        "few + both": ("few", "generated", "edited"), "many": ("many",)}
JUDGES = {"held-out worlds": "held", "generated from them": "held_generated", "exact surfaces": "surfaces"}
FEW_SEED, MANY_SEED, HELD_SEED = 6, 1000, 5000
EDITS = [[{"count": {"class": c, "n": n}}] for c, n in (("pedestrian", 10), ("bicycle", 5), ("truck", 5), ("car", 16), ("traffic_cone", 8))]
WRITE = [{"format": "ply", "learned_lidar": True}, {"format": "boxes"}, {"format": "occ3d"}]
SMALL = PerceiverConfig(widths=(32, 64, 96), kernels=((3,), (3, 3), (3,)))
T_95 = (12.706, 4.303, 3.182, 2.776, 2.571, 2.447, 2.365, 2.306, 2.262, 2.228, 2.201, 2.179, 2.16, 2.145, 2.131, 2.12, 2.11, 2.101, 2.093)
SHOWN = ("map", "ap_car", "ap_person", "miou_seen", "miou_all")


def of_templates(first, worlds):
    """Axes of a plan of so many worlds (a multiple of eight)."""
    return [{"name": "template", "values": [[{"base": {"template": t}}] for t in TEMPLATES]}, {"name": "seed", "seeds": {"from": first, "count": max(1, worlds // 8)}}]


def of_scenes(folder):
    """An axis of the scenes that a plan wrote."""
    return {"name": "scene", "values": [[{"base": {"scene": str(p.resolve())}}] for p in sorted(folder.rglob("*.loom"))]}


def written(args, name, sweep, generate=None, keep=False):
    """Runs a plan and packs what it wrote; done before is left alone."""
    folder, out = args.folder / "batch" / name, args.folder / "data" / name
    if out.exists():
        return folder
    plan = {"format": "sceneloom_batch", "version": 1, "seed": FEW_SEED, "base": {"template": TEMPLATES[0]}, "sweep": sweep,
            "write": WRITE + [{"format": "loom"}] * keep} | ({"generate": generate} if generate else {})
    folder.mkdir(parents=True, exist_ok=True)
    path = folder / "plan.json"
    path.write_text(json.dumps(plan, indent=1))
    # 1 says that some variants could not be made: an edit may find no room.
    code = subprocess.run([args.sceneloom, "batch", str(path), "-o", str(folder / "out")], stdout=subprocess.DEVNULL).returncode
    if code not in (0, 1):
        raise SystemExit(f"{path}: sceneloom batch ended with code {code}")
    made = pack(of_batch(folder / "out"), out.with_suffix(".part"))
    out.with_suffix(".part").rename(out)
    print(f"{name}: {made} frames", flush=True)
    return folder


def make(args):
    """The scenes of all arms and judges."""
    whole, touched = {"quality": args.quality, "whole": True}, {"quality": args.quality, "whole": False}
    few = written(args, "few", of_templates(FEW_SEED, args.few), keep=True)
    seeds = {"name": "seed", "seeds": {"from": 1, "count": args.variants}}
    written(args, "generated", [of_scenes(few), seeds], whole)
    written(args, "edited", [of_scenes(few), {"name": "edit", "values": EDITS[: args.variants]}], touched)
    written(args, "many", of_templates(MANY_SEED, args.few * (1 + 2 * args.variants)))
    held = written(args, "held", of_templates(HELD_SEED, args.held_out), keep=True)
    written(args, "held_generated", [of_scenes(held)], whole)
    surfaces = args.folder / "data" / "surfaces"
    if not surfaces.exists():
        subprocess.run([args.worlds, "--kind", "perception", "--frames", str(args.held_out), "--seed", "2", "-o", str(surfaces)], check=True)


def trained(frames, seed, steps, size, side, device, dtype):
    """A network after so many steps; its seed fixes first weights and the order of samples."""
    torch.manual_seed(seed)
    net = LidarPerceiver(SMALL).to(device).to(memory_format=torch.channels_last)
    rng, steppers = np.random.default_rng(seed), optimizers(net, "muon", 3e-3, (0.9, 0.98), 0.01)
    for step in range(steps):
        parts = batch(frames, rng, size, side)
        rate = 3e-3 * min(1.0, (step + 1) / 100) * 0.5 * (1 + math.cos(math.pi * step / steps))
        for optimizer in steppers:
            for group in optimizer.param_groups:
                group["lr"] = rate
            optimizer.zero_grad(set_to_none=True)
        with torch.autocast(device.type, dtype, enabled=dtype is not None):
            loss, _ = losses(net, *(part.to(device) for part in parts))
        loss.backward()
        torch.nn.utils.clip_grad_norm_(net.parameters(), 1.0)
        for optimizer in steppers:
            optimizer.step()
    return net.cpu().eval()


def judges_of(args):
    """Sets of frames by name."""
    named = {name: args.folder / "data" / part for name, part in JUDGES.items()}
    named |= {name: Path(folder) for name, folder in (pair.split("=", 1) for pair in args.judge)}
    return {name: PerceptionFrames(folder) for name, folder in named.items()}


def run(args):
    """Trains and judges every arm by every seed that has no figures yet."""
    device, dtype = pick_device(args.threads)
    judges, out = judges_of(args), args.folder / "results"
    out.mkdir(exist_ok=True)
    for seed in range(args.first_seed, args.first_seed + args.seeds):
        for arm, parts in ARMS.items():
            path = out / f"{arm.replace(' + ', '_')}_{args.steps}_{seed}.json"
            found = json.loads(path.read_text()) if path.exists() else None
            if found and set(judges) <= set(found["judged"]):
                continue
            weights = path.with_suffix(".pt")
            if weights.exists():
                net = LidarPerceiver(SMALL).eval()
                net.load_state_dict(torch.load(weights, weights_only=True))
            else:
                frames = Mixed([PerceptionFrames(args.folder / "data" / part) for part in parts])
                net = trained(frames, seed, args.steps, args.batch, args.side, device, dtype)
                torch.save(net.state_dict(), weights)
            judged = {name: evaluated(net, frames, range(len(frames))) for name, frames in judges.items()}
            path.write_text(json.dumps({"arm": arm, "seed": seed, "steps": args.steps, "judged": judged}))
            print(f"{arm}, seed {seed}: " + ", ".join(f"{name} mAP {row(f)['map']:.3f}" for name, f in judged.items()), flush=True)


def interval(values):
    """Mean and half the 95 % interval over seeds (Student's t)."""
    n = len(values)
    half = T_95[min(n - 2, len(T_95) - 1)] * float(np.std(values, ddof=1)) / math.sqrt(n) if n > 1 else math.inf
    return float(np.mean(values)), half


def table(args):
    """Figures of all arms by judge, with what they gain over `few` of the same seed; and what `many` loses on generated scenes."""
    results = [json.loads(p.read_text()) for p in sorted((args.folder / "results").glob("*.json"))]
    steps = {r["steps"] for r in results}
    if len(steps) != 1:
        raise SystemExit(f"{args.folder}/results: expected runs of one number of steps, found {sorted(steps)}")
    by = {(r["arm"], r["seed"]): {name: row(f) for name, f in r["judged"].items()} for r in results}
    seeds = sorted({s for _, s in by if all((arm, s) in by for arm in ARMS)})
    if not seeds:
        raise SystemExit(f"{args.folder}/results: expected every arm by one seed at least")
    shown = lambda pair, sign="": f"{pair[0]:{sign}.3f} ± {pair[1]:.3f}"
    lines, figures = [f"{len(seeds)} seeds, {steps.pop()} steps each; mean ± 95 % interval over seeds; gains are over `few` of the same seed."], {}
    for judge in sorted(set.intersection(*(set(v) for v in by.values()))):
        lines += ["", f"**{judge}**", "", "| trained on | " + " | ".join(f"{k} | gain" for k in SHOWN) + " |", "|---" * (1 + 2 * len(SHOWN)) + "|"]
        for arm in ARMS:
            cells = []
            for key in SHOWN:
                values = np.array([by[arm, s][judge][key] for s in seeds])
                gain = values - np.array([by["few", s][judge][key] for s in seeds])
                figures.setdefault(judge, {}).setdefault(arm, {})[key] = {"value": interval(values), "gain": interval(gain), "seeds": values.tolist()}
                cells += [shown(interval(values)), "" if arm == "few" else shown(interval(gain), "+")]
            lines.append(f"| {arm} | " + " | ".join(cells) + " |")
    worlds, made = list(JUDGES)[:2]
    loss = {k: interval([by["many", s][made][k] - by["many", s][worlds][k] for s in seeds]) for k in SHOWN}
    lines += ["", f"**Gen**: `many` on scenes {made}, less on the {worlds}: " + ", ".join(f"{k} {shown(v, '+')}" for k, v in loss.items()) + "."]
    (args.folder / "table.md").write_text("\n".join(lines) + "\n")
    (args.folder / "table.json").write_text(json.dumps({"seeds": seeds, "judges": figures, "gen": loss}, indent=1) + "\n")
    print("\n".join(lines))


def main():
    p = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    p.add_argument("what", choices=("make", "run", "table"))
    p.add_argument("folder", type=Path)
    p.add_argument("--sceneloom", default="sceneloom")
    p.add_argument("--worlds", default="sceneloom-worlds")
    p.add_argument("--few", type=int, default=32, help="worlds, a multiple of 8")
    p.add_argument("--variants", type=int, default=3, help="generated and edited scenes of each of them, up to 5")
    p.add_argument("--held-out", type=int, default=64)
    p.add_argument("--quality", default="draft", help="of generation: draft, balanced, careful")
    p.add_argument("--seeds", type=int, default=5)
    p.add_argument("--first-seed", type=int, default=0, help="so that several processes can share the seeds")
    p.add_argument("--steps", type=int, default=3000)
    p.add_argument("--batch", type=int, default=4)
    p.add_argument("--side", type=int, default=120, help="columns of the squares that are trained on")
    p.add_argument("--threads", type=int, default=1)
    p.add_argument("--judge", action="append", default=[], metavar="NAME=DIR", help="a further folder of shards to judge on")
    args = p.parse_args()
    {"make": make, "run": run, "table": table}[args.what](args)


if __name__ == "__main__":
    sys.exit(main())
