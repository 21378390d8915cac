"""One order for what can be said in any order: the network learns it, the judge of validation compares in it."""

FIRST = ["road", "lanes", "one_way", "narrow", "wide", "own_lane", "time", "weather", "env", "density", "has", "lacks", "length"]
LAST = ["no", "leave"]
RELATIONS = (
    "there like in_line side_by_side on blocking crossing waiting between following ahead behind left right next_to near "
    "far at across oncoming same_way facing facing_away"
).split()


def thing(t):
    t = dict(t)
    if "places" in t:
        t["places"] = [place(p) for p in sorted(t["places"], key=lambda p: RELATIONS.index(p["rel"]))]
    if "except" in t:
        t["except"] = [thing(e) for e in t["except"]]
    return t


def place(p):
    return {k: thing(v) if isinstance(v, dict) else v for k, v in p.items()}


def acts(list_, prompt):
    """The same acts in the one order; of a prompt everything that is added stands in one act."""
    out = []
    for a in list_:
        a = dict(a)
        for key in ("who", "things"):
            if key in a:
                a[key] = [thing(t) for t in a[key]]
        for key in ("to", "places"):
            if key in a:
                a[key] = [place(p) for p in sorted(a[key], key=lambda p: RELATIONS.index(p["rel"]))]
        if a["act"] == "set" and "paint_of" in a["look"]:
            a["look"] = {**a["look"], "paint_of": thing(a["look"]["paint_of"])}
        if out and a["act"] == out[-1]["act"] and a["act"] in ("add", "remove", "keep", "no") and "who" in a and "who" in out[-1]:
            out[-1]["who"] = out[-1]["who"] + a["who"]
        elif out and a["act"] == out[-1]["act"] == "add":
            out[-1]["things"] = out[-1]["things"] + a["things"]
        else:
            out.append(a)
    if prompt:
        rank = lambda a: len(FIRST) + 0.5 if a["act"] == "go" else FIRST.index(a["act"]) if a["act"] in FIRST else len(FIRST) + 1 + (LAST.index(a["act"]) if a["act"] in LAST else -1)
        out.sort(key=rank)
    else:
        # time and weather first; what stays, last
        out.sort(key=lambda a: 0 if a["act"] in ("time", "weather") else 2 if a["act"] == "leave" else 1)
    return out
