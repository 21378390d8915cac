"""The notation of readings (notation.md): parses a line into values and writes values as a line."""

import re

PAINTS = "white silver grey black red orange yellow green blue brown purple pink beige".split()
NOUNS = {
    "car": "car", "taxi": "car", "police_car": "car", "suv": "car", "van": "car", "ambulance": "truck", "limousine": "car",
    "truck": "truck", "pickup": "truck", "tanker": "truck", "dump_truck": "truck", "garbage_truck": "truck",
    "fire_truck": "truck", "tow_truck": "truck", "box_truck": "truck", "semi": "truck",
    "bus": "bus", "minibus": "bus", "school_bus": "bus", "trailer": "trailer", "caravan": "trailer",
    "construction_vehicle": "construction_vehicle", "excavator": "construction_vehicle", "bulldozer": "construction_vehicle",
    "crane": "construction_vehicle", "roller": "construction_vehicle", "forklift": "construction_vehicle",
    "tractor": "construction_vehicle", "loader": "construction_vehicle", "cement_mixer": "truck",
    "motorcycle": "motorcycle", "scooter": "motorcycle", "bicycle": "bicycle",
    "person": "pedestrian", "man": "pedestrian", "woman": "pedestrian", "child": "pedestrian", "worker": "pedestrian",
    "policeman": "pedestrian", "cone": "traffic_cone", "barrier": "barrier",
    "vehicle": None, "two_wheeler": None, "thing": None, "it": None, "one": None,
}
PICKS = "nearest farthest leftmost rightmost frontmost rearmost largest smallest".split()
STATES = ["moving", "parked", "waiting"]
SIZES = ["small", "large"]
ANCHORS = (
    "ego crossing junction ego_lane left_lane right_lane oncoming_lane cross_street road roadside left_roadside "
    "right_roadside sidewalk left_sidewalk right_sidewalk carpark other_side other_lane each_other"
).split()
RELATIONS = (
    "ahead behind left right near next_to far at on waiting blocking crossing facing facing_away following oncoming "
    "same_way across between like there in_line side_by_side"
).split()
WAYS = "left right forward back nearer away lane_left lane_right times".split()
VALUES = {
    "time": "dawn day dusk night".split(),
    "weather": "clear overcast rain snow fog sandstorm".split(),
    "road": "straight curve t_junction intersection roundabout highway parking suburb".split(),
    "env": "downtown urban suburban residential rural highway industrial nature".split(),
    "density": "empty light busy jam".split(),
    "own_lane": "left right middle".split(),
    "lacks": ["crossing", "sidewalk"],
}
MANOEUVRES = "drive follow stop cut_in cross pull_out park".split()
PACES = ["fast", "slow"]
VERBS = "add no remove keep leave replace move turn set count swap go length has lanes one_way narrow wide".split() + list(VALUES)


class Wrong(ValueError):
    pass


