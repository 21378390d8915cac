#!/usr/bin/env python3
"""How fast the window feels: from an edit to the picture that shows it, and the longest frames, in the real window.

    python3 tests/window/felt.py target/release/sceneloom [PHASE ...]

Needs Xvfb, xdotool and ImageMagick. Each phase has a window of its own, of 1600 x 950 points, and moves the mouse 60 times a
second. The figures are the window's own (`--trace`): *visible* is from the frame that took the input to the end of the one
that shows it, *frame* the work of the main thread for a frame.
"""
import json, os, subprocess, sys, tempfile, time

from window import CLOSE_EXPORT, EXPORT_ALL, EXPORT_FILES, PROMPT, ROAD_LEFT_M, SIZE, Window, map_point


def sweep(w, points, seconds=0.6):
    """One drag through places of the window, as a hand does it."""
    lines = ["mousemove %d %d" % points[0], "mousedown 1"]
    per_leg = max(1, round(seconds * 60 / max(1, len(points) - 1)))
    for a, b in zip(points, points[1:]):
        for k in range(1, per_leg + 1):
            lines += ["mousemove %d %d" % tuple(round(p + (q - p) * k / per_leg) for p, q in zip(a, b)), "sleep 0.0167"]
    w.script(lines + ["mouseup 1", "sleep 0.1"])


def paint(w):
    w.move(map_point(0, 30))
    w.key("b")
    for k in range(8):
        sweep(w, [map_point(-25 + 6 * k, 25), map_point(-22 + 6 * k, -25)])


def drag_a_car(w):
    w.key("a")
    w.click(map_point(14, -12))
    w.key("v")
    at = (14, -12)
    for to in [(20, -14), (12, -16), (25, -8), (14, -12)] * 2:
        sweep(w, [map_point(*at), map_point(*to)])
        at = to


def drag_a_building(w):
    w.click(map_point(-16, 24))
    at = (-16, 24)
    for to in [(-12, 26), (-18, 22), (-16, 24)]:
        sweep(w, [map_point(*at), map_point(*to)])
        at = to


def drag_a_road(w):
    w.key("h")
    w.click(map_point(-20, 0.6))
    left = ROAD_LEFT_M
    for to in [8, 2, 10, 3, 9, 1]:
        sweep(w, [map_point(-24, left), map_point(-24, to)])
        left = to


def voxels(w):
    w.move((1000, 420))
    w.key("b")
    for k in range(6):
        sweep(w, [(930 + 25 * k, 330), (900 + 30 * k, 500)])


def undo(w):
    paint(w)
    for _ in range(4):
        for _ in range(6):
            w.key("ctrl+z")
        for _ in range(6):
            w.key("ctrl+shift+z")


def while_generating(w):
    w.key("ctrl+Return")
    time.sleep(0.5)
    paint(w)
    w.key("ctrl+Return")
    drag_a_car(w)


def while_playing(w):
    w.palette("forecast")
    time.sleep(4)
    w.palette("play or pause")
    time.sleep(1)
    for k in range(6):
        sweep(w, [(940, 300), (1100 - 40 * k, 400)])
        time.sleep(0.5)


def while_words_are_read(w):
    for words in ["at night in the rain", "a roundabout here", "remove the cars"]:
        w.click(PROMPT)
        w.type(words)
        w.key("Return")
        time.sleep(2)


def while_exporting(w):
    w.key("ctrl+e")
    time.sleep(1)
    w.click(EXPORT_ALL)
    w.click(EXPORT_FILES)
    w.click(CLOSE_EXPORT)
    paint(w)


PHASES = {
    "paint": paint,
    "drag a car": drag_a_car,
    "drag a building": drag_a_building,
    "drag a road": drag_a_road,
    "voxels": voxels,
    "undo and redo": undo,
    "while generating": while_generating,
    "while playing": while_playing,
    "words": while_words_are_read,
    "while exporting": while_exporting,
}


def quantile(values, part):
    values = sorted(values)
    return values[min(len(values) - 1, max(0, -(-len(values) * part // 1).__int__() - 1))] if values else float("nan")


def main():
    program = os.path.abspath(sys.argv[1])
    display, folder = ":86", tempfile.mkdtemp()
    server = subprocess.Popen(["Xvfb", display, "-screen", "0", "%dx%dx24" % SIZE], stderr=subprocess.DEVNULL)
    time.sleep(1)
    scene = os.path.join(folder, "street.loom")
    subprocess.run([program, "new", "--template", "t-junction", "--seed", "1", "-o", scene], check=True, capture_output=True)
    print("%-18s %6s %22s %7s %22s %6s" % ("", "edits", "visible p50, p95, max", "frames", "frame p50, p95, max", "> 100"))
    try:
        for name in sys.argv[2:] or PHASES:
            trace = os.path.join(folder, "trace.jsonl")
            window = Window(program, scene, display, "--trace", trace)
            since_s = time.time() - window.started
            PHASES[name](window)
            time.sleep(2.5)
            window.picture(os.path.join(folder, name.replace(" ", "_") + ".png"))
            window.close()
            rows = [json.loads(line) for line in open(trace) if line.endswith("}\n")]
            rows = [row for row in rows if row.get("t_s", 0) > since_s]
            visible = [row["visible_ms"] for row in rows if row["kind"] == "edit"]
            frames = [row["busy_ms"] for row in rows if row["kind"] == "frame"]
            told = ["%4.0f %6.0f %6.0f ms" % tuple(quantile(v, q) for q in (0.5, 0.95, 1.0)) for v in (visible, frames)]
            print("%-18s %6d %22s %7d %22s %6d" % (name, len(visible), told[0], len(frames), told[1], sum(f > 100 for f in frames)), flush=True)
    finally:
        server.terminate()
    print("pictures of the ends:", folder)


main()
