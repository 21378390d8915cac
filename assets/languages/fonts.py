"""Cuts the letters of the interface out of Noto Sans CJK: python3 assets/languages/fonts.py NotoSansCJK-Regular.ttc

Needs fonttools. Writes ja.otf (Japanese forms), zh.otf (simplified Chinese forms) and names.otf (what the languages call
themselves, for the list of languages) beside this file; run it again when a
translation has new letters (a test says so).
"""

import json
import pathlib
import sys

from fontTools import subset
from fontTools.ttLib import TTCollection

FACES = {"ja": 0, "zh": 2}


def main(collection: str) -> None:
    here = pathlib.Path(__file__).parent
    names = "".join(json.loads((here / f"{code}.json").read_text())[""] for code in FACES)
    cut(collection, 0, names, here / "names.otf")
    for code, face in FACES.items():
        texts = json.loads((here / f"{code}.json").read_text()).values()
        cut(collection, face, "".join([*texts, names]), here / f"{code}.otf")


def cut(collection: str, face: int, text: str, path: pathlib.Path) -> None:
    """Writes one face of a collection with the letters of a text that egui's fonts lack."""
    letters = sorted({c for c in text if ord(c) > 0x2E7F or c in "—‘’“”…"})
    font = TTCollection(collection).fonts[face]
    options = subset.Options(hinting=False, layout_features=[], notdef_outline=True, name_IDs=[0, 1, 2, 13, 14])
    subsetter = subset.Subsetter(options)
    subsetter.populate(text="".join(letters))
    subsetter.subset(font)
    font.save(path)
    print(path.name, len(letters), "letters", path.stat().st_size, "bytes")


if __name__ == "__main__":
    main(sys.argv[1])
