"""Random readings and the sentences that say them. `python3 generate.py N SEED` prints pairs."""

import random
import re
import sys

import notation
import motion_phrases as motion
from phrases import *

WORDS = "zero one two three four five six seven eight nine ten eleven twelve".split()


class Speaker:
    """One voice: its habits stay the same over a sentence."""

    def __init__(self, rng):
        self.r = rng
        self.digits = rng.random() < 0.35
        self.articles = rng.choices(["kept", "dropped", "wrong"], [0.78, 0.16, 0.06])[0]
        self.my = rng.choice(MY)
        self.ego = rng.choice(EGO)
        self.unit = rng.choices([" m", "m", " metres", " meters", " yards", " feet", " ft", " car lengths"], [4, 4, 4, 3, 0.6, 0.5, 0.3, 0.2])[0]

    def pick(self, options):
        return self.r.choice(options)

    def number(self, n):
        return str(n) if self.digits or n > 12 else WORDS[n]

    def metres(self, m):
        """Words for so many metres; the value they come to stands in the reading."""
        if self.unit in (" yards", " feet", " ft", " car lengths"):
            per = {" yards": 0.9144, " feet": 0.3048, " ft": 0.3048, " car lengths": 4.6}[self.unit]
            n = max(1, round(m / per / (5 if per < 1 and m > 10 else 1)) * (5 if per < 1 and m > 10 else 1))
            self.exact = round(n * per, 1)
            return f"{n}{self.unit}"
        self.exact = m
        whole = m == int(m)
        words = whole and not self.digits and m <= 12 and self.r.random() < 0.5
        text = WORDS[int(m)] if words else (str(int(m)) if whole else f"{m:g}")
        unit = self.unit if not words else " metres"
        return f"{text}{unit}"

    def fill(self, template, **kw):
        text = template
        for key, value in kw.items():
            text = text.replace("{" + key + "}", value)
        mine = {"my": "mine", "our": "ours"}.get(self.my, "the ego lane")
        return text.replace("{my}", self.my).replace("{mine}", mine).replace("{i}", "we" if self.my == "our" else "I")


def article(text):
    return ("an " if re.match(r"[aeiouAEIO]", text) and not re.match(r"(?:uni|use|ute|U|one)", text) else "a ") + text


def noun_of(s, t, many):
    forms = s.pick(NOUNS[t["noun"]])
    if s.r.random() < 0.5:
        forms = NOUNS[t["noun"]][0]
    return forms[1 if many else 0]


def states_of(noun):
    return WALKS if noun in LIVING else RIDES if noun in CYCLES else STATES


def place_words(s, p, noun):
    rel, to = p["rel"], p.get("to")
    m = p.get("m")
    text = ""
    if m is not None:
        text = s.metres(m)
        p["m"] = s.exact
    if to is None:
        return s.pick(PLACES[(rel,)])
    if isinstance(to, dict):
        x = thing_words(s, to, anchor=True)
        if rel == "between":
            if "and" not in p:
                return s.fill(s.pick(PLACES[("between", "two")]), x=x)
            y = s.ego if p["and"] == "ego" else thing_words(s, p["and"], anchor=True)
            if s.r.random() < 0.3 and p["and"] == "ego":
                x, y = y, x
            return s.fill(s.pick(PLACES[("between", "thing")]), x=x, y=y)
        key = (rel, "thing", "m") if m is not None else (rel, "thing")
        return s.fill(s.pick(PLACES[key]), x=x, m=text)
    if to == "ego":
        key = (rel, "ego", "m") if m is not None else (rel, "ego")
        return s.fill(s.pick(PLACES[key]), x=s.ego, m=text)
    kind = {"ego_lane": "lane", "left_lane": "lane", "right_lane": "lane", "oncoming_lane": "lane", "cross_street": "cross_street", "roadside": "strip", "left_roadside": "strip", "right_roadside": "strip", "sidewalk": "walk", "left_sidewalk": "walk", "right_sidewalk": "walk"}.get(to, to)
    x = s.fill(s.pick(ANCHORS[to]))
    key = (rel, to) if (rel, to) in PLACES else (rel, kind)
    return s.fill(s.pick(PLACES[key]), x=x)


def quantity(s, t, many):
    n = t.get("n")
    if t.get("the"):
        first = s.pick(["the", "the", "the", "that", "this"]) if not isinstance(n, int) else s.pick(["the", "the", "those", "both" if n == 2 else "the", "all"])
        if first == "both":
            return "both"
        if isinstance(n, int):
            if first == "all":
                first = s.pick(["all", "all the", "all of the"])
            return f"{first} {'other ' if t.get('other') else ''}{s.number(n)}"
        return first + (" other" if t.get("other") else "")
    if n == "all":
        return s.pick(["the", "all the", "all", "every single one of the", "all of the"]) + (" other" if t.get("other") else "")
    if n == "half":
        return s.pick(["half of the", "half the", "every second one of the"])
    if n == "some":
        return s.pick(["some", "a few", "several", "a couple of" if False else "a handful of"])
    if n == "many":
        return s.pick(["many", "lots of", "a lot of", "plenty of", "loads of"])
    if isinstance(n, list):
        a, b = (s.number(x) for x in n)
        return s.pick([f"{a} to {b}", f"between {a} and {b}", f"{a} or {b}" if n[1] == n[0] + 1 else f"from {a} to {b}", f"{n[0]}-{n[1]}"])
    return s.number(n)


