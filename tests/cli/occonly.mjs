// node occonly.mjs MODEL.glb: follows the import of Godot 4 for each node of the scene, from the
// name to what is made of it, and checks that it ends as an occluder and nothing else.
import { readFileSync } from "node:fs";
import { strict as assert } from "node:assert";

// What the import tries, in its order (ResourceImporterScene::_pre_fix_node).
const words = ["noimp", "colonly", "convcolonly", "rigid", "col", "convcol", "navmesh", "occ",
    "occonly", "vehicle", "wheel"];

// Digits, blanks and underscores at the end do not count; "$word" counts anywhere.
function hasSuffix(name, word) {
    const core = name.replace(/[0-9_\s]+$/, "").toLowerCase();
    return core.includes(`$${word}`) || core.endsWith(`-${word}`) || core.endsWith(`_${word}`);
}

const bytes = readFileSync(process.argv[2]);
const gltf = JSON.parse(bytes.subarray(20, 20 + bytes.readUInt32LE(12)));
const nodes = gltf.scenes[gltf.scene].nodes.map((node) => gltf.nodes[node]);
assert(nodes.length > 0);
assert.equal(nodes.length, gltf.nodes.length, "all nodes are at the root");
for (const node of nodes) {
    // The importer of glTF makes names valid first.
    const name = node.name.replace(/[.:@/"%]/g, "_");
    assert.equal(words.find((word) => hasSuffix(name, word)), "occonly", name);
    assert(node.name.endsWith("-occonly"));
    // Occluders are taken with the node's own transform, without its parents'.
    assert(!node.children && !node.matrix && !node.translation && !node.rotation && !node.scale);
    for (const primitive of gltf.meshes[node.mesh].primitives) {
        // Meshes without indices, and materials that are not opaque, are left out of the baking.
        assert.notEqual(primitive.indices, undefined);
        assert.equal(gltf.materials[primitive.material].alphaMode ?? "OPAQUE", "OPAQUE");
    }
}
