"""Writes the sample roads beside this file: python3 make_roads.py. Standard library only; all of it is made up here.

Together they hold every kind of geometry, a four-arm and a direct junction, crossings in each of the ways
a file can give them, stop lines, sidewalks, parking, bicycle lanes, lane offsets, changing widths, lane
borders, one-sided lane sections and left-hand traffic.
"""
import math
from pathlib import Path

HERE = Path(__file__).resolve().parent


def number(value):
    return f"{value:.12g}"


def tag(name, /, *children, **attributes):
    text = "".join(f' {key}="{number(v) if isinstance(v, float) else v}"' for key, v in attributes.items())
    inner = "\n".join(children)
    if not inner:
        return f"<{name}{text}/>"
    return f"<{name}{text}>\n" + "\n".join("  " + line for line in inner.split("\n")) + f"\n</{name}>"


# Geometry: (kind, length, numbers); the end of one record is the start of the next.

def headings(kind, length, k, s):
    if kind == "line":
        return 0.0
    if kind == "arc":
        return k["curvature"] * s
    return s * (k["curvStart"] + 0.5 * (k["curvEnd"] - k["curvStart"]) * s / length)  # spiral


def cubic(k, p):
    return k[0] + p * (k[1] + p * (k[2] + p * k[3]))


def slope(k, p):
    return k[1] + p * (2 * k[2] + p * 3 * k[3])


def simpson(f, a, b, n=2000):
    h = (b - a) / n
    return h / 3 * (f(a) + f(b) + sum((4 if i % 2 else 2) * f(a + i * h) for i in range(1, n)))


def end_of(kind, length, k):
    """End point and heading in the frame of the start."""
    if kind in ("line", "arc", "spiral"):
        turn = lambda s: headings(kind, length, k, s)
        return simpson(lambda s: math.cos(turn(s)), 0, length), simpson(lambda s: math.sin(turn(s)), 0, length), turn(length)
    if kind == "poly3":
        v = [k[c] for c in "abcd"]
        low, high = 0.0, length
        for _ in range(60):
            middle = 0.5 * (low + high)
            run = simpson(lambda u: math.hypot(1, slope(v, u)), 0, middle, 400)
            low, high = (middle, high) if run < length else (low, middle)
        return low, cubic(v, low), math.atan(slope(v, low))
    u, v = [k[c] for c in ("aU", "bU", "cU", "dU")], [k[c] for c in ("aV", "bV", "cV", "dV")]
    p = 1.0 if k["pRange"] == "normalized" else length
    return cubic(u, p), cubic(v, p), math.atan2(slope(v, p), slope(u, p))


def param_poly3(u, v, length=None):
    """Normalized unless a length is given; then p is that arc length."""
    k = dict(zip(("aU", "bU", "cU", "dU", "aV", "bV", "cV", "dV"), map(float, u + v)))
    k["pRange"] = "normalized" if length is None else "arcLength"
    run = length or simpson(lambda p: math.hypot(slope(u, p), slope(v, p)), 0, 1)
    return "paramPoly3", run, k


def plan_view(x, y, heading, records):
    nodes, s = [], 0.0
    for kind, length, k in records:
        nodes.append(tag("geometry", tag(kind, **k), s=s, x=x, y=y, hdg=heading, length=length))
        u, v, turn = end_of(kind, length, k)
        x, y = x + u * math.cos(heading) - v * math.sin(heading), y + u * math.sin(heading) + v * math.cos(heading)
        heading, s = heading + turn, s + length
    return tag("planView", *nodes), s


# Lanes

def mark(kind, s=0.0, color="white"):
    return tag("roadMark", sOffset=s, type=kind, weight="standard", color=color, width=0.12, laneChange="none" if kind == "solid" else "both")


def cubic_records(name, start, records):
    return [tag(name, **{start: float(s)}, **dict(zip("abcd", map(float, k)))) for s, k in records]


def lane(number_, kind, width, *marks, border=False):
    """`width` is a number or a list of (sOffset, (a, b, c, d))."""
    records = width if isinstance(width, list) else [(0, (width, 0, 0, 0))]
    shape = cubic_records("border" if border else "width", "sOffset", records)
    return tag("lane", *shape, *marks, id=number_, type=kind, level="false")


def section(s, left, center, right, **more):
    sides = [tag("left", *left)] if left else []
    sides.append(tag("center", tag("lane", *center, id=0, type="none", level="false")))
    sides += [tag("right", *right)] if right else []
    return tag("laneSection", *sides, s=float(s), **more)


