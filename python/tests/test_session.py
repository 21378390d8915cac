"""The package against the program: SCENELOOM names it, else `sceneloom` on the PATH. Run: python -m unittest discover python/tests"""

from __future__ import annotations

import importlib.util
import pathlib
import sys
import tempfile
import threading
import unittest

ROOT = pathlib.Path(__file__).parent.parent
sys.path.insert(0, str(ROOT))

from sceneloom import CallError, Session, SessionEnded, edits  # noqa: E402


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
        import os
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
