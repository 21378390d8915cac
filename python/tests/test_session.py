"""The package against the program: SCENELOOM names it, else `sceneloom` on the PATH. Run: python -m unittest discover python/tests"""

from __future__ import annotations

import importlib.util
import os
import pathlib
import struct
import sys
import tempfile
import threading
import unittest
import unittest.mock
import zlib
from typing import Any

ROOT = pathlib.Path(__file__).parent.parent
sys.path.insert(0, str(ROOT))

from sceneloom import CallError, Session, SessionEnded, arrays, edits  # noqa: E402


class TestSession(unittest.TestCase):
    def setUp(self) -> None:
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)

    def test_a_scene_is_made_changed_and_written(self) -> None:
        with Session(folder=self.folder) as s:
            made = s.new(template="t-junction", seed=3)
            self.assertGreater(made["boxes"], 2)
            cone = edits.add_box(class_="traffic_cone", center_m=(9, 1, 0.5), size_m=(0.4, 0.4, 1.0), yaw_deg=0)
            done = s.apply(edits=[cone], step="a cone")
            self.assertEqual(done["step"], "a cone")
            self.assertEqual(done["changed"]["boxes"], {"added": 1, "removed": 0, "changed": 0})
            (number,) = done["changed"]["boxes_added"]
            cones = [b for b in s.state()["boxes"] if b["id"] == number]
            self.assertEqual((cones[0]["class"], cones[0]["center_m"]), ("traffic_cone", [9.0, 1.0, 0.5]))
            self.assertEqual(s.undo()["revision"], made["revision"])
            self.assertEqual(s.redo()["revision"], done["revision"])
            s.save(file="a.loom")
            self.assertTrue((self.folder / "a.loom").is_file())
        with Session(self.folder / "a.loom", folder=self.folder) as s:
            self.assertEqual(s.diff(file="a.loom")["changed"]["voxels"], 0)
            self.assertEqual(s.close(), 0)

    def test_the_example_of_the_document_runs_twice_in_a_folder_that_is_missing(self) -> None:
        document = (ROOT.parent / "docs/assistants.md").read_text(encoding="utf-8")
        example = document.split("```python\n")[1].split("```")[0]
        there = str(self.folder / "a" / "scenes")
        example = example.replace('"scenes"', repr(there)).replace("    s.generate(quality", "    #")
        for _ in range(2):
            found: dict[str, Any] = {}
            exec(compile(example, "assistants.md", "exec"), found)
            shapes = {name: tuple(found[name].shape) for name in ("labels", "depth_m")}
            self.assertEqual(shapes, {"labels": (200, 200, 16), "depth_m": (270, 480)})
            self.assertGreater(found["x"].shape[0], 1000)
        self.assertEqual(os.listdir(there), ["labels.npz"], "files of arrays do not stay")

    def test_the_example_of_the_package_gives_arrays_in_memory_and_runs_twice(self) -> None:
        example = (ROOT / "README.md").read_text(encoding="utf-8").split("```python\n")[1].split("```")[0]
        there = str(self.folder / "scenes")
        for _ in range(2):
            found: dict[str, Any] = {}
            exec(compile(example.replace('"scenes"', repr(there)), "README.md", "exec"), found)
            labels, sweep, front, truth, boxes = (found[name] for name in ("labels", "sweep", "front", "truth", "boxes"))
            self.assertEqual(tuple(labels.shape), (200, 200, 16))
            self.assertGreater(sweep["x"].shape[0], 1000)
            self.assertEqual(tuple(front.shape), (270, 480, 3))
            self.assertGreater(len(set(front.tobytes())), 100, "a picture has many shades")
            self.assertEqual(tuple(truth["class"].shape), (270, 480))
            count = len(boxes["id"])
            self.assertEqual(tuple(boxes["center_m"].shape), (count, 3))
            self.assertEqual(tuple(boxes["yaw_deg"].shape), (count,))
            self.assertIn("pedestrian", boxes["class"])
            self.assertEqual(os.listdir(there), ["a.loom"], "files of arrays do not stay")

    def test_pixels_of_every_filter_come_back(self) -> None:
        width, height = 5, 6
        rows = [bytes((x * 37 + y * 91 + c * 13) * (y + 1) & 255 for x in range(width) for c in range(4)) for y in range(height)]
        packed, before = b"", bytes(4 * width)
        for y, row in enumerate(rows):
            kind = y % 5
            around = [(row[i - 4] if i >= 4 else 0, before[i], before[i - 4] if i >= 4 else 0) for i in range(4 * width)]
            guesses = [(0, a, b, (a + b) // 2, min((a, b, c), key=lambda v, t=a + b - c: abs(t - v)))[kind] for a, b, c in around]
            packed += bytes([kind]) + bytes((v - g) & 255 for v, g in zip(row, guesses))
            before = row

        def chunk(kind: bytes, content: bytes) -> bytes:
            return struct.pack(">I", len(content)) + kind + content + struct.pack(">I", zlib.crc32(kind + content))

        def file(depth: int, body: bytes) -> bytes:
            head = struct.pack(">IIBBBBB", width, height, depth, 6, 0, 0, 0)
            return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", head) + chunk(b"IDAT", zlib.compress(body)) + chunk(b"IEND", b"")

        pixels = arrays.png(file(8, packed))
        self.assertEqual(tuple(pixels.shape), (height, width, 3))
        self.assertEqual(pixels.tobytes(), b"".join(row[i : i + 3] for row in rows for i in range(0, len(row), 4)))
        for bad in (b"", file(16, packed), file(8, packed[:-1]), file(8, b"\x07" + packed[1:])):
            with self.assertRaises(ValueError):
                arrays.png(bad)

    def test_arrays_hold_what_is_in_the_scene(self) -> None:
        with Session(folder=self.folder) as s:
            occupied = s.new(template="straight", seed=3)["occupied_voxels"]
            labels = s.voxels()
            values = bytes(labels.tobytes())
            self.assertEqual(len(values) - values.count(17), occupied)
            self.assertEqual(int(labels[0, 0, 15]), 17)
            points = s.points()
            self.assertEqual({len(of) for of in points.values()}, {points["x"].shape[0]})
            self.assertLess(max(points["range_m"].tolist()), 200)
            with self.assertRaisesRegex(CallError, "NOWHERE"):
                s.maps("NOWHERE")
            self.assertEqual(os.listdir(self.folder), [])

    def test_without_numpy_arrays_are_views_of_the_same_shape(self) -> None:
        head = repr({"descr": "<f4", "fortran_order": False, "shape": (2, 3)}).encode()
        content = b"\x93NUMPY\x01\x00" + struct.pack("<H", len(head)) + head + struct.pack("<6f", *range(6))
        with unittest.mock.patch("importlib.util.find_spec", return_value=None):
            view = arrays.npy(content)
        self.assertIsInstance(view, memoryview)
        self.assertEqual((view.shape, view[1, 2], view.tolist()), ((2, 3), 5.0, [[0.0, 1.0, 2.0], [3.0, 4.0, 5.0]]))
        for bad in (b"", b"PK", content.replace(b"<f4", b"<c8"), content.replace(b"False", b"True ")):
            with self.assertRaises(ValueError):
                arrays.npy(bad)

    def test_a_refusal_says_how_to_write_over_files(self) -> None:
        with Session(folder=self.folder) as s:
            s.render(what=["bev"])
            with self.assertRaisesRegex(CallError, r'pictures/bev.png: is there already; "replace": true'):
                s.render(what=["bev"])
            s.render(what=["bev"], replace=True)

    def test_what_is_refused_is_an_exception_and_the_session_goes_on(self) -> None:
        with Session(folder=self.folder) as s:
            with self.assertRaisesRegex(CallError, "refused"):
                s.open(file="../a.loom")
            with self.assertRaisesRegex(CallError, "no call"):
                s.call("run_code", {})
            with self.assertRaises(ValueError):  # NaN is no JSON, and nothing is sent
                s.show(time_s=float("nan"))
            with self.assertRaisesRegex(CallError, "1048576"):
                s.prompt(text="x" * (10 << 20))
            self.assertEqual(s.state(most_boxes=1)["revision"], 1)

    def test_a_program_that_cannot_begin_is_an_exception(self) -> None:
        with self.assertRaisesRegex(SessionEnded, "nowhere"):
            Session(folder=self.folder, program="/nowhere/sceneloom")
        session = Session(scene=self.folder / "missing.loom", folder=self.folder)
        self.addCleanup(session.close)
        with self.assertRaisesRegex(SessionEnded, "missing.loom"):
            session.state()

    def test_threads_share_a_session(self) -> None:
        with Session(folder=self.folder) as s:
            seen: list[int] = []
            look = lambda: seen.append(s.state(most_boxes=0, roads=False)["revision"])  # noqa: E731
            threads = [threading.Thread(target=look) for _ in range(8)]
            for thread in threads:
                thread.start()
            for thread in threads:
                thread.join()
            self.assertEqual(seen, [1] * 8)

    def test_the_package_is_made_from_the_schema_of_this_program(self) -> None:
        import shutil

        spec = importlib.util.spec_from_file_location("generate", ROOT / "generate.py")
        assert spec is not None and spec.loader is not None
        generate = importlib.util.module_from_spec(spec)
        spec.loader.exec_module(generate)
        program = os.environ.get("SCENELOOM") or shutil.which("sceneloom")
        for name, text in generate.written(generate.schema_of(program)).items():
            with self.subTest(name):
                found = (ROOT / "sceneloom" / name).read_text(encoding="utf-8")
                self.assertEqual(found, text, "run python/generate.py")


if __name__ == "__main__":
    unittest.main()
