// node validate.cjs FILE...: prints what the Khronos validator finds; exits 1 on any error or
// warning. The package is found through NODE_PATH.
const validator = require("gltf-validator");
const fs = require("node:fs");

async function validate(path) {
    const report = await validator.validateBytes(new Uint8Array(fs.readFileSync(path)), {uri: path});
    const issues = report.issues.messages.filter(message => message.severity <= 1);
    for (const issue of issues) {
        console.error(`${path}: ${issue.code} at ${issue.pointer}: ${issue.message}`);
    }
    if (!/^paravent [0-9.]+$/.test(report.info.generator ?? "")) {
        console.error(`${path}: asset.generator is ${report.info.generator}`);
        return 1;
    }
    return issues.length;
}

Promise.all(process.argv.slice(2).map(validate)).then(counts => {
    const sum = counts.reduce((total, count) => total + count, 0);
    console.log(`${counts.length} files, ${sum} problems`);
    process.exit(sum === 0 && counts.length > 0 ? 0 : 1);
});
