#!/bin/bash
# How fast the window is, by its own measure (`sceneloom --trace`): tests/latency.sh [SCENE]. Nudges a car while generation
# runs, paints a stroke of 100 steps, dabs while the worker is busy, then rests. Without SCENE it does so on the bundled
# scene, on one with 500 boxes and on one in which the user painted all 640,000 voxels. Prints ms.
source "$(dirname "$0")/window.sh"

# measure NAME SCENE
measure() {
    local trace=$work/trace.jsonl
    rm -f "$trace"
    open_window dark 1600x950 --trace "$trace" "$2"
    xdotool mousemove 600 720
    sleep "${READY_S:-15}" # the networks get ready
    xdotool mousemove 1430 227 click 1
    sleep 1
    xdotool mousemove 600 720
    for _ in $(seq 30); do
        xdotool key Up
        sleep 0.4
    done
    xdotool key b
    sleep 0.5
    xdotool mousemove 300 600 mousedown 1
    for i in $(seq 100); do
        xdotool mousemove $((300 + i * 2)) $((600 + (i % 20) * 3))
        sleep 0.03
    done
    xdotool mouseup 1
    sleep 2
    for i in $(seq 12); do
        xdotool mousemove $((320 + i * 15)) 400 click 1
        sleep 0.4
    done
    xdotool mousemove 600 720
    sleep "${REST_S:-15}"
    kill "$app" # without asking; the summary is not needed
    wait "$app" 2>/dev/null || true
    app=
    rm -rf "$SCENELOOM_STATE_DIR" "$SCENELOOM_CONFIG_DIR"
    python3 - "$1" "$trace" <<'P'
import json, sys
edits, frames, working, idle = [], [], [], []
for line in open(sys.argv[2]):
    try:
        d = json.loads(line)
    except ValueError:
        continue  # cut off
    if d["kind"] == "edit":
        edits.append(d["visible_ms"])
    elif d["kind"] == "frame":
        (working if d["working"] else frames).append(d["busy_ms"])
    elif d["kind"] == "cpu" and d["idle"]:
        idle.append(d["share"])
def q(v):
    v = sorted(v)
    at = lambda p: v[min(len(v) - 1, int(p * len(v)))] if v else float("nan")
    return f"median {at(.5):.0f}, 95 % {at(.95):.0f}, most {max(v, default=float('nan')):.0f}, n {len(v)}"
print(f"{sys.argv[1]}: edit to visible {q(edits)}")
print(f"  window's own work per frame: {q(frames)}; while the worker runs: {q(working)}")
if idle:
    print(f"  processor at rest: {100 * sum(idle) / len(idle):.1f} % of a core over {len(idle)} s")
P
}

bundled=$(realpath assets/scenes/first_light.loom)
if [ $# -gt 0 ]; then
    measure "$1" "$(realpath "$1")"
    exit
fi
python3 - "$work" <<'P'
import json, sys
boxes = [{"add_box": {"class": "pedestrian", "center_m": [-38 + 3.0 * (i % 25), -38 + 3.6 * (i // 25), 0.9], "size_m": [0.7, 0.7, 1.8], "yaw_deg": 0}} for i in range(500)]
json.dump(boxes, open(f"{sys.argv[1]}/boxes.json", "w"))
cells = [[x, y, z] for x in range(200) for y in range(200) for z in range(16)]
classes = {"manmade": [c for c in cells if c[2] == 0 or (c[0] // 8 + c[1] // 8) % 3 == 0 and c[2] < 6]}
classes["free"] = [c for c in cells if not (c[2] == 0 or (c[0] // 8 + c[1] // 8) % 3 == 0 and c[2] < 6)]
json.dump([{"paint_voxels": {"cells": v, "class": k}} for k, v in classes.items()], open(f"{sys.argv[1]}/voxels.json", "w"))
P
for what in boxes voxels; do
    "$binary" edit "$bundled" --edits "$work/$what.json" --steps 2 -o "$work/$what.loom" >/dev/null
done
measure "bundled scene" "$bundled"
measure "500 boxes more" "$work/boxes.loom"
measure "640,000 voxels painted" "$work/voxels.loom"
