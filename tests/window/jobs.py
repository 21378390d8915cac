#!/usr/bin/env python3
"""Does a scenario designer's jobs in the real window, by mouse and keys, and writes how many steps and seconds each takes.

    python3 tests/window/jobs.py target/release/sceneloom OUT [JOB ...]

Needs Xvfb, xdotool and ImageMagick. A step is a click, a drag, a key or a line of text. A job's seconds are those from its
first step until the picture has stayed the same for two seconds, those two not counted. OUT gets a picture before and after
each job, and jobs.json. The window has 1600 x 950 points, so that places are the same on every machine.
"""
import json, os, subprocess, sys, tempfile, time

from window import EXPORT_ALL, EXPORT_FILES, PROMPT, ROAD_LEFT_M, SIZE, Window, map_point


def paint_a_lane(w):
    # Over the 3D view the key takes the brush of voxels.
    w.move(map_point(-20, 20))
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
    w.click(map_point(*CAR_M))
    w.key("Delete")
    w.wait()
    w.key("shift+backslash")


def triage(w):
    w.click((1545, 936))
    w.wait()
    w.click(FIX_ALL)


def export_with_calibration(w):
    w.key("ctrl+e")
    w.click(EXPORT_ALL)
    w.click(EXPORT_FILES)


def restore_from_a_picture(w):
    w.key("ctrl+o")
    w.key("ctrl+a")
    w.type(w.file("street.png"))
    w.key("Return")


def learned_pictures(w):
    w.palette("Cameras: Learned")


def find_a_corner_case(w):
    w.palette("Perception")
    w.wait()
    w.click(FIRST_SEEN)
    w.click(SEARCH)


def picture_beside_classes(w):
    w.palette("Camera 2")


FIX_ALL = (1280, 642)
# A car of the scene, m ahead of the ego vehicle and to its left.
CAR_M = (15.4, 3.3)
# Of the pane of perception.
FIRST_SEEN, SEARCH = (660, 666), (1130, 666)
CARS_IN_THE_AIR = [
    {"add_box": {"class": "car", "center_m": [-36 + k % 10 * 8, -30 + k // 10 * 20, 1.9], "size_m": [4.5, 1.9, 1.6], "yaw_deg": 0}} for k in range(40)
]
JOBS = {
    "paint a lane": paint_a_lane,
    "reshape a road": reshape_a_road,
    "a roundabout by words": make_a_roundabout,
    "place and turn a car": place_and_turn_a_car,
    "a night scene by words": night_by_words,
    "compare with before": compare,
    "repair 40 findings": triage,
    "export with calibration": export_with_calibration,
    "restore from a picture": restore_from_a_picture,
    "pictures by the network": learned_pictures,
    "find a corner case": find_a_corner_case,
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
    folder = tempfile.mkdtemp()
    scene, faulty = os.path.join(folder, "street.loom"), os.path.join(folder, "faulty.loom")

    def run(*arguments):
        subprocess.run([program, *arguments], check=True, capture_output=True)

    run("new", "--template", "t-junction", "--seed", "1", "-o", scene)
    run("shot", scene, "-o", os.path.join(folder, "street.png"))
    with open(os.path.join(folder, "edits.json"), "w") as file:
        json.dump(CARS_IN_THE_AIR, file)
    run("edit", scene, "--edits", os.path.join(folder, "edits.json"), "-o", faulty)
    rows = []
    try:
        for name in chosen:
            window = Window(program, faulty if JOBS[name] is triage else scene, display)
            window.scenes = folder
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