def thing_words(s, t, anchor=False, bare=False, who=False):
    """A noun phrase; `who`: of something that is there."""
    n = t.get("n")
    many = n in ("all", "half", "some", "many") or isinstance(n, list) or (isinstance(n, int) and n != 1)
    if t["noun"] == "it":
        return s.pick(["it", "that", "it", "that one", "him", "her"]) if not many else s.pick(["them", "these", "they"])
    adjectives, after = [], []
    if "size" in t:
        adjectives.append(s.pick(SIZES[t["size"]]))
    if "state" in t:
        before, behind = states_of(t["noun"]).get(t["state"], ([t["state"]], [t["state"]]))
        if t.get("places") and s.r.random() < 0.6:
            after.append(s.pick(before))
        elif s.r.random() < 0.6:
            adjectives.append(s.pick(before))
        else:
            after.append(s.pick(behind))
    if "paint" in t:
        paint = t["paint"]
        if paint.startswith("not_"):
            after.append(s.pick(["that are not ", "that aren't ", "which are not "]) + paint[4:] if many else "that is not " + paint[4:])
        elif s.r.random() < 0.9:
            adjectives.append(s.pick(PAINTS[paint]))
        else:
            after.append(s.pick(["in ", "painted ", "that is " if not many else "that are "]) + s.pick(PAINTS[paint]))
    one_of = who and isinstance(n, int) and not t.get("the") and "pick" not in t and "nth" not in t
    noun = noun_of(s, t, many or one_of)
    if s.r.random() < 0.2 and len(adjectives) > 1:
        s.r.shuffle(adjectives)
    core = " ".join([*adjectives, noun])
    if bare:
        return core
    if "id" in t:
        said = f"#{t['id']}" if t["noun"] == "thing" else f"{noun} #{t['id']}"
        return said if t["noun"] == "thing" else s.pick(["the ", ""]) + said
    if "pick" in t:
        pick = s.pick({"nearest": ["nearest", "closest"], "farthest": ["farthest", "furthest", "most distant"], "leftmost": ["leftmost"], "rightmost": ["rightmost"], "frontmost": ["foremost", "frontmost"], "rearmost": ["rearmost", "hindmost"], "largest": ["largest", "biggest"], "smallest": ["smallest"]}[t["pick"]])
        text = f"the {pick} {s.number(n) + ' ' if isinstance(n, int) and n > 1 else ''}{core}"
    elif "nth" in t:
        word = {0: "last", 1: "first", 2: "second", 3: "third", 4: "fourth"}[t["nth"]]
        text = f"the {word} {core}"
    elif one_of:
        text = s.pick([f"{s.number(n)} of the {core}", f"{s.number(n)} of the {core}", f"any {s.number(n)} of the {core}"])
    elif n == 1 and not t.get("the"):
        text = article(core) if s.r.random() < 0.85 else s.pick(["one ", "a single ", "1 "]) + core
    elif n == "each":
        plural = " ".join([*adjectives, noun_of(s, t, True)])
        text = s.pick([f"each {core}", f"every {core}", f"each of the {plural}", f"every one of the {plural}"])
    elif n == "all" and s.r.random() < 0.2:
        single = " ".join([*adjectives, noun_of(s, t, False)])
        text = s.pick(["every ", "each ", "any "]) + single
    elif n == 2 and not t.get("the") and s.r.random() < 0.2:
        text = s.pick(["a couple of ", "a pair of "]) + core
    elif n == 6 and s.r.random() < 0.15 and not t.get("the"):
        text = "half a dozen " + core
    elif n is None and not t.get("the"):
        text = core
    else:
        text = f"{quantity(s, t, many)} {core}"
    places = [place_words(s, p, t["noun"]) for p in t.get("places", [])]
    if len(places) > 1 and s.r.random() < 0.25:
        places.reverse()
    rest = " ".join([*after, *places])
    if t.get("except"):
        rest += s.pick([" except ", " but ", " apart from ", " other than ", " save for "]) + list_words(s, t["except"], True)
    if rest:
        link = " "
        if places and not after and s.r.random() < 0.2:
            link = s.pick([", ", " which is ", " that is ", " that's "] if not many else [", ", " that are ", " which are "])
        text += link + rest.strip()
    return text


def list_words(s, things, who):
    texts = [thing_words(s, t, who=who) for t in things]
    if len(texts) == 1:
        return texts[0]
    if len(texts) == 2 and s.r.random() < 0.1:
        return f"both {texts[0]} and {texts[1]}"
    return ", ".join(texts[:-1]) + s.pick([" and ", " and ", ", and ", " plus ", " as well as ", " & "]) + texts[-1]


# ---- random readings


