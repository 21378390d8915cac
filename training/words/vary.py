"""Variants of a labelled sentence: other things, paints, numbers, metres and sides in the same words."""

import re

import lexicon
import notation
from generate import JOINS, OPENINGS, CLOSINGS, Speaker, slips
from phrases import NOUNS, PAINTS

GROUPS = [
    "car taxi police_car suv van ambulance truck pickup tanker fire_truck bus minibus trailer caravan construction_vehicle excavator semi".split(),
    "motorcycle scooter bicycle".split(),
    "person man woman child worker policeman".split(),
    "cone barrier".split(),
]
WEIGHTS = {"car": 5, "truck": 4, "bus": 4, "trailer": 2, "construction_vehicle": 2, "person": 5, "bicycle": 4, "motorcycle": 4, "cone": 3, "barrier": 2}
ARITHMETIC = set("half twice double triple halve quarter many more fewer less each total altogether second third other rest remain remaining both apiece every per".split())
WORDS = "zero one two three four five six seven eight nine ten eleven twelve".split()


MOTION = [("from", range(2, 13)), ("gap", range(4, 26)), ("speed", range(10, 120, 5))]


def walk(node, fn):
    """Calls fn on every dict of a reading."""
    if isinstance(node, dict):
        fn(node)
        for v in node.values():
            walk(v, fn)
    elif isinstance(node, list):
        for v in node:
            walk(v, fn)


def copy(node):
    return {k: copy(v) for k, v in node.items()} if isinstance(node, dict) else [copy(v) for v in node] if isinstance(node, list) else node


def phrases_of(tokens, kind):
    """(first token, last token, symbol, plural) of the phrases with one sense of that kind."""
    out, i = [], 0
    while i < len(tokens):
        for n in range(min(lexicon.LONGEST_PHRASE, len(tokens) - i), 0, -1):
            found = lexicon.TABLE.get(tuple(t.text for t in tokens[i : i + n]))
            if found:
                ours = [f for f in found if f[0] == kind]
                if len(ours) == 1 and len(found) == 1:
                    out.append((i, i + n - 1, ours[0][1], ours[0][2]))
                i += n
                break
        else:
            i += 1
    return out


