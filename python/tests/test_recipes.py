"""The recipes of docs/batches.md for many machines, as far as they go without a cluster."""

from __future__ import annotations

import contextlib
import io
import os
import pathlib
import re
import stat
import subprocess
import sys
import tempfile
import types
import unittest
import unittest.mock

DOCUMENT = (pathlib.Path(__file__).parents[2] / "docs/batches.md").read_text(encoding="utf-8")
PARTS = 16

# Stands in for the program: notes its arguments; part 3 has variants that failed.
PROGRAM = """#!/bin/sh
echo "$@" >> "$NOTES"
case "$*" in *" --shard 3/16") exit 1 ;; esac
"""


def recipe(language: str) -> str:
    """The first block of code in a language."""
    return DOCUMENT.split(f"```{language}\n")[1].split("```")[0]


class TestRecipes(unittest.TestCase):
    def setUp(self) -> None:
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        program = pathlib.Path(folder.name) / "sceneloom"
        program.write_text(PROGRAM)
        program.chmod(program.stat().st_mode | stat.S_IXUSR)
        self.notes = pathlib.Path(folder.name) / "notes"
        self.env = {**os.environ, "PATH": f"{folder.name}:{os.environ['PATH']}", "NOTES": str(self.notes)}

    def shards(self) -> list[str]:
        return sorted(line.split()[-1] for line in self.notes.read_text().splitlines())

    def test_every_index_of_the_job_makes_its_own_part(self) -> None:
        line = re.search(r"args: \['(.*)'\]", recipe("yaml"))
        assert line is not None
        for index in range(PARTS):
            env = {**self.env, "JOB_COMPLETION_INDEX": str(index)}
            subprocess.run(["/bin/sh", "-c", line[1]], env=env, check=False)
        self.assertEqual(self.shards(), sorted(f"{i}/{PARTS}" for i in range(PARTS)))

    def test_the_job_is_one_as_kubernetes_reads_it(self) -> None:
        try:
            import yaml
        except ImportError:
            self.skipTest("this Python lacks yaml")
        job = yaml.safe_load(recipe("yaml"))
        spec = job["spec"]
        self.assertEqual((job["apiVersion"], job["kind"], spec["completionMode"]), ("batch/v1", "Job", "Indexed"))
        self.assertEqual((spec["completions"], spec["parallelism"]), (PARTS, PARTS))
        # What batch/v1 asks for where these are used.
        self.assertIn("backoffLimitPerIndex", spec)
        self.assertEqual(spec["template"]["spec"]["restartPolicy"], "Never")
        (container,) = spec["template"]["spec"]["containers"]
        self.assertEqual(container["command"], ["/bin/sh", "-c"])
        self.assertNotIn("$(", container["args"][0], "Kubernetes expands only variables of env")
        volumes = {v["name"] for v in spec["template"]["spec"]["volumes"]}
        self.assertEqual({m["name"] for m in container["volumeMounts"]}, volumes)

    def test_a_part_that_fails_ends_no_other_part_of_ray(self) -> None:
        class RayError(Exception):
            pass

        def remote(**_: int):  # type: ignore[no-untyped-def]
            return lambda work: types.SimpleNamespace(remote=lambda *args: Ready(work, args))

        class Ready:
            def __init__(self, work, args) -> None:  # type: ignore[no-untyped-def]
                self.work, self.args = work, args

        def get(ready: Ready) -> object:
            if ready.args[0] == 5:
                raise RayError("the machine was lost")
            return ready.work(*ready.args)

        ray = types.ModuleType("ray")
        ray.remote, ray.get, ray.init = remote, get, lambda: None  # type: ignore[attr-defined]
        ray.wait = lambda all_: (all_[:1], all_[1:])  # type: ignore[attr-defined]
        ray.exceptions = types.SimpleNamespace(RayError=RayError)  # type: ignore[attr-defined]
        said = io.StringIO()
        with unittest.mock.patch.dict(sys.modules, ray=ray), unittest.mock.patch.dict(os.environ, self.env):
            with contextlib.redirect_stdout(said):
                exec(compile(recipe("python"), "batches.md", "exec"), {})
        self.assertEqual(self.shards(), sorted(f"{i}/{PARTS}" for i in range(PARTS) if i != 5))
        self.assertEqual(said.getvalue().strip(), "{3: 1, 5: 'the machine was lost'}")


if __name__ == "__main__":
    unittest.main()
