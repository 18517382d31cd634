// node stats.mjs FILE: whether the file holds what docs call the stats of `generate`.
import { readFileSync } from "node:fs";

const stats = JSON.parse(readFileSync(process.argv[2], "utf8"));
const fields = {
    version: "string", input: "string", triangles_in: "count", triangles: "count",
    polygons: "count", resolution: "count", voxel_size: "number", error_bound: "number",
    surface_polygons: "count", surface_deviation: "number", inside_fraction: "number", measure: "number", measure_of_solid: "number",
    candidates: "count", outside: "count", seconds: "object", peak_bytes: "count",
    options: "object", warnings: "array",
};
const options = ["convention", "separate", "budget", "resolution", "error", "tolerance", "method", "effort", "deadline",
    "views", "seed", "smallest_hole", "ground", "terrain", "up", "enclosed", "scene", "node", "masked",
    "slicer", "threads", "memory_limit"];
const stages = ["load", "voxelize", "solid", "sections", "chains", "select", "refine", "check", "preview",
    "save", "total"];
const problems = [];
if (stats.options.separate) {
    Object.assign(fields, { nodes: "count", nodes_without: "count", occluders: "array" });
}

function isKind(value, kind) {
    switch (kind) {
    case "array": return Array.isArray(value);
    case "count": return Number.isSafeInteger(value) && value >= 0;
    case "number": return Number.isFinite(value) && value >= 0;
    default: return typeof value === kind && value !== null;
    }
}

function expectKeys(what, object, keys) {
    const found = Object.keys(object).sort().join(" ");
    const wanted = [...keys].sort().join(" ");
    if (found !== wanted) problems.push(`${what} has ${found}, not ${wanted}`);
}

expectKeys("the file", stats, Object.keys(fields));
for (const [name, kind] of Object.entries(fields)) {
    if (!isKind(stats[name], kind)) problems.push(`${name} is ${stats[name]}, not a ${kind}`);
}
expectKeys("options", stats.options, options);
expectKeys("seconds", stats.seconds, stages);
for (const [stage, seconds] of Object.entries(stats.seconds)) {
    if (!isKind(seconds, "number")) problems.push(`seconds.${stage} is ${seconds}`);
}
const sum = Object.entries(stats.seconds).reduce(
    (total, [stage, seconds]) => (stage === "total" ? total : total + seconds), 0);
if (sum > stats.seconds.total + 1e-3) problems.push(`the stages take ${sum} s, more than all`);
if (!stats.warnings.every(text => typeof text === "string")) problems.push("warnings not text");
if (stats.triangles > stats.options.budget) problems.push("more triangles than the budget");
if (stats.inside_fraction > 1) problems.push("more than all is inside");
if (stats.measure > stats.measure_of_solid * 1.0001) problems.push("hides more than the solid");
if (stats.peak_bytes < 1e5) problems.push("no program is that small");

for (const each of stats.occluders ?? []) {
    const isMade = each.result === "made";
    if (isMade !== (each.reason === null)) problems.push(`${each.node}: reason ${each.reason}`);
    if (isMade !== each.triangles > 0) problems.push(`${each.node}: ${each.triangles} triangles`);
    if (each.triangles > each.budget) problems.push(`${each.node}: more than its share`);
    if (each.outside !== 0) problems.push(`${each.node}: reaches outside`);
}
if (stats.occluders !== undefined) {
    const drawn = stats.occluders.reduce((sum, each) => sum + each.nodes * each.triangles, 0);
    if (drawn !== stats.triangles) problems.push(`${drawn} triangles, not ${stats.triangles}`);
}

for (const problem of problems) console.error(`${process.argv[2]}: ${problem}`);
process.exit(problems.length === 0 ? 0 : 1);