def some_place(r, noun, new, deep=0):
    """One place for a thing of that kind."""
    living, fixed, cycle = noun in LIVING, noun in FIXED, noun in CYCLES
    m = float(r.choice([5, 8, 10, 12, 15, 15, 18, 20, 20, 22, 25, 25, 28, 30, 30, 35, 7, 9, 11, 13, 14, 16, 17, 24, 27, 33, 6, 36, 7.5]))
    roll = r.random()
    if roll < 0.34:
        rel = r.choices(["ahead", "behind", "left", "right", "near", "next_to", "far", "at"], [9, 4, 5, 5, 1, 1, 1, 1])[0]
        p = {"rel": rel, "to": "ego"}
        if rel == "at" or (rel in ("ahead", "behind") and r.random() < 0.55) or (rel in ("left", "right") and r.random() < 0.06):
            p["m"] = m
        return p
    if roll < 0.44 and not fixed:
        rel = r.choice(["oncoming", "oncoming", "same_way", "facing", "facing_away"] if living or r.random() < 0.3 else ["oncoming", "oncoming", "same_way", "following"])
        p = {"rel": rel, "to": "ego"}
        if rel == "oncoming" and r.random() < 0.25:
            p["m"] = m
        return p
    if roll < 0.72:
        if living:
            return r.choice([{"rel": "on", "to": "crossing"}, {"rel": "on", "to": "crossing"}, {"rel": "waiting", "to": "crossing"}, {"rel": "on", "to": "left_sidewalk"}, {"rel": "on", "to": "right_sidewalk"}, {"rel": "on", "to": "sidewalk"}, {"rel": "crossing", "to": "road"}, {"rel": "near", "to": "crossing"}, {"rel": "on", "to": "road"}, {"rel": "on", "to": "carpark"}, {"rel": "on", "to": "junction"}, {"rel": "waiting", "to": "junction"}]).copy()
        if fixed:
            return r.choice([{"rel": "blocking", "to": "ego_lane"}, {"rel": "on", "to": "ego_lane"}, {"rel": "on", "to": "right_lane"}, {"rel": "on", "to": "left_lane"}, {"rel": "on", "to": "roadside"}, {"rel": "on", "to": "left_roadside"}, {"rel": "on", "to": "right_roadside"}, {"rel": "on", "to": "right_sidewalk"}, {"rel": "on", "to": "road"}, {"rel": "on", "to": "crossing"}, {"rel": "on", "to": "oncoming_lane"}, {"rel": "near", "to": "crossing"}]).copy()
        return r.choice([{"rel": "on", "to": "ego_lane"}, {"rel": "on", "to": "ego_lane"}, {"rel": "on", "to": "left_lane"}, {"rel": "on", "to": "right_lane"}, {"rel": "on", "to": "oncoming_lane"}, {"rel": "on", "to": "left_roadside"}, {"rel": "on", "to": "right_roadside"}, {"rel": "on", "to": "roadside"}, {"rel": "waiting", "to": "crossing"}, {"rel": "waiting", "to": "junction"}, {"rel": "on", "to": "junction"}, {"rel": "near", "to": "junction"}, {"rel": "on", "to": "cross_street"}, {"rel": "blocking", "to": "ego_lane"}, {"rel": "on", "to": "carpark"}, {"rel": "on", "to": "right_sidewalk"}, {"rel": "on", "to": "sidewalk"}, {"rel": "blocking", "to": "crossing"}]).copy()
    if deep:
        return {"rel": r.choice(["left", "right"]), "to": "ego"}
    rel = r.choices(["ahead", "behind", "left", "right", "near", "next_to", "between", "across", "following", "facing", "facing_away", "like", "far", "at"], [5, 6, 3, 3, 3, 6, 4, 1.5, 3 if not fixed and not living else 0.2, 1 if living else 0.2, 0.3, 0.7, 0.2, 0.3])[0]
    other = anchor_thing(r, new, deep)
    p = {"rel": rel, "to": other}
    if rel == "between":
        q = r.random()
        if q < 0.35:
            p["and"] = "ego"
        elif q < 0.75:
            p["and"] = anchor_thing(r, new, deep)
        else:
            p["to"] = {"the": True, "n": 2, "noun": other["noun"]} if not new or r.random() < 0.3 else {"n": 2, "noun": other["noun"]}
    elif rel == "at" or (rel in ("ahead", "behind") and r.random() < 0.2):
        p["m"] = float(r.choice([3, 4, 5, 6, 8, 10, 12, 15]))
    if rel == "like":
        p["to"] = {"the": True, "noun": other["noun"]}
    return p


def anchor_thing(r, new, deep):
    t = {"noun": r.choice(COMMON)}
    if new and not deep and r.random() < 0.05:
        t["n"] = "each"
    elif new and r.random() < 0.6:
        t["n"] = 1
    else:
        t["the"] = True
    if r.random() < 0.25 and t["noun"] not in LIVING | FIXED:
        t["paint"] = r.choice(list(PAINTS))
    elif r.random() < 0.15:
        t["state"] = "parked" if t["noun"] not in LIVING | FIXED else "waiting" if t["noun"] in LIVING else None
        if not t["state"]:
            del t["state"]
    if r.random() < 0.08:
        t["places"] = [some_place(r, t["noun"], new, 1)]
    return t


