"""Release artefacts of a built program: python3 python/release/make.py [--program target/release/sceneloom] [-o dist]

The program is best built for it: cargo build --profile dist --features full, then --program target/dist/sceneloom.

Writes a wheel (the Python package with the program inside), a .deb with desktop entry and file type, and a .tar.gz. Needs Python alone. The
same program and commit give the same bytes. Prints name and size of each; exit 1 if one is larger than 100 MB. `check.py` tries them.
"""
from __future__ import annotations

import argparse
import base64
import csv
import gzip
import hashlib
import io
import lzma
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tarfile
import tempfile
import time
import zipfile

ROOT = pathlib.Path(__file__).resolve().parents[2]
HERE = pathlib.Path(__file__).resolve().parent
LARGEST_MB = 100
SUMMARY = "Interactive editor for driving scenes: layout, voxels, boxes, cameras and LiDAR in one window"
# Libraries that are linked, and those that a window under X11 loads.
DEPENDS = "libc6 (>= 2.{glibc}), libgcc-s1, libstdc++6, libxkbcommon-x11-0, libx11-xcb1, libxcursor1, libxi6, libxrandr2"
RECOMMENDS = "mesa-vulkan-drivers | vulkan-icd, xdg-desktop-portal, libwayland-client0"


def version() -> str:
    manifest = (ROOT / "Cargo.toml").read_text(encoding="utf-8")
    return re.search(r'\[workspace\.package\]\nversion = "([^"]+)"', manifest).group(1)


def moment() -> int:
    """Seconds since 1970 that all files carry: SOURCE_DATE_EPOCH, else the time of the commit."""
    if "SOURCE_DATE_EPOCH" in os.environ:
        return int(os.environ["SOURCE_DATE_EPOCH"])
    return int(subprocess.check_output(["git", "-C", ROOT, "log", "-1", "--format=%ct"]))


def documents() -> dict[str, bytes]:
    names = {"LICENSE-MIT": ROOT, "LICENSE-APACHE": ROOT, "notices.txt": ROOT / "assets/licences"}
    return {name: (folder / name).read_bytes() for name, folder in names.items()}


def newest_glibc(program: bytes) -> int:
    """Minor version of the newest GLIBC 2.x that the program asks for."""
    return max(int(n) for n in re.findall(rb"GLIBC_2\.(\d+)(?:\.\d+)?\0", program))


def without_symbols(path: pathlib.Path) -> bytes:
    """The program as it is shipped; with its symbols where there is no `strip`."""
    if path.read_bytes()[:4] != b"\x7fELF":
        sys.exit(f"{path}: no program for Linux")
    if not shutil.which("strip"):
        print("no strip here: symbols stay in")
        return path.read_bytes()
    with tempfile.TemporaryDirectory() as folder:
        subprocess.run(["strip", "-o", f"{folder}/program", path], check=True)
        return pathlib.Path(folder, "program").read_bytes()


def tar(files: dict[str, tuple[bytes, int]], at: int) -> bytes:
    """An uncompressed archive of files by name: content and mode. Folders above them come first; all belong to root."""
    folders = sorted({str(p) for name in files for p in pathlib.PurePosixPath(name).parents if str(p) != "."})
    out = io.BytesIO()
    with tarfile.open(fileobj=out, mode="w", format=tarfile.USTAR_FORMAT) as archive:
        for folder in folders:
            info = tarfile.TarInfo(folder)
            info.type, info.mode, info.mtime = tarfile.DIRTYPE, 0o755, at
            archive.addfile(info)
        for name, (content, mode) in sorted(files.items()):
            info = tarfile.TarInfo(name)
            info.size, info.mode, info.mtime, info.uname, info.gname = len(content), mode, at, "root", "root"
            archive.addfile(info, io.BytesIO(content))
    return out.getvalue()


def tarball(program: bytes, at: int) -> tuple[str, bytes]:
    name = f"sceneloom-{version()}-linux-x86_64"
    files = {f"{name}/sceneloom": (program, 0o755), f"{name}/README.md": ((ROOT / "README.md").read_bytes(), 0o644)}
    files |= {f"{name}/{file}": (content, 0o644) for file, content in documents().items()}
    files |= {f"{name}/share/{file}": ((HERE / file).read_bytes(), 0o644) for file in ("sceneloom.desktop", "sceneloom.svg", "sceneloom.xml")}
    return f"{name}.tar.gz", gzip.compress(tar(files, at), 6, mtime=at)


