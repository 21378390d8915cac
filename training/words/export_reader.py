"""Trained reader -> assets/weights/reader.safetensors (f16), its section of the card, and the golden of its parity test.

python3 export_reader.py RUN [OUT.safetensors: the weights alone, there]
"""

import json
import sys
from pathlib import Path

import torch
from safetensors.torch import save_file

import lexicon
import symbols
from reader import Config, Reader
from train_reader import HERE, Data, batch, greedy, load

ROOT = Path(__file__).parents[2]
sys.path.append(str(ROOT / "training"))

from export_layout import add_section  # noqa: E402

GOLDEN = [
    ("prompt", "A foggy highway, two trucks 20 m ahead of me and a red car in the left lane."),
    ("edit", "move the bus 5 metres closer, and paint it blue"),
    ("edit", "remvoe both cones, the rest stays"),
    ("edit", "swap #3 with the nearest taxi"),
]


def main():
    run = Path(sys.argv[1])
    state = torch.load(run / "last.pt", weights_only=False)
    c = state["config"]
    model = Reader(Config(**c)).eval()
    halved = {k: v.half() for k, v in state["model"].items()}
    model.load_state_dict({k: v.float() for k, v in halved.items()})
    out = Path(sys.argv[2]) if len(sys.argv) > 2 else ROOT / "assets/weights/reader.safetensors"
    meta = {"kind": "reader", "config": json.dumps(c), "words": json.dumps(state["words"]), "symbols": json.dumps(symbols.SYMBOLS), "seen": str(state["seen"])}
    save_file({k: v.contiguous() for k, v in halved.items()}, out, meta)
    data = Data([], 1, words=state["words"])
    rows = []
    with torch.no_grad():
        for kind, text in GOLDEN:
            toks = lexicon.tokens(text, data.speller)
            x, _, _ = batch([(data.inputs(toks, kind == "prompt"), [0])])
            memory, mask = model.encode(x)
            start = torch.tensor([[len(symbols.SYMBOLS)]])
            first = model.decode(start, memory, mask, x)[0, 0].exp()
            said = greedy(model, x, 80)[0]
            rows.append({
                "kind": kind, "text": text, "tokens": [t.text for t in toks],
                "memory": [round(float(v), 5) for v in memory[0, :, 0]],
                "first": [[symbols.SYMBOLS[i], round(float(first[i]), 5)] for i in first.argsort(descending=True)[:4].tolist()],
                "line": symbols.to_line(said, toks),
            })
    if len(sys.argv) < 3:
        n = sum(len(load(p)) for p in HERE.glob("readings/*.jsonl"))
        about = {"kind": "reader", "config": meta["config"], "seed": state["seed"], "steps": state["step"], "samples": state["seen"], "minutes": round(state["spent"] / 60, 1)}
        data_command = f"training/words/readings/*.jsonl ({n:,} sentences, those of the voices below held out), their variants, generated pairs"
        right = {f"{name}_right": share for name, share in state["right"].items()}
        add_section(out.parent, "reader", halved, about, data_command, f"{state['spent'] / 3600:.2f} h", right)
        (ROOT / "tests/reference/reader_golden.json").write_text(json.dumps(rows, indent=1, ensure_ascii=False) + "\n")
    print(out, f"{out.stat().st_size / 1e6:.2f} MB")
    for r in rows:
        print(r["text"], "|", r["line"])


if __name__ == "__main__":
    main()
