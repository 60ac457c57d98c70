// The Khronos validator on .glb files: node gltf_check.cjs FILE.. prints one line of JSON, a list with the validator's issues,
// the counts of its objects and the extent of each file.
const fs = require('fs');
const validator = require('gltf-validator');

const check = async (file) => {
  const report = await validator.validateBytes(new Uint8Array(fs.readFileSync(file)), { maxIssues: 20 });
  const { issues, info } = report;
  return {
    errors: issues.numErrors,
    warnings: issues.numWarnings,
    infos: issues.numInfos,
    messages: issues.messages.map((message) => `${message.code} ${message.pointer}: ${message.message}`),
    version: info.version,
    animations: info.animationCount,
    materials: info.materialCount,
    triangles: info.totalTriangleCount,
  };
};

Promise.all(process.argv.slice(2).map(check)).then((found) => console.log(JSON.stringify(found)));
