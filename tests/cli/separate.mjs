// node separate.mjs INPUT.glb OUTPUT.glb shared|moved: whether the output of --separate has the
// nodes of models/yard.glb that have an inside, by their names, and stands where they stand: as
// instances of shared meshes, or moved there.
import assert from "node:assert/strict";
import { readFileSync } from "node:fs";

function read(path) {
    const bytes = readFileSync(path);
    const size = bytes.readUInt32LE(12);
    const json = JSON.parse(bytes.subarray(20, 20 + size).toString("utf8"));
    return { ...json, binary: bytes.subarray(28 + size) };
}

const [inputPath, outputPath, layout] = process.argv.slice(2);
const input = read(inputPath);
const output = read(outputPath);

// The first of equal names keeps it; "tower_2" is a node's own, so that the other tower is the third.
// A node without a name has its mesh's.
const names = ["tower", "tower_3", "tower_2", "wedge", "wedge_2", "M\u00e4uerchen /\u6771$noimp"];
const wanted = layout === "shared" ? names.map(name => `${name}_occluder`) :
    names.map(name => `${name.replace("$", "_")}-occonly`);
assert.deepEqual(output.nodes.map(node => node.name), wanted);
assert.deepEqual(output.scenes[0].nodes, [0, 1, 2, 3, 4, 5]);

const near = (a, b, what) => a.forEach((value, i) =>
    assert(Math.abs(value - b[i]) <= 1e-6, `${what}: ${a} is not ${b}`));
const part = node => ({ translation: node.translation ?? [0, 0, 0],
    rotation: node.rotation ?? [0, 0, 0, 1], scale: node.scale ?? [1, 1, 1] });

if (layout === "shared") {
    assert.equal(output.meshes.length, 2);
    assert.deepEqual(output.nodes.map(node => node.mesh), [0, 0, 0, 1, 1, 1]);
    output.nodes.forEach((node, i) => {
        const from = part(input.nodes[i]);
        const to = part(node);
        near(to.translation, from.translation, "translation");
        near(to.scale, from.scale, "scale");
        const dot = to.rotation.reduce((sum, value, k) => sum + value * from.rotation[k], 0);
        assert(Math.abs(Math.abs(dot) - 1) < 1e-6, `rotation: ${to.rotation}`);
        assert(!("matrix" in node));
    });
} else {
    assert.equal(output.meshes.length, 6);
    for (const node of output.nodes) {
        assert.deepEqual(part(node), part({}));
        assert(!("matrix" in node) && !("children" in node));
    }
}
for (const node of output.nodes) {
    assert(node.extras.paravent.error_bound > 0);
    assert(node.extras.paravent.budget >= 2);
}
