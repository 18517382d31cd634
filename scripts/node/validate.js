// node validate.js FILE...: the Khronos glTF validator over .glb and .gltf files. Errors fail;
// warnings are shown.
'use strict';
const fs = require('fs');
const path = require('path');
const validator = require('gltf-validator');

const SEVERITIES = ['error', 'warning'];

async function validate(file) {
  const report = await validator.validateBytes(new Uint8Array(fs.readFileSync(file)), {
    uri: path.basename(file),
    externalResourceFunction: async (uri) =>
      new Uint8Array(fs.readFileSync(path.join(path.dirname(file), decodeURIComponent(uri)))),
  });
  for (const message of report.issues.messages) {
    if (message.severity < SEVERITIES.length) {
      const where = message.pointer ? ` at ${message.pointer}` : '';
      console.log(`${file}: ${SEVERITIES[message.severity]}${where}: ${message.message}`);
    }
  }
  return report.issues.numErrors;
}

async function main(files) {
  if (files.length === 0) {
    console.error('usage: node validate.js FILE...');
    return 1;
  }
  let errors = 0;
  for (const file of files) {
    errors += await validate(file).catch((problem) => {
      console.log(`${file}: ${problem}`);
      return 1;
    });
  }
  console.log(`${files.length} files, ${errors} errors`);
  return errors === 0 ? 0 : 1;
}

main(process.argv.slice(2)).then((code) => {
  process.exitCode = code;
});
