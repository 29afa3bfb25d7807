// Prints one JSON list with the validator's issues for each of the files named on the command line.
const fs = require("fs");
const validator = require("gltf-validator");

const options = { maxIssues: 100 };
const reports = process.argv.slice(2).map(async (path) => {
  const report = await validator.validateBytes(new Uint8Array(fs.readFileSync(path)), options);
  return report.issues;
});
Promise.all(reports).then((issues) => console.log(JSON.stringify(issues)));
