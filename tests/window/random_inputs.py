#!/usr/bin/env python3
"""Random mouse, keys, text and sizes into the real window: it must neither end nor hang, and what it saves must be sound.

    python3 tests/window/random_inputs.py target/release/sceneloom [COUNT [SEED]]

Needs Xvfb, xdotool and ImageMagick. Every 500 inputs the palette is opened and closed: the picture has to change within ten
seconds. In the end the scene is saved and checked by `sceneloom check`. Ctrl+Q is left out; if *Quit* was hit in a menu the
program is started again and that is counted.
"""
import os, random, subprocess, sys, tempfile, time

KEYS = """a b c d e f g h i k l m n o p q r s t u v w x y z 0 1 3 5 7 bracketleft bracketright comma period slash space Tab Return Escape Escape Delete
BackSpace Left Right Up Down Prior Next Home F1 F2 F10 ctrl+z ctrl+z ctrl+y ctrl+d ctrl+a ctrl+i ctrl+c ctrl+v ctrl+x ctrl+k ctrl+m ctrl+comma ctrl+e ctrl+n
ctrl+g ctrl+h ctrl+l ctrl+shift+g ctrl+shift+h ctrl+shift+l ctrl+shift+p ctrl+shift+a ctrl+Return ctrl+Tab shift+Tab shift+b shift+t shift+l shift+s shift+p shift+u shift+o shift+backslash alt+1 alt+2 alt+3 alt+4 alt+5 alt+6""".split()
WORDS = ["a bus ahead", "at night", "remove the cars", "four lanes", "rain", "12", "-3.5", "1e9", "nan", "", "ß 日本", "no sidewalk", "a roundabout here"]


class Program:
    def __init__(self, program, scene, display):
        self.command, self.env = [program, scene], dict(os.environ, DISPLAY=display, HOME=tempfile.mkdtemp(), XDG_RUNTIME_DIR=tempfile.mkdtemp())
        self.folder, self.starts = os.path.dirname(scene), 0
        self.start()

    def start(self):
        self.starts += 1
        self.log = open(os.path.join(self.folder, "log.txt"), "ab")
        self.process = subprocess.Popen(self.command, env=self.env, cwd=self.folder, stdout=self.log, stderr=self.log)
        for _ in range(120):
            time.sleep(0.5)
            self.window = self.tool("search", "--name", "Sceneloom").split("\n")[0]
            if self.window:
                break
        time.sleep(12)
        self.tool("windowfocus", self.window)

    def tool(self, *arguments):
        return subprocess.run(["xdotool", *arguments], env=self.env, capture_output=True, text=True).stdout.strip()

    def send(self, lines):
        subprocess.run(["xdotool", "-"], env=self.env, input="\n".join(lines) + "\n", text=True, capture_output=True, timeout=120)

    def picture(self):
        return subprocess.run(["import", "-window", "root", "ppm:-"], env=self.env, capture_output=True).stdout

    def answers(self):
        """The palette opens, within ten seconds."""
        self.send(["key Escape"] * 4)
        time.sleep(0.5)
        before, start = self.picture(), time.time()
        self.send(["key ctrl+k"])
        while time.time() - start < 10:
            time.sleep(0.1)
            if self.picture() != before:
                self.send(["key Escape"])
                return time.time() - start
        return None


def inputs(draw, count):
    """Lines for xdotool that make so many inputs."""
    out = []
    for _ in range(count):
        x, y = draw.randrange(0, 1600), draw.randrange(0, 950)
        kind = draw.random()
        if kind < 0.35:
            out += ["mousemove %d %d" % (x, y), "click %d" % draw.choice([1, 1, 1, 1, 3, 2])]
        elif kind < 0.5:
            out += ["mousemove %d %d" % (x, y), "mousedown %d" % (button := draw.choice([1, 1, 1, 2, 3]))]
            out += ["mousemove_relative -- %d %d" % (draw.randrange(-150, 150), draw.randrange(-150, 150)) for _ in range(3)]
            out += ["mouseup %d" % button]
        elif kind < 0.58:
            out += ["mousemove %d %d" % (x, y), "click --repeat %d %d" % (draw.randrange(1, 4), draw.choice([4, 5]))]
        elif kind < 0.96:
            out.append("key " + draw.choice(KEYS))
        elif kind < 0.99:
            out.append("type --delay 5 %r" % draw.choice(WORDS))
        else:
            out.append("windowsize WINDOW %d %d" % (draw.randrange(640, 1601), draw.randrange(420, 951)))
        out.append("sleep 0.01")
    return out


def main():
    program = os.path.abspath(sys.argv[1])
    count = int(sys.argv[2]) if len(sys.argv) > 2 else 10_000
    seed = int(sys.argv[3]) if len(sys.argv) > 3 else 1
    draw, display = random.Random(seed), ":88"
    server = subprocess.Popen(["Xvfb", display, "-screen", "0", "1600x950x24"], stderr=subprocess.DEVNULL)
    time.sleep(1)
    folder = tempfile.mkdtemp()
    scene = os.path.join(folder, "street.loom")
    subprocess.run([program, "new", "--template", "intersection", "--seed", "2", "-o", scene], check=True, capture_output=True)
    failed, slowest = [], 0.0
    try:
        window = Program(program, scene, display)
        for done in range(0, count, 50):
            lines = [l.replace("WINDOW", window.window) for l in inputs(draw, min(50, count - done))]
            window.send(lines)
            ended = window.process.poll()
            if ended is not None:
                if ended != 0:
                    failed.append("after %d inputs the program ended with %s" % (done + 50, ended))
                window.start()
            if (done + 50) % 500 == 0:
                window.send(["windowsize %s 1600 950" % window.window])
                seconds = window.answers()
                if seconds is None:
                    failed.append("after %d inputs the window does not answer" % (done + 50))
                    window.process.kill()
                    window.process.wait()
                    window.start()
                else:
                    slowest = max(slowest, seconds)
                print("%6d inputs, answers after %s s, %d starts" % (done + 50, "%.1f" % seconds if seconds else "-", window.starts), flush=True)
        window.send(["key Escape"] * 5 + ["key ctrl+s"])
        time.sleep(3)
        check = subprocess.run([program, "check", scene], capture_output=True, text=True)
        # 0: no errors; 1: errors were found. 2: the file is unsound.
        if check.returncode not in (0, 1):
            failed.append("what was saved is unsound: " + check.stderr.strip())
        with open(os.path.join(folder, "log.txt"), "rb") as log:
            failed += [l for l in log.read().decode("utf8", "replace").splitlines() if "panick" in l]
        window.process.kill()
    finally:
        server.terminate()
    print("%d inputs, seed %d: %s; slowest answer %.1f s, %d starts" % (count, seed, "; ".join(failed) or "no fault", slowest, window.starts))
    sys.exit(1 if failed else 0)


main()
