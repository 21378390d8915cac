// packages: @playcanvas/splat-transform@3.7.0 playcanvas@2.22.4 node@22
// A scene_gaussians.ply through the converter of PlayCanvas, which wants Node 22: read, written as its own GLB and as CSV, and
// the CSV compared with the file.
import { execFileSync } from "node:child_process";
import { mkdtempSync, readFileSync, rmSync } from "node:fs";
import { createRequire } from "node:module";
import { tmpdir } from "node:os";
import { dirname, join } from "node:path";

// Also where the packages lie in the folder that this is run in.
const require = createRequire(`${process.cwd()}/`);
const node = join(dirname(require.resolve("node/package.json")), "bin", "node");
const home = join(process.cwd(), "node_modules", "@playcanvas", "splat-transform");
const { version } = JSON.parse(readFileSync(join(home, "package.json")));

function fail(line) {
  console.error(`gaussians-ply: ${line}`);
  process.exit(1);
}

const file = process.argv[2];
const bytes = readFileSync(file);
const end = bytes.indexOf("end_header\n") + "end_header\n".length;
const header = bytes.subarray(0, end).toString();
const count = Number(/element vertex (\d+)/.exec(header)[1]);
const stride = (bytes.length - end) / count;
const folder = mkdtempSync(join(tmpdir(), "splat-"));
try {
  const run = (out) =>
    execFileSync(node, [join(home, "bin", "cli.mjs"), "-w", file, join(folder, out)], { stdio: "pipe" });
  run("back.csv");
  run("back.glb");
  const lines = readFileSync(join(folder, "back.csv"), "utf8").trim().split("\n");
  const names = lines[0].split(",");
  if (lines.length - 1 !== count) fail(`${lines.length - 1} Gaussians, expected ${count}`);
  for (const i of [0, count >> 1, count - 1]) {
    const row = lines[i + 1].split(",").map(Number);
    ["x", "y", "z"].forEach((name, k) => {
      const ours = bytes.readFloatLE(end + i * stride + 4 * k);
      const theirs = row[names.indexOf(name)];
      if (Math.abs(ours - theirs) > 1e-3) fail(`${name} of ${i} is ${theirs}, expected ${ours}`);
    });
  }
  const glb = readFileSync(join(folder, "back.glb"));
  const document = JSON.parse(glb.subarray(20, 20 + glb.readUInt32LE(12)).toString());
  const points = document.accessors[document.meshes[0].primitives[0].attributes.POSITION].count;
  if (points !== count) fail(`${points} Gaussians in its GLB, expected ${count}`);
  console.log(
    JSON.stringify({
      reader: "splat-transform",
      version,
      accepted: true,
      read: { gaussians: count, columns: names.length, kept: ["class", "instance", "strength"].filter((n) => names.includes(n)) },
    }),
  );
} finally {
  rmSync(folder, { recursive: true, force: true });
}
