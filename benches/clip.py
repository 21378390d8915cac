"""python3 benches/clip.py PROGRAM ROAD.xodr: a clip of 8 s on 300 m of an imported road, 20 objects and the ego vehicle moving.

Prints how long it takes to make it, to open it, to change one track, and to edit it at eight moments one after another, with the
networks; how many voxels those edits changed outside their regions; and the memory of the largest process."""
import json
import math
import resource
import subprocess
import sys
import tempfile
import time
import zipfile
from pathlib import Path


def run(program, *arguments):
    """Wall time in seconds and the JSON report."""
    start = time.monotonic()
    done = subprocess.run([program, *map(str, arguments), "--json"], capture_output=True, text=True, check=False)
    took = time.monotonic() - start
    if done.returncode != 0:
        sys.exit(done.stderr.strip() or f"exit {done.returncode}")
    return took, json.loads(done.stdout)


def path(points_m, mps):
    return {"path": {"points_m": points_m, "speeds": [{"time_s": 0, "mps": mps}]}}


def moving(boxes, most):
    """Edits that let boxes with a velocity go straight on."""
    def speed(box):
        return math.hypot(*box["velocity_mps"])

    for box in [b for b in boxes if speed(b) > 1][:most]:
        (x, y), (vx, vy), mps = box["center_m"][:2], box["velocity_mps"], speed(box)
        yield {"set_motion": {"id": box["id"], "motion": path([[x, y], [x + 60 * vx / mps, y + 60 * vy / mps]], mps)}}


def main(program, road):
    with tempfile.TemporaryDirectory() as folder:
        folder = Path(folder)
        scene, clip, edits = folder / "road.loom", folder / "clip.loom", folder / "edits.json"
        took, report = run(program, "import", road, "--size", "300x100", "-o", scene)
        print(f"import                  {took:6.2f} s  {report['boxes']} boxes, {report['things']} things")
        boxes = json.loads(zipfile.ZipFile(scene).read("scene.json"))["canvas"]["boxes"]
        tracks = list(moving(boxes, 20))
        begin = [{"set_length": {"length_s": 8, "rate_hz": 10}}, {"set_motion": {"motion": path([[0, 0], [100, 0]], 12)}}]
        edits.write_text(json.dumps(begin + tracks))
        took, _ = run(program, "edit", scene, "--edits", edits, "-o", clip)
        print(f"let {len(tracks)} objects move      {took:6.2f} s")
        took, report = run(program, "diff", clip, clip)
        print(f"open twice and compare  {took:6.2f} s  {report['frames'][0]} frames")
        edits.write_text(json.dumps([{"set_motion": {**tracks[3]["set_motion"], "motion": path([[40, 2], [70, 2]], 7)}}]))
        took, report = run(program, "edit", clip, "--edits", edits, "-o", folder / "other.loom")
        print(f"one track, other path   {took:6.2f} s  {report['voxels_changed']} voxels that stand changed")
        still = [b["id"] for b in boxes if b["id"] not in [t["set_motion"]["id"] for t in tracks]][:8]
        outside, walls = 0, []
        for second, number in enumerate(still):
            edits.write_text(json.dumps([{"at": {"time_s": second, "edit": {"remove_box": {"id": number}}}}]))
            after = folder / f"{second}.loom"
            took, report = run(program, "edit", clip, "--edits", edits, "-o", after)
            _, difference = run(program, "diff", clip, after)
            walls.append(took)
            outside += report["untouched_voxels_changed"] + difference["changed_outside_region"]
            clip = after
        print(f"8 edits at 8 moments    {sum(walls):6.2f} s  {outside} voxels changed outside their regions")
        print(f"memory at most          {resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss / 1024:6.0f} MB")


if __name__ == "__main__":
    main(*sys.argv[1:3])