def link(**ends):
    def one(name, kind, element, contact):
        more = {"contactPoint": contact} if contact else {}
        return tag(name, elementType=kind, elementId=element, **more)
    return tag("link", *(one(name, *end) for name, end in ends.items()))


def road(number_, plan, sections, name="", junction=-1, links=None, offsets=(), objects=(), signals=(), rule="RHT", **more):
    view, length = plan
    nodes = [links or tag("link"), view, tag("lanes", *cubic_records("laneOffset", "s", offsets), *sections)]
    if objects:
        nodes.append(tag("objects", *objects))
    if signals:
        nodes.append(tag("signals", *signals))
    return tag("road", *nodes, name=name, id=number_, junction=junction, length=length, rule=rule, **more)


def write(name, version, *nodes):
    header = tag("header", revMajor=1, revMinor=version, name=name, version="1.00", vendor="sceneloom")
    text = '<?xml version="1.0" encoding="UTF-8"?>\n' + tag("OpenDRIVE", header, *nodes) + "\n"
    (HERE / f"{name}.xodr").write_text(text, encoding="utf-8")


def local_outline(points):
    corners = [tag("cornerLocal", u=float(u), v=float(v), z=0.0, height=0.0, id=i) for i, (u, v) in enumerate(points)]
    return tag("outlines", tag("outline", *corners, id=0, closed="true"))


def road_outline(points):
    corners = [tag("cornerRoad", s=float(s), t=float(t), dz=0.0, height=0.0, id=i) for i, (s, t) in enumerate(points)]
    return tag("outlines", tag("outline", *corners, id=0, closed="true"))


def stop_sign_line(number_, s, orientation):
    return tag("signal", id=number_, s=float(s), t=0.0, dynamic="no", orientation=orientation, type="294", subtype="-1", country="OpenDRIVE", value=0.0)


LINE = lambda length: ("line", float(length), {})
ARC = lambda length, k: ("arc", float(length), dict(curvature=float(k)))
SPIRAL = lambda length, k0, k1: ("spiral", float(length), dict(curvStart=float(k0), curvEnd=float(k1)))


def straight_two_way():
    sides = lambda sign: [lane(sign, "driving", 3.5, mark("solid")), lane(2 * sign, "sidewalk", 2.0)]
    crossing = tag("object", road_outline([(98, -3.5), (102, -3.5), (102, 3.5), (98, 3.5)]), type="crosswalk", id=1, s=100.0, t=0.0)
    lines = [tag("object", type="roadMark", subtype="stopLine", id=2, s=96.0, t=-1.75, orientation="+"),
             tag("object", type="roadMark", subtype="stopLine", id=3, s=104.0, t=1.75, orientation="-")]
    lamp = tag("object", type="pole", id=4, s=60.0, t=4.5, radius=0.1, height=6.0)
    body = section(0, sides(1)[::-1], [mark("broken")], sides(-1))
    write("straight_two_way", 7, road(1, plan_view(0.0, 0.0, 0.0, [LINE(200)]), [body], objects=[crossing, *lines, lamp]))


def corner(size, turn):
    """Spiral, arc, spiral through a right angle, from the origin along x to (size, +-size)."""
    third = math.pi / 6
    unit = [SPIRAL(2 * third, 0, 1), ARC(third, 1), SPIRAL(2 * third, 1, 0)]
    x = y = heading = 0.0
    for record in unit:
        u, v, t = end_of(*record)
        x, y = x + u * math.cos(heading) - v * math.sin(heading), y + u * math.sin(heading) + v * math.cos(heading)
        heading += t
    assert abs(x - y) < 1e-9 and abs(heading - math.pi / 2) < 1e-9
    scale, k = size / x, turn * x / size
    return [SPIRAL(2 * third * scale, 0, k), ARC(third * scale, k), SPIRAL(2 * third * scale, k, 0)]