class Parser:
    def __init__(self, line):
        line = re.sub(r"\bgold\b", "yellow", line)
        self.tokens = line.replace("(", " ( ").replace(")", " ) ").replace(";", " ; ").split()
        self.at = 0

    def peek(self, k=0):
        return self.tokens[self.at + k] if self.at + k < len(self.tokens) else ""

    def take(self, *wanted):
        token = self.peek()
        if wanted and token not in wanted:
            raise Wrong(f"{token or 'the end'!r} where {' or '.join(wanted[:6])} should be, after {' '.join(self.tokens[max(0, self.at - 6):self.at])!r}")
        self.at += 1
        return token

    def number(self):
        token = self.take()
        if not re.fullmatch(r"\d+(\.\d+)?", token):
            raise Wrong(f"{token!r} is no number")
        return float(token)

    def whole(self):
        n = self.number()
        if n != int(n):
            raise Wrong(f"{n} is no whole number")
        return int(n)

    def metres(self):
        m = re.fullmatch(r"(\d+(?:\.\d+)?)m", self.peek())
        if not m:
            return None
        self.at += 1
        return float(m[1])

    def measure(self, unit):
        m = re.fullmatch(r"(\d+(?:\.\d+)?)" + unit, self.peek())
        if not m:
            raise Wrong(f"{self.peek()!r} where a number of {unit} should be")
        self.at += 1
        return float(m[1])

    def amount(self):
        n = self.whole()
        if self.peek() == "..":
            self.take()
            return [n, self.whole()]
        return n

    def reading(self):
        acts = []
        while self.at < len(self.tokens):
            acts.append(self.act())
            if self.at < len(self.tokens):
                self.take(";")
        return acts

    def list(self, new):
        things = [self.thing(new)]
        while self.peek() == "and":
            self.take()
            things.append(self.thing(new))
        return things

    def act(self):
        verb = self.take(*VERBS)
        act = {"act": verb}
        if verb == "add":
            act["things"] = self.list(True)
        elif verb in ("no", "remove", "keep", "leave"):
            if self.peek() == "rest":
                self.take()
                act["rest"] = True
            else:
                act["who"] = self.list(False)
        elif verb == "replace":
            act["who"] = self.list(False)
            self.take("with")
            act["things"] = self.list(True)
        elif verb == "swap":
            act["who"] = [self.thing(False)]
            self.take("and")
            act["who"].append(self.thing(False))
        elif verb == "move":
            act["who"] = self.list(False)
            if self.take("to", "by") == "to":
                act["to"] = self.places(1)
            else:
                way = self.take(*WAYS)
                act["way"] = way
                if way == "times":
                    act["n"] = self.number()
                elif way.startswith("lane"):
                    act["n"] = self.whole() if self.peek().isdigit() else 1
                else:
                    act["m"] = self.metres()
        elif verb == "turn":
            act["who"] = self.list(False)
            turn = self.take("around", "left", "right", "along", "to")
            if turn == "to":
                act["to"] = self.places(1)
            else:
                act["turn"] = turn
                m = re.fullmatch(r"(\d+(?:\.\d+)?)deg", self.peek())
                if m and turn in ("left", "right"):
                    self.take()
                    act["deg"] = float(m[1])
        elif verb == "set":
            act["who"] = self.list(False)
            look = {}
            while self.peek() and self.peek() != ";":
                token = self.take(*PAINTS, *STATES, *SIZES, "paint_of")
                if token == "paint_of":
                    look["paint_of"] = self.thing(False)
                else:
                    key = "paint" if token in PAINTS else "state" if token in STATES else "size"
                    look[key] = token
            if not look:
                raise Wrong("set to what?")
            act["look"] = look
        elif verb == "count":
            act["who"] = self.list(False)
            if self.take("to", "times") == "to":
                act["n"] = self.amount()
            else:
                act["times"] = self.number()
        elif verb == "go":
            if self.peek() == "ego":
                self.take()
                act["ego"] = True
            else:
                act["who"] = self.list(False)
            act["what"] = self.take(*MANOEUVRES)
            for key, unit in (("from", "s"), ("gap", "m"), ("speed", "kmh")):
                if self.peek() == key:
                    self.take()
                    act[key] = self.measure(unit)
            if self.peek() in PACES:
                act["pace"] = self.take()
        elif verb == "length":
            act["n"] = self.measure("s")
        elif verb == "has":
            act["what"] = self.take("crossing", "sidewalk")
            act["places"] = self.places(0)
        elif verb == "lanes":
            act["n"] = self.whole()
        elif verb in VALUES:
            act["what"] = self.take(*VALUES[verb])
        return act

    def thing(self, new):
        t = {}
        token = self.peek()
        if token == "the":
            t["the"] = True
            self.take()
        elif token in ("all", "half", "some", "many", "each"):
            t["n"] = self.take()
        if self.peek() == "other":
            t["other"] = True
            self.take()
        if re.fullmatch(r"\d+", self.peek()):
            t["n"] = self.amount()
        if self.peek() in PICKS:
            t["pick"] = self.take()
        elif self.peek() == "nth":
            self.take()
            t["nth"] = self.whole()
        if self.peek() in SIZES:
            t["size"] = self.take()
        if self.peek() in STATES:
            t["state"] = self.take()
        if self.peek() in PAINTS or self.peek().startswith("not_"):
            paint = self.take()
            if paint.removeprefix("not_") not in PAINTS:
                raise Wrong(f"{paint!r} is no paint")
            t["paint"] = paint
        noun = self.peek()
        if noun not in NOUNS:
            if t.get("other"):
                noun = "thing"
            else:
                raise Wrong(f"{noun or 'the end'!r} where a noun should be, after {' '.join(self.tokens[max(0, self.at - 6):self.at])!r}")
        else:
            self.take()
        t["noun"] = noun
        if re.fullmatch(r"#\d+", self.peek()):
            t["id"] = int(self.take()[1:])
        # (a state or paint after the noun is read, too)
        while self.peek() in STATES + PAINTS + SIZES and not ("look" in t):
            if not new and self.tokens[: self.at].count("set") and "set" in self.tokens[self.last_verb() : self.at]:
                break
            token = self.take()
            t["state" if token in STATES else "size" if token in SIZES else "paint"] = token
        places, t_except = [], []
        while self.peek() == "(":
            if self.peek(1) == "except":
                self.take(), self.take()
                t_except += self.list(False)
                self.take(")")
            else:
                places.append(self.place())
        if places:
            t["places"] = places
        if t_except:
            t["except"] = t_except
        return t

    def last_verb(self):
        for k in range(self.at - 1, -1, -1):
            if k == 0 or self.tokens[k - 1] == ";":
                return k
        return 0

    def places(self, least):
        out = []
        while self.peek() == "(":
            out.append(self.place())
        if len(out) < least:
            raise Wrong(f"a place should follow {' '.join(self.tokens[max(0, self.at - 6):self.at])!r}")
        return out

    def anchor(self):
        if self.peek() in ANCHORS:
            return self.take()
        return self.thing(False)

    def place(self):
        self.take("(")
        relation = self.take(*RELATIONS)
        p = {"rel": relation}
        if relation not in ("there", "in_line", "side_by_side"):
            p["to"] = self.anchor()
            if relation == "between" and self.peek() == "and":
                self.take()
                p["and"] = self.anchor()
        m = self.metres()
        if m is not None:
            p["m"] = m
        if relation == "at" and m is None:
            raise Wrong("at needs metres")
        self.take(")")
        return p


