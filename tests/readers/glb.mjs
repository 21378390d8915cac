// packages: gltf-validator@2.0.0-dev.3.10
// Checks a scene.glb with the validator of Khronos: no errors.
import { readFileSync } from "node:fs";
import { createRequire } from "node:module";

// Also where the packages lie in the folder that this is run in.
const require = createRequire(`${process.cwd()}/`);
const validator = require("gltf-validator");

const report = await validator.validateBytes(new Uint8Array(readFileSync(process.argv[2])), { maxIssues: 0 });
const { numErrors, numWarnings, numInfos, messages } = report.issues;
const info = report.info;
if (numErrors > 0) {
  console.error(`${numErrors} errors, the first: ${JSON.stringify(messages[0])}`);
  process.exit(1);
}
console.log(
  JSON.stringify({
    reader: "gltf-validator",
    version: validator.version(),
    accepted: true,
    read: {
      errors: numErrors,
      warnings: numWarnings,
      infos: numInfos,
      codes: [...new Set(messages.map((m) => m.code))],
      triangles: info.totalTriangleCount,
      vertices: info.totalVertexCount,
      materials: info.materialCount,
    },
  }),
);
