"""Words to tokens: numbers and measures read, typing errors mended, senses looked up. Twin of src/gen/words/{tokens,lexicon}.rs."""

import re
from dataclasses import dataclass, field
from pathlib import Path

LEXICON = Path(__file__).parents[2] / "assets/words/lexicon.txt"
TENS = {"twenty": 20, "thirty": 30, "forty": 40, "fourty": 40, "fifty": 50, "sixty": 60, "seventy": 70, "eighty": 80, "ninety": 90}
ONES = {
    w: i
    for i, w in enumerate(
        "zero one two three four five six seven eight nine ten eleven twelve thirteen fourteen fifteen sixteen "
        "seventeen eighteen nineteen".split()
    )
}
NUMBERS = {**ONES, **TENS, "dozen": 12, "hundred": 100}
LONGEST_PHRASE = 5


@dataclass
class Token:
    text: str  # lower case; "<n>" for digits, "<m>" for a measure, "<v>" for a speed
    start: int  # bytes of the text
    end: int
    value: float | None = None  # of a number word, digits, a measure in metres or a speed in km/h
    measure: bool = False
    senses: list = field(default_factory=list)  # (kind, symbol)
    was: str | None = None  # before a typing error was mended


def plural(word):
    """By rule."""
    head, _, last = word.rpartition(" ")
    if re.search(r"(s|x|z|ch|sh)$", last):
        last += "es"
    elif re.search(r"[^aeiou]y$", last):
        last = last[:-1] + "ies"
    else:
        last += "s"
    return f"{head} {last}".strip()


def load():
    """{phrase (tuple of words): [(kind, symbol, is_plural)]} and the units."""
    table, units = {}, {}
    for line in LEXICON.read_text().splitlines():
        if line.startswith("#") or not line.strip():
            continue
        key, words = line.split(": ", 1)
        kind, symbol = key.split(" ", 1)
        for word in words.split(", "):
            if kind in ("unit", "speed"):
                units[tuple(word.split())] = (kind, float(symbol))
                continue
            forms = word.split("/")
            many = forms[1:] or ([plural(forms[0])] if kind in ("noun", "group", "place") else [])
            for form, is_plural in [(forms[0], False), *[(f, True) for f in many]]:
                table.setdefault(tuple(form.split()), []).append((kind, symbol, is_plural))
    return table, units


TABLE, UNITS = load()
ENGLISH = {w for w in (LEXICON.parent / "english.txt").read_text().splitlines() if not w.startswith("#")}
SINGLE = {k[0] for k in TABLE if len(k) == 1}
PIECES = re.compile(r"\d+(?:[.,]\d+)?|[^\W\d_]+(?:['’`][^\W\d_]+)?|[^\w\s]|_")


def pieces(text):
    """(text, start byte, end byte) in order."""
    out = []
    for m in PIECES.finditer(text):
        start = len(text[: m.start()].encode())
        out.append((m[0].lower(), start, start + len(m[0].encode())))
    return out


def split_words(text):
    out = []
    for piece, start, end in pieces(text):
        if len(piece) > 1 and re.search("['’`]", piece):
            head, tail = re.split("['’`]", piece, maxsplit=1)
            if tail in ("s", "re", "ll", "ve", "d", "m") and head not in ("let",):
                cut = start + len(head.encode())
                out.append((head, start, cut))
                out.append(("'" + tail, cut, end))
            else:
                out.append((head + tail, start, end))
        else:
            out.append((piece, start, end))
    # a hyphen between words is a space
    keep = []
    for i, (w, s, e) in enumerate(out):
        if w in "-–‑" and 0 < i < len(out) - 1 and out[i - 1][2] == s and e == out[i + 1][1]:
            if not (out[i - 1][0][0].isdigit() and out[i + 1][0][0].isdigit()):
                continue
        keep.append((w, s, e))
    return keep


def close(a, b):
    """True if one insertion, deletion, substitution or swap of neighbours makes b of a."""
    if a == b or abs(len(a) - len(b)) > 1:
        return a == b
    i = 0
    while i < min(len(a), len(b)) and a[i] == b[i]:
        i += 1
    if len(a) == len(b):
        return a[i + 1 :] == b[i + 1 :] or (i + 1 < len(a) and a[i] == b[i + 1] and a[i + 1] == b[i] and a[i + 2 :] == b[i + 2 :])
    return a[i + 1 :] == b[i:] if len(a) > len(b) else a[i:] == b[i + 1 :]


class Speller:
    """Mends words that are in no list and no English words: the most frequent one that one slip makes of it."""

    def __init__(self, common):
        self.common = common  # word -> rank (0 is the most frequent)
        self.by_length = {}
        for w in [*common, *(w for w in SINGLE if w not in common)]:
            self.by_length.setdefault(len(w), []).append(w)
        self.memory = {}

    def known(self, w):
        return w in self.common or w in SINGLE or w in ENGLISH or w in NUMBERS or (w,) in UNITS or len(w) < 3 or not w.isalpha()

    def mend(self, w):
        if self.known(w):
            return None
        if w not in self.memory:
            if len(self.memory) > 20000:
                self.memory.clear()
            best = None
            for n in (len(w), len(w) + 1, len(w) - 1):
                for c in self.by_length.get(n, []):
                    # (of three letters two may be swapped, no more)
                    if len(c) >= 3 and close(w, c) and (len(w) > 3 or sorted(c) == sorted(w)):
                        rank = self.common.get(c, len(self.common))
                        key = (c[0] != w[0], rank, c)
                        if best is None or key < best[0]:
                            best = (key, c)
            self.memory[w] = best[1] if best else None
        return self.memory[w]


def tokens(text, speller=None):
    """The tokens of a text."""
    out = []
    words = split_words(text)
    i = 0
    while i < len(words):
        w, s, e = words[i]
        if w[0].isdigit():
            value = float(w.replace(",", "."))
            t = Token("<n>", s, e, value)
            i += 1
        else:
            was = None
            if speller:
                fixed = speller.mend(w)
                if fixed:
                    was, w = w, fixed
            t = Token(w, s, e, was=was)
            if w in NUMBERS:
                t.value = float(NUMBERS[w])
                if w in TENS and i + 1 < len(words) and 0 < ONES.get(words[i + 1][0], 0) < 10:
                    t.value += ONES[words[i + 1][0]]
                    t.end = words[i + 1][2]
                    i += 1
            i += 1
        if t.value is not None:
            for n in (3, 2, 1):
                unit = tuple(x[0] for x in words[i : i + n])
                if len(unit) == n and unit in UNITS and not (unit == ("m",) and t.text != "<n>") and unit != ("ms",):
                    kind, factor = UNITS[unit]
                    t.text, t.measure = "<m>" if kind == "unit" else "<v>", True
                    t.value *= factor
                    t.end = words[i + n - 1][2]
                    i += n
                    break
        out.append(t)
    look_up(out)
    return out


def look_up(tokens):
    i = 0
    while i < len(tokens):
        for n in range(min(LONGEST_PHRASE, len(tokens) - i), 0, -1):
            found = TABLE.get(tuple(t.text for t in tokens[i : i + n]))
            if found:
                for t in tokens[i : i + n]:
                    t.senses += found
                i += n
                break
        else:
            i += 1


if __name__ == "__main__":
    import sys

    for t in tokens(" ".join(sys.argv[1:]), Speller({})):
        print(t)