def parse(line):
    """The acts of a line; raises Wrong with the place."""
    return Parser(line).reading()


def number(x):
    return str(int(x)) if float(x) == int(x) else f"{x:g}"


def write_thing(t):
    out = []
    n = t.get("n")
    if t.get("the"):
        out.append("the")
    if isinstance(n, str):
        out.append(n)
    if t.get("other"):
        out.append("other")
    if isinstance(n, list):
        out += [str(n[0]), "..", str(n[1])]
    elif isinstance(n, int):
        out.append(str(n))
    if "pick" in t:
        out.append(t["pick"])
    if "nth" in t:
        out += ["nth", str(t["nth"])]
    out += [t[k] for k in ("size", "state", "paint") if t.get(k)]
    out.append(t["noun"])
    if "id" in t:
        out.append(f"#{t['id']}")
    out += [write_place(p) for p in t.get("places", [])]
    if t.get("except"):
        out.append(f"( except {' and '.join(write_thing(e) for e in t['except'])} )")
    return " ".join(out)


def write_place(p):
    anchor = lambda a: a if isinstance(a, str) else write_thing(a)
    out = ["(", p["rel"]]
    if "to" in p:
        out.append(anchor(p["to"]))
    if "and" in p:
        out += ["and", anchor(p["and"])]
    if p.get("m") is not None:
        out.append(f"{number(p['m'])}m")
    return " ".join(out + [")"])


def write_act(a):
    things = lambda key: " and ".join(write_thing(t) for t in a[key])
    verb = a["act"]
    if verb == "add":
        return f"add {things('things')}"
    if a.get("rest"):
        return f"{verb} rest"
    if verb in ("no", "remove", "keep", "leave", "swap"):
        return f"{verb} {things('who')}"
    if verb == "replace":
        return f"replace {things('who')} with {things('things')}"
    places = " ".join(write_place(p) for p in a.get("to", []))
    if verb == "move":
        if places:
            return f"move {things('who')} to {places}"
        rest = f" {number(a['n'])}" if a.get("n") and not (a["way"].startswith("lane") and a["n"] == 1) else ""
        rest += f" {number(a['m'])}m" if a.get("m") is not None else ""
        return f"move {things('who')} by {a['way']}{rest}"
    if verb == "turn":
        if places:
            return f"turn {things('who')} to {places}"
        return f"turn {things('who')} {a['turn']}" + (f" {number(a['deg'])}deg" if "deg" in a else "")
    if verb == "set":
        look = a["look"]
        out = [look[k] for k in ("size", "state", "paint") if k in look]
        if "paint_of" in look:
            out.append(f"paint_of {write_thing(look['paint_of'])}")
        return f"set {things('who')} {' '.join(out)}"
    if verb == "count":
        if "times" in a:
            return f"count {things('who')} times {number(a['times'])}"
        n = a["n"]
        return f"count {things('who')} to " + (f"{n[0]} .. {n[1]}" if isinstance(n, list) else str(n))
    if verb == "go":
        out = ["go", "ego" if a.get("ego") else things("who"), a["what"]]
        for key, unit in (("from", "s"), ("gap", "m"), ("speed", "kmh")):
            if key in a:
                out += [key, number(a[key]) + unit]
        return " ".join(out + ([a["pace"]] if "pace" in a else []))
    if verb == "length":
        return f"length {number(a['n'])}s"
    if verb == "has":
        return " ".join(["has", a["what"], *[write_place(p) for p in a["places"]]])
    if verb == "lanes":
        return f"lanes {a['n']}"
    return f"{verb} {a['what']}" if "what" in a else verb


def write(acts):
    """The line of acts; `parse` of it gives the same acts."""
    return " ; ".join(write_act(a) for a in acts)


def added(acts):
    """{class: (least, most)} that the acts add, nested new things included."""
    out = {}

    def one(t, new):
        n = t.get("n")
        if new or (isinstance(n, (int, list)) and not t.get("the") and not t.get("other")) or n in ("some", "many"):
            cls = NOUNS[t["noun"]]
            lo, hi = (n, n) if isinstance(n, int) else tuple(n) if isinstance(n, list) else (2, 12) if n else (1, 1)
            if cls:
                a, b = out.get(cls, (0, 0))
                out[cls] = (a + lo, b + hi)
        for p in t.get("places", []):
            for key in ("to", "and"):
                if isinstance(p.get(key), dict) and p["rel"] != "like":
                    one(p[key], False)

    for a in acts:
        if a["act"] == "add":
            for t in a["things"]:
                one(t, True)
    return out
