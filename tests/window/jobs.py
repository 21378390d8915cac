#!/usr/bin/env python3
"""Does a scenario designer's jobs in the real window, by mouse and keys, and writes how many steps and seconds each takes.

    python3 tests/window/jobs.py target/release/sceneloom OUT [JOB ...]

Needs Xvfb, xdotool and ImageMagick. A step is a click, a drag, a key or a line of text. A job's seconds are those from its
first step until the picture has stayed the same for two seconds, those two not counted. OUT gets a picture before and after
each job, and jobs.json. The window has 1600 x 950 points, so that places are the same on every machine.
"""
import hashlib, json, os, subprocess, sys, tempfile, time

SIZE = (1600, 950)
STABLE_S = 2.0
# Places of the window, points.
BEV = (508, 418)  # the ego vehicle from above, in a fresh window
SCALE = 6.53      # points per metre there
PROMPT = (1460, 520)


def map_point(ahead_m, left_m):
    """Where a place of the ego frame appears from above."""
    return round(BEV[0] - left_m * SCALE), round(BEV[1] - ahead_m * SCALE)


class Window:
    """One running editor."""

    def __init__(self, program, scene, display):
        self.env = dict(os.environ, DISPLAY=display, HOME=tempfile.mkdtemp(), XDG_RUNTIME_DIR=tempfile.mkdtemp())
        self.folder = tempfile.mkdtemp()
        self.steps = 0
        arguments = [program] + ([scene] if scene else [])
        quiet = dict(stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        self.process = subprocess.Popen(arguments, env=self.env, cwd=self.folder, **quiet)
        for _ in range(120):
            time.sleep(0.5)
            found = self.tool("search", "--name", "Sceneloom")
            if found:
                break
        self.wait()
        self.tool("windowfocus", self.tool("search", "--name", "Sceneloom").split()[0])
        time.sleep(0.5)

    def tool(self, *arguments):
        return subprocess.run(["xdotool", *arguments], env=self.env, capture_output=True, text=True).stdout.strip()

    def picture(self, path=None):
        path = path or os.path.join(self.folder, "now.png")
        subprocess.run(["import", "-window", "root", path], env=self.env, check=True)
        # Without the right column: the caret of the prompt blinks there.
        shown = subprocess.run(["convert", path, "-crop", "1330x950+0+0", "rgb:-"], capture_output=True, check=True)
        return hashlib.md5(shown.stdout).hexdigest()

    def wait(self, limit_s=120):
        """Until the picture stays the same; the moment at which it last changed."""
        last, changed = self.picture(), time.time()
        start = changed
        while time.time() - changed < STABLE_S and time.time() - start < limit_s:
            time.sleep(0.25)
            now = self.picture()
            if now != last:
                last, changed = now, time.time()
        return changed

    def move(self, at):
        self.tool("mousemove", str(at[0]), str(at[1]))
        time.sleep(0.1)

    def click(self, at, button=1):
        self.steps += 1
        self.move(at)
        self.tool("click", str(button))
        time.sleep(0.3)

    def double_click(self, at):
        self.steps += 1
        self.move(at)
        self.tool("click", "--repeat", "2", "--delay", "80", "1")
        time.sleep(0.3)

    def drag(self, start, end):
        self.steps += 1
        self.move(start)
        self.tool("mousedown", "1")
        for k in range(1, 9):
            self.move(tuple(round(a + (b - a) * k / 8) for a, b in zip(start, end)))
        self.tool("mouseup", "1")
        time.sleep(0.3)

    def key(self, name):
        self.steps += 1
        self.tool("key", "--clearmodifiers", name)
        time.sleep(0.3)

    def type(self, text):
        self.steps += 1
        self.tool("type", "--delay", "20", text)
        time.sleep(0.3)

    def palette(self, words):
        """A command by its words."""
        self.key("ctrl+k")
        self.type(words)
        self.key("Return")

    def close(self):
        self.process.terminate()
        try:
            self.process.wait(10)
        except subprocess.TimeoutExpired:
            self.process.kill()


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