def look(r, t, state=0.25, paint=0.3):
    noun = t["noun"]
    if noun not in FIXED and r.random() < state:
        t["state"] = r.choice(["parked", "parked", "waiting", "moving"] if noun not in LIVING else ["waiting", "moving"])
    if noun not in LIVING and noun not in ("cone", "barrier") and r.random() < paint:
        t["paint"] = r.choice(list(PAINTS))
    elif noun in FIXED and r.random() < 0.05:
        t["paint"] = r.choice(["orange", "red", "white"])
    if r.random() < 0.03:
        t["size"] = r.choice(["small", "large"])


def new_thing(r, places=None):
    t = {}
    q = r.random()
    t["n"] = 1 if q < 0.5 else r.choices([2, 3, 4, 5, 6, 7, 8, 10, 12], [9, 7, 5, 4, 3, 1, 1, 1, 1])[0] if q < 0.9 else r.choice(["some", "many", [2, 4], [3, 5], [2, 3], [5, 7], [4, 6], [6, 8]])
    noun = r.choice(COMMON) if r.random() < 0.85 else r.choice([n for n in NOUNS if n not in ("thing", "one", "two_wheeler", "vehicle")])
    t["noun"] = noun
    look(r, t)
    k = places if places is not None else r.choices([0, 1, 2], [2, 6, 2.2])[0]
    rels = []
    for _ in range(k):
        p = some_place(r, noun, True)
        if p["rel"] in rels or (rels and isinstance(p.get("to"), dict)) or {p["rel"], *rels} >= {"left", "right"} or {p["rel"], *rels} >= {"ahead", "behind"}:
            continue
        rels.append(p["rel"])
        t.setdefault("places", []).append(p)
    if "places" in t and any(p["rel"] in ("oncoming", "following", "same_way") or (p["rel"] == "on" and p.get("to") == "crossing") for p in t["places"]):
        t.pop("state", None)
    if isinstance(t["n"], int) and t["n"] > 1 and r.random() < 0.06:
        t.setdefault("places", []).append({"rel": r.choice(["in_line", "side_by_side"])})
    return {k: t[k] for k in ("n", "size", "state", "paint", "noun", "places") if k in t}


def who(r, many=0.35, plain=False):
    """Something that is there."""
    t = {}
    q = r.random()
    if q > 0.97:
        return {"the": True, "noun": r.choice(COMMON) if r.random() < 0.5 else "thing", "id": r.randint(1, 40)}
    noun = r.choice(COMMON) if r.random() < 0.86 else r.choice([n for n in NOUNS if n not in ("one",)])
    if q < 0.05 and not plain:
        return {"the": True, "noun": "it"} if r.random() < 0.7 else {"n": "all", "noun": "it"}
    if r.random() < many:
        k = r.random()
        if k < 0.5:
            t["n"] = "all"
        elif k < 0.72:
            t["the"], t["n"] = True, r.choice([2, 2, 2, 3, 3, 4, 5])
        elif k < 0.93:
            t["n"] = r.choice([1, 1, 1, 2, 2, 3])
        else:
            t["n"] = "half"
    else:
        t["the"] = True
        if r.random() < 0.06:
            t["other"] = True
        elif r.random() < 0.12:
            if r.random() < 0.75:
                del t["the"]
                t["the"] = True
                t["pick"] = r.choice(["nearest", "nearest", "farthest", "farthest", "leftmost", "rightmost", "frontmost", "rearmost", "largest", "smallest"])
            else:
                t["nth"] = r.choice([0, 1, 2, 3])
    t["noun"] = noun
    look(r, t, 0.12, 0.3)
    if t.get("paint") and r.random() < 0.08:
        t["noun"] = "one"
    if r.random() < 0.16 and "pick" not in t and not plain:
        p = some_place(r, t["noun"], False, 0 if r.random() < 0.4 else 1)
        p.pop("m", None)
        if p["rel"] not in ("at", "like"):
            t["places"] = [p]
    if t.get("n") == "all" and r.random() < 0.08 and not plain:
        t["except"] = [who(r, 0, True)]
    order = ("the", "n", "other", "pick", "nth", "size", "state", "paint", "noun", "places", "except")
    return {k: t[k] for k in order if k in t}


def whos(r, many=0.35):
    n = r.choices([1, 2, 3], [10, 2.2, 0.4])[0]
    return [who(r, many, plain=n > 1) for _ in range(n)]


def capital(text):
    return text[:1].upper() + text[1:]


def say_add(r, s, t, edit):
    n = t.get("n")
    if edit and isinstance(n, int) and not t.get("paint") and r.random() < 0.3:
        tail = " ".join(place_words(s, p, t["noun"]) for p in t.get("places", []))
        lead = " ".join(s.pick(states_of(t["noun"])[t["state"]][0]) for _ in [0] if "state" in t)
        bare = (lead + " " + noun_of(s, t, n > 1)).strip()
        head = s.fill(s.pick(ANOTHER if n == 1 else MORE), n=s.number(n), s=bare)
        return f"{head} {tail}".strip()
    return thing_words(s, t)


def seconds(s, n):
    return str(n) if s.digits or n > 12 or n != int(n) else WORDS[int(n)]


