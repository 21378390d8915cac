"""What the reader network hears and says: ids of words, senses and symbols."""

import re

import lexicon
import notation

GRAMS = 4096
MOST_NUMBERS = 8  # numeric tokens that can be pointed at
LONGEST = 112  # tokens
ROOM = 160  # symbols

WHOLE = [str(n) for n in range(21)]
METRES = [f"{n}m" for n in range(1, 46)]
SYMBOLS = (
    ["<end>", ";", "(", ")", "and", "to", "by", "with", "the", "all", "half", "some", "many", "other", "..", "nth", "except", "rest", "around", "along", "paint_of", "#"]
    + [v for v in notation.VERBS if v not in ("go", "length")]
    + list(notation.NOUNS)
    + notation.PAINTS
    + ["not_" + p for p in notation.PAINTS]
    + notation.PICKS
    + notation.STATES
    + notation.SIZES
    + notation.ANCHORS
    + notation.RELATIONS
    + notation.WAYS
    + [v for values in notation.VALUES.values() for v in values]
    + WHOLE
    + METRES
    + ["0.5", "0.33", "0.25", "1.5", "30deg", "45deg", "90deg", "180deg"]
    + [f"@{k}" for k in range(MOST_NUMBERS)]  # metres, and after "#" an id
    + [f"={k}" for k in range(MOST_NUMBERS)]  # a number of things above twenty
    + ["each"]
    # (what is new stands at the end: weights of before keep their places)
    + ["go", "length", *notation.MANOEUVRES, "from", "gap", "speed", *notation.PACES, "2.5", "3.5"]
)
UNIT = {"from": "s", "length": "s", "speed": "kmh"}  # of a number after these symbols; else metres
SYMBOLS = list(dict.fromkeys(SYMBOLS))
ID = {s: i for i, s in enumerate(SYMBOLS)}
END = 0


def senses():
    """Ids of senses, a noun's plural apart; 0 is none."""
    names = []
    for found in lexicon.TABLE.values():
        for kind, symbol, many in found:
            names.append((kind, symbol, many))
    return {s: i + 1 for i, s in enumerate(sorted(set(names)))}


SENSES = senses()


def sense_symbol(sense):
    kind, symbol, _ = sense
    if kind in ("noun", "paint", "time", "weather", "env", "density", "road"):
        return ID.get(symbol)
    if kind == "place":
        return ID.get(symbol)
    if kind == "ego":
        return ID["ego"]
    return None


def fnv(text):
    h = 0x811C9DC5
    for b in text.encode():
        h = ((h ^ b) * 0x01000193) & 0xFFFFFFFF
    return h


def grams(word):
    """Buckets of the letter triples of a word with its ends."""
    w = f"^{word}$"
    return sorted({1 + fnv(w[i : i + 3]) % (GRAMS - 1) for i in range(max(1, len(w) - 2))})


def numbers_of(tokens):
    """Indices of the first numeric tokens."""
    return [i for i, t in enumerate(tokens) if t.value is not None][:MOST_NUMBERS]


def to_symbols(line, tokens):
    """Symbols of a reading beside the tokens of its text; None if it cannot be said."""
    numeric = [tokens[i].value for i in numbers_of(tokens)]
    out = []

    def point(v, tolerance):
        best = [k for k, n in enumerate(numeric) if abs(n - v) <= tolerance]
        return f"@{best[0]}" if best else None

    pieces = line.split()
    for i, s in enumerate(pieces):
        if s.startswith("#"):
            at = point(float(s[1:]), 0.0)
            if not at:
                return None
            out += ["#", at]
        elif re.fullmatch(r"[\d.]+(m|s|kmh)", s):
            v = float(re.match(r"[\d.]+", s)[0])
            at = point(v, 0.06)
            if not at and not s.endswith("m") and v != int(v):
                out.append(notation.number(v) if notation.number(v) in ID else None)
                continue
            # (a length that no words give)
            out.append(at or (f"{round(v)}m" if 1 <= round(v) <= 45 else None))
        elif re.fullmatch(r"\d+", s):
            out.append(s if int(s) <= 20 else (point(float(s), 0.0) or "").replace("@", "=") or None)
        elif s in ID:
            out.append(s)
        else:
            return None
    if None in out:
        return None
    return [ID[s] for s in out] + [END]


def to_line(ids, tokens):
    """The reading that symbols say."""
    numeric = [tokens[i].value for i in numbers_of(tokens)] + [0.0] * MOST_NUMBERS
    out = []
    for i in ids:
        s = SYMBOLS[i]
        if i == END:
            break
        if s[0] == "=" and len(s) == 2:
            out.append(str(int(numeric[int(s[1])])))
        elif s[0] == "@":
            v = numeric[int(s[1])]
            if out and out[-1] == "#":
                out[-1] = f"#{int(v)}"
            else:
                out.append(f"{notation.number(v)}{UNIT.get(out[-1] if out else '', 'm')}")
        elif out and out[-1] in UNIT and re.fullmatch(r"[\d.]+m?", s):
            out.append(s.rstrip("m") + UNIT[out[-1]])
        else:
            out.append(s)
    return " ".join(out)