def deb(program: bytes, at: int) -> tuple[str, bytes]:
    copyright_ = b"Sceneloom: MIT or Apache-2.0, at your choice. Texts of both, and of all that is inside, are beside this file.\n"
    doc = "usr/share/doc/sceneloom"
    files = {
        "usr/bin/sceneloom": (program, 0o755),
        "usr/share/applications/sceneloom.desktop": ((HERE / "sceneloom.desktop").read_bytes(), 0o644),
        "usr/share/icons/hicolor/scalable/apps/sceneloom.svg": ((HERE / "sceneloom.svg").read_bytes(), 0o644),
        "usr/share/mime/packages/sceneloom.xml": ((HERE / "sceneloom.xml").read_bytes(), 0o644),
        f"{doc}/copyright": (copyright_, 0o644),
    }
    files |= {f"{doc}/{name}": (content, 0o644) for name, content in documents().items()}
    fields = {
        "Package": "sceneloom",
        "Version": version(),
        "Architecture": "amd64",
        "Maintainer": "The Sceneloom authors <sceneloom@localhost>",
        "Installed-Size": str(sum(len(content) for content, _ in files.values()) // 1024),
        "Depends": DEPENDS.format(glibc=newest_glibc(program)),
        "Recommends": RECOMMENDS,
        "Section": "graphics",
        "Priority": "optional",
        "Description": SUMMARY,
    }
    control = "".join(f"{name}: {value}\n" for name, value in fields.items()).encode()
    sums = "".join(f"{hashlib.md5(content).hexdigest()}  {name}\n" for name, (content, _) in sorted(files.items())).encode()
    parts = {
        "debian-binary": b"2.0\n",
        "control.tar.xz": lzma.compress(tar({"control": (control, 0o644), "md5sums": (sums, 0o644)}, at), preset=1),
        "data.tar.xz": lzma.compress(tar(files, at), preset=1),
    }
    out = b"!<arch>\n"
    for name, content in parts.items():
        out += f"{name:<16}{at:<12}{0:<6}{0:<6}{'100644':<8}{len(content):<10}`\n".encode() + content + b"\n" * (len(content) % 2)
    return f"sceneloom_{version()}_amd64.deb", out


def wheel(program: bytes, at: int) -> tuple[str, bytes]:
    name = f"sceneloom-{version()}"
    tag = f"py3-none-manylinux_2_{newest_glibc(program)}_x86_64"
    metadata = f"""Metadata-Version: 2.1
Name: sceneloom
Version: {version()}
Summary: {SUMMARY}
License: MIT OR Apache-2.0
Requires-Python: >=3.10
Description-Content-Type: text/markdown

""".encode() + (ROOT / "python/README.md").read_bytes()
    package = sorted((ROOT / "python/sceneloom").glob("*.py")) + [ROOT / "python/sceneloom/py.typed"]
    files = {f"sceneloom/{path.name}": path.read_bytes() for path in package}
    files[f"{name}.data/scripts/sceneloom"] = program
    files |= {f"{name}.dist-info/licenses/{file}": content for file, content in documents().items()}
    files[f"{name}.dist-info/METADATA"] = metadata
    files[f"{name}.dist-info/WHEEL"] = f"Wheel-Version: 1.0\nGenerator: sceneloom\nRoot-Is-Purelib: false\nTag: {tag}\n".encode()
    record = io.StringIO()
    rows = csv.writer(record, lineterminator="\n")
    for file, content in files.items():
        digest = base64.urlsafe_b64encode(hashlib.sha256(content).digest()).rstrip(b"=").decode()
        rows.writerow([file, f"sha256={digest}", len(content)])
    rows.writerow([f"{name}.dist-info/RECORD", "", ""])
    files[f"{name}.dist-info/RECORD"] = record.getvalue().encode()
    out = io.BytesIO()
    with zipfile.ZipFile(out, "w", zipfile.ZIP_DEFLATED, compresslevel=6) as archive:
        for file, content in files.items():
            info = zipfile.ZipInfo(file, time.gmtime(at)[:6])
            info.compress_type = zipfile.ZIP_DEFLATED
            info.external_attr = (0o100755 if "/scripts/" in file else 0o100644) << 16
            archive.writestr(info, content)
    return f"{name}-{tag}.whl", out.getvalue()


def main() -> None:
    p = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    p.add_argument("--program", type=pathlib.Path, default=ROOT / "target/release/sceneloom", help="built for x86-64 Linux")
    p.add_argument("-o", "--out", type=pathlib.Path, default=ROOT / "dist")
    args = p.parse_args()
    if not args.program.is_file():
        sys.exit(f"{args.program} is not there: cargo build --release makes it")
    program, at = without_symbols(args.program), moment()
    args.out.mkdir(parents=True, exist_ok=True)
    largest = 0.0
    for name, content in (make(program, at) for make in (wheel, deb, tarball)):
        (args.out / name).write_bytes(content)
        largest = max(largest, len(content) / 1e6)
        print(f"{len(content) / 1e6:6.1f} MB  {args.out / name}", flush=True)
    sys.exit(largest > LARGEST_MB)


if __name__ == "__main__":
    main()