def four_arm_junction():
    edge, nodes, links = 16.0, [], []
    for arm in range(4):
        heading = arm * math.pi / 2
        sides = lambda sign: [lane(sign, "driving", 3.5, mark("solid")), lane(2 * sign, "sidewalk", 2.0)]
        crossing = tag("object", local_outline([(-1.5, -3.5), (1.5, -3.5), (1.5, 3.5), (-1.5, 3.5)]), type="crosswalk", id=10 + arm, s=4.0, t=0.0, hdg=0.0)
        nodes.append(road(
            arm, plan_view(edge * math.cos(heading), edge * math.sin(heading), heading, [LINE(70)]),
            [section(0, sides(1)[::-1], [mark("solid", color="yellow")], sides(-1))], name=f"arm {arm}",
            links=link(predecessor=("junction", 100, None)), objects=[crossing], signals=[stop_sign_line(20 + arm, 7, "-")]))
    for start in range(4):
        heading = start * math.pi / 2
        x, y = edge * math.cos(heading), edge * math.sin(heading)
        for goal, shape in ((start + 1, corner(edge, -1)), (start + 2, [LINE(2 * edge)]), (start + 3, corner(edge, 1))):
            number_, goal = 200 + 10 * start + goal % 4, goal % 4
            right = [lane(-1, "driving", 3.5)]
            if goal == (start + 1) % 4:
                right.append(lane(-2, "sidewalk", 2.0))
            nodes.append(road(
                number_, plan_view(x, y, heading + math.pi, shape), [section(0, [], [], right)], junction=100,
                links=link(predecessor=("road", start, "start"), successor=("road", goal, "start"))))
            links.append(tag("connection", tag("laneLink", **{"from": 1, "to": -1}), id=len(links), incomingRoad=start, connectingRoad=number_, contactPoint="start"))
    write("four_arm_junction", 6, *nodes, tag("junction", *links, id=100, name="crossroads"))


def every_geometry():
    records = [
        LINE(30), SPIRAL(25, 0, 0.03), ARC(20, 0.03), SPIRAL(30, 0.03, -0.02),
        ("poly3", 20.0, dict(a=0.0, b=0.0, c=-0.01, d=0.0003)),
        param_poly3([0, 30, 0, -2], [0, 0, -10, 4]),
        param_poly3([0, 1, 0, -0.01 ** 2 / 6], [0, 0, 0.005, 0], length=25.0),
    ]
    body = section(0, [lane(1, "driving", 3.25, mark("solid"))], [mark("broken")], [lane(-1, "driving", 3.25, mark("solid"))])
    height = tag("elevationProfile", tag("elevation", s=0.0, a=0.0, b=0.02, c=0.0, d=0.0))
    node = road(1, plan_view(-40.0, 12.0, 0.3, records), [body]).replace("  <lanes>", "\n".join("  " + line for line in height.split("\n")) + "\n  <lanes>", 1)
    write("every_geometry", 4, node)


def parking_street():
    """One way, shifted by a lane offset, a second lane opens; parking lane, bays, bicycle lane, borders."""
    shift = [(0, (0, 0, 0, 0)), (50, (0, 0, 3 * 1.5 / 20 ** 2, -2 * 1.5 / 20 ** 3)), (70, (1.5, 0, 0, 0))]
    first = section(
        0, [lane(1, "sidewalk", 1.8)], [mark("solid")],
        [lane(-1, "driving", 3.2, mark("broken")), lane(-2, "biking", 1.5, mark("broken")), lane(-3, "parking", 2.2, mark("solid")),
         lane(-4, "curb", 0.3), lane(-5, "sidewalk", 2.0)])
    opening = [(0, (0, 0, 3 * 3.0 / 25 ** 2, -2 * 3.0 / 25 ** 3)), (25, (3.0, 0, 0, 0))]
    second = section(
        80, [], [mark("solid")],
        [lane(-1, "driving", 3.2, mark("none"), mark("broken", 10.0)), lane(-2, "driving", opening, mark("solid")),
         lane(-3, "curb", 0.3), lane(-4, "sidewalk", 2.0)], singleSide="true")
    third = section(
        130, [lane(1, "sidewalk", 1.8)], [mark("solid")],
        [lane(-1, "driving", [(0, (-3.2, 0, 0, 0))], mark("broken"), border=True), lane(-2, "driving", [(0, (-6.2, 0, 0, 0))], mark("solid"), border=True),
         lane(-3, "sidewalk", [(0, (-8.5, 0, 0, 0))], border=True)])
    repeat = tag("repeat", s=12.5, length=25.0, distance=5.0, tStart=-5.8, tEnd=-5.8, heightStart=0.0, heightEnd=0.0, zOffsetStart=0.0, zOffsetEnd=0.0)
    bays = tag("object", repeat, type="parkingSpace", id=1, s=12.5, t=-5.8, hdg=0.0, length=5.0, width=2.2)
    yard = tag("object", local_outline([(-6, -4), (6, -4), (6, 4), (-6, 4)]), type="parkingSpace", id=2, s=110.0, t=10.0, hdg=0.0)
    write("parking_street", 7, road(1, plan_view(0.0, 0.0, 0.5, [LINE(160)]), [first, second, third], offsets=shift, objects=[bays, yard]))


