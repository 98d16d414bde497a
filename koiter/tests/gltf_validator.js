// Prints the report of the Khronos glTF validator on a file as JSON: node gltf_validator.js FILE.glb
"use strict";
const fs = require("fs");
const validator = require("gltf-validator");

validator
  .validateBytes(new Uint8Array(fs.readFileSync(process.argv[2])))
  .then((report) => process.stdout.write(JSON.stringify(report)));