def motion_act(r, s, who_, words, many, ego=False, noun="car"):
    """(act, words) of a motion of somebody said in `words`."""
    walks = noun in LIVING
    choices = ["cross", "drive", "stop"] if walks else list(motion.VERBS)
    what = r.choices(choices, [8, 1, 2] if walks else [3, 1.5, 4, 0 if ego else 5, 0.3 if ego else 1.2, 1.5 if ego else 4, 2])[0]
    act = {"act": "go", **({"ego": True} if ego else {"who": who_}), "what": what}
    verbs, tails = motion.VERBS[what], []
    if what == "cross" and walks and r.random() < 0.35:
        verbs, act["pace"] = motion.RUNS, "fast"
    do, does = s.pick(verbs)
    q = r.random()
    if q < 0.62 or (ego and q < 0.8):
        n = r.choice([1, 2, 2, 3, 3, 4, 5, 6, 7, 8, 10, 1.5, 2.5, 3.5])
        text = seconds(s, n)
        tails.append(s.fill(s.pick(motion.WHEN), n=text, sec=s.pick(["second"] if n == 1 else ["seconds", "seconds", "sec", "s"]), s="s" if text[0].isdigit() else " s"))
        act["from"] = float(n)
    elif q < 0.8 and not ego:
        m = s.metres(float(r.choice([5, 6, 8, 10, 12, 15, 20])))
        act["gap"] = s.exact
        tails.append(s.fill(s.pick(motion.GAP), m=m))
    if "pace" not in act and r.random() < (0.5 if what in ("drive", "follow") else 0.16):
        if r.random() < 0.7:
            unit, per = s.pick(motion.UNITS)
            n = r.choice([5, 10, 15, 20, 30, 40, 50, 60, 70, 80, 100, 120] if per < 3 else [5, 8, 10, 15, 20])
            act["speed"] = round(n * per, 1)
            tails.append(s.fill(s.pick(motion.SPEED), n=str(n), u=unit))
        else:
            act["pace"] = r.choice(["fast", "slow"])
            tails.append(s.pick(motion.FAST if act["pace"] == "fast" else motion.SLOW))
    r.shuffle(tails)
    if ego and words in ("we", "I"):
        core = f"{words} {do}" if r.random() < 0.7 else f"{words} will {do}"
    elif many or r.random() < 0.6:
        core = s.fill(s.pick(motion.LET), w=words, do=do)
    else:
        core = f"{words} {does}"
    core = s.fill(core)
    if tails and r.random() < 0.25:
        return act, tails[0] + s.pick([" ", ", "]) + " ".join([core, *tails[1:]])
    return act, " ".join([core, *tails])


