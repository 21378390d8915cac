"""A session: the program as a child process that speaks JSON lines."""

from __future__ import annotations

import collections
import contextlib
import json
import os
import pathlib
import shutil
import subprocess
import sysconfig
import tempfile
import threading
from typing import Any, Iterator, Literal, Sequence

from .arrays import Array, npz, ply, png, stacked
from .calls import Calls


class CallError(Exception):
    """A call was refused or failed; the scene is as before. One line."""


class SessionEnded(Exception):
    """The program has ended, or was not found."""


def _of_wheel() -> str | None:
    """The program that came with this package, if it came as a wheel: it lies among the scripts of this Python."""
    schemes = ("", sysconfig.get_preferred_scheme("user"))
    places = [sysconfig.get_path("scripts", scheme) if scheme else sysconfig.get_path("scripts") for scheme in schemes]
    return next((found for place in places if (found := shutil.which("sceneloom", path=place))), None)


class Session(Calls):
    """One scene with its undo history. Calls are answered one by one, also if several threads make them.

    scene: file to begin with; the scene that ships with the program if left out.
    folder: the one folder whose files calls may read and write; it is made if it is missing.
    program: path of `sceneloom`; else that of the environment variable SCENELOOM, else the one of the wheel, else the one on the PATH.
    weights: folder of weights instead of the bundled ones.
    """

    def __init__(
        self,
        scene: str | os.PathLike[str] | None = None,
        folder: str | os.PathLike[str] = ".",
        program: str | os.PathLike[str] | None = None,
        weights: str | os.PathLike[str] | None = None,
    ) -> None:
        found = program or os.environ.get("SCENELOOM") or _of_wheel() or shutil.which("sceneloom")
        if not found:
            raise SessionEnded("sceneloom was not found: name it by program= or SCENELOOM, or put it on the PATH")
        self.folder = pathlib.Path(folder).absolute()
        try:
            self.folder.mkdir(parents=True, exist_ok=True)
        except OSError as error:
            raise SessionEnded(f"{folder}: {error.strerror}, expected a folder or the name of a new one") from error
        command = [os.fspath(found), "session", "--folder", os.fspath(self.folder)]
        if weights is not None:
            command += ["--weights", os.fspath(weights)]
        if scene is not None:
            command += ["--", os.fspath(scene)]
        try:
            self._process = subprocess.Popen(
                command,
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                stderr=subprocess.PIPE,
                encoding="utf-8",
            )
        except OSError as error:
            raise SessionEnded(f"{command[0]}: {error}") from error
        self._lock = threading.Lock()
        self._number = 0
        self._said: collections.deque[str] = collections.deque(maxlen=20)
        self._listener = threading.Thread(target=self._listen, daemon=True)
        self._listener.start()

    def _listen(self) -> None:
        """Keeps the last lines of stderr, so that the program never waits for them to be read."""
        assert self._process.stderr is not None
        for line in self._process.stderr:
            self._said.append(line.rstrip("\n"))

    def call(self, name: str, args: dict[str, Any]) -> Any:
        """Any call by its name; the methods of this class are typed. Returns the receipt."""
        with self._lock:
            self._number += 1
            request = {"id": self._number, "call": name, "args": args}
            # (NaN is no JSON)
            line = json.dumps(request, allow_nan=False)
            assert self._process.stdin is not None and self._process.stdout is not None
            try:
                self._process.stdin.write(line + "\n")
                self._process.stdin.flush()
                answer = self._process.stdout.readline()
            except (OSError, ValueError) as error:
                raise SessionEnded(self._why()) from error
            if not answer:
                raise SessionEnded(self._why())
        reply = json.loads(answer)
        if reply["ok"]:
            return reply["receipt"]
        raise CallError(reply["error"])

    def _why(self) -> str:
        self._listener.join(timeout=1)
        return self._said[-1] if self._said else "the session has ended"

    @contextlib.contextmanager
    def _written(self) -> Iterator[tuple[str, pathlib.Path]]:
        """A folder for files that are read at once: its name within the session's folder, and its path. It goes afterwards."""
        with tempfile.TemporaryDirectory(prefix="arrays_", dir=self.folder) as path:
            yield pathlib.Path(path).name, pathlib.Path(path)

    def voxels(self) -> Array:
        """Classes of all voxels at the moment that is shown, u8 [x, y, z], 0.4 m each way, in the ego frame; 17 is free."""
        with self._written() as (name, path):
            self.export(format="occ3d", name=f"{name}/voxels.npz", replace=True)
            return npz(path / "voxels.npz")["semantics"]

    def boxes(self) -> dict[str, Array]:
        """All boxes at the moment that is shown, the nearest first, at most 1000: `id` and `class` as lists; `center_m` and `size_m`
        (f64 [boxes, 3]), `velocity_mps` (f64 [boxes, 2]) and `yaw_deg` (f64 [boxes]) in the world frame."""
        found = self.state(most_boxes=1000, roads=False)["boxes"]
        return {
            "id": [box["id"] for box in found],
            "class": [box["class"] for box in found],
            "center_m": stacked([box["center_m"] for box in found], 3),
            "size_m": stacked([box["size_m"] for box in found], 3),
            "velocity_mps": stacked([box["velocity_mps"] for box in found], 2),
            "yaw_deg": stacked([[box["yaw_deg"]] for box in found]),
        }

    def picture(self, camera: str, size: Sequence[int] = (480, 270), what: Literal["appearance", "learned"] = "appearance") -> Array:
        """What a camera sees as a photograph, u8 [height, width, 3]. `size`: width, height."""
        with self._written() as (name, path):
            self.render(what=[what], cameras=[camera], size=size, folder=name, replace=True)
            return png((path / f"{camera}_{what}.png").read_bytes())

    def truth(self, camera: str, size: Sequence[int] = (480, 270)) -> dict[str, Array]:
        """The picture of a camera as `picture`, and what is so at each of its pixels: class, instance, depth, normal and others, [height, width, …]."""
        with self._written() as (name, path):
            self.render(what=["truth"], cameras=[camera], size=size, folder=name, replace=True)
            return {"picture": png((path / f"{camera}.png").read_bytes()), **npz(path / f"{camera}_truth.npz")}

    def maps(self, camera: str, size: Sequence[int] = (480, 270)) -> dict[str, Array]:
        """Class and depth of the voxels at each pixel of a camera, [height, width]: `semantic` (u8), `depth_m` and others (f32). `size`: width, height."""
        with self._written() as (name, path):
            self.render(what=["semantic", "depth"], cameras=[camera], size=size, folder=name, replace=True)
            return npz(path / f"{camera}_maps.npz")

    def points(self, learned: bool = False) -> dict[str, Array]:
        """The LiDAR sweep at the moment that is shown, one array per property: x, y, z in m in the ego frame, intensity, ring, class, …"""
        with self._written() as (name, path):
            self.render(what=["lidar"], learned_lidar=learned, folder=name, replace=True)
            return ply(path / "lidar.ply")

    def radar(self) -> dict[str, Array]:
        """The returns of all radars at the moment that is shown, one array per property: radar (its number in the rig), position_m in the ego frame, range_m, azimuth_rad, elevation_rad (NaN where no heights are measured), speed_mps (grows with distance), speed_over_ground_mps, rcs_dbsm, snr_db, class."""
        with self._written() as (name, path):
            self.render(what=["radar"], folder=name, replace=True)
            return npz(path / "radar.npz")

    def close(self) -> int:
        """Ends the session; the exit code of the program. Nothing is saved."""
        if self._process.stdin is not None and not self._process.stdin.closed:
            try:
                self._process.stdin.close()
            except OSError:
                pass
        code = self._process.wait()
        self._listener.join(timeout=1)
        for pipe in (self._process.stdout, self._process.stderr):
            if pipe is not None:
                pipe.close()
        return code

    def __enter__(self) -> Session:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()
