#!/usr/bin/env python3
"""Does a scenario designer's jobs in the real window, by mouse and keys, and writes how many steps and seconds each takes.

    python3 tests/window/jobs.py target/release/sceneloom OUT [JOB ...]

Needs Xvfb, xdotool and ImageMagick. A step is a click, a drag, a key or a line of text. A job's seconds are those from its
first step until the picture has stayed the same for two seconds, those two not counted. OUT gets a picture before and after
each job, and jobs.json. The window has 1600 x 950 points, so that places are the same on every machine.
"""
import json, os, subprocess, sys, tempfile, time

from window import PROMPT, SIZE, Window, map_point


def paint_a_lane(w):
    w.key("b")
    w.drag(map_point(-20, 20), map_point(20, 20))


def reshape_a_road(w):
    w.key("h")
    w.click(map_point(-20, 0.6))
    w.drag(map_point(-24, ROAD_LEFT_M), map_point(-24, ROAD_LEFT_M + 6))


def make_a_roundabout(w):
    w.click(PROMPT)
    w.type("a roundabout here")
    w.key("Return")


def place_and_turn_a_car(w):
    w.key("a")
    w.click(map_point(14, -12))
    w.key("c")


def night_by_words(w):
    w.click(PROMPT)
    w.type("at night in the rain")
    w.key("Return")


def compare(w):
    w.click(map_point(20, 0))
    w.key("Delete")
    w.wait()
    w.key("shift+backslash")


def triage(w):
    w.click((1545, 936))


def export_with_calibration(w):
    w.key("ctrl+e")


def picture_beside_classes(w):
    w.palette("Camera: Front")


# Where the line of the road lies in the scene of the jobs, m left of the ego vehicle.
ROAD_LEFT_M = 1.8
JOBS = {
    "paint a lane": paint_a_lane,
    "reshape a road": reshape_a_road,
    "a roundabout by words": make_a_roundabout,
    "place and turn a car": place_and_turn_a_car,
    "a night scene by words": night_by_words,
    "compare with before": compare,
    "look at the findings": triage,
    "open the export": export_with_calibration,
    "a camera's picture beside the classes": picture_beside_classes,
}


def main():
    program, out = os.path.abspath(sys.argv[1]), sys.argv[2]
    chosen = sys.argv[3:] or list(JOBS)
    os.makedirs(out, exist_ok=True)
    display = ":87"
    screen = "%dx%dx24" % SIZE
    server = subprocess.Popen(["Xvfb", display, "-screen", "0", screen], stderr=subprocess.DEVNULL)
    time.sleep(1)
    scene = os.path.join(tempfile.mkdtemp(), "street.loom")
    subprocess.run([program, "new", "--template", "t-junction", "--seed", "1", "-o", scene], check=True, capture_output=True)
    rows = []
    try:
        for name in chosen:
            window = Window(program, scene, display)
            file = name.replace(" ", "_").replace("'", "")
            window.picture(os.path.join(out, file + "_before.png"))
            start, window.steps = time.time(), 0
            JOBS[name](window)
            seconds = window.wait() - start
            window.picture(os.path.join(out, file + "_after.png"))
            alive = window.process.poll() is None
            rows.append({"job": name, "steps": window.steps, "seconds": round(seconds, 1), "alive": alive})
            print("%-40s %2d steps %6.1f s%s" % (name, window.steps, seconds, "" if alive else "  THE PROGRAM ENDED"), flush=True)
            window.close()
    finally:
        server.terminate()
    with open(os.path.join(out, "jobs.json"), "w") as file:
        json.dump(rows, file, indent=1)
    if not all(r["alive"] for r in rows):
        sys.exit(1)


main()
