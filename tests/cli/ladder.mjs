// node ladder.mjs FILE msft|suffix STATS LEVELS [ORIGINAL]: whether the file is a ladder as the stats
// tell it: errors grow, triangles fall, nodes and coverages are where they belong.
import assert from "node:assert/strict";
import {readFileSync} from "node:fs";

const [, , path, naming, statsPath, levelCount] = process.argv;

function readDocument(file) {
    const bytes = readFileSync(file);
    if (bytes.subarray(0, 4).toString() !== "glTF") return JSON.parse(bytes.toString());
    return JSON.parse(bytes.subarray(20, 20 + bytes.readUInt32LE(12)).toString());
}

function rises(values) {
    return values.every((value, i) => i === 0 || value > values[i - 1]);
}

const near = (a, b) => Math.abs(a - b) <= 1e-9 * Math.abs(b);
const document = readDocument(path);
const stats = JSON.parse(readFileSync(statsPath, "utf8"));
const levels = stats.levels;
const screen = stats.options;

assert.equal(levels.length, Number(levelCount));
assert.equal(screen.levels, (screen.errors ?? screen.budgets)?.split(",").length ?? screen.levels);
assert.equal(screen.resolution === null, screen.errors !== null, "one of them sets the voxels");
assert(rises(levels.map(level => level.error_bound)), "errors grow");
assert(rises(levels.map(level => level.distance)), "so do distances");
assert(rises(levels.map(level => -level.triangles)), "triangles fall");
assert(rises(levels.map(level => -level.budget)), "and so do budgets");

// The help's formula, with numbers from the stats alone.
const tangent = Math.tan(screen.fov * Math.PI / 360);
const width = screen.screen_width ?? screen.screen_height * 16 / 9;
const reaches = levels.map(level => level.distance -
    level.error_bound * screen.screen_height / (2 * tangent) / screen.pixel_error);
for (const [i, level] of levels.entries()) {
    assert(level.triangles <= level.budget && level.triangles >= 1);
    assert.equal(level.level, i);
    assert.equal(level.outside, 0);
    assert(near(reaches[i], reaches[0]) || near(level.distance, levels[0].distance));
    const coverage = Math.PI * (stats.radius / level.distance) ** 2 * screen.screen_height /
        (4 * tangent ** 2 * width);
    assert(near(level.screen_coverage, Math.min(1, coverage)), "coverage by the formula");
}

const found = document.nodes.filter(node => node.extras?.paravent !== undefined);
assert.equal(found.length, levels.length);
for (const [i, node] of found.entries()) {
    const primitive = document.meshes[node.mesh].primitives[0];
    assert.equal(document.accessors[primitive.indices].count, 3 * levels[i].triangles);
    const extras = node.extras.paravent;
    for (const key of ["error_bound", "distance", "screen_coverage", "budget", "resolution"]) {
        assert.equal(extras[key], levels[i][key]);
    }
}
const inScene = document.scenes[document.scene].nodes.map(index => document.nodes[index]);
if (naming === "msft") {
    const finest = found[0];
    assert(document.extensionsUsed.includes("MSFT_lod"));
    assert.deepEqual(finest.extensions.MSFT_lod.ids.map(id => document.nodes[id]), found.slice(1));
    const coverages = finest.extras.MSFT_screencoverage;
    assert.deepEqual(coverages, [...levels.slice(1).map(level => level.screen_coverage), 0]);
    assert.deepEqual(found.map(node => inScene.includes(node)), found.map((_, i) => i === 0));
} else {
    assert(found.every(node => inScene.includes(node) && node.extensions === undefined));
    assert(levels.length === 1 || found.every((node, i) => node.name.endsWith(`_LOD${i}`)));
}
