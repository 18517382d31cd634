// node evaluate.mjs JSON CSV: whether the two files of one run of `evaluate` hold what they should.
import { readFileSync } from "node:fs";

const [jsonPath, csvPath] = process.argv.slice(2);
const result = JSON.parse(readFileSync(jsonPath, "utf8"));
const problems = [];

function expectKeys(what, object, keys) {
    const found = Object.keys(object).sort().join(" ");
    const wanted = keys.split(" ").sort().join(" ");
    if (found !== wanted) problems.push(`${what} has ${found}, not ${wanted}`);
}

function expectFraction(what, value) {
    if (!(value >= 0 && value <= 1)) problems.push(`${what} is ${value}`);
}

function expectLength(what, value) {
    if (!(Number.isFinite(value) && value >= 0)) problems.push(`${what} is ${value}`);
}

function checkNumbers(what, score) {
    for (const family of ["uniform", "small"]) {
        expectKeys(`${what}.${family}`, score[family], "precision recall");
        expectFraction(`${what}.${family}.precision`, score[family].precision);
        expectFraction(`${what}.${family}.recall`, score[family].recall);
    }
    expectFraction(`${what}.coverage`, score.coverage);
    expectLength(`${what}.over_area`, score.over_area);
    expectLength(`${what}.over_thickness`, score.over_thickness);
}

expectKeys("the file", result, "version original views quads pixels seed occluders");
expectKeys("original", result.original, "file triangles");
for (const occluder of result.occluders) {
    const what = occluder.file;
    expectKeys(what, occluder,
        "file triangles uniform small coverage over_area over_thickness worst_view per_view");
    checkNumbers(what, occluder);
    expectKeys(`${what}.worst_view`, occluder.worst_view, "direction recall");
    if (occluder.per_view.length !== result.views) problems.push(`${what}: views are missing`);
    const worst = Math.min(...occluder.per_view.map((view) => view.uniform.recall));
    if (occluder.worst_view.recall !== worst) problems.push(`${what}: another view is worse`);
    const thickest = Math.max(...occluder.per_view.map((view) => view.over_thickness));
    if (occluder.over_thickness !== thickest) problems.push(`${what}: another view is thicker`);
    for (const view of occluder.per_view) {
        expectKeys(`${what} view`, view,
            "direction uniform small coverage over_area over_thickness");
        checkNumbers(`${what} view`, view);
        const length = Math.hypot(...view.direction);
        if (Math.abs(length - 1) > 1e-9) problems.push(`${what}: a direction of length ${length}`);
    }
}

// The counts of the CSV add up to the fractions of the JSON.
const lines = readFileSync(csvPath, "utf8").split("\r\n");
const head = lines[0].split(",");
const rows = lines.slice(1, -1).map((line) => {
    const cells = line.split(",");
    if (cells.length !== head.length) problems.push(`a line of ${cells.length} cells: ${line}`);
    return Object.fromEntries(head.map((key, i) => [key, cells[i]]));
});
if (rows.length !== result.views * result.occluders.length) problems.push("lines are missing");
for (const occluder of result.occluders) {
    const own = rows.filter((row) => row.occluder === occluder.file);
    const sum = (key) => own.reduce((total, row) => total + Number(row[key]), 0);
    for (const family of ["uniform", "small"]) {
        const [nt, pf, nf] = ["nt", "pf", "nf"].map((key) => sum(`${family}_${key}`));
        const recall = nt + pf > 0 ? nt / (nt + pf) : 1;
        const precision = nt + nf > 0 ? nt / (nt + nf) : 1;
        if (Math.abs(recall - occluder[family].recall) > 1e-12 ||
            Math.abs(precision - occluder[family].precision) > 1e-12) {
            problems.push(`${occluder.file}: the counts say ${precision}, ${recall}`);
        }
    }
    own.forEach((row, v) => {
        if (Number(row.view) !== v ||
            Number(row.uniform_recall) !== occluder.per_view[v].uniform.recall) {
            problems.push(`${occluder.file}: line ${v} is not view ${v}`);
        }
    });
}

// By what the three are: the larger is better, and what lies beside is only wrong.
const [large, small, beside] = result.occluders;
if (!(large.uniform.recall > small.uniform.recall && small.uniform.recall > 0)) {
    problems.push("the larger occluder does not hide more");
}
if (!(beside.coverage < 0.05 && beside.over_area > 0 && beside.over_thickness > 3)) {
    problems.push("what lies beside is not told");
}
for (const problem of problems) console.error(problem);
process.exit(problems.length > 0 ? 1 : 0);
