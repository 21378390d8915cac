# packages: rerun-sdk==0.41.0
"""An MCAP file as the viewer Rerun takes it: checked, converted to its own `.rrd`, and counted."""
import json
import re
import subprocess
import sys
import tempfile
from pathlib import Path


def rerun(*arguments):
    program = Path(sys.executable).parent / "rerun"
    done = subprocess.run([program, *map(str, arguments)], capture_output=True, text=True)
    if done.returncode:
        print(f"mcap: rerun {arguments[0]}: {done.stderr.strip().splitlines()[-1]}", file=sys.stderr)
        sys.exit(1)
    return done.stdout


def main(path):
    checked = rerun("mcap", "check", path)
    states = re.findall(r"^(\w+)\s+\d+\s+\d+\s+/", checked, re.MULTILINE)
    with tempfile.TemporaryDirectory() as folder:
        out = Path(folder) / "scene.rrd"
        rerun("mcap", "convert", path, "-o", out)
        entities = int(re.search(r"num_entity_paths = (\d+)", rerun("rrd", "stats", out)).group(1))
    version = rerun("--version").split()[1]
    accepted = bool(states) and set(states) == {"ok"} and entities >= len(states)
    read = {"channels": len(states), "entities": entities}
    print(json.dumps({"reader": "rerun (mcap to rrd)", "version": version, "accepted": accepted, "read": read}))


main(sys.argv[1])