def edit_act(r, s):
    """(act, words) of a random edit."""
    kind = r.choices(
        ["add", "remove", "move", "by", "replace", "count", "paint", "keep", "leave", "turn", "swap", "state", "time", "weather", "no", "paint_of", "times", "has", "range", "go", "length"],
        [16, 13, 11, 8, 9, 7, 9, 4, 3, 6, 2.5, 3, 5, 5, 2, 0.8, 2.5, 1, 4, 15, 1],
    )[0]
    if kind == "go":
        if r.random() < 0.2:
            return motion_act(r, s, None, s.pick(motion.EGO), False, ego=True)
        w = [who(r, 0.15)]
        return motion_act(r, s, w, list_words(s, w, True), w[0].get("n") not in (None, 1), noun=w[0]["noun"])
    if kind == "length":
        n = r.randint(3, 20)
        return {"act": "length", "n": float(n)}, s.fill(s.pick(motion.LENGTH), n=seconds(s, n), sec=s.pick(["seconds", "s", "sec"]))
    if kind == "add":
        things = [new_thing(r) for _ in range(r.choices([1, 2], [9, 1.5])[0])]
        words = s.fill(s.pick(ADD), t=" and ".join(say_add(r, s, t, True) for t in things))
        return {"act": "add", "things": things}, words
    if kind == "remove":
        w = whos(r)
        text = list_words(s, w, True)
        bare = re.sub(r"^(the|all the|all of the|that|this|those|all) ", "", text)
        return {"act": "remove", "who": w}, s.fill(s.pick(REMOVE), w=text, w_bare=bare)
    if kind == "keep":
        w = whos(r)
        return {"act": "keep", "who": w}, s.fill(s.pick(KEEP), w=list_words(s, w, True))
    if kind == "leave":
        if r.random() < 0.4:
            return {"act": "leave", "rest": True}, s.pick(LEAVE_REST)
        w = whos(r, 0.2)
        return {"act": "leave", "who": w}, s.fill(s.pick(LEAVE), w=list_words(s, w, True))
    if kind == "replace":
        w, t = whos(r), [new_thing(r, 0)]
        if len(w) == 1 and w[0].get("n") == "all":
            t[0]["n"] = r.choice([2, 3, 4, 1])
        text = thing_words(s, t[0])
        wt = list_words(s, w, True)
        bare = re.sub(r"^(the|that|this) ", "", wt)
        return {"act": "replace", "who": w, "things": t}, s.fill(s.pick(REPLACE), w=wt, w_a=article(bare), t=text)
    if kind == "move":
        w = whos(r, 0.15)
        noun = w[0]["noun"] if w[0]["noun"] not in ("it", "one", "thing", "vehicle") else "car"
        n = r.choices([1, 2], [8, 2])[0]
        places = []
        for _ in range(n):
            p = some_place(r, noun, False)
            if all(p["rel"] != q["rel"] for q in places) and not (places and isinstance(p.get("to"), dict)) and not {p["rel"], *(q["rel"] for q in places)} >= {"left", "right"} and not {p["rel"], *(q["rel"] for q in places)} >= {"ahead", "behind"}:
                places.append(p)
        text = list_words(s, w, True)
        pt = " ".join(place_words(s, p, noun) for p in places)
        if pt.startswith(("on ", "in ")) and r.random() < 0.25:
            pt = s.pick(["onto", "into", "to"]) + pt[2:]
        return {"act": "move", "who": w, "to": places}, s.fill(s.pick(MOVE_TO), w=text, p=pt)
    if kind == "range":
        w = [who(r, 0)]
        text = list_words(s, w, True)
        words = s.metres(float(r.choice([5, 8, 9, 10, 12, 14, 15, 18, 20, 22, 25, 28, 30, 35])))
        m = s.exact
        other = s.metres(float(r.choice([6, 11, 16, 21, 26, 31])))
        return {"act": "move", "who": w, "to": [{"rel": "at", "to": "ego", "m": m}]}, s.fill(s.pick(TO_RANGE), w=text, m=words, o=other)
    if kind == "by":
        w = [who(r, 0.12)]
        text = list_words(s, w, True)
        way = r.choices(["nearer", "away", "left", "right", "forward", "back", "lane_left", "lane_right", "times"], [5, 4, 2, 2, 2, 2, 1, 1, 1])[0]
        act = {"act": "move", "who": w, "way": way}
        if way == "times":
            n = r.choice([2, 0.5])
            act["n"] = n
            return act, s.fill(s.pick(TIMES_FAR[n]), w=text)
        if way.startswith("lane"):
            act["n"] = 1
            return act, s.fill(s.pick(LANES[way]), w=text)
        if r.random() < 0.75:
            words = s.metres(float(r.choice([1, 2, 3, 4, 5, 5, 6, 8, 10, 10, 12, 15])))
            act["m"] = s.exact
            bank = {"nearer": NEARER, "away": AWAY}.get(way) or BY[way]
            return act, s.fill(s.pick(bank), w=text, m=words)
        act["m"] = None
        bank = {"nearer": NEARER_0, "away": AWAY_0}.get(way) or BY_0[way]
        return act, s.fill(s.pick(bank), w=text)
    if kind == "turn":
        w = whos(r, 0.15)
        text = list_words(s, w, True)
        q = r.random()
        if q < 0.45:
            return {"act": "turn", "who": w, "turn": "around"}, s.fill(s.pick(TURN), w=text)
        if q < 0.6:
            side = r.choice(["left", "right", "along"])
            return {"act": "turn", "who": w, "turn": side}, s.fill(s.pick(TURN_SIDE[side]), w=text)
        key = r.choice(list(TURN_TO))
        x = {"the": True, "noun": r.choice(COMMON)} if key[1] == "thing" else "ego"
        words = thing_words(s, x) if key[1] == "thing" else ""
        return {"act": "turn", "who": w, "to": [{"rel": key[0], "to": x}]}, s.fill(s.pick(TURN_TO[key]), w=text, x=words)
    if kind == "paint":
        w = whos(r)
        c = r.choice(list(PAINTS))
        return {"act": "set", "who": w, "look": {"paint": c}}, s.fill(s.pick(PAINT), w=list_words(s, w, True), c=s.pick(PAINTS[c]))
    if kind == "paint_of":
        w, x = [who(r, 0.2)], {"the": True, "noun": r.choice(COMMON)}
        return {"act": "set", "who": w, "look": {"paint_of": x}}, s.fill(s.pick(PAINT_OF), w=list_words(s, w, True), x=thing_words(s, x))
    if kind == "state":
        w = whos(r, 0.2)
        st = r.choice(["parked", "moving", "waiting"])
        if r.random() < 0.12:
            size = r.choice(["small", "large"])
            return {"act": "set", "who": w, "look": {"size": size}}, s.fill(s.pick(SET_SIZE[size]), w=list_words(s, w, True))
        return {"act": "set", "who": w, "look": {"state": st}}, s.fill(s.pick(SET_STATE[st]), w=list_words(s, w, True))
    if kind == "count":
        t = {"noun": r.choice(COMMON)}
        look(r, t, 0.12, 0.15)
        n = r.choices([1, 2, 3, 4, 5, 6, 7, 8, 10, 0], [4, 5, 4, 3, 3, 2, 1, 1, 1, 0.5])[0]
        bare = thing_words(s, {**t, "n": 2}, bare=True)
        if n == 0:
            return {"act": "no", "who": [t]}, s.fill(s.pick(NONE), s=bare, one=thing_words(s, {**t, "n": 1}, bare=True))
        if n == 1:
            one = thing_words(s, {**t, "n": 1}, bare=True)
            template = s.pick(["there should be only one {s}", "just one {s}", "only one {s}", "only one of the {p} should remain", "reduce the {p} to one", "keep only one of the {p}", "one {s} is enough", "a single {s} is enough", "leave one of the {p}", "thin out the {p} until a single one is left", "from the {p} only one shall remain", "all {p} but one can go", "one {s} only"])
            return {"act": "count", "who": [t], "n": 1}, s.fill(template, s=one, p=bare)
        return {"act": "count", "who": [t], "n": n}, s.fill(s.pick(COUNT), n=s.number(n), s=bare)
    if kind == "times":
        t = {"noun": r.choice(COMMON)}
        n = r.choice([2, 2, 2, 3, 4, 0.5, 0.5])
        return {"act": "count", "who": [t], "times": n}, s.fill(s.pick(TIMES_N[n]), s=thing_words(s, {**t, "n": 2}, bare=True))
    if kind == "swap":
        a, b = who(r, 0, True), who(r, 0, True)
        return {"act": "swap", "who": [a, b]}, s.fill(s.pick(SWAP), w=thing_words(s, a), x=thing_words(s, b))
    if kind == "no":
        t = {"noun": r.choice(COMMON + ["vehicle"])}
        look(r, t, 0.15, 0.1)
        return {"act": "no", "who": [t]}, s.fill(s.pick(NONE), s=thing_words(s, {**t, "n": 2}, bare=True), one=thing_words(s, {**t, "n": 1}, bare=True))
    if kind == "time":
        t = r.choice(list(TIMES))
        return {"act": "time", "what": t}, s.pick(TIME_EVENTS[t]) if r.random() < 0.3 else s.fill(s.pick(TIME_SET), t=s.pick(TIMES[t]))
    if kind == "weather":
        t = r.choice(list(WEATHERS))
        return {"act": "weather", "what": t}, s.pick(WEATHER_EVENTS[t]) if r.random() < 0.35 else s.fill(s.pick(WEATHER_SET), t=s.pick(WEATHERS[t]))
    what = r.choice(["crossing", "crossing", "sidewalk"])
    words = s.pick(HAS[what])
    if r.random() < 0.25:
        return {"act": "lacks", "what": what}, s.pick(["remove ", "no ", "take away ", "without "]) + re.sub(r"^an? ", "the ", words)
    act = {"act": "has", "what": what, "places": []}
    text = s.pick(["add ", "there should be ", "put ", ""]) + words
    if what == "crossing" and r.random() < 0.5:
        p = {"rel": "ahead", "to": "ego", "m": float(r.choice([8, 10, 12, 15, 20, 25]))}
        text += " " + place_words(s, p, "car")
        act["places"] = [p]
    return act, text


