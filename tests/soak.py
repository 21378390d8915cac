"""A session that is asked thousands of calls must not grow: python3 tests/soak.py [--calls 20000] [--program target/release/sceneloom]

Each round changes the scene in several ways, looks at it, and takes some of it back, as an assistant does; no version is kept. Prints the
memory of the session after every thousand calls. Exit 1 if it grew by more than 5 % after the warm-up, in which the history fills up.
"""
from __future__ import annotations

import argparse
import os
import pathlib
import sys
import tempfile
import time

ROOT = pathlib.Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT / "python"))
from sceneloom import Session, edits  # noqa: E402


def resident_mib(process: int) -> float:
    status = pathlib.Path(f"/proc/{process}/status").read_text()
    return int(status.split("VmRSS:")[1].split()[0]) / 1024


def rounds(session: Session):
    """One call after another, for ever."""
    number = 0
    while True:
        number += 1
        x = 8 + number % 20
        box = edits.add_box(class_="pedestrian", center_m=[x, 3, 0.9], size_m=[0.7, 0.7, 1.8], yaw_deg=number % 360)
        (added,) = session.apply(edits=[box])["changed"]["boxes_added"]
        yield
        session.apply(edits=[edits.move_box(id=added, center_m=[x + 1, 3, 0.9])])
        yield
        strip = {"rect": {"min_m": [-30 + number % 40, -12], "max_m": [-28 + number % 40, -10]}}
        session.apply(edits=[edits.paint_bev(layer="walkway", shape=strip, value=number % 2 == 0)])
        yield
        session.prompt(text=f"add a bus {20 + number % 9} m ahead")
        yield
        session.undo()
        yield
        session.state(roads=False)
        yield
        session.check(sensors=False)
        yield
        session.apply(edits=[edits.remove_box(id=added)])
        yield
        if number % 10 == 0:
            session.render(what=["bev"], replace=True)
            yield
        if number % 500 == 0:
            session.new(template=("t-junction", "straight")[number // 500 % 2], seed=number)
            yield


def main() -> None:
    p = argparse.ArgumentParser(description=__doc__)
    p.add_argument("--calls", type=int, default=20_000, help="calls that are measured")
    p.add_argument("--warm", type=int, default=10_000, help="calls before them, in which the history fills up")
    p.add_argument("--program", default=os.environ.get("SCENELOOM", str(ROOT / "target/release/sceneloom")))
    args = p.parse_args()
    with tempfile.TemporaryDirectory() as folder, Session(folder=folder, program=args.program) as session:
        session.new(template="t-junction", seed=3)
        process, begun, warm, most = session._process.pid, time.monotonic(), 0.0, 0.0
        for calls, _ in enumerate(rounds(session), 1):
            if calls % 1000 == 0 or calls in (args.warm, args.warm + args.calls):
                now = resident_mib(process)
                print(f"{calls:6} calls {now:7.1f} MiB {time.monotonic() - begun:7.0f} s", flush=True)
                most = max(most, now) if calls > args.warm else now
            if calls == args.warm:
                warm = most
            if calls == args.warm + args.calls:
                break
    grown = most / warm - 1
    print(f"grown by {100 * grown:.1f} % after the first {args.warm} calls (allowed 5 %)")
    sys.exit(grown > 0.05)


if __name__ == "__main__":
    main()
