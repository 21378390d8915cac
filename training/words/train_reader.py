"""Trains the reader. `python3 train_reader.py OUT --minutes 60 [--resume]`; sentences: readings/*.jsonl beside this file."""

import argparse
import json
import math
import random
import time
from collections import Counter
from pathlib import Path

import torch
import torch.distributed as dist
import torch.multiprocessing as mp

import canonical
import generate
import lexicon
import notation
import symbols
import vary
from reader import Config, Reader

HERE = Path(__file__).parent
PAD = symbols.END


def load(path):
    out = []
    for line in path.read_text().splitlines():
        if line.strip():
            r = json.loads(line)
            r["acts"] = notation.parse(r["reading"])
            out.append(r)
    return out


class Data:
    """Pairs without end: variants of strangers' sentences, and generated ones."""

    def __init__(self, records, seed, generated=0.45, words=None, size=8000):
        self.records, self.generated = records, generated
        self.r = random.Random(seed)
        if words is None:
            count = Counter()
            probe = random.Random(1)
            for _ in range(30000):
                count.update(t.text for t in lexicon.tokens(generate.pair(probe)["text"]))
            common = {w for w, n in count.items() if n > 12}
            count = Counter({w: n for w, n in count.items() if w in common})
            for r in records:
                for w in {t.text for t in lexicon.tokens(r["text"])}:
                    count[w] += 15 if r.get("weight", 1) >= 1 else 4
            words = [w for w, n in count.most_common(size) if n >= 30 or w in common]
        self.words = words
        self.id = {w: i + 3 for i, w in enumerate(words)}
        self.speller = lexicon.Speller({w: i for i, w in enumerate(words)})

    def record(self):
        r = self.r
        if r.random() < self.generated or not self.records:
            return generate.pair(r)
        a = r.choice(self.records)
        a = self.variant(a)
        if a["kind"] == "edit" and r.random() < 0.12:
            b = r.choice(self.records)
            if b["kind"] == "edit":
                a = vary.joined(r, a, self.variant(b)) or a
        a = vary.wrapped(r, a)
        return {**a, "text": vary.roughen(r, a["text"])}

    def variant(self, a):
        text, acts = a["text"], a["acts"]
        if self.r.random() < 0.9:
            text, acts = vary.vary(self.r, text, acts)
        return {"kind": a["kind"], "text": text, "reading": notation.write(acts)}

    def item(self, record, train=True):
        """(inputs, symbols) or None."""
        prompt = record["kind"] == "prompt"
        toks = lexicon.tokens(record["text"], self.speller)[: symbols.LONGEST - 1]
        acts = canonical.acts(notation.parse(record["reading"]), prompt)
        out = symbols.to_symbols(notation.write(acts), toks)
        if out is None or len(out) > symbols.ROOM:
            return None
        return self.inputs(toks, prompt, self.r if train else None), out

    def inputs(self, toks, prompt, r=None):
        word, gram, sense, value, pointer, by_sense, by_number = [1 if prompt else 2], [[]], [[]], [0], [0], [-1], [-1]
        numeric = {i: k for k, i in enumerate(symbols.numbers_of(toks))}
        for i, t in enumerate(toks):
            known = self.id.get(t.text, 0)
            word.append(0 if r and r.random() < 0.06 else known)
            gram.append(symbols.grams(t.text) if t.text[0] != "<" else [])
            sense.append(sorted({symbols.SENSES[s] for s in t.senses})[:4])
            v = t.value
            value.append(0 if v is None else 33 if v != int(v) or v > 31 else int(v) + 1)
            k = numeric.get(i)
            pointer.append(0 if k is None else k + 1)
            by_number.append(-1 if k is None else symbols.ID[f"@{k}"])
            copies = [c for c in map(symbols.sense_symbol, t.senses) if c is not None]
            if v is not None and not t.measure and v == int(v) and v <= 20:
                copies = [symbols.ID[str(int(v))]]
            by_sense.append(copies[0] if copies else -1)
        return word, gram, sense, value, pointer, by_sense, by_number


def batch(items):
    """Tensors of items; the symbols before and after each place."""
    t = max(len(x[0][0]) for x in items)
    s = max(len(x[1]) for x in items)
    pad = lambda rows, n, fill: torch.tensor([row + [fill] * (n - len(row)) for row in rows])

    def bags(rows):
        most = max(1, max(len(b) for row in rows for b in row))
        return torch.tensor([[b + [0] * (most - len(b)) for b in row] + [[0] * most] * (t - len(row)) for row in rows])

    col = lambda k: [x[0][k] for x in items]
    x = {
        "word": pad(col(0), t, 0),
        "gram": bags(col(1)),
        "sense": bags(col(2)),
        "value": pad(col(3), t, 0),
        "pointer": pad(col(4), t, 0),
        "copy_sense": pad(col(5), t, -1),
        "copy_number": pad(col(6), t, -1),
        "empty": torch.tensor([[False] * len(row) + [True] * (t - len(row)) for row in col(0)]),
    }
    start = len(symbols.SYMBOLS)
    said = pad([[start] + y[:-1] for _, y in items], s, PAD)
    wanted = pad([y for _, y in items], s, -1)
    return x, said, wanted