def say_edit(r, s):
    n = r.choices([1, 2, 3], [6.5, 3, 0.6])[0]
    acts, words = [], []
    for _ in range(n):
        a, w = edit_act(r, s)
        acts.append(a)
        words.append(w)
    if n > 1 and r.random() < 0.12:
        # a shared verb: "remove the car and the bus ... , the truck too"
        pass
    text = words[0]
    for w in words[1:]:
        text += s.pick(JOINS) + w
    return acts, text


def say_prompt(r, s):
    acts, before, body, after = [], [], [], []
    if r.random() < 0.32:
        road = r.choice(list(ROADS))
        acts.append({"act": "road", "what": road})
        (before if r.random() < 0.7 else after).append(("road", s.pick(ROADS[road])))
    if r.random() < 0.38:
        t = r.choice(list(TIMES))
        acts.append({"act": "time", "what": t})
        (before if r.random() < 0.5 else after).append(("time", s.pick(TIMES[t])))
    if r.random() < 0.36:
        t = r.choice(list(WEATHERS))
        acts.append({"act": "weather", "what": t})
        (before if r.random() < 0.5 else after).append(("weather", s.pick(WEATHERS[t])))
    if r.random() < 0.05:
        t = r.choice(list(ENVS))
        acts.append({"act": "env", "what": t})
        after.append(("env", s.pick(ENVS[t])))
    if r.random() < 0.05:
        t = r.choice(list(DENSITIES))
        acts.append({"act": "density", "what": t})
        after.append(("density", s.pick(DENSITIES[t])))
    if r.random() < 0.04:
        t = r.choice(["crossing", "sidewalk"])
        acts.append({"act": "has", "what": t, "places": []})
        after.append(("has", s.pick(["with ", "and "]) + s.pick(HAS[t])))
    things = [new_thing(r) for _ in range(r.choices([1, 2, 3, 4], [5, 4, 1.6, 0.4])[0])]
    acts.append({"act": "add", "things": things})
    said = []
    for t in things:
        w = thing_words(s, t)
        if r.random() < 0.2:
            many = t.get("n") != 1
            w = s.pick(["there are ", "we have ", "you see "] if many else ["there is ", "we have ", "there's ", "you see "]) + w
        elif r.random() < 0.1 and t.get("places"):
            p = place_words(s, t["places"][0], t["noun"])
            rest = {**t, "places": t["places"][1:]}
            w = p + s.pick([" ", ", ", " there is ", " stands ", ": "]) + thing_words(s, rest)
        said.append(w)
    text = said[0]
    for w in said[1:]:
        text += s.pick(JOINS) + w
    if r.random() < 0.3:
        movers = [t for t in things if t.get("n") == 1 and sum(t["noun"] == u["noun"] for u in things) == 1]
        for t in r.sample(movers, min(len(movers), r.choice([1, 1, 2]))):
            if t["noun"] in FIXED:
                continue
            w = {"the": True, "noun": t["noun"]}
            words = thing_words(s, w) if len(things) > 1 or r.random() < 0.5 else s.pick(["it", "which then", "and it"])
            a, said_of = motion_act(r, s, [w], words, False, noun=t["noun"])
            acts.append(a)
            text += s.pick([", ", ". ", "; ", " and then ", ". Then "]) + said_of
        if r.random() < 0.3:
            a, said_of = motion_act(r, s, None, s.pick(motion.EGO), False, ego=True)
            acts.append(a)
            text += s.pick([", ", ". ", "; "]) + said_of
    if r.random() < 0.12:
        t = {"noun": r.choice(COMMON + ["vehicle"])}
        acts.append({"act": "no", "who": [t]})
        text += s.pick([", ", ". ", " and ", " but "]) + s.fill(s.pick(NONE), s=thing_words(s, {**t, "n": 2}, bare=True), one=thing_words(s, {**t, "n": 1}, bare=True))
    elif r.random() < 0.09:
        w = s.pick(NO_OTHER)
        acts.append({"act": "no", "who": [{"other": True, "noun": "vehicle" if "traffic" in w else "thing"}]})
        text += s.pick([", ", ". ", " and ", " - "]) + w
    lead = ""
    r.shuffle(before)
    parts = [w for _, w in before]
    adjectives = [k for k, _ in before]
    if parts:
        if "road" in adjectives and r.random() < 0.35 and len(parts) > 1:
            road = dict(before)["road"]
            bare = re.sub(r"^(an?|the) ", "", road)
            adj = []
            for a in acts:
                if a["act"] == "weather" and "weather" in adjectives:
                    adj.append(WEATHER_ADJ[a["what"]])
                if a["act"] == "time" and "time" in adjectives:
                    adj.append(TIME_ADJ[a["what"]])
            lead = article(" ".join([*adj, bare]))
        else:
            lead = s.pick([", ", ", ", " "]).join(parts)
        lead += s.pick([", ", ". ", ": ", " with ", " - ", ", "])
    text = s.pick(SCENES) + lead + text
    for _, w in after:
        text += s.pick([", ", ", ", ". ", " "]) + w
    order = ["road", "time", "weather", "env", "density", "has", "lacks", "add", "go", "no"]
    acts.sort(key=lambda a: order.index(a["act"]))
    return acts, text


