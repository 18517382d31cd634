// node bundle.mjs PAGE.c: one HTML page with everything in it, as an array of bytes in a C file. The
// mark that the data goes in place of splits it in two.
import { build } from "esbuild";
import { readFileSync, writeFileSync } from "node:fs";
import { dirname, join } from "node:path";
import { fileURLToPath } from "node:url";

const here = dirname(fileURLToPath(import.meta.url));
const result = await build({
    entryPoints: [join(here, "viewer.js")],
    bundle: true, minify: true, write: false, format: "iife", target: "es2022",
    legalComments: "inline", logLevel: "error",
});
// Within a page a script ends at the first "</script", wherever that stands.
const script = result.outputFiles[0].text.replaceAll("</script", "<\\/script");
const page = readFileSync(join(here, "page.html"), "utf8").replace("/*VIEWER*/", () => script);

function toArray(name, text) {
    const bytes = Buffer.from(text, "utf8");
    const lines = [];
    for (let i = 0; i < bytes.length; i += 32) {
        lines.push(`    ${[...bytes.subarray(i, i + 32)].join(",")},`);
    }
    return `const unsigned char ${name}[] = {\n${lines.join("\n")}\n};\n` +
        `const size_t ${name}Size = ${bytes.length};\n`;
}

const [head, tail] = page.split("<!--DATA-->\n");
writeFileSync(process.argv[2], "// Made by bundle.mjs from the files beside it.\n" +
    '#include "report_page.h"\n\n' + toArray("pvtReportHead", head) +
    toArray("pvtReportTail", tail));
