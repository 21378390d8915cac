#!/usr/bin/env python3
"""Writes notices.txt: the licences of everything that is linked into the program, on any system, and of the data inside it.

    cargo fetch --locked && python3 assets/licences/make.py

Asks `cargo metadata` for the libraries that the program links (no build scripts, no tests) and takes the licence texts from
their packages. Where a library may be had under several licences, the first of PREFERRED is taken. Equal texts stand once.
"""

import json
import os
import re
import subprocess
from pathlib import Path

HERE = Path(__file__).resolve().parent
ROOT = HERE.parent.parent
PREFERRED = ["Apache-2.0", "MIT", "BSD-3-Clause", "BSD-2-Clause", "Zlib", "BSL-1.0", "ISC", "Unlicense", "CC0-1.0", "0BSD"]
NAMES = re.compile(r"(?i)^(licen[cs]e|copying|notice|unlicense|ofl|ufl)")
# Folders of packages whose licences speak of code that is not compiled in, and a file that speaks of none of it.
NOT_LINKED = {"tests", "examples", "programs", "contrib", "images"}
NOT_MEANT = {"COPYING.LIB"}
# Texts of packages that bring none: whole for these, by the names of the authors for MIT.
OWN_TEXTS = {"Apache-2.0": ROOT / "LICENSE-APACHE"}


def linked(metadata):
    """Packages from a registry that normal dependencies reach from the program."""
    packages = {p["id"]: p for p in metadata["packages"]}
    nodes = {n["id"]: n for n in metadata["resolve"]["nodes"]}
    seen, ahead = set(), [p["id"] for p in metadata["packages"] if p["name"] == "sceneloom"]
    while ahead:
        one = ahead.pop()
        if one in seen:
            continue
        seen.add(one)
        for dependency in nodes[one]["deps"]:
            if any(kind["kind"] is None for kind in dependency["dep_kinds"]):
                ahead.append(dependency["pkg"])
    found = [packages[i] for i in seen if packages[i]["source"]]
    return sorted(found, key=lambda p: (p["name"], p["version"]))


def chosen(expression):
    """The licences that are taken out of an SPDX expression: all of its ANDed parts, of each the first of PREFERRED."""
    taken = []
    for part in expression.replace("/", " OR ").split(" AND "):
        choices = [c.strip() for c in part.strip(" ()").split(" OR ")]
        best = [p for p in PREFERRED if p in choices]
        taken.append(best[0] if best else choices[0])
    return taken


def printed(package, licences):
    """The licence texts in a package that belong to what was chosen."""
    folder = Path(package["manifest_path"]).parent
    found = []
    for here, folders, files in os.walk(folder):
        folders[:] = sorted(d for d in folders if d not in NOT_LINKED)
        for name in sorted(files):
            if not NAMES.match(name) or name.endswith((".rs", ".toml")) or name in NOT_MEANT:
                continue
            path = Path(here) / name
            text = path.read_text(encoding="utf-8", errors="replace").strip()
            top = path.parent == folder
            if top and not notice(name) and not wanted(text, licences):
                continue
            found.append(text)
    return found


def notice(name):
    return name.lower().startswith("notice")


MARKS = {
    "Apache-2.0": "apache license",
    "MIT": "permission is hereby granted, free of charge, to any person obtaining a copy",
    "BSD-3-Clause": "redistribution and use in source and binary forms",
    "BSD-2-Clause": "redistribution and use in source and binary forms",
    "Zlib": "this software is provided 'as-is'",
    "BSL-1.0": "boost software license",
    "ISC": "permission to use, copy, modify, and",
    "Unicode-3.0": "unicode license",
    "CC0-1.0": "cc0",
    "GPL-2.0-only": "gnu general public license",
    "LGPL-2.1-or-later": "lesser general public license",
}


def wanted(text, licences):
    """True if a text is of one of the licences that were chosen, or of one that is not known here."""
    plain = " ".join(text.lower().replace("’", "'").split())
    kinds = [kind for kind, mark in MARKS.items() if mark in plain]
    return not kinds or any(kind in licences for kind in kinds)


def missing(package, licence, packages):
    """The text of a licence whose package brings none."""
    if licence in OWN_TEXTS:
        return OWN_TEXTS[licence].read_text(encoding="utf-8").strip()
    body = (ROOT / "LICENSE-MIT").read_text(encoding="utf-8").split("Permission is hereby", 1)[1]
    authors = ", ".join(package["authors"]) or f"the authors of {package['name']}"
    if licence == "MIT":
        return f"MIT License\n\nCopyright (c) {authors}\n\nPermission is hereby{body}".strip()
    # The terms as another library prints them.
    for other in packages:
        if chosen(other["license"]) == [licence]:
            found = printed(other, [licence])
            if found:
                return f"Copyright (c) {authors}, under these terms, as {other['name']} prints them:\n\n{found[0]}"
    raise SystemExit(f"{package['name']}: no text of {licence} is known")


def main():
    metadata = json.loads(subprocess.run(
        ["cargo", "metadata", "--format-version", "1", "--locked"], cwd=ROOT, check=True, stdout=subprocess.PIPE).stdout)
    packages = linked(metadata)
    by_text = {}
    rows = []
    for package in packages:
        licences = chosen(package["license"])
        name = f"{package['name']} {package['version']}"
        rows.append(f"  {name}: {' AND '.join(licences)}" + (f", {package['repository']}" if package["repository"] else ""))
        for text in printed(package, licences) or [missing(package, one, packages) for one in licences]:
            key = " ".join(text.split())
            if "apache license version 2.0, january 2004" in key.lower() and "terms and conditions for use" in key.lower():
                # Copies differ in line breaks and in the names of their appendix.
                key, text = "apache", OWN_TEXTS["Apache-2.0"].read_text(encoding="utf-8").strip()
            by_text.setdefault(key, (text, []))[1].append(name)
    lines = [(HERE / "data.txt").read_text(encoding="utf-8").rstrip(), ""]
    lines += [f"LIBRARIES ({len(rows)}; not every system links all)", ""] + rows + [""]
    for text, names in sorted(by_text.values(), key=lambda pair: (-len(pair[1]), pair[1])):
        lines += ["=" * 100, "Of " + ", ".join(dict.fromkeys(names)) + ":", "", text, ""]
    (HERE / "notices.txt").write_text("\n".join(line.rstrip() for line in "\n".join(lines).splitlines()) + "\n", encoding="utf-8")
    print(f"{len(rows)} libraries, {len(by_text)} texts")


if __name__ == "__main__":
    main()