def roughen(r, s, text):
    """The habits of a voice, and slips."""
    if s.articles == "dropped":
        text = re.sub(r"\b(the|an?) ", lambda m: "" if r.random() < 0.85 else m[0], text)
    elif s.articles == "wrong":
        text = re.sub(r"\b(the|an?) ", lambda m: r.choice(["", "the ", "a ", m[0]]), text)
    if r.random() < 0.3:
        text = text.lower()
    if r.random() < 0.2:
        text = re.sub(r"[,;:.!?](?=\s|$)", "", text)
    if r.random() < 0.14:
        text = slips(r, text)
    if r.random() < 0.5 and not text.endswith((".", "!", "?")):
        text = capital(text) + "."
    return re.sub(r"\s+", " ", text).strip() if "\n" not in text else text.strip()


def slips(r, text):
    words = text.split(" ")
    for k, w in enumerate(words):
        if len(w) < 4 or not w.isalpha() or r.random() > 0.18:
            continue
        i = r.randrange(1, len(w) - 1)
        how = r.random()
        if how < 0.4:
            w = w[:i] + w[i + 1] + w[i] + w[i + 2 :]
        elif how < 0.65:
            w = w[:i] + w[i + 1 :]
        elif how < 0.85:
            w = w[:i] + w[i] + w[i:]
        else:
            w = w[:i] + r.choice("abcdefghijklmnopqrstuvwxyz") + w[i + 1 :]
        words[k] = w
    return " ".join(words)


def pair(r):
    """{"kind", "text", "reading"}."""
    while True:
        s = Speaker(r)
        prompt = r.random() < 0.42
        acts, text = (say_prompt if prompt else say_edit)(r, s)
        if not prompt:
            text = s.pick(OPENINGS) + text + s.pick(CLOSINGS)
        text = roughen(r, s, text)
        line = notation.write(acts)
        if len(text) < 400 and notation.parse(line):
            return {"kind": "prompt" if prompt else "edit", "text": text, "reading": line}


if __name__ == "__main__":
    import json

    rng = random.Random(int(sys.argv[2]) if len(sys.argv) > 2 else 0)
    for _ in range(int(sys.argv[1])):
        print(json.dumps(pair(rng), ensure_ascii=False))
