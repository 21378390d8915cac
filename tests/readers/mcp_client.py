# packages: mcp==2.3.0 jsonschema==4.26.0 numpy==2.4.6
"""Builds a scene over MCP with the protocol's own Python client, from what the tool list says alone.

python mcp_client.py [TRANSCRIPT.md]; the program is that of SCENELOOM, else `sceneloom`. Prints one line of JSON.
"""

from __future__ import annotations

import asyncio
import base64
import importlib.metadata
import json
import os
import pathlib
import re
import subprocess
import sys
import tempfile
from typing import Any

import httpx2
import jsonschema
import numpy
from mcp import StdioServerParameters
from mcp.client.client import Client
from mcp.client.streamable_http import streamable_http_client

PEDESTRIAN = 7  # the label of Occ3D


class Wrong(Exception):
    """Something is not as it should be."""


def expect(holds: bool, what: str) -> None:
    if not holds:
        raise Wrong(what)


class Transcript:
    """What was called and what came back, for a person."""

    def __init__(self, tools: list[Any]) -> None:
        self.tools = {tool.name: tool for tool in tools}
        self.lines: list[str] = []

    def say(self, text: str) -> None:
        self.lines += [text, ""]

    def called(self, name: str, args: dict[str, Any], answer: str) -> None:
        self.lines += [f"**{name}** `{json.dumps(args)}`", "", "```json", answer, "```", ""]


def short(value: Any, depth: int = 0) -> Any:
    """A receipt with long lists cut, to be read."""
    if isinstance(value, list):
        kept = [short(v, depth + 1) for v in value[:3]]
        return kept + [f"... {len(value)} in all"] if len(value) > 3 else kept
    if isinstance(value, dict):
        nothing = (None, [], {}, "") if depth == 0 else (None, [], {}, "", 0, False)
        return {k: short(v, depth + 1) for k, v in value.items() if v not in nothing}
    return round(value, 3) if isinstance(value, float) else value


async def call(client: Client, log: Transcript, name: str, keys: tuple[str, ...] = (), /, **args: Any) -> Any:
    """Calls a tool with arguments that meet its schema; its receipt meets its own. `keys` of it go into the transcript."""
    tool = log.tools[name]
    jsonschema.validate(args, tool.input_schema)
    result = await client.call_tool(name, args)
    text = next((c.text for c in result.content if c.type == "text"), "")
    expect(not result.is_error, f"{name}: {text}")
    receipt = result.structured_content
    jsonschema.validate(receipt, tool.output_schema)
    expect(json.loads(text) == receipt, f"{name}: the text differs from the values")
    shown = short({k: receipt[k] for k in keys} if keys else receipt)
    log.called(name, args, json.dumps(shown, ensure_ascii=False))
    return receipt, result


async def refused(client: Client, log: Transcript, name: str, /, **args: Any) -> str:
    """Calls what must be refused; the one line that says why."""
    try:
        result = await client.call_tool(name, args)
        expect(bool(result.is_error), f"{name} {args} was not refused")
        line = result.content[0].text
    except Wrong:
        raise
    except Exception as error:  # a protocol error, of the client's own kind
        line = str(error)
    expect("\n" not in line and len(line) <= 320, f"{name}: refused in more than a line: {line}")
    log.called(name, args, json.dumps({"refused": line}, ensure_ascii=False))
    return line


def crossing_at(roads: dict[str, Any]) -> tuple[float, float, float]:
    """Where our road can be crossed: x ahead of us, and the sides of the lanes there (y, m)."""
    x = 14.0
    ys = []
    for line in roads["lanes"]:
        for (x0, y0), (x1, y1) in zip(line, line[1:]):
            if min(x0, x1) <= x <= max(x0, x1) and abs(x1 - x0) > abs(y1 - y0):
                ys.append(y0 + (y1 - y0) * (x - x0) / (x1 - x0))
    expect(len(ys) >= 1, "no lane passes 14 m ahead")
    return x, min(ys) - 2.0, max(ys) + 2.0


