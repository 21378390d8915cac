"""Notation, tokens, variants and symbols agree with each other; a short training learns. `python3 test_words.py`"""

import random
import tempfile
from pathlib import Path

import canonical
import generate
import lexicon
import notation
import symbols
import vary
from train_reader import HERE, Data, load


def test_tokens():
    speller = lexicon.Speller({"remove": 0, "barriers": 1})
    texts = [t.text for t in lexicon.tokens("Remvoe the T-junction's 20m, twenty-five yards & #7", speller)]
    assert texts == ["remove", "the", "t", "junction", "'s", "<m>", ",", "<m>", "&", "#", "<n>"], texts
    far = [t.value for t in lexicon.tokens("20 yards, half a dozen, 2.5 m") if t.value is not None]
    assert [round(v, 3) for v in far] == [18.288, 12, 2.5], far


def test_readings_survive_symbols():
    r = random.Random(1)
    records = [generate.pair(r) for _ in range(2000)]
    for path in sorted((HERE / "readings").glob("*.jsonl")):
        records += load(path)
    lost = 0
    for x in records:
        tokens = lexicon.tokens(x["text"])
        acts = canonical.acts(notation.parse(x["reading"]), x["kind"] == "prompt")
        line = notation.write(acts)
        assert notation.parse(line) == acts, line
        ids = symbols.to_symbols(line, tokens)
        if ids is None:
            lost += 1
            continue
        notation.parse(symbols.to_line(ids, tokens))
    assert lost < 0.005 * len(records), lost


def test_variants_are_valid():
    r = random.Random(2)
    records = [x for p in sorted((HERE / "readings").glob("*.jsonl")) for x in load(p)]
    changed = lost = 0
    for x in r.sample(records, 600):
        text, acts = vary.vary(r, x["text"], x["acts"])
        line = notation.write(canonical.acts(acts, x["kind"] == "prompt"))
        assert notation.write(notation.parse(line)) == line, line
        # (what the reading says can be pointed at in the changed words)
        lost += symbols.to_symbols(line, lexicon.tokens(text)) is None
        changed += text != x["text"]
    assert changed > 300, changed
    assert lost < 12, lost


def test_a_short_training_learns():
    import subprocess
    import sys

    with tempfile.TemporaryDirectory() as folder:
        run = [sys.executable, str(HERE / "train_reader.py"), folder, "--minutes", "0.4", "--workers", "1", "--width", "64", "--batch", "32"]
        log = subprocess.run(run, capture_output=True, text=True, check=True).stdout
        losses = [float(line.split("loss ")[1].split()[0]) for line in log.splitlines() if "loss" in line]
        assert losses and losses[-1] < 4.5, log
        assert (Path(folder) / "last.pt").exists()


if __name__ == "__main__":
    for name, test in list(globals().items()):
        if name.startswith("test_"):
            test()
            print(name, "ok")