def vary(r, text, acts):
    """Another (text, acts) that fit."""
    acts = copy(acts)
    raw = text.encode()
    tokens = lexicon.tokens(text)
    changes = []  # (start, end, words)
    words = {t.text for t in tokens}

    nouns, paints = set(), set()
    walk(acts, lambda d: (nouns.add(d["noun"]) if "noun" in d else None, paints.add(d["paint"]) if isinstance(d.get("paint"), str) else None))
    spoken = phrases_of(tokens, "noun")
    said = {s[2] for s in spoken}
    swap = {}
    for x in nouns & said:
        group = next((g for g in GROUPS if x in g), None)
        if not group or r.random() < 0.25:
            continue
        free = [y for y in group if y not in nouns and y not in said and y not in swap.values()]
        if free and r.random() < 0.75:
            swap[x] = r.choices(free, [WEIGHTS.get(y, 1) for y in free])[0]
        else:
            swap[x] = x
    for i, j, sym, many in spoken:
        if sym in swap:
            new = r.choice(NOUNS[swap[sym]])[1 if many else 0] if r.random() < 0.6 else NOUNS[swap[sym]][0][1 if many else 0]
            changes.append((tokens[i].start, tokens[j].end, new))

    def rename(d):
        if d.get("noun") in swap:
            d["noun"] = swap[d["noun"]]

    walk(acts, rename)

    hues = phrases_of(tokens, "paint")
    plain = {p.removeprefix("not_") for p in paints}
    walk(acts, lambda d: plain.add(d["look"]["paint"]) if isinstance(d.get("look"), dict) and "paint" in d["look"] else None)
    if {h[2] for h in hues} >= plain and plain:
        others = [p for p in PAINTS if p not in plain]
        r.shuffle(others)
        hue = dict(zip(sorted(plain), others))
        for i, j, sym, _ in hues:
            if sym in hue:
                changes.append((tokens[i].start, tokens[j].end, r.choice(PAINTS[hue[sym]])))

        def repaint(d):
            p = d.get("paint")
            if isinstance(p, str):
                d["paint"] = "not_" + hue[p[4:]] if p.startswith("not_") else hue.get(p, p)

        walk(acts, repaint)

    numeric = [t for t in tokens if t.value is not None]
    counts = []
    walk(acts, lambda d: counts.append(d) if isinstance(d.get("n"), int) and ("noun" in d or d.get("act") == "count") else None)
    if not words & ARITHMETIC:
        used = {}
        for t in numeric:
            if t.measure or t.value != int(t.value) or not 2 <= t.value <= 12:
                continue
            mine = [d for d in counts if d["n"] == int(t.value)]
            same = [u for u in numeric if u.value == t.value]
            if len(mine) == 1 and len(same) == 1 and r.random() < 0.7:
                n = r.choice([2, 3, 4, 5, 6, 7, 8, 9])
                if n in used:
                    continue
                used[n] = 1
                mine[0]["n"] = n
                changes.append((t.start, t.end, str(n) if t.text == "<n>" else WORDS[n]))
    metres = []
    walk(acts, lambda d: metres.append(d) if d.get("m") is not None else None)
    for t in numeric:
        mine = [d for d in metres if abs(d["m"] - t.value) < 0.06]
        same = [u for u in numeric if abs(u.value - t.value) < 0.06]
        if not mine or len(same) != 1 or r.random() < 0.2:
            continue
        piece = raw[t.start : t.end].decode()
        m = re.match(r"[\d.,]+", piece)
        n = r.choice([3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16, 18, 20, 22, 24, 25, 26, 28, 30, 32, 35])
        if any(abs(u.value - n) < 0.06 for u in numeric):
            continue
        if m:
            number, rest = str(n), piece[m.end() :]
        elif n <= 12:
            head = re.match(r"[a-zA-Z]+(?:[ -](?:one|two|three|four|five|six|seven|eight|nine)\b)?", piece)
            if not head:
                continue
            number, rest = WORDS[n], piece[head.end() :]
        else:
            continue
        factor = t.value / float(m[0].replace(",", ".")) if m and t.value and float(m[0].replace(",", ".")) else 1.0
        if not m and t.measure:
            continue_value = lexicon.tokens(piece)[0].value
            word_value = lexicon.tokens(piece[: head.end()])[0].value
            factor = continue_value / word_value if word_value else 1.0
        changes.append((t.start, t.end, number + rest))
        for d in mine:
            d["m"] = round(n * factor, 1)

    # Seconds, speeds and gaps of motions; lengths of a scene.
    timed = []
    walk(acts, lambda d: timed.extend((d, k, c) for k, c in MOTION if k in d) if d.get("act") == "go" else timed.append((d, "n", range(3, 21))) if d.get("act") == "length" else None)
    for d, key, choices in timed:
        spoken_of = [t for t in numeric if abs(t.value - d[key]) < 0.06]
        if len(spoken_of) != 1 or len([1 for e, k, _ in timed if abs(e[k] - d[key]) < 0.06]) != 1 or r.random() < 0.25:
            continue
        t, n = spoken_of[0], r.choice(choices)
        m = re.match(r"[\d.,]+", raw[t.start : t.end].decode())
        if any(abs(u.value - n) < 0.06 for u in numeric) or not (m or n <= 12) or any(c[0] == t.start for c in changes) or not m and t.measure:
            continue
        factor = t.value / float(m[0].replace(",", ".")) if m and t.value else 1.0
        piece = raw[t.start : t.end].decode()
        changes.append((t.start, t.end, str(n) + piece[m.end() :] if m else WORDS[n]))
        d[key] = round(n * factor, 1)

    sides = [t for t in tokens if t.text in ("left", "right")]
    line = notation.write(acts)
    signs = re.findall(r"\b(?:left|right)(?:_\w+)?\b|\blane_(?:left|right)\b|\b(?:left|right)most\b", line)
    if sides and len(sides) == len(signs) and r.random() < 0.5:
        for t in sides:
            changes.append((t.start, t.end, "right" if t.text == "left" else "left"))
        line = re.sub(r"left|right", lambda m: "right" if m[0] == "left" else "left", line)
        acts = notation.parse(line)

    changes.sort()
    out, at = b"", 0
    for start, end, new in changes:
        if start < at:
            continue
        old = raw[start:end].decode()
        if old[:1].isupper() and old[1:2].islower():
            new = new[:1].upper() + new[1:]
        elif old.islower():
            new = new.lower()
        out += raw[at:start] + new.encode()
        at = end
    text = (out + raw[at:]).decode()
    text = re.sub(r"\b([Aa])n? (?=[aeiou])", lambda m: m[1] + "n ", text)
    text = re.sub(r"\b([Aa])n (?=[bcdfghjklmnpqrstvwxyz])", lambda m: m[1] + " ", text)
    text = re.sub(r"\b([Aa])n (?=(?:uni|use|ute|one)\b)", lambda m: m[1] + " ", text)
    return text, acts


ALONE = re.compile(r"\b(it|one|other|rest|keep|leave|there|no)\b")


def roughen(r, text):
    q = r.random()
    if q < 0.15:
        text = text.lower()
    elif q < 0.22:
        text = re.sub(r"[,;:.!?](?=\s|$)", "", text).lower()
    if r.random() < 0.08:
        text = slips(r, text)
    if r.random() < 0.06:
        text = re.sub(r"\b(the|an?) ", "", text)
    return text


def joined(r, a, b):
    """Two edits in one text, if the second stands for itself."""
    if ALONE.search(b["reading"]) or ALONE.search(a["reading"]) or len(a["text"]) + len(b["text"]) > 220:
        return None
    text = a["text"].rstrip(". !") + r.choice(JOINS) + b["text"][:1].lower() + b["text"][1:]
    return {"kind": "edit", "text": text, "reading": a["reading"] + " ; " + b["reading"]}


def wrapped(r, record):
    if record["kind"] == "edit" and r.random() < 0.12:
        text = record["text"].rstrip(".")
        opening = r.choice(OPENINGS)
        return {**record, "text": (opening + text[:1].lower() + text[1:] if opening else text) + r.choice(CLOSINGS)}
    return record