def greedy(model, x, most=symbols.ROOM):
    """Symbols said, [B, S]."""
    memory, mask = model.encode(x)
    b = memory.shape[0]
    said = torch.full((b, 1), len(symbols.SYMBOLS))
    done = torch.zeros(b, dtype=torch.bool)
    for _ in range(most):
        nxt = model.decode(said, memory, mask, x)[:, -1].argmax(-1)
        nxt = nxt.masked_fill(done, PAD)
        said = torch.cat([said, nxt[:, None]], 1)
        done |= nxt == symbols.END
        if done.all():
            break
    return said[:, 1:].tolist()


def validate(model, data, records, show=0):
    """Share of records whose symbols are all as labelled."""
    model.eval()
    items = [(r, data.item(r, train=False)) for r in records]
    items = [(r, i) for r, i in items if i]
    right, wrong = 0, []
    order = sorted(range(len(items)), key=lambda k: len(items[k][1][0][0]))
    with torch.no_grad():
        for at in range(0, len(order), 64):
            part = [items[k] for k in order[at : at + 64]]
            x, _, _ = batch([i for _, i in part])
            for (r, (_, y)), got in zip(part, greedy(model, x, 120)):
                got = got[: got.index(PAD) + 1] if PAD in got else got
                if got == y:
                    right += 1
                else:
                    wrong.append((r["text"], y, got))
    model.train()
    name = lambda ids: " ".join(symbols.SYMBOLS[i] for i in ids[:-1])
    for text, y, got in wrong[:show]:
        print("   ", text, "\n      is ", name(y), "\n      got", name(got))
    return right / max(1, len(items))


def started(path, words):
    """Weights of a shipped reader; their words, and behind them those of `words` that it has not (their vectors begin at 0)."""
    from safetensors import safe_open
    from safetensors.torch import load_file

    with safe_open(path, "pt") as f:
        known = json.loads(f.metadata()["words"])
    weights = {k: v.float() for k, v in load_file(path).items()}
    new = [w for w in words if w not in set(known)]
    table = weights["word.weight"]
    weights["word.weight"] = torch.cat([table, torch.zeros(len(new), table.shape[1])])
    # (new symbols stand at the end; the last row of `symbol` begins a reading)
    more = len(symbols.SYMBOLS) - weights["say.bias"].shape[0]
    zeros = torch.zeros(more, table.shape[1])
    weights["symbol.weight"] = torch.cat([weights["symbol.weight"][:-1], zeros, weights["symbol.weight"][-1:]])
    weights["say.weight"] = torch.cat([weights["say.weight"], zeros])
    weights["say.bias"] = torch.cat([weights["say.bias"], torch.full((more,), -4.0)])
    return weights, known + new


def averaged(model):
    """Gradients of all workers, averaged in place."""
    flat = torch.cat([w.grad.reshape(-1) for w in model.parameters()])
    dist.all_reduce(flat)
    flat /= dist.get_world_size()
    at = 0
    for w in model.parameters():
        w.grad.copy_(flat[at : at + w.numel()].view_as(w))
        at += w.numel()


def main():
    p = argparse.ArgumentParser()
    p.add_argument("out", type=Path)
    p.add_argument("--minutes", type=float, default=60)
    p.add_argument("--batch", type=int, default=128)
    p.add_argument("--rate", type=float, default=1e-3)
    p.add_argument("--width", type=int, default=224)
    p.add_argument("--seed", type=int, default=1)
    p.add_argument("--workers", type=int, default=1, help="processes of one thread each; one process has two")
    p.add_argument("--generated", type=float, default=0.45)
    p.add_argument("--sentences", type=Path, default=HERE / "readings")
    p.add_argument("--hold-out", default="", help="files of the sentences that are not learned, by name, with commas")
    p.add_argument("--share", type=float, default=1.0, help="share of the sentences that is learned, for learning curves")
    p.add_argument("--start", type=Path, help="weights to go on from (reader.safetensors), with the words they know and those that are new")
    p.add_argument("--resume", action="store_true")
    a = p.parse_args()
    if a.workers > 1:
        mp.spawn(work, (a,), a.workers)
    else:
        work(0, a)