def left_hand_bend():
    plan = plan_view(0.0, 0.0, math.pi / 2, [LINE(40), SPIRAL(20, 0, -0.04), ARC(25, -0.04), SPIRAL(20, -0.04, 0), LINE(40)])
    crossing = tag("object", type="crosswalk", id=1, s=20.0, t=0.0, hdg=math.pi / 2, length=6.0, width=4.0)
    zebra = tag("object", tag("outlines", tag("outline", tag("cornerRoad", s=125.0, t=-3.0, dz=0.0, height=0.0, id=0), tag("cornerRoad", s=125.0, t=3.0, dz=0.0, height=0.0, id=1), id=0)),
                tag("markings", tag("marking", width=3.0, color="white", lineLength=0.5, spaceLength=0.5, startOffset=0.0, stopOffset=0.0)),
                type="crosswalk", id=2, s=125.0, t=0.0)
    sides = lambda sign: [lane(sign, "driving", 3.0, mark("solid")), lane(2 * sign, "shoulder", 1.0), lane(3 * sign, "border", 1.5)]
    body = section(0, sides(1)[::-1], [mark("broken")], sides(-1))
    write("left_hand_bend", 5, road(1, plan, [body], objects=[crossing, zebra], rule="LHT"))


def motorway_exit():
    carriage = lambda sign, first: [
        lane(first * sign, "shoulder", 0.8, mark("solid")), lane((first + 1) * sign, "driving", 3.75, mark("broken")), lane((first + 2) * sign, "driving", 3.75, mark("solid"))]
    median = lambda sign: [lane(sign, "median", 2.0, mark("solid"))]
    left = (median(1) + carriage(1, 2) + [lane(5, "stop", 2.5)])[::-1]
    plain = median(-1) + carriage(-1, 2)
    opening = [(0, (0, 0, 3 * 3.5 / 40 ** 2, -2 * 3.5 / 40 ** 3)), (40, (3.5, 0, 0, 0))]
    sections = [
        section(0, left, [mark("none")], plain + [lane(-5, "stop", 2.5)]),
        section(60, left, [mark("none")], plain[:-1] + [lane(-4, "driving", 3.75, mark("broken")), lane(-5, "exit", opening, mark("solid")), lane(-6, "stop", 2.5)]),
    ]
    main = road(1, plan_view(-150.0, 5.0, 0.1, [LINE(60), ARC(110, -0.001)]), sections, links=link(successor=("junction", 9, None)))
    # The ramp begins at the end of the exit lane: its reference line is that lane's inner edge.
    view, length = plan_view(-150.0, 5.0, 0.1, [LINE(60), ARC(110, -0.001)])
    u, v, turn = end_of("arc", 110, dict(curvature=-0.001))
    x, y = -150 + 60 * math.cos(0.1), 5 + 60 * math.sin(0.1)
    x, y, heading = x + u * math.cos(0.1) - v * math.sin(0.1), y + u * math.sin(0.1) + v * math.cos(0.1), 0.1 + turn
    t = -(2.0 + 0.8 + 3.75 + 3.75)
    ramp = road(2, plan_view(x - t * math.sin(heading), y + t * math.cos(heading), heading, [SPIRAL(50, -0.001, -0.02), ARC(30, -0.02)]),
                [section(0, [], [mark("solid")], [lane(-1, "offRamp", 3.5, mark("solid")), lane(-2, "stop", [(0, (2.5, 0, 0, 0))])])], links=link(predecessor=("junction", 9, None)))
    on = road(3, plan_view(x, y, heading, [ARC(110, -0.001)]),
              [section(0, left, [mark("none")], plain + [lane(-5, "stop", [(0, (0, 0.05, 0, 0)), (50, (2.5, 0, 0, 0))])])], links=link(predecessor=("junction", 9, None)))
    links = [tag("connection", tag("laneLink", **{"from": -5, "to": -1}), id=0, incomingRoad=1, linkedRoad=2, contactPoint="start"),
             tag("connection", *(tag("laneLink", **{"from": i, "to": i}) for i in (-3, -4)), id=1, incomingRoad=1, linkedRoad=3, contactPoint="start")]
    write("motorway_exit", 7, main, ramp, on, tag("junction", *links, id=9, name="exit", type="direct"))


for make in (straight_two_way, four_arm_junction, every_geometry, parking_street, left_hand_bend, motorway_exit):
    make()
