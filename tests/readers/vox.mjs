// packages: three@0.187.0
// A .vox file through the VOXLoader of three.js: models, nodes, colours.
import { readFileSync } from "node:fs";
import { createRequire } from "node:module";
import { pathToFileURL } from "node:url";

// Also where the packages lie in the folder that this is run in.
const require = createRequire(`${process.cwd()}/`);
const loader = require.resolve("three/examples/jsm/loaders/VOXLoader.js");
const { VOXLoader } = await import(pathToFileURL(loader));
const { version } = JSON.parse(readFileSync(new URL("../../../package.json", pathToFileURL(loader))));

function fail(line) {
  console.error(`vox: ${line}`);
  process.exit(1);
}

const complaints = [];
console.error = (...words) => complaints.push(words.join(" "));
const bytes = readFileSync(process.argv[2]);
let parsed;
try {
  parsed = new VOXLoader().parse(bytes.buffer.slice(bytes.byteOffset, bytes.byteOffset + bytes.length));
} catch (error) {
  complaints.push(String(error));
}
const { log } = console;
console.error = (line) => process.stderr.write(`${line}\n`);
if (complaints.length || !parsed) fail(complaints.join("; ") || "nothing was read");
const { chunks, scene } = parsed;
if (!chunks?.length || !scene) fail("no models, or no scene of them");

const classes = {};
let voxels = 0;
const high = [0, 0, 0];
for (const { data, size, palette } of chunks) {
  for (let i = 0; i < data.length; i += 4) {
    const [x, y, z, color] = data.slice(i, i + 4);
    if (x >= size.x || y >= size.y || z >= size.z) fail(`voxel ${x}, ${y}, ${z} outside ${JSON.stringify(size)}`);
    if (color < 1 || color > 17) fail(`colour ${color}, expected 1 to 17`);
    const rgb = palette[color] & 0xffffff;
    if (color === 5 && rgb !== ((245 << 16) | (150 << 8) | 30)) fail(`a car of colour ${rgb.toString(16)}`);
    classes[color - 1] = (classes[color - 1] ?? 0) + 1;
    voxels += 1;
    [x, y, z].forEach((v, axis) => { high[axis] = Math.max(high[axis], v); });
  }
}
const places = [];
scene.traverse((node) => { if (node.isMesh) places.push(node.getWorldPosition(node.position.clone()).toArray()); });
const read = { models: chunks.length, sizes: chunks.map((c) => [c.size.x, c.size.y, c.size.z]), voxels, classes, high, places };
log(JSON.stringify({ reader: "three VOXLoader", version, accepted: true, read }));
