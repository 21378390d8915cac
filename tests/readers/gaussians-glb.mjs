// packages: @babylonjs/core@9.35.0 @babylonjs/loaders@9.28.0 gltf-validator@2.0.0-dev.3.10
// A scene_gaussians.glb through Khronos' validator, and through Babylon.js, which knows KHR_gaussian_splatting: splats of each
// node, their places with y up, and their sizes.
import { readFileSync } from "node:fs";
import { createRequire } from "node:module";
import { pathToFileURL } from "node:url";

// Where the packages lie in the folder that this is run in.
const require = createRequire(`${process.cwd()}/`);
const load = async (name) => import(pathToFileURL(require.resolve(name)));

function fail(line) {
  console.error(`gaussians-glb: ${line}`.replaceAll("\n", " ").slice(0, 300));
  process.exit(1);
}

const bytes = readFileSync(process.argv[2]);
// The validator does not know the extension, nor the names of its attributes.
const { issues } = await require("gltf-validator").validateBytes(new Uint8Array(bytes), { maxIssues: 0 });
const known = (m) => m.code === "MESH_PRIMITIVE_INVALID_ATTRIBUTE" && m.pointer.includes("/KHR_gaussian_splatting:");
const errors = issues.messages.filter((m) => m.severity === 0 && !known(m));
if (errors.length > 0) fail(`${errors[0].code} ${errors[0].pointer}, ${errors[0].message}`);

const length = bytes.readUInt32LE(12);
const document = JSON.parse(bytes.subarray(20, 20 + length).toString());
const floats = (accessor) => {
  const view = document.bufferViews[document.accessors[accessor].bufferView];
  const from = 20 + length + 8 + view.byteOffset;
  return new Float32Array(bytes.buffer.slice(bytes.byteOffset + from, bytes.byteOffset + from + view.byteLength));
};

// Babylon sorts in a worker, for which there is no use without a picture.
globalThis.XMLHttpRequest ??= class {};
globalThis.Worker ??= class {
  postMessage() {}
  terminate() {}
};
const { NullEngine, Scene, ImportMeshAsync, Logger } = await load("@babylonjs/core");
await load("@babylonjs/loaders/glTF");
Logger.LogLevels = Logger.NoneLogLevel;
const scene = new Scene(new NullEngine());
scene.useRightHandedSystem = true;
const url = `data:model/gltf-binary;base64,${bytes.toString("base64")}`;
const { meshes } = await ImportMeshAsync(url, scene, { pluginExtension: ".glb" }).catch((e) => fail(e.message.slice(-250)));
const splats = meshes.filter((m) => m.getClassName() === "GaussianSplattingMesh");
if (splats.length !== document.nodes.length) fail(`${splats.length} meshes of splats, expected ${document.nodes.length}`);
let count = 0;
const instances = new Set();
const classes = new Set();
document.nodes.forEach((node, i) => {
  const attributes = document.meshes[node.mesh].primitives[0].attributes;
  const places = floats(attributes.POSITION);
  const mesh = splats.find((m) => m.name === node.name) ?? splats[i];
  const found = mesh._vertexCount;
  if (found !== places.length / 3) fail(`${node.name}: ${found} splats, expected ${places.length / 3}`);
  const sizes = floats(attributes["KHR_gaussian_splatting:SCALE"]);
  for (const k of [0, found >> 1, found - 1]) {
    for (let axis = 0; axis < 3; axis++) {
      const at = mesh._splatPositions[4 * k + axis];
      if (at !== places[3 * k + axis]) fail(`${node.name}: splat ${k} is at ${at}, expected ${places[3 * k + axis]}`);
    }
  }
  // Its largest splat is as large as Babylon takes it to be: spreads are metres, not logarithms.
  const largest = sizes.reduce((a, b) => Math.max(a, b), 0);
  if (!(mesh._splatSizeMax <= 10 * largest && mesh._splatSizeMax >= 0.1 * largest)) {
    fail(`${node.name}: the largest splat is of ${mesh._splatSizeMax} m, expected about ${largest}`);
  }
  count += places.length / 3;
  classes.add(node.extras.class);
  if (node.extras.instance > 0) instances.add(node.extras.instance);
});
const version = ["@babylonjs/loaders", "gltf-validator"].map((n) => JSON.parse(readFileSync(require.resolve(`${n}/package.json`))).version);
console.log(
  JSON.stringify({
    reader: "Babylon.js",
    version: `${version[0]}, gltf-validator ${version[1]}`,
    accepted: true,
    read: { gaussians: count, nodes: splats.length, classes: classes.size, instances: instances.size, warnings: issues.numWarnings },
  }),
);
process.exit(0);