def work(rank, a):
    """One of the workers; the first one validates and saves."""
    torch.manual_seed(a.seed)
    torch.set_num_threads(1 if a.workers > 1 else 2)
    if a.workers > 1:
        dist.init_process_group("gloo", f"tcp://127.0.0.1:{29500 + a.seed}", rank=rank, world_size=a.workers)
    held = [n for n in a.hold_out.split(",") if n]
    train, test = [], {}
    for path in sorted(a.sentences.glob("*.jsonl")):
        if path.stem in held:
            test[path.stem] = load(path)[:160]
        else:
            train += load(path)
    random.Random(5).shuffle(train)
    train = train[: round(len(train) * a.share)]
    probe = random.Random(77)
    test["generated"] = [generate.pair(probe) for _ in range(100)]
    a.out.mkdir(parents=True, exist_ok=True)
    last = a.out / "last.pt"
    state = torch.load(last, weights_only=False) if a.resume and last.exists() else None
    data = Data(train, a.seed + 1000003 * rank + (state["step"] if state else 0), a.generated, state["words"] if state else None)
    weights = None
    if a.start and not state:
        weights, words = started(a.start, data.words)
        data = Data(train, a.seed + 1000003 * rank, a.generated, words)
    model = Reader(Config(len(data.words) + 3, a.width))
    if weights:
        model.load_state_dict(weights)
    opt = torch.optim.AdamW(model.parameters(), lr=a.rate, betas=(0.9, 0.98), weight_decay=0.01)
    step, seen, spent = 0, 0, 0.0
    if state:
        model.load_state_dict(state["model"])
        opt.load_state_dict(state["opt"])
        step, seen, spent = state["step"], state["seen"], state["spent"]
    if rank == 0:
        print(f"{len(train)} sentences, {len(data.words)} words, {sum(w.numel() for w in model.parameters()):,} weights", flush=True)
    began, mean, saved = time.time(), 0.0, time.time()
    budget = a.minutes * 60
    over = False
    while not over:
        # (all workers go by the clock of the first, or their weights would part)
        clock = torch.tensor([(spent + time.time() - began) / (spent + budget)], dtype=torch.float64)
        if a.workers > 1:
            dist.broadcast(clock, 0)
        pool = []
        while len(pool) < a.batch * 8:
            item = data.item(data.record())
            if item:
                pool.append(item)
        pool.sort(key=lambda i: len(i[0][0]) + len(i[1]))
        # (the same order of lengths on all workers: none waits for another)
        batches = [pool[k : k + a.batch] for k in range(0, len(pool), a.batch)]
        random.Random(step).shuffle(batches)
        for items in batches:
            x, said, wanted = batch(items)
            rate = a.rate * min(1.0, (step + 1) / 400) * (0.02 + 0.98 * 0.5 * (1 + math.cos(math.pi * min(1.0, clock.item()))))
            for g in opt.param_groups:
                g["lr"] = rate
            with torch.autocast("cpu", dtype=torch.bfloat16):
                logp = model(x, said).float()
            keep = wanted >= 0
            loss = -logp.gather(2, wanted.clamp(min=0)[..., None])[..., 0][keep].mean() - 0.02 * logp[keep].mean()
            opt.zero_grad()
            loss.backward()
            if a.workers > 1:
                averaged(model)
            torch.nn.utils.clip_grad_norm_(model.parameters(), 1.0)
            opt.step()
            step += 1
            seen += len(items) * a.workers
            mean = loss.item() if step == 1 else 0.98 * mean + 0.02 * loss.item()
            if step % 100 == 0 and rank == 0:
                print(f"step {step} seen {seen} loss {mean:.4f} {seen / (spent + time.time() - began):.0f}/s", flush=True)
        # (all workers stop together)
        flags = torch.tensor([float(time.time() - began >= budget), float(time.time() - saved > 400)])
        if a.workers > 1:
            dist.broadcast(flags, 0)
        over = flags[0] > 0
        if (over or flags[1] > 0) and rank == 0:
            shares = {n: round(validate(model, data, t), 3) for n, t in test.items()}
            print(f"step {step} seen {seen} right {shares}", flush=True)
            torch.save({"model": model.state_dict(), "opt": opt.state_dict(), "words": data.words, "step": step, "seen": seen, "spent": spent + time.time() - began, "config": vars(model.c), "seed": a.seed, "right": shares}, last)
        if over or flags[1] > 0:
            saved = time.time()
            if a.workers > 1:
                dist.barrier()
    if rank > 0:
        return
    for n, t in test.items():
        print(n, validate(model, data, t, show=40 if n != "generated" else 0))


if __name__ == "__main__":
    main()
