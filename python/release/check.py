"""Tries release artefacts where no build tree is: python3 python/release/check.py [FOLDER]   (root, or a system that allows user namespaces)

Hides the project behind an empty folder, installs each artefact of FOLDER (default: dist) into a folder of its own, and runs it with an empty
environment: the wheel in a fresh virtual environment, where the example of python/README.md runs twice; the .deb and the .tar.gz unpacked.
Exit 1 at the first that fails.
"""
from __future__ import annotations

import configparser
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile
import xml.etree.ElementTree

ROOT = pathlib.Path(__file__).resolve().parents[2]
EMPTY = {"PATH": "/usr/bin:/bin", "HOME": "/nonexistent", "LANG": "C.UTF-8"}


def run(*command: str | os.PathLike[str], folder: pathlib.Path) -> str:
    done = subprocess.run([os.fspath(c) for c in command], cwd=folder, env=EMPTY, capture_output=True, text=True)
    if done.returncode:
        sys.exit(f"{' '.join(map(str, command))[:200]}: exit {done.returncode}\n{done.stdout}{done.stderr}")
    return done.stdout


def works(program: pathlib.Path, folder: pathlib.Path) -> None:
    """Versions, licences, a scene made, checked, rendered and exported."""
    print(" ", run(program, "--version", folder=folder).strip())
    assert "candle" in run(program, "licences", folder=folder)
    run(program, "new", "--template", "t-junction", "--seed", "3", "-o", "a.loom", folder=folder)
    run(program, "render", "a.loom", "--what", "appearance,lidar", "--size", "320x180", "-o", "pictures", folder=folder)
    run(program, "export", "a.loom", "--format", "occ3d", "-o", "labels.npz", folder=folder)
    assert (folder / "pictures/lidar.ply").stat().st_size > 100_000 and (folder / "labels.npz").is_file()


def wheel(file: pathlib.Path, example: str, folder: pathlib.Path) -> None:
    run(sys.executable, "-m", "venv", folder / "venv", folder=folder)
    python = folder / "venv/bin/python"
    run(python, "-m", "pip", "install", "--quiet", "--no-index", file, folder=folder)
    works(folder / "venv/bin/sceneloom", folder)
    for _ in range(2):
        shapes = "; print(labels.shape, sweep['x'].shape, front.shape, truth['class'].shape, boxes['center_m'].shape)"
        print(" ", run(python, "-c", f"exec({example!r}){shapes}", folder=folder).strip())
    assert (folder / "scenes/a.loom").is_file()
    run(python, "-m", "pip", "uninstall", "--quiet", "--yes", "sceneloom", folder=folder)
    assert not (folder / "venv/bin/sceneloom").exists()


def deb(file: pathlib.Path, folder: pathlib.Path) -> None:
    if not shutil.which("dpkg-deb"):
        return print("  not tried: no dpkg-deb here")
    print(" ", run("dpkg-deb", "-f", file, "Version", "Depends", folder=folder).strip().replace("\n", "; "))
    run("dpkg-deb", "-x", file, folder / "root", folder=folder)
    share = folder / "root/usr/share"
    entry = configparser.ConfigParser(interpolation=None)
    entry.read(share / "applications/sceneloom.desktop", encoding="utf-8")
    kind = xml.etree.ElementTree.parse(share / "mime/packages/sceneloom.xml").getroot()[0].get("type")
    assert entry["Desktop Entry"]["MimeType"] == f"{kind};" and entry["Desktop Entry"]["Exec"] == "sceneloom %f"
    works(folder / "root/usr/bin/sceneloom", folder)


def tarball(file: pathlib.Path, folder: pathlib.Path) -> None:
    shutil.unpack_archive(file, folder / "unpacked")
    (inside,) = (folder / "unpacked").iterdir()
    works(inside / "sceneloom", folder)


def main() -> None:
    dist = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else ROOT / "dist").absolute()
    if "SCENELOOM_HIDDEN" not in os.environ:
        with tempfile.TemporaryDirectory() as copy:
            for file in [*dist.iterdir(), ROOT / "python/README.md", pathlib.Path(__file__)]:
                shutil.copy(file, copy)
            hide = 'mount -t tmpfs none "$1" && cd / && SCENELOOM_HIDDEN="$1" exec "$2" "$3/check.py" "$3"'
            user = [] if os.geteuid() == 0 else ["--map-root-user"]
            sys.exit(subprocess.run(["unshare", "--mount", *user, "sh", "-c", hide, "sh", ROOT, sys.executable, copy]).returncode)
    assert not os.listdir(os.environ["SCENELOOM_HIDDEN"]), "the project is not hidden"
    example = (dist / "README.md").read_text(encoding="utf-8").split("```python\n")[1].split("```")[0]
    tried = 0
    for ending, check in ((".whl", lambda f, at: wheel(f, example, at)), (".deb", deb), (".tar.gz", tarball)):
        for file in sorted(dist.glob(f"*{ending}")):
            print(file.name, flush=True)
            with tempfile.TemporaryDirectory() as folder:
                check(file, pathlib.Path(folder))
            tried += 1
    sys.exit(0 if tried else f"no artefact in {dist}")


if __name__ == "__main__":
    main()
