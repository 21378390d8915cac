"""The real window, used by mouse and keys as a person would. Needs Xvfb, xdotool and ImageMagick."""
import hashlib, os, subprocess, tempfile, time

SIZE = (1600, 950)
STABLE_S = 2.0
# Places of the window, points.
BEV = (508, 418)  # the ego vehicle from above, in a fresh window
SCALE = 6.53      # points per metre there
PROMPT = (1460, 520)
# Of the dialog of exports.
EXPORT_ALL, EXPORT_FILES, CLOSE_EXPORT = (402, 505), (853, 613), (886, 144)
# The line of the road of template t-junction, seed 1, m left of the ego vehicle.
ROAD_LEFT_M = 1.8


def map_point(ahead_m, left_m):
    """Where a place of the ego frame appears from above."""
    return round(BEV[0] - left_m * SCALE), round(BEV[1] - ahead_m * SCALE)


class Window:
    """One running editor."""

    def __init__(self, program, scene, display, *options):
        self.env = dict(os.environ, DISPLAY=display, HOME=tempfile.mkdtemp(), XDG_RUNTIME_DIR=tempfile.mkdtemp())
        self.folder = tempfile.mkdtemp()
        self.steps = 0
        arguments = [program] + ([scene] if scene else []) + list(options)
        quiet = dict(stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        self.started = time.time()
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

    def script(self, lines):
        """Many small inputs in one go, without a pause but those that they say."""
        self.steps += 1
        subprocess.run(["xdotool", "-"], env=self.env, input="\n".join(lines) + "\n", text=True, capture_output=True, timeout=120)

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

    def file(self, name):
        """A file beside the scene."""
        return os.path.join(self.scenes, name)

    def close(self):
        self.process.terminate()
        try:
            self.process.wait(10)
        except subprocess.TimeoutExpired:
            self.process.kill()