async def build(client: Client, folder: pathlib.Path) -> tuple[Transcript, dict[str, Any]]:
    listed = await client.list_tools()
    log = Transcript(listed.tools)
    for tool in listed.tools:
        jsonschema.Draft202012Validator.check_schema(tool.input_schema)
        jsonschema.Draft202012Validator.check_schema(tool.output_schema)
        found = re.search(r"Example: (\{.*\})$", tool.description or "")
        expect(found is not None, f"{tool.name} has no example")
        jsonschema.validate(json.loads(found[1]), tool.input_schema)
    log.say(f"The server offers {len(listed.tools)} tools: {', '.join(log.tools)}.")
    log.say("## A street with a crossing and three pedestrians")
    await call(client, log, "new", ("revision", "name", "boxes", "occupied_voxels"), template="straight", seed=3)
    state, _ = await call(client, log, "state", ("revision", "map", "counts"), most_boxes=100, roads=True)
    x, right, left = crossing_at(state["roads"])
    taken = [b["id"] for b in state["boxes"] if abs(b["center_m"][0] - x) < 5 and right - 3 < b["center_m"][1] < left + 3]
    log.say(f"Our road spans y = {right:.1f} to {left:.1f} m at x = {x:.0f} m. What stands there makes room.")
    edits: list[dict[str, Any]] = [{"remove_box": {"id": i}} for i in taken]
    corners = [[x - 2, right], [x + 2, right], [x + 2, left], [x - 2, left]]
    edits.append({"add_polylines": {"lines": [{"kind": "ped_crossing", "points_m": corners}]}})
    places = [(x - 1, right + 1.0), (x, (right + left) / 2), (x + 1, left - 1.0)]
    for px, py in places:
        size = [0.7, 0.7, 1.8]
        edits.append({"add_box": {"class": "pedestrian", "center_m": [px, round(py, 2), 0.9], "size_m": size, "yaw_deg": 90}})
    done, _ = await call(client, log, "apply", ("revision", "step", "changed", "draft_columns", "warnings"), edits=edits, step="a crossing with people")
    people = done["changed"]["boxes_added"]
    expect(len(people) == 3, f"three pedestrians were added: {people}")
    expect(done["changed"]["layers"]["ped_crossing"]["gained"] > 50, "the crossing is on the map")

    log.say("## Looking at it, letting one walk, drawing the voxels")
    _, result = await call(client, log, "render", ("files", "revision"), what=["bev"])
    image = next(c for c in result.content if c.type == "image")
    expect(base64.b64decode(image.data).startswith(b"\x89PNG"), "a picture comes with the answer")
    log.say(f"The picture that came with it has {len(image.data) * 3 // 4000} kB.")
    await call(client, log, "add_track", ("revision", "step", "track", "length_s"), box=people[0], template="cross", mps=1.2)
    await call(client, log, "generate", ("revision", "step", "region_columns", "untouched_voxels_changed", "draft_columns"), quality="draft")
    await call(client, log, "prompt", ("revision", "answer", "phrases"), text="at dusk in the rain")

    log.say("## Checking and writing")
    checked, _ = await call(client, log, "check", ("errors", "warnings", "waived"), sensors=True)
    ours = [f for f in checked["findings"] if f["box"] in people and f["severity"] == "error"]
    expect(not ours, f"the pedestrians are sound: {ours}")
    written, _ = await call(client, log, "export", ("files", "holds", "lost"), format="occ3d", name="frame/labels.npz")
    await call(client, log, "save", ("file", "revision"), file="crossing.loom")
    labels = numpy.load(folder / written["files"][0]["name"])["semantics"]
    expect(labels.shape == (200, 200, 16), f"Occ3D labels have 200 x 200 x 16 voxels: {labels.shape}")
    for px, py in places[1:]:
        i, j = int((px + 40) / 0.4), int((py + 40) / 0.4)
        near = labels[i - 2 : i + 3, j - 2 : j + 3]
        expect(bool((near == PEDESTRIAN).any()), f"a pedestrian has voxels at {px}, {py}")

    log.say("## What is refused")
    await refused(client, log, "open", file="../../etc/passwd")
    await refused(client, log, "save", file="/tmp/x.loom")
    await refused(client, log, "apply", edits=[{"run": "rm -rf /"}])
    await refused(client, log, "show", time_s="NaN")
    await refused(client, log, "run_code", code="1 + 1")
    undone, _ = await call(client, log, "undo", ("revision", "steps"), steps=2)
    expect(len(undone["steps"]) == 2, "each call was one step")
    last, _ = await call(client, log, "state", ("revision", "undo", "redo", "counts"), most_boxes=0, roads=False)
    read = {"tools": len(listed.tools), "calls": sum(1 for l in log.lines if l.startswith("**")), "boxes": last["counts"]["boxes"]}
    return log, read


async def over_http(program: str, folder: str) -> int:
    """The same server over HTTP, with the handshake of before 2026-07-28 and with today's; how many calls were answered."""
    token = "0123456789abcdef"
    command = [program, "mcp", "--folder", folder, "--listen", "127.0.0.1:0", "--token", token]
    answered = 0
    with subprocess.Popen(command, stderr=subprocess.PIPE, text=True) as server:
        try:
            assert server.stderr is not None
            url = server.stderr.readline().removeprefix("listening on ").strip()
            for mode in ("legacy", "auto"):
                headers = {"Authorization": f"Bearer {token}"}
                async with httpx2.AsyncClient(headers=headers, timeout=120) as http:
                    async with Client(streamable_http_client(url, http_client=http), mode=mode) as client:
                        expect(len((await client.list_tools()).tools) > 20, "the tools over HTTP")
                        made = await client.call_tool("new", {"template": "curve", "seed": answered})
                        state = await client.call_tool("state", {"most_boxes": 0})
                        now = state.structured_content["revision"]
                        expect(made.structured_content["revision"] == now, "one scene for all requests")
                        answered += 2
        finally:
            server.terminate()
    return answered


async def main() -> None:
    program = os.environ.get("SCENELOOM", "sceneloom")
    with tempfile.TemporaryDirectory() as folder:
        server = StdioServerParameters(command=program, args=["mcp", "--folder", folder])
        async with Client(server) as client:
            log, read = await build(client, pathlib.Path(folder))
        read["calls_over_http"] = await over_http(program, folder)
    version = importlib.metadata.version("mcp")
    if len(sys.argv) > 1:
        head = f"# A session over MCP\n\nMade by `tests/readers/mcp_client.py` with the Python client of the protocol's makers (`mcp` {version}). Receipts are\nshortened: what is 0, empty or false is left out, and long lists are cut.\n\n"
        pathlib.Path(sys.argv[1]).write_text(head + "\n".join(log.lines).rstrip() + "\n", encoding="utf-8")
    print(json.dumps({"reader": "mcp", "version": version, "accepted": True, "read": read}))


if __name__ == "__main__":
    try:
        asyncio.run(main())
    except Wrong as error:
        sys.exit(f"mcp_client: {error}")
